//! Facts about a material with water in its pores.

use core::fmt;

use powerhouse_elements::WaterPressure;

use super::Kind;
use crate::Topic;

/// Material with water in its pores: what the water does, in numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct SaturatedMaterial {
    /// Name of the material.
    pub name: String,
    /// Bulk modulus of the water over the porosity (Pa).
    pub stiffness: f64,
    /// Speeds of P waves in the drained and in the undrained material (m/s).
    pub speeds: [f64; 2],
    /// Pressure of the water at the start, if there is one.
    pub at_rest: Option<WaterPressure>,
    /// How far the water would flow during the run, if the permeability is known.
    pub seepage: Option<Seepage>,
}

/// Flow of the water in a saturated material during a run that leaves it out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seepage {
    /// Hydraulic conductivity (m/s).
    pub permeability: f64,
    /// Coefficient of consolidation (m2/s): permeability times constrained modulus of the skeleton over weight of the water.
    pub consolidation: f64,
    /// Duration of the run (s).
    pub duration: f64,
    /// Least extent of the parts of the material along an axis (m), of which half is the way of the water.
    pub extent: f64,
}

/// Share of the pressure that has flowed away by the end of the run (1) from which a warning is given.
const LARGE_SHARE: f64 = 0.1;

impl Seepage {
    /// Distance (m) over which pressure spreads during the run.
    pub fn distance(&self) -> f64 {
        (self.consolidation * self.duration).sqrt()
    }
    /// Mean share of a pressure that is gone at the end of the run where the ground drains at both sides of its least extent (1):
    /// `sqrt(4 T / pi)` of the time factor `T = c t / L^2`, which holds up to a half and is above Terzaghi's series beyond.
    pub fn share(&self) -> f64 {
        let way = 0.5 * self.extent;
        (2.0 * self.distance() / way / core::f64::consts::PI.sqrt()).min(1.0)
    }
}

impl SaturatedMaterial {
    /// Whether no flow during the run, as it is computed, is wrong.
    fn is_warning(&self) -> bool {
        (self.seepage).is_some_and(|seepage| seepage.share() > LARGE_SHARE)
    }
}

described!(SaturatedMaterial, |material| Kind::warning_if(
    material.is_warning(),
    Topic::Run
));

impl fmt::Display for SaturatedMaterial {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [drained, undrained] = self.speeds;
        write!(f, "material '{}' has water in its pores, ", self.name)?;
        match self.at_rest.as_ref().map(WaterPressure::level) {
            Some(Some(level)) => write!(f, "at the start hydrostatic below z = {level} m: ")?,
            Some(None) => write!(f, "at the start with the pressures of a table: ")?,
            None => write!(f, "at the start without pressure: ")?,
        }
        write!(
            f,
            "its law sees effective stress, stages without `undrained` are drained, and in the run no water flows (bulk modulus over porosity {:.3e} Pa, \
             P speed {undrained:.0} m/s, drained {drained:.0} m/s); stresses in results are total ones, but for those named `effective_`, and joints see total ones",
            self.stiffness
        )?;
        let Some(seepage) = &self.seepage else {
            return Ok(());
        };
        let (distance, share) = (seepage.distance(), seepage.share());
        write!(
            f,
            "; with a permeability of {:e} m/s pressure spreads over {distance:.2} m in {} s, and {:.0} % of it would be gone from a body \
             of {} m that drains at both sides",
            seepage.permeability,
            seepage.duration,
            100.0 * share,
            seepage.extent,
        )?;
        if self.is_warning() {
            write!(
                f,
                ": the ground is not undrained; where it drains at once leave out `pore_water` and give an in-situ stress without \
                 pressure, and take the two runs as bounds in between"
            )
        } else {
            Ok(())
        }
    }
}
