//! Response and Fourier spectra, Arias intensity.

use powerhouse_wavefield::{TimeHistory, broadened_spectrum};
use std::f64::consts::PI;

/// Under a step of ground acceleration an undamped oscillator reaches twice the static
/// displacement, whatever its period and the record's step.
#[test]
fn a_step_doubles_the_static_response() {
    let history = TimeHistory::new(0.1, vec![1.0; 101]).unwrap();
    for period in [0.01, 0.1, 0.7, 3.0] {
        let response = history.response_spectrum(0.0, &[period]).unwrap()[0];
        let stiffness = (2.0 * PI / period).powi(2);
        // At 32 instants a period, a peak is missed by at most 1 - cos(pi/32) of its half.
        let share = response.displacement * stiffness / 2.0;
        assert!(
            (1.0 - 0.5 * (1.0 - (PI / 32.0).cos())..=1.0 + 1e-9).contains(&share),
            "{share}"
        );
        assert!((response.acceleration - response.pseudo_acceleration()).abs() < 1e-9);
    }
}

/// Under a damped harmonic at resonance the amplitude grows as 1 - exp(-z w t) towards
/// a / (2 z w^2).
#[test]
fn resonance_grows_as_theory_says() {
    let (period, damping, step) = (1.0, 0.05, 0.001);
    let w = 2.0 * PI / period;
    let cycles = 30.0;
    let samples = (0..=(cycles * period / step) as usize).map(|i| (w * step * i as f64).sin());
    let history = TimeHistory::new(step, samples.collect()).unwrap();
    let response = history.response_spectrum(damping, &[period]).unwrap()[0];
    let expected = (1.0 - (-damping * w * cycles * period).exp()) / (2.0 * damping * w * w);
    // Straight lines between samples lower a harmonic by (w step)^2 / 12.
    assert!(
        (response.displacement / expected - 1.0).abs() < 1e-3,
        "{response:?} {expected}"
    );
}

/// Refining a record's step by a whole number changes its response spectrum only by the instants at
/// which peaks are taken: the solution is exact for straight lines.
#[test]
fn the_response_is_exact_for_straight_lines() {
    let samples: Vec<f64> = (0..200)
        .map(|i| (0.37 * i as f64).sin() + (0.6 * i as f64).cos())
        .collect();
    let coarse = TimeHistory::new(0.05, samples).unwrap();
    let fine = coarse.resampled(0.005).unwrap();
    // At instants of 12.5 ms, a motion of 12 rad/s is missed by 1 - cos(12 x 0.0125 / 2) = 0.3 %.
    for period in [0.08, 0.3, 1.0, 5.0] {
        let read = |history: &TimeHistory| history.response_spectrum(0.05, &[period]).unwrap()[0];
        let (a, b) = (read(&coarse), read(&fine));
        assert!((a.displacement / b.displacement - 1.0).abs() < 5e-3);
        assert!((a.velocity / b.velocity - 1.0).abs() < 5e-3);
    }
}

/// The response of a stiff oscillator is the ground's acceleration, that of a soft one its displacement.
#[test]
fn the_spectrum_has_its_limits() {
    let samples = (0..=200).map(|i| {
        let x = i as f64 / 200.0;
        // The integrals of the second derivative of (x (1 - x))^4 end at zero.
        let y = x * (1.0 - x);
        12.0 * y * y * (1.0 - 2.0 * x).powi(2) - 8.0 * y * y * y
    });
    let history = TimeHistory::new(0.01, samples.collect()).unwrap();
    let report = history.report();
    let stiff = history.response_spectrum(0.05, &[0.002]).unwrap()[0];
    assert!((stiff.acceleration / report.peak_acceleration - 1.0).abs() < 1e-2);
    let soft = history.response_spectrum(0.05, &[1000.0]).unwrap()[0];
    assert!((soft.displacement / report.peak_displacement - 1.0).abs() < 1e-2);
}

/// The Fourier spectrum of a triangle is its closed form at every line, above the old Nyquist
/// frequency of its corners too.
#[test]
fn the_fourier_spectrum_is_exact() {
    let triangle = TimeHistory::new(0.5, vec![0.0, 1.0, 0.0]).unwrap();
    let fine = triangle.resampled(0.05).unwrap();
    for history in [&triangle, &fine] {
        for line in history.fourier_spectrum() {
            let x = PI * line.frequency * 0.5;
            let sinc = if x == 0.0 { 1.0 } else { x.sin() / x };
            assert!(
                (line.amplitude - 0.5 * sinc * sinc).abs() < 1e-12,
                "{line:?}"
            );
        }
    }
}

/// Arias intensity and significant duration of a constant acceleration have closed forms.
#[test]
fn arias_intensity_is_exact() {
    let history = TimeHistory::new(0.1, vec![2.0; 101]).unwrap();
    let expected = PI / (2.0 * 9.80665) * 4.0 * 10.0;
    assert!((history.arias_intensity() / expected - 1.0).abs() < 1e-12);
    let duration = history.significant_duration(0.05, 0.95).unwrap();
    assert!((duration - 9.0).abs() < 1e-9);
    assert!(history.significant_duration(0.9, 0.1).is_err());
}

