//! Numbers that neither the ground nor what stands in it has.

use core::fmt;

/// A quantity of a scene whose value lies outside of its usual range.
///
/// Such a value is nearly always a slip of units: Young's modulus in GPa where Pa are wanted, a density in
/// t/m3, a peak in g, a gap in mm. A scene is refused for it unless it
/// [allows](crate::Scene::allow_magnitudes) magnitudes beyond the usual.
///
/// # Why so
/// The ranges are wide: from peat to diamond, from weak motion to the strongest that was ever recorded. What
/// lies in them may be wrong still; what lies outside is not a matter of opinion.
#[derive(Clone, Debug, PartialEq)]
pub struct Magnitude {
    /// The quantity, by its key or in words.
    pub name: String,
    /// Its value, in SI units.
    pub value: f64,
    /// The usual range; zero is permitted beside it where the quantity may vanish.
    pub usual: [f64; 2],
    /// The SI unit.
    pub unit: &'static str,
    /// What was probably meant, if that can be said.
    pub meant: Option<Meant>,
}

/// The unit in which a value was probably given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meant {
    /// The unit.
    pub unit: &'static str,
    /// The value in SI units if it was given in that unit.
    pub value: f64,
}

impl fmt::Display for Magnitude {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            name,
            value,
            usual: [least, most],
            unit,
            meant,
        } = self;
        let unit = match *unit {
            "" => String::new(),
            unit => format!(" {unit}"),
        };
        write!(
            f,
            "{name} = {}{unit} is beyond what is usual, {} to {}{unit}",
            plain(*value),
            plain(*least),
            plain(*most)
        )?;
        if let Some(meant) = meant {
            let (found, value) = (plain(*value), plain(rounded(meant.value)));
            write!(f, "; {found} {} would be {value}{unit}", meant.unit)?;
        }
        Ok(())
    }
}

impl std::error::Error for Magnitude {}

/// What a magnitude belongs to.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum MagnitudeOf {
    /// The material of a part, by its set.
    Part(String),
    /// The mesh.
    Mesh,
    /// A record, by its name.
    Record(String),
    /// Gravity or the duration.
    Scene,
}

/// A number to four digits.
pub(crate) fn rounded(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

/// A number as a person would write it.
fn plain(value: f64) -> String {
    if value == 0.0 || (1e-3..1e5).contains(&value.abs()) {
        format!("{value}")
    } else {
        format!("{value:e}")
    }
}

/// What is usual of a quantity.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Usual {
    pub(crate) unit: &'static str,
    /// Least and greatest size of what is not zero.
    range: [f64; 2],
    /// Where most values lie: the unit that brings a value there is probably the one that was meant.
    typical: [f64; 2],
    /// Whether values may be negative or zero; then the range is that of their sizes.
    sign: Sign,
    /// Other units, the likelier ones first, in SI units.
    slips: &'static [(&'static str, f64)],
}

/// Which signs a quantity has.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Sign {
    /// The range holds as it stands.
    Ranged,
    /// Zero is permitted, too.
    OrZero,
    /// Zero is permitted, and so are negative values; the range is that of sizes.
    Both,
}

impl Usual {
    const fn new(unit: &'static str, range: [f64; 2]) -> Self {
        Self {
            unit,
            range,
            typical: range,
            sign: Sign::Ranged,
            slips: &[],
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
    const fn slips(mut self, typical: [f64; 2], slips: &'static [(&'static str, f64)]) -> Self {
        (self.typical, self.slips) = (typical, slips);
        self
    }

    /// Sees whether a value is usual.
    pub(crate) fn check(&self, name: &str, value: f64) -> Result<(), Magnitude> {
        let size = match self.sign {
            Sign::Both => value.abs(),
            Sign::Ranged | Sign::OrZero => value,
        };
        let within = |[least, most]: [f64; 2], size: f64| (least..=most).contains(&size);
        if within(self.range, size) || (size == 0.0 && self.sign != Sign::Ranged) {
            return Ok(());
        }
        let meant = [self.typical, self.range].into_iter().find_map(|range| {
            let fits = |(_, factor): &&(&str, f64)| within(range, size * factor);
            self.slips.iter().find(fits)
        });
        let [least, most] = self.range;
        Err(Magnitude {
            name: name.into(),
            value,
            usual: if self.sign == Sign::Both {
                [-most, most]
            } else {
                [least, most]
            },
            unit: self.unit,
            meant: meant.map(|&(unit, factor)| Meant {
                unit,
                value: value * factor,
            }),
        })
    }
}

/// Standard gravity (m/s2).
const G: f64 = 9.806_65;

/// Peat to diamond.
pub(crate) const YOUNG: Usual =
    Usual::new("Pa", [1e5, 1.2e12]).slips([5e7, 5e11], &[("GPa", 1e9), ("MPa", 1e6), ("kPa", 1e3)]);
