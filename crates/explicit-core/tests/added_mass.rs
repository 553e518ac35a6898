//! Added mass of nodes: the motion and the stable step that it gives, its energy, joints, fibres, and bits.

use std::sync::Arc;

use nalgebra::{Rotation3, Unit};
use powerhouse_contact::{Frictionless, Joint, Tied};
use powerhouse_elements::NodalForce;
use powerhouse_explicit_core::{BuildModel, ExplicitOnRanks, Leapfrog, Model, OneSided, run};
use powerhouse_model::{
    AddedMass, ContactLaw, ElementKind, EnergyCheck, Engine, EngineError, JointPair, Mat3, Mesh,
    ModelError, ModelSpec, Precision, RunOptions, State, StaticOptions, StepChoice, Support,
    ThreadRanks, TimeIntegrator, Vec3,
};

use crate::fibres::{assert_balanced, columns_of, dense_body, rock, with_everything};
use crate::support::{
    Links, StopAfter, balanced_steps, energy_of, fibre_of, hex_box, random_vectors,
    same_bits_over_threads,
};

/// Added masses (kg) of nodes, each along one direction of its own, or along two.
fn masses(nodes: impl Iterator<Item = u32>, size: f64, seed: u64) -> Vec<AddedMass> {
    let of_node = |node: u32| {
        let [first, second] = [0, 1].map(|k| {
            let along = random_vectors(1, 1.0, seed + 7 * u64::from(node) + k)[0].normalize();
            along * along.transpose()
        });
        let both = if node.is_multiple_of(3) { 0.4 } else { 0.0 };
        let size = size * (1.0 + 0.2 * f64::from(node % 4));
        AddedMass::new(node, (first + second * both) * size)
    };
    nodes.map(of_node).collect()
}

fn masses_of_set(mesh: &Mesh, set: &str, size: f64, seed: u64) -> Vec<AddedMass> {
    masses(mesh.node_set(set).unwrap().iter().copied(), size, seed)
}

/// A body with added masses in every direction, oblique supports and fibres moves in its lowest, highest and some other mode
/// of the dense matrices as central differences make it, to rounding, and as much when all of it is turned; the reported
/// step is that of the dense matrices.
#[test]
fn a_mode_moves_as_the_dense_matrices_say() {
    let counts = [1, 2, 1];
    for (turn, size, fibre) in [
        (0.0, 900.0, 0.0),
        (0.9, 40.0, 0.0),
        (0.0, 2e4, 5.0),
        (-1.3, 300.0, 30.0),
    ] {
        let axis = Unit::new_normalize(Vec3::new(0.2, 1.0, -0.6));
        let turn = Rotation3::from_axis_angle(&axis, turn);
        let mesh = hex_box(counts, 1.0, 0.2)
            .map_positions(|x| turn * Vec3::new(x.x, 0.7 * x.y, 0.4 * x.z))
            .unwrap();
        let turned =
            |added: AddedMass| AddedMass::new(added.node, turn * added.mass * turn.inverse());
        let water: Vec<AddedMass> = masses([0, 3, 4, 7, 8, 10].into_iter(), size, 11)
            .into_iter()
            .map(turned)
            .map(|added| AddedMass::new(added.node, 0.5 * (added.mass + added.mass.transpose())))
            .collect();
        let fibres = if fibre > 0.0 {
            columns_of(counts, |node| if node == 2 { 0.0 } else { fibre })
        } else {
            Vec::new()
        };
        let held = [
            (vec![0, 1], turn * Vec3::new(1.0, 0.2, -0.4)),
            (vec![5], turn * Vec3::y()),
        ];
        let dense = dense_body(&mesh, &rock(), &water, (&fibres, &held));
        let mut spec = Model::builder(&mesh).elements("rock", rock().boxed());
        for (nodes, direction) in &held {
            spec = spec.support(Support::roller(nodes.clone(), *direction));
        }
        let mut model = spec.added_masses(water).build().unwrap();
        model.set_fibres(&fibres).unwrap();
        let step = model.stable_step(&Leapfrog).unwrap();
        assert!(step.converged);
        let share = step.step / (0.98 * dense.limit());
        assert!((0.995..=1.000_001).contains(&share), "{share}");
        let modes = dense.modes();
        let start = model.state();
        // Three supports leave three motions without strain.
        for index in [3, 5, modes.len() / 2, modes.len() - 1] {
            let (frequency, shape) = &modes[index];
            let size = shape.iter().map(Vec3::norm).fold(0.0, f64::max);
            let shape: Vec<Vec3> = shape.iter().map(|u| u * (1e-3 / size)).collect();
            let angle = 2.0 * (0.5 * frequency * step.step).asin();
            let before = (1.0 - angle.cos()) / step.step;
            let velocity: Vec<Vec3> = shape.iter().map(|u| u * before).collect();
            model.set_state(&start).unwrap();
            model.set_initial(&shape, &velocity).unwrap();
            let report = balanced_steps(&mut model, 200, StepChoice::Fixed(step.step));
            assert!(report.energy_residual < 1e-11, "{}", report.energy_residual);
            assert!(energy_of(&report, "added mass") >= 0.0);
            for (node, shape) in (0..).zip(&shape) {
                let exact = shape * (200.0 * angle).cos();
                let error = (model.displacement(node) - exact).norm();
                assert!(error < 1e-11, "mode {index}, node {node}: {error:e}");
            }
        }
    }
}

