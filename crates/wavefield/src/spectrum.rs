//! Response spectra and Fourier spectra of records.

use powerhouse_model::ParameterError;
use std::f64::consts::PI;

use crate::fourier::Fourier;
use crate::{TimeHistory, WaveError};

/// Peak response of a linear single-degree-of-freedom oscillator to a record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OscillatorResponse {
    /// Natural period (s).
    pub period: f64,
    /// Peak relative displacement (m), SD.
    pub displacement: f64,
    /// Peak relative velocity (m/s), SV.
    pub velocity: f64,
    /// Peak absolute acceleration (m/s2), SA.
    pub acceleration: f64,
}

impl OscillatorResponse {
    /// Pseudo-velocity, `w SD` (m/s).
    pub fn pseudo_velocity(&self) -> f64 {
        2.0 * PI / self.period * self.displacement
    }
    /// Pseudo-acceleration, `w^2 SD` (m/s2).
    pub fn pseudo_acceleration(&self) -> f64 {
        (2.0 * PI / self.period).powi(2) * self.displacement
    }
}

/// Ordinate of a Fourier amplitude spectrum at one frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpectralLine {
    /// Frequency (Hz).
    pub frequency: f64,
    /// Fourier amplitude of the acceleration, `|int a exp(-i w t) dt|` (m/s).
    pub amplitude: f64,
}

/// Response spectrum with broadened peaks, over the same frequencies (Hz, ascending).
///
/// At each frequency `f` it is the greatest ordinate of the polyline between `f / (1 + share)` and `f / (1 - share)`, so that a
/// peak at `f` covers `f (1 - share)` to `f (1 + share)`: what the frequencies of structure and ground are uncertain by
/// (U.S. NRC, Regulatory Guide 1.122, takes 0.15 where no other share is shown to do). A share of zero changes nothing.
///
/// # Errors
/// If the share is not in [0, 0.5], or frequencies are not above zero and ascending.
pub fn broadened_spectrum(
    frequencies: &[f64],
    ordinates: &[f64],
    share: f64,
) -> Result<Vec<f64>, WaveError> {
    ParameterError::check("share", share, 0.0, 0.5)?;
    let mut least = f64::MIN_POSITIVE;
    for &frequency in frequencies {
        ParameterError::check("frequency", frequency, least, 1e9)?;
        least = frequency;
    }
    let at = |frequency: f64| {
        let above = frequencies.partition_point(|&other| other < frequency);
        if above == 0 || above == frequencies.len() {
            // Beyond the ends nothing is known.
            return 0.0;
        }
        let [low, high] = [frequencies[above - 1], frequencies[above]];
        let [from, to] = [ordinates[above - 1], ordinates[above]];
        from + (to - from) * (frequency - low) / (high - low)
    };
    let broadened = frequencies.iter().map(|frequency| {
        let [low, high] = [frequency / (1.0 + share), frequency / (1.0 - share)];
        let within = (frequencies.iter().zip(ordinates))
            .filter(|(other, _)| (low..=high).contains(*other))
            .map(|(_, &ordinate)| ordinate);
        within.fold(at(low).max(at(high)), f64::max)
    });
    Ok(broadened.collect())
}

impl TimeHistory {
    /// Elastic response spectrum for a damping ratio, at the given periods (s).
    ///
    /// The oscillator `u'' + 2 z w u' + w^2 u = -a(t)` is solved exactly for the piecewise-linear
    /// record (N. C. Nigam and P. C. Jennings (1969), Bull. Seism. Soc. Am. 59(2)). Peaks are taken over
    /// at least 32 instants a period and four a step, during the record and one period of free vibration
    /// after it.
    ///
    /// # Errors
    /// If the damping is not in [0, 0.99], or a period not above a thousandth of the step.
    pub fn response_spectrum(
        &self,
        damping: f64,
        periods: &[f64],
    ) -> Result<Vec<OscillatorResponse>, WaveError> {
        ParameterError::check("damping", damping, 0.0, 0.99)?;
        let acceleration = self.acceleration();
        let response = periods.iter().map(|&period| {
            ParameterError::check("period", period, 1e-3 * self.step(), 1e6)?;
            Ok(self.oscillator(&acceleration, damping, period))
        });
        response.collect()
    }

    fn oscillator(&self, acceleration: &[f64], damping: f64, period: f64) -> OscillatorResponse {
        let mut largest = OscillatorResponse {
            period,
            displacement: 0.0,
            velocity: 0.0,
            acceleration: 0.0,
        };
        let march = March::new(self.step(), damping, period);
        let oscillator = &march.oscillator;
        march.run(acceleration, |_, (displacement, velocity)| {
            largest.displacement = largest.displacement.max(displacement.abs());
            largest.velocity = largest.velocity.max(velocity.abs());
            let absolute = oscillator.absolute_acceleration((displacement, velocity));
            largest.acceleration = largest.acceleration.max(absolute.abs());
        });
        largest
    }

