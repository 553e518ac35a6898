//! Errors of parameters, model assembly and runs.

use thiserror::Error;

use crate::StateError;

/// A parameter value outside its permitted range.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{name} = {value} is outside its permitted range{}", Range([*least, *most]))]
pub struct ParameterError {
    /// Name of the parameter, as its field or key is called.
    pub name: &'static str,
    /// Value that was given, in the unit of the parameter; it may be NaN or infinite.
    pub value: f64,
    /// Least permitted value, in the unit of the parameter.
    pub least: f64,
    /// Greatest permitted value, in the unit of the parameter.
    pub most: f64,
}

/// The end of a sentence that names a range; ends that are those of numbers are left out.
struct Range([f64; 2]);

impl core::fmt::Display for Range {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let [least, most] = self.0;
        match (least <= -f64::MAX, most >= f64::MAX) {
            (true, true) => write!(f, ": any finite number"),
            (true, false) => write!(f, ": at most {most}"),
            (false, true) if least == f64::MIN_POSITIVE => write!(f, ": above 0"),
            (false, true) => write!(f, ": at least {least}"),
            (false, false) => write!(f, " [{least}, {most}]"),
        }
    }
}

impl ParameterError {
    /// Checks that a value is finite and in the closed range `[least, most]`.
    ///
    /// # Errors
    /// A [`ParameterError`] with these arguments, if it is not.
    pub fn check(name: &'static str, value: f64, least: f64, most: f64) -> Result<(), Self> {
        if value.is_finite() && value >= least && value <= most {
            Ok(())
        } else {
            Err(Self {
                name,
                value,
                least,
                most,
            })
        }
    }
}

/// Failure of the assembly of a model, in any crate.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ModelError {
    /// A parameter outside its permitted range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// A fault of the mesh.
    #[error(transparent)]
    Mesh(#[from] crate::MeshError),
    /// An error of an implementation of one of the interfaces, such as a boundary or a law.
    #[error("{part}: {source}")]
    Refused {
        /// The part of the model that failed.
        part: String,
        /// Cause of the failure.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
}

impl ModelError {
    /// Wraps the error of a user's type as [`ModelError::Refused`].
    pub fn refused(
        part: impl Into<String>,
        source: impl Into<Box<dyn std::error::Error + Send + Sync>>,
    ) -> Self {
        Self::Refused {
            part: part.into(),
            source: source.into(),
        }
    }
    /// Refuses what an engine does not have, such as fibres, as [`ModelError::Refused`].
    pub fn lacking(part: impl Into<String>) -> Self {
        Self::refused(part, "the engine computes without them")
    }
}

/// Failure of a dynamic run. Element and node numbers are those of the mesh file; a step has the number of steps taken
/// before it.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RunError {
    /// A parameter of the run outside its permitted range, before the first step.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// Divergence during the run: a velocity that is not finite or above the bound.
    #[error(
        "the motion diverged at step {step} (t = {time:.6e} s): element {element} of set '{set}', \
         speed {speed:.3e} m/s at node {node}"
    )]
    Diverged {
        /// Number of the step, from 0.
        step: u64,
        /// Time (s).
        time: f64,
        /// Number of an element at the fastest node.
        element: u64,
        /// Set of that element.
        set: String,
        /// Number of the fastest node.
        node: u64,
        /// Speed of that node (m/s), possibly not finite.
        speed: f64,
    },
    /// A residual of the energy balance above its limit, at a reading during the run.
    #[error(
        "the residual of the energy balance is {residual:.3e} of the largest energy at step {step} (limit {limit:.1e}), largest in set '{set}'"
    )]
    EnergyResidual {
        /// Number of the step, from 0.
        step: u64,
        /// Residual over the largest stored energy or external work so far (1).
        residual: f64,
        /// Largest permitted residual (1).
        limit: f64,
        /// Element set with the largest share of the residual.
        set: String,
    },
    /// A time step that is not positive or is above the stability limit of the scheme, before the first step.
    #[error(
        "a step of {step:.6e} s is above the stable limit {limit:.6e} s of the scheme '{scheme}' ({reason})"
    )]
    UnstableStep {
        /// The step given (s).
        step: f64,
        /// Stability limit (s).
        limit: f64,
        /// Name of the integration scheme.
        scheme: &'static str,
        /// Cause of the limit.
        reason: String,
    },
    /// An integration scheme that is unstable under the damping of the model, before the first step.
    #[error(
        "the scheme '{scheme}' needs stiffness damping of at least {least:.6e} s (half the step); the model has {given:.6e} s"
    )]
    TooLittleDamping {
        /// Name of the integration scheme.
        scheme: &'static str,
        /// Least stiffness damping coefficient required (s).
        least: f64,
        /// Least stiffness damping coefficient of the model (s).
        given: f64,
    },
    /// An element whose displacement, velocity, stress or force is not finite, during the run.
    #[error("element {element} of set '{set}' at step {step}: {reason}")]
    Element {
        /// Number of the element.
        element: u64,
        /// Set of the element.
        set: String,
        /// Number of the step, from 0.
        step: u64,
        /// Cause of the failure.
        reason: String,
    },
    /// A constraint or joint that cannot be satisfied, during the run.
    #[error("constraint '{name}' at step {step}: {reason}")]
    Constraint {
        /// Name of the constraint.
        name: String,
        /// Number of the step, from 0.
        step: u64,
        /// Cause of the failure.
        reason: String,
    },
    /// A saved state from which the run cannot go on, before the first step, or a state that cannot be saved.
    #[error("the state of {part}: {source}")]
    State {
        /// Part of the run whose state it is, such as a block of elements.
        part: String,
        /// Cause of the failure.
        source: StateError,
    },
    /// A failure of the communication between ranks.
    #[error(transparent)]
    Ranks(#[from] crate::RankError),
    /// An option of a run that one rank alone supports at present, before the first step.
    #[error("{what} cannot be used on {ranks} ranks, only on one")]
    OneRankOnly {
        /// The option.
        what: &'static str,
        /// Number of ranks.
        ranks: usize,
    },
    /// Ranks whose runs differ, before the first step.
    #[error("{what} differs between the ranks, which must all make the same run")]
    RanksDiffer {
        /// The option or quantity that differs.
        what: &'static str,
    },
    /// An error on another rank, which ends the run on all of them.
    #[error("rank {rank}: {message}")]
    OnRank {
        /// Number of the rank.
        rank: usize,
        /// Message of its error.
        message: String,
    },
    /// A failure of the device that takes time steps, or a part of the run that it cannot compute, before the first step.
    #[error(transparent)]
    Device(#[from] crate::DeviceError),
    /// An error of an observer, in a step or when it completed its output.
    #[error("observer '{name}' at step {step}: {source}")]
    Observer {
        /// Name of the observer.
        name: String,
        /// Number of the step, from 0.
        step: u64,
        /// Cause of the failure.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
}
