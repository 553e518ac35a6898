//! Usual ranges of physical quantities, and the check of a scene against them.

use core::fmt;

use crate::Topic;
use crate::remark::{Kind, described};

/// Quantity of a scene whose value lies outside its usual range.
///
/// Such a value is nearly always a mistaken unit: Young's modulus in GPa instead of Pa, a density in t/m3, a peak
/// in g, a gap in mm. It is an error, or a warning if the scene
/// [allows](crate::Scene::allow_magnitudes) it.
///
/// # Why so
/// The ranges are wide: from peat to diamond, from weak motion to the strongest ever recorded. A value inside may
/// still be wrong; a value outside is certainly not that of ground or of a structure.
#[derive(Clone, Debug, PartialEq)]
pub struct Magnitude {
    /// Name of the quantity: its key, or a description.
    pub name: String,
    /// Value, in [`unit`](Self::unit).
    pub value: f64,
    /// Usual range: lowest and highest value, in [`unit`](Self::unit); zero is also permitted for a quantity that may
    /// vanish.
    pub usual: [f64; 2],
    /// SI unit of value and range.
    pub unit: &'static str,
    /// Unit in which the value was probably given, if it can be identified.
    pub probable_unit: Option<ProbableUnit>,
}

/// Unit in which a value was probably given, and its conversion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProbableUnit {
    /// Unit that was probably meant, such as `GPa`.
    pub unit: &'static str,
    /// Value in SI units if it was given in that unit.
    pub value: f64,
}

described!(Magnitude, |_| Kind::Warning(Topic::Run));

impl fmt::Display for Magnitude {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            name,
            value,
            usual: [least, most],
            unit,
            probable_unit,
        } = self;
        let unit = match *unit {
            "" => String::new(),
            unit => format!(" {unit}"),
        };
        write!(
            f,
            "{name} = {}{unit} is outside the usual range of {} to {}{unit}",
            plain(*value),
            plain(*least),
            plain(*most)
        )?;
        if let Some(probable_unit) = probable_unit {
            let (found, value) = (plain(*value), plain(rounded(probable_unit.value)));
            write!(f, "; {found} {} would be {value}{unit}", probable_unit.unit)?;
        }
        Ok(())
    }
}

impl std::error::Error for Magnitude {}

/// Object of a scene to which an out-of-range quantity belongs.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum MagnitudeOf {
    /// Material of a part, by the part's element set.
    Part(String),
    /// Mesh.
    Mesh,
    /// Record, by its name.
    Record(String),
    /// Scene as a whole: gravity or duration.
    Scene,
}

/// Number rounded to four digits.
pub fn rounded(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

/// Number as text, in exponential form where it is very small or large.
fn plain(value: f64) -> String {
    if value == 0.0 || (1e-3..1e5).contains(&value.abs()) {
        format!("{value}")
    } else {
        format!("{value:e}")
    }
}

/// Usual range of a quantity.
#[derive(Clone, Copy, Debug)]
pub struct UsualRange {
    pub unit: &'static str,
    /// Least and greatest magnitude of nonzero values.
    range: [f64; 2],
    /// Range of most values: a unit that converts a value into it is the probable one.
    typical: [f64; 2],
    /// Permitted signs.
    sign: Sign,
    /// Other units with their SI factors, the likelier ones first.
    alternatives: &'static [(&'static str, f64)],
}

/// Permitted signs of a quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Sign {
    /// Values in the range only.
    Ranged,
    /// Values in the range, and zero.
    OrZero,
    /// Values whose magnitude is in the range, and zero.
    Both,
}

impl UsualRange {
    const fn new(unit: &'static str, range: [f64; 2]) -> Self {
        Self {
            unit,
            range,
            typical: range,
            sign: Sign::Ranged,
            alternatives: &[],
        }
    }
    const fn or_zero(mut self) -> Self {
        self.sign = Sign::OrZero;
        self
    }
    const fn signed(mut self) -> Self {
        self.sign = Sign::Both;
        self
    }
    const fn alternatives(
        mut self,
        typical: [f64; 2],
        alternatives: &'static [(&'static str, f64)],
    ) -> Self {
        (self.typical, self.alternatives) = (typical, alternatives);
        self
    }

    /// Checks a value against the usual range.
    pub fn check(&self, name: &str, value: f64) -> Result<(), Magnitude> {
        let size = match self.sign {
            Sign::Both => value.abs(),
            Sign::Ranged | Sign::OrZero => value,
        };
        let within = |[least, most]: [f64; 2], size: f64| (least..=most).contains(&size);
        if within(self.range, size) || (size == 0.0 && self.sign != Sign::Ranged) {
            return Ok(());
        }
        let probable_unit = [self.typical, self.range].into_iter().find_map(|range| {
            let fits = |(_, factor): &&(&str, f64)| within(range, size * factor);
            self.alternatives.iter().find(fits)
        });
        let [least, most] = self.range;
        let usual = match self.sign {
            // A magnitude that is too small: the range on its side of zero.
            Sign::Both if size < least && value > 0.0 => [least, most],
            Sign::Both if size < least => [-most, -least],
            Sign::Both => [-most, most],
            Sign::Ranged | Sign::OrZero => [least, most],
        };
        Err(Magnitude {
            name: name.into(),
            value,
            usual,
            unit: self.unit,
            probable_unit: probable_unit.map(|&(unit, factor)| ProbableUnit {
                unit,
                value: value * factor,
            }),
        })
    }
}

