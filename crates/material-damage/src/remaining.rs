//! What damage and plastic flow leave of the stiffness.

use powerhouse_model::{Lane, LawInput, RemainingStiffness, array};

/// Places of the damage of a law in its history.
#[derive(Clone, Copy)]
pub(crate) struct DamagePlaces {
    /// Of `D`, which falls where cracks close.
    pub(crate) whole: usize,
    /// Of the damage in tension and in compression, neither of which ever falls.
    pub(crate) parts: [usize; 2],
}

/// What is left after a step of plastic flow, whose strain begins the history: `1 - D` of stiffness damping
/// and `(1 - d_t)(1 - d_c)` of hourglass stiffness, whatever plastic strain was reached. Hourglass stiffness
/// does not come back where cracks close: a spring that stiffens under load would make energy.
#[inline(always)]
pub(crate) fn of_flow<L: Lane>(
    input: &LawInput<L>,
    new_history: &[L],
    damage: Option<DamagePlaces>,
) -> RemainingStiffness<L> {
    let one = new_history[0].constant(1.0);
    let mut remaining = RemainingStiffness::whole(one)
        .with_plastic_strain_increment(array(|i| new_history[i] - input.history[i]));
    if let Some(DamagePlaces { whole, parts }) = damage {
        remaining = remaining
            .with_undamaged(one - new_history[whole])
            .with_hourglass((one - new_history[parts[0]]) * (one - new_history[parts[1]]));
    }
    remaining
}
