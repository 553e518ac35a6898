//! Statistics of the results of a sweep over a set of records.

use core::fmt;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use powerhouse::io::csv_cell;
use powerhouse::spec::{FragilityCurve, RecordCase};
use serde::{Deserialize, Serialize};

use super::{CaseOutcome, SectionExtremes, SetSpectra, table, write_text};
use crate::StudyError;
use crate::fragility::{LognormalFragility, Stripe};
use crate::json::read_json;
use crate::rounded::rounded;

/// Statistics of the cases of a set of records, as stored in `statistics.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SetStatistics {
    /// Name of the set.
    pub set: String,
    /// Statistics over the records at each scale, from the least scale to the greatest.
    pub scales: Vec<ScaleStatistics>,
    /// Fragility curves that the set requests.
    pub fragility: Vec<FragilityResult>,
    /// Response spectra of the records; none of statistics that were written before they had them.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub spectra: Option<SetSpectra>,
}

/// Statistics over the records of a set at one scale.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ScaleStatistics {
    /// Factor on the records.
    pub scale: f64,
    /// Number of finished cases.
    pub finished: usize,
    /// Their names; none in statistics that were written before they had them.
    #[serde(default)]
    pub cases: Vec<String>,
    /// Names of the cases without results: failed, interrupted, or not run.
    pub missing: Vec<String>,
    /// Fractiles of each result of the cases.
    pub figures: Vec<FigureStatistics>,
    /// Envelope of the forces of each section over all records: of single sections, and of those of rings.
    pub envelopes: Vec<SectionEnvelope>,
}

/// Fractiles of a result over records: of the values in rising order those at 0.16, 0.5 and 0.84 of the way from the first to the
/// last, on straight lines between them (Hyndman and Fan 1996, definition 7). `None` for one without bound, as a utilisation
/// where no moment is borne.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FigureStatistics {
    /// Name of the result with its unit, as the column of `sweep.csv`.
    pub figure: String,
    /// Number of cases that have it.
    pub count: usize,
    /// 16 % fractile.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub low: Option<f64>,
    /// Median.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub median: Option<f64>,
    /// 84 % fractile.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub high: Option<f64>,
}

/// Least and greatest forces per metre of a section over the runs of all records.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SectionEnvelope {
    /// Name of the section.
    pub section: String,
    /// Least and greatest normal force (N/m, tension positive).
    pub axial: [f64; 2],
    /// Least and greatest shear force (N/m).
    pub shear: [f64; 2],
    /// Least and greatest bending moment (N m/m).
    pub moment: [f64; 2],
}

/// Fragility of a set of records for one limit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FragilityResult {
    /// Name of the curve.
    pub name: String,
    /// Name of the result with its unit, as the column of `sweep.csv`.
    pub figure: String,
    /// Limit in this unit: exceeded by greater results, or, of a limit below 0, by lesser ones.
    pub limit: f64,
    /// Measure of intensity with its unit.
    pub measure: String,
    /// Finished cases by rising intensity.
    pub runs: Vec<FragilityRun>,
    /// The curve; `None` where the runs determine none.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub curve: Option<LognormalFragility>,
    /// Why there is no curve.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub refused: Option<String>,
}

/// Case of a fragility.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FragilityRun {
    /// Name of the case.
    pub case: String,
    /// Intensity of its scaled record, in the unit of the measure.
    pub intensity: f64,
    /// Whether its result exceeds the limit.
    pub exceeds: bool,
}

