//! Misfit: relative L2 difference of histories.

use powerhouse::io::TableColumn;

use super::SensitiveHistory;

/// Least norm of a history over the largest norm of the same unit: smaller histories are measured against that.
const LEAST_SHARE: f64 = 1e-3;
/// Least norms of dimensionless history variables such as strains and damage: absolute value per sample, and share of
/// the largest norm of the same variable. A small difference of an insignificant damage is no error.
const LEAST_STATE: f64 = 1e-6;
const LEAST_SHARE_OF_STATE: f64 = 0.1;

/// Unit of dimensionless columns.
const WITHOUT_UNIT: &str = "1";

/// Difference of a history from its reference.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Misfit {
    /// The relative L2 difference.
    pub(crate) error: f64,
    /// Sum of the squared differences.
    pub(crate) difference: f64,
    /// Name of the history.
    pub(crate) name: String,
}

/// The largest of the [misfits] of all histories but the excluded ones, which still count for the largest norms.
pub(super) fn misfit(
    reference: &[TableColumn],
    found: &[TableColumn],
    excluded: &[SensitiveHistory],
) -> Misfit {
    let mut worst = Misfit {
        error: 0.0,
        difference: 0.0,
        name: String::new(),
    };
    for other in misfits(reference, found) {
        let counts = excluded.iter().all(|known| known.history != other.name);
        if counts && (other.error >= worst.error || other.error.is_nan()) {
            worst = other;
        }
    }
    worst
}

/// The name of the history of a column; the components of a motion or a variable at one point are one history.
pub(super) fn history_of(column: &TableColumn) -> String {
    HistorySums::of(column).name()
}

/// The relative L2 differences of all histories from their reference, over all components of a history.
///
/// Histories of a unit for which the reference is zero have no relative error. The first column of both tables is
/// time; columns that the reference lacks are skipped.
pub(crate) fn misfits(reference: &[TableColumn], found: &[TableColumn]) -> Vec<Misfit> {
    let mut groups: Vec<HistorySums> = Vec::new();
    let ([time, columns @ ..], [other, others @ ..]) = (reference, found) else {
        return vec![Misfit {
            error: f64::INFINITY,
            difference: f64::INFINITY,
            name: String::new(),
        }];
    };
    for column in columns {
        let Some(same) = others.iter().find(|other| other.name == column.name) else {
            continue;
        };
        let group = HistorySums::of(column);
        let known = |other: &HistorySums| other.stem == group.stem && other.kind == group.kind;
        let index = groups.iter().position(known).unwrap_or_else(|| {
            groups.push(group);
            groups.len() - 1
        });
        for (instant, value) in time.values.iter().zip(&column.values) {
            if let Some(at) = interpolate(&other.values, &same.values, *instant) {
                groups[index].difference += (at - value).powi(2);
                groups[index].least += match column.unit.as_str() {
                    WITHOUT_UNIT => LEAST_STATE.powi(2),
                    _ => 0.0,
                };
                groups[index].size += value.powi(2);
            }
        }
    }
    let mut misfits = Vec::new();
    for group in &groups {
        let of_kind = groups.iter().filter(|other| other.kind == group.kind);
        let largest = of_kind.fold(0.0, |most, other| other.size.max(most));
        let share = match group.least {
            0.0 => LEAST_SHARE,
            _ => LEAST_SHARE_OF_STATE,
        };
        let size = group.size.max(share.powi(2) * largest);
        let size = size.max(group.least);
        if size != 0.0 {
            misfits.push(Misfit {
                error: (group.difference / size).sqrt(),
                difference: group.difference,
                name: group.name(),
            });
        }
    }
    misfits
}

/// Sums of squares over all components of a history.
struct HistorySums {
    stem: String,
    /// The unit; for a dimensionless history variable its name.
    kind: String,
    difference: f64,
    size: f64,
    /// Least sum by which differences are divided.
    least: f64,
}

impl HistorySums {
    fn of(column: &TableColumn) -> Self {
        let (stem, variable) = column.name.rsplit_once('.').unwrap_or(("", &column.name));
        let kind = match column.unit.as_str() {
            WITHOUT_UNIT => match variable.rsplit_once('_') {
                Some((variable, "xx" | "yy" | "zz" | "xy" | "yz" | "zx")) => variable,
                _ => variable,
            },
            unit => unit,
        };
        Self {
            stem: stem.into(),
            kind: kind.into(),
            difference: 0.0,
            size: 0.0,
            least: 0.0,
        }
    }
    fn name(&self) -> String {
        format!("{} [{}]", self.stem, self.kind)
    }
}