/// Standard gravity (m/s2).
const G: f64 = 9.806_65;

/// Young's modulus, from peat to diamond.
pub const YOUNG: UsualRange = UsualRange::new("Pa", [1e5, 1.2e12])
    .alternatives([5e7, 5e11], &[("GPa", 1e9), ("MPa", 1e6), ("kPa", 1e3)]);
/// Density, from aerated concrete to lead.
pub const DENSITY: UsualRange = UsualRange::new("kg/m3", [200.0, 12e3]).alternatives(
    [900.0, 9e3],
    &[("t/m3", 1e3), ("kN/m3", 1e3 / G), ("N/m3", 1.0 / G)],
);
/// Density of water and slurries.
pub const LIQUID: UsualRange = UsualRange::new("kg/m3", [500.0, 3e3])
    .alternatives([500.0, 3e3], &[("t/m3", 1e3), ("kN/m3", 1e3 / G)]);
/// Poisson's ratio: not auxetic, at most that of saturated clay.
pub const POISSON: UsualRange = UsualRange::new("", [0.0, 0.4995]);
/// S wave speed, from mud to iron.
pub const S_SPEED: UsualRange =
    UsualRange::new("m/s", [5.0, 20e3]).alternatives([50.0, 6e3], &[("km/s", 1e3)]);
/// P wave speed.
pub const P_SPEED: UsualRange =
    UsualRange::new("m/s", [10.0, 30e3]).alternatives([100.0, 12e3], &[("km/s", 1e3)]);
/// Yield stresses of steel.
pub const STEEL: UsualRange = UsualRange::new("Pa", [5e7, 3e9])
    .alternatives([1e8, 2e9], &[("MPa", 1e6), ("kPa", 1e3), ("GPa", 1e9)]);
/// Strengths of materials and of bonds.
pub const STRENGTH: UsualRange = UsualRange::new("Pa", [100.0, 5e9])
    .or_zero()
    .alternatives([1e4, 1e9], &[("MPa", 1e6), ("kPa", 1e3), ("GPa", 1e9)]);
/// Angles of friction and dilation.
pub const ANGLE: UsualRange = UsualRange::new("degrees", [1.0, 75.0])
    .or_zero()
    .alternatives([1.0, 75.0], &[("rad", 180.0 / core::f64::consts::PI)]);
/// Coefficients of friction.
pub const FRICTION: UsualRange = UsualRange::new("", [0.01, 5.0]).or_zero();
/// Energies per area of crack.
pub const FRACTURE_ENERGY: UsualRange =
    UsualRange::new("N/m", [0.5, 1e7]).alternatives([5.0, 1e5], &[("N/mm", 1e3), ("kN/mm", 1e6)]);
/// Gravitational acceleration, from small bodies to large centrifuges.
pub const GRAVITY: UsualRange =
    UsualRange::new("m/s2", [1.5, 500.0]).alternatives([9.7, 9.9], &[("g", G), ("cm/s2", 0.01)]);
/// A peak to which a record is scaled.
pub const PEAK: UsualRange =
    UsualRange::new("m/s2", [0.2, 50.0]).alternatives([0.2, 30.0], &[("g", G), ("cm/s2", 0.01)]);
/// Peak of a record as read, including weak motion.
pub const RECORDED_PEAK: UsualRange =
    UsualRange::new("m/s2", [1e-3, 50.0]).alternatives([0.1, 30.0], &[("cm/s2", 0.01), ("g", G)]);
/// Time between samples of a record.
pub const RECORD_STEP: UsualRange =
    UsualRange::new("s", [1e-5, 0.25]).alternatives([1e-3, 0.05], &[("ms", 1e-3)]);
