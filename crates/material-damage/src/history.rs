//! History variables that several laws have.

use powerhouse_model::HistoryVariable;

/// A history variable without a unit.
pub(crate) const fn number(name: &'static str) -> HistoryVariable {
    HistoryVariable { name, unit: "1" }
}

/// Plastic strains, engineering shears.
pub(crate) const PLASTIC_STRAINS: [HistoryVariable; 6] = [
    number("plastic_strain_xx"),
    number("plastic_strain_yy"),
    number("plastic_strain_zz"),
    number("plastic_strain_xy"),
    number("plastic_strain_yz"),
    number("plastic_strain_zx"),
];
