//! A horizontal joint in a full space under SV and SH waves along it, against its closed form.
//!
//! The joint is rigid and slips at a strength that does not change. All its motion has the slowness `s` along y, and slip sends out waves along the
//! normal. With the impedances `Z_x` and `Z_y` of both half-spaces together the slip rate `w` obeys `T = T_w - Z w`, with the shear
//! stress `T_w` of the waves in a welded space, `T` along `w` and at most the strength.

use powerhouse_boundary::Viscous;
use powerhouse_contact::{
    BondedCoulomb, BondedCoulombParameters, Joint, JointSurface, SurfaceOptions,
};
use powerhouse_elements::SolidKernel;
use powerhouse_explicit_core::{BuildModel, Leapfrog, Model};
use powerhouse_material_damage::LinearElastic;
use powerhouse_model::{
    AbsorbingBoundary, BlockOptions, BoundarySite, DelayedPairs, FieldMotion, IncidentField, Mesh,
    PeriodicPairs, TimeIntegrator, Vec3,
};
use powerhouse_wavefield::{
    Angle, InputConvention, PlaneWave, PlaneWaveParameters, Ricker, RickerQuantity, Site,
    Superposition, WaveKind,
};

use super::{pairs, rock, slowness};

/// Shear strength (Pa).
const STRENGTH: f64 = 4e5;
/// Incidence and azimuth (degrees).
const ANGLES: [f64; 2] = [20.0, 90.0];

/// SV and SH waves of 8 Hz whose displacements pass the origin at 0.2 s with 10 and 7 mm.
fn field() -> Superposition {
    let wave = |kind, size: f64| -> Box<dyn IncidentField> {
        let pulse = Ricker::new(RickerQuantity::Displacement, size, 8.0, 0.2).unwrap();
        let parameters = PlaneWaveParameters {
            kind,
            incidence: Angle::from_degrees(ANGLES[0]),
            azimuth: Angle::from_degrees(ANGLES[1]),
            medium: rock(),
            site: Site::FullSpace,
            reference: Vec3::zeros(),
            arrival: 0.0,
            convention: InputConvention::Incident,
        };
        Box::new(PlaneWave::new(parameters, std::sync::Arc::new(pulse)).unwrap())
    };
    Superposition::new(vec![wave(WaveKind::SV, 0.01), wave(WaveKind::SH, 0.007)]).unwrap()
}

/// Impedances (N s/m3) of both half-spaces to slip along x and along y.
fn impedances() -> [f64; 2] {
    let (medium, s) = (rock(), slowness(WaveKind::SV, ANGLES));
    let along = |speed: f64| (1.0 / (speed * speed) - s * s).sqrt();
    let (xi, eta) = (along(medium.p_speed()), along(medium.s_speed()));
    let sum = xi * eta + s * s;
    let (density, shear) = (medium.density, medium.shear());
    let (normal, axial) = (density * eta / sum, density * xi / sum);
    let coupling = s * (density - 2.0 * shear * sum) / sum;
    [
        0.5 * shear * eta,
        0.5 * (axial + coupling * coupling / normal),
    ]
}

/// Slip (m) along x and y at times (s) by the closed form, whose rate is integrated in intervals of 10 us.
fn exact(times: &[f64]) -> Vec<[f64; 2]> {
    let field = field();
    let sampler = field.prepare(&[Vec3::zeros()]).unwrap();
    let [across, along] = impedances();
    let rate = |time: f64| {
        let mut motion = [FieldMotion::default()];
        sampler.add_motion(time, &mut motion);
        let welded = [motion[0].stress.0[5], motion[0].stress.0[4]];
        let at = |share: f64| {
            [
                welded[0] / (1.0 + across * share),
                welded[1] / (1.0 + along * share),
            ]
        };
        let excess = |share: f64| at(share)[0].hypot(at(share)[1]) - STRENGTH;
        if excess(0.0) <= 0.0 {
            return [0.0; 2];
        }
        let (mut low, mut high) = (
            0.0,
            welded[0].hypot(welded[1]) / STRENGTH / across.min(along),
        );
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if excess(middle) > 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        at(low).map(|traction| traction * low)
    };
    let (mut slip, mut time, interval) = ([0.0; 2], 0.0, 1e-5);
    let mut all = Vec::new();
    for &end in times {
        while time < end - 0.5 * interval {
            let rate = rate(time + 0.5 * interval);
            slip = [slip[0] + interval * rate[0], slip[1] + interval * rate[1]];
            time += interval;
        }
        all.push(slip);
    }
    all
}

