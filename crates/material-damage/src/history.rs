//! History variables that several laws share.

use powerhouse_model::{HistoryVariable, Lane, array};

/// Dimensionless amount.
pub(crate) const fn number(name: &'static str) -> HistoryVariable {
    HistoryVariable::amount(name, "1")
}

/// Component of a strain.
pub(crate) const fn strain(name: &'static str) -> HistoryVariable {
    HistoryVariable::component(name, "1")
}

/// Yield state of a point, a [`YieldState`](crate::YieldState).
pub(crate) const YIELD_STATE: HistoryVariable = HistoryVariable::flags("yield_state");

/// Damage type of a point: 0 none, 1 tension, 2 shear or compression, 3 both.
pub(crate) const DAMAGE_TYPE: HistoryVariable = HistoryVariable::flags("damage_type");

/// Plastic strain, engineering shears.
pub(crate) const PLASTIC_STRAINS: [HistoryVariable; 6] = [
    strain("plastic_strain_xx"),
    strain("plastic_strain_yy"),
    strain("plastic_strain_zz"),
    strain("plastic_strain_xy"),
    strain("plastic_strain_yz"),
    strain("plastic_strain_zx"),
];

/// Copies a history of `N` variables. The constant length lets packs be moved as such:
/// `copy_from_slice` of a slice calls a function, which costs more than the elastic law.
#[inline(always)]
#[expect(clippy::manual_memcpy, reason = "a call is what this avoids")]
pub(crate) fn copy<L: Lane, const N: usize>(old: &[L], new: &mut [L]) {
    for i in 0..N {
        new[i] = old[i];
    }
}

/// Loads the `N` variables of a history into an array, to be changed before they are [`store`]d: numbers
/// in registers, where writing the new history twice would go through memory.
#[inline(always)]
pub(crate) fn load<L: Lane, const N: usize>(old: &[L]) -> [L; N] {
    array(|i| old[i])
}

/// Stores `N` variables in a new history.
#[inline(always)]
#[expect(clippy::manual_memcpy, reason = "a call is what this avoids")]
pub(crate) fn store<L: Lane, const N: usize>(variables: &[L; N], new: &mut [L]) {
    for i in 0..N {
        new[i] = variables[i];
    }
}
