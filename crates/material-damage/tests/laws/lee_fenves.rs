//! Concrete damaged plasticity.

use nalgebra::Vector3;
use powerhouse_material_damage::{
    Control, LeeFenves, LeeFenvesParameters, MaterialError, PointDriver, PrincipalAxes,
    SofteningOf, presets,
};
use powerhouse_model::{ConstitutiveLaw, LawInput, Strain, Stress};

use super::random::Random;

/// Cracks stay open: uniaxial tension has closed forms without recovery.
const GOOD: LeeFenvesParameters = LeeFenvesParameters {
    stiffness_recovery: 0.0,
    ..presets::PAPER_CONCRETE_LEE_FENVES
};
const ROOT_3: f64 = 1.732_050_807_568_877_2;

/// Concrete that hardens before it crushes, with plastic strain and damage in softening.
fn hardening() -> LeeFenvesParameters {
    LeeFenvesParameters {
        compression_limit: 9.0e6,
        tension_damage: 0.6,
        compression_damage: 0.4,
        residual_stiffness: 1.0e-6,
        ..GOOD
    }
}

/// `a` of the ratio of peak and limit, and `b` of an element of a width, by the energy.
fn curve(limit: f64, peak: f64, r: f64, energy: f64, size: f64, tension: bool) -> [f64; 2] {
    let ratio = peak / limit;
    let a = if tension {
        0.0
    } else {
        2.0 * ratio - 1.0 + 2.0 * (ratio * ratio - ratio).sqrt()
    };
    let elastic = 0.5 * r * limit * limit / GOOD.medium.young
        * ((1.0 + a).powi(2) / (2.0 - r) - 2.0 * a * (1.0 + a) / (3.0 - r) + a * a / (4.0 - r));
    [a, limit * (1.0 + 0.5 * a) / (energy / size - elastic)]
}

/// In uniaxial tension and compression, nominal stress and strain are those of the curve at the
/// plastic strain, for every size of element.
#[test]
fn uniaxial_curves_are_closed_forms() {
    for p in [GOOD, hardening()] {
        let law = LeeFenves::new(p).unwrap();
        for size in [0.1, 0.4] {
            for (end, limit, peak, r, energy) in [
                (
                    8.0e-4,
                    p.tension_strength,
                    p.tension_strength,
                    p.tension_damage,
                    133.0,
                ),
                (
                    -1.5e-2,
                    p.compression_limit,
                    p.compression_strength,
                    p.compression_damage,
                    35.96e3,
                ),
            ] {
                let tension = end > 0.0;
                let [a, b] = curve(limit, peak, r, energy, size, tension);
                let mut point = PointDriver::new(law).with_size(size).unwrap();
                let path = point.advance(Control::uniaxial(end), 300).unwrap();
                let mut seen = 0;
                for record in path {
                    let sign = f64::signum(end);
                    let e = record.history[if tension { 6 } else { 7 }];
                    let nominal = limit * ((1.0 + a) * (-b * e).exp() - a * (-2.0 * b * e).exp());
                    let effective = nominal * (r * b * e).exp();
                    if e == 0.0 || effective < 2e-3 * limit {
                        continue;
                    }
                    seen += 1;
                    let stress = sign * record.stress.0[2];
                    let floor = 1.0 - p.residual_stiffness;
                    let left = (1.0 - (-r * b * e).exp()).min(floor);
                    let error = (stress - effective * (1.0 - left)).abs();
                    assert!(error < 1e-10 * peak, "{e:e}: {stress} {nominal}");
                    let strain = sign * record.strain.0[2];
                    let expected = e + effective / p.medium.young;
                    assert!(
                        (strain - expected).abs() < 1e-10 * strain,
                        "{strain} {expected}"
                    );
                }
                assert!(seen > 60, "{seen}");
            }
        }
    }
}

