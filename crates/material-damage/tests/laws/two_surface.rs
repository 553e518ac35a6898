//! Yield surface with listed uniaxial strengths.

use nalgebra::Vector3;
use powerhouse_material_damage::{
    Control, ElastoPlastic, MaterialError, PlasticDamage, PlasticDamageParameters, PointDriver,
    Softening, TwoSurface, TwoSurfaceParameters, YieldSurface, presets,
};
use powerhouse_model::Stress;

use super::exhaustive::{Face, cut_off_faces, passive_ratio, search, shear_faces};
use super::random::Random;

/// The listed strengths of the paper's concrete (Pa).
const TENSION: f64 = 1.27e6;
const COMPRESSION: f64 = 16.7e6;

fn parameters(dilation: f64, cohesion: f64) -> TwoSurfaceParameters {
    TwoSurfaceParameters {
        medium: presets::PAPER_CONCRETE.medium,
        friction: 47.7,
        dilation,
        cohesion,
        tension_strength: TENSION,
        compression_strength: COMPRESSION,
    }
}

/// All faces in unsorted principal stresses.
fn faces(p: &TwoSurfaceParameters) -> Vec<Face> {
    let [n, m] = [p.friction, p.dilation].map(passive_ratio);
    let (pulled, pressed) = (p.tension_strength, p.compression_strength);
    let mut faces = shear_faces(pressed / pulled, m, pressed);
    let confined = (2.0 * p.cohesion * n.sqrt()).max(pressed);
    faces.extend(shear_faces(n, m, confined));
    faces.extend(cut_off_faces(pulled));
    faces
}

/// Yield stresses of the law on all paths of laboratory tests are closed forms: the listed
/// strengths without confinement, friction under it, whatever the cohesion.
#[test]
fn yield_stresses_along_laboratory_paths_are_closed_forms() {
    let n = passive_ratio(47.7);
    let ratio = COMPRESSION / TENSION;
    for (cohesion, dilation) in [(1.3e6, 0.0), (1.3e6, 20.0), (5.0e6, 0.0), (5.0e6, 47.7)] {
        let surface = TwoSurface::new(parameters(dilation, cohesion)).unwrap();
        let law = ElastoPlastic::new(surface);
        let confined = (2.0 * cohesion * n.sqrt()).max(COMPRESSION);
        assert!((surface.cohesion() - 0.5 * confined / n.sqrt()).abs() < 1e-10 * confined);
        let yields = |target: [Control; 6], initial: [f64; 3]| {
            let [xx, yy, zz] = initial;
            let initial = Stress([xx, yy, zz, 0.0, 0.0, 0.0]);
            let mut point = PointDriver::new(law).with_initial(initial).unwrap();
            point.advance(target, 40).unwrap()[39].stress.0
        };
        let check = |stress: f64, expected: f64, what: &str| {
            let error = (stress / expected - 1.0).abs();
            assert!(error < 1e-10, "{what}: {stress} {expected}");
        };
        let none = [0.0; 3];
        check(
            yields(Control::uniaxial(5.0e-4), none)[2],
            TENSION,
            "tension",
        );
        check(
            yields(Control::uniaxial(-4.0e-3), none)[2],
            -COMPRESSION,
            "compression",
        );
        check(
            yields(Control::biaxial(-4.0e-3), none)[0],
            -COMPRESSION,
            "biaxial",
        );
        check(
            yields(Control::biaxial(5.0e-4), none)[0],
            TENSION,
            "biaxial tension",
        );
        let shear = yields(Control::simple_shear([0.0; 3], 1.0e-3), none)[3];
        check(shear, COMPRESSION / (ratio + 1.0), "shear");
        // A straight line between lateral tension and compression.
        let across = 0.4 * TENSION;
        let mixed = yields(Control::triaxial(across, -2.0e-3), [across, across, 0.0])[2];
        check(mixed, -0.6 * COMPRESSION, "tension and compression");
        for pressure in [0.1e6, 3.0e6, 20.0e6] {
            let axial = (ratio * pressure + COMPRESSION).min(n * pressure + confined);
            let squeezed = yields(Control::triaxial(-pressure, -2.0e-2), [-pressure; 3])[2];
            check(squeezed, -axial, "triaxial compression");
            let side = yields(Control::plane_strain(-pressure, -2.0e-2), [-pressure; 3])[2];
            check(side, -axial, "plane strain");
        }
        let pressure = 60.0e6;
        let drawn = ((COMPRESSION - pressure) / ratio).min((confined - pressure) / n);
        let extended = yields(Control::triaxial(-pressure, 1.0e-2), [-pressure; 3])[2];
        check(extended, drawn, "triaxial extension");
    }
}

