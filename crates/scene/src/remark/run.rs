//! Remarks about the run as a whole and its energies.

use super::{Item, Kind};
use crate::Topic;

remark! {
    /// Fact: the run started from a state of another run.
    pub struct StartedFrom {
        /// The origin of the run, in words.
        pub origin: String,
    }
    Fact(Run),
    "the run {origin}"
}

remark! {
    /// Warning: the requested number of threads is above that of the machine.
    pub struct Threads {
        /// Requested number.
        pub wanted: usize,
        /// Number of the machine, which is used.
        pub available: usize,
    }
    Warning(Run),
    "threads = {wanted}, but the machine has {available}: the run uses {available}"
}

remark! {
    /// Warning: the engine computes no balance of energies, by which a run would be checked.
    pub struct NoEnergyBalance {
        /// Name of the engine.
        pub engine: String,
    }
    Warning(Run),
    "the engine '{engine}' computes no balance of energies: the run is not checked by it"
}

remark! {
    /// Warning after the run: the work of hourglass resistance is above 1 % of the internal work of a set.
    pub struct Hourglass {
        /// Name of the stage, of several that with the largest share; `None` for the dynamic run.
        pub stage: Option<String>,
        /// Name of the element set.
        pub set: String,
        /// Greatest work of hourglass resistance over the greatest internal work (1).
        pub share: f64,
    }
    Warning(Energy),
    "{}hourglass resistance takes {:.1} % of the internal work of set '{set}', more than 1 %: displacements and stresses there are affected by it; use the kernel \"hex8-natural\", \"hex8-full\" or \"hex8-b-bar\", or smaller elements",
    stage.as_ref().map_or_else(String::new, |stage| format!("in stage '{stage}' ")),
    100.0 * share
}

/// Warning after the run: the stiffness that returned when cracks closed, or the time integration of laws, gave or
/// took energy of the size of that which plastic flow and damage took.
#[derive(Clone, Debug, PartialEq)]
pub struct CrackEnergy {
    /// Energy that plastic flow and damage took (J).
    pub dissipated: f64,
    /// Energy that the recovery of stiffness gave to the body (J).
    pub recovery: f64,
    /// Energy by which the time integration of the laws errs (J).
    pub integration: f64,
}

impl Item for CrackEnergy {
    fn kind(&self) -> Kind {
        Kind::Warning(Topic::Energy)
    }
    fn text(&self) -> String {
        let (recovery, integration) = (self.recovery, self.integration);
        let gave = (recovery > 0.0).then(|| {
            format!("the stiffness that returned when cracks closed gave the body {recovery:.2e} J")
        });
        let erred = (integration != 0.0)
            .then(|| format!("the time integration of the laws erred by {integration:.2e} J"));
        let causes: Vec<String> = gave.into_iter().chain(erred).collect();
        format!(
            "{}, where plastic flow and damage took {:.2e} J: peaks of acceleration, plastic strain, displacement and section forces of the parts that crack depend on the time step and on rounding, and may be too large by far; compare with a shorter step (`safety = 0.4` in `[time]`){} and with an elastic run",
            causes.join(", and "),
            self.dissipated,
            if recovery > 0.0 {
                ", with a law without recovery (`stiffness_recovery = 0`)"
            } else {
                ""
            }
        )
    }
}

remark! {
    /// Warning after the run: the added inertia of fibres has more than 1 % of the kinetic energy of their masses.
    pub struct HeavyFibres {
        /// Its share (1), see [`Results::share_of_fibres`](crate::Results::share_of_fibres).
        pub share: f64,
    }
    Warning(Sections),
    "the added inertia of fibres takes {:.1} % of the kinetic energy of their masses, more than 1 %: frequencies of their motion are up to {:.1} % too low, and accelerations, shear forces and floor spectra feel it; take a smaller factor (`fibres` in [time])",
    100.0 * share,
    50.0 * share
}

remark! {
    /// Warning after the run: laws and joints of some steps of a bay were not solved together with its velocities.
    pub struct UnsolvedSteps {
        /// The steps.
        pub unsolved: powerhouse_model::UnsolvedSteps,
        /// Number of steps of the run.
        pub steps: u64,
    }
    Warning(Energy),
    "in {} of {steps} steps the iterations of the bay did not end: velocities of them err by up to {:.1e} of the motion, at {:.4} s the most; where the answer of a law or joint jumps, as where a brittle bond breaks or sides meet at an angle, a step may have no solution: compare with a shorter step (`safety = 0.4` in `[time]`)",
    unsolved.steps,
    unsolved.worst,
    unsolved.time
}