/// With added masses, fibres and supports of a body of many nodes the reported step lies between 0.975 and 0.98 times the
/// limit of the dense matrices, and is no shorter than without.
#[test]
fn the_reported_step_is_that_of_the_added_mass() {
    let counts = [3, 2, 2];
    let mesh = hex_box(counts, 1.0, 0.15);
    let every = 0..mesh.node_count() as u32;
    let held = [(
        mesh.node_set("z0").unwrap().to_vec(),
        Vec3::new(0.3, 0.0, 1.0),
    )];
    for (water, fibre) in [
        (masses_of_set(&mesh, "x1", 3e3, 5), 0.0),
        (masses(every, 700.0, 9), 0.0),
        (masses_of_set(&mesh, "y0", 1e5, 5), 8.0),
    ] {
        let fibres = columns_of(counts, |_| fibre);
        let limit =
            |water: &[AddedMass]| dense_body(&mesh, &rock(), water, (&fibres, &held)).limit();
        let step = |water: &[AddedMass]| {
            let mut model = Model::builder(&mesh)
                .elements("rock", rock().boxed())
                .support(Support::roller(held[0].0.clone(), held[0].1))
                .added_masses(water.iter().copied())
                .build()
                .unwrap();
            model.set_fibres(&fibres).unwrap();
            model.stable_step(&Leapfrog).unwrap().step
        };
        let share = step(&water) / limit(&water);
        assert!((0.975..=0.980_001).contains(&share), "{share}");
        assert!(step(&water) >= 0.995 * step(&[]));
    }
}

/// Along the direction in which all nodes have added mass in proportion to their own a free body falls more slowly by that
/// share, across it with g: weight acts on the mass of the elements alone.
#[test]
fn added_mass_has_inertia_and_no_weight() {
    let mesh = hex_box([4, 2, 3], 0.7, 0.2);
    let gravity = Vec3::new(1.0, -2.0, -9.0);
    for along in [Vec3::z(), Vec3::new(0.3, -0.5, 0.8).normalize()] {
        let plain = Model::builder(&mesh)
            .elements("rock", rock().boxed())
            .build()
            .unwrap();
        let normal = along * along.transpose();
        let water = (0..mesh.node_count() as u32)
            .map(|node| AddedMass::new(node, normal * (1.7 * plain.mass(node))));
        let mut model = Model::builder(&mesh)
            .elements("rock", rock().boxed())
            .gravity(gravity, Box::new(|_: f64| 1.0))
            .added_masses(water)
            .build()
            .unwrap();
        let report = balanced_steps(&mut model, 1000, StepChoice::Fixed(1e-5));
        let slowed = gravity - normal * gravity * (1.7 / 2.7);
        let fallen = slowed * (1e-10 * 0.5 * 1000.0 * 1001.0);
        for node in 0..mesh.node_count() as u32 {
            let error = (model.displacement(node) - fallen).norm() / fallen.norm();
            assert!(error < 1e-12, "node {node}: {error:e}");
        }
        let velocity = slowed * (1e-5 * 1000.5);
        let total: f64 = (0..mesh.node_count() as u32)
            .map(|node| model.mass(node))
            .sum();
        let exact = 0.5 * 1.7 * total * along.dot(&velocity).powi(2);
        let found = energy_of(&report, "added mass");
        assert!((found / exact - 1.0).abs() < 1e-2, "{found} {exact}");
    }
}

