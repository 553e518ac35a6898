//! Replay of programs on numbers.

use powerhouse_model::{Lane, NumberFormat, Program, ProgramError, ProgramOperation, Scalar};

use crate::schedule::{BranchEnd, BranchSteps, LoopSteps, Step, schedule};

/// Interpreter of a [`Program`]: the reference of its translations, with the bits of the law or kernel from which it was
/// recorded.
///
/// ```
/// use powerhouse_model::Lane;
/// use powerhouse_program::{Names, Replay, record};
/// let names = Names {
///     program: "hypotenuse".into(),
///     inputs: vec!["a".into(), "b".into()],
///     outputs: vec!["c".into()],
/// };
/// let program = record::<f64>(names, 0, |x| vec![x[0].mul_add(x[0], x[1] * x[1]).sqrt()])?;
/// let mut replay = Replay::<f64>::new(&program)?;
/// let mut c = [0.0];
/// replay.run(&[3.0, 4.0], &mut c)?;
/// assert_eq!(c, [5.0]);
/// # Ok::<(), powerhouse_model::ProgramError>(())
/// ```
pub struct Replay<'a, S> {
    program: &'a Program,
    steps: BranchSteps,
    /// Operations that are numbers of the state of each loop, with their indices in it.
    states: Vec<Vec<(u32, u32)>>,
    numbers: Vec<S>,
    masks: Vec<bool>,
}

impl<'a, S: Scalar + Lane<Scalar = S, Token = (), Mask = bool>> Replay<'a, S> {
    /// Prepares the replay of a program.
    ///
    /// # Errors
    /// [`ProgramError::Format`] if the program's numbers have another format than `S`.
    pub fn new(program: &'a Program) -> Result<Self, ProgramError> {
        let expected = if S::EPSILON > f64::EPSILON {
            NumberFormat::F32
        } else {
            NumberFormat::F64
        };
        if program.format() != expected {
            return Err(ProgramError::Format {
                name: program.name().to_owned(),
                found: program.format(),
                expected,
            });
        }
        let count = program.operations().len();
        let mut states = vec![Vec::new(); program.loops().len()];
        for (id, operation) in (0..).zip(program.operations()) {
            if let ProgramOperation::LoopState(of, number) | ProgramOperation::LoopEnd(of, number) =
                *operation
            {
                states[of as usize].push((id, number));
            }
        }
        Ok(Self {
            program,
            steps: schedule(program),
            states,
            numbers: vec![S::default(); count],
            masks: vec![false; count],
        })
    }

    /// Computes the outputs of some inputs, in the order of their names.
    ///
    /// # Errors
    /// [`ProgramError::Length`] if there are more or fewer of them than names.
    pub fn run(&mut self, inputs: &[S], outputs: &mut [S]) -> Result<(), ProgramError> {
        for (list, expected, found) in [
            ("inputs", self.program.inputs().len(), inputs.len()),
            ("outputs", self.program.outputs().len(), outputs.len()),
        ] {
            if expected != found {
                return Err(ProgramError::Length {
                    name: self.program.name().to_owned(),
                    list,
                    expected,
                    found,
                });
            }
        }
        let mut values = Values {
            program: self.program,
            inputs,
            states: &self.states,
            numbers: &mut self.numbers,
            masks: &mut self.masks,
        };
        let mut branch = &self.steps;
        loop {
            values.all(&branch.steps);
            match &branch.end {
                BranchEnd::Outputs(indices) => {
                    for (output, &index) in outputs.iter_mut().zip(indices) {
                        *output = values.numbers[index as usize];
                    }
                    return Ok(());
                }
                BranchEnd::Fork { mask, yes, no } => {
                    branch = if values.masks[*mask as usize] {
                        yes
                    } else {
                        no
                    };
                }
            }
        }
    }
}

/// Results of the operations so far.
struct Values<'a, S> {
    program: &'a Program,
    inputs: &'a [S],
    states: &'a [Vec<(u32, u32)>],
    numbers: &'a mut [S],
    masks: &'a mut [bool],
}

impl<S: Scalar + Lane<Scalar = S, Token = (), Mask = bool>> Values<'_, S> {
    fn all(&mut self, steps: &[Step]) {
        for step in steps {
            match step {
                Step::Compute(index) => self.compute(*index),
                Step::Loop(steps) => self.turns(steps),
            }
        }
    }

    fn compute(&mut self, index: u32) {
        let at = |index: u32| self.numbers[index as usize];
        let number = match self.program.operations()[index as usize] {
            ProgramOperation::Constant(bits) => S::from_f64(f64::from_bits(bits)),
            ProgramOperation::Input(input) => self.inputs[input as usize],
            ProgramOperation::Add(a, b) => at(a) + at(b),
            ProgramOperation::Sub(a, b) => at(a) - at(b),
            ProgramOperation::Mul(a, b) => at(a) * at(b),
            ProgramOperation::Div(a, b) => at(a) / at(b),
            ProgramOperation::Neg(a) => -at(a),
            ProgramOperation::MulAdd(a, b, c) => at(a).mul_add(at(b), at(c)),
            ProgramOperation::Sqrt(a) => at(a).sqrt(),
            ProgramOperation::Abs(a) => at(a).abs(),
            ProgramOperation::Round(a) => at(a).round(),
            ProgramOperation::PowerOfTwo(a) => at(a).power_of_two(),
            ProgramOperation::Select(mask, a, b) => at(a).select(self.masks[mask as usize], at(b)),
            ProgramOperation::Less(a, b) => {
                self.masks[index as usize] = at(a).less(at(b));
                return;
            }
            // Loops write them.
            ProgramOperation::LoopState(..) | ProgramOperation::LoopEnd(..) => return,
        };
        self.numbers[index as usize] = number;
    }

    fn turns(&mut self, steps: &LoopSteps) {
        let program = self.program;
        let parts = &program.loops()[steps.index as usize];
        let read = |values: &Self, indices: &[u32]| -> Vec<S> {
            let numbers = indices.iter();
            numbers.map(|&id| values.numbers[id as usize]).collect()
        };
        let mut state = read(self, &parts.start);
        for _ in 0..parts.most {
            self.write(steps.index, &state);
            self.all(&steps.test);
            if !self.masks[parts.open as usize] {
                break;
            }
            self.all(&steps.turn);
            state = read(self, &parts.next);
        }
        self.write(steps.index, &state);
    }

    /// Writes the state of a loop, within it and after it.
    fn write(&mut self, of: u32, state: &[S]) {
        for &(id, number) in &self.states[of as usize] {
            self.numbers[id as usize] = state[number as usize];
        }
    }
}
