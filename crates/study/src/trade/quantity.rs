//! Quantities of histories that are compared.

use std::collections::BTreeSet;

use powerhouse::io::TableColumn;
use powerhouse::model::HistoryKind;
use powerhouse::{OutputPlan, Scene};

/// Quantity of a recorded history.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Quantity {
    /// Displacement of a point (m).
    Displacement,
    /// Displacement of a point relative to another (m).
    Relative,
    /// Velocity of a point (m/s).
    Velocity,
    /// Acceleration of a point (m/s2).
    Acceleration,
    /// Stress of an element (Pa).
    Stress,
    /// History variable of an element's law, except flags.
    State,
}

impl Quantity {
    /// All quantities.
    pub const ALL: [Self; 6] = [
        Self::Displacement,
        Self::Relative,
        Self::Velocity,
        Self::Acceleration,
        Self::Stress,
        Self::State,
    ];

    /// Name of the quantity in commands.
    #[must_use]
    pub fn keyword(self) -> &'static str {
        match self {
            Self::Relative => "relative",
            other => other.name(),
        }
    }

    /// Name of the quantity in messages.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Displacement => "displacement",
            Self::Relative => "relative displacement",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
            Self::Stress => "stress",
            Self::State => "state",
        }
    }

    /// Whether an output plan requests histories of the quantity.
    pub(super) fn is_recorded(self, plan: &OutputPlan) -> bool {
        let motions = || plan.histories.iter().map(|request| request.motion);
        match self {
            Self::Displacement => motions().any(|motion| motion.displacement),
            Self::Velocity => motions().any(|motion| motion.velocity),
            Self::Acceleration => motions().any(|motion| motion.acceleration),
            Self::Relative => !plan.relative.is_empty(),
            Self::Stress => !plan.stresses.is_empty(),
            Self::State => !plan.state.places.is_empty(),
        }
    }
}

/// Selection of the columns of a scene's histories that are compared.
pub(super) struct Compared {
    /// Quantities that the scene records.
    pub(super) recorded: Vec<Quantity>,
    /// Quantities that are compared.
    pub(super) quantities: Vec<Quantity>,
    /// Names of histories of relative displacements.
    relative: BTreeSet<String>,
    /// Names of history variables that are flags, for which a relative error is meaningless.
    flags: BTreeSet<&'static str>,
}

impl Compared {
    /// The selection of all quantities that a scene records.
    pub(super) fn of(scene: &Scene) -> Self {
        let plan = scene.output();
        let variables = scene
            .parts()
            .iter()
            .flat_map(|part| part.material.history());
        let flags = variables.filter(|variable| variable.kind == HistoryKind::Flags);
        let recorded = Quantity::ALL.into_iter();
        let recorded: Vec<Quantity> = recorded
            .filter(|quantity| quantity.is_recorded(plan))
            .collect();
        Self {
            quantities: recorded.clone(),
            recorded,
            relative: plan
                .relative
                .iter()
                .map(|request| request.name.clone())
                .collect(),
            flags: flags.map(|variable| variable.name).collect(),
        }
    }

    /// Time (the first column) and the compared columns.
    pub(super) fn among(&self, columns: Vec<TableColumn>) -> Vec<TableColumn> {
        after_time(columns, |column| self.counts(column))
    }

    /// Time (the first column) and the columns of motions.
    pub(super) fn motions(&self, columns: &[TableColumn]) -> Vec<TableColumn> {
        let is_of_element = |quantity| [Quantity::Stress, Quantity::State].contains(&quantity);
        after_time(columns.to_vec(), |column| {
            !is_of_element(self.quantity(column))
        })
    }

    fn counts(&self, column: &TableColumn) -> bool {
        let own = column.name.as_str();
        let variable = own.rsplit_once('.').map_or(own, |(_, name)| name);
        self.quantities.contains(&self.quantity(column)) && !self.flags.contains(variable)
    }

    /// The quantity of a column.
    fn quantity(&self, column: &TableColumn) -> Quantity {
        let stem = column.name.rsplit_once('.').map_or("", |(stem, _)| stem);
        match column.unit.as_str() {
            "m" if self.relative.contains(stem) => Quantity::Relative,
            "m" => Quantity::Displacement,
            "m/s" => Quantity::Velocity,
            "m/s2" => Quantity::Acceleration,
            "Pa" => Quantity::Stress,
            _ => Quantity::State,
        }
    }
}

/// The first column, time, and those of the others that meet a condition.
fn after_time(
    mut columns: Vec<TableColumn>,
    is_wanted: impl Fn(&TableColumn) -> bool,
) -> Vec<TableColumn> {
    let mut count = 0;
    columns.retain(|column| {
        count += 1;
        count == 1 || is_wanted(column)
    });
    columns
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Time is kept, flags are dropped, and of the other columns the requested quantities are kept.
    #[test]
    fn columns_are_selected_by_quantity() {
        let column = |name: &str, unit: &str| TableColumn::new(name, unit, vec![0.0]);
        let columns = || {
            vec![
                column("time", "s"),
                column("A.ux", "m"),
                column("A-B.ux", "m"),
                column("A.ax", "m/s2"),
                column("E.xx", "Pa"),
                column("E.damage", "1"),
                column("E.yield_state", "1"),
            ]
        };
        let names = |quantities: &[Quantity]| {
            let compared = Compared {
                recorded: Quantity::ALL.into(),
                quantities: quantities.to_vec(),
                relative: ["A-B".to_owned()].into(),
                flags: ["yield_state"].into(),
            };
            let left = compared.among(columns()).into_iter();
            left.map(|column| column.name).collect::<Vec<String>>()
        };
        assert_eq!(names(&[Quantity::Relative]), ["time", "A-B.ux"]);
        let both = [Quantity::Displacement, Quantity::State];
        assert_eq!(names(&both), ["time", "A.ux", "E.damage"]);
        assert_eq!(names(&Quantity::ALL).len(), 6);
    }
}
