//! Options of static solutions: method, tolerance, increments.

use crate::ParameterError;

/// Solution method for static equilibrium.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum StaticMethod {
    /// Corrections with the elastic operator, each by conjugate gradients preconditioned with the inverses of the
    /// nodal 3 x 3 diagonals; no matrix is assembled.
    #[default]
    ConjugateGradients,
    /// Corrections with a sparse Cholesky factor, ordered by nested dissection, in engines that have a direct solver.
    ///
    /// Efficient where one factor serves many corrections and memory permits: a cube of 30 bricks a
    /// side has 9.3e7 entries in its factor and takes 0.9 GiB, one of 60 has 1.54e9 and takes 12.7 GiB
    /// (`cargo bench --bench statics --features direct -- cholesky 60`). On two busy cores that took
    /// 713 s; conjugate gradients took 23 s, 390 products and 0.2 GiB (`-- gradients 60`).
    Cholesky(Linearisation),
    /// Dynamic relaxation: damped explicit steps in pseudo-time until the body is in static equilibrium, with the laws of
    /// joints evaluated in every step. For joints that slide and open, and for softening, where Newton's method does
    /// not converge.
    ///
    /// Each increment begins with the solution of [`ConjugateGradients`](Self::ConjugateGradients) with all sticking
    /// pairs tied, so that bonds do not break by waves of the relaxation itself.
    /// Then, with fictitious masses for which the step is stable,
    ///
    /// `v+ = (1 - c dt) v + dt M^-1 (f_ext - f_int(u) + f_joint)`, `u+ = u + dt v+`
    ///
    /// with the damping `c` twice the frequency of the present motion, the root of its Rayleigh
    /// quotient `v . K v / (v . M v)`, `K` as seen along the last step (Underwood 1983, in
    /// *Computational Methods for Transient Analysis*, ch. 5). Constitutive laws are evaluated for the whole increment,
    /// as in the other methods; joint laws step by step.
    DynamicRelaxation,
}

/// The operator that a direct solver factors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Linearisation {
    /// The elastic operator, factored once; corrections are accelerated with earlier ones (modified Newton method).
    #[default]
    Elastic,
    /// The consistent tangent, factored for each correction (Newton's method).
    ///
    /// Cholesky takes its symmetric part. For associated flow this is the whole tangent, and
    /// corrections converge quadratically. For dilation less than friction it is not, and they
    /// converge linearly, accelerated with earlier ones where they grow. Where softening makes
    /// it indefinite the increment is halved, as if it had not converged.
    Tangent,
}

/// Options of a static solution.
///
/// ```
/// use powerhouse_model::StaticOptions;
/// let options = StaticOptions::default().with_tolerance(1.0e-10);
/// assert!(options.check().is_ok());
/// assert!(options.with_tolerance(0.0).check().is_err());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StaticOptions {
    /// Method by which static equilibrium is computed.
    pub method: StaticMethod,
    /// Tolerance: the largest permitted norm of the unbalanced forces over that of the load, 1e-14 to 1; 1e-8 by default.
    pub tolerance: f64,
    /// Number of load increments, 1 to 1e6, more where one does not converge; 1 by default.
    pub increments: u32,
    /// Largest number of corrections in one increment before it is halved, 1 to 1e6; 100 by default.
    pub corrections: u32,
    /// Largest number of steps of a dynamic relaxation in one increment before it is halved, 1 to 4e9; 50,000 by default.
    pub steps: u32,
    /// Smallest permitted increment as a share of the load, 1e-9 to 1; 1e-3 by default.
    pub least_increment: f64,
    /// Share of the initially unbalanced forces that is applied (load relaxation factor), 1e-6 to 1; 1 by default. With
    /// less, the remainder stays balanced by carried forces until the next solution, as by the support of a tunnel
    /// face nearby.
    pub release: f64,
}

impl StaticMethod {
    /// Name of the method in messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::ConjugateGradients => "conjugate gradients",
            Self::Cholesky(Linearisation::Elastic) => "Cholesky",
            Self::Cholesky(Linearisation::Tangent) => "Newton",
            Self::DynamicRelaxation => "dynamic relaxation",
        }
    }
}

impl Default for StaticOptions {
    fn default() -> Self {
        Self {
            method: StaticMethod::default(),
            tolerance: 1.0e-8,
            increments: 1,
            corrections: 100,
            steps: 50_000,
            least_increment: 1.0e-3,
            release: 1.0,
        }
    }
}

impl StaticOptions {
    /// The same options with another solution method ([`method`](Self::method)).
    #[must_use]
    pub fn with_method(mut self, method: StaticMethod) -> Self {
        self.method = method;
        self
    }
    /// The same options with another tolerance of equilibrium ([`tolerance`](Self::tolerance)), 1e-14 to 1.
    #[must_use]
    pub fn with_tolerance(mut self, tolerance: f64) -> Self {
        self.tolerance = tolerance;
        self
    }
    /// The same options with another number of load increments ([`increments`](Self::increments)), 1 to 1e6.
    #[must_use]
    pub fn with_increments(mut self, increments: u32) -> Self {
        self.increments = increments;
        self
    }
    /// The same options with another load relaxation factor ([`release`](Self::release)), 1e-6 to 1.
    #[must_use]
    pub fn with_release(mut self, release: f64) -> Self {
        self.release = release;
        self
    }
    /// Checks the ranges of all fields.
    ///
    /// # Errors
    /// The first field outside its permitted range.
    pub fn check(&self) -> Result<(), ParameterError> {
        ParameterError::check("tolerance", self.tolerance, 1.0e-14, 1.0)?;
        ParameterError::check("increments", f64::from(self.increments), 1.0, 1.0e6)?;
        ParameterError::check("corrections", f64::from(self.corrections), 1.0, 1.0e6)?;
        ParameterError::check("steps", f64::from(self.steps), 1.0, 4.0e9)?;
        ParameterError::check("least_increment", self.least_increment, 1.0e-9, 1.0)?;
        ParameterError::check("release", self.release, 1.0e-6, 1.0)
    }
}
