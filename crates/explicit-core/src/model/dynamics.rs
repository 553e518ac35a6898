//! Operations of a time step: forces, kick (velocity update), constraints, drift (displacement update).

use std::time::Instant;

use powerhouse_model::{
    BlockContext, ConstraintWork, DividedWork, Dynamics, ElementBlock, ElementFault, ForceTerms,
    MassDampingRule, Operator, PredictedMotion, Quad, RunError, StepTime, Vec3,
};
use rayon::prelude::*;

use super::Model;
use crate::applied::split;
use crate::nodes::{NodalArrays, Nodes, Storage, with_nodes};
use crate::profile::{BlockTimes, PROBE_INTERVAL, Phase, Profiler};
use crate::ranks::{Communicator, Exchange, Ranked};
use crate::subdomain::{NodalMotion, Subdomain};

/// Terms of a force evaluation of all blocks.
#[derive(Clone, Copy)]
pub(crate) struct BlockTerms {
    pub(crate) when: StepTime,
    pub(crate) terms: ForceTerms,
    /// Whether blocks keep account of their energies.
    pub(crate) ledger: bool,
    /// Whether the body rests, whatever the length of the step.
    pub(crate) rests: bool,
    /// Whether the history variables of the last step are committed first, while the block is in the cache.
    pub(crate) commit: bool,
    /// Whether blocks compute without their stiffness damping, to measure its time.
    pub(crate) undamped: bool,
}

impl BlockTerms {
    /// Terms of static forces with a length of step (s), which viscoelastic laws depend on.
    pub(crate) fn of_statics(when: StepTime) -> Self {
        Self {
            when,
            terms: ForceTerms::PLAIN,
            ledger: false,
            rests: true,
            commit: false,
            undamped: false,
        }
    }
}

/// A block with its number on this rank and its force buffer.
type BlockTask<'a, S> = (usize, &'a mut Box<dyn ElementBlock>, &'a mut [Quad<S>]);

/// Computes the forces of all blocks, each into its buffer; returns the set and fault of the first block that fails.
pub(crate) fn block_forces<S: Storage>(
    subdomain: &Subdomain,
    blocks: &mut [Box<dyn ElementBlock>],
    motion: NodalMotion<S>,
    forces: &mut [Quad<S>],
    evaluation: BlockTerms,
    times: Option<&BlockTimes>,
) -> Option<(String, ElementFault)> {
    blocks
        .par_iter_mut()
        .zip(split(forces, &subdomain.lengths))
        .enumerate()
        .with_max_len(1)
        .find_map_first(|(index, (block, buffer))| {
            let start = times.map(|_| Instant::now());
            let fault = forces_of(subdomain, motion, evaluation, (index, block, buffer));
            if let (Some(times), Some(start)) = (times, start) {
                times.add(index, start);
            }
            Some((block.label().to_string(), fault?))
        })
}

/// The same for one of several ranks, which sends the forces at shared nodes as soon as the blocks that have them are
/// done, and computes the others meanwhile. After a fault of a block with shared nodes nothing is sent.
fn block_forces_sent<S: Storage>(
    subdomain: &Subdomain,
    blocks: &mut [Box<dyn ElementBlock>],
    motion: NodalMotion<S>,
    forces: &mut [Quad<S>],
    evaluation: BlockTerms,
    (exchange, team): (&mut Exchange, &Communicator),
) -> Option<(String, ElementFault)> {
    let buffers = split(forces, &subdomain.lengths);
    let tasks = blocks.iter_mut().zip(buffers).enumerate();
    let (mut border, mut inner): (Vec<BlockTask<S>>, Vec<BlockTask<S>>) = tasks
        .map(|(index, (block, buffer))| (index, block, buffer))
        .partition(|(index, ..)| exchange.is_at_border(*index));
    let first_fault = |tasks: &mut [BlockTask<S>]| {
        let tasks = tasks.par_iter_mut().with_max_len(1);
        tasks.find_map_first(|(index, block, buffer)| {
            let fault = forces_of(subdomain, motion, evaluation, (*index, block, buffer))?;
            Some((*index, block.label().to_string(), fault))
        })
    };
    let (at_border, inside) = rayon::join(
        || {
            let fault = first_fault(&mut border);
            if fault.is_none() {
                let parts = border.iter();
                let parts =
                    parts.map(|(index, _, buffer)| (subdomain.slots_of(*index).start, &**buffer));
                exchange.send(team, &parts.collect::<Vec<_>>());
            }
            fault
        },
        || first_fault(&mut inner),
    );
    let faults = at_border.into_iter().chain(inside);
    let first = faults.min_by_key(|(index, ..)| *index);
    first.map(|(_, set, fault)| (set, fault))
}

