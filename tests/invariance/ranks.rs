//! Independence of the results from the number of ranks that share the blocks of a model.

use core::f64::consts::TAU;

use powerhouse::engine::{BuildModel, Leapfrog, Model, RankModel, Traffic, run};
use powerhouse::{Kernel, Material};
use powerhouse_boundary::ViscousSpring;
use powerhouse_contact::{
    BondedCoulomb, BondedCoulombParameters, Joint, JointSurface, SurfaceOptions,
};
use powerhouse_elements::{
    BoltEnd, BoltLine, BoltParameters, BoltSet, Grout, NodalForce, SolidKernel,
};
use powerhouse_material_damage::{
    ConeFit, DruckerPrager, DruckerPragerParameters, ElastoPlastic, media,
};
use powerhouse_model::{
    AbsorbingBoundary, BlockOptions, BoundarySite, Constant, EnergyCheck, Mesh, ModelSpec,
    PeriodicPairs, Precision, Prescribed, Rayleigh, RunOptions, StepChoice, Support, ThreadRanks,
    Vec3,
};
use powerhouse_tests::{elastic, oblique_waves};
use powerhouse_wavefield::WaveKind;

/// Numbers of ranks and threads of each that are compared with one rank.
const RANKS: [usize; 5] = [1, 2, 3, 4, 7];
const THREADS: [usize; 2] = [1, 2];

/// Motion of the nodes that a rank has, as bits.
type Motion = Vec<Option<[u64; 6]>>;

/// Results of a run that all ranks must agree on, as text with every digit, and the motion.
#[derive(Clone, PartialEq)]
struct Outcome {
    motion: Motion,
    report: String,
}

fn bits(displacement: Vec3, velocity: Vec3) -> [u64; 6] {
    let [u, v]: [[f64; 3]; 2] = [displacement.into(), velocity.into()];
    core::array::from_fn(|c| if c < 3 { u[c] } else { v[c - 3] }.to_bits())
}

/// Runs a model on one rank without the machinery of ranks.
fn alone(spec: ModelSpec, options: &RunOptions) -> Outcome {
    let mut model: Model = spec.threads(1).build().unwrap();
    let report = run(&mut model, &Leapfrog, options, &mut [], &mut |_| {}).unwrap();
    let nodes = 0..model.mesh().node_count() as u32;
    Outcome {
        motion: nodes
            .map(|node| Some(bits(model.displacement(node), model.velocity(node))))
            .collect(),
        report: format!("{report:?}"),
    }
}

/// Runs a model on some ranks; returns the outcome and the traffic of each.
fn on_ranks<'m>(
    spec: &(impl Fn() -> ModelSpec<'m> + Sync),
    options: &RunOptions,
    ranks: usize,
    threads: usize,
) -> Vec<(Outcome, Traffic)> {
    let found = ThreadRanks::run(ranks, |ranks| {
        let spec = spec().threads(threads);
        let nodes = 0..spec.mesh.node_count() as u32;
        let mut model = RankModel::build(spec, Box::new(ranks)).unwrap();
        let report = model.run(&Leapfrog, options, &mut [], &mut |_| {}).unwrap();
        let motion = |node| Some(bits(model.displacement(node)?, model.velocity(node)?));
        let outcome = Outcome {
            motion: nodes.map(motion).collect(),
            report: format!("{report:?}"),
        };
        Ok((outcome, model.traffic()))
    });
    found.into_iter().map(|found| found.unwrap()).collect()
}

/// Fails unless every number of ranks and threads has the bits of a run on one rank.
fn check<'m>(what: &str, spec: impl Fn() -> ModelSpec<'m> + Sync, options: &RunOptions) {
    let reference = alone(spec(), options);
    let largest = (reference.motion.iter().flatten())
        .flat_map(|motion| motion[..3].iter().map(|bits| f64::from_bits(*bits).abs()))
        .fold(0.0, f64::max);
    assert!(largest > 1e-6, "{what} does not move");
    for ranks in RANKS {
        for threads in THREADS {
            let case = format!("{what}, {ranks} ranks of {threads} threads");
            let found = on_ranks(&spec, options, ranks, threads);
            let mut present = vec![0; reference.motion.len()];
            for (rank, (found, traffic)) in found.iter().enumerate() {
                assert_eq!(found.report, reference.report, "{case}: rank {rank}");
                for (node, motion) in found.motion.iter().enumerate() {
                    if motion.is_some() {
                        present[node] += 1;
                        let expected = &reference.motion[node];
                        assert_eq!(motion, expected, "{case}: rank {rank}, node {node}");
                    }
                }
                let has_neighbours = traffic.neighbours > 0 && traffic.shared_nodes > 0;
                assert_eq!(has_neighbours, ranks > 1, "{case}: rank {rank}");
            }
            assert!(
                present.iter().all(|&count| count > 0),
                "{case}: a node is nowhere"
            );
            let shared = present.iter().filter(|&&count| count > 1).count();
            assert_eq!(shared > 0, ranks > 1, "{case}");
        }
    }
}

