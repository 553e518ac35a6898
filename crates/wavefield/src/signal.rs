//! The time function of a wave.

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

/// When a signal moves, and how finely.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Support {
    /// Before this time (s) the signal is at rest at zero.
    pub start: f64,
    /// After this time (s) the signal is at rest, possibly displaced.
    pub end: f64,
    /// A time step (s) at which samples of displacement, velocity and acceleration, joined by
    /// quintics, represent the signal. Where the acceleration has kinks they fall on these steps.
    pub step: f64,
}

/// The displacement that a wave carries, with its derivatives, as a function of time.
///
/// ```
/// use powerhouse_wavefield::{Signal, SignalMotion, Support};
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
///     fn support(&self) -> Support { Support { start: 0.0, end: 2.0, step: 0.01 } }
/// }
/// let mut motion = ([0.0; 2], [0.0; 2]);
/// Swing.sample(&[1.0, 5.0], &mut motion.0, &mut motion.1);
/// assert!((motion.0[0] - 1e-3).abs() < 1e-15 && motion.0[1] == 0.0);
/// ```
pub trait Signal: Send + Sync {
    /// The motion at a time (s); finite at every time.
    fn motion(&self, time: f64) -> SignalMotion;
    /// When the signal moves.
    fn support(&self) -> Support;
    /// Displacements (m) and velocities (m/s) at many times (s): one virtual call for a batch.
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

/// Refuses a signal that ends displaced, as far as an operation cannot take that.
pub(crate) fn check_return(signal: &dyn Signal, operation: &'static str) -> Result<(), WaveError> {
    const INSTANTS: usize = 1000;
    /// Of the peak: what a pulse that never quite begins and ends leaves.
    const PERMITTED_SHARE: f64 = 1e-9;
    let support = signal.support();
    let displacement = signal.motion(support.end + support.step).displacement;
    let interval = (support.end - support.start) / INSTANTS as f64;
    let peak = (0..=INSTANTS).fold(0.0f64, |peak, i| {
        let motion = signal.motion(support.start + interval * i as f64);
        peak.max(motion.displacement.abs())
    });
    if displacement.abs() > PERMITTED_SHARE * peak {
        return Err(WaveError::LastingDisplacement {
            operation,
            displacement,
        });
    }
    Ok(())
}
