//! Static equilibrium of a model: increments of load, a preconditioned conjugate gradient on the
//! element blocks, and accelerated iteration for laws that are not linear.

mod error;
mod gradients;
mod joints;
mod mixing;
mod parts;
mod rest;
mod support_check;
mod system;

pub use error::StaticError;
pub use rest::HandOverReport;

use powerhouse_model::{ParameterError, Vec3};

use crate::Model;
use mixing::Mixing;
use parts::Parts;
use system::System;

use crate::spectrum::norm;

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
    /// The gate: the norm of the forces out of balance over that of the load; 1e-8 by default.
    pub tolerance: f64,
    /// Increments that the load comes in, more where one does not converge; 1 by default.
    pub increments: u32,
    /// Corrections in one increment before it is cut in half; 100 by default.
    pub corrections: u32,
    /// The smallest share of the load that an increment may be cut to; 1e-3 by default.
    pub least_increment: f64,
    /// The share of what is out of balance at the start that comes; 1 by default. Less leaves the
    /// rest standing, as a face ahead that still bears, until the next solution.
    pub release: f64,
}

impl Default for StaticOptions {
    fn default() -> Self {
        Self {
            tolerance: 1.0e-8,
            increments: 1,
            corrections: 100,
            least_increment: 1.0e-3,
            release: 1.0,
        }
    }
}

impl StaticOptions {
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
        ParameterError::check("least_increment", self.least_increment, 1.0e-9, 1.0)?;
        ParameterError::check("release", self.release, 1.0e-6, 1.0)
    }
}

/// What a static solution took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StaticReport {
    /// Increments, cut ones counted as often as they were tried.
    pub increments: u32,
    /// Corrections in all increments.
    pub corrections: u32,
    /// Products of the elastic operator.
    pub products: u64,
    /// Forces out of balance in the end over the load, below the gate.
    pub residual: f64,
    /// Norm of the load (N): the largest of applied forces, those that the initial stress asks for,
    /// and those that were out of balance.
    pub load: f64,
}

/// Progress of a static solution, shown after each correction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StaticProgress {
    /// The share of the load that acts.
    pub share: f64,
    /// Corrections in this increment.
    pub correction: u32,
    /// Forces out of balance over the load.
    pub residual: f64,
}

/// Corrections that are remembered.
const REMEMBERED: usize = 8;
/// How much of an increment's first residual the linear solver leaves in laws that are not linear.
const FORCING: f64 = 1.0e-3;
/// Of what the gate asks, how much the linear solver leaves.
const MARGIN: f64 = 0.1;

impl Model {
    /// Brings the model to rest under its loads at its present time.
    ///
    /// The load that is not yet balanced comes in increments; in each one the displacement is
    /// corrected by the elastic operator until forces balance,
    ///
    /// `K_e du = f_ext - f_int(u)`
    ///
    /// by conjugate gradients with the inverse of the nodal 3 x 3 diagonal. For linear laws one
    /// correction suffices; for others the corrections are combined with up to eight earlier ones
    /// so that the next is smallest (Anderson 1965). The history of an increment is
    /// committed once it balances; an increment that does not is tried anew by halves.
    ///
    /// The initial stress counts with the forces that it asks of the nodes, so that it stands in
    /// balance with weights, pressures and supports, or moves the body until it does. Dashpots do
    /// not act, springs of boundaries do, and prescribed motions have their value at the present
    /// time. Laws that depend on time are static.
    ///
    /// Ties and pairs of joints that stick are one node for the solution; in the end the joints take
    /// their tractions, which their laws must admit. Pairs that are open stay so.
    ///
    /// In the end velocities are zero, and what the body lacks to be at rest beside its loads,
    /// the residual under the gate too, acts on as standing forces: stepped on with the same
    /// supports it stays as still as if it were in balance to the last digit.
    ///
    /// # Errors
    /// See [`StaticError`]; the model is then in the state of the last increment that balanced.
    pub fn equilibrate(
        &mut self,
        options: &StaticOptions,
        progress: &mut (dyn FnMut(StaticProgress) + Send),
    ) -> Result<StaticReport, StaticError> {
        options.check()?;
        self.in_pool(|model| model.equilibrate_here(options, progress))
    }

