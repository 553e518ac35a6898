//! Difference of the histories of two runs.

use std::collections::BTreeMap;

use powerhouse::engine::observe::HistoryTable;

use crate::StudyError;

/// Relative difference of a motion at a recorded point between two runs.
#[derive(Clone, Debug, PartialEq)]
pub struct ProbeError {
    /// Name of the history, as in the output requests of both runs.
    pub probe: String,
    /// Quantity: `u` displacement, `v` velocity, `a` acceleration.
    pub quantity: char,
    /// Relative L2 difference `sqrt(sum |x - y|^2 / sum |y|^2)` over all instants and components; NaN where the
    /// reference does not move.
    pub error: f64,
}

/// Relative L2 differences of the histories of a run from those of a reference run, for each recorded point and
/// quantity; histories that only one of them has are skipped.
///
/// The error of an absorbing boundary is the difference between a run with it and a run of the same mesh
/// [extended](fn@crate::grown) so far that no reflection returns within the run; both have the same elements and
/// steps. Waves should enter the larger mesh through the elements behind the faces of the smaller one (the region of
/// its [`Boundary`](powerhouse::Boundary) is the smaller mesh), so that numerical dispersion is the same and only the
/// boundary differs.
///
/// # Errors
/// [`StudyError::DifferentTimes`] if the instants differ by more than a millionth of the duration.
pub fn probe_errors(
    found: &HistoryTable,
    reference: &HistoryTable,
) -> Result<Vec<ProbeError>, StudyError> {
    let counts = [found.times.len(), reference.times.len()];
    let end = reference.times.last().copied().unwrap_or_default();
    let span = end - reference.times.first().copied().unwrap_or_default();
    let pairs = found.times.iter().zip(&reference.times);
    let apart = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    if counts[0] != counts[1] || apart > 1e-6 * span {
        return Err(StudyError::DifferentTimes { counts, apart });
    }
    let mut sums: BTreeMap<(String, char), [f64; 2]> = BTreeMap::new();
    for expected in &reference.columns {
        let (Some(column), Some(key)) = (found.column(&expected.name), key(&expected.name)) else {
            continue;
        };
        let [difference, size] = sums.entry(key).or_default();
        for (value, expected) in column.values.iter().zip(&expected.values) {
            *difference += (value - expected).powi(2);
            *size += expected.powi(2);
        }
    }
    let errors = sums.into_iter();
    let errors = errors.map(|((probe, quantity), [difference, size])| ProbeError {
        probe,
        quantity,
        error: (difference / size).sqrt(),
    });
    Ok(errors.collect())
}

/// Largest of several errors; NaN if one of them is NaN or if there are none.
#[must_use]
pub fn largest_error(errors: &[ProbeError]) -> f64 {
    let sizes = errors.iter().map(|error| error.error.abs());
    // `total_cmp` orders NaN above all numbers.
    sizes.max_by(f64::total_cmp).unwrap_or(f64::NAN)
}

/// History and quantity of a column such as `crown.ux`.
fn key(column: &str) -> Option<(String, char)> {
    let (probe, component) = column.rsplit_once('.')?;
    let mut letters = component.chars();
    match (letters.next(), letters.next(), letters.next()) {
        (Some(quantity @ ('u' | 'v' | 'a')), Some('x' | 'y' | 'z'), None) => {
            Some((probe.to_owned(), quantity))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use powerhouse::engine::observe::Column;

    use super::*;

    fn table(end: f64, columns: &[(&str, [f64; 2])]) -> HistoryTable {
        let column = |(name, values): &(&str, [f64; 2])| Column::new(*name, "m", values.to_vec());
        HistoryTable::new(vec![0.0, end], columns.iter().map(column).collect())
    }

    /// The components of a history and quantity are summed; columns without motion, or missing in one run, are
    /// skipped; different instants are an error.
    #[test]
    fn errors_are_computed_by_history_and_quantity() {
        let reference = table(
            1.0,
            &[
                ("a.ux", [3.0, 0.0]),
                ("a.uz", [0.0, 4.0]),
                ("a.vx", [1.0, 1.0]),
                ("b.ux", [1.0, 0.0]),
            ],
        );
        let found = table(
            1.0,
            &[
                ("a.ux", [3.0, 0.3]),
                ("a.uz", [0.4, 4.0]),
                ("a.vx", [1.0, 0.0]),
                ("stress", [1.0, 2.0]),
            ],
        );
        let errors = probe_errors(&found, &reference).unwrap();
        let keys: Vec<(&str, char)> = errors
            .iter()
            .map(|e| (e.probe.as_str(), e.quantity))
            .collect();
        assert_eq!(keys, [("a", 'u'), ("a", 'v')]);
        assert!((errors[0].error - 0.1).abs() < 1e-15);
        assert!((largest_error(&errors) - 0.5_f64.sqrt()).abs() < 1e-15);
        assert!(largest_error(&[]).is_nan());
        let later = table(1.1, &[("a.ux", [3.0, 0.0])]);
        assert!(matches!(
            probe_errors(&later, &reference),
            Err(StudyError::DifferentTimes { .. })
        ));
    }
}