/// Computes the forces of a block into its buffer; returns its fault.
fn forces_of<S: Storage>(
    subdomain: &Subdomain,
    motion: NodalMotion<S>,
    evaluation: BlockTerms,
    (index, block, buffer): BlockTask<S>,
) -> Option<ElementFault> {
    let BlockTerms {
        when,
        terms,
        ledger,
        rests,
        commit,
        undamped,
    } = evaluation;
    if commit {
        block.commit();
    }
    let shift = if undamped {
        -block.damping().stiffness
    } else {
        terms.damping_shift
    };
    let reads_velocity = block.reads_velocity(shift, ledger);
    let computed =
        subdomain.with_copies(index, motion, reads_velocity, |displacement, velocity| {
            let context = BlockContext::new(when, Storage::view(displacement), S::view(velocity))
                .with_damping_shift(shift)
                .with_ledger(ledger)
                .with_rest(rests)
                .with_shown(terms.shown)
                .with_repeats(terms.repeats);
            block.forces(&context, S::view_mut(buffer))
        });
    computed.err()
}

/// Measures the parts of element forces by extra evaluations; the evaluation of the step follows.
fn probe<S: Storage>(
    profiler: &mut Profiler,
    subdomain: &Subdomain,
    blocks: &mut [Box<dyn ElementBlock>],
    motion: NodalMotion<S>,
    forces: &mut [Quad<S>],
    evaluation: &mut BlockTerms,
) {
    let start = Instant::now();
    if core::mem::take(&mut evaluation.commit) {
        blocks.par_iter_mut().for_each(|block| block.commit());
    }
    evaluation.terms.repeats = true;
    let plain = BlockTerms {
        ledger: false,
        ..*evaluation
    };
    let undamped = BlockTerms {
        undamped: true,
        ..plain
    };
    let probes = &profiler.probes;
    for (terms, times) in [
        (plain, &probes.without_account),
        (undamped, &probes.without_damping),
    ] {
        // A fault is found again by the evaluation of the step.
        let _ = block_forces(subdomain, blocks, motion, forces, terms, Some(times));
    }
    blocks
        .par_iter()
        .zip(split(forces, &subdomain.lengths))
        .enumerate()
        .with_max_len(1)
        .for_each(|(index, (block, buffer))| {
            let start = Instant::now();
            subdomain.with_copies(index, motion, true, |_, velocity| {
                block.apply(Operator::Elastic, S::view(velocity), S::view_mut(buffer));
            });
            probes.elastic.add(index, start);
        });
    profiler.apart += start.elapsed();
}

impl Dynamics for Model {
    fn time(&self) -> f64 {
        self.time
    }

    fn forces(&mut self, terms: ForceTerms, step: f64) -> Result<(), RunError> {
        self.in_pool(|model| {
            model.complete_kick();
            if model.delayed.is_some() {
                return model.slice_forces(terms, step);
            }
            if model.bay.is_some() {
                return model.bay_forces(terms, step);
            }
            match model.fault.take() {
                Some(fault) => Err(fault),
                None => model.evaluate(terms, model.present_step(step)),
            }
        })
    }

    fn kick(&mut self, rule: MassDampingRule, step: f64) -> Result<(), RunError> {
        self.in_pool(|model| {
            let start = model.clock();
            model.complete_kick();
            if model.delayed.is_some() {
                model.kick_slice(rule, step);
                model.spent(Phase::Groups, start);
                return;
            }
            model.prepare(rule, step);
            model.predict(step);
            model.turn_bay(rule, step);
            model.kicked = true;
            model.spent(Phase::Groups, start);
        });
        Ok(())
    }

