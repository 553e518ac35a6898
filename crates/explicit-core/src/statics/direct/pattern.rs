//! The assembled matrix.

use powerhouse_model::{ElementBlock, Mat3, Operator, Vec3};

use super::dissection::{self, Neighbours};
use crate::groups::Group;
use crate::statics::freedoms::Freedoms;

/// A lead without unknowns.
const NONE: u32 = u32::MAX;

/// Which unknowns share an element: the upper triangle by columns, in the order of elimination.
pub(super) struct Pattern {
    freedoms: Freedoms,
    /// Leads in the order of elimination.
    pub(super) order: Vec<u32>,
    /// Place in it, by node.
    place: Vec<u32>,
    /// First unknown of each place, and how many there are in all.
    first: Vec<usize>,
    /// Places that come before or at each place and share an element with it, rising.
    starts: Vec<usize>,
    rows: Vec<u32>,
    /// Entries in a column of a place before those of a row of places.
    offsets: Vec<u32>,
    /// Column pointers and rows of the unknowns.
    pub(super) columns: Vec<usize>,
    pub(super) indices: Vec<usize>,
}

impl Pattern {
    /// Of blocks over nodes at positions (m).
    pub(super) fn new(
        blocks: &[Box<dyn ElementBlock>],
        freedoms: Freedoms,
        positions: &[Vec3],
    ) -> Self {
        let leads = freedoms.leads();
        let mut place = vec![NONE; positions.len()];
        for (index, &lead) in leads.iter().enumerate() {
            place[lead as usize] = index as u32;
        }
        let neighbours = neighbours(blocks, &freedoms, &place, leads.len());
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
        let count = |place: u32| freedoms.free(leads[order[place as usize] as usize]).count;
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
        for index in place.iter_mut().filter(|index| **index != NONE) {
            *index = rank[*index as usize];
        }
        Self {
            order: order.iter().map(|&index| leads[index as usize]).collect(),
            freedoms,
            place,
            first,
            starts,
            rows,
            offsets,
            columns,
            indices,
        }
    }

    /// How many unknowns there are.
    pub(super) fn size(&self) -> usize {
        self.columns.len() - 1
    }

    /// The lead that an unknown belongs to.
    pub(super) fn lead_of(&self, unknown: usize) -> u32 {
        let place = self.first.partition_point(|&first| first <= unknown) - 1;
        self.order[place]
    }

    /// The symmetric part of the operator of all blocks and of the springs of groups (N/m), in the
    /// entries of the pattern.
    pub(super) fn assemble(
        &self,
        blocks: &[Box<dyn ElementBlock>],
        operator: Operator,
        groups: &[Group],
    ) -> Vec<f64> {
        let mut values = vec![0.0; self.indices.len()];
        for group in groups {
            if let Some(lead) = self.freedoms.lead(group.members[0]) {
                let place = self.place[lead as usize];
                self.add(&mut values, (place, place), &group.spring);
            }
        }
        let mut places = Vec::new();
        for block in blocks {
            block.each_matrix(operator, &mut |nodes, matrix| {
                places.clear();
                let leads = nodes.iter().map(|&node| self.freedoms.lead(node));
                places.extend(leads.map(|lead| lead.map(|lead| self.place[lead as usize])));
                let size = 3 * nodes.len();
                for (a, &row) in places.iter().enumerate() {
                    for (b, &column) in places.iter().enumerate() {
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

    /// Adds what a row of places and a column of places have in common.
    fn add(&self, values: &mut [f64], (row, column): (u32, u32), part: &Mat3) {
        let [from, to] = [row, column].map(|place| {
            let lead = self.order[place as usize];
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

    /// The unknowns of a nodal vector.
    pub(super) fn take(&self, vector: &[Vec3]) -> Vec<f64> {
        let mut unknowns = Vec::with_capacity(self.size());
        for &lead in &self.order {
            let free = self.freedoms.free(lead);
            let along = free.directions.transpose() * vector[lead as usize];
            unknowns.extend_from_slice(&along.as_slice()[..free.count]);
        }
        unknowns
    }

    /// The nodal vector of unknowns, zero but at leads.
    pub(super) fn spread(&self, unknowns: &[f64]) -> Vec<Vec3> {
        let mut vector = vec![Vec3::zeros(); self.place.len()];
        for (place, &lead) in self.order.iter().enumerate() {
            let free = self.freedoms.free(lead);
            let first = self.first[place];
            for j in 0..free.count {
                vector[lead as usize] += free.directions.column(j) * unknowns[first + j];
            }
        }
        vector
    }
}

/// Which leads share an element, by place; each is its own neighbour, too.
fn neighbours(
    blocks: &[Box<dyn ElementBlock>],
    freedoms: &Freedoms,
    place: &[u32],
    count: usize,
) -> Neighbours {
    let mut lists: Vec<Vec<u32>> = vec![Vec::new(); count];
    let mut places = Vec::new();
    for block in blocks {
        block.each_matrix(Operator::Elastic, &mut |nodes, _| {
            places.clear();
            let leads = nodes.iter().filter_map(|&node| freedoms.lead(node));
            places.extend(leads.map(|lead| place[lead as usize]));
            for &a in &places {
                for &b in &places {
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
