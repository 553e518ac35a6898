//! Window of time in which a layered field is computed, and how long it must be.

use super::ground::Ground;
use super::stack::Stack;
use super::tables::{LayeredTables, MOST_SAMPLES, StaticPart};
use crate::sampled::falling;
use crate::{Signal, SignalMotion, SurfaceReflection, WaveError, WaveKind};

/// Decay of a causal field over the window, as an exponent: its periodic images are smaller by
/// `exp(-12)`.
const WINDOW_DECAY: f64 = 12.0;
/// Share of the window of a causal field that is used.
const USED: f64 = 0.6;
/// Shares of the window between which a permanent displacement is taken back.
const TAKEN_BACK: [f64; 2] = [0.65, 0.85];
/// Share of the window of another field that lies before the signal.
const BEFORE: f64 = 0.4;
/// Permitted motion at the end of the window over its peak.
const QUIET: f64 = 1e-6;
/// The same where the motion falls as a power of time.
const QUIET_POWER: f64 = 1e-5;
/// The same for a window under a slow weight, by which the periodic images are smaller.
const QUIET_WEIGHTED: f64 = 5e-5;
/// Decay of a field that is not causal over a long window, as an exponent, and the least duration of such a
/// window (s): the spectrum has a kink at zero, which a faster decay would not respect.
const SLOW_DECAY: f64 = 8.0;
const LEAST_WEIGHTED: f64 = 250.0;
/// Permitted errors of interpolation of displacement, velocity and stress over their peaks.
const INTERPOLATION: [f64; 3] = [3e-6, 2e-4, 2e-4];

/// Uniform samples in time, with the exponential weight under which they are transformed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Window {
    /// Number of samples, a power of two.
    pub(crate) length: usize,
    /// Time between two samples (s).
    pub(crate) step: f64,
    /// Time of the first sample (s), on the signal's axis.
    first: f64,
    /// Whether nothing moves before the signal's start.
    pub(crate) causal: bool,
    /// Rate of the weight `exp(-growth t)` (1/s).
    pub(crate) growth: f64,
    /// Time (s) after the signal's start up to which the motion is needed; none for all.
    pub(crate) until: Option<f64>,
    /// Time of the signal's start (s).
    start: f64,
}

impl Window {
    /// Time of a sample (s).
    pub(crate) fn time(&self, index: usize) -> f64 {
        self.first + index as f64 * self.step
    }
    /// Index of the first sample after a time from the signal's start (s).
    pub(crate) fn after(&self, time: f64) -> usize {
        ((self.start + time - self.first) / self.step).ceil() as usize
    }
    /// Weight of a sample (1).
    pub(crate) fn weight(&self, index: usize) -> f64 {
        (-self.growth * index as f64 * self.step).exp()
    }
    /// Number of samples that can be used.
    pub(crate) fn valid(&self) -> usize {
        if self.causal {
            (USED * self.length as f64) as usize
        } else {
            self.length
        }
    }
}

/// Motion of a signal in a window: a permanent displacement is taken back after the times that are used.
pub(crate) fn held(signal: &dyn Signal, time: f64, window: &Window) -> SignalMotion {
    let motion = signal.motion(time);
    let length = window.length as f64 * window.step;
    let [from, to] = TAKEN_BACK.map(|share| window.first + share * length);
    if !window.causal || time <= from {
        return motion;
    }
    if time >= to {
        return SignalMotion::default();
    }
    let rate = 1.0 / (to - from);
    let [w, w1, w2] = falling((time - from) * rate, rate);
    SignalMotion {
        displacement: motion.displacement * w,
        velocity: motion.velocity * w + motion.displacement * w1,
        acceleration: motion.acceleration * w
            + 2.0 * motion.velocity * w1
            + motion.displacement * w2,
    }
}

/// A plane wave that is incident from the half-space on its layers.
#[derive(Clone, Copy)]
pub(crate) struct Arriving<'a> {
    pub(crate) ground: &'a Ground,
    pub(crate) kind: WaveKind,
    /// Reflection at a surface of the half-space without layers.
    pub(crate) reflection: &'a SurfaceReflection,
    pub(crate) signal: &'a dyn Signal,
    /// Lowest height z at which the field is needed (m).
    pub(crate) lowest: f64,
    /// Time (s) after its arrival up to which the motion is needed; none for all.
    pub(crate) until: Option<f64>,
}