impl SetStatistics {
    /// Statistics of the finished cases of a set; `intensity` is that of a case by the measure of a curve, by its index.
    pub(super) fn of(
        (set, curves): (&str, &[FragilityCurve]),
        spectra: Option<SetSpectra>,
        cases: &[RecordCase],
        outcomes: &[CaseOutcome],
        intensity: impl Fn(&RecordCase, usize) -> Option<f64>,
    ) -> Self {
        let mut scales: Vec<f64> = cases.iter().map(|case| case.scale).collect();
        scales.sort_by(f64::total_cmp);
        scales.dedup();
        let outcome = |case: &RecordCase| outcomes.iter().find(|outcome| outcome.name == case.case);
        let at = |scale: f64| {
            let own = || cases.iter().filter(move |case| case.scale == scale);
            let finished: Vec<&CaseOutcome> = own().filter_map(outcome).collect();
            let missing = own().filter(|case| outcome(case).is_none());
            ScaleStatistics {
                scale,
                finished: finished.len(),
                cases: finished.iter().map(|of| of.name.clone()).collect(),
                missing: missing.map(|case| case.case.clone()).collect(),
                figures: figures(&finished),
                envelopes: envelopes(&finished),
            }
        };
        let finished = cases.iter().filter_map(|case| Some((case, outcome(case)?)));
        let finished: Vec<(&RecordCase, &CaseOutcome)> = finished.collect();
        let fragility = curves.iter().enumerate().map(|(index, curve)| {
            FragilityResult::of(curve, &finished, |case| intensity(case, index))
        });
        Self {
            set: set.into(),
            fragility: fragility.collect(),
            scales: scales.into_iter().map(at).collect(),
            spectra,
        }
    }

    /// Reads statistics from their JSON file.
    ///
    /// # Errors
    /// [`StudyError::Read`], [`StudyError::Outcome`].
    pub fn read(file: &Path) -> Result<Self, StudyError> {
        read_json(file)
    }

    /// Writes the fractiles to a CSV table, one line for each scale and result.
    pub(super) fn write_figures(&self, file: &Path) -> Result<(), StudyError> {
        let mut text = String::from("scale,result,count,16 %,median,84 %\n");
        for scale in &self.scales {
            for figure in &scale.figures {
                let fractiles = [figure.low, figure.median, figure.high];
                let [low, median, high] = fractiles.map(|value| value.unwrap_or(f64::INFINITY));
                let (name, count) = (csv_cell(&figure.figure), figure.count);
                let _ = writeln!(
                    text,
                    "{},{name},{count},{low:e},{median:e},{high:e}",
                    scale.scale
                );
            }
        }
        write_text(file, &text)
    }

    /// Writes the envelopes of section forces to a CSV table, one line for each scale and section.
    pub(super) fn write_envelopes(&self, file: &Path) -> Result<(), StudyError> {
        let mut text = String::from("scale,section");
        for (force, unit) in [
            ("axial force", "N/m"),
            ("shear force", "N/m"),
            ("moment", "N m/m"),
        ] {
            let _ = write!(text, ",least {force} [{unit}],greatest {force} [{unit}]");
        }
        text.push('\n');
        for scale in &self.scales {
            for envelope in &scale.envelopes {
                let _ = write!(text, "{},{}", scale.scale, csv_cell(&envelope.section));
                for [least, greatest] in [envelope.axial, envelope.shear, envelope.moment] {
                    let _ = write!(text, ",{least:e},{greatest:e}");
                }
                text.push('\n');
            }
        }
        write_text(file, &text)
    }
}

/// Fractiles of all results of cases, in the order in which they appear.
fn figures(outcomes: &[&CaseOutcome]) -> Vec<FigureStatistics> {
    let mut names: Vec<String> = Vec::new();
    let mut values: BTreeMap<String, Vec<f64>> = BTreeMap::new();
    for (name, value) in outcomes.iter().flat_map(|outcome| table::figures(outcome)) {
        if !values.contains_key(&name) {
            names.push(name.clone());
        }
        values.entry(name).or_default().push(value);
    }
    let of = |name: String| {
        let mut sorted = values.remove(&name).unwrap_or_default();
        sorted.sort_by(f64::total_cmp);
        let at = |share: f64| Some(fractile(&sorted, share)).filter(|value| value.is_finite());
        FigureStatistics {
            figure: name,
            count: sorted.len(),
            low: at(0.16),
            median: at(0.5),
            high: at(0.84),
        }
    };
    names.into_iter().map(of).collect()
}

/// Fractile of values in rising order, of which there is one at least.
pub fn fractile(sorted: &[f64], share: f64) -> f64 {
    let place = share * (sorted.len() - 1) as f64;
    let [below, above] = [place.floor(), place.ceil()].map(|place| sorted[place as usize]);
    if below == above {
        below
    } else {
        below + (place - place.floor()) * (above - below)
    }
}

