//! Programs: the arithmetic of a constitutive law or of an element as data.

use thiserror::Error;

/// Format of all numbers of a [`Program`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum NumberFormat {
    /// Double precision (IEEE binary64).
    F64,
    /// Single precision (IEEE binary32).
    F32,
}

/// ProgramOperation of a [`Program`]. Its operands are results of operations before it, given by their indices. Every one is
/// that of [`Lane`](crate::Lane) of the same name and has the same bits.
///
/// The list is closed: whoever executes or translates programs must know all operations.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ProgramOperation {
    /// A constant, as the bits of the double of equal value; in single precision it has been rounded.
    Constant(u64),
    /// An input of the program, by its number.
    Input(u32),
    /// The sum of two numbers.
    Add(u32, u32),
    /// The first number less the second.
    Sub(u32, u32),
    /// The product of two numbers.
    Mul(u32, u32),
    /// The first number over the second.
    Div(u32, u32),
    /// The number with the other sign.
    Neg(u32),
    /// Fused multiply-add: the product of the first two numbers plus the third, rounded once.
    MulAdd(u32, u32, u32),
    /// The square root.
    Sqrt(u32),
    /// The absolute value.
    Abs(u32),
    /// The nearest integer, `(x + c) - c` with `c = 1.5 / EPSILON`.
    Round(u32),
    /// Power of two `2^x` of an integer `x`: the bits of `x + 1.5 / EPSILON`, shifted left by the length of the fraction, plus
    /// those of one.
    PowerOfTwo(u32),
    /// Mask: whether the first number is less than the second.
    Less(u32, u32),
    /// By the mask, which is the first operand, the second where it is true, the third elsewhere.
    Select(u32, u32, u32),
    /// Number of the state of a loop within a turn: index of the loop, index in the state.
    LoopState(u32, u32),
    /// Number of the state of a loop after its last turn: index of the loop, index in the state.
    LoopEnd(u32, u32),
}

impl ProgramOperation {
    /// Indices of the operands, of which there are at most three.
    pub fn operands(self) -> impl Iterator<Item = u32> {
        let (operands, count) = match self {
            Self::Constant(_) | Self::Input(_) | Self::LoopState(..) | Self::LoopEnd(..) => {
                ([0; 3], 0)
            }
            Self::Neg(a) | Self::Sqrt(a) | Self::Abs(a) | Self::Round(a) | Self::PowerOfTwo(a) => {
                ([a, 0, 0], 1)
            }
            Self::Add(a, b)
            | Self::Sub(a, b)
            | Self::Mul(a, b)
            | Self::Div(a, b)
            | Self::Less(a, b) => ([a, b, 0], 2),
            Self::MulAdd(a, b, c) | Self::Select(a, b, c) => ([a, b, c], 3),
        };
        operands.into_iter().take(count)
    }
    /// Whether the result is a mask, not a number.
    pub fn is_mask(self) -> bool {
        matches!(self, Self::Less(..))
    }
}

/// Loop of a [`Program`]: turns from a start, while a mask is true, and at most a number of them.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct ProgramLoop {
    /// Greatest number of turns.
    pub most: u32,
    /// State before the first turn, as indices of operations.
    pub start: Vec<u32>,
    /// Mask that is true where a further turn follows; it depends on the [`ProgramOperation::LoopState`] of the loop.
    pub open: u32,
    /// State after a turn.
    pub next: Vec<u32>,
}

impl ProgramLoop {
    /// A loop of at most `most` turns: state at its start, mask, and state after a turn.
    pub fn new(most: u32, start: Vec<u32>, open: u32, next: Vec<u32>) -> Self {
        Self {
            most,
            start,
            open,
            next,
        }
    }
}

/// Branches of a [`Program`]: forks by masks, and the outputs at their ends.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ProgramBranch {
    /// End of a branch: the outputs of the program, as indices of operations.
    End(Vec<u32>),
    /// Fork.
    Fork {
        /// Mask, as the index of an operation.
        mask: u32,
        /// Branch where the mask is true.
        yes: Box<ProgramBranch>,
        /// Branch where it is false.
        no: Box<ProgramBranch>,
    },
}

impl ProgramBranch {
    /// Number of ends.
    pub fn ends(&self) -> usize {
        match self {
            Self::End(_) => 1,
            Self::Fork { yes, no, .. } => yes.ends() + no.ends(),
        }
    }
}

/// Parts of a [`Program`].
#[derive(Clone, Debug, PartialEq)]
pub struct ProgramParts {
    /// Name of what the program computes, such as that of a law.
    pub name: String,
    /// Format of all numbers.
    pub format: NumberFormat,
    /// Names of the inputs, such as `strain.xx`.
    pub inputs: Vec<String>,
    /// Names of the outputs, such as `stress_change.xx`.
    pub outputs: Vec<String>,
    /// Operations, each after its operands.
    pub operations: Vec<ProgramOperation>,
    /// Loops.
    pub loops: Vec<ProgramLoop>,
    /// Forks and outputs.
    pub branch: ProgramBranch,
}