    fn constrain(&mut self, step: f64) -> Result<(), RunError> {
        self.in_pool(|model| model.correct(step))
    }

    fn drift(&mut self, step: f64) {
        self.in_pool(|model| {
            if model.delayed.is_some() {
                model.drift_slice(step);
                return;
            }
            if model.kicked {
                let start = model.clock();
                model.record_first_half(step);
                model.spent(Phase::EnergyBalance, start);
                let start = model.clock();
                model.kicked = false;
                model.advance::<true>(step);
                model.spent(Phase::Nodes, start);
                if matches!(model.nodes, Nodes::F64(_)) {
                    model.groups.motion.has_moved(step);
                }
                let start = model.clock();
                model.record_second_half(step);
                model.spent(Phase::EnergyBalance, start);
            } else {
                model.groups.motion.invalidate();
                with_nodes!(&mut model.nodes, arrays => arrays.drift(step));
            }
            model.uncommitted = true;
            model.time += step;
            model.number += 1;
        });
    }
}

/// Least positive nodal mass (kg); one kilogram if no node has mass.
pub(crate) fn least_mass(masses: &[f64]) -> f64 {
    let some = masses.iter().copied().filter(|mass| *mass > 0.0);
    some.reduce(f64::min).unwrap_or(1.0)
}

impl Model {
    /// The time, while a profile is measured.
    pub(crate) fn clock(&self) -> Option<Instant> {
        self.profiler.as_ref().map(|_| Instant::now())
    }

    /// Adds the time since `start` to a phase of the profile.
    pub(crate) fn spent(&mut self, phase: Phase, start: Option<Instant>) {
        if let (Some(profiler), Some(start)) = (&mut self.profiler, start) {
            profiler.add(phase, start);
        }
    }

    /// Carries out a pending kick of the plain nodes without drift.
    pub(crate) fn complete_kick(&mut self) {
        if self.kicked {
            self.kicked = false;
            self.advance::<false>(0.0);
        }
    }

    /// Whether velocities after the step are known that have not moved the nodes yet.
    pub(crate) fn is_kicked(&self) -> bool {
        self.kicked
    }

    /// Discards a pending kick of the plain nodes: the motion is that of the start of the step.
    pub(crate) fn discard_kick(&mut self) {
        self.kicked = false;
    }

    /// Commits the history variables of the last forces of all blocks.
    pub(crate) fn commit(&mut self) {
        if self.uncommitted {
            self.uncommitted = false;
            self.blocks.par_iter_mut().for_each(|block| block.commit());
        }
    }

    /// The step of a length (s) from the present time.
    pub(crate) fn present_step(&self, step: f64) -> StepTime {
        StepTime {
            number: self.number,
            time: self.time,
            step,
        }
    }

    /// Forces of the elements and loads at the present time, with history variables of the step that ends there.
    pub(crate) fn evaluate(&mut self, terms: ForceTerms, when: StepTime) -> Result<(), RunError> {
        let is_booked = self.ledger.is_some();
        self.evaluate_parts(terms, when, is_booked, true)
    }

