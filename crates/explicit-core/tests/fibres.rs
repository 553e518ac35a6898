//! Fibres: the inertia that they add, its frequencies, momentum, energy, joints and bits.

use std::sync::Arc;

use nalgebra::{DMatrix, Rotation3, Unit};
use powerhouse_contact::{Frictionless, Joint, TiedPairs};
use powerhouse_elements::NodalForce;
use powerhouse_explicit_core::{BuildModel, ExplicitOnRanks, Leapfrog, Model, OneSided, run};
use powerhouse_model::{
    AddedMass, BlockFactory, BoundaryParts, ElementKind, EnergyCheck, Engine, Fibre, JointPair,
    Mat3, Mesh, ModelSpec, NodalImpedance, PeriodicPairs, Precision, Prescribed, RunError,
    RunOptions, State, StepChoice, Support, ThreadRanks, TimeIntegrator, Vec3,
};

use crate::support::{
    Links, StopAfter, balanced_steps, dense, energy_of, fibre_of, hex_box, random_vectors,
    same_bits_over_threads,
};

pub(crate) fn rock() -> Links {
    Links::new("rock", ElementKind::Hex8, 9.0e9, 0.3, 2700.0)
}

/// Bars at places along a line, with nodes tagged from 1; a set for each bar.
fn bars(places: &[f64], along: Vec3) -> Mesh {
    let mut builder = Mesh::builder();
    for (tag, place) in (1..).zip(places) {
        builder.node(tag, along * *place);
    }
    for tag in 1..places.len() as u64 {
        let set = format!("bar {tag}");
        builder.element(tag, ElementKind::Bar2, &[tag, tag + 1], &[&set]);
    }
    builder.build().unwrap()
}

/// Fibres of the nodes above each other of a box of hexahedra.
pub(crate) fn columns_of([nx, ny, nz]: [usize; 3], added: impl Fn(usize) -> f64) -> Vec<Fibre> {
    let plane = (nx + 1) * (ny + 1);
    let column = |node: usize| Fibre {
        nodes: (0..=nz).map(|k| (node + k * plane) as u32).collect(),
        added: added(node),
    };
    (0..plane).map(column).collect()
}

/// A chain of masses `m1, m2, m2, m1` with stiff bar in the middle whose two nodes are a fibre, in any direction: the
/// mode in which the middle bar is strained has the frequency of masses `m2 (1 + a)`, that in which it is not is
/// unchanged, and both move as central differences make them, to rounding, for any length of step. The reported step
/// is that of the chain.
#[test]
fn a_fibre_of_two_masses_shifts_the_frequency_that_strains_it() {
    let directions = [Vec3::x(), Vec3::new(0.3, -0.5, 0.8).normalize()];
    for (along, added, thin) in [
        (directions[0], 3.0, 0.05),
        (directions[1], 8.0, 0.01),
        (directions[1], 0.3, 0.4),
        (directions[0], 40.0, 0.002),
    ] {
        let mesh = bars(&[0.0, 1.0, 1.0 + thin, 2.0 + thin], along);
        let (young, area, density) = (9.0e9, 0.5, 2700.0);
        let links = |set: &str| Links::new(set, ElementKind::Bar2, young, area, density).boxed();
        let chain = || {
            Model::builder(&mesh)
                .elements("bar 1", links("bar 1"))
                .elements("bar 2", links("bar 2"))
                .elements("bar 3", links("bar 3"))
                .build()
                .unwrap()
        };
        let mut model = chain();
        let outer = 0.5 * density * area;
        let inner = outer * (1.0 + thin);
        let (k, middle) = (young * area, young * area / thin);
        model.set_fibres(&[fibre_of(&[1, 2], added)]).unwrap();
        // Strained: both masses of a half, M u'' = -K u with K = [k, -k; -k, k + 2 middle].
        let slow = inner * (1.0 + added);
        let half = 0.5 * (k / outer + (k + 2.0 * middle) / slow);
        let rest = (half * half - 2.0 * k * middle / (outer * slow)).sqrt();
        let strained = [half + rest, half - rest].map(|square| {
            let ratio = 1.0 - square * outer / k;
            (square.sqrt(), [1.0, ratio, -ratio, -1.0])
        });
        let whole = (k * (1.0 / outer + 1.0 / inner)).sqrt();
        let unstrained = [(whole, [1.0, -outer / inner, -outer / inner, 1.0])];
        let highest = strained[0].0.max(whole);
        let step = model.stable_step(&Leapfrog).unwrap().step;
        assert!(
            (step * highest / 1.96 - 1.0).abs() < 1e-9,
            "{added}: {step}"
        );
        for (frequency, shape) in strained.into_iter().chain(unstrained) {
            let step = 0.9 * step;
            let angle = 2.0 * (0.5 * frequency * step).asin();
            let shape: Vec<Vec3> = shape.iter().map(|value| along * (1e-3 * value)).collect();
            let before = (1.0 - angle.cos()) / step;
            let velocity: Vec<Vec3> = shape.iter().map(|value| value * before).collect();
            let mut model = chain();
            model.set_fibres(&[fibre_of(&[2, 1], added)]).unwrap();
            model.set_initial(&shape, &velocity).unwrap();
            let report = balanced_steps(&mut model, 333, StepChoice::Fixed(step));
            assert!(report.energy_residual < 1e-12, "{}", report.energy_residual);
            for (node, shape) in (0..).zip(&shape) {
                let exact = shape * (333.0 * angle).cos();
                let error = (model.displacement(node) - exact).norm();
                assert!(error < 1e-12, "{added}, {frequency}: {error:e}");
            }
        }
    }
}

