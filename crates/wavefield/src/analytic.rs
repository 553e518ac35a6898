//! Analytic signals: a signal under complex reflection coefficients and decay with depth.

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::sync::{Arc, Mutex, PoisonError};

use crate::fourier::Fourier;
use crate::hermite::Quintic;
use crate::{Complex, Signal, WaveError};

/// Number of tables per doubling of the height; see [`AnalyticTables`].
const ROWS_PER_OCTAVE: f64 = 8.0;
/// Distance from the signal's centre, in half lengths of the signal, from which on the moment
/// expansion is used: its twelfth term is 2^-12 of the leading one.
const FAR_RADII: f64 = 2.0;
/// Number of terms of the moment expansion.
const MOMENTS: usize = 12;
/// Greatest length of a transform.
const MOST_SAMPLES: usize = 1 << 22;

/// Smooth taper that removes the forerunner of an acausal field; see
/// [`PlaneWave::with_quiet_start`](crate::PlaneWave::with_quiet_start).
///
/// The factor `1 / (1 + exp(-(z - centre) / width))` is analytic up to the height `pi width`, so
/// the product of an analytic signal with it still gives waves that satisfy the equation of motion
/// and leave the surface free.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct StartTaper {
    /// Time at which the factor is one half (s, on the signal's own axis).
    pub(crate) centre: f64,
    /// Time in which the factor falls by e (s).
    pub(crate) width: f64,
}

impl StartTaper {
    /// Factor and its first two derivatives at a complex time.
    fn factor(&self, z: Complex) -> [Complex; 3] {
        let exponent = (z - self.centre) / self.width;
        let zero = Complex::new(0.0, 0.0);
        if exponent.re < -300.0 {
            return [zero; 3];
        }
        let one = Complex::new(1.0, 0.0);
        let factor = one / (one + (-exponent).exp());
        let first = factor * (one - factor) / self.width;
        [factor, first, first * (one - factor * 2.0) / self.width]
    }

    /// Displacement, velocity and acceleration times the factor, by the product rule.
    fn apply(&self, z: Complex, [d, v, a]: [Complex; 3]) -> [Complex; 3] {
        let [w, w1, w2] = self.factor(z);
        [d * w, v * w + d * w1, a * w + v * w1 * 2.0 + d * w2]
    }
}

/// Table and offset in it that belong to one height.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Level {
    table: u32,
    /// Height above that of the table, in steps of the table.
    offset: f64,
    /// Height itself (s).
    height: f64,
}

/// Table index of heights without a table, at which the moment expansion holds at all times.
const FAR: u32 = u32::MAX;

/// Quintics in time at one height, over uniform intervals.
struct Table<T> {
    start: f64,
    per_step: f64,
    intervals: Vec<Quintic<T>>,
}

/// Table of the analytic signal at one height.
type HeightTable = Table<Complex>;

impl<T> Table<T> {
    /// Interval of a time (s) and the position in it from 0 to 1; none outside the table.
    #[inline(always)]
    fn interval(&self, time: f64) -> Option<(&Quintic<T>, f64)> {
        let position = (time - self.start) * self.per_step;
        // Out of its range the conversion saturates, beyond any table.
        let index = position as i32;
        let interval = self.intervals.get(usize::try_from(index).ok()?)?;
        (position >= 0.0).then_some((interval, position - f64::from(index)))
    }
}

/// Analytic signal `A(t + i h)` of a signal f, tabulated over time and height on demand.
///
/// `A = f + i H f` on the real axis (H the Hilbert transform) has positive frequencies only, and
/// `A(t + i h)` is A with each of them damped by `exp(-w h)`. So `Re[c A(t + i h)]` is the signal
/// under a complex coefficient c (for `exp(+i w t)`, `w > 0`) at depth `h / kappa` of a wave that
/// decays as `exp(-w kappa depth)`.
///
/// Tables hold A and two derivatives at uniform times, joined by quintics, which are evaluated at
/// complex arguments: A is analytic above the real axis, so one table serves a band of heights. By
/// Cauchy's bound the error of interpolation at heights from 8 steps up is below 1e-6 of the peak;
/// below that the signal's own smoothness on its [`step`](crate::SignalSupport::step) decides, and the
/// real part at height zero is as exact as quintics through its samples. Higher bands are smoother
/// and take coarser steps. Far from the signal the moment expansion is used.
///
/// The transform is periodic; the contribution of the signal's periodic images is subtracted by its
/// moments, `cot x = 1/x - x/3 - x^3/45 - ...`.
pub(crate) struct AnalyticTables {
    sampled: SampledSpectra,
    taper: Option<StartTaper>,
    /// Tables made so far, by coarsening and row; each is made when a point first needs it.
    made: Mutex<BTreeMap<(u32, u64), Arc<HeightTable>>>,
}

