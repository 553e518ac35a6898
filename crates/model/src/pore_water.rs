//! Element values of ground with water in its pores, by the names that results have for them.

use crate::{HistoryVariable, Stress};

/// Pressure of the water (Pa, compression positive): that of static states, and what it has risen by since.
pub const PORE_PRESSURE: HistoryVariable = HistoryVariable::amount("pore_pressure", "Pa");

/// What the pressure has risen by since the last drained static state (Pa).
pub const EXCESS_PORE_PRESSURE: HistoryVariable =
    HistoryVariable::amount("excess_pore_pressure", "Pa");

/// Rise of the pressure over the vertical effective stress of the last drained static state (1); zero where that is no
/// compression.
pub const PORE_PRESSURE_RATIO: HistoryVariable =
    HistoryVariable::amount("pore_pressure_ratio", "1");

/// Components of the mean effective stress (Pa, tension positive), total stress plus the pressure of the water, in the order of
/// [`Stress`](crate::Stress).
///
/// A block knows its pressure, the model its total stress: it is the model that answers these names, for elements whose block
/// answers [`PORE_PRESSURE`].
pub const EFFECTIVE_STRESS: [HistoryVariable; 6] = [
    HistoryVariable::component("effective_xx", "Pa"),
    HistoryVariable::component("effective_yy", "Pa"),
    HistoryVariable::component("effective_zz", "Pa"),
    HistoryVariable::component("effective_xy", "Pa"),
    HistoryVariable::component("effective_yz", "Pa"),
    HistoryVariable::component("effective_zx", "Pa"),
];

/// Effective stress (Pa) of a total stress and the pressure of the water (Pa).
pub fn effective_stress(total: Stress, pressure: f64) -> Stress {
    let [xx, yy, zz, xy, yz, zx] = total.0;
    Stress([xx + pressure, yy + pressure, zz + pressure, xy, yz, zx])
}
