//! Mean stress and stored energies of elements.

use powerhouse_model::{Geometry, Quad, Strain, Stress};

use super::batches::Batch;
use super::operations::Moduli;

use crate::lanes::{BatchLane, BatchScalar, MOST_LANES};

/// Mean stress and stored energies of one element.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Summary {
    /// Mean change of stress over the volume (Pa).
    pub(super) stress: Stress,
    /// Stored strain energy (J).
    pub(super) elastic: f64,
    /// Energy stored by hourglass forces (J).
    pub(super) hourglass: f64,
}

/// Where the law writes one summary per element.
pub(super) struct Survey<'a> {
    pub(super) out: &'a mut [Summary],
    /// Whether of the batches alone that are inside the elastic domain, whose law the forces spared.
    pub(super) of_spared: bool,
}

/// Summaries in a step that is shown, until its state changes: those of the law as the forces evaluated it, and the others from
/// the first read on.
#[derive(Debug, Default)]
pub(super) struct Shown {
    /// Displacement of the forces (m), by local node index; empty in other steps.
    nodes: Vec<Quad<f64>>,
    /// One summary per element; empty before the first read where the forces leave none.
    pub(super) summaries: Vec<Summary>,
    /// Whether the summaries are those of all elements.
    pub(super) is_whole: bool,
}

impl Shown {
    /// Begins a step that is shown with a displacement (m), or another one without any.
    pub(super) fn begin(&mut self, nodes: &[Quad<f64>]) {
        self.nodes.clear();
        self.nodes.extend_from_slice(nodes);
        self.summaries.clear();
        self.is_whole = false;
    }
    /// Whether the step is shown, and has a displacement (m).
    pub(super) fn is_of(&self, nodes: &[Quad<f64>]) -> bool {
        let known = self.nodes.iter().map(|node| node.values);
        known.eq(nodes.iter().map(|node| node.values))
    }
}

/// Calls `put(element, number)` for every active element of a batch.
#[inline(always)]
pub(super) fn each_lane<L: BatchLane<Scalar = S>, S: BatchScalar, const N: usize>(
    value: L,
    batch: &Batch<S, N>,
    mut put: impl FnMut(usize, f64),
) {
    let mut lanes = [S::default(); MOST_LANES];
    value.store(&mut lanes);
    for j in 0..L::WIDTH {
        if batch.has(j) {
            put(
                batch.first + j,
                lanes[batch.arrangement.lane_of[j]].to_f64(),
            );
        }
    }
}

/// Writes the mean stress of each element of a batch.
#[inline(always)]
pub(super) fn write_mean<
    L: BatchLane<Scalar = S>,
    S: BatchScalar,
    const N: usize,
    const P: usize,
>(
    volumes: &[L; P],
    stresses: &[Stress<L>; P],
    batch: &Batch<S, N>,
    out: &mut [Summary],
) {
    let mut volume = volumes[0];
    for p in 1..P {
        volume = volume + volumes[p];
    }
    for i in 0..6 {
        let mut sum = stresses[0].0[i] * volumes[0];
        for p in 1..P {
            sum = stresses[p].0[i].mul_add(volumes[p], sum);
        }
        each_lane(sum / volume, batch, |e, mean| out[e].stress.0[i] = mean);
    }
}

/// Strain energy `1/2 sum_p sigma : epsilon V` of linear laws.
#[inline(always)]
pub(super) fn linear_energy<L: BatchLane, const P: usize>(
    volumes: &[L; P],
    stresses: &[Stress<L>; P],
    strains: &[Strain<L>; P],
) -> L {
    let half = volumes[0].constant(0.5);
    let mut energy = stresses[0].work(&strains[0]) * volumes[0];
    for p in 1..P {
        energy = stresses[p].work(&strains[p]).mul_add(volumes[p], energy);
    }
    half * energy
}

/// Complementary energy `1/2 sum_p sigma : C^-1 : sigma V`, which elastic unloading would return.
#[inline(always)]
pub(super) fn complementary_energy<L: BatchLane, const P: usize>(
    moduli: Moduli,
    volumes: &[L; P],
    stresses: &[Stress<L>; P],
) -> L {
    let bulk = moduli.lambda + 2.0 / 3.0 * moduli.shear;
    let mut energy = volumes[0].constant(0.0);
    for p in 0..P {
        let density = complementary_density([bulk, moduli.shear], &stresses[p].0);
        energy = density.mul_add(volumes[p], energy);
    }
    energy
}

