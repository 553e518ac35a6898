//! Runs that are taken step by step.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;

use numpy::{PyArray1, PyArray2};
use powerhouse::model::{Cadence, Fields, Flow, ModelError, Observer, StepView};
use pyo3::prelude::*;

use crate::alarm::Alarm;
use crate::arrays::{of_list, of_rows};
use crate::fault::exception;
use crate::results::Results;
use crate::run::{End, Order, Progress, Ran, finished, make};
use crate::turns::{Turn, Turns};

/// What can be read at a step.
#[derive(Clone, Debug)]
enum Question {
    Displacement,
    Velocity,
    Acceleration,
    Stress,
    /// A history variable by its name; elements without it have no number.
    History(String),
}

/// What both threads see.
struct Meeting {
    turns: Turns,
    number: AtomicU64,
    /// Bits of time and step (s).
    time: AtomicU64,
    step: AtomicU64,
    question: Mutex<Question>,
    answer: Mutex<Vec<f64>>,
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Observer that waits at every step until the other thread has seen it.
struct Host {
    meeting: Arc<Meeting>,
    every: u64,
    elements: usize,
}

impl Host {
    /// Answers a question about the step.
    fn answer(&self, view: &dyn StepView) {
        let nodes = 0..view.node_count() as u32;
        let elements = 0..self.elements as u32;
        let mut answer = locked(&self.meeting.answer);
        answer.clear();
        match &*locked(&self.meeting.question) {
            Question::Displacement => {
                answer.extend(nodes.flat_map(|node| <[f64; 3]>::from(view.displacement(node))));
            }
            Question::Velocity => {
                answer.extend(nodes.flat_map(|node| <[f64; 3]>::from(view.velocity(node))));
            }
            Question::Acceleration => {
                answer.extend(nodes.flat_map(|node| <[f64; 3]>::from(view.acceleration(node))));
            }
            Question::Stress => answer.extend(elements.flat_map(|e| view.stress(e).0)),
            Question::History(name) => {
                answer.extend(elements.map(|e| view.history(e, name).unwrap_or(f64::NAN)));
            }
        }
    }
}

impl Observer for Host {
    fn name(&self) -> &str {
        "stepping by hand"
    }
    fn fields(&self) -> Fields {
        Fields::default().with_acceleration(true).with_stress(true)
    }
    fn cadence(&self) -> Cadence {
        Cadence::Steps(self.every)
    }
    fn observe(&mut self, view: &dyn StepView) -> Result<Flow, ModelError> {
        let meeting = &self.meeting;
        meeting.number.store(view.number(), Ordering::Relaxed);
        meeting.time.store(view.time().to_bits(), Ordering::Relaxed);
        meeting.step.store(view.step().to_bits(), Ordering::Relaxed);
        // After the step at which it was stopped the run does not wait any more.
        if !meeting.turns.change(Turn::Run, Turn::Pause) {
            return Ok(Flow::Stop);
        }
        loop {
            match meeting.turns.wait(|turn| turn == Turn::Pause) {
                Turn::Pause => {}
                Turn::Answer => {
                    self.answer(view);
                    meeting.turns.change(Turn::Answer, Turn::Pause);
                }
                Turn::Run => return Ok(Flow::Continue),
                Turn::Stop | Turn::End => return Ok(Flow::Stop),
            }
        }
    }
}

/// A run on another thread that waits at its steps.
#[pyclass(frozen, module = "powerhouse_fe._core")]
pub(crate) struct Steps {
    meeting: Arc<Meeting>,
    alarm: Arc<Alarm>,
    nodes: usize,
    elements: usize,
    thread: Mutex<Option<JoinHandle<Result<Ran, End>>>>,
}

impl Steps {
    /// Starts the run of a scene with numbers of nodes and elements.
    pub(crate) fn start(order: Order, every: u64, (nodes, elements): (usize, usize)) -> Self {
        let meeting = Arc::new(Meeting {
            turns: Turns::new(order.threads.unwrap_or(usize::MAX)),
            number: AtomicU64::new(0),
            time: AtomicU64::new(0),
            step: AtomicU64::new(0),
            question: Mutex::new(Question::Displacement),
            answer: Mutex::new(Vec::new()),
        });
        let alarm = Arc::new(Alarm::default());
        let (of_run, raised) = (meeting.clone(), alarm.clone());
        let thread = std::thread::spawn(move || {
            /// Says that the run has ended, also if it panics.
            struct AtEnd(Arc<Meeting>);
            impl Drop for AtEnd {
                fn drop(&mut self) {
                    self.0.turns.give(Turn::End);
                }
            }
            let _end = AtEnd(of_run.clone());
            let host = Host {
                meeting: of_run,
                every,
                elements,
            };
            make(
                &order,
                &raised,
                &Arc::new(Progress::default()),
                Some(Box::new(host)),
            )
        });
        Self {
            meeting,
            alarm,
            nodes,
            elements,
            thread: Mutex::new(Some(thread)),
        }
    }

