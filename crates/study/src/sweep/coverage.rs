//! How much of its records a case has seen.

use powerhouse::wavefield::TimeHistory;
use powerhouse::{Doubt, Remark, Scene, Topic};
use serde::{Deserialize, Serialize};

use super::CaseInput;

/// The share of the Arias intensity of a record that a case must see to be judged: the end of its significant
/// duration D5-95.
const SIGNIFICANT: f64 = 0.95;

/// How much of a record a case has seen: of its records the one of which it saw least.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Coverage {
    /// The name of the record.
    pub record: String,
    /// The time of the record at which the run ends (s): the duration, less the padding before quiet starts.
    pub end: f64,
    /// The length of the record (s).
    pub length: f64,
    /// The share of its Arias intensity that comes before that end.
    pub intensity: f64,
    /// The time of the record at which its significant duration D5-95 ends (s).
    pub significant: f64,
}

impl Coverage {
    /// That of a case; none if no record moves its waves.
    pub(super) fn of(scene: &Scene, input: &CaseInput) -> Option<Self> {
        let padding = scene.remarks().iter().map(|remark| match remark {
            Remark::QuietStart { padding, .. } => *padding,
            _ => 0.0,
        });
        let end = scene.duration() - padding.sum::<f64>();
        let moves = |name: &str| {
            let mut waves = input.waves.iter();
            waves.any(|wave| {
                let rest = wave.motion.strip_prefix(name);
                rest.is_some_and(|rest| rest.is_empty() || rest.starts_with(' '))
            })
        };
        let records = scene.records().iter().filter(|(name, _)| moves(name));
        let all = records.map(|(name, record)| Self::of_record(name, record, end));
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
        let last = ((end / step).floor().max(0.0) as usize).min(sums.len() - 1);
        let significant = sums.partition_point(|sum| *sum < SIGNIFICANT * total);
        Self {
            record: name.into(),
            end: end.max(0.0),
            length: step * (samples.len() - 1) as f64,
            intensity: if total > 0.0 { sums[last] / total } else { 1.0 },
            significant: step * significant as f64,
        }
    }

    /// Whether the case has seen the strong motion: all of the significant duration.
    pub fn is_enough(&self) -> bool {
        self.intensity >= SIGNIFICANT
    }

    /// What is missing, in words.
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

    /// The doubt about a case that has not seen the strong motion.
    pub(super) fn doubt(&self) -> Option<Doubt> {
        (!self.is_enough()).then(|| Doubt {
            about: Topic::Input,
            text: format!(
                "{}: all results are those of the motion until then",
                self.shortened()
            ),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a record that is strong in its middle the share before a time is that of its squared acceleration,
    /// and what ends before 95 % of it has not seen the strong motion.
    #[test]
    fn a_case_sees_the_share_of_its_time() {
        // Constant from 2 to 4 s, still before and after.
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
        let told = Coverage::of_record("x", &record, 3.0).shortened();
        assert!(
            told.starts_with("shortened to 3.000 of 6.000 s of record 'x', 50.0 %"),
            "{told}"
        );
    }
}
