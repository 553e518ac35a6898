//! Conclusions 1 to 3: what the angle does to stress, displacement and damage.

use super::Conclusion;
use super::Verdict;
use super::series::{Measure, P, SV, Series, WORST, called, case, verdict};
use crate::bay::BayPart;
use crate::rounded::rounded;
use crate::sweep::{CaseOutcome, PartDamage, Peak};

/// The set of all concrete.
const STRUCTURE: &str = "structure";

/// What is measured at the monitoring points.
#[derive(Clone, Copy)]
enum Points {
    Stress,
    Relative,
}

impl Points {
    fn peaks(self, outcome: &CaseOutcome) -> &[Peak] {
        match self {
            Self::Stress => &outcome.stresses,
            Self::Relative => &outcome.relative,
        }
    }
    /// Factor and unit in which it is told.
    fn scale(self) -> (f64, &'static str) {
        match self {
            Self::Stress => (1e-6, "MPa"),
            Self::Relative => (1e3, "mm"),
        }
    }
    fn mean(self, outcome: &CaseOutcome) -> Option<f64> {
        mean(self.peaks(outcome))
    }
    /// What the same comes to in the ground alone.
    fn ground(self, outcome: &CaseOutcome) -> Option<f64> {
        match self {
            Self::Stress => None,
            Self::Relative => mean(&outcome.ground),
        }
    }
}

fn mean(peaks: &[Peak]) -> Option<f64> {
    let sum: f64 = peaks.iter().map(|peak| peak.value).sum();
    (!peaks.is_empty()).then(|| sum / peaks.len() as f64)
}

/// How a measure is to go with the angle.
type Trend = fn(&Series) -> bool;

fn greatest_at_worst(series: &Series) -> bool {
    series.is_greatest_at(WORST)
}

fn around_worst(series: &Series) -> bool {
    series.rises_and_falls_around(WORST)
}

/// Stress and displacement of the points, and damage of the structure, against the angle.
pub(super) fn of_angles(outcomes: &[CaseOutcome]) -> Vec<Conclusion> {
    let (stress, relative) = (Points::Stress, Points::Relative);
    let at_points = |head, wave, points, trend| of_points(outcomes, head, wave, points, trend);
    let damage = |head, wave, trend| of_damage(outcomes, head, wave, trend);
    vec![
        at_points(
            (
                1,
                "sv_stress_rises",
                "SV: peaks of principal stress rise with the angle of incidence",
            ),
            ("sv", &SV),
            stress,
            Series::rises,
        ),
        at_points(
            (
                1,
                "p_stress_is_greatest_at_30",
                "P: peaks of principal stress rise up to 30 degrees and fall beyond",
            ),
            ("p", &P),
            stress,
            around_worst,
        ),
        at_points(
            (
                2,
                "sv_displacement_is_greatest_at_30",
                "SV: relative displacements are greatest at 30 degrees",
            ),
            ("sv", &SV),
            relative,
            greatest_at_worst,
        ),
        at_points(
            (
                2,
                "p_displacement_is_greatest_at_30",
                "P: relative displacements are greatest at 30 degrees",
            ),
            ("p", &P),
            relative,
            greatest_at_worst,
        ),
        at_points(
            (
                2,
                "p_oblique_displaces_more",
                "P: relative displacements at 30 degrees are greater than at vertical and horizontal \
                 incidence",
            ),
            ("p", &[P[0], WORST, P[3]]),
            relative,
            greatest_at_worst,
        ),
        damage(
            (
                3,
                "sv_damage_is_worst_at_30",
                "SV: damage is most serious at 30 degrees",
            ),
            ("sv", &SV),
            greatest_at_worst,
        ),
        damage(
            (
                3,
                "p_damage_is_worst_at_30",
                "P: damage is most serious at 30 degrees",
            ),
            ("p", &P),
            greatest_at_worst,
        ),
    ]
}

/// What a claim is: number, key, words.
type Head = (u8, &'static str, &'static str);

fn told((number, key, claim): Head, figures: String, verdict: Verdict) -> Conclusion {
    Conclusion {
        number,
        key,
        claim,
        figures,
        verdict,
    }
}

