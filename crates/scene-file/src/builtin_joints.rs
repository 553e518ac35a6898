//! Built-in contact laws of joints, registered in every registry.

use powerhouse_contact::{BondedCoulomb, Cohesive, Frictionless, Paper, SlipWeakening, Tied};
use schemars::JsonSchema;
use serde::Deserialize;

use crate::Registry;

pub(crate) fn register(registry: &mut Registry) {
    registry.add_joint_law("tied", |_: NoKeys| Ok(Box::new(Tied)));
    registry.add_joint_law("frictionless", |_: NoKeys| Ok(Box::new(Frictionless)));
    registry.add_joint_law("bonded-coulomb", |p| Ok(Box::new(BondedCoulomb::new(p)?)));
    registry.add_joint_law("cohesive", |p| Ok(Box::new(Cohesive::new(p)?)));
    registry.add_joint_law("paper", |p| Ok(Box::new(Paper::new(p)?)));
    registry.add_joint_law("slip-weakening", |p| Ok(Box::new(SlipWeakening::new(p)?)));
}

/// Keys of a law without parameters.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct NoKeys {}
