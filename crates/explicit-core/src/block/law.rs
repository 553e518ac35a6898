//! Laws with their type erased: one call for all points of some batches.
//!
//! Kernels are compiled once and laws once, instead of every law into every kernel. A call is for
//! some batches; strains and stresses pass through an [`Exchange`](super::exchange::Exchange).

use std::sync::Arc;

use powerhouse_model::{
    ConstitutiveLaw, ElasticDomain, ElasticMedium, Extents, HistoryVariable, LawEnergy, LawInput,
    ModelError, Scalar, Strain, Stress, point_stress_change,
};

use super::exchange::REMAINING;
use super::history::History;
use super::memory::{as_lanes, as_lanes_mut};
use super::numbers::Aligned;
use crate::lanes::{BatchLane, BatchOperation, BatchScalar, Lanes};

/// How many batches ahead of their use histories are asked for.
const AHEAD: usize = 4;

/// Histories of up to so many variables stay on the stack at a small price.
const USUAL_VARIABLES: usize = 24;
/// Those of up to so many at a larger one: what yields and is damped.
const MANY_VARIABLES: usize = 48;

/// What is done with the history.
pub(crate) enum Memory<'a, S> {
    /// The committed one stays the only one.
    Read(&'a History<S>),
    /// The new one is kept beside it.
    Write(&'a mut History<S>),
}

impl<S> Memory<'_, S> {
    #[inline(always)]
    pub(super) fn get(&self) -> &History<S> {
        match self {
            Self::Read(history) => history,
            Self::Write(history) => history,
        }
    }
}

/// What a law is asked for successive batches.
pub(crate) struct Question<'a, 'm, S> {
    /// The first batch.
    pub(super) first: usize,
    /// Points of a batch.
    pub(super) points: usize,
    /// Six strains of each point of each batch in lanes.
    pub(super) strains: &'a [S],
    /// Six initial stresses (Pa) of each batch in lanes, or nothing.
    pub(super) initial: Option<&'a [S]>,
    /// Six numbers of the extents (m2) of each element of all batches, or of one batch if all elements
    /// are alike, in lanes.
    pub(super) extents: &'a [S],
    /// The histories.
    pub(super) memory: &'a mut Memory<'m, S>,
    /// Where the six changes of stress go likewise (Pa).
    pub(super) stresses: &'a mut [S],
    /// Where stored, plastic, damage and recovered energy go likewise (J/m3), if wanted.
    pub(super) energies: Option<&'a mut [S]>,
    /// Where what is left of the stiffness goes likewise, if wanted.
    pub(super) remaining: Option<Wanted<'a, S>>,
}

/// Where numbers of a [`RemainingStiffness`] go.
pub(super) struct Wanted<'a, S> {
    pub(super) numbers: &'a mut [S],
    /// Whether all of them are wanted, or that of the path alone.
    pub(super) all: bool,
}

/// What does not depend on the scalar.
pub(crate) trait LawParts: Send + Sync {
    fn medium(&self) -> ElasticMedium;
    fn history(&self) -> &[HistoryVariable];
    fn accept_size(&self, size: f64) -> Result<(), ModelError>;
    fn stress_change(&self, input: &LawInput<f64>, new_history: &mut [f64]) -> Stress;
    fn of_path(&self, input: &LawInput<f64>, new_history: &[f64], change: &Stress) -> f64;
    fn tangent(&self, input: &LawInput<f64>) -> Option<[[f64; 6]; 6]>;
    fn relaxes(&self) -> bool;
    fn elastic_domain(&self) -> Option<ElasticDomain>;
}

/// A law for batches in a scalar.
pub(crate) trait BatchLaw<S>: LawParts {
    /// Answers; yields whether energies were told.
    fn answer(&self, lanes: Lanes, question: Question<S>) -> bool;
    /// The same in steps of a length (s).
    fn for_step(&self, length: f64) -> Arc<dyn BatchLaw<S>>;
}

/// A law for batches in either scalar.
pub(crate) trait AnyLaw: BatchLaw<f64> + BatchLaw<f32> {}

impl<M: ConstitutiveLaw> AnyLaw for M {}

impl<M: ConstitutiveLaw> LawParts for M {
    fn medium(&self) -> ElasticMedium {
        ConstitutiveLaw::medium(self)
    }
    fn history(&self) -> &[HistoryVariable] {
        ConstitutiveLaw::history(self)
    }
    fn accept_size(&self, size: f64) -> Result<(), ModelError> {
        ConstitutiveLaw::accept_size(self, size)
    }
    fn stress_change(&self, input: &LawInput<f64>, new_history: &mut [f64]) -> Stress {
        point_stress_change(self, input, new_history)
    }
    fn of_path(&self, input: &LawInput<f64>, new_history: &[f64], change: &Stress) -> f64 {
        ConstitutiveLaw::remaining_stiffness(self, input, new_history, change).of_path
    }
    fn tangent(&self, input: &LawInput<f64>) -> Option<[[f64; 6]; 6]> {
        ConstitutiveLaw::tangent(self, input)
    }
    fn relaxes(&self) -> bool {
        ConstitutiveLaw::relaxes(self)
    }
    fn elastic_domain(&self) -> Option<ElasticDomain> {
        ConstitutiveLaw::elastic_domain(self)
    }
}

