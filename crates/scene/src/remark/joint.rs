//! Remarks about joints and bolts.

use powerhouse_model::Renewal;

use crate::Results;

remark! {
    /// Warning after the run: slip or opening of a joint is above a tenth of the shortest edge, too large for node pairs
    /// that are fixed (small-slip assumption).
    pub struct LargeSlip {
        /// Name of the joint.
        pub joint: String,
        /// Largest accumulated slip or opening of a pair over the shortest edge of the facets (1).
        pub share: f64,
    }
    Warning(Joints),
    "joint '{joint}' slipped or opened by {share:.2} of the shortest edge of its facets; its node pairs are fixed, which is accurate up to about {:.2}",
    Results::SMALL_SLIP
}

remark! {
    /// Fact: a joint is re-initialised in a construction stage or at the start of the run, from where its opening,
    /// slip and energies are counted.
    pub struct JointRenewed {
        /// Name of the joint.
        pub joint: String,
        /// Name of the last stage that does so; `None` for the start of the run.
        pub stage: Option<String>,
        /// Whether it is grouted, or its tie is removed.
        pub renewal: Renewal,
    }
    Fact(Joints),
    "opening, slip and energies of joint '{joint}' are counted from {}, where {}",
    match stage {
        Some(stage) => format!("its position before stage '{stage}'"),
        None => "its position at the start of the run".to_owned(),
    },
    match renewal {
        Renewal::Grouted => "it was grouted",
        Renewal::Released => "its tie was removed",
    }
}

remark! {
    /// Warning: the strength of a joint is reduced where the mesh does not resolve the failure of its bond.
    pub struct ReducedStrength {
        /// Name of the joint.
        pub joint: String,
        /// Least factor of a strength (1).
        pub factor: f64,
        /// Area of the pairs whose strength is reduced (m2).
        pub area: f64,
        /// Area of all pairs (m2).
        pub of: f64,
    }
    Warning(Joints),
    "the mesh does not resolve how the bond of joint '{joint}' fails: its strength is reduced to {factor:.2} of its own, its fracture energies are kept, on {:.0} % of its area ({area:.1} m2); cracks begin too early, their energy and final area are as with smaller elements",
    100.0 * area / of
}

remark! {
    /// Warning: a joint slides with friction, and a part beside it has no damping of high frequencies: oscillations of sliding
    /// bodies grow by themselves at any time step.
    pub struct UndampedFriction {
        /// Name of the joint.
        pub joint: String,
        /// Coefficient of friction of a sliding pair (1).
        pub friction: f64,
        /// Element sets of the parts.
        pub sets: Vec<String>,
    }
    Warning(Joints),
    "the joint '{joint}' slides with a friction of {friction:.2} beside parts without damping ({}): oscillations of such bodies grow by themselves at any time step (flutter), from rounding to a visible motion in some {:.0} steps where all pairs slide or are about to; give the parts `damping`{}",
    sets.join(", "),
    700.0 / friction,
    bounded_safety(*friction).map_or_else(String::new, |safety| format!(
        "; where it is oblique, `safety = {safety:.2}` in [time] keeps its highest frequency below the stable step"
    ))
}

remark! {
    /// Warning: bolts without grout cross a joint, whose opening and slip do not stretch them.
    pub struct CutBolts {
        /// Name of the bolts.
        pub bolts: String,
        /// Name of the joint.
        pub joint: String,
        /// Number of bolts that cross it.
        pub crossing: usize,
    }
    Warning(Run),
    "{crossing} of the bolts '{bolts}' cross the joint '{joint}' without grout: its opening and slip do not stretch them, and they bear nothing from one side to the other; give the bolts a `grout`"
}

remark! {
    /// Warning: segments of bolts are too long for their grout.
    pub struct CoarseBolts {
        /// Name of the bolts.
        pub bolts: String,
        /// Relative error of the greatest force in ground that is stretched uniformly (1).
        pub error: f64,
    }
    Warning(Run),
    "the segments of the bolts '{bolts}' are too long for their grout: in ground that is stretched uniformly their greatest force errs by {:.0} %; leave `longest_segment` out, or give a shorter one",
    100.0 * error
}

/// Share of the stable step that keeps the highest frequency of sliding pairs below it, for coefficients of friction above
/// 0.9, beyond which the usual share does not; see "Friction and the step" in `docs/theory.md`.
fn bounded_safety(friction: f64) -> Option<f64> {
    let raised = 0.5 * (1.0 + friction.hypot(1.0));
    (friction > 0.9).then(|| raised.sqrt().recip() / 0.98)
}
