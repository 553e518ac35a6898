//! Residual of the energy balance.

/// Residual of the energy balance of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnergyResidual {
    /// Residual at the end of the run (J).
    pub energy: f64,
    /// Its absolute value over the work of loads and prescribed motions at the end (1); zero where no residual was above
    /// rounding, none without such work.
    pub share_of_input: Option<f64>,
    /// Largest absolute residual at the samples of the run beyond the rounding of works that cancel, over the largest stored
    /// energy or external work until then (1).
    pub largest: f64,
}
