//! Dynamic steps of linear ground with water in its pores, which spare the law: the forces are those of the undrained moduli and
//! constant ones of the last drained state.

use powerhouse_model::{
    BlockContext, ElementKernel, Geometry, KernelArithmetic, NodalViewMut, Quad, Vec3,
};

use super::batches::Batches;
use super::history::History;
use super::law::HistoryAccess;
use super::memory::as_lanes;
use super::operations::Rest;
use super::pore_water::raise;
use super::transfer::{NodeScalar, gather};
use super::{Block, NodalView, is_read};
use crate::lanes::{BatchLane, BatchOperation, BatchScalar};

impl<K, S, const N: usize, const P: usize> Block<K, S, N, P>
where
    K: ElementKernel<N, P>,
    S: NodeScalar,
{
    /// Whether the last step, which had a coefficient of stiffness damping (s), spares the law. Elements that condense strains of
    /// their own do so by steps of the law alone.
    pub(super) fn spares_law(&self, damping: f64) -> bool {
        self.is_linear_ground && damping == 0.0 && self.law.is_stepping() && !self.condenses()
    }

    /// Forces of nodal displacements by local index; returns whether all is finite.
    pub(super) fn forces_without_law(
        &mut self,
        nodes: &[Quad<f64>],
        mut out: NodalViewMut,
    ) -> bool {
        let finite = self.elastic(nodes, self.moduli, Some(out.reborrow()), None);
        let known = self.forces_at_rest.take();
        let forces = known.unwrap_or_else(|| self.found_forces_at_rest());
        for (node, force) in forces.iter().enumerate() {
            out.add(node, &force.to_vector());
        }
        self.forces_at_rest = Some(forces);
        finite
    }

    /// Forces of the law without displacement; empty if all are zero.
    fn found_forces_at_rest(&self) -> Vec<Quad<f64>> {
        let still = vec![Quad::default(); self.nodes.len()];
        let mut forces = still.clone();
        let access = (HistoryAccess::Read(&self.history), Rest::default());
        let out = NodalViewMut::F64(&mut forces);
        self.material(&still, access, None, Some(out), None);
        let acts = |force: &Quad<f64>| force.to_vector() != Vec3::zeros();
        if forces.iter().any(acts) {
            forces
        } else {
            Vec::new()
        }
    }

    /// Stores the pressures of the water in a step whose state is read.
    pub(super) fn show_pressures(&mut self, context: &BlockContext, displacement: &[Quad<f64>]) {
        if !is_read(context) {
            return;
        }
        let nodes = self.since_reference(NodalView::F64(displacement));
        let mut history = core::mem::take(&mut self.history);
        self.lanes.dispatch(RaisePressures::<K, S, N, P> {
            kernel: &self.kernel,
            batches: self.batches(),
            stiffness: self.moduli.water,
            history: &mut history,
            nodes: &nodes,
        });
        self.history = history;
    }
}

/// The pressures of water that cannot flow at a displacement, as new histories.
struct RaisePressures<'a, K, S: BatchScalar, const N: usize, const P: usize> {
    kernel: &'a K,
    batches: Batches<'a, S, N>,
    /// Pressure of the water per volume strain (Pa).
    stiffness: f64,
    history: &'a mut History<S>,
    /// Displacement (m) by local node index.
    nodes: &'a [Quad<f64>],
}

impl<K, S, const N: usize, const P: usize> BatchOperation<S> for RaisePressures<'_, K, S, N, P>
where
    K: ElementKernel<N, P>,
    S: BatchScalar,
{
    type Output = ();
    #[inline(always)]
    fn run<L: BatchLane<Scalar = S>>(self, token: L::Token) {
        let mut nodal = [[L::splat(token, 0.0); 3]; N];
        let nodes = self.batches.connectivity.over(self.nodes);
        for index in 0..self.batches.count(L::WIDTH) {
            let batch = (self.batches).batch(index, L::WIDTH, self.kernel.geometry_len());
            let geometry = Geometry::new(token, as_lanes::<L>(token, batch.geometry));
            gather::<f64, L, N>(token, nodes.elements(batch.first, L::WIDTH), &mut nodal);
            let modes = self.kernel.modes(&nodal);
            let strains = self.kernel.strains(geometry, &modes);
            self.history.discard_trial(index);
            for p in 0..P {
                raise(self.history, (index, p), &strains[p], self.stiffness);
            }
            self.history.revert_absent(index, &batch);
        }
    }
}
