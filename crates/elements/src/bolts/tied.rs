//! Bars tied to the rock along their length: segments that do not depend on each other. This is hot code.

use core::ops::Range;

use super::BoltParameters;

/// History variables of the bars of a block.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct TiedState {
    /// Plastic elongation (m) of each segment.
    pub(super) plastic: Vec<f64>,
    /// Axial force (N) of each segment.
    pub(super) force: Vec<f64>,
    /// Energy dissipated by each bolt so far (J).
    pub(super) dissipated: Vec<f64>,
}

/// The bars of all bolts of a block, segment by segment.
#[derive(Debug)]
pub(super) struct TiedBars {
    /// Axial stiffness of each segment, `E A / l` (N/m).
    stiffness: Vec<f64>,
    yield_force: f64,
    pretension: f64,
    /// Elongation (m) of each segment at installation.
    reference: Vec<f64>,
    pub(super) committed: TiedState,
    /// Trial state of the last forces.
    trial: TiedState,
    /// Whether the trial state is valid and not committed.
    pending: bool,
    /// Energy (J) dissipated by each segment in the trial state since the committed one.
    spent: Vec<f64>,
}

impl TiedBars {
    /// From the lengths of all segments (m) and the number of bolts.
    pub(super) fn new(
        parameters: &BoltParameters,
        lengths: impl Iterator<Item = f64>,
        bolts: usize,
    ) -> Self {
        let axial = parameters.young * parameters.area;
        let stiffness: Vec<f64> = lengths.map(|length| axial / length).collect();
        let installed = TiedState {
            plastic: vec![0.0; stiffness.len()],
            force: vec![parameters.pretension; stiffness.len()],
            dissipated: vec![0.0; bolts],
        };
        Self {
            yield_force: parameters.yield_force,
            pretension: parameters.pretension,
            reference: vec![0.0; stiffness.len()],
            spent: vec![0.0; stiffness.len()],
            committed: installed.clone(),
            trial: installed,
            pending: false,
            stiffness,
        }
    }

    /// The state of the last forces, committed or not.
    pub(super) fn present(&self) -> &TiedState {
        if self.pending {
            &self.trial
        } else {
            &self.committed
        }
    }
    /// Axial force (N) of each segment in the trial state.
    #[inline(always)]
    pub(super) fn forces(&self) -> &[f64] {
        &self.trial.force
    }

    /// Writes the trial state for the elongations (m) of all segments, of which the list may be longer; `segments` are those of
    /// each bolt.
    ///
    /// # Errors
    /// The first segment whose elongation is not finite.
    #[inline(always)]
    pub(super) fn stretch(
        &mut self,
        segments: &[Range<u32>],
        elongations: &[f64],
    ) -> Result<(), usize> {
        let count = self.stiffness.len();
        let elongations = &elongations[..count];
        let (stiffness, reference) = (&self.stiffness[..], &self.reference[..count]);
        let (force, plastic) = (
            &self.committed.force[..count],
            &self.committed.plastic[..count],
        );
        let new_force = &mut self.trial.force[..count];
        let new_plastic = &mut self.trial.plastic[..count];
        let spent = &mut self.spent[..count];
        let (mut flows, mut sound) = (false, true);
        for k in 0..count {
            let stretched = elongations[k] - reference[k];
            sound &= stretched.is_finite();
            let trial = self.pretension + stiffness[k] * (stretched - plastic[k]);
            let limited = trial.min(self.yield_force).max(-self.yield_force);
            let flow = (trial - limited) / stiffness[k];
            flows |= flow != 0.0;
            new_force[k] = limited;
            new_plastic[k] = plastic[k] + flow;
            spent[k] = 0.5 * (force[k] + limited) * flow;
        }
        self.pending = sound;
        if !sound {
            let lost = |k: &usize| !(elongations[*k] - reference[*k]).is_finite();
            return Err((0..count).find(lost).unwrap_or(0));
        }
        let dissipated = &mut self.trial.dissipated;
        dissipated.copy_from_slice(&self.committed.dissipated);
        if flows {
            for (sum, own) in dissipated.iter_mut().zip(segments) {
                let own = &spent[own.start as usize..own.end as usize];
                own.iter().for_each(|spent| *sum += spent);
            }
        }
        Ok(())
    }

    /// Makes the trial state the committed one.
    pub(super) fn commit(&mut self) {
        if core::mem::take(&mut self.pending) {
            core::mem::swap(&mut self.committed, &mut self.trial);
        }
    }

    /// Elastic axial force (N) of a segment.
    pub(super) fn elastic(&self, segment: usize, elongation: f64) -> f64 {
        self.stiffness[segment] * elongation
    }

    /// Stored elastic energy (J) of some segments.
    pub(super) fn stored(&self, segments: Range<usize>) -> f64 {
        let force = &self.present().force[segments.clone()];
        let bars = force.iter().zip(&self.stiffness[segments]);
        bars.map(|(force, k)| 0.5 * force * force / k).sum()
    }

    /// Installs the bars at a reference displacement (m) of the segment ends.
    pub(super) fn install(&mut self, reference: &[[f64; 2]]) {
        for (own, ends) in self.reference.iter_mut().zip(reference) {
            *own = ends[1] - ends[0];
        }
        self.committed.plastic.fill(0.0);
        self.committed.force.fill(self.pretension);
        self.committed.dissipated.fill(0.0);
        self.pending = false;
    }
}
