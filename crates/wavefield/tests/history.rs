//! Records: exact integration, editing, baseline, motion at the end.

use powerhouse_wavefield::{BaselineCorrection, EndDisplacement, Signal, TimeHistory, WaveError};

const EL_CENTRO: &str = include_str!("../../../data/records/el_centro_1940_ns.csv");

fn el_centro() -> TimeHistory {
    let rows = EL_CENTRO.lines().filter(|line| !line.starts_with('#'));
    let samples = rows.map(|row| row.split(',').nth(1).unwrap().parse().unwrap());
    TimeHistory::new(0.02, samples.collect()).unwrap()
}

/// A constant acceleration gives a t and a t^2 / 2 at every time, between samples too.
#[test]
fn constant_acceleration_is_exact() {
    let history = TimeHistory::new(0.1, vec![3.0; 11]).unwrap();
    for i in 0..=100 {
        let t = 0.01 * i as f64;
        let motion = history.motion(t);
        assert!((motion.acceleration - 3.0).abs() < 1e-14);
        assert!((motion.velocity - 3.0 * t).abs() < 1e-14);
        assert!((motion.displacement - 1.5 * t * t).abs() < 1e-14);
    }
}

/// A linear acceleration gives its parabola and cubic at every time.
#[test]
fn linear_acceleration_is_exact() {
    let history = TimeHistory::new(0.1, (0..11).map(|i| 1.0 - 0.4 * i as f64).collect()).unwrap();
    for i in 0..=100 {
        let t = 0.01 * i as f64;
        let motion = history.motion(t);
        assert!((motion.acceleration - (1.0 - 4.0 * t)).abs() < 1e-13);
        assert!((motion.velocity - (t - 2.0 * t * t)).abs() < 1e-13);
        assert!((motion.displacement - (0.5 * t * t - 2.0 / 3.0 * t * t * t)).abs() < 1e-13);
    }
}

/// Before its start a history is at rest, after its end at rest and displaced, also at times that are
/// NaN; two samples and a step suffice.
#[test]
fn a_history_is_defined_at_all_times() {
    for samples in [vec![0.0, 1.0], vec![1.0, 1.0], vec![0.0, 0.0, 5.0, 5.0]] {
        let history = TimeHistory::new(0.5, samples).unwrap();
        let end = history.motion(history.duration());
        for time in [-1e300, -1.0, -1e-300, f64::NAN, f64::NEG_INFINITY] {
            assert_eq!(history.motion(time), Default::default());
        }
        for time in [history.duration() + 1e-9, 1e9, f64::INFINITY] {
            let motion = history.motion(time);
            assert_eq!(motion.displacement, end.displacement);
            assert_eq!((motion.velocity, motion.acceleration), (0.0, 0.0));
        }
    }
}

/// The motion is continuous across samples: no value belongs to the wrong interval.
#[test]
fn motion_is_continuous() {
    let history = el_centro();
    for i in 1..1559 {
        let time = 0.02 * i as f64;
        let (before, after) = (history.motion(time - 1e-9), history.motion(time + 1e-9));
        assert!((before.acceleration - after.acceleration).abs() < 1e-6);
        assert!((before.velocity - after.velocity).abs() < 1e-8);
        assert!((before.displacement - after.displacement).abs() < 1e-8);
    }
}

/// El Centro has its published peak, 3.1266 m/s2, and its uncorrected velocity peak near 0.37 m/s.
#[test]
fn el_centro_has_its_peaks() {
    let report = el_centro().report();
    assert!((report.peak_acceleration - 3.1266).abs() < 5e-5);
    assert!((0.35..0.40).contains(&report.peak_velocity), "{report:?}");
}

