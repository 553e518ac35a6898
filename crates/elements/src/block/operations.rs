//! Force evaluation of all batches of a block: elastic, and with a law.

use powerhouse_model::{
    ElasticDomain, ElementKernel, Geometry, Hourglass, KernelArithmetic, LawEnergy, NodalView,
    NodalViewMut, Quad, RemainingStiffness, Strain, Stress,
};

use super::account::{PreviousStep, StepSums};
use super::batches::Batches;
use super::exchange::{Exchange, POINTS, PointBuffers};
use super::law::{BatchLaw, Energies, Evaluation, HistoryAccess, RemainingOutput};
use super::locations::Locations;
use super::memory::as_lanes;
use super::numbers::Aligned;
use super::own::MOST_OWN;
use super::survey::{
    FiniteCheck, Summary, Survey, complementary_energy, each_lane, linear_energy, saturated_energy,
    write_mean,
};
use super::transfer::{gather, scatter};
use crate::lanes::{BatchLane, BatchOperation, BatchScalar, Lanes, MOST_LANES};

/// Elastic constants of the undamaged material (Pa).
#[derive(Clone, Copy, Debug)]
pub(super) struct Moduli {
    pub(super) lambda: f64,
    pub(super) shear: f64,
    /// The first of them without the stiffness of water in pores, and that stiffness (zero where there is no water).
    pub(super) skeleton: f64,
    pub(super) water: f64,
    /// Whether the water flows in static states.
    pub(super) is_drained: bool,
    /// Hourglass moduli of the undamaged material, zero if there are no hourglass forces.
    pub(super) hourglass: [f64; 3],
}

impl Moduli {
    /// The moduli in static states: without water in pores, unless it cannot flow in them.
    #[inline(always)]
    pub(super) fn at_rest(self) -> Self {
        if self.is_drained {
            self.drained()
        } else {
            self
        }
    }
    /// The moduli without water in pores.
    #[inline(always)]
    pub(super) fn drained(self) -> Self {
        Self {
            lambda: self.skeleton,
            water: 0.0,
            ..self
        }
    }
    /// Whether there are hourglass forces.
    #[inline(always)]
    pub(super) fn resist(&self) -> bool {
        self.hourglass[0] != 0.0
    }
    /// Hourglass moduli in lanes.
    #[inline(always)]
    pub(super) fn hourglass<L: BatchLane>(&self, token: L::Token) -> [L; 3] {
        let [a, b, c] = self.hourglass;
        [L::splat(token, a), L::splat(token, b), L::splat(token, c)]
    }
}

/// Elastic forces of a displacement by local node index; returns whether all is finite.
pub(super) struct Elastic<'a, K, S, const N: usize, const P: usize> {
    pub(super) kernel: &'a K,
    pub(super) batches: Batches<'a, S, N>,
    pub(super) moduli: Moduli,
    pub(super) nodes: &'a [Quad<f64>],
    /// Output, if required: forces by local node index.
    pub(super) out: Option<NodalViewMut<'a>>,
    /// Output, if required: one summary per element.
    pub(super) survey: Option<&'a mut [Summary]>,
}