/// Ten thousand trials come to where an exhaustive search over all faces solves the return
/// equations, and never lie outside.
#[test]
fn returns_agree_with_an_exhaustive_search() {
    let mut random = Random(61);
    for case in 0..10_000 {
        let dilation = [0.0, 20.0, 47.7][case % 3];
        let cohesion = [1.3e6, 3.5e6, 8.0e6][case / 3 % 3];
        let p = parameters(dilation, cohesion);
        let surface = TwoSurface::new(p).unwrap();
        let near = 10.0_f64.powf(-12.0 * random.unit()) * TENSION;
        let mut s: [f64; 3] = core::array::from_fn(|_| 40.0 * TENSION * random.signed());
        match case % 7 {
            0 => s[1] = s[0] + near * random.signed(),
            1 => s[1] = s[2] + near * random.signed(),
            2 => s = core::array::from_fn(|_| TENSION + near * random.signed()),
            3 => {
                s = [
                    TENSION + near,
                    near * random.signed(),
                    near * random.signed(),
                ]
            }
            4 => s = s.map(|x| 0.05 * x),
            _ => {}
        }
        s.sort_by(|a, b| b.total_cmp(a));
        if surface.excess(&s) <= 0.0 {
            continue;
        }
        let expected = search(&faces(&p), &p.medium, TENSION, false, s);
        let returned = Vector3::from(surface.return_principal(&s).stress);
        let error = (returned - expected).norm() / TENSION.max(Vector3::from(s).norm());
        assert!(error < 1e-8, "{case}: {s:?} {returned:?} {expected:?}");
        // The yield function is scaled by the ratio of the strengths, about 13.
        let outside = surface.excess(&returned.into()) / TENSION.max(returned.norm());
        assert!(outside < 1.3e-11, "{case}: {outside:e}");
    }
}

/// With damage, cracks and crushing begin at the listed strengths and dissipate their energies,
/// whatever the size of the element.
#[test]
fn damage_begins_at_the_listed_strengths() {
    let by_energy = |energy| Softening::FractureEnergy {
        energy,
        threshold: 0.0,
    };
    let law = |stiffness_recovery| {
        PlasticDamage::new(PlasticDamageParameters {
            surface: TwoSurface::new(parameters(0.0, 1.3e6)).unwrap(),
            tension: by_energy(133.0),
            compression: by_energy(36.0e3),
            stiffness_recovery,
            residual_stiffness: 1.0e-6,
        })
        .unwrap()
    };
    for size in [0.1, 0.5, 1.0] {
        // Lateral cracks of crushing stay closed; those of tension leave lateral stresses if they close.
        for (energy, strength, sign, recovery) in
            [(133.0, TENSION, 1.0, 0.0), (36.0e3, COMPRESSION, -1.0, 1.0)]
        {
            let law = law(recovery);
            law.check_size(size).unwrap();
            let mut point = PointDriver::new(law).with_size(size).unwrap();
            let end = sign * 8.0 * energy / strength / size;
            let path = point.advance(Control::uniaxial(end), 4000).unwrap();
            let stresses = path.iter().map(|record| sign * record.stress.0[2]);
            let peak = stresses.fold(0.0, f64::max);
            // The peak falls between two steps.
            assert!(
                peak <= strength * (1.0 + 1e-10) && peak > 0.98 * strength,
                "{peak}"
            );
            let taken = path[3999].work * size / energy;
            assert!((taken - 1.0).abs() < 3.0e-3, "{taken}");
        }
    }
}

/// Strengths whose ratio is below that of the friction angle, and numbers out of range, are refused by name.
#[test]
fn wrong_parameters_are_refused() {
    let refused = TwoSurface::new(TwoSurfaceParameters {
        compression_strength: 6.0 * TENSION,
        ..parameters(0.0, 1.3e6)
    });
    let expected = MaterialError::StrengthRatio {
        ratio: 6.0,
        least: passive_ratio(47.7),
    };
    match (refused, expected) {
        (
            Err(MaterialError::StrengthRatio { ratio, least }),
            MaterialError::StrengthRatio {
                ratio: wanted,
                least: limit,
            },
        ) => assert!((ratio - wanted).abs() < 1e-12 && (least - limit).abs() < 1e-12),
        other => panic!("{other:?}"),
    }
    for wrong in [0.0, -1.0, f64::NAN] {
        let p = TwoSurfaceParameters {
            tension_strength: wrong,
            ..parameters(0.0, 1.3e6)
        };
        match TwoSurface::new(p) {
            Err(MaterialError::Parameter(error)) => assert_eq!(error.name, "tension_strength"),
            other => panic!("{other:?}"),
        }
    }
}
