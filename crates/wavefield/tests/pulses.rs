//! Pulses: derivatives, continuity, peaks and moments.

use powerhouse_wavefield::{
    HarmonicBurst, Ricker, RickerQuantity, Signal, SmoothPulse, ZeroMeanPulse,
};

fn pulses() -> [(&'static str, Box<dyn Signal>); 5] {
    let ricker = |quantity| Box::new(Ricker::new(quantity, 2.0, 3.0, 0.6).unwrap());
    [
        ("smooth", Box::new(SmoothPulse::new(2.0, 0.8).unwrap())),
        ("zero mean", Box::new(ZeroMeanPulse::new(2.0, 0.8).unwrap())),
        ("ricker u", ricker(RickerQuantity::Displacement)),
        ("ricker v", ricker(RickerQuantity::Velocity)),
        (
            "burst",
            Box::new(HarmonicBurst::new(2.0, 4.0, 5.0).unwrap()),
        ),
    ]
}

/// Velocity and acceleration are the derivatives of displacement and velocity.
#[test]
fn derivatives_are_derivatives() {
    let step = 1e-4;
    for (name, pulse) in pulses() {
        for i in -20..400 {
            // Off the kinks of the accelerations, which lie at multiples of 0.1 s.
            let time = 0.00517 * i as f64 + 0.0003;
            let (a, b) = (pulse.motion(time - step), pulse.motion(time + step));
            let found = pulse.motion(time);
            let velocity = (b.displacement - a.displacement) / (2.0 * step);
            let acceleration = (b.velocity - a.velocity) / (2.0 * step);
            // step^2 / 6 times the next derivative but one, at most (2 pi 4)^3 to (2 pi 4)^4 times 2.
            assert!((found.velocity - velocity).abs() < 2e-3, "{name} {time}");
            assert!(
                (found.acceleration - acceleration).abs() < 0.3,
                "{name} {time}"
            );
        }
    }
}

/// At both ends of its interval a pulse is at rest in every quantity that is documented as continuous.
#[test]
fn pulses_begin_and_end_at_rest() {
    for (name, pulse) in pulses() {
        let support = pulse.support();
        assert!(support.step > 0.0 && support.end > support.start);
        for time in [
            support.start - 1e-9,
            support.start,
            support.end,
            support.end + 1e-9,
        ] {
            let motion = pulse.motion(time);
            assert!(motion.displacement.abs() < 1e-13, "{name}");
            assert!(motion.velocity.abs() < 1e-11, "{name}");
            assert!(
                motion.acceleration.abs() < 1e-6,
                "{name} {}",
                motion.acceleration
            );
        }
        for time in [-1e9, 1e9, f64::NEG_INFINITY, f64::INFINITY] {
            assert_eq!(pulse.motion(time), Default::default(), "{name}");
        }
    }
}

/// Peaks are the amplitudes, where the documentation says.
#[test]
fn peaks_are_the_amplitudes() {
    assert!((SmoothPulse::new(2.0, 0.8).unwrap().motion(0.4).displacement - 2.0).abs() < 1e-15);
    assert!(
        (ZeroMeanPulse::new(2.0, 0.8)
            .unwrap()
            .motion(0.4)
            .displacement
            - 2.0)
            .abs()
            < 1e-15
    );
    let at = |quantity| Ricker::new(quantity, 2.0, 3.0, 0.6).unwrap().motion(0.6);
    assert_eq!(at(RickerQuantity::Displacement).displacement, 2.0);
    assert_eq!(at(RickerQuantity::Velocity).velocity, 2.0);
    for (name, pulse) in &pulses()[..3] {
        for i in 0..=1000 {
            let displacement = pulse.motion(0.0012 * i as f64).displacement;
            assert!(displacement.abs() <= 2.0 + 1e-12, "{name}");
        }
    }
}

/// The zero-mean pulse has neither a mean nor a first moment; nor has a Ricker displacement.
#[test]
fn zero_means_are_zero() {
    for (name, pulse) in [&pulses()[1], &pulses()[2]] {
        let support = pulse.support();
        let step = (support.end - support.start) / 4000.0;
        let (mut mean, mut first) = (0.0, 0.0);
        for i in 0..=4000 {
            let time = support.start + step * i as f64;
            let area = pulse.motion(time).displacement * step;
            mean += area;
            first += area * time;
        }
        // The trapezoidal rule errs by step^4 for functions that end with zero second derivatives.
        assert!(
            mean.abs() < 1e-9 && first.abs() < 1e-9,
            "{name} {mean:e} {first:e}"
        );
    }
}

/// Batches and single values agree, also across the ends of the interval.
#[test]
fn samples_are_motions() {
    for (name, pulse) in pulses() {
        let times: Vec<f64> = (-30..200).map(|i| 0.0123 * i as f64).collect();
        let (mut d, mut v) = (vec![0.0; times.len()], vec![0.0; times.len()]);
        pulse.sample(&times, &mut d, &mut v);
        for (i, time) in times.iter().enumerate() {
            let motion = pulse.motion(*time);
            assert_eq!(
                (d[i], v[i]),
                (motion.displacement, motion.velocity),
                "{name}"
            );
        }
    }
}

/// Pulses of zero duration or frequency, or of amplitudes that are NaN, are refused by name.
#[test]
fn impossible_pulses_are_refused() {
    let text = |error: powerhouse_wavefield::WaveError| error.to_string();
    assert!(text(SmoothPulse::new(1.0, 0.0).unwrap_err()).contains("duration"));
    assert!(text(ZeroMeanPulse::new(f64::NAN, 1.0).unwrap_err()).contains("amplitude"));
    let ricker = Ricker::new(RickerQuantity::Velocity, 1.0, -3.0, 0.0);
    assert!(text(ricker.unwrap_err()).contains("frequency"));
    let ricker = Ricker::new(RickerQuantity::Velocity, 1.0, 3.0, f64::NAN);
    assert!(text(ricker.unwrap_err()).contains("delay"));
    assert!(text(HarmonicBurst::new(1.0, 1.0, 0.5).unwrap_err()).contains("cycles"));
}
