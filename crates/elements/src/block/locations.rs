//! Locations of integration points, for laws that use them.

use powerhouse_model::PointLocation;

use super::numbers::AlignedNumbers;
use crate::lanes::{Arrangement, BatchLane, BatchScalar};

/// Positions and element numbers of all integration points of a block, in lanes.
#[derive(Debug)]
pub(super) struct Locations<S> {
    /// Three coordinates of each point of each element (m).
    positions: AlignedNumbers<S>,
    /// The user's number of each element, in the order of the lanes.
    elements: Vec<u64>,
    /// Integration points per element.
    points: usize,
}

impl<S: BatchScalar> Locations<S> {
    /// Zeros for a number of elements that fill whole batches.
    pub(super) fn zeros(elements: usize, points: usize) -> Self {
        Self {
            positions: AlignedNumbers::zeros(3 * points * elements),
            elements: vec![0; elements],
            points,
        }
    }
    /// Sets the number of an element and the positions (m) of its points.
    pub(super) fn set(
        &mut self,
        arrangement: &Arrangement,
        element: usize,
        number: u64,
        positions: &[[f64; 3]],
    ) {
        self.elements[arrangement.place(element, 0, 1)] = number;
        for (index, &coordinate) in positions.as_flattened().iter().enumerate() {
            let index = arrangement.place(element, index, 3 * self.points);
            self.positions.as_mut_slice()[index] = S::from_f64(coordinate);
        }
    }
    /// Location of a point of a batch.
    #[inline(always)]
    pub(super) fn in_lanes<L: BatchLane<Scalar = S>>(
        &self,
        token: L::Token,
        batch: usize,
        point: usize,
    ) -> PointLocation<'_, L> {
        let start = 3 * (batch * self.points + point) * L::WIDTH;
        let numbers = &self.positions.as_slice()[start..start + 3 * L::WIDTH];
        let position = [
            L::load(token, numbers),
            L::load(token, &numbers[L::WIDTH..]),
            L::load(token, &numbers[2 * L::WIDTH..]),
        ];
        PointLocation::new(position, &self.elements[batch * L::WIDTH..][..L::WIDTH])
    }
    /// Location of a point of one element.
    pub(super) fn of_element(
        &self,
        arrangement: &Arrangement,
        element: usize,
        point: usize,
    ) -> PointLocation<'_, f64> {
        let coordinate = |axis: usize| {
            let index = arrangement.place(element, 3 * point + axis, 3 * self.points);
            self.positions.as_slice()[index].to_f64()
        };
        let position = [coordinate(0), coordinate(1), coordinate(2)];
        let element = arrangement.place(element, 0, 1);
        PointLocation::new(position, &self.elements[element..=element])
    }
}
