//! History variables of all integration points of a block: committed ones and trial ones of the last forces.

use std::collections::HashMap;

use powerhouse_model::{HistoryField, HistoryVariable};

use super::batches::Batch;
use super::memory::{Cache, prefetch};
use super::numbers::AlignedNumbers;
use crate::lanes::{Arrangement, BatchLane, BatchScalar};

/// Name of the field of the history of elements as a whole.
const OWN: &str = "element_history";

/// Flags of the double-buffered trial and committed history variables of a batch of elements.
#[derive(Clone, Copy, Debug)]
struct BatchState {
    /// Index of the store, of two, with the committed history.
    side: u8,
    /// Whether the other store has a trial history that differs from the committed one.
    changed: bool,
    /// Whether the last forces overwrote the committed history with another one.
    overwritten: bool,
    /// Whether the committed history is all zero (virgin material).
    zero: bool,
    /// Whether of the committed history only the variables of water may differ from zero, and whether of the trial history.
    virgin: [bool; 2],
    /// Whether the last commit changed the committed history.
    active: bool,
}

impl BatchState {
    /// All zero.
    const VIRGIN: Self = Self {
        side: 0,
        changed: false,
        overwritten: false,
        zero: true,
        virgin: [true; 2],
        active: false,
    };

    /// The store with the committed history, and the other one.
    #[inline(always)]
    fn sides<T>(self, [first, second]: &mut [T; 2]) -> (&T, &mut T) {
        match self.side {
            0 => (first, second),
            _ => (second, first),
        }
    }
}

/// What is known of the committed history of a batch.
#[derive(Clone, Copy, Debug)]
pub(super) struct BatchFlags {
    /// Whether it may differ from zero.
    pub(super) touched: bool,
    /// Whether variables other than those of water may.
    pub(super) used: bool,
    /// Whether the last commit changed it.
    pub(super) active: bool,
}

/// Double-buffered history variables of a block, batch by batch.
///
/// Most integration points do not change in most steps: a batch whose history has never changed is not
/// read, one whose history does not change in a step is not written. A commit exchanges the stores of a
/// batch and copies nothing. In-place updates overwrite the committed history: a step then touches one
/// store instead of two.
#[derive(Debug, Default)]
pub(super) struct History<S> {
    variables: Vec<HistoryVariable>,
    points: usize,
    /// Number of history variables of an element as a whole, after those of its points.
    own: usize,
    /// Number of the last variables of a point that are those of water in pores.
    of_water: usize,
    width: usize,
    stores: [AlignedNumbers<S>; 2],
    states: Vec<BatchState>,
    /// Whether new history variables overwrite the committed ones.
    in_place: bool,
}

impl<S: BatchScalar> History<S> {
    /// All history variables zero, of points and of elements as a whole, for a number of batches of a width.
    pub(super) fn new(
        variables: &[HistoryVariable],
        (points, own): (usize, usize),
        (batches, width): (usize, usize),
    ) -> Self {
        let numbers = batches * width * (points * variables.len() + own);
        Self {
            variables: variables.to_vec(),
            points,
            own,
            of_water: 0,
            width,
            stores: [(); 2].map(|()| AlignedNumbers::zeros(numbers)),
            states: vec![BatchState::VIRGIN; batches],
            in_place: false,
        }
    }

    /// The history whose last variables of a point are a number of those of water in pores.
    pub(super) fn with_water(self, of_water: usize) -> Self {
        Self { of_water, ..self }
    }
    /// Number of values per batch.
    fn numbers(&self) -> usize {
        self.per_element() * self.width
    }
    /// Sets whether new history variables overwrite the committed ones.
    pub(super) fn set_in_place(&mut self, in_place: bool) {
        self.in_place = in_place;
    }
    /// Number of history variables per integration point.
    #[inline(always)]
    pub(super) fn variables(&self) -> usize {
        self.variables.len()
    }
    /// Committed history of a batch; none if it is all zero.
    #[inline(always)]
    pub(super) fn committed(&self, batch: usize) -> Option<&[S]> {
        let state = self.states[batch];
        let numbers = self.numbers();
        let store = self.stores[usize::from(state.side)].as_slice();
        (!state.zero).then(|| &store[batch * numbers..][..numbers])
    }
    /// Whether all committed variables of a batch are zero, but for those of water.
    #[inline(always)]
    pub(super) fn is_virgin(&self, batch: usize) -> bool {
        let state = &self.states[batch];
        state.zero || state.virgin[0]
    }
    /// Marks variables of a batch that are not those of water as changed by the last forces.
    #[inline(always)]
    fn mark_used(&mut self, batch: usize) {
        let virgin = &mut self.states[batch].virgin;
        virgin[1] = false;
        if self.in_place {
            virgin[0] = false;
        }
    }
    /// History of a batch after the last forces; none if it is all zero.
    fn latest(&self, batch: usize) -> Option<&[S]> {
        let state = self.states[batch];
        if !state.changed {
            return self.committed(batch);
        }
        let numbers = self.numbers();
        let store = self.stores[usize::from(1 - state.side)].as_slice();
        Some(&store[batch * numbers..][..numbers])
    }