impl AnalyticTables {
    /// Spectra of a signal, without tables yet.
    pub(crate) fn new(signal: &dyn Signal, taper: Option<StartTaper>) -> Result<Self, WaveError> {
        Ok(Self {
            sampled: SampledSpectra::new(signal)?,
            taper,
            made: Mutex::default(),
        })
    }

    /// Tables of the signal at the given heights (s, not negative), and the level of each height.
    pub(crate) fn at(&self, heights: &[f64]) -> (AnalyticSignal, Vec<Level>) {
        let sampled = &self.sampled;
        let mut tables = Vec::new();
        let mut known = BTreeMap::new();
        let level = |&height: &f64| {
            if height >= FAR_RADII * sampled.radius {
                return Level {
                    table: FAR,
                    offset: 0.0,
                    height,
                };
            }
            let (coarsening, row) = band(height / sampled.step);
            let table = *known.entry((coarsening, row)).or_insert_with(|| {
                tables.push(self.shared(coarsening, row));
                (tables.len() - 1) as u32
            });
            Level {
                table,
                offset: height / self.step(coarsening) - row as f64,
                height,
            }
        };
        let levels = heights.iter().map(level).collect();
        let signal = AnalyticSignal {
            tables,
            moments: sampled.moments,
            centre: sampled.centre,
            radius: sampled.radius,
            taper: self.taper,
        };
        (signal, levels)
    }

    /// Time step of the tables of one coarsening (s).
    fn step(&self, coarsening: u32) -> f64 {
        self.sampled.step * (1u64 << coarsening) as f64
    }

    /// Table of one band of heights, made at the first request.
    fn shared(&self, coarsening: u32, row: u64) -> Arc<HeightTable> {
        // If another thread panics, every table in the map is still complete.
        let mut made = self.made.lock().unwrap_or_else(PoisonError::into_inner);
        let make = || Arc::new(self.table(coarsening, row as f64 * self.step(coarsening)));
        made.entry((coarsening, row)).or_insert_with(make).clone()
    }

    /// Table at one height, with nodes `2^coarsening` steps apart.
    fn table(&self, coarsening: u32, height: f64) -> HeightTable {
        let sampled = &self.sampled;
        let step = self.step(coarsening);
        let values = sampled.along(coarsening, height);
        let period = values.len() as i64;
        let reach = FAR_RADII * sampled.radius;
        let before = ((reach - sampled.radius) / step).ceil() as i64 + 1;
        let after = ((reach + sampled.radius) / step).ceil() as i64 + 1;
        let images = Images::new(&sampled.moments, sampled.radius, sampled.period);
        let node = |i: i64| {
            let z = Complex::new(sampled.start + i as f64 * step, height);
            let images = images.value(z - sampled.centre);
            let periodic = values[i.rem_euclid(period) as usize];
            let node = core::array::from_fn(|k| periodic[k] + images[k]);
            match &self.taper {
                Some(taper) => taper.apply(z, node),
                None => node,
            }
        };
        let mut intervals = Vec::with_capacity((before + after) as usize);
        let mut from = node(-before);
        for i in -before..after {
            let to = node(i + 1);
            intervals.push(Quintic::new(from, to, step));
            from = to;
        }
        Table {
            start: sampled.start - before as f64 * step,
            per_step: 1.0 / step,
            intervals,
        }
    }
}

/// Analytic signal at the levels of some points; see [`AnalyticTables`].
pub(crate) struct AnalyticSignal {
    tables: Vec<Arc<HeightTable>>,
    moments: [f64; MOMENTS],
    centre: f64,
    radius: f64,
    taper: Option<StartTaper>,
}