impl<K, S, const N: usize, const P: usize> BatchOperation<S> for Elastic<'_, K, S, N, P>
where
    K: ElementKernel<N, P>,
    S: BatchScalar,
{
    type Output = bool;
    #[inline(always)]
    fn run<L: BatchLane<Scalar = S>>(mut self, token: L::Token) -> bool {
        let lambda = L::splat(token, self.moduli.lambda);
        let shear = L::splat(token, self.moduli.shear);
        let hourglass = Hourglass::new(self.moduli.hourglass::<L>(token));
        let mut rows = Aligned([[[S::default(); 4]; MOST_LANES]; N]);
        let mut nodal = [[L::splat(token, 0.0); 3]; N];
        let mut check = FiniteCheck(L::splat(token, 0.0));
        let connectivity = self.batches.connectivity;
        let nodes = connectivity.over(self.nodes);
        for index in 0..self.batches.count(L::WIDTH) {
            let batch = self
                .batches
                .batch(index, L::WIDTH, self.kernel.geometry_len());
            let geometry = Geometry::new(token, as_lanes::<L>(token, batch.geometry));
            gather::<f64, L, N>(token, nodes.elements(batch.first, L::WIDTH), &mut nodal);
            let modes = self.kernel.modes(&nodal);
            let short = (self.kernel).elastic_forces(geometry, [lambda, shear], &modes);
            let forces = match short {
                // Strains and stresses are not computed.
                Some(forces) if self.survey.is_none() => {
                    check.add_forces(&forces);
                    forces
                }
                short => {
                    let strains = self.kernel.strains(geometry, &modes);
                    let mut stresses = [Stress::zero(token); P];
                    for p in 0..P {
                        stresses[p] = Stress::elastic(lambda, shear, &strains[p]);
                        check.add(&stresses[p]);
                    }
                    if let Some(survey) = self.survey.as_deref_mut() {
                        let volumes = self.kernel.volumes(geometry);
                        write_mean(&volumes, &stresses, &batch, survey);
                        let energy = linear_energy(&volumes, &stresses, &strains);
                        each_lane(energy, &batch, |e, energy| survey[e].elastic = energy);
                        let energy = self.kernel.hourglass_energy(geometry, &hourglass, &modes);
                        if let Some(energy) = energy {
                            each_lane(energy, &batch, |e, energy| survey[e].hourglass = energy);
                        }
                    }
                    match short {
                        Some(forces) => forces,
                        None => (self.kernel).forces(geometry, &stresses, &hourglass, &modes),
                    }
                }
            };
            let forces = self.kernel.nodal_forces(&forces);
            if let Some(out) = &mut self.out {
                scatter::<L, N>(&forces, &batch, &mut rows.0, (connectivity, out));
            }
        }
        check.all_finite()
    }
}

/// Input of a law besides strain and history, for whole batches.
#[derive(Clone, Copy)]
pub(super) struct LawState<'a, S> {
    /// Six initial stresses per element (Pa), or empty.
    pub(super) initial: &'a [S],
    /// Six numbers of the extents per element (m2), or those of one batch if all elements are alike.
    pub(super) extents: &'a [S],
}

/// Velocities, for stiffness damping and for the work of a step.
pub(super) struct Rates<'a, S> {
    /// Length of the step (s).
    pub(super) step: f64,
    /// Velocity by local node index (m/s).
    pub(super) velocity: NodalView<'a>,
    /// Stiffness damping coefficient (s).
    pub(super) damping: f64,
    /// Energy bookkeeping of the step, if it is required.
    pub(super) bookkeeping: Option<EnergyBookkeeping<'a, S>>,
}

/// Energy bookkeeping of a step: the increments of energy of the elements that may dissipate.
///
/// It leaves out batches inside their elastic domain at the end of this step and of the previous one, of which
/// the work of a step is the increment of their stored energy.
pub(super) struct EnergyBookkeeping<'a, S> {
    /// State at the previous step.
    pub(super) previous: PreviousStep<'a, S>,
    /// Energies of the step.
    pub(super) sums: &'a mut StepSums,
}

/// Source of the stresses of a batch.
pub(super) enum Response<L, const P: usize> {
    /// Hooke's law, inside the elastic domain.
    Elastic,
    /// The law, without energies.
    Law,
    /// The law, with the work of the step alone.
    LawWithWork,
    /// The law, with energies if it has them, and whether they are all.
    LawWithEnergies(Option<[LawEnergy<L>; P]>, bool),
}

/// What the forces of a step depend on beside the motion: length of the step and coefficient of stiffness damping (s), and
/// whether the body rests; and whether the step is shown.
#[derive(Clone, Copy)]
pub(super) struct StepTerms {
    pub(super) step: f64,
    pub(super) damping: f64,
    pub(super) rests: bool,
    pub(super) shown: bool,
}

/// Static state of elements with histories of their own: displacement of the last committed one, if it is known, and whether
/// these histories are brought to equilibrium.
#[derive(Clone, Copy, Default)]
pub(super) struct Rest<'a> {
    pub(super) still: Option<&'a [Quad<f64>]>,
    pub(super) relaxes: bool,
}

