//! Cases that several ranks compute together.
//!
//! Rank 0 runs the sweep: it claims cases, checks them, and writes their files. The others wait for the name of the next
//! case, build and compute their part of it, and write nothing. What may fail on one rank alone comes before a point at which
//! all agree on whether it has.

use powerhouse::{EquilibratedBody, RunHooks, Simulation};

use super::at_rest::{self, BodyStore};
use super::{CaseControl, Sweep, locked};
use crate::StudyError;
use crate::ranks::RunRanks;

impl RunRanks {
    /// Gives the other ranks the name of the case that is computed next; none ends their work.
    pub(super) fn begin(&self, case: Option<&str>) -> Result<(), StudyError> {
        self.of_first(case.unwrap_or_default()).map(|_| ())
    }

    /// Whether rank 0 has found a body in equilibrium, so that the others read its file.
    pub(super) fn is_known(&self, found: bool) -> Result<bool, StudyError> {
        let text = if found { "found" } else { "" };
        Ok(!self.of_first(text)?.is_empty())
    }
}

impl Sweep {
    /// Computes the part of a rank other than 0 in all cases, until rank 0 ends the sweep.
    pub(super) fn follow(
        &self,
        control: &CaseControl,
        bodies: &BodyStore,
    ) -> Result<(), StudyError> {
        loop {
            let case = self.ranks.of_first("")?;
            if case.is_empty() {
                return Ok(());
            }
            match self.follow_case(&case, control, bodies) {
                // Rank 0 reports the failure of a case, and decides what comes next.
                Ok(()) | Err(StudyError::Scene(_) | StudyError::Interrupted) => {}
                Err(error) => {
                    locked(control.watch).fails(&case, &error);
                }
            }
        }
    }

    fn follow_case(
        &self,
        case: &str,
        control: &CaseControl,
        bodies: &BodyStore,
    ) -> Result<(), StudyError> {
        let scene = self.ranks.agree(self.scene_of(case))?;
        let key = at_rest::key(&scene);
        let mut run = self.run_of((case, scene), control);
        run.bodies = Some(Box::new(|simulation, hooks| {
            self.follow_stages(simulation, hooks, (&key, bodies))
        }));
        // Rank 0 alone is shown.
        run.run(&mut ()).map(|_| ())
    }

    /// The body after the stages on a rank other than 0: from the file of rank 0, or computed with it.
    fn follow_stages(
        &self,
        simulation: &Simulation,
        hooks: RunHooks,
        (key, bodies): (&str, &BodyStore),
    ) -> Result<Option<EquilibratedBody>, StudyError> {
        self.ranks.agree(Ok(()))?;
        if self.ranks.is_known(false)? {
            let read = bodies.read(key).ok_or_else(|| StudyError::NoResults {
                folder: self.folder.clone(),
            });
            return self.ranks.agree(read).map(Some);
        }
        let body = simulation.equilibrate_with(hooks)?;
        if body.is_some() {
            self.ranks.agree(Ok(()))?;
        }
        Ok(body)
    }
}
