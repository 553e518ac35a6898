//! Displacement corrections from unbalanced forces.

#[cfg(feature = "direct")]
use powerhouse_model::{Linearisation, Operator};
use powerhouse_model::{StaticError, StaticMethod, StaticReport, Vec3};

#[cfg(feature = "direct")]
use super::direct::Factor;
use super::gradients;
use super::system::System;

/// Linear solver of the static method in use.
pub(super) enum Corrector {
    Gradients,
    /// Cholesky factor of the elastic operator.
    #[cfg(feature = "direct")]
    Elastic(Box<Factor>),
    /// Cholesky factor of the tangent, factored anew for every correction.
    #[cfg(feature = "direct")]
    Tangent(Box<Factor>),
}

impl Corrector {
    /// The linear solver of a method.
    pub(super) fn new(
        method: StaticMethod,
        system: &System,
        report: &mut StaticReport,
    ) -> Result<Self, StaticError> {
        #[cfg(not(feature = "direct"))]
        let _ = (system, report);
        match method {
            StaticMethod::ConjugateGradients | StaticMethod::DynamicRelaxation => {
                Ok(Self::Gradients)
            }
            #[cfg(feature = "direct")]
            StaticMethod::Cholesky(linearisation) => {
                let mut factor = Box::new(Factor::new(system)?);
                report.factor_entries = factor.entries();
                if linearisation == Linearisation::Tangent && !system.is_linear() {
                    return Ok(Self::Tangent(factor));
                }
                report.factorisations += 1;
                factor.factor(system, Operator::Static)?;
                Ok(Self::Elastic(factor))
            }
            other => Err(StaticError::NoMethod {
                engine: crate::NAME.into(),
                method: other.name(),
            }),
        }
    }

    /// Whether corrections use the tangent of the present state (Newton's method).
    pub(super) fn is_tangent(&self) -> bool {
        #[cfg(feature = "direct")]
        if let Self::Tangent(_) = self {
            return true;
        }
        false
    }

    /// Displacement correction (m) for unbalanced forces (N) at the state of the last forces; the
    /// linear solver reduces them to at most a share `left`.
    pub(super) fn correct(
        &mut self,
        system: &mut System,
        residual: &[Vec3],
        left: f64,
        report: &mut StaticReport,
    ) -> Result<Vec<Vec3>, StaticError> {
        match self {
            Self::Gradients => {
                let (step, products) = gradients::solve(system, residual, left)?;
                report.products += products;
                Ok(step)
            }
            #[cfg(feature = "direct")]
            Self::Elastic(factor) => factor.solve(residual),
            #[cfg(feature = "direct")]
            Self::Tangent(factor) => {
                report.factorisations += 1;
                factor.factor(system, Operator::Tangent)?;
                factor.solve(residual)
            }
        }
    }
}
