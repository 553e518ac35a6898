//! The history variables of all points of a block: committed ones, and those of the last forces.

use std::collections::HashMap;

use powerhouse_model::{HistoryField, HistoryVariable};

use super::memory::{Cache, prefetch};
use super::numbers::AlignedNumbers;
use crate::lanes::{Arrangement, BatchLane, BatchScalar};

/// Flags of the double-buffered trial and committed history variables of a batch of elements.
#[derive(Clone, Copy, Debug)]
struct BatchState {
    /// Which of the two stores holds the committed history.
    side: u8,
    /// Whether the other store holds another history, that of the last forces.
    changed: bool,
    /// Whether the last forces wrote another history over the committed one.
    moved: bool,
    /// Whether the committed history is still all zero.
    zero: bool,
    /// Whether the last commit changed it.
    active: bool,
}

impl BatchState {
    /// The store that holds the committed history, and the other one.
    #[inline(always)]
    fn sides<T>(self, [first, second]: &mut [T; 2]) -> (&T, &mut T) {
        match self.side {
            0 => (first, second),
            _ => (second, first),
        }
    }
}

/// History variables, batch by batch.
///
/// Most points of most steps stay as they are: a batch whose history has never changed is not read,
/// one whose history does not change in a step is not written. Committing turns a batch to its
/// other store and copies nothing. Where nothing but a commit follows, the new history goes where the
/// committed one is: a step then touches one store instead of two.
#[derive(Debug, Default)]
pub(super) struct History<S> {
    variables: Vec<HistoryVariable>,
    points: usize,
    width: usize,
    stores: [AlignedNumbers<S>; 2],
    states: Vec<BatchState>,
    /// Whether new numbers go over the committed ones.
    over: bool,
}

impl<S: BatchScalar> History<S> {
    /// Zeros for some batches of a width, with some points per element.
    pub(super) fn new(
        variables: &[HistoryVariable],
        points: usize,
        (batches, width): (usize, usize),
    ) -> Self {
        let numbers = batches * width * points * variables.len();
        let state = BatchState {
            side: 0,
            changed: false,
            moved: false,
            zero: true,
            active: false,
        };
        Self {
            variables: variables.to_vec(),
            points,
            width,
            stores: [(); 2].map(|()| AlignedNumbers::zeros(numbers)),
            states: vec![state; batches],
            over: false,
        }
    }

    /// Numbers per batch.
    fn numbers(&self) -> usize {
        self.points * self.variables.len() * self.width
    }
    /// From now on new numbers go over the committed ones, or beside them.
    pub(super) fn write_over(&mut self, over: bool) {
        self.over = over;
    }
    /// How many variables a point has.
    #[inline(always)]
    pub(super) fn variables(&self) -> usize {
        self.variables.len()
    }
    /// The committed numbers of a batch; none if they are all zero.
    #[inline(always)]
    pub(super) fn committed(&self, batch: usize) -> Option<&[S]> {
        let state = self.states[batch];
        let numbers = self.numbers();
        let store = self.stores[usize::from(state.side)].as_slice();
        (!state.zero).then(|| &store[batch * numbers..][..numbers])
    }
    /// The numbers of a batch after the last forces; none if they are all zero.
    fn latest(&self, batch: usize) -> Option<&[S]> {
        let state = self.states[batch];
        if !state.changed {
            return self.committed(batch);
        }
        let numbers = self.numbers();
        let store = self.stores[usize::from(1 - state.side)].as_slice();
        Some(&store[batch * numbers..][..numbers])
    }

    /// Asks for the numbers of a batch ahead of their use; and for the place of the next ones, if what
    /// laws write goes there.
    #[inline(always)]
    pub(super) fn ask_ahead(&self, batch: usize) {
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
        if state.active && !self.over {
            prefetch(
                Cache::Second,
                self.stores[1 - side].as_slice(),
                batch * numbers,
                numbers,
            );
        }
    }

