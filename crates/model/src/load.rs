//! Nodal loads and functions of time.

use crate::{ParameterError, StateError, Vec3};

/// A scalar function of time (s).
///
/// It may be evaluated at any time and in any order, from several threads: its values depend on the time alone.
///
/// Every `Fn(f64) -> f64` that can be shared between threads implements it.
/// ```
/// use powerhouse_model::TimeFunction;
/// let ramp = |t: f64| (t / 0.5).clamp(0.0, 1.0);
/// assert_eq!(ramp.value(0.25), 0.5);
/// ```
pub trait TimeFunction: Send + Sync {
    /// Value at a time (s).
    fn value(&self, time: f64) -> f64;
    /// Whether the function is constant, so that loads are evaluated only once; false by default.
    fn is_constant(&self) -> bool {
        false
    }
}

impl<F: Fn(f64) -> f64 + Send + Sync> TimeFunction for F {
    fn value(&self, time: f64) -> f64 {
        self(time)
    }
}

/// A constant function of time, with its value.
///
/// ```
/// use powerhouse_model::{Constant, TimeFunction};
/// assert_eq!(Constant(9.81).value(3.0), 9.81);
/// assert!(Constant(1.0).is_constant());
/// let closure = |_: f64| 1.0;
/// assert!(!closure.is_constant(), "closures do not count as constant");
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Constant(pub f64);

impl TimeFunction for Constant {
    fn value(&self, _time: f64) -> f64 {
        self.0
    }
    fn is_constant(&self) -> bool {
        true
    }
}

/// A piecewise linear function of time, given by points, constant before the first and after the last.
///
/// ```
/// use powerhouse_model::{Table, TimeFunction};
/// let table = Table::new(&[1.0, 2.0, 4.0], &[0.0, 10.0, -10.0])?;
/// let values = [0.0, 1.5, 2.0, 3.0, 9.0].map(|time| table.value(time));
/// assert_eq!(values, [0.0, 5.0, 10.0, 0.0, -10.0]);
/// assert!(Table::new(&[1.0, 1.0], &[0.0, 5.0]).is_err());
/// # Ok::<(), powerhouse_model::ParameterError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    points: Vec<[f64; 2]>,
}

impl Table {
    /// A table of strictly increasing times (s) and as many values.
    ///
    /// # Errors
    /// An empty list of times, another number of values, times that do not increase strictly, a number
    /// that is not finite.
    pub fn new(times: &[f64], values: &[f64]) -> Result<Self, ParameterError> {
        let count = times.len() as f64;
        ParameterError::check("number of times", count, 1.0, f64::MAX)?;
        ParameterError::check("number of values", values.len() as f64, count, count)?;
        let mut least = f64::MIN;
        for (&time, &value) in times.iter().zip(values) {
            ParameterError::check("time", time, least, f64::MAX)?;
            ParameterError::check("value", value, f64::MIN, f64::MAX)?;
            least = time.next_up();
        }
        let points = times
            .iter()
            .zip(values)
            .map(|(&time, &value)| [time, value]);
        Ok(Self {
            points: points.collect(),
        })
    }
}

impl TimeFunction for Table {
    fn value(&self, time: f64) -> f64 {
        let after = self.points.partition_point(|&[t, _]| t <= time);
        let last = self.points.len() - 1;
        let [t0, v0] = self.points[after.saturating_sub(1)];
        let [t1, v1] = self.points[after.min(last)];
        if t1 > t0 {
            v0 + (v1 - v0) * ((time - t0) / (t1 - t0))
        } else {
            v0
        }
    }
    fn is_constant(&self) -> bool {
        self.points
            .iter()
            .all(|point| point[1] == self.points[0][1])
    }
}

/// A load: forces at some nodes as a function of time.
///
/// The engine evaluates it once in every time step, at rising times, as a task in parallel with other loads and with the
/// elements; the forces of a load that is [constant](Self::is_constant) are kept from the first step. In static solutions
/// the time does not advance.
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
    /// Name of the load in reports.
    fn name(&self) -> &str;
    /// Mesh indices of the loaded nodes, each at most once.
    fn nodes(&self) -> &[u32];
    /// Adds the forces (N) at a time (s) to `forces`, in the order of [`nodes`](Self::nodes).
    fn add_forces(&mut self, time: f64, forces: &mut [Vec3]);
    /// Whether the forces are constant in time, so that the engine evaluates them only once; false by default.
    fn is_constant(&self) -> bool {
        false
    }
    /// State of the load between two steps as bytes, if its forces depend on more than the time; empty by default.
    ///
    /// # Errors
    /// A state that cannot be saved.
    fn save_state(&self) -> Result<Vec<u8>, StateError> {
        Ok(Vec::new())
    }
    /// Restores a state that an equal load [saved](Self::save_state).
    ///
    /// # Errors
    /// A state of another load; by default every state that is not empty.
    fn restore_state(&mut self, saved: &[u8]) -> Result<(), StateError> {
        StateError::expect_none(saved)
    }
}
