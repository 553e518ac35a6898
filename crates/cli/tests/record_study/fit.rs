//! Fit of a fragility curve of its own: a search over median and dispersion, intervals of the profile likelihood; and the response of
//! an oscillator, by steps. Nothing here is of the software that it checks.

use std::f64::consts::PI;

/// Standard normal distribution, by its Taylor series around zero (Marsaglia 2004).
fn normal(z: f64) -> f64 {
    if z.abs() > 7.0 {
        return if z > 0.0 { 1.0 } else { 0.0 };
    }
    let (mut sum, mut term, mut odd) = (z, z, 1.0);
    while term.abs() > 1e-18 * sum.abs() {
        odd += 2.0;
        term *= z * z / odd;
        sum += term;
    }
    0.5 + sum * (-0.5 * z * z).exp() / (2.0 * PI).sqrt()
}

/// Logarithm of the likelihood of runs, each an intensity and whether it exceeds the limit.
fn likelihood(runs: &[(f64, bool)], [median, dispersion]: [f64; 2]) -> f64 {
    let of = |&(intensity, exceeds): &(f64, bool)| {
        let z = (intensity.ln() - median) / dispersion.exp();
        normal(if exceeds { z } else { -z }).max(1e-300).ln()
    };
    runs.iter().map(of).sum()
}

/// Greatest value of a function over an interval by ternary search, with its place.
fn greatest(of: impl Fn(f64) -> f64, [mut low, mut high]: [f64; 2]) -> (f64, f64) {
    for _ in 0..120 {
        let [a, b] = [low + (high - low) / 3.0, high - (high - low) / 3.0];
        if of(a) < of(b) { low = a } else { high = b }
    }
    (0.5 * (low + high), of(0.5 * (low + high)))
}

/// Median and dispersion of greatest likelihood, and the ends of their intervals of 95 % by the profile likelihood, all as logarithms.
pub(super) struct Fit {
    pub(super) median: f64,
    pub(super) dispersion: f64,
    pub(super) median_interval: [f64; 2],
    pub(super) dispersion_interval: [f64; 2],
}

/// Ranges of the search: logarithms of the median (m/s2) and of the dispersion.
const RANGES: [[f64; 2]; 2] = [[-3.0, 4.0], [-4.0, 1.5]];

pub(super) fn fit(runs: &[(f64, bool)]) -> Fit {
    let of_median = |median: f64| greatest(|d| likelihood(runs, [median, d]), RANGES[1]);
    let of_dispersion =
        |dispersion: f64| greatest(|m| likelihood(runs, [m, dispersion]), RANGES[0]);
    let (median, best) = greatest(|median| of_median(median).1, RANGES[0]);
    let dispersion = of_median(median).0;
    // Half of the 95 % quantile of chi square with one degree of freedom.
    let lost = best - 0.5 * 3.841_458_8;
    let end = |profile: &dyn Fn(f64) -> f64, mut inside: f64, mut outside: f64| {
        for _ in 0..60 {
            let middle = 0.5 * (inside + outside);
            if profile(middle) > lost {
                inside = middle
            } else {
                outside = middle
            }
        }
        inside
    };
    let profiles: [&dyn Fn(f64) -> f64; 2] = [&|m| of_median(m).1, &|d| of_dispersion(d).1];
    let interval = |of: usize, at: f64| RANGES[of].map(|range| end(profiles[of], at, range));
    Fit {
        median,
        dispersion,
        median_interval: interval(0, median),
        dispersion_interval: interval(1, dispersion),
    }
}

/// Pseudo-acceleration of an oscillator of a period (s) and 5 % damping under accelerations with straight lines between them, by central
/// differences with a hundred steps a sample.
pub(super) fn pseudo_acceleration(accelerations: &[f64], step: f64, period: f64) -> f64 {
    const PARTS: usize = 100;
    let (angular, dt) = (2.0 * PI / period, step / PARTS as f64);
    let (mut place, mut velocity, mut most) = (0.0_f64, 0.0, 0.0_f64);
    // Two periods of free vibration behind the record.
    let behind = (2.0 * period / step) as usize;
    for sample in 0..accelerations.len() + behind {
        let at = |sample: usize| accelerations.get(sample).copied().unwrap_or(0.0);
        for part in 0..PARTS {
            let share = part as f64 / PARTS as f64;
            let ground = at(sample) + share * (at(sample + 1) - at(sample));
            let force = -ground - angular * angular * place;
            let damping = 0.05 * angular * dt;
            velocity = ((1.0 - damping) * velocity + dt * force) / (1.0 + damping);
            place += dt * velocity;
            most = most.max(place.abs());
        }
    }
    angular * angular * most
}
