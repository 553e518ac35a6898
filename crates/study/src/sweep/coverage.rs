//! Share of the records that a case covers.

use powerhouse::wavefield::TimeHistory;
use powerhouse::{Message, Scene, Topic};
use serde::{Deserialize, Serialize};

use super::CaseInput;

/// Share of the Arias intensity of a record that a case must cover to be judged: the end of its significant duration
/// D5-95.
const SIGNIFICANT: f64 = 0.95;

/// Share of a wave's record that a case covers; of several records that with the least share.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Coverage {
    /// Name of the record.
    pub record: String,
    /// Time of the record at the end of the run (s), at the reference point of its wave; counted, as the next ones are, from
    /// the first sample of the record as the waves use it, the extension by its filter included.
    pub end: f64,
    /// Duration of the record (s).
    pub length: f64,
    /// Share of the Arias intensity of the record before that end, from 0 to 1.
    pub intensity: f64,
    /// Record time at the end of the significant duration D5-95 (s).
    pub significant: f64,
}

impl Coverage {
    /// The coverage of a case; `None` if its waves have no record.
    pub(super) fn of(scene: &Scene, input: &CaseInput) -> Option<Self> {
        let end = scene.start_time() + scene.duration();
        let moves = |name: &str| input.waves.iter().any(|wave| is_of(&wave.motion, name));
        let records = scene.records().iter().filter(|(name, _)| moves(name));
        // The components of a station arrive together.
        let arrivals = scene.record_arrivals();
        let station = |name: &str| arrivals.get(name.rsplit_once('.')?.0);
        let all = records.map(|(name, record)| {
            let arrival = arrivals.get(name).or_else(|| station(name));
            let arrival = arrival.copied().unwrap_or(0.0);
            Self::of_record(name, record, end - arrival)
        });
        all.min_by(|a, b| a.intensity.total_cmp(&b.intensity))
    }

    fn of_record(name: &str, record: &TimeHistory, end: f64) -> Self {
        let (step, samples) = (record.step(), record.acceleration());
        // The integral of the square of a piecewise-linear record, without its constant factor.
        let mut sums = vec![0.0];
        for pair in samples.windows(2) {
            let [a, b] = [pair[0], pair[1]];
            sums.push(sums[sums.len() - 1] + step * (a * a + a * b + b * b) / 3.0);
        }
        let total = sums[sums.len() - 1];
        let significant = sums.partition_point(|sum| *sum < SIGNIFICANT * total);
        Self {
            record: name.into(),
            end: end.max(0.0),
            length: step * (samples.len() - 1) as f64,
            intensity: record.arias_share_before(end),
            significant: step * significant as f64,
        }
    }

    /// Whether the case covers the strong motion: the whole significant duration.
    pub fn is_enough(&self) -> bool {
        self.intensity >= SIGNIFICANT
    }

    /// Describes the covered and the missing part of the record as text.
    pub fn shortened(&self) -> String {
        format!(
            "shortened to {:.3} of {:.3} s of record '{}', {:.1} % of its Arias intensity; its significant duration ends at {:.2} s",
            self.end.min(self.length),
            self.length,
            self.record,
            100.0 * self.intensity,
            self.significant
        )
    }

    /// The warning about a case that does not cover the strong motion.
    pub(super) fn warning(&self) -> Option<Message> {
        (!self.is_enough()).then(|| Message {
            about: Topic::Input,
            text: format!(
                "{}: all results are those of the motion until then",
                self.shortened()
            ),
        })
    }
}

/// Whether the description of a motion is that of a record, of which a component has the name `station.x`: `station`,
/// `station X`, and `station split` for all components.
fn is_of(motion: &str, record: &str) -> bool {
    let of_component = record.rsplit_once('.').is_some_and(|(station, component)| {
        let rest = motion.strip_prefix(station);
        let rest = rest.and_then(|rest| rest.strip_prefix(' '));
        rest.is_some_and(|rest| rest == "split" || rest.eq_ignore_ascii_case(component))
    });
    of_component || motion == record
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The covered share is that of the integral of the squared acceleration, and a case that ends before 95 % of it does
    /// not cover the strong motion.
    #[test]
    fn a_case_covers_the_intensity_before_its_end() {
        // Constant from 2 to 4 s, zero before and after.
        let samples = (0..=600).map(|i| f64::from(u8::from((200..=400).contains(&i))));
        let record = TimeHistory::new(0.01, samples.collect()).unwrap();
        for (end, share) in [
            (0.0, 0.0),
            (1.5, 0.0),
            (3.0, 0.5),
            (3.8, 0.9),
            (4.5, 1.0),
            (60.0, 1.0),
        ] {
            let found = Coverage::of_record("x", &record, end);
            assert!((found.intensity - share).abs() < 5e-3, "{end}: {found:?}");
            assert_eq!(found.is_enough(), share >= 0.95);
            assert!((found.significant - 3.9).abs() < 0.02, "{found:?}");
            assert_eq!(found.length, 6.0);
        }
        let text = Coverage::of_record("x", &record, 3.0).shortened();
        assert!(
            text.starts_with("shortened to 3.000 of 6.000 s of record 'x', 50.0 %"),
            "{text}"
        );
    }

    /// Motions are those of a record, of a component of one, or of a whole station.
    #[test]
    fn motions_name_their_records() {
        for (motion, record, wanted) in [
            ("quake", "quake", true),
            ("quake", "quakes", false),
            ("station X", "station.x", true),
            ("station X", "station.y", false),
            ("station split", "station.x", true),
            ("stations split", "station.x", false),
            ("stationx", "station.x", false),
        ] {
            assert_eq!(is_of(motion, record), wanted, "{motion} {record}");
        }
    }
}