/// The mean over the points and at least half of them decide; how many go the same way is told.
fn of_points(
    outcomes: &[CaseOutcome],
    head: Head,
    (kind, angles): (&str, &[f64]),
    points: Points,
    trend: Trend,
) -> Conclusion {
    let series = |measure: Measure| Series::of(outcomes, kind, angles, measure);
    let mean = match series(&|outcome| points.mean(outcome)) {
        Ok(mean) => mean,
        Err(missing) => return told(head, String::new(), Verdict::Missing(missing)),
    };
    let first = case(outcomes, (kind, angles[0]), false);
    let names: Vec<&str> = first.map_or_else(Vec::new, |outcome| {
        let peaks = points.peaks(outcome).iter();
        peaks.map(|peak| peak.name.as_str()).collect()
    });
    let follows = |name: &&&str| {
        let own = series(&|outcome| {
            let mut peaks = points.peaks(outcome).iter();
            Some(peaks.find(|peak| peak.name == **name)?.value)
        });
        own.is_ok_and(|own| trend(&own))
    };
    let following = names.iter().filter(follows).count();
    let (scale, unit) = points.scale();
    let mut figures = format!(
        "{} {unit}, mean of {} points; so at {following} of them",
        mean.told(scale),
        names.len()
    );
    if let Ok(ground) = series(&|outcome| points.ground(outcome)) {
        figures = format!("{figures}; the ground alone {}", ground.told(scale));
    }
    let holds = trend(&mean) && 2 * following >= names.len();
    told(head, figures, verdict(holds))
}

/// A part of the structure of a case.
pub(super) fn part<'o>(outcome: &'o CaseOutcome, name: &str) -> Option<&'o PartDamage> {
    outcome.parts.iter().find(|part| part.name == name)
}

/// The mean damage of the structure decides; the damaged share of its volume is told.
fn of_damage(
    outcomes: &[CaseOutcome],
    head: Head,
    (kind, angles): (&str, &[f64]),
    trend: Trend,
) -> Conclusion {
    let of = |measure: fn(&PartDamage) -> f64| {
        let measure = |outcome: &CaseOutcome| part(outcome, STRUCTURE).map(measure);
        Series::of(outcomes, kind, angles, &measure)
    };
    match (of(|part| part.mean), of(|part| part.damaged)) {
        (Ok(mean), Ok(damaged)) => {
            let figures = format!(
                "mean damage {}; damaged by more than a tenth {} %",
                mean.told(1.0),
                damaged.told(100.0)
            );
            told(head, figures, verdict(trend(&mean)))
        }
        (Err(missing), _) | (_, Err(missing)) => {
            told(head, String::new(), Verdict::Missing(missing))
        }
    }
}

/// The mean damage of arches and floors, and of all other concrete.
fn weak_and_other(outcome: &CaseOutcome) -> Option<[f64; 2]> {
    let mut sums = [[0.0; 2]; 2];
    for known in BayPart::ALL.into_iter().filter(|part| part.is_concrete()) {
        let Some(part) = part(outcome, known.name()) else {
            continue;
        };
        let is_weak = known.name().starts_with("arch") || known.name().starts_with("floor");
        let sum = &mut sums[usize::from(!is_weak)];
        *sum = [sum[0] + part.volume * part.mean, sum[1] + part.volume];
    }
    let means = sums.map(|[damage, volume]| damage / volume);
    means.iter().all(|mean| mean.is_finite()).then_some(means)
}

/// Arches and floors suffer most, and more under oblique waves than under vertical or horizontal ones.
pub(super) fn of_weak_parts(outcomes: &[CaseOutcome]) -> Vec<Conclusion> {
    let kinds = [
        (
            ("sv", &[SV[0], WORST][..]),
            (
                3,
                "sv_arches_and_floors_suffer_most",
                "SV at 30 degrees: arches and floors suffer most",
            ),
            (
                3,
                "sv_oblique_damages_arches_and_floors_more",
                "SV: arches and floors suffer more at 30 degrees than at vertical incidence",
            ),
        ),
        (
            ("p", &[P[0], WORST, P[3]][..]),
            (
                3,
                "p_arches_and_floors_suffer_most",
                "P at 30 degrees: arches and floors suffer most",
            ),
            (
                3,
                "p_oblique_damages_arches_and_floors_more",
                "P: arches and floors suffer more at 30 degrees than at vertical and horizontal \
                 incidence",
            ),
        ),
    ];
    let mut found = Vec::new();
    for ((kind, angles), most, oblique) in kinds {
        let at_worst = case(outcomes, (kind, WORST), false).and_then(weak_and_other);
        found.push(match at_worst {
            Some([weak, other]) => {
                let figures = format!(
                    "mean damage {} of arches and floors, {} of all other concrete",
                    rounded(weak),
                    rounded(other)
                );
                told(most, figures, verdict(weak > other))
            }
            None => {
                let missing = vec![called((kind, WORST), false)];
                told(most, String::new(), Verdict::Missing(missing))
            }
        });
        let weak = |outcome: &CaseOutcome| weak_and_other(outcome).map(|[weak, _]| weak);
        found.push(match Series::of(outcomes, kind, angles, &weak) {
            Ok(series) => {
                let figures = format!("mean damage {}", series.told(1.0));
                told(oblique, figures, verdict(series.is_greatest_at(WORST)))
            }
            Err(missing) => told(oblique, String::new(), Verdict::Missing(missing)),
        });
    }
    found
}