/// Envelopes of the forces of all single sections and of those of rings, in the order in which they appear.
fn envelopes(outcomes: &[&CaseOutcome]) -> Vec<SectionEnvelope> {
    let mut envelopes: Vec<SectionEnvelope> = Vec::new();
    let sections = outcomes.iter().flat_map(|outcome| &outcome.sections);
    let single = sections.flat_map(|section| match &section.around[..] {
        [] => std::slice::from_ref(section),
        around => around,
    });
    for section in single {
        let own = SectionEnvelope::of(section);
        let known = envelopes
            .iter_mut()
            .find(|known| known.section == own.section);
        match known {
            Some(known) => known.widen(&own),
            None => envelopes.push(own),
        }
    }
    envelopes
}

impl SectionEnvelope {
    fn of(section: &SectionExtremes) -> Self {
        let [axial, shear, moment] = [&section.axial, &section.shear, &section.moment]
            .map(|[least, greatest]| [least.value, greatest.value]);
        Self {
            section: section.name.clone(),
            axial,
            shear,
            moment,
        }
    }

    fn widen(&mut self, other: &Self) {
        for (own, other) in [
            (&mut self.axial, other.axial),
            (&mut self.shear, other.shear),
            (&mut self.moment, other.moment),
        ] {
            *own = [own[0].min(other[0]), own[1].max(other[1])];
        }
    }
}

/// Whether a name is that of a figure, with its unit in brackets or without.
fn is_named(figure: &str, name: &str) -> bool {
    let bare = figure.rsplit_once(" [").map(|(bare, _)| bare);
    figure == name || bare == Some(name)
}

impl FragilityResult {
    fn of(
        curve: &FragilityCurve,
        cases: &[(&RecordCase, &CaseOutcome)],
        intensity: impl Fn(&RecordCase) -> Option<f64>,
    ) -> Self {
        let limit = curve.limit.get();
        let mut known: Vec<String> = Vec::new();
        let mut runs = Vec::new();
        for (case, outcome) in cases {
            let figures = table::figures(outcome);
            let value = figures
                .iter()
                .find(|(name, _)| is_named(name, &curve.figure));
            if let (Some((_, value)), Some(intensity)) = (value, intensity(case)) {
                runs.push(FragilityRun {
                    case: case.case.clone(),
                    intensity,
                    exceeds: if limit < 0.0 {
                        *value < limit
                    } else {
                        *value > limit
                    },
                });
            }
            for (name, _) in figures {
                if !known.contains(&name) {
                    known.push(name);
                }
            }
        }
        runs.sort_by(|a, b| a.intensity.total_cmp(&b.intensity));
        let fitted = match (runs.is_empty(), known.is_empty()) {
            (true, false) => Err(format!(
                "no case has the result '{}', but: {}",
                curve.figure,
                known.join(", ")
            )),
            _ => LognormalFragility::fit(&stripes(&runs)).map_err(|error| error.to_string()),
        };
        let measure = match curve.period {
            None => "peak acceleration [m/s2]".to_owned(),
            Some(period) => format!("pseudo-acceleration at {} s, 5 % [m/s2]", period.get()),
        };
        Self {
            name: curve.name.to_string(),
            figure: curve.figure.clone(),
            limit,
            measure,
            runs,
            curve: fitted.as_ref().ok().copied(),
            refused: fitted.err(),
        }
    }

    /// Number of runs that exceed the limit.
    pub fn exceeded(&self) -> usize {
        self.runs.iter().filter(|run| run.exceeds).count()
    }
}

/// Runs of equal intensities together, which are in rising order.
fn stripes(runs: &[FragilityRun]) -> Vec<Stripe> {
    let mut stripes: Vec<Stripe> = Vec::new();
    for run in runs {
        let exceeded = u32::from(run.exceeds);
        match stripes.last_mut() {
            Some(last) if last.intensity == run.intensity => {
                last.count += 1;
                last.exceeded += exceeded;
            }
            _ => stripes.push(Stripe {
                intensity: run.intensity,
                count: 1,
                exceeded,
            }),
        }
    }
    stripes
}

impl FigureStatistics {
    /// The three fractiles as text with three significant digits, or that they have no bound.
    pub fn shown(&self) -> [String; 3] {
        let fractiles = [self.low, self.median, self.high];
        fractiles.map(|value| value.map_or("unbounded".into(), rounded))
    }
}