impl<M: ConstitutiveLaw, S: BatchScalar> BatchLaw<S> for M {
    fn answer(&self, lanes: Lanes, question: Question<S>) -> bool {
        lanes.dispatch(Answer {
            law: self,
            question,
        })
    }
    fn for_step(&self, length: f64) -> Arc<dyn BatchLaw<S>> {
        Arc::new(ConstitutiveLaw::for_step(self, length))
    }
}

struct Answer<'a, 'm, M, S> {
    law: &'a M,
    question: Question<'a, 'm, S>,
}

impl<M: ConstitutiveLaw, S: BatchScalar> BatchOperation<S> for Answer<'_, '_, M, S> {
    type Output = bool;
    #[inline(always)]
    fn run<L: BatchLane<Scalar = S>>(self, token: L::Token) -> bool {
        let zero = L::splat(token, 0.0);
        let variables = self.question.memory.get().variables();
        let (mut usual, mut many, mut any);
        let [blank, staged]: [&mut [L]; 2] = if variables <= USUAL_VARIABLES {
            usual = Aligned([[zero; USUAL_VARIABLES]; 2]);
            usual.0.each_mut().map(|numbers| &mut numbers[..variables])
        } else if variables <= MANY_VARIABLES {
            many = Aligned([[zero; MANY_VARIABLES]; 2]);
            many.0.each_mut().map(|numbers| &mut numbers[..variables])
        } else {
            any = [(); 2].map(|()| vec![zero; variables]);
            any.each_mut().map(Vec::as_mut_slice)
        };
        self.all_points(token, blank, staged)
    }
}

impl<M: ConstitutiveLaw, S: BatchScalar> Answer<'_, '_, M, S> {
    /// Asks the law point by point; points without a history have the blank one, and new histories that
    /// may not have to be stored are staged.
    #[inline(always)]
    fn all_points<L: BatchLane<Scalar = S>>(
        self,
        token: L::Token,
        blank: &[L],
        staged: &mut [L],
    ) -> bool {
        let Question {
            first,
            points,
            strains,
            initial,
            extents,
            memory,
            stresses,
            energies,
            remaining,
        } = self.question;
        let (strains, _) = as_lanes::<L>(token, strains).as_chunks::<6>();
        let (stresses, _) = as_lanes_mut::<L>(token, stresses).as_chunks_mut::<6>();
        #[expect(clippy::manual_map, reason = "a closure may be compiled on its own")]
        let mut energies = match energies {
            Some(energies) => Some(as_lanes_mut::<L>(token, energies).as_chunks_mut::<4>().0),
            None => None,
        };
        let (mut remaining, all) = match remaining {
            Some(Wanted { numbers, all }) => {
                let (places, _) = as_lanes_mut::<L>(token, numbers).as_chunks_mut::<REMAINING>();
                (Some(places), all)
            }
            None => (None, false),
        };
        let mut initially = Stress::zero(token);
        let mut told = false;
        let writes = matches!(memory, Memory::Write(_));
        let length = blank.len() * L::WIDTH;
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
            if let Memory::Write(history) = &mut *memory {
                history.retry(batch);
            }
            let mut changed = false;
            for p in 0..points {
                let (committed, next) = match &mut *memory {
                    Memory::Read(history) => (history.committed(batch), None),
                    Memory::Write(history) => history.both(batch),
                };
                let here = p * length..(p + 1) * length;
                let old = match committed {
                    Some(numbers) => as_lanes::<L>(token, &numbers[here.clone()]),
                    None => blank,
                };
                let is_staged = next.is_none();
                let new = match next {
                    Some(numbers) => as_lanes_mut::<L>(token, &mut numbers[here]),
                    None => &mut *staged,
                };
                let input = LawInput::new(Strain(strains[p]), old)
                    .with_initial(initially)
                    .with_extents(widths);
                let place = b * points + p;
                let change = L::stress_change(self.law, &input, new);
                stresses[place] = change.0;
                if let Some(remaining) = remaining.as_deref_mut() {
                    let left = L::remaining_stiffness(self.law, &input, new, &change);
                    remaining[place][1] = left.of_path;
                    if all {
                        remaining[place][0] = left.undamaged;
                        for i in 0..6 {
                            remaining[place][2 + i] = left.flowed[i];
                        }
                    }
                }
                if let Some(energies) = energies.as_deref_mut()
                    && let Some(energy) = L::energy(self.law, &input, new)
                {
                    let LawEnergy {
                        stored,
                        plastic,
                        damage,
                        recovered,
                    } = energy;
                    energies[place] = [stored, plastic, damage, recovered];
                    told = true;
                }
                changed = changed || (writes && differ(old, new));
                if let (true, Memory::Write(history)) = (changed, &mut *memory) {
                    if is_staged {
                        history.take(batch, p, staged);
                    } else {
                        history.took(batch);
                    }
                }
            }
            memory.get().ask_ahead(batch + AHEAD);
        }
        told
    }
}

/// Whether any lane of any number differs, or is not a number.
///
/// Where a law changes anything it mostly changes its first variable, so that one is looked at alone.
#[inline(always)]
fn differ<L: BatchLane>(old: &[L], new: &[L]) -> bool {
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
