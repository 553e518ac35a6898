//! Static equilibrium of a model: increments of load, a preconditioned conjugate gradient on the
//! element blocks, and accelerated iteration for laws that are not linear.

mod corrector;
#[cfg(feature = "direct")]
mod direct;
mod error;
#[cfg(feature = "direct")]
mod freedoms;
mod gradients;
mod joints;
mod mixing;
mod options;
mod parts;
mod relaxation;
mod rest;
mod support_check;
mod system;

pub use error::StaticError;
#[cfg(feature = "direct")]
pub use options::Linearisation;
pub use options::{StaticMethod, StaticOptions};
pub use rest::HandOverReport;

use powerhouse_model::Vec3;

use crate::Model;
use corrector::Corrector;
use joints::Held;
use mixing::Mixing;
use parts::Parts;
use relaxation::Relaxation;
use system::System;

use crate::spectrum::norm;

/// What a static solution took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StaticReport {
    /// Increments, cut ones counted as often as they were tried.
    pub increments: u32,
    /// Corrections in all increments.
    pub corrections: u32,
    /// Products of the elastic operator.
    pub products: u64,
    /// Factorisations of the operator; zero without a direct solver.
    pub factorisations: u32,
    /// Entries of the factor, eight bytes each.
    pub factor_entries: u64,
    /// Steps of a dynamic relaxation.
    pub steps: u64,
    /// Forces out of balance in the end over the load, below the gate.
    pub residual: f64,
    /// Norm of the load (N): the largest of applied forces, those that the initial stress asks for,
    /// and those that were out of balance.
    pub load: f64,
    /// What was out of balance at the start, over the load.
    pub unbalanced: f64,
}

/// Progress of a static solution, shown after each correction or a hundred steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StaticProgress {
    /// The share of the load that acts.
    pub share: f64,
    /// Corrections in this increment, or steps of a dynamic relaxation.
    pub correction: u32,
    /// Forces out of balance over the load.
    pub residual: f64,
}

/// Corrections that are kept.
const KEPT_CORRECTIONS: usize = 8;
/// How much of an increment's first residual the linear solver leaves in laws that are not linear.
const FORCING: f64 = 1.0e-2;
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
    /// by conjugate gradients or as else the [method](StaticMethod) says. For linear laws one
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
    /// their tractions, which their laws must admit. Pairs that are open stay so. Where that is not
    /// how it ends, [`StaticMethod::DynamicRelaxation`] lets joints slide, open and close; pairs that
    /// slid stick where they came to rest.
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
        let relaxes = options.method == StaticMethod::DynamicRelaxation;
        self.check_static(if relaxes {
            Held::Closed
        } else {
            Held::Sticking
        })?;
        self.settle();
        self.commit();
        let mut report = StaticReport::default();
        let mut system = System::new(self)?;
        let mut solver = match options.method {
            StaticMethod::DynamicRelaxation => {
                system.part()?;
                Solver::Relaxation(Relaxation::new(&system, options.steps))
            }
            _ => Solver::Corrector(Corrector::new(options.method, &system, &mut report)?),
        };
        let mut u = system.displacement();
        let (target, size) = system.external();
        system.forces(&u)?;
        // What is balanced at the start stays balanced: the rest is the load that comes.
        let mut first = system.residual(&target, &u);
        if let Solver::Relaxation(relaxation) = &solver {
            first = relaxation.beside_joints(&mut system, &first, &u)?;
        }
        let driven = system.prescribed_change(&u);
        report.load = size.max(norm(&first));
        if report.load > 0.0 {
            report.unbalanced = norm(&first) / report.load;
        }
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
            let increment = Increment {
                options,
                applied: &rest,
                share: next,
            };
            let found = match &mut solver {
                Solver::Corrector(corrector) => {
                    increment.find((&mut system, corrector), trial, &mut report, progress)
                }
                Solver::Relaxation(relaxation) => {
                    relaxation.find(&mut system, &increment, trial, &mut report, progress)
                }
            };
            match found {
                Ok(found) => {
                    u = found;
                    system.commit();
                    done = next;
                }
                Err(StaticError::NotConverged { .. } | StaticError::NotDefinite { .. })
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
        // A relaxation has asked the joints already.
        if !relaxes {
            self.load_joints()?;
        }
        self.hold()?;
        Ok(report)
    }
}

/// What finds the state of an increment.
enum Solver {
    Corrector(Corrector),
    Relaxation(Relaxation),
}

/// One increment.
struct Increment<'a> {
    options: &'a StaticOptions,
    /// Forces (N) that act in it.
    applied: &'a [Vec3],
    share: f64,
}

impl Increment<'_> {
    /// The displacement at which forces balance, by corrections of a first guess.
    fn find(
        &self,
        (system, corrector): (&mut System, &mut Corrector),
        mut u: Vec<Vec3>,
        report: &mut StaticReport,
        progress: &mut (dyn FnMut(StaticProgress) + Send),
    ) -> Result<Vec<Vec3>, StaticError> {
        let mut mixing = Mixing::new(KEPT_CORRECTIONS);
        let (mut correction, mut last) = (0, f64::INFINITY);
        loop {
            system.forces(&u)?;
            let residual = system.residual(self.applied, &u);
            let size = norm(&residual);
            if report.load == 0.0 {
                // Prescribed motions alone: what they let go at first.
                report.load = size;
            }
            let relative = if size == 0.0 { 0.0 } else { size / report.load };
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
                return Err(system.not_converged(&residual, relative, self));
            }
            correction += 1;
            report.corrections += 1;
            let gate = MARGIN * self.options.tolerance * report.load / size;
            let left = if system.is_linear() {
                gate
            } else {
                gate.max(FORCING)
            };
            let mut step = corrector.correct(system, &residual, left, report)?;
            system.spread(&mut step);
            if corrector.follows_the_state() && size < last {
                // Newton's own pace, which earlier corrections would only slow down: 10 corrections
                // where they make 32 of it.
                mixing = Mixing::new(KEPT_CORRECTIONS);
            }
            last = size;
            mixing.advance(&mut u, step);
        }
    }
}
