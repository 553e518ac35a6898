//! Tables of a report.

use powerhouse::summary::{PeakSummary, RunSummary, StageSummary};

use super::ReportCase;
use super::ReportTable;
use crate::Variation;
use powerhouse_study::internal::rounded;
use powerhouse_study::sweep::{CaseOutcome, JointCase, Peak};

/// The header cells of a table.
pub(super) fn header(names: &[&str]) -> Vec<String> {
    names.iter().map(|name| (*name).to_owned()).collect()
}

/// A sentence with the software and the mesh that reproduce a run, or the runs of a sweep.
pub(super) fn repetition(summaries: &[&RunSummary]) -> String {
    format!(
        "{} The scene as it was run is at the end of this page; with it and the files that it names the results can be reproduced bit \
         by bit.",
        computed_by(summaries)
    )
}

/// A sentence with the software and the mesh of runs.
pub(super) fn computed_by(summaries: &[&RunSummary]) -> String {
    let meshes = summaries.iter();
    let meshes: Vec<[usize; 2]> = meshes.map(|run| [run.elements, run.nodes]).collect();
    let software = summaries.first().map_or("", |run| &run.software);
    computed(software, &meshes)
}

/// The sentence of a software and the numbers of elements and nodes of meshes.
fn computed(software: &str, meshes: &[[usize; 2]]) -> String {
    let [elements, nodes] = [0, 1].map(|of| {
        let counts = meshes.iter().map(|mesh| mesh[of]);
        match (counts.clone().min(), counts.max()) {
            (Some(least), Some(most)) if least < most => format!("{least} to {most}"),
            (least, _) => least.map_or(String::new(), |least| least.to_string()),
        }
    });
    let mesh = if elements.contains(' ') {
        format!("meshes of {elements} elements and {nodes} nodes")
    } else {
        format!("a mesh of {elements} elements and {nodes} nodes")
    };
    format!("Computed by {software} on {mesh}.")
}

/// The table of cases: steps, times, energy residual and fingerprint.
pub(super) fn cases(cases: &[ReportCase]) -> ReportTable {
    let rows = cases.iter().map(|case| {
        let outcome = &case.outcome;
        let summary = case.summary.as_ref();
        let limit = summary.and_then(|summary| summary.stable_step.as_ref());
        let limited = limit.map(|limit| format!("{} in {}", limit.element, limit.set));
        vec![
            outcome.name.clone(),
            summary.map_or(String::new(), |summary| summary.elements.to_string()),
            rounded(outcome.end),
            outcome.steps.to_string(),
            rounded(1e3 * outcome.step),
            limited.unwrap_or_default(),
            rounded(outcome.wall_time),
            rounded(outcome.energy_residual),
            case.fingerprint["inputs"].as_str().unwrap_or("").into(),
        ]
    });
    ReportTable {
        header: header(&[
            "case",
            "elements",
            "end (s)",
            "steps",
            "step (ms)",
            "limited by",
            "wall time (s)",
            "energy residual",
            "checksum of scene and files",
        ]),
        rows: rows.collect(),
    }
}

/// The table of stages, once for all cases that share them; `None` without stages.
pub(super) fn stages(cases: &[ReportCase]) -> Option<ReportTable> {
    let mut shared: Vec<(&[StageSummary], Vec<&str>)> = Vec::new();
    for case in cases {
        let Some(summary) = &case.summary else {
            continue;
        };
        let stages = summary.stages.as_slice();
        let name = case.outcome.name.as_str();
        match shared.iter_mut().find(|(known, _)| *known == stages) {
            Some((_, names)) => names.push(name),
            None => shared.push((stages, vec![name])),
        }
    }
    let rows = shared.iter().flat_map(|(stages, names)| {
        let cases = match names.as_slice() {
            [one] => (*one).to_owned(),
            [first, others @ ..] => format!("{first} and {} more", others.len()),
            [] => String::new(),
        };
        stages.iter().map(move |stage| {
            vec![
                cases.clone(),
                stage.name.clone(),
                stage.excavated.to_string(),
                stage.cast.to_string(),
                stage.increments.to_string(),
                stage.corrections.to_string(),
                rounded(stage.residual),
                rounded(1e3 * stage.largest_displacement),
            ]
        })
    });
    let rows: Vec<Vec<String>> = rows.collect();
    (!rows.is_empty()).then(|| ReportTable {
        header: header(&[
            "cases",
            "stage",
            "excavated",
            "cast",
            "increments",
            "corrections",
            "residual",
            "largest displacement (mm)",
        ]),
        rows,
    })
}

