//! Doubts about results as files and reports have them.

use serde::Serialize;

use crate::Remark;

/// What of the results a doubt is about: reports put it there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Topic {
    /// The motion that comes in.
    Input,
    /// Motions, stresses and states against time, and their greatest values.
    Histories,
    /// Section forces.
    Sections,
    /// Joints.
    Joints,
    /// Bolts.
    Bolts,
    /// The energy account.
    Energy,
    /// All of the run.
    Run,
}

/// A doubt about results as files and reports have it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Doubt {
    /// What it is about.
    pub about: Topic,
    /// One sentence.
    pub text: String,
}

/// What the files of a run say beside its results.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct RunNotes {
    /// What was found while the scene was composed.
    pub remarks: Vec<Remark>,
    /// Doubts that were found otherwise, such as those of a check.
    pub warnings: Vec<Doubt>,
}

impl RunNotes {
    /// Notes of a run with the remarks of its scene.
    pub fn new(remarks: Vec<Remark>) -> Self {
        let warnings = Vec::new();
        Self { remarks, warnings }
    }
    /// The same with warnings that were found otherwise.
    #[must_use]
    pub fn with_warnings(mut self, warnings: Vec<Doubt>) -> Self {
        self.warnings = warnings;
        self
    }
    /// Doubts about a topic.
    pub(crate) fn about(&self, topic: Topic) -> Vec<String> {
        let doubts = self.doubts(&[]).into_iter();
        let own = doubts.filter(|doubt| doubt.about == topic);
        own.map(|doubt| format!("warning: {}", doubt.text))
            .collect()
    }
    /// All doubts, those of the results themselves last; each once.
    pub(crate) fn doubts(&self, of_results: &[Remark]) -> Vec<Doubt> {
        let remarks = self.remarks.iter().filter(|remark| remark.is_warning());
        let mut doubts: Vec<Doubt> = Vec::new();
        let all = (remarks.map(Remark::doubt))
            .chain(self.warnings.iter().cloned())
            .chain(of_results.iter().map(Remark::doubt));
        for doubt in all {
            doubts.push(doubt);
        }
        together(doubts)
    }
    /// What is no doubt.
    pub(crate) fn facts(&self) -> Vec<String> {
        let facts = self.remarks.iter().filter(|remark| !remark.is_warning());
        facts.map(Remark::to_string).collect()
    }
}

/// Doubts of which those that say the same of several names stand in one: the names of the others follow the
/// first. Each stands once.
///
/// ```
/// use powerhouse::{Doubt, Topic, together};
/// let doubt = |text: &str| Doubt { about: Topic::Run, text: text.into() };
/// let found = together([
///     doubt("part 'rock' is damped"),
///     doubt("part 'lining' is damped"),
///     doubt("part 'rock' yields"),
/// ]);
/// assert_eq!(found, [doubt("part 'rock', 'lining' is damped"), doubt("part 'rock' yields")]);
/// ```
pub fn together(doubts: impl IntoIterator<Item = Doubt>) -> Vec<Doubt> {
    /// What stands before the first name, the names, and what stands behind.
    struct Frame {
        about: Topic,
        before: String,
        names: Vec<String>,
        behind: String,
    }
    let mut frames: Vec<Frame> = Vec::new();
    for Doubt { about, text } in doubts {
        let named = text.split_once('\'').and_then(|(before, rest)| {
            let (name, behind) = rest.split_once('\'')?;
            Some((before.to_owned(), vec![name.to_owned()], behind.to_owned()))
        });
        let (before, names, behind) = named.unwrap_or_else(|| (text, Vec::new(), String::new()));
        let alike = frames
            .iter_mut()
            .find(|known| known.about == about && known.before == before && known.behind == behind);
        match alike {
            Some(known) => {
                let new = names.into_iter().filter(|name| !known.names.contains(name));
                let new: Vec<String> = new.collect();
                known.names.extend(new);
            }
            None => frames.push(Frame {
                about,
                before,
                names,
                behind,
            }),
        }
    }
    let whole = |frame: Frame| {
        let names: Vec<String> = frame.names.iter().map(|name| format!("'{name}'")).collect();
        Doubt {
            about: frame.about,
            text: format!("{}{}{}", frame.before, names.join(", "), frame.behind),
        }
    };
    frames.into_iter().map(whole).collect()
}