    /// The same forces. Blocks account for the energies of the step if they are `booked`, which they may be once per step; loads stay as they are if
    /// they are not `loaded` again.
    pub(crate) fn evaluate_parts(
        &mut self,
        terms: ForceTerms,
        when: StepTime,
        booked: bool,
        loaded: bool,
    ) -> Result<(), RunError> {
        let commit = core::mem::take(&mut self.uncommitted);
        let Self {
            nodes,
            blocks,
            loads,
            subdomain,
            profiler,
            ranks,
            ..
        } = self;
        let fault = with_nodes!(nodes, arrays => {
            let NodalArrays { displacement, velocity, forces, external, .. } = arrays;
            let motion = NodalMotion { displacement, velocity };
            let mut evaluation = BlockTerms {
                when,
                terms,
                ledger: booked,
                rests: when.step == 0.0,
                commit,
                undamped: false,
            };
            let probed = profiler.as_deref().is_some_and(|_| when.number.is_multiple_of(PROBE_INTERVAL));
            if let (Some(profiler), true) = (profiler.as_deref_mut(), probed) {
                probe(profiler, subdomain, blocks, motion, forces, &mut evaluation);
            }
            let start = profiler.as_deref().map(|_| Instant::now());
            let profile = profiler.as_deref();
            let times = profile.map(|profile| if probed { &profile.probes.whole } else { &profile.blocks });
            let (fault, ()) = rayon::join(
                || if ranks.is_single() { block_forces(subdomain, blocks, motion, forces, evaluation, times) } else {
                        let Ranked { exchange, team, .. } = ranks;
                        let to = (exchange, &*team);
                        block_forces_sent(subdomain, blocks, motion, forces, evaluation, to)
                    },
                || if loaded { loads.evaluate(when.time, profile.map(|profile| &profile.loads)) },
            );
            if loaded {
                loads.sums.write_plain(external);
            }
            if let (Some(profiler), Some(start)) = (profiler.as_deref_mut(), start) {
                profiler.forces += start.elapsed();
            }
            fault
        });
        let failed = fault.map(|(set, fault)| {
            let of_block = self.subdomain.block_of(fault.element);
            let block = of_block.map_or(u32::MAX, |(block, _)| block as u32);
            let error = RunError::Element {
                element: self.element_tag(fault.element),
                set,
                step: self.number,
                reason: fault.reason,
            };
            self.ranks.failed_in_block(block);
            error
        });
        match failed {
            Some(error) => Err(error),
            None => self.receive_forces(),
        }
    }

    /// Loads at a time (s), without the forces of elements.
    pub(crate) fn evaluate_loads(&mut self, time: f64) {
        let Self { nodes, loads, .. } = self;
        loads.evaluate(time, None);
        with_nodes!(nodes, arrays => loads.sums.write_plain(&mut arrays.external));
    }

    /// Receives the forces of other ranks at shared nodes.
    fn receive_forces(&mut self) -> Result<(), RunError> {
        if self.ranks.is_single() {
            return Ok(());
        }
        let Ranked { exchange, team, .. } = &mut self.ranks;
        let complete = with_nodes!(&mut self.nodes, arrays => {
            exchange.receive(team, &mut arrays.forces)
        });
        if complete {
            Ok(())
        } else {
            Err(self.ranks.ended_elsewhere())
        }
    }

    /// Computes the coefficients for a rule of mass damping and a length of step (s), unless they are in use.
    pub(crate) fn prepare(&mut self, rule: MassDampingRule, step: f64) {
        if self.prepared == Some((rule, step)) {
            return;
        }
        self.prepared = Some((rule, step));
        self.groups.prepare(rule, step);
        let (mut gain, mut decay) = (Vec::new(), Vec::new());
        for (node, mass) in self.mass.iter().enumerate() {
            let grouped = self.groups.if_kicked(self.group_of[node]).is_some();
            let damping = self.mass_damping.get(node).copied().unwrap_or(0.0) * step;
            let (effective, old) = rule.effective_mass(*mass, damping);
            // Nodes without mass are not moved; nodes of groups are updated apart from this pass.
            let moves = !grouped && effective > 0.0;
            gain.push(if moves { step / effective } else { 0.0 });
            if !self.mass_damping.is_empty() {
                decay.push(if moves { old / effective } else { 1.0 });
            }
        }
        with_nodes!(&mut self.nodes, arrays => arrays.set_coefficients(&gain, &decay));
        let least = self.ranks.least_mass;
        for bound in &mut self.constraints {
            for (inverse, g) in bound.inverse_mass.iter_mut().zip(bound.groups.clone()) {
                let orphan = self.groups.groups[g].orphan_inverse(least);
                *inverse = orphan.unwrap_or_else(|| self.groups.response(g));
            }
            if let Some(coupled) = bound.constraint.coupled() {
                coupled.couple(&self.groups.couplings(&bound.groups));
            }
            bound.constraint.prepare(step, &bound.inverse_mass);
        }
    }

