//! Lane type that records the operations of what is computed with it.

use core::marker::PhantomData;
use core::ops::{Add, Div, Mul, Neg, Sub};
use std::cell::RefCell;
use std::collections::HashMap;

use powerhouse_model::{
    Lane, NumberFormat, Program, ProgramBranch, ProgramError, ProgramLoop, ProgramOperation,
    ProgramParts, Repeated, Scalar,
};

/// Number that is known by its operation alone: an input, a constant or a result in a recording.
///
/// [`record`] makes the inputs. Numbers of one recording have no meaning in another one, or outside of it.
#[derive(Clone, Copy, Debug)]
pub struct Traced<S> {
    operation: u32,
    format: PhantomData<S>,
}

/// Mask of [`Traced`] numbers, likewise.
#[derive(Clone, Copy, Debug)]
pub struct TracedMask {
    operation: u32,
}

/// Operations that have been recorded, and answers of [`Lane::any`].
#[derive(Default)]
struct Recorder {
    operations: Vec<ProgramOperation>,
    /// Index of each operation, of which there is one of a kind.
    known: HashMap<ProgramOperation, u32>,
    loops: Vec<ProgramLoop>,
    /// Depth of loops.
    depth: usize,
    /// Number of questions that fork; all others are answered with true, which is always right: another lane may hold.
    forks: usize,
    /// Answers to the first questions on the way that is recorded.
    answers: Vec<bool>,
    /// Masks that have been asked for on it, with the answers.
    asked: Vec<(u32, bool)>,
    /// Whether numbers of single lanes were read or built.
    leaves_lanes: bool,
}

thread_local! {
    static RECORDER: RefCell<Recorder> = RefCell::default();
}

/// Index of an operation, which is recorded if it is new.
fn index_of(operation: ProgramOperation) -> u32 {
    RECORDER.with_borrow_mut(|recorder| {
        let next = recorder.operations.len() as u32;
        let index = *recorder.known.entry(operation).or_insert(next);
        if index == next {
            recorder.operations.push(operation);
        }
        index
    })
}

/// Records that numbers of single lanes were read or built.
fn leave_lanes() {
    RECORDER.with_borrow_mut(|recorder| recorder.leaves_lanes = true);
}

impl<S: Scalar> Traced<S> {
    fn new(operation: ProgramOperation) -> Self {
        Self::at(index_of(operation))
    }
    fn at(operation: u32) -> Self {
        Self {
            operation,
            format: PhantomData,
        }
    }
}

macro_rules! binary {
    ($($operation:ident $method:ident)*) => { $(
        impl<S: Scalar> $operation for Traced<S> {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                Self::new(ProgramOperation::$operation(self.operation, other.operation))
            }
        }
    )* }
}

binary!(Add add Sub sub Mul mul Div div);

impl<S: Scalar> Neg for Traced<S> {
    type Output = Self;
    fn neg(self) -> Self {
        Self::new(ProgramOperation::Neg(self.operation))
    }
}

impl<S: Scalar> Lane for Traced<S> {
    type Scalar = S;
    type Token = ();
    type Mask = TracedMask;
    const WIDTH: usize = 1;