/// Program: the arithmetic of one integration point or one element from inputs to outputs, as a graph of operations with
/// forks and loops.
///
/// It is recorded from a law or a kernel that is generic over the [lane](crate::Lane), and has its bits when it is
/// replayed or compiled with exact IEEE arithmetic: without contraction of products and sums, and without reordering.
///
/// ```
/// use powerhouse_model::{NumberFormat, ProgramOperation, Program, ProgramBranch, ProgramParts};
/// // a * a + b
/// let program = Program::new(ProgramParts {
///     name: "square-and-sum".into(),
///     format: NumberFormat::F64,
///     inputs: vec!["a".into(), "b".into()],
///     outputs: vec!["sum".into()],
///     operations: vec![ProgramOperation::Input(0), ProgramOperation::Input(1), ProgramOperation::MulAdd(0, 0, 1)],
///     loops: vec![],
///     branch: ProgramBranch::End(vec![2]),
/// })?;
/// assert_eq!(program.operations().len(), 3);
/// # Ok::<(), powerhouse_model::ProgramError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Program(ProgramParts);

impl Program {
    /// A program of parts that fit each other.
    ///
    /// # Errors
    /// [`ProgramError::Operand`], [`ProgramError::Loop`] and [`ProgramError::Branch`]: an operand that is not before its
    /// operation, or is a mask where a number is needed or the reverse; an input, loop or number of a state that does not
    /// exist; outputs of another number than their names.
    pub fn new(parts: ProgramParts) -> Result<Self, ProgramError> {
        let program = Self(parts);
        for (index, operation) in program.0.operations.iter().enumerate() {
            let fits = program.operation_fits(index, *operation);
            fits.then_some(()).ok_or(ProgramError::Operand { index })?;
        }
        for (index, of) in program.0.loops.iter().enumerate() {
            let numbers = of.start.len() == of.next.len()
                && of
                    .start
                    .iter()
                    .chain(&of.next)
                    .all(|&id| program.is(id, false));
            let fits = numbers && !of.start.is_empty() && program.is(of.open, true);
            fits.then_some(()).ok_or(ProgramError::Loop { index })?;
        }
        let fits = program.branch_fits(&program.0.branch);
        fits.then_some(()).ok_or(ProgramError::Branch)?;
        Ok(program)
    }

    /// Whether an index is that of a number, or of a mask.
    fn is(&self, id: u32, mask: bool) -> bool {
        let operation = self.0.operations.get(id as usize);
        operation.is_some_and(|operation| operation.is_mask() == mask)
    }

    fn operation_fits(&self, index: usize, operation: ProgramOperation) -> bool {
        let masks = usize::from(matches!(operation, ProgramOperation::Select(..)));
        let mut operands = operation.operands().enumerate();
        let ordered =
            operands.all(|(n, operand)| (operand as usize) < index && self.is(operand, n < masks));
        ordered
            && match operation {
                ProgramOperation::Input(input) => (input as usize) < self.0.inputs.len(),
                ProgramOperation::LoopState(of, number) => {
                    let of = self.0.loops.get(of as usize);
                    // What a turn starts with is computed before it.
                    of.is_some_and(|of| {
                        (number as usize) < of.start.len()
                            && of.start.iter().all(|&id| (id as usize) < index)
                    })
                }
                ProgramOperation::LoopEnd(of, number) => {
                    let of = self.0.loops.get(of as usize);
                    of.is_some_and(|of| {
                        let mut before = of.start.iter().chain(&of.next).chain([&of.open]);
                        (number as usize) < of.start.len()
                            && before.all(|&id| (id as usize) < index)
                    })
                }
                _ => true,
            }
    }

    fn branch_fits(&self, branch: &ProgramBranch) -> bool {
        match branch {
            ProgramBranch::End(outputs) => {
                outputs.len() == self.0.outputs.len()
                    && outputs.iter().all(|&id| self.is(id, false))
            }
            ProgramBranch::Fork { mask, yes, no } => {
                self.is(*mask, true) && self.branch_fits(yes) && self.branch_fits(no)
            }
        }
    }