    /// Waits until the run is at a step or has ended; whether it is at a step.
    fn reach(&self, py: Python<'_>) -> PyResult<bool> {
        loop {
            let turn = py.detach(|| {
                self.meeting
                    .turns
                    .wait(|turn| turn == Turn::Run || turn == Turn::Stop)
            });
            match turn {
                Turn::Pause => return Ok(true),
                Turn::End => return Ok(false),
                _ => py.check_signals()?,
            }
        }
    }

    /// Answers of the run about its present step.
    fn ask(&self, py: Python<'_>, question: Question) -> PyResult<Vec<f64>> {
        *locked(&self.meeting.question) = question;
        if !self.meeting.turns.change(Turn::Pause, Turn::Answer) {
            return Err(exception(
                py,
                "Error",
                "the run is at no step: it has not begun or has ended",
            ));
        }
        loop {
            let turn = py.detach(|| self.meeting.turns.wait(|turn| turn == Turn::Answer));
            if turn != Turn::Answer {
                return Ok(core::mem::take(&mut locked(&self.meeting.answer)));
            }
        }
    }
}

impl Drop for Steps {
    /// A run that nobody waits for is stopped after its step.
    fn drop(&mut self) {
        self.alarm.stop.store(true, Ordering::Relaxed);
        self.meeting.turns.change(Turn::Pause, Turn::Stop);
        self.meeting.turns.change(Turn::Run, Turn::Stop);
    }
}

#[pymethods]
impl Steps {
    /// Goes to the next step at which the run waits; false at its end.
    fn go_on(&self, py: Python<'_>) -> PyResult<bool> {
        self.meeting.turns.change(Turn::Pause, Turn::Run);
        self.reach(py)
    }
    /// Number of the step, from 0.
    #[getter]
    fn number(&self) -> u64 {
        self.meeting.number.load(Ordering::Relaxed)
    }
    /// Time of the displacement (s).
    #[getter]
    fn time(&self) -> f64 {
        f64::from_bits(self.meeting.time.load(Ordering::Relaxed))
    }
    /// Length of the step (s).
    #[getter]
    fn step(&self) -> f64 {
        f64::from_bits(self.meeting.step.load(Ordering::Relaxed))
    }
    /// Displacement (m) of the nodes, one row each.
    #[getter]
    fn displacement<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        of_rows(py, self.ask(py, Question::Displacement)?, 3)
    }
    /// Velocity (m/s) of the nodes, one row each.
    #[getter]
    fn velocity<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        of_rows(py, self.ask(py, Question::Velocity)?, 3)
    }
    /// Acceleration (m/s2) of the nodes, one row each.
    #[getter]
    fn acceleration<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        of_rows(py, self.ask(py, Question::Acceleration)?, 3)
    }
    /// Mean stress (Pa) of the elements, one row each: xx, yy, zz, xy, yz, zx.
    #[getter]
    fn stress<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        of_rows(py, self.ask(py, Question::Stress)?, 6)
    }
    /// A history variable of the elements; not a number where the law has none of the name.
    fn history<'py>(&self, py: Python<'py>, name: String) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(of_list(py, self.ask(py, Question::History(name))?))
    }
    /// Number of nodes.
    #[getter]
    fn node_count(&self) -> usize {
        self.nodes
    }
    /// Number of elements.
    #[getter]
    fn element_count(&self) -> usize {
        self.elements
    }
    /// Ends the run, if it has not ended, and returns its results; none if they were returned already.
    fn finish(&self, py: Python<'_>) -> PyResult<Option<Results>> {
        let Some(thread) = locked(&self.thread).take() else {
            return Ok(None);
        };
        self.alarm.stop.store(true, Ordering::Relaxed);
        self.meeting.turns.change(Turn::Pause, Turn::Stop);
        self.meeting.turns.change(Turn::Run, Turn::Stop);
        match py.detach(|| thread.join()) {
            Ok(outcome) => finished(py, outcome, self.alarm.take()).map(Some),
            Err(panic) => std::panic::resume_unwind(panic),
        }
    }
}
