//! Lumping of `T`, the nodal sums of the stress on sections normal to y: rows of its dependence on velocities.
//!
//! An element with the velocities `v_j` of its pairs has the strain `-s v` along y, and with it `T_i = ... - s A_ij v_j`, `A` a
//! consistent matrix: a stiffness times a volume. Lumped it is `-s A_i v_i` with the sum `A_i` of the row, by which
//! `T_i` changes by `s A_ij (v_j - v_i)`.

use powerhouse_model::{ElementBlock, EngineError, Operator, Vec3};

use crate::subdomain::Subdomain;

/// Coupling of y with x and z over the largest entry of a matrix, above which an element is not extruded along y.
const COUPLED: f64 = 1e-8;

/// Entries of a row: those of one other pair of an element.
#[derive(Clone, Copy, Debug)]
struct Entry {
    group: u32,
    /// Of x and z by x and z, row by row (N m).
    plane: [f64; 4],
    /// Of y by y (N m).
    axial: f64,
}

/// The rows of `A` of one group: one of each of its elements.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lumping {
    /// Rows of each group, by offsets.
    rows_of: Vec<u32>,
    /// Entries of each row, by offsets.
    entries_of: Vec<u32>,
    entries: Vec<Entry>,
    /// Sum of the entries of all rows of each group along each axis, `A_i` (N m).
    rigidity: Vec<Vec3>,
}

/// A row under construction: its group and entries.
type Row = (u32, Vec<Entry>);

impl Lumping {
    /// From the elastic matrices of all elements; `place` has the group of each node and the sign of its side, `half` is half
    /// the distance of the sides (m).
    pub(super) fn new(
        blocks: &[Box<dyn ElementBlock>],
        subdomain: &Subdomain,
        place: &[(u32, f64)],
        half: f64,
    ) -> Result<Self, EngineError> {
        let mut rows: Vec<Row> = Vec::new();
        let mut coupled = None;
        for (index, block) in blocks.iter().enumerate() {
            let nodes = subdomain.nodes_of(index);
            block.each_matrix(Operator::Elastic, &mut |local, matrix| {
                let places = local.iter().map(|&n| place[nodes[n as usize] as usize]);
                let places: Vec<(u32, f64)> = places.collect();
                if !add_rows(&places, (matrix, half), &mut rows) {
                    coupled = Some(block.label().to_owned());
                }
            });
        }
        if let Some(set) = coupled {
            return Err(EngineError::DelayedWith {
                what: format!("set '{set}', whose elements couple motion along y with that across"),
                way: "take isotropic laws and elements extruded along y",
            });
        }
        rows.sort_by_key(|(group, _)| *group);
        let groups = place.iter().map(|(group, _)| group + 1).max().unwrap_or(0) as usize;
        let mut lumping = Self {
            rigidity: vec![Vec3::zeros(); groups],
            entries_of: vec![0],
            ..Self::default()
        };
        for (group, row) in &rows {
            for entry in row {
                let sum = Vec3::new(entry.plane[0], entry.axial, entry.plane[3]);
                lumping.rigidity[*group as usize] += sum;
            }
            lumping.entries.extend(row);
            lumping.entries_of.push(lumping.entries.len() as u32);
        }
        let start = |group: usize| rows.partition_point(|(g, _)| (*g as usize) < group) as u32;
        lumping.rows_of = (0..=groups).map(start).collect();
        Ok(lumping)
    }

    /// `A_i` of a group along each axis (N m).
    pub(crate) fn rigidity(&self, group: usize) -> Vec3 {
        self.rigidity[group]
    }

    /// `A_ij (v_j - v_i)` of a group, from the velocities (m/s) of all groups (N).
    pub(crate) fn spread(&self, group: usize, velocity: impl Fn(usize) -> Vec3) -> Vec3 {
        let own = velocity(group);
        let mut sum = Vec3::zeros();
        for row in self.rows_of[group]..self.rows_of[group + 1] {
            let [from, to] = [row, row + 1].map(|row| self.entries_of[row as usize] as usize);
            for entry in &self.entries[from..to] {
                let change = velocity(entry.group as usize) - own;
                let [xx, xz, zx, zz] = entry.plane;
                sum.x += xx * change.x + xz * change.z;
                sum.y += entry.axial * change.y;
                sum.z += zx * change.x + zz * change.z;
            }
        }
        sum
    }
}

/// Adds the rows of an element with a stiffness matrix (N/m) between nodes with groups and signs; returns whether y is
/// not coupled with x and z.
fn add_rows(places: &[(u32, f64)], (matrix, half): (&[f64], f64), rows: &mut Vec<Row>) -> bool {
    let size = 3 * places.len();
    let mut groups: Vec<u32> = places.iter().map(|(group, _)| *group).collect();
    groups.sort_unstable();
    groups.dedup();
    let at = |g: u32| groups.partition_point(|&group| group < g);
    let mut sums = vec![[[0.0; 3]; 3]; groups.len() * groups.len()];
    for (i, &(of_row, row_sign)) in places.iter().enumerate() {
        for (j, &(of_column, column_sign)) in places.iter().enumerate() {
            let sum = &mut sums[at(of_row) * groups.len() + at(of_column)];
            let factor = half * half * row_sign * column_sign;
            for (c, row) in sum.iter_mut().enumerate() {
                for (d, entry) in row.iter_mut().enumerate() {
                    *entry += factor * matrix[(3 * i + c) * size + 3 * j + d];
                }
            }
        }
    }
    let scale = sums.iter().flatten().flatten().fold(0.0, |m: f64, x| m.max(x.abs()));
    let coupled = |sum: &[[f64; 3]; 3]| {
        let across = [sum[0][1], sum[1][0], sum[1][2], sum[2][1]];
        across.into_iter().any(|x| x.abs() > COUPLED * scale)
    };
    for (row, entries) in groups.iter().zip(sums.chunks(groups.len())) {
        let own = groups.iter().zip(entries).map(|(&group, sum)| Entry {
            group,
            plane: [sum[0][0], sum[0][2], sum[2][0], sum[2][2]],
            axial: sum[1][1],
        });
        rows.push((*row, own.collect()));
    }
    !sums.iter().any(coupled)
}
