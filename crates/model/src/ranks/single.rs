//! A computation on one rank.

use super::{Message, RankError, Ranks};

/// The only rank of a computation: it has nobody to exchange messages with, and every operation leaves its numbers as
/// they are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SingleRank;

/// Refuses messages, because there is no other rank.
fn refuse(messages: &[Message]) -> Result<(), RankError> {
    match messages.first() {
        None => Ok(()),
        Some(&Message { rank, .. }) => Err(RankError::Unknown { rank, count: 1 }),
    }
}

impl Ranks for SingleRank {
    fn rank(&self) -> usize {
        0
    }
    fn count(&self) -> usize {
        1
    }
    fn start(&mut self, out: &mut [Message]) -> Result<(), RankError> {
        refuse(out)
    }
    fn finish(&mut self, into: &mut [Message]) -> Result<(), RankError> {
        refuse(into)
    }
    fn sum(&mut self, _numbers: &mut [i64]) -> Result<(), RankError> {
        Ok(())
    }
    fn least(&mut self, _numbers: &mut [u64]) -> Result<(), RankError> {
        Ok(())
    }
    fn gather(&mut self, bytes: &[u8]) -> Result<Vec<Vec<u8>>, RankError> {
        Ok(vec![bytes.to_vec()])
    }
    fn broadcast(&mut self, from: usize, _bytes: &mut Vec<u8>) -> Result<(), RankError> {
        match from {
            0 => Ok(()),
            rank => Err(RankError::Unknown { rank, count: 1 }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Alone, a rank keeps its numbers and refuses messages to others.
    #[test]
    fn nothing_changes_on_one_rank() {
        let mut rank = SingleRank;
        assert_eq!((rank.rank(), rank.count()), (0, 1));
        let (mut terms, mut numbers) = ([3, -4], [7]);
        rank.sum(&mut terms).unwrap();
        rank.least(&mut numbers).unwrap();
        assert_eq!((terms, numbers), ([3, -4], [7]));
        assert_eq!(rank.gather(b"ab").unwrap(), [b"ab"]);
        let mut bytes = b"ab".to_vec();
        rank.broadcast(0, &mut bytes).unwrap();
        assert_eq!(bytes, b"ab");
        let unknown = |rank| Err(RankError::Unknown { rank, count: 1 });
        assert_eq!(rank.broadcast(1, &mut bytes), unknown(1));
        assert_eq!(rank.start(&mut []), Ok(()));
        assert_eq!(rank.start(&mut [Message::new(0)]), unknown(0));
        assert_eq!(rank.finish(&mut [Message::new(2)]), unknown(2));
    }
}