    /// Forgets what the last forces made of a batch.
    #[inline(always)]
    pub(super) fn retry(&mut self, batch: usize) {
        self.states[batch].changed = false;
    }
    /// The committed numbers of a batch, none if they are all zero; and the place of the next ones, if that
    /// is another and its history changed in the last step: it will again, and what laws write need not be
    /// copied there.
    #[inline(always)]
    pub(super) fn both(&mut self, batch: usize) -> (Option<&[S]>, Option<&mut [S]>) {
        let state = self.states[batch];
        let numbers = self.numbers();
        let range = batch * numbers..(batch + 1) * numbers;
        let (held, other) = state.sides(&mut self.stores);
        let committed = (!state.zero).then(|| &held.as_slice()[range.clone()]);
        let next = (state.active && !self.over).then(|| &mut other.as_mut_slice()[range]);
        (committed, next)
    }
    /// Says that what was written to the place of the next history differs from the committed one.
    #[inline(always)]
    pub(super) fn took(&mut self, batch: usize) {
        self.states[batch].changed = true;
    }
    /// Takes the new history of one point of a batch, point after point, from the first on that differs
    /// from the committed one.
    #[inline(always)]
    pub(super) fn take<L: BatchLane<Scalar = S>>(&mut self, batch: usize, point: usize, new: &[L]) {
        if !(self.over || self.states[batch].changed) {
            self.begin(batch, point);
        }
        let (start, length) = (batch * self.numbers(), new.len() * L::WIDTH);
        let state = &mut self.states[batch];
        let mut side = 1 - state.side;
        if self.over {
            // Where the history is zero, so is its store.
            (state.moved, state.zero) = (true, false);
            side = state.side;
        }
        let store = &mut self.stores[usize::from(side)];
        let numbers = &mut store.as_mut_slice()[start + point * length..][..length];
        for (value, numbers) in new.iter().zip(numbers.chunks_exact_mut(L::WIDTH)) {
            value.store(numbers);
        }
    }
    /// Opens the other store of a batch with a copy of the committed history of its first points; those
    /// of the others follow.
    fn begin(&mut self, batch: usize, points: usize) {
        let start = batch * self.numbers();
        let range = start..start + points * self.variables.len() * self.width;
        let state = &mut self.states[batch];
        state.changed = true;
        let (from, to) = state.sides(&mut self.stores);
        to.as_mut_slice()[range.clone()].copy_from_slice(&from.as_slice()[range]);
    }
    /// Takes the new history of one lane of a batch back.
    pub(super) fn take_back(&mut self, batch: usize, lane: usize) {
        let state = self.states[batch];
        if !state.changed {
            return;
        }
        let numbers = self.numbers();
        let (from, to) = state.sides(&mut self.stores);
        for place in (batch * numbers + lane..(batch + 1) * numbers).step_by(self.width) {
            to.as_mut_slice()[place] = from.as_slice()[place];
        }
    }
    /// Makes the history of the last forces the committed one.
    pub(super) fn commit(&mut self) {
        for state in &mut self.states {
            state.active = state.changed || state.moved;
            state.moved = false;
            if state.changed {
                state.side = 1 - state.side;
                state.changed = false;
                state.zero = false;
            }
        }
    }

    /// A committed number of an element, by point and variable.
    pub(super) fn value(
        &self,
        arrangement: &Arrangement,
        element: usize,
        (point, variable): (usize, usize),
    ) -> f64 {
        let numbers = self.committed(element / self.width);
        let place = self.place(arrangement, element, (point, variable));
        numbers.map_or(0.0, |numbers| numbers[place].to_f64())
    }
    /// What an element shows of a variable after the last forces.
    pub(super) fn shown(
        &self,
        arrangement: &Arrangement,
        element: usize,
        variable: &str,
    ) -> Option<f64> {
        let (v, variable) = self.find(variable)?;
        let numbers = self.latest(element / self.width);
        let of_point = |point: usize| {
            let place = self.place(arrangement, element, (point, v));
            numbers.map_or(0.0, |numbers| numbers[place].to_f64())
        };
        Some(variable.of_element((0..self.points).map(of_point)))
    }
    /// The committed history of some elements of the mesh, by name.
    pub(super) fn fields(&self, arrangement: &Arrangement, elements: &[u32]) -> Vec<HistoryField> {
        let variables = self.variables.iter().enumerate();
        let field = |(v, variable): (usize, &HistoryVariable)| {
            let values = (0..elements.len() * self.points)
                .map(|i| self.value(arrangement, i / self.points, (i % self.points, v)))
                .collect();
            HistoryField::new(variable.name, elements.to_vec(), self.points, values)
        };
        variables.map(field).collect()
    }
    /// Takes over what belongs to some elements of the mesh.
    pub(super) fn set_fields(
        &mut self,
        arrangement: &Arrangement,
        elements: &[u32],
        fields: &[HistoryField],
    ) {
        for field in fields.iter().filter(|field| field.points == self.points) {
            let Some((v, _)) = self.find(&field.name) else {
                continue;
            };
            let row_of: HashMap<u32, usize> = field.elements.iter().copied().zip(0..).collect();
            for (element, mesh_element) in elements.iter().enumerate() {
                let Some(&row) = row_of.get(mesh_element) else {
                    continue;
                };
                let batch = element / self.width;
                self.states[batch].changed = false;
                for point in 0..self.points {
                    let value = field.values[row * self.points + point];
                    let place = self.place(arrangement, element, (point, v));
                    let place = batch * self.numbers() + place;
                    let state = &mut self.states[batch];
                    state.zero &= value == 0.0;
                    let store = &mut self.stores[usize::from(state.side)];
                    store.as_mut_slice()[place] = S::from_f64(value);
                }
            }
        }
    }

    fn find(&self, name: &str) -> Option<(usize, &HistoryVariable)> {
        let mut variables = self.variables.iter().enumerate();
        variables.find(|(_, variable)| variable.name == name)
    }
    /// Where a number of an element stands among those of its batch.
    fn place(
        &self,
        arrangement: &Arrangement,
        element: usize,
        (point, variable): (usize, usize),
    ) -> usize {
        let index = point * self.variables.len() + variable;
        arrangement.place(element % self.width, index, 0)
    }
}
