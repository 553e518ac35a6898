//! What is probably not what is meant about water in the pores of a material.

use core::fmt;

use super::Kind;
use crate::Topic;

/// Material whose water is probably not what is meant, and why.
#[derive(Clone, Debug, PartialEq)]
pub struct WaterWarning {
    /// Name of the material.
    pub material: String,
    /// Why.
    pub reason: WaterReason,
}

/// Why water in the pores of a material is probably not what is meant.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum WaterReason {
    /// The density of grains and water together is below that of the water.
    Light {
        /// Density of the material (kg/m3).
        density: f64,
        /// Density of the water (kg/m3).
        water: f64,
    },
    /// The pores leave next to no room for grains.
    Porous {
        /// Share of the pores in the volume (1).
        porosity: f64,
    },
    /// The water is so soft that it takes next to nothing of an isotropic stress.
    Soft {
        /// Its share, Skempton's B (1).
        share: f64,
    },
    /// Elements that are too stiff where their volume cannot change.
    Locks {
        /// Element set of the part.
        set: String,
        /// Name of the kernel.
        kernel: &'static str,
        /// Poisson's ratio of the undrained material (1).
        poisson: f64,
    },
    /// The pressure at the start is another one in the in-situ stress.
    OtherPressure {
        /// Number of an element where they differ most.
        element: u64,
        /// Pressures there of the material and of the in-situ stress (Pa), none where it has no water.
        pressures: [Option<f64>; 2],
    },
    /// The level is above the ground, and nothing loads the ground.
    Above {
        /// Height z of the level (m).
        level: f64,
        /// Height z of the ground (m).
        top: f64,
    },
}

described!(WaterWarning, |_| Kind::Warning(Topic::Run));

impl fmt::Display for WaterWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "material '{}': ", self.material)?;
        match &self.reason {
            WaterReason::Light { density, water } => write!(
                f,
                "its density of {density} kg/m3 is below that of the water in its pores, {water}: `density` is that of grains and water together"
            ),
            WaterReason::Porous { porosity } => write!(
                f,
                "a porosity of {porosity} leaves next to no room for grains; it is the share of the pores in the volume, such as 0.35 of sand, 0.5 of clay, 0.01 of rock"
            ),
            WaterReason::Soft { share } => write!(
                f,
                "its water takes {share:.1e} of an isotropic stress (Skempton's B), so that the ground is as good as dry; `bulk_modulus` is in Pa, 2.2e9 of water without gas"
            ),
            WaterReason::Locks {
                set,
                kernel,
                poisson,
            } => write!(
                f,
                "elements '{kernel}' of part '{set}' are too stiff where the volume cannot change (Poisson's ratio of {poisson:.4} with water that cannot flow): take 'hex8-natural', which is the default, 'hex8-eas' or 'hex8-b-bar' for bricks, and tetrahedra with ten nodes (`order = 2` of [mesh])"
            ),
            WaterReason::OtherPressure { element, pressures } => {
                let [own, in_situ] = pressures.map(|pressure| match pressure {
                    Some(pressure) => format!("{:.1} kPa", 1e-3 * pressure),
                    None => "no water".to_owned(),
                });
                write!(
                    f,
                    "in element {element} it has {own}, and [in_situ_stress] has {in_situ}: effective stresses at the start are off by the difference, and the coefficients `lateral` hold between others; give both the same level or table"
                )
            }
            WaterReason::Above { level, top } => write!(
                f,
                "its water level z = {level} m is above the ground, which ends at {top} m, and no load of kind 'water' presses on it: the ground would be lifted; give the faces under the water that load"
            ),
        }
    }
}
