//! Axes with round numbers.

/// Least exponent of ten of a round step; smaller ranges are drawn as zero.
const LEAST_EXPONENT: i32 = -290;

/// Axis from `low` to `high` with round marks.
///
/// Its numbers are those of the data divided by `10^exponent`, a multiple of three, so that marks
/// have few digits.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Scale {
    pub(crate) low: f64,
    pub(crate) high: f64,
    pub(crate) exponent: i32,
    pub(crate) marks: Vec<f64>,
    decimals: usize,
}

impl Scale {
    /// Axis over data from `least` to `greatest` with about `wanted` marks; with `room`, its
    /// ends are marks at or past the data.
    pub(crate) fn new(least: f64, greatest: f64, wanted: usize, room: bool) -> Self {
        let largest = least.abs().max(greatest.abs());
        let order = if largest > 0.0 {
            (largest.log10() + 1e-9).floor() as i32
        } else {
            0
        };
        let exponent = if (-2..4).contains(&order) || order < LEAST_EXPONENT {
            0
        } else {
            3 * order.div_euclid(3)
        };
        let (mut low, mut high) = (over(least, exponent), over(greatest, exponent));
        let magnitude = low.abs().max(high.abs());
        if !(high - low > 1e-9 * magnitude && order >= LEAST_EXPONENT) {
            let half = if order >= LEAST_EXPONENT && magnitude > 0.0 {
                0.5 * magnitude
            } else {
                1.0
            };
            let middle = 0.5 * (low + high);
            (low, high) = (middle - half, middle + half);
        }
        let raw = (high - low) / wanted.max(1) as f64;
        let power = raw.log10().floor() as i32;
        let unit = 10.0_f64.powi(power);
        let factor = [1.0, 2.0, 5.0, 10.0]
            .into_iter()
            .find(|factor| factor * unit >= raw * (1.0 - 1e-9))
            .unwrap_or(10.0);
        let step = factor * unit;
        if room {
            low = (low / step + 1e-9).floor() * step;
            high = (high / step - 1e-9).ceil() * step;
        }
        let first = (low / step - 1e-9).ceil() as i64;
        let last = (high / step + 1e-9).floor() as i64;
        let marks = (first..=last).map(|mark| mark as f64 * step).collect();
        let decimals = if factor == 10.0 { -power - 1 } else { -power };
        Self {
            low,
            high,
            exponent,
            marks,
            decimals: decimals.max(0) as usize,
        }
    }
    #[cfg(feature = "plots")]
    /// Position of a number of the data: 0 at the low end, 1 at the high end.
    pub(crate) fn share(&self, value: f64) -> f64 {
        self.share_of_mark(over(value, self.exponent))
    }
    pub(crate) fn share_of_mark(&self, mark: f64) -> f64 {
        (mark - self.low) / (self.high - self.low)
    }
    /// Text of a mark, with the digits that its step needs.
    pub(crate) fn text(&self, mark: f64) -> String {
        let text = format!("{mark:.*}", self.decimals);
        if text.trim_start_matches(['-', '0', '.']).is_empty() {
            text.trim_start_matches('-').into()
        } else {
            text
        }
    }
}

/// `value / 10^exponent`, in two factors so that neither leaves the range of numbers.
fn over(value: f64, exponent: i32) -> f64 {
    let half = exponent / 2;
    value / 10.0_f64.powi(half) / 10.0_f64.powi(exponent - half)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Marks are one, two or five times a power of ten, cover the data, and have few digits.
    #[test]
    fn marks_are_round() {
        for (least, greatest, exponent, marks) in [
            (0.0, 20.0, 0, vec!["0", "5", "10", "15", "20"]),
            (
                -0.0031,
                0.0012,
                -3,
                vec!["-4", "-3", "-2", "-1", "0", "1", "2"],
            ),
            (-1.7, 1.7, 0, vec!["-2", "-1", "0", "1", "2"]),
            (3.0e9, 3.4e9, 9, vec!["3.0", "3.1", "3.2", "3.3", "3.4"]),
        ] {
            let scale = Scale::new(least, greatest, 5, true);
            let texts: Vec<String> = scale.marks.iter().map(|&mark| scale.text(mark)).collect();
            assert_eq!(
                (scale.exponent, texts),
                (exponent, marks.into_iter().map(String::from).collect())
            );
        }
    }

    /// Every pair of finite numbers gives an axis with different ends and some marks, not too many.
    #[test]
    fn every_range_has_an_axis() {
        let values = [
            0.0,
            1.0,
            -1.0,
            5e-324,
            1e-300,
            1e300,
            f64::MAX,
            -f64::MAX,
            1.0 + 1e-15,
        ];
        for (least, greatest) in values
            .iter()
            .flat_map(|&a| values.map(|b| (a.min(b), a.max(b))))
        {
            for room in [false, true] {
                let scale = Scale::new(least, greatest, 5, room);
                let shares = [scale.share(least), scale.share(greatest)];
                assert!(scale.high > scale.low, "{least} {greatest}");
                assert!(
                    (1..=12).contains(&scale.marks.len()),
                    "{least} {greatest}: {scale:?}"
                );
                assert!(
                    shares.iter().all(|s| (-1e-6..=1.0 + 1e-6).contains(s)),
                    "{least} {greatest}: {shares:?}"
                );
            }
        }
    }
}