/// The strain that is computed for the compressive strength is that of the greatest stress on a path of uniaxial compression, for every size
/// of element, with and without hardening before the strength, which the finding of its parameters names.
#[test]
fn the_strain_at_the_strength_is_that_of_a_path() {
    for p in [GOOD, hardening()] {
        let law = LeeFenves::new(p).unwrap();
        for size in [0.1, 0.25, 0.4] {
            let expected = law.strain_at_strength(size);
            let mut point = PointDriver::new(law).with_size(size).unwrap();
            let path = point
                .advance(Control::uniaxial(-2.0 * expected), 2000)
                .unwrap();
            let of_step = |step: usize| 2.0 * expected * (step + 1) as f64 / 2000.0;
            let stresses = path.iter().map(|record| -record.stress.0[2]);
            let greatest = (stresses.enumerate()).max_by(|a, b| a.1.total_cmp(&b.1));
            let (step, stress) = greatest.unwrap();
            let error = (of_step(step) / expected - 1.0).abs();
            assert!(error < 0.01, "{size}: {} for {expected}", of_step(step));
            assert!((stress / p.compression_strength - 1.0).abs() < 1e-3);
        }
        let findings: Vec<String> = law.findings().iter().map(ToString::to_string).collect();
        let strain = format!(
            "{:.2} per mille in elements of 0.1 m",
            1e3 * law.strain_at_strength(0.1)
        );
        assert_eq!(
            findings.iter().any(|finding| finding.contains(&strain)),
            p.compression_limit < p.compression_strength,
            "{findings:?}"
        );
    }
}

/// The surface yields at the strengths in uniaxial tension and compression, at the listed ratio in
/// biaxial compression, at closed forms in biaxial tension and shear, and its meridians have
/// the listed ratio.
#[test]
fn yield_stresses_are_closed_forms() {
    let p = hardening();
    let law = LeeFenves::new(p).unwrap();
    let (t, c) = (p.tension_strength, p.compression_limit);
    let value = |[xx, yy, zz]: [f64; 3], xy: f64| {
        law.yield_function(&Stress([xx, yy, zz, xy, 0.0, 0.0]), &[0.0; 15], 0.3)
    };
    let alpha = 0.16 / 1.32;
    let beta = c / t * (1.0 - alpha) - (1.0 + alpha);
    let biaxial = (1.0 - alpha) * c / (2.0 * alpha + 1.0 + beta);
    let shear = (1.0 - alpha) * c / (ROOT_3 + beta);
    for (stress, xy) in [
        ([t, 0.0, 0.0], 0.0),
        ([0.0, 0.0, -c], 0.0),
        ([0.0, -1.16 * c, -1.16 * c], 0.0),
        ([biaxial, biaxial, 0.0], 0.0),
        ([0.0; 3], shear),
    ] {
        assert!(value(stress, xy).abs() < 1e-10, "{stress:?} {xy}");
    }
    // Deviators of compression and extension under one mean stress.
    for mean in [-20.0e6, -100.0e6] {
        let radius = |turned: f64| {
            let (mut low, mut high) = (0.0, 1.0e9);
            for _ in 0..200 {
                let q = 0.5 * (low + high);
                let side = mean + turned * q / 3.0;
                let axis = mean - turned * 2.0 * q / 3.0;
                if value([side, side, axis], 0.0) < 0.0 {
                    low = q;
                } else {
                    high = q;
                }
            }
            low
        };
        let [compression, extension] = [1.0, -1.0].map(radius);
        assert!((extension / compression - 2.0 / 3.0).abs() < 1e-10);
    }
}

/// A point with some damage, and a trial strain.
struct Case {
    history: [f64; 15],
    strain: [f64; 6],
    size: f64,
}

fn case(random: &mut Random, number: usize) -> Case {
    let mut history = [0.0; 15];
    history[6] = 2.0e-4 * random.unit() * [0.0, 1.0][number % 2];
    history[7] = 1.0e-3 * random.unit() * [0.0, 1.0][number / 2 % 2];
    let scale = 10.0_f64.powf(-4.5 + 2.5 * random.unit());
    let mut strain = random.six().map(|x| scale * x);
    if number.is_multiple_of(5) {
        // Tension from all sides: the apex.
        for e in &mut strain[..3] {
            *e = e.abs();
        }
        for e in &mut strain[3..] {
            *e *= 0.1;
        }
    }
    let size = 0.05 + 0.3 * random.unit();
    for (strain, width) in [(6, 13), (7, 14)] {
        history[width] = if history[strain] > 0.0 { size } else { 0.0 };
    }
    Case {
        history,
        strain,
        size,
    }
}

