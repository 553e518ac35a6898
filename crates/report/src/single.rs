//! Report page of a single run.

use std::path::{Path, PathBuf};

use powerhouse::{ResultFolder, Topic};

use super::ReportTable;
use super::page::Page;
use super::run_warnings::RunWarnings;
use super::{forces, motions, report_gaps, tables};
use powerhouse_study::StudyError;
use powerhouse_study::internal::FoundSummary;
use powerhouse_study::internal::after_first_slip;
use powerhouse_study::internal::rounded;

/// Greatest size of a picture on the page (bytes).
const LARGEST: u64 = 4 << 20;

/// Topics of the peaks and of plots and pictures.
const OF_RESULTS: [Topic; 3] = [Topic::Histories, Topic::Sections, Topic::Joints];

/// The report page of a result folder.
pub(super) fn page(folder: &Path) -> Result<Page, StudyError> {
    let Some(found) = FoundSummary::read(folder)? else {
        let folder = folder.into();
        return Err(StudyError::NoResults { folder });
    };
    let mut page = Page::new(found.title());
    page.section("Run");
    page.warnings(&report_gaps(folder)?);
    let summary = found.whole();
    let warnings = RunWarnings::of(summary.map(|summary| ("", summary)));
    page.warnings(&warnings.about(&[]));
    let row = |name: &str, value: String| vec![name.to_owned(), value];
    let mut rows = vec![row("ended", found.ended().to_owned())];
    rows.extend(found.failure().map(|why| row("why", why.to_owned())));
    if let Some(summary) = summary {
        page.paragraph(&tables::repetition(&[summary]));
        rows.splice(
            0..0,
            [
                row("steps", summary.steps.to_string()),
                row("step (s)", rounded(summary.step)),
            ],
        );
        rows.push(row("end (s)", rounded(summary.end_time)));
        rows.push(row("wall time (s)", rounded(summary.wall_time)));
    }
    page.table(&ReportTable {
        header: vec!["".into(), "".into()],
        rows,
    });
    let facts = summary.iter().flat_map(|summary| &summary.remarks);
    let facts: Vec<Vec<String>> = (facts.enumerate())
        .map(|(number, fact)| vec![(number + 1).to_string(), fact.clone()])
        .collect();
    if !facts.is_empty() {
        page.section("Remarks");
        page.table(&ReportTable {
            header: vec![String::new(), "about the input and the computation".into()],
            rows: facts,
        });
    }
    page.section("Peaks");
    page.warnings(&warnings.about(&OF_RESULTS));
    let joints = summary.iter().flat_map(|summary| &summary.joints);
    let firsts = joints.flat_map(|joint| [joint.first_slip, joint.first_crack]);
    if let Some(after) = after_first_slip(firsts.flatten()) {
        page.paragraph(&format!("The {after}."));
    }
    let peaks = summary.iter().flat_map(|summary| &summary.peaks);
    let rows = peaks.map(|peak| {
        let (value, time) = if peak.below_rounding {
            ("0, below rounding".into(), String::new())
        } else {
            (rounded(peak.value), rounded(peak.time))
        };
        vec![peak.name.clone(), value, peak.unit.clone(), time]
    });
    page.table(&ReportTable {
        header: ["name", "value", "unit", "time (s)"]
            .map(str::to_owned)
            .to_vec(),
        rows: rows.collect(),
    });
    let fibres = summary.and_then(|summary| summary.fibres.as_ref());
    let fibres = fibres.map(|fibres| format!("Fibres: {}.", fibres.text()));
    motions::section(&mut page, folder, &warnings.about(&[Topic::Histories]))?;
    if let Some(text) = &fibres {
        page.paragraph(text);
    }
    if let Some(table) = forces::table(folder)? {
        page.section("Section forces");
        page.warnings(&warnings.about(&[Topic::Sections]));
        if let Some(text) = &fibres {
            page.paragraph(text);
        }
        page.paragraph(forces::MEANING);
        page.table(&table);
        let uses = summary.and_then(|summary| forces::utilisation(&summary.section_uses));
        if let Some(uses) = uses {
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
            page.warnings(&warnings.about(&OF_RESULTS));
        }
        for file in files {
            let name = file
                .file_stem()
                .unwrap_or_default()
                .to_string_lossy()
                .into_owned();
            // An animation may be larger than all the rest of the page.
            if file.metadata().is_ok_and(|file| file.len() > LARGEST) {
                page.paragraph(&format!(
                    "`{below}/{name}.{end}` is too large for this page."
                ))
            } else {
                page.figure(&file, &name)?
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
