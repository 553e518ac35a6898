//! The page of a sweep.

use std::path::{Path, PathBuf};

use powerhouse::file_name;
use powerhouse::io::{TableColumn, read_table};

use super::page::Page;
use super::spectra::FloorSpectra;
use super::{CaseFiles, PLOTS, charts, forces, fourier, paper, tables};
use crate::StudyError;
use crate::rounded::rounded;
use crate::sweep::{CaseOutcome, RECORD};
use crate::{conclusions, sensitivity};

/// What a sweep has to show.
struct Sweep<'s> {
    folder: &'s Path,
    cases: &'s [CaseFiles],
    outcomes: Vec<CaseOutcome>,
    /// Where its plots go.
    plots: PathBuf,
}

/// The page of a sweep of which some cases are finished.
pub(super) fn page(folder: &Path, cases: &[CaseFiles]) -> Result<Page, StudyError> {
    let title = cases[0].summary["title"].as_str().unwrap_or("sweep");
    let title = title.rsplit_once(": ").map_or(title, |(scene, _)| scene);
    let mut page = Page::new(title);
    let sweep = Sweep {
        folder,
        cases,
        outcomes: cases.iter().map(|case| case.outcome.clone()).collect(),
        plots: folder.join(PLOTS),
    };
    sweep.runs(&mut page);
    sweep.input(&mut page)?;
    sweep.findings(&mut page);
    sweep.stress(&mut page)?;
    sweep.displacement(&mut page)?;
    sweep.damage(&mut page)?;
    sweep.joint(&mut page)?;
    sweep.sections(&mut page)?;
    sweep.floors(&mut page)?;
    sweep.bolts(&mut page);
    sweep.energy(&mut page)?;
    page.section("The scene");
    page.paragraph("As it was run; mesh and records are the files that it names.");
    page.file(&cases[0].folder.join("scene.toml"))?;
    Ok(page)
}