/// Slip of the joint in a bay of two layers along y with a number of elements per wavelength of S waves, at the same times.
fn found(per_wavelength: f64, share: f64, times: &[f64]) -> Vec<[f64; 2]> {
    let size = rock().s_speed() / 8.0 / per_wavelength;
    let layers = 20.0;
    let (low, high) = (
        Vec3::new(-0.5, -1.0, -layers) * size,
        Vec3::new(0.5, 1.0, layers) * size,
    );
    let whole = Mesh::box_of_hexes(low, high, [1, 2, 2 * layers as usize], "rock").unwrap();
    let all = 0..whole.element_count() as u32;
    let (upper, lower): (Vec<u32>, Vec<u32>) = all.partition(|e| whole.centroid(*e).z > 0.0);
    let split = whole.split_between(&lower, &upper).unwrap();
    let mesh = split.mesh;
    let options = SurfaceOptions::within(1e-6 * size).unwrap();
    let surface = JointSurface::between(&mesh, &split.first, &split.second, &options).unwrap();
    let face = |name: &str| mesh.nodes_of_facets(mesh.facet_set(name).unwrap());
    let sides = PeriodicPairs::by_translation(&mesh, &face("left"), &face("right"), 1e-6).unwrap();
    let ends = PeriodicPairs {
        pairs: pairs(&mesh),
    };
    let leads = PeriodicPairs::leads([&sides, &ends]);
    let lead = |node: u32| leads.get(&node).copied().unwrap_or(node);
    let joined = surface.united(lead);
    let law = BondedCoulomb::new(BondedCoulombParameters {
        static_friction: 0.0,
        dynamic_friction: 0.0,
        cohesion: STRENGTH,
        tensile_strength: 1e12,
        cohesion_loss: false,
    });
    let joint = Joint::new("joint", joined.pairs, law.unwrap()).unwrap();
    let field = field();
    let faces = ["bottom", "top"].map(|face| (face, mesh.facet_set(face).unwrap()));
    let site = BoundarySite::from_mesh(&mesh, &faces, |_| rock(), Vec3::zeros(), Some(&field));
    let slowness = slowness(WaveKind::SV, ANGLES);
    let parts = Viscous::default()
        .build(&site.with_slowness(slowness))
        .unwrap();
    let law = LinearElastic::new(rock());
    let factory = SolidKernel::Hex8Full.factory("rock", law, BlockOptions::default());
    let mut model = Model::builder(&mesh)
        .elements("rock", factory)
        .boundary(parts)
        .constraint(Box::new(joint))
        .periodic(sides)
        .delayed(DelayedPairs {
            pairs: ends.pairs.clone(),
            slowness,
            ..DelayedPairs::default()
        })
        .build()
        .unwrap();
    let at = |upper: bool| {
        let is_here = |node: &u32| mesh.positions()[*node as usize].norm() < 1.2 * size;
        let elements = if upper { &split.second } else { &split.first };
        let mut nodes = mesh.nodes_of_facets(elements);
        nodes.retain(is_here);
        nodes[0]
    };
    let [above, below] = [at(true), at(false)];
    let steps = (times[0] / (share * model.stable_step(&Leapfrog).unwrap().step)).ceil();
    let step = times[0] / steps;
    let mut slips = Vec::new();
    for _ in times {
        for _ in 0..steps as usize {
            Leapfrog.step(&mut model, step).unwrap();
        }
        let slip = model.displacement(above) - model.displacement(below);
        slips.push([slip.x, slip.y]);
    }
    slips
}

fn apart(found: &[[f64; 2]], exact: &[[f64; 2]]) -> f64 {
    let both = found.iter().flatten().zip(exact.iter().flatten());
    let missed: f64 = both.map(|(a, b)| (a - b).powi(2)).sum();
    (missed / exact.iter().flatten().map(|b| b * b).sum::<f64>()).sqrt()
}

/// With 40 elements per wavelength the slip is that of the closed form within a hundredth, over all times.
#[test]
fn a_joint_slips_under_waves_along_it_as_the_closed_form_does() {
    let times: Vec<f64> = (1..=40).map(|k| 0.01 * f64::from(k)).collect();
    let exact = exact(&times);
    let last = exact[exact.len() - 1];
    let greatest = exact
        .iter()
        .map(|slip| slip[0].hypot(slip[1]))
        .fold(0.0, f64::max);
    assert!(greatest > 1e-3, "{greatest:e}");
    let errors = [(40.0, 0.7), (40.0, 0.35)]
        .map(|(count, share)| apart(&found(count, share, &times), &exact));
    println!("greatest slip {greatest:.3e}, last {last:?}, errors {errors:?}");
    assert!(errors[0] < 0.01, "{errors:?}");
}
