//! Lumping of `T`, the nodal sums of the stress on sections normal to y: rows of its dependence on velocities.
//!
//! An element with the velocities `v_j` of its pairs has the strain `-s v` along y, and with it `T_i = ... - s A_ij v_j`, `A` a
//! consistent matrix: a stiffness times a volume. Lumped it is `-s A_i v_i` with the sum `A_i` of the row, by which
//! `T_i` changes by `s A_ij (v_j - v_i)`.
//!
//! Where damage has taken a share of the stiffness of an element, its matrix counts with the share that is left: with the
//! whole of it, the velocities of the step before would act with more stiffness than there is, and the motion of a part that breaks
//! would diverge near the highest slowness. Plastic flow leaves the whole.

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

/// The rows of `A` of all groups: one of each of their elements.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lumping {
    /// Rows of each group, by offsets.
    rows_of: Vec<u32>,
    /// Element of each row, in the order of the blocks.
    element_of: Vec<u32>,
    /// Entries of each row, by offsets.
    entries_of: Vec<u32>,
    entries: Vec<Entry>,
    /// Names of the damage variables of each block, with its first element.
    damage_of: Vec<(u32, Vec<String>)>,
    /// Share of the stiffness of each element that damage leaves (1); empty if no block damages.
    remaining: Vec<f64>,
    /// Place of each entry in `merged`.
    merged_of: Vec<u32>,
    /// Rows of all elements of each group together, by offsets.
    merged_offsets: Vec<u32>,
    merged: Vec<Entry>,
    /// Sum of the entries of all rows of each group along each axis, `A_i` (N m).
    rigidity: Vec<Vec3>,
}