/// A body under its weight rests at the same bits with added mass and without.
#[test]
fn equilibrium_does_not_feel_it() {
    let mesh = hex_box([3, 2, 4], 1.0, 0.2);
    let rest = |water: Vec<AddedMass>| {
        let mut model = Model::builder(&mesh)
            .elements("rock", rock().boxed())
            .support(Support::fixed(mesh.node_set("z0").unwrap().to_vec()))
            .gravity(Vec3::new(0.0, 0.0, -9.81), Box::new(|_: f64| 1.0))
            .added_masses(water)
            .build()
            .unwrap();
        let options = StaticOptions::default();
        model.equilibrate(&options, &mut |_| {}).unwrap();
        model.state()
    };
    let without = rest(Vec::new());
    let with = rest(masses_of_set(&mesh, "x1", 5e4, 3));
    let sizes = without.displacement.iter().map(Vec3::norm);
    let most = sizes.fold(0.0, f64::max);
    assert!(most > 0.0);
    for (a, b) in without.displacement.iter().zip(&with.displacement) {
        assert!((a - b).norm() < 1e-12 * most);
    }
}

/// A body with everything that acts at nodes but joints, and added masses at most of these.
fn everything<'a>(mesh: &'a Mesh, precision: Precision, step: f64) -> ModelSpec<'a> {
    let sets = ["x0", "x1", "y0", "y1", "z0", "z1"];
    let water = (1..).zip(sets);
    let water = water.flat_map(|(seed, set)| masses_of_set(mesh, set, 800.0, seed));
    with_everything(mesh, precision, step).added_masses(water.collect::<Vec<_>>())
}

/// Mass damping, stiffness damping, oblique dashpots, springs, supports, prescribed motion, ties and fibres at nodes with
/// added mass: the balance closes to rounding under both schemes, with a share of the added mass.
#[test]
fn the_balance_has_the_added_mass() {
    let counts = [4, 3, 3];
    let mesh = hex_box(counts, 1.0, 0.2);
    let step = 5e-5;
    for integrator in [&Leapfrog as &dyn TimeIntegrator, &OneSided] {
        for fibre in [0.0, 8.0] {
            let mut model = everything(&mesh, Precision::F64, step).build().unwrap();
            model.set_fibres(&columns_of(counts, |_| fibre)).unwrap();
            println!("fibres with an added inertia of {fibre}");
            assert_balanced(&mut model, (integrator, step), "added mass");
        }
    }
}

/// The same bits for 1, 2 and 4 threads, in double and in single precision.
#[test]
fn threads_do_not_change_a_bit() {
    same_bits_over_threads(|threads, precision| {
        let mesh = hex_box([9, 8, 7], 1.0, 0.2);
        let mut model = everything(&mesh, precision, 1e-6)
            .threads(threads)
            .block_size(32)
            .build()
            .unwrap();
        let options = RunOptions::steps(200).with_step(StepChoice::Unchecked(1e-5));
        run(&mut model, &Leapfrog, &options, &mut [], &mut |_| {}).unwrap();
        model.state()
    });
}

/// On 2 and 3 ranks motion, stable step and energies have the bits of one; ranks whose added masses differ are refused.
#[test]
fn ranks_do_not_change_a_bit() {
    let mesh = hex_box([6, 4, 4], 1.0, 0.2);
    let options = || {
        RunOptions::steps(100)
            .with_step(StepChoice::Unchecked(1e-5))
            .with_energy(EnergyCheck::every(10).with_by_set(false))
    };
    let spec = || everything(&mesh, Precision::F64, 1e-6).block_size(16);
    let mut alone = spec().build().unwrap();
    let step = alone.stable_step(&Leapfrog).unwrap().step;
    let report = run(&mut alone, &Leapfrog, &options(), &mut [], &mut |_| {}).unwrap();
    let whole: (State, _) = (alone.state(), report.energies);
    for count in [2, 3] {
        let found = ThreadRanks::run(count, |ranks| {
            let engine = ExplicitOnRanks::new(Box::new(ranks));
            let mut model = engine.build(spec()).unwrap();
            let step = model.stable_step(&Leapfrog).unwrap().step;
            let report = model.run(&Leapfrog, &options(), &mut [], &mut |_| {});
            let report = report.map_err(|failure| failure.error).unwrap();
            Ok((step, (model.stateful().unwrap().state(), report.energies)))
        });
        for of_rank in found {
            assert_eq!(of_rank.unwrap(), (step, whole.clone()), "{count} ranks");
        }
    }
    let refused = ThreadRanks::run(2, |ranks| {
        let more = powerhouse_model::Ranks::rank(&ranks) as f64;
        let own = [AddedMass::new(3, Mat3::identity() * more)];
        let engine = ExplicitOnRanks::new(Box::new(ranks));
        Ok(engine
            .build(spec().added_masses(own))
            .err()
            .unwrap()
            .to_string())
    });
    for error in refused {
        let error = error.unwrap();
        assert!(error.contains("specification of the model"), "{error}");
    }
}

