//! Reports of static solutions.

/// Report of a static solution: numbers of operations and residual.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StaticReport {
    /// Number of load increments tried, including those that were repeated by halves.
    pub increments: u32,
    /// Number of displacement corrections in all increments.
    pub corrections: u32,
    /// Number of products of the elastic operator with a vector.
    pub products: u64,
    /// Number of factorisations of the operator; zero without a direct solver.
    pub factorisations: u32,
    /// Number of entries of the Cholesky factor, eight bytes each; zero without a direct solver.
    pub factor_entries: u64,
    /// Number of steps of the dynamic relaxation in all increments; zero with the other methods.
    pub steps: u64,
    /// Norm of the unbalanced forces at the end over that of the load (1), at most the tolerance.
    pub residual: f64,
    /// Norm of the load (N): the largest of the norms of applied forces, forces of the initial stress,
    /// and unbalanced forces at the start.
    pub load: f64,
    /// Norm of the unbalanced forces at the start over that of the load (1).
    pub unbalanced: f64,
}

/// Progress of a static solution, passed to the progress callback after each correction or a hundred steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StaticProgress {
    /// Load factor of the increment, 0 to 1.
    pub share: f64,
    /// Number of corrections in this increment, or of steps of a dynamic relaxation.
    pub correction: u32,
    /// Norm of the unbalanced forces over that of the load.
    pub residual: f64,
}

/// Report of the transition from a static to a dynamic stage.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct HandOverReport {
    /// Norm of the carried forces (N), which balance the body in addition to its loads.
    pub carried_forces: f64,
    /// Norm of their difference from the carried forces of the stage before, over that of the internal forces; of the
    /// order of rounding in a consistent model.
    pub difference: f64,
}
