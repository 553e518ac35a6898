//! Remarks about gravity, in-situ stress and construction stages.

use super::quoted;

remark! {
    /// Warning: bodies under gravity that nothing restrains along it (no support, prescribed motion or boundary spring
    /// with a component along gravity), in a scene without stages, user constraints and boundary elements: they fall
    /// freely. Parts that share nodes, joints or periodic pairs are one body.
    pub struct UnsupportedBody {
        /// Element sets of the parts with an element in such a body.
        pub sets: Vec<String>,
    }
    Warning(Run),
    "the body of {} is under gravity and has no support: it falls; give it supports, or a stage in which it reaches static equilibrium",
    quoted(sets)
}

remark! {
    /// Warning: gravity acts on a supported body from the start of the run, in a scene without a stage in which the body
    /// reaches static equilibrium: it oscillates about its equilibrium. Gravity that grows from zero is no warning.
    pub struct SuddenGravity {}
    Warning(Run),
    "gravity is applied suddenly at the start of the run, and the body oscillates about its static equilibrium; add a stage, in which it reaches equilibrium before"
}

remark! {
    /// Warning: construction stages without in-situ stress and without loads, in which nothing happens.
    pub struct IdleStages {}
    Warning(Run),
    "the stages have neither `[in_situ_stress]` nor loads: nothing deforms in them; the stress of the ground is given by both `[in_situ_stress]` and a [[load]] of kind `gravity`"
}

remark! {
    /// Warning: the in-situ stress of stages grows with depth as that of ground under its weight, but no gravity acts.
    pub struct WeightlessGround {}
    Warning(Run),
    "`[in_situ_stress]` grows with depth, as of ground under its weight, but no [[load]] of kind `gravity` acts: the first stage is out of balance by all of the weight"
}

remark! {
    /// Warning: the body at the start of the first stage reaches above the level of a geostatic in-situ stress, which is
    /// zero there.
    pub struct AboveGround {
        /// Height z of the ground surface (m).
        pub level: f64,
        /// Greatest height z of the body (m).
        pub top: f64,
    }
    Warning(Run),
    "the in-situ stress of the ground is zero above its level of {level} m, and the body reaches up to {top} m"
}

remark! {
    /// Warning after the run: the in-situ stress is not in equilibrium with loads and supports of the first stage, by
    /// more than 5 % of the load; only if that stage neither excavates nor casts.
    pub struct Unbalanced {
        /// Name of the first stage.
        pub stage: String,
        /// Unbalanced force at the start of the stage over the force of the load (1).
        pub share: f64,
        /// Largest displacement until equilibrium (m).
        pub displacement: f64,
        /// Number of the node with this displacement in the mesh file.
        pub node: u64,
    }
    Warning(Run),
    "the in-situ stress leaves an unbalanced force of {:.1} % of the load at the start of stage '{stage}', and the body moved by up to {displacement:.3e} m (node {node}) until equilibrium: stress, density, gravity, surface loads and supports are inconsistent, and the stress is no longer the given one (in a mesh that is hollow from the start the force is that of its opening)",
    100.0 * share
}
