//! Errors that more than one crate raises.

use thiserror::Error;

/// A parameter outside its permitted range.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{name} = {value} is outside its permitted range [{least}, {most}]")]
pub struct ParameterError {
    /// The field's name.
    pub name: &'static str,
    /// What was given.
    pub value: f64,
    /// The least permitted value.
    pub least: f64,
    /// The greatest permitted value.
    pub most: f64,
}

impl ParameterError {
    /// Accepts a finite value in the closed range `[least, most]`.
    ///
    /// # Errors
    /// The error itself, if the value is outside or not a number.
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

/// What makes the assembly of a model fail, from whichever crate it comes.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ModelError {
    /// A parameter outside its range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// A mesh that cannot be computed with.
    #[error(transparent)]
    Mesh(#[from] crate::MeshError),
    /// An implementation behind a socket refused; its own error is the source.
    #[error("{part}: {source}")]
    Refused {
        /// Which part of the model refused.
        part: String,
        /// Why.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
}

impl ModelError {
    /// Wraps the error of a user's type.
    pub fn refused(
        part: impl Into<String>,
        source: impl Into<Box<dyn std::error::Error + Send + Sync>>,
    ) -> Self {
        Self::Refused {
            part: part.into(),
            source: source.into(),
        }
    }
}

/// What ends a run before its time.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RunError {
    /// A parameter of the run outside its range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// The motion left the range of numbers, or grew past a stated bound.
    #[error(
        "the motion diverged at step {step} (t = {time:.6e} s): element {element} of set '{set}', \
         speed {speed:.3e} m/s at node {node}"
    )]
    Diverged {
        /// Step number, from 0.
        step: u64,
        /// Time (s).
        time: f64,
        /// The user's number of an element at the node with the largest motion.
        element: u64,
        /// The set of that element.
        set: String,
        /// The user's number of the node.
        node: u64,
        /// Its speed (m/s), possibly not finite.
        speed: f64,
    },
    /// The energy ledger does not close.
    #[error(
        "the energy ledger is off by {residual:.3e} of its scale at step {step} (limit {limit:.1e}); worst set '{set}'"
    )]
    EnergyResidual {
        /// Step number.
        step: u64,
        /// Residual over the ledger's scale.
        residual: f64,
        /// The permitted residual.
        limit: f64,
        /// The set with the largest share.
        set: String,
    },
    /// A time step that the scheme cannot take.
    #[error(
        "a step of {step:.6e} s is above the stable limit {limit:.6e} s of the scheme '{scheme}' ({reason})"
    )]
    UnstableStep {
        /// The wanted step (s).
        step: f64,
        /// The limit (s).
        limit: f64,
        /// The integrator's name.
        scheme: &'static str,
        /// What sets the limit.
        reason: String,
    },
    /// An integrator that is unstable at every step under the given damping.
    #[error(
        "the scheme '{scheme}' needs stiffness damping of at least {least:.6e} s (half the step); the model has {given:.6e} s"
    )]
    TooLittleDamping {
        /// The integrator's name.
        scheme: &'static str,
        /// The least stiffness damping (s).
        least: f64,
        /// What the model has (s).
        given: f64,
    },
    /// An element could not be computed.
    #[error("element {element} of set '{set}' at step {step}: {reason}")]
    Element {
        /// The user's number.
        element: u64,
        /// Its set.
        set: String,
        /// Step number.
        step: u64,
        /// Why.
        reason: String,
    },
    /// A constraint or joint could not be satisfied.
    #[error("constraint '{name}' at step {step}: {reason}")]
    Constraint {
        /// Its name.
        name: String,
        /// Step number.
        step: u64,
        /// Why.
        reason: String,
    },
    /// An observer failed the run.
    #[error("observer '{name}' at step {step}: {source}")]
    Observer {
        /// Its name.
        name: String,
        /// Step number.
        step: u64,
        /// Why.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
}