/// The value at a time by linear interpolation; `None` outside the samples.
fn interpolate(times: &[f64], values: &[f64], time: f64) -> Option<f64> {
    let after = times.partition_point(|&known| known < time);
    let (&end, &at_end) = (times.get(after)?, values.get(after)?);
    if end == time {
        return Some(at_end);
    }
    let before = after.checked_sub(1)?;
    let (start, at_start) = (times[before], *values.get(before)?);
    Some(at_start + (time - start) / (end - start) * (at_end - at_start))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(times: &[f64], scale: f64) -> Vec<TableColumn> {
        let of = |f: fn(f64) -> f64, scale: f64| times.iter().map(|&t| scale * f(t)).collect();
        vec![
            TableColumn::new("time", "s", times.to_vec()),
            TableColumn::new("a.ux", "m", of(|t| 3.0 * t, scale)),
            TableColumn::new("a.uy", "m", of(|t| 4.0 * t, scale)),
            TableColumn::new("b.ux", "m", of(|t| 1e-9 * t, 2.0)),
        ]
    }

    /// A history that is a hundredth too large has a misfit of a hundredth, whatever its sampling; a small history is
    /// measured against the largest.
    #[test]
    fn a_misfit_is_that_of_the_worst_history() {
        let finely: Vec<f64> = (0..=100).map(|i| 0.01 * f64::from(i)).collect();
        let coarsely: Vec<f64> = (0..=7).map(|i| f64::from(i) / 7.0).collect();
        let found = misfit(&table(&finely, 1.0), &table(&coarsely, 1.01), &[]);
        assert!((found.error - 0.01).abs() < 1e-12, "{found:?}");
        assert_eq!(found.name, "a [m]");
        let same = misfit(&table(&finely, 1.0), &table(&finely, 1.0), &[]);
        assert_eq!(same.error, 0.0);
        let mut still = table(&finely, 1.0);
        still[3].values.fill(0.0);
        let found = misfit(&table(&finely, 1.0), &still, &[]);
        assert!((found.error - 2e-9 / 5e-3).abs() < 1e-12, "{found:?}");
    }

    /// A small damage is measured against a tenth of the largest one; a small displacement against a thousandth of the
    /// largest.
    #[test]
    fn small_damage_is_measured_against_the_largest() {
        let table = |unit: &str, hairline: f64| {
            vec![
                TableColumn::new("time", "s", vec![0.0, 1.0]),
                TableColumn::new("a.damage", unit, vec![0.0, 0.5]),
                TableColumn::new("b.damage", unit, vec![0.0, hairline]),
            ]
        };
        for (unit, expected) in [("1", 0.02), ("m", 1.0)] {
            let found = misfit(&table(unit, 1e-3), &table(unit, 2e-3), &[]);
            assert!((found.error - expected).abs() < 1e-12, "{found:?}");
            assert!(found.name.starts_with("b ["));
        }
        // It does so even if the largest is excluded.
        let excluded = [SensitiveHistory {
            history: "a [damage]".into(),
            change: 1.0,
        }];
        let (reference, mut other) = (table("1", 1e-3), table("1", 2e-3));
        other[1].values = vec![0.0, 0.9];
        assert_eq!(misfit(&reference, &other, &[]).name, "a [damage]");
        let found = misfit(&reference, &other, &excluded);
        assert!((found.error - 0.02).abs() < 1e-12, "{found:?}");
    }

    /// Each dimensionless history variable is measured against its own norm, over all components.
    #[test]
    fn variables_without_a_unit_are_measured_one_by_one() {
        let table = |scale: f64| {
            vec![
                TableColumn::new("time", "s", vec![0.0, 1.0]),
                TableColumn::new("e.damage", "1", vec![0.0, 0.5]),
                TableColumn::new("e.strain_xx", "1", vec![0.0, 3e-6]),
                TableColumn::new("e.strain_xy", "1", vec![0.0, 4e-6 * scale]),
            ]
        };
        let found = misfit(&table(1.0), &table(1.5), &[]);
        assert!((found.error - 0.4).abs() < 1e-12, "{found:?}");
        assert_eq!(found.name, "e [strain]");
        // One that is zero in the reference is measured against a millionth; one with a unit has no misfit.
        let with = |crushed: f64, pulled: f64| {
            let mut table = table(1.0);
            let values = |value: f64| vec![value, value];
            table.push(TableColumn::new("e.crushed", "1", values(crushed)));
            table.push(TableColumn::new("e.xx", "Pa", values(pulled)));
            table
        };
        let found = misfit(&with(0.0, 0.0), &with(2e-8, 3.0), &[]);
        assert!((found.error - 0.02).abs() < 1e-12, "{found:?}");
    }
}
