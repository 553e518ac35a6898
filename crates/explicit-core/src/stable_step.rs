//! The stable time step, and the element that limits it.

use powerhouse_model::{
    FrequencyLimits, LimitingTerm, RunError, StableStep, TimeIntegrator, decode, encode,
};

use serde::{Deserialize, Serialize};

use crate::Model;
use crate::ranks::Communicator;

/// Safety factor of the stable step on the stability limit.
const SAFETY: f64 = 0.98;

/// Highest frequency and damping of a model, computed once.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Spectrum {
    /// Highest angular frequency of the assembled model (rad/s).
    highest: f64,
    iterations: usize,
    converged: bool,
    /// Upper bound (s) of the effective stiffness damping coefficient at the highest frequency.
    stiffness_damping: f64,
    /// The speed (m/s) at which strains reach the order of one.
    pub(crate) reference_speed: f64,
}

/// Stable step of one element without its neighbours.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct ElementBound<S> {
    /// The step (s).
    step: f64,
    /// Place in the order of the blocks of all ranks.
    place: u64,
    /// Stiffness damping coefficient (s).
    damping: f64,
    /// Number of the element.
    element: u64,
    /// Name of its set.
    set: S,
}

/// The least bound of any rank, from that of this rank; the first one of equal bounds.
fn worst_of_all(
    own: Option<&ElementBound<&str>>,
    team: &Communicator,
) -> Option<ElementBound<String>> {
    let own = own.cloned().map(|bound| ElementBound {
        step: bound.step,
        place: bound.place,
        damping: bound.damping,
        element: bound.element,
        set: bound.set.to_string(),
    });
    if team.is_single() {
        return own;
    }
    let least = team.least_of(own.as_ref().map_or(f64::INFINITY, |bound| bound.step));
    let equal = own.as_ref().filter(|bound| bound.step == least);
    let place = team.least(equal.map_or(u64::MAX, |bound| bound.place));
    let is_first = equal.filter(|bound| bound.place == place).is_some();
    let first = team.least(if is_first {
        team.rank() as u64
    } else {
        u64::MAX
    });
    if first == u64::MAX {
        return None;
    }
    let sent = encode(&own).unwrap_or_default();
    decode(&team.of_rank(first as usize, sent)).ok().flatten()
}

impl Model {
    /// The stable step of the model under an integration scheme, from the highest frequency of the assembled
    /// elastic operator (joints open, without impedances), and the element that limits it.
    ///
    /// The first call costs some tens of force evaluations.
    ///
    /// # Errors
    /// If the scheme is unstable at every step under the model's damping.
    pub fn stable_step(&mut self, integrator: &dyn TimeIntegrator) -> Result<StableStep, RunError> {
        let limits = self.frequency_limits();
        let spectrum = self.spectrum();
        let step = integrator.stable_step(&limits)?;
        let mut report = StableStep::new(step, 2.0 / spectrum.highest);
        (report.iterations, report.converged) = (spectrum.iterations, spectrum.converged);
        let delayed = self.delayed_bound();
        let mut bounds: Vec<ElementBound<&str>> = Vec::new();
        let numbers = &self.ranks.block_numbers;
        for (block, &number) in self.blocks.iter().zip(numbers) {
            for (index, bound) in (0..).zip(block.frequency_bounds()) {
                let damping = bound.stiffness_damping;
                let frequency = bound.frequency * delayed / self.slowing(bound.element);
                let alone = FrequencyLimits::undamped(frequency).with_damping(
                    damping,
                    damping,
                    block.damping().mass,
                );
                let step = integrator.stable_step(&alone)?;
                bounds.push(ElementBound {
                    step,
                    place: (u64::from(number) << 32) + index,
                    damping,
                    element: self.element_tag(bound.element),
                    set: block.label(),
                });
            }
        }
        let team = &self.ranks.team;
        let worst = bounds.iter().min_by(|a, b| a.step.total_cmp(&b.step));
        if let Some(worst) = worst_of_all(worst, team) {
            let (step, set) = (worst.step, worst.set);
            report.element_bound = step;
            report.element = worst.element;
            if worst.damping > 0.5 * step {
                report.term = LimitingTerm::StiffnessDamping;
            }
            if limits.most_mass_damping * report.step > 1.99 {
                report.term = LimitingTerm::MassDamping;
            }
            let similar = bounds.iter().filter(|b| b.step <= 1.05 * step).count();
            report.similar_elements = team.total([similar as f64].into_iter()) as usize;
            let others = bounds.iter().filter(|b| b.set != set).map(|b| b.step);
            let next = others.min_by(f64::total_cmp).unwrap_or(f64::INFINITY);
            report.next_set_bound = Some(team.least_of(next)).filter(|next| next.is_finite());
            report.set = set;
        }
        team.check()?;
        Ok(report)
    }

