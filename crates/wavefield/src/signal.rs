//! Time functions of waves.

use crate::WaveError;

/// Displacement, velocity and acceleration of a signal at one time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SignalMotion {
    /// Displacement (m).
    pub displacement: f64,
    /// Velocity (m/s).
    pub velocity: f64,
    /// Acceleration (m/s2).
    pub acceleration: f64,
}

/// Time interval in which a signal moves, and the step that resolves it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SignalSupport {
    /// Start of the motion (s); before it the signal is at rest at zero.
    pub start: f64,
    /// End of the motion (s); after it the signal is at rest, possibly displaced.
    pub end: f64,
    /// Time step (s) at which quintic interpolation of displacement, velocity and acceleration
    /// represents the signal. Kinks of the acceleration fall on these steps.
    pub step: f64,
}

impl SignalSupport {
    /// Support of two signals together.
    pub(crate) fn with(self, other: Self) -> Self {
        Self {
            start: self.start.min(other.start),
            end: self.end.max(other.end),
            step: self.step.min(other.step),
        }
    }
}

/// Displacement of a wave, with its derivatives, as a function of time.
///
/// It is evaluated at any times in any order, from several threads: its values depend on the time alone, and velocity and
/// acceleration are the derivatives of the displacement.
///
/// ```
/// use powerhouse_wavefield::{Signal, SignalMotion, SignalSupport};
/// /// One swing of 1 mm and 2 s.
/// struct Swing;
/// impl Signal for Swing {
///     fn motion(&self, time: f64) -> SignalMotion {
///         if !(0.0..=2.0).contains(&time) {
///             return SignalMotion::default();
///         }
///         let (sine, cosine) = (std::f64::consts::PI * time).sin_cos();
///         let (rate, amplitude) = (std::f64::consts::PI, 0.5e-3);
///         SignalMotion {
///             displacement: amplitude * (1.0 - cosine),
///             velocity: amplitude * rate * sine,
///             acceleration: amplitude * rate * rate * cosine,
///         }
///     }
///     fn support(&self) -> SignalSupport { SignalSupport { start: 0.0, end: 2.0, step: 0.01 } }
/// }
/// let mut motion = ([0.0; 2], [0.0; 2]);
/// Swing.sample(&[1.0, 5.0], &mut motion.0, &mut motion.1);
/// assert!((motion.0[0] - 1e-3).abs() < 1e-15 && motion.0[1] == 0.0);
/// ```
pub trait Signal: Send + Sync {
    /// Motion at a time (s); finite at every time.
    fn motion(&self, time: f64) -> SignalMotion;
    /// Time interval and resolution of the motion.
    fn support(&self) -> SignalSupport;
    /// Computes displacements (m) and velocities (m/s) at many times (s), in one virtual call per batch; an own form must
    /// give the values of [`motion`](Self::motion).
    ///
    /// # Panics
    /// May panic if the outputs are shorter than `times`.
    #[inline]
    fn sample(&self, times: &[f64], displacement: &mut [f64], velocity: &mut [f64]) {
        for ((time, d), v) in times.iter().zip(displacement).zip(velocity) {
            let motion = self.motion(*time);
            *d = motion.displacement;
            *v = motion.velocity;
        }
    }
}

/// Returns an error if the signal ends displaced; `operation` is named in it.
pub(crate) fn check_return(signal: &dyn Signal, operation: &'static str) -> Result<(), WaveError> {
    const INSTANTS: usize = 1000;
    /// Permitted end displacement over the peak, for pulses of unbounded duration.
    const PERMITTED_SHARE: f64 = 1e-9;
    let support = signal.support();
    let displacement = signal.motion(support.end + support.step).displacement;
    let interval = (support.end - support.start) / INSTANTS as f64;
    let peak = (0..=INSTANTS).fold(0.0f64, |peak, i| {
        let motion = signal.motion(support.start + interval * i as f64);
        peak.max(motion.displacement.abs())
    });
    if displacement.abs() > PERMITTED_SHARE * peak {
        return Err(WaveError::PermanentDisplacement {
            operation,
            displacement,
        });
    }
    Ok(())
}
