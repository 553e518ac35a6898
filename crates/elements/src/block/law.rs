//! Constitutive laws with their type erased: one call for all integration points of some batches.
//!
//! Kernels are compiled once and laws once, instead of every law into every kernel. A call evaluates a law
//! for some batches; strains and stresses pass through an [`Exchange`](super::exchange::Exchange).

use std::sync::Arc;

#[cfg(feature = "programs")]
use powerhouse_model::RemainingStiffness;
use powerhouse_model::{
    ConstitutiveLaw, ElasticDomain, ElasticMedium, Extents, HistoryVariable, LawEnergy, LawInput,
    ModelError, Scalar, Strain, Stress, point_energy, point_stress_change,
};
#[cfg(feature = "programs")]
use powerhouse_program::Traced;

use super::exchange::REMAINING;
use super::history::History;
use super::locations::Locations;
use super::memory::{as_lanes, as_lanes_mut};
use super::numbers::Aligned;
use crate::lanes::{BatchLane, BatchOperation, BatchScalar, Lanes};

/// Number of batches ahead of their use at which histories are prefetched.
const AHEAD: usize = 4;

/// Histories of up to so many variables are kept on the stack at a small cost.
const USUAL_VARIABLES: usize = 24;
/// Histories of up to so many variables, as of a plastic law with damping, at a larger one.
const MANY_VARIABLES: usize = 48;

/// Access of an evaluation to the history variables of a block.
pub(crate) enum HistoryAccess<'a, S> {
    /// Committed history variables are read, new ones are discarded.
    Read(&'a History<S>),
    /// New history variables are stored as trial state.
    Write(&'a mut History<S>),
}

impl<S> HistoryAccess<'_, S> {
    #[inline(always)]
    pub(super) fn get(&self) -> &History<S> {
        match self {
            Self::Read(history) => history,
            Self::Write(history) => history,
        }
    }
}

/// Input and output of the evaluation of a law for successive batches.
pub(crate) struct Evaluation<'a, 'm, S> {
    /// Index of the first batch.
    pub(super) first: usize,
    /// Integration points per element.
    pub(super) points: usize,
    /// Six strains of each point of each batch in lanes.
    pub(super) strains: &'a [S],
    /// Six initial stresses (Pa) of each batch in lanes, or none.
    pub(super) initial: Option<&'a [S]>,
    /// Six numbers of the extents (m2) of each element of all batches, or of one batch if all elements
    /// are alike, in lanes.
    pub(super) extents: &'a [S],
    /// Locations of the points of all batches, if the law uses them.
    pub(super) locations: Option<&'a Locations<S>>,
    /// History variables.
    pub(super) history: &'a mut HistoryAccess<'m, S>,
    /// Output: six changes of stress (Pa) of each point of each batch in lanes.
    pub(super) stresses: &'a mut [S],
    /// Output, if required: stored, plastic, damage and recovered energy (J/m3) likewise.
    pub(super) energies: Option<&'a mut [S]>,
    /// Output, if required: remaining stiffness likewise.
    pub(super) remaining: Option<RemainingOutput<'a, S>>,
}

/// Output of the numbers of a [`RemainingStiffness`].
pub(super) struct RemainingOutput<'a, S> {
    pub(super) numbers: &'a mut [S],
    /// Whether all of them are required, or the hourglass share alone.
    pub(super) all: bool,
}

/// Energies that the evaluation of a law has written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Energies {
    /// None: the stored one is that of an undamaged medium.
    None,
    /// The stored one alone: what the work exceeds it by is plastic.
    Stored,
    /// All.
    All,
}

