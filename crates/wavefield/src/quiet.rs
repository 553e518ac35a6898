//! Motion of a field at the start of an analysis, and a taper that makes it small.

use powerhouse_model::{
    FieldMotion, FieldSampler, IncidentField, ModelError, ParameterError, Vec3,
};
use std::f64::consts::FRAC_2_PI;

use crate::analytic::StartTaper;
use crate::{LayeredWave, PlaneWave, WaveError};

/// Motion of a field at one time relative to its peak at the same points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StartLevel {
    /// Largest displacement over the peak displacement (1).
    pub displacement: f64,
    /// Largest velocity over the peak velocity (1).
    pub velocity: f64,
}

impl StartLevel {
    /// Larger one of the displacement and velocity levels (1).
    pub fn largest(&self) -> f64 {
        self.displacement.max(self.velocity)
    }
}

/// Permitted motion of a field at the start of an analysis, and limits of the delay and taper that
/// achieve it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuietStartLimits {
    /// Displacement and velocity at the start over their peaks (1), 1e-12 to 0.5.
    pub threshold: f64,
    /// Greatest permitted delay of the wave (s), 0 to 1000. The cost of the search is proportional to it: the field is
    /// evaluated at all points at every fourth step of the signal, or less often for long signals, over this time.
    pub most_padding: f64,
    /// Least width of the taper (s). A wider one retains more of the forerunner, and needs about
    /// twice `ln(1 / threshold)` of its width as delay.
    pub least_taper: f64,
}

impl Default for QuietStartLimits {
    /// Threshold 1e-4 of the peak, at most 20 s of delay, the narrowest taper.
    fn default() -> Self {
        Self {
            threshold: 1e-4,
            most_padding: 20.0,
            least_taper: 0.0,
        }
    }
}

impl QuietStartLimits {
    fn check(&self, start: f64) -> Result<(), ParameterError> {
        ParameterError::check("start", start, -1e9, 1e9)?;
        ParameterError::check("threshold", self.threshold, 1e-12, 0.5)?;
        ParameterError::check("most_padding", self.most_padding, 0.0, 1e3)?;
        ParameterError::check("least_taper", self.least_taper, 0.0, 1e6)
    }
}

/// Delay and taper that let a field start at rest, and the error that they make.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuietStart {
    /// Delay of the wave (s).
    pub padding: f64,
    /// Motion of the delayed and tapered field at the start over its peak.
    pub level: StartLevel,
    /// Largest displacement that the taper removed from the field, over the peak (1); zero without a
    /// taper.
    pub removed: f64,
    /// Time in which the taper falls by a factor e (s); zero without a taper.
    pub taper: f64,
}

impl PlaneWave {
    /// Motion of the field at a time (s) over its peak, both taken over the given points.
    ///
    /// Before the first arrival it is zero below the critical angle; past it the forerunner of the
    /// reflected waves already moves the points.
    ///
    /// # Errors
    /// As [`prepare`](IncidentField::prepare).
    pub fn start_level(&self, points: &[Vec3], time: f64) -> Result<StartLevel, ModelError> {
        let envelope = Envelope::of(self, points)?;
        Ok(envelope.level(time))
    }

    /// Wave with the least delay, and past the critical angle a taper, for which displacement and
    /// velocity at all points are below the threshold at `start` (s).
    ///
    /// Past the critical angle the analytic signal is multiplied by `1 / (1 + exp(-(z - c) / w))`:
    /// the surface stays free and the equation of motion satisfied at all depths of the points.
    /// `w` is ten of the signal's own steps or more, as much as the depth demands; `c` lies before
    /// the signal's start by so much that the signal itself changes by less than the threshold.
    /// The forerunner before `c` is removed; the report states how much. The result is still an exact
    /// field, of incident waves that differ by that much.
    ///
    /// # Errors
    /// [`WaveError::NotQuiet`] if the permitted padding does not suffice; parameter errors for
    /// limits out of range; as [`prepare`](IncidentField::prepare).
    pub fn with_quiet_start(
        &self,
        points: &[Vec3],
        start: f64,
        limits: &QuietStartLimits,
    ) -> Result<(Self, QuietStart), ModelError> {
        limits.check(start)?;
        let taper = (!self.is_causal()).then(|| self.start_taper(points, limits));
        let tapered = self.delayed(0.0, taper);
        let envelope = Envelope::of(&tapered, points)?;
        let padding = envelope.padding(start, limits)?;
        let level = envelope.level(start - padding);
        let removed = match taper {
            Some(_) => Envelope::of(self, points)?.difference(&envelope, start - padding),
            None => 0.0,
        };
        let report = QuietStart {
            padding,
            level,
            removed,
            taper: taper.map_or(0.0, |taper| taper.width),
        };
        Ok((self.delayed(padding, taper), report))
    }

    fn start_taper(&self, points: &[Vec3], limits: &QuietStartLimits) -> StartTaper {
        let support = self.signal.support();
        let waves = self.partial_waves().iter();
        let heights = waves.flat_map(|wave| points.iter().map(|point| -wave.delay(point).im));
        let height = heights.fold(0.0, f64::max);
        let width = (FRAC_2_PI * height)
            .max(10.0 * support.step)
            .max(limits.least_taper);
        StartTaper {
            // 1 - factor at the signal's start is exp(-(start - centre) / width).
            centre: support.start + width * limits.threshold.ln(),
            width,
        }
    }
}