/// Peaks between samples are found: a triangle in acceleration has its largest velocity where the
/// acceleration crosses zero, and its largest displacement where the velocity does.
#[test]
fn peaks_between_samples_are_found() {
    // a = 1 - 2 t/3 on [0, 3]: velocity t - t^2/3, largest 0.75 at 1.5 and zero again at 3.
    let report = TimeHistory::new(3.0, vec![1.0, -1.0]).unwrap().report();
    assert!((report.peak_velocity - 0.75).abs() < 1e-15);
    // a = 1 - 2 t/4 on [0, 5]: velocity t - t^2/4 is zero at 4, displacement 8/3 there.
    let report = TimeHistory::new(5.0, vec![1.0, -1.5]).unwrap().report();
    assert!((report.peak_displacement - 8.0 / 3.0).abs() < 1e-14);
    assert!((report.end_displacement - (12.5 - 125.0 / 12.0)).abs() < 1e-14);
    // In the second interval a = -1 + 1.5 t: velocity 0.1875 - t + 0.75 t^2 vanishes once in it.
    for sign in [1.0, -1.0] {
        let samples = [1.375, -1.0, 0.5].map(|a| sign * a);
        let history = TimeHistory::new(1.0, samples.to_vec()).unwrap();
        let root = history.motion(1.0 + (1.0 - 0.4375f64.sqrt()) / 1.5);
        assert!((history.motion(1.0).velocity - sign * 0.1875).abs() < 1e-15);
        assert!(root.velocity.abs() < 1e-15);
        let peak = history.report().peak_displacement;
        assert!((peak - root.displacement.abs()).abs() < 1e-15);
    }
}

/// A usual sequence of operations: 20 s of a record, baseline, scaled to 1.7 m/s2, a signal at rest
/// at its end.
#[test]
fn el_centro_becomes_a_signal() {
    let cut = el_centro().truncated(20.0, 0.0).unwrap();
    assert_eq!(cut.samples(), 1001);
    let method = BaselineCorrection::VelocityPolynomial { order: 5 };
    let (corrected, report) = cut.corrected(method).unwrap();
    assert!(report.after.end_velocity.abs() < 1e-12 && report.after.end_displacement.abs() < 1e-12);
    // The correction is small beside the record.
    assert!(
        report.largest_change < 0.05 * report.before.peak_acceleration,
        "{report:?}"
    );
    let signal = corrected.scaled_to_peak(1.7).unwrap();
    let signal = signal.into_signal(EndDisplacement::Zero).unwrap();
    assert!((signal.report().peak_acceleration - 1.7).abs() < 1e-12);
    let support = signal.support();
    assert!(support.end > 20.0 && support.end < 22.0);
    assert_eq!(signal.motion(support.end + 1.0), Default::default());
    // The closing segment stays within the record's own range.
    let report = signal.history().report();
    assert!((report.peak_acceleration - 1.7).abs() < 1e-12);
}

/// A drifting record is refused with its end values, and the corrections do what is documented.
#[test]
fn drifting_records_are_refused() {
    let drifting = TimeHistory::new(0.1, vec![1.0; 20]).unwrap();
    let refused = drifting.clone().into_signal(EndDisplacement::Zero);
    assert!(matches!(refused, Err(WaveError::EndVelocity { .. })));
    let swing = |i: usize| (0.05 * std::f64::consts::PI * i as f64).sin();
    let displaced = TimeHistory::new(0.1, (0..=40).map(swing).collect()).unwrap();
    let end = displaced.report().end_displacement;
    let refused = displaced.clone().into_signal(EndDisplacement::Zero);
    assert!(matches!(refused, Err(WaveError::EndDisplacement { .. })));
    let declared = displaced
        .into_signal(EndDisplacement::Declared(end))
        .unwrap();
    let rest = declared.motion(1e3);
    assert_eq!((rest.displacement, rest.velocity), (end, 0.0));
}

/// After its closing segment a record has exactly the declared displacement, without a jump.
#[test]
fn the_closing_segment_is_smooth() {
    let (history, _) = el_centro()
        .truncated(11.3, 0.0)
        .unwrap()
        .corrected(BaselineCorrection::Mean)
        .unwrap();
    let end = history.report().end_displacement * (1.0 - 0.004);
    let start = history.duration();
    let signal = history.into_signal(EndDisplacement::Declared(end)).unwrap();
    let stop = signal.support().end;
    let times = (0..=1000).map(|i| start + (stop - start) * 1.01 * i as f64 / 1000.0);
    for time in times.chain([start, stop]) {
        let (before, after) = (signal.motion(time - 1e-8), signal.motion(time + 1e-8));
        assert!((before.acceleration - after.acceleration).abs() < 1e-5);
        assert!((before.velocity - after.velocity).abs() < 1e-6);
        assert!((before.displacement - after.displacement).abs() < 1e-7);
    }
    assert_eq!(signal.motion(stop + 1.0).displacement, end);
}

