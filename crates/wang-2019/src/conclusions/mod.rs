//! Test of the conclusions of Wang, Chen & Xiao (2019) by the cases of a sweep.
//!
//! Each of the five conclusions of their section 5 is divided into claims that computed values confirm or do not
//! confirm. A claim with missing cases remains open and names them; a claim whose cases end before 95 % of the Arias
//! intensity of their records is not judged.
//!
//! ```
//! use powerhouse_wang_2019::{Verdict, conclusions};
//! let without_cases = conclusions(&[]);
//! assert!(without_cases.iter().all(|claim| matches!(claim.verdict, Verdict::Missing(_))));
//! ```

mod claims;
mod contact;
mod series;

use std::fmt;

use powerhouse_study::sweep::CaseOutcome;

/// Claim of the paper with its verdict and the computed values behind it.
#[derive(Clone, Debug, PartialEq)]
pub struct Conclusion {
    /// Number of the conclusion in the paper, 1 to 5; 0 for a claim of its abstract that contradicts them.
    pub number: u8,
    /// Identifier of the claim for programs, such as `sv_stress_rises`.
    pub key: &'static str,
    /// Claim of the paper as a sentence.
    pub claim: &'static str,
    /// Computed values that decide the claim, as text; empty if cases are missing.
    pub figures: String,
    /// Result of the test.
    pub verdict: Verdict,
}

/// Result of the test of a claim.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// The computed values confirm the claim.
    Confirmed,
    /// The computed values do not confirm the claim.
    NotConfirmed,
    /// Not judged, since a case ends before the end of the strong motion of its record; with the explanation.
    NotJudged(String),
    /// Open, since the named cases are missing.
    Missing(Vec<String>),
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Confirmed => f.write_str("confirmed"),
            Self::NotConfirmed => f.write_str("not confirmed"),
            Self::NotJudged(reason) => write!(f, "not judged ({reason})"),
            Self::Missing(cases) => write!(f, "open, missing {}", cases.join(", ")),
        }
    }
}

impl fmt::Display for Conclusion {
    /// Writes the conclusion as `conclusion.1.sv_stress_rises = confirmed (0: 1.2, ...)`.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self.number {
            0 => f.write_str("abstract")?,
            number => write!(f, "conclusion.{number}")?,
        }
        write!(f, ".{} = {}", self.key, self.verdict)?;
        if self.figures.is_empty() {
            Ok(())
        } else {
            write!(f, " ({})", self.figures)
        }
    }
}

/// Tests the conclusions of Wang, Chen & Xiao (2019) by the outcomes of the cases of a sweep, of which some may be
/// missing.
pub fn conclusions(outcomes: &[CaseOutcome]) -> Vec<Conclusion> {
    let mut found = claims::of_angles(outcomes);
    found.extend(claims::of_weak_parts(outcomes));
    found.extend(contact::of_interaction(outcomes));
    found.extend(contact::of_joints(outcomes));
    // A case that ends before the strong motion does not decide a claim.
    let coverages = outcomes
        .iter()
        .filter_map(|outcome| outcome.coverage.as_ref());
    let short = coverages.filter(|coverage| !coverage.is_enough());
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
