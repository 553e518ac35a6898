//! Tables in time of a layered field, one for each height.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::PI;
use std::sync::{Arc, Mutex, PoisonError};

use super::ground::Ground;
use super::heights::Heights;
use super::stack::{Amplitudes, Stack};
use super::states::spectra;
use super::window::{Window, held};
use crate::analytic::{AnalyticSignal, AnalyticTables, Level};
use crate::fourier::Fourier;
use crate::{Complex, Signal, WaveError};

/// Greatest number of samples of a transform, and greatest memory of all tables of a wave (bytes).
pub(crate) const MOST_SAMPLES: usize = 1 << 20;
pub(crate) const MOST_BYTES: usize = 2 << 30;
/// Memory of the states of heights that are computed at a time (bytes).
const BATCH_BYTES: usize = 16 << 20;
/// Number of samples over which the weight of a window is multiplied.
const MULTIPLIED: usize = 64;
/// Share of a peak below which a table begins and ends.
const NEGLIGIBLE: f64 = 3e-7;
/// The same where the motion falls as a power of time.
const NEGLIGIBLE_POWER: f64 = 1e-5;

/// Values and derivatives of some quantities at uniform times, joined by cubics.
///
/// A record holds `Q` values and then their derivatives times the step.
pub(crate) struct Table {
    /// Time of the first record after the arrival of the incident wave (s).
    pub(crate) start: f64,
    pub(crate) per_step: f64,
    pub(crate) values: Vec<f64>,
}

/// Constant part of the spectrum of a field that is not causal: coefficients of displacement along the
/// direction of travel, across it and up, on the analytic signal.
pub(crate) struct StaticPart {
    pub(crate) coefficients: [Complex; 3],
    signal: AnalyticSignal,
    level: Level,
}

impl StaticPart {
    pub(crate) fn new(signal: &dyn Signal, coefficients: [Complex; 3]) -> Result<Self, WaveError> {
        let (signal, levels) = AnalyticTables::new(signal, None)?.at(&[0.0]);
        Ok(Self {
            coefficients,
            signal,
            level: levels[0],
        })
    }

    /// Displacement and velocity of a component at a time (s).
    pub(crate) fn value(&self, component: usize, time: f64) -> (f64, f64) {
        let (displacement, velocity) = self.signal.value(time, &self.level);
        let coefficient = self.coefficients[component];
        ((coefficient * displacement).re, (coefficient * velocity).re)
    }
}

/// Accuracy and memory of the tables made so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LayeredTablesReport {
    /// Number of heights with a table.
    pub heights: usize,
    /// Memory of the tables (bytes).
    pub bytes: usize,
    /// Estimated largest errors of interpolation in time of displacement, velocity and stress over
    /// the peaks at the same height (1).
    pub interpolation: [f64; 3],
    /// Number of heights between which those of many points are interpolated, and the errors of displacement, velocity and
    /// stress over their peaks at twice their distance (1); `None` where each height has its table.
    pub between_heights: Option<(usize, [f64; 3])>,
}

/// Motion of a layered field at some heights; of displacement (m), velocity (m/s) and stress (Pa).
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Probe {
    /// Largest values where the window ends.
    pub(crate) left: [f64; 3],
    /// Largest estimated errors of interpolation.
    pub(crate) errors: [f64; 3],
    /// Peaks.
    pub(crate) peaks: [f64; 3],
}

impl Probe {
    /// Values over the peaks (1).
    pub(crate) fn shares(&self, values: [f64; 3]) -> [f64; 3] {
        let share = |k: usize| (self.peaks[k] > 0.0).then(|| values[k] / self.peaks[k]);
        core::array::from_fn(|k| share(k).unwrap_or(0.0))
    }
}

#[derive(Default)]
struct Made {
    states: BTreeMap<i64, Arc<Table>>,
    products: BTreeMap<(i64, usize), Arc<Table>>,
    report: LayeredTablesReport,
    heights: Option<Arc<Heights>>,
}

