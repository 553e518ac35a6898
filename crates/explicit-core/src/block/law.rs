//! Laws with their type erased: one call for all points of some batches.
//!
//! Kernels are compiled once and laws once, instead of every law into every kernel. A call is for
//! some batches; strains and stresses pass through the nearest cache.

use std::sync::Arc;

use powerhouse_model::{
    ConstitutiveLaw, ElasticDomain, ElasticMedium, HistoryVariable, LawEnergy, LawInput,
    ModelError, Strain, Stress, point_stress_change,
};

use super::history::History;
use super::numbers::Aligned;
use crate::lanes::{BatchLane, BatchOperation, BatchScalar, Lanes, MOST_LANES};

/// Numbers of the lanes of a batch at one point, `C` in each lane.
pub(super) type PointNumbers<S, const C: usize> = [[S; MOST_LANES]; C];

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
    /// Strains, batch by batch and point by point.
    pub(super) strains: &'a [PointNumbers<S, 6>],
    /// Six initial stresses (Pa) of each batch in lanes, or nothing.
    pub(super) initial: Option<&'a [S]>,
    /// Widths of the elements of each batch (m).
    pub(super) sizes: &'a [S],
    /// The histories.
    pub(super) memory: &'a mut Memory<'m, S>,
    /// Where the changes of stress go (Pa), point by point.
    pub(super) stresses: &'a mut [PointNumbers<S, 6>],
    /// Where stored, plastic, damage and recovered energy go (J/m3), point by point, if wanted.
    pub(super) energies: Option<&'a mut [PointNumbers<S, 4>]>,
}

/// What does not depend on the scalar.
pub(crate) trait LawParts: Send + Sync {
    fn medium(&self) -> ElasticMedium;
    fn history(&self) -> &[HistoryVariable];
    fn accept_size(&self, size: f64) -> Result<(), ModelError>;
    fn stress_change(&self, input: &LawInput<f64>, new_history: &mut [f64]) -> Stress;
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
        let [old, new]: [&mut [L]; 2] = if variables <= USUAL_VARIABLES {
            usual = Aligned([[zero; USUAL_VARIABLES]; 2]);
            usual.0.each_mut().map(|numbers| &mut numbers[..variables])
        } else if variables <= MANY_VARIABLES {
            many = Aligned([[zero; MANY_VARIABLES]; 2]);
            many.0.each_mut().map(|numbers| &mut numbers[..variables])
        } else {
            any = [(); 2].map(|()| vec![zero; variables]);
            any.each_mut().map(Vec::as_mut_slice)
        };
        self.all_points(token, old, new)
    }
}

impl<M: ConstitutiveLaw, S: BatchScalar> Answer<'_, '_, M, S> {
    /// Asks the law point by point; the old history is zero.
    #[inline(always)]
    fn all_points<L: BatchLane<Scalar = S>>(
        self,
        token: L::Token,
        old: &mut [L],
        new: &mut [L],
    ) -> bool {
        let Question {
            first,
            points,
            strains,
            initial,
            sizes,
            memory,
            stresses,
            mut energies,
        } = self.question;
        let zero = L::splat(token, 0.0);
        let mut initially = Stress::zero(token);
        // Whether the old history is still all zero.
        let mut blank = true;
        let mut told = false;
        for (b, strains) in strains.chunks_exact(points).enumerate() {
            let batch = first + b;
            if let Some(initial) = initial {
                for i in 0..6 {
                    initially.0[i] = L::load(token, &initial[(6 * b + i) * L::WIDTH..]);
                }
            }
            let size = L::load(token, &sizes[b * L::WIDTH..]);
            if let Memory::Write(history) = &mut *memory {
                history.retry(batch);
            }
            for p in 0..points {
                if let Some(numbers) = memory.get().committed(batch) {
                    let numbers = &numbers[p * old.len() * L::WIDTH..];
                    for (old, numbers) in old.iter_mut().zip(numbers.chunks_exact(L::WIDTH)) {
                        *old = L::load(token, numbers);
                    }
                    blank = false;
                } else if !blank {
                    old.fill(zero);
                    blank = true;
                }
                let mut strain = Strain([size; 6]);
                for i in 0..6 {
                    strain.0[i] = L::load(token, &strains[p][i]);
                }
                let input = LawInput::new(strain, old)
                    .with_initial(initially)
                    .with_size(size);
                let stress = L::stress_change(self.law, &input, new);
                let place = b * points + p;
                for i in 0..6 {
                    stress.0[i].store(&mut stresses[place][i]);
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
                    let parts = [stored, plastic, damage, recovered];
                    for i in 0..4 {
                        parts[i].store(&mut energies[place][i]);
                    }
                    told = true;
                }
                if let Memory::Write(history) = &mut *memory {
                    history.take(batch, p, old, new);
                }
            }
            memory.get().ask_ahead(batch + AHEAD, batch);
        }
        told
    }
}
