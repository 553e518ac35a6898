//! Interpolation of the bolts of a block from the nodes of their host elements (embedded element constraint). This is
//! hot code.

use std::collections::BTreeMap;

use powerhouse_model::{Quad, Vec3};

use super::Embedded;

/// Number of rows of a matrix that are multiplied side by side.
const LANES: usize = 8;

/// A sparse matrix, by rows: column indices and entries.
type Rows = Vec<Vec<(u32, f64)>>;

/// A sparse matrix for products, several rows side by side; shorter rows have zeros at their ends.
#[derive(Debug)]
struct Lanes {
    columns: Vec<[u32; LANES]>,
    weights: Vec<[f64; LANES]>,
    /// End of each group of rows in the two lists.
    ends: Vec<u32>,
}

impl Lanes {
    fn new(rows: &Rows) -> Self {
        let mut lanes = Self {
            columns: Vec::new(),
            weights: Vec::new(),
            ends: Vec::new(),
        };
        for group in rows.chunks(LANES) {
            for entry in 0..group.iter().map(Vec::len).max().unwrap_or(0) {
                let (mut columns, mut weights) = ([0; LANES], [0.0; LANES]);
                for (lane, row) in group.iter().enumerate() {
                    // Zeros read what their own row reads: a number that is not finite stays in its rows.
                    let own = row.first().map_or(0, |(column, _)| *column);
                    (columns[lane], weights[lane]) = row.get(entry).copied().unwrap_or((own, 0.0));
                }
                lanes.columns.push(columns);
                lanes.weights.push(weights);
            }
            lanes.ends.push(lanes.columns.len() as u32);
        }
        lanes
    }

    /// Product with a vector, the products of a row summed in the order of its entries; with some values beyond the last
    /// row.
    #[inline(always)]
    fn product(&self, vector: &[f64], out: &mut Vec<f64>) {
        out.clear();
        let mut start = 0;
        for &end in &self.ends {
            let group = start..end as usize;
            let mut sums = [0.0; LANES];
            for (columns, weights) in self.columns[group.clone()].iter().zip(&self.weights[group]) {
                for lane in 0..LANES {
                    sums[lane] += weights[lane] * vector[columns[lane] as usize];
                }
            }
            out.extend_from_slice(&sums);
            start = end as usize;
        }
    }
}

/// An axis of bolts with its nodal values.
#[derive(Debug)]
struct Axis {
    /// Unit vector from head to toe.
    direction: Vec3,
    /// End of its nodal values among those of the block.
    end: u32,
}

/// Interpolation of the segment ends of all bolts of a block from the nodes of their host elements, two points per
/// segment.
///
/// Segments share hosts, hosts share nodes, and parallel bolts share an axis, so that a node contributes to several
/// points. For each axis its axial displacement is read and its axial force written once; all products use these scalar
/// nodal values (`line`), axis by axis in one list.
#[derive(Debug)]
pub(super) struct Interpolation {
    axes: Vec<Axis>,
    /// Axis of each bolt.
    axis_of: Vec<u32>,
    /// Index in the block of the node of each nodal value, in rising order for each axis.
    nodes: Vec<u32>,
    /// Interpolation of the points.
    points: Rows,
    /// Elongation of the segments: the second point of each less the first.
    stretches: Rows,
    /// The same for products, and its transpose.
    elongations: Lanes,
    tensions: Lanes,
}

