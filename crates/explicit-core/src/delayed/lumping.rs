//! Matrices of a slice between its pairs of nodes: what they add to `T`, the nodal sums of the stress on sections normal to y.
//!
//! An element with the velocities `v_j` of its pairs has the strain `-s v` along y, and with it `T_i = ... - s A_ij v_j`, `A` a
//! consistent matrix: a stiffness times a volume. Lumped it is `-s A_i v_i` with the sum `A_i` of the row, by which
//! `T_i` changes by `s A_ij (v_j - v_i)`.
//!
//! Where damage has taken a share of the stiffness of an element, its matrix counts with the share that is left: with the
//! whole of it, the velocities of the step before would act with more stiffness than there is, and the motion of a part that breaks
//! would diverge near the highest slowness. Plastic flow leaves the whole.

use std::collections::HashMap;

use powerhouse_model::{ElementBlock, EngineError, Mat3, Operator, Vec3};

use super::stiff::{Inertia, Stiff};
use crate::subdomain::Subdomain;

/// Coupling of y with x and z over the largest entry of a matrix, above which an element is not extruded along y.
const COUPLED: f64 = 1e-8;

/// Entries of a row: those of one other pair of an element.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    pub(super) group: u32,
    /// `A` of x and z by x and z, row by row (N m).
    pub(super) plane: [f64; 4],
    /// `A` of y by y (N m).
    pub(super) axial: f64,
}

/// What an element adds to the row of a pair by one other pair: sums of its stiffness matrix over the sides of both.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sums {
    /// Stiffness (N/m): force by displacement.
    pub(super) stiffness: Mat3,
    /// `A` (N m): `T` by velocity times the slowness, with the opposite sign.
    pub(super) rigidity: Mat3,
    /// `T` by displacement (N).
    pub(super) traction: Mat3,
    /// Force by velocity times the slowness (N).
    pub(super) delayed: Mat3,
}

/// A row under construction: its group, the element and its sums by other groups.
pub(super) type Row = (u32, u32, Vec<(u32, Sums)>);

/// Elements of a block whose damage is followed: names of its damage variables, and of each element the index in the block and
/// among all elements.
type Damaged = (usize, Vec<String>, Vec<[u32; 2]>);

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
    /// Blocks with damage variables.
    damaged: Vec<Damaged>,
    /// Share of the stiffness of each element that damage leaves (1); empty if no block damages.
    remaining: Vec<f64>,
    /// Place of each entry in `merged`.
    merged_of: Vec<u32>,
    /// Rows of all elements of each group together, by offsets.
    merged_offsets: Vec<u32>,
    merged: Vec<Entry>,
    /// Elements whose P waves are faster than the motion along y.
    stiff: Stiff,
    /// What each group has of `A` as inertia.
    inertia: Inertia,
}

impl Lumping {
    /// From the rows of all elements of a slice.
    pub(super) fn new(rows: &Rows, groups: usize, stiff: Stiff) -> Self {
        let mut lumping = Self {
            entries_of: vec![0],
            stiff,
            damaged: rows.damaged.clone(),
            ..Self::default()
        };
        for (_, element, row) in &rows.rows {
            let entries = row.iter().map(|(group, sums)| {
                let a = &sums.rigidity;
                Entry {
                    group: *group,
                    plane: [a[(0, 0)], a[(0, 2)], a[(2, 0)], a[(2, 2)]],
                    axial: a[(1, 1)],
                }
            });
            lumping.entries.extend(entries);
            lumping.entries_of.push(lumping.entries.len() as u32);
            lumping.element_of.push(*element);
        }
        lumping.rows_of = rows.offsets(groups);
        if !lumping.damaged.is_empty() {
            lumping.remaining = vec![1.0; rows.elements];
        }
        lumping.merge(groups);
        lumping.add_up();
        lumping
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
        self.inertia.clear(self.merged_offsets.len() - 1);
        for group in 0..self.rows_of.len() - 1 {
            for row in self.rows_of[group]..self.rows_of[group + 1] {
                let element = self.element_of[row as usize];
                let share = self.remaining.get(element as usize).copied().unwrap_or(1.0);
                let [from, to] = [row, row + 1].map(|row| self.entries_of[row as usize] as usize);
                let mut whole = Vec3::zeros();
                let places = &self.merged_of[from..to];
                for (entry, &place) in self.entries[from..to].iter().zip(places) {
                    let merged = &mut self.merged[place as usize];
                    for (sum, own) in merged.plane.iter_mut().zip(entry.plane) {
                        *sum += share * own;
                    }
                    merged.axial += share * entry.axial;
                    whole += Vec3::new(entry.plane[0], entry.axial, entry.plane[3]);
                }
                let kept = self.stiff.kept(element);
                self.inertia.add(group, &whole, (share, &kept));
            }
        }
        self.inertia.move_rest(&self.stiff);
    }

    /// Passes on the rest of stiff elements to other groups than before.
    pub(super) fn pass_on(&mut self, stiff: Stiff) {
        self.stiff = stiff;
        self.add_up();
    }

    /// Takes over the damage of all elements from the committed history variables.
    pub(super) fn follow_damage(&mut self, blocks: &[Box<dyn ElementBlock>]) {
        let mut changed = false;
        for (block, names, elements) in &self.damaged {
            let block = &blocks[*block];
            for &[index, element] in elements {
                let of = |name: &String| block.shown_history(index as usize, name).unwrap_or(0.0);
                let left = names
                    .iter()
                    .map(|name| 1.0 - of(name).clamp(0.0, 1.0))
                    .product();
                let known = &mut self.remaining[element as usize];
                changed |= *known != left;
                *known = left;
            }
        }
        if changed {
            self.add_up();
        }
    }

