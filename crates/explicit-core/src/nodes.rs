//! Nodal arrays (displacement, velocity, forces) and the pass that updates them. This is hot code.

use core::ops::{Add, Mul, Range, Sub};

use powerhouse_model::{NodalScalar, NodalView, NodalViewMut, Quad, Vec3};
use pulp::NullaryFnOnce;
use rayon::prelude::*;

use crate::gather::{CHUNK, Gather, SlotTable};
use crate::groups::GroupMotion;
use crate::roller_nodes::hold;
use crate::subdomain::BlockCopies;

/// Number format of nodal values.
pub(crate) trait Storage:
    NodalScalar + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self>
{
    fn view(values: &[Quad<Self>]) -> NodalView<'_>;
    fn view_mut(values: &mut [Quad<Self>]) -> NodalViewMut<'_>;
    /// Whether `-limit <= self <= limit`; false for NaN.
    fn within(self, limit: Self) -> bool;
    /// Largest finite number of the format, the largest bound that excludes infinity.
    const MOST: f64;
    /// Buffers for displacements of a block, and for velocities in this format.
    fn copies(buffers: &mut BlockCopies) -> (&mut Vec<Quad<f64>>, &mut Vec<Quad<Self>>);
    /// Number of bytes of a number.
    const BYTES: usize;
    /// Appends the bytes of a vector.
    fn write(vector: &[Self; 3], bytes: &mut Vec<u8>);
    /// The vector with some bytes, `3 * BYTES` of them.
    fn read(bytes: &[u8]) -> [Self; 3];
}

macro_rules! storage {
    ($float:ty, $variant:ident, $buffer:ident) => {
        impl Storage for $float {
            fn view(values: &[Quad<Self>]) -> NodalView<'_> {
                NodalView::$variant(values)
            }
            fn view_mut(values: &mut [Quad<Self>]) -> NodalViewMut<'_> {
                NodalViewMut::$variant(values)
            }
            #[inline(always)]
            fn within(self, limit: Self) -> bool {
                self.abs() <= limit
            }
            const MOST: f64 = <$float>::MAX as f64;
            fn copies(buffers: &mut BlockCopies) -> (&mut Vec<Quad<f64>>, &mut Vec<Quad<Self>>) {
                (&mut buffers.displacement, &mut buffers.$buffer)
            }
            const BYTES: usize = size_of::<$float>();
            #[inline(always)]
            fn write(vector: &[Self; 3], bytes: &mut Vec<u8>) {
                for number in vector {
                    bytes.extend_from_slice(&number.to_le_bytes());
                }
            }
            #[inline(always)]
            fn read(bytes: &[u8]) -> [Self; 3] {
                let (numbers, _) = bytes.as_chunks::<{ size_of::<$float>() }>();
                core::array::from_fn(|c| <$float>::from_le_bytes(numbers[c]))
            }
        }
    };
}
storage!(f64, F64, double);
storage!(f32, F32, single);

/// Nodal arrays in one number format, by local node number.
pub(crate) struct NodalArrays<S: Storage> {
    /// Displacement (m) at the present time, in double precision whatever the format: it is a sum over all
    /// steps, and strains are small differences of it.
    pub(crate) displacement: Vec<Quad<f64>>,
    /// Velocity (m/s) half a step before the displacement.
    pub(crate) velocity: Vec<Quad<S>>,
    /// Internal forces (N) of the blocks, their buffers concatenated.
    pub(crate) forces: Vec<Quad<S>>,
    /// Applied forces (N) at plain nodes (those without a group); empty if there are none.
    /// Rows of numbers, which are allocated as zeros: those of unloaded nodes take no memory.
    pub(crate) external: Vec<[S; 4]>,
    /// Velocity per force, `dt / (m + dt c / 2)` (m/s/N); zero at nodes of groups.
    gain: Vec<S>,
    /// New velocity per old velocity; empty if it is one everywhere.
    decay: Vec<S>,
}

/// Nodal arrays in double or single precision.
pub(crate) enum Nodes {
    F64(NodalArrays<f64>),
    F32(NodalArrays<f32>),
}

/// Evaluates an expression on the arrays of either format.
macro_rules! with_nodes {
    ($nodes:expr, $arrays:ident => $body:expr) => {
        match $nodes {
            $crate::nodes::Nodes::F64($arrays) => $body,
            $crate::nodes::Nodes::F32($arrays) => $body,
        }
    };
}
pub(crate) use with_nodes;

