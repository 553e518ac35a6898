//! Laws and constraints of a step of a bay, which depend on the velocities after it as these depend on them.

use powerhouse_model::{ConstraintWork, Operator, Quad, RunError, StepTime, UnsolvedSteps, Vec3};
use rayon::prelude::*;

use super::{Bay, Best};
use crate::Model;
use crate::gather::CHUNK;
use crate::groups::Groups;
use crate::nodes::Nodes;

/// Difference between guess and answer, over the motion, at which laws and constraints of a step count as solved.
const SETTLED: f64 = 5e-6;
/// What rounding changes of forces, over the sum of those of all elements at a node: some three times what it was in a bay of 16,000 elements
/// under gravity.
const ROUNDING: f64 = 3e-14;
/// Most iterations of a step. What is not solved then has no solution that this finds, as where a brittle bond holds if it breaks and breaks if it
/// holds: the state with the least difference is taken, and the balance of energy has what it errs by.
const MOST_ITERATIONS: usize = 30;
/// Iterations that may follow the best one without a better one, and the difference of one of them over that of the best, after which the best one is taken up again
/// with a smaller change.
const PATIENCE: usize = 4;
const WORSE: f64 = 4.0;

impl Bay {
    /// What laws and constraints make of the velocities (m/s) after the step, in the order of the guess: velocities by the impulses of laws in the
    /// second half of the step, and changes by constraints.
    fn answer(&self, groups: &Groups, step: f64) -> Vec<Vec3> {
        let next = &groups.motion.next;
        let mut answer = self.of_laws(&self.solution.lacking, groups, step);
        let changed = next.iter().zip(&self.solution.free);
        answer.extend(changed.map(|(next, free)| next - free));
        answer
    }

    /// Velocities (m/s) that the impulses of laws in the second half of a step make, by group, where they lack so much of linear forces at its end.
    pub(super) fn of_laws(&self, lacking: &[[Vec3; 2]], groups: &Groups, step: f64) -> Vec<Vec3> {
        let all = lacking.par_iter().zip(&groups.coefficients);
        let all = all.map(|([force, moment], coefficients)| {
            coefficients.inverse * (force * (0.5 * step) + moment * self.slowness)
        });
        all.collect()
    }

    /// Inner product of velocities in the order of the guess, by effective mass.
    fn product(&self, a: &[Vec3], b: &[Vec3]) -> f64 {
        let inertia = &self.inertia.1;
        let laws = a.len() - self.solution.free.len();
        let chunks = a.par_chunks(CHUNK).zip(b.par_chunks(CHUNK)).enumerate();
        let sums = chunks.map(|(chunk, (a, b))| {
            let both = (chunk * CHUNK..).zip(a.iter().zip(b));
            let of = |(index, (a, b)): (usize, (&Vec3, &Vec3))| {
                let group = if index < laws { index } else { index - laws };
                a.dot(&(inertia[group] * b))
            };
            both.map(of).sum::<f64>()
        });
        let sums: Vec<f64> = sums.collect();
        sums.iter().sum()
    }

    /// Difference between an answer of laws and constraints and what was guessed of them, and its size over that of the motion; a smaller motion than
    /// `least` counts as that where the step would not be settled.
    fn difference(&self, answer: &[Vec3], least: impl FnOnce() -> f64) -> (Vec<Vec3>, f64) {
        let left: Vec<Vec3> = (answer.iter().zip(&self.solution.guess))
            .map(|(answer, guess)| answer - guess)
            .collect();
        let inertia = &self.inertia.1;
        let sums = self.solution.sum.iter().zip(inertia);
        let all: f64 = sums.map(|(sum, inertia)| sum.dot(&(inertia * sum))).sum();
        let of_left = self.product(&left, &left);
        let (of_left, motion) = (of_left.sqrt(), all.sqrt());
        let size = if of_left == 0.0 {
            0.0
        } else if of_left <= SETTLED * motion {
            of_left / motion
        } else {
            of_left / motion.max(least())
        };
        (left, size)
    }

