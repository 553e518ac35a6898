//! Interpolation of a bolt from the nodes of its host elements (embedded element constraint).

use std::collections::BTreeMap;

use powerhouse_model::Vec3;

use super::embedding::HostPoint;

/// A sparse matrix over the axial nodal values of a bolt, by rows.
#[derive(Debug, Default)]
struct Rows {
    /// Column indices, row by row.
    own: Vec<u32>,
    /// Matrix entries, row by row.
    weights: Vec<f64>,
    /// End of each row in the two lists.
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
    /// Column indices and entries of each row.
    fn iter(&self) -> impl Iterator<Item = impl Iterator<Item = (usize, f64)>> {
        let mut start = 0;
        self.ends.iter().map(move |&end| {
            let row = core::mem::replace(&mut start, end as usize)..end as usize;
            let own = self.own[row.clone()].iter().map(|&own| own as usize);
            own.zip(self.weights[row].iter().copied())
        })
    }
    /// Product of the matrix with the axial nodal values `line`.
    fn sums(&self, line: &[f64]) -> impl Iterator<Item = f64> {
        self.iter()
            .map(|row| row.map(|(own, weight)| weight * line[own]).sum())
    }
    /// Adds the product of the transposed matrix with one value per row to `line`.
    fn add<'v>(&self, values: impl Iterator<Item = &'v f64>, line: &mut [f64]) {
        for (row, &value) in self.iter().zip(values) {
            for (own, weight) in row {
                line[own] += weight * value;
            }
        }
    }
}

/// Interpolation of the segment ends of a bolt from the nodes of its host elements, two points per segment.
///
/// Segments share hosts and hosts share nodes, so that a node contributes to several points of a bolt. Its axial
/// displacement is read and its axial force written once; all products use these scalar nodal values (`line`).
#[derive(Debug)]
pub(super) struct Interpolation {
    direction: Vec3,
    /// Indices of the nodes in the block, in rising order.
    nodes: Vec<u32>,
    /// Interpolation of the points.
    points: Rows,
    /// Elongation of the segments: the second point of each less the first.
    stretches: Rows,
}

impl Interpolation {
    /// From the points of a bolt, head first; `index` is the index of a mesh node in the block.
    pub(super) fn new<'h>(
        direction: Vec3,
        points: impl Iterator<Item = &'h HostPoint> + Clone,
        index: impl Fn(u32) -> u32,
    ) -> Self {
        let all = points.clone().flat_map(|point| &point.nodes);
        let mut nodes: Vec<u32> = all.map(|&node| index(node)).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let own = |node: u32| {
            let index = index(node);
            nodes.partition_point(|&other| other < index) as u32
        };
        let mut rows = Rows::default();
        for point in points {
            let columns = point.nodes.iter().map(|&node| own(node));
            rows.push(columns.zip(point.weights.iter().copied()));
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
            nodes,
        }
    }

    /// Unit vector from head to toe.
    pub(super) fn direction(&self) -> Vec3 {
        self.direction
    }
    /// Indices in the block of the nodes of the host elements, in rising order.
    pub(super) fn nodes(&self) -> &[u32] {
        &self.nodes
    }

    /// Axial displacements (m) of the nodes, from displacements by index in the block.
    fn read(&self, displacement: impl Fn(u32) -> Vec3, line: &mut Vec<f64>) {
        line.clear();
        let along = |&node: &u32| self.direction.dot(&displacement(node));
        line.extend(self.nodes.iter().map(along));
    }

    /// Axial displacements (m) of the points, from displacements of the block's nodes; `line` is a buffer.
    pub(super) fn axial(
        &self,
        displacement: impl Fn(u32) -> Vec3,
        line: &mut Vec<f64>,
        out: &mut Vec<[f64; 2]>,
    ) {
        self.read(displacement, line);
        self.interpolate(line, out);
    }

    /// Elongation (m) of each segment, from displacements of the block's nodes; `line` is a buffer.
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

    /// Axial values at the points, from axial values at the nodes.
    pub(super) fn interpolate(&self, line: &[f64], out: &mut Vec<[f64; 2]>) {
        out.clear();
        let mut sums = self.points.sums(line);
        while let (Some(first), Some(second)) = (sums.next(), sums.next()) {
            out.push([first, second]);
        }
    }

    /// Axial nodal forces (N) of axial forces at the points.
    pub(super) fn gather(&self, forces: &[[f64; 2]], line: &mut Vec<f64>) {
        line.clear();
        line.resize(self.nodes.len(), 0.0);
        self.points.add(forces.iter().flatten(), line);
    }

    /// Adds axial forces (N) at the points to the nodal forces.
    pub(super) fn spread(&self, forces: &[[f64; 2]], line: &mut Vec<f64>, out: &mut [Vec3]) {
        self.gather(forces, line);
        self.write(line, out);
    }

    /// Adds axial tension (N) of the segments to the nodal forces.
    pub(super) fn spread_tension(&self, forces: &[f64], line: &mut Vec<f64>, out: &mut [Vec3]) {
        line.clear();
        line.resize(self.nodes.len(), 0.0);
        self.stretches.add(forces.iter(), line);
        self.write(line, out);
    }

    fn write(&self, line: &[f64], out: &mut [Vec3]) {
        for (&node, &force) in self.nodes.iter().zip(line) {
            out[node as usize] += self.direction * force;
        }
    }
}