    /// Highest frequency and damping of the model, input of the stability limit of a scheme. The highest frequency
    /// includes the safety factor.
    ///
    /// With different stiffness damping in different sets, the largest coefficient at the highest frequency would be
    /// too strict, because the damped set may not reach that frequency. The coefficient
    /// is the least `b` with `b w^2 >=` the highest eigenvalue of `M^-1 D`, `D` the sum of
    /// the damped operators: a bound for every scheme, because the highest eigenvalue of a sum is
    /// at most the sum of the highest ones.
    pub fn frequency_limits(&mut self) -> FrequencyLimits {
        let spectrum = self.spectrum();
        let mut least = f64::INFINITY;
        let mut mass = 0.0_f64;
        for block in &self.blocks {
            least = least.min(block.damping().stiffness);
            mass = mass.max(block.damping().mass);
        }
        let team = &self.ranks.team;
        let (least, mass) = (team.least_of(least), team.most_of(mass));
        FrequencyLimits::undamped(spectrum.highest / SAFETY).with_damping(
            least,
            spectrum.stiffness_damping,
            mass,
        )
    }

    pub(crate) fn spectrum(&mut self) -> Spectrum {
        if let Some(known) = self.spectrum {
            return known;
        }
        let (mut bound, mut reference_speed) = (0.0_f64, 0.0_f64);
        let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
        for block in &self.blocks {
            least = least.min(block.damping().stiffness);
            most = most.max(block.damping().stiffness);
            for of_element in block.frequency_bounds() {
                bound = bound.max(of_element.frequency);
                let size = self.element_size(of_element.element);
                reference_speed = reference_speed.max(0.5 * of_element.frequency * size);
            }
        }
        let team = &self.ranks.team;
        let (least, most) = (team.least_of(least), team.most_of(most));
        let (bound, reference_speed) = (team.most_of(bound), team.most_of(reference_speed));
        let found = self.in_pool(|model| {
            let of_slice = model.highest_of_slice(bound);
            of_slice.unwrap_or_else(|| model.highest_eigenvalue(|_| 1.0))
        });
        let assembled = (found.value + found.residual).sqrt();
        let converged = found.converged && assembled > 0.0;
        let highest = if converged {
            assembled
        } else {
            (bound * self.delayed_bound()).max(assembled)
        };
        let mut stiffness_damping = most;
        if least < most {
            let damped =
                self.in_pool(|model| model.highest_eigenvalue(|block| block.damping().stiffness));
            if damped.converged {
                let coefficient = (damped.value + damped.residual) / highest.powi(2);
                stiffness_damping = stiffness_damping.min(coefficient);
            }
        }
        let spectrum = Spectrum {
            highest,
            iterations: found.products,
            converged,
            stiffness_damping,
            reference_speed,
        };
        self.spectrum = Some(spectrum);
        spectrum
    }

    /// By what the delay of a slice or bay raises the frequency of an element at most, `1 / sqrt(1 - s^2 c^2)` with the highest
    /// speed `c` of any part; 1 for other bodies.
    fn delayed_bound(&self) -> f64 {
        if !self.is_delayed() {
            return 1.0;
        }
        let groups = self.groups.groups.iter().enumerate();
        let left = groups.filter(|(_, group)| group.mass > 0.0);
        let left = left.map(|(g, group)| match (&self.delayed, &self.bay) {
            (Some(slice), _) => (slice.inertia(g) / group.mass).min(),
            (_, Some(bay)) => bay.share_left(g, group.mass),
            _ => 1.0,
        });
        1.0 / left.fold(1.0, f64::min).sqrt()
    }

    /// By what fibres divide the frequency bound of an element all of whose nodes are in one, taken as that of a motion
    /// within them; 1 for other elements.
    fn slowing(&self, element: u32) -> f64 {
        if self.groups.fibres.is_empty() || element as usize >= self.mesh.element_count() {
            return 1.0;
        }
        let added = self.mesh.nodes_of(element).iter().map(|&node| {
            let group = self.group_of[self.engine(node)];
            group.map_or(0.0, |group| self.groups.groups[group as usize].added)
        });
        (1.0 + added.fold(f64::INFINITY, f64::min)).sqrt()
    }

    /// Diagonal of the bounding box of an element (m); zero for an additional element.
    fn element_size(&self, element: u32) -> f64 {
        if element as usize >= self.mesh.element_count() {
            return 0.0;
        }
        let positions = self.mesh.positions();
        let corners = self.mesh.nodes_of(element).iter();
        let (low, high) = corners.map(|&n| positions[n as usize]).fold(
            (
                powerhouse_model::Vec3::repeat(f64::INFINITY),
                powerhouse_model::Vec3::repeat(f64::NEG_INFINITY),
            ),
            |(low, high), x| (low.inf(&x), high.sup(&x)),
        );
        (high - low).norm()
    }
}
