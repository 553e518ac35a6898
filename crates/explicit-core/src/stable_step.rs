//! The stable step, and who limits it.

use powerhouse_model::{FrequencyLimits, LimitingTerm, RunError, TimeIntegrator};

use crate::Model;

/// The reported step is this share of the limit.
const SAFETY: f64 = 0.98;

/// The stable step of a model under a scheme.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct StableStep {
    /// The step to run with (s): 0.98 of the limit of the assembled model.
    pub step: f64,
    /// The limit of the assembled model without damping (s), `2 / w`.
    pub assembled_limit: f64,
    /// The least bound that one element alone gives, damping included (s); infinite if no block
    /// knows its elements' bounds.
    pub element_bound: f64,
    /// The user's number of that element.
    pub element: u64,
    /// Its set.
    pub set: String,
    /// What limits it: its stiffness damping coefficient counts if it is above half the bound,
    /// mass damping if it alone permits no longer step.
    pub term: LimitingTerm,
    /// Elements whose bound is within 5 % of it.
    pub similar_elements: usize,
    /// The least bound (s) of all other sets, what removing this set's worst elements could buy at
    /// most; none if there is no other set.
    pub next_set_bound: Option<f64>,
    /// Operator products that Lanczos took.
    pub iterations: usize,
    /// Whether Lanczos converged; if not, the element bound is used.
    pub converged: bool,
}

/// The spectrum of a model, found once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Spectrum {
    /// Highest angular frequency of the assembled model (rad/s).
    highest: f64,
    iterations: usize,
    converged: bool,
    /// Stiffness damping coefficient (s) that bounds the model's at the highest frequency.
    stiffness_damping: f64,
    /// The speed (m/s) at which strains reach the order of one.
    pub(crate) reference_speed: f64,
}

impl Model {
    /// The stable step of the model under a scheme, from the highest frequency of the assembled
    /// elastic operator (joints open, impedances out), and the element that limits it.
    ///
    /// The first call costs some tens of force evaluations.
    ///
    /// # Errors
    /// If the scheme is unstable at every step under the model's damping.
    pub fn stable_step(&mut self, integrator: &dyn TimeIntegrator) -> Result<StableStep, RunError> {
        let limits = self.frequency_limits();
        let spectrum = self.spectrum();
        let mut report = StableStep {
            step: integrator.stable_step(&limits)?,
            assembled_limit: 2.0 / spectrum.highest,
            element_bound: f64::INFINITY,
            element: 0,
            set: String::new(),
            term: LimitingTerm::Stiffness,
            similar_elements: 0,
            next_set_bound: None,
            iterations: spectrum.iterations,
            converged: spectrum.converged,
        };
        let mut bounds: Vec<(f64, f64, u32, &str)> = Vec::new();
        for block in &self.blocks {
            for bound in block.frequency_bounds() {
                let damping = bound.stiffness_damping;
                let alone = FrequencyLimits::undamped(bound.frequency).with_damping(
                    damping,
                    damping,
                    block.mass_damping(),
                );
                let step = integrator.stable_step(&alone)?;
                bounds.push((step, damping, bound.element, block.label()));
            }
        }
        let worst = bounds.iter().min_by(|a, b| a.0.total_cmp(&b.0)).copied();
        if let Some((step, damping, element, set)) = worst {
            report.element_bound = step;
            report.element = self.element_tag(element);
            report.set = set.into();
            if damping > 0.5 * step {
                report.term = LimitingTerm::StiffnessDamping;
            }
            if limits.most_mass_damping * report.step > 1.99 {
                report.term = LimitingTerm::MassDamping;
            }
            report.similar_elements = bounds.iter().filter(|b| b.0 <= 1.05 * step).count();
            let others = bounds.iter().filter(|b| b.3 != set).map(|b| b.0);
            report.next_set_bound = others.min_by(f64::total_cmp);
        }
        Ok(report)
    }

    /// What a scheme is told of the model. The highest frequency has the safety on it.
    ///
    /// With different stiffness damping in different sets, the largest coefficient would be
    /// charged to the highest frequency, though the damped set may not reach it. The coefficient
    /// given is the least `b` with `b w^2 >=` the highest eigenvalue of `M^-1 D`, `D` the sum of
    /// the damped operators: a bound for every scheme, because the highest eigenvalue of a sum is
    /// at most the sum of the highest ones.
    pub fn frequency_limits(&mut self) -> FrequencyLimits {
        let spectrum = self.spectrum();
        let mut least = f64::INFINITY;
        let mut mass = 0.0_f64;
        for block in &self.blocks {
            least = least.min(block.stiffness_damping());
            mass = mass.max(block.mass_damping());
        }
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
            least = least.min(block.stiffness_damping());
            most = most.max(block.stiffness_damping());
            for of_element in block.frequency_bounds() {
                bound = bound.max(of_element.frequency);
                let size = self.element_size(of_element.element);
                reference_speed = reference_speed.max(0.5 * of_element.frequency * size);
            }
        }
        let found = self.in_pool(|model| model.highest_eigenvalue(|_| 1.0));
        let assembled = (found.value + found.residual).sqrt();
        let converged = found.converged && assembled > 0.0;
        let highest = if converged {
            assembled
        } else {
            bound.max(assembled)
        };
        let mut stiffness_damping = most;
        if least < most {
            let damped =
                self.in_pool(|model| model.highest_eigenvalue(|block| block.stiffness_damping()));
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

    /// The diagonal of the box around an element (m); zero for an additional element.
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
