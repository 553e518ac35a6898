//! Accelerations up to a frequency.

use core::f64::consts::{PI, TAU};

use powerhouse_model::{
    Cadence, Fields, Flow, ModelError, Observer, ParameterError, Reach, Selection, StateError,
    StepView, Vec3, decode, encode,
};
use serde::{Deserialize, Serialize};

use super::history::Channel;
use super::place::Probe;
use super::{HistoryTable, ObserveError, Recording};

/// Observer of the accelerations of the motions of a [`History`](super::History) up to a frequency, the band: at even intervals,
/// of all steps and without delay.
///
/// A filter of linear phase, symmetric about the instant of each value, makes them from the displacements of all steps: a sinusoid
/// of up to 0.75 of the band keeps its amplitude to 0.1 %, one of the band has half of it, and from 1.25 of the band on
/// less than 0.1 % is left. Rows are five to the period of the band, 2 ms apart at 100 Hz, so that straight lines between them are
/// not yet the motion, but the sum of the sinusoids of all rows is.
/// [Peaks](super::Column::peak) are those of twenty values to that period. A value depends on the four periods of the band
/// before and behind it: the body counts as moving uniformly before its motion begins, and behind the last step its
/// accelerations as those before it, mirrored, so that a run that ends amid the motion has no overshoot at its end. An observer
/// of a motion that began before its first step has the first row four periods later.
///
/// Where the band has fewer than two steps to its period, it is divided by the least whole number that gives two.
///
/// # Why so
/// *Displacements, not accelerations, are sampled.* Between two steps the body moves uniformly, so that the displacement is known
/// at every instant, and its second difference is the acceleration through a filter of its own (a triangle of two intervals),
/// which has next to nothing of what would be aliased. The filter makes up for what the triangle takes from the band.
pub struct BandLimited {
    band: f64,
    motions: Vec<Channel>,
    probes: Vec<Probe>,
    weights: Vec<f64>,
    sampling: Sampling,
    recording: Recording<HistoryTable>,
}

/// Samples of displacements to a period of the band.
const SAMPLES: f64 = 20.0;
/// Samples before and behind a value that it depends on.
const REACH: usize = 80;
/// Samples between rows.
const OF_A_ROW: i64 = 4;
/// Form of the Kaiser window of the filter: what is left beyond the band is 1e-3 (63 dB).
const WINDOW: f64 = 6.0;

/// State between two steps.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct Sampling {
    /// Samples per second; zero before the first step.
    rate: f64,
    /// Numbers of the first value that can be known and of the next sample, whose instants are these numbers over the rate.
    first: i64,
    next: i64,
    /// Displacements (m) of the last sample and of the one before.
    last: [Vec<f64>; 2],
    /// Second differences times the square of the rate (m/s2), one row per sample, of the last samples; a ring.
    differences: Vec<f64>,
    /// Row of the oldest of them.
    oldest: usize,
}

impl BandLimited {
    pub(super) fn new(
        band: f64,
        motions: Vec<Channel>,
        probes: Vec<Probe>,
    ) -> Result<Option<Self>, ObserveError> {
        ParameterError::check("band", band, f64::MIN_POSITIVE, f64::MAX)?;
        let mut table = HistoryTable::default();
        for channel in &motions {
            let columns = channel.columns();
            for (name, unit) in columns.into_iter().filter(|(_, unit)| *unit == "m/s2") {
                table.add_column(name, unit)?;
            }
        }
        Ok((!motions.is_empty()).then(|| Self {
            band,
            motions,
            probes,
            weights: weights(),
            sampling: Sampling::default(),
            recording: Recording::new(table),
        }))
    }
    /// Shared access to the table.
    pub fn recording(&self) -> Recording<HistoryTable> {
        self.recording.clone()
    }
    /// The values of a nodal field at the places of all motions.
    fn values(&self, field: &dyn Fn(u32) -> Vec3) -> Vec<f64> {
        let motions = self.motions.iter();
        let vectors = motions.map(|channel| channel.value(&self.probes, field));
        vectors.flat_map(<[f64; 3]>::from).collect()
    }
    /// Sampling that begins with a step.
    fn begin(&self, view: &dyn StepView) -> Sampling {
        let band = self.band / (2.0 * self.band * view.step()).ceil().max(1.0);
        let rate = SAMPLES * band;
        let whole = Cadence::whole_intervals(1.0 / rate, view.time(), view.step());
        let is_now = Cadence::is_same_time(whole / rate, view.time(), view.step());
        let first = whole as i64 + i64::from(!is_now);
        // The sample before the first one, were the motion uniform.
        let interval = 1.0 / rate;
        let before = self.values(&|node| view.displacement(node) - view.velocity(node) * interval);
        Sampling {
            rate,
            first: match view.number() {
                0 => first,
                _ => first + REACH as i64 + 1,
            },
            next: first,
            differences: vec![0.0; before.len() * self.weights.len()],
            last: [before, Vec::new()],
            oldest: 0,
        }
    }
    /// Takes the second differences (m/s2) at a sample, and adds what is known of the accelerations then.
    fn take(&mut self, number: i64, differences: &[f64]) {
        let sampling = &mut self.sampling;
        let (columns, rows) = (differences.len(), self.weights.len());
        let start = sampling.oldest * columns;
        sampling.differences[start..start + columns].copy_from_slice(differences);
        sampling.oldest = (sampling.oldest + 1) % rows;
        let known = number - REACH as i64;
        if known < sampling.first {
            return;
        }
        let mut values = vec![0.0; columns];
        for (index, weight) in self.weights.iter().enumerate() {
            let row = (sampling.oldest + index) % rows;
            let row = &sampling.differences[row * columns..][..columns];
            for (value, difference) in values.iter_mut().zip(row) {
                *value += weight * difference;
            }
        }
        let time = known as f64 / sampling.rate;
        let mut table = self.recording.lock();
        for (column, &value) in table.columns.iter_mut().zip(&values) {
            column.raise(value, time);
        }
        if known % OF_A_ROW == 0 {
            table.push(time, &values);
        }
    }
}

