//! Assembly of the sparse stiffness matrix.

use powerhouse_model::{Mat3, Operator, Vec3};

use super::dissection::{self, Neighbours};
use crate::statics::freedoms::DegreesOfFreedom;
use crate::statics::system::System;

/// Index of a node without unknowns.
const NONE: u32 = u32::MAX;

/// Sparsity pattern of the stiffness matrix: upper triangle in compressed columns, in the elimination order.
pub(super) struct Pattern {
    freedoms: DegreesOfFreedom,
    /// Lead nodes in the elimination order.
    pub(super) order: Vec<u32>,
    /// Index in the elimination order, by node.
    index_of: Vec<u32>,
    /// First unknown of each lead node in the elimination order, and the number of unknowns at the end.
    first: Vec<usize>,
    /// For each lead node the lead nodes at or before it in the elimination order that share an element with it, rising, as
    /// offsets and a flat list.
    starts: Vec<usize>,
    rows: Vec<u32>,
    /// For each entry of `rows` the number of matrix rows before it in the columns of its lead node.
    offsets: Vec<u32>,
    /// Column pointers and row indices of the unknowns.
    pub(super) columns: Vec<usize>,
    pub(super) indices: Vec<usize>,
}

impl Pattern {
    /// The pattern of the equations of a system.
    pub(super) fn new(system: &System) -> Self {
        let (freedoms, positions) = (system.freedoms(), system.positions());
        let leads = freedoms.leads();
        let mut index_of = vec![NONE; positions.len()];
        for (index, &lead) in leads.iter().enumerate() {
            index_of[lead as usize] = index as u32;
        }
        let neighbours = neighbours(system, &freedoms, &index_of, leads.len());
        let of_leads: Vec<Vec3> = (leads.iter())
            .map(|&lead| positions[lead as usize])
            .collect();
        let order = dissection::order(&of_leads, &neighbours);
        let mut rank = vec![0; leads.len()];
        for (position, &lead) in order.iter().enumerate() {
            rank[lead as usize] = position as u32;
        }

        let (mut first, mut starts) = (vec![0], vec![0]);
        let (mut rows, mut offsets) = (Vec::new(), Vec::new());
        let (mut columns, mut indices) = (vec![0], Vec::new());
        let count = |index: u32| freedoms.free(leads[order[index as usize] as usize]).count;
        for position in 0..order.len() as u32 {
            let of_lead = order[position as usize] as usize;
            let others = &neighbours.nodes[neighbours.starts[of_lead]..];
            let others = &others[..neighbours.starts[of_lead + 1] - neighbours.starts[of_lead]];
            let others = others.iter().map(|&other| rank[other as usize]);
            let mut before: Vec<u32> = others.filter(|&other| other < position).collect();
            before.push(position);
            before.sort_unstable();
            before.dedup();
            let mut offset = 0;
            for &row in &before {
                offsets.push(offset);
                offset += count(row) as u32;
            }
            let start: usize = first[position as usize];
            first.push(start + count(position));
            for column in 0..count(position) {
                for &row in &before {
                    let most = if row == position {
                        column + 1
                    } else {
                        count(row)
                    };
                    let from = first[row as usize];
                    indices.extend(from..from + most);
                }
                columns.push(indices.len());
            }
            rows.extend(before);
            starts.push(rows.len());
        }
        for index in index_of.iter_mut().filter(|index| **index != NONE) {
            *index = rank[*index as usize];
        }
        Self {
            order: order.iter().map(|&index| leads[index as usize]).collect(),
            freedoms,
            index_of,
            first,
            starts,
            rows,
            offsets,
            columns,
            indices,
        }
    }

    /// Number of unknowns.
    pub(super) fn size(&self) -> usize {
        self.columns.len() - 1
    }

    /// The lead node of an unknown.
    pub(super) fn lead_of(&self, unknown: usize) -> u32 {
        let index = self.first.partition_point(|&first| first <= unknown) - 1;
        self.order[index]
    }

