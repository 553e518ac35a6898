//! Test pulses in closed form.

use powerhouse_model::ParameterError;
use std::f64::consts::PI;

use crate::{Signal, SignalMotion, SignalSupport, WaveError};

/// Checks that amplitude and times of a pulse are in their ranges.
fn check_pulse(amplitude: f64, positive: &[(&'static str, f64)]) -> Result<(), WaveError> {
    ParameterError::check("amplitude", amplitude, -1e12, 1e12)?;
    for (name, value) in positive {
        ParameterError::check(name, *value, 1e-12, 1e12)?;
    }
    Ok(())
}

/// One-sided smooth displacement pulse without permanent displacement: a cubic B-spline.
///
/// `u(t) = 16 A [G(x) - 4 G(x - 1/4) + 6 G(x - 1/2) - 4 G(x - 3/4) + G(x - 1)]`, `G(x) = max(x, 0)^3`,
/// `x = t / duration`; displacement, velocity and acceleration are continuous, the peak `A` is
/// reached at half the duration.
/// ```
/// use powerhouse_wavefield::{Signal, SmoothPulse};
/// let pulse = SmoothPulse::new(1.0, 0.8)?;
/// assert!((pulse.motion(0.4).displacement - 1.0).abs() < 1e-15);
/// assert_eq!(pulse.motion(0.9).displacement, 0.0);
/// # Ok::<(), powerhouse_wavefield::WaveError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmoothPulse {
    /// Peak displacement (m).
    pub amplitude: f64,
    /// Duration of the motion (s).
    pub duration: f64,
}

impl SmoothPulse {
    /// Pulse of a peak displacement (m) and a duration (s).
    ///
    /// # Errors
    /// If the amplitude is not finite or the duration not above zero.
    pub fn new(amplitude: f64, duration: f64) -> Result<Self, WaveError> {
        check_pulse(amplitude, &[("duration", duration)])?;
        Ok(Self {
            amplitude,
            duration,
        })
    }
}

impl Signal for SmoothPulse {
    #[inline]
    fn motion(&self, time: f64) -> SignalMotion {
        let x = time / self.duration;
        if !(0.0..=1.0).contains(&x) {
            return SignalMotion::default();
        }
        // Symmetric about x = 1/2; from the nearer end only two terms remain.
        let (y, sign) = if x <= 0.5 { (x, 1.0) } else { (1.0 - x, -1.0) };
        let z = (y - 0.25).max(0.0);
        let (scale, rate) = (16.0 * self.amplitude, 1.0 / self.duration);
        SignalMotion {
            displacement: scale * (y * y * y - 4.0 * z * z * z),
            velocity: sign * rate * scale * (3.0 * y * y - 12.0 * z * z),
            acceleration: rate * rate * scale * (6.0 * y - 24.0 * z),
        }
    }
    fn support(&self) -> SignalSupport {
        SignalSupport {
            start: 0.0,
            end: self.duration,
            step: self.duration / 200.0,
        }
    }
}

/// One-sided displacement pulse in the shape of a raised cosine.
///
/// `u(t) = A sin^2(pi t / duration)`; displacement and velocity are continuous, acceleration jumps
/// at both ends. It is wider than a [`SmoothPulse`] of the same duration, and so needs a less fine
/// mesh.
/// ```
/// use powerhouse_wavefield::{RaisedCosinePulse, Signal};
/// let pulse = RaisedCosinePulse::new(1.0, 0.8)?;
/// assert!((pulse.motion(0.4).displacement - 1.0).abs() < 1e-15);
/// assert!((pulse.motion(0.2).displacement - 0.5).abs() < 1e-15);
/// assert_eq!(pulse.motion(0.9).displacement, 0.0);
/// # Ok::<(), powerhouse_wavefield::WaveError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RaisedCosinePulse {
    /// Peak displacement (m).
    pub amplitude: f64,
    /// Duration of the motion (s).
    pub duration: f64,
}