    /// `A_i` of a group along each axis (N m) that is taken from its mass.
    pub(crate) fn rigidity(&self, group: usize) -> Vec3 {
        self.inertia.of(group)
    }

    /// `A_ij v_j` of a group, less `A_i v_i`, from the velocities (m/s) of all groups (N).
    pub(crate) fn spread(&self, group: usize, velocity: impl Fn(usize) -> Vec3) -> Vec3 {
        let own = velocity(group);
        let mut sum = self.inertia.moved_from(group).component_mul(&own);
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

/// Rows of all elements of a slice, in the order of their groups.
pub(super) struct Rows {
    pub(super) rows: Vec<Row>,
    damaged: Vec<Damaged>,
    /// Number of elements.
    elements: usize,
    /// Mesh index of each element; the largest number for one of a block whose elements are not known one by one.
    pub(super) mesh_elements: Vec<u32>,
}

impl Rows {
    /// From the elastic matrices of all elements; `place` has the group of each node and the sign of its side, `half` is half
    /// the distance of the sides (m).
    pub(super) fn new(
        blocks: &[Box<dyn ElementBlock>],
        subdomain: &Subdomain,
        place: &[(u32, f64)],
        half: f64,
    ) -> Result<Self, EngineError> {
        let mut rows: Vec<Row> = Vec::new();
        let (mut damaged, mut mesh_elements) = (Vec::new(), Vec::new());
        for (index, block) in blocks.iter().enumerate() {
            let nodes = subdomain.nodes_of(index);
            let first = mesh_elements.len();
            let mut coupled = false;
            block.each_matrix(Operator::Elastic, &mut |local, matrix| {
                let places = local.iter().map(|&n| place[nodes[n as usize] as usize]);
                let places: Vec<(u32, f64)> = places.collect();
                let element = mesh_elements.len() as u32;
                mesh_elements.push(u32::MAX);
                coupled |= !add_rows(&places, (matrix, (element, half)), &mut rows);
            });
            if coupled {
                let set = block.label();
                return Err(EngineError::DelayedWith {
                    what: format!(
                        "set '{set}', whose elements couple motion along y with that across"
                    ),
                    way: "take isotropic laws and elements extruded along y",
                });
            }
            // Matrices are those of active elements, as frequency bounds are.
            let bounds = block.frequency_bounds();
            if bounds.len() == mesh_elements.len() - first {
                for (known, bound) in mesh_elements[first..].iter_mut().zip(&bounds) {
                    *known = bound.element;
                }
            }
            let names = damage_variables(block.as_ref());
            if !names.is_empty() {
                let own = mesh_elements[first..].iter().zip(first as u32..);
                let own: HashMap<u32, u32> = own.map(|(element, row)| (*element, row)).collect();
                let elements = block.elements().iter().zip(0..);
                let elements =
                    elements.filter_map(|(element, index)| Some([index, *own.get(element)?]));
                damaged.push((index, names, elements.collect()));
            }
        }
        rows.sort_by_key(|(group, element, _)| (*group, *element));
        Ok(Self {
            rows,
            damaged,
            elements: mesh_elements.len(),
            mesh_elements,
        })
    }

    /// The first row of each group, and their number.
    pub(super) fn offsets(&self, groups: usize) -> Vec<u32> {
        let start = |group: usize| {
            let before = |(g, ..): &Row| (*g as usize) < group;
            self.rows.partition_point(before) as u32
        };
        (0..=groups).map(start).collect()
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
/// not coupled with x and z but by the delay.
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
    let mut sums = vec![Sums::default(); groups.len() * groups.len()];
    for (i, &(of_row, row_sign)) in places.iter().enumerate() {
        for (j, &(of_column, column_sign)) in places.iter().enumerate() {
            let sum = &mut sums[at(of_row) * groups.len() + at(of_column)];
            let block = Mat3::from_fn(|c, d| matrix[(3 * i + c) * size + 3 * j + d]);
            sum.stiffness += block;
            sum.rigidity += block * (half * half * row_sign * column_sign);
            sum.traction -= block * (half * row_sign);
            sum.delayed += block * (half * column_sign);
        }
    }
    let coupled = is_coupled(&sums, half);
    for (row, sums) in groups.iter().zip(sums.chunks(groups.len())) {
        let own = groups.iter().copied().zip(sums.iter().copied());
        rows.push((*row, element, own.collect()));
    }
    !coupled
}

/// Whether stiffness or `A` of an element couple y with x and z, or `T` couples anything else.
fn is_coupled(sums: &[Sums], half: f64) -> bool {
    let entries = |of: fn(&Sums) -> &Mat3, across: bool| {
        let all = sums.iter().flat_map(move |sum| {
            let matrix = of(sum);
            (0..9).map(move |k| ((k / 3 == 1) != (k % 3 == 1), matrix[(k / 3, k % 3)].abs()))
        });
        all.filter(move |(is_across, _)| *is_across == across)
            .fold(0.0, |most: f64, (_, entry)| most.max(entry))
    };
    let scale = entries(|sum| &sum.rigidity, false);
    let stiffness = entries(|sum| &sum.stiffness, false);
    entries(|sum| &sum.rigidity, true) > COUPLED * scale
        || entries(|sum| &sum.stiffness, true) > COUPLED * stiffness
        || entries(|sum| &sum.traction, false) > COUPLED * (scale / half).max(half * stiffness)
}
