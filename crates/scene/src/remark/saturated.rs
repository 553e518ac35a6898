//! Facts about a material with water in its pores.

use core::fmt;

/// Material with water in its pores: what the water does, in numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct SaturatedMaterial {
    /// Name of the material.
    pub name: String,
    /// Bulk modulus of the water over the porosity (Pa).
    pub stiffness: f64,
    /// Speeds of P waves in the drained and in the undrained material (m/s).
    pub speeds: [f64; 2],
    /// Height z of the water level (m), if there is one.
    pub level: Option<f64>,
}

impl fmt::Display for SaturatedMaterial {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [drained, undrained] = self.speeds;
        write!(f, "material '{}' has water in its pores, ", self.name)?;
        match self.level {
            Some(level) => write!(f, "at the start hydrostatic below z = {level} m: ")?,
            None => write!(f, "at the start without pressure: ")?,
        }
        write!(
            f,
            "its law sees effective stress, stages are drained, and in the run no water flows (bulk modulus over porosity {:.3e} Pa, \
             P speed {undrained:.0} m/s, drained {drained:.0} m/s); stresses in results are total ones, and so are those that joints see",
            self.stiffness
        )
    }
}
