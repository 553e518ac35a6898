//! Laws that are evaluated for all integration points of a block at once.

use std::sync::Arc;

#[cfg(feature = "programs")]
use powerhouse_model::RemainingStiffness;
use powerhouse_model::{
    BlockLaw, BlockLawInput, ConstitutiveLaw, ElasticDomain, ElasticMedium, Extents,
    HistoryVariable, Lane, LawEnergy, LawInput, ModelError, Scalar, Strain, Stress,
};
#[cfg(feature = "programs")]
use powerhouse_program::Traced;

use super::exchange::REMAINING;
use super::law::{
    BatchLaw, BatchLaws, Energies, ErasedLaw, Evaluation, HistoryAccess, RemainingOutput, differ,
};
use super::memory::{as_lanes, as_lanes_mut};
use crate::lanes::{BatchLane, BatchOperation, BatchScalar, Lanes};

/// A [`BlockLaw`] behind the functions of laws in lanes.
#[derive(Clone)]
pub(super) struct AtOnce(Arc<dyn BlockLaw>);

impl AtOnce {
    pub(super) fn new(law: impl BlockLaw + 'static) -> Self {
        Self(Arc::new(law))
    }
}

impl ErasedLaw for AtOnce {
    fn name(&self) -> &str {
        self.0.name()
    }
    fn medium(&self) -> ElasticMedium {
        self.0.medium()
    }
    fn is_linear(&self) -> bool {
        false
    }
    fn history(&self) -> &[HistoryVariable] {
        self.0.history()
    }
    fn uses_location(&self) -> bool {
        self.0.uses_location()
    }
    #[cfg(feature = "programs")]
    fn is_in_lanes(&self) -> bool {
        false
    }
    fn takes_blocks(&self) -> bool {
        true
    }
    fn accept_size(&self, size: f64) -> Result<(), ModelError> {
        self.0.accept_size(size)
    }
    fn stress_change(&self, input: &LawInput<f64>, new_history: &mut [f64]) -> Stress {
        let (strains, initial, extents) = ([input.strain], [input.initial], [input.extents]);
        let point = BlockLawInput::new(&strains, &initial, input.history, &extents);
        let mut stress = [Stress([0.0; 6])];
        match input.location() {
            None => self.0.stress_changes(&point, &mut stress, new_history),
            Some(location) => {
                let positions = [location.position()];
                let point = point.with_locations(&positions, location.elements());
                self.0.stress_changes(&point, &mut stress, new_history);
            }
        }
        stress[0]
    }
    fn energy(&self, _input: &LawInput<f64>, _new_history: &[f64]) -> Option<LawEnergy<f64>> {
        None
    }
    fn hourglass_share(
        &self,
        _input: &LawInput<f64>,
        _new_history: &[f64],
        _change: &Stress,
    ) -> f64 {
        1.0
    }
    fn tangent(&self, _input: &LawInput<f64>) -> Option<[[f64; 6]; 6]> {
        None
    }
    fn relaxes(&self) -> bool {
        false
    }
    fn only_stores(&self) -> bool {
        false
    }
    fn elastic_domain(&self) -> Option<ElasticDomain> {
        None
    }
}

impl<S: BatchScalar> BatchLaw<S> for AtOnce {
    fn evaluate(&self, lanes: Lanes, evaluation: Evaluation<S>) -> Energies {
        lanes.dispatch(InLanes {
            law: self.0.as_ref(),
            evaluation,
        })
    }
    fn for_step(&self, _length: f64) -> Arc<dyn BatchLaw<S>> {
        Arc::new(self.clone())
    }
    /// Leaves its lanes, for which the recording is refused: the law is a function of a whole block.
    #[cfg(feature = "programs")]
    fn record(
        &self,
        input: &LawInput<Traced<S>>,
        _new_history: &mut [Traced<S>],
    ) -> (Stress<Traced<S>>, RemainingStiffness<Traced<S>>) {
        let first = input.strain.0[0];
        let left = first.constant(first.extract(0));
        (Stress([left; 6]), RemainingStiffness::whole(left))
    }
}

impl BatchLaws for AtOnce {}

/// The medium of a law as a law in lanes, whose remaining stiffness is that of laws by default.
#[derive(Clone)]
pub(super) struct Undamaged(pub(super) ElasticMedium);

impl ConstitutiveLaw for Undamaged {
    fn name(&self) -> &str {
        "undamaged"
    }
    fn medium(&self) -> ElasticMedium {
        self.0
    }
    fn is_linear(&self) -> bool {
        true
    }
    fn history(&self) -> &[HistoryVariable] {
        &[]
    }
    #[inline(always)]
    fn stress_change<L: Lane>(&self, input: &LawInput<L>, _new_history: &mut [L]) -> Stress<L> {
        let one = input.strain.0[0].constant(1.0);
        let (lambda, shear) = (self.0.lambda(), self.0.shear());
        Stress::elastic(one.constant(lambda), one.constant(shear), &input.strain)
    }
    fn elastic_domain(&self) -> Option<ElasticDomain> {
        Some(ElasticDomain::EVERYTHING)
    }
}

/// Evaluation of a law for batches in the lanes of the processor.
struct InLanes<'a, 'm, S> {
    law: &'a dyn BlockLaw,
    evaluation: Evaluation<'a, 'm, S>,
}

/// Points out of their lanes: those of a lane after those of the one before, point by point and batch by batch.
#[derive(Default)]
struct Points {
    strains: Vec<Strain>,
    initial: Vec<Stress>,
    history: Vec<f64>,
    extents: Vec<Extents<f64>>,
    positions: Vec<[f64; 3]>,
    elements: Vec<u64>,
}