    /// The own numbers of the elements among those of a batch.
    #[inline(always)]
    fn own_of<'a>(&self, numbers: &'a [S]) -> &'a [S] {
        &numbers[numbers.len() - self.own * self.width..]
    }
    /// Committed own history of a batch; none if its history is all zero.
    #[inline(always)]
    pub(super) fn committed_own(&self, batch: usize) -> Option<&[S]> {
        let numbers = self.committed(batch)?;
        Some(self.own_of(numbers))
    }
    /// Own history of a batch after the last forces; none if its history is all zero.
    #[inline(always)]
    pub(super) fn own(&self, batch: usize) -> Option<&[S]> {
        let numbers = self.latest(batch)?;
        Some(self.own_of(numbers))
    }
    /// Own history of one element after the last forces.
    pub(super) fn own_of_element(&self, arrangement: &Arrangement, element: usize) -> Vec<f64> {
        let numbers = match self.own {
            0 => None,
            _ => self.own(element / self.width),
        };
        let of = |h| {
            numbers.map_or(0.0, |own| {
                own[arrangement.place(element % self.width, h, 0)].to_f64()
            })
        };
        (0..self.own).map(of).collect()
    }
    /// Stores the own history of a batch, after that of its points, if it or theirs changed.
    #[inline(always)]
    pub(super) fn store_own<L: BatchLane<Scalar = S>>(
        &mut self,
        batch: usize,
        new: &[L],
        changed: bool,
    ) {
        if changed {
            self.mark_used(batch);
        }
        let from = self.numbers() - new.len() * L::WIDTH;
        self.store_behind(batch, from, new, changed);
    }
    /// Stores the last history variables of one point of a batch, those of water, after those before them, if they or others
    /// changed.
    #[inline(always)]
    pub(super) fn store_last<L: BatchLane<Scalar = S>>(
        &mut self,
        batch: usize,
        point: usize,
        new: &[L],
        changed: bool,
    ) {
        let from = ((point + 1) * self.variables.len() - new.len()) * self.width;
        self.store_behind(batch, from, new, changed);
    }
    /// Stores numbers of a batch that follow from a place on, after the history of all its points, if they or others changed.
    #[inline(always)]
    fn store_behind<L: BatchLane<Scalar = S>>(
        &mut self,
        batch: usize,
        from: usize,
        new: &[L],
        changed: bool,
    ) {
        if !(changed || self.states[batch].changed) {
            return;
        }
        if !(self.in_place || self.states[batch].changed) {
            self.open_trial(batch, self.points);
        }
        self.write(batch, from, new);
    }
    /// Writes numbers of a batch from a place on, in place of the committed ones or to the trial history.
    #[inline(always)]
    fn write<L: BatchLane<Scalar = S>>(&mut self, batch: usize, from: usize, new: &[L]) {
        let start = batch * self.numbers() + from;
        let state = &mut self.states[batch];
        let mut side = 1 - state.side;
        if self.in_place {
            // Where the history is zero, so is its store.
            (state.overwritten, state.zero) = (true, false);
            side = state.side;
        }
        let store = &mut self.stores[usize::from(side)];
        let numbers = &mut store.as_mut_slice()[start..][..new.len() * L::WIDTH];
        for (value, numbers) in new.iter().zip(numbers.chunks_exact_mut(L::WIDTH)) {
            value.store(numbers);
        }
    }

    /// Prefetches the committed history of a batch, and the store of its trial history if laws write there.
    #[inline(always)]
    pub(super) fn prefetch(&self, batch: usize) {
        let Some(state) = self.states.get(batch) else {
            return;
        };
        let numbers = self.numbers();
        let side = usize::from(state.side);
        if !state.zero {
            prefetch(
                Cache::Second,
                self.stores[side].as_slice(),
                batch * numbers,
                numbers,
            );
        }
        if state.active && !self.in_place {
            prefetch(
                Cache::Second,
                self.stores[1 - side].as_slice(),
                batch * numbers,
                numbers,
            );
        }
    }

    /// Discards the trial history of a batch.
    #[inline(always)]
    pub(super) fn discard_trial(&mut self, batch: usize) {
        let state = &mut self.states[batch];
        state.changed = false;
        state.virgin[1] = state.virgin[0];
    }
    /// Committed history of a batch, none if it is all zero, and the store of its trial history, if updates
    /// are buffered and the history changed in the last step: it probably changes again, and laws can write
    /// there without a copy.
    #[inline(always)]
    pub(super) fn committed_and_trial(&mut self, batch: usize) -> (Option<&[S]>, Option<&mut [S]>) {
        let state = self.states[batch];
        let numbers = self.numbers();
        let range = batch * numbers..(batch + 1) * numbers;
        let (held, other) = state.sides(&mut self.stores);
        let committed = (!state.zero).then(|| &held.as_slice()[range.clone()]);
        let trial = (state.active && !self.in_place).then(|| &mut other.as_mut_slice()[range]);
        (committed, trial)
    }
    /// Marks the trial history of a batch, already written to its store, as changed.
    #[inline(always)]
    pub(super) fn mark_changed(&mut self, batch: usize) {
        self.mark_used(batch);
        self.states[batch].changed = true;
    }
    /// Stores the new history of one point of a batch; called point after point from the first one on that
    /// differs from the committed one.
    #[inline(always)]
    pub(super) fn store<L: BatchLane<Scalar = S>>(
        &mut self,
        batch: usize,
        point: usize,
        new: &[L],
    ) {
        self.mark_used(batch);
        if !(self.in_place || self.states[batch].changed) {
            self.open_trial(batch, point);
        }
        self.write(batch, point * new.len() * L::WIDTH, new);
    }
    /// Begins the trial history of a batch with a copy of the committed history of its first points; the
    /// other points follow.
    fn open_trial(&mut self, batch: usize, points: usize) {
        let start = batch * self.numbers();
        let range = start..start + points * self.variables.len() * self.width;
        let state = &mut self.states[batch];
        state.changed = true;
        let (from, to) = state.sides(&mut self.stores);
        to.as_mut_slice()[range.clone()].copy_from_slice(&from.as_slice()[range]);
    }
    /// Reverts the trial history of the elements of a batch that are not active to the committed one.
    #[inline(always)]
    pub(super) fn revert_absent<const N: usize>(&mut self, index: usize, batch: &Batch<S, N>) {
        if batch.active.is_none() {
            return;
        }
        for lane in 0..self.width {
            if !batch.has(batch.arrangement.element_in[lane]) {
                self.revert_lane(index, lane);
            }
        }
    }
    /// Reverts the trial history of one lane of a batch to the committed one.
    fn revert_lane(&mut self, batch: usize, lane: usize) {
        let state = self.states[batch];
        if !state.changed {
            return;
        }
        let numbers = self.numbers();
        let (from, to) = state.sides(&mut self.stores);
        for index in (batch * numbers + lane..(batch + 1) * numbers).step_by(self.width) {
            to.as_mut_slice()[index] = from.as_slice()[index];
        }
    }
    /// Commits the history of the last forces.
    pub(super) fn commit(&mut self) {
        for state in &mut self.states {
            state.active = state.changed || state.overwritten;
            state.overwritten = false;
            if state.changed {
                state.side = 1 - state.side;
                state.changed = false;
                state.zero = false;
                state.virgin[0] = state.virgin[1];
            }
        }
    }

    /// Committed value of an element, by point and variable.
    pub(super) fn value(
        &self,
        arrangement: &Arrangement,
        element: usize,
        (point, variable): (usize, usize),
    ) -> f64 {
        let numbers = self.committed(element / self.width);
        let index = self.index(arrangement, element, (point, variable));
        numbers.map_or(0.0, |numbers| numbers[index].to_f64())
    }
    /// Element value of a variable after the last forces.
    pub(super) fn element_value(
        &self,
        arrangement: &Arrangement,
        element: usize,
        variable: &str,
    ) -> Option<f64> {
        let (v, variable) = self.find(variable)?;
        let numbers = self.latest(element / self.width);
        let of_point = |point: usize| {
            let index = self.index(arrangement, element, (point, v));
            numbers.map_or(0.0, |numbers| numbers[index].to_f64())
        };
        Some(variable.of_element((0..self.points).map(of_point)))
    }
    /// Sum of the values of a variable of an element after the last forces, by its place among those of a point, times
    /// weights of the points.
    pub(super) fn weighted(
        &self,
        arrangement: &Arrangement,
        element: usize,
        variable: usize,
        weights: &[f64],
    ) -> f64 {
        let Some(numbers) = self.latest(element / self.width) else {
            return 0.0;
        };
        let of_point = |(point, weight): (usize, &f64)| {
            weight * numbers[self.index(arrangement, element, (point, variable))].to_f64()
        };
        weights.iter().enumerate().map(of_point).sum()
    }
    /// Committed history of some elements of the mesh, one field per variable.
    pub(super) fn fields(&self, arrangement: &Arrangement, elements: &[u32]) -> Vec<HistoryField> {
        let of_elements = (self.own > 0).then(|| {
            let first = self.points * self.variables.len();
            let values = elements.iter().enumerate().flat_map(|(element, _)| {
                let own = self.of_element(arrangement, element).skip(first);
                own.map(|value| value.to_f64())
            });
            HistoryField::new(OWN, elements.to_vec(), self.own, values.collect())
        });
        let variables = self.variables.iter().enumerate();
        let field = |(v, variable): (usize, &HistoryVariable)| {
            let values = (0..elements.len() * self.points)
                .map(|i| self.value(arrangement, i / self.points, (i % self.points, v)))
                .collect();
            HistoryField::new(variable.name, elements.to_vec(), self.points, values)
        };
        variables.map(field).chain(of_elements).collect()
    }
    /// Sets the committed history of some elements of the mesh from fields.
    pub(super) fn set_fields(
        &mut self,
        arrangement: &Arrangement,
        elements: &[u32],
        fields: &[HistoryField],
    ) {
        let first = self.points * self.variables.len();
        for field in fields {
            // Place of the first value of an element, and of the next one.
            let (start, next) = if field.name == OWN && field.points == self.own {
                (first, 1)
            } else {
                match self.find(&field.name) {
                    Some((v, _)) if field.points == self.points => (v, self.variables.len()),
                    _ => continue,
                }
            };
            let is_of_water = next > 1 && start + self.of_water >= self.variables.len();
            let row_of: HashMap<u32, usize> = field.elements.iter().copied().zip(0..).collect();
            for (element, mesh_element) in elements.iter().enumerate() {
                let Some(&row) = row_of.get(mesh_element) else {
                    continue;
                };
                let batch = element / self.width;
                self.states[batch].changed = false;
                for point in 0..field.points {
                    let value = field.values[row * field.points + point];
                    let number = start + point * next;
                    let index = arrangement.place(element % self.width, number, 0);
                    let index = batch * self.numbers() + index;
                    let state = &mut self.states[batch];
                    // A zero with a sign is a value of its own.
                    let is_zero = value.to_bits() == 0;
                    state.zero &= is_zero;
                    state.virgin[0] &= is_zero || is_of_water;
                    let store = &mut self.stores[usize::from(state.side)];
                    store.as_mut_slice()[index] = S::from_f64(value);
                }
            }
        }
    }

    /// Names of the history variables.
    pub(super) fn names(&self) -> impl Iterator<Item = &'static str> {
        self.variables.iter().map(|variable| variable.name)
    }
    /// Number of values per element.
    #[inline(always)]
    pub(super) fn per_element(&self) -> usize {
        self.points * self.variables.len() + self.own
    }
    /// Flags of the committed history of a batch.
    pub(super) fn flags(&self, batch: usize) -> BatchFlags {
        let state = self.states.get(batch).unwrap_or(&BatchState::VIRGIN);
        BatchFlags {
            touched: !state.zero,
            used: !(state.zero || state.virgin[0]),
            active: state.active,
        }
    }
    /// Committed values of an element, point after point.
    pub(super) fn of_element(
        &self,
        arrangement: &Arrangement,
        element: usize,
    ) -> impl Iterator<Item = S> {
        let committed = self.committed(element / self.width.max(1));
        (0..self.per_element()).map(move |number| {
            let place = arrangement.place(element % self.width, number, 0);
            committed.map_or(S::default(), |numbers| numbers[place])
        })
    }
    /// Makes the history of all batches zero, with their flags.
    pub(super) fn restore(&mut self, flags: impl Iterator<Item = BatchFlags>) {
        for (state, flags) in self.states.iter_mut().zip(flags) {
            *state = BatchState {
                zero: !flags.touched,
                virgin: [!flags.used; 2],
                active: flags.active,
                ..BatchState::VIRGIN
            };
        }
        self.stores[0].as_mut_slice().fill(S::default());
    }
    /// Sets the committed values of an element, point after point, on the side of a [restored](Self::restore) history.
    pub(super) fn put_element(&mut self, arrangement: &Arrangement, element: usize, values: &[S]) {
        let start = element / self.width * self.numbers();
        for (number, value) in values.iter().enumerate() {
            let place = arrangement.place(element % self.width, number, 0);
            self.stores[0].as_mut_slice()[start + place] = *value;
        }
    }

    fn find(&self, name: &str) -> Option<(usize, &HistoryVariable)> {
        let mut variables = self.variables.iter().enumerate();
        variables.find(|(_, variable)| variable.name == name)
    }
    /// Index of a value of an element among those of its batch.
    fn index(
        &self,
        arrangement: &Arrangement,
        element: usize,
        (point, variable): (usize, usize),
    ) -> usize {
        let number = point * self.variables.len() + variable;
        arrangement.place(element % self.width, number, 0)
    }
}