/// Tables of the fractiles at each scale, and the fragility curves, for a terminal.
impl fmt::Display for SetStatistics {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let fit = self.spectra.as_ref().map(ToString::to_string);
        if let Some(fit) = fit.filter(|fit| !fit.is_empty()) {
            writeln!(f, "{fit}")?;
        }
        for scale in &self.scales {
            let all = scale.finished + scale.missing.len();
            let finished = scale.finished;
            write!(
                f,
                "records '{}' at scale {}: {finished} of {all} cases",
                self.set, scale.scale
            )?;
            if !scale.missing.is_empty() {
                write!(f, "; without results: {}", scale.missing.join(", "))?;
            }
            let width = scale
                .figures
                .iter()
                .map(|figure| figure.figure.chars().count());
            let width = width.max().unwrap_or(0).max(6);
            if !scale.figures.is_empty() {
                let heads = ["16 %", "median", "84 %"];
                write!(f, "\n  {:width$}", "result")?;
                heads.iter().try_for_each(|head| write!(f, " {head:>10}"))?;
            }
            for figure in &scale.figures {
                write!(f, "\n  {:width$}", figure.figure)?;
                for value in figure.shown() {
                    write!(f, " {value:>10}")?;
                }
                if figure.count < finished {
                    write!(f, "  of {} cases", figure.count)?;
                }
            }
            writeln!(f)?;
        }
        self.fragility
            .iter()
            .try_for_each(|fragility| writeln!(f, "{fragility}"))
    }
}