/// A run that is resumed has the bits of one that was not interrupted.
#[test]
fn a_resumed_run_has_the_same_bits() {
    let mesh = hex_box([4, 3, 3], 1.0, 0.2);
    let build = || everything(&mesh, Precision::F64, 0.0).build().unwrap();
    let options = || {
        RunOptions::steps(60)
            .with_step(StepChoice::Unchecked(5e-5))
            .with_energy(EnergyCheck::every(7))
    };
    let go = |model: &mut Model, options: RunOptions| {
        run(model, &Leapfrog, &options, &mut [], &mut |_| {})
    };
    let mut whole = build();
    let report = go(&mut whole, options()).unwrap();
    let sink = StopAfter::new(23);
    go(&mut build(), options().with_checkpoints(sink.clone())).unwrap_err();
    let mut resumed = build();
    let found = go(&mut resumed, options().with_resume(Arc::new(sink.saved()))).unwrap();
    assert_eq!(whole.state(), resumed.state());
    assert_eq!(report.energies, found.energies);
}

/// Two bars with their ends at one place, and water at these.
fn parted_bar(along: Vec3) -> Mesh {
    let mut builder = Mesh::builder();
    for (tag, place) in (1..).zip([0.0, 1.0, 1.0, 1.6]) {
        builder.node(tag, along * place);
    }
    builder.element(1, ElementKind::Bar2, &[1, 2], &["bar"]);
    builder.element(2, ElementKind::Bar2, &[3, 4], &["bar"]);
    builder.build().unwrap()
}

/// A joint sees nodes with their added mass: a tie of two bars moves as one node with the sum of both would, to rounding, and
/// a closing pair without friction is left with the velocity that the impulse along its normal gives two mass matrices, in
/// any direction. Its impact is in the balance.
#[test]
fn joints_see_the_mass_matrix() {
    let links = || Links::new("bar", ElementKind::Bar2, 9.0e9, 0.5, 2700.0).boxed();
    for along in [Vec3::x(), Vec3::new(0.3, -0.5, 0.8).normalize()] {
        let mesh = parted_bar(along);
        let water = masses([1, 2].into_iter(), 3e3, 21);
        let model = |law: bool| {
            let pair = || vec![JointPair::new([1, 2], along, 0.5)];
            fn joint<L: ContactLaw + 'static>(pairs: Vec<JointPair>, law: L) -> Joint<L> {
                Joint::new("seam", pairs, law).unwrap()
            }
            let spec = Model::builder(&mesh)
                .elements("bar", links())
                .added_masses(water.iter().copied());
            if law {
                spec.constraint(Box::new(joint(pair(), Frictionless)))
            } else {
                spec.constraint(Box::new(joint(pair(), Tied)))
            }
        };
        let still = vec![Vec3::zeros(); 4];
        let step = 1e-5;

        let mut closing = model(true).build().unwrap();
        let side = Vec3::new(0.2, 0.4, -0.1);
        let speeds = [
            along,
            along * 0.7 + side,
            along * -0.3 - side,
            Vec3::zeros(),
        ];
        closing.set_initial(&still, &speeds).unwrap();
        let [first, second] = [0, 1].map(|index| {
            let own = closing.mass([1, 2][index]);
            Mat3::identity() * own + water[index].mass
        });
        let [p, q] = [first, second].map(|mass| mass.try_inverse().unwrap());
        let impulse = along.dot(&(speeds[1] - speeds[2])) / along.dot(&((p + q) * along));
        let report = balanced_steps(&mut closing, 1, StepChoice::Unchecked(step));
        for (node, expected) in [
            (1, speeds[1] - p * along * impulse),
            (2, speeds[2] + q * along * impulse),
        ] {
            let error = (closing.velocity(node) - expected).norm();
            assert!(error < 1e-12, "{node}: {error:e}");
        }
        assert!(energy_of(&report, "added mass") > 0.0);
        assert!(report.energy_residual < 1e-12, "{}", report.energy_residual);

        let mut tied = model(false).build().unwrap();
        let speeds = [along, side, side, -along];
        tied.set_initial(&still, &speeds).unwrap();
        let report = balanced_steps(&mut tied, 300, StepChoice::Unchecked(step));
        assert!(report.energy_residual < 1e-12, "{}", report.energy_residual);
        let mut one = Mesh::builder();
        for (tag, place) in (1..).zip([0.0, 1.0, 1.6]) {
            one.node(tag, along * place);
        }
        one.element(1, ElementKind::Bar2, &[1, 2], &["bar"]);
        one.element(2, ElementKind::Bar2, &[2, 3], &["bar"]);
        let one = one.build().unwrap();
        let both = AddedMass::new(1, water[0].mass + water[1].mass);
        let mut one = Model::builder(&one)
            .elements("bar", links())
            .added_masses([both])
            .build()
            .unwrap();
        let speeds = [along, side, -along];
        one.set_initial(&still[..3], &speeds).unwrap();
        balanced_steps(&mut one, 300, StepChoice::Unchecked(step));
        for (node, same) in [(0, 0), (1, 1), (2, 1), (3, 2)] {
            let error = (tied.displacement(node) - one.displacement(same)).norm();
            assert!(error < 1e-14, "{node}: {error:e}");
        }
    }
}

