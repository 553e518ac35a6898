//! The table of all cases.

use std::path::Path;

use powerhouse::io::csv_cell;

use super::{CaseOutcome, Peak, write_text};
use crate::StudyError;

/// Writes a CSV table with one line per case and a named column per value.
pub(super) fn write(file: &Path, outcomes: &[CaseOutcome]) -> Result<(), StudyError> {
    let mut columns: Vec<String> = Vec::new();
    let lines: Vec<Vec<(String, f64)>> = outcomes.iter().map(cells).collect();
    for (name, _) in lines.iter().flatten() {
        if !columns.contains(name) {
            columns.push(name.clone());
        }
    }
    let heads: Vec<_> = columns.iter().map(|column| csv_cell(column)).collect();
    let mut text = format!("case,{}\n", heads.join(","));
    for (outcome, cells) in outcomes.iter().zip(&lines) {
        let value = |column: &String| {
            let found = cells.iter().find(|(name, _)| name == column);
            found.map_or(String::new(), |(_, value)| format!("{value:e}"))
        };
        let values: Vec<String> = columns.iter().map(value).collect();
        text += &format!("{},{}\n", csv_cell(&outcome.name), values.join(","));
    }
    write_text(file, &text)
}

/// The values of a case with their names and units.
fn cells(outcome: &CaseOutcome) -> Vec<(String, f64)> {
    let run = [
        ("steps".into(), outcome.steps as f64),
        ("end [s]".into(), outcome.end),
        ("wall time [s]".into(), outcome.wall_time),
    ];
    run.into_iter().chain(figures(outcome)).collect()
}

/// The results of a case with their names and units.
pub(super) fn figures(outcome: &CaseOutcome) -> Vec<(String, f64)> {
    let mut cells = Vec::new();
    let mut put = |what: &str, unit: &str, peaks: &[Peak]| {
        for peak in peaks {
            cells.push((format!("{what} {} [{unit}]", peak.name), peak.value));
        }
    };
    put("principal stress", "Pa", &outcome.stresses);
    put("displacement", "m", &outcome.displacements);
    put("relative displacement", "m", &outcome.relative);
    put("relative displacement of the ground", "m", &outcome.ground);
    put("bolt force", "N", &outcome.bolts);
    for section in &outcome.sections {
        let name = &section.name;
        for (what, unit, [least, greatest]) in [
            ("axial force", "N/m", &section.axial),
            ("shear force", "N/m", &section.shear),
            ("moment", "N m/m", &section.moment),
        ] {
            cells.push((format!("least {what} {name} [{unit}]"), least.value));
            cells.push((format!("greatest {what} {name} [{unit}]"), greatest.value));
        }
        if let Some(utilisation) = section.utilisation {
            cells.push((format!("utilisation {name}"), utilisation.value()));
        }
    }
    for damage in &outcome.damage {
        cells.push((format!("greatest {}", damage.name), damage.greatest));
        let name = format!("elements with {} above 0.1", damage.name);
        cells.push((name, damage.damaged as f64));
    }
    for part in &outcome.parts {
        cells.push((format!("mean damage of {}", part.name), part.mean));
    }
    if let Some(found) = &outcome.joint_and_lining {
        cells.push(("failed share of joints".into(), found.failed));
    }
    for joint in &outcome.joints {
        for (what, value) in [
            ("slipped", joint.slipped),
            ("opened", joint.opened),
            ("broken", joint.broken),
            ("slip [m]", joint.slip),
            ("opening [m]", joint.opening),
        ] {
            cells.push((format!("joint {} {what}", joint.name), value));
        }
    }
    cells
}
