//! Built-in contact laws of joints, registered in every registry.

use powerhouse_contact::{
    BondedCoulomb, BondedCoulombParameters, Cohesive, CohesiveParameters, Frictionless, Paper,
    PaperParameters, SlipWeakening, SlipWeakeningParameters, StrengthReduction, Tied,
};
use schemars::JsonSchema;
use serde::Deserialize;

use crate::Registry;
use crate::spec::{NonNegative, Positive};

pub(crate) fn register(registry: &mut Registry) {
    registry.add_joint_law("tied", |_: NoKeys| Ok(Box::new(Tied)));
    registry.add_joint_law("frictionless", |_: NoKeys| Ok(Box::new(Frictionless)));
    registry.add_joint_law("bonded-coulomb", |keys: BondedCoulombKeys| {
        Ok(Box::new(BondedCoulomb::new(BondedCoulombParameters {
            cohesion: keys.cohesion.map_or(0.0, NonNegative::get),
            tensile_strength: keys.tensile_strength.map_or(0.0, NonNegative::get),
            static_friction: keys.static_friction.get(),
            dynamic_friction: keys.dynamic_friction.unwrap_or(keys.static_friction).get(),
            cohesion_loss: keys.cohesion_loss,
        })?))
    });
    registry.add_joint_law("cohesive", |keys: CohesiveKeys| {
        let energy = keys.opening_energy.get();
        Ok(Box::new(Cohesive::new(CohesiveParameters {
            tensile_strength: keys.tensile_strength.get(),
            cohesion: keys.cohesion.get(),
            opening_energy: energy,
            shear_energy: keys
                .shear_energy
                .map_or(SHEAR_OVER_OPENING * energy, Positive::get),
            mode_exponent: keys.mode_exponent.map_or(MODE_EXPONENT, Positive::get),
            static_friction: keys.static_friction.get(),
            dynamic_friction: keys.dynamic_friction.unwrap_or(keys.static_friction).get(),
            reduction: if keys.reduce {
                StrengthReduction::ByMedia
            } else {
                StrengthReduction::None
            },
        })?))
    });
    registry.add_joint_law("paper", |bond: BondKeys| {
        Ok(Box::new(Paper::new(PaperParameters {
            cohesion: bond.cohesion.map_or(0.0, NonNegative::get),
            tensile_strength: bond.tensile_strength.map_or(0.0, NonNegative::get),
            static_friction: bond.static_friction.get(),
            dynamic_friction: bond.dynamic_friction.unwrap_or(bond.static_friction).get(),
        })?))
    });
    registry.add_joint_law("slip-weakening", |keys: SlipWeakeningKeys| {
        Ok(Box::new(SlipWeakening::new(SlipWeakeningParameters {
            static_friction: keys.static_friction.get(),
            dynamic_friction: keys.dynamic_friction.get(),
            slip_distance: keys.slip_distance.get(),
        })?))
    });
}

/// Keys of a law without parameters.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct NoKeys {}

/// Strengths of a bond and friction, after Wang, Chen & Xiao (2019), Eqs. 22 to 24.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct BondKeys {
    /// Cohesion (Pa), 0 by default.
    cohesion: Option<NonNegative>,
    /// Tensile strength (Pa), 0 by default.
    tensile_strength: Option<NonNegative>,
    /// Static friction coefficient.
    static_friction: NonNegative,
    /// Dynamic friction coefficient, at most the static one and the same by default.
    dynamic_friction: Option<NonNegative>,
}

/// A brittle bond, then Coulomb friction.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct BondedCoulombKeys {
    /// Cohesion (Pa), 0 by default.
    cohesion: Option<NonNegative>,
    /// Tensile strength (Pa), 0 by default.
    tensile_strength: Option<NonNegative>,
    /// Static friction coefficient.
    static_friction: NonNegative,
    /// Dynamic friction coefficient, at most the static one and the same by default.
    dynamic_friction: Option<NonNegative>,
    /// Whether slip destroys the bond; it does by default.
    #[serde(default = "lost")]
    cohesion_loss: bool,
}

fn lost() -> bool {
    true
}

/// Default of the fracture energy in shear over that in opening.
const SHEAR_OVER_OPENING: f64 = 10.0;
/// Default of the exponent of mixed modes.
const MODE_EXPONENT: f64 = 2.0;

/// A bond that fails gradually, with fracture energies, and Coulomb friction.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct CohesiveKeys {
    /// Tensile strength (Pa).
    tensile_strength: Positive,
    /// Cohesion (Pa).
    cohesion: Positive,
    /// Fracture energy in opening (J/m2).
    opening_energy: Positive,
    /// Fracture energy in shear (J/m2), at least that in opening; ten times that by default.
    shear_energy: Option<Positive>,
    /// Exponent of mixed modes after Benzeggagh and Kenane, 2 by default.
    mode_exponent: Option<Positive>,
    /// Static friction coefficient.
    static_friction: NonNegative,
    /// Dynamic friction coefficient, at most the static one and the same by default.
    dynamic_friction: Option<NonNegative>,
    /// Whether strengths are reduced where the mesh does not resolve the failure, with the energies kept; they are by default.
    #[serde(default = "reduced")]
    reduce: bool,
}

fn reduced() -> bool {
    true
}

/// Friction that falls with slip.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct SlipWeakeningKeys {
    /// Static friction coefficient.
    static_friction: NonNegative,
    /// Dynamic friction coefficient, at most the static one.
    dynamic_friction: NonNegative,
    /// Slip over which friction falls from one to the other (m).
    slip_distance: Positive,
}