impl Observer for BandLimited {
    fn name(&self) -> &str {
        "band-limited accelerations"
    }
    fn fields(&self) -> Fields {
        Fields::default().with_acceleration(true)
    }
    fn reach(&self) -> Reach {
        let nodes = self.probes.iter().flat_map(Probe::nodes);
        Reach::NONE.with_nodes(Selection::These(nodes.collect()))
    }
    fn cadence(&self) -> Cadence {
        Cadence::Seconds(1.0 / (SAMPLES * self.band))
    }
    fn save_state(&self) -> Result<Vec<u8>, StateError> {
        encode(&(&self.sampling, self.recording.save()?))
    }
    fn restore_state(&mut self, saved: &[u8]) -> Result<(), StateError> {
        let (sampling, table): (Sampling, Vec<u8>) = decode(saved)?;
        self.recording.restore(&table, |found, here| {
            StateError::expect_same("the list of columns", found.names(), here.names())
        })?;
        self.sampling = sampling;
        Ok(())
    }
    fn observe(&mut self, view: &dyn StepView) -> Result<Flow, ModelError> {
        if self.sampling.rate == 0.0 {
            self.sampling = self.begin(view);
        }
        let (time, step, rate) = (view.time(), view.step(), self.sampling.rate);
        let reached = Cadence::whole_intervals(1.0 / rate, time, step) as i64;
        if self.sampling.next > reached {
            return Ok(Flow::Continue);
        }
        let displacement = self.values(&|node| view.displacement(node));
        // Velocity between the step before and this one.
        let velocity = self.values(&|node| {
            let half = view.acceleration(node) * (0.5 * step);
            view.velocity(node) - half
        });
        while self.sampling.next <= reached {
            let number = self.sampling.next;
            let back = time - number as f64 / rate;
            let moving = displacement.iter().zip(&velocity);
            let sample: Vec<f64> = moving.map(|(u, v)| u - back * v).collect();
            let [last, before] = &self.sampling.last;
            if !before.is_empty() {
                let three = sample.iter().zip(last).zip(before);
                let differences: Vec<f64> = three
                    .map(|((next, this), before)| (next - 2.0 * this + before) * rate * rate)
                    .collect();
                self.take(number - 1, &differences);
            }
            let last = core::mem::replace(&mut self.sampling.last[0], sample);
            self.sampling.last[1] = last;
            self.sampling.next += 1;
        }
        Ok(Flow::Continue)
    }
    fn finish(&mut self) -> Result<(), ModelError> {
        let (last, columns) = (self.sampling.next - 1, 3 * self.motions.len());
        if self.sampling.rate > 0.0 {
            let Sampling {
                differences,
                oldest,
                ..
            } = &self.sampling;
            let rows = self.weights.len();
            let latest = |back: usize| {
                let row = (oldest + rows - 1 - back) % rows;
                differences[row * columns..][..columns].to_vec()
            };
            let mirrored: Vec<Vec<f64>> = (0..=REACH).map(latest).collect();
            for (number, differences) in (last..).zip(&mirrored) {
                self.take(number, differences);
            }
        }
        Ok(())
    }
}

/// Weights of the samples around a value: `2 f sinc(2 f i)` at the frequency `f` of the band times the window of Kaiser (J. F.
/// Kaiser (1974), Proc. IEEE Symp. Circuits and Systems, 20-23), with the sum one, less a twelfth of their second
/// differences, by which a triangle of two intervals lowers a sinusoid.
fn weights() -> Vec<f64> {
    let reach = REACH as i32;
    let weight = |index: i32| {
        let (place, share) = (f64::from(index), f64::from(index) / f64::from(reach + 1));
        let sine = match index {
            0 => TAU / SAMPLES,
            _ => (TAU * place / SAMPLES).sin() / place,
        };
        if index.abs() <= reach {
            sine / PI * bessel(WINDOW * (1.0 - share * share).sqrt())
        } else {
            0.0
        }
    };
    let sum: f64 = (-reach..=reach).map(weight).sum();
    (-reach..=reach)
        .map(|index| {
            let change = weight(index - 1) - 2.0 * weight(index) + weight(index + 1);
            (weight(index) - change / 12.0) / sum
        })
        .collect()
}

/// Modified Bessel function of the first kind and order zero.
fn bessel(x: f64) -> f64 {
    let (mut sum, mut term) = (1.0, 1.0);
    for order in 1..60 {
        term *= (0.5 * x / f64::from(order)).powi(2);
        sum += term;
    }
    sum
}
