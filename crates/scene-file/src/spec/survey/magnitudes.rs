//! Assignment of usual ranges to the keys of a scene file.

use powerhouse_scene::magnitude as usual;
use powerhouse_scene::magnitude::UsualRange;

/// UsualRange range of the number under a key of a table.
///
/// A key denotes the same quantity in all tables, except those that are listed with their table.
pub(super) fn of(table: &str, key: &str) -> UsualRange {
    match (table, key) {
        ("grout", "stiffness") => usual::GROUT_STIFFNESS,
        ("grout", "strength") => usual::GROUT_STRENGTH,
        ("pulse", "displacement") => usual::PULSE,
        ("load" | "added_mass", "density") => usual::LIQUID,
        ("added_mass", "diameter") => usual::BODY,
        ("load", "acceleration") => usual::GRAVITY,
        ("load", "pressure") | ("preload", "pressure") => usual::PRESSURE,
        ("record", "time_step") => usual::RECORD_STEP,
        ("record" | "target", "peak") => usual::PEAK,
        ("target", "short" | "one_second") => usual::PEAK,
        ("target", _) => usual::NUMBER,
        ("time", "step") => usual::STEP,
        ("time", "safety") => usual::SAFETY,
        // Threads are checked against the machine, the reference frequency against the damping band.
        (_, "threads") => usual::ANY,
        ("damping", "reference") => usual::NUMBER,
        ("joint", "tolerance") => usual::GAP,
        ("stage", "tolerance") => usual::SHARE,
        ("bolt", "section") => usual::SECTION,
        ("reinforcement", "bars") => usual::BARS,
        ("reinforcement", "cover") => usual::COVER,
        ("reinforcement", "yield_stress") => usual::STEEL,
        ("pattern", "length" | "spacing") => usual::BOLT_LENGTH,
        ("baseline", "corner") => usual::FREQUENCY,
        ("joint", "corner") => usual::NUMBER,
        ("support" | "load", "direction" | "normal") => usual::NUMBER,
        (_, "young") => usual::YOUNG,
        (_, "density") => usual::DENSITY,
        (_, "poisson") => usual::POISSON,
        (
            _,
            "cohesion"
            | "tensile_strength"
            | "compressive_strength"
            | "compressive_limit"
            | "intact_strength"
            | "concrete_strength"
            | "yield_stress",
        ) => usual::STRENGTH,
        (_, "friction" | "dilation") => usual::ANGLE,
        (_, "static_friction" | "dynamic_friction") => usual::FRICTION,
        (_, "fracture_energy") => usual::FRACTURE_ENERGY,
        (_, "slip_distance" | "gap") => usual::GAP,
        (_, "duration") => usual::DURATION,
        (_, "start" | "every" | "energies" | "taper" | "delay" | "arrival" | "times" | "cut") => {
            usual::TIME
        }
        (_, "frequency" | "frequencies" | "band" | "reference") if table != "wave" => {
            usual::FREQUENCY
        }
        (_, "displacement" | "end_displacement") => usual::DISPLACEMENT,
        (_, "diameter") => usual::DIAMETER,
        (_, "yield_force" | "pretension") => usual::BOLT_FORCE,
        (_, "lateral" | "lateral_y") => usual::LATERAL,
        (_, "stress" | "traction") => usual::STRESS,
        (_, "force") => usual::FORCE,
        (_, "level" | "surface" | "depth") => usual::HEIGHT,
        (_, "self_check" | "energy_residual") => usual::SHARE,
        // Large numbers are permitted as unlimited coordinates.
        ("within", "x" | "y" | "z") => usual::NUMBER,
        (
            _,
            "at" | "from" | "low" | "high" | "box" | "scatterer" | "lines" | "x" | "y" | "z"
            | "within" | "half_extent" | "reach" | "elastic_rim" | "rim" | "distance" | "length"
            | "spacing" | "longest_segment",
        ) => usual::COORDINATE,
        (_, "reference") => usual::COORDINATE,
        _ => usual::NUMBER,
    }
}