    /// The guess after an answer with a difference from the last one.
    fn guess_again(&mut self, left: Vec<Vec3>, size: f64) {
        let best = &mut self.solution.best;
        best.age += 1;
        if size < best.size {
            *best = Best {
                guess: self.solution.guess.clone(),
                left: left.clone(),
                size,
                share: 1.0,
                age: 0,
            };
        }
        if best.age > PATIENCE || size > WORSE * best.size || size.is_nan() {
            best.share *= 0.5;
            best.age = 0;
            let both = best.guess.iter().zip(&best.left);
            self.solution.guess = both
                .map(|(guess, left)| guess + left * best.share)
                .collect();
            self.solution.mixing.clear();
            return;
        }
        let mut mixing = core::mem::take(&mut self.solution.mixing);
        let guess = mixing.next(&self.solution.guess, left, |a, b| self.product(a, b));
        (self.solution.mixing, self.solution.guess) = (mixing, guess);
    }

    /// Keeps what the step has found.
    fn keep(&mut self, answer: Vec<Vec3>) {
        let Self {
            motion, solution, ..
        } = self;
        motion.settled.swap(0, 1);
        motion.settled[0] = answer;
        motion.lacking.swap(0, 1);
        motion.lacking[0].clone_from(&solution.lacking);
    }
}

impl Model {
    /// Corrects the predicted velocities of a bay by its laws and constraints until they agree with the velocities that follow from them; returns
    /// the work of the constraints.
    pub(crate) fn correct_bay(&mut self, step: f64) -> Result<Vec<ConstraintWork>, RunError> {
        self.repeat_constraints(true);
        let (mut iteration, time, mut least) = (0, self.time, None);
        loop {
            let work = self.correct_once(step)?;
            if self.fault.is_some() {
                return Ok(work);
            }
            if self.bay.as_ref().is_some_and(|bay| !bay.is_linear) {
                let (velocity, when) = (self.groups.motion.next.clone(), self.present_step(step));
                self.evaluate_delayed(&velocity, 0.5 * step, when)?;
            }
            let Some(bay) = &self.bay else {
                return Ok(work);
            };
            iteration += 1;
            let answer = bay.answer(&self.groups, step);
            let least = || *least.get_or_insert_with(|| self.rounding(bay, step) / SETTLED);
            let (left, size) = bay.difference(&answer, least);
            let Some(bay) = &mut self.bay else {
                return Ok(work);
            };
            if size <= SETTLED || iteration > MOST_ITERATIONS {
                if size > SETTLED {
                    let earlier = bay.motion.unsolved;
                    bay.motion.unsolved = Some(UnsolvedSteps::with(earlier, time, size));
                }
                bay.keep(answer);
                if self.ledger.is_some() && !bay.is_linear {
                    self.book_delayed(self.present_step(step))?;
                }
                return Ok(work);
            }
            if iteration == MOST_ITERATIONS {
                bay.solution.guess.clone_from(&bay.solution.best.guess);
            } else {
                bay.guess_again(left, size);
            }
            if !bay.solve(&mut self.groups, step) {
                self.fault = Some(self.divergence());
                return Ok(work);
            }
            self.repeat_constraints(false);
        }
    }

    /// Size of what rounding of the forces of the elements changes of the velocities of a step.
    fn rounding(&self, bay: &Bay, step: f64) -> f64 {
        let Nodes::F64(arrays) = &self.nodes else {
            return 0.0;
        };
        let (groups, slots) = (&self.groups, &self.subdomain.slots);
        let coefficients = groups.coefficients.par_iter().zip(&bay.inertia.1);
        let of_groups = groups.groups.par_iter().zip(coefficients);
        let squares = of_groups.map(|(group, (coefficients, inertia))| {
            let forces = group.members.iter();
            let forces = forces.map(|node| arrays.internal(slots, *node as usize).norm());
            let changed = coefficients.inverse * Vec3::repeat(forces.sum::<f64>() * step);
            changed.dot(&(inertia * changed))
        });
        let squares: Vec<f64> = squares.collect();
        ROUNDING * squares.iter().sum::<f64>().sqrt()
    }

    /// Lets the constraints keep the state before a step, or return to it.
    fn repeat_constraints(&mut self, keep: bool) {
        for bound in &mut self.constraints {
            match bound.constraint.jointed_mut() {
                Some(jointed) if keep => jointed.keep_state(),
                Some(jointed) => jointed.return_to_kept(),
                None => {}
            }
        }
    }