/// Changes of stress of a batch, their source, and the remaining stiffness if it is required.
pub(super) struct BatchStress<L, const P: usize> {
    pub(super) changes: [Stress<L>; P],
    pub(super) response: Response<L, P>,
    pub(super) remaining: Option<[RemainingStiffness<L>; P]>,
    /// Own history with which the step began.
    pub(super) own: [L; MOST_OWN],
}

/// Output of a law that is required besides stresses.
#[derive(Clone, Copy)]
pub(super) struct Required {
    energy: bool,
    /// Whether the work of the step is required.
    work: bool,
    /// Whether stiffness damping acts, or the element's own history follows plastic flow, which require all of the
    /// remaining stiffness.
    all: bool,
    /// Whether hourglass forces act, which require the hourglass share of the remaining stiffness.
    hourglass: bool,
}

/// Forces of a nonlinear law; returns whether all is finite.
pub(super) struct Material<'a, K, S: BatchScalar, const N: usize, const P: usize> {
    pub(super) kernel: &'a K,
    pub(super) law: &'a dyn BatchLaw<S>,
    /// Elastic domain, in which the law need not be evaluated.
    pub(super) domain: Option<&'a ElasticDomain>,
    pub(super) lanes: Lanes,
    pub(super) batches: Batches<'a, S, N>,
    pub(super) moduli: Moduli,
    pub(super) state: LawState<'a, S>,
    /// Locations of the integration points, if the law uses them.
    pub(super) locations: Option<&'a Locations<S>>,
    pub(super) history: HistoryAccess<'a, S>,
    pub(super) exchange: &'a mut Exchange<S>,
    pub(super) nodes: &'a [Quad<f64>],
    /// Displacement of the last committed static state, from which own histories follow, by local node index.
    pub(super) still: Option<&'a [Quad<f64>]>,
    /// Whether own histories are brought to equilibrium within their elements: in static states that are stored.
    pub(super) relaxes: bool,
    pub(super) rates: Option<Rates<'a, S>>,
    /// Output, if required: forces by local node index.
    pub(super) out: Option<NodalViewMut<'a>>,
    /// Output, if required: one summary per element.
    pub(super) survey: Option<Survey<'a>>,
}