/// Functions of a law that do not depend on the lane.
pub(crate) trait ErasedLaw: Send + Sync {
    fn name(&self) -> &str;
    fn medium(&self) -> ElasticMedium;
    fn is_linear(&self) -> bool;
    fn history(&self) -> &[HistoryVariable];
    fn uses_location(&self) -> bool;
    #[cfg(feature = "programs")]
    fn is_in_lanes(&self) -> bool;
    /// Whether the law is evaluated for all points of a block at once, and linearised by its medium.
    fn takes_blocks(&self) -> bool {
        false
    }
    fn accept_size(&self, size: f64) -> Result<(), ModelError>;
    fn stress_change(&self, input: &LawInput<f64>, new_history: &mut [f64]) -> Stress;
    fn energy(&self, input: &LawInput<f64>, new_history: &[f64]) -> Option<LawEnergy<f64>>;
    fn hourglass_share(&self, input: &LawInput<f64>, new_history: &[f64], change: &Stress) -> f64;
    fn tangent(&self, input: &LawInput<f64>) -> Option<[[f64; 6]; 6]>;
    fn relaxes(&self) -> bool;
    fn only_stores(&self) -> bool;
    fn elastic_domain(&self) -> Option<ElasticDomain>;
}

/// A law for batches in one scalar type.
pub(crate) trait BatchLaw<S: Scalar>: ErasedLaw {
    /// Evaluates the law; returns which energies it has.
    ///
    /// Points may have further history variables than the law, after its own, which keep their values.
    fn evaluate(&self, lanes: Lanes, evaluation: Evaluation<S>) -> Energies;
    /// The law discretised in time for steps of a length (s).
    fn for_step(&self, length: f64) -> Arc<dyn BatchLaw<S>>;
    /// Records the evaluation of the law at one point: its change of stress and the remaining stiffness.
    #[cfg(feature = "programs")]
    fn record(
        &self,
        input: &LawInput<Traced<S>>,
        new_history: &mut [Traced<S>],
    ) -> (Stress<Traced<S>>, RemainingStiffness<Traced<S>>);
}

/// A law for batches in both scalar types.
pub(crate) trait BatchLaws: BatchLaw<f64> + BatchLaw<f32> {}

impl<M: ConstitutiveLaw> BatchLaws for M {}

impl<M: ConstitutiveLaw> ErasedLaw for M {
    fn name(&self) -> &str {
        ConstitutiveLaw::name(self)
    }
    fn medium(&self) -> ElasticMedium {
        ConstitutiveLaw::medium(self)
    }
    fn is_linear(&self) -> bool {
        ConstitutiveLaw::is_linear(self)
    }
    fn history(&self) -> &[HistoryVariable] {
        ConstitutiveLaw::history(self)
    }
    fn uses_location(&self) -> bool {
        ConstitutiveLaw::uses_location(self)
    }
    #[cfg(feature = "programs")]
    fn is_in_lanes(&self) -> bool {
        ConstitutiveLaw::is_in_lanes(self)
    }
    fn accept_size(&self, size: f64) -> Result<(), ModelError> {
        ConstitutiveLaw::accept_size(self, size)
    }
    fn stress_change(&self, input: &LawInput<f64>, new_history: &mut [f64]) -> Stress {
        point_stress_change(self, input, new_history)
    }
    fn energy(&self, input: &LawInput<f64>, new_history: &[f64]) -> Option<LawEnergy<f64>> {
        point_energy(self, input, new_history)
    }
    fn hourglass_share(&self, input: &LawInput<f64>, new_history: &[f64], change: &Stress) -> f64 {
        ConstitutiveLaw::remaining_stiffness(self, input, new_history, change).hourglass
    }
    fn tangent(&self, input: &LawInput<f64>) -> Option<[[f64; 6]; 6]> {
        ConstitutiveLaw::tangent(self, input)
    }
    fn relaxes(&self) -> bool {
        ConstitutiveLaw::relaxes(self)
    }
    fn only_stores(&self) -> bool {
        ConstitutiveLaw::only_stores(self)
    }
    fn elastic_domain(&self) -> Option<ElasticDomain> {
        ConstitutiveLaw::elastic_domain(self)
    }
}