/// Dense matrices of a body with added masses, fibres and supports.
pub(crate) struct DenseBody {
    pub(crate) stiffness: DMatrix<f64>,
    pub(crate) inertia: DMatrix<f64>,
    /// A base of the free motions.
    pub(crate) base: DMatrix<f64>,
}

pub(crate) fn dense_body(
    mesh: &Mesh,
    factory: &dyn BlockFactory,
    masses: &[AddedMass],
    (fibres, held): (&[Fibre], &[(Vec<u32>, Vec3)]),
) -> DenseBody {
    let elements: Vec<u32> = (0..mesh.element_count() as u32).collect();
    let (stiffness, mass) = dense(mesh, factory, &elements);
    let size = stiffness.nrows();
    let mut inertia = DMatrix::<f64>::zeros(size, size);
    for dof in 0..size {
        inertia[(dof, dof)] = mass[dof / 3];
    }
    for added in masses {
        let at = 3 * added.node as usize;
        let mut of_node = inertia.fixed_view_mut::<3, 3>(at, at);
        of_node += added.mass;
    }
    for fibre in fibres {
        let sum: f64 = fibre.nodes.iter().map(|&n| mass[n as usize]).sum();
        for c in 0..3 {
            for &a in &fibre.nodes {
                let a = a as usize;
                inertia[(3 * a + c, 3 * a + c)] += fibre.added * mass[a];
                for &b in &fibre.nodes {
                    let b = b as usize;
                    inertia[(3 * a + c, 3 * b + c)] -= fibre.added * mass[a] * mass[b] / sum;
                }
            }
        }
    }
    // The base, from the projection that takes the held directions out.
    let mut free = DMatrix::<f64>::identity(size, size);
    for (nodes, direction) in held {
        let n = direction.normalize();
        for &node in nodes {
            let mut normal = DMatrix::<f64>::zeros(size, 1);
            for c in 0..3 {
                normal[(3 * node as usize + c, 0)] = n[c];
            }
            free -= &normal * normal.transpose();
        }
    }
    let eigen = free.symmetric_eigen();
    let kept: Vec<usize> = (0..size).filter(|&i| eigen.eigenvalues[i] > 0.5).collect();
    let base = eigen.eigenvectors.select_columns(&kept);
    DenseBody {
        stiffness,
        inertia,
        base,
    }
}

