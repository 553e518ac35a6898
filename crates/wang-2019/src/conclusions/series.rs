//! A measure as a function of the angle of incidence.

use super::Verdict;
use powerhouse_study::sweep::CaseOutcome;
use powerhouse_study::text::rounded;

/// The angles of SV waves that the paper computes (degrees).
pub(super) const SV: [f64; 4] = [0.0, 15.0, 25.0, 30.0];
/// The angles of P waves that the paper computes (degrees).
pub(super) const P: [f64; 4] = [0.0, 30.0, 60.0, 90.0];
/// The angle at which the paper finds the greatest response (degrees).
pub(super) const WORST: f64 = 30.0;

/// The unvaried case of a single wave, with or without joints, under the same motion as the first unvaried case of
/// the sweep, which may contain other records.
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

/// The name of a case in a list of missing cases.
pub(super) fn case_label((kind, angle): (&str, f64), continuous: bool) -> String {
    let joints = if continuous { " without joints" } else { "" };
    format!("{} {angle}{joints}", kind.to_uppercase())
}

/// A measure of a case; `None` if the case lacks it.
pub(super) type Measure<'m> = &'m dyn Fn(&CaseOutcome) -> Option<f64>;

/// Values of a measure at several angles, in rising order.
#[derive(Debug)]
pub(super) struct Series {
    pub(super) angles: Vec<f64>,
    pub(super) values: Vec<f64>,
}

impl Series {
    /// Collects a measure from the cases of a kind of wave, or returns the labels of the missing cases.
    pub(super) fn of(
        outcomes: &[CaseOutcome],
        kind: &str,
        angles: &[f64],
        measure: Measure,
    ) -> Result<Self, Vec<String>> {
        let value = |&angle: &f64| {
            let found = case(outcomes, (kind, angle), false).and_then(measure);
            found.ok_or_else(|| case_label((kind, angle), false))
        };
        let found: Vec<Result<f64, String>> = angles.iter().map(value).collect();
        let missing: Vec<String> = (found.iter())
            .filter_map(|value| value.as_ref().err().cloned())
            .collect();
        if missing.is_empty() {
            Ok(Self {
                angles: angles.to_vec(),
                values: found.into_iter().flatten().collect(),
            })
        } else {
            Err(missing)
        }
    }

    /// Whether the values rise strictly with the angle.
    pub(super) fn rises(&self) -> bool {
        self.values.windows(2).all(|pair| pair[1] > pair[0])
    }

    /// Whether the value at an angle is greater than all others.
    pub(super) fn is_greatest_at(&self, angle: f64) -> bool {
        let Some(index) = self.angles.iter().position(|&other| other == angle) else {
            return false;
        };
        let all = self.values.iter().enumerate();
        let mut others = all.filter(|(other, _)| *other != index);
        others.all(|(_, &value)| value < self.values[index])
    }

    /// Whether values rise up to an angle and fall beyond it.
    pub(super) fn rises_and_falls_around(&self, angle: f64) -> bool {
        let pairs = self.values.windows(2).zip(self.angles.windows(2));
        let mut signs = pairs.map(|(value, at)| (value[1] > value[0], value[1] < value[0], at[1]));
        signs.all(|(up, down, end)| if end <= angle { up } else { down })
    }

    /// The values with their angles as text, multiplied by a scale.
    pub(super) fn text(&self, scale: f64) -> String {
        let pairs = self.angles.iter().zip(&self.values);
        let texts = pairs.map(|(angle, value)| format!("{angle}: {}", rounded(scale * value)));
        texts.collect::<Vec<_>>().join(", ")
    }
}

/// The verdict on a claim that holds or not.
pub(super) fn verdict(holds: bool) -> Verdict {
    if holds {
        Verdict::Confirmed
    } else {
        Verdict::NotConfirmed
    }
}
