//! Work that no state function gives, booked step by step.

use powerhouse_model::{BlockContext, ConstitutiveLaw, ElementKernel, Quad};

use super::Block;
use super::numbers::AlignedNumbers;
use super::operations::Rates;
use super::transfer::NodeScalar;
use crate::lanes::BatchScalar;

/// What a block remembers from step to step to account for damping and plastic flow.
#[derive(Debug)]
pub(super) struct Account<S> {
    /// The step that the rest belongs to.
    number: Option<u64>,
    /// Velocity before that step (m/s), by place.
    velocity: Vec<Quad<f64>>,
    /// Elastic and hourglass energy of that velocity taken as a displacement.
    velocity_energy: f64,
    /// Stress at that step (Pa), for laws that are not linear.
    stress: AlignedNumbers<S>,
    /// Work of the stresses less the growth of the elastic energy (J).
    pub(super) plastic: f64,
    /// Elastic energy at that step (J).
    elastic: f64,
    /// Work of the stiffness damping (J).
    pub(super) damping: f64,
}

impl<S: BatchScalar> Default for Account<S> {
    fn default() -> Self {
        Self {
            number: None,
            velocity: Vec::new(),
            velocity_energy: 0.0,
            stress: AlignedNumbers::zeros(0),
            plastic: 0.0,
            elastic: 0.0,
            damping: 0.0,
        }
    }
}

impl<S> Account<S> {
    /// Forgets the last step: what follows does not continue it.
    pub(super) fn rest(&mut self) {
        self.number = None;
    }
}

impl<K, M, S, const N: usize, const P: usize> Block<K, M, S, N, P>
where
    K: ElementKernel<N, P>,
    M: ConstitutiveLaw,
    S: NodeScalar,
{
    /// Books the work of the step that ends at the context.
    ///
    /// With the velocity `v` of that step, `v_0` of the step before and the elastic form
    /// `a(x, y) = x . K y`, damping takes `1/2 (a(v_0, v) + a(v, v)) beta dt`. With `E(x) =
    /// a(x, x) / 2`, summed element by element, `a(v_0, v) = E(v_0) + E(v) - E(v - v_0)`.
    ///
    /// The stresses of other laws do the work `1/2 (sigma_0 + sigma_1) : de V` on the strain
    /// increment; what does not become elastic energy counts as plastic.
    pub(super) fn book_step(
        &mut self,
        context: &BlockContext,
        displacement: &[Quad<f64>],
        velocity: Vec<Quad<f64>>,
    ) {
        let damping = self.coefficient(context);
        if M::LINEAR && damping == 0.0 {
            return;
        }
        let mut account = core::mem::take(&mut self.account);
        let follows = context.number > 0 && account.number == Some(context.number - 1);

        if damping != 0.0 {
            let energy = self.elastic_form(&velocity);
            if follows {
                let change: Vec<Quad<f64>> = velocity
                    .iter()
                    .zip(&account.velocity)
                    .map(|(v, before)| Quad::from_vector(&(v.to_vector() - before.to_vector())))
                    .collect();
                let mixed = account.velocity_energy + energy - self.elastic_form(&change);
                account.damping += 0.5 * damping * context.step * (mixed + 2.0 * energy);
            }
            account.velocity_energy = energy;
        }

        if !M::LINEAR {
            let numbers = self.places.as_slice().len() * P * 6;
            if account.stress.as_slice().len() != numbers {
                account.stress = AlignedNumbers::zeros(numbers);
            }
            let rates = Rates {
                velocity: &velocity,
                damping: 0.0,
                step: context.step,
                stored: Some(account.stress.as_mut_slice()),
            };
            let survey = self.survey(displacement, Some(rates));
            let (mut elastic, mut work) = (0.0, 0.0);
            for summary in &survey {
                elastic += summary.elastic;
                work += summary.work;
            }
            if follows {
                account.plastic += work - (elastic - account.elastic);
            }
            account.elastic = elastic;
        }

        account.number = Some(context.number);
        account.velocity = velocity;
        self.account = account;
    }

    /// Elastic and hourglass energy of a nodal vector under the initial stiffness (J).
    fn elastic_form(&self, nodes: &[Quad<f64>]) -> f64 {
        let mut sum = 0.0;
        for summary in self.elastic_survey(nodes) {
            sum += summary.elastic + summary.hourglass;
        }
        sum
    }
}