/// The table of peaks, with a column for each history.
pub(super) fn peaks(
    cases: &[ReportCase],
    of: impl Fn(&CaseOutcome) -> &Vec<Peak>,
    scale: f64,
) -> ReportTable {
    let mut names: Vec<String> = Vec::new();
    for peak in cases.iter().flat_map(|case| of(&case.outcome)) {
        if !names.contains(&peak.name) {
            names.push(peak.name.clone());
        }
    }
    let rows = cases.iter().map(|case| {
        let value = |name: &String| {
            let peak = of(&case.outcome).iter().find(|peak| peak.name == *name);
            peak.map_or(String::new(), |peak| rounded(scale * peak.value))
        };
        let cells = names.iter().map(value);
        std::iter::once(case.outcome.name.clone())
            .chain(cells)
            .collect()
    });
    ReportTable {
        rows: rows.collect(),
        header: std::iter::once("case".to_owned()).chain(names).collect(),
    }
}

/// The table of all peaks of the summaries, with a column for each case.
pub(super) fn all_peaks(cases: &[ReportCase]) -> ReportTable {
    let of_cases = cases.iter().map(|case| match &case.summary {
        Some(summary) => summary.peaks.as_slice(),
        None => &[],
    });
    let of_cases: Vec<&[PeakSummary]> = of_cases.collect();
    let mut names: Vec<(String, String)> = Vec::new();
    for peak in of_cases.iter().copied().flatten() {
        let named = (peak.name.clone(), peak.unit.clone());
        if !names.contains(&named) {
            names.push(named);
        }
    }
    let rows = names.iter().map(|(name, unit)| {
        let values =
            of_cases
                .iter()
                .map(|peaks| match peaks.iter().find(|peak| peak.name == *name) {
                    Some(peak) if peak.below_rounding => "0".to_owned(),
                    found => found.map_or(String::new(), |peak| rounded(peak.value)),
                });
        [name.clone(), unit.clone()]
            .into_iter()
            .chain(values)
            .collect()
    });
    let rows = rows.collect();
    let cases = cases.iter().map(|case| case.outcome.name.clone());
    ReportTable {
        rows,
        header: ["peak".into(), "unit".into()]
            .into_iter()
            .chain(cases)
            .collect(),
    }
}

/// The table of the damage variables of the cases.
pub(super) fn damage(cases: &[ReportCase]) -> ReportTable {
    let rows = cases.iter().flat_map(|case| {
        let of = case.outcome.damage.iter();
        of.map(|damage| {
            let share = 100.0 * damage.damaged as f64 / damage.of.max(1) as f64;
            vec![
                case.outcome.name.clone(),
                damage.name.clone(),
                rounded(damage.greatest),
                damage.element.to_string(),
                format!("{} of {} ({share:.1} %)", damage.damaged, damage.of),
            ]
        })
    });
    ReportTable {
        header: header(&["case", "kind", "greatest", "element", "above 0.1"]),
        rows: rows.collect(),
    }
}

/// The table of the damage of the structure and its parts in a case.
pub(super) fn parts(outcome: &CaseOutcome) -> ReportTable {
    let rows = outcome.parts.iter().map(|part| {
        let shares = [
            part.damaged,
            part.tension,
            part.compression,
            part.both,
            part.severe,
        ];
        let mut row = vec![
            part.name.clone(),
            rounded(part.volume),
            rounded(part.mean),
            rounded(part.greatest),
        ];
        row.extend(shares.map(|share| rounded(100.0 * share)));
        row
    });
    ReportTable {
        header: header(&[
            "part",
            "volume (m3)",
            "mean",
            "greatest",
            "above 0.1 (%)",
            "by tension (%)",
            "by compression or shear (%)",
            "by both (%)",
            "above half the greatest (%)",
        ]),
        rows: rows.collect(),
    }
}

/// The table of the mean damage of the structure, its lining and its interior in each case.
pub(super) fn mean_damage(cases: &[ReportCase]) -> ReportTable {
    const SETS: [&str; 3] = ["structure", "lining", "interior"];
    let with = cases.iter().filter(|case| !case.outcome.parts.is_empty());
    let rows = with.map(|case| {
        let of = |set: &str| {
            let found = case.outcome.parts.iter().find(|part| part.name == set);
            found.map_or_else(
                || vec![String::new(); 3],
                |part| {
                    let shares = [part.damaged, part.tension + part.both];
                    let shares = shares.map(|share| rounded(100.0 * share));
                    std::iter::once(rounded(part.mean)).chain(shares).collect()
                },
            )
        };
        let cells = SETS.iter().flat_map(|set| of(set));
        std::iter::once(case.outcome.name.clone())
            .chain(cells)
            .collect()
    });
    let names = SETS.iter().flat_map(|set| {
        [
            format!("{set}: mean"),
            "above 0.1 (%)".into(),
            "by tension or both (%)".into(),
        ]
    });
    ReportTable {
        header: std::iter::once("case".to_owned()).chain(names).collect(),
        rows: rows.collect(),
    }
}