/// The new velocity of a plain node.
#[inline(always)]
fn kicked<S: Storage>(velocity: &[S; 4], force: &[S; 4], gain: S, decay: Option<S>) -> [S; 4] {
    let mut new = *velocity;
    for c in 0..4 {
        let kept = match decay {
            None => velocity[c],
            Some(decay) => decay * velocity[c],
        };
        new[c] = kept + gain * force[c];
    }
    new
}

/// The force on a plain node: applied minus internal.
#[inline(always)]
fn total<S: Storage>(internal: &[S; 4], external: Option<&[S; 4]>) -> [S; 4] {
    let applied = external.copied().unwrap_or_default();
    let mut force = applied;
    for c in 0..4 {
        force[c] = applied[c] - internal[c];
    }
    force
}

impl<S: Storage> NodalArrays<S> {
    pub(crate) fn new(nodes: usize, slots: usize, with_external: bool) -> Self {
        Self {
            displacement: vec![Quad::default(); nodes],
            velocity: vec![Quad::default(); nodes],
            forces: vec![Quad::default(); slots],
            external: vec![[S::default(); 4]; if with_external { nodes } else { 0 }],
            gain: vec![S::default(); nodes],
            decay: Vec::new(),
        }
    }

    /// Sets the coefficients of the velocity update of plain nodes: gain (m/s/N), and decay if it differs from one.
    pub(crate) fn set_coefficients(&mut self, gain: &[f64], decay: &[f64]) {
        self.gain = gain.iter().map(|&g| S::from_f64(g)).collect();
        self.decay = decay.iter().map(|&d| S::from_f64(d)).collect();
    }

    /// Gain and decay of the velocity update of plain nodes, as they are stored.
    pub(crate) fn coefficients(&self) -> (Vec<f64>, Vec<f64>) {
        let plain = |values: &[S]| values.iter().map(|value| value.to_f64()).collect();
        (plain(&self.gain), plain(&self.decay))
    }

    /// Updates the velocity of plain nodes (kick) and copies that of the groups; with `DRIFT`, updates the displacement
    /// of all nodes too. Returns whether every component of velocity is within `limit` (m/s).
    pub(crate) fn advance<const DRIFT: bool>(
        &mut self,
        gather: &Gather,
        groups: &GroupMotion,
        step: f64,
        limit: f64,
    ) -> bool {
        let Self {
            displacement,
            velocity,
            forces,
            external,
            gain,
            decay,
        } = self;
        let pass = Pass {
            gather,
            groups,
            forces,
            external,
            gain,
            decay,
            step,
            limit: S::from_f64(limit.min(S::MOST)),
        };
        // Wider instructions where the processor has them; they change no bit.
        let processor = pulp::Arch::new();
        velocity
            .par_chunks_mut(CHUNK)
            .zip(displacement.par_chunks_mut(CHUNK))
            .enumerate()
            .map(|(chunk, (velocity, displacement))| {
                processor.dispatch(ChunkPass::<S, DRIFT> {
                    pass: &pass,
                    chunk,
                    velocity,
                    displacement,
                })
            })
            .reduce(|| true, |a, b| a && b)
    }

    /// Updates the displacement of all nodes with their present velocity.
    pub(crate) fn drift(&mut self, step: f64) {
        self.displacement
            .par_chunks_mut(CHUNK)
            .zip(self.velocity.par_chunks(CHUNK))
            .for_each(|(displacement, velocity)| {
                for (displacement, velocity) in displacement.iter_mut().zip(velocity) {
                    for c in 0..4 {
                        displacement.values[c] += step * velocity.values[c].to_f64();
                    }
                }
            });
    }

    /// Sums over the plain nodes of a range, between kick and drift, of `m v-.v+`, `c v-.v-`, `c v-.v+`,
    /// `c v+.v+` and `m (v+ - v-).(v+ - v-)` with the masses `m` (kg) and the damping `c` (kg/s, or none), in the order of
    /// the nodes.
    pub(crate) fn products(
        &self,
        range: Range<usize>,
        gather: &Gather,
        (groups, grouped): (&GroupMotion, impl Fn(usize) -> bool),
        mass: &[f64],
        damping: &[f64],
    ) -> [f64; 5] {
        let mut sums = [0.0; 5];
        let mut roller_nodes = groups.roller_nodes.from(range.start);
        gather.for_range(range, &self.forces, |first, internal| {
            roller_nodes = hold(roller_nodes, first, internal, &self.external);
            for (i, internal) in internal.iter().enumerate() {
                let node = first + i;
                if grouped(node) {
                    continue;
                }
                let before = self.velocity[node].to_vector();
                let after = self.next_of(node, &internal.values);
                let damping = damping.get(node).copied().unwrap_or(0.0);
                let across = before.dot(&after);
                sums[0] += mass[node] * across;
                sums[1] += damping * before.norm_squared();
                sums[2] += damping * across;
                sums[3] += damping * after.norm_squared();
                sums[4] += mass[node] * (after - before).norm_squared();
            }
        });
        sums
    }