impl LayeredWave {
    /// Motion of the field at a time (s) over its peak, both taken over the given points.
    ///
    /// # Errors
    /// As [`prepare`](IncidentField::prepare).
    pub fn start_level(&self, points: &[Vec3], time: f64) -> Result<StartLevel, ModelError> {
        Ok(self.envelope(points)?.level(time))
    }

    /// Wave with the least delay for which displacement and velocity at all points are below the
    /// threshold at `start` (s).
    ///
    /// Where the field is not causal the motion before the start is left out without a taper: at most
    /// the threshold, of which the body then knows nothing.
    ///
    /// # Errors
    /// [`WaveError::NotQuiet`] if the permitted padding does not suffice; parameter errors for
    /// limits out of range; as [`prepare`](IncidentField::prepare).
    pub fn with_quiet_start(
        &self,
        points: &[Vec3],
        start: f64,
        limits: &QuietStartLimits,
    ) -> Result<(Self, QuietStart), ModelError> {
        limits.check(start)?;
        let envelope = self.envelope(points)?;
        let padding = envelope.padding(start, limits)?;
        let level = envelope.level(start - padding);
        let report = QuietStart {
            padding,
            level,
            removed: level.displacement,
            taper: 0.0,
        };
        Ok((self.later(padding), report))
    }

    fn envelope(&self, points: &[Vec3]) -> Result<Envelope, ModelError> {
        let sampler = self.prepare(points)?;
        Ok(Envelope::new(
            sampler,
            self.times(points),
            self.signal_step(),
        ))
    }
}

/// Field at some points, with its peaks.
struct Envelope {
    sampler: Box<dyn FieldSampler>,
    /// First and last time (s) at which the signal moves a point.
    window: [f64; 2],
    step: f64,
    peak: [f64; 2],
}

impl Envelope {
    fn of(wave: &PlaneWave, points: &[Vec3]) -> Result<Self, ModelError> {
        let support = wave.signal.support();
        let waves = wave.partial_waves().iter();
        let delays = waves.flat_map(|wave| points.iter().map(|point| wave.delay(point).re));
        let (mut first, mut last) = (f64::INFINITY, f64::NEG_INFINITY);
        for delay in delays {
            first = first.min(delay);
            last = last.max(delay);
        }
        if first > last {
            (first, last) = (0.0, 0.0);
        }
        let window = [support.start + first, support.end + last];
        Ok(Self::new(wave.prepare(points)?, window, support.step))
    }

    /// Field that a sampler evaluates, with its peaks in a window of time; `step` is that of the signal (s).
    fn new(sampler: Box<dyn FieldSampler>, window: [f64; 2], step: f64) -> Self {
        const MOST_INSTANTS: f64 = 4000.0;
        let step = (4.0 * step).max((window[1] - window[0]) / MOST_INSTANTS);
        let mut envelope = Self {
            sampler,
            window,
            step,
            peak: [0.0; 2],
        };
        for time in envelope.instants(window[0]) {
            let largest = envelope.largest(time);
            envelope.peak = core::array::from_fn(|i| envelope.peak[i].max(largest[i]));
        }
        envelope
    }

    fn instants(&self, from: f64) -> impl Iterator<Item = f64> + use<> {
        let (step, count) = (self.step, (self.window[1] - from) / self.step);
        (0..=count.max(0.0).ceil() as usize).map(move |i| from + step * i as f64)
    }

    fn motion(&self, time: f64) -> Vec<FieldMotion> {
        let mut motion = vec![FieldMotion::default(); self.sampler.len()];
        self.sampler.add_motion(time, &mut motion);
        motion
    }

    /// Largest displacement and velocity at a time.
    fn largest(&self, time: f64) -> [f64; 2] {
        let mut largest = [0.0f64; 2];
        for motion in self.motion(time) {
            largest[0] = largest[0].max(motion.displacement.norm());
            largest[1] = largest[1].max(motion.velocity.norm());
        }
        largest
    }

    fn level(&self, time: f64) -> StartLevel {
        let [displacement, velocity] = self.largest(time);
        let over = |value: f64, peak: f64| if value == 0.0 { 0.0 } else { value / peak };
        StartLevel {
            displacement: over(displacement, self.peak[0]),
            velocity: over(velocity, self.peak[1]),
        }
    }

    /// Least padding such that all larger paddings satisfy the threshold too.
    fn padding(&self, start: f64, limits: &QuietStartLimits) -> Result<f64, WaveError> {
        let (threshold, most) = (limits.threshold, limits.most_padding);
        let count = (most / self.step).floor() as usize;
        let mut quiet = None;
        let less = (0..=count).rev().map(|i| self.step * i as f64);
        for padding in core::iter::once(most).chain(less) {
            if self.level(start - padding).largest() >= threshold {
                break;
            }
            quiet = Some(padding);
        }
        quiet.ok_or_else(|| WaveError::NotQuiet {
            padding: most,
            level: self.level(start - most).largest(),
            threshold,
        })
    }

    /// Largest difference in displacement from another field at the same points from a time on,
    /// over the peak.
    fn difference(&self, other: &Self, from: f64) -> f64 {
        let mut largest = 0.0f64;
        for time in self.instants(from) {
            for (a, b) in self.motion(time).iter().zip(other.motion(time)) {
                largest = largest.max((a.displacement - b.displacement).norm());
            }
        }
        if largest == 0.0 {
            0.0
        } else {
            largest / self.peak[0]
        }
    }
}
