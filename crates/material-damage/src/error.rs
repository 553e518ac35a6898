//! What a law or its driver refuses.

use powerhouse_model::ParameterError;
use thiserror::Error;

/// A law that cannot be made, or a path that cannot be followed.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum MaterialError {
    /// A parameter outside its range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// A law that dilates more than associated flow gains energy from nothing.
    #[error("dilation = {dilation} degrees is above friction = {friction} degrees")]
    Dilation {
        /// Dilation angle (degrees).
        dilation: f64,
        /// Friction angle (degrees).
        friction: f64,
    },
}