/// Duration of a record.
pub const RECORD_LENGTH: UsualRange = UsualRange::new("s", [0.05, 7200.0]);
/// Any other duration.
pub const DURATION: UsualRange = UsualRange::new("s", [1e-12, 1e5]);
/// A time or an interval.
pub const TIME: UsualRange = UsualRange::new("s", [1e-9, 1e5]).signed();
/// A time step.
pub const STEP: UsualRange = UsualRange::new("s", [1e-9, 10.0]);
/// Factor on the stable step.
pub const SAFETY: UsualRange = UsualRange::new("", [1e-3, 1.0]);
/// Number without usual range.
pub const ANY: UsualRange = UsualRange::new("", [0.0, f64::MAX]).signed();
/// Frequencies of earthquakes, machines and blasts.
pub const FREQUENCY: UsualRange = UsualRange::new("Hz", [1e-4, 1e6]);
/// Coordinates, including geodetic ones.
pub const COORDINATE: UsualRange = UsualRange::new("m", [0.0, 1e7]).signed();
/// Heights above the sea.
pub const HEIGHT: UsualRange = UsualRange::new("m", [0.0, 12e3])
    .signed()
    .alternatives([0.0, 12e3], &[("mm", 1e-3)]);
/// Displacements of the ground.
pub const DISPLACEMENT: UsualRange = UsualRange::new("m", [0.0, 20.0])
    .signed()
    .alternatives([0.0, 1.0], &[("mm", 1e-3), ("cm", 1e-2)]);
/// Displacements of a test pulse.
pub const PULSE: UsualRange =
    UsualRange::new("m", [1e-12, 5.0]).alternatives([1e-12, 1.0], &[("mm", 1e-3), ("cm", 1e-2)]);
/// Openings of joints.
pub const GAP: UsualRange = UsualRange::new("m", [1e-9, 1.0])
    .or_zero()
    .alternatives([1e-5, 1.0], &[("mm", 1e-3)]);
/// Diameters of bolts.
pub const DIAMETER: UsualRange =
    UsualRange::new("m", [2e-3, 0.5]).alternatives([5e-3, 0.2], &[("mm", 1e-3), ("cm", 1e-2)]);
/// Sections of bolts.
pub const SECTION: UsualRange =
    UsualRange::new("m2", [3e-6, 0.2]).alternatives([1e-5, 0.05], &[("mm2", 1e-6), ("cm2", 1e-4)]);
/// Areas of reinforcing bars per metre.
pub const BARS: UsualRange = UsualRange::new("m2/m", [1e-5, 0.1])
    .or_zero()
    .alternatives([5e-5, 0.05], &[("mm2/m", 1e-6), ("cm2/m", 1e-4)]);
/// Distances of bars from their face.
pub const COVER: UsualRange = UsualRange::new("m", [1e-3, 1.0])
    .or_zero()
    .alternatives([5e-3, 0.3], &[("mm", 1e-3), ("cm", 1e-2)]);
/// Lengths and distances of bolts.
pub const BOLT_LENGTH: UsualRange =
    UsualRange::new("m", [0.02, 500.0]).alternatives([0.2, 100.0], &[("mm", 1e-3), ("cm", 1e-2)]);
/// Forces of bolts.
pub const BOLT_FORCE: UsualRange = UsualRange::new("N", [1e3, 1e8])
    .or_zero()
    .alternatives([1e3, 1e8], &[("kN", 1e3), ("MN", 1e6)]);
/// Stiffness of grout.
pub const GROUT_STIFFNESS: UsualRange = UsualRange::new("N/m2", [1e5, 1e12]).alternatives(
    [1e7, 1e11],
    &[("GN/m2", 1e9), ("MN/m2", 1e6), ("kN/m2", 1e3)],
);
/// Strength of grout.
pub const GROUT_STRENGTH: UsualRange =
    UsualRange::new("N/m", [1e2, 1e8]).alternatives([1e4, 1e7], &[("kN/m", 1e3), ("MN/m", 1e6)]);
/// Horizontal over vertical stress.
pub const LATERAL: UsualRange = UsualRange::new("", [0.02, 15.0])
    .or_zero()
    .alternatives([0.1, 5.0], &[("%", 0.01)]);
/// Pressures and stresses.
pub const PRESSURE: UsualRange = UsualRange::new("Pa", [1.0, 1e11])
    .signed()
    .alternatives([1e4, 1e9], &[("MPa", 1e6), ("kPa", 1e3)]);
/// Stresses, component by component.
pub const STRESS: UsualRange = UsualRange::new("Pa", [0.0, 1e11]).signed();
/// Forces at nodes.
pub const FORCE: UsualRange = UsualRange::new("N", [0.0, 1e13]).signed();
/// Shares and relative errors.
pub const SHARE: UsualRange =
    UsualRange::new("", [0.0, 1.0]).alternatives([1e-3, 1.0], &[("%", 0.01)]);
/// Any other number of a scene.
pub const NUMBER: UsualRange = UsualRange::new("", [1e-30, 1e15]).signed();
/// The longest diagonal of a body.
pub const BODY: UsualRange =
    UsualRange::new("m", [0.1, 5e4]).alternatives([0.1, 2e4], &[("mm", 1e-3), ("km", 1e3)]);
/// The longest edge of an element.
pub const ELEMENT: UsualRange =
    UsualRange::new("m", [1e-4, 2e3]).alternatives([1e-2, 100.0], &[("mm", 1e-3), ("km", 1e3)]);
