//! Evaluation of a run for the quantities of the reference.

use core::f64::consts::PI;

use powerhouse::engine::observe::HistoryTable;
use powerhouse::wavefield::{Complex, Signal, SignalMotion, SignalSupport};

use super::{RADIUS, SAMPLES, STATIONS, WALL, rock, unit_of_time};
use crate::Outcome;
use crate::reference::ReferenceTable;

/// The frequency of the harmonic reference, `w a / (pi cs)`.
pub const ETA: f64 = 0.4915;

/// Angular frequency of the harmonic reference (rad/s).
///
/// # Errors
/// None: see [`rock`].
pub fn angular_frequency() -> Outcome<f64> {
    Ok(ETA * PI * rock()?.s_speed() / RADIUS)
}

/// The values of a column.
///
/// # Errors
/// An unknown column.
pub fn values<'a>(table: &'a HistoryTable, name: &str) -> Outcome<&'a [f64]> {
    let column = table
        .column(name)
        .ok_or_else(|| format!("no column '{name}'"))?;
    Ok(&column.values)
}

/// Harmonic signal at the frequency of the reference, with an amplitude that rises over the first periods.
#[derive(Clone, Copy, Debug)]
pub struct Steady {
    amplitude: f64,
    frequency: f64,
}

/// Number of periods over which the amplitude rises.
const GROWTH: f64 = 4.0;

impl Steady {
    /// Creates the signal with an amplitude (m).
    ///
    /// # Errors
    /// None: see [`rock`].
    pub fn new(amplitude: f64) -> Outcome<Self> {
        let frequency = angular_frequency()?;
        Ok(Self {
            amplitude,
            frequency,
        })
    }

    /// Duration of a number of periods, in `a / cs`.
    ///
    /// # Errors
    /// None: see [`rock`].
    pub fn periods(&self, count: f64) -> Outcome<f64> {
        Ok(count * 2.0 * PI / self.frequency / unit_of_time()?)
    }
}

impl Signal for Steady {
    fn motion(&self, time: f64) -> SignalMotion {
        let rate = self.frequency / (2.0 * PI * GROWTH);
        let x = (rate * time).clamp(0.0, 1.0);
        // 10 x^3 - 15 x^4 + 6 x^5 and its derivatives.
        let level = x * x * x * (10.0 + x * (6.0 * x - 15.0));
        let rise = 30.0 * rate * (x * (1.0 - x)).powi(2);
        let bend = 60.0 * rate * rate * x * (1.0 - x) * (1.0 - 2.0 * x);
        let (sine, cosine) = (self.frequency * time).sin_cos();
        let (w, a) = (self.frequency, self.amplitude);
        SignalMotion {
            displacement: a * level * sine,
            velocity: a * (rise * sine + level * w * cosine),
            acceleration: a * (bend * sine + 2.0 * rise * w * cosine - level * w * w * sine),
        }
    }
    fn support(&self) -> SignalSupport {
        let period = 2.0 * PI / self.frequency;
        SignalSupport {
            start: 0.0,
            end: 1.0e3 * period,
            step: 0.01 * period,
        }
    }
}

/// Amplitudes of a component at all stations per unit of the incident signal, by the ratio of
/// spectra: of the whole run, or of the last part of it (s) under a window that opens and closes
/// smoothly.
///
/// # Errors
/// A station that was not recorded.
pub fn amplitudes(
    run: &HistoryTable,
    signal: &dyn Signal,
    axis: char,
    last: Option<f64>,
) -> Outcome<Vec<f64>> {
    let frequency = angular_frequency()?;
    let end = run.times.last().copied().unwrap_or_default();
    let window = |time: f64| match last {
        None => 1.0,
        Some(last) => (PI * ((time - end) / last + 1.0).max(0.0)).sin().powi(2),
    };
    let weights: Vec<f64> = run.times.iter().map(|time| window(*time)).collect();
    let sum = |value: &dyn Fn(usize) -> f64| -> f64 {
        let terms = run.times.iter().enumerate();
        let terms = terms
            .map(|(row, time)| Complex::from_polar(weights[row], -frequency * time) * value(row));
        terms.sum::<Complex>().norm()
    };
    let incident = sum(&|row| signal.motion(run.times[row]).displacement);
    STATIONS
        .map(|station| {
            let motion = values(run, &format!("s{station}.u{axis}"))?;
            Ok(sum(&|row| motion[row]) / incident)
        })
        .collect()
}

/// A history of the reference with that of a run, from time zero, per unit of the incident peak.
#[derive(Clone, Debug)]
pub struct Pair {
    /// Name in the reference.
    pub name: String,
    /// Values of the reference.
    pub expected: Vec<f64>,
    /// Values of the run.
    pub found: Vec<f64>,
}

/// Displacements of surface and wall with those of a reference.
///
/// # Errors
/// A run that lacks a history of the reference.
pub fn transients(run: &HistoryTable, reference: &ReferenceTable, peak: f64) -> Outcome<Vec<Pair>> {
    let unit = unit_of_time()?;
    let first = run
        .times
        .iter()
        .position(|time| *time > -0.5 * unit / SAMPLES as f64);
    let first = first.ok_or("the run ends before time zero")?;
    let mut pairs = Vec::new();
    let mut pair = |name: String, parts: [(&str, f64); 2]| -> Outcome<()> {
        let expected = reference.column(&name)?;
        let [(a, of_a), (b, of_b)] = parts;
        let both = values(run, a)?[first..]
            .iter()
            .zip(&values(run, b)?[first..]);
        let found: Vec<f64> = both.map(|(a, b)| (of_a * a + of_b * b) / peak).collect();
        if found.len() < expected.len() {
            return Err("the run ends before the reference".into());
        }
        pairs.push(Pair {
            name,
            found: found[..expected.len()].to_vec(),
            expected,
        });
        Ok(())
    };
    for station in [-4, -2, -1, 0, 1, 2, 4] {
        let [x, z] = ['x', 'z'].map(|axis| format!("s{}.u{axis}", 10 * station));
        pair(format!("ux({station})"), [(&x, 1.0), (&z, 0.0)])?;
        pair(format!("uy({station})"), [(&x, 0.0), (&z, 1.0)])?;
    }
    for degrees in WALL {
        let (sine, cosine) = f64::from(degrees).to_radians().sin_cos();
        let [x, z] = ['x', 'z'].map(|axis| format!("w{degrees}.u{axis}"));
        pair(format!("ur@{degrees}deg"), [(&x, cosine), (&z, sine)])?;
        pair(format!("ut@{degrees}deg"), [(&x, -sine), (&z, cosine)])?;
    }
    Ok(pairs)
}

/// The L2 norm of all differences over that of the reference.
#[must_use]
pub fn relative_l2(pairs: &[Pair]) -> f64 {
    let (mut difference, mut reference) = (0.0, 0.0);
    for pair in pairs {
        for (found, expected) in pair.found.iter().zip(&pair.expected) {
            difference += (found - expected).powi(2);
            reference += expected.powi(2);
        }
    }
    (difference / reference).sqrt()
}