/// The return by bisection: effective stress, plastic strain (principal) and `e_t`, `e_c`.
fn bisection(p: &LeeFenvesParameters, case: &Case, trial: Vector3<f64>) -> Vector3<f64> {
    let (k, g) = (p.medium.bulk(), p.medium.shear());
    let [_, b_t] = curve(
        p.tension_strength,
        p.tension_strength,
        p.tension_damage,
        p.tension_energy,
        case.size,
        true,
    );
    let [a, b_c] = curve(
        p.compression_limit,
        p.compression_strength,
        p.compression_damage,
        p.compression_energy,
        case.size,
        false,
    );
    let mean = trial.mean();
    let deviator = trial.add_scalar(-mean);
    let q = (1.5 * deviator.norm_squared()).sqrt();
    let tangent = p.dilation.to_radians().tan();
    let alpha = (p.biaxial_ratio - 1.0) / (2.0 * p.biaxial_ratio - 1.0);
    let gamma = 3.0 * (1.0 - p.meridian_ratio) / (2.0 * p.meridian_ratio - 1.0);
    // A plastic multiplier of the potential q + p tan(psi).
    let after = |flow: f64| {
        let left = (1.0 - 3.0 * g * flow / q).max(0.0);
        let stress = (left * deviator).add_scalar(mean - k * tangent * flow);
        let plastic = ((1.0 - left) / (2.0 * g) * deviator).add_scalar(tangent * flow / 3.0);
        let positive: f64 = stress.iter().map(|s| s.max(0.0)).sum();
        let r = positive / stress.iter().map(|s| s.abs()).sum::<f64>();
        let e_t = case.history[6] + r * plastic.max().max(0.0);
        let e_c = case.history[7] - (1.0 - r) * plastic.min().min(0.0);
        let fall = (1.0 - p.tension_damage) * b_t * e_t;
        let t = p.tension_strength * (-fall).exp().max(1e-3);
        let bulged = (1.0 + a) * (-b_c * e_c).exp() - a * (-2.0 * b_c * e_c).exp();
        let bulged = bulged * (p.compression_damage * b_c * e_c).exp();
        let c = p.compression_limit * bulged.max(1e-3);
        let t = t.min(c * p.tension_strength / p.compression_limit);
        let beta = c / t * (1.0 - alpha) - (1.0 + alpha);
        let greatest = stress.max();
        let sum = 3.0 * alpha * stress.mean()
            + left * q
            + beta * greatest.max(0.0)
            + gamma * greatest.min(0.0);
        (stress, sum / (1.0 - alpha) - c)
    };
    if after(0.0).1 <= 0.0 {
        return trial;
    }
    let mut low = 0.0;
    let mut high = (q / (3.0 * g)).max(mean / (k * tangent));
    for _ in 0..300 {
        let flow = 0.5 * (low + high);
        if after(flow).1 > 0.0 {
            low = flow;
        } else {
            high = flow;
        }
    }
    after(high).0
}

/// Whether a stress is on the surface or lies outside by no more than a distance (Pa): less of it, of its
/// greatest principal value, or of all of them is inside.
fn is_within(law: &LeeFenves, stress: &Stress, of: (&[f64], f64), distance: f64) -> bool {
    let axes = PrincipalAxes::of(stress);
    let value = |taken: [f64; 3]| {
        let values = core::array::from_fn(|i| axes.values[i] - taken[i]);
        law.yield_function(&Stress(axes.tensor(&values)), of.0, of.1)
    };
    let size = stress.matrix().norm();
    let smaller = axes.values.map(|s| s * (distance / size.max(distance)));
    [[0.0; 3], [distance, 0.0, 0.0], [distance; 3], smaller]
        .into_iter()
        .any(|taken| value(taken) <= 0.0)
}