    /// Predicts the velocity of the groups, with prescribed motion.
    fn predict(&mut self, step: f64) {
        let end = self.time + step;
        let motions: Vec<f64> = self.prescribed.iter().map(|f| f.value(end)).collect();
        let (groups, slots, sums) = (&mut self.groups, &self.subdomain.slots, &self.loads.sums);
        with_nodes!(&self.nodes, arrays => {
            groups.kick(arrays, slots, |group| sums.on_group(group), step);
            groups.prescribe(&motions, |node| arrays.displacement[node].to_vector(), step);
        });
        groups.couple_fibres();
    }

    /// Corrects the predicted velocities by the constraints, and accounts their work.
    fn correct(&mut self, step: f64) -> Result<(), RunError> {
        let work = match self.bay {
            Some(_) => self.correct_bay(step)?,
            None => self.correct_once(step)?,
        };
        let (Some(ledger), Some(prepared)) = (&mut self.ledger, self.prepared) else {
            return Ok(());
        };
        for (index, (bound, work)) in self.constraints.iter().zip(&work).enumerate() {
            let own = (index, bound.groups.clone());
            // The work of a constraint that is not divided is accounted at its first node.
            let divided = bound.constraint.divided();
            let divided = divided.and_then(|divided| divided.divided_work());
            let divided = divided.unwrap_or(DividedWork {
                nodes: &[0],
                work: core::slice::from_ref(work),
            });
            ledger.record_constraint(&self.groups, prepared, own, &bound.predicted, divided);
        }
        Ok(())
    }

    /// Corrects the predicted velocities by the constraints; returns their work in this step.
    pub(crate) fn correct_once(&mut self, step: f64) -> Result<Vec<ConstraintWork>, RunError> {
        let Self {
            constraints,
            groups,
            ledger,
            profiler,
            ranks,
            ..
        } = self;
        let mut all = Vec::with_capacity(constraints.len());
        for (index, bound) in constraints.iter_mut().enumerate() {
            ranks.failed_in_constraint(index);
            let start = profiler.as_ref().map(|_| Instant::now());
            let motion = groups.motion.of(bound.groups.clone());
            if ledger.is_some() {
                bound.predicted.clear();
                bound.predicted.extend_from_slice(motion.next);
            }
            let work = bound.constraint.correct(PredictedMotion::new(
                StepTime {
                    number: self.number,
                    time: self.time,
                    step,
                },
                motion.displacement,
                motion.previous,
                motion.next,
                &bound.inverse_mass,
            ))?;
            groups.follow_constraint(&bound.groups);
            if let (Some(profiler), Some(start)) = (profiler.as_mut(), start) {
                profiler.constraints[index] += start.elapsed();
            }
            all.push(work);
        }
        Ok(all)
    }

    fn advance<const DRIFT: bool>(&mut self, step: f64) {
        let (gather, motion, limit) = (
            &self.subdomain.gather,
            &self.groups.motion,
            self.speed_limit,
        );
        let sound = with_nodes!(&mut self.nodes, arrays => {
            arrays.advance::<DRIFT>(gather, motion, step, limit)
        });
        if !sound && self.fault.is_none() {
            self.fault = Some(self.divergence());
        }
    }

    /// The error of a diverged motion, with the fastest node; a node whose velocity is not finite counts as fastest.
    pub(crate) fn divergence(&mut self) -> RunError {
        let rank = |v: &Vec3| {
            let speed = v.norm();
            if speed.is_finite() {
                speed
            } else {
                f64::INFINITY
            }
        };
        let (mut worst, mut velocity) = (0, Vec3::zeros());
        for node in 0..self.mass.len() {
            let v = self.velocity_of(node);
            if rank(&v) > rank(&velocity) {
                (worst, velocity) = (node, v);
            }
        }
        let at = self.element_at(worst);
        self.ranks.diverged(velocity.norm(), worst);
        RunError::Diverged {
            step: self.number,
            time: self.time,
            element: at.element,
            set: at.set,
            node: self.node_tag(worst),
            speed: velocity.norm(),
        }
    }
}
