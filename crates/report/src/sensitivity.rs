//! Sensitivity of the main results of a sweep to single parameters.

use std::fmt;

use powerhouse_study::internal::rounded;
use powerhouse_study::sweep::{CaseOutcome, Peak};

/// Value of a main result in a varied case and in its base case.
#[derive(Clone, Debug, PartialEq)]
pub struct VariedFigure {
    /// Name of the result, with its unit.
    pub name: String,
    /// Value in the base case, in the unit that [`name`](Self::name) states.
    pub base: f64,
    /// Value in the varied case, in the same unit.
    pub here: f64,
}

impl VariedFigure {
    /// Relative change from the base case, the difference over the base value (1); `None` if that is zero.
    pub fn change(&self) -> Option<f64> {
        (self.base != 0.0).then(|| (self.here - self.base) / self.base.abs())
    }

    /// The value in the varied case with its change in percent, as text.
    pub(crate) fn text(&self) -> String {
        let here = rounded(self.here);
        match self.change() {
            Some(change) => format!("{here} ({:+.1} %)", 100.0 * change),
            None => here,
        }
    }
}

impl fmt::Display for VariedFigure {
    /// Writes the result as `relative displacement B-O1 (mm) 12.3 (+4.5 %)`.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{} {}", self.name, self.text())
    }
}

/// Comparison of a case that varies one parameter with its base case.
#[derive(Clone, Debug, PartialEq)]
pub struct Variation {
    /// Name of the varied case.
    pub case: String,
    /// Description of the varied parameter.
    pub varies: String,
    /// Name of the base case: the first unvaried case with the same waves, and with the same record if there is one.
    pub base: String,
    /// Main results that both cases have: relative displacement, principal stress, mean damage of the lining, failed
    /// share of the joint.
    pub figures: Vec<VariedFigure>,
}

/// The peak that a condition on its name selects, or else the first.
fn headline(peaks: &[Peak], is_headline: impl Fn(&str) -> bool) -> Option<&Peak> {
    let found = peaks.iter().find(|peak| is_headline(&peak.name));
    found.or(peaks.first())
}

/// The main results of a case by their names; of displacement and stress those of the upstream wall and of the crown,
/// if there are such points.
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

/// Compares each varied case of a sweep with its base case; varied cases without an unvaried case of the same waves
/// are left out.
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