impl DenseBody {
    /// Circular frequencies (rad/s), from the lowest on, and modes of all nodes.
    pub(crate) fn modes(&self) -> Vec<(f64, Vec<Vec3>)> {
        let Self {
            stiffness,
            inertia,
            base,
        } = self;
        let inertia = base.transpose() * inertia * base;
        let stiffness = base.transpose() * stiffness * base;
        let inverse = inertia.cholesky().unwrap().l().try_inverse().unwrap();
        let eigen = (&inverse * stiffness * inverse.transpose()).symmetric_eigen();
        let shapes = base * inverse.transpose() * eigen.eigenvectors;
        let mut modes: Vec<(f64, Vec<Vec3>)> = (shapes.column_iter().zip(&eigen.eigenvalues))
            .map(|(shape, square)| {
                let nodes = shape.as_slice().as_chunks::<3>().0.iter();
                let shape = nodes.map(|&node| Vec3::from(node)).collect();
                (square.max(0.0).sqrt(), shape)
            })
            .collect();
        modes.sort_by(|a, b| a.0.total_cmp(&b.0));
        modes
    }

    /// The stability limit `2 / w` (s).
    pub(crate) fn limit(&self) -> f64 {
        2.0 / self.modes().last().unwrap().0
    }
}

fn dense_limit(
    mesh: &Mesh,
    factory: &dyn BlockFactory,
    (fibres, held): (&[Fibre], &[(Vec<u32>, Vec3)]),
) -> f64 {
    dense_body(mesh, factory, &[], (fibres, held)).limit()
}

/// With fibres of any added inertia through flat and distorted bricks, free, on an oblique roller or between rollers
/// along the fibres, the reported step lies between 0.95 and 1.000 of the limit of the dense matrices, and is longer
/// than without.
#[test]
fn the_reported_step_is_that_of_the_added_inertia() {
    let counts = [3, 2, 2];
    let flat = hex_box(counts, 1.0, 0.15);
    let flat = flat
        .map_positions(|x| Vec3::new(x.x, x.y, 0.15 * x.z))
        .unwrap();
    let set = |name: &str| flat.node_set(name).unwrap().to_vec();
    let oblique = Vec3::new(1.0, 0.2, -0.4);
    let free: &[(Vec<u32>, Vec3)] = &[];
    let rollers = [(set("z0"), Vec3::z()), (set("x0"), Vec3::x())];
    for (held, added) in [
        (free, 3.0),
        (&[(set("x0"), oblique)], 8.0),
        (&rollers, 3.0),
        (free, 0.5),
    ] {
        let fibres = columns_of(counts, |node| added * (1.0 + 0.1 * (node % 3) as f64));
        let truth = dense_limit(&flat, &rock(), (&fibres, held));
        let without = dense_limit(&flat, &rock(), (&[], held));
        let mut spec = Model::builder(&flat).elements("rock", rock().boxed());
        for (nodes, direction) in held {
            spec = spec.support(Support::roller(nodes.clone(), *direction));
        }
        let mut model = spec.build().unwrap();
        let first = model.stable_step(&Leapfrog).unwrap().step;
        model.set_fibres(&fibres).unwrap();
        let report = model.stable_step(&Leapfrog).unwrap();
        let share = report.step / truth;
        assert!((0.95..=1.0).contains(&share), "{added}: {share}");
        assert!(
            report.converged && truth > 1.1 * without,
            "{added}: {truth} {without}"
        );
        // Without them again, the step is that of before.
        model.set_fibres(&[]).unwrap();
        assert_eq!(model.stable_step(&Leapfrog).unwrap().step, first);
    }
}

