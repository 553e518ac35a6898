//! Loads.

use crate::Vec3;

/// A number as a function of time (s).
///
/// Every `Fn(f64) -> f64` that can be shared between threads is one.
/// ```
/// use powerhouse_model::TimeFunction;
/// let ramp = |t: f64| (t / 0.5).clamp(0.0, 1.0);
/// assert_eq!(ramp.value(0.25), 0.5);
/// ```
pub trait TimeFunction: Send + Sync {
    /// The value at a time.
    fn value(&self, time: f64) -> f64;
}

impl<F: Fn(f64) -> f64 + Send + Sync> TimeFunction for F {
    fn value(&self, time: f64) -> f64 {
        self(time)
    }
}

/// Forces at some nodes as a function of time.
///
/// ```
/// use powerhouse_model::{NodalLoad, Vec3};
/// struct Weight { nodes: Vec<u32> }
/// impl NodalLoad for Weight {
///     fn name(&self) -> &str { "weight" }
///     fn nodes(&self) -> &[u32] { &self.nodes }
///     fn add_forces(&mut self, _time: f64, forces: &mut [Vec3]) {
///         for force in forces { force.z -= 9.81; }
///     }
/// }
/// ```
pub trait NodalLoad: Send {
    /// The load's name in reports.
    fn name(&self) -> &str;
    /// The mesh's node indices, each at most once.
    fn nodes(&self) -> &[u32];
    /// Adds the forces (N) at a time (s), in the order of [`nodes`](Self::nodes).
    fn add_forces(&mut self, time: f64, forces: &mut [Vec3]);
}
