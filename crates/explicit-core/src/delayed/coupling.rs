//! Elastic matrices of a slice between its pairs of nodes, of which those that couple y with x and z.
//!
//! The equation of motion of linear elements is `(M - s^2 A) V' + D V + K U = F`, `D = s (Q - Q^T)` and the skew coupling of boundaries, with `Q_ij`
//! the part of `T_i` that follows displacements. The elements give `K U` alone, which has x and z at the time of `V_y` and y at that
//! of `V_x` and `V_z`: one evaluation in a step is enough, and neither `T` nor the momentum needs to be known.

use powerhouse_model::Vec3;

use super::lumping::Rows;
use crate::node_group::NodeGroup;

/// The rows of all groups by other groups.
#[derive(Clone, Debug, Default)]
pub(crate) struct Coupling {
    /// Entries of each group, by offsets.
    offsets: Vec<u32>,
    /// The other group of each entry.
    others: Vec<u32>,
    /// `D` of x and z by y (N s/m).
    across: Vec<[f64; 2]>,
    /// `D` of y by x and z (N s/m).
    along: Vec<[f64; 2]>,
    /// `Q` of x and z by y (N).
    traction: Vec<[f64; 2]>,
    /// `K` of y by y (N/m).
    stiffness: Vec<f64>,
    /// Internal force (N) along y of each group in the present step.
    pub(super) force: Vec<f64>,
    /// New velocity per force (m/s/N) of each group along each axis in a step of a length (s), with inertia alone.
    pub(super) gain: (f64, Vec<[f64; 3]>),
}

impl Coupling {
    /// From the rows of all elements of a slice with a slowness (s/m).
    pub(super) fn new(rows: &Rows, groups: &[NodeGroup], slowness: f64) -> Self {
        let starts = rows.offsets(groups.len());
        let mut coupling = Self {
            offsets: vec![0],
            force: vec![0.0; groups.len()],
            ..Self::default()
        };
        for (index, group) in groups.iter().enumerate() {
            let own = &rows.rows[starts[index] as usize..starts[index + 1] as usize];
            let mut others: Vec<u32> = own
                .iter()
                .flat_map(|(.., row)| row.iter().map(|(other, _)| *other))
                .collect();
            others.sort_unstable();
            others.dedup();
            let first = coupling.others.len();
            let end = first + others.len();
            coupling.across.resize(end, [0.0; 2]);
            coupling.along.resize(end, [0.0; 2]);
            coupling.traction.resize(end, [0.0; 2]);
            coupling.stiffness.resize(end, 0.0);
            for (other, sums) in own.iter().flat_map(|(.., row)| row) {
                let place = first + others.partition_point(|o| o < other);
                let both = (sums.traction + sums.delayed) * slowness;
                for (side, axis) in [0, 2].into_iter().enumerate() {
                    coupling.across[place][side] += both[(axis, 1)];
                    coupling.along[place][side] += both[(1, axis)];
                    coupling.traction[place][side] += sums.traction[(axis, 1)];
                }
                coupling.stiffness[place] += sums.stiffness[(1, 1)];
            }
            if let Ok(place) = others.binary_search(&(index as u32)) {
                let place = first + place;
                for (side, axis) in [0, 2].into_iter().enumerate() {
                    coupling.across[place][side] += group.gyroscopic[(axis, 1)];
                    coupling.along[place][side] += group.gyroscopic[(1, axis)];
                }
            }
            coupling.others.extend(others);
            coupling.offsets.push(end as u32);
        }
        coupling
    }

    #[inline(always)]
    fn entries(&self, group: usize) -> core::ops::Range<usize> {
        self.offsets[group] as usize..self.offsets[group + 1] as usize
    }

    /// Products of rows of two axes with the values along y of all groups.
    #[inline(always)]
    fn by_axial(&self, rows: &[[f64; 2]], group: usize, values: &[f64]) -> [f64; 2] {
        let own = self.entries(group);
        let mut sums = [0.0; 2];
        for (other, row) in self.others[own.clone()].iter().zip(&rows[own]) {
            let value = values[*other as usize];
            sums[0] += row[0] * value;
            sums[1] += row[1] * value;
        }
        sums
    }

    /// `D V` of a group along x and z (N), from the velocities along y (m/s) of all groups.
    #[inline(always)]
    pub(super) fn across(&self, group: usize, velocity: &[f64]) -> [f64; 2] {
        self.by_axial(&self.across, group, velocity)
    }

    /// `D V` of a group along y (N), from the velocities along x and z (m/s) of all groups.
    #[inline(always)]
    pub(super) fn along(&self, group: usize, velocity: &[[f64; 2]]) -> f64 {
        let own = self.entries(group);
        let mut sum = 0.0;
        for (other, row) in self.others[own.clone()].iter().zip(&self.along[own]) {
            let value = &velocity[*other as usize];
            sum += row[0] * value[0] + row[1] * value[1];
        }
        sum
    }

    /// `Q U` of a group along x and z (N m), from displacements along y (m) of all groups.
    pub(super) fn traction(&self, group: usize, displacement: &[f64]) -> Vec3 {
        let [x, z] = self.by_axial(&self.traction, group, displacement);
        Vec3::new(x, 0.0, z)
    }

    /// `K U` of a group along y (N), from displacements along y (m) of all groups.
    pub(super) fn stiffness(&self, group: usize, displacement: &[f64]) -> f64 {
        let own = self.entries(group);
        let entries = self.others[own.clone()].iter().zip(&self.stiffness[own]);
        entries
            .map(|(other, entry)| entry * displacement[*other as usize])
            .sum()
    }
}
