//! Formatting of numbers in reports.

/// A number with three significant digits.
pub fn rounded(value: f64) -> String {
    match value.abs() {
        0.0 => "0".into(),
        size if !(1e-3..1e5).contains(&size) => format!("{value:.2e}"),
        size if size >= 100.0 => format!("{value:.0}"),
        size if size >= 10.0 => format!("{value:.1}"),
        size if size >= 1.0 => format!("{value:.2}"),
        size if size >= 0.0995 => format!("{value:.3}"),
        size if size >= 0.00995 => format!("{value:.4}"),
        _ => format!("{value:.5}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Small numbers keep three significant digits, those that are rounded up to a power of ten too.
    #[test]
    fn three_digits_are_significant() {
        for (value, text) in [
            (0.0, "0"),
            (-3.548e-3, "-0.00355"),
            (0.0999999, "0.100"),
            (0.0234, "0.0234"),
            (0.2346, "0.235"),
            (12.34, "12.3"),
            (4.56e-4, "4.56e-4"),
        ] {
            assert_eq!(rounded(value), text);
        }
    }
}