/// A row under construction: its group, element and entries.
type Row = (u32, u32, Vec<Entry>);

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
        let mut element = 0;
        let mut damage_of = Vec::new();
        for (index, block) in blocks.iter().enumerate() {
            let nodes = subdomain.nodes_of(index);
            damage_of.push((element, damage_variables(block.as_ref())));
            block.each_matrix(Operator::Elastic, &mut |local, matrix| {
                let places = local.iter().map(|&n| place[nodes[n as usize] as usize]);
                let places: Vec<(u32, f64)> = places.collect();
                let place = (element, half);
                element += 1;
                if !add_rows(&places, (matrix, place), &mut rows) {
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
        rows.sort_by_key(|(group, element, _)| (*group, *element));
        let groups = place.iter().map(|(group, _)| group + 1).max().unwrap_or(0) as usize;
        let mut lumping = Self {
            rigidity: vec![Vec3::zeros(); groups],
            entries_of: vec![0],
            ..Self::default()
        };
        for (_, element, row) in &rows {
            lumping.entries.extend(row);
            lumping.entries_of.push(lumping.entries.len() as u32);
            lumping.element_of.push(*element);
        }
        let start = |group: usize| rows.partition_point(|(g, ..)| (*g as usize) < group) as u32;
        lumping.rows_of = (0..=groups).map(start).collect();
        if damage_of.iter().any(|(_, names)| !names.is_empty()) {
            lumping.damage_of = damage_of;
            lumping.remaining = vec![1.0; element as usize];
        }
        lumping.merge(groups);
        lumping.add_up();
        Ok(lumping)
    }

    /// Finds the neighbours of all groups.
    fn merge(&mut self, groups: usize) {
        self.merged_offsets.push(0);
        for group in 0..groups {
            let [from, to] = [group, group + 1].map(|group| {
                let row = self.rows_of[group];
                self.entries_of[row as usize] as usize
            });
            let own = self.entries[from..to].iter().map(|entry| entry.group);
            let mut others: Vec<u32> = own.clone().collect();
            others.sort_unstable();
            others.dedup();
            let first = self.merged.len();
            let place = |other: u32| (first + others.partition_point(|o| *o < other)) as u32;
            self.merged_of.extend(own.map(place));
            self.merged.extend(others.iter().map(|&group| Entry {
                group,
                plane: [0.0; 4],
                axial: 0.0,
            }));
            self.merged_offsets.push(self.merged.len() as u32);
        }
    }

    /// Adds up the rows of all groups.
    fn add_up(&mut self) {
        for entry in &mut self.merged {
            (entry.plane, entry.axial) = ([0.0; 4], 0.0);
        }
        for row in 0..self.element_of.len() {
            let share = self.share(row as u32);
            let [from, to] = [row, row + 1].map(|row| self.entries_of[row] as usize);
            for (entry, &place) in self.entries[from..to].iter().zip(&self.merged_of[from..to]) {
                let merged = &mut self.merged[place as usize];
                for (sum, own) in merged.plane.iter_mut().zip(entry.plane) {
                    *sum += share * own;
                }
                merged.axial += share * entry.axial;
            }
        }
        for (group, rigidity) in self.rigidity.iter_mut().enumerate() {
            let own = self.merged_offsets[group] as usize..self.merged_offsets[group + 1] as usize;
            let sums = self.merged[own].iter();
            let sums = sums.map(|entry| Vec3::new(entry.plane[0], entry.axial, entry.plane[3]));
            *rigidity = sums.sum();
        }
    }

    /// Share of the stiffness that is left to the element of a row.
    fn share(&self, row: u32) -> f64 {
        let element = self.element_of[row as usize];
        self.remaining.get(element as usize).copied().unwrap_or(1.0)
    }

    /// Takes over the damage of all elements from the committed history variables.
    pub(super) fn follow_damage(&mut self, blocks: &[Box<dyn ElementBlock>]) {
        if self.remaining.is_empty() {
            return;
        }
        let mut changed = false;
        for (block, (first, names)) in blocks.iter().zip(&self.damage_of) {
            if names.is_empty() {
                continue;
            }
            for index in 0..block.elements().len() {
                let of = |name: &String| block.shown_history(index, name).unwrap_or(0.0);
                let left = names
                    .iter()
                    .map(|name| 1.0 - of(name).clamp(0.0, 1.0))
                    .product();
                let known = &mut self.remaining[*first as usize + index];
                changed |= *known != left;
                *known = left;
            }
        }
        if changed {
            self.add_up();
        }
    }

    /// `A_i` of a group along each axis (N m).
    pub(crate) fn rigidity(&self, group: usize) -> Vec3 {
        self.rigidity[group]
    }

    /// `A_ij (v_j - v_i)` of a group, from the velocities (m/s) of all groups (N).
    pub(crate) fn spread(&self, group: usize, velocity: impl Fn(usize) -> Vec3) -> Vec3 {
        let own = velocity(group);
        let mut sum = Vec3::zeros();
        let from = self.merged_offsets[group] as usize;
        let to = self.merged_offsets[group + 1] as usize;
        for entry in &self.merged[from..to] {
            let change = velocity(entry.group as usize) - own;
            let [xx, xz, zx, zz] = entry.plane;
            sum.x += xx * change.x + xz * change.z;
            sum.y += entry.axial * change.y;
            sum.z += zx * change.x + zz * change.z;
        }
        sum
    }
}

/// Names of the history variables of a block that are damage, from 0 to 1: `damage`, or where a law has none its parts.
fn damage_variables(block: &dyn ElementBlock) -> Vec<String> {
    let names = block.history().into_iter().map(|field| field.name);
    let names: Vec<String> = names.filter(|name| name.contains("damage")).collect();
    if names.iter().any(|name| name == WHOLE) {
        return vec![WHOLE.into()];
    }
    names
        .into_iter()
        .filter(|name| !name.contains("type"))
        .collect()
}

/// The damage of all causes together, as laws call it.
const WHOLE: &str = "damage";

/// Adds the rows of an element with a stiffness matrix (N/m) between nodes with groups and signs; returns whether y is
/// not coupled with x and z.
fn add_rows(
    places: &[(u32, f64)],
    (matrix, (element, half)): (&[f64], (u32, f64)),
    rows: &mut Vec<Row>,
) -> bool {
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
    let scale = sums
        .iter()
        .flatten()
        .flatten()
        .fold(0.0, |m: f64, x| m.max(x.abs()));
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
        rows.push((*row, element, own.collect()));
    }
    !sums.iter().any(coupled)
}