impl Arriving<'_> {
    /// Whether nothing moves before the first wave arrives: all waves in all media travel.
    pub(crate) fn is_causal(&self) -> bool {
        let highest = 0.5 / self.signal.support().step;
        let fastest = self.ground.fastest(self.kind == WaveKind::SH, highest);
        self.slowness() * fastest < 1.0
    }

    fn slowness(&self) -> f64 {
        self.reflection.horizontal_slowness
    }

    /// Tables over the least window, a power of two of half steps of the signal, at whose end the
    /// motion has died out at surface, interfaces and lowest height or is not needed; and what is left of
    /// it over its peak.
    pub(crate) fn tables(&self) -> Result<(LayeredTables, f64), WaveError> {
        let support = self.signal.support();
        let past_critical = self.reflection.past_critical();
        let causal = self.is_causal();
        let mut step = 0.5 * support.step;
        let pads = match (causal, past_critical) {
            (true, _) => 2.0,
            (false, false) => 4.0,
            (false, true) => 8.0,
        };
        let length = support.end - support.start + self.longest_delay();
        // What comes after the time that is needed does not reach back to it.
        let needed = self.until.filter(|_| causal);
        let mut duration = match needed {
            Some(until) => (until + 4.0 * support.step) / USED,
            None => pads * length,
        };
        loop {
            let count = duration / step;
            WaveError::check_samples("the ring-down of the layers", count, MOST_SAMPLES)?;
            let samples = (count.ceil() as usize).max(256).next_power_of_two();
            duration = samples as f64 * step;
            // Sharp resonances ring on for longer than a window can be: these decay under a weight.
            let is_long = !causal
                && self
                    .until
                    .is_some_and(|until| duration > self.weighted(until));
            let decay = match (causal, is_long) {
                (true, _) => WINDOW_DECAY,
                (false, true) => SLOW_DECAY,
                (false, false) => 0.0,
            };
            let window = Window {
                length: samples,
                step,
                first: if causal {
                    support.start
                } else {
                    support.start - BEFORE * duration
                },
                causal,
                growth: decay / duration,
                until: self.until,
                start: support.start,
            };
            let mut tables = self.in_window(window)?;
            let probe = tables.probe(&self.probed(&tables));
            tables.peaks = probe.peaks;
            let left = probe.shares(probe.left).into_iter().fold(0.0, f64::max);
            let left = if is_long { left * (-decay).exp() } else { left };
            let permitted = match (past_critical, is_long) {
                (_, true) => QUIET_WEIGHTED,
                (true, _) => QUIET_POWER,
                (false, _) => QUIET,
            };
            // Of a causal field what still moves at the end comes back under the weight alone.
            let is_covered = needed.is_some_and(|until| window.after(until) < window.valid())
                && left * (-decay).exp() <= QUIET;
            if left > permitted && !is_covered {
                duration *= 2.0;
                continue;
            }
            let apart = probe.shares(probe.errors).into_iter().zip(INTERPOLATION);
            let worst = apart.fold(0.0f64, |m, (error, most)| m.max(error / most));
            if worst > 1.0 {
                tables.refine();
                // Beyond twice the signal's own resolution nothing is gained.
                if worst > 8.0 && step > 0.2 * support.step {
                    step *= 0.5;
                    continue;
                }
            }
            return Ok((tables, left));
        }
    }

    /// Least duration of a window under a weight (s), where the field is needed up to a time after its
    /// arrival (s).
    fn weighted(&self, until: f64) -> f64 {
        let support = self.signal.support();
        let long = LEAST_WEIGHTED.max(2.0 * (support.end - support.start));
        long.max(2.0 * until)
    }

    fn in_window(&self, window: Window) -> Result<LayeredTables, WaveError> {
        let support = self.signal.support();
        let stack = Stack::new(self.ground, self.kind, self.slowness());
        let motion = self.reflection.surface_motion();
        let statics = if self.reflection.past_critical() {
            Some(StaticPart::new(self.signal, motion)?)
        } else {
            None
        };
        let end = self.signal.motion(support.end + support.step).displacement;
        let remaining = match (window.causal, stack.order) {
            (false, _) => [0.0; 2],
            (true, 1) => [motion[1].re * end, 0.0],
            (true, _) => [motion[0].re * end, motion[2].re * end],
        };
        let (ground, signal) = (self.ground, self.signal);
        let unit = self.unit();
        Ok(LayeredTables::new(
            ground, stack, signal, window, statics, remaining, unit,
        ))
    }

    /// Unit of heights (m): a millionth of the depth, or of the thinnest layer.
    fn unit(&self) -> f64 {
        let ground = self.ground;
        let depth = (ground.surface() - self.lowest).max(ground.surface() - ground.base());
        let thickness = (0..ground.layers().len()).map(|index| {
            let [top, bottom] = ground.extent(index);
            top - bottom
        });
        1e-6 * thickness.fold(depth.max(1.0), f64::min)
    }

    /// Delay (s) after the incident wave of the slowest wave that passes every layer twice, up and down, and goes on to the
    /// lowest height.
    pub(crate) fn longest_delay(&self) -> f64 {
        let slow = |index: usize| 1.0 / self.ground.medium(index).s_speed();
        let layers = (0..self.ground.layers().len()).map(|index| {
            let [top, bottom] = self.ground.extent(index);
            2.0 * (top - bottom) * slow(index)
        });
        let below = (self.ground.base() - self.lowest).max(0.0);
        layers.sum::<f64>() + 2.0 * below * slow(self.ground.layers().len())
    }

    /// Keys of surface, interfaces and lowest height.
    fn probed(&self, tables: &LayeredTables) -> Vec<i64> {
        let ends = [self.ground.surface(), self.lowest];
        let heights = self.ground.interfaces().iter().chain(&ends);
        heights.map(|height| tables.key(*height)).collect()
    }
}