/// Amplitudes in all layers at all frequencies, spectra of the signal, and tables made from them.
///
/// Spectra of displacement, velocity and acceleration are each from samples of their own at half of
/// the signal's step, and fall off smoothly over the upper half of their band: what rings after a
/// corner of the signal then stays there.
pub(crate) struct LayeredTables {
    pub(crate) stack: Stack,
    ground: Ground,
    pub(crate) window: Window,
    frequencies: Vec<Complex>,
    spectra: [Vec<Complex>; 3],
    /// Amplitudes of all layers, frequency after frequency.
    amplitudes: Vec<Amplitudes>,
    pub(crate) statics: Option<StaticPart>,
    /// Displacement after the end of all tables (m), in the order of their values.
    pub(crate) remaining: [f64; 2],
    /// Peaks of displacement (m), velocity (m/s) and stress (Pa) at surface, interfaces and lowest height.
    pub(crate) peaks: [f64; 3],
    /// Number of samples of the transform from one record to the next.
    stride: usize,
    /// Unit of heights (m): points nearer than half of it share a table.
    unit: f64,
    fourier: Fourier,
    made: Mutex<Made>,
}

/// Tables of a height that are missing.
#[derive(Default)]
struct Missing {
    /// That of displacement and traction.
    state: bool,
    /// Damped layers of which that of the product is missing.
    products: BTreeSet<usize>,
}

/// Histories at all samples of a transform: values, and their derivatives.
pub(crate) struct Histories {
    pub(crate) values: Vec<Vec<f64>>,
    pub(crate) rates: Vec<Vec<f64>>,
    /// Time between two samples (s).
    step: f64,
}

impl LayeredTables {
    /// Spectra of a signal in a window, and amplitudes of the layers.
    pub(crate) fn new(
        ground: &Ground,
        stack: Stack,
        signal: &dyn Signal,
        window: Window,
        statics: Option<StaticPart>,
        remaining: [f64; 2],
        unit: f64,
    ) -> Self {
        let fourier = Fourier::new(window.length);
        let length = fourier.len();
        let mut samples = [(); 3].map(|()| Vec::with_capacity(length));
        for i in 0..length {
            let time = window.time(i);
            let weight = window.weight(i);
            let motion = held(signal, time, &window);
            samples[0].push(weight * motion.displacement);
            samples[1].push(weight * motion.velocity);
            samples[2].push(weight * motion.acceleration);
        }
        let mut spectra = samples.map(|samples| fourier.forward(&samples));
        let bins = length / 2 + 1;
        for spectrum in &mut spectra {
            for (i, value) in spectrum.iter_mut().enumerate() {
                *value *= fall_off(i as f64 / (bins - 1) as f64);
            }
        }
        let bin = 2.0 * PI / (length as f64 * window.step);
        let mut frequencies: Vec<Complex> = (0..bins)
            .map(|i| Complex::new(i as f64 * bin, -window.growth))
            .collect();
        if frequencies[0].norm() == 0.0 {
            // At zero a damped modulus may vanish.
            frequencies[0] = frequencies[1] * 1e-6;
        }
        let layers = stack.count() + 1;
        let zero = Complex::new(0.0, 0.0);
        let none = Amplitudes {
            up: [zero; 2],
            down: [zero; 2],
        };
        let mut amplitudes = vec![none; bins * layers];
        for (i, out) in amplitudes.chunks_exact_mut(layers).enumerate() {
            stack.amplitudes(frequencies[i], out);
        }
        Self {
            stack,
            ground: ground.clone(),
            window,
            frequencies,
            spectra,
            amplitudes,
            statics,
            remaining,
            peaks: [0.0; 3],
            stride: 2,
            unit,
            fourier,
            made: Mutex::default(),
        }
    }

