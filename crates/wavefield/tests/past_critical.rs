//! SV waves past the critical angle: complex coefficients, decay with depth, forerunners.

use crate::support::{self, SURFACE, motion, parameters, residuals, rock, wave};
use powerhouse_model::{FieldMotion, IncidentField, Vec3};
use powerhouse_wavefield::{
    BaselineCorrection, Complex, EndDisplacement, PlaneWave, QuietStartLimits, Ricker,
    RickerQuantity, Signal, SmoothPulse, SurfaceReflection, TimeHistory, WaveError, WaveKind,
    ZeroMeanPulse, critical_angle,
};
use std::f64::consts::PI;
use std::sync::Arc;

const POISSON: f64 = 0.27;

/// `A(t + i h) = (i / pi) int f(s) / (t + i h - s) ds`, of displacement and velocity, by quadrature
/// with midpoints that lie evenly about t: for h = 0 the principal value.
fn analytic(signal: &dyn Signal, time: f64, height: f64) -> [Complex; 2] {
    let support = signal.support();
    let step = (support.step / 8.0).min(if height > 0.0 {
        height / 8.0
    } else {
        f64::INFINITY
    });
    let first = ((time - support.end) / step - 0.5).floor() as i64;
    let last = ((time - support.start) / step - 0.5).ceil() as i64;
    let mut sum = [Complex::new(0.0, 0.0); 2];
    for i in first..=last {
        let lag = (i as f64 + 0.5) * step;
        let motion = signal.motion(time - lag);
        let kernel = Complex::new(0.0, step / PI) / Complex::new(lag, height);
        sum[0] += kernel * motion.displacement;
        sum[1] += kernel * motion.velocity;
    }
    if height == 0.0 {
        let motion = signal.motion(time);
        sum[0].re = motion.displacement;
        sum[1].re = motion.velocity;
    }
    sum
}

/// A delayed wave is the same wave at an earlier time, and keeps the taper of its quiet
/// start.
#[test]
fn a_later_wave_is_the_same_wave() {
    let pulse: Arc<dyn Signal> = Arc::new(ZeroMeanPulse::new(0.01, 0.4).unwrap());
    let points = [
        Vec3::new(-80.0, 30.0, -150.0),
        Vec3::new(80.0, -30.0, SURFACE),
    ];
    let limits = QuietStartLimits::default();
    for degrees in [20.0, 42.0] {
        let field = wave(WaveKind::SV, POISSON, degrees, 15.0, pulse.clone());
        let (field, _) = field.with_quiet_start(&points, 0.0, &limits).unwrap();
        let later = field.later(0.7);
        assert_eq!(later.parameters().arrival, field.parameters().arrival + 0.7);
        for point in points {
            for time in [0.2, 0.6, 1.1] {
                let (now, then) = (
                    motion(&field, point, time),
                    motion(&later, point, time + 0.7),
                );
                let apart = (now.displacement - then.displacement).norm();
                assert!(apart < 1e-12, "{degrees} degrees, {time} s: {apart}");
            }
        }
        let level = later.start_level(&points, 0.0).unwrap().largest();
        assert!(level < limits.threshold, "{level}");
    }
}