/// Masses that no node can have are refused with the node: of a node that does not exist or has no elements, not symmetric,
/// negative in a direction, or not finite; masses of one node add up, and one of zero changes no bit.
#[test]
fn impossible_masses_are_refused_by_name() {
    let mesh = hex_box([2, 1, 1], 1.0, 0.0);
    let spec = || Model::builder(&mesh).elements("rock", rock().boxed());
    let refusal = |spec: ModelSpec| match spec.build().unwrap_err() {
        ModelError::Refused { source, .. } => *source.downcast::<EngineError>().unwrap(),
        other => panic!("{other}"),
    };
    let refused = |added: AddedMass| refusal(spec().added_masses([added]));
    let shape = "it is not symmetric and positive semi-definite";
    for mass in [
        Mat3::identity() * -1.0,
        Mat3::new(1.0, 2.0, 0.0, 2.0, 1.0, 0.0, 0.0, 0.0, 1.0),
        Mat3::new(3.0, 1.0, 0.0, 0.0, 3.0, 0.0, 0.0, 0.0, 3.0),
        Mat3::identity() * f64::NAN,
        Mat3::identity() * f64::INFINITY,
    ] {
        let (node, reason) = (5, shape);
        assert_eq!(
            refused(AddedMass::new(4, mass)),
            EngineError::AddedMass { node, reason }
        );
    }
    let unknown = refused(AddedMass::new(77, Mat3::identity()));
    assert!(
        matches!(unknown, EngineError::UnknownNode { node: 77, .. }),
        "{unknown}"
    );
    let mut state = State::at_rest(mesh.node_count());
    state.absent = vec![1];
    let absent = mesh
        .nodes_of(1)
        .iter()
        .find(|node| !mesh.nodes_of(0).contains(node));
    let absent = *absent.unwrap();
    let water = AddedMass::new(absent, Mat3::identity());
    let (node, reason) = (
        mesh.node_tags()[absent as usize],
        "it has no active elements",
    );
    assert_eq!(
        refusal(spec().start(state).added_masses([water])),
        EngineError::AddedMass { node, reason }
    );

    let end = |water: &[AddedMass]| {
        let far = vec![(mesh.node_count() - 1) as u32];
        let push = NodalForce::new(far, Vec3::new(1e4, 2e4, 3e4), Box::new(|_: f64| 1.0));
        let mut model = spec()
            .load(Box::new(push))
            .added_masses(water.iter().copied())
            .build()
            .unwrap();
        model.set_fibres(&[fibre_of(&[0, 1], 2.0)]).unwrap();
        balanced_steps(&mut model, 50, StepChoice::Unchecked(1e-5));
        model.state()
    };
    assert_eq!(end(&[]), end(&[AddedMass::new(3, Mat3::zeros())]));
    let own = Mat3::identity() * 300.0;
    let parts = [1.0, 3.0].map(|part| AddedMass::new(3, own * part));
    assert_eq!(end(&[AddedMass::new(3, own * 4.0)]), end(&parts));
    assert_ne!(end(&[]), end(&parts));
}
