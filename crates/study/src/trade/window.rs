//! Default window of a trade study.

use powerhouse::Scene;
use powerhouse::wavefield::TimeHistory;

/// Share of a record's intensity that a window contains, and share of the duration that is added for the waves to
/// travel through the body.
const SHARE_OF_INTENSITY: f64 = 0.5;
const SHARE_ADDED: f64 = 0.1;

/// Time until all records have half of their intensity, plus a tenth of the duration, rounded to four digits; at most
/// the duration, and the duration without records.
pub(super) fn window(scene: &Scene) -> f64 {
    of_records(scene.duration(), scene.records().values())
}

fn of_records<'a>(duration: f64, records: impl Iterator<Item = &'a TimeHistory>) -> f64 {
    let until = |history: &TimeHistory| {
        let samples = history.acceleration();
        let whole: f64 = samples.iter().map(|a| a * a).sum();
        let mut sum = 0.0;
        let index = samples.iter().position(|a| {
            sum += a * a;
            sum >= SHARE_OF_INTENSITY * whole
        });
        index.unwrap_or(samples.len()) as f64 * history.step()
    };
    let Some(latest) = records.map(until).reduce(f64::max) else {
        return duration;
    };
    let window = latest + SHARE_ADDED * duration;
    // Rounded, since it is printed and typed.
    duration.min(format!("{window:.3e}").parse().unwrap_or(window))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The window ends after half of the latest record's intensity and a tenth of the duration, rounded to few digits;
    /// without records, or if that is longer, it is the duration.
    #[test]
    fn the_window_contains_half_of_the_intensity() {
        let record = |strong: usize| {
            let of = |sample| if sample == strong { 2.0 } else { 0.001 };
            TimeHistory::new(0.02, (0..1000).map(of).collect()).unwrap()
        };
        let (early, late) = (record(100), record(228));
        let of = |duration, records: &[&TimeHistory]| of_records(duration, records.iter().copied());
        assert_eq!(of(20.0, &[]), 20.0);
        assert_eq!(of(20.0, &[&early]), 4.0);
        assert_eq!(of(20.0, &[&late, &early]).to_string(), "6.56");
        assert_eq!(of(5.0, &[&late]), 5.0);
    }
}
