//! Hoek-Brown surface and its law.

use nalgebra::{Matrix3, Vector3};
use powerhouse_material_damage::{
    Control, ElastoPlastic, HoekBrown, HoekBrownParameters, MaterialError, PointDriver,
    YieldSurface, media,
};
use powerhouse_model::Stress;

use super::random::Random;

/// The rock mass of the authors' tunnel: GSI 45, m_i 10, intact strength 50 MPa.
pub(crate) fn tunnel(dilation_share: f64) -> HoekBrownParameters {
    HoekBrownParameters {
        medium: media::ROCK,
        intact_strength: 50.0e6,
        intact_constant: 10.0,
        strength_index: 45.0,
        disturbance: 0.0,
        dilation_share,
    }
}

/// The constants are those of the definition: m 1.403, s 0.00222, a 0.508 in the authors' tunnel;
/// 1, 1/2 and m_i in intact rock; less m and s in disturbed rock.
#[test]
fn constants_are_those_of_the_definition() {
    let [m, s, a] = HoekBrown::new(tunnel(0.0)).unwrap().constants();
    assert!((m - 1.4026).abs() < 1e-4 && (s - 2.218e-3).abs() < 1e-6 && (a - 0.50809).abs() < 1e-5);
    let intact = HoekBrownParameters {
        strength_index: 100.0,
        ..tunnel(0.0)
    };
    let [m, s, a] = HoekBrown::new(intact).unwrap().constants();
    assert!(m == 10.0 && s == 1.0 && (a - 0.5).abs() < 1e-3);
    let blasted = HoekBrownParameters {
        disturbance: 1.0,
        ..tunnel(0.0)
    };
    let [m, s, _] = HoekBrown::new(blasted).unwrap().constants();
    let expected = [10.0 * f64::exp(-55.0 / 14.0), f64::exp(-55.0 / 6.0)];
    assert!((m / expected[0] - 1.0).abs() < 1e-12 && (s / expected[1] - 1.0).abs() < 1e-12);
}