    fn splat(_token: (), value: f64) -> Self {
        let rounded = S::from_f64(value).to_f64();
        Self::new(ProgramOperation::Constant(rounded.to_bits()))
    }
    fn load(_token: (), from: &[S]) -> Self {
        Self::splat((), from[0].to_f64())
    }
    /// Has no number to write: the recording fails.
    fn store(self, to: &mut [S]) {
        leave_lanes();
        to[0] = S::default();
    }
    fn token(self) {}
    fn mul_add(self, factor: Self, summand: Self) -> Self {
        Self::new(ProgramOperation::MulAdd(
            self.operation,
            factor.operation,
            summand.operation,
        ))
    }
    fn sqrt(self) -> Self {
        Self::new(ProgramOperation::Sqrt(self.operation))
    }
    fn abs(self) -> Self {
        Self::new(ProgramOperation::Abs(self.operation))
    }
    fn less(self, other: Self) -> TracedMask {
        TracedMask {
            operation: index_of(ProgramOperation::Less(self.operation, other.operation)),
        }
    }
    fn select(self, mask: TracedMask, other: Self) -> Self {
        if self.operation == other.operation {
            return self;
        }
        Self::new(ProgramOperation::Select(
            mask.operation,
            self.operation,
            other.operation,
        ))
    }
    fn any(self, mask: TracedMask) -> bool {
        RECORDER.with_borrow_mut(|recorder| {
            if recorder.depth > 0 {
                return true;
            }
            let known = recorder.asked.iter().find(|(of, _)| *of == mask.operation);
            if let Some(&(_, answer)) = known {
                return answer;
            }
            let answer = recorder.answers.get(recorder.asked.len());
            let answer = answer.copied().unwrap_or(true);
            recorder.asked.push((mask.operation, answer));
            answer
        })
    }
    /// Has no number to return: the recording fails.
    fn extract(self, _lane: usize) -> f64 {
        leave_lanes();
        0.0
    }
    /// A number that no operation has made: the recording fails.
    fn build(token: (), _value: impl FnMut(usize) -> f64) -> Self {
        leave_lanes();
        Self::splat(token, 0.0)
    }
    fn round(self) -> Self {
        Self::new(ProgramOperation::Round(self.operation))
    }
    fn power_of_two(self) -> Self {
        Self::new(ProgramOperation::PowerOfTwo(self.operation))
    }
    fn repeat<const N: usize>(
        most: usize,
        start: [Self; N],
        turns: &impl Repeated<Self, N>,
    ) -> [Self; N] {
        let indices = |numbers: &[Self; N]| -> Vec<u32> {
            numbers.iter().map(|number| number.operation).collect()
        };
        let start = indices(&start);
        let most = u32::try_from(most).unwrap_or(u32::MAX);
        // A loop that has been recorded on another way, or a new one.
        for of in 0.. {
            let known = RECORDER.with_borrow(|recorder| recorder.loops.get(of).cloned());
            let differs = |known: &ProgramLoop| known.start != start || known.most != most;
            if known.as_ref().is_some_and(differs) {
                continue;
            }
            if known.is_none() {
                let reserved = ProgramLoop::new(most, start.clone(), 0, Vec::new());
                RECORDER.with_borrow_mut(|recorder| recorder.loops.push(reserved));
            }
            let state = |of: usize, end: bool| -> [Self; N] {
                core::array::from_fn(|number| {
                    let (of, number) = (of as u32, number as u32);
                    Self::new(if end {
                        ProgramOperation::LoopEnd(of, number)
                    } else {
                        ProgramOperation::LoopState(of, number)
                    })
                })
            };
            RECORDER.with_borrow_mut(|recorder| recorder.depth += 1);
            let at_turn = state(of, false);
            let open = turns.open(&at_turn).operation;
            let next = indices(&turns.next(at_turn));
            RECORDER.with_borrow_mut(|recorder| recorder.depth -= 1);
            let found = ProgramLoop::new(most, start.clone(), open, next);
            match known {
                Some(known) if known != found => continue,
                Some(_) => {}
                None => RECORDER.with_borrow_mut(|recorder| recorder.loops[of] = found),
            }
            return state(of, true);
        }
        unreachable!("some number of loops is reached")
    }
}

/// Names of what is recorded.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Names {
    /// Name of the program.
    pub program: String,
    /// Names of the inputs.
    pub inputs: Vec<String>,
    /// Names of the outputs.
    pub outputs: Vec<String>,
}

/// Records the program of a function of inputs that computes with any lane.
///
/// The function is called once for every combination of answers to its first `forks` different questions by
/// [`Lane::any`], which become forks of the program. All further ones are answered with true, so that both sides are
/// computed and selected from: by its contract the bits of a lane do not depend on what other lanes hold. One fork is mostly best: where nothing
/// yields a law leaves early, and more forks multiply the length of the program.
///
/// # Errors
/// [`ProgramError::SingleLanes`] if the function reads or builds numbers of single lanes;
/// [`ProgramError::Branch`] if it returns another number of outputs than names.
pub fn record<S: Scalar>(
    names: Names,
    forks: usize,
    function: impl Fn(&[Traced<S>]) -> Vec<Traced<S>>,
) -> Result<Program, ProgramError> {
    let fresh = Recorder {
        forks,
        ..Recorder::default()
    };
    // A recording within another one leaves the outer one as it is.
    let outer = RECORDER.replace(fresh);
    let inputs: Vec<Traced<S>> = (0..names.inputs.len() as u32)
        .map(|input| Traced::new(ProgramOperation::Input(input)))
        .collect();
    let ways = || {
        let outputs = function(&inputs);
        outputs.iter().map(|number| number.operation).collect()
    };
    let branch = explore(&ways, &[]);
    let recorder = RECORDER.replace(outer);
    if recorder.leaves_lanes {
        return Err(ProgramError::SingleLanes {
            name: names.program,
        });
    }
    Program::new(ProgramParts {
        name: names.program,
        format: if S::EPSILON > f64::EPSILON {
            NumberFormat::F32
        } else {
            NumberFormat::F64
        },
        inputs: names.inputs,
        outputs: names.outputs,
        operations: recorder.operations,
        loops: recorder.loops,
        branch,
    })
}

/// Branches of a function below some first answers.
fn explore(function: &dyn Fn() -> Vec<u32>, answers: &[bool]) -> ProgramBranch {
    RECORDER.with_borrow_mut(|recorder| {
        recorder.answers = answers.to_vec();
        recorder.asked.clear();
    });
    let mut branch = ProgramBranch::End(function());
    let (mut asked, forks) =
        RECORDER.with_borrow(|recorder| (recorder.asked.clone(), recorder.forks));
    asked.truncate(forks);
    // The other way at each question after the given answers, from the last one on.
    while asked.len() > answers.len() {
        let (mask, _) = asked.pop().unwrap_or_default();
        let mut other: Vec<bool> = asked.iter().map(|(_, answer)| *answer).collect();
        other.push(false);
        branch = ProgramBranch::Fork {
            mask,
            yes: Box::new(branch),
            no: Box::new(explore(function, &other)),
        };
    }
    branch
}
