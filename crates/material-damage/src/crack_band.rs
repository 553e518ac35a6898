//! Width of a band of cracks or of crushing, a history variable from first damage on.

use powerhouse_model::{Extents, HistoryVariable, Lane};

/// History variable: width of the element along the normal of the crack at first damage (m), zero before.
pub(crate) const CRACK_BAND_WIDTH: HistoryVariable =
    HistoryVariable::amount("crack_band_width", "m");
/// History variable: width of the element along the axis of crushing at first damage (m), zero before.
pub(crate) const CRUSHING_BAND_WIDTH: HistoryVariable =
    HistoryVariable::amount("crushing_band_width", "m");

/// Width of a band (m): that of the history, or that of the element along a unit vector before first
/// damage.
#[inline(always)]
pub(crate) fn width<L: Lane>(stored: L, extents: &Extents<L>, normal: &[L; 3]) -> L {
    stored.select(stored.constant(0.0).less(stored), extents.along(normal))
}

/// History value of the width after a step (m): that of the step where there is damage or softening.
#[inline(always)]
pub(crate) fn updated<L: Lane>(before: L, width: L, damage: L) -> L {
    width.select(damage.constant(0.0).less(damage), before)
}