impl Sweep<'_> {
    /// The case that is shown where there is room for one: that of an SV wave at 30 degrees, the first
    /// one that varies nothing, or the first.
    fn headline(&self) -> &CaseFiles {
        let mut plain = self.cases.iter().filter(|case| case.is_plain());
        let is_headline = |case: &&CaseFiles| case.outcome.input.wave() == Some(("sv", 30.0));
        let found = plain.clone().find(is_headline).or(plain.next());
        found.unwrap_or(&self.cases[0])
    }

    fn runs(&self, page: &mut Page) {
        page.section("Cases");
        let summaries: Vec<_> = self.cases.iter().map(|case| &case.summary).collect();
        page.paragraph(&tables::repetition(&summaries));
        page.table(&tables::cases(self.cases));
        if let Some(stages) = tables::stages(self.cases) {
            page.section("Before the earthquake");
            page.paragraph("What the stages came to, once for the cases that share them.");
            page.table(&stages);
        }
    }

    fn input(&self, page: &mut Page) -> Result<(), StudyError> {
        page.section("Input");
        for record in self.records() {
            if let Some([time, spectrum]) = fourier::plots(&record, &self.plots)? {
                page.figure(&time, "Acceleration of the record as it enters the waves")?;
                page.figure(&spectrum, "Its Fourier amplitude")?;
            }
        }
        Ok(())
    }

    fn findings(&self, page: &mut Page) {
        page.section("Against the paper");
        page.paragraph(paper::CONCLUSIONS);
        page.table(&paper::conclusions(&conclusions(&self.outcomes)));
        if let Some(figures) = paper::figures(self.cases) {
            page.paragraph(paper::FIGURES);
            page.table(&figures);
        }
        if let Some(table) = tables::sensitivity(&sensitivity(&self.outcomes)) {
            page.section("What single choices do");
            page.paragraph(
                "Cases that differ by one choice from the first case of the same waves that varies \
                 nothing, with the change of each figure.",
            );
            page.table(&table);
        }
    }

    fn stress(&self, page: &mut Page) -> Result<(), StudyError> {
        page.section("Principal stress");
        page.paragraph(
            "Greatest principal stress over the motion behind each monitoring point (MPa).",
        );
        let stresses = tables::peaks(self.cases, |outcome| &outcome.stresses, 1e-6);
        page.table(&stresses);
        page.figures(charts::by_angle(self.cases, &self.plots, "stress")?)?;
        page.figures(charts::histories(self.cases, &self.plots, ".s1")?)
    }

    fn displacement(&self, page: &mut Page) -> Result<(), StudyError> {
        page.section("Displacement");
        page.paragraph(
            "Greatest displacement of the points relative to the middles of the floors (mm); its \
             direction is any.",
        );
        page.table(&tables::peaks(self.cases, |outcome| &outcome.relative, 1e3));
        page.figures(charts::by_angle(self.cases, &self.plots, "relative")?)?;
        if (self.outcomes.iter()).any(|outcome| !outcome.ground.is_empty()) {
            page.paragraph(
                "The same of the ground alone, as the waves move it where there are no caverns (mm): \
                 what is more than this, caverns and structure make.",
            );
            page.table(&tables::peaks(self.cases, |outcome| &outcome.ground, 1e3));
        }
        page.paragraph("Greatest displacement itself (mm).");
        let displacements = tables::peaks(self.cases, |outcome| &outcome.displacements, 1e3);
        page.table(&displacements);
        for component in [".ux", ".uy", ".uz"] {
            page.figures(charts::histories(self.cases, &self.plots, component)?)?;
        }
        Ok(())
    }

    fn damage(&self, page: &mut Page) -> Result<(), StudyError> {
        page.section("Damage");
        page.table(&tables::damage(self.cases));
        if self
            .outcomes
            .iter()
            .any(|outcome| !outcome.parts.is_empty())
        {
            page.paragraph("Over the volume of the structure, its lining and its interior.");
            page.table(&tables::mean_damage(self.cases));
            page.paragraph("Part by part; a part may belong to another one.");
            for outcome in self.outcomes.iter().filter(|found| !found.parts.is_empty()) {
                page.folded(&outcome.name, &tables::parts(outcome));
            }
        }
        page.pictures(self.cases, |_| {
            ["damage", "damage-type", "stress"]
                .map(|what| format!("structure-{what}.png"))
                .to_vec()
        })
    }

    fn joint(&self, page: &mut Page) -> Result<(), StudyError> {
        if self
            .outcomes
            .iter()
            .all(|outcome| outcome.joints.is_empty())
        {
            return Ok(());
        }
        page.section("Joint");
        page.table(&tables::joints(self.cases, |outcome| &outcome.joints));
        if self
            .outcomes
            .iter()
            .any(|outcome| !outcome.joint_parts.is_empty())
        {
            let parts = tables::joints(self.cases, |outcome| &outcome.joint_parts);
            page.folded("parts of the joint", &parts);
        }
        page.pictures(self.cases, |outcome| {
            let joints = outcome.joints.iter();
            let pictures = |what: &'static str| joints.clone().map(move |joint| (joint, what));
            let pictures = pictures("over-the-run").chain(pictures("bond"));
            pictures
                .map(|(joint, what)| format!("joint-{}-{what}.png", file_name(&joint.name)))
                .collect()
        })
    }

    fn sections(&self, page: &mut Page) -> Result<(), StudyError> {
        let mut tables = Vec::new();
        for case in self.cases {
            if let Some(table) = forces::table(case)? {
                tables.push((&case.outcome.name, table));
            }
        }
        if tables.is_empty() {
            return Ok(());
        }
        page.section("Section forces");
        page.paragraph(
            "Normal force N (tension positive), shear force Q and bending moment M of cuts through \
             linings and floors, per metre along the halls, what the stages left included: at rest, and \
             the least and greatest of the motion with their times.",
        );
        let headline = &self.headline().outcome.name;
        for (name, table) in &tables {
            if *name == headline {
                page.paragraph(&format!("Case {name}:"));
                page.table(table);
            }
        }
        for (name, table) in tables.iter().filter(|(name, _)| *name != headline) {
            page.folded(name, table);
        }
        Ok(())
    }

    fn floors(&self, page: &mut Page) -> Result<(), StudyError> {
        let spectra = FloorSpectra::of(self.cases);
        if spectra.is_empty() {
            return Ok(());
        }
        page.section("Floor response spectra");
        page.paragraph(&format!(
            "What equipment on the floors feels: the greatest absolute acceleration of an oscillator \
             against its period, from {} s on, of which the samples of the run still tell. Spectra at 2, 5 \
             and 10 % of critical damping of every case stand in report/floor-spectra-CASE.csv; a direction \
             in which a floor hardly moves is left out.",
            rounded(spectra.shortest())
        ));
        let headline = &self.headline().outcome.name;
        page.paragraph(&format!("Case {headline}:"));
        page.table(&spectra.table(headline));
        for outcome in &self.outcomes {
            let name = &outcome.name;
            spectra.write(&self.plots, name)?;
            if name != headline {
                page.folded(name, &spectra.table(name));
            }
        }
        let plots = spectra.plots(self.cases, headline, &self.plots)?;
        page.figures(plots)
    }

    fn bolts(&self, page: &mut Page) {
        if self
            .outcomes
            .iter()
            .any(|outcome| !outcome.bolts.is_empty())
        {
            page.section("Bolts");
            page.paragraph("The greatest axial force of any bolt of each make.");
            page.table(&tables::bolts(self.cases));
        }
    }

    fn energy(&self, page: &mut Page) -> Result<(), StudyError> {
        page.section("Energy");
        page.paragraph(
            "The ledger of each case at its end (J): what came in, what is held, what was dissipated and \
             where. The residual is what does not add up.",
        );
        page.table(&tables::energies(self.cases));
        let headline = self.headline();
        let file = headline.folder.join("plots/energies.svg");
        if file.exists() {
            page.figure(&file, &format!("Energies, case {}", headline.outcome.name))?;
        }
        Ok(())
    }

    /// The records of the sweep: time and acceleration.
    fn records(&self) -> Vec<Vec<TableColumn>> {
        let entries = std::fs::read_dir(self.folder).into_iter().flatten();
        let mut files: Vec<PathBuf> = entries
            .flatten()
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
}
