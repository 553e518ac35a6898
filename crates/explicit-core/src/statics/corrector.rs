//! From forces out of balance to a correction of the displacement.

#[cfg(feature = "direct")]
use powerhouse_model::Operator;
use powerhouse_model::Vec3;

#[cfg(feature = "direct")]
use super::direct::Factor;
#[cfg(feature = "direct")]
use super::options::Linearisation;
use super::system::System;
use super::{StaticError, StaticMethod, StaticReport, gradients};

/// A linear solver of the method in use.
pub(super) enum Corrector {
    Gradients,
    /// A factor of the elastic operator.
    #[cfg(feature = "direct")]
    Elastic(Box<Factor>),
    /// A factor that is to be made anew at every state.
    #[cfg(feature = "direct")]
    Tangent(Box<Factor>),
}

impl Corrector {
    /// The solver that a method asks for.
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
                factor.factor(system, Operator::Elastic)?;
                Ok(Self::Elastic(factor))
            }
        }
    }

    /// Whether corrections are by the tangent at the present state.
    pub(super) fn follows_the_state(&self) -> bool {
        #[cfg(feature = "direct")]
        if let Self::Tangent(_) = self {
            return true;
        }
        false
    }

    /// The correction for forces out of balance at the state of the last forces, such that the
    /// linear solver leaves at most a share `left` of them.
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
