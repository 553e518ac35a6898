//! What was warned of in runs, beside the figures that it is about.

use serde_json::Value;

use super::CaseFiles;

/// A doubt, and the runs that have it.
pub(super) struct Doubted<'v> {
    about: &'v str,
    text: &'v str,
    cases: Vec<&'v str>,
}

/// The doubts of some runs, by name, each once.
pub(super) struct Doubts<'v> {
    all: Vec<Doubted<'v>>,
    /// How many runs there are.
    runs: usize,
}

impl<'v> Doubts<'v> {
    /// Those of summaries by the names of their runs.
    pub(super) fn of(runs: impl IntoIterator<Item = (&'v str, &'v Value)>) -> Self {
        let mut found = Self {
            all: Vec::new(),
            runs: 0,
        };
        for (name, summary) in runs {
            found.runs += 1;
            for doubt in summary["warnings"].as_array().into_iter().flatten() {
                let (about, text) = (doubt["about"].as_str(), doubt["text"].as_str());
                let (about, text) = (about.unwrap_or("run"), text.unwrap_or(""));
                match found.all.iter_mut().find(|known| known.text == text) {
                    Some(known) => known.cases.push(name),
                    None => found.all.push(Doubted {
                        about,
                        text,
                        cases: vec![name],
                    }),
                }
            }
        }
        found
    }

    pub(super) fn of_cases(cases: &'v [CaseFiles]) -> Self {
        Self::of((cases.iter()).map(|case| (case.outcome.name.as_str(), &case.summary)))
    }

    /// Those about one of some topics, or all, as sentences with the runs that have them.
    pub(super) fn about(&self, topics: &[&str]) -> Vec<String> {
        let own = self.all.iter().filter(|doubt| {
            let is_own = topics.contains(&doubt.about);
            topics.is_empty() || is_own
        });
        let told = own.map(|doubt| match doubt.cases.len() {
            all if all == self.runs => doubt.text.to_owned(),
            _ => format!("{} (case {})", doubt.text, doubt.cases.join(", ")),
        });
        told.collect()
    }
}