impl<K, S, const N: usize, const P: usize> BatchOperation<S> for Material<'_, K, S, N, P>
where
    K: ElementKernel<N, P>,
    S: BatchScalar,
{
    type Output = bool;
    #[inline(always)]
    fn run<L: BatchLane<Scalar = S>>(mut self, token: L::Token) -> bool {
        let mut rows = Aligned([[[S::default(); 4]; MOST_LANES]; N]);
        let mut check = FiniteCheck(L::splat(token, 0.0));
        let rates = self.rates.as_ref();
        let bookkeeping = rates.and_then(|rates| rates.bookkeeping.as_ref());
        let required = Required {
            energy: self.survey.is_some() || bookkeeping.is_some_and(|of| of.sums.requires_stored),
            work: bookkeeping.is_some(),
            all: rates.is_some_and(|rates| rates.damping != 0.0)
                || (self.moduli.resist() && self.kernel.own_history() > 0),
            hourglass: self.moduli.resist(),
        };
        let of_spared = self.survey.as_ref().is_some_and(|survey| survey.of_spared);
        let count = self.batches.count(L::WIDTH);
        let at_once = if self.law.takes_blocks() {
            P * count
        } else {
            POINTS
        };
        let capacity = self.exchange.prepare((N, P), L::WIDTH, at_once);
        // Number of the last batches for which the law is still to be evaluated.
        let mut pending = 0;
        for index in 0..count {
            let (modes, strains, own) = self.deformed::<L>(token, index);
            let mut elastic = self.elastic_response::<L>(index, &strains);
            let by_law = elastic.is_some() == of_spared;
            if of_spared {
                elastic = None;
            }
            let mut end = index;
            if by_law {
                self.exchange
                    .store::<L, N, P>(token, pending, &modes, &strains);
                if self.kernel.own_history() > 0 {
                    self.exchange.store_own::<L>(token, pending, &own);
                }
                pending += 1;
                end += 1;
            }
            let mut of_law = 0;
            let mut has_energies = Energies::None;
            if pending == capacity || (pending > 0 && (!by_law || end == count)) {
                of_law = core::mem::take(&mut pending);
                has_energies = self.evaluate::<L>(end - of_law, of_law, required);
                if self.relaxes {
                    self.relax::<L>(token, end - of_law, of_law, required);
                }
            }
            // The batches of the law, then this one if it is elastic: the code that finishes a batch is in the
            // function once, which halves its compilation.
            let finished = of_law + usize::from(elastic.is_some());
            for batch in 0..finished {
                let (mut modes, mut own) = (modes, own);
                let stress = match elastic {
                    Some(changes) if batch == of_law => BatchStress {
                        changes,
                        response: Response::Elastic,
                        remaining: None,
                        own,
                    },
                    _ => {
                        modes = self.exchange.modes::<L, N>(token, batch);
                        let (changes, energies) = self.exchange.response::<L, P>(
                            token,
                            batch,
                            has_energies != Energies::None,
                        );
                        let response = if required.energy {
                            Response::LawWithEnergies(energies, has_energies == Energies::All)
                        } else if required.work {
                            Response::LawWithWork
                        } else {
                            Response::Law
                        };
                        let remaining = if required.all || required.hourglass {
                            Some(self.exchange.remaining::<L, P>(token, batch))
                        } else {
                            None
                        };
                        if self.kernel.own_history() > 0 {
                            own = self.exchange.own::<L>(token, batch);
                        }
                        BatchStress {
                            changes,
                            response,
                            remaining,
                            own,
                        }
                    }
                };
                let index = end - of_law + batch;
                self.finish::<L>(index, modes, stress, &mut rows.0, &mut check);
            }
        }
        check.all_finite()
    }
}

impl<K, S, const N: usize, const P: usize> Material<'_, K, S, N, P>
where
    K: ElementKernel<N, P>,
    S: BatchScalar,
{
    /// Modal displacements, strains and own history of a batch.
    #[inline(always)]
    fn deformed<L: BatchLane<Scalar = S>>(
        &self,
        token: L::Token,
        index: usize,
    ) -> ([[L; 3]; N], [Strain<L>; P], [L; MOST_OWN]) {
        let batch = (self.batches).batch(index, L::WIDTH, self.kernel.geometry_len());
        let geometry = Geometry::new(token, as_lanes::<L>(token, batch.geometry));
        let nodes = self.batches.connectivity.over(self.nodes);
        let mut nodal = [[L::splat(token, 0.0); 3]; N];
        gather::<f64, L, N>(token, nodes.elements(batch.first, L::WIDTH), &mut nodal);
        let modes = self.kernel.modes(&nodal);
        let mut strains = self.kernel.strains(geometry, &modes);
        let own = self.own_at_start(L::splat(token, 0.0), index);
        let count = self.kernel.own_history();
        if count > 0 {
            (self.kernel).add_own_strains(geometry, &own[..count], &mut strains);
        }
        (modes, strains, own)
    }

    /// Initial stress of a batch.
    #[inline(always)]
    pub(super) fn initial_stress<L: BatchLane<Scalar = S>>(
        &self,
        zero: L,
        batch: usize,
    ) -> Stress<L> {
        let mut initially = Stress([zero; 6]);
        if let Some(initial) = self.state.initial.get(6 * batch * L::WIDTH..)
            && !initial.is_empty()
        {
            for i in 0..6 {
                initially.0[i] = L::load(zero.token(), &initial[i * L::WIDTH..]);
            }
        }
        initially
    }

    /// Changes of stress of a virgin batch inside the elastic domain, for which the law need not be evaluated.
    #[inline(always)]
    fn elastic_response<L: BatchLane<Scalar = S>>(
        &mut self,
        batch: usize,
        strains: &[Strain<L>; P],
    ) -> Option<[Stress<L>; P]> {
        let domain = self.domain?;
        if let HistoryAccess::Write(history) = &mut self.history {
            history.discard_trial(batch);
        }
        if !self.history.get().is_virgin(batch) {
            return None;
        }
        let zero = strains[0].0[0].constant(0.0);
        let (lambda, shear) = (
            zero.constant(self.moduli.skeleton),
            zero.constant(self.moduli.shear),
        );
        let initially = self.initial_stress(zero, batch);
        let mut changes = [initially; P];
        for p in 0..P {
            changes[p] = Stress::elastic(lambda, shear, &strains[p]);
            if !domain.contains(&(initially + changes[p])) {
                return None;
            }
        }
        if self.moduli.water != 0.0 {
            for p in 0..P {
                let excess = self.raise_pressure(batch, p, &strains[p]);
                for i in 0..3 {
                    changes[p].0[i] = changes[p].0[i] - excess;
                }
            }
        }
        Some(changes)
    }

    /// Evaluates the law for successive batches, whose strains are in the exchange buffers, with the required
    /// output; writes new history variables. Returns which of the energies the law has, if they are required.
    #[inline(always)]
    pub(super) fn evaluate<L: BatchLane<Scalar = S>>(
        &mut self,
        first: usize,
        count: usize,
        required: Required,
    ) -> Energies {
        let initial = self.state.initial;
        let PointBuffers {
            strains,
            stresses,
            energies,
            remaining,
        } = self.exchange.of_points(P * count, L::WIDTH);
        let remaining = if required.all || required.hourglass {
            Some(RemainingOutput {
                numbers: remaining,
                all: required.all,
            })
        } else {
            None
        };
        self.law.evaluate(
            self.lanes,
            Evaluation {
                first,
                points: P,
                strains,
                initial: (!initial.is_empty()).then(|| &initial[6 * first * L::WIDTH..]),
                extents: self.state.extents,
                locations: self.locations,
                history: &mut self.history,
                stresses,
                energies: if required.energy {
                    Some(energies)
                } else {
                    None
                },
                remaining,
            },
        )
    }
}