/// Baseline corrections remove what they are named after, exactly where they say so.
#[test]
fn baseline_corrections_do_what_their_names_say() {
    let record = el_centro();
    let after = |method| record.corrected(method).unwrap().1.after;
    assert_eq!(after(BaselineCorrection::None), record.report());
    assert!(after(BaselineCorrection::Mean).end_velocity.abs() < 1e-12);
    for order in 2..=9 {
        let rest = after(BaselineCorrection::VelocityPolynomial { order });
        assert!(
            rest.end_velocity.abs() < 1e-11 && rest.end_displacement.abs() < 1e-11,
            "{order}"
        );
    }
    // A polynomial added to a record comes off again, with its integrals.
    let clean = record
        .corrected(BaselineCorrection::LeastVelocity { order: 2 })
        .unwrap()
        .0;
    let drifted = clean.acceleration().into_iter().enumerate().map(|(i, a)| {
        let t = 0.02 * i as f64;
        a + 0.01 - 0.002 * t + 1e-4 * t * t
    });
    let drifted = TimeHistory::new(0.02, drifted.collect()).unwrap();
    for (method, least) in [
        (BaselineCorrection::LeastVelocity { order: 2 }, 1e-9),
        (
            BaselineCorrection::AccelerationPolynomial { order: 2 },
            0.01,
        ),
    ] {
        let again = drifted.corrected(method).unwrap().0;
        let differences = again.acceleration().into_iter().zip(clean.acceleration());
        let worst = differences.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(worst < least, "{method:?} {worst}");
    }
}

/// The high-pass filter halves its corner frequency, passes high ones, stops low ones and has no
/// phase shift.
#[test]
fn the_high_pass_filter_keeps_phase() {
    let burst = |frequency: f64| {
        let samples = (0..=4000).map(|i| {
            let t = 0.01 * i as f64 - 20.0;
            (-(t / 6.0).powi(2)).exp() * (2.0 * std::f64::consts::PI * frequency * t).cos()
        });
        TimeHistory::new(0.01, samples.collect()).unwrap()
    };
    let method = BaselineCorrection::HighPass {
        corner: 1.0,
        order: 2,
    };
    // H = r^4 / (1 + r^4), r = f / fc.
    for (frequency, gain) in [(0.25, 1.0 / 257.0), (1.0, 0.5), (4.0, 256.0 / 257.0)] {
        let (filtered, report) = burst(frequency).corrected(method).unwrap();
        let centre = filtered.motion(20.0 + report.leading_pad).acceleration;
        // The burst is 0.05 Hz wide; the curvature of H over it is below 2 %.
        assert!(
            (centre - gain).abs() < 0.02 * gain.max(0.1),
            "{frequency}: {centre} {gain}"
        );
    }
}

/// Cutting, padding, scaling and refining change what they name and nothing else.
#[test]
fn edits_change_what_they_name() {
    let record = el_centro();
    let twice = record.scaled(2.0).unwrap();
    assert!(
        (twice.motion(3.333).displacement - 2.0 * record.motion(3.333).displacement).abs() < 1e-13
    );
    let fine = record.resampled(0.005).unwrap();
    let padded = record.padded(1.0, 2.0).unwrap();
    assert!((padded.duration() - 34.18).abs() < 1e-9);
    for i in 0..300 {
        let time = 0.1 * i as f64 + 0.0123;
        let expected = record.motion(time);
        for found in [fine.motion(time), padded.motion(time + 1.0)] {
            assert!((found.acceleration - expected.acceleration).abs() < 1e-9);
            assert!((found.displacement - expected.displacement).abs() < 1e-9);
        }
    }
    let tapered = record.truncated(10.0, 2.0).unwrap();
    assert_eq!(tapered.motion(7.9), record.motion(7.9));
    assert!(tapered.motion(10.0).acceleration.abs() < 1e-15);
    let half = tapered.motion(9.0).acceleration / record.motion(9.0).acceleration;
    assert!((half - 0.5).abs() < 1e-12);
}