/// Damping and periods outside their range are refused by name.
#[test]
fn impossible_oscillators_are_refused() {
    let history = TimeHistory::new(0.1, vec![1.0; 3]).unwrap();
    for (damping, period, name) in [
        (1.0, 1.0, "damping"),
        (-0.1, 1.0, "damping"),
        (0.05, 0.0, "period"),
    ] {
        let error = history.response_spectrum(damping, &[period]).unwrap_err();
        assert!(error.to_string().contains(name));
    }
}

/// A refined history passes through the samples and follows a band-limited motion between them, whatever its phase and the number
/// of samples per period down to two and a half, where straight lines miss up to a fifth of it; and so do its spectra.
#[test]
fn refined_histories_follow_band_limited_motions() {
    let step = 0.002;
    for (samples, phase) in [(2.5, 0.3), (5.0, 1.1), (7.3, 2.0), (40.0, 0.0)] {
        let w = 2.0 * PI / (samples * step);
        let motion = |t: f64| (-((t - 0.4) / 0.08).powi(2)).exp() * (w * t + phase).sin();
        let given: Vec<f64> = (0..401).map(|i| motion(f64::from(i) * step)).collect();
        let history = TimeHistory::new(step, given.clone()).unwrap();
        for times in [1, 2, 8] {
            let refined = history.refined(times).unwrap();
            assert_eq!(refined.samples(), 400 * times + 1);
            let fine = step / times as f64;
            for (i, value) in refined.acceleration().into_iter().enumerate() {
                let off = (value - motion(i as f64 * fine)).abs();
                assert!(off < 1e-6, "{samples} {times} {i}: {off:e}");
            }
        }
        let period = samples * step;
        let response = |history: &TimeHistory| {
            history.response_spectrum(0.05, &[period]).unwrap()[0].acceleration
        };
        let exact = TimeHistory::new(
            1e-5,
            (0..80_001).map(|i| motion(f64::from(i) * 1e-5)).collect(),
        );
        let exact = response(&exact.unwrap());
        let share = response(&history.refined(8).unwrap()) / exact;
        assert!((share - 1.0).abs() < 0.02, "{samples}: {share}");
        if samples < 3.0 {
            assert!(response(&history) / exact < 0.8);
        }
    }
    // Samples are kept also where their content reaches half of their frequency.
    for given in [
        vec![0.0, 1.0, 0.0, 0.0],
        vec![1.0, -1.0, 1.0, -1.0, 1.0, -1.0],
    ] {
        let history = TimeHistory::new(step, given.clone()).unwrap();
        for times in [1, 2, 8] {
            let refined = history.refined(times).unwrap().acceleration();
            for (i, value) in given.iter().enumerate() {
                let off = (refined[times * i] - value).abs();
                assert!(off < 1e-12, "{given:?} {times} {i}: {off:e}");
            }
        }
    }
    let history = TimeHistory::new(step, vec![1.0, 2.0]).unwrap();
    assert!(history.refined(3).is_err() && history.refined(0).is_err());
}

/// A broadened peak covers its share to both sides, at its height, whatever the spacing of the frequencies; a valley
/// narrower than the shares of its banks is filled, and a share of zero changes nothing.
#[test]
fn broadened_peaks_cover_their_share() {
    for (count, peak, share) in [(400, 7.0, 0.15), (900, 2.3, 0.1), (150, 20.0, 0.2)] {
        let ratio: f64 = 100.0;
        let frequency = |index: usize| 0.5 * ratio.powf(index as f64 / (count - 1) as f64);
        let frequencies: Vec<f64> = (0..count).map(frequency).collect();
        let nearest = (frequencies.iter().copied())
            .min_by(|a, b| (a - peak).abs().total_cmp(&(b - peak).abs()))
            .unwrap();
        let spike = |f: &f64| if *f == nearest { 5.0 } else { 1.0 };
        let ordinates: Vec<f64> = frequencies.iter().map(spike).collect();
        let broadened = broadened_spectrum(&frequencies, &ordinates, share).unwrap();
        for (f, found) in frequencies.iter().zip(&broadened) {
            // Beside the spike the polyline falls within one interval.
            let spacing = ratio.powf(1.0 / (count - 1) as f64);
            let [low, high] = [nearest * (1.0 - share), nearest * (1.0 + share)];
            if (low..=high).contains(f) {
                assert_eq!(*found, 5.0, "{f} Hz of {nearest}");
            } else if *f < low / spacing || *f > high * spacing {
                assert_eq!(*found, 1.0, "{f} Hz of {nearest}");
            }
        }
        let same = broadened_spectrum(&frequencies, &ordinates, 0.0).unwrap();
        assert_eq!(same, ordinates);
    }
    // Peaks at 9 and 11 Hz, 15 % each: all of 7.65 to 12.65 Hz.
    let frequencies: Vec<f64> = (0..2000).map(|index| 5.0 + 0.005 * index as f64).collect();
    let two = |f: &f64| 1.0 + 4.0 * ((f - 9.0).abs().min((f - 11.0).abs()) < 0.003) as u8 as f64;
    let ordinates: Vec<f64> = frequencies.iter().map(two).collect();
    let broadened = broadened_spectrum(&frequencies, &ordinates, 0.15).unwrap();
    for (f, found) in frequencies.iter().zip(broadened) {
        if (7.66..=12.64).contains(f) {
            assert_eq!(found, 5.0, "{f} Hz");
        }
    }
    assert!(broadened_spectrum(&[1.0, 1.0], &[0.0; 2], 0.7).is_err());
    assert!(broadened_spectrum(&[2.0, 1.0], &[0.0; 2], 0.1).is_err());
}
