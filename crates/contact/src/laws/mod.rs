//! Contact laws of joints.

mod bonded_coulomb;
mod cohesive;
mod frictionless;
mod paper;
mod slip_weakening;
mod tied;

pub use bonded_coulomb::{BondedCoulomb, BondedCoulombParameters};
pub use cohesive::{Cohesive, CohesiveParameters, StrengthReduction};
pub use frictionless::Frictionless;
pub use paper::{Paper, PaperParameters};
pub use slip_weakening::{SlipWeakening, SlipWeakeningParameters};
pub use tied::Tied;

use powerhouse_model::{Bond, ContactState, JointResponse, JointState, ParameterError, Vec3};

/// Size of the tangential part of a traction (Pa).
#[inline(always)]
fn shear(traction: &Vec3) -> f64 {
    (traction.y * traction.y + traction.z * traction.z).sqrt()
}

/// Traction with a given normal part and the shear of a trial, reduced to a strength where it exceeds it (Pa).
#[inline(always)]
fn with_shear(normal: f64, trial: &Vec3, shear: f64, strength: f64) -> Vec3 {
    let share = if shear > strength {
        strength / shear
    } else {
        1.0
    };
    Vec3::new(normal, trial.y * share, trial.z * share)
}

/// Initial state of a pair: bonded if one of the strengths (Pa) is above zero.
fn initial_state(cohesion: f64, tensile_strength: f64) -> JointState {
    let bonded = cohesion > 0.0 || tensile_strength > 0.0;
    JointState::default().with_bond(if bonded { Bond::Intact } else { Bond::Never })
}

/// Bond after its strength is exceeded: broken, if there ever was one.
#[inline(always)]
fn failed(bond: Bond) -> Bond {
    match bond {
        Bond::Never => Bond::Never,
        Bond::Intact | Bond::Softening | Bond::Broken => Bond::Broken,
    }
}

/// Response of a pair that opens: no traction.
#[inline(always)]
fn opened(bond: Bond, state: &JointState) -> JointResponse {
    let state = state.with_contact(ContactState::Open).with_bond(bond);
    JointResponse::new(Vec3::zeros(), state)
}

/// Checks a strength (Pa): not negative, possibly infinite.
fn check_strength(name: &'static str, value: f64) -> Result<(), ParameterError> {
    let (least, most) = (0.0, f64::INFINITY);
    if value >= least {
        return Ok(());
    }
    Err(ParameterError {
        name,
        value,
        least,
        most,
    })
}

/// Checks coefficients of static and dynamic friction: not negative, the second not above the first.
fn check_friction(resting: f64, sliding: f64) -> Result<(), ParameterError> {
    ParameterError::check("static_friction", resting, 0.0, f64::MAX)?;
    ParameterError::check("dynamic_friction", sliding, 0.0, resting)
}

/// Root in 0 to a bound of a function that falls, positive at 0 and not at the bound; 0 if it is not positive there.
fn bisected(function: impl Fn(f64) -> f64, bound: f64) -> f64 {
    let (mut low, mut high) = (0.0, bound);
    if function(low) <= 0.0 {
        return 0.0;
    }
    // Secants with halving where they do not shrink the interval (Illinois), to the last bits.
    let (mut at_low, mut at_high) = (function(low), function(high));
    for _ in 0..100 {
        if high - low <= f64::EPSILON * high || at_high == 0.0 {
            break;
        }
        let finite = at_low.is_finite() && at_low > at_high;
        let mut next = if finite {
            (low * -at_high + high * at_low) / (at_low - at_high)
        } else {
            0.5 * (low + high)
        };
        if !(next > low && next < high) {
            next = 0.5 * (low + high);
        }
        let value = function(next);
        if value > 0.0 {
            (low, at_low) = (next, value);
            at_high *= 0.5;
        } else {
            (high, at_high) = (next, value);
            at_low *= 0.5;
        }
        if value == 0.0 {
            break;
        }
    }
    high
}