impl Interpolation {
    /// Of some bolts; `index` is the index of a mesh node in the block.
    pub(super) fn new<'b>(
        bolts: impl Iterator<Item = &'b Embedded> + Clone,
        index: impl Fn(u32) -> u32,
    ) -> Self {
        // Axes in the order of their first bolts, each with its nodes.
        let mut axis_with: BTreeMap<[u64; 3], u32> = BTreeMap::new();
        let mut axes: Vec<(Vec3, BTreeMap<u32, u32>)> = Vec::new();
        let mut axis_of = Vec::new();
        for bolt in bolts.clone() {
            let key = [0, 1, 2].map(|c| bolt.direction[c].to_bits());
            let axis = *axis_with.entry(key).or_insert_with(|| {
                axes.push((bolt.direction, BTreeMap::new()));
                axes.len() as u32 - 1
            });
            axis_of.push(axis);
            for point in bolt.segments.iter().flat_map(|segment| &segment.ends) {
                let acting = point.nodes.iter().zip(&point.weights);
                let acting = acting.filter(|(_, weight)| **weight != 0.0);
                let nodes = acting.map(|(&node, _)| (index(node), 0));
                axes[axis as usize].1.extend(nodes);
            }
        }
        let mut nodes = Vec::new();
        for (_, column_of) in &mut axes {
            for (&node, column) in column_of {
                *column = nodes.len() as u32;
                nodes.push(node);
            }
        }
        let (mut points, mut stretches) = (Rows::new(), Rows::new());
        for (bolt, &axis) in bolts.zip(&axis_of) {
            let column_of = &axes[axis as usize].1;
            for segment in &bolt.segments {
                let ends = [0, 1].map(|end| -> Vec<(u32, f64)> {
                    let point = &segment.ends[end];
                    let acting = point.nodes.iter().zip(&point.weights);
                    let acting = acting.filter(|(_, weight)| **weight != 0.0);
                    acting
                        .map(|(&n, &weight)| (column_of[&index(n)], weight))
                        .collect()
                });
                let mut stretch: BTreeMap<u32, f64> = ends[1].iter().copied().collect();
                for &(column, weight) in &ends[0] {
                    *stretch.entry(column).or_default() -= weight;
                }
                points.extend(ends);
                let acting = stretch.into_iter().filter(|(_, weight)| *weight != 0.0);
                stretches.push(acting.collect());
            }
        }
        let mut transposed = vec![Vec::new(); nodes.len()];
        for (segment, row) in (0..).zip(&stretches) {
            for &(column, weight) in row {
                transposed[column as usize].push((segment, weight));
            }
        }
        let ends = axes.iter().scan(0, |end, (direction, column_of)| {
            *end += column_of.len() as u32;
            Some(Axis {
                direction: *direction,
                end: *end,
            })
        });
        Self {
            axes: ends.collect(),
            axis_of,
            nodes,
            elongations: Lanes::new(&stretches),
            tensions: Lanes::new(&transposed),
            points,
            stretches,
        }
    }

    /// Number of axial nodal values.
    pub(super) fn value_count(&self) -> usize {
        self.nodes.len()
    }
    /// Unit vector of a bolt from head to toe.
    pub(super) fn direction(&self, bolt: usize) -> Vec3 {
        self.axes[self.axis_of[bolt] as usize].direction
    }
    /// Indices of the nodal values that act on some segments, in rising order.
    pub(super) fn values_of(&self, segments: core::ops::Range<usize>) -> Vec<usize> {
        let points = self.points[2 * segments.start..2 * segments.end].iter();
        let mut values: Vec<usize> = points
            .flatten()
            .map(|(column, _)| *column as usize)
            .collect();
        values.sort_unstable();
        values.dedup();
        values
    }
    /// Index in the block of the node of a nodal value.
    pub(super) fn node(&self, value: usize) -> u32 {
        self.nodes[value]
    }

    /// Axial displacements (m) of the nodes, from displacements by index in the block.
    #[inline(always)]
    pub(super) fn read(&self, displacement: impl Fn(u32) -> Vec3, line: &mut Vec<f64>) {
        line.clear();
        line.reserve(self.nodes.len());
        let mut start = 0;
        for axis in &self.axes {
            let end = axis.end as usize;
            let along = |&node: &u32| axis.direction.dot(&displacement(node));
            line.extend(self.nodes[start..end].iter().map(along));
            start = end;
        }
    }

    /// Elongations (m) of all segments from axial values at the nodes; the list may be longer.
    #[inline(always)]
    pub(super) fn elongations(&self, line: &[f64], out: &mut Vec<f64>) {
        self.elongations.product(line, out);
    }

    /// Axial nodal forces (N) of the tensions (N) of all segments; the list may be longer.
    #[inline(always)]
    pub(super) fn tensions(&self, forces: &[f64], axial: &mut Vec<f64>) {
        self.tensions.product(forces, axial);
    }

    /// Elongation (m) of a segment, from axial values at the nodes.
    pub(super) fn elongation(&self, segment: usize, line: &[f64]) -> f64 {
        product(&self.stretches[segment], line)
    }

    /// Adds the tension (N) of a segment to the axial nodal forces.
    pub(super) fn add_tension(&self, segment: usize, force: f64, line: &mut [f64]) {
        add(&self.stretches[segment], force, line);
    }

    /// Axial values at the two points of a segment, from axial values at the nodes.
    pub(super) fn ends(&self, segment: usize, line: &[f64]) -> [f64; 2] {
        [0, 1].map(|end| product(&self.points[2 * segment + end], line))
    }

    /// Adds axial forces (N) at the two points of a segment to the axial nodal forces.
    pub(super) fn add_ends(&self, segment: usize, forces: &[f64; 2], line: &mut [f64]) {
        for (end, &force) in forces.iter().enumerate() {
            add(&self.points[2 * segment + end], force, line);
        }
    }

    /// Writes the forces (N) at the nodes of the block from axial nodal forces.
    #[inline(always)]
    pub(super) fn write(&self, line: &[f64], out: &mut [Quad<f64>]) {
        out.fill(Quad::default());
        let mut start = 0;
        for axis in &self.axes {
            let end = axis.end as usize;
            let [x, y, z]: [f64; 3] = axis.direction.into();
            for (&node, &force) in self.nodes[start..end].iter().zip(&line[start..end]) {
                let values = &mut out[node as usize].values;
                for (value, along) in values.iter_mut().zip([x, y, z, 0.0]) {
                    *value += along * force;
                }
            }
            start = end;
        }
    }
}

/// Product of a row with a vector.
fn product(row: &[(u32, f64)], line: &[f64]) -> f64 {
    let terms = row.iter();
    terms
        .map(|&(column, weight)| weight * line[column as usize])
        .sum()
}

/// Adds a row times a value to a vector.
fn add(row: &[(u32, f64)], value: f64, line: &mut [f64]) {
    for &(column, weight) in row {
        line[column as usize] += weight * value;
    }
}
