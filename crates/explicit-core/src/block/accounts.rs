//! Mean stresses, energies and the work of a step, from the fields of the elements.

use powerhouse_model::{ElementKernel, Geometry, Quad, Stress};

use super::numbers::AlignedNumbers;
use super::operations::{Moduli, PointFields, Visitor};
use super::transfer::{Batch, gather};
use crate::lanes::{Arrangement, BatchLane, BatchScalar, MOST_LANES};

/// Sums lanes in the order of elements, so that the width leaves no trace.
#[inline(always)]
fn sum_lanes<L: BatchLane<Scalar = S>, S: BatchScalar, const N: usize>(
    value: L,
    batch: &Batch<S, N>,
    arrangement: &Arrangement,
    sum: &mut f64,
) {
    let mut lanes = [S::default(); MOST_LANES];
    value.store(&mut lanes);
    for j in 0..L::WIDTH {
        if batch.has(j) {
            *sum += lanes[arrangement.lane_of[j]].to_f64();
        }
    }
}

/// Adds the mean change of stress over the volume of each element.
pub(super) struct MeanStress<'a, K> {
    pub(super) kernel: &'a K,
    pub(super) arrangement: Arrangement,
    pub(super) out: &'a mut [Stress],
}

impl<K, S, const N: usize, const P: usize> Visitor<S, N, P> for MeanStress<'_, K>
where
    K: ElementKernel<N, P>,
    S: BatchScalar,
{
    #[inline(always)]
    fn visit<L: BatchLane<Scalar = S>>(
        &mut self,
        token: L::Token,
        batch: &Batch<S, N>,
        fields: &PointFields<L, N, P>,
    ) {
        let volumes = self
            .kernel
            .volumes(Geometry::<L>::new(token, batch.geometry));
        let mut volume = volumes[0];
        for p in 1..P {
            volume = volume + volumes[p];
        }
        let mut mean = Stress::zero(token);
        for p in 0..P {
            mean = mean + fields.stresses[p] * (volumes[p] / volume);
        }
        for i in 0..6 {
            let mut lanes = [S::default(); MOST_LANES];
            mean.0[i].store(&mut lanes);
            for j in 0..L::WIDTH {
                if batch.has(j) {
                    let lane = lanes[self.arrangement.lane_of[j]];
                    self.out[batch.first + j].0[i] += lane.to_f64();
                }
            }
        }
    }
}

/// Sums the energies that are held by elastic strain and by hourglass resistance.
pub(super) struct HeldEnergy<'a, K> {
    pub(super) kernel: &'a K,
    pub(super) moduli: Moduli,
    pub(super) linear: bool,
    pub(super) arrangement: Arrangement,
    pub(super) elastic: f64,
    pub(super) hourglass: f64,
}

/// Elastic energy of a batch: `1/2 sigma : C^-1 : sigma`, which for a linear law is
/// `1/2 sigma : epsilon`.
#[inline(always)]
fn elastic_energy<L: BatchLane, const N: usize, const P: usize>(
    moduli: Moduli,
    linear: bool,
    volumes: &[L; P],
    fields: &PointFields<L, N, P>,
) -> L {
    let half = volumes[0].constant(0.5);
    let bulk = moduli.lambda + 2.0 / 3.0 * moduli.shear;
    let distortion = volumes[0].constant(1.0 / (2.0 * moduli.shear));
    let dilatation = volumes[0].constant(1.0 / (9.0 * bulk));
    let mut energy = volumes[0].constant(0.0);
    for p in 0..P {
        let stress = &fields.stresses[p];
        let density = if linear {
            stress.work(&fields.strains[p])
        } else {
            let [xx, yy, zz, xy, yz, zx] = stress.0;
            let trace = xx + yy + zz;
            let mean = trace * trace.constant(1.0 / 3.0);
            let (x, y, z) = (xx - mean, yy - mean, zz - mean);
            let normal = x.mul_add(x, y.mul_add(y, z * z));
            let shear = xy.mul_add(xy, yz.mul_add(yz, zx * zx));
            distortion * (normal + (shear + shear)) + dilatation * (trace * trace)
        };
        energy = (half * density).mul_add(volumes[p], energy);
    }
    energy
}

impl<K, S, const N: usize, const P: usize> Visitor<S, N, P> for HeldEnergy<'_, K>
where
    K: ElementKernel<N, P>,
    S: BatchScalar,
{
    #[inline(always)]
    fn visit<L: BatchLane<Scalar = S>>(
        &mut self,
        token: L::Token,
        batch: &Batch<S, N>,
        fields: &PointFields<L, N, P>,
    ) {
        let geometry = Geometry::<L>::new(token, batch.geometry);
        let volumes = self.kernel.volumes(geometry);
        let elastic = elastic_energy(self.moduli, self.linear, &volumes, fields);
        sum_lanes(elastic, batch, &self.arrangement, &mut self.elastic);
        let modulus = L::splat(token, self.moduli.constrained());
        if let Some(energy) = self
            .kernel
            .hourglass_energy(geometry, modulus, &fields.modes)
        {
            sum_lanes(energy, batch, &self.arrangement, &mut self.hourglass);
        }
    }
}

