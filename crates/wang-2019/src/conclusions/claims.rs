//! Conclusions 1 to 3: dependence of stress, displacement and damage on the angle of incidence.

use super::Conclusion;
use super::Verdict;
use super::series::{Measure, P, SV, Series, WORST, case, case_label, verdict};
use crate::bay::BayPart;
use powerhouse_study::sweep::{CaseOutcome, PartDamage, Peak};
use powerhouse_study::text::rounded;

/// The set of all concrete.
const STRUCTURE: &str = "structure";

/// Measure at the monitoring points.
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
    /// Scale factor and unit for the text.
    fn scale(self) -> (f64, &'static str) {
        match self {
            Self::Stress => (1e-6, "MPa"),
            Self::Relative => (1e3, "mm"),
        }
    }
    fn mean(self, outcome: &CaseOutcome) -> Option<f64> {
        mean(self.peaks(outcome))
    }
    /// The mean of the same measure in the free field.
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

/// Claimed dependence of a measure on the angle.
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
    let at_points = |claim, wave, points, trend| of_points(outcomes, claim, wave, points, trend);
    let damage = |claim, wave, trend| of_damage(outcomes, claim, wave, trend);
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

/// A claim: number of the conclusion, key and sentence.
type Claim = (u8, &'static str, &'static str);

fn conclusion((number, key, claim): Claim, figures: String, verdict: Verdict) -> Conclusion {
    Conclusion {
        number,
        key,
        claim,
        figures,
        verdict,
    }
}

/// A claim on the points: it holds if the mean over the points and at least half of the points follow the trend.
fn of_points(
    outcomes: &[CaseOutcome],
    claim: Claim,
    (kind, angles): (&str, &[f64]),
    points: Points,
    trend: Trend,
) -> Conclusion {
    let series = |measure: Measure| Series::of(outcomes, kind, angles, measure);
    let mean = match series(&|outcome| points.mean(outcome)) {
        Ok(mean) => mean,
        Err(missing) => return conclusion(claim, String::new(), Verdict::Missing(missing)),
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
        "{} {unit}, mean of {} points; the same trend at {following} of them",
        mean.text(scale),
        names.len()
    );
    if let Ok(ground) = series(&|outcome| points.ground(outcome)) {
        figures = format!("{figures}; free field {}", ground.text(scale));
    }
    let holds = trend(&mean) && 2 * following >= names.len();
    conclusion(claim, figures, verdict(holds))
}

/// The damage of a part of the structure in a case.
pub(super) fn part<'o>(outcome: &'o CaseOutcome, name: &str) -> Option<&'o PartDamage> {
    outcome.parts.iter().find(|part| part.name == name)
}

/// A claim on damage, decided by the mean damage of the structure; the damaged share of its volume is reported.
fn of_damage(
    outcomes: &[CaseOutcome],
    claim: Claim,
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
                mean.text(1.0),
                damaged.text(100.0)
            );
            conclusion(claim, figures, verdict(trend(&mean)))
        }
        (Err(missing), _) | (_, Err(missing)) => {
            conclusion(claim, String::new(), Verdict::Missing(missing))
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

/// Claims that arches and floors are damaged most, and more under oblique waves than under vertical or horizontal
/// ones.
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
                conclusion(most, figures, verdict(weak > other))
            }
            None => {
                let missing = vec![case_label((kind, WORST), false)];
                conclusion(most, String::new(), Verdict::Missing(missing))
            }
        });
        let weak = |outcome: &CaseOutcome| weak_and_other(outcome).map(|[weak, _]| weak);
        found.push(match Series::of(outcomes, kind, angles, &weak) {
            Ok(series) => {
                let figures = format!("mean damage {}", series.text(1.0));
                conclusion(oblique, figures, verdict(series.is_greatest_at(WORST)))
            }
            Err(missing) => conclusion(oblique, String::new(), Verdict::Missing(missing)),
        });
    }
    found
}
