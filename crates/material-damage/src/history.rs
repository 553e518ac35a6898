//! History variables that several laws have.

use powerhouse_model::{HistoryVariable, Lane, array};

/// An amount without a unit.
pub(crate) const fn number(name: &'static str) -> HistoryVariable {
    HistoryVariable::amount(name, "1")
}

/// A component of a strain.
pub(crate) const fn strain(name: &'static str) -> HistoryVariable {
    HistoryVariable::component(name, "1")
}

/// How a point yields, a [`YieldState`](crate::YieldState).
pub(crate) const YIELD_STATE: HistoryVariable = HistoryVariable::flags("yield_state");

/// What has damaged a point: 0 nothing, 1 tension, 2 shear or compression, 3 both.
pub(crate) const DAMAGE_TYPE: HistoryVariable = HistoryVariable::flags("damage_type");

/// Plastic strains, engineering shears.
pub(crate) const PLASTIC_STRAINS: [HistoryVariable; 6] = [
    strain("plastic_strain_xx"),
    strain("plastic_strain_yy"),
    strain("plastic_strain_zz"),
    strain("plastic_strain_xy"),
    strain("plastic_strain_yz"),
    strain("plastic_strain_zx"),
];

/// Takes a history of `N` variables over as it is. The length is known here, so that packs are moved as
/// such: `copy_from_slice` of a slice calls a function, which costs more than the elastic law.
#[inline(always)]
#[expect(clippy::manual_memcpy, reason = "a call is what this avoids")]
pub(crate) fn keep<L: Lane, const N: usize>(old: &[L], new: &mut [L]) {
    for i in 0..N {
        new[i] = old[i];
    }
}

/// The `N` variables of a history, to be changed before they are [`put`] down: numbers that stay in
/// registers, where writing them into the new history twice would go through memory.
#[inline(always)]
pub(crate) fn taken<L: Lane, const N: usize>(old: &[L]) -> [L; N] {
    array(|i| old[i])
}

/// Writes `N` variables into a new history.
#[inline(always)]
#[expect(clippy::manual_memcpy, reason = "a call is what this avoids")]
pub(crate) fn put<L: Lane, const N: usize>(variables: &[L; N], new: &mut [L]) {
    for i in 0..N {
        new[i] = variables[i];
    }
}
