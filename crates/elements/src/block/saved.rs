//! State of a block between two steps: history variables and energy bookkeeping, in the order of the elements.

use powerhouse_model::{ElementKernel, Quad, StateError, decode, encode};
use serde::{Deserialize, Serialize};

use super::Block;
use super::account::SavedAccount;
use super::history::BatchFlags;
use super::transfer::NodeScalar;
use crate::lanes::{Arrangement, BatchScalar};

/// The batch of an element has a history that is not all zero, or had one.
const TOUCHED: u8 = 1;
/// The last commit changed the history of the batch.
const ACTIVE: u8 = 2;
/// The batch had energy bookkeeping in the last step.
const BALANCED: u8 = 4;
/// Variables of the batch other than those of water in pores are not all zero, or were not.
const USED: u8 = 8;

/// Numbers in the format of the elements.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) enum Numbers {
    Single(Vec<f32>),
    Double(Vec<f64>),
}

impl Numbers {
    /// From numbers in the format of the elements.
    pub(super) fn of<S: BatchScalar>(numbers: impl Iterator<Item = S>) -> Self {
        if const { size_of::<S>() == size_of::<f32>() } {
            Self::Single(numbers.map(|number| number.to_f64() as f32).collect())
        } else {
            Self::Double(numbers.map(|number| number.to_f64()).collect())
        }
    }

    /// A number of numbers in the format of the elements.
    pub(super) fn read<S: BatchScalar>(&self, expected: usize) -> Result<Vec<S>, StateError> {
        let (found, of_format) = match self {
            Self::Single(numbers) => {
                let numbers = numbers.iter().map(|&number| S::from_f64(f64::from(number)));
                (numbers.collect::<Vec<S>>(), size_of::<f32>())
            }
            Self::Double(numbers) => {
                let numbers = numbers.iter().map(|&number| S::from_f64(number));
                (numbers.collect(), size_of::<f64>())
            }
        };
        StateError::expect_same("the size of its numbers (bytes)", of_format, size_of::<S>())?;
        StateError::expect_same("the number of its values", found.len(), expected)?;
        Ok(found)
    }
}

/// Elements of a block with their places in stores of whole batches.
#[derive(Clone, Copy)]
pub(super) struct Places<'a> {
    pub(super) arrangement: &'a Arrangement,
    /// Number of elements, and of them in whole batches: the last batch is filled with copies of the last element.
    pub(super) elements: usize,
    pub(super) padded: usize,
}

impl Places<'_> {
    /// The numbers of some elements in a store with `count` of them per element, element after element.
    pub(super) fn take<S: BatchScalar>(
        &self,
        store: &[S],
        count: usize,
        chosen: impl Fn(usize) -> bool,
    ) -> Numbers {
        let elements = (0..self.elements).filter(|&element| chosen(element));
        Numbers::of(elements.flat_map(|element| {
            (0..count).map(move |index| store[self.arrangement.place(element, index, count)])
        }))
    }

    /// Writes the numbers of some elements into a store.
    pub(super) fn put<S: BatchScalar>(
        &self,
        numbers: &Numbers,
        store: &mut [S],
        count: usize,
        chosen: impl Fn(usize) -> bool,
    ) -> Result<(), StateError> {
        let own: Vec<usize> = (0..self.elements).filter(|&e| chosen(e)).collect();
        let numbers: Vec<S> = numbers.read(own.len() * count)?;
        for (row, &element) in own.iter().enumerate() {
            for index in 0..count {
                store[self.arrangement.place(element, index, count)] = numbers[row * count + index];
            }
        }
        for copy in self.elements..self.padded {
            for index in 0..count {
                let last = self.arrangement.place(self.elements - 1, index, count);
                store[self.arrangement.place(copy, index, count)] = store[last];
            }
        }
        Ok(())
    }
}

/// Saved state of a block.
#[derive(Debug, Serialize, Deserialize)]
struct SavedBlock {
    /// Width of the batches.
    width: usize,
    /// Names of the history variables.
    variables: Vec<String>,
    /// Flags of each element, those of its batch.
    flags: Vec<u8>,
    /// Committed history of the elements in touched batches.
    history: Numbers,
    /// Committed history of the copies of the last element that fill the last batch, if that is touched: it differs from
    /// the element's where only the element's was set, and whether a batch leaves its elastic domain depends on it.
    copies: Numbers,
    /// Displacement of the last committed static state, by local node index, if histories of elements follow from it.
    committed_displacement: Option<Vec<[f64; 3]>>,
    account: SavedAccount,
}