impl<M: ConstitutiveLaw, S: BatchScalar> BatchLaw<S> for M {
    fn evaluate(&self, lanes: Lanes, evaluation: Evaluation<S>) -> Energies {
        lanes.dispatch(InLanes {
            law: self,
            evaluation,
        })
    }
    fn for_step(&self, length: f64) -> Arc<dyn BatchLaw<S>> {
        Arc::new(ConstitutiveLaw::for_step(self, length))
    }
    #[cfg(feature = "programs")]
    fn record(
        &self,
        input: &LawInput<Traced<S>>,
        new_history: &mut [Traced<S>],
    ) -> (Stress<Traced<S>>, RemainingStiffness<Traced<S>>) {
        let change = ConstitutiveLaw::stress_change(self, input, new_history);
        let remaining = self.remaining_stiffness(input, new_history, &change);
        (change, remaining)
    }
}

/// Evaluation of a law in the lanes of the processor.
struct InLanes<'a, 'm, M, S> {
    law: &'a M,
    evaluation: Evaluation<'a, 'm, S>,
}

impl<M: ConstitutiveLaw, S: BatchScalar> BatchOperation<S> for InLanes<'_, '_, M, S> {
    type Output = Energies;
    #[inline(always)]
    fn run<L: BatchLane<Scalar = S>>(self, token: L::Token) -> Energies {
        let zero = L::splat(token, 0.0);
        let variables = self.evaluation.history.get().variables();
        let (mut usual, mut many, mut any);
        let [virgin, staged]: [&mut [L]; 2] = if variables <= USUAL_VARIABLES {
            usual = Aligned([[zero; USUAL_VARIABLES]; 2]);
            usual.0.each_mut().map(|numbers| &mut numbers[..variables])
        } else if variables <= MANY_VARIABLES {
            many = Aligned([[zero; MANY_VARIABLES]; 2]);
            many.0.each_mut().map(|numbers| &mut numbers[..variables])
        } else {
            any = [(); 2].map(|()| vec![zero; variables]);
            any.each_mut().map(Vec::as_mut_slice)
        };
        self.all_points(token, virgin, staged)
    }
}

