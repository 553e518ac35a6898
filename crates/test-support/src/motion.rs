//! Short strong motions for tests of many records.

use core::f64::consts::PI;

/// Time between two samples (s).
pub const MOTION_STEP: f64 = 0.01;

/// Number of intervals of a motion, 1.3 s.
const INTERVALS: usize = 130;

/// Accelerations (m/s2, peak 1) of a displacement under a window of half a sine squared, `MOTION_STEP` apart: the second differences
/// of its samples, so that velocity and displacement end at zero by the trapezoidal rule.
fn windowed(displacement: impl Fn(usize) -> f64) -> Vec<f64> {
    let window = |sample: usize| (PI * sample as f64 / INTERVALS as f64).sin().powi(2);
    let mut samples = vec![0.0; 2];
    samples.extend((0..=INTERVALS).map(|sample| window(sample) * displacement(sample)));
    samples.extend([0.0; 2]);
    let bent = |three: &[f64]| three[0] - 2.0 * three[1] + three[2];
    let mut accelerations = vec![0.0];
    accelerations.extend(samples.windows(3).map(bent));
    accelerations.push(0.0);
    let peak = accelerations
        .iter()
        .fold(0.0_f64, |most, a| most.max(a.abs()));
    accelerations.into_iter().map(|a| a / peak).collect()
}

/// Synthetic strong motion of a number (m/s2, peak 1): twelve frequencies of 0.5 to 6 Hz with random phases, filtered by ground of a
/// random frequency of 1.5 to 5.5 Hz and 60 % of critical damping (Kanai 1957, Tajimi 1960). One number has one motion.
pub fn synthetic_motion(number: u64) -> Vec<f64> {
    let mut state = number;
    let mut random = move || {
        state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    for _ in 0..3 {
        random();
    }
    let ground = 1.5 + 4.0 * random();
    let components: Vec<[f64; 3]> = (1..=12)
        .map(|index| {
            let frequency = 0.5 * f64::from(index);
            let ratio = (frequency / ground).powi(2);
            let damping = 4.0 * 0.6 * 0.6 * ratio;
            let filter = ((1.0 + damping) / ((1.0 - ratio).powi(2) + damping)).sqrt();
            let angular = 2.0 * PI * frequency;
            let amplitude = filter * frequency.sqrt() / angular.powi(2);
            [angular, amplitude, 2.0 * PI * random()]
        })
        .collect();
    windowed(|sample| {
        let time = MOTION_STEP * sample as f64;
        let waves = components.iter();
        waves
            .map(|[angular, amplitude, phase]| amplitude * (angular * time + phase).cos())
            .sum()
    })
}

/// Part of a record from a time (s) on, as a motion like the synthetic ones; the record has accelerations at even times.
pub fn part_of_motion(record: &[f64], step: f64, from: f64) -> Vec<f64> {
    let acceleration = |time: f64| {
        let place = (time / step).max(0.0);
        let below = (place.floor() as usize).min(record.len() - 2);
        record[below] + (place - below as f64) * (record[below + 1] - record[below])
    };
    let (mut velocity, mut displacement) = (0.0, vec![0.0]);
    for sample in 0..INTERVALS {
        let now = acceleration(from + MOTION_STEP * sample as f64);
        let last = displacement[sample];
        displacement.push(last + MOTION_STEP * (velocity + 0.5 * MOTION_STEP * now));
        velocity += MOTION_STEP * now;
    }
    // Less the straight line between its ends.
    let end = displacement[INTERVALS];
    windowed(|sample| displacement[sample] - end * sample as f64 / INTERVALS as f64)
}

/// Text of a motion: times (s) and accelerations.
pub fn motion_text(accelerations: &[f64]) -> String {
    let rows = accelerations.iter().enumerate();
    let rows = rows.map(|(row, a)| format!("{:.2} {a:e}\n", MOTION_STEP * row as f64));
    rows.collect()
}
