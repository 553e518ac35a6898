//! Comparison of the results of a sweep with those of Wang, Chen & Xiao (2019).

use powerhouse_report::{ReportCase, ReportItem, ReportSection, ReportTable};
use powerhouse_study::sweep::{CaseOutcome, Peak};
use powerhouse_study::text::rounded;

use crate::{Conclusion, Verdict, conclusions};

/// Text above the table of conclusions.
const CONCLUSIONS: &str = "The conclusions of Wang, Chen & Xiao (2019), section 5, each tested by \
     results of the cases of this sweep. The abstract contradicts the fourth conclusion; both are \
     tested. A claim is open as long as a case that it needs is not finished.";

/// Text above the table of values.
const FIGURES: &str = "Values that the paper gives in numbers. Its mesh, the dimensions of the members \
     inside the caverns, the softening of its concrete and its dynamic friction are not published.";

const INPUT: &str = "the record is another processing of the same event, and the paper does not say whether \
     1.7 m/s2 is the incident wave or the outcrop";
const CONCRETE: &str = "softening and reinforcement of the concrete are not given; here stress is the mean of \
     an element";
const STRENGTH: &str = "the value of the paper is above the tensile strength of its concrete, 1.27 MPa, and above the apex of its \
     yield surface, c cot(phi) = 1.18 MPa; here stress is the mean of an element";
const STATICS: &str = "excavation stages and the share of the load on the lining are assumed";

/// A value of the paper and the function that evaluates it here.
struct Figure {
    what: &'static str,
    paper: &'static str,
    why: &'static str,
    here: fn(&[ReportCase]) -> Option<f64>,
}

const COMPARED: [Figure; 8] = [
    Figure {
        what: "greatest displacement of A, SV 30 (mm)",
        paper: "74",
        why: INPUT,
        here: |cases| displacement(cases, ("sv", 30.0)),
    },
    Figure {
        what: "greatest displacement of A, P 90 (mm)",
        paper: "84",
        why: INPUT,
        here: |cases| displacement(cases, ("p", 90.0)),
    },
    Figure {
        what: "static principal stress at A (MPa)",
        paper: "-0.78",
        why: STATICS,
        here: |cases| static_stress(of(cases, ("sv", 30.0))?),
    },
    Figure {
        what: "greatest principal stress at A, SV 0 to 30 (MPa)",
        paper: "1.76",
        why: STRENGTH,
        here: |cases| greatest_stress(cases, "sv", 30.0),
    },
    Figure {
        what: "greatest principal stress at A, P (MPa)",
        paper: "1.67",
        why: STRENGTH,
        here: |cases| greatest_stress(cases, "p", 90.0),
    },
    Figure {
        what: "greatest damage, SV 0",
        paper: "below 0.5",
        why: CONCRETE,
        here: |cases| damage(cases, ("sv", 0.0)),
    },
    Figure {
        what: "greatest damage, SV 25",
        paper: "about 0.6",
        why: CONCRETE,
        here: |cases| damage(cases, ("sv", 25.0)),
    },
    Figure {
        what: "greatest damage, SV 30",
        paper: "about 0.6 and more",
        why: CONCRETE,
        here: |cases| damage(cases, ("sv", 30.0)),
    },
];

/// Section of the report of a sweep that compares it with the paper: the conclusions, and the values that the paper gives in
/// numbers. Sweeps without the paper's monitoring point A do not have it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Comparison;

impl Comparison {
    /// Whether outcomes are those of the paper's machine bay: one has its monitoring point A.
    pub fn concerns<'o>(outcomes: impl IntoIterator<Item = &'o CaseOutcome>) -> bool {
        outcomes.into_iter().any(|outcome| {
            at_crown(&outcome.stresses)
                .or(at_crown(&outcome.displacements))
                .is_some()
        })
    }
}

