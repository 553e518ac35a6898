//! Spectra of the records of a set, beside the one to which they are brought.

use std::fmt::Write as _;
use std::path::Path;

use powerhouse::io::{Plot, PlotCurve, PlotPanel, csv_cell, write_plot};
use powerhouse_study::StudyError;
use powerhouse_study::internal::{rounded, write_text};
use powerhouse_study::sweep::{SetSpectra, SpectrumOfRecord};

use super::super::ReportTable;
use super::super::page::Page;
use super::super::tables::header;
use super::figures::{fractiles, shown};

/// Longest period that is drawn of a set without a target, and the longest of the band over which more is drawn (s, 1).
const DRAWN: f64 = 2.0;

/// A number of a record.
type Value = fn(&SpectrumOfRecord) -> f64;

/// Adds the section, and writes the tables of all records.
pub(super) fn add(page: &mut Page, spectra: &SetSpectra, folder: &Path) -> Result<(), StudyError> {
    write_tables(spectra, folder)?;
    page.section("Records");
    page.paragraph(&paragraph(spectra));
    let rows: [(&str, Value); 3] = [
        ("peak acceleration (m/s2)", |record| record.peak),
        ("Arias intensity (m/s)", |record| record.arias),
        ("5 to 95 % of it (s)", |record| record.duration),
    ];
    let rows: [Vec<String>; 3] = rows.map(|(name, of)| {
        let values = shown(spectra.records.iter().map(of));
        std::iter::once(name.to_owned()).chain(values).collect()
    });
    page.table(&ReportTable {
        header: header(&["at scale 1", "least", "16 %", "median", "84 %", "greatest"]),
        rows: rows.into(),
    });
    let file = folder.join("set-spectra.svg");
    draw(spectra, &file)?;
    let damping = rounded(100.0 * spectra.damping);
    let all = format!(
        "Response spectra of the records at scale 1 ({damping} % damping; grey) with their fractiles"
    );
    let caption = match &spectra.target {
        Some(target) => format!(
            "{all}, the target ({}), and the median over it",
            target.name
        ),
        None => all,
    };
    page.figure(&file, &caption)
}

/// How far the records are from the target.
fn paragraph(spectra: &SetSpectra) -> String {
    let count = spectra.records.len();
    let Some(target) = &spectra.target else {
        return format!("{count} records, which are brought to no spectrum.");
    };
    let mut text = spectra.to_string();
    if text.is_empty() {
        return format!("{count} records, brought to {}.", target.name);
    }
    text[..1].make_ascii_uppercase();
    text + "."
}

fn draw(spectra: &SetSpectra, file: &Path) -> Result<(), StudyError> {
    let longest = spectra
        .target
        .as_ref()
        .map_or(DRAWN, |target| DRAWN * target.band[1]);
    let count = spectra.periods.partition_point(|period| *period <= longest);
    let periods = &spectra.periods[..count];
    let of = |index: usize| {
        fractiles(
            spectra
                .records
                .iter()
                .map(|record| record.accelerations[index]),
        )
    };
    let all: Vec<[f64; 3]> = (0..count).map(of).collect();
    let [low, median, high] =
        [0, 1, 2].map(|which| all.iter().map(|of| of[which]).collect::<Vec<f64>>());
    let mut curves: Vec<PlotCurve> = spectra
        .records
        .iter()
        .map(|record| PlotCurve {
            name: "",
            x: periods,
            y: &record.accelerations[..count],
        })
        .collect();
    // The target alone where it is defined.
    let target = spectra.target.as_ref().map(|target| {
        let points = periods.iter().zip(&target.accelerations).zip(&median);
        let defined = points.filter_map(|((period, target), median)| {
            let target = (*target)?;
            Some(((*period, target), median / target))
        });
        let (points, ratio): (Vec<(f64, f64)>, Vec<f64>) = defined.unzip();
        let (x, y): (Vec<f64>, Vec<f64>) = points.into_iter().unzip();
        (x, y, ratio)
    });
    if let Some((x, y, _)) = &target {
        curves.push(PlotCurve {
            name: "target",
            x,
            y,
        });
    }
    for (name, y) in [("median", &median), ("16 %", &low), ("84 %", &high)] {
        curves.push(PlotCurve {
            name,
            x: periods,
            y,
        });
    }
    let mut panels = vec![PlotPanel {
        label: "pseudo-acceleration".into(),
        unit: "m/s2".into(),
        curves,
    }];
    let ends = spectra
        .target
        .as_ref()
        .map(|target| target.band.map(|end| [end; 2]));
    let height = [0.0, 2.0];
    if let (Some((x, _, ratio)), Some([from, to])) = (&target, &ends) {
        let mut curves = vec![PlotCurve {
            name: "median over target",
            x,
            y: ratio,
        }];
        for (name, x) in [("ends of the band", from), ("", to)] {
            curves.push(PlotCurve {
                name,
                x,
                y: &height,
            });
        }
        panels.push(PlotPanel {
            label: "ratio".into(),
            unit: String::new(),
            curves,
        });
    }
    let plot = Plot {
        title: String::new(),
        label: "period".into(),
        unit: "s".into(),
        panels,
        gaps: Vec::new(),
    };
    write_plot(file, &plot).map_err(|error| powerhouse::Error::from(error).into())
}

/// Writes the table of the records, and that of their spectra.
fn write_tables(spectra: &SetSpectra, folder: &Path) -> Result<(), StudyError> {
    let mut text =
        String::from("record,peak acceleration [m/s2],Arias intensity [m/s],5 to 95 % of it [s]\n");
    for record in &spectra.records {
        let name = csv_cell(&record.record);
        let _ = writeln!(
            text,
            "{name},{:e},{:e},{:e}",
            record.peak, record.arias, record.duration
        );
    }
    write_text(&folder.join("records.csv"), &text)?;
    let mut text = String::from("period [s]");
    if spectra.target.is_some() {
        text += ",target [m/s2]";
    }
    for record in &spectra.records {
        let _ = write!(text, ",{}", csv_cell(&format!("{} [m/s2]", record.record)));
    }
    text.push('\n');
    for (index, period) in spectra.periods.iter().enumerate() {
        let _ = write!(text, "{period:e}");
        if let Some(target) = &spectra.target {
            let value = target.accelerations[index];
            text += &value.map_or(",".into(), |value| format!(",{value:e}"));
        }
        for record in &spectra.records {
            let _ = write!(text, ",{:e}", record.accelerations[index]);
        }
        text.push('\n');
    }
    write_text(&folder.join("spectra.csv"), &text)
}
