//! Accelerations at equal intervals.

use powerhouse::wavefield::TimeHistory;

/// Resamples an acceleration (m/s2) at equal intervals, with the same number of samples, since a run samples at its
/// steps. `None` for fewer than two samples or an invalid record.
pub fn even_samples(times: &[f64], acceleration: &[f64]) -> Option<TimeHistory> {
    let ([first, _, ..], [.., last]) = (times, times) else {
        return None;
    };
    let step = (last - first) / (times.len() - 1) as f64;
    let mut index = 0;
    let even = (0..times.len()).map(|sample| {
        let time = first + step * sample as f64;
        while index + 2 < times.len() && times[index + 1] <= time {
            index += 1;
        }
        let share = (time - times[index]) / (times[index + 1] - times[index]);
        let [from, to] = [acceleration[index], acceleration[index + 1]];
        from + (to - from) * share.clamp(0.0, 1.0)
    });
    TimeHistory::new(step, even.collect()).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Samples at unequal intervals are resampled to those of the same motion at equal intervals.
    #[test]
    fn uneven_samples_become_even_ones() {
        // Every first step of 6 ms at or past a multiple of 10 ms.
        let times: Vec<f64> = (0..100)
            .map(|sample| 6e-3 * (10.0 * f64::from(sample) / 6.0).ceil())
            .collect();
        let wave = |time: f64| (5.0 * time).sin();
        let uneven: Vec<f64> = times.iter().map(|&time| wave(time)).collect();
        let even = even_samples(&times, &uneven).unwrap();
        let step = times[99] / 99.0;
        assert!((even.step() - step).abs() < 1e-15);
        for (sample, value) in even.acceleration().into_iter().enumerate() {
            // Chords of at most 12 ms.
            let off = value - wave(step * sample as f64);
            assert!(
                off.abs() < 25.0 * 0.012_f64.powi(2) / 8.0 + 1e-12,
                "{off:e}"
            );
        }
        let given: Vec<f64> = (0..50).map(|sample| 0.25 * f64::from(sample)).collect();
        let same = even_samples(&given, &given).unwrap().acceleration();
        assert!(same.iter().zip(&given).all(|(a, b)| (a - b).abs() < 1e-12));
        assert!(even_samples(&[0.0], &[1.0]).is_none());
    }
}
