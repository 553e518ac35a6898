//! Spacings of grid lines.

/// Exponent with which smoothed spacings follow the original ones.
const RELAXED_POWER: f64 = 0.35;
/// Bisection steps that determine a factor to machine precision.
const HALVINGS: usize = 80;

/// Spacings that grow geometrically from `first` up to `longest` and fill a length; equal ones where no growth is
/// needed or none suffices. If `cells` spacings of the longest do not fill the length, there are more.
pub(super) fn graded(length: f64, cells: usize, first: f64, longest: f64) -> Vec<f64> {
    let cells = enough(length, cells, longest);
    fill(length, cells, |growth, k| {
        (first * growth.powi(k as i32)).min(longest)
    })
}

/// Spacings as of [`graded`], growing from both ends to the middle.
pub(super) fn graded_from_both_ends(
    length: f64,
    cells: usize,
    first: f64,
    longest: f64,
) -> Vec<f64> {
    let cells = enough(length, cells, longest);
    fill(length, cells, |growth, k| {
        let from_end = k.min(cells - 1 - k);
        (first * growth.powi(from_end as i32)).min(longest)
    })
}

fn enough(length: f64, cells: usize, longest: f64) -> usize {
    cells.max((length / longest).ceil() as usize)
}

/// Spacings `of(growth, k)` whose sum is a length.
fn fill(length: f64, cells: usize, of: impl Fn(f64, usize) -> f64) -> Vec<f64> {
    let sum = |growth: f64| (0..cells).map(|k| of(growth, k)).sum::<f64>();
    let (mut low, mut high) = (1.0, 8.0);
    if sum(low) >= length || sum(high) <= length {
        return vec![length / cells as f64; cells];
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if sum(middle) < length {
            low = middle;
        } else {
            high = middle;
        }
    }
    (0..cells).map(|k| of(low, k)).collect()
}

/// Smoothed spacings with the same sum; none above `longest` unless the mean is.
pub(super) fn relaxed(spacings: &[f64], longest: f64) -> Vec<f64> {
    let length: f64 = spacings.iter().sum();
    let longest = longest.max(length / spacings.len() as f64);
    let scaled = |factor: f64| -> Vec<f64> {
        let powers = spacings.iter().map(|spacing| spacing.powf(RELAXED_POWER));
        powers.map(|power| (factor * power).min(longest)).collect()
    };
    let (mut low, mut high) = (0.0, longest);
    while scaled(high).iter().sum::<f64>() < length * (1.0 - 1e-12) && high < 1e6 {
        high *= 2.0;
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if scaled(middle).iter().sum::<f64>() < length {
            low = middle;
        } else {
            high = middle;
        }
    }
    scaled(high)
}

/// Positions of grid lines from a start with given spacings; the last is exactly `end`.
pub(super) fn positions(start: f64, spacings: &[f64], end: f64) -> Vec<f64> {
    let mut positions = vec![start];
    let mut position = start;
    for spacing in spacings {
        position += spacing;
        positions.push(position);
    }
    if let Some(last) = positions.last_mut() {
        *last = end;
    }
    positions
}

/// Cubic step from 0 at `t = 0` to 1 at `t = 1`, with zero slope at both ends.
pub(super) fn smooth_step(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