/// Nodes of a mesh with some property of their position.
fn nodes_where(mesh: &Mesh, is: impl Fn(&Vec3) -> bool) -> Vec<u32> {
    let positions = (0..).zip(mesh.positions());
    positions
        .filter(|(_, position)| is(position))
        .map(|(node, _)| node)
        .collect()
}

/// A distorted box of rock that fills no lane evenly.
fn rock_box(size: Vec3, cells: [usize; 3]) -> Mesh {
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), size, cells, "rock").unwrap();
    let middle = 0.5 * size;
    let inside = move |p: &Vec3| {
        let scaled = (p - middle).component_div(&middle);
        scaled.iter().map(|x| 1.0 - x * x).product::<f64>()
    };
    let wave = |p: &Vec3| Vec3::new((p.y * 0.1).sin(), (p.x * 0.09).cos(), (p.z * 0.2).sin());
    mesh.map_positions(|p| p + wave(&p) * inside(&p)).unwrap()
}

fn yielding() -> Material {
    let cone = DruckerPrager::new(DruckerPragerParameters {
        medium: media::ROCK,
        friction: 35.0,
        dilation: 10.0,
        cohesion: 1.0e5,
        fit: ConeFit::Inscribed,
    });
    ElastoPlastic::new(cone.unwrap()).into()
}

/// An absorbing boundary with input by oblique waves, loads, weight and a support on a body of an elastic and a yielding
/// part with damping proportional to mass and stiffness: the motion, the stable step and the energies have the same bits
/// for any number of ranks, in every precision.
#[test]
fn ranks_change_no_bit_of_elastic_and_yielding_bodies() {
    let size = Vec3::new(150.0, 130.0, 110.0);
    let mesh = rock_box(size, [11, 9, 8]);
    let field = oblique_waves(media::ROCK, size, &[(WaveKind::SV, 30.0)], 37.0, 0.1);
    let faces: Vec<_> = ["left", "right", "bottom"]
        .map(|face| (face, mesh.facet_set(face).unwrap()))
        .into();
    let parts = || {
        let middle = 0.5 * size;
        let site = BoundarySite::from_mesh(&mesh, &faces, |_| media::ROCK, middle, Some(&field));
        ViscousSpring::default().build(&site).unwrap()
    };
    let every = 0..mesh.element_count() as u32;
    let (inner, outer): (Vec<u32>, Vec<u32>) = every.partition(|&element| {
        let centre = mesh.centroid(element);
        (centre - 0.5 * size).norm() < 40.0
    });
    for precision in [Precision::F64, Precision::Mixed, Precision::F32] {
        let mut options = BlockOptions::default();
        options.precision = precision;
        let mut damped = options;
        damped.damping = Rayleigh {
            mass: 2.0,
            stiffness: 1e-4,
        };
        let spec = || {
            let kernel = SolidKernel::Hex8OnePoint(Default::default());
            let outside = elastic("rock", kernel, media::ROCK, options);
            let inside = Kernel::from(kernel).factory("yielding", &yielding(), damped);
            let top = nodes_where(&mesh, |p| p.z == size.z && p.x < 60.0);
            let pressing = |t: f64| 0.3 + (TAU * 12.0 * t).sin();
            let force = NodalForce::new(top, -4e6 * Vec3::z(), Box::new(pressing));
            let front = nodes_where(&mesh, |p| p.y == 0.0);
            ModelSpec::new(&mesh)
                .elements(outer.clone(), outside)
                .elements(inner.clone(), inside)
                .boundary(parts())
                .load(Box::new(force))
                .gravity(-9.81 * Vec3::z(), Box::new(Constant(1.0)))
                .support(Support::roller(front, Vec3::y()))
                .block_size(48)
        };
        let options = RunOptions::steps(60).with_energy(EnergyCheck::every(7));
        check(&format!("{precision:?}"), spec, &options);
    }
}

