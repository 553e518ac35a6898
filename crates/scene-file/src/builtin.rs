//! Built-in laws, boundaries, joint laws and kernels of every registry.

use std::sync::Arc;

use powerhouse_boundary::{AxisParameters, InputMode, Spreading, Viscous, ViscousSpring};
use powerhouse_elements::SolidKernel;
use powerhouse_material_damage::{Finding, LinearElastic};
use powerhouse_model::{ElasticMedium, ModelError};
use schemars::JsonSchema;
use serde::Deserialize;

use crate::spec::{AmplitudeRatio, DashpotRatio, Positive};
use crate::{Registry, keys};
use powerhouse_laws::Material;

pub(crate) fn register(registry: &mut Registry) {
    registry.add_law("elastic", |medium: ElasticMedium| {
        let medium = medium.checked()?;
        let warnings = Finding::of_medium(&medium);
        Ok(Material::from(LinearElastic::new(medium)).with_warnings(warnings))
    });
    registry.add_boundary(keys::VISCOUS_SPRING, |keys: ViscousSpringKeys| {
        Ok(Arc::new(keys.build()?))
    });
    registry.add_boundary(keys::VISCOUS, |boundary: Viscous| Ok(Arc::new(boundary)));
    crate::builtin_joints::register(registry);
    crate::builtin_laws::register(registry);
    for kernel in SolidKernel::ALL {
        registry.add_kernel(kernel.name(), kernel.into());
    }
}

/// Viscous-spring boundary: springs and dashpots of Wang, Chen & Xiao (2019), Eqs. (1)-(2).
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct ViscousSpringKeys {
    /// Amplitude ratio A of plane to scattered waves (dimensionless), 0 to 100; 0.8 by default.
    amplitude_ratio: Option<AmplitudeRatio>,
    /// Velocity ratio B of physical to apparent wave speed (dimensionless), 0.1 to 10; 1 by default. `"paper"` is
    /// the 1.1 of Wang, Chen & Xiao (2019), with which 4.8 % of a normally incident wave are reflected.
    speed_ratio: Option<DashpotRatio>,
    /// Distance from the scatterer to all faces (m), above 0; by default that of the nodes of each face.
    distance: Option<Positive>,
    /// Parameters of the faces normal to x, where they differ.
    x: Option<AxisKeys>,
    /// Parameters of the faces normal to y, where they differ.
    y: Option<AxisKeys>,
    /// Parameters of the faces normal to z, where they differ.
    z: Option<AxisKeys>,
    /// Geometric spreading of scattered waves: `spherical` (the default) or `cylindrical`.
    #[serde(default)]
    spreading: Spreading,
    /// Input motion: `full-field` (the default), `{ incident-only = [faces] }` or `nothing`.
    #[serde(default)]
    input: InputMode,
}

/// Parameters of the faces normal to one axis.
#[derive(Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct AxisKeys {
    /// Amplitude ratio A of these faces (dimensionless), 0 to 100.
    amplitude_ratio: Option<AmplitudeRatio>,
    /// Velocity ratio B of these faces (dimensionless), 0.1 to 10, or `"paper"`.
    speed_ratio: Option<DashpotRatio>,
    /// Distance from the scatterer to these faces (m), above 0.
    distance: Option<Positive>,
}

impl ViscousSpringKeys {
    fn build(self) -> Result<ViscousSpring, ModelError> {
        let mut axes = [AxisParameters::default(); 3];
        for (axis, own) in axes.iter_mut().zip([self.x, self.y, self.z]) {
            let own = own.unwrap_or_default();
            let amplitude_ratio = own.amplitude_ratio.or(self.amplitude_ratio);
            let speed_ratio = own.speed_ratio.or(self.speed_ratio);
            *axis = AxisParameters::new(
                amplitude_ratio.map_or(axis.amplitude_ratio, AmplitudeRatio::get),
                speed_ratio.map_or(axis.speed_ratio, DashpotRatio::get),
                own.distance.or(self.distance).map(Positive::get),
            )?;
        }
        Ok(ViscousSpring {
            axes,
            spreading: self.spreading,
            input: self.input,
        })
    }
}
