//! The end of a run, on which all ranks agree.
//!
//! A rank that fails sends its neighbours, instead of forces, that it has ended; those do the same, and so on. All then
//! agree on the failure of the earliest step, which is the one that a model on one rank meets. Before every collective
//! operation of a run the ranks agree that none has failed, so that no rank waits in another operation than the others.

use powerhouse_model::{Checksum, Observer, RunError, decode, encode};
use serde::{Deserialize, Serialize};

use super::assembly::Ranked;
use super::layout::ABSENT;
use crate::Model;
use crate::model::ElementAt;

/// Key of a rank that has not failed, in place of that of a failure.
const NONE: u64 = u64::MAX;
/// Keys of rank 0 if the state of the run is to be saved, and of a rank that is to stop after the next step.
const SAVE: u64 = u64::MAX - 1;
const STOP: u64 = u64::MAX - 2;
/// Kind of a divergence in the key of a failure, the last in a step.
const DIVERGED: u64 = 3;
/// Number of steps between two agreements on saving and stopping.
const INTERVAL: u64 = 16;

/// What the ranks do before the next step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Decision {
    GoOn,
    /// Save the state of the run.
    Save,
    /// Save the state of the run, and stop after the next step.
    Stop,
}

/// What a rank knows of the end of a run.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Outcome {
    /// Order of the failure of this rank among those of the same kind in the same step.
    order: [u64; 2],
    /// Key of the failure on which the ranks have agreed.
    agreed: Option<u64>,
    /// Whether this rank ends because another one has failed.
    elsewhere: bool,
}

/// A failure as it is sent to other ranks.
#[derive(Serialize, Deserialize)]
enum SentError {
    Element {
        element: u64,
        set: String,
        step: u64,
        reason: String,
    },
    Constraint {
        name: String,
        step: u64,
        reason: String,
    },
    Diverged {
        step: u64,
        time: f64,
        element: u64,
        set: String,
        node: u64,
        speed: f64,
    },
    Other(String),
}

impl SentError {
    fn of(error: &RunError) -> Self {
        match error {
            RunError::Element {
                element,
                set,
                step,
                reason,
            } => Self::Element {
                element: *element,
                set: set.clone(),
                step: *step,
                reason: reason.clone(),
            },
            RunError::Constraint { name, step, reason } => Self::Constraint {
                name: name.clone(),
                step: *step,
                reason: reason.clone(),
            },
            RunError::Diverged {
                step,
                time,
                element,
                set,
                node,
                speed,
            } => Self::Diverged {
                step: *step,
                time: *time,
                element: *element,
                set: set.clone(),
                node: *node,
                speed: *speed,
            },
            other => Self::Other(other.to_string()),
        }
    }

    /// The error of a rank.
    fn into_error(self, rank: usize) -> RunError {
        match self {
            Self::Element {
                element,
                set,
                step,
                reason,
            } => RunError::Element {
                element,
                set,
                step,
                reason,
            },
            Self::Constraint { name, step, reason } => RunError::Constraint { name, step, reason },
            Self::Diverged {
                step,
                time,
                element,
                set,
                node,
                speed,
            } => RunError::Diverged {
                step,
                time,
                element,
                set,
                node,
                speed,
            },
            Self::Other(message) => RunError::OnRank { rank, message },
        }
    }
}

impl Ranked {
    /// Records the block of this rank in which the next error is.
    pub(crate) fn failed_in_block(&mut self, block: u32) {
        let number = self.block_numbers.get(block as usize);
        self.outcome.order = [number.map_or(NONE, |&number| number.into()), 0];
    }

    /// Records the constraint of this rank in which the next error is.
    pub(crate) fn failed_in_constraint(&mut self, constraint: usize) {
        let number = self.constraint_numbers.get(constraint);
        self.outcome.order = [number.map_or(NONE, |&number| number.into()), 0];
    }

    /// Records the fastest node of this rank as the place of the next error.
    pub(crate) fn diverged(&mut self, speed: f64, node: usize) {
        // The fastest node comes first.
        let speed = if speed.is_finite() {
            !speed.to_bits()
        } else {
            0
        };
        self.outcome.order = [speed, self.engine(node) as u64];
    }

