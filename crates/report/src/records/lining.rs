//! Forces of linings over all records of a set: around rings, and beside what sections bear.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use powerhouse::file_name;
use powerhouse::io::{Plot, PlotCurve, PlotPanel, TableColumn, read_table, write_plot};
use powerhouse_study::StudyError;
use powerhouse_study::sweep::{ScaleStatistics, SetStatistics};

use super::super::page::Page;
use super::super::{column, statistics};
use super::figures::fractiles;
use super::{MOST_SECTIONS, middle_scale};

/// Forces per metre in the tables of rings, with their symbols and units in plots.
const FORCES: [(&str, &str, &str); 3] = [
    ("axial_per_metre", "N", "kN/m"),
    ("shear_per_metre", "Q", "kN/m"),
    ("moment_per_metre", "M", "kN m/m"),
];
/// Utilisation up to which it is drawn.
const MOST_USED: f64 = 5.0;
/// Relative difference of thicknesses that count as equal.
const SAME_THICKNESS: f64 = 0.01;

/// Axial forces (kN/m) and moments (kN m/m).
type Diagram = [Vec<f64>; 2];

/// Adds the section, if there are section forces.
pub(super) fn add(
    page: &mut Page,
    (folder, found): (&Path, &SetStatistics),
    plots: &Path,
) -> Result<(), StudyError> {
    let Some(table) = statistics::envelopes(found) else {
        return Ok(());
    };
    page.section("Section forces over all records");
    let rings = names_in(folder, found, "rings");
    let capacities = names_in(folder, found, "capacity");
    let mut of_rings = BTreeSet::new();
    if !rings.is_empty() {
        page.paragraph(
            "Around each lining the least and greatest forces per metre of each record (grey), of all records, and the medians over the \
             records; utilisation is the moment over that borne with the same normal force. Below them the hulls of all normal forces and \
             moments of each record and of all, in the interaction diagram of the thinnest section. Of several scales that of the records \
             themselves, or the nearest to it, and the greatest are drawn.",
        );
    }
    // The records themselves, and the strongest.
    let strongest = found
        .scales
        .iter()
        .rev()
        .find(|scale| !scale.cases.is_empty());
    let mut scales: Vec<&ScaleStatistics> = middle_scale(found).into_iter().collect();
    scales.extend(strongest.filter(|scale| scales.iter().all(|known| known.scale != scale.scale)));
    for ring in &rings {
        let own: Vec<String> = sections_of(ring, &capacities);
        for scale in &scales {
            let tables = tables(folder, scale, &format!("rings/{ring}.csv"))?;
            let Some(first) = tables.first() else {
                continue;
            };
            let at = format!("{ring} at scale {}", scale.scale);
            let file = format!(
                "{}-x{}.svg",
                file_name(&format!("ring-{ring}")),
                scale.scale
            );
            let file = plots.join(file);
            around(&file, &tables)?;
            page.figure(
                &file,
                &format!("{at}: forces and utilisation around the lining"),
            )?;
            let thinnest = thinnest(ring, first, &own);
            let drawn = interaction(folder, (scale, ring), (&own, thinnest.as_deref()), plots)?;
            if let Some(file) = drawn {
                page.figure(&file, &format!("{at}: N and M of all sections"))?;
            }
        }
        of_rings.extend(own);
    }
    let single: Vec<&String> = capacities
        .iter()
        .filter(|name| !of_rings.contains(*name))
        .collect();
    for section in single.iter().take(MOST_SECTIONS) {
        let Some(scale) = strongest else {
            continue;
        };
        let own = [(*section).clone()];
        let drawn = interaction(folder, (scale, section), (&own, Some(section)), plots)?;
        if let Some(file) = drawn {
            let at = format!("{section} at scale {}", scale.scale);
            let caption = format!("{at}: N and M beside what the section bears");
            page.figure(&file, &caption)?;
        }
    }
    if single.len() > MOST_SECTIONS {
        page.paragraph(&format!(
            "The first {MOST_SECTIONS} of {} sections with a reinforcement are drawn.",
            single.len()
        ));
    }
    // Sections of rings are in the plots and in the table of the folder.
    let is_of_ring = |section: &str| rings.iter().any(|ring| is_section_of(ring, section));
    let mut table = table;
    table
        .rows
        .retain(|row| row.first().is_none_or(|section| !is_of_ring(section)));
    if !table.rows.is_empty() {
        page.paragraph(
            "Envelopes over all records of the forces of single sections (kN/m, kN m/m).",
        );
        page.table(&table);
    }
    Ok(())
}

