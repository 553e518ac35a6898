//! Bays whose core yields or cracks: where nothing changes along y they move as slices do.

use powerhouse_boundary::ViscousSpring;
use powerhouse_elements::{AnyLaw, SolidKernel};
use powerhouse_explicit_core::{BuildModel, Leapfrog, Model, run};
use powerhouse_material_damage::LinearElastic;
use powerhouse_model::{
    AbsorbingBoundary, BlockOptions, BoundarySite, DelayedPairs, EnergyCheck, Mesh, ModelSpec,
    RunOptions, StepChoice, TimeIntegrator, Vec3,
};
use powerhouse_wavefield::WaveKind;

use super::{brittle, pairs, rock, slowness, wave, yielding};
use crate::support::apart;

/// What the core is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Core {
    Rock,
    Yielding,
    Brittle,
}

impl Core {
    fn law(self) -> AnyLaw {
        match self {
            Self::Rock => LinearElastic::new(rock()).into(),
            Self::Yielding => yielding(),
            Self::Brittle => brittle(1.5e-5),
        }
    }
}

/// A section of ground with a core of 30 m x 20 m under an SV wave.
pub(super) fn spec(mesh: &Mesh, angles: [f64; 2], core: Core) -> ModelSpec<'_> {
    let field = wave(WaveKind::SV, angles, (8.0, 0.25));
    let s = slowness(WaveKind::SV, angles);
    let faces = ["left", "right", "bottom"].map(|face| (face, mesh.facet_set(face).unwrap()));
    let site = BoundarySite::from_mesh(mesh, &faces, |_| rock(), Vec3::zeros(), Some(&field));
    let parts = ViscousSpring::default()
        .build(&site.with_slowness(s))
        .unwrap();
    let (low, high) = (Vec3::new(-15.0, -9e9, -40.0), Vec3::new(15.0, 9e9, -20.0));
    let inside = mesh.elements_in_box(&low, &high);
    let all = 0..mesh.element_count() as u32;
    let rest: Vec<u32> = all.filter(|element| !inside.contains(element)).collect();
    let factory = |label: &str, law: AnyLaw| {
        SolidKernel::Hex8Full.factory(label, law, BlockOptions::default())
    };
    Model::builder(mesh)
        .elements(rest, factory("rock", Core::Rock.law()))
        .elements(inside, factory("core", core.law()))
        .boundary(parts)
        .delayed(DelayedPairs {
            pairs: pairs(mesh),
            slowness: s,
            ..DelayedPairs::default()
        })
}

pub(super) fn model(mesh: &Mesh, angles: [f64; 2], core: Core) -> Model {
    spec(mesh, angles, core).build().unwrap()
}

/// A section of 120 x 60 m of elements of 5 m, of a number of layers along y.
fn mesh(layers: usize) -> Mesh {
    let half = 2.5 * layers as f64;
    let (low, high) = (Vec3::new(-60.0, -half, -60.0), Vec3::new(60.0, half, 0.0));
    Mesh::box_of_hexes(low, high, [24, layers, 12], "rock").unwrap()
}

/// Displacement at 20 times within 0.6 s of the nodes at the end of smaller y, in the order of x and z.
fn motion(layers: usize, angles: [f64; 2], core: Core, steps: u64) -> Vec<Vec3> {
    let mesh = mesh(layers);
    let mut model = model(&mesh, angles, core);
    let x = mesh.positions();
    let mut ends = pairs(&mesh);
    ends.sort_by_key(|(a, _)| [x[*a as usize].x, x[*a as usize].z].map(|x| x as i64));
    let mut motion = Vec::new();
    for _ in 0..20 {
        for _ in 0..steps / 20 {
            Leapfrog.step(&mut model, 0.6 / steps as f64).unwrap();
        }
        let of = |node: u32| model.displacement(node);
        motion.extend(ends.iter().map(|(a, b)| (of(*a) + of(*b)) * 0.5));
    }
    motion
}

/// Residual of the energy of a bay in the same time.
fn residual(angles: [f64; 2], core: Core, steps: u64) -> f64 {
    let mesh = mesh(3);
    let options = RunOptions::steps(steps).with_step(StepChoice::Fixed(0.6 / steps as f64));
    let options = options.with_energy(EnergyCheck::every(steps / 4));
    let mut model = model(&mesh, angles, core);
    let report = run(&mut model, &Leapfrog, &options, &mut [], &mut |_| {}).unwrap();
    report.energy_residual
}

/// What a core changes of the motion of a slice, and what a bay with the same core all along y errs by against it, with a number of steps and
/// with twice as many.
fn compared(angles: [f64; 2], core: Core, steps: u64) -> [f64; 3] {
    let [slice, elastic] = [core, Core::Rock].map(|core| motion(1, angles, core, 2 * steps));
    let [bay, finer] = [steps, 2 * steps].map(|steps| motion(3, angles, core, steps));
    [
        apart(&slice, &elastic),
        apart(&bay, &slice),
        apart(&finer, &slice),
    ]
}

/// A bay whose core yields moves as a slice does, to a hundredth of what the core changes, and the closer the smaller the step is.
#[test]
fn a_uniform_bay_that_yields_moves_as_a_slice() {
    for angles in [[25.0, 45.0], [22.0, 90.0]] {
        let [effect, error, halved] = compared(angles, Core::Yielding, 600);
        let residual = residual(angles, Core::Yielding, 600);
        println!("{angles:?}: {effect:.3}, {error:.4} {halved:.4}, residual {residual:.1e}");
        assert!(effect > 0.3 && error < 0.02 * effect, "{effect} {error}");
        assert!(halved < 0.7 * error, "{error} {halved}");
        assert!(residual < 1e-5, "{residual:e}");
    }
}

/// A bay whose core breaks moves as a slice does to a tenth of what the core changes: the two share out the inertia of what breaks
/// in other ways.
#[test]
fn a_uniform_bay_that_breaks_moves_as_a_slice() {
    let angles = [25.0, 45.0];
    let [effect, error, halved] = compared(angles, Core::Brittle, 600);
    let residual = residual(angles, Core::Brittle, 600);
    println!("{effect:.3}, {error:.4} {halved:.4}, residual {residual:.1e}");
    assert!(effect > 0.3 && error < 0.1 * effect, "{effect} {error}");
    assert!(residual < 1e-5, "{residual:e}");
}