/// Displacement and velocity by the formulas, without the tables.
fn oracle(field: &PlaneWave, signal: &dyn Signal, point: Vec3, time: f64) -> [Vec3; 2] {
    let parameters = field.parameters();
    let reflection =
        SurfaceReflection::new(WaveKind::SV, parameters.incidence, &parameters.medium).unwrap();
    let (cp, cs) = (parameters.medium.p_speed(), parameters.medium.s_speed());
    let (sine, cosine) = parameters.incidence.radians().sin_cos();
    let along = Vec3::new(
        parameters.azimuth.radians().cos(),
        parameters.azimuth.radians().sin(),
        0.0,
    );
    let offset = point - parameters.reference;
    let horizontal = sine / cs * offset.dot(&along);
    let up = (SURFACE - parameters.reference.z) * cosine / cs;
    let depth = SURFACE - point.z;
    let kappa = ((sine / cs).powi(2) - 1.0 / (cp * cp)).sqrt();
    let i = Complex::new(0.0, 1.0);
    let waves = [
        (
            Complex::new(cosine, 0.0),
            Complex::new(-sine, 0.0),
            offset.z * cosine / cs,
            0.0,
        ),
        (
            -reflection.same * cosine,
            -reflection.same * sine,
            up + depth * cosine / cs,
            0.0,
        ),
        (
            reflection.converted * (sine * cp / cs),
            reflection.converted * i * kappa * cp,
            up,
            kappa * depth,
        ),
    ];
    let mut found = [Vec3::zeros(); 2];
    for (x, z, delay, height) in waves {
        let values = analytic(signal, time - horizontal - delay, height);
        for (found, value) in found.iter_mut().zip(values) {
            *found += along * (x * value).re + Vec3::z() * (z * value).re;
        }
    }
    found
}

/// Largest difference from the formulas over the peaks, in displacement and velocity.
fn misfit(signal: Arc<dyn Signal>, degrees: f64, depths: &[f64], lags: &[f64]) -> [f64; 2] {
    let field = wave(WaveKind::SV, POISSON, degrees, 37.0, signal.clone());
    let reference = field.parameters().reference;
    let points: Vec<Vec3> = depths
        .iter()
        .map(|depth| Vec3::new(reference.x + 3.0, reference.y + 100.0, SURFACE - depth))
        .collect();
    let sampler = field.prepare(&points).unwrap();
    let (mut difference, mut peak) = ([0.0f64; 2], [0.0f64; 2]);
    for lag in lags {
        let mut motion = vec![FieldMotion::default(); points.len()];
        sampler.add_motion(*lag, &mut motion);
        for (point, motion) in points.iter().zip(motion) {
            let expected = oracle(&field, &*signal, *point, *lag);
            for (i, found) in [motion.displacement, motion.velocity]
                .into_iter()
                .enumerate()
            {
                difference[i] = difference[i].max((found - expected[i]).norm());
                peak[i] = peak[i].max(expected[i].norm());
            }
        }
    }
    [difference[0] / peak[0], difference[1] / peak[1]]
}

/// The field of pulses agrees with the formulas at all depths, from far before the incident wave
/// to far after it: to 1e-6 of the peak in displacement and 1e-4 in velocity where the
/// acceleration of the pulse has kinks, 1e-7 where it is smooth.
#[test]
fn the_field_agrees_with_the_formulas() {
    let depths = [0.0, 0.7, 5.0, 33.3, 150.0, 700.0, 3e3, 3e4];
    let lags: Vec<f64> = (-30..=30)
        .map(|i| i as f64 / 10.0)
        .chain([-300.0, -30.0, -7.0, 7.0, 30.0, 300.0])
        .collect();
    let smooth: Arc<dyn Signal> = Arc::new(SmoothPulse::new(1.0, 0.8).unwrap());
    let zero_mean: Arc<dyn Signal> = Arc::new(ZeroMeanPulse::new(1.0, 0.8).unwrap());
    let ricker: Arc<dyn Signal> =
        Arc::new(Ricker::new(RickerQuantity::Velocity, 1.0, 3.0, 0.6).unwrap());
    for (name, signal, limits) in [
        ("smooth_pulse", smooth, [1e-6, 1e-4]),
        ("zero_mean_pulse", zero_mean, [1e-6, 1e-4]),
        ("ricker", ricker, [1e-7, 1e-7]),
    ] {
        for degrees in [34.3, 36.0, 60.0, 85.0] {
            let [displacement, velocity] = misfit(signal.clone(), degrees, &depths, &lags);
            println!("figure wavefield.{name}.sv{degrees}.displacement {displacement:e}");
            println!("figure wavefield.{name}.sv{degrees}.velocity {velocity:e}");
            assert!(
                displacement < limits[0] && velocity < limits[1],
                "{name} {degrees}"
            );
        }
    }
}

