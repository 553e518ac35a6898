//! Warnings of runs, for the sections of a report that they concern.

use powerhouse::summary::RunSummary;
use powerhouse::{Message, Topic};

use super::ReportCase;

/// A warning with the runs that have it.
struct RunWarning<'v> {
    about: Topic,
    text: &'v str,
    cases: Vec<&'v str>,
}

/// The warnings of several runs, each once.
pub(super) struct RunWarnings<'v> {
    all: Vec<RunWarning<'v>>,
    /// Number of runs.
    runs: usize,
}

impl<'v> RunWarnings<'v> {
    /// Collects the warnings of summaries with the names of their runs.
    pub(super) fn of(runs: impl IntoIterator<Item = (&'v str, &'v RunSummary)>) -> Self {
        let mut found = Self {
            all: Vec::new(),
            runs: 0,
        };
        for (name, summary) in runs {
            found.runs += 1;
            for Message { about, text } in &summary.warnings {
                match found.all.iter_mut().find(|known| known.text == text) {
                    Some(known) => known.cases.push(name),
                    None => found.all.push(RunWarning {
                        about: *about,
                        text,
                        cases: vec![name],
                    }),
                }
            }
        }
        found
    }

    /// Collects the warnings of the cases of a sweep.
    pub(super) fn of_cases(cases: &'v [ReportCase]) -> Self {
        let named =
            |case: &'v ReportCase| Some((case.outcome.name.as_str(), case.summary.as_ref()?));
        Self::of(cases.iter().filter_map(named))
    }

    /// All warnings with the names of the runs that have them.
    pub(super) fn with_cases(&self) -> impl Iterator<Item = (&'v str, &[&'v str])> {
        let all = self.all.iter();
        all.map(|warning| (warning.text, &warning.cases[..]))
    }

    /// The warnings about some topics (all topics for an empty list), as sentences with the runs that have them.
    pub(super) fn about(&self, topics: &[Topic]) -> Vec<String> {
        let own = self.all.iter().filter(|warning| {
            let is_own = topics.contains(&warning.about);
            topics.is_empty() || is_own
        });
        let texts = own.map(|warning| match warning.cases.len() {
            all if all == self.runs => warning.text.to_owned(),
            _ => format!("{} (case {})", warning.text, warning.cases.join(", ")),
        });
        texts.collect()
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn with_warnings(texts: &[&str]) -> RunSummary {
        let warnings: Vec<Message> = (texts.iter())
            .map(|text| Message {
                about: Topic::Input,
                text: (*text).into(),
            })
            .collect();
        let summary = json!({
            "title": "", "software": "", "nodes": 8, "elements": 1, "ended": "completed", "failure": null,
            "advice": [], "steps": 1, "device": null, "step": 1.0, "end_time": 1.0, "wall_time": 1.0,
            "stable_step": null, "fibres": null, "stages": [], "hand_over": null, "bolts": [], "peaks": [],
            "resolution": [], "section_uses": [], "joints": [], "energies": [], "energy_residual": null,
            "warnings": warnings, "remarks": [], "path_dependent": false, "files": [],
        });
        serde_json::from_value(summary).unwrap()
    }

    /// A warning is stated once, with all cases that have it, and without names if all cases have it.
    #[test]
    fn a_warning_has_the_cases_that_have_it() {
        let summaries = [&["x", "y"][..], &["x"], &["y", "x", "z"]].map(with_warnings);
        let warnings = RunWarnings::of(["a", "b", "c"].into_iter().zip(&summaries));
        assert_eq!(warnings.about(&[]), ["x", "y (case a, c)", "z (case c)"]);
    }
}
