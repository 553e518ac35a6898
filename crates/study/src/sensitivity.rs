//! What single choices do to the headline figures of a sweep.

use std::fmt;

use crate::rounded::rounded;
use crate::sweep::{CaseOutcome, Peak};

/// A figure of a case and of the one that it is compared with.
#[derive(Clone, Debug, PartialEq)]
pub struct VariedFigure {
    /// What it is, with its unit.
    pub name: String,
    /// In the case that varies nothing.
    pub base: f64,
    /// In the case that varies a choice.
    pub here: f64,
}

impl VariedFigure {
    /// The change over the value of the base; none if that is zero.
    pub fn change(&self) -> Option<f64> {
        (self.base != 0.0).then(|| (self.here - self.base) / self.base.abs())
    }

    /// The figure here and its change in percent.
    pub(crate) fn told(&self) -> String {
        let here = rounded(self.here);
        match self.change() {
            Some(change) => format!("{here} ({:+.1} %)", 100.0 * change),
            None => here,
        }
    }
}

impl fmt::Display for VariedFigure {
    /// `relative displacement B-O1 (mm) 12.3 (+4.5 %)`.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{} {}", self.name, self.told())
    }
}

/// A case that differs from another one by one choice.
#[derive(Clone, Debug, PartialEq)]
pub struct Variation {
    /// Its name.
    pub case: String,
    /// The choice.
    pub varies: String,
    /// The case that it is compared with: the first of the same waves that varies nothing, of the same record
    /// if there is one.
    pub base: String,
    /// The headline figures that both have: relative displacement, principal stress, mean damage of the
    /// lining, share of the joint that failed.
    pub figures: Vec<VariedFigure>,
}

/// The peak that is the headline's by its name, or else the first.
fn headline(peaks: &[Peak], is_headline: impl Fn(&str) -> bool) -> Option<&Peak> {
    let found = peaks.iter().find(|peak| is_headline(&peak.name));
    found.or(peaks.first())
}

/// The headline figures of a case by their names: relative displacement of the upstream wall, stress at
/// the crown, where there are such points.
pub(crate) fn headlines(outcome: &CaseOutcome) -> Vec<(String, f64)> {
    let relative = headline(&outcome.relative, |name| name == "B-O1");
    let stress = headline(&outcome.stresses, |name| {
        name == "A" || name.starts_with("A-")
    });
    let lining = outcome.parts.iter().find(|part| part.name == "lining");
    let failed = outcome.joint_and_lining.as_ref();
    let figures = [
        relative.map(|peak| {
            let name = format!("relative displacement {} (mm)", peak.name);
            (name, 1e3 * peak.value)
        }),
        stress.map(|peak| {
            let name = format!("principal stress {} (MPa)", peak.name);
            (name, 1e-6 * peak.value)
        }),
        lining.map(|part| ("mean damage of the lining".into(), part.mean)),
        failed.map(|found| ("failed share of the joint (%)".into(), 100.0 * found.failed)),
    ];
    figures.into_iter().flatten().collect()
}

/// The cases of a sweep that say what they vary, each beside the one that it is compared with. Cases of
/// other waves than any that varies nothing are left out.
pub fn sensitivity(outcomes: &[CaseOutcome]) -> Vec<Variation> {
    let found = outcomes.iter().filter_map(|case| {
        let varies = case.input.varies.clone()?;
        let waves = &case.input.waves;
        let plain = || {
            outcomes.iter().filter(|base| {
                let others = &base.input.waves;
                let alike = || waves.iter().zip(others).all(|(a, b)| a.arrives_as(b));
                let plain = base.input.varies.is_none() && !base.input.continuous;
                plain && others.len() == waves.len() && alike()
            })
        };
        let same_motion = plain().find(|base| {
            let pairs = || waves.iter().zip(&base.input.waves);
            pairs().all(|(own, other)| own.motion == other.motion)
        });
        let base = same_motion.or(plain().next())?;
        let own = headlines(case);
        let figures = headlines(base).into_iter().filter_map(|(name, base)| {
            let here = own.iter().find(|(other, _)| *other == name)?.1;
            Some(VariedFigure { name, base, here })
        });
        Some(Variation {
            case: case.name.clone(),
            varies,
            base: base.name.clone(),
            figures: figures.collect(),
        })
    });
    found.collect()
}
