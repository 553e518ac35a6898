//! How much of a scene a trade runs.

use powerhouse::Scene;
use powerhouse::wavefield::TimeHistory;

/// Share of a record's intensity that a window holds, and what is added of the duration for the waves
/// to cross the body.
const SHARE_OF_INTENSITY: f64 = 0.5;
const SHARE_ADDED: f64 = 0.1;

/// Time until half of the records' intensity has come, and a tenth of the duration more, in four digits;
/// the duration if that is shorter, or waves are pulses.
pub(super) fn window(scene: &Scene) -> f64 {
    of_records(scene.duration(), scene.records().values())
}

fn of_records<'a>(duration: f64, records: impl Iterator<Item = &'a TimeHistory>) -> f64 {
    let until = |history: &TimeHistory| {
        let samples = history.acceleration();
        let whole: f64 = samples.iter().map(|a| a * a).sum();
        let mut sum = 0.0;
        let place = samples.iter().position(|a| {
            sum += a * a;
            sum >= SHARE_OF_INTENSITY * whole
        });
        place.unwrap_or(samples.len()) as f64 * history.step()
    };
    let Some(latest) = records.map(until).reduce(f64::max) else {
        return duration;
    };
    let window = latest + SHARE_ADDED * duration;
    // What people read and type.
    duration.min(format!("{window:.3e}").parse().unwrap_or(window))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A window ends after half of the latest record's intensity and a tenth of the duration, at a time
    /// that is written in few digits; without records, or if that is longer, it is the duration.
    #[test]
    fn a_window_holds_half_of_the_intensity() {
        let record = |strong: usize| {
            let of = |place| if place == strong { 2.0 } else { 0.001 };
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
