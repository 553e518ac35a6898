//! Independence of the results from blocks: their size, the threads that share them, and their order.

use core::f64::consts::TAU;

use powerhouse::engine::{BuildModel, Leapfrog, Model, run};
use powerhouse_contact::{
    BondedCoulomb, BondedCoulombParameters, Joint, JointSurface, SurfaceOptions,
};
use powerhouse_elements::{
    BoltEnd, BoltLine, BoltParameters, BoltSet, Grout, NodalForce, SolidKernel,
};
use powerhouse_material_damage::media;
use powerhouse_model::{BlockOptions, EnergyCheck, Mesh, RunOptions, StepChoice, Support, Vec3};
use powerhouse_tests::elastic;

/// Two halves of a block of rock with a joint between them, and bolts across the joint: two sets, one tied to the
/// rock, one in grout, that have no node in common.
struct Body {
    mesh: Mesh,
    surface: JointSurface,
    bolts: [BoltSet; 2],
}

impl Body {
    fn new() -> Self {
        let size = Vec3::new(12.0, 12.0, 24.0);
        let mesh = Mesh::box_of_hexes(Vec3::zeros(), size, [12, 12, 24], "rock").unwrap();
        let half = |below: bool| -> Vec<u32> {
            let all = 0..mesh.element_count() as u32;
            all.filter(|&e| (mesh.centroid(e).z < 12.0) == below)
                .collect()
        };
        let split = mesh.split_between(&half(true), &half(false)).unwrap();
        let options = SurfaceOptions::within(1e-6).unwrap();
        let sides = (&split.first, &split.second);
        let surface = JointSurface::between(&split.mesh, sides.0, sides.1, &options).unwrap();
        let all: Vec<u32> = (0..split.mesh.element_count() as u32).collect();
        let set = |name: &str, x: f64, grout: Option<Grout>| {
            let line = |i: usize| {
                let at = f64::from(i as u32);
                let head = Vec3::new(x + 0.3 * at, 0.7 + 1.3 * (at % 8.0), 9.0 + 0.4 * at);
                BoltLine {
                    head,
                    toe: head + Vec3::new(0.5, 0.3, 5.0),
                }
            };
            let lines: Vec<BoltLine> = (0..10).map(line).collect();
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
        let bolts = [set("tied", 0.5, None), set("grouted", 7.5, Some(grout))];
        Self {
            surface,
            bolts,
            mesh: split.mesh,
        }
    }

    /// The body on its base, pressed and shaken from above.
    fn model(&self, block_size: usize, threads: usize, backwards: bool) -> Model {
        let law = BondedCoulomb::new(BondedCoulombParameters {
            cohesion: 2e4,
            tensile_strength: 1e4,
            static_friction: 0.6,
            dynamic_friction: 0.4,
            cohesion_loss: true,
        });
        let joint = Joint::new("joint", self.surface.pairs.clone(), law.unwrap()).unwrap();
        let level = |z: f64| -> Vec<u32> {
            let at = |node: &u32| self.mesh.positions()[*node as usize].z == z;
            (0..self.mesh.node_count() as u32).filter(at).collect()
        };
        let force = |direction: Vec3, constant: f64, frequency: f64| {
            let history = move |t: f64| constant + (TAU * frequency * t).sin();
            Box::new(NodalForce::new(level(24.0), direction, Box::new(history)))
        };
        let kernel = SolidKernel::Hex8OnePoint(Default::default());
        let rock = elastic("rock", kernel, media::ROCK, BlockOptions::default());
        let mut spec = Model::builder(&self.mesh)
            .elements("rock", rock)
            .support(Support::fixed(level(0.0)))
            .load(force(-5e4 * Vec3::z(), 0.6, 60.0))
            .load(force(Vec3::new(6e4, 2e4, 0.0), 0.0, 45.0))
            .constraint(Box::new(joint))
            .threads(threads)
            .block_size(block_size);
        let mut order = [0, 1];
        if backwards {
            order.reverse();
        }
        for set in order {
            spec = spec.embed(Box::new(self.bolts[set].clone()));
        }
        spec.build().unwrap()
    }

    fn outcome(&self, block_size: usize, threads: usize, backwards: bool) -> Outcome {
        let mut model = self.model(block_size, threads, backwards);
        let options = RunOptions::steps(600)
            .with_step(StepChoice::Fixed(1e-4))
            .with_energy(EnergyCheck::every(20));
        let report = run(&mut model, &Leapfrog, &options, &mut [], &mut |_| {}).unwrap();
        let slid = |r: &powerhouse_model::JointRecord| r.first_slip.is_some();
        let mut joints = model.joints();
        let slips = joints.any(|joint| joint.records.iter().any(slid));
        drop(joints);
        assert!(slips, "nothing slips");
        let state = model.state();
        let forces = self.bolts.iter();
        let forces = forces.flat_map(|bolts| bolts.axial_forces(&state).unwrap());
        Outcome {
            motion: (state.displacement.iter().chain(&state.velocity))
                .flat_map(|v| [v.x, v.y, v.z])
                .collect(),
            forces: forces.collect(),
            energies: report.energies.iter().map(|(_, energy)| *energy).collect(),
        }
    }
}

/// Motion of all nodes, axial forces of the bolts bolt by bolt, and the energies at the end.
#[derive(Debug)]
struct Outcome {
    motion: Vec<f64>,
    forces: Vec<f64>,
    energies: Vec<f64>,
}

impl Outcome {
    fn bits(&self) -> Vec<u64> {
        let all = [&self.motion[..], &self.forces, &self.energies];
        all.concat().into_iter().map(f64::to_bits).collect()
    }
    /// Largest difference of each of the three over the largest value.
    fn difference(&self, other: &Self) -> f64 {
        let pairs = [
            (&self.motion, &other.motion),
            (&self.forces, &other.forces),
            (&self.energies, &other.energies),
        ];
        let of = |(a, b): (&Vec<f64>, &Vec<f64>)| {
            assert_eq!(a.len(), b.len());
            let largest = a.iter().fold(0.0_f64, |most, a| most.max(a.abs()));
            let gaps = a.iter().zip(b).map(|(a, b)| (a - b).abs());
            gaps.fold(0.0, f64::max) / largest
        };
        pairs.into_iter().map(of).fold(0.0, f64::max)
    }
}

/// For blocks of any size one, two and four threads give the same bits of motion, bolts and energies; equal blocks, the same bits;
/// blocks of different sizes, the same results to rounding.
#[test]
fn threads_change_no_bit_for_any_size_of_blocks() {
    let body = Body::new();
    let reference = body.outcome(16_384, 1, false);
    assert_eq!(reference.bits(), body.outcome(5000, 1, false).bits());
    for size in [64, 512, 2048, 16_384] {
        let one = body.outcome(size, 1, false);
        let difference = reference.difference(&one);
        assert!(difference < 1e-9, "blocks of {size}: {difference:e}");
        for threads in [2, 4] {
            let other = body.outcome(size, threads, false);
            assert_eq!(
                one.bits(),
                other.bits(),
                "blocks of {size}, {threads} threads"
            );
        }
    }
}

/// Bolts are in blocks beside those of their hosts: one for each set and each block that has heads of its bolts.
#[test]
fn bolts_have_a_block_for_each_host_block() {
    let body = Body::new();
    for size in [64, 512, 16_384] {
        let model = body.model(size, 1, false);
        let mut wanted = Vec::new();
        for bolts in &body.bolts {
            let heads = (0..bolts.len()).map(|bolt| bolts.segments(bolt).next().unwrap().element);
            let block_of = |head: u32| {
                let mut blocks = model.partition().blocks.iter();
                blocks
                    .position(|block| block.elements.contains(&head))
                    .unwrap() as u32
            };
            let mut hosts: Vec<u32> = heads.map(block_of).collect();
            hosts.sort_unstable();
            hosts.dedup();
            wanted.extend(
                hosts
                    .into_iter()
                    .map(|host| (bolts.name().to_string(), Some(host))),
            );
        }
        let found = model.embedded_hosts();
        let found: Vec<_> = found
            .map(|(label, host)| (label.to_string(), host))
            .collect();
        assert_eq!(found, wanted);
        assert!(size > 64 || found.len() >= 6, "{}", found.len());
    }
}

/// The order of blocks that have no node in common changes no bit of the motion, and none of the sums over all blocks.
#[test]
fn the_order_of_blocks_changes_no_sum() {
    let body = Body::new();
    for size in [64, 16_384] {
        let forwards = body.outcome(size, 2, false);
        let backwards = body.outcome(size, 2, true);
        assert_eq!(forwards.bits(), backwards.bits(), "blocks of {size}");
        assert!(forwards.energies.iter().any(|energy| *energy > 0.0));
    }
}
