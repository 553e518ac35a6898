//! Static equilibrium of a model: increments of load, a preconditioned conjugate gradient on the
//! element blocks, and accelerated iteration for laws that are not linear.

mod agreement;
mod balance;
mod corrector;
#[cfg(feature = "direct")]
mod direct;
#[cfg(feature = "direct")]
mod freedoms;
mod gradients;
mod joints;
mod mixing;
mod recovery;
mod relaxation;
mod saved;
mod sliding;
mod support_check;
mod system;

use powerhouse_model::{
    StaticError, StaticMethod, StaticOptions, StaticProgress, StaticReport, Vec3,
};

use crate::Model;
use corrector::Corrector;
use joints::Smooth;
use mixing::Mixing;
use relaxation::{Relaxation, Start};
use saved::{Checkpoints, Position, SavedStatics};
use system::{External, System};

/// Number of earlier corrections in the Anderson acceleration.
const KEPT_CORRECTIONS: usize = 8;
/// Relative residual to which the linear solver is run with nonlinear laws.
const FORCING: f64 = 1.0e-2;
/// Residual of the linear solver over the tolerance of the static solution.
const MARGIN: f64 = 0.1;
/// Share of the forces that supports and neighbours bear below which a load is their rounding.
const ROUNDED: f64 = 256.0 * f64::EPSILON;

impl Model {
    /// Brings the model into static equilibrium under its loads at its present time.
    ///
    /// The unbalanced part of the load is applied in increments; in each one the displacement is
    /// corrected with the elastic operator until forces balance,
    ///
    /// `K_e du = f_ext - f_int(u)`
    ///
    /// solved by conjugate gradients or by the chosen [method](StaticMethod). For linear laws one
    /// correction suffices; for others the corrections are accelerated with up to eight earlier ones
    /// (Anderson 1965). The history variables are committed at the end of a converged increment; an increment that
    /// does not converge is repeated by halves.
    ///
    /// The initial stress enters with its internal nodal forces, which weights, pressures and supports
    /// balance, or the body deforms until they do. Dashpots have no force, springs of boundaries
    /// have, and prescribed motions have their value at the present
    /// time. Time-dependent laws are evaluated in their static form.
    ///
    /// Ties and closed pairs of joints are treated as one node, without friction they are connected along their normals alone (but in
    /// methods that factor a matrix); at the end the tractions of the joints are computed,
    /// which their laws must admit but for forces below the tolerance. Open pairs stay open. Otherwise use
    /// [`StaticMethod::DynamicRelaxation`], in which joints slide, open and close; pairs that
    /// slid stick at the equilibrium position. The nodes of a side without elements follow the other side.
    ///
    /// At the end velocities are zero, and the forces that balance the body in addition to its loads
    /// (reactions of the initial stress and the residual below the tolerance) are stored as carried forces: a dynamic run
    /// with the same supports starts in equilibrium to the last digit.
    ///
    /// # Errors
    /// See [`StaticError`]; the model is then in the state of the last converged increment.
    pub fn equilibrate(
        &mut self,
        options: &StaticOptions,
        progress: &mut (dyn FnMut(StaticProgress) + Send),
    ) -> Result<StaticReport, StaticError> {
        options.check()?;
        self.in_pool(|model| model.equilibrate_here(options, progress))
    }

    /// Refuses what one rank alone supports.
    fn check_options(&self, options: &StaticOptions) -> Result<(), StaticError> {
        let ranks = self.ranks.team.count();
        let is_direct = matches!(options.method, StaticMethod::Cholesky(_));
        let refused = [
            ("the static method `direct`", is_direct),
            (
                "a checkpoint within a stage",
                self.static_checkpoints.is_some(),
            ),
            ("a saved state of a stage", self.static_resume.is_some()),
        ];
        match refused.into_iter().find(|(_, used)| *used) {
            Some((what, _)) if ranks > 1 => Err(StaticError::OneRankOnly { what, ranks }),
            _ => Ok(()),
        }
    }