impl<K, S, const N: usize, const P: usize> Block<K, S, N, P>
where
    K: ElementKernel<N, P>,
    S: NodeScalar,
{
    fn places(&self) -> Places<'_> {
        Places {
            arrangement: &self.arrangement,
            elements: self.elements.len(),
            padded: self.connectivity.as_slice().len(),
        }
    }

    /// State between two steps.
    pub(super) fn encoded(&self) -> Result<Vec<u8>, StateError> {
        let width = self.arrangement.width;
        let balanced = self.account.balanced();
        let flags: Vec<u8> = (0..self.elements.len())
            .map(|element| {
                let batch = element / width;
                let flags = self.history.flags(batch);
                let balanced = balanced.get(batch).copied().unwrap_or(false);
                let flags = [
                    (flags.touched, TOUCHED),
                    (flags.active, ACTIVE),
                    (balanced, BALANCED),
                    (flags.used, USED),
                ];
                (flags.into_iter()).fold(0, |all, (set, flag)| if set { all | flag } else { all })
            })
            .collect();
        let numbers = (0..self.elements.len())
            .filter(|&element| flags[element] & TOUCHED != 0)
            .flat_map(|element| self.history.of_element(&self.arrangement, element));
        let is_balanced = |element: usize| flags[element] & BALANCED != 0;
        let (elements, padded) = (self.elements.len(), self.connectivity.as_slice().len());
        let last = flags.last().is_some_and(|flags| flags & TOUCHED != 0);
        let copies = (elements..padded).filter(|_| last);
        let copies = copies.flat_map(|copy| self.history.of_element(&self.arrangement, copy));
        encode(&SavedBlock {
            width,
            copies: Numbers::of(copies),
            variables: self.history.names().map(String::from).collect(),
            history: Numbers::of(numbers),
            committed_displacement: self.committed_displacement.as_ref().map(|values| {
                let values = values.iter();
                values.map(|value| value.to_vector().into()).collect()
            }),
            account: self.account.saved(self.places(), P, is_balanced),
            flags,
        })
    }

    /// Restores the state of a block of the same elements.
    pub(super) fn restore(&mut self, bytes: &[u8]) -> Result<(), StateError> {
        let saved: SavedBlock = decode(bytes)?;
        let (elements, width) = (self.elements.len(), self.arrangement.width);
        StateError::expect_same("the number of elements", saved.flags.len(), elements)?;
        let names: Vec<&str> = self.history.names().collect();
        let found: Vec<&str> = saved.variables.iter().map(String::as_str).collect();
        StateError::expect_same("the list of history variables", found, names)?;
        let of_batches = |flag: u8| -> Vec<bool> {
            let batches = saved.flags.chunks(width);
            batches
                .map(|flags| flags.iter().any(|flags| flags & flag != 0))
                .collect()
        };
        let balanced = of_batches(BALANCED);
        let divided = |(batch, &any): (usize, &bool)| {
            let flags = saved.flags[batch * width..].iter().take(width);
            any && !flags.clone().all(|flags| flags & BALANCED != 0)
        };
        if balanced.iter().enumerate().any(divided) {
            return Err(StateError::LaneWidth {
                found: saved.width,
                expected: width,
            });
        }
        let touched = |element: usize| saved.flags[element] & TOUCHED != 0;
        let own = (0..elements).filter(|&element| touched(element));
        let own: Vec<usize> = own.collect();
        let numbers: Vec<S> = saved.history.read(own.len() * self.history.per_element())?;
        let arrangement = self.arrangement;
        let (touched_batches, active) = (of_batches(TOUCHED), of_batches(ACTIVE));
        let used = of_batches(USED);
        let flags = (0..used.len()).map(|batch| BatchFlags {
            touched: touched_batches[batch],
            used: used[batch],
            active: active[batch],
        });
        self.history.restore(flags);
        let rows = numbers.chunks(self.history.per_element().max(1));
        for (&element, numbers) in own.iter().zip(rows) {
            self.history.put_element(&arrangement, element, numbers);
        }
        let last = elements.saturating_sub(1);
        if elements > 0 && touched(last) {
            let copies = elements..self.connectivity.as_slice().len();
            let each = self.history.per_element();
            let numbers: Vec<S> = if saved.width == width {
                saved.copies.read(copies.len() * each)?
            } else {
                let of_last: Vec<S> = self.history.of_element(&arrangement, last).collect();
                of_last.repeat(copies.len())
            };
            for (copy, numbers) in copies.zip(numbers.chunks(each.max(1))) {
                self.history.put_element(&arrangement, copy, numbers);
            }
        }
        self.committed_displacement = saved.committed_displacement.map(|values| {
            let values = values.into_iter();
            values.map(|[x, y, z]| Quad::new(x, y, z)).collect()
        });
        self.forces_at_rest = None;
        self.shown_mut().begin(&[]);
        let mut account = core::mem::take(&mut self.account);
        let is_balanced = |element: usize| saved.flags[element] & BALANCED != 0;
        let restored = account.restore(saved.account, self.places(), P, balanced, is_balanced);
        self.account = account;
        restored
    }
}
