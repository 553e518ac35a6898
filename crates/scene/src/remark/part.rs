//! Remarks about parts, their materials and damping.

use powerhouse_laws::DampingCost;

remark! {
    /// Warning: no part and no stage uses a material.
    pub struct UnusedMaterial {
        /// Name of the material.
        pub name: String,
    }
    Warning(Run),
    "material '{name}' is used by no part and no stage"
}

remark! {
    /// Warning: the set of a support, load or added mass is empty, so that it has no effect.
    pub struct EmptySet {
        /// Name of the set.
        pub set: String,
    }
    Warning(Run),
    "the set '{set}' of a support, load or added mass is empty: it has no effect"
}

remark! {
    /// Warning: parameters of a material are inconsistent ([`Material::warnings`](powerhouse_laws::Material::warnings)).
    pub struct Material {
        /// Element set of the part.
        pub set: String,
        /// Description of the inconsistency.
        pub warning: String,
    }
    Warning(Run),
    "material of part '{set}': {warning}"
}

remark! {
    /// Warning: a part with a nonlinear law has stiffness-proportional damping, which is proportional to the degraded
    /// stiffness and whose stress is not contained in any output.
    pub struct DampedHistory {
        /// Element set of the part.
        pub set: String,
        /// Name of the law.
        pub law: String,
    }
    Warning(Run),
    "part '{set}' with the law '{law}' has stiffness-proportional damping: where it yields or cracks the damping is proportional to the degraded stiffness, and its stress adds to that of the law, so that the total may exceed the strength; outputs of stress and section forces do not contain it. Flat damping stays within the strength: damping = {{ kind = \"flat\", ... }}"
}

remark! {
    /// Fact: accuracy and cost of flat damping of a part.
    pub struct FlatDamping {
        /// Element set of the part.
        pub set: String,
        /// Accuracy and cost.
        pub cost: DampingCost,
        /// Whether it is the default damping of the material.
        pub by_default: bool,
    }
    Fact(Run),
    "damping of part '{set}'{}: {cost}",
    if *by_default {
        " (that of the preset of its material; `damping = \"none\"` switches it off)"
    } else {
        ""
    }
}
