//! Cases by angle, and how a measure goes with it.

use super::Verdict;
use crate::rounded::rounded;
use crate::sweep::CaseOutcome;

/// The angles of SV waves that the paper computes (degrees).
pub(super) const SV: [f64; 4] = [0.0, 15.0, 25.0, 30.0];
/// Those of P waves.
pub(super) const P: [f64; 4] = [0.0, 30.0, 60.0, 90.0];
/// The angle at which the paper finds the most of everything (degrees).
pub(super) const WORST: f64 = 30.0;

/// A case of one wave with nothing varied, with its joints or without; moved as the first case of all that
/// varies nothing, for a sweep may hold other records.
pub(super) fn case<'o>(
    outcomes: &'o [CaseOutcome],
    (kind, angle): (&str, f64),
    continuous: bool,
) -> Option<&'o CaseOutcome> {
    let plain = || {
        let cases = outcomes.iter();
        cases.filter(|outcome| outcome.input.varies.is_none() && outcome.input.wave().is_some())
    };
    let motion = |outcome: &CaseOutcome| {
        let wave = &outcome.input.waves[0];
        (wave.motion.clone(), wave.factor)
    };
    let first = plain().next().map(motion);
    plain().find(|outcome| {
        outcome.input.continuous == continuous
            && outcome.input.wave() == Some((kind, angle))
            && Some(motion(outcome)) == first
    })
}

/// How a missing case is called.
pub(super) fn called((kind, angle): (&str, f64), continuous: bool) -> String {
    let joints = if continuous { " without joints" } else { "" };
    format!("{} {angle}{joints}", kind.to_uppercase())
}

/// A measure of a case; none if the case does not have it.
pub(super) type Measure<'m> = &'m dyn Fn(&CaseOutcome) -> Option<f64>;

/// A measure at each of some angles, in rising order.
#[derive(Debug)]
pub(super) struct Series {
    pub(super) angles: Vec<f64>,
    pub(super) values: Vec<f64>,
}

impl Series {
    /// Of the cases of a kind of wave, or which of them are missing.
    pub(super) fn of(
        outcomes: &[CaseOutcome],
        kind: &str,
        angles: &[f64],
        measure: Measure,
    ) -> Result<Self, Vec<String>> {
        let value = |&angle: &f64| {
            let found = case(outcomes, (kind, angle), false).and_then(measure);
            found.ok_or_else(|| called((kind, angle), false))
        };
        let found: Vec<Result<f64, String>> = angles.iter().map(value).collect();
        let missing: Vec<String> = (found.iter())
            .filter_map(|value| value.as_ref().err().cloned())
            .collect();
        match missing.is_empty() {
            true => Ok(Self {
                angles: angles.to_vec(),
                values: found.into_iter().flatten().collect(),
            }),
            false => Err(missing),
        }
    }

    /// Whether each value is above the one before.
    pub(super) fn rises(&self) -> bool {
        self.values.windows(2).all(|pair| pair[1] > pair[0])
    }

    /// Whether the greatest value, and no other, is that of an angle.
    pub(super) fn is_greatest_at(&self, angle: f64) -> bool {
        let Some(place) = self.angles.iter().position(|&other| other == angle) else {
            return false;
        };
        let all = self.values.iter().enumerate();
        let mut others = all.filter(|(other, _)| *other != place);
        others.all(|(_, &value)| value < self.values[place])
    }

    /// Whether values rise up to an angle and fall beyond it.
    pub(super) fn rises_and_falls_around(&self, angle: f64) -> bool {
        let pairs = self.values.windows(2).zip(self.angles.windows(2));
        let mut signs = pairs.map(|(value, at)| (value[1] > value[0], value[1] < value[0], at[1]));
        signs.all(|(up, down, end)| if end <= angle { up } else { down })
    }

    /// The values with their angles, times a scale.
    pub(super) fn told(&self, scale: f64) -> String {
        let pairs = self.angles.iter().zip(&self.values);
        let told = pairs.map(|(angle, value)| format!("{angle}: {}", rounded(scale * value)));
        told.collect::<Vec<_>>().join(", ")
    }
}

/// Confirmed or not.
pub(super) fn verdict(holds: bool) -> Verdict {
    match holds {
        true => Verdict::Confirmed,
        false => Verdict::NotConfirmed,
    }
}
