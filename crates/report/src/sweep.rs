//! Report page of a sweep.

use std::path::{Path, PathBuf};

use powerhouse::io::{TableColumn, read_table};
use powerhouse::{ResultFolder, Topic, file_name};

use super::page::Page;
use super::run_warnings::RunWarnings;
use super::spectra::FloorSpectra;
use super::{
    PLOTS, ReportCase, ReportItem, ReportSection, ReportTable, charts, forces, fourier, repetition,
    report_gaps, statistics, tables,
};
use crate::sensitivity;
use powerhouse_study::StudyError;
use powerhouse_study::convergence::ConvergenceReport;
use powerhouse_study::internal::read_report;
use powerhouse_study::internal::rounded;
use powerhouse_study::internal::{RECORD, STATISTICS};
use powerhouse_study::sweep::{CaseOutcome, SetStatistics};

/// Results of a sweep for its report.
struct Sweep<'s> {
    folder: &'s Path,
    cases: &'s [ReportCase],
    outcomes: Vec<CaseOutcome>,
    /// Folder of the plots.
    plots: PathBuf,
}

/// The report page of the finished cases of a sweep.
pub(super) fn page(
    folder: &Path,
    cases: &[ReportCase],
    sections: &[&dyn ReportSection],
) -> Result<Page, StudyError> {
    let title = (cases[0].summary.as_ref()).map_or("sweep", |summary| &summary.title);
    let title = title.rsplit_once(": ").map_or(title, |(scene, _)| scene);
    let mut page = Page::new(title);
    let sweep = Sweep {
        folder,
        cases,
        outcomes: cases.iter().map(|case| case.outcome.clone()).collect(),
        plots: folder.join(PLOTS),
    };
    sweep.runs(&mut page)?;
    sweep.input(&mut page)?;
    let mut has_results = true;
    for section in sections {
        let items = section.items(cases);
        if !items.is_empty() {
            sweep.further(&mut page, section.title(), items);
            has_results &= !section.replaces_results();
        }
    }
    sweep.sensitivity(&mut page);
    sweep.statistics(&mut page)?;
    sweep.convergence(&mut page)?;
    if has_results {
        sweep.results(&mut page)?;
    }
    sweep.stress(&mut page)?;
    sweep.displacement(&mut page)?;
    sweep.damage(&mut page)?;
    sweep.joint(&mut page)?;
    sweep.sections(&mut page)?;
    sweep.floors(&mut page)?;
    sweep.bolts(&mut page);
    sweep.energy(&mut page)?;
    page.section("The scene");
    page.paragraph("The scene as it was run; mesh and records are the files that it names.");
    page.file(&ResultFolder::new(&cases[0].folder).scene())?;
    Ok(page)
}

