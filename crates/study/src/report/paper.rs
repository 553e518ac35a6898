//! What Wang, Chen & Xiao (2019) conclude, beside what the cases of a sweep show.

use super::CaseFiles;
use super::charts::angle;
use super::page::Table;
use super::tables::number;
use crate::sweep::CaseOutcome;

/// What stands above the table.
pub(super) const ABOUT: &str = "The conclusions of Wang, Chen & Xiao (2019), section 5, and what the \
     cases here show. The paper's mesh, its sections below the sizes of the caverns, its softening and \
     its dynamic friction are not published; its record is another processing of the same event. A \
     conclusion counts as shown only if the cases that it needs are finished.";

/// Greatest of one kind of peaks over the monitoring points.
type Measure = fn(&CaseOutcome) -> f64;

fn stress(outcome: &CaseOutcome) -> f64 {
    outcome
        .stresses
        .iter()
        .fold(0.0, |most, peak| most.max(peak.value))
}

fn relative(outcome: &CaseOutcome) -> f64 {
    outcome
        .relative
        .iter()
        .fold(0.0, |most, peak| most.max(peak.value))
}

fn damaged(outcome: &CaseOutcome) -> f64 {
    let of = outcome.damage.iter().find(|damage| damage.name == "damage");
    of.map_or(0.0, |damage| damage.damaged as f64)
}

/// The table of conclusions.
pub(super) fn conclusions(cases: &[CaseFiles]) -> Table {
    let mut rows = Vec::new();
    let measures: [(&str, &str, f64, Measure); 3] = [
        ("1", "stress (MPa)", 1e-6, stress),
        ("2", "relative displacement (mm)", 1e3, relative),
        ("3", "damaged elements", 1.0, damaged),
    ];
    for (place, what, scale, measure) in measures {
        let sv = series(cases, "sv", 30.0, measure);
        rows.push(vec![
            place.into(),
            format!("SV: {what} grows with the angle up to 30 degrees"),
            told(&sv, scale),
            verdict(&sv, 4, |values| {
                values.windows(2).all(|pair| pair[1] >= pair[0])
            }),
        ]);
        let p = series(cases, "p", 90.0, measure);
        rows.push(vec![
            place.into(),
            format!("P: {what} is greatest at 30 degrees"),
            told(&p, scale),
            verdict(&p, 4, |values| {
                let most = values.iter().copied().fold(f64::MIN, f64::max);
                values[1] >= most
            }),
        ]);
    }
    for kind in ["sv-30", "p-30"] {
        let of = |name: &str| cases.iter().find(|case| case.outcome.name == name);
        let pair = of(kind).zip(of(&format!("{kind}-continuous")));
        let told = pair.map(|(with, without)| [&with.outcome, &without.outcome].map(damaged));
        rows.push(vec![
            "4".into(),
            format!("{kind}: more damage with interaction of rock and structure than without"),
            told.map_or("cases missing".into(), |[with, without]| {
                format!("{with} with, {without} without")
            }),
            told.map_or(String::new(), |[with, without]| shown(with >= without)),
        ]);
    }
    let joint = cases.iter().filter(|case| !case.outcome.joints.is_empty());
    let most = joint.flat_map(|case| case.outcome.joints.iter().map(|joint| joint.broken));
    let most = most.fold(f64::NAN, f64::max);
    rows.push(vec![
        "5".into(),
        "the joint slips and opens where the lining is damaged, mostly at arches and upper walls"
            .into(),
        if most.is_nan() {
            "cases missing".into()
        } else {
            format!(
                "bond broken on at most {} % of the joint",
                number(100.0 * most)
            )
        },
        "see the pictures of joint and damage".into(),
    ]);
    Table {
        head: ["conclusion", "the paper", "here", "shown"]
            .map(str::to_owned)
            .to_vec(),
        rows,
    }
}

/// Angle and measure of the cases of a kind of wave up to an angle, by angle.
fn series(cases: &[CaseFiles], kind: &str, most: f64, of: Measure) -> Vec<(f64, f64)> {
    let mut found: Vec<(f64, f64)> = (cases.iter())
        .filter_map(|case| {
            let (other, angle) = angle(&case.outcome.name)?;
            (other == kind && angle <= most).then(|| (angle, of(&case.outcome)))
        })
        .collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found
}

fn told(series: &[(f64, f64)], scale: f64) -> String {
    let told = series
        .iter()
        .map(|(angle, value)| format!("{angle}: {}", number(scale * value)));
    let told: Vec<String> = told.collect();
    match told.is_empty() {
        true => "cases missing".into(),
        false => told.join(", "),
    }
}

fn verdict(series: &[(f64, f64)], needed: usize, holds: impl Fn(&[f64]) -> bool) -> String {
    if series.len() < needed {
        return "cases missing".into();
    }
    let values: Vec<f64> = series.iter().map(|(_, value)| *value).collect();
    shown(holds(&values))
}

fn shown(holds: bool) -> String {
    match holds {
        true => "confirmed".into(),
        false => "not confirmed".into(),
    }
}