/// A record with a corner at every sample agrees to 1e-5 in displacement and 1e-3 in velocity.
#[test]
fn a_record_agrees_with_the_formulas() {
    let signal = el_centro();
    let lags: Vec<f64> = (-5..40).map(|i| 0.613 * i as f64).collect();
    for degrees in [36.0, 60.0] {
        let [displacement, velocity] =
            misfit(signal.clone(), degrees, &[0.0, 3.0, 70.0, 150.0], &lags);
        println!("figure wavefield.record.sv{degrees}.displacement {displacement:e}");
        println!("figure wavefield.record.sv{degrees}.velocity {velocity:e}");
        assert!(displacement < 1e-5 && velocity < 1e-3, "{degrees}");
    }
}

/// El Centro, 20 s, at rest at its end.
fn el_centro() -> Arc<dyn Signal> {
    let rows = include_str!("../../../data/records/el_centro_1940_ns.csv").lines();
    let rows = rows.filter(|line| !line.starts_with('#'));
    let samples = rows.map(|row| row.split(',').nth(1).unwrap().parse().unwrap());
    let record = TimeHistory::new(0.02, samples.collect()).unwrap();
    let method = BaselineCorrection::VelocityPolynomial { order: 5 };
    let record = record
        .truncated(20.0, 0.0)
        .unwrap()
        .corrected(method)
        .unwrap()
        .0;
    Arc::new(record.into_signal(EndDisplacement::Zero).unwrap())
}

/// Inside, the field satisfies the equation of motion and its stress is that of its displacement,
/// under the decaying wave too: residuals are those of the tables.
#[test]
fn the_field_is_elastic_and_in_motion() {
    let ricker = Arc::new(Ricker::new(RickerQuantity::Displacement, 1e-3, 3.0, 0.6).unwrap());
    for degrees in [34.3, 40.0, 60.0, 85.0] {
        let field = wave(WaveKind::SV, POISSON, degrees, 37.0, ricker.clone());
        for depth in [5.0, 40.0, 300.0] {
            let point = Vec3::new(20.0, 11.0, SURFACE - depth);
            let (motion, stress) = residuals(&field, point, 0.72, 2.0);
            assert!(
                motion < 1e-4 && stress < 1e-4,
                "{degrees} {depth} {motion:e} {stress:e}"
            );
        }
    }
}

/// Across the critical angle the field is continuous: it changes as the square root of the
/// distance from it.
#[test]
fn the_field_is_continuous_across_the_critical_angle() {
    let critical = critical_angle(&rock(POISSON)).degrees();
    let ricker = Arc::new(Ricker::new(RickerQuantity::Displacement, 1.0, 3.0, 0.6).unwrap());
    let point = Vec3::new(20.0, 11.0, -60.0);
    let mut jumps = Vec::new();
    for distance in [1e-4, 1e-6, 1e-8] {
        let at = |degrees: f64| wave(WaveKind::SV, POISSON, degrees, 0.0, ricker.clone());
        let (below, above) = (at(critical - distance), at(critical + distance));
        assert!(below.is_causal() && !above.is_causal());
        let jump = (60..90).map(|i| {
            let time = 0.01 * i as f64;
            let difference =
                motion(&below, point, time).displacement - motion(&above, point, time).displacement;
            difference.norm()
        });
        jumps.push(jump.fold(0.0, f64::max));
    }
    for pair in jumps.windows(2) {
        let ratio = pair[0] / pair[1];
        assert!((8.0..12.5).contains(&ratio), "{jumps:?}");
    }
}

/// A signal that ends displaced has no field past the critical angle, and is refused.
#[test]
fn a_permanent_displacement_is_refused() {
    let swing = |i: usize| (0.05 * PI * i as f64).sin();
    let record = TimeHistory::new(0.1, (0..=40).map(swing).collect()).unwrap();
    let end = EndDisplacement::Declared(record.report().end_displacement);
    let signal = Arc::new(record.into_signal(end).unwrap());
    assert!(PlaneWave::new(parameters(WaveKind::SV, POISSON, 20.0, 0.0), signal.clone()).is_ok());
    let refused = PlaneWave::new(parameters(WaveKind::SV, POISSON, 50.0, 0.0), signal);
    assert!(matches!(
        refused,
        Err(WaveError::PermanentDisplacement { .. })
    ));
}