impl RaisedCosinePulse {
    /// Pulse of a peak displacement (m) and a duration (s).
    ///
    /// # Errors
    /// If the amplitude is not finite or the duration not above zero.
    pub fn new(amplitude: f64, duration: f64) -> Result<Self, WaveError> {
        check_pulse(amplitude, &[("duration", duration)])?;
        Ok(Self {
            amplitude,
            duration,
        })
    }
}

impl Signal for RaisedCosinePulse {
    #[inline]
    fn motion(&self, time: f64) -> SignalMotion {
        if !(0.0..=self.duration).contains(&time) {
            return SignalMotion::default();
        }
        let rate = PI / self.duration;
        let (sine, cosine) = (rate * time).sin_cos();
        SignalMotion {
            displacement: self.amplitude * sine * sine,
            velocity: 2.0 * self.amplitude * rate * sine * cosine,
            acceleration: 2.0 * self.amplitude * rate * rate * (cosine * cosine - sine * sine),
        }
    }
    fn support(&self) -> SignalSupport {
        SignalSupport {
            start: 0.0,
            end: self.duration,
            step: self.duration / 200.0,
        }
    }
}

/// Two-sided displacement pulse whose time integral and first moment vanish.
///
/// `u(t) = A (1 - y^2)^3 (1 - 9 y^2)`, `y = 2 t / duration - 1`: the second derivative of
/// `(1 - y^2)^5`, scaled. Displacement, velocity and acceleration are continuous. Past the
/// critical angle, where fields are not causal, its forerunner falls with the third power of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ZeroMeanPulse {
    /// Displacement at the centre (m), which is the peak.
    pub amplitude: f64,
    /// Duration of the motion (s).
    pub duration: f64,
}

impl ZeroMeanPulse {
    /// Pulse of a peak displacement (m) and a duration (s).
    ///
    /// # Errors
    /// If the amplitude is not finite or the duration not above zero.
    pub fn new(amplitude: f64, duration: f64) -> Result<Self, WaveError> {
        check_pulse(amplitude, &[("duration", duration)])?;
        Ok(Self {
            amplitude,
            duration,
        })
    }
}

impl Signal for ZeroMeanPulse {
    #[inline]
    fn motion(&self, time: f64) -> SignalMotion {
        let y = 2.0 * time / self.duration - 1.0;
        if !(-1.0..=1.0).contains(&y) {
            return SignalMotion::default();
        }
        let (square, rate) = (y * y, 2.0 / self.duration);
        let rest = 1.0 - square;
        SignalMotion {
            displacement: self.amplitude * rest * rest * rest * (1.0 - 9.0 * square),
            velocity: self.amplitude * rate * rest * rest * y * (72.0 * square - 24.0),
            acceleration: self.amplitude
                * rate
                * rate
                * rest
                * (-24.0 + square * (336.0 - 504.0 * square)),
        }
    }
    fn support(&self) -> SignalSupport {
        SignalSupport {
            start: 0.0,
            end: self.duration,
            step: self.duration / 400.0,
        }
    }
}

/// Quantity of a [`Ricker`] pulse that has the Ricker shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RickerQuantity {
    /// Displacement, amplitude in m.
    Displacement,
    /// Velocity, amplitude in m/s.
    Velocity,
}

/// Ricker pulse `A (1 - 2 q) exp(-q)` with `q = (pi f (t - delay))^2`.
///
/// Source: N. Ricker (1953), Geophysics 18(1). The pulse has no finite start: with a delay of
/// `1.5 / frequency` it is 1e-8 of its peak at time zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ricker {
    /// Quantity that has the Ricker shape.
    pub quantity: RickerQuantity,
    /// Peak of that quantity (m or m/s).
    pub amplitude: f64,
    /// Frequency at which the spectrum of that quantity peaks (Hz).
    pub frequency: f64,
    /// Time of the peak (s).
    pub delay: f64,
}

