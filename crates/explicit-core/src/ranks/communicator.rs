//! The ranks of a model, with the sums and decisions that they take together.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use powerhouse_model::{
    EngineError, ModelError, RankError, Ranks, SingleRank, StateError, decode, encode,
};
use serde::{Serialize, de::DeserializeOwned};

use crate::exact::ExactSum;

/// Communication of a model with those of the other ranks; clones share it, one model after the other.
///
/// The first failure is kept: from then on operations return their input at once, so that a computation that cannot
/// return an error ends, and [`check`](Self::check) reports it.
#[derive(Clone)]
pub(crate) struct Communicator {
    rank: usize,
    count: usize,
    state: Arc<Mutex<State>>,
}

struct State {
    ranks: Box<dyn Ranks>,
    failure: Option<RankError>,
}

impl Default for Communicator {
    fn default() -> Self {
        Self::new(Box::new(SingleRank))
    }
}

impl Communicator {
    pub(crate) fn new(ranks: Box<dyn Ranks>) -> Self {
        Self {
            rank: ranks.rank(),
            count: ranks.count(),
            state: Arc::new(Mutex::new(State {
                ranks,
                failure: None,
            })),
        }
    }
    /// Number of this rank.
    pub(crate) fn rank(&self) -> usize {
        self.rank
    }
    /// Number of ranks.
    pub(crate) fn count(&self) -> usize {
        self.count
    }
    /// Whether there is no other rank.
    pub(crate) fn is_single(&self) -> bool {
        self.count == 1
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The first failure so far.
    pub(crate) fn check(&self) -> Result<(), RankError> {
        match &self.lock().failure {
            Some(failure) => Err(failure.clone()),
            None => Ok(()),
        }
    }

    /// The result of an operation; none after a failure.
    pub(crate) fn attempt<T>(
        &self,
        operation: impl FnOnce(&mut dyn Ranks) -> Result<T, RankError>,
    ) -> Option<T> {
        let mut state = self.lock();
        if state.failure.is_some() {
            return None;
        }
        match operation(state.ranks.as_mut()) {
            Ok(result) => Some(result),
            Err(failure) => {
                state.failure = Some(failure);
                None
            }
        }
    }

    /// The exact sums over all ranks, each rounded once.
    pub(crate) fn totals<const N: usize>(&self, sums: [ExactSum; N]) -> [f64; N] {
        if self.is_single() {
            return sums.map(|sum| sum.round());
        }
        let mut digits: Vec<i64> = sums.iter().flat_map(ExactSum::digits).collect();
        self.attempt(|ranks| ranks.sum(&mut digits));
        let (all, _) = digits.as_chunks::<{ ExactSum::LENGTH }>();
        core::array::from_fn(|i| ExactSum::from_digits(&all[i]).round())
    }

    /// The exact sum of terms over all ranks, rounded once.
    pub(crate) fn total(&self, terms: impl Iterator<Item = f64>) -> f64 {
        let [total] = self.totals([terms.collect()]);
        total
    }

    /// The least number of any rank.
    pub(crate) fn least(&self, number: u64) -> u64 {
        if self.is_single() {
            return number;
        }
        let mut least = [number];
        self.attempt(|ranks| ranks.least(&mut least));
        least[0]
    }

    /// Replaces each number by the least one of any rank.
    pub(crate) fn least_of_each(&self, numbers: &mut [u64]) {
        if !self.is_single() {
            self.attempt(|ranks| ranks.least(numbers));
        }
    }

    /// The least positive or zero number of any rank, infinity included.
    pub(crate) fn least_of(&self, number: f64) -> f64 {
        // The bits of such numbers have their order.
        f64::from_bits(self.least(number.to_bits()))
    }

    /// The greatest positive or zero number of any rank.
    pub(crate) fn most_of(&self, number: f64) -> f64 {
        f64::from_bits(!self.least(!number.to_bits()))
    }

    /// The bytes of the rank `from`, on all ranks.
    pub(crate) fn of_rank(&self, from: usize, mut bytes: Vec<u8>) -> Vec<u8> {
        if !self.is_single() {
            self.attempt(|ranks| ranks.broadcast(from, &mut bytes));
        }
        bytes
    }

    /// The bytes of all ranks in their order, on rank 0; none on others and after a failure.
    pub(crate) fn at_first(&self, bytes: &[u8]) -> Vec<Vec<u8>> {
        self.attempt(|ranks| ranks.gather(bytes))
            .unwrap_or_default()
    }

    /// The bytes of all ranks in their order, on all of them; none after a failure.
    pub(crate) fn of_all(&self, bytes: &[u8]) -> Vec<Vec<u8>> {
        let gathered = self.at_first(bytes);
        let mut lengths: Vec<i64> = vec![0; self.count];
        for (length, bytes) in lengths.iter_mut().zip(&gathered) {
            *length = bytes.len() as i64;
        }
        self.attempt(|ranks| ranks.sum(&mut lengths));
        let all = self.of_rank(0, gathered.concat());
        if self.check().is_err() {
            return Vec::new();
        }
        let mut rest = &all[..];
        let part = |&length: &i64| rest.split_off(..length as usize).map(<[u8]>::to_vec);
        lengths.iter().filter_map(part).collect()
    }

    /// Checks that a value, such as a checksum, is the same on all ranks.
    pub(crate) fn check_same(&self, what: &'static str, value: u64) -> Result<(), ModelError> {
        let (least, most) = (self.least(value), !self.least(!value));
        self.check().map_err(|failure| rank_failure(&failure))?;
        if least == most {
            Ok(())
        } else {
            Err(EngineError::RanksDiffer { what }.into())
        }
    }

    /// A value of each rank in their order, on all ranks.
    ///
    /// # Errors
    /// A failure of the communication, or a value that cannot be encoded.
    pub(crate) fn all<T: Serialize + DeserializeOwned>(
        &self,
        own: &T,
    ) -> Result<Vec<T>, ModelError> {
        let unsent = |error: StateError| ModelError::refused("ranks", error);
        let sent = self.of_all(&encode(own).map_err(unsent)?);
        self.check().map_err(|failure| rank_failure(&failure))?;
        let values = sent.iter().map(|bytes| decode(bytes).map_err(unsent));
        values.collect()
    }

    /// A value of each rank in their order on rank 0; none on others and after a failure.
    pub(crate) fn all_at_first<T: Serialize + DeserializeOwned>(&self, own: &T) -> Vec<T> {
        let sent = self.at_first(&encode(own).unwrap_or_default());
        let values = sent.iter().filter_map(|bytes| decode(bytes).ok());
        values.collect()
    }

    /// A value that rank 0 computes, on all ranks.
    ///
    /// # Errors
    /// The error of rank 0 on all, and a failure of the communication.
    pub(crate) fn of_first<T: Serialize + DeserializeOwned>(
        &self,
        compute: impl FnOnce() -> Result<T, ModelError>,
    ) -> Result<T, ModelError> {
        if self.is_single() {
            return compute();
        }
        let unsent = |error: StateError| ModelError::refused("ranks", error);
        let own = (self.rank == 0).then(compute).transpose();
        let own = self.agree(own)?;
        let bytes = self.agree(own.as_ref().map_or(Ok(Vec::new()), encode).map_err(unsent))?;
        let bytes = self.of_rank(0, bytes);
        self.check().map_err(|failure| rank_failure(&failure))?;
        own.map_or_else(|| decode(&bytes).map_err(unsent), Ok)
    }

    /// The result of work on every rank: an error of one of them is an error on all.
    pub(crate) fn agree<T>(&self, result: Result<T, ModelError>) -> Result<T, ModelError> {
        if self.is_single() {
            return result;
        }
        let own = if result.is_err() {
            self.rank
        } else {
            self.count
        };
        let failed = self.least(own as u64) as usize;
        self.check().map_err(|failure| rank_failure(&failure))?;
        if failed >= self.count {
            return result;
        }
        let message = result.as_ref().err().map(ModelError::to_string);
        let message = self.of_rank(failed, message.unwrap_or_default().into_bytes());
        match result {
            Err(error) => Err(error),
            Ok(_) => Err(ModelError::refused(
                format!("rank {failed}"),
                String::from_utf8_lossy(&message),
            )),
        }
    }
}

/// The error of the assembly of a model after a failure of the communication.
pub(crate) fn rank_failure(failure: &RankError) -> ModelError {
    ModelError::refused("ranks", failure.clone())
}

#[cfg(test)]
mod tests {
    use powerhouse_model::ThreadRanks;