/// A free body of fibres that spins and is strained keeps its momentum, and the moment of momentum of its inertia, to
/// rounding.
#[test]
fn momentum_is_conserved() {
    let counts = [3, 3, 2];
    for (turn, added) in [(0.0, 3.0), (0.7, 15.0)] {
        let axis = Unit::new_normalize(Vec3::new(0.2, 1.0, -0.6));
        let turn = Rotation3::from_axis_angle(&axis, turn);
        let mesh = hex_box(counts, 2.0, 0.2)
            .map_positions(|x| turn * x)
            .unwrap();
        let fibres = columns_of(counts, |node| if node % 4 == 1 { 0.0 } else { added });
        let mut model = Model::builder(&mesh)
            .elements("rock", rock().boxed())
            .build()
            .unwrap();
        model.set_fibres(&fibres).unwrap();
        let count = mesh.node_count() as u32;
        let spin = Vec3::new(0.4, -0.2, 1.0);
        let noise = random_vectors(count as usize, 0.3, 7);
        let velocity: Vec<Vec3> = (mesh.positions().iter().zip(&noise))
            .map(|(x, noise)| spin.cross(x) + noise)
            .collect();
        let still = vec![Vec3::zeros(); count as usize];
        model.set_initial(&still, &velocity).unwrap();
        let momenta = |model: &Model| {
            let mut of_node: Vec<Vec3> = (0..count)
                .map(|node| model.velocity(node) * model.mass(node))
                .collect();
            let momentum: Vec3 = of_node.iter().sum();
            for fibre in &fibres {
                let sum: f64 = fibre.nodes.iter().map(|&n| model.mass(n)).sum();
                let momenta = fibre
                    .nodes
                    .iter()
                    .map(|&n| model.velocity(n) * model.mass(n));
                let mean = momenta.sum::<Vec3>() / sum;
                for &node in &fibre.nodes {
                    let apart = model.velocity(node) - mean;
                    of_node[node as usize] += apart * (fibre.added * model.mass(node));
                }
            }
            let moment: Vec3 = (mesh.positions().iter().zip(&of_node))
                .map(|(x, p)| x.cross(p))
                .sum();
            [momentum, moment]
        };
        let before = momenta(&model);
        let step = model.stable_step(&Leapfrog).unwrap().step;
        let report = balanced_steps(&mut model, 500, StepChoice::Fixed(step));
        assert!(energy_of(&report, "added inertia") > 0.0);
        for (before, after) in before.iter().zip(momenta(&model)) {
            let error = (after - before).norm() / before.norm();
            // The rounding of 500 steps.
            assert!(error < 1e-12, "{added}: {error:e}");
        }
    }
}

/// A body with everything that acts at nodes, with fibres across its supports, dashpots, ties and prescribed motions.
pub(crate) fn with_everything(mesh: &Mesh, precision: Precision, step: f64) -> ModelSpec<'_> {
    let set = |name| mesh.node_set(name).unwrap().to_vec();
    let impedance = set("x0").into_iter().map(|node| {
        NodalImpedance::new(
            node,
            Mat3::new(3e8, 1e7, 0.0, 1e7, 2e8, 0.0, 0.0, 0.0, 1e8),
            Mat3::new(5e6, 1e6, 0.0, 1e6, 3e6, 0.0, 0.0, 0.0, 3e6),
        )
    });
    let ties = PeriodicPairs::by_translation(
        mesh,
        mesh.node_set("y0").unwrap(),
        mesh.node_set("y1").unwrap(),
        1e-9,
    );
    let corner = mesh.node_set("z1").unwrap().to_vec();
    Model::builder(mesh)
        .elements(
            "rock",
            rock().damped(5.0, 2.0 * step).precision(precision).boxed(),
        )
        .periodic(ties.unwrap())
        .support(Support::roller(set("z0"), Vec3::new(0.0, 0.1, 1.0)))
        .prescribed(Prescribed {
            nodes: set("x1"),
            direction: Vec3::new(0.3, 0.0, 1.0),
            displacement: Box::new(|t: f64| 1e-5 * (1.0 - (150.0 * t).cos())),
        })
        .load(Box::new(NodalForce::new(
            corner,
            Vec3::new(1e4, 2e3, -3e4),
            Box::new(|t: f64| (200.0 * t).sin()),
        )))
        .gravity(
            Vec3::new(0.1, 0.0, -1.0),
            Box::new(|t: f64| (50.0 * t).sin()),
        )
        .boundary(BoundaryParts::default().with_impedance(impedance))
}