/// Invalid histories are refused by name: no samples, one, a sample or a step that is
/// NaN, a coarser step, a cut beyond the end, a scale of zero to a peak.
#[test]
fn impossible_histories_are_refused() {
    let few = TimeHistory::new(0.1, vec![1.0]);
    assert!(matches!(
        few,
        Err(WaveError::TooFewSamples { given: 1, .. })
    ));
    for bad in [f64::NAN, f64::INFINITY, f64::MAX] {
        let history = TimeHistory::new(0.1, vec![0.0, bad]);
        assert!(matches!(
            history,
            Err(WaveError::SampleNotFinite { index: 1, .. })
        ));
    }
    for step in [0.0, -0.1, f64::NAN] {
        assert!(TimeHistory::new(step, vec![0.0; 3]).is_err());
    }
    let record = el_centro();
    assert!(record.resampled(0.04).is_err() && record.resampled(1e-9).is_err());
    assert!(record.truncated(40.0, 0.0).is_err() && record.truncated(10.0, 11.0).is_err());
    assert!(record.padded(-1.0, 0.0).is_err() && record.padded(1e9, 0.0).is_err());
    let nothing = TimeHistory::new(0.1, vec![0.0; 5]).unwrap();
    assert_eq!(nothing.scaled_to_peak(1.0), Err(WaveError::ZeroPeak));
    assert!(nothing.into_signal(EndDisplacement::Zero).is_ok());
    let short = TimeHistory::new(0.1, vec![1.0, 2.0]).unwrap();
    let fitted = short.corrected(BaselineCorrection::VelocityPolynomial { order: 4 });
    assert!(matches!(fitted, Err(WaveError::TooFewSamples { .. })));
}

/// Every permitted operation on a short history gives finite numbers.
#[test]
fn short_histories_stay_finite() {
    for samples in [2, 3, 5] {
        let history = TimeHistory::new(0.01, vec![1.0; samples]).unwrap();
        for method in [
            BaselineCorrection::Mean,
            BaselineCorrection::AccelerationPolynomial { order: 0 },
            BaselineCorrection::LeastVelocity { order: 0 },
            BaselineCorrection::HighPass {
                corner: 5.0,
                order: 1,
            },
        ] {
            let (corrected, _) = history.corrected(method).unwrap();
            assert!(
                corrected.report().peak_displacement.is_finite(),
                "{method:?}"
            );
        }
        assert!(history.arias_intensity().is_finite());
        assert!(
            history
                .significant_duration(0.05, 0.95)
                .unwrap()
                .is_finite()
        );
    }
}

/// A batch of a signal's samples is its motion at those times, outside its interval too.
#[test]
fn samples_of_a_signal_are_its_motion() {
    let method = BaselineCorrection::VelocityPolynomial { order: 5 };
    let (record, _) = el_centro().corrected(method).unwrap();
    let signal = record.into_signal(EndDisplacement::Zero).unwrap();
    let mut times: Vec<f64> = (-100..4000).map(|i| 0.00913 * i as f64).collect();
    times.extend((0..1600).map(|i| 0.02 * i as f64));
    times.extend([
        f64::NEG_INFINITY,
        -1e300,
        0.0,
        1e300,
        f64::INFINITY,
        f64::NAN,
    ]);
    let (mut d, mut v) = (vec![1.0; times.len()], vec![1.0; times.len()]);
    signal.sample(&times, &mut d, &mut v);
    for (i, time) in times.iter().enumerate() {
        let motion = signal.motion(*time);
        assert!((d[i] - motion.displacement).abs() < 1e-14, "{time}");
        assert!((v[i] - motion.velocity).abs() < 1e-13, "{time}");
    }
}