    /// Name of what the program computes.
    pub fn name(&self) -> &str {
        &self.0.name
    }
    /// Format of all numbers.
    pub fn format(&self) -> NumberFormat {
        self.0.format
    }
    /// Names of the inputs.
    pub fn inputs(&self) -> &[String] {
        &self.0.inputs
    }
    /// Names of the outputs.
    pub fn outputs(&self) -> &[String] {
        &self.0.outputs
    }
    /// Operations, each after its operands.
    pub fn operations(&self) -> &[ProgramOperation] {
        &self.0.operations
    }
    /// Loops.
    pub fn loops(&self) -> &[ProgramLoop] {
        &self.0.loops
    }
    /// Forks and outputs.
    pub fn branch(&self) -> &ProgramBranch {
        &self.0.branch
    }
    /// Parts of the program.
    pub fn into_parts(self) -> ProgramParts {
        self.0
    }
}

/// Reason why there is no program of something, or why parts are none.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ProgramError {
    /// Elements or an engine without programs.
    #[error("'{name}' has no program: its arithmetic is not written in lanes")]
    None {
        /// Name of the element set or of the engine.
        name: String,
    },
    /// Elements that are compiled without the recording of programs.
    #[error(
        "'{name}' has no program: this build leaves them out; compile it with the feature `programs`"
    )]
    LeftOut {
        /// Name of the element set.
        name: String,
    },
    /// A law that is evaluated one point at a time.
    #[error(
        "the law '{law}' has no program: it is evaluated one point at a time; a law that implements \
         ConstitutiveLaw, in lanes, has one"
    )]
    OnePoint {
        /// Name of the law.
        law: String,
    },
    /// A law that depends on the location of the point.
    #[error("the law '{law}' has no program: it depends on the location of the integration point")]
    Location {
        /// Name of the law.
        law: String,
    },
    /// Arithmetic that reads the numbers of single lanes.
    #[error("'{name}' has no program: it reads or builds the numbers of single lanes")]
    SingleLanes {
        /// Name of the law or kernel.
        name: String,
    },
    /// A translation for which the number format has no type.
    #[error("'{name}' has numbers in {found:?}, and this language has {expected:?} alone")]
    Format {
        /// Name of the program.
        name: String,
        /// Format of the program.
        found: NumberFormat,
        /// Format that is possible.
        expected: NumberFormat,
    },
    /// Lists of inputs or outputs of another length than the program's.
    #[error("'{name}' has {expected} {list}, and {found} were given")]
    Length {
        /// Name of the program.
        name: String,
        /// Which list: `inputs` or `outputs`.
        list: &'static str,
        /// Number of the program's.
        expected: usize,
        /// Number given.
        found: usize,
    },
    /// An operation with an operand that is not before it or of the wrong kind, or of an input or loop that is not there.
    #[error("operation {index} of a program does not fit those before it")]
    Operand {
        /// Index of the operation.
        index: usize,
    },
    /// A loop whose lists differ in length, or have masks in place of numbers or the reverse.
    #[error("loop {index} of a program does not fit its operations")]
    Loop {
        /// Index of the loop.
        index: usize,
    },
    /// A fork without a mask, or an end with outputs of another number than their names.
    #[error("forks and outputs of a program do not fit its operations")]
    Branch,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parts(operations: Vec<ProgramOperation>, outputs: Vec<u32>) -> ProgramParts {
        ProgramParts {
            name: "test".into(),
            format: NumberFormat::F64,
            inputs: vec!["x".into()],
            outputs: vec!["y".into()],
            operations,
            loops: vec![],
            branch: ProgramBranch::End(outputs),
        }
    }

    /// Parts that do not fit each other are no program: operands after their operation, masks as numbers, inputs, loops
    /// and outputs that are not there.
    #[test]
    fn only_parts_that_fit_are_a_program() {
        use ProgramOperation::{Add, Input, Less, LoopEnd, LoopState, Select};
        assert!(Program::new(parts(vec![Input(0), Add(0, 0)], vec![1])).is_ok());
        for (operations, index) in [
            (vec![Input(1)], 0),
            (vec![Input(0), Add(0, 1)], 1),
            (vec![Input(0), Less(0, 0), Add(0, 1)], 2),
            (vec![Input(0), Select(0, 0, 0)], 1),
            (vec![LoopState(0, 0)], 0),
            (vec![LoopEnd(0, 0)], 0),
        ] {
            let refused = Program::new(parts(operations, vec![0]));
            assert_eq!(refused, Err(ProgramError::Operand { index }));
        }
        for outputs in [vec![], vec![1], vec![2]] {
            let refused = Program::new(parts(vec![Input(0), Less(0, 0)], outputs));
            assert_eq!(refused, Err(ProgramError::Branch));
        }
        let mut looped = parts(vec![Input(0), Less(0, 0), LoopState(0, 0)], vec![0]);
        looped.loops = vec![ProgramLoop::new(3, vec![0], 1, vec![2])];
        assert!(Program::new(looped.clone()).is_ok());
        looped.loops[0].next = vec![1];
        assert_eq!(Program::new(looped), Err(ProgramError::Loop { index: 0 }));
    }
}
