//! Fractiles of all results over the records, at all scales.

use powerhouse_study::internal::{fractile, rounded};
use powerhouse_study::sweep::{FigureStatistics, ScaleStatistics, SetStatistics};

use super::super::page::Page;
use super::super::{ReportTable, statistics};

/// Scales beside each other in one table.
const BESIDE: usize = 3;

/// Adds the section.
pub(super) fn add(page: &mut Page, found: &SetStatistics) {
    page.section("Results over the records");
    page.paragraph(
        "Fractiles of the results over the records at each scale: of the values in rising order those at 16, 50 and 84 % of the \
         way from the first to the last.",
    );
    let mut names: Vec<&str> = Vec::new();
    for figure in found.scales.iter().flat_map(|scale| &scale.figures) {
        if !names.contains(&figure.figure.as_str()) {
            names.push(&figure.figure);
        }
    }
    let is_zero = |name: &&str| {
        let mut all = found.scales.iter().filter_map(|scale| of(scale, name));
        all.all(|figure| [figure.low, figure.median, figure.high] == [Some(0.0); 3])
    };
    let (zero, others): (Vec<&str>, Vec<&str>) = names.into_iter().partition(is_zero);
    for scales in found.scales.chunks(BESIDE) {
        page.table(&table(&others, scales));
    }
    if !zero.is_empty() {
        page.paragraph(&format!("Zero from 16 to 84 %: {}.", zero.join(", ")));
    }
}

fn of<'s>(scale: &'s ScaleStatistics, name: &str) -> Option<&'s FigureStatistics> {
    scale.figures.iter().find(|figure| figure.figure == name)
}

/// The table of some scales: one column for each fractile of a single one, else one for each scale.
fn table(names: &[&str], scales: &[ScaleStatistics]) -> ReportTable {
    let mut header = vec!["result".to_owned()];
    let rows = names.iter().map(|name| vec![(*name).to_owned()]);
    let mut rows: Vec<Vec<String>> = rows.collect();
    if let [scale] = scales {
        let heading = statistics::heading(scale);
        header.extend([format!("{heading}, 16 %"), "median".into(), "84 %".into()]);
    } else {
        header.extend(
            scales
                .iter()
                .map(|scale| format!("{}, median (16 to 84 %)", statistics::heading(scale))),
        );
    }
    for (row, name) in rows.iter_mut().zip(names) {
        for scale in scales {
            let shown = of(scale, name).map(|figure| {
                let note = if figure.count < scale.finished {
                    format!(" of {} cases", figure.count)
                } else {
                    String::new()
                };
                let [low, median, high] = figure.shown();
                ([low, median, high], note)
            });
            match (scales.len(), shown) {
                (1, Some(([low, median, high], note))) => row.extend([low, median, high + &note]),
                (1, None) => row.extend([const { String::new() }; 3]),
                (_, Some(([low, median, high], note))) => {
                    row.push(format!("{median} ({low} to {high}){note}"));
                }
                (_, None) => row.push(String::new()),
            }
        }
    }
    ReportTable { header, rows }
}

/// Median and fractiles of 16 and 84 % of values that are not in order; zeros without values.
pub(super) fn fractiles(values: impl Iterator<Item = f64>) -> [f64; 3] {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_by(f64::total_cmp);
    if sorted.is_empty() {
        return [0.0; 3];
    }
    [0.16, 0.5, 0.84].map(|share| fractile(&sorted, share))
}

/// The three as text, with the least and the greatest.
pub(super) fn shown(values: impl Iterator<Item = f64> + Clone) -> [String; 5] {
    let least = values.clone().fold(f64::INFINITY, f64::min);
    let greatest = values.clone().fold(f64::NEG_INFINITY, f64::max);
    let [low, median, high] = fractiles(values);
    [least, low, median, high, greatest].map(rounded)
}
