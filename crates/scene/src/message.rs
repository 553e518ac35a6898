//! Messages: texts of warnings and facts with their topic, as written to files and reports.

use serde::{Deserialize, Serialize};

use crate::Remark;

/// Topic of a message: the group of results that it concerns, beside which reports show it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Topic {
    /// Input motion: records, waves and prescribed motions.
    Input,
    /// Histories and envelopes of motion, stress and state variables.
    Histories,
    /// Section forces and moments.
    Sections,
    /// Joints: slip, opening, tractions, and their node pairs.
    Joints,
    /// Energy balance: work of hourglass resistance.
    Energy,
    /// The run as a whole: mesh, materials, boundary, stages, and all that concerns no single group of results.
    Run,
}

/// Message: text of a warning or fact with its topic.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Message {
    /// Topic of the message.
    pub about: Topic,
    /// Text, one sentence.
    pub text: String,
}

/// Remarks and warnings that are written to the files of a run beside its results.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct RunNotes {
    /// Remarks of the composition of the scene ([`Simulation::remarks`](crate::Simulation::remarks)).
    pub remarks: Vec<Remark>,
    /// Further warnings, such as those of a check; warnings of the results are added when files are written.
    pub warnings: Vec<Message>,
}

impl RunNotes {
    /// Notes of a run with the remarks of its scene.
    pub fn new(remarks: Vec<Remark>) -> Self {
        let warnings = Vec::new();
        Self { remarks, warnings }
    }
    /// The same with these further [warnings](Self::warnings), in place of those it had.
    #[must_use]
    pub fn with_warnings(mut self, warnings: Vec<Message>) -> Self {
        self.warnings = warnings;
        self
    }
    /// Warnings about a topic, as text lines.
    pub fn about(&self, topic: Topic) -> Vec<String> {
        let warnings = self.all_warnings(&[]).into_iter();
        let own = warnings.filter(|warning| warning.about == topic);
        own.map(|warning| format!("warning: {}", warning.text))
            .collect()
    }
    /// All warnings without repetitions, those of the results last.
    pub fn all_warnings(&self, of_results: &[Remark]) -> Vec<Message> {
        let remarks = self.remarks.iter().filter(|remark| remark.is_warning());
        let all = (remarks.map(Remark::message))
            .chain(self.warnings.iter().cloned())
            .chain(of_results.iter().map(Remark::message));
        merge_messages(all)
    }
    /// Texts of the remarks that are facts.
    pub fn facts(&self) -> Vec<String> {
        let facts = self.remarks.iter().filter(|remark| !remark.is_warning());
        facts.map(Remark::to_string).collect()
    }
}

/// Merges messages that differ only in the first quoted name into one message with all names, and drops repetitions.
///
/// ```
/// use powerhouse_scene::{Message, Topic, merge_messages};
/// let message = |text: &str| Message { about: Topic::Run, text: text.into() };
/// let found = merge_messages([
///     message("part 'rock' is damped"),
///     message("part 'lining' is damped"),
///     message("part 'rock' yields"),
/// ]);
/// assert_eq!(found, [message("part 'rock', 'lining' is damped"), message("part 'rock' yields")]);
/// ```
pub fn merge_messages(messages: impl IntoIterator<Item = Message>) -> Vec<Message> {
    /// Text before the first quoted name, the names, and the text after it.
    struct Frame {
        about: Topic,
        before: String,
        names: Vec<String>,
        behind: String,
    }
    let mut frames: Vec<Frame> = Vec::new();
    for Message { about, text } in messages {
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
        Message {
            about: frame.about,
            text: format!("{}{}{}", frame.before, names.join(", "), frame.behind),
        }
    };
    frames.into_iter().map(whole).collect()
}