    fn equilibrate_here(
        &mut self,
        options: &StaticOptions,
        progress: &mut (dyn FnMut(StaticProgress) + Send),
    ) -> Result<StaticReport, StaticError> {
        let relaxes = options.method == StaticMethod::DynamicRelaxation;
        self.check_options(options)?;
        self.check_static()?;
        self.complete_kick();
        self.commit();
        let (sink, resumed) = (self.static_checkpoints.clone(), self.static_resume.take());
        let mut report = StaticReport::default();
        let smooth = match options.method {
            StaticMethod::ConjugateGradients | StaticMethod::DynamicRelaxation => Smooth::Sliding,
            // Factored without conditions between nodes.
            _ => Smooth::Tied,
        };
        let mut system = System::new(self, smooth)?;
        let mut solver = match options.method {
            StaticMethod::DynamicRelaxation => {
                system.separate_joints()?;
                Solver::Relaxation(Relaxation::new(&system, options.steps)?)
            }
            _ => Solver::Corrector(Corrector::new(options.method, &system, &mut report)?),
        };
        let mut u = system.displacement();
        let External {
            forces: target,
            size,
            borne,
        } = system.external();
        system.forces(&u)?;
        let borne = borne.max(system.internal());
        // Balanced forces stay balanced: the unbalanced part is the load to be applied.
        let mut first = system.residual(&target, &u);
        if let Solver::Relaxation(relaxation) = &solver {
            first = relaxation.without_joint_forces(&mut system, &first, &u)?;
        }
        let prescribed = system.prescribed_change(&u);
        let still = prescribed
            .iter()
            .all(|(_, change)| *change == Vec3::zeros());
        let moves = !system.model().on_all_ranks(still);
        let rounded = |force: f64| force <= ROUNDED * borne;
        report.load = size.max(system.norm(&first));
        if rounded(report.load) || moves && rounded(size) {
            // Forces that cancel, as of a uniform stress in a body that is held all around, or what an earlier solution has
            // left beside prescribed motions alone.
            report.load = 0.0;
        }
        if report.load > 0.0 {
            report.unbalanced = system.norm(&first) / report.load;
        }
        let end = options.release;
        let (mut done, mut share) = (0.0, end / f64::from(options.increments));
        if report.load == 0.0 && !moves {
            done = end;
        }
        let mut relaxation = None;
        if let Some(saved) = resumed {
            let saved = SavedStatics::restore(&saved, system.model())?;
            let at = saved.position;
            (done, share, u, report) = (at.done, at.share, at.u, at.report);
            relaxation = saved.relaxation;
        }
        while done < end {
            // The last increment ends exactly at the load factor of the end.
            let next = if done + 1.5 * share > end {
                end
            } else {
                done + share
            };
            let checkpoints = Checkpoints {
                sink: sink.as_ref(),
                position: Position {
                    done,
                    share,
                    u: u.clone(),
                    report,
                },
                most_steps: options.steps,
            };
            let resumed = relaxation.take();
            if resumed.is_none() {
                checkpoints.take(system.model(), &report, || None)?;
                // A relaxation that goes on is counted already.
                report.increments += 1;
            }
            let mut trial = u.clone();
            for &(node, change) in &prescribed {
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
                    let start = match resumed {
                        Some(saved) => Start::Saved(saved),
                        None => Start::Displacement(trial),
                    };
                    let context = (&increment, &checkpoints);
                    relaxation.find(&mut system, context, start, &mut report, progress)
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
        // Forces that the solution leaves, as much again, and rounding.
        let negligible =
            2.0 * options.tolerance * report.load + ROUNDED * borne.max(system.internal());
        // A dynamic relaxation has evaluated the joints already.
        if !relaxes {
            self.load_joints(negligible)?;
        }
        self.keep_tractions();
        self.store_carried_forces()?;
        Ok(report)
    }
}

/// Solver of an increment.
enum Solver {
    Corrector(Corrector),
    Relaxation(Relaxation),
}

/// One load increment.
struct Increment<'a> {
    options: &'a StaticOptions,
    /// Nodal forces (N) at its end.
    applied: &'a [Vec3],
    share: f64,
}

impl Increment<'_> {
    /// The displacement (m) in static equilibrium, by corrections of a first guess.
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
            let size = system.norm(&residual);
            if report.load == 0.0 {
                // Prescribed motions alone: the unbalanced forces that they cause first.
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
            let required = MARGIN * self.options.tolerance * report.load / size;
            let left = if system.is_linear() {
                required
            } else {
                required.max(FORCING)
            };
            let mut step = corrector.correct(system, &residual, left, report)?;
            system.spread(&mut step);
            if corrector.is_tangent() && size < last {
                // Newton's method converges faster without acceleration: 10 corrections instead of 32.
                mixing = Mixing::new(KEPT_CORRECTIONS);
            }
            last = size;
            mixing.advance(system.sums(), &mut u, step);
        }
    }
}