/// Aerated concrete to lead.
pub(crate) const DENSITY: Usual = Usual::new("kg/m3", [200.0, 12e3]).slips(
    [900.0, 9e3],
    &[("t/m3", 1e3), ("kN/m3", 1e3 / G), ("N/m3", 1.0 / G)],
);
/// Water and what is stirred into it.
pub(crate) const LIQUID: Usual =
    Usual::new("kg/m3", [500.0, 3e3]).slips([500.0, 3e3], &[("t/m3", 1e3), ("kN/m3", 1e3 / G)]);
/// No material of the ground is narrowed by pressure along; saturated clay comes near to one half.
pub(crate) const POISSON: Usual = Usual::new("", [0.0, 0.4995]);
/// Mud to iron.
pub(crate) const S_SPEED: Usual =
    Usual::new("m/s", [5.0, 20e3]).slips([50.0, 6e3], &[("km/s", 1e3)]);
/// As for S waves.
pub(crate) const P_SPEED: Usual =
    Usual::new("m/s", [10.0, 30e3]).slips([100.0, 12e3], &[("km/s", 1e3)]);
/// Strengths of materials and of bonds.
pub(crate) const STRENGTH: Usual = Usual::new("Pa", [100.0, 5e9])
    .or_zero()
    .slips([1e4, 1e9], &[("MPa", 1e6), ("kPa", 1e3), ("GPa", 1e9)]);
/// Angles of friction and dilation.
pub(crate) const ANGLE: Usual = Usual::new("degrees", [1.0, 75.0])
    .or_zero()
    .slips([1.0, 75.0], &[("rad", 180.0 / core::f64::consts::PI)]);
/// Coefficients of friction.
pub(crate) const FRICTION: Usual = Usual::new("", [0.01, 5.0]).or_zero();
/// Energies per area of crack.
pub(crate) const FRACTURE_ENERGY: Usual =
    Usual::new("N/m", [0.5, 1e7]).slips([5.0, 1e5], &[("N/mm", 1e3), ("kN/mm", 1e6)]);
/// Ceres to large centrifuges.
pub(crate) const GRAVITY: Usual =
    Usual::new("m/s2", [1.5, 500.0]).slips([9.7, 9.9], &[("g", G), ("cm/s2", 0.01)]);
/// A peak to which a record is scaled.
pub(crate) const PEAK: Usual =
    Usual::new("m/s2", [0.2, 50.0]).slips([0.2, 30.0], &[("g", G), ("cm/s2", 0.01)]);
/// The peak of a record as it is read, weak motion too.
pub(crate) const RECORDED_PEAK: Usual =
    Usual::new("m/s2", [1e-3, 50.0]).slips([0.1, 30.0], &[("cm/s2", 0.01), ("g", G)]);
/// Time between samples of a record.
pub(crate) const RECORD_STEP: Usual =
    Usual::new("s", [1e-5, 0.25]).slips([1e-3, 0.05], &[("ms", 1e-3)]);
/// How long a record is.
pub(crate) const RECORD_LENGTH: Usual = Usual::new("s", [0.05, 7200.0]);
/// How long something lasts.
pub(crate) const DURATION: Usual = Usual::new("s", [1e-12, 1e5]);
/// A time or an interval.
pub(crate) const TIME: Usual = Usual::new("s", [1e-9, 1e5]).signed();
/// A time step.
pub(crate) const STEP: Usual = Usual::new("s", [1e-9, 10.0]);
/// A share of the stable step with which a run comes to an end.
pub(crate) const SAFETY: Usual = Usual::new("", [1e-3, 1.0]);
/// What has no usual range.
pub(crate) const ANY: Usual = Usual::new("", [0.0, f64::MAX]).signed();
/// Frequencies of earthquakes, machines and blasts.
pub(crate) const FREQUENCY: Usual = Usual::new("Hz", [1e-4, 1e6]);
/// Coordinates, geodetic ones too.
pub(crate) const COORDINATE: Usual = Usual::new("m", [0.0, 1e7]).signed();
/// Heights above the sea.
pub(crate) const HEIGHT: Usual = Usual::new("m", [0.0, 12e3])
    .signed()
    .slips([0.0, 12e3], &[("mm", 1e-3)]);
/// Displacements of the ground.
pub(crate) const DISPLACEMENT: Usual = Usual::new("m", [0.0, 20.0])
    .signed()
    .slips([0.0, 1.0], &[("mm", 1e-3), ("cm", 1e-2)]);
/// Displacements of a test pulse.
pub(crate) const PULSE: Usual =
    Usual::new("m", [1e-12, 5.0]).slips([1e-12, 1.0], &[("mm", 1e-3), ("cm", 1e-2)]);
/// Openings of joints.
pub(crate) const GAP: Usual = Usual::new("m", [1e-9, 1.0])
    .or_zero()
    .slips([1e-5, 1.0], &[("mm", 1e-3)]);
