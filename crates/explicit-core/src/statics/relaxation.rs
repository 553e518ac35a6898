//! Dynamic relaxation: static equilibrium as the limit of a damped motion.

use powerhouse_model::{Mat3, Operator, StaticError, StaticProgress, StaticReport, Vec3};
use rayon::prelude::*;

use super::saved::{Checkpoints, SavedRelaxation};
use super::system::System;
use super::{FORCING, Increment, gradients};
use crate::model::least_mass;

/// Length of a step in pseudo-time (s); results do not depend on it.
const STEP: f64 = 1.0e-4;
/// Largest share of a velocity that damping removes in a step.
const MOST_DAMPING: f64 = 0.4;
/// Factor on the masses for which the step is stable without damping: lagged damping reduces the square of the stable
/// step by the factor `1 - 0.4 / 2` at most.
const MASS_FACTOR: f64 = 1.0 / (1.0 - 0.5 * MOST_DAMPING);
/// Number of steps between two calls of the progress callback.
const PROGRESS_INTERVAL: u32 = 100;

/// Relative change of the tractions by the stress beside a joint at which they count as those of the equilibrium.
const SETTLED: f64 = 1.0e-4;

/// Start of an increment: an unbalanced displacement (m), or the state of a relaxation that was interrupted.
pub(super) enum Start {
    Displacement(Vec<Vec3>),
    Saved(SavedRelaxation),
}

/// Dynamic relaxation with fictitious nodal masses for which the step is stable.
pub(super) struct Relaxation {
    /// Effective masses of lead nodes (kg).
    effective: Vec<Mat3>,
    /// Inverses of the effective masses in the free directions (1/kg).
    inverse: Vec<Mat3>,
    most_steps: u32,
}

impl Relaxation {
    /// Masses from row sums of the elastic operator: no eigenvalue of `M^-1 K` exceeds the largest
    /// `sum_j |K_ij| / m_i` (Gershgorin 1931).
    ///
    /// # Errors
    /// A failure of the communication between ranks.
    pub(super) fn new(system: &System, most_steps: u32) -> Result<Self, StaticError> {
        let blocks = system.blocks();
        let of_block = |index: usize| {
            let mut rows: Vec<(u32, Vec3)> = Vec::new();
            blocks.each_matrix(index, Operator::Static, |nodes, matrix| {
                let size = 3 * nodes.len();
                for (a, &node) in nodes.iter().enumerate() {
                    let row = |i: usize| &matrix[(3 * a + i) * size..(3 * a + i + 1) * size];
                    let sum = |i: usize, _| row(i).iter().map(|k| k.abs()).sum::<f64>();
                    rows.push((node, Vec3::from_fn(sum)));
                }
            });
            rows
        };
        let rows: Vec<_> = (0..blocks.count()).into_par_iter().map(of_block).collect();
        let rows = system.rows_of_all(rows)?;
        let mut stiffness = vec![Vec3::zeros(); system.node_count()];
        for (node, row) in rows.into_iter().flatten() {
            stiffness[node as usize] += row;
        }
        let masses: Vec<f64> = (stiffness.iter())
            .map(|rows| MASS_FACTOR * 0.25 * STEP * STEP * rows.max())
            .collect();
        let least = system.least_of_all(least_mass(&masses));
        let mut effective: Vec<Mat3> = (masses.iter())
            .map(|mass| Mat3::identity() * *mass)
            .collect();
        let mut inverse: Vec<Mat3> = (effective.iter())
            .map(|mass| mass.try_inverse().unwrap_or_else(Mat3::zeros))
            .collect();
        for group in system.groups() {
            let sum: f64 = group
                .members
                .iter()
                .map(|&node| masses[node as usize])
                .sum();
            let whole = Mat3::identity() * sum + group.spring * (0.25 * STEP * STEP);
            for &member in &group.members {
                inverse[member as usize] = Mat3::zeros();
            }
            let lead = group.members[0] as usize;
            if let Some(orphan) = group.orphan_inverse(least) {
                inverse[lead] = orphan;
                continue;
            }
            let free = whole.try_inverse().unwrap_or_else(Mat3::zeros);
            effective[lead] = whole;
            inverse[lead] = group.condition.project(&free).0;
        }
        Ok(Self {
            effective,
            inverse,
            most_steps,
        })
    }

    /// Unbalanced forces (N) without the part that joints balance at a displacement; the state of the joints is left
    /// unchanged.
    pub(super) fn without_joint_forces(
        &self,
        system: &mut System,
        out: &[Vec3],
        u: &[Vec3],
    ) -> Result<Vec<Vec3>, StaticError> {
        system.model().set_reference_tractions()?;
        let before = system.model().joint_histories();
        let still = vec![Vec3::zeros(); u.len()];
        let predicted = self.inverse.par_iter().zip(out);
        let mut next: Vec<Vec3> = predicted.map(|(p, force)| p * (force * STEP)).collect();
        let model = system.model();
        model.prepare_joints(STEP, &self.inverse);
        model.correct_joints(STEP, (u, &still), &mut next, &self.inverse)?;
        model.restore_joints(&before);
        let net = next.par_iter().zip(&self.effective);
        Ok(net.map(|(next, mass)| mass * (next / STEP)).collect())
    }

