//! Measurement of the wall time of the parts of time steps.
//!
//! # Why so
//! *Elements are evaluated again, not instrumented.* A clock inside the loop over batches would slow it down also where
//! nobody asks. In one of [`PROBE_INTERVAL`] steps the blocks compute their forces once more without energy
//! bookkeeping, once without damping too, and once by the elastic operator alone; the differences tell kernel, law, damping
//! and bookkeeping apart. Forces and history variables of the step itself are computed last, so that the motion has the
//! same bits as without a profile.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use powerhouse_model::{ElementBlock, ProfileRow, StepProfile};

use crate::model::blocks_by_label;

/// Interval (steps) at which the parts of element blocks are separated.
pub(crate) const PROBE_INTERVAL: u64 = 50;

/// Processor time of every element block.
#[derive(Default)]
pub(crate) struct BlockTimes(Vec<AtomicU64>);

impl BlockTimes {
    fn new(blocks: usize) -> Self {
        Self((0..blocks).map(|_| AtomicU64::new(0)).collect())
    }
    /// Adds the time since `start` to that of a block.
    pub(crate) fn add(&self, block: usize, start: Instant) {
        let nanoseconds = start.elapsed().as_nanos() as u64;
        self.0[block].fetch_add(nanoseconds, Ordering::Relaxed);
    }
    fn seconds(&self, block: usize) -> f64 {
        self.0[block].load(Ordering::Relaxed) as f64 * 1e-9
    }
}

/// Processor times of the blocks in the steps in which their parts are separated.
#[derive(Default)]
pub(crate) struct Probes {
    /// Forces of the step.
    pub(crate) whole: BlockTimes,
    /// Forces without energy bookkeeping.
    pub(crate) without_account: BlockTimes,
    /// Forces without energy bookkeeping and stiffness damping.
    pub(crate) without_damping: BlockTimes,
    /// Forces of the elastic operator.
    pub(crate) elastic: BlockTimes,
}

/// Phases of a step besides element forces and loads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Phase {
    /// Velocity update of the groups: boundary impedance, supports, prescribed motion, ties.
    Groups,
    /// Update of all nodes.
    Nodes,
    /// Nodal part of the energy balance, and its readings.
    EnergyBalance,
    /// Output.
    Observers,
}

impl Phase {
    const ALL: [Self; 4] = [
        Self::Groups,
        Self::Nodes,
        Self::EnergyBalance,
        Self::Observers,
    ];
    fn name(self) -> &'static str {
        match self {
            Self::Groups => "boundaries, supports and ties",
            Self::Nodes => "update of all nodes",
            Self::EnergyBalance => "energy balance of nodes, and its readings",
            Self::Observers => "output",
        }
    }
}

/// Profile of a run while it is measured.
pub(crate) struct Profiler {
    /// Processor times of the blocks in the steps without probes.
    pub(crate) blocks: BlockTimes,
    /// Processor time of the loads.
    pub(crate) loads: AtomicU64,
    /// Wall time of the evaluation of forces and loads.
    pub(crate) forces: Duration,
    pub(crate) probes: Probes,
    phases: [Duration; 4],
    /// Wall time of each constraint.
    pub(crate) constraints: Vec<Duration>,
    /// Wall time of the probes, which is no part of the steps.
    pub(crate) apart: Duration,
}

impl Profiler {
    pub(crate) fn new(blocks: usize, constraints: usize) -> Self {
        let times = || BlockTimes::new(blocks);
        Self {
            blocks: times(),
            loads: AtomicU64::new(0),
            forces: Duration::ZERO,
            probes: Probes {
                whole: times(),
                without_account: times(),
                without_damping: times(),
                elastic: times(),
            },
            phases: [Duration::ZERO; 4],
            constraints: vec![Duration::ZERO; constraints],
            apart: Duration::ZERO,
        }
    }

    /// Processor time (s) of the forces of a block in all steps, probed ones included.
    fn of_block(&self, block: usize) -> f64 {
        self.blocks.seconds(block) + self.probes.whole.seconds(block)
    }

    /// Adds the time since `start` to a phase.
    pub(crate) fn add(&mut self, phase: Phase, start: Instant) {
        self.phases[phase as usize] += start.elapsed();
    }

    /// The profile of some steps with a wall time, probes included, of blocks and constraints by name.
    pub(crate) fn report(
        &self,
        steps: u64,
        wall: Duration,
        blocks: &[Box<dyn ElementBlock>],
        constraints: &[&str],
    ) -> StepProfile {
        let seconds = wall.saturating_sub(self.apart).as_secs_f64();
        let loads = self.loads.load(Ordering::Relaxed) as f64 * 1e-9;
        let of_blocks: f64 = (0..blocks.len()).map(|block| self.of_block(block)).sum();
        let processor = of_blocks + loads;
        let scale = if processor > 0.0 {
            self.forces.as_secs_f64() / processor
        } else {
            0.0
        };
        let mut rows = vec![ProfileRow::new("loads and wave input", scale * loads)];
        for (label, of_set) in blocks_by_label(blocks) {
            let sum = |times: &BlockTimes| of_set.iter().map(|&b| times.seconds(b)).sum::<f64>();
            let whole = scale * of_set.iter().map(|&b| self.of_block(b)).sum::<f64>();
            let probes = &self.probes;
            let parts = shares([
                sum(&probes.elastic),
                sum(&probes.without_damping),
                sum(&probes.without_account),
                sum(&probes.whole),
            ]);
            match parts {
                Some(shares) if of_set.iter().any(|&b| !blocks[b].elements().is_empty()) => {
                    for (part, share) in PARTS.iter().zip(shares) {
                        let name = format!("elements of '{label}': {part}");
                        rows.push(ProfileRow::new(name, share * whole));
                    }
                }
                _ => rows.push(ProfileRow::new(format!("block '{label}'"), whole)),
            }
        }
        for (phase, time) in Phase::ALL.iter().zip(self.phases) {
            rows.push(ProfileRow::new(phase.name(), time.as_secs_f64()));
        }
        for (name, time) in constraints.iter().zip(&self.constraints) {
            rows.push(ProfileRow::new(
                format!("joint '{name}'"),
                time.as_secs_f64(),
            ));
        }
        rows.retain(|row| row.seconds > 0.0);
        StepProfile::new(steps, seconds, rows)
    }
}

/// Parts of the time of elements.
const PARTS: [&str; 4] = ["kernel", "law", "stiffness damping", "energy bookkeeping"];

/// Shares of the parts from times of evaluations that each hold one part more than the one before; none without times.
fn shares(times: [f64; 4]) -> Option<[f64; 4]> {
    let whole = times[3];
    if whole <= 0.0 {
        return None;
    }
    let mut before = 0.0;
    Some(times.map(|time| {
        let time = time.clamp(before, whole);
        let share = (time - before) / whole;
        before = time;
        share
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Shares add up to one, also where an evaluation with one part more was measured as faster.
    #[test]
    fn shares_add_up() {
        assert_eq!(shares([1.0, 2.0, 3.0, 4.0]), Some([0.25; 4]));
        assert_eq!(shares([1.0, 4.0, 3.0, 4.0]), Some([0.25, 0.75, 0.0, 0.0]));
        assert_eq!(shares([5.0, 1.0, 2.0, 4.0]), Some([1.0, 0.0, 0.0, 0.0]));
        assert_eq!(shares([0.0; 4]), None);
    }
}