/// Names of the tables in a folder of the cases, without their ends.
fn names_in(folder: &Path, found: &SetStatistics, of: &str) -> Vec<String> {
    let mut names = BTreeSet::new();
    let Some(case) = found.scales.iter().flat_map(|scale| &scale.cases).next() else {
        return Vec::new();
    };
    let files = std::fs::read_dir(folder.join(case).join(of));
    for file in files.into_iter().flatten().flatten() {
        let file = file.path();
        if let (Some("csv"), Some(stem)) = (
            file.extension().and_then(|end| end.to_str()),
            file.file_stem().and_then(|stem| stem.to_str()),
        ) {
            names.insert(stem.to_owned());
        }
    }
    names.into_iter().collect()
}

/// Whether a section is one of a ring, by its name: that of the ring with three digits behind it.
fn is_section_of(ring: &str, section: &str) -> bool {
    let angle = section
        .strip_prefix(ring)
        .and_then(|rest| rest.strip_prefix('-'));
    angle.is_some_and(|angle| angle.len() == 3 && angle.bytes().all(|digit| digit.is_ascii_digit()))
}

fn sections_of(ring: &str, sections: &[String]) -> Vec<String> {
    let own = sections
        .iter()
        .filter(|section| is_section_of(ring, section));
    own.cloned().collect()
}

/// A table of all cases at a scale that have it.
fn tables(
    folder: &Path,
    scale: &ScaleStatistics,
    name: &str,
) -> Result<Vec<Vec<TableColumn>>, StudyError> {
    let files = scale.cases.iter().map(|case| folder.join(case).join(name));
    let files = files.filter(|file| file.exists());
    let tables = files.map(|file| read_table(&file).map_err(powerhouse::Error::from));
    Ok(tables.collect::<Result<_, _>>()?)
}

/// The section of a ring that is thinnest by more than rounding, else the first.
fn thinnest(ring: &str, table: &[TableColumn], sections: &[String]) -> Option<String> {
    let [angles, thickness] = [table.first()?, column(table, "thickness")?];
    let mut least: Option<(f64, &String)> = None;
    for (angle, thickness) in angles.values.iter().zip(&thickness.values) {
        let name = format!("{ring}-{:03.0}", angle.rem_euclid(360.0));
        let Some(section) = sections.iter().find(|section| **section == name) else {
            continue;
        };
        if least.is_none_or(|(known, _)| *thickness < known * (1.0 - SAME_THICKNESS)) {
            least = Some((*thickness, section));
        }
    }
    least.map(|(_, section)| section.clone())
}

