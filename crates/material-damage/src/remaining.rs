//! What damage and plastic flow leave of the stiffness.

use powerhouse_model::{Lane, LawInput, RemainingStiffness, array};

/// What is left after a step of plastic flow, whose strain begins the history, with the damage at a
/// place of it, if there is any: `1 - D`, whatever plastic strain was reached.
#[inline(always)]
pub(crate) fn of_flow<L: Lane>(
    input: &LawInput<L>,
    new_history: &[L],
    damage: Option<usize>,
) -> RemainingStiffness<L> {
    let one = new_history[0].constant(1.0);
    let undamaged = match damage {
        Some(place) => one - new_history[place],
        None => one,
    };
    RemainingStiffness {
        undamaged,
        of_path: undamaged,
        flowed: array(|i| new_history[i] - input.history[i]),
    }
}