    use super::*;

    /// Sums, extremes and texts of all ranks are the same on all of them, and on one rank.
    #[test]
    fn ranks_agree_on_sums_and_extremes() {
        let terms: Vec<f64> = (0..60)
            .map(|i| f64::from(i * i - 300).powi(5) * 1e-7)
            .collect();
        let alone = Communicator::default();
        let expected = alone.total(terms.iter().copied());
        for count in [1, 2, 3, 7] {
            let found = ThreadRanks::run(count, |ranks| {
                let team = Communicator::new(Box::new(ranks));
                let own = terms.iter().skip(team.rank()).step_by(count);
                let total = team.total(own.copied());
                let rank = team.rank() as f64;
                let extremes = [team.least_of(rank + 0.5), team.most_of(rank + 0.5)];
                let texts = team.of_all(&vec![b'x'; team.rank()]);
                team.check()?;
                Ok((total.to_bits(), extremes, texts))
            });
            let texts: Vec<Vec<u8>> = (0..count).map(|rank| vec![b'x'; rank]).collect();
            let extremes = [0.5, count as f64 - 0.5];
            for found in found {
                assert_eq!(found, Ok((expected.to_bits(), extremes, texts.clone())));
            }
        }
    }

    /// An error of one rank is an error on all, with its message; after a failure of communication operations return at
    /// once and the failure is reported.
    #[test]
    fn an_error_of_one_rank_is_an_error_on_all() {
        let found = ThreadRanks::run(3, |ranks| {
            let team = Communicator::new(Box::new(ranks));
            let own = match team.rank() {
                1 => Err(ModelError::refused("rock", "no mass")),
                _ => Ok(()),
            };
            let error = team.agree(own).err().map(|error| error.to_string());
            let rank = team.rank();
            if rank == 1 {
                return Ok((error, 0.0, None));
            }
            let total = team.total([1.0, 2.0].into_iter());
            Ok((error, total, team.check().err()))
        });
        let lost = Some(RankError::Lost { rank: 1 });
        let other = Some("rank 1: rock: no mass".to_string());
        assert_eq!(found[0], Ok((other.clone(), 3.0, lost.clone())));
        assert_eq!(found[1], Ok((Some("rock: no mass".into()), 0.0, None)));
        assert_eq!(found[2], Ok((other, 3.0, lost)));
    }
}
