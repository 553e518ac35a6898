//! How a bolt hangs on the nodes of its hosts.

use std::collections::BTreeMap;

use powerhouse_model::Vec3;

use super::embedding::HostPoint;

/// Weights of values along a line, row by row.
#[derive(Debug, Default)]
struct Rows {
    /// Which values, of all rows one after the other.
    own: Vec<u32>,
    /// Their weights.
    weights: Vec<f64>,
    /// Where each row ends.
    ends: Vec<u32>,
}

impl Rows {
    fn push(&mut self, row: impl Iterator<Item = (u32, f64)>) {
        for (own, weight) in row.filter(|(_, weight)| *weight != 0.0) {
            self.own.push(own);
            self.weights.push(weight);
        }
        self.ends.push(self.own.len() as u32);
    }
    /// Values and weights of each row.
    fn iter(&self) -> impl Iterator<Item = impl Iterator<Item = (usize, f64)>> {
        let mut start = 0;
        self.ends.iter().map(move |&end| {
            let row = core::mem::replace(&mut start, end as usize)..end as usize;
            let own = self.own[row.clone()].iter().map(|&own| own as usize);
            own.zip(self.weights[row].iter().copied())
        })
    }
    /// The sum of each row over the values of a line.
    fn sums(&self, line: &[f64]) -> impl Iterator<Item = f64> {
        self.iter()
            .map(|row| row.map(|(own, weight)| weight * line[own]).sum())
    }
    /// Adds a value of each row to the line, by its weights.
    fn add<'v>(&self, values: impl Iterator<Item = &'v f64>, line: &mut [f64]) {
        for (row, &value) in self.iter().zip(values) {
            for (own, weight) in row {
                line[own] += weight * value;
            }
        }
    }
}

/// The points of a bolt on the nodes around them: two for each segment.
///
/// Segments share hosts and hosts share nodes, so that each node is met several times along a bolt. It
/// is read and written once: between, everything is along one line.
#[derive(Debug)]
pub(super) struct Hanging {
    direction: Vec3,
    /// Places of the nodes in the block, in rising order.
    places: Vec<u32>,
    /// The points.
    points: Rows,
    /// The second point of each segment less the first.
    stretches: Rows,
}

impl Hanging {
    /// Points of a bolt, head first; `place` tells where a node stands in the block.
    pub(super) fn new<'h>(
        direction: Vec3,
        points: impl Iterator<Item = &'h HostPoint> + Clone,
        place: impl Fn(u32) -> u32,
    ) -> Self {
        let nodes = points.clone().flat_map(|point| &point.nodes);
        let mut places: Vec<u32> = nodes.map(|&node| place(node)).collect();
        places.sort_unstable();
        places.dedup();
        let own = |node: u32| {
            let place = place(node);
            places.partition_point(|&other| other < place) as u32
        };
        let mut rows = Rows::default();
        for point in points {
            let nodes = point.nodes.iter().map(|&node| own(node));
            rows.push(nodes.zip(point.weights.iter().copied()));
        }
        let mut stretches = Rows::default();
        let mut ends = rows.iter();
        while let (Some(first), Some(second)) = (ends.next(), ends.next()) {
            let mut row: BTreeMap<usize, f64> = second.collect();
            for (own, weight) in first {
                *row.entry(own).or_default() -= weight;
            }
            stretches.push(row.into_iter().map(|(own, weight)| (own as u32, weight)));
        }
        drop(ends);
        Self {
            direction,
            points: rows,
            stretches,
            places,
        }
    }

    /// The direction from head to toe, of length one.
    pub(super) fn direction(&self) -> Vec3 {
        self.direction
    }
    /// Places of the nodes that it hangs on, in rising order.
    pub(super) fn places(&self) -> &[u32] {
        &self.places
    }

    /// Displacements (m) along the bolt at its places.
    fn read(&self, displacement: impl Fn(u32) -> Vec3, line: &mut Vec<f64>) {
        line.clear();
        let along = |&place: &u32| self.direction.dot(&displacement(place));
        line.extend(self.places.iter().map(along));
    }

    /// Axial displacements (m) of the points, from the displacements at places; `line` is room to compute
    /// in.
    pub(super) fn axial(
        &self,
        displacement: impl Fn(u32) -> Vec3,
        line: &mut Vec<f64>,
        out: &mut Vec<[f64; 2]>,
    ) {
        self.read(displacement, line);
        self.interpolate(line, out);
    }

    /// How much longer (m) each segment is, from the displacements at places.
    pub(super) fn elongations(
        &self,
        displacement: impl Fn(u32) -> Vec3,
        line: &mut Vec<f64>,
        out: &mut Vec<f64>,
    ) {
        self.read(displacement, line);
        out.clear();
        out.extend(self.stretches.sums(line));
    }

    /// Values at the points, from values at the places.
    pub(super) fn interpolate(&self, line: &[f64], out: &mut Vec<[f64; 2]>) {
        out.clear();
        let mut sums = self.points.sums(line);
        while let (Some(first), Some(second)) = (sums.next(), sums.next()) {
            out.push([first, second]);
        }
    }

    /// Axial forces (N) at the places of those at the points.
    pub(super) fn gather(&self, forces: &[[f64; 2]], line: &mut Vec<f64>) {
        line.clear();
        line.resize(self.places.len(), 0.0);
        self.points.add(forces.iter().flatten(), line);
    }

    /// Adds axial forces (N) at the points to the nodes.
    pub(super) fn spread(&self, forces: &[[f64; 2]], line: &mut Vec<f64>, out: &mut [Vec3]) {
        self.gather(forces, line);
        self.write(line, out);
    }

    /// Adds axial forces (N) of the segments, which pull their points together, to the nodes.
    pub(super) fn spread_tension(&self, forces: &[f64], line: &mut Vec<f64>, out: &mut [Vec3]) {
        line.clear();
        line.resize(self.places.len(), 0.0);
        self.stretches.add(forces.iter(), line);
        self.write(line, out);
    }

    fn write(&self, line: &[f64], out: &mut [Vec3]) {
        for (&place, &force) in self.places.iter().zip(line) {
            out[place as usize] += self.direction * force;
        }
    }
}