impl fmt::Display for FragilityResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let side = if self.limit < 0.0 { "below" } else { "above" };
        write!(
            f,
            "fragility '{}', {} {side} {}, {} of {} cases: ",
            self.name,
            self.figure,
            rounded(self.limit),
            self.exceeded(),
            self.runs.len()
        )?;
        if let Some(refused) = &self.refused {
            return write!(f, "no curve, since {refused}");
        }
        let Some(curve) = &self.curve else {
            return Ok(());
        };
        let interval = |[low, high]: [f64; 2]| format!("{} to {}", rounded(low), rounded(high));
        write!(
            f,
            "median {} ({}), dispersion {} ({}) of the {}; intervals of 95 % by the expected information",
            rounded(curve.median),
            interval(curve.median_interval),
            rounded(curve.dispersion),
            interval(curve.dispersion_interval),
            self.measure
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Fractiles are those by hand, of one value, of several, and of values without bound.
    #[test]
    fn fractiles_are_those_by_hand() {
        for (sorted, share, expected) in [
            (&[4.0][..], 0.16, 4.0),
            (&[1.0, 2.0], 0.84, 1.84),
            (&[-3.0, 1.0, 2.0], 0.5, 1.0),
            (&[-3.0, 1.0, 2.0], 0.16, -3.0 + 0.32 * 4.0),
            (&[0.0, 10.0, 20.0, 40.0, 80.0], 0.84, 40.0 + 0.36 * 40.0),
            (&[1.0, 2.0, f64::INFINITY], 0.5, 2.0),
            (&[1.0, 2.0, f64::INFINITY], 0.84, f64::INFINITY),
            (&[f64::INFINITY, f64::INFINITY], 0.5, f64::INFINITY),
        ] {
            let found = fractile(sorted, share);
            assert!(
                found == expected || (found - expected).abs() < 1e-12,
                "{sorted:?}: {found}"
            );
        }
    }

    /// Outcome of a case with peaks of a displacement, and section forces between plus and minus a value: of a ring of two sections,
    /// of which the second has twice the force of the first, and of a single section, if there is one.
    fn outcome(name: &str, force: f64, single: Option<f64>, utilisation: &str) -> CaseOutcome {
        let section = |name: &str, force: f64, more: &str| {
            let range = |factor: f64| {
                let [low, high] = [-factor * force, factor * force]
                    .map(|value| format!(r#"{{ "name": "{name}", "value": {value}, "time": 0 }}"#));
                format!("[{low}, {high}]")
            };
            format!(
                r#"{{ "name": "{name}", "axial": {}, "shear": {}, "moment": {}{more} }}"#,
                range(1.0),
                range(0.5),
                range(0.1)
            )
        };
        let around = [
            section("ring-0", force, ""),
            section("ring-90", 2.0 * force, ""),
        ];
        let more = format!(
            r#", "utilisation": {utilisation}, "around": [{}]"#,
            around.join(",")
        );
        let mut sections = vec![section("ring", 2.0 * force, &more)];
        sections.extend(single.map(|force| section("cut", force, "")));
        let text = format!(
            r#"{{ "name": "{name}", "steps": 1, "step": 1, "end": 1, "wall_time": {force}, "energy_residual": 0,
                "stresses": [], "displacements": [], "relative": [], "damage": [], "joints": [], "bolts": [],
                "sections": [{}] }}"#,
            sections.join(",")
        );
        serde_json::from_str(&text).unwrap()
    }

    /// At each scale results have the number of cases that have them, and none of the wall time; what is not bounded is none of the
    /// numbers; envelopes are those of the sections of a ring and of single ones, and cases without results are named.
    #[test]
    fn statistics_count_what_there_is() {
        let case =
            |record: &str, scale: f64| RecordCase::new(format!("{record}-x{scale}"), record, scale);
        let cases = ["a", "b", "c", "d"].map(|record| [case(record, 1.0), case(record, 3.0)]);
        let outcomes = [
            outcome("a-x1", 10.0, Some(7.0), r#"{ "of": 0.25 }"#),
            outcome("b-x1", 30.0, None, r#""beyond""#),
            outcome("c-x1", 20.0, Some(8.0), r#"{ "of": 0.75 }"#),
            outcome("other", 1e6, Some(1e6), r#""beyond""#),
        ];
        let found = SetStatistics::of(
            ("set", &[]),
            None,
            cases.as_flattened(),
            &outcomes,
            |_, _| None,
        );
        let [at_one, at_three] = &found.scales[..] else {
            panic!("{found:?}");
        };
        assert_eq!(
            (at_one.scale, at_one.finished, &at_one.missing[..]),
            (1.0, 3, &["d-x1".to_owned()][..])
        );
        assert_eq!(
            (
                at_three.finished,
                at_three.missing.len(),
                at_three.figures.len()
            ),
            (0, 4, 0)
        );
        let figure = |name: &str| at_one.figures.iter().find(|of| of.figure == name).unwrap();
        let axial = figure("greatest axial force ring [N/m]");
        assert_eq!((axial.count, axial.median), (3, Some(40.0)));
        assert!((axial.low.unwrap() - (20.0 + 0.32 * 20.0)).abs() < 1e-12);
        let cut = figure("least axial force cut [N/m]");
        assert_eq!((cut.count, cut.median), (2, Some(-7.5)));
        let used = figure("utilisation ring");
        assert_eq!((used.count, used.median, used.high), (3, Some(0.75), None));
        assert!(at_one.figures.iter().all(|of| !of.figure.contains("wall")));
        let envelopes: Vec<_> = at_one
            .envelopes
            .iter()
            .map(|of| (of.section.as_str(), of.axial, of.shear))
            .collect();
        assert_eq!(
            envelopes,
            [
                ("ring-0", [-30.0, 30.0], [-15.0, 15.0]),
                ("ring-90", [-60.0, 60.0], [-30.0, 30.0]),
                ("cut", [-8.0, 8.0], [-4.0, 4.0]),
            ]
        );
        let shown = found.to_string();
        assert!(
            shown.contains("3 of 4 cases; without results: d-x1") && shown.contains("unbounded"),
            "{shown}"
        );
        assert!(shown.contains("  of 2 cases"), "{shown}");
    }

    /// A figure is named with its unit, as in `sweep.csv`, or without; not by a part of its name.
    #[test]
    fn figures_are_named_with_their_units_or_without() {
        let figure = "least shear force crown [N/m]";
        assert!(is_named(figure, figure) && is_named(figure, "least shear force crown"));
        assert!(is_named("greatest damage", "greatest damage"));
        for other in [
            "least shear force",
            "least shear force crown [N]",
            "[N/m]",
            "",
        ] {
            assert!(!is_named(figure, other), "{other}");
        }
    }
}