/// What a block remembers from step to step to account for work that no state function gives.
#[derive(Debug)]
pub(super) struct Account<S> {
    /// The step that the rest belongs to.
    pub(super) number: Option<u64>,
    /// Velocity before that step (m/s), by place.
    pub(super) velocity: Vec<Quad<f64>>,
    /// Stress at that step (Pa), for laws that are not linear.
    pub(super) stress: AlignedNumbers<S>,
    /// Work of the stresses since the account began (J), for laws that are not linear.
    pub(super) work: f64,
    /// Elastic energy when it began (J).
    pub(super) elastic_at_start: f64,
    /// Work that is not held as elastic energy (J).
    pub(super) plastic: f64,
    /// Work of the stiffness damping (J).
    pub(super) damping: f64,
}

impl<S: BatchScalar> Default for Account<S> {
    fn default() -> Self {
        Self {
            number: None,
            velocity: Vec::new(),
            stress: AlignedNumbers::zeros(0),
            work: 0.0,
            elastic_at_start: 0.0,
            plastic: 0.0,
            damping: 0.0,
        }
    }
}

/// Adds the work of the step that ends now.
///
/// With the strain increment `de` of that step, stresses `s` and damping stresses `d` before and
/// after it: `1/2 (s_0 + s_1) : de V` and `1/2 (d_0 + d_1) : de V`.
pub(super) struct StepWork<'a, K, A: BatchScalar, S> {
    pub(super) kernel: &'a K,
    pub(super) moduli: Moduli,
    pub(super) linear: bool,
    pub(super) arrangement: Arrangement,
    /// Length of the step (s).
    pub(super) step: f64,
    /// Stiffness damping coefficient (s).
    pub(super) damping: f64,
    /// Velocity during the step (m/s), by engine number.
    pub(super) velocity: &'a [Quad<A>],
    /// Velocity during the step before (m/s), by place.
    pub(super) velocity_before: &'a [Quad<f64>],
    /// Stress before the step, replaced by that after it.
    pub(super) stress: &'a mut [S],
    /// Sum of the stresses' work (J).
    pub(super) work: f64,
    /// Sum of the damping's work (J).
    pub(super) dissipated: f64,
    /// Elastic energy after the step (J).
    pub(super) elastic: f64,
}

impl<K, A, S, const N: usize, const P: usize> Visitor<S, N, P> for StepWork<'_, K, A, S>
where
    K: ElementKernel<N, P>,
    A: BatchScalar,
    S: BatchScalar,
{
    #[inline(always)]
    fn visit<L: BatchLane<Scalar = S>>(
        &mut self,
        token: L::Token,
        batch: &Batch<S, N>,
        fields: &PointFields<L, N, P>,
    ) {
        let geometry = Geometry::<L>::new(token, batch.geometry);
        let volumes = self.kernel.volumes(geometry);
        let rates = gather::<A, L, N>(token, self.velocity, batch.engine);
        let rates = self.kernel.modes(&rates);
        let strain_rates = self.kernel.strains(geometry, &rates);
        let step = L::splat(token, self.step);

        if self.damping != 0.0 {
            let before = gather::<f64, L, N>(token, self.velocity_before, batch.places);
            let mut mean = self.kernel.modes(&before);
            let half = L::splat(token, 0.5 * self.damping);
            for a in 0..N {
                for i in 0..3 {
                    mean[a][i] = (mean[a][i] + rates[a][i]) * half;
                }
            }
            let mean_strains = self.kernel.strains(geometry, &mean);
            let lambda = L::splat(token, self.moduli.lambda);
            let shear = L::splat(token, self.moduli.shear);
            let mut power = L::splat(token, 0.0);
            for p in 0..P {
                let stress = Stress::elastic(lambda, shear, &mean_strains[p]);
                power = stress.work(&strain_rates[p]).mul_add(volumes[p], power);
            }
            let modulus = L::splat(token, self.moduli.constrained());
            let nothing = [Stress::zero(token); P];
            let resisted = self.kernel.forces(geometry, &nothing, modulus, &mean);
            for a in 0..N {
                for i in 0..3 {
                    power = resisted[a][i].mul_add(rates[a][i], power);
                }
            }
            sum_lanes(power * step, batch, &self.arrangement, &mut self.dissipated);
        }

        if !self.linear {
            let half = L::splat(token, 0.5);
            let first = batch.first * 6 * P;
            let mut power = L::splat(token, 0.0);
            for p in 0..P {
                let mut before = Stress::zero(token);
                for i in 0..6 {
                    let place = first + (6 * p + i) * L::WIDTH;
                    before.0[i] = L::load(token, &self.stress[place..]);
                    fields.stresses[p].0[i].store(&mut self.stress[place..]);
                }
                let mean = (before + fields.stresses[p]) * half;
                power = mean.work(&strain_rates[p]).mul_add(volumes[p], power);
            }
            sum_lanes(power * step, batch, &self.arrangement, &mut self.work);
            let elastic = elastic_energy(self.moduli, false, &volumes, fields);
            sum_lanes(elastic, batch, &self.arrangement, &mut self.elastic);
        }
    }
}