impl Sweep<'_> {
    /// The case that is shown where only one is shown: that of an SV wave at 30 degrees, else the first unvaried one, else
    /// the first.
    fn headline(&self) -> &ReportCase {
        let mut plain = self.cases.iter().filter(|case| case.is_plain());
        let is_headline = |case: &&ReportCase| case.outcome.input.wave() == Some(("sv", 30.0));
        let found = plain.clone().find(is_headline).or(plain.next());
        found.unwrap_or(&self.cases[0])
    }

    /// Adds the warnings of the cases about some topics; about all topics for an empty list.
    fn warnings(&self, page: &mut Page, topics: &[Topic]) {
        page.warnings(&RunWarnings::of_cases(self.cases).about(topics));
    }

    /// Adds the peaks and histories of a general scene.
    fn results(&self, page: &mut Page) -> Result<(), StudyError> {
        page.section("Peaks");
        self.warnings(page, &[Topic::Histories]);
        page.table(&tables::all_peaks(self.cases));
        page.section("Histories");
        self.warnings(page, &[Topic::Histories]);
        page.figures(charts::all_histories(self.cases, &self.plots)?)?;
        page.section("Pictures");
        page.pictures(self.cases, |_| {
            let names = [
                "largest-displacement",
                "largest-velocity",
                "largest-acceleration",
            ]
            .into_iter()
            .chain(["greatest-principal-stress", "least-principal-stress"])
            .chain(["equivalent_plastic_strain", "damage", "damage_tension"]);
            names.map(|name| format!("{name}.png")).collect()
        })
    }

    fn runs(&self, page: &mut Page) -> Result<(), StudyError> {
        page.section("Cases");
        page.warnings(&report_gaps(self.folder)?);
        self.warnings(page, &[]);
        let summaries = self.cases.iter().filter_map(|case| case.summary.as_ref());
        let summaries: Vec<_> = summaries.collect();
        page.paragraph(&tables::repetition(&summaries));
        page.table(&tables::cases(self.cases));
        if let Some(stages) = tables::stages(self.cases) {
            page.section("Before the earthquake");
            page.paragraph(
                "Results of the construction stages, once for all cases that share them.",
            );
            page.table(&stages);
        }
        Ok(())
    }

    fn input(&self, page: &mut Page) -> Result<(), StudyError> {
        page.section("Input");
        self.warnings(page, &[Topic::Input]);
        for record in self.records() {
            let coverages = self
                .outcomes
                .iter()
                .filter_map(|case| case.coverage.as_ref());
            let own = coverages.filter(|coverage| coverage.record == record[1].name);
            let end = own.map(|coverage| coverage.end).reduce(f64::max);
            if let Some([time, spectrum]) = fourier::plots(&record, end, &self.plots)? {
                page.figure(&time, "Acceleration of the record as used by the waves")?;
                page.figure(&spectrum, "Fourier amplitude spectrum of the record")?;
            }
        }
        Ok(())
    }

    /// Adds a section that is not one of all reports.
    fn further(&self, page: &mut Page, title: &str, items: Vec<ReportItem>) {
        page.section(title);
        self.warnings(page, &[Topic::Input]);
        for item in items {
            match item {
                ReportItem::Paragraph(text) => page.paragraph(&text),
                ReportItem::Table(table) => page.table(&table),
            }
        }
    }

    fn sensitivity(&self, page: &mut Page) {
        if let Some(table) = tables::sensitivity(&sensitivity(&self.outcomes)) {
            page.section("Sensitivity to single parameters");
            page.paragraph(
                "Cases that differ in one parameter from the first unvaried case with the same waves, with \
                 the change of each result.",
            );
            page.table(&table);
        }
    }

    /// Adds the statistics over a set of records, if the sweep is of one.
    fn statistics(&self, page: &mut Page) -> Result<(), StudyError> {
        let file = self.folder.join(STATISTICS);
        if !file.exists() {
            return Ok(());
        }
        let found = SetStatistics::read(&file)?;
        page.section("Statistics over the records");
        page.paragraph(&format!(
            "Fractiles of the results over the records of the set '{}': of the values in rising order those at 16, 50 and 84 % \
             of the way from the first to the last.",
            found.set
        ));
        for scale in &found.scales {
            let heading = statistics::heading(scale);
            page.warnings(statistics::missing(scale).as_slice());
            if scale.scale == found.scales[0].scale {
                page.paragraph(&heading);
                page.table(&statistics::figures(scale));
            } else {
                page.folded(&heading, &statistics::figures(scale));
            }
        }
        if let Some(table) = statistics::envelopes(&found) {
            page.paragraph(
                "Envelopes over all records of the forces of each section (kN/m, kN m/m), of rings section by section.",
            );
            page.table(&table);
        }
        if !found.fragility.is_empty() {
            page.paragraph(
                "Fragility curves: lognormal distributions of the greatest binomial likelihood (Baker 2015), with intervals of \
                 95 % confidence by the expected information at the estimate, too narrow for few runs.",
            );
            page.table(&statistics::fragility(&found));
            page.figures(statistics::curves(&found, &self.plots)?)?;
        }
        Ok(())
    }

    /// Adds the results of a convergence study, if the sweep is of one.
    fn convergence(&self, page: &mut Page) -> Result<(), StudyError> {
        let Some(found) = read_report(self.folder)? else {
            return Ok(());
        };
        page.section("Convergence");
        page.paragraph(
            "Results on several meshes, the coarsest first, extrapolated to vanishing element size. The error band is half its width \
             around the value of the finest mesh, over that value; the scatter is the largest change of a value under \
             waves larger by 1e-6.",
        );
        page.warnings(&found.limits());
        let of = |negligible: bool| {
            let figures = found.figures.iter();
            let figures = figures.filter(move |figure| figure.negligible == negligible);
            let rows: Vec<_> = figures.map(ConvergenceReport::cells).collect();
            ReportTable {
                header: found.header(),
                rows,
            }
        };
        page.table(&of(false));
        let others = of(true);
        if !others.rows.is_empty() {
            page.folded(
                "Results below a thousandth of the largest of their kind",
                &others,
            );
        }
        Ok(())
    }

    fn stress(&self, page: &mut Page) -> Result<(), StudyError> {
        if (self.outcomes.iter()).all(|outcome| outcome.stresses.is_empty()) {
            return Ok(());
        }
        page.section("Principal stress");
        self.warnings(page, &[Topic::Histories]);
        page.paragraph("Greatest principal stress over time of each stress history (MPa).");
        let stresses = tables::peaks(self.cases, |outcome| &outcome.stresses, 1e-6);
        page.table(&stresses);
        page.figures(charts::by_angle(self.cases, &self.plots, "stress")?)?;
        page.figures(charts::histories(self.cases, &self.plots, ".s1")?)
    }

    fn displacement(&self, page: &mut Page) -> Result<(), StudyError> {
        let (relative, own) = (
            (self.outcomes.iter()).any(|outcome| !outcome.relative.is_empty()),
            (self.outcomes.iter()).any(|outcome| !outcome.displacements.is_empty()),
        );
        if !relative && !own {
            return Ok(());
        }
        page.section("Displacement");
        self.warnings(page, &[Topic::Histories]);
        if relative {
            page.paragraph("Greatest norm of the relative displacement (mm).");
            page.table(&tables::peaks(self.cases, |outcome| &outcome.relative, 1e3));
            page.figures(charts::by_angle(self.cases, &self.plots, "relative")?)?;
        }
        if (self.outcomes.iter()).any(|outcome| !outcome.ground.is_empty()) {
            page.paragraph(
                "The same in the free field, without caverns (mm); the difference is due to caverns and \
                 structure.",
            );
            page.table(&tables::peaks(self.cases, |outcome| &outcome.ground, 1e3));
        }
        page.paragraph("Greatest norm of the absolute displacement (mm).");
        let displacements = tables::peaks(self.cases, |outcome| &outcome.displacements, 1e3);
        page.table(&displacements);
        for component in [".ux", ".uy", ".uz"] {
            page.figures(charts::histories(self.cases, &self.plots, component)?)?;
        }
        Ok(())
    }

    fn damage(&self, page: &mut Page) -> Result<(), StudyError> {
        if (self.outcomes.iter()).all(|outcome| outcome.damage.is_empty()) {
            return Ok(());
        }
        page.section("Damage");
        page.table(&tables::damage(self.cases));
        if self
            .outcomes
            .iter()
            .any(|outcome| !outcome.parts.is_empty())
        {
            page.paragraph("Damage over the volume of the structure, its lining and its interior.");
            page.table(&tables::mean_damage(self.cases));
            page.paragraph("Damage of each part; parts may overlap.");
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
        self.warnings(page, &[Topic::Joints]);
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
            if let Some(table) = forces::table(&case.folder)? {
                tables.push((&case.outcome.name, table));
            }
        }
        if tables.is_empty() {
            return Ok(());
        }
        page.section("Section forces");
        self.warnings(page, &[Topic::Sections]);
        page.paragraph(
            "Normal force N (tension positive), shear force Q and bending moment M of sections through \
             linings and floors, per metre along the halls, including the static forces of the stages: the \
             static values, and the least and greatest values of the motion with their times.",
        );
        if self.cases.len() > 1
            && let Some(table) = forces::of_cases(&self.outcomes)
        {
            page.paragraph(
                "Extremes over the run (kN/m, kN m/m), of a ring over all its sections; single sections by case below.",
            );
            page.table(&table);
        }
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
        self.warnings(page, &[Topic::Histories]);
        let unknown = repetition::unknown(self.cases);
        page.warnings(unknown.as_slice());
        page.paragraph(&format!(
            "Peak absolute acceleration of an oscillator on the floor against its period, from {} s, the \
             shortest period that the samples of the run resolve, {}. The peak of a floor is what an oscillator of 33 Hz \
             bears, or the stiffest that is resolved: the greatest instant where bodies hit each other depends on mesh and \
             step. The spectra of every case at 2, 5 and 10 % of critical damping are in report/floor-spectra-CASE.csv; \
             directions in which a floor hardly moves are left out.",
            rounded(spectra.shortest()),
            self.headline().accelerations.note(),
        ));
        let headline = &self.headline().outcome.name;
        let with_note = |name: &str| match repetition::of(self.cases, name) {
            Some(note) => format!("{name} ({note})"),
            None => name.to_owned(),
        };
        page.paragraph(&format!("Case {}:", with_note(headline)));
        page.table(&spectra.table(headline));
        for case in self.cases {
            let name = &case.outcome.name;
            spectra.write(&self.plots, case, repetition::of(self.cases, name))?;
            if name != headline {
                page.folded(&with_note(name), &spectra.table(name));
            }
        }
        let plots = spectra.plots(self.cases, headline, &self.plots)?;
        page.figures(plots)?;
        page.paragraph(
            "For what a floor carries, the greatest of all cases over frequency, with peaks broadened by 15 % to both sides, is in \
             report/floor-spectra-broadened.csv. It covers no other mesh than that of the cases.",
        );
        let notes = (self.cases.iter())
            .map(|case| format!("case {}: {}", case.outcome.name, case.accelerations.note()));
        let notes: Vec<String> = notes.chain(unknown).collect();
        page.figures(spectra.write_envelope(&self.plots, &notes)?)
    }

    fn bolts(&self, page: &mut Page) {
        if self
            .outcomes
            .iter()
            .any(|outcome| !outcome.bolts.is_empty())
        {
            page.section("Bolts");
            page.paragraph("Greatest axial force among the bolts of each type.");
            page.table(&tables::bolts(self.cases));
        }
    }

    fn energy(&self, page: &mut Page) -> Result<(), StudyError> {
        page.section("Energy");
        self.warnings(page, &[Topic::Energy]);
        page.paragraph(
            "Energy balance of each case at its end (J): external work, stored energies and dissipation. The \
             residual is the imbalance.",
        );
        page.table(&tables::energies(self.cases));
        let headline = self.headline();
        let file = headline.folder.join("plots/energies.svg");
        if file.exists() {
            page.figure(&file, &format!("Energies, case {}", headline.outcome.name))?;
        }
        Ok(())
    }

    /// The record files of the sweep: time and acceleration.
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