/// Runs a model [with everything](with_everything), whose balance must close to rounding, with a share of an inertia that is
/// added.
pub(crate) fn assert_balanced(
    model: &mut Model,
    (integrator, step): (&dyn TimeIntegrator, f64),
    inertia: &str,
) {
    let options = RunOptions::steps(4_000)
        .with_step(StepChoice::Unchecked(step))
        .with_energy(EnergyCheck::every(100));
    let report = run(model, integrator, &options, &mut [], &mut |_| {}).unwrap();
    for name in [inertia, "mass damping", "dashpots", "prescribed motion"] {
        let energy = energy_of(&report, name);
        assert!(energy.abs() > 1e-6, "{name}: {energy}");
    }
    let residual = report.energy_residual;
    assert!(residual < 1e-12, "{inertia}: {residual:e}");
}

/// Mass damping, stiffness damping, oblique dashpots, springs, supports and prescribed motion at nodes of fibres, and
/// ties of fibres with each other: the balance closes to rounding under both schemes, with a share of the added
/// inertia.
#[test]
fn the_balance_has_the_added_inertia() {
    let counts = [4, 3, 3];
    let mesh = hex_box(counts, 1.0, 0.2);
    let step = 5e-5;
    for integrator in [&Leapfrog as &dyn TimeIntegrator, &OneSided] {
        for added in [1.0, 8.0, 100.0] {
            let mut model = with_everything(&mesh, Precision::F64, step)
                .build()
                .unwrap();
            let fibres = columns_of(counts, |node| added * (node % 5) as f64 / 4.0);
            model.set_fibres(&fibres).unwrap();
            println!("fibres with an added inertia of {added}");
            assert_balanced(&mut model, (integrator, step), "added inertia");
        }
    }
}

fn everything(threads: usize, precision: Precision) -> State {
    let counts = [9, 8, 7];
    let mesh = hex_box(counts, 1.0, 0.2);
    let mut model = with_everything(&mesh, precision, 1e-6)
        .threads(threads)
        .block_size(32)
        .build()
        .unwrap();
    model.set_fibres(&columns_of(counts, |_| 3.0)).unwrap();
    let count = mesh.node_count();
    let still = vec![Vec3::zeros(); count];
    model
        .set_initial(&random_vectors(count, 1e-6, 8), &still)
        .unwrap();
    let options = RunOptions::steps(200).with_step(StepChoice::Unchecked(1e-5));
    run(&mut model, &Leapfrog, &options, &mut [], &mut |_| {}).unwrap();
    model.state()
}

/// The same bits for 1, 2 and 4 threads, in double and in single precision.
#[test]
fn threads_do_not_change_a_bit() {
    same_bits_over_threads(everything);
}

/// A run with fibres that is resumed has the bits of one that was not interrupted; without the fibres, or with others,
/// it is refused.
#[test]
fn a_resumed_run_has_the_same_bits() {
    let counts = [4, 3, 3];
    let mesh = hex_box(counts, 1.0, 0.2);
    let build = |added: f64| {
        // These elements do not save what they have dissipated.
        let mut model = with_everything(&mesh, Precision::F64, 0.0).build().unwrap();
        model.set_fibres(&columns_of(counts, |_| added)).unwrap();
        model
    };
    let options = || {
        RunOptions::steps(60)
            .with_step(StepChoice::Unchecked(5e-5))
            .with_energy(EnergyCheck::every(7))
    };
    let go = |model: &mut Model, options: RunOptions| {
        run(model, &Leapfrog, &options, &mut [], &mut |_| {})
    };
    let mut whole = build(3.0);
    let report = go(&mut whole, options()).unwrap();
    let sink = StopAfter::new(23);
    go(&mut build(3.0), options().with_checkpoints(sink.clone())).unwrap_err();
    let saved = Arc::new(sink.saved());
    let mut resumed = build(3.0);
    let found = go(&mut resumed, options().with_resume(saved.clone())).unwrap();
    assert_eq!(whole.state(), resumed.state());
    assert_eq!(report.energies, found.energies);
    for added in [0.0, 2.0] {
        let refused = go(&mut build(added), options().with_resume(saved.clone())).unwrap_err();
        assert!(matches!(refused, RunError::State { .. }), "{refused}");
        assert!(refused.to_string().contains("fibres"), "{refused}");
    }
}

