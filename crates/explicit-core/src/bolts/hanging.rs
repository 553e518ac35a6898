//! How a bolt hangs on the nodes of its hosts.

use powerhouse_model::Vec3;

use super::embedding::HostPoint;

/// The points of a bolt on the nodes around them: two for each segment.
///
/// Segments share hosts and hosts share nodes, so that each node is met several times along a bolt. It
/// is read and written once: between, everything is along one line.
#[derive(Debug)]
pub(super) struct Hanging {
    direction: Vec3,
    /// Places of the nodes in the block, in rising order.
    places: Vec<u32>,
    /// Of all points one after the other: which of the places, and the weight.
    weights: Vec<(u32, f64)>,
    /// Where the weights of each point end.
    ends: Vec<u32>,
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
        let mut weights = Vec::new();
        let mut ends = Vec::new();
        for point in points {
            for (&node, &weight) in point.nodes.iter().zip(&point.weights) {
                let place = place(node);
                let own = places.partition_point(|&other| other < place);
                weights.push((own as u32, weight));
            }
            ends.push(weights.len() as u32);
        }
        Self {
            direction,
            places,
            weights,
            ends,
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

    /// Axial displacements (m) of the points, from the displacements at places; `line` is room to compute
    /// in.
    pub(super) fn axial(
        &self,
        displacement: impl Fn(u32) -> Vec3,
        line: &mut Vec<f64>,
        out: &mut Vec<[f64; 2]>,
    ) {
        line.clear();
        let along = |&place: &u32| self.direction.dot(&displacement(place));
        line.extend(self.places.iter().map(along));
        self.interpolate(line, out);
    }

    /// Values at the points, from values at the places.
    pub(super) fn interpolate(&self, line: &[f64], out: &mut Vec<[f64; 2]>) {
        out.clear();
        let mut start = 0;
        out.extend(self.ends.chunks_exact(2).map(|ends| {
            let mut pair = [0.0; 2];
            for (value, &end) in pair.iter_mut().zip(ends) {
                for &(own, weight) in &self.weights[start..end as usize] {
                    *value += weight * line[own as usize];
                }
                start = end as usize;
            }
            pair
        }));
    }

    /// Axial forces (N) at the places of those at the points.
    pub(super) fn gather(&self, forces: &[[f64; 2]], line: &mut Vec<f64>) {
        line.clear();
        line.resize(self.places.len(), 0.0);
        let mut start = 0;
        for (&force, &end) in forces.iter().flatten().zip(&self.ends) {
            for &(own, weight) in &self.weights[start..end as usize] {
                line[own as usize] += weight * force;
            }
            start = end as usize;
        }
    }

    /// Adds axial forces (N) at the points to the nodes.
    pub(super) fn spread(&self, forces: &[[f64; 2]], line: &mut Vec<f64>, out: &mut [Vec3]) {
        self.gather(forces, line);
        for (&place, &force) in self.places.iter().zip(line.iter()) {
            out[place as usize] += self.direction * force;
        }
    }
}