impl<M: ConstitutiveLaw, S: BatchScalar> InLanes<'_, '_, M, S> {
    /// Evaluates the law point by point. Points whose history variables are all zero read `virgin`; new
    /// history variables that may not have to be stored are written to `staged` first.
    #[inline(always)]
    fn all_points<L: BatchLane<Scalar = S>>(
        self,
        token: L::Token,
        virgin: &[L],
        staged: &mut [L],
    ) -> Energies {
        let Evaluation {
            first,
            points,
            strains,
            initial,
            extents,
            locations,
            history: access,
            stresses,
            energies,
            remaining,
        } = self.evaluation;
        let (strains, _) = as_lanes::<L>(token, strains).as_chunks::<6>();
        let (stresses, _) = as_lanes_mut::<L>(token, stresses).as_chunks_mut::<6>();
        #[expect(clippy::manual_map, reason = "a closure may be compiled on its own")]
        let mut energies = match energies {
            Some(energies) => Some(as_lanes_mut::<L>(token, energies).as_chunks_mut::<4>().0),
            None => None,
        };
        let (mut remaining, all) = match remaining {
            Some(RemainingOutput { numbers, all }) => {
                let (numbers, _) = as_lanes_mut::<L>(token, numbers).as_chunks_mut::<REMAINING>();
                (Some(numbers), all)
            }
            None => (None, false),
        };
        let mut initially = Stress::zero(token);
        let mut has_energies = false;
        let writes = matches!(access, HistoryAccess::Write(_));
        let length = virgin.len() * L::WIDTH;
        let own = ConstitutiveLaw::history(self.law).len();
        let is_alike = extents.len() == 6 * L::WIDTH;
        for (b, strains) in strains.chunks_exact(points).enumerate() {
            let batch = first + b;
            if let Some(initial) = initial {
                for i in 0..6 {
                    initially.0[i] = L::load(token, &initial[(6 * b + i) * L::WIDTH..]);
                }
            }
            let of_batch = if is_alike { 0 } else { batch };
            let (of_batch, _) = extents[6 * of_batch * L::WIDTH..].split_at(6 * L::WIDTH);
            let mut widths = Extents(initially.0);
            for i in 0..6 {
                widths.0[i] = L::load(token, &of_batch[i * L::WIDTH..]);
            }
            if let HistoryAccess::Write(history) = &mut *access {
                history.discard_trial(batch);
            }
            let mut changed = false;
            for p in 0..points {
                let (committed, next) = match &mut *access {
                    HistoryAccess::Read(history) => (history.committed(batch), None),
                    HistoryAccess::Write(history) => history.committed_and_trial(batch),
                };
                let here = p * length..(p + 1) * length;
                let old = match committed {
                    Some(numbers) => as_lanes::<L>(token, &numbers[here.clone()]),
                    None => virgin,
                };
                let is_staged = next.is_none();
                let new = match next {
                    Some(numbers) => as_lanes_mut::<L>(token, &mut numbers[here]),
                    None => &mut *staged,
                };
                new[own..].copy_from_slice(&old[own..]);
                let mut input = LawInput::new(Strain(strains[p]), &old[..own])
                    .with_initial(initially)
                    .with_extents(widths);
                let location;
                if let Some(locations) = locations {
                    location = locations.in_lanes::<L>(token, batch, p);
                    input = input.with_location(&location);
                }
                let index = b * points + p;
                let change = L::stress_change(self.law, &input, &mut new[..own]);
                stresses[index] = change.0;
                if let Some(remaining) = remaining.as_deref_mut() {
                    let left = L::remaining_stiffness(self.law, &input, &new[..own], &change);
                    remaining[index][1] = left.hourglass;
                    if all {
                        remaining[index][0] = left.undamaged;
                        for i in 0..6 {
                            remaining[index][2 + i] = left.plastic_strain_increment[i];
                        }
                    }
                }
                if let Some(energies) = energies.as_deref_mut()
                    && let Some(energy) = L::energy(self.law, &input, &new[..own])
                {
                    let LawEnergy {
                        stored,
                        plastic,
                        damage,
                        recovered,
                        ..
                    } = energy;
                    energies[index] = [stored, plastic, damage, recovered];
                    has_energies = true;
                }
                changed = changed || (writes && differ(old, new));
                if let (true, HistoryAccess::Write(history)) = (changed, &mut *access) {
                    if is_staged {
                        history.store(batch, p, staged);
                    } else {
                        history.mark_changed(batch);
                    }
                }
            }
            access.get().prefetch(batch + AHEAD);
        }
        if has_energies {
            Energies::All
        } else {
            Energies::None
        }
    }
}

/// Whether any lane of any number differs, or is not a number.
///
/// A law that changes any variable mostly changes its first one, which is therefore compared alone.
#[inline(always)]
pub(super) fn differ<L: BatchLane>(old: &[L], new: &[L]) -> bool {
    let Some(&first) = new.first() else {
        return false;
    };
    let zero = first.constant(0.0);
    // Below the least positive number there is only zero; NaN is not below it.
    let single = L::Scalar::from_f64(f64::from_bits(1)).to_f64() == 0.0;
    let least = first.constant(if single {
        f64::from(f32::from_bits(1))
    } else {
        f64::from_bits(1)
    });
    let one = first.constant(1.0);
    let mut sum = zero;
    for (h, (old, new)) in old.iter().zip(new).enumerate() {
        sum = sum + (*new - *old).abs();
        if h == 0 && first.any(zero.less(zero.select(sum.less(least), one))) {
            return true;
        }
    }
    first.any(zero.less(zero.select(sum.less(least), one)))
}
