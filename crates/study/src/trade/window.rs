//! How much of a scene a trade runs.

use powerhouse::Scene;
use powerhouse::wavefield::TimeHistory;

/// Share of a record's intensity that a window holds, and what is added of the duration for the waves
/// to cross the body.
const SHARE_OF_INTENSITY: f64 = 0.5;
const SHARE_ADDED: f64 = 0.1;

/// Time until half of the records' intensity has come, and a tenth of the duration more; the duration
/// if that is shorter, or waves are pulses.
pub(super) fn window(scene: &Scene) -> f64 {
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
    let duration = scene.run_duration();
    let latest = scene.records().values().map(until).reduce(f64::max);
    latest.map_or(duration, |latest| {
        duration.min(latest + SHARE_ADDED * duration)
    })
}