impl ReportSection for Comparison {
    fn title(&self) -> &'static str {
        "Comparison with the paper"
    }

    fn items(&self, cases: &[ReportCase]) -> Vec<ReportItem> {
        if !Self::concerns(cases.iter().map(|case| &case.outcome)) {
            return Vec::new();
        }
        let outcomes: Vec<CaseOutcome> = cases.iter().map(|case| case.outcome.clone()).collect();
        let mut items = vec![
            ReportItem::Paragraph(CONCLUSIONS.into()),
            ReportItem::Table(of_conclusions(&conclusions(&outcomes))),
        ];
        if let Some(table) = figures(cases) {
            items.extend([
                ReportItem::Paragraph(FIGURES.into()),
                ReportItem::Table(table),
            ]);
        }
        items
    }

    /// The tables by angle of the report have the peaks of the paper's points.
    fn replaces_results(&self) -> bool {
        true
    }
}

/// The unvaried case of a wave.
fn of<'c>(cases: &'c [ReportCase], wave: (&str, f64)) -> Option<&'c ReportCase> {
    cases
        .iter()
        .find(|case| case.is_plain() && case.outcome.input.wave() == Some(wave))
}

/// The peak at the point A.
fn at_crown(peaks: &[Peak]) -> Option<f64> {
    let is_crown = |peak: &&Peak| peak.name == "A" || peak.name.starts_with("A-concrete");
    peaks.iter().find(is_crown).map(|peak| peak.value)
}

fn displacement(cases: &[ReportCase], wave: (&str, f64)) -> Option<f64> {
    Some(1e3 * at_crown(&of(cases, wave)?.outcome.displacements)?)
}

fn static_stress(case: &ReportCase) -> Option<f64> {
    let mut columns = case.histories.iter();
    let stress = columns.find(|column| column.name == "A-concrete.s1")?;
    Some(1e-6 * stress.values.first()?)
}

/// The greatest principal stress at A over the cases of a kind of wave up to an angle (MPa).
fn greatest_stress(cases: &[ReportCase], kind: &str, most: f64) -> Option<f64> {
    let is_one = |case: &&ReportCase| {
        let wave = case.outcome.input.wave();
        case.is_plain() && wave.is_some_and(|(own, angle)| own == kind && angle <= most)
    };
    let peaks = cases.iter().filter(is_one);
    let peaks = peaks.filter_map(|case| at_crown(&case.outcome.stresses));
    peaks.reduce(f64::max).map(|stress| 1e-6 * stress)
}

fn damage(cases: &[ReportCase], wave: (&str, f64)) -> Option<f64> {
    let outcome: &CaseOutcome = &of(cases, wave)?.outcome;
    let found = outcome.damage.iter().find(|damage| damage.name == "damage");
    Some(found?.greatest)
}

/// The values of the paper and of this sweep; `None` if no value is available here.
fn figures(cases: &[ReportCase]) -> Option<ReportTable> {
    let found: Vec<Option<f64>> = COMPARED.iter().map(|figure| (figure.here)(cases)).collect();
    let rows = COMPARED.iter().zip(&found).map(|(figure, here)| {
        vec![
            figure.what.into(),
            figure.paper.into(),
            here.map_or("case missing".into(), rounded),
            figure.why.into(),
        ]
    });
    found.iter().any(Option::is_some).then(|| ReportTable {
        header: ["value", "paper", "here", "reason for a difference"]
            .map(str::to_owned)
            .to_vec(),
        rows: rows.collect(),
    })
}

/// The table of conclusions.
fn of_conclusions(found: &[Conclusion]) -> ReportTable {
    let rows = found.iter().map(|claim| {
        let number = match claim.number {
            0 => "abstract".into(),
            number => number.to_string(),
        };
        let figures = match &claim.verdict {
            Verdict::Missing(_) => String::new(),
            _ => claim.figures.clone(),
        };
        vec![
            number,
            claim.claim.into(),
            claim.verdict.to_string(),
            figures,
        ]
    });
    ReportTable {
        header: ["conclusion", "claim of the paper", "here", "values"]
            .map(str::to_owned)
            .to_vec(),
        rows: rows.collect(),
    }
}
