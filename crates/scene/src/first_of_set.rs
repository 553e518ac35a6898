//! The motion of a scene with a set of records that is no case of it.

use core::fmt;

use crate::Topic;
use crate::remark::{Kind, described};

/// Motion of a scene with a set of records where it is no case of the set: that of the first of these cases.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FirstOfSet {
    /// Name of the set.
    pub set: String,
    /// First case of the set.
    pub first: String,
    /// Number of the cases of the set.
    pub cases: usize,
}

described!(FirstOfSet, |_| Kind::Fact(Topic::Input));

impl fmt::Display for FirstOfSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { set, first, cases } = self;
        write!(
            f,
            "of the set of records '{set}' this is the motion of case '{first}' alone; a sweep runs the {cases} cases of the set, `--case` one of them"
        )
    }
}
