//! The width of a band of cracks or of crushing, kept from its first damage on.

use powerhouse_model::{Extents, HistoryVariable, Lane};

/// The width of the element along the normal of the crack at first damage (m), zero before.
pub(crate) const CRACK_BAND_WIDTH: HistoryVariable =
    HistoryVariable::amount("crack_band_width", "m");
/// The width of the element along the axis of crushing at first damage (m), zero before.
pub(crate) const CRUSHING_BAND_WIDTH: HistoryVariable =
    HistoryVariable::amount("crushing_band_width", "m");

/// The width of a band (m): the one that was kept, or that of the element along a unit vector where
/// none is kept yet.
#[inline(always)]
pub(crate) fn width<L: Lane>(kept: L, extents: &Extents<L>, normal: &[L; 3]) -> L {
    kept.select(kept.constant(0.0).less(kept), extents.along(normal))
}

/// The width that is kept after a step (m): that of the step where there is damage or softening.
#[inline(always)]
pub(crate) fn kept<L: Lane>(before: L, width: L, damage: L) -> L {
    width.select(damage.constant(0.0).less(damage), before)
}
