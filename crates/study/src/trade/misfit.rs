//! How far the histories of a run are from those of another.

use powerhouse::io::TableColumn;

use super::Unrepeated;

/// Histories below this share of the largest of their unit are measured against that share of it.
const LEAST_SHARE: f64 = 1e-3;
/// History variables of laws without a unit, strains and damage, counts against this at least, and against this
/// share of the largest of its variable: where next to nothing cracks, a hairline more or less is no error.
const LEAST_STATE: f64 = 1e-6;
const LEAST_SHARE_OF_STATE: f64 = 0.1;

/// The unit of what has none.
const WITHOUT_UNIT: &str = "1";

/// How far a history is from its reference.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Misfit {
    /// The relative L2 difference.
    pub(crate) error: f64,
    /// The squares of all differences, summed.
    pub(crate) difference: f64,
    /// The history.
    pub(crate) name: String,
}

/// The worst of the [misfits] of all histories but some, which still say what is large.
pub(super) fn misfit(
    reference: &[TableColumn],
    found: &[TableColumn],
    left_out: &[Unrepeated],
) -> Misfit {
    let mut worst = Misfit {
        error: 0.0,
        difference: 0.0,
        name: String::new(),
    };
    for other in misfits(reference, found) {
        let counts = left_out.iter().all(|known| known.history != other.name);
        if counts && (other.error >= worst.error || other.error.is_nan()) {
            worst = other;
        }
    }
    worst
}

/// The name of the history that a column belongs to: the components of one motion or one variable at one
/// place are one.
pub(super) fn history_of(column: &TableColumn) -> String {
    Group::of(column).name()
}

/// The relative L2 differences of all histories from their reference; the components of one motion or one
/// variable at one place count together. Of a unit of which the reference has nothing but zero there is no
/// relative error. The first column of both tables is time; what the reference lacks is passed over.
pub(crate) fn misfits(reference: &[TableColumn], found: &[TableColumn]) -> Vec<Misfit> {
    let mut groups: Vec<Group> = Vec::new();
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
        let group = Group::of(column);
        let known = |other: &Group| other.stem == group.stem && other.kind == group.kind;
        let place = groups.iter().position(known).unwrap_or_else(|| {
            groups.push(group);
            groups.len() - 1
        });
        for (instant, value) in time.values.iter().zip(&column.values) {
            if let Some(at) = interpolate(&other.values, &same.values, *instant) {
                groups[place].difference += (at - value).powi(2);
                groups[place].least += match column.unit.as_str() {
                    WITHOUT_UNIT => LEAST_STATE.powi(2),
                    _ => 0.0,
                };
                groups[place].size += value.powi(2);
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

/// Squares summed over the components of one motion or one variable at one place.
struct Group {
    stem: String,
    /// The unit; of a history variable without one, its name.
    kind: String,
    difference: f64,
    size: f64,
    /// What the size is taken for at least.
    least: f64,
}

impl Group {
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

/// The value at a time, linear between samples; none outside of them.
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

    /// A history that is a hundredth too large is off by a hundredth, whatever times it is sampled at;
    /// one that hardly moves counts against the largest.
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

    /// A place where next to nothing cracks counts against a tenth of what cracks elsewhere; in metres such a
    /// place counts against a thousandth.
    #[test]
    fn what_hardly_cracks_counts_against_what_does() {
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
        // It does so where what cracks does not count itself.
        let left_out = [Unrepeated {
            history: "a [damage]".into(),
            change: 1.0,
        }];
        let (reference, mut other) = (table("1", 1e-3), table("1", 2e-3));
        other[1].values = vec![0.0, 0.9];
        assert_eq!(misfit(&reference, &other, &[]).name, "a [damage]");
        let found = misfit(&reference, &other, &left_out);
        assert!((found.error - 0.02).abs() < 1e-12, "{found:?}");
    }

    /// History variables of laws has no unit: each variable is measured against its own size, components together.
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
        // One that the reference never has counts against a millionth, one of a unit against nothing.
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
