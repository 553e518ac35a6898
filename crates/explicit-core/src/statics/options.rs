//! How a static solution is found, and how far it goes.

use powerhouse_model::ParameterError;

/// How a body is brought to rest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum StaticMethod {
    /// Corrections by the elastic operator, each by conjugate gradients with the inverses of the
    /// nodal 3 x 3 diagonals: no matrix is assembled.
    #[default]
    ConjugateGradients,
    /// Corrections by a sparse Cholesky factor, in an order by nested dissection.
    ///
    /// Worth it where one factor serves many corrections and memory permits: a cube of 30 bricks a
    /// side has 9.3e7 entries in its factor and takes 0.9 GiB, one of 60 has 1.54e9 and takes 12.7 GiB
    /// (`cargo bench --bench statics --features direct -- cholesky 60`). On two busy cores that took
    /// 713 s; conjugate gradients took 23 s, 390 products and 0.2 GiB (`-- gradients 60`).
    #[cfg(feature = "direct")]
    Cholesky(Linearisation),
    /// Explicit steps in a time of its own, damped until nothing moves, with the laws of joints
    /// asked in every step: for joints that slide and open, and for softening that leaves Newton's
    /// corrections nowhere to go.
    ///
    /// Each increment begins with what [`ConjugateGradients`](Self::ConjugateGradients) would do if
    /// all that sticks went on sticking, so that bonds do not break by waves that no load made.
    /// Then, with masses for which one step is stable,
    ///
    /// `v+ = (1 - c dt) v + dt M^-1 (f_ext - f_int(u) + f_joint)`, `u+ = u + dt v+`
    ///
    /// with the damping `c` twice the frequency of the present motion, the root of its Rayleigh
    /// quotient `v . K v / (v . M v)`, `K` as seen along the last step (Underwood 1983, in
    /// *Computational Methods for Transient Analysis*, ch. 5). Laws answer for the whole increment,
    /// as in the other methods; joints step by step.
    DynamicRelaxation,
}

/// What a direct solver factors.
#[cfg(feature = "direct")]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Linearisation {
    /// The elastic operator, once; corrections are accelerated by earlier ones.
    #[default]
    Elastic,
    /// The consistent tangent, anew for each correction.
    ///
    /// Cholesky takes its symmetric part. That is all of it for flow that is associated, where
    /// corrections converge by squares. Where dilation is less than friction it is not, and they
    /// converge by a factor; those that do not are combined with earlier ones. Where softening makes
    /// it indefinite the increment is cut, as if it had not converged.
    Tangent,
}

/// How far a static solution goes.
///
/// ```
/// use powerhouse_explicit_core::StaticOptions;
/// let options = StaticOptions::default().with_tolerance(1.0e-10);
/// assert!(options.check().is_ok());
/// assert!(options.with_tolerance(0.0).check().is_err());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StaticOptions {
    /// How the body is brought to rest.
    pub method: StaticMethod,
    /// The gate: the norm of the forces out of balance over that of the load; 1e-8 by default.
    pub tolerance: f64,
    /// Increments that the load comes in, more where one does not converge; 1 by default.
    pub increments: u32,
    /// Corrections in one increment before it is cut in half; 100 by default.
    pub corrections: u32,
    /// Steps of a dynamic relaxation in one increment before it is cut in half; 50,000 by default.
    pub steps: u32,
    /// The smallest share of the load that an increment may be cut to; 1e-3 by default.
    pub least_increment: f64,
    /// The share of what is out of balance at the start that comes; 1 by default. Less leaves the
    /// rest standing, as a face ahead that still bears, until the next solution.
    pub release: f64,
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
    /// The same by another method.
    #[must_use]
    pub fn with_method(mut self, method: StaticMethod) -> Self {
        self.method = method;
        self
    }
    /// The same with another gate.
    #[must_use]
    pub fn with_tolerance(mut self, tolerance: f64) -> Self {
        self.tolerance = tolerance;
        self
    }
    /// The same with so many increments.
    #[must_use]
    pub fn with_increments(mut self, increments: u32) -> Self {
        self.increments = increments;
        self
    }
    /// The same with a share of what is out of balance that comes.
    #[must_use]
    pub fn with_release(mut self, release: f64) -> Self {
        self.release = release;
        self
    }
    /// Whether every field is in its range.
    ///
    /// # Errors
    /// The first that is not.
    pub fn check(&self) -> Result<(), ParameterError> {
        ParameterError::check("tolerance", self.tolerance, 1.0e-14, 1.0)?;
        ParameterError::check("increments", f64::from(self.increments), 1.0, 1.0e6)?;
        ParameterError::check("corrections", f64::from(self.corrections), 1.0, 1.0e6)?;
        ParameterError::check("steps", f64::from(self.steps), 1.0, 4.0e9)?;
        ParameterError::check("least_increment", self.least_increment, 1.0e-9, 1.0)?;
        ParameterError::check("release", self.release, 1.0e-6, 1.0)
    }
}
