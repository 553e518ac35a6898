//! The tables of a report.

use serde_json::Value;

use super::CaseFiles;
use super::page::Table;
use crate::sweep::{CaseOutcome, Peak};

fn head(names: &[&str]) -> Vec<String> {
    names.iter().map(|name| (*name).to_owned()).collect()
}

/// A number with three digits that count.
pub(super) fn number(value: f64) -> String {
    match value.abs() {
        0.0 => "0".into(),
        size if !(1e-3..1e5).contains(&size) => format!("{value:.2e}"),
        size if size >= 100.0 => format!("{value:.0}"),
        size if size >= 10.0 => format!("{value:.1}"),
        size if size >= 1.0 => format!("{value:.2}"),
        _ => format!("{value:.3}"),
    }
}

/// What is needed to repeat a run.
pub(super) fn repetition(summary: &Value) -> String {
    let text = |key: &str| summary[key].as_str().unwrap_or("?").to_owned();
    let count = |key: &str| summary[key].as_u64().unwrap_or(0);
    format!(
        "Computed by {} on a mesh of {} elements and {} nodes. The scene as it was run stands at the \
         end; with it and the files that it names the results come again to the last bit.",
        text("software"),
        count("elements"),
        count("nodes"),
    )
}

/// Steps, time and balance of the cases.
pub(super) fn cases(cases: &[CaseFiles]) -> Table {
    let rows = cases.iter().map(|case| {
        let outcome = &case.outcome;
        let limit = &case.summary["stable_step"];
        let limited = match (limit["element"].as_u64(), limit["set"].as_str()) {
            (Some(element), Some(set)) => format!("{element} in {set}"),
            _ => String::new(),
        };
        vec![
            outcome.name.clone(),
            number(outcome.end),
            outcome.steps.to_string(),
            number(1e3 * outcome.step),
            limited,
            number(outcome.wall_time),
            number(outcome.energy_residual),
        ]
    });
    Table {
        head: head(&[
            "case",
            "end (s)",
            "steps",
            "step (ms)",
            "limited by",
            "wall time (s)",
            "energy residual",
        ]),
        rows: rows.collect(),
    }
}

/// The stages of the first case that has some.
pub(super) fn stages(cases: &[CaseFiles]) -> Option<Table> {
    let stages = cases.iter().find_map(|case| {
        let stages = case.summary["stages"].as_array()?;
        (!stages.is_empty()).then_some(stages)
    })?;
    let count = |stage: &Value, key: &str| stage[key].as_u64().unwrap_or(0).to_string();
    let rows = stages.iter().map(|stage| {
        let real = |key: &str| number(stage[key].as_f64().unwrap_or(0.0));
        vec![
            stage["name"].as_str().unwrap_or("").into(),
            count(stage, "excavated"),
            count(stage, "cast"),
            count(stage, "increments"),
            count(stage, "corrections"),
            real("residual"),
            number(1e3 * stage["largest_displacement"].as_f64().unwrap_or(0.0)),
        ]
    });
    Some(Table {
        head: head(&[
            "stage",
            "excavated",
            "cast",
            "increments",
            "corrections",
            "residual",
            "largest displacement (mm)",
        ]),
        rows: rows.collect(),
    })
}

/// Peaks of the cases, a column for each name.
pub(super) fn peaks(
    cases: &[CaseFiles],
    of: impl Fn(&CaseOutcome) -> &Vec<Peak>,
    scale: f64,
) -> Table {
    let mut names: Vec<String> = Vec::new();
    for peak in cases.iter().flat_map(|case| of(&case.outcome)) {
        if !names.contains(&peak.name) {
            names.push(peak.name.clone());
        }
    }
    let rows = cases.iter().map(|case| {
        let value = |name: &String| {
            let peak = of(&case.outcome).iter().find(|peak| peak.name == *name);
            peak.map_or(String::new(), |peak| number(scale * peak.value))
        };
        let cells = names.iter().map(value);
        std::iter::once(case.outcome.name.clone())
            .chain(cells)
            .collect()
    });
    Table {
        rows: rows.collect(),
        head: std::iter::once("case".to_owned()).chain(names).collect(),
    }
}

/// Damage of the cases.
pub(super) fn damage(cases: &[CaseFiles]) -> Table {
    let rows = cases.iter().flat_map(|case| {
        let of = case.outcome.damage.iter();
        of.map(|damage| {
            let share = 100.0 * damage.damaged as f64 / damage.of.max(1) as f64;
            vec![
                case.outcome.name.clone(),
                damage.name.clone(),
                number(damage.greatest),
                damage.element.to_string(),
                format!("{} of {} ({share:.1} %)", damage.damaged, damage.of),
            ]
        })
    });
    Table {
        head: head(&["case", "kind", "greatest", "element", "above 0.1"]),
        rows: rows.collect(),
    }
}

/// Joints of the cases.
pub(super) fn joints(cases: &[CaseFiles]) -> Table {
    let rows = cases.iter().flat_map(|case| {
        case.outcome.joints.iter().map(|joint| {
            vec![
                case.outcome.name.clone(),
                joint.name.clone(),
                number(joint.area),
                number(100.0 * joint.slipped),
                number(100.0 * joint.opened),
                number(100.0 * joint.broken),
                number(1e3 * joint.slip),
                number(1e3 * joint.opening),
            ]
        })
    });
    Table {
        head: head(&[
            "case",
            "joint",
            "area (m2)",
            "slipped (%)",
            "opened (%)",
            "bond broken (%)",
            "largest slip (mm)",
            "largest opening (mm)",
        ]),
        rows: rows.collect(),
    }
}