/// The table of the sensitivity of the main results to single parameters; `None` without varied cases.
pub(super) fn sensitivity(variations: &[Variation]) -> Option<ReportTable> {
    let mut names: Vec<&str> = Vec::new();
    for figure in variations.iter().flat_map(|found| &found.figures) {
        if !names.contains(&figure.name.as_str()) {
            names.push(&figure.name);
        }
    }
    let mut bases: Vec<&str> = Vec::new();
    let mut rows = Vec::new();
    for found in variations {
        let cells = |of: &dyn Fn(&crate::VariedFigure) -> String| {
            let own = names.iter().map(|name| {
                let mut figures = found.figures.iter();
                figures
                    .find(|figure| figure.name == *name)
                    .map_or(String::new(), of)
            });
            own.collect::<Vec<_>>()
        };
        if !bases.contains(&found.base.as_str()) {
            bases.push(&found.base);
            let mut row = vec![found.base.clone(), "none".into()];
            row.extend(cells(&|figure| rounded(figure.base)));
            rows.push(row);
        }
        let mut row = vec![found.case.clone(), found.varies.clone()];
        row.extend(cells(&|figure| figure.text()));
        rows.push(row);
    }
    (!rows.is_empty()).then(|| ReportTable {
        header: (["case", "varied parameter"].into_iter().chain(names))
            .map(str::to_owned)
            .collect(),
        rows,
    })
}

/// The table of the energies at the end of each case (J).
pub(super) fn energies(cases: &[ReportCase]) -> ReportTable {
    let entries = |case: &ReportCase| -> Vec<(String, f64)> {
        let list = case.summary.iter().flat_map(|summary| &summary.energies);
        list.map(|energy| (energy.name.clone(), energy.value))
            .collect()
    };
    let all: Vec<Vec<(String, f64)>> = cases.iter().map(entries).collect();
    let mut names: Vec<String> = Vec::new();
    for (name, _) in all.iter().flatten() {
        if !names.contains(name) {
            names.push(name.clone());
        }
    }
    let rows = cases.iter().zip(&all).map(|(case, own)| {
        let value = |name: &String| {
            let found = own.iter().find(|(other, _)| other == name);
            found.map_or(String::new(), |(_, value)| rounded(*value))
        };
        std::iter::once(case.outcome.name.clone())
            .chain(names.iter().map(value))
            .chain([rounded(case.outcome.energy_residual)])
            .collect()
    });
    ReportTable {
        rows: rows.collect(),
        header: std::iter::once("case".to_owned())
            .chain(names.iter().cloned())
            .chain(["residual over the largest".into()])
            .collect(),
    }
}

/// The table of the bolt forces: static values, and peaks of the motion with their times.
pub(super) fn bolts(cases: &[ReportCase]) -> ReportTable {
    let rows = cases.iter().flat_map(|case| {
        case.outcome.bolts.iter().map(|peak| {
            let mut statics = case.outcome.bolts_at_rest.iter();
            let statics = statics.find(|other| other.name == peak.name);
            vec![
                case.outcome.name.clone(),
                peak.name.clone(),
                statics.map_or(String::new(), |peak| rounded(1e-3 * peak.value)),
                rounded(1e-3 * peak.value),
                format!("{:.2}", peak.time),
            ]
        })
    });
    ReportTable {
        header: header(&[
            "case",
            "bolts",
            "static (kN)",
            "greatest in the motion (kN)",
            "at time (s)",
        ]),
        rows: rows.collect(),
    }
}

/// The table of the joints of the cases, or of their parts.
pub(super) fn joints(
    cases: &[ReportCase],
    of: impl Fn(&CaseOutcome) -> &Vec<JointCase>,
) -> ReportTable {
    let rows = cases.iter().flat_map(|case| {
        of(&case.outcome).iter().map(|joint| {
            vec![
                case.outcome.name.clone(),
                joint.name.clone(),
                rounded(joint.area),
                rounded(100.0 * joint.slipped),
                rounded(100.0 * joint.opened),
                rounded(100.0 * joint.broken),
                rounded(1e3 * joint.slip),
                rounded(1e3 * joint.opening),
            ]
        })
    });
    ReportTable {
        header: header(&[
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

#[cfg(test)]
mod tests {
    use super::computed;

    /// Different meshes of the cases are reported as ranges.
    #[test]
    fn sizes_of_meshes_are_reported_as_a_range() {
        let [coarse, fine] = [[15840, 19494], [130088, 144960]];
        let same = computed("powerhouse", &[coarse, coarse]);
        assert!(
            same.contains(" on a mesh of 15840 elements and 19494 nodes."),
            "{same}"
        );
        let both = computed("powerhouse", &[fine, coarse]);
        assert!(
            both.contains(" on meshes of 15840 to 130088 elements and 19494 to 144960 nodes."),
            "{both}"
        );
    }
}