    /// Largest motion where the window ends, largest errors of interpolation, and peaks of
    /// displacement, velocity and stress at some keys.
    pub(crate) fn probe(&self, keys: &[i64]) -> Probe {
        let mut probe = Probe::default();
        let n = self.stack.order;
        let (valid, edge) = (self.window.valid(), self.window.length / 64);
        for (_, state) in self.states(keys) {
            let histories = self.histories(&state);
            let kinds = [
                (&histories.values[..n], &self.remaining[..n]),
                (&histories.rates[..n], &[0.0; 2][..n]),
                (&histories.values[n..], &[0.0; 2][..n]),
            ];
            for (kind, (histories, rest)) in kinds.into_iter().enumerate() {
                for (values, rest) in histories.iter().zip(rest) {
                    probe.peaks[kind] = probe.peaks[kind].max(peak(values, valid));
                    let first = if self.window.causal {
                        &[][..]
                    } else {
                        &values[..edge]
                    };
                    let edges = values[valid - edge..valid].iter().chain(first);
                    let left = edges.fold(0.0f64, |m, v| m.max((v - rest).abs()));
                    probe.left[kind] = probe.left[kind].max(left);
                }
            }
            let errors = histories.interpolation(self.stride, valid, n);
            for (worst, error) in probe.errors.iter_mut().zip(errors) {
                *worst = worst.max(error);
            }
        }
        probe
    }

    /// Takes records at every sample of the transform instead of every second one.
    pub(crate) fn refine(&mut self) {
        self.stride = 1;
    }

    /// Time between two records (s).
    pub(crate) fn step(&self) -> f64 {
        self.window.step * self.stride as f64
    }

    /// Memory of a table of displacement and traction at most (bytes).
    pub(crate) fn most_bytes(&self) -> usize {
        let valid = self.window.valid();
        let needed = self.window.until.map(|until| self.window.after(until));
        let samples = needed.map_or(valid, |needed| needed.min(valid));
        (samples / self.stride + 3) * 4 * self.stack.order * size_of::<f64>()
    }

    /// Memory of spectra and amplitudes (bytes).
    pub(crate) fn bytes_of_spectra(&self) -> usize {
        let bins = self.frequencies.len() * (1 + self.spectra.len());
        bins * size_of::<Complex>() + self.amplitudes.len() * size_of::<Amplitudes>()
    }

    pub(crate) fn report(&self) -> LayeredTablesReport {
        let made = self.made.lock().unwrap_or_else(PoisonError::into_inner);
        made.report
    }

    /// Height to which a height is rounded, as a multiple of the unit below the surface.
    pub(crate) fn key(&self, height: f64) -> i64 {
        ((self.ground.surface() - height) / self.unit)
            .round()
            .max(0.0) as i64
    }

    /// Depth of a height below the surface, as a multiple of the unit.
    pub(crate) fn depth(&self, height: f64) -> f64 {
        ((self.ground.surface() - height) / self.unit).max(0.0)
    }

    /// Heights between which those of many points are interpolated, chosen at the first request.
    pub(crate) fn heights(&self, lowest: f64) -> Result<Arc<Heights>, WaveError> {
        let lock = || self.made.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = &lock().heights {
            return Ok(known.clone());
        }
        let heights = Arc::new(Heights::new(self, &self.ground, lowest)?);
        let mut made = lock();
        made.report.between_heights = Some((heights.count(), heights.errors));
        made.heights = Some(heights.clone());
        Ok(heights)
    }

    /// Layer and depth in it of a key; on an interface those of the layer below.
    fn place(&self, key: i64) -> (usize, f64) {
        let height = self.ground.surface() - key as f64 * self.unit;
        let interfaces = self.ground.interfaces();
        let index = interfaces.partition_point(|bottom| self.key(*bottom) <= key);
        let [top, _] = self.ground.extent(index);
        (index, (top - height).max(0.0))
    }

    /// Layer of a key, on an interface that below.
    pub(crate) fn layer_of(&self, key: i64) -> usize {
        self.place(key).0
    }