/// Six numbers of a lane, in lanes from a place on.
fn six<S: Scalar>(numbers: &[S], width: usize, lane: usize) -> [f64; 6] {
    core::array::from_fn(|i| numbers[i * width + lane].to_f64())
}

impl<S: BatchScalar> InLanes<'_, '_, S> {
    /// The points of the evaluation out of their lanes.
    fn points<L: BatchLane<Scalar = S>>(&self, token: L::Token) -> Points {
        let given = &self.evaluation;
        let (width, points) = (L::WIDTH, given.points);
        let history = given.history.get();
        let (variables, is_alike) = (history.variables(), given.extents.len() == 6 * width);
        let mut found = Points::default();
        for b in 0..given.strains.len() / (6 * points * width) {
            let batch = given.first + b;
            let of_batch = if is_alike { 0 } else { batch };
            let committed = history.committed(batch);
            for p in 0..points {
                let location =
                    (given.locations).map(|locations| locations.in_lanes::<L>(token, batch, p));
                for lane in 0..width {
                    let strain = &given.strains[6 * (b * points + p) * width..];
                    found.strains.push(Strain(six(strain, width, lane)));
                    let initial = given.initial.map_or([0.0; 6], |initial| {
                        six(&initial[6 * b * width..], width, lane)
                    });
                    found.initial.push(Stress(initial));
                    let extents = &given.extents[6 * of_batch * width..];
                    found.extents.push(Extents(six(extents, width, lane)));
                    found.history.extend((0..self.law.history().len()).map(|h| {
                        let place = (p * variables + h) * width + lane;
                        committed.map_or(0.0, |numbers| numbers[place].to_f64())
                    }));
                    if let Some(location) = &location {
                        let position = location.position().map(|x| x.extract(lane));
                        found.positions.push(position);
                        found.elements.push(location.elements()[lane]);
                    }
                }
            }
        }
        found
    }

    /// Stores the new history variables of all points, where they differ from the committed ones.
    fn store<L: BatchLane<Scalar = S>>(&mut self, token: L::Token, new: &[f64]) {
        let Evaluation {
            first,
            points,
            strains,
            history: HistoryAccess::Write(history),
            ..
        } = &mut self.evaluation
        else {
            return;
        };
        let (variables, own) = (history.variables(), self.law.history().len());
        let length = variables * L::WIDTH;
        let zero = L::splat(token, 0.0);
        let virgin = vec![zero; variables];
        let mut staged = vec![zero; variables];
        for b in 0..strains.len() / (6 * *points * L::WIDTH) {
            let batch = *first + b;
            history.discard_trial(batch);
            let mut changed = false;
            for p in 0..*points {
                let rows = &new[(b * *points + p) * own * L::WIDTH..];
                let here = p * length..(p + 1) * length;
                let (committed, trial) = history.committed_and_trial(batch);
                let old = match committed {
                    Some(numbers) => as_lanes::<L>(token, &numbers[here.clone()]),
                    None => &virgin,
                };
                staged.copy_from_slice(old);
                for (h, value) in staged[..own].iter_mut().enumerate() {
                    *value = L::build(token, |lane| rows[lane * own + h]);
                }
                changed = changed || differ(old, &staged);
                let is_staged = trial.is_none();
                if let Some(numbers) = trial {
                    as_lanes_mut::<L>(token, &mut numbers[here]).copy_from_slice(&staged);
                }
                if changed && is_staged {
                    history.store(batch, p, &staged);
                } else if changed {
                    history.mark_changed(batch);
                }
            }
        }
    }
}

impl<S: BatchScalar> BatchOperation<S> for InLanes<'_, '_, S> {
    type Output = Energies;
    #[inline(always)]
    fn run<L: BatchLane<Scalar = S>>(mut self, token: L::Token) -> Energies {
        let points = self.points::<L>(token);
        let mut stresses = vec![Stress([0.0; 6]); points.strains.len()];
        let mut new = vec![0.0; points.history.len()];
        let (strains, initial) = (&points.strains, &points.initial);
        let mut input = BlockLawInput::new(strains, initial, &points.history, &points.extents);
        if !points.positions.is_empty() {
            input = input.with_locations(&points.positions, &points.elements);
        }
        self.law.stress_changes(&input, &mut stresses, &mut new);
        for (index, rows) in stresses.chunks_exact(L::WIDTH).enumerate() {
            for i in 0..6 {
                let place = (6 * index + i) * L::WIDTH;
                for (lane, stress) in rows.iter().enumerate() {
                    self.evaluation.stresses[place + lane] = S::from_f64(stress.0[i]);
                }
            }
        }
        self.store::<L>(token, &new);
        if let Some(RemainingOutput { numbers, .. }) = self.evaluation.remaining.take() {
            let undamaged = Undamaged(self.law.medium());
            let (numbers, _) = as_lanes_mut::<L>(token, numbers).as_chunks_mut::<REMAINING>();
            let (strains, _) = as_lanes::<L>(token, self.evaluation.strains).as_chunks::<6>();
            let (changes, _) = as_lanes::<L>(token, self.evaluation.stresses).as_chunks::<6>();
            for ((numbers, strain), change) in numbers.iter_mut().zip(strains).zip(changes) {
                let input = LawInput::new(Strain(*strain), &[]);
                let change = Stress(*change);
                let left = undamaged.remaining_stiffness(&input, &[], &change);
                numbers[0] = left.undamaged;
                numbers[1] = left.hourglass;
                numbers[2..8].copy_from_slice(&left.plastic_strain_increment);
            }
        }
        Energies::None
    }
}
