//! Bolts in grout, each in equilibrium by itself.

use super::bar::{Balance, Bar, BarState};

/// Failures, with the place of the index of the bolt.
pub(super) const NOT_FINITE: &str = "the displacement of a node at bolt {} is not finite";
const NOT_CONVERGED: &str = "the equilibrium of bolt {} with its grout does not converge";

/// One bolt in grout.
#[derive(Debug)]
pub(super) struct GroutedBar {
    pub(super) bar: Bar,
    pub(super) committed: BarState,
    /// Trial state of the last forces.
    pub(super) trial: BarState,
    /// Whether the trial state is valid and not committed.
    pub(super) pending: bool,
}

impl GroutedBar {
    pub(super) fn new(bar: Bar) -> Self {
        Self {
            committed: bar.installed(),
            trial: bar.installed(),
            pending: false,
            bar,
        }
    }
    /// The state of the last forces, committed or not.
    pub(super) fn present(&self) -> &BarState {
        if self.pending {
            &self.trial
        } else {
            &self.committed
        }
    }
}

/// Reusable buffers for one bolt in grout: axial displacements of its points, forces there, equilibrium.
#[derive(Debug, Default)]
pub(super) struct BoltWorkspace {
    pub(super) moved: Vec<[f64; 2]>,
    pub(super) forces: Vec<[f64; 2]>,
    pub(super) balance: Balance,
}

/// Resets a buffer to so many zeros.
pub(super) fn clear<T: Default + Clone>(buffer: &mut Vec<T>, count: usize) {
    buffer.clear();
    buffer.resize(count, T::default());
}

impl GroutedBar {
    /// Computes the forces (N) at the points for their axial displacements (m), from those at installation.
    ///
    /// # Errors
    /// The segment and what has failed.
    pub(super) fn resist(
        &mut self,
        moved: impl Iterator<Item = [f64; 2]>,
        reference: &[[f64; 2]],
        workspace: &mut BoltWorkspace,
    ) -> Result<(), (usize, &'static str)> {
        let BoltWorkspace {
            moved: since,
            forces,
            balance,
        } = workspace;
        since.clear();
        since.extend(
            moved
                .zip(reference)
                .map(|(u, at)| [u[0] - at[0], u[1] - at[1]]),
        );
        let invalid = |ends: &[f64; 2]| ends.iter().any(|u| !u.is_finite());
        if let Some(segment) = since.iter().position(invalid) {
            return Err((segment, NOT_FINITE));
        }
        clear(forces, self.bar.segment_count());
        let (old, new) = (&self.committed, &mut self.trial);
        let found = self.bar.forces(since, old, new, forces, balance);
        self.pending = found.is_some();
        found.ok_or_else(|| {
            let stretch = |ends: &[f64; 2]| (ends[1] - ends[0]).abs();
            let worst = since.iter().map(stretch).enumerate();
            let worst = worst.max_by(|a, b| a.1.total_cmp(&b.1));
            (worst.map_or(0, |(segment, _)| segment), NOT_CONVERGED)
        })
    }
}