    /// Time (s) by which the incident wave passes a key before it passes the top of the half-space.
    pub(crate) fn advance(&self, key: i64) -> f64 {
        let (index, depth) = self.place(key);
        if index < self.stack.count() {
            return 0.0;
        }
        let columns = self.stack.columns(index, Complex::new(0.0, 0.0));
        columns.slowness[self.stack.incident].re * depth
    }

    /// Makes what is missing of tables of displacement and traction at some keys, and of the modulus of a damped layer over that
    /// of its medium, times the velocity along the layer (of SH: across the direction of travel), at keys of layers.
    ///
    /// Those of one layer are made together: most of the work is the same at all heights.
    pub(crate) fn make(
        &self,
        keys: impl IntoIterator<Item = i64>,
        products: impl IntoIterator<Item = (i64, usize)>,
    ) -> Result<(), WaveError> {
        // If another thread panics, every table in the map is still complete.
        let mut made = self.made.lock().unwrap_or_else(PoisonError::into_inner);
        let mut missing: BTreeMap<i64, Missing> = BTreeMap::new();
        for key in keys {
            if !made.states.contains_key(&key) {
                missing.entry(key).or_default().state = true;
            }
        }
        for (key, index) in products {
            if !made.products.contains_key(&(key, index)) {
                missing.entry(key).or_default().products.insert(index);
            }
        }
        let keys: Vec<i64> = missing.keys().copied().collect();
        for (key, state) in self.states(&keys) {
            let Missing {
                state: is_missing,
                products,
            } = &missing[&key];
            if *is_missing {
                let table = self.state_table(&state, &mut made.report);
                self.keep(&mut made, &table)?;
                made.states.insert(key, table);
            }
            for &index in products {
                let histories = self.product_histories(&state[0], index);
                let table = Arc::new(self.table(&histories, &[(self.peaks[1], 0.0)]));
                self.keep(&mut made, &table)?;
                made.products.insert((key, index), table);
            }
        }
        Ok(())
    }

    /// Table of displacement and traction at a key.
    pub(crate) fn at(&self, key: i64) -> Result<Arc<Table>, WaveError> {
        self.make([key], [])?;
        let made = self.made.lock().unwrap_or_else(PoisonError::into_inner);
        Ok(made.states[&key].clone())
    }

    /// Table of the product of a damped layer at a key.
    pub(crate) fn product(&self, key: i64, index: usize) -> Result<Arc<Table>, WaveError> {
        self.make([], [(key, index)])?;
        let made = self.made.lock().unwrap_or_else(PoisonError::into_inner);
        Ok(made.products[&(key, index)].clone())
    }

    fn state_table(
        &self,
        state: &[Vec<Complex>; 4],
        report: &mut LayeredTablesReport,
    ) -> Arc<Table> {
        let histories = self.histories(state);
        let errors = histories.interpolation(self.stride, self.window.valid(), self.stack.order);
        let [displacement, _, stress] = self.peaks;
        let [x, z] = self.remaining.map(|rest| (displacement, rest));
        let traction = (stress, 0.0);
        report.heights += 1;
        let shares = Probe {
            peaks: self.peaks,
            ..Probe::default()
        };
        let worst = report.interpolation.iter_mut();
        for (worst, error) in worst.zip(shares.shares(errors)) {
            *worst = worst.max(error);
        }
        Arc::new(match self.stack.order {
            1 => self.table(&histories, &[x, traction]),
            _ => self.table(&histories, &[x, z, traction, traction]),
        })
    }

    fn keep(&self, made: &mut Made, table: &Table) -> Result<(), WaveError> {
        made.report.bytes += table.values.len() * size_of::<f64>();
        if made.report.bytes > MOST_BYTES {
            return Err(WaveError::TableMemory {
                heights: made.report.heights,
                bytes: made.report.bytes,
                most: MOST_BYTES,
            });
        }
        Ok(())
    }

    /// Error of tables at more heights than there may be.
    pub(crate) fn too_large(&self, heights: usize) -> WaveError {
        WaveError::TableMemory {
            heights,
            bytes: heights * self.most_bytes(),
            most: MOST_BYTES,
        }
    }