    /// Fourier amplitude spectrum of the acceleration, from zero to the Nyquist frequency, at multiples
    /// of `1 / (n step)` with n the least power of two of at least twice the number of samples.
    ///
    /// Exact for the piecewise-linear record, taken to fall to zero within one step beyond both
    /// ends: the discrete transform times `step sinc^2(pi f step)`.
    pub fn fourier_spectrum(&self) -> Vec<SpectralLine> {
        let fourier = Fourier::new(2 * self.samples());
        let spectrum = fourier.forward(&self.acceleration());
        let bin = 1.0 / (fourier.len() as f64 * self.step());
        let lines = spectrum.iter().enumerate().map(|(i, value)| {
            let frequency = i as f64 * bin;
            let x = PI * frequency * self.step();
            let sinc = if x == 0.0 { 1.0 } else { x.sin() / x };
            SpectralLine {
                frequency,
                amplitude: value.norm() * self.step() * sinc * sinc,
            }
        });
        lines.collect()
    }
}

/// Motion of one oscillator under a record, at least 32 instants a period and four a step of the record.
pub(crate) struct March {
    /// Instants in each step of the record.
    pub(crate) parts: usize,
    /// Instants of free vibration after the record: one period.
    after: usize,
    oscillator: Oscillator,
}

impl March {
    pub(crate) fn new(step: f64, damping: f64, period: f64) -> Self {
        const INSTANTS_PER_PERIOD: f64 = 32.0;
        const INSTANTS_PER_STEP: f64 = 4.0;
        let parts = (INSTANTS_PER_PERIOD * step / period).ceil();
        let parts = parts.max(INSTANTS_PER_STEP);
        Self {
            parts: parts as usize,
            after: (period / step).ceil() as usize,
            oscillator: Oscillator::new(2.0 * PI / period, damping, step / parts),
        }
    }

    /// Shows each instant, counted from 1, with displacement and velocity relative to the ground.
    pub(crate) fn run(&self, acceleration: &[f64], mut see: impl FnMut(usize, (f64, f64))) {
        let (mut state, mut instant) = ((0.0, 0.0), 0);
        let mut advance = |from: f64, to: f64| {
            let rise = (to - from) / self.parts as f64;
            for part in 0..self.parts {
                let ground = from + rise * part as f64;
                state = self
                    .oscillator
                    .advance(state, ground, rise / self.oscillator.step);
                instant += 1;
                see(instant, state);
            }
        };
        for pair in acceleration.windows(2) {
            advance(pair[0], pair[1]);
        }
        for _ in 0..self.after {
            advance(0.0, 0.0);
        }
    }
}

/// Exact propagator of one oscillator over one step.
struct Oscillator {
    frequency: f64,
    damping: f64,
    step: f64,
    /// State (u, u') after a step of free vibration, from unit displacement and from unit velocity.
    free: [[f64; 2]; 2],
}

impl Oscillator {
    fn new(frequency: f64, damping: f64, step: f64) -> Self {
        let damped = frequency * (1.0 - damping * damping).sqrt();
        let decay = (-damping * frequency * step).exp();
        let (sine, cosine) = (damped * step).sin_cos();
        let ratio = damping * frequency / damped;
        Self {
            frequency,
            damping,
            step,
            free: [
                [
                    decay * (cosine + ratio * sine),
                    -decay * frequency * frequency / damped * sine,
                ],
                [decay * sine / damped, decay * (cosine - ratio * sine)],
            ],
        }
    }

    /// State (u, u') after a step under ground acceleration `a + slope t`.
    ///
    /// `u_p = -(a + slope t) / w^2 + 2 z slope / w^3` solves the forced equation; the difference vibrates
    /// freely.
    fn advance(&self, (u, v): (f64, f64), a: f64, slope: f64) -> (f64, f64) {
        let stiffness = self.frequency * self.frequency;
        let lag = 2.0 * self.damping * slope / (stiffness * self.frequency);
        let drift = -slope / stiffness;
        let (u, v) = (u + a / stiffness - lag, v - drift);
        let [from_u, from_v] = &self.free;
        (
            from_u[0] * u + from_v[0] * v - (a + slope * self.step) / stiffness + lag,
            from_u[1] * u + from_v[1] * v + drift,
        )
    }

    /// Absolute acceleration `u'' + a = -2 z w u' - w^2 u`.
    fn absolute_acceleration(&self, (u, v): (f64, f64)) -> f64 {
        -self.frequency * (2.0 * self.damping * v + self.frequency * u)
    }
}