    /// Forces of the stiffness of all elements and of loads at the present time. Before the first step laws are evaluated half a step earlier.
    pub(super) fn stiffness_forces(&mut self, when: StepTime) -> Result<(), RunError> {
        let is_first = |bay: &Bay| bay.motion.lacking[0].is_empty();
        if self.bay.as_ref().is_some_and(is_first)
            && let (Some(bay), Nodes::F64(arrays)) = (&self.bay, &self.nodes)
        {
            let of = |lead: &u32| arrays.velocity[*lead as usize].to_vector();
            let velocity: Vec<Vec3> = bay.leads.iter().map(of).collect();
            self.evaluate_delayed(&velocity, -0.5 * when.step, when)?;
            // A body that moves from the start on has strains from its velocity, from which its laws go on.
            self.uncommitted = velocity.iter().any(|v| *v != Vec3::zeros());
            if let Some(bay) = &mut self.bay {
                bay.motion.lacking[0].clone_from(&bay.solution.lacking);
            }
        }
        self.evaluate_loads(when.time);
        let Nodes::F64(arrays) = &self.nodes else {
            return Ok(());
        };
        let moved: Vec<Vec3> = arrays.displacement.iter().map(|u| u.to_vector()).collect();
        // The product stays as the forces of the elements.
        self.elastic_product(Operator::Elastic, &moved, &|_| 1.0);
        Ok(())
    }

    /// Evaluates the laws of a bay at the velocities (m/s) of its groups, a time (s) from the present one, and what they lack of linear forces.
    fn evaluate_delayed(
        &mut self,
        velocity: &[Vec3],
        after: f64,
        when: StepTime,
    ) -> Result<(), RunError> {
        let (Some(bay), Nodes::F64(arrays)) = (&self.bay, &self.nodes) else {
            return Ok(());
        };
        let (step, previous) = (when.step, &self.groups.motion.previous);
        let is_first = bay.motion.lacking[0].is_empty();
        // The velocity tells elements how their strain has changed since the step before.
        let places = |node: usize| {
            let (group, offset) = bay.place[node];
            let now = velocity[group as usize];
            let before = if is_first {
                now
            } else {
                previous[group as usize]
            };
            let (moved, late) = (&arrays.displacement[node], bay.slowness * offset);
            let rate = (before + now) * 0.5 - (now - before) * (late / step);
            (moved.to_vector() + now * (after - late), rate)
        };
        let nodes = (0..self.mass.len()).into_par_iter();
        let (placed, rates): (Vec<Vec3>, Vec<Vec3>) = nodes.map(places).unzip();
        let elastic = self.elastic_product(Operator::Elastic, &placed, &|_| 1.0);
        let done = self.evaluate_at((&placed, &rates), when, false);
        let (Some(bay), Nodes::F64(arrays)) = (&mut self.bay, &self.nodes) else {
            return done;
        };
        let slots = &self.subdomain.slots;
        let lacking = self.groups.groups.par_iter().map(|group| {
            let lack = |node: usize| elastic[node] - arrays.internal(slots, node);
            let forces = group.members.iter().map(|node| lack(*node as usize));
            [forces.sum(), bay.moment(group, lack)]
        });
        bay.solution.lacking = lacking.collect();
        (bay.solution.placed, bay.solution.rates) = (placed, rates);
        done
    }

    /// Evaluates the laws at displacements (m) and velocities (m/s) of all engine nodes, which are those of the model before and after; energies of
    /// the step are accounted for if they are `booked`.
    fn evaluate_at(
        &mut self,
        (placed, rates): (&[Vec3], &[Vec3]),
        when: StepTime,
        booked: bool,
    ) -> Result<(), RunError> {
        let (Some(bay), Nodes::F64(arrays)) = (&self.bay, &mut self.nodes) else {
            return Ok(());
        };
        let terms = bay.terms.with_repeats(true);
        let quads = |values: &[Vec3]| values.par_iter().map(Quad::from_vector).collect();
        let moved = core::mem::replace(&mut arrays.displacement, quads(placed));
        let moving = core::mem::replace(&mut arrays.velocity, quads(rates));
        let done = self.evaluate_parts(terms, when, booked, false);
        if let Nodes::F64(arrays) = &mut self.nodes {
            (arrays.displacement, arrays.velocity) = (moved, moving);
        }
        done
    }

    /// Accounts for the energies of the step at the state that laws were evaluated at last.
    fn book_delayed(&mut self, when: StepTime) -> Result<(), RunError> {
        let Some(bay) = &mut self.bay else {
            return Ok(());
        };
        let solution = &mut bay.solution;
        let [placed, rates] = [&mut solution.placed, &mut solution.rates].map(core::mem::take);
        let done = self.evaluate_at((&placed, &rates), when, true);
        if let Some(bay) = &mut self.bay {
            (bay.solution.placed, bay.solution.rates) = (placed, rates);
        }
        done
    }
}