    /// Spectra of the state at keys, for a unit incident displacement at the top of the half-space, some at a time.
    fn states<'s>(
        &'s self,
        keys: &'s [i64],
    ) -> impl Iterator<Item = (i64, [Vec<Complex>; 4])> + use<'s> {
        let of_height = 2 * self.stack.order * self.frequencies.len() * size_of::<Complex>();
        let most = (BATCH_BYTES / of_height).max(1);
        let layers = keys.chunk_by(|a, b| self.layer_of(*a) == self.layer_of(*b));
        layers
            .flat_map(move |keys| keys.chunks(most))
            .flat_map(|keys| {
                let places = keys.iter().map(|key| self.place(*key));
                let (layers, depths): (Vec<usize>, Vec<f64>) = places.unzip();
                let of = (layers[0], &depths[..]);
                let states = spectra(&self.stack, of, &self.frequencies, &self.amplitudes);
                keys.iter().copied().zip(states)
            })
    }

    /// Value and rate of a quantity of a table from the constant part of the spectrum.
    fn constant(&self, quantity: usize, quantities: usize, time: f64) -> (f64, f64) {
        let is_state = quantities == 2 * self.stack.order;
        match &self.statics {
            Some(statics) if is_state && quantity < self.stack.order => {
                statics.value(self.component(quantity), time)
            }
            _ => (0.0, 0.0),
        }
    }

    /// Share of a peak below which a table begins and ends.
    fn negligible(&self) -> f64 {
        match self.statics {
            Some(_) => NEGLIGIBLE_POWER,
            None => NEGLIGIBLE,
        }
    }

    /// Histories of a state, less those of the constant part of the spectrum.
    fn histories(&self, state: &[Vec<Complex>; 4]) -> Histories {
        let n = self.stack.order;
        let [displacement, velocity, acceleration] = &self.spectra;
        let of = |row: usize, signal: &[Complex]| {
            let constant = match &self.statics {
                Some(statics) if row < n => statics.coefficients[self.component(row)],
                _ => Complex::new(0.0, 0.0),
            };
            let values = state[row].iter().zip(signal);
            self.inverse(values.map(|(value, signal)| (value - constant) * signal))
        };
        let mut histories = Histories {
            values: Vec::with_capacity(2 * n),
            rates: Vec::with_capacity(2 * n),
            step: self.window.step,
        };
        for row in 0..2 * n {
            let [value, rate] = if row < n {
                [displacement, velocity]
            } else {
                [velocity, acceleration]
            };
            histories.values.push(of(row, value));
            histories.rates.push(of(row, rate));
        }
        histories
    }

    /// Component in [along, across, up] of a displacement of the state.
    fn component(&self, k: usize) -> usize {
        if self.stack.order == 1 { 1 } else { 2 * k }
    }

    /// Histories of the velocity of a displacement under the modulus of a damped layer.
    fn product_histories(&self, displacement: &[Complex], index: usize) -> Histories {
        let moduli = self.frequencies.iter();
        let moduli = moduli.map(|frequency| self.stack.modulus(index, *frequency));
        let under: Vec<Complex> = moduli.zip(displacement).map(|(m, u)| m * u).collect();
        let of = |signal: &[Complex]| self.inverse(under.iter().zip(signal).map(|(u, s)| u * s));
        Histories {
            values: vec![of(&self.spectra[1])],
            rates: vec![of(&self.spectra[2])],
            step: self.window.step,
        }
    }

    /// History of a spectrum, without the weight of the window.
    fn inverse(&self, spectrum: impl Iterator<Item = Complex>) -> Vec<f64> {
        let mut history = self.fourier.inverse_of(spectrum);
        if self.window.growth == 0.0 {
            return history;
        }
        let per_sample = 1.0 / self.window.weight(1);
        for (part, values) in history.chunks_mut(MULTIPLIED).enumerate() {
            let mut factor = 1.0 / self.window.weight(MULTIPLIED * part);
            for value in values {
                *value *= factor;
                factor *= per_sample;
            }
        }
        history
    }

    /// Table of histories without the quiet times before and after them. `of` has for each quantity its
    /// peak, and the value that remains after the end.
    fn table(&self, histories: &Histories, of: &[(f64, f64)]) -> Table {
        let valid = self.window.valid();
        let stride = self.stride;
        let count = valid / stride;
        let last = match self.window.until {
            Some(until) => (self.window.after(until) / stride + 2).min(count - 1),
            None => count - 1,
        };
        let (mut first, mut end) = (count, 0);
        for (values, (peak, rest)) in histories.values.iter().zip(of) {
            let limit = self.negligible() * peak;
            let before = |i: &usize| values[i * stride].abs() > limit;
            first = first.min((0..count).find(before).unwrap_or(count));
            let after = |i: &usize| (values[i * stride] - rest).abs() > limit;
            end = end.max((0..count).rev().find(after).unwrap_or(0));
        }
        let range = (first.saturating_sub(2), (end + 2).min(last));
        let quantities = histories.values.len();
        let mut values = Vec::new();
        if range.0 <= range.1 {
            values.reserve_exact((range.1 - range.0 + 1) * 2 * quantities);
            for i in range.0..=range.1 {
                let time = self.window.time(i * stride);
                let constant = |k: usize| self.constant(k, quantities, time);
                let of_values = histories.values.iter().enumerate();
                values.extend(of_values.map(|(k, values)| values[i * stride] + constant(k).0));
                let rates = histories.rates.iter().enumerate();
                values.extend(
                    rates.map(|(k, rates)| (rates[i * stride] + constant(k).1) * self.step()),
                );
            }
        }
        Table {
            start: self.window.time(range.0 * stride),
            per_step: 1.0 / self.step(),
            values,
        }
    }
}