/// Energies of a batch in a step (J).
pub(super) struct Energy<L> {
    /// Energies of all points of an element.
    pub(super) sum: LawEnergy<L>,
    /// Whether they are the law's own; otherwise they are the stored energy of an undamaged medium.
    pub(super) of_law: bool,
}

impl<L: BatchLane> Energy<L> {
    /// Integrates the energies of the points.
    /// Without closures, which could be compiled on their own, without the instructions of the lane.
    #[inline(always)]
    pub(super) fn over<const P: usize>(
        points: &[LawEnergy<L>; P],
        of_law: bool,
        volumes: &[L; P],
    ) -> Self {
        let mut sum = LawEnergy::stored(volumes[0].constant(0.0));
        for (point, &volume) in points.iter().zip(volumes) {
            sum.stored = point.stored.mul_add(volume, sum.stored);
            sum.plastic = point.plastic.mul_add(volume, sum.plastic);
            sum.damage = point.damage.mul_add(volume, sum.damage);
            sum.recovered = point.recovered.mul_add(volume, sum.recovered);
        }
        Self { sum, of_law }
    }
    /// None, of a step in which the stored energy of a law that has no other is not required.
    #[inline(always)]
    pub(super) fn not_required(zero: L) -> Self {
        let sum = LawEnergy::stored(zero);
        Self { sum, of_law: true }
    }
    /// The energy that an undamaged medium stores at changes of stress (Pa), total ones where there is water in its pores, with
    /// the pressures of the water beyond those at rest (Pa).
    #[inline(always)]
    pub(super) fn of_stresses<const P: usize>(
        moduli: Moduli,
        volumes: &[L; P],
        stresses: &[Stress<L>; P],
        water: Option<&[L; P]>,
    ) -> Self {
        let stored = match water {
            Some(water) => saturated_energy(moduli, volumes, stresses, water),
            None => complementary_energy(moduli, volumes, stresses),
        };
        Self {
            sum: LawEnergy::stored(stored),
            of_law: false,
        }
    }
}