/// Ten thousand trials, with and without history, near the apex too, come to where bisection of
/// the return equations does; none lies outside.
#[test]
fn returns_solve_the_return_equations() {
    let mut random = Random(71);
    let mut apexes = 0;
    for number in 0..10_000_usize {
        let p = if number.is_multiple_of(3) {
            GOOD
        } else {
            hardening()
        };
        let law = LeeFenves::new(p).unwrap();
        let case = case(&mut random, number);
        law.check_size(case.size).unwrap();
        let (lambda, shear) = (p.medium.lambda(), p.medium.shear());
        let elastic = Stress::elastic(lambda, shear, &Strain(case.strain));
        let trial = Vector3::from(PrincipalAxes::of(&elastic).values);
        let expected = bisection(&p, &case, trial);
        let mut new = [0.0; 15];
        let input = LawInput::new(Strain(case.strain), &case.history).with_size(case.size);
        let nominal = law.stress_change(&input, &mut new);
        apexes += usize::from(new[12] == 2.0);
        let left = Strain(core::array::from_fn(|i| case.strain[i] - new[i]));
        let effective = Stress::elastic(lambda, shear, &left);
        let returned = Vector3::from(PrincipalAxes::of(&effective).values);
        let scale = p.compression_limit.max(trial.norm());
        let error = (returned - expected).norm() / scale;
        assert!(
            error < 1e-8,
            "{number}: {trial:?} {returned:?} {expected:?}"
        );
        // As it comes out, not rebuilt from the plastic strain, which is rounded as the trial is.
        let borne = Stress(nominal.0.map(|s| s / (1.0 - new[10])));
        let distance = 1e-12 * p.compression_limit.max(borne.matrix().norm());
        assert!(
            is_within(&law, &borne, (&new, case.size), distance),
            "{number}: {:e}",
            law.yield_function(&borne, &new, case.size)
        );
        for i in 0..6 {
            let weakened = (1.0 - new[10]) * effective.0[i];
            assert!((nominal.0[i] - weakened).abs() < 1e-12 * scale);
        }
        // The flow has no other axes than the trial.
        let plastic = Stress(core::array::from_fn(|i| {
            if i < 3 { new[i] } else { 0.5 * new[i] }
        }));
        let commutator = plastic.matrix() * elastic.matrix() - elastic.matrix() * plastic.matrix();
        assert!(
            commutator.norm() < 1e-12 * elastic.matrix().norm() * plastic.matrix().norm().max(1e-9)
        );
    }
    assert!(apexes > 300, "{apexes}");
}

/// The work of full opening and of crushing is the fracture energy, whatever the size of the element.
#[test]
fn cracks_and_crushing_dissipate_their_energies() {
    for p in [GOOD, hardening()] {
        let law = LeeFenves::new(LeeFenvesParameters {
            residual_stiffness: 1e-6,
            ..p
        })
        .unwrap();
        for size in [0.02, 0.1, 0.5] {
            law.check_size(size).unwrap();
            for (energy, strength, sign) in [
                (133.0, p.tension_strength, 1.0),
                (35.96e3, p.compression_strength, -1.0),
            ] {
                let mut point = PointDriver::new(law).with_size(size).unwrap();
                let end = sign * 6.0 * energy / strength / size;
                let work = point.advance(Control::uniaxial(end), 4000).unwrap()[3999].work;
                let error = (work * size / energy - 1.0).abs();
                assert!(error < 3.0e-3, "{size} {energy}: {}", work * size);
            }
        }
    }
}