/// Yield stresses of the law on all paths of laboratory tests are those of the curve.
#[test]
fn yield_stresses_along_laboratory_paths_are_closed_forms() {
    for share in [0.0, 0.3, 1.0] {
        let surface = HoekBrown::new(tunnel(share)).unwrap();
        let law = ElastoPlastic::new(surface);
        let [m, s, a] = surface.constants();
        let intact = 50.0e6;
        let strength = |greatest: f64| intact * (s - m * greatest / intact).max(0.0).powf(a);
        let yields = |target: [Control; 6], initial: f64| {
            let initial = Stress([initial, initial, initial, 0.0, 0.0, 0.0]);
            let mut point = PointDriver::new(law).with_initial(initial).unwrap();
            point.advance(target, 60).unwrap()[59].stress.0
        };
        let check = |stress: f64, expected: f64, what: &str| {
            let error = (stress / expected - 1.0).abs();
            assert!(error < 1e-10, "{what}, {share}: {stress} {expected}");
        };
        let compressive = strength(0.0);
        check(surface.uniaxial_compression(), compressive, "listed");
        check(
            yields(Control::uniaxial(-2.0e-3), 0.0)[2],
            -compressive,
            "uniaxial",
        );
        check(
            yields(Control::biaxial(-2.0e-3), 0.0)[0],
            -compressive,
            "biaxial",
        );
        for pressure in [0.5e6, 10.0e6] {
            let expected = -pressure - strength(-pressure);
            let squeezed = yields(Control::triaxial(-pressure, -2.0e-2), -pressure)[2];
            check(squeezed, expected, "triaxial compression");
            let plane = yields(Control::plane_strain(-pressure, -2.0e-2), -pressure)[2];
            check(plane, expected, "plane strain");
        }
        // Where the greatest stress is sought: the zero of `s1 - s3(s1) - strength(s1)`.
        let meets = |least: &dyn Fn(f64) -> f64| {
            let (mut low, mut high) = (-40.0e6, s * intact / m);
            for _ in 0..200 {
                let middle = 0.5 * (low + high);
                if middle - least(middle) < strength(middle) {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            low
        };
        check(
            yields(Control::uniaxial(1.0e-3), 0.0)[2],
            meets(&|_| 0.0),
            "tension",
        );
        check(
            surface.uniaxial_tension(),
            meets(&|_| 0.0),
            "tension listed",
        );
        let shear = yields(Control::simple_shear([0.0; 3], 1.0e-3), 0.0)[3];
        check(shear, meets(&|s1| -s1), "shear");
        let extended = yields(Control::triaxial(-40.0e6, 1.0e-2), -40.0e6)[2];
        check(extended, meets(&|_| -40.0e6), "triaxial extension");
    }
}

/// A trial far and near, near edges and the apex.
fn trial(random: &mut Random, case: usize, apex: f64) -> [f64; 3] {
    let near = 10.0_f64.powf(-10.0 * random.unit()) * apex;
    let size = 10.0_f64.powf(3.0 * random.unit());
    let mut s: [f64; 3] = core::array::from_fn(|_| size * apex * (random.signed() - 0.3));
    match case % 5 {
        0 => s[1] = s[0] + near * random.signed(),
        1 => s[1] = s[2] + near * random.signed(),
        2 => s = core::array::from_fn(|_| apex * (1.0 + random.signed())),
        _ => {}
    }
    s.sort_by(|a, b| b.total_cmp(a));
    s
}

/// Ten thousand returns solve the return equations: the stress is on the surface, and the plastic
/// strain is a combination, nowhere negative, of the flows of the faces that meet there.
#[test]
fn returns_solve_the_return_equations() {
    let mut random = Random(81);
    let mut seen = [0; 4];
    for case in 0..10_000_usize {
        let mut p = tunnel([0.0, 0.4, 1.0][case % 3]);
        p.strength_index = [10.0, 45.0, 100.0][case / 3 % 3];
        let surface = HoekBrown::new(p).unwrap();
        let [m, s, a] = surface.constants();
        let apex = surface.apex();
        let t = trial(&mut random, case, apex);
        if surface.excess(&t) <= 0.0 {
            continue;
        }
        let returned = surface.return_principal(&t);
        let [s1, s2, s3] = returned.stress;
        let scale = Vector3::from(t).norm().max(apex);
        let size = Vector3::from(returned.stress).norm().max(apex);
        let depth = s - m * s1 / p.intact_strength;
        // As a distance: near the apex the yield function rises without bound.
        let steepness = 1.0 + a * m * depth.max(1e-300).powf(a - 1.0);
        let outside = surface.excess(&returned.stress) / steepness;
        assert!(
            outside.abs() < 1e-12 * size.max(surface.uniaxial_compression()),
            "{case}: {outside:e}"
        );
        assert!(s1 >= s2 && s2 >= s3, "{case}");
        let lame = p.medium.lambda() / (2.0 * p.medium.shear());
        let loss: Vector3<f64> = Vector3::from(t) - Vector3::from(returned.stress);
        let told = Vector3::from(returned.loss);
        assert!((loss - told).norm() < 1e-12 * scale, "{case}");
        // 2G times the plastic strain.
        let x = told.add_scalar(-lame / (1.0 + 3.0 * lame) * told.sum());
        let tiny = 1e-8 * scale;
        if depth < 1e-12 {
            seen[3] += 1;
            let opens = if p.dilation_share > 0.0 {
                x.min()
            } else {
                x.sum()
            };
            assert!(opens > -tiny, "{case}: {x:?}");
            continue;
        }
        let opening = 1.0 + p.dilation_share * a * m * depth.powf(a - 1.0);
        // Relative to the opening, which may be large near the apex.
        let wrong = if s1 == s2 {
            seen[1] += 1;
            assert!(x[0] > -tiny && x[1] > -tiny && x[2] < tiny, "{case}: {x:?}");
            (x[0] + x[1]) / opening + x[2]
        } else if s2 == s3 {
            seen[2] += 1;
            assert!(x[0] > -tiny && x[1] < tiny && x[2] < tiny, "{case}: {x:?}");
            x[0] / opening + x[1] + x[2]
        } else {
            seen[0] += 1;
            assert!(x[1].abs() < tiny && x[2] < tiny, "{case}: {x:?}");
            x[0] / opening + x[2]
        };
        assert!(wrong.abs() < tiny, "{case}: {wrong:e} of {scale:e}");
    }
    assert!(seen.iter().all(|count| *count > 100), "{seen:?}");
}

/// With associated flow no stress within the surface is closer in energy than the returned one: an
/// optimiser that uses convexity alone finds none.
#[test]
fn associated_returns_are_closest_points() {
    let mut random = Random(83);
    let surface = HoekBrown::new(tunnel(1.0)).unwrap();
    let medium = surface.medium();
    let stiffness =
        Matrix3::from_element(medium.lambda()) + 2.0 * medium.shear() * Matrix3::identity();
    let compliance = stiffness.try_inverse().unwrap() * medium.shear();
    let [m, s, a] = surface.constants();
    let intact = 50.0e6;
    for case in 0..10_000 {
        let t = trial(&mut random, case, surface.apex());
        if surface.excess(&t) <= 0.0 {
            continue;
        }
        let energy = |stress: [f64; 3]| {
            let loss = Vector3::from(t) - Vector3::from(stress);
            loss.dot(&(compliance * loss))
        };
        // The best of all with a given greatest stress: the others are bounded by straight lines.
        let nearest = |s1: f64| {
            let least = s1 - intact * (s - m * s1 / intact).max(0.0).powf(a);
            let share = -compliance[(0, 1)] / compliance[(0, 0)];
            // Free in s2 and s3, then on each of the bounds, the middle bounded by both.
            let middle = |s3: f64| {
                let free = t[1] + share * ((s1 - t[0]) + (s3 - t[2]));
                free.clamp(s3, s1)
            };
            let (mut low, mut high) = (least, s1);
            for _ in 0..60 {
                let third = (high - low) / 3.0;
                let [b, c] = [low + third, high - third];
                if energy([s1, middle(b), b]) < energy([s1, middle(c), c]) {
                    high = c;
                } else {
                    low = b;
                }
            }
            let s3 = 0.5 * (low + high);
            let best = energy([s1, middle(s3), s3]);
            best.min(energy([s1, middle(least), least]))
        };
        let (mut low, mut high) = (t[2] - 2.0 * (t[0] - t[2]) - intact, surface.apex());
        for _ in 0..80 {
            let third = (high - low) / 3.0;
            let [b, c] = [low + third, high - third];
            if nearest(b) < nearest(c) {
                high = c;
            } else {
                low = b;
            }
        }
        let found = nearest(0.5 * (low + high)).min(nearest(high));
        let own = energy(surface.return_principal(&t).stress);
        // The remaining distance is the root of the remaining energy.
        let scale = Vector3::from(t).norm_squared();
        assert!(
            own < found + 1e-15 * scale,
            "{case}: {own:e} {found:e} {t:?}"
        );
    }
}

/// Invalid parameters are refused by name.
#[test]
fn wrong_parameters_are_refused() {
    for (wrong, name) in [
        (
            HoekBrownParameters {
                strength_index: 101.0,
                ..tunnel(0.0)
            },
            "strength_index",
        ),
        (
            HoekBrownParameters {
                dilation_share: 1.1,
                ..tunnel(0.0)
            },
            "dilation_share",
        ),
        (
            HoekBrownParameters {
                intact_strength: f64::NAN,
                ..tunnel(0.0)
            },
            "intact_strength",
        ),
    ] {
        match HoekBrown::new(wrong) {
            Err(MaterialError::Parameter(error)) => assert_eq!(error.name, name),
            other => panic!("{other:?}"),
        }
    }
}

/// The driver follows uniaxial tension without dilation beyond the yield stress, in few steps and in many,
/// from zero stress and from pressure, and with little or full dilation: the elastic first guess of a step is on
/// the apex there, which no correction leaves.
#[test]
fn uniaxial_tension_is_followed_with_and_without_dilation() {
    for share in [0.0, 0.01, 0.5, 1.0] {
        let surface = HoekBrown::new(tunnel(share)).unwrap();
        let strength = surface.uniaxial_tension();
        for (strain, steps) in [(1.0e-4, 1), (1.0e-3, 1), (1.0e-3, 10), (1.0e-2, 100)] {
            let mut point = PointDriver::new(ElastoPlastic::new(surface));
            let path = point.advance(Control::uniaxial(strain), steps);
            let path = path.unwrap_or_else(|error| panic!("{share} {strain} {steps}: {error}"));
            let stress = path[steps - 1].stress.0;
            assert!(
                (stress[2] / strength - 1.0).abs() < 1e-8,
                "{share} {stress:?}"
            );
            assert!(stress[0].abs() < 1e-8 * strength && stress[1].abs() < 1e-8 * strength);
        }
    }
}