/// A free body falls with g whatever its fibres, and none of its fibres is strained: weight acts on the true mass.
#[test]
fn a_body_with_fibres_falls_with_its_true_mass() {
    let counts = [4, 2, 3];
    let mesh = hex_box(counts, 0.7, 0.2);
    let gravity = Vec3::new(1.0, -2.0, -9.0);
    for added in [0.5, 30.0] {
        let mut model = Model::builder(&mesh)
            .elements("rock", rock().boxed())
            .gravity(gravity, Box::new(|_: f64| 1.0))
            .build()
            .unwrap();
        model
            .set_fibres(&columns_of(counts, |node| added * (node % 3) as f64))
            .unwrap();
        let step = 1e-5;
        let report = balanced_steps(&mut model, 1000, StepChoice::Fixed(step));
        // Of central differences from rest, half a step after the velocity.
        let fallen = gravity * (step * step * 0.5 * 1000.0 * 1001.0);
        for node in 0..mesh.node_count() as u32 {
            let error = (model.displacement(node) - fallen).norm() / fallen.norm();
            assert!(error < 1e-12, "{added}, node {node}: {error:e}");
        }
        assert!(energy_of(&report, "added inertia") < 1e-20 * energy_of(&report, "kinetic"));
    }
}

/// Fibres of which a node does not exist or has no mass, with nodes of two joints or two of a constraint that cannot be
/// solved so, or an added inertia out of range are refused with the node, before a run; the model is as before.
#[test]
fn impossible_fibres_are_refused_by_name() {
    let mesh = hex_box([2, 2, 2], 1.0, 0.1);
    let joint = |name: &str, nodes| {
        let pair = JointPair::new(nodes, Vec3::z(), 1.0);
        Box::new(Joint::new(name, vec![pair], Frictionless).unwrap())
    };
    let mut model = Model::builder(&mesh)
        .elements("rock", rock().boxed())
        .constraint(joint("seam", [0, 26]))
        .constraint(joint("crack", [2, 8]))
        .constraint(Box::new(TiedPairs::new("tie", &[[18, 20]]).unwrap()))
        .build()
        .unwrap();
    let step = model.stable_step(&Leapfrog).unwrap().step;
    for (fibres, said) in [
        (vec![fibre_of(&[3, 99], 1.0)], "node index 99"),
        (vec![fibre_of(&[3, 4], -1.0)], "added inertia"),
        (vec![fibre_of(&[3, 4], f64::NAN)], "added inertia"),
        (
            vec![fibre_of(&[0, 5, 8], 1.0)],
            "cannot be in a fibre: a node of another joint",
        ),
        (
            vec![fibre_of(&[0, 5], 1.0), fibre_of(&[5, 8], 1.0)],
            "cannot be in a fibre: a node of another joint",
        ),
        (
            vec![fibre_of(&[0, 5], 1.0), fibre_of(&[18, 19, 20], 1.0)],
            "cannot be in a fibre: its constraint cannot be solved",
        ),
    ] {
        let refused = model.set_fibres(&fibres).unwrap_err();
        let text = format!("{refused}");
        assert!(text.contains(said), "{text}");
    }
    assert_eq!(model.stable_step(&Leapfrog).unwrap().step, step);
    model.set_fibres(&[fibre_of(&[0, 5, 26], 1.0)]).unwrap();
}

/// A model that several ranks share refuses fibres on all of them, and takes none.
#[test]
fn ranks_refuse_fibres() {
    let mesh = hex_box([6, 4, 4], 1.0, 0.1);
    let found = ThreadRanks::run(2, |ranks| {
        let spec = Model::builder(&mesh).elements("rock", rock().boxed());
        let engine = ExplicitOnRanks::new(Box::new(ranks));
        let mut model = engine.build(spec.block_size(16)).unwrap();
        Ok(model.frequencies().unwrap().fibres().is_none())
    });
    assert_eq!(found, [Ok(true), Ok(true)]);
}