/// Closed cracks carry pressure with the whole stiffness if it recovers, and with the damaged one if
/// not; opened again, they are as weak as before.
#[test]
fn stiffness_recovers_as_cracks_close() {
    for recovery in [0.0, 0.4, 1.0] {
        let law = LeeFenves::new(LeeFenvesParameters {
            stiffness_recovery: recovery,
            ..hardening()
        })
        .unwrap();
        let mut point = PointDriver::new(law).with_size(0.3).unwrap();
        let opened = point.advance(Control::uniaxial(3.0e-4), 200).unwrap()[199].clone();
        let torn = opened.history[8];
        assert!(torn > 0.3, "{torn}");
        let mut target = Control::uniaxial(0.0);
        target[2] = Control::Stress(-0.1e6);
        let closed = point.advance(target, 20).unwrap()[19].clone();
        let modulus = closed.stress.0[2] / (closed.strain.0[2] - closed.history[2]);
        let expected = 25.0e9 * (1.0 - (1.0 - recovery) * torn);
        assert!(
            (modulus / expected - 1.0).abs() < 1e-6,
            "{modulus:e} {expected:e}"
        );
        let end = opened.strain.0[2];
        let again = point.advance(Control::uniaxial(end), 50).unwrap()[49]
            .stress
            .0[2];
        assert!((again - opened.stress.0[2]).abs() < 1e-6 * 1.27e6);
    }
}

fn end(law: &LeeFenves, end: [f64; 6], parts: usize) -> ([f64; 6], [f64; 15]) {
    let (mut old, mut new) = ([0.0; 15], [0.0; 15]);
    let mut stress = [0.0; 6];
    for part in 1..=parts {
        let strain = end.map(|e| e * part as f64 / parts as f64);
        let input = LawInput::new(Strain(strain), &old).with_size(0.2);
        stress = law.stress_change(&input, &mut new).0;
        old = new;
    }
    (stress, old)
}

/// On straight paths on which the deviator keeps its direction and the share of tension stays one
/// or zero, the end does not depend on the number of increments; on others it converges with their
/// first power.
#[test]
fn split_increments_end_alike_or_converge() {
    let law = LeeFenves::new(hardening()).unwrap();
    for path in [
        [2.0e-4, 1.9e-4, 1.8e-4, 0.0, 0.0, 0.0],
        [0.4e-3, 0.3e-3, -4.0e-3, 0.0, 3.0e-4, 0.0],
    ] {
        let (whole, history) = end(&law, path, 1);
        assert!(history[6].max(history[7]) > 5.0e-5, "{history:?}");
        for parts in [10, 1000] {
            let (stress, parted) = end(&law, path, parts);
            for i in 0..6 {
                assert!((stress[i] - whole[i]).abs() < 1e-8 * 9.0e6);
            }
            for i in 0..11 {
                assert!((parted[i] - history[i]).abs() < 1e-8, "{i}");
            }
        }
    }
    let path = [3.0e-4, 0.0, -1.0e-3, 4.0e-4, 0.0, 0.0];
    let stress = |parts| Vector3::from_row_slice(&end(&law, path, parts).0[..3]);
    let limit = stress(1 << 16);
    let error = |parts| (stress(parts) - limit).norm();
    let slope = (error(256) / error(2048)).log2() / 3.0;
    assert!((slope - 1.0).abs() < 0.15, "{slope}");
}

/// Elements too wide, a dilation that would generate energy, and numbers out of range are refused by
/// name.
#[test]
fn invalid_parameters_are_refused() {
    let law = LeeFenves::new(hardening()).unwrap();
    let largest = law.largest_size();
    assert_eq!(law.check_size(0.999 * largest), Ok(()));
    let size = 1.001 * largest;
    assert_eq!(
        law.check_size(size),
        Err(MaterialError::SnapBack {
            of: SofteningOf::Compression,
            size,
            largest
        })
    );
    let refused = |p: LeeFenvesParameters, name: &str| match LeeFenves::new(p) {
        Err(MaterialError::Parameter(error)) => assert_eq!(error.name, name),
        other => panic!("{other:?}"),
    };
    refused(
        LeeFenvesParameters {
            dilation: 50.0,
            ..GOOD
        },
        "dilation",
    );
    refused(
        LeeFenvesParameters {
            tension_strength: f64::NAN,
            ..GOOD
        },
        "tension_strength",
    );
    refused(
        LeeFenvesParameters {
            compression_limit: 17.0e6,
            ..GOOD
        },
        "compression_limit",
    );
    refused(
        LeeFenvesParameters {
            tension_energy: 0.0,
            ..GOOD
        },
        "energy",
    );
}