/// Periodic pairs of opposite faces, a prescribed motion and rollers: all nodes that move together are on the same ranks,
/// and their motion has the same bits.
#[test]
fn ranks_change_no_bit_of_ties_and_prescribed_motions() {
    let size = Vec3::new(12.0, 8.0, 6.0);
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), size, [12, 8, 6], "rock").unwrap();
    let spec = || {
        let face = |name: &str| mesh.nodes_of_set(name).unwrap();
        let (left, right) = (face("left"), face("right"));
        let pairs = PeriodicPairs::by_translation(&mesh, &left, &right, 1e-6).unwrap();
        let within = |p: &Vec3| p.x > 0.0 && p.x < size.x;
        let motion = Prescribed {
            nodes: nodes_where(&mesh, |p| p.z == 0.0 && within(p)),
            direction: Vec3::new(0.0, 0.6, 0.8),
            displacement: Box::new(|t: f64| 1e-3 * (TAU * 90.0 * t).sin()),
        };
        let mut options = BlockOptions::default();
        options.damping.mass = 3.0;
        let rock = elastic("rock", SolidKernel::Hex8Full, media::ROCK, options);
        let back = nodes_where(&mesh, |p| p.y == size.y && p.z > 0.0 && within(p));
        ModelSpec::new(&mesh)
            .elements("rock", rock)
            .periodic(pairs)
            .prescribed(motion)
            .support(Support::roller(back, Vec3::y()))
            .block_size(24)
    };
    let options = RunOptions::steps(80).with_energy(EnergyCheck::every(10));
    check("tied and prescribed", spec, &options);
}

/// A joint that opens and slips between two halves, with bolts across it, tied and in grout: node pairs and bolts have
/// the same bits wherever the border between ranks is.
#[test]
fn ranks_change_no_bit_of_joints_and_bolts() {
    let size = Vec3::new(8.0, 6.0, 12.0);
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), size, [8, 6, 12], "rock").unwrap();
    let every = || 0..mesh.element_count() as u32;
    let half = |below: bool| -> Vec<u32> {
        let is = |element: &u32| (mesh.centroid(*element).z < 6.0) == below;
        every().filter(is).collect()
    };
    let split = mesh.split_between(&half(true), &half(false)).unwrap();
    let options = SurfaceOptions::within(1e-6).unwrap();
    let surface =
        JointSurface::between(&split.mesh, &split.first, &split.second, &options).unwrap();
    let all: Vec<u32> = every().collect();
    let set = |name: &str, x: f64, grout: Option<Grout>| {
        let line = |i: u32| {
            let head = Vec3::new(x + 0.3 * f64::from(i), 0.7 + 0.9 * f64::from(i), 4.3);
            BoltLine {
                head,
                toe: head + Vec3::new(0.5, 0.3, 4.0),
            }
        };
        let lines: Vec<BoltLine> = (0..5).map(line).collect();
        let parameters = BoltParameters {
            pretension: if grout.is_some() { 0.0 } else { 2.0e4 },
            yield_force: 3.0e4,
            grout,
            ..BoltParameters::steel(0.03).unwrap()
        };
        BoltSet::new(name, &split.mesh, &all, &lines, parameters).unwrap()
    };
    let grout = Grout {
        stiffness: 1.0e8,
        strength: 1.0e4,
        head: BoltEnd::Anchored,
        toe: BoltEnd::Free,
    };
    let bolts = [set("tied", 0.5, None), set("grouted", 5.0, Some(grout))];
    let spec = || {
        let law = BondedCoulomb::new(BondedCoulombParameters {
            cohesion: 2e4,
            tensile_strength: 1e4,
            static_friction: 0.6,
            dynamic_friction: 0.4,
            cohesion_loss: true,
        });
        let joint = Joint::new("joint", surface.pairs.clone(), law.unwrap()).unwrap();
        let level = |z: f64| nodes_where(&split.mesh, |p| p.z == z);
        let force = |direction: Vec3, constant: f64, frequency: f64| {
            let history = move |t: f64| constant + (TAU * frequency * t).sin();
            Box::new(NodalForce::new(level(12.0), direction, Box::new(history)))
        };
        // On one side a support across the joint connects the directions of its pairs.
        let edge = nodes_where(&split.mesh, |p| p.x == 0.0 && p.z == 6.0);
        let oblique = Vec3::new(1.0, 0.5, 0.2).normalize();
        let kernel = SolidKernel::Hex8OnePoint(Default::default());
        let rock = elastic("rock", kernel, media::ROCK, BlockOptions::default());
        ModelSpec::new(&split.mesh)
            .elements("rock", rock)
            .support(Support::fixed(level(0.0)))
            .support(Support::roller(edge, oblique))
            .load(force(-5e4 * Vec3::z(), 0.6, 60.0))
            .load(force(Vec3::new(6e4, 2e4, 0.0), 0.0, 45.0))
            .constraint(Box::new(joint))
            .embed(Box::new(bolts[0].clone()))
            .embed(Box::new(bolts[1].clone()))
            .block_size(32)
    };
    let options = RunOptions::steps(300)
        .with_step(StepChoice::Fixed(1e-4))
        .with_energy(EnergyCheck::every(20));
    let mut model = spec().build().unwrap();
    run(&mut model, &Leapfrog, &options, &mut [], &mut |_| {}).unwrap();
    let mut joints = model.joints();
    let slips = joints.any(|joint| joint.records.iter().any(|r| r.first_slip.is_some()));
    assert!(slips, "nothing slips");
    drop(joints);
    check("a joint with bolts", spec, &options);
}