impl Histories {
    /// Estimated errors of cubic interpolation over `stride` samples, of displacement (m), velocity
    /// (m/s) and stress (Pa).
    ///
    /// Over four times the interval the error of the values is 256 times as large for a smooth history
    /// and that of the derivatives 64 times; a quarter of that is counted on.
    pub(crate) fn interpolation(&self, stride: usize, valid: usize, order: usize) -> [f64; 3] {
        let mut errors = [0.0f64; 3];
        let wide = 4 * stride;
        for (k, (values, rates)) in self.values.iter().zip(&self.rates).enumerate() {
            let of_stress = k >= order;
            let value_of = if of_stress { 2 } else { 0 };
            for i in (0..valid.saturating_sub(wide)).step_by(stride) {
                let (a, b) = (values[i], values[i + wide]);
                let (va, vb) = (rates[i], rates[i + wide]);
                let middle = 0.5 * (a + b) + 0.125 * (va - vb) * (wide as f64 * self.step);
                let missed = (middle - values[i + wide / 2]).abs();
                errors[value_of] = errors[value_of].max(missed / 64.0);
                if !of_stress {
                    // At a quarter of the interval, where the derivative errs most.
                    let slope =
                        1.125 * (b - a) / (wide as f64 * self.step) + 0.1875 * va - 0.3125 * vb;
                    let missed = (slope - rates[i + wide / 4]).abs();
                    errors[1] = errors[1].max(missed / 16.0);
                }
            }
        }
        errors
    }
}

/// Largest magnitude of the first samples of a history.
pub(crate) fn peak(values: &[f64], valid: usize) -> f64 {
    values[..valid].iter().fold(0.0, |m, v| m.max(v.abs()))
}

/// Factor on a spectrum at a share of the Nyquist frequency: one up to a half, zero at the end, with
/// all derivatives continuous.
fn fall_off(share: f64) -> f64 {
    let x = 2.0 * share - 1.0;
    if x <= 0.0 {
        1.0
    } else if x >= 1.0 {
        0.0
    } else {
        1.0 / (1.0 + (1.0 / (1.0 - x) - 1.0 / x).exp())
    }
}
