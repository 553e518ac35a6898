//! Stiff parts of a slice: elements in which P waves are faster than the motion along y, or nearly so.
//!
//! There `M - s^2 A` is not positive. Such elements keep a part of their share of `A`, and nodes of other elements near by take over
//! the rest: the inertia of all is what it is, and that along y is a little beside its place. A lining then keeps its reaction on the
//! ground along y, which would be lost without the rest.

use powerhouse_model::{DelayedPairs, Vec3};

use super::lumping::Rows;

/// The stiff elements of a slice, and to which groups the rest of their share goes.
#[derive(Clone, Debug, Default)]
pub(super) struct Stiff {
    /// What each element keeps of its share along each axis (1); empty if no element is stiff.
    kept: Vec<Vec3>,
    /// Groups of stiff elements, with other groups and the weights with which they take over the rest; the weights of a group sum
    /// up to one.
    takers: Vec<(u32, Vec<(u32, f64)>)>,
}

impl Stiff {
    /// Of the stiff elements of a slice; the rest goes over to nodes of other elements in a number of rows around them, in
    /// proportion to their masses (kg).
    pub(super) fn new(delayed: &DelayedPairs, rows: &Rows, mass: &[f64], reach: usize) -> Self {
        let mut kept_of = std::collections::HashMap::new();
        for stiff in &delayed.stiff {
            let [across, along] = stiff.kept;
            let kept = Vec3::new(across, along, across);
            kept_of.extend(stiff.elements.iter().map(|element| (*element, kept)));
        }
        if kept_of.is_empty() {
            return Self::default();
        }
        let whole = Vec3::repeat(1.0);
        let of_element = |element: &u32| kept_of.get(element).copied().unwrap_or(whole);
        let kept: Vec<Vec3> = rows.mesh_elements.iter().map(of_element).collect();
        let mut is_stiff = vec![false; mass.len()];
        let mut others: Vec<Vec<u32>> = vec![Vec::new(); mass.len()];
        for (group, element, row) in &rows.rows {
            is_stiff[*group as usize] |= kept[*element as usize] != whole;
            others[*group as usize].extend(row.iter().map(|(other, _)| *other));
        }
        for own in &mut others {
            own.sort_unstable();
            own.dedup();
        }
        let stiff = (0..mass.len() as u32).filter(|group| is_stiff[*group as usize]);
        let takers = stiff.map(|group| {
            let near = near(group, &others, &is_stiff, reach);
            let sum: f64 = near.iter().map(|taker| mass[*taker as usize]).sum();
            let weights = near
                .iter()
                .map(|taker| (*taker, mass[*taker as usize] / sum));
            (group, weights.collect())
        });
        Self {
            takers: takers.collect(),
            kept,
        }
    }

    /// What an element keeps of its share along each axis (1).
    pub(super) fn kept(&self, element: u32) -> Vec3 {
        let kept = self.kept.get(element as usize);
        kept.copied().unwrap_or_else(|| Vec3::repeat(1.0))
    }
}

/// Groups without stiff elements around a group, in a number of rows from the first such ones on.
fn near(group: u32, others: &[Vec<u32>], is_stiff: &[bool], reach: usize) -> Vec<u32> {
    let mut known = std::collections::HashSet::from([group]);
    let (mut front, mut found, mut rows) = (vec![group], Vec::new(), 0);
    while !front.is_empty() && rows < reach {
        let next = front.iter().flat_map(|group| &others[*group as usize]);
        let mut next: Vec<u32> = next.copied().filter(|other| known.insert(*other)).collect();
        next.sort_unstable();
        let soft = next.iter().filter(|other| !is_stiff[**other as usize]);
        let before = found.len();
        found.extend(soft);
        rows += usize::from(found.len() > before);
        front = next;
    }
    found
}

/// `A_i` of all groups along each axis (N m), once stiff elements have passed on a part of theirs.
#[derive(Clone, Debug, Default)]
pub(super) struct Inertia {
    taken: Vec<Vec3>,
    /// What each group has passed on, or with the opposite sign taken over.
    moved: Vec<Vec3>,
}

impl Inertia {
    /// Sets the sums of a number of groups to zero.
    pub(super) fn clear(&mut self, groups: usize) {
        self.taken = vec![Vec3::zeros(); groups];
        self.moved = vec![Vec3::zeros(); groups];
    }

    /// Adds the row of an element without damage to a group, of which damage leaves a share (1), and the element keeps some part.
    pub(super) fn add(&mut self, group: usize, whole: &Vec3, (share, kept): (f64, &Vec3)) {
        let left = kept.map(|kept| kept.min(share));
        self.taken[group] += whole.component_mul(&left);
        self.moved[group] += whole.component_mul(&left.map(|left| share - left));
    }

    /// Passes on what stiff elements do not keep.
    pub(super) fn move_rest(&mut self, stiff: &Stiff) {
        for (group, takers) in &stiff.takers {
            let rest = self.moved[*group as usize];
            for (taker, weight) in takers {
                self.taken[*taker as usize] += rest * *weight;
                self.moved[*taker as usize] -= rest * *weight;
            }
        }
    }

    /// `A_i` of a group along each axis (N m).
    pub(super) fn of(&self, group: usize) -> Vec3 {
        self.taken[group]
    }

    /// What a group has passed on along each axis (N m); negative for one that took over.
    pub(super) fn moved_from(&self, group: usize) -> Vec3 {
        self.moved[group]
    }
}