    fn equilibrate_here(
        &mut self,
        options: &StaticOptions,
        progress: &mut (dyn FnMut(StaticProgress) + Send),
    ) -> Result<StaticReport, StaticError> {
        self.check_static()?;
        self.settle();
        self.commit();
        let mut system = System::new(self)?;
        let mut u = system.displacement();
        let (target, size) = system.external();
        system.forces(&u)?;
        // What is balanced at the start stays balanced: the rest is the load that comes.
        let first = system.residual(&target, &u);
        let driven = system.prescribed_change(&u);
        let mut report = StaticReport {
            load: size.max(norm(&first)),
            ..StaticReport::default()
        };
        let moves = driven.iter().any(|(_, change)| *change != Vec3::zeros());
        let end = options.release;
        let (mut done, mut share) = (0.0, end / f64::from(options.increments));
        if report.load == 0.0 && !moves {
            done = end;
        }
        while done < end {
            // The last increment ends exactly at what is to come.
            let next = if done + 1.5 * share > end {
                end
            } else {
                done + share
            };
            report.increments += 1;
            let mut trial = u.clone();
            for &(node, change) in &driven {
                trial[node] += change * (next - done);
            }
            let rest: Vec<Vec3> = (target.iter().zip(&first))
                .map(|(f, r)| f - r * (1.0 - next))
                .collect();
            let balance = Balance {
                options,
                load: report.load,
                share: next,
            };
            match balance.find(&mut system, &rest, trial, &mut report, progress) {
                Ok(found) => {
                    u = found;
                    system.commit();
                    done = next;
                }
                Err(StaticError::NotConverged { .. })
                    if 0.5 * (next - done) >= options.least_increment =>
                {
                    share = 0.5 * (next - done);
                }
                Err(stuck) => {
                    system.finish(&u);
                    return Err(stuck);
                }
            }
        }
        system.finish(&u);
        self.load_joints()?;
        self.hold()?;
        Ok(report)
    }
}

/// One increment.
struct Balance<'a> {
    options: &'a StaticOptions,
    load: f64,
    share: f64,
}

impl Balance<'_> {
    /// The displacement at which the forces `applied` balance, from a first guess.
    fn find(
        &self,
        system: &mut System,
        applied: &[Vec3],
        mut u: Vec<Vec3>,
        report: &mut StaticReport,
        progress: &mut (dyn FnMut(StaticProgress) + Send),
    ) -> Result<Vec<Vec3>, StaticError> {
        let mut load = self.load;
        let mut mixing = Mixing::new(REMEMBERED);
        let mut correction = 0;
        loop {
            system.forces(&u)?;
            let residual = system.residual(applied, &u);
            let size = norm(&residual);
            if load == 0.0 {
                // Prescribed motions alone: what they let go at first.
                load = size;
                report.load = size;
            }
            let relative = if size == 0.0 { 0.0 } else { size / load };
            progress(StaticProgress {
                share: self.share,
                correction,
                residual: relative,
            });
            if relative <= self.options.tolerance {
                report.residual = relative;
                return Ok(u);
            }
            if !relative.is_finite() || correction == self.options.corrections {
                return Err(system.not_converged(&residual, relative, self.share));
            }
            correction += 1;
            report.corrections += 1;
            let gate = MARGIN * self.options.tolerance * load / size;
            let left = if system.is_linear() {
                gate
            } else {
                gate.max(FORCING)
            };
            let (mut step, products) = gradients::solve(system, &residual, left)?;
            system.spread(&mut step);
            report.products += products;
            mixing.advance(&mut u, step);
        }
    }
}