    /// Assembles the symmetric part of the operator of all blocks and the springs of groups (N/m) into the
    /// entries of the pattern.
    pub(super) fn assemble(&self, system: &System, operator: Operator) -> Vec<f64> {
        let mut values = vec![0.0; self.indices.len()];
        for group in system.groups() {
            if let Some(lead) = self.freedoms.lead(group.members[0]) {
                let index = self.index_of[lead as usize];
                self.add(&mut values, (index, index), &group.spring);
            }
        }
        let mut indices = Vec::new();
        let blocks = system.blocks();
        for block in 0..blocks.count() {
            blocks.each_matrix(block, operator, |nodes, matrix| {
                indices.clear();
                let leads = nodes.iter().map(|&node| self.freedoms.lead(node));
                indices.extend(leads.map(|lead| lead.map(|lead| self.index_of[lead as usize])));
                let size = 3 * nodes.len();
                for (a, &row) in indices.iter().enumerate() {
                    for (b, &column) in indices.iter().enumerate() {
                        let (Some(row), Some(column)) = (row, column) else {
                            continue;
                        };
                        if row > column {
                            continue;
                        }
                        let entry = |i: usize, j: usize| matrix[i * size + j];
                        let part = Mat3::from_fn(|i, j| {
                            let (i, j) = (3 * a + i, 3 * b + j);
                            0.5 * (entry(i, j) + entry(j, i))
                        });
                        self.add(&mut values, (row, column), &part);
                    }
                }
            });
        }
        values
    }

    /// Adds a 3 x 3 matrix at the row and column of two lead nodes, given by their index in the elimination order.
    fn add(&self, values: &mut [f64], (row, column): (u32, u32), part: &Mat3) {
        let [from, to] = [row, column].map(|index| {
            let lead = self.order[index as usize];
            self.freedoms.free(lead)
        });
        let part = from.directions.transpose() * part * to.directions;
        let range = self.starts[column as usize]..self.starts[column as usize + 1];
        let at = range.start + self.rows[range].partition_point(|&other| other < row);
        let offset = self.offsets[at] as usize;
        for j in 0..to.count {
            let start = self.columns[self.first[column as usize] + j] + offset;
            let most = if row == column { j + 1 } else { from.count };
            for i in 0..most {
                values[start + i] += part[(i, j)];
            }
        }
    }

    /// The vector of unknowns of a reduced nodal vector.
    pub(super) fn take(&self, vector: &[Vec3]) -> Vec<f64> {
        let mut unknowns = Vec::with_capacity(self.size());
        for &lead in &self.order {
            let free = self.freedoms.free(lead);
            let along = free.directions.transpose() * vector[lead as usize];
            unknowns.extend_from_slice(&along.as_slice()[..free.count]);
        }
        unknowns
    }

    /// The reduced nodal vector of a vector of unknowns.
    pub(super) fn spread(&self, unknowns: &[f64]) -> Vec<Vec3> {
        let mut vector = vec![Vec3::zeros(); self.index_of.len()];
        for (index, &lead) in self.order.iter().enumerate() {
            let free = self.freedoms.free(lead);
            let first = self.first[index];
            for j in 0..free.count {
                vector[lead as usize] += free.directions.column(j) * unknowns[first + j];
            }
        }
        vector
    }
}

/// Adjacency of lead nodes that share an element, by index; each is its own neighbour, too.
fn neighbours(
    system: &System,
    freedoms: &DegreesOfFreedom,
    index_of: &[u32],
    count: usize,
) -> Neighbours {
    let mut lists: Vec<Vec<u32>> = vec![Vec::new(); count];
    let mut indices = Vec::new();
    let blocks = system.blocks();
    for block in 0..blocks.count() {
        blocks.each_matrix(block, Operator::Elastic, |nodes, _| {
            indices.clear();
            let leads = nodes.iter().filter_map(|&node| freedoms.lead(node));
            indices.extend(leads.map(|lead| index_of[lead as usize]));
            for &a in &indices {
                for &b in &indices {
                    let list = &mut lists[a as usize];
                    if !list.contains(&b) {
                        list.push(b);
                    }
                }
            }
        });
    }
    let (mut starts, mut nodes) = (vec![0], Vec::new());
    for list in lists {
        nodes.extend(list);
        starts.push(nodes.len());
    }
    Neighbours { starts, nodes }
}
