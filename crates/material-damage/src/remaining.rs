//! Remaining stiffness after damage and plastic flow.

use powerhouse_model::{Lane, LawInput, RemainingStiffness, array};

/// Indices of the damage variables of a law in its history.
#[derive(Clone, Copy)]
pub(crate) struct DamageIndices {
    /// Index of `D`, which falls where cracks close.
    pub(crate) whole: usize,
    /// Indices of the damage in tension and in compression, neither of which ever falls.
    pub(crate) parts: [usize; 2],
}

/// Remaining stiffness after a step of plastic flow. The history begins with the plastic strain; the
/// factors are `1 - D` for stiffness damping and `(1 - d_t)(1 - d_c)` for hourglass stiffness. Hourglass
/// stiffness does not recover where cracks close: a spring that stiffens under load would generate energy.
#[inline(always)]
pub(crate) fn of_flow<L: Lane>(
    input: &LawInput<L>,
    new_history: &[L],
    damage: Option<DamageIndices>,
) -> RemainingStiffness<L> {
    let one = new_history[0].constant(1.0);
    let mut remaining = RemainingStiffness::whole(one)
        .with_plastic_strain_increment(array(|i| new_history[i] - input.history[i]));
    if let Some(DamageIndices { whole, parts }) = damage {
        remaining = remaining
            .with_undamaged(one - new_history[whole])
            .with_hourglass((one - new_history[parts[0]]) * (one - new_history[parts[1]]));
    }
    remaining
}
