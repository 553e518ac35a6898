//! One HTML page of a sweep or a run, which needs nothing beside it.
//!
//! # Why so
//! *It reads what is on disk*, so that a report can be made again of old results, and of results that
//! are not complete: what is missing is left out.
//!
//! *Plots and pictures are part of the page* as data, each for itself, so that a page can be sent by
//! mail and the colours of a plot follow light and dark.

mod charts;
mod fourier;
mod page;
mod paper;
mod single;
mod tables;

use std::path::{Path, PathBuf};

use powerhouse::io::{TableColumn, read_table};

use crate::StudyError;
use crate::sweep::{CASES, CaseOutcome, OUTCOME, RECORD, write_text};
use page::Page;

/// The name of the page in its folder.
const FILE: &str = "report.html";
/// The folder of the plots that are made for it.
const PLOTS: &str = "report";

/// A case and what is on disk of it.
pub(super) struct CaseFiles {
    pub(super) folder: PathBuf,
    pub(super) outcome: CaseOutcome,
    pub(super) histories: Vec<TableColumn>,
    pub(super) summary: serde_json::Value,
}

/// Writes `report.html` of a folder of results: of a sweep or of a single run. Returns the file.
///
/// # Errors
/// [`StudyError::NoResults`] for a folder that holds neither; a file that cannot be read or written.
pub fn write_report(folder: impl AsRef<Path>) -> Result<PathBuf, StudyError> {
    let folder = folder.as_ref();
    let page = match read_cases(folder)? {
        Some(cases) if !cases.is_empty() => of_sweep(folder, &cases)?,
        _ => single::page(folder)?,
    };
    let file = folder.join(FILE);
    write_text(&file, &page.html())?;
    Ok(file)
}

/// The cases of a sweep that are finished, in order; none if it is no sweep.
fn read_cases(folder: &Path) -> Result<Option<Vec<CaseFiles>>, StudyError> {
    let Ok(text) = std::fs::read(folder.join(CASES)) else {
        return Ok(None);
    };
    let names: Vec<String> =
        serde_json::from_slice(&text).map_err(|source| StudyError::Outcome {
            file: folder.join(CASES),
            source,
        })?;
    let mut cases = Vec::new();
    for name in names {
        let folder = folder.join(name);
        let file = folder.join(OUTCOME);
        if !file.exists() {
            continue;
        }
        let histories = folder.join("histories.csv");
        cases.push(CaseFiles {
            outcome: CaseOutcome::read(&file)?,
            histories: match histories.exists() {
                true => read_table(&histories).map_err(powerhouse::Error::from)?,
                false => Vec::new(),
            },
            summary: read_summary(&folder),
            folder,
        });
    }
    Ok(Some(cases))
}

/// The summary of a run; null if there is none that can be read.
fn read_summary(folder: &Path) -> serde_json::Value {
    let text = std::fs::read(folder.join("summary.json")).unwrap_or_default();
    serde_json::from_slice(&text).unwrap_or_default()
}

fn of_sweep(folder: &Path, cases: &[CaseFiles]) -> Result<Page, StudyError> {
    let title = cases[0].summary["title"].as_str().unwrap_or("sweep");
    let title = title.rsplit_once(": ").map_or(title, |(scene, _)| scene);
    let mut page = Page::new(title);
    let plots = folder.join(PLOTS);
    page.section("Cases");
    page.paragraph(&tables::repetition(&cases[0].summary));
    page.table(&tables::cases(cases));
    if let Some(stages) = tables::stages(cases) {
        page.section("Before the earthquake");
        page.paragraph("What the stages came to, once for the cases that share them.");
        page.table(&stages);
    }
    page.section("Input");
    for record in records(folder) {
        let [time, spectrum] = fourier::plots(&record, &plots)?;
        page.figure(&time, "Acceleration of the record as it enters the waves")?;
        page.figure(&spectrum, "Its Fourier amplitude")?;
    }
    page.section("Principal stress");
    page.paragraph("Greatest principal stress over the motion behind each monitoring point (MPa).");
    page.table(&tables::peaks(cases, |outcome| &outcome.stresses, 1e-6));
    for (file, caption) in charts::by_angle(cases, &plots, "stress")? {
        page.figure(&file, &caption)?;
    }
    for (file, caption) in charts::histories(cases, &plots, ".s1")? {
        page.figure(&file, &caption)?;
    }
    page.section("Displacement");
    page.paragraph(
        "Greatest displacement of the points relative to the middles of the floors (mm); its \
         direction is any.",
    );
    page.table(&tables::peaks(cases, |outcome| &outcome.relative, 1e3));
    for (file, caption) in charts::by_angle(cases, &plots, "relative")? {
        page.figure(&file, &caption)?;
    }
    page.paragraph("Greatest displacement itself (mm).");
    page.table(&tables::peaks(cases, |outcome| &outcome.displacements, 1e3));
    for (file, caption) in charts::histories(cases, &plots, ".ux")? {
        page.figure(&file, &caption)?;
    }
    page.section("Damage");
    page.table(&tables::damage(cases));
    page.pictures(cases, |_| {
        ["structure-damage.png", "structure-stress.png"]
            .map(str::to_owned)
            .to_vec()
    })?;
    page.section("Joint");
    page.table(&tables::joints(cases));
    page.pictures(cases, |outcome| {
        let joints = outcome.joints.iter();
        let pictures = |what: &'static str| joints.clone().map(move |joint| (joint, what));
        let pictures = pictures("state").chain(pictures("bond"));
        pictures
            .map(|(joint, what)| format!("joint-{}-{what}.png", joint.name))
            .collect()
    })?;
    page.section("Bolts");
    page.paragraph("Greatest axial force at the end (kN).");
    page.table(&tables::peaks(cases, |outcome| &outcome.bolts, 1e-3));
    page.section("Against the paper");
    page.paragraph(paper::ABOUT);
    page.table(&paper::conclusions(cases));
    page.section("Energy");
    page.paragraph(
        "The ledger of each case: what came in, what is held, what was dissipated and where. The \
         residual is what does not add up.",
    );
    for case in cases {
        let file = case.folder.join("plots/energies.svg");
        if file.exists() {
            page.figure(&file, &case.outcome.name)?;
        }
    }
    page.section("The scene");
    page.paragraph("As it was run; mesh and records are the files that it names.");
    page.file(&cases[0].folder.join("scene.toml"))?;
    Ok(page)
}

/// The records of a sweep: time and acceleration.
fn records(folder: &Path) -> Vec<Vec<TableColumn>> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut files: Vec<PathBuf> = entries
        .map(|entry| entry.path())
        .filter(|path| {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            name.starts_with(RECORD) && name.ends_with(".csv")
        })
        .collect();
    files.sort();
    let tables = files.iter().filter_map(|file| read_table(file).ok());
    tables.filter(|table| table.len() == 2).collect()
}