fn box_points() -> Vec<Vec3> {
    let mut points = Vec::new();
    for x in [-80.0, 0.0, 80.0] {
        for z in [-150.0, -75.0, SURFACE] {
            points.push(Vec3::new(x, 30.0, z));
        }
    }
    points
}

/// Points prepared one by one, in any order and by clones of the wave, move to the last bit as they
/// do when they are prepared together: the tables that samplers share depend on no sampler.
#[test]
fn points_move_alike_however_they_are_prepared() {
    let ricker = Arc::new(Ricker::new(RickerQuantity::Displacement, 1.0, 3.0, 0.6).unwrap());
    let together = wave(WaveKind::SV, POISSON, 45.0, 30.0, ricker.clone());
    let apart = wave(WaveKind::SV, POISSON, 45.0, 30.0, ricker).clone();
    let points = box_points();
    let mut all = vec![FieldMotion::default(); points.len()];
    let time = 0.63;
    together
        .prepare(&points)
        .unwrap()
        .add_motion(time, &mut all);
    for (point, expected) in points.iter().zip(&all).rev() {
        let mut one = [FieldMotion::default()];
        let sampler = apart.clone().prepare(&[*point]).unwrap();
        sampler.add_motion(time, &mut one);
        assert!(expected.displacement.norm() > 0.0);
        assert_eq!(one[0], *expected);
    }
}

/// Past the critical angle the field begins before its arrival, and its forerunner falls only as 1/t for
/// a one-sided pulse: some per cent are left at -1 s; below the critical angle the field is zero.
#[test]
fn the_forerunner_is_reported() {
    let pulse = Arc::new(SmoothPulse::new(1.0, 0.8).unwrap());
    let level = |degrees: f64, time: f64| {
        let field = wave(WaveKind::SV, POISSON, degrees, 0.0, pulse.clone());
        field.start_level(&box_points(), time).unwrap()
    };
    assert_eq!(level(30.0, 0.0).largest(), 0.0);
    let (near, far) = (
        level(38.0, -4.0).displacement,
        level(38.0, -8.0).displacement,
    );
    assert!((0.001..0.05).contains(&near), "{near}");
    // The pulse is 0.8 s long and at most 0.4 s farther away.
    assert!((near / far - 2.0).abs() < 0.15, "{near} {far}");
}

/// A quiet start leaves less than the threshold at the start; the field still satisfies the
/// equation of motion and the free surface, and the signal itself is changed by no more.
#[test]
fn a_quiet_start_is_still_a_field() {
    let threshold = 1e-4;
    let ricker = Ricker::new(RickerQuantity::Displacement, 1.0, 3.0, 0.6).unwrap();
    let smooth = SmoothPulse::new(1.0, 0.8).unwrap();
    let signals: [(&str, Arc<dyn Signal>); 3] = [
        ("ricker", Arc::new(ricker)),
        ("smooth_pulse", Arc::new(smooth)),
        ("record", el_centro()),
    ];
    for (name, signal) in signals {
        for degrees in [38.0, 60.0] {
            let field = wave(WaveKind::SV, POISSON, degrees, 37.0, signal.clone());
            let points = box_points();
            let (quiet, report) = field
                .with_quiet_start(&points, 0.0, &QuietStartLimits::default())
                .unwrap();
            println!(
                "figure wavefield.{name}.quiet_start.sv{degrees}.padding {}",
                report.padding
            );
            println!(
                "figure wavefield.{name}.quiet_start.sv{degrees}.removed {:e}",
                report.removed
            );
            assert!(
                report.level.largest() < threshold && report.padding < 2.5,
                "{report:?}"
            );
            // Computed again, with peaks at instants that differ by rounding.
            let again = quiet.start_level(&points, 0.0).unwrap().largest();
            assert!((again / report.level.largest() - 1.0).abs() < 1e-2);
            // Free surface and equation of motion, also where the taper acts.
            for time in [0.7 * report.padding, report.padding + 0.5] {
                let surface = motion(&quiet, points[2], time).stress;
                let inside = motion(&quiet, points[1], time).stress;
                let traction = surface.traction(&Vec3::z()).amax();
                assert!(traction < 1e-12 * support::size(&inside.0), "{traction:e}");
            }
            // Once the signal has begun in all waves, the field is what it was without the taper.
            let begun = support::latest_arrival(&field, points[1]) + signal.support().start;
            let (mut difference, mut peak) = (0.0f64, 0.0f64);
            for i in 0..40 {
                let time = begun + 0.02 * i as f64;
                let before = motion(&field, points[1], time).displacement;
                let after = motion(&quiet, points[1], time + report.padding).displacement;
                difference = difference.max((after - before).norm());
                peak = peak.max(before.norm());
            }
            assert!(
                difference < 2.0 * threshold * peak,
                "{difference:e} {peak:e}"
            );
            // The incident wave is the signal, delayed.
            let incident = quiet.incident_part().unwrap();
            let reference = field.parameters().reference;
            let support = signal.support();
            for i in 0..50 {
                let time = support.start + (support.end - support.start) * i as f64 / 50.0;
                let found = motion(&*incident, reference, time + report.padding);
                let expected = signal.motion(time).displacement;
                assert!((found.displacement.norm() - expected.abs()).abs() < threshold);
            }
        }
    }
}