/// Draws forces and utilisation around a ring, of the tables of all cases at a scale.
fn around(file: &Path, tables: &[Vec<TableColumn>]) -> Result<(), StudyError> {
    let first = &tables[0];
    let angles = &first[0].values;
    let step = 360.0 / angles.len().max(1) as f64;
    let is_closed = angles
        .windows(2)
        .all(|pair| (pair[1] - pair[0] - step).abs() < 1e-6);
    let closed = |values: Vec<f64>, turn: f64| -> Vec<f64> {
        let end = values
            .first()
            .filter(|_| is_closed)
            .map(|value| value + turn);
        values.into_iter().chain(end).collect()
    };
    // Values of a column of all cases with the same sections.
    let all = |name: &str, factor: f64| -> Vec<Vec<f64>> {
        let columns = tables.iter().filter_map(|table| column(table, name));
        let columns = columns.filter(|column| column.values.len() == angles.len());
        let values = columns.map(|of| of.values.iter().map(|value| factor * value).collect());
        values.map(|values| closed(values, 0.0)).collect()
    };
    let over = |of: &[Vec<f64>], fold: fn(Vec<f64>) -> f64| -> Vec<f64> {
        let count = of.first().map_or(0, Vec::len);
        (0..count)
            .map(|at| fold(of.iter().map(|values| values[at]).collect()))
            .collect()
    };
    let least = |values: Vec<f64>| values.into_iter().fold(f64::INFINITY, f64::min);
    let greatest = |values: Vec<f64>| values.into_iter().fold(f64::NEG_INFINITY, f64::max);
    let median = |values: Vec<f64>| fractiles(values.into_iter())[1];
    let x = closed(angles.clone(), 360.0);
    let forces: Vec<_> = FORCES
        .iter()
        .map(|(force, ..)| {
            let [start, low, high] =
                ["start", "least", "greatest"].map(|value| all(&format!("{force}.{value}"), 1e-3));
            let named = [
                ("least of all", over(&low, least)),
                ("greatest of all", over(&high, greatest)),
                ("median of the least", over(&low, median)),
                ("median of the greatest", over(&high, median)),
                ("at the start", start.into_iter().next().unwrap_or_default()),
            ];
            ([low, high].concat(), named)
        })
        .collect();
    let mut panels: Vec<PlotPanel> = Vec::new();
    for ((_, quantity, unit), (faint, named)) in FORCES.iter().zip(&forces) {
        let faint = faint.iter().map(|y| PlotCurve { name: "", x: &x, y });
        let named = named.iter().filter(|(_, y)| y.len() == x.len());
        panels.push(PlotPanel {
            label: (*quantity).into(),
            unit: (*unit).into(),
            curves: faint
                .chain(named.map(|(name, y)| PlotCurve { name, x: &x, y }))
                .collect(),
        });
    }
    let used: Vec<Vec<f64>> = (all("utilisation", 1.0).into_iter())
        .map(|values| {
            values
                .into_iter()
                .map(|value| value.min(MOST_USED))
                .collect()
        })
        .collect();
    let (most, middle) = (over(&used, greatest), over(&used, median));
    let limit = vec![1.0; x.len()];
    if !used.is_empty() {
        let faint = used.iter().map(|y| PlotCurve { name: "", x: &x, y });
        let named = [
            ("greatest of all", &most),
            ("median", &middle),
            ("limit", &limit),
        ];
        panels.push(PlotPanel {
            label: format!("utilisation, up to {MOST_USED}"),
            unit: String::new(),
            curves: faint
                .chain(named.map(|(name, y)| PlotCurve { name, x: &x, y }))
                .collect(),
        });
    }
    let plot = Plot {
        title: String::new(),
        label: "angle".into(),
        unit: "degrees".into(),
        panels,
        gaps: Vec::new(),
    };
    write_plot(file, &plot).map_err(|error| powerhouse::Error::from(error).into())
}