    /// Ends the run of this rank because another one has failed; the error is replaced when all have agreed on it.
    pub(crate) fn ended_elsewhere(&mut self) -> RunError {
        self.outcome.elsewhere = true;
        let rank = self.team.rank();
        let message = "another rank has failed".into();
        RunError::OnRank { rank, message }
    }

    /// The least key of any rank; an error if one has failed.
    fn decide(&mut self, own: u64) -> Result<u64, RunError> {
        let least = self.team.least(own);
        self.team.check()?;
        if least < STOP {
            self.outcome.agreed = Some(least);
            return Err(self.ended_elsewhere());
        }
        Ok(least)
    }

    /// Agrees with the other ranks that none has failed; to be called before a collective operation in a run.
    pub(crate) fn agree_to_go_on(&mut self) -> Result<(), RunError> {
        if self.is_single() {
            Ok(())
        } else {
            self.decide(NONE).map(|_| ())
        }
    }

    /// Whether the run is saved, or stops after the next step: all ranks agree on it every few steps.
    pub(crate) fn agree_to_stop(
        &mut self,
        raised: bool,
        is_due: impl FnOnce() -> bool,
        done: u64,
    ) -> Result<Decision, RunError> {
        if self.is_single() {
            return Ok(if raised {
                Decision::Stop
            } else {
                Decision::GoOn
            });
        }
        if !done.is_multiple_of(INTERVAL) {
            return Ok(Decision::GoOn);
        }
        let own = match raised {
            true => STOP,
            false if self.team.rank() == 0 && is_due() => SAVE,
            false => NONE,
        };
        Ok(match self.decide(own)? {
            STOP => Decision::Stop,
            SAVE => Decision::Save,
            _ => Decision::GoOn,
        })
    }

    /// The result of work on every rank before the first step: a failure of one of them is one on all.
    pub(crate) fn agree<T>(&self, result: Result<T, RunError>) -> Result<T, RunError> {
        if self.is_single() {
            return result;
        }
        let team = &self.team;
        let rank = if result.is_err() {
            team.rank()
        } else {
            team.count()
        };
        let first = team.least(rank as u64) as usize;
        team.check()?;
        if first >= team.count() {
            return result;
        }
        let message = result.as_ref().err().map(RunError::to_string);
        let message = team.of_rank(first, message.unwrap_or_default().into_bytes());
        team.check()?;
        match result {
            Err(error) if first == team.rank() => Err(error),
            _ => Err(RunError::OnRank {
                rank: first,
                message: String::from_utf8_lossy(&message).into_owned(),
            }),
        }
    }

    /// The error of what one rank alone supports in a run.
    pub(crate) fn run_on_one_rank_only(&self, what: &'static str) -> RunError {
        let ranks = self.team.count();
        RunError::OneRankOnly { what, ranks }
    }

    /// The result of rank 0, that of the observers, on all ranks: the name of the one that stops the run, if any.
    pub(crate) fn follow_first(
        &mut self,
        shown: Option<Result<Option<String>, RunError>>,
    ) -> Result<Option<String>, RunError> {
        let name = match &shown {
            Some(Ok(stopped_by)) => encode(&Some(stopped_by)),
            _ => encode(&None::<Option<String>>),
        };
        let sent = self.team.of_rank(0, name.unwrap_or_default());
        if let Some(own) = shown {
            return own;
        }
        self.team.check()?;
        match decode::<Option<Option<String>>>(&sent) {
            Ok(Some(stopped_by)) => Ok(stopped_by),
            _ => Err(self.ended_elsewhere()),
        }
    }

