//! Times of samples: equal steps, gaps, and columns in the wrong order.

use crate::{RecordError, RecordFault, RecordOptions};

/// Largest deviation of a time from the uniform one, in steps.
pub(crate) const UNIFORMITY: f64 = 0.01;

/// Whether of two columns the second is of times and the first is not.
pub(crate) fn is_swapped(times: &[f64], samples: &[f64], options: &RecordOptions) -> bool {
    options.columns.is_none()
        && times.len() == samples.len()
        && times.len() > 3
        && is_uniform(samples)
        && !is_uniform(times)
}

/// Whether numbers rise by the same step.
pub(crate) fn is_uniform(values: &[f64]) -> bool {
    let step = values.get(1).zip(values.first()).map(|(b, a)| b - a);
    step.is_some_and(|step| {
        let is_step = |pair: &[f64]| (pair[1] - pair[0] - step).abs() <= 2.0 * UNIFORMITY * step;
        step > 0.0 && values.windows(2).all(is_step)
    })
}

/// Compares each time with the one before it and the median step, which a gap does not change: so the
/// error names the gap, and not the row at which the mean step first fails.
fn check_gaps(times: &[(usize, f64)]) -> Result<(), RecordError> {
    let mut steps: Vec<f64> = times.windows(2).map(|pair| pair[1].1 - pair[0].1).collect();
    let middle = steps.len() / 2;
    let (_, &mut median, _) = steps.select_nth_unstable_by(middle, f64::total_cmp);
    for pair in times.windows(2) {
        let ((_, before), (line, time)) = (pair[0], pair[1]);
        let expected = before + median;
        // Both ends of a step are rounded.
        if (time - expected).abs() > 2.0 * UNIFORMITY * median.abs() {
            let fault = RecordFault::NotUniform { time, expected };
            return Err(RecordError::content(line, 1, fault));
        }
    }
    Ok(())
}

/// Step of a time column; `None` if there is no such column.
pub(crate) fn uniform_step(times: &[(usize, f64)]) -> Result<Option<f64>, RecordError> {
    let ([(_, first), .., (last_line, last)], count) = (times, times.len()) else {
        return Ok(None);
    };
    let step = (last - first) / (count - 1) as f64;
    if !(step.is_finite() && step > 0.0) {
        let fault = RecordFault::Step { value: step };
        return Err(RecordError::content(*last_line, 0, fault));
    }
    check_gaps(times)?;
    for (index, &(line, time)) in times.iter().enumerate() {
        let expected = first + index as f64 * step;
        if (time - expected).abs() > UNIFORMITY * step {
            let fault = RecordFault::NotUniform { time, expected };
            return Err(RecordError::content(line, 1, fault));
        }
    }
    // Printed times are rounded; a step of few digits is the intended one.
    let rounded = format!("{step:.6e}").parse().unwrap_or(step);
    Ok(Some(rounded))
}