/// Stored energy of saturated points: that of the skeleton at the effective stress, and that of the water at a pressure beyond
/// that at rest (Pa), from total changes of stress.
#[inline(always)]
pub(super) fn saturated_energy<L: BatchLane, const P: usize>(
    moduli: Moduli,
    volumes: &[L; P],
    stresses: &[Stress<L>; P],
    pressures: &[L; P],
) -> L {
    let half = volumes[0].constant(0.5 / moduli.water);
    let mut effective = *stresses;
    let mut energy = volumes[0].constant(0.0);
    for p in 0..P {
        for i in 0..3 {
            effective[p].0[i] = effective[p].0[i] + pressures[p];
        }
        let density = pressures[p] * pressures[p] * half;
        energy = density.mul_add(volumes[p], energy);
    }
    energy + complementary_energy(moduli.drained(), volumes, &effective)
}

/// Complementary energy per volume (J/m3) of a stress in a medium with a bulk and a shear modulus (Pa).
#[inline(always)]
pub(super) fn complementary_density<L: BatchLane>([bulk, shear]: [f64; 2], stress: &[L; 6]) -> L {
    let [xx, yy, zz, xy, yz, zx] = *stress;
    let distortion = xx.constant(1.0 / (4.0 * shear));
    let dilatation = xx.constant(1.0 / (18.0 * bulk));
    let trace = xx + yy + zz;
    let mean = trace * trace.constant(1.0 / 3.0);
    let (x, y, z) = (xx - mean, yy - mean, zz - mean);
    let normal = x.mul_add(x, y.mul_add(y, z * z));
    let sides = xy.mul_add(xy, yz.mul_add(yz, zx * zx));
    distortion * (normal + (sides + sides)) + dilatation * (trace * trace)
}

/// Strains one step (s) before some, which change at some rates (1/s).
#[inline(always)]
pub(super) fn earlier<L: BatchLane, const P: usize>(
    step: f64,
    strains: &[Strain<L>; P],
    rates: &[Strain<L>; P],
) -> [Strain<L>; P] {
    let back = strains[0].0[0].constant(-step);
    let mut before = *strains;
    for p in 0..P {
        for i in 0..6 {
            before[p].0[i] = rates[p].0[i].mul_add(back, before[p].0[i]);
        }
    }
    before
}

/// Stores stresses as those of the previous step for [`step_work`].
#[inline(always)]
pub(super) fn write_all<L: BatchLane<Scalar = S>, S: BatchScalar, const P: usize>(
    stresses: &[Stress<L>; P],
    stored: &mut [S],
) {
    for p in 0..P {
        for i in 0..6 {
            stresses[p].0[i].store(&mut stored[(6 * p + i) * L::WIDTH..]);
        }
    }
}

/// Work of a step, `1/2 sum_p (sigma_0 + sigma_1) : rate dt V`, with the stresses before it from `stored`
/// (six numbers per point), which those after it replace.
#[inline(always)]
pub(super) fn step_work<L: BatchLane<Scalar = S>, S: BatchScalar, const P: usize>(
    geometry: &Geometry<L>,
    step: f64,
    volumes: &[L; P],
    stresses: &[Stress<L>; P],
    rates: &[Strain<L>; P],
    stored: &mut [S],
) -> L {
    let mut sum = geometry.constant(0.0);
    for p in 0..P {
        let mut both = stresses[p];
        for i in 0..6 {
            let index = (6 * p + i) * L::WIDTH;
            let before = L::load(sum.token(), &stored[index..]);
            both.0[i].store(&mut stored[index..]);
            both.0[i] = both.0[i] + before;
        }
        sum = both.work(&rates[p]).mul_add(volumes[p], sum);
    }
    sum * geometry.constant(0.5 * step)
}

/// Check that all stresses are finite: zero as long as they are, NaN afterwards.
#[derive(Clone, Copy)]
pub(super) struct FiniteCheck<L>(pub(super) L);

impl<L: BatchLane> FiniteCheck<L> {
    #[inline(always)]
    pub(super) fn add(&mut self, stress: &Stress<L>) {
        let sum = stress.0[0] + stress.0[1] + stress.0[2];
        self.0 = sum.mul_add(sum.constant(0.0), self.0);
    }
    /// The same of modal forces.
    #[inline(always)]
    pub(super) fn add_forces<const N: usize>(&mut self, forces: &[[L; 3]; N]) {
        let mut sum = forces[0];
        for force in &forces[1..] {
            for i in 0..3 {
                sum[i] = sum[i] + force[i];
            }
        }
        self.add(&Stress([sum[0], sum[1], sum[2], sum[0], sum[0], sum[0]]));
    }
    #[inline(always)]
    pub(super) fn all_finite(self) -> bool {
        let mut lanes = [L::Scalar::default(); MOST_LANES];
        self.0.store(&mut lanes);
        lanes.iter().all(|&lane| lane == L::Scalar::default())
    }
}
