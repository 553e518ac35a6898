//! Nodes of constraints, most of which have nothing but a mass. This is hot code.

use core::ops::Range;

use powerhouse_model::{MassDampingRule, Quad, Vec3};

use crate::gather::SlotTable;
use crate::groups::Group;
use crate::nodes::{NodalArrays, Storage};

/// Nodes that are gathered at once: one value of all after the other, in loops so short that many
/// loads are under way at a time.
pub(crate) const TILE: usize = 64;

/// The motion of some nodes of constraints, in their order.
pub(crate) struct ConstrainedMotion<'a> {
    /// Displacement (m) at the step's start.
    pub(crate) displacement: &'a mut [Vec3],
    /// Velocity before the step (m/s).
    pub(crate) previous: &'a mut [Vec3],
    /// Velocity after it (m/s).
    pub(crate) next: &'a mut [Vec3],
}

/// What the kick of a node takes if it has nothing but a mass, as on the sides of a joint.
#[derive(Clone, Copy, Debug, Default)]
struct Bare {
    /// New velocity per old velocity.
    carry: f64,
    /// Velocity per force (m/s/N); zero where there is more than a mass.
    response: f64,
}

/// The nodes of all constraints, constraint by constraint; their groups have the same order.
#[derive(Default)]
pub(crate) struct ConstrainedNodes {
    nodes: Vec<u32>,
    /// The first slot of each node.
    slots: Vec<u32>,
    /// Place in its tile and slot of all further ones.
    further: Vec<(u32, u32)>,
    /// Further slots of each tile.
    tiles: Vec<Range<u32>>,
    /// What nodes with nothing but a mass need.
    bare: Vec<Bare>,
    /// Effective masses (kg) of those.
    masses: Vec<Option<f64>>,
}

impl ConstrainedNodes {
    /// Engine nodes whose groups are the first ones.
    pub(crate) fn new(nodes: &[u32], groups: &[Group], slots: &SlotTable) -> Self {
        let (mut further, mut tiles) = (Vec::new(), Vec::new());
        for tile in nodes.chunks(TILE) {
            let start = further.len() as u32;
            for (place, &node) in tile.iter().enumerate() {
                let others = &slots.of(node as usize)[1..];
                further.extend(others.iter().map(|&slot| (place as u32, slot)));
            }
            tiles.push(start..further.len() as u32);
        }
        let first = nodes.iter().map(|&node| slots.of(node as usize)[0]);
        let own = groups.iter().take(nodes.len());
        let masses = own.map(|group| group.is_bare().then_some(0.0));
        Self {
            nodes: nodes.to_vec(),
            slots: first.collect(),
            further,
            tiles,
            masses: masses.collect(),
            bare: vec![Bare::default(); nodes.len()],
        }
    }

    /// How many there are.
    pub(crate) fn count(&self) -> usize {
        self.nodes.len()
    }

    /// The effective mass (kg) of a node that has nothing but a mass.
    #[inline]
    pub(crate) fn bare_mass(&self, group: usize) -> Option<f64> {
        *self.masses.get(group)?
    }

    /// Takes what depends on the step.
    pub(crate) fn prepare(&mut self, groups: &[Group], rule: MassDampingRule, step: f64) {
        for ((known, bare), group) in self.masses.iter_mut().zip(&mut self.bare).zip(groups) {
            if let Some(known) = known {
                let (mass, old) = group.effective_mass(rule, step);
                let (carry, response) = (old / mass, step / mass);
                (*known, *bare) = (mass, Bare { carry, response });
            }
        }
    }

    /// Predicts the velocity of the nodes of a tile, those with nothing but a mass from the forces on
    /// them, the others by `kicked`, which gives the velocities before and after first. If the nodes have
    /// `moved` by a step (s) since the last kick, with `motion.previous`, there is no need to look
    /// where they are.
    pub(crate) fn kick<S: Storage>(
        &self,
        (tile, moved): (usize, Option<f64>),
        motion: ConstrainedMotion,
        arrays: &NodalArrays<S>,
        applied: impl Fn(usize) -> Vec3,
        kicked: impl Fn(usize) -> [Vec3; 3],
    ) {
        let start = tile * TILE;
        let count = motion.next.len();
        let nodes = &self.nodes[start..start + count];
        if let Some(step) = moved {
            for (displacement, velocity) in motion.displacement.iter_mut().zip(&*motion.previous) {
                *displacement += velocity * step;
            }
        } else {
            for (displacement, &node) in motion.displacement.iter_mut().zip(nodes) {
                *displacement = arrays.displacement[node as usize].to_vector();
            }
            for (previous, &node) in motion.previous.iter_mut().zip(nodes) {
                *previous = arrays.velocity[node as usize].to_vector();
            }
        }
        let mut sums = [Quad::<S>::default(); TILE];
        for (sum, &slot) in sums.iter_mut().zip(&self.slots[start..start + count]) {
            *sum = arrays.forces[slot as usize];
        }
        let further = &self.tiles[tile];
        for &(place, slot) in &self.further[further.start as usize..further.end as usize] {
            let add = &arrays.forces[slot as usize].values;
            let sum = &mut sums[place as usize].values;
            for c in 0..4 {
                sum[c] = sum[c] + add[c];
            }
        }
        for i in 0..count {
            let g = start + i;
            let bare = &self.bare[g];
            if bare.response > 0.0 {
                let force = applied(g) - sums[i].to_vector();
                motion.next[i] = motion.previous[i] * bare.carry + force * bare.response;
            } else {
                [motion.previous[i], motion.next[i], _] = kicked(g);
            }
        }
    }
}