    /// The displacement (m) in static equilibrium with the joints.
    ///
    /// After a failure the joints have their former state.
    pub(super) fn find(
        &self,
        system: &mut System,
        (increment, checkpoints): (&Increment, &Checkpoints),
        start: Start,
        report: &mut StaticReport,
        progress: &mut (dyn FnMut(StaticProgress) + Send),
    ) -> Result<Vec<Vec3>, StaticError> {
        let motion = match start {
            Start::Saved(saved) => saved,
            Start::Displacement(mut u) => {
                let before = system.model().joint_histories();
                self.predict_sticking(system, increment, &mut u, report)?;
                system.forces(&u)?;
                system.model().set_reference_tractions()?;
                SavedRelaxation {
                    before,
                    velocity: vec![Vec3::zeros(); u.len()],
                    u,
                    last: None,
                    damping: 0.0,
                    step: 0,
                    is_still: true,
                }
            }
        };
        let before = motion.before.clone();
        let context = (increment, checkpoints);
        system.model().begin_relaxation(&before);
        let mut found = self.relax(system, context, motion, report, progress);
        system.model().end_relaxation();
        match &mut found {
            Ok(u) => {
                let start = &checkpoints.position.u;
                system.model().stick_joints(&before, (start, u));
            }
            Err(_) => system.model().restore_joints(&before),
        }
        found
    }

    /// Predicts the displacement with elastic laws and all closed pairs tied.
    fn predict_sticking(
        &self,
        system: &mut System,
        increment: &Increment,
        u: &mut [Vec3],
        report: &mut StaticReport,
    ) -> Result<(), StaticError> {
        system.merge_joints()?;
        system.forces(u)?;
        let residual = system.residual(increment.applied, u);
        if report.load == 0.0 {
            // Prescribed motions alone: the unbalanced forces that they cause first.
            report.load = system.norm(&residual);
        }
        // A sliding body may have no such equilibrium; it starts from the present displacement.
        if system.norm(&residual) > 0.0
            && let Ok((mut step, products)) = gradients::solve(system, &residual, FORCING)
        {
            report.products += products;
            system.spread(&mut step);
            for (u, step) in u.iter_mut().zip(&step) {
                *u += step;
            }
        }
        system.separate_joints()
    }

    /// Takes damped steps until forces balance in motion and at zero velocity.
    fn relax(
        &self,
        system: &mut System,
        (increment, checkpoints): (&Increment, &Checkpoints),
        mut motion: SavedRelaxation,
        report: &mut StaticReport,
        progress: &mut (dyn FnMut(StaticProgress) + Send),
    ) -> Result<Vec<Vec3>, StaticError> {
        system.model().prepare_joints(STEP, &self.inverse);
        loop {
            checkpoints.take(system.model(), report, || Some(motion.clone()))?;
            let SavedRelaxation {
                u,
                velocity,
                last,
                damping,
                step,
                is_still,
                ..
            } = &mut motion;
            system.forces(u)?;
            let out = system.residual(increment.applied, u);
            if let Some(last) = last {
                *damping = self
                    .damping(system, velocity, last, &out)
                    .unwrap_or(*damping);
            }
            let kept = 1.0 - *damping;
            let mut next: Vec<Vec3> = (velocity.par_iter().zip(&self.inverse).zip(&out))
                .map(|((v, inverse), force)| v * kept + inverse * (force * STEP))
                .collect();
            let model = system.model();
            model.take_back(if *is_still { 1.0 } else { *damping });
            model.correct_joints(STEP, (u, velocity), &mut next, &self.inverse)?;
            let net: Vec<Vec3> = (next.par_iter().zip(&*velocity).zip(&self.effective))
                .map(|((next, v), mass)| mass * ((next - v * kept) / STEP))
                .collect();
            let size = system.norm(&net);
            let relative = if size == 0.0 { 0.0 } else { size / report.load };
            let balances = relative <= increment.options.tolerance;
            if balances || step.is_multiple_of(PROGRESS_INTERVAL) {
                progress(StaticProgress {
                    share: increment.share,
                    correction: *step,
                    residual: relative,
                });
            }
            if balances && *is_still {
                // The stress beside the joint has changed since its tractions were taken from it.
                let change = system.model().set_reference_tractions()?;
                if change <= SETTLED {
                    report.residual = relative;
                    return Ok(motion.u);
                }
                system.model().prepare_joints(STEP, &self.inverse);
            }
            if !relative.is_finite() || *step == self.most_steps {
                return Err(system.not_converged(&net, relative, increment));
            }
            *step += 1;
            report.steps += 1;
            // Members of groups other than the lead have no velocity of their own.
            (u.par_iter_mut().zip(&next)).for_each(|(u, v)| *u += v * STEP);
            for group in system.groups() {
                let moved = next[group.members[0] as usize] * STEP;
                for &member in &group.members[1..] {
                    u[member as usize] += moved;
                }
            }
            // Forces that balance in motion must also balance at zero velocity.
            *is_still = balances;
            if balances {
                velocity.fill(Vec3::zeros());
                (*last, *damping) = (None, 0.0);
            } else {
                (*velocity, *last) = (next, Some(out));
            }
        }
    }

    /// Share of the velocity that critical damping of the present motion removes in a step: twice its frequency times
    /// the step; none if forces do not resist the motion.
    fn damping(
        &self,
        system: &System,
        velocity: &[Vec3],
        last: &[Vec3],
        out: &[Vec3],
    ) -> Option<f64> {
        let sums = system.sums();
        let resisted = sums.sum(|nodes| {
            nodes
                .map(|node| velocity[node].dot(&(last[node] - out[node])))
                .sum()
        });
        let moved = sums.sum(|nodes| {
            let of =
                |node: usize| velocity[node].dot(&(self.effective[node] * velocity[node] * STEP));
            nodes.map(of).sum()
        });
        let square = resisted / moved;
        (square > 0.0 && square.is_finite()).then(|| (2.0 * square.sqrt() * STEP).min(MOST_DAMPING))
    }
}
