//! The frequencies of a gravity dam, empty and with its reservoir.

use core::f64::consts::{PI, TAU};

use powerhouse::Results;

use super::page::{Row, compare};
use super::run;

/// Time (s) at which the blow is over.
const FREE: f64 = 0.5;

/// The circular frequency (rad/s) near one at which the free vibration of the crest has a peak of its spectrum, under a Hann
/// window.
fn frequency(results: &Results, column: &str, near: f64) -> f64 {
    let times = &results.histories().times;
    let values = &results
        .histories()
        .column(column)
        .expect("a history")
        .values;
    let samples: Vec<(f64, f64)> = (times.iter().copied().zip(values.iter().copied()))
        .filter(|(time, _)| *time >= FREE)
        .collect();
    let (start, end) = (samples[0].0, samples[samples.len() - 1].0);
    let amplitude = |frequency: f64| {
        let (mut cosine, mut sine) = (0.0, 0.0);
        for &(time, value) in &samples {
            let window = (PI * (time - start) / (end - start)).sin().powi(2);
            cosine += window * value * (frequency * time).cos();
            sine += window * value * (frequency * time).sin();
        }
        f64::hypot(cosine, sine)
    };
    // A twentieth of the width of a peak.
    let fine = TAU / (20.0 * (end - start));
    let count = (0.12 * near / fine) as i32;
    let around = (-count..=count).map(|step| near + f64::from(step) * fine);
    let peak = around
        .max_by(|a, b| amplitude(*a).total_cmp(&amplitude(*b)))
        .expect("frequencies");
    // The vertex of the parabola through the peak and its neighbours.
    let [before, at, after] = [-1.0, 0.0, 1.0].map(|step| amplitude(peak + step * fine));
    peak + 0.5 * fine * (before - after) / (before - 2.0 * at + after)
}

/// The first frequencies of Koyna dam in plane stress: empty against those of Chopra & Chakrabarti (1973) and of Abaqus, and with
/// Westergaard's mass against a plane solution of our own with other elements.
#[test]
fn koyna() {
    let empty = run("koyna.toml", &[]);
    let full = run("koyna_reservoir.toml", &[]);
    let mut rows = Vec::new();
    let known = [
        ("crest.ux", 19.27, 18.86),
        ("crest.ux", 51.50, 49.97),
        ("crest.uz", 67.56, 68.16),
        ("crest.ux", 99.73, 98.27),
    ];
    let found = known.map(|(column, paper, _)| frequency(&empty, column, paper));
    for (mode, ((_, paper, _), found)) in (1..).zip(known.into_iter().zip(found)) {
        let what = format!("empty, mode {mode} (rad/s)");
        rows.push(Row::new(what, paper, found, 0.03));
    }
    for (mode, ((_, _, other), found)) in (1..).zip(known.into_iter().zip(found)) {
        let what = format!("the same against Abaqus, mode {mode} (rad/s)");
        rows.push(Row::new(what, other, found, 0.01));
    }
    for (mode, column, own) in [
        (1, "crest.ux", 16.59),
        (2, "crest.ux", 41.83),
        (4, "crest.ux", 80.12),
    ] {
        let what = format!("with water, against own plane elements, mode {mode} (rad/s)");
        rows.push(Row::new(what, own, frequency(&full, column, own), 0.01));
    }
    compare("Koyna", &rows);
}
