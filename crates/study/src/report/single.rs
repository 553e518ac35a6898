//! Report page of a single run.

use std::path::{Path, PathBuf};

use powerhouse::ResultFolder;
use serde_json::Value;

use super::ReportTable;
use super::page::Page;
use super::run_warnings::RunWarnings;
use super::{forces, motions, read_json, report_gaps, tables};
use crate::StudyError;
use crate::rounded::rounded;
use crate::text::after_first_slip;

/// Greatest size of a picture on the page (bytes).
const LARGEST: u64 = 4 << 20;

/// The report page of a result folder.
pub(super) fn page(folder: &Path) -> Result<Page, StudyError> {
    let summary = read_json(&folder.join("summary.json"))?;
    let Some(title) = summary["title"].as_str() else {
        let folder = folder.into();
        return Err(StudyError::NoResults { folder });
    };
    let mut page = Page::new(title);
    page.section("Run");
    page.warnings(&report_gaps(folder)?);
    let warnings = RunWarnings::of([("", &summary)]);
    page.warnings(&warnings.about(&[]));
    page.paragraph(&tables::repetition(&[&summary]));
    let real = |key: &str| rounded(summary[key].as_f64().unwrap_or(0.0));
    let row = |name: &str, value: String| vec![name.to_owned(), value];
    page.table(&ReportTable {
        header: vec!["".into(), "".into()],
        rows: vec![
            row("steps", summary["steps"].to_string()),
            row("step (s)", real("step")),
            row("ended", summary["ended"].as_str().unwrap_or("").to_owned()),
            row("end (s)", real("end_time")),
            row("wall time (s)", real("wall_time")),
        ],
    });
    let facts = summary["remarks"].as_array().into_iter().flatten();
    let facts: Vec<Vec<String>> = (facts.filter_map(|fact| fact.as_str()).enumerate())
        .map(|(number, fact)| vec![(number + 1).to_string(), fact.to_owned()])
        .collect();
    if !facts.is_empty() {
        page.section("Remarks");
        page.table(&ReportTable {
            header: vec![String::new(), "about the input and the computation".into()],
            rows: facts,
        });
    }
    page.section("Peaks");
    page.warnings(&warnings.about(&["histories", "sections", "joints"]));
    let joints = summary["joints"].as_array().into_iter().flatten();
    let firsts = joints.flat_map(|joint| [&joint["first_slip"], &joint["first_crack"]]);
    if let Some(after) = after_first_slip(firsts.filter_map(Value::as_f64)) {
        page.paragraph(&format!("The {after}."));
    }
    let peaks = summary["peaks"].as_array();
    let rows = peaks.into_iter().flatten().map(|peak| {
        let text = |key: &str| peak[key].as_str().unwrap_or("").to_owned();
        let real = |key: &str| rounded(peak[key].as_f64().unwrap_or(0.0));
        if peak["below_rounding"] == true {
            let (value, time) = ("0, below rounding".into(), String::new());
            return vec![text("name"), value, text("unit"), time];
        }
        vec![text("name"), real("value"), text("unit"), real("time")]
    });
    page.table(&ReportTable {
        header: ["name", "value", "unit", "time (s)"]
            .map(str::to_owned)
            .to_vec(),
        rows: rows.collect(),
    });
    motions::section(&mut page, folder, &warnings.about(&["histories"]))?;
    if let Some(table) = forces::table(folder)? {
        page.section("Section forces");
        page.warnings(&warnings.about(&["sections"]));
        page.paragraph(forces::MEANING);
        page.table(&table);
        if let Some(uses) = forces::utilisation(&summary) {
            page.paragraph(
                "Utilisation of reinforced sections: the moment over what the section bears with the same normal \
                 force (`capacity/`), strengths as in the scene.",
            );
            page.table(&uses);
        }
    }
    for (section, below, end) in [("Plots", "plots", "svg"), ("Pictures", "pictures", "png")] {
        let files = files(&folder.join(below), end);
        if !files.is_empty() {
            page.section(section);
            page.warnings(&warnings.about(&["histories", "sections", "joints"]));
        }
        for file in files {
            let name = file
                .file_stem()
                .unwrap_or_default()
                .to_string_lossy()
                .into_owned();
            // An animation may be larger than all the rest of the page.
            match file.metadata().is_ok_and(|file| file.len() > LARGEST) {
                true => page.paragraph(&format!(
                    "`{below}/{name}.{end}` is too large for this page."
                )),
                false => page.figure(&file, &name)?,
            }
        }
    }
    page.section("The scene");
    page.file(&ResultFolder::new(folder).scene())?;
    Ok(page)
}

/// The files of a folder with an extension, sorted by name.
fn files(folder: &Path, extension: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut files: Vec<PathBuf> = entries
        .map(|entry| entry.path())
        .filter(|path| path.extension().is_some_and(|found| found == extension))
        .collect();
    files.sort();
    files
}
