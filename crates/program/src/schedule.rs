//! Order in which the operations of a program are computed.

use powerhouse_model::{Program, ProgramBranch, ProgramOperation};

/// Step of a schedule.
pub(crate) enum Step {
    /// An operation is computed; its operands are known.
    Compute(u32),
    /// A loop with all its turns; its start and all that it takes from outside are known.
    Loop(LoopSteps),
}

/// Steps of a loop.
pub(crate) struct LoopSteps {
    /// Index of the loop.
    pub(crate) index: u32,
    /// Steps to the mask of a further turn.
    pub(crate) test: Vec<Step>,
    /// Steps to the state after the turn, which follow those of the test.
    pub(crate) turn: Vec<Step>,
}

/// Steps of a branch, and how it ends.
pub(crate) struct BranchSteps {
    pub(crate) steps: Vec<Step>,
    pub(crate) end: BranchEnd,
}

/// End of a branch.
pub(crate) enum BranchEnd {
    /// Outputs, as indices of operations.
    Outputs(Vec<u32>),
    /// Fork by a mask.
    Fork {
        mask: u32,
        yes: Box<BranchSteps>,
        no: Box<BranchSteps>,
    },
}

/// Schedules the operations that the outputs of a program need, each as late as it is needed for certain.
pub(crate) fn schedule(program: &Program) -> BranchSteps {
    let scheduler = Scheduler::new(program);
    let mut known = vec![false; program.operations().len()];
    scheduler.branch(program.branch(), &mut known)
}

struct Scheduler<'a> {
    program: &'a Program,
    /// Loops on whose state within a turn each operation depends, in rising order.
    free: Vec<Vec<u32>>,
}

impl<'a> Scheduler<'a> {
    fn new(program: &'a Program) -> Self {
        let mut free: Vec<Vec<u32>> = Vec::with_capacity(program.operations().len());
        for operation in program.operations() {
            let mut here = Vec::new();
            match *operation {
                ProgramOperation::LoopState(of, _) => here.push(of),
                ProgramOperation::LoopEnd(of, _) => {
                    let parts = &program.loops()[of as usize];
                    let within = parts.next.iter().chain([&parts.open]);
                    for &id in within {
                        here.extend(free[id as usize].iter().filter(|other| **other != of));
                    }
                    for &id in &parts.start {
                        here.extend(&free[id as usize]);
                    }
                }
                operation => {
                    for id in operation.operands() {
                        here.extend(&free[id as usize]);
                    }
                }
            }
            here.sort_unstable();
            here.dedup();
            free.push(here);
        }
        Self { program, free }
    }

    fn branch(&self, branch: &ProgramBranch, known: &mut [bool]) -> BranchSteps {
        match branch {
            ProgramBranch::End(outputs) => BranchSteps {
                steps: self.steps(outputs, known, &[]),
                end: BranchEnd::Outputs(outputs.clone()),
            },
            ProgramBranch::Fork { mask, yes, no } => {
                let steps = self.steps(&[*mask], known, &[]);
                let arm = |branch| Box::new(self.branch(branch, &mut known.to_vec()));
                let (yes, no) = (arm(yes), arm(no));
                BranchSteps {
                    steps,
                    end: BranchEnd::Fork {
                        mask: *mask,
                        yes,
                        no,
                    },
                }
            }
        }
    }

    /// Steps to some operations within the turns of some loops, and notes what is known after them.
    fn steps(&self, goals: &[u32], known: &mut [bool], within: &[u32]) -> Vec<Step> {
        let mut needed = Vec::new();
        let mut waiting = goals.to_vec();
        let mut seen = vec![false; known.len()];
        while let Some(id) = waiting.pop() {
            if known[id as usize] || core::mem::replace(&mut seen[id as usize], true) {
                continue;
            }
            needed.push(id);
            match self.program.operations()[id as usize] {
                ProgramOperation::LoopEnd(of, _) => {
                    waiting.extend(&self.program.loops()[of as usize].start);
                    waiting.extend(self.taken_from_outside(of, within));
                }
                operation => waiting.extend(operation.operands()),
            }
        }
        // Operands are before their operations.
        needed.sort_unstable();
        let mut steps = Vec::with_capacity(needed.len());
        for id in needed {
            if core::mem::replace(&mut known[id as usize], true) {
                continue;
            }
            match self.program.operations()[id as usize] {
                ProgramOperation::LoopEnd(of, _) => {
                    for (other, operation) in self.program.operations().iter().enumerate() {
                        known[other] |=
                            matches!(operation, ProgramOperation::LoopEnd(same, _) if *same == of);
                    }
                    steps.push(Step::Loop(self.loop_steps(of, known, within)));
                }
                _ => steps.push(Step::Compute(id)),
            }
        }
        steps
    }

    fn loop_steps(&self, of: u32, known: &[bool], within: &[u32]) -> LoopSteps {
        let mut known = known.to_vec();
        for (id, operation) in self.program.operations().iter().enumerate() {
            known[id] |= matches!(operation, ProgramOperation::LoopState(same, _) if *same == of);
        }
        let within = [within, &[of]].concat();
        let parts = &self.program.loops()[of as usize];
        LoopSteps {
            index: of,
            test: self.steps(&[parts.open], &mut known, &within),
            turn: self.steps(&parts.next, &mut known, &within),
        }
    }

    /// What the turns of a loop need that does not change in them: it depends on no loop but those within whose turns the
    /// loop is.
    fn taken_from_outside(&self, of: u32, within: &[u32]) -> Vec<u32> {
        let parts = &self.program.loops()[of as usize];
        let mut waiting = parts.next.clone();
        waiting.push(parts.open);
        let mut seen = vec![false; self.free.len()];
        let mut outside = Vec::new();
        while let Some(id) = waiting.pop() {
            if core::mem::replace(&mut seen[id as usize], true) {
                continue;
            }
            if self.free[id as usize].iter().all(|of| within.contains(of)) {
                outside.push(id);
                continue;
            }
            match self.program.operations()[id as usize] {
                ProgramOperation::LoopEnd(of, _) => {
                    let inner = &self.program.loops()[of as usize];
                    waiting.extend(inner.start.iter().chain(&inner.next).chain([&inner.open]));
                }
                operation => waiting.extend(operation.operands()),
            }
        }
        outside
    }
}