impl Ricker {
    /// Pulse of a peak (m or m/s), a frequency (Hz) and the time of its peak (s).
    ///
    /// # Errors
    /// If a number is not finite or the frequency not above zero.
    pub fn new(
        quantity: RickerQuantity,
        amplitude: f64,
        frequency: f64,
        delay: f64,
    ) -> Result<Self, WaveError> {
        check_pulse(amplitude, &[("frequency", frequency)])?;
        ParameterError::check("delay", delay, -1e12, 1e12)?;
        Ok(Self {
            quantity,
            amplitude,
            frequency,
            delay,
        })
    }
}

impl Signal for Ricker {
    #[inline]
    fn motion(&self, time: f64) -> SignalMotion {
        let rate = PI * self.frequency;
        let x = (time - self.delay) * rate;
        let q = x * x;
        let shape = self.amplitude * (-q).exp();
        if shape == 0.0 {
            return SignalMotion::default();
        }
        // exp(-x^2) and its derivatives by Hermite polynomials.
        let second = 1.0 - 2.0 * q;
        let third = x * (4.0 * q - 6.0);
        match self.quantity {
            RickerQuantity::Displacement => SignalMotion {
                displacement: shape * second,
                velocity: shape * rate * third,
                acceleration: shape * rate * rate * (24.0 * q - 8.0 * q * q - 6.0),
            },
            RickerQuantity::Velocity => SignalMotion {
                displacement: shape * x / rate,
                velocity: shape * second,
                acceleration: shape * rate * third,
            },
        }
    }
    fn support(&self) -> SignalSupport {
        let half = 2.0 / self.frequency;
        SignalSupport {
            start: self.delay - half,
            end: self.delay + half,
            step: half / 200.0,
        }
    }
}

/// Harmonic displacement under a sine-squared window: `A sin(2 pi f t) sin^2(pi f t / cycles)`.
///
/// With three cycles or more its spectrum is a narrow peak at `f`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HarmonicBurst {
    /// Amplitude of the harmonic (m).
    pub amplitude: f64,
    /// Frequency (Hz).
    pub frequency: f64,
    /// Number of cycles in the window (1), 1 to 1e4.
    pub cycles: f64,
}

impl HarmonicBurst {
    /// Burst of an amplitude (m), a frequency (Hz) and a number of cycles.
    ///
    /// # Errors
    /// If a number is not finite or the frequency not above zero; the cycles range from 1 to 1e4.
    pub fn new(amplitude: f64, frequency: f64, cycles: f64) -> Result<Self, WaveError> {
        check_pulse(amplitude, &[("frequency", frequency)])?;
        ParameterError::check("cycles", cycles, 1.0, 1e4)?;
        Ok(Self {
            amplitude,
            frequency,
            cycles,
        })
    }
}

impl Signal for HarmonicBurst {
    #[inline]
    fn motion(&self, time: f64) -> SignalMotion {
        let duration = self.cycles / self.frequency;
        if !(0.0..=duration).contains(&time) {
            return SignalMotion::default();
        }
        let (carrier, window) = (2.0 * PI * self.frequency, 2.0 * PI / duration);
        let (sine, cosine) = (carrier * time).sin_cos();
        let (window_sine, window_cosine) = (window * time).sin_cos();
        let half = 0.5 * self.amplitude;
        let shape = 1.0 - window_cosine;
        SignalMotion {
            displacement: half * sine * shape,
            velocity: half * (carrier * cosine * shape + sine * window * window_sine),
            acceleration: half
                * (sine * (window * window * window_cosine - carrier * carrier * shape)
                    + 2.0 * carrier * cosine * window * window_sine),
        }
    }
    fn support(&self) -> SignalSupport {
        SignalSupport {
            start: 0.0,
            end: self.cycles / self.frequency,
            step: 1.0 / (100.0 * self.frequency),
        }
    }
}