    /// Internal force at a node (N).
    pub(crate) fn internal(&self, slots: &SlotTable, node: usize) -> Vec3 {
        slots.sum(node, &self.forces).to_vector()
    }

    /// Velocity of a plain node after the step, bitwise that of [`Self::advance`].
    pub(crate) fn next_velocity(
        &self,
        slots: &SlotTable,
        groups: &GroupMotion,
        node: usize,
    ) -> Vec3 {
        let mut internal = [slots.sum(node, &self.forces)];
        hold(
            groups.roller_nodes.of(node),
            node,
            &mut internal,
            &self.external,
        );
        self.next_of(node, &internal[0].values)
    }

    fn next_of(&self, node: usize, internal: &[S; 4]) -> Vec3 {
        let force = total(internal, self.external.get(node));
        let decay = self.decay.get(node).copied();
        let new = kicked(&self.velocity[node].values, &force, self.gain[node], decay);
        Vec3::new(new[0].to_f64(), new[1].to_f64(), new[2].to_f64())
    }
}

/// Input of a pass over the nodes.
struct Pass<'a, S: Storage> {
    gather: &'a Gather,
    groups: &'a GroupMotion,
    forces: &'a [Quad<S>],
    external: &'a [[S; 4]],
    gain: &'a [S],
    decay: &'a [S],
    step: f64,
    limit: S,
}

/// The pass over one chunk of nodes. A type of its own, since a closure passed to the dispatch may end up in
/// a function compiled without the processor's wide instructions.
struct ChunkPass<'a, S: Storage, const DRIFT: bool> {
    pass: &'a Pass<'a, S>,
    chunk: usize,
    velocity: &'a mut [Quad<S>],
    displacement: &'a mut [Quad<f64>],
}

impl<S: Storage, const DRIFT: bool> NullaryFnOnce for ChunkPass<'_, S, DRIFT> {
    type Output = bool;
    #[inline(always)]
    fn call(self) -> bool {
        self.pass
            .advance::<DRIFT>(self.chunk, self.velocity, self.displacement)
    }
}

impl<S: Storage> Pass<'_, S> {
    /// Updates one chunk; returns whether its velocities are within the limit.
    #[inline(always)]
    fn advance<const DRIFT: bool>(
        &self,
        chunk: usize,
        velocity: &mut [Quad<S>],
        displacement: &mut [Quad<f64>],
    ) -> bool {
        let start = chunk * CHUNK;
        let mut beyond = [false; 4];
        // The gain of a node of a group is zero: the loop below leaves its velocity unchanged.
        for &(node, group) in self.groups.members_in(chunk) {
            velocity[node as usize - start] = Quad::from_vector(&self.groups.next[group as usize]);
        }
        let mut roller_nodes = self.groups.roller_nodes.in_chunk(chunk);
        self.gather.for_chunk(
            chunk,
            self.forces,
            #[inline(always)]
            |first, sums| {
                roller_nodes = hold(roller_nodes, first, sums, self.external);
                let range = first - start..first - start + sums.len();
                let velocity = &mut velocity[range.clone()];
                let displacement = &mut displacement[range];
                let gain = &self.gain[first..first + sums.len()];
                for i in 0..sums.len() {
                    let applied = self.external.get(first + i);
                    let force = total(&sums[i].values, applied);
                    let decay = self.decay.get(first + i).copied();
                    let new = kicked(&velocity[i].values, &force, gain[i], decay);
                    velocity[i].values = new;
                    for c in 0..4 {
                        if DRIFT {
                            let value = &mut displacement[i].values[c];
                            *value += self.step * new[c].to_f64();
                        }
                        beyond[c] |= !new[c].within(self.limit);
                    }
                }
            },
        );
        !beyond.contains(&true)
    }
}
