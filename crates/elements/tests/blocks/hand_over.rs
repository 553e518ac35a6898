//! From static states to steps: the same forces.

use powerhouse_material_damage::{
    DampingBand, ElasticInSeries, ElastoPlastic, FlatDamping, LeeFenves, LeeFenvesParameters,
    Mazars, MazarsParameters, MazarsTension, MohrCoulomb, ReferenceFrequency, RelaxationSpectrum,
    SofteningPlasticity, SofteningPlasticityParameters, StrengthFall, presets,
};

use super::*;

const KERNELS: [SolidKernel; 4] = [
    SolidKernel::Hex8Natural,
    SolidKernel::Hex8BBar,
    SolidKernel::Wedge6,
    SolidKernel::Tet10,
];
/// Strain of the deformations over that at the strength.
const STRAINS: [f64; 3] = [1.5, 4.0, 12.0];

/// Concrete with steel fibres.
fn fibres() -> LeeFenvesParameters {
    LeeFenvesParameters {
        tension_energy: 4000.0,
        compression_energy: 8.0e5,
        ..presets::eurocode_lee_fenves(30.0).unwrap()
    }
}

/// A block that was deformed in static states beyond its strength, its displacement, and the last forces.
fn deformed<M: ConstitutiveLaw>(
    kernel: SolidKernel,
    law: &M,
    (strain, stiffness): (f64, f64),
) -> (Fixture, Vec<Quad<f64>>, Vec<Vec3>) {
    let mesh = distorted(kernel.kind(), [2, 2, 2]);
    let mesh = mesh.map_positions(|x| x * 0.1).unwrap();
    let options = options(Precision::F64, LaneWidth::Native, stiffness);
    let mut fixture = Fixture::of(mesh, kernel, law.clone(), options);
    // Elements of 0.2 m that are deformed by twice the noise.
    let shape = fixture.noise(5, 0.1 * strain);
    let mut last = Vec::new();
    let mut u = shape.clone();
    for share in [0.4, 0.7, 1.0] {
        for (u, shape) in u.iter_mut().zip(&shape) {
            *u = Quad::from_vector(&(shape.to_vector() * share));
        }
        last = fixture.static_forces(&u);
        fixture.block.commit();
    }
    (fixture, u, last)
}

/// Whether the forces of a block that was deformed in static states beyond its strength are the same when they are
/// computed again, in a step without motion, and after many of them, to 1e-9 of the largest.
fn holds<M: ConstitutiveLaw>(kernel: SolidKernel, law: &M, (strain, stiffness): (f64, f64)) {
    let (mut fixture, u, last) = deformed(kernel, law, (strain, stiffness));
    let name = law.name();
    let size = largest(&last);
    let change = |forces: &[Vec3]| {
        let changes: Vec<Vec3> = forces.iter().zip(&last).map(|(a, b)| a - b).collect();
        largest(&changes) / size
    };
    let again = fixture.static_forces(&u);
    let mut most = change(&again);
    let rest = zeros(u.len());
    for number in 0..30 {
        let views = [NodalView::F64(&u), NodalView::F64(&rest)];
        let context = BlockContext::new(when(number, 1e-3), views[0], views[1]);
        let moving = fixture.forces_at(&context).unwrap();
        fixture.block.commit();
        most = most.max(change(&moving));
    }
    assert!(most < 1e-9, "{kernel:?} {name} {strain:e}: {most:e}");
}

/// The same without damping, with flat damping, and with damping proportional to stiffness.
fn holds_with_any_damping<M: ElasticInSeries>(kernel: SolidKernel, law: M, strength: f64) {
    let band = DampingBand {
        ratio: 0.04,
        lowest: 0.5,
        highest: 20.0,
        mechanisms: 3,
    };
    let spectrum = RelaxationSpectrum::fit(band).unwrap();
    let flat = FlatDamping::new(law.clone(), spectrum, ReferenceFrequency::Centre).unwrap();
    let none = FlatDamping::none(law);
    for strain in STRAINS.map(|strain| strain * strength) {
        holds(kernel, &none, (strain, 0.0));
        holds(kernel, &flat, (strain, 0.0));
        holds(kernel, &none, (strain, 1e-4));
    }
}

/// Blocks of every law that yields or cracks, in bricks, wedges and tetrahedra without order, deformed beyond the strength
/// by little and by much, have the same forces at the start of the motion as at the end of the statics, and keep them.
#[test]
fn what_cracked_at_rest_keeps_its_forces_in_motion() {
    for kernel in KERNELS {
        let fibres = fibres();
        let tension = fibres.tension_strength / fibres.medium.young;
        holds_with_any_damping(kernel, LeeFenves::new(fibres).unwrap(), tension);
        let concrete = presets::eurocode_concrete(30.0).unwrap();
        holds_with_any_damping(kernel, concrete, tension);
        let mazars = Mazars::new(MazarsParameters {
            medium: ElasticMedium::new(30.0e9, 0.2, 2400.0).unwrap(),
            threshold: 1.0e-4,
            tension: MazarsTension::FallingStress { energy: 150.0 },
            compression_share: 1.2,
            compression_rate: 1500.0,
            residual_stiffness: 1.0e-3,
        });
        holds_with_any_damping(kernel, mazars.unwrap(), 1.0e-4);
        let surface = MohrCoulomb::new(presets::PAPER_ROCK).unwrap();
        holds_with_any_damping(kernel, ElastoPlastic::new(surface), 1.0e-4);
        let softening = SofteningPlasticity::new(SofteningPlasticityParameters {
            surface,
            fall: StrengthFall::FractureEnergy { energy: 2.0e3 },
            residual_strength: 0.2,
        });
        holds_with_any_damping(kernel, softening.unwrap(), 1.0e-4);
    }
}

/// Bricks with strains of their own, cracked by little and by much, where these strains are hard to find: a body at rest has the
/// same forces whatever the length of the step by which it is tested whether its stress stays.
#[test]
fn own_strains_at_rest_do_not_depend_on_the_step() {
    let fibres = fibres();
    let tension = fibres.tension_strength / fibres.medium.young;
    let law = LeeFenves::new(fibres).unwrap();
    for strain in STRAINS.map(|strain| strain * tension) {
        let (mut fixture, u, _) = deformed(SolidKernel::Hex8Eas, &law, (strain, 0.0));
        let still = fixture.static_forces(&u);
        let rest = zeros(u.len());
        for step in [1e-6, 1e-3, 1.0] {
            let views = [NodalView::F64(&u), NodalView::F64(&rest)];
            let context = BlockContext::new(when(0, step), views[0], views[1]).with_rest(true);
            let forces = fixture.forces_at(&context).unwrap();
            let changes: Vec<Vec3> = forces.iter().zip(&still).map(|(a, b)| a - b).collect();
            let change = largest(&changes) / largest(&still);
            assert!(change < 1e-12, "{strain:e} {step}: {change:e}");
        }
    }
}