impl AnalyticSignal {
    /// Complex displacement and velocity at a time (s) on a level.
    #[inline(always)]
    pub(crate) fn value(&self, time: f64, level: &Level) -> (Complex, Complex) {
        let table = self.tables.get(level.table as usize);
        if let Some((table, (interval, local))) =
            table.and_then(|table| Some((table, table.interval(time)?)))
        {
            let (displacement, velocity) = if level.offset == 0.0 {
                interval.real_value(local)
            } else {
                interval.value(Complex::new(local, level.offset))
            };
            return (displacement, velocity * table.per_step);
        }
        self.far(Complex::new(time, level.height))
    }

    /// Real part of a factor times the signal, on a level at the height of its table.
    pub(crate) fn phase_shifted(&self, factor: Complex, level: &Level) -> ShiftedSignal {
        let table = self.tables.get(level.table as usize);
        let real = |table: &Arc<HeightTable>| Table {
            start: table.start,
            per_step: table.per_step,
            intervals: (table.intervals.iter())
                .map(|interval| interval.map(|c| (factor * c).re))
                .collect(),
        };
        ShiftedSignal {
            factor,
            table: table.map(real),
            height: level.height,
        }
    }

    /// Complex displacement and velocity by the moment expansion,
    /// `A = (i / pi) sum_n M_n / (z - centre)^(n + 1)`.
    #[cold]
    fn far(&self, z: Complex) -> (Complex, Complex) {
        let inverse = Complex::new(self.radius, 0.0) / (z - self.centre);
        let zero = Complex::new(0.0, 0.0);
        let (mut displacement, mut velocity) = (zero, zero);
        let mut power = inverse;
        for (n, moment) in self.moments.iter().enumerate() {
            displacement += power * *moment;
            power *= inverse;
            velocity -= power * (*moment * (n + 1) as f64);
        }
        let scale = Complex::new(0.0, 1.0 / (PI * self.radius));
        displacement *= scale;
        velocity *= scale / self.radius;
        match &self.taper {
            Some(taper) => {
                let [d, v, _] = taper.apply(z, [displacement, velocity, zero]);
                (d, v)
            }
            None => (displacement, velocity),
        }
    }
}

/// Real part of a factor times an [`AnalyticSignal`] at one height: a signal with a phase shift.
///
/// The tables are linear in their nodes, so this is the same to rounding, at half of the arithmetic
/// and memory.
pub(crate) struct ShiftedSignal {
    factor: Complex,
    table: Option<Table<f64>>,
    height: f64,
}

impl ShiftedSignal {
    /// Displacement and velocity at a time (s); `of` is the signal that this one was made from.
    #[inline(always)]
    pub(crate) fn value(&self, time: f64, of: &AnalyticSignal) -> (f64, f64) {
        let table = self.table.as_ref();
        if let Some((table, (interval, local))) =
            table.and_then(|table| Some((table, table.interval(time)?)))
        {
            let (displacement, velocity) = interval.value(local);
            return (displacement, velocity * table.per_step);
        }
        let (displacement, velocity) = of.far(Complex::new(time, self.height));
        ((self.factor * displacement).re, (self.factor * velocity).re)
    }
}

/// Number of doublings of the step at a height given in steps, and the nearest row at that step.
///
/// Heights stay below those of the moment expansion, so that even the coarsest transform has 128 samples.
fn band(height: f64) -> (u32, u64) {
    let mut coarsening = 0;
    let mut rows = height;
    while rows >= 2.0 * ROWS_PER_OCTAVE {
        rows *= 0.5;
        coarsening += 1;
    }
    (coarsening, rows.round() as u64)
}

/// Correction of the periodic transform for the signal's periodic images, a polynomial of z:
/// `(i / P) int f(s) [1/x - cot x] ds`, `x = pi (z - s) / P`.
struct Images {
    /// Coefficients of the powers of `pi z / P`.
    coefficients: [f64; 8],
    rate: f64,
    period: f64,
}

