//! What Wang, Chen & Xiao (2019) conclude, put to the test by the cases of a sweep.
//!
//! Each of the five conclusions of their section 5 becomes one claim or several that figures can bear out
//! or not. A claim whose cases are not finished is open, and says which are missing; one whose cases end before
//! 95 % of the Arias intensity of their records is not judged.
//!
//! ```
//! use powerhouse_study::{Verdict, conclusions};
//! let without_cases = conclusions(&[]);
//! assert!(without_cases.iter().all(|claim| matches!(claim.verdict, Verdict::Missing(_))));
//! ```

mod claims;
mod contact;
mod series;

use std::fmt;

use crate::sweep::CaseOutcome;

/// A claim of the paper, and what the cases of a sweep say to it.
#[derive(Clone, Debug, PartialEq)]
pub struct Conclusion {
    /// The number of the paper's conclusion; 0 for a claim of its abstract that contradicts them.
    pub number: u8,
    /// A name for machines, such as `sv_stress_rises`.
    pub key: &'static str,
    /// What the paper says.
    pub claim: &'static str,
    /// The figures by which it was tested.
    pub figures: String,
    /// What they say.
    pub verdict: Verdict,
}

/// What figures say to a claim.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// They bear it out.
    Confirmed,
    /// They do not.
    NotConfirmed,
    /// Some of the cases end before the strong motion of their records: how.
    NotJudged(String),
    /// Some of the cases that it takes are not there: which.
    Missing(Vec<String>),
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Confirmed => f.write_str("confirmed"),
            Self::NotConfirmed => f.write_str("not confirmed"),
            Self::NotJudged(why) => write!(f, "not judged ({why})"),
            Self::Missing(cases) => write!(f, "open, without {}", cases.join(", ")),
        }
    }
}

impl fmt::Display for Conclusion {
    /// `conclusion.1.sv_stress_rises = confirmed (0: 1.2, ...)`.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self.number {
            0 => f.write_str("abstract")?,
            number => write!(f, "conclusion.{number}")?,
        }
        write!(f, ".{} = {}", self.key, self.verdict)?;
        match self.figures.is_empty() {
            true => Ok(()),
            false => write!(f, " ({})", self.figures),
        }
    }
}

/// Tests the conclusions of Wang, Chen & Xiao (2019) by the outcomes of the cases of a sweep, which may be
/// some of them only.
pub fn conclusions(outcomes: &[CaseOutcome]) -> Vec<Conclusion> {
    let mut found = claims::of_angles(outcomes);
    found.extend(claims::of_weak_parts(outcomes));
    found.extend(contact::of_interaction(outcomes));
    found.extend(contact::of_joints(outcomes));
    // What ends before the strong motion tells nothing of it.
    let seen = outcomes
        .iter()
        .filter_map(|outcome| outcome.coverage.as_ref());
    let short = seen.filter(|seen| !seen.is_enough());
    if let Some(short) = short.min_by(|a, b| a.intensity.total_cmp(&b.intensity)) {
        for claim in &mut found {
            if !matches!(claim.verdict, Verdict::Missing(_)) {
                claim.verdict = Verdict::NotJudged(short.shortened());
            }
        }
    }
    found.sort_by_key(|claim| match claim.number {
        // The abstract says the contrary of the fourth conclusion.
        0 => (4, 1),
        number => (number, 0),
    });
    found
}
