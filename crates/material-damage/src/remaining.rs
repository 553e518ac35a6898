//! What damage and plastic flow leave of the stiffness.

use powerhouse_model::{ElasticMedium, Lane, LawInput, RemainingStiffness, array};

/// Below this a strain at first yield counts as this: materials without cohesion have none.
const LEAST: f64 = 1.0e-6;

/// The axial strain at which uniaxial compression yields.
pub(crate) fn strain_at_yield(strength: f64, medium: &ElasticMedium) -> f64 {
    (strength / medium.young).max(LEAST)
}

/// What is left after a step of plastic flow, whose strain begins the history, with the damage at a
/// place of it, if there is any: of the path `(1 - D) e_y / (e_y + e_p)` with the norm `e_p = sqrt(2/3
/// epsilon_p : epsilon_p)` of the plastic strain, shears halved.
#[inline(always)]
pub(crate) fn of_flow<L: Lane>(
    input: &LawInput<L>,
    new_history: &[L],
    damage: Option<usize>,
    strain_at_yield: f64,
) -> RemainingStiffness<L> {
    let number = |value: f64| new_history[0].constant(value);
    let undamaged = match damage {
        Some(place) => number(1.0) - new_history[place],
        None => number(1.0),
    };
    let [xx, yy, zz, xy, yz, zx]: [L; 6] = array(|i| new_history[i]);
    let normal = xx.mul_add(xx, yy.mul_add(yy, zz * zz));
    let shear = xy.mul_add(xy, yz.mul_add(yz, zx * zx));
    let square = shear.mul_add(number(0.5), normal) * number(2.0 / 3.0);
    let first = number(strain_at_yield);
    RemainingStiffness {
        undamaged,
        of_path: undamaged * (first / (first + square.sqrt())),
        flowed: array(|i| new_history[i] - input.history[i]),
    }
}