impl Images {
    fn new(moments: &[f64; MOMENTS], radius: f64, period: f64) -> Self {
        /// Taylor coefficients of `1/x - cot x`.
        const COTANGENT: [(usize, f64); 4] = [
            (1, 1.0 / 3.0),
            (3, 1.0 / 45.0),
            (5, 2.0 / 945.0),
            (7, 1.0 / 4725.0),
        ];
        let rate = PI / period;
        let mut coefficients = [0.0; 8];
        for (power, coefficient) in COTANGENT {
            // (z - s)^n by the binomial theorem.
            let mut factor = coefficient;
            for (k, moment) in moments.iter().enumerate().take(power + 1) {
                coefficients[power - k] += factor * moment;
                factor *= -(radius * rate) * (power - k) as f64 / (k + 1) as f64;
            }
        }
        Self {
            coefficients,
            rate,
            period,
        }
    }

    /// Displacement, velocity and acceleration at a time from the centre.
    fn value(&self, z: Complex) -> [Complex; 3] {
        let x = z * self.rate;
        let zero = Complex::new(0.0, 0.0);
        let (mut value, mut first, mut half_second) = (zero, zero, zero);
        for coefficient in self.coefficients.iter().rev() {
            half_second = half_second * x + first;
            first = first * x + value;
            value = value * x + coefficient;
        }
        let scale = Complex::new(0.0, 1.0 / self.period);
        [
            value * scale,
            first * scale * self.rate,
            half_second * scale * (2.0 * self.rate * self.rate),
        ]
    }
}

/// Spectra of displacement, velocity and acceleration, each from its own samples: at height zero
/// the real parts of the tables then pass through the samples.
struct SampledSpectra {
    spectra: [Vec<Complex>; 3],
    start: f64,
    step: f64,
    period: f64,
    centre: f64,
    radius: f64,
    /// Moments of the displacement, `int f ((s - centre) / radius)^n ds`.
    moments: [f64; MOMENTS],
    length: usize,
}

impl SampledSpectra {
    fn new(signal: &dyn Signal) -> Result<Self, WaveError> {
        let support = signal.support();
        let needed = 8.0 * (support.end - support.start) / support.step;
        WaveError::check_samples("the transform of a signal", needed, MOST_SAMPLES)?;
        let count = (needed / 8.0).ceil().max(1.0) as usize;
        let fourier = Fourier::new(8 * count);
        let radius = 0.5 * count as f64 * support.step;
        let centre = support.start + radius;
        let mut samples = [(); 3].map(|()| Vec::with_capacity(count + 1));
        let mut moments = [0.0; MOMENTS];
        for i in 0..=count {
            let time = support.start + i as f64 * support.step;
            let motion = signal.motion(time);
            samples[0].push(motion.displacement);
            samples[1].push(motion.velocity);
            samples[2].push(motion.acceleration);
            let mut term = motion.displacement * support.step;
            for moment in &mut moments {
                *moment += term;
                term *= (time - centre) / radius;
            }
        }
        Ok(Self {
            spectra: samples.map(|samples| fourier.forward(&samples)),
            start: support.start,
            step: support.step,
            period: fourier.len() as f64 * support.step,
            centre,
            radius,
            moments,
            length: fourier.len(),
        })
    }

    /// Displacement, velocity and acceleration of the periodic analytic signal at a height,
    /// `2^coarsening` steps apart.
    fn along(&self, coarsening: u32, height: f64) -> Vec<[Complex; 3]> {
        let length = (self.length >> coarsening).max(4);
        let fourier = Fourier::new(length);
        let scale = length as f64 / self.length as f64;
        let rate = 2.0 * PI / self.period * height;
        let mut values = vec![[Complex::new(0.0, 0.0); 3]; length];
        for (quantity, spectrum) in self.spectra.iter().enumerate() {
            let damped = spectrum[..=length / 2].iter().enumerate();
            let mut damped: Vec<Complex> = damped
                .map(|(i, value)| value * (scale * (-rate * i as f64).exp()))
                .collect();
            for (value, real) in values.iter_mut().zip(fourier.inverse(&damped)) {
                value[quantity].re = real;
            }
            // The Hilbert transform turns by -90 degrees; the mean has none.
            for value in &mut damped {
                *value *= Complex::new(0.0, -1.0);
            }
            damped[0] = Complex::new(0.0, 0.0);
            for (value, imaginary) in values.iter_mut().zip(fourier.inverse(&damped)) {
                value[quantity].im = imaginary;
            }
        }
        values
    }
}