    /// Checks before the first step that the runs of all ranks have the same step (s), number of steps and observers.
    pub(crate) fn check_same_run(
        &self,
        step: f64,
        planned: u64,
        observers: &[Box<dyn Observer>],
    ) -> Result<(), RunError> {
        if self.is_single() {
            return Ok(());
        }
        let mut of_observers = Checksum::default();
        for observer in observers {
            let (cadence, fields) = (observer.cadence(), observer.fields());
            let kind = format!("{cadence:?} {fields:?} {:?}", observer.reach());
            of_observers.add_whole(kind.as_bytes());
        }
        for (what, number) in [
            ("the time step", step.to_bits()),
            ("the number of steps", planned),
            ("the list of observers", of_observers.value()),
        ] {
            let (least, most) = (self.team.least(number), !self.team.least(!number));
            self.team.check()?;
            if least != most {
                return Err(RunError::RanksDiffer { what });
            }
        }
        Ok(())
    }
}

/// Order of the kinds of errors in a step.
fn key(error: &RunError, now: u64) -> u64 {
    let (step, kind) = match error {
        RunError::Element { step, .. } => (*step, 0),
        RunError::Constraint { step, .. } => (*step, 1),
        RunError::Diverged { step, .. } => (*step, DIVERGED),
        _ => (now, 2),
    };
    (step << 2) + kind
}

impl Model {
    /// The end of a run on which all ranks agree: the result of this rank, or the failure of the earliest step of any rank.
    pub(crate) fn settle<T>(&mut self, result: Result<T, RunError>) -> Result<T, RunError> {
        let (ranks, now) = (&mut self.ranks, self.number);
        if ranks.is_single() {
            return result;
        }
        let Outcome {
            order,
            agreed,
            elsewhere,
        } = core::mem::take(&mut ranks.outcome);
        let own = match &result {
            Err(error) if !elsewhere => key(error, now),
            _ => NONE,
        };
        if result.is_err() {
            ranks.exchange.end(&ranks.team);
        }
        let team = &ranks.team;
        let agreed = agreed.unwrap_or_else(|| team.least(own));
        team.check()?;
        if agreed >= STOP {
            return result;
        }
        let mut is_first = own == agreed;
        let mut last = NONE;
        for number in order {
            last = team.least(if is_first { number } else { NONE });
            is_first &= number == last;
        }
        let at = (agreed & 3 == DIVERGED).then(|| self.element_of_all(last));
        let ranks = &mut self.ranks;
        let team = &ranks.team;
        let rank = team.rank() as u64;
        let first = team.least(if is_first { rank } else { NONE }) as usize;
        let sent = match &result {
            Err(error) if first == team.rank() => encode(&SentError::of(error)).ok(),
            _ => None,
        };
        let received = team.of_rank(first, sent.unwrap_or_default());
        ranks.exchange.drain(team);
        team.check()?;
        let mut error = match (result, decode::<SentError>(&received)) {
            (Err(error), _) if first == team.rank() => error,
            (_, Ok(sent)) => sent.into_error(first),
            (_, Err(error)) => RunError::OnRank {
                rank: first,
                message: error.to_string(),
            },
        };
        if let (RunError::Diverged { element, set, .. }, Some(at)) = (&mut error, at) {
            (*element, *set) = (at.element, at.set);
        }
        Err(error)
    }

    /// Of the elements of all ranks at an engine node, the one with the highest frequency bound, on all ranks.
    pub(crate) fn element_of_all(&self, node: u64) -> ElementAt {
        let team = &self.ranks.team;
        let local = self.ranks.local(node as u32);
        if team.is_single() {
            return self.element_at(node as usize);
        }
        let own = match local {
            ABSENT => ElementAt::default(),
            _ => self.element_at(local as usize),
        };
        let highest = team.most_of(own.frequency);
        let block = own.block.filter(|_| own.frequency == highest);
        let block = block.map_or(NONE, u64::from);
        let first = team.least(block);
        let is_first = block == first && first != NONE;
        let rank = team.least(if is_first { team.rank() as u64 } else { NONE });
        if rank == NONE {
            return own;
        }
        let sent = encode(&(own.element, &own.set)).unwrap_or_default();
        match decode(&team.of_rank(rank as usize, sent)) {
            Ok((element, set)) => ElementAt {
                element,
                set,
                ..own
            },
            Err(_) => own,
        }
    }
}