/// Draws the hulls of normal forces and moments of some sections over the runs at a scale, beside what one of them bears; `None`
/// without forces.
fn interaction(
    folder: &Path,
    (scale, name): (&ScaleStatistics, &str),
    (sections, bearing): (&[String], Option<&str>),
    plots: &Path,
) -> Result<Option<PathBuf>, StudyError> {
    let mut hulls: Vec<Diagram> = Vec::new();
    let mut points = Vec::new();
    for table in tables(folder, scale, "sections.csv")? {
        let mut own = Vec::new();
        for section in sections {
            let of = |force: &str| column(&table, &format!("{section}.{force}"));
            if let (Some(axial), Some(moment)) = (of(FORCES[0].0), of(FORCES[2].0)) {
                let pairs = axial.values.iter().zip(&moment.values);
                own.extend(pairs.map(|(axial, moment)| [1e-3 * axial, 1e-3 * moment]));
            }
        }
        let hull = hull(own);
        points.extend(&hull);
        hulls.push(closed(&hull));
    }
    let whole = hull(points);
    if whole.is_empty() {
        return Ok(None);
    }
    let whole = closed(&whole);
    let borne = match bearing {
        Some(section) => borne(folder, scale, section)?,
        None => None,
    };
    let mut curves: Vec<PlotCurve> = (hulls.iter())
        .map(|[x, y]| PlotCurve { name: "", x, y })
        .collect();
    let [x, y] = &whole;
    curves.push(PlotCurve {
        name: "all records",
        x,
        y,
    });
    if let Some([x, y]) = &borne {
        curves.push(PlotCurve {
            name: "borne",
            x,
            y,
        });
    }
    let plot = Plot {
        title: String::new(),
        label: "N, tension positive".into(),
        unit: "kN/m".into(),
        panels: vec![PlotPanel {
            label: "M".into(),
            unit: "kN m/m".into(),
            curves,
        }],
        gaps: Vec::new(),
    };
    let file = plots.join(format!(
        "{}-x{}.svg",
        file_name(&format!("interaction-{name}")),
        scale.scale
    ));
    write_plot(&file, &plot).map_err(powerhouse::Error::from)?;
    Ok(Some(file))
}

/// What a section bears, by the first case that has its diagram.
fn borne(
    folder: &Path,
    scale: &ScaleStatistics,
    section: &str,
) -> Result<Option<Diagram>, StudyError> {
    let all = tables(folder, scale, &format!("capacity/{section}.csv"))?;
    let Some([axial, moment]) = all.first().map(Vec::as_slice) else {
        return Ok(None);
    };
    let thousands = |of: &TableColumn| of.values.iter().map(|value| 1e-3 * value).collect();
    Ok(Some([thousands(axial), thousands(moment)]))
}

/// Corners of the convex hull of points, against the clock (Andrew 1979).
fn hull(mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    points.retain(|point| point.iter().all(|value| value.is_finite()));
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    points.dedup();
    let turns = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| {
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 0.0
    };
    let half = |points: &mut dyn Iterator<Item = [f64; 2]>| {
        let mut corners: Vec<[f64; 2]> = Vec::new();
        for point in points {
            while let [.., a, b] = corners[..]
                && !turns(a, b, point)
            {
                corners.pop();
            }
            corners.push(point);
        }
        corners.pop();
        corners
    };
    if points.len() < 3 {
        return points;
    }
    let lower = half(&mut points.iter().copied());
    let upper = half(&mut points.iter().rev().copied());
    [lower, upper].concat()
}

/// A closed line through corners.
fn closed(corners: &[[f64; 2]]) -> Diagram {
    [0, 1].map(|axis| {
        let all = corners.iter().chain(corners.first());
        all.map(|corner| corner[axis]).collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A hull has the corners alone, against the clock, also of points on its sides and within.
    #[test]
    fn a_hull_has_the_corners() {
        let points = [
            [0.0, 0.0],
            [2.0, 0.0],
            [1.0, 0.0],
            [1.0, 0.5],
            [2.0, 1.0],
            [0.0, 1.0],
            [0.0, 0.0],
            [1.0, 1.0],
            [f64::NAN, 3.0],
        ];
        let corners = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]];
        assert_eq!(hull(points.into()), corners);
        assert_eq!(closed(&corners)[0], [0.0, 2.0, 2.0, 0.0, 0.0]);
        assert_eq!(hull(vec![[1.0, 2.0]]), [[1.0, 2.0]]);
        assert!(hull(Vec::new()).is_empty());
    }

    /// A section of a ring is known by its name, and no other one.
    #[test]
    fn sections_of_rings_are_known() {
        assert!(is_section_of("lining", "lining-090"));
        for other in ["lining-crown", "lining-0900", "lining", "other-090"] {
            assert!(!is_section_of("lining", other), "{other}");
        }
    }
}