/// Diameters of bolts.
pub(crate) const DIAMETER: Usual =
    Usual::new("m", [2e-3, 0.5]).slips([5e-3, 0.2], &[("mm", 1e-3), ("cm", 1e-2)]);
/// Sections of bolts.
pub(crate) const SECTION: Usual =
    Usual::new("m2", [3e-6, 0.2]).slips([1e-5, 0.05], &[("mm2", 1e-6), ("cm2", 1e-4)]);
/// Lengths and distances of bolts.
pub(crate) const BOLT_LENGTH: Usual =
    Usual::new("m", [0.02, 500.0]).slips([0.2, 100.0], &[("mm", 1e-3), ("cm", 1e-2)]);
/// Forces of bolts.
pub(crate) const BOLT_FORCE: Usual = Usual::new("N", [1e3, 1e8])
    .or_zero()
    .slips([1e3, 1e8], &[("kN", 1e3), ("MN", 1e6)]);
/// Stiffness of grout.
pub(crate) const GROUT_STIFFNESS: Usual = Usual::new("N/m2", [1e5, 1e12]).slips(
    [1e7, 1e11],
    &[("GN/m2", 1e9), ("MN/m2", 1e6), ("kN/m2", 1e3)],
);
/// Strength of grout.
pub(crate) const GROUT_STRENGTH: Usual =
    Usual::new("N/m", [1e2, 1e8]).slips([1e4, 1e7], &[("kN/m", 1e3), ("MN/m", 1e6)]);
/// Horizontal over vertical stress.
pub(crate) const LATERAL: Usual = Usual::new("", [0.02, 15.0])
    .or_zero()
    .slips([0.1, 5.0], &[("%", 0.01)]);
/// Pressures and stresses.
pub(crate) const PRESSURE: Usual = Usual::new("Pa", [1.0, 1e11])
    .signed()
    .slips([1e4, 1e9], &[("MPa", 1e6), ("kPa", 1e3)]);
/// Stresses, component by component.
pub(crate) const STRESS: Usual = Usual::new("Pa", [0.0, 1e11]).signed();
/// Forces at nodes.
pub(crate) const FORCE: Usual = Usual::new("N", [0.0, 1e13]).signed();
/// Shares and relative errors.
pub(crate) const SHARE: Usual = Usual::new("", [0.0, 1.0]).slips([1e-3, 1.0], &[("%", 0.01)]);
/// Any other number of a scene.
pub(crate) const NUMBER: Usual = Usual::new("", [1e-30, 1e15]).signed();
/// The longest diagonal of a body.
pub(crate) const BODY: Usual =
    Usual::new("m", [0.1, 5e4]).slips([0.1, 2e4], &[("mm", 1e-3), ("km", 1e3)]);
/// The longest edge of an element.
pub(crate) const ELEMENT: Usual =
    Usual::new("m", [1e-4, 2e3]).slips([1e-2, 100.0], &[("mm", 1e-3), ("km", 1e3)]);

#[cfg(test)]
mod tests {
    use super::*;

    /// A slip of units is told with the unit that was probably meant; what lies in the range is not.
    #[test]
    fn slips_of_units_are_told() {
        for (usual, value, meant) in [
            (YOUNG, 30.0, "30 GPa would be 3e10 Pa"),
            (YOUNG, 25_000.0, "25000 MPa would be 2.5e10 Pa"),
            (DENSITY, 2.5, "2.5 t/m3 would be 2500 kg/m3"),
            (DENSITY, 27.0, "27 kN/m3 would be 2753 kg/m3"),
            (STRENGTH, 1.05, "1.05 MPa would be 1.05e6 Pa"),
            (PEAK, 0.17, "0.17 g would be 1.667 m/s2"),
            (PEAK, 170.0, "170 cm/s2 would be 1.7 m/s2"),
            (GAP, 5.0, "5 mm would be 0.005 m"),
            (DIAMETER, 25.0, "25 mm would be 0.025 m"),
            (BOLT_FORCE, 250.0, "250 kN would be 2.5e5 N"),
            (RECORD_STEP, 5.0, "5 ms would be 0.005 s"),
            (FRACTURE_ENERGY, 0.133, "0.133 N/mm would be 133 N/m"),
            (GRAVITY, 1.0, "1 g would be 9.807 m/s2"),
            (ANGLE, 0.7, "0.7 rad would be 40.11 degrees"),
        ] {
            let told = usual.check("it", value).unwrap_err();
            assert!(told.to_string().contains(meant), "{told}");
            let right = told.meant.unwrap().value;
            assert_eq!(usual.check("it", right), Ok(()), "{right}");
        }
        assert_eq!(STRENGTH.check("it", 0.0), Ok(()));
        assert_eq!(DISPLACEMENT.check("it", -3.0), Ok(()));
        assert!(NUMBER.check("it", -1e300).is_err());
        assert!(YOUNG.check("it", f64::NAN).is_err());
        assert!(YOUNG.check("it", 1e300).unwrap_err().meant.is_none());
    }
}