/// The equation of motion holds with a taper as without one.
#[test]
fn a_tapered_field_is_in_motion() {
    let ricker = Arc::new(Ricker::new(RickerQuantity::Displacement, 1.0, 3.0, 0.6).unwrap());
    let field = wave(WaveKind::SV, POISSON, 38.0, 37.0, ricker);
    let (quiet, report) = field
        .with_quiet_start(&box_points(), 0.0, &QuietStartLimits::default())
        .unwrap();
    for time in [0.5, 0.8, 1.0].map(|share| share * report.padding) {
        let (motion, stress) = residuals(&quiet, Vec3::new(20.0, 11.0, -60.0), time, 2.0);
        assert!(
            motion < 1e-3 && stress < 1e-3,
            "{time} {motion:e} {stress:e}"
        );
    }
}

/// Where the permitted padding does not suffice the error states the level; a causal field needs
/// none.
#[test]
fn padding_has_its_limit() {
    let pulse = Arc::new(SmoothPulse::new(1.0, 0.8).unwrap());
    let limits = |most_padding| QuietStartLimits {
        most_padding,
        ..QuietStartLimits::default()
    };
    let field = wave(WaveKind::SV, POISSON, 38.0, 0.0, pulse.clone());
    let refused = field.with_quiet_start(&box_points(), 0.0, &limits(0.1));
    assert!(
        refused
            .err()
            .unwrap()
            .to_string()
            .contains("0.1 s of padding")
    );
    let causal = wave(WaveKind::SV, POISSON, 30.0, 0.0, pulse);
    let (_, report) = causal
        .with_quiet_start(&box_points(), 0.0, &limits(0.0))
        .unwrap();
    assert_eq!(
        (report.padding, report.removed, report.taper),
        (0.0, 0.0, 0.0)
    );
}

/// A wider taper keeps more of the forerunner and takes more padding.
#[test]
fn a_wider_taper_keeps_more() {
    let pulse = Arc::new(SmoothPulse::new(1.0, 0.8).unwrap());
    let field = wave(WaveKind::SV, POISSON, 38.0, 0.0, pulse);
    let report = |least_taper| {
        let limits = QuietStartLimits {
            least_taper,
            ..QuietStartLimits::default()
        };
        field
            .with_quiet_start(&box_points(), 0.0, &limits)
            .unwrap()
            .1
    };
    let (narrow, wide) = (report(0.0), report(0.5));
    assert!(wide.removed < 0.5 * narrow.removed, "{wide:?} {narrow:?}");
    assert!(wide.padding > narrow.padding && wide.taper == 0.5);
}
