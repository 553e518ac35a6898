//! In-situ stress before the first stage.

use crate::{Mesh, ParameterError, Stress, Vec3};

/// An initial (in-situ) stress that varies linearly with depth,
///
/// `sigma(z) = at_surface + gradient (surface - z)`
///
/// which holds above the surface too, unless it [ends](Self::ends) there.
///
/// ```
/// use powerhouse_model::{StressField, Vec3};
/// // Rock of 27 kN/m3 under a surface at z = 0, with lateral stress ratios 0.8 along x and 1.2 along y.
/// let field = StressField::geostatic(0.0, 27.0e3, [0.8, 1.2])?;
/// let stress = field.at(&Vec3::new(3.0, 4.0, -100.0));
/// assert_eq!(stress.0, [-2.16e6, -3.24e6, -2.7e6, 0.0, 0.0, 0.0]);
/// # Ok::<(), powerhouse_model::ParameterError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StressField {
    /// Height z from which depth is counted (m), downwards.
    pub surface: f64,
    /// Stress at depth zero (Pa), tension positive: xx, yy, zz, xy, yz, zx.
    pub at_surface: Stress,
    /// Increase of each component of stress per depth (Pa/m); negative for compression that grows downwards.
    pub gradient: Stress,
    /// Whether the stress is zero above the surface, as in ground under its own weight.
    pub ends: bool,
}

impl StressField {
    /// The geostatic stress of a unit weight (N/m3, positive), zero above the surface, with the lateral stress ratios K0
    /// along x and y.
    ///
    /// # Errors
    /// A unit weight or ratio that is negative or not finite.
    pub fn geostatic(
        surface: f64,
        unit_weight: f64,
        lateral: [f64; 2],
    ) -> Result<Self, ParameterError> {
        ParameterError::check("surface", surface, -f64::MAX, f64::MAX)?;
        ParameterError::check("unit weight", unit_weight, 0.0, f64::MAX)?;
        for share in lateral {
            ParameterError::check("lateral stress ratio", share, 0.0, f64::MAX)?;
        }
        let [x, y] = lateral.map(|share| -share * unit_weight);
        Ok(Self {
            surface,
            at_surface: Stress::default(),
            gradient: Stress([x, y, -unit_weight, 0.0, 0.0, 0.0]),
            ends: true,
        })
    }

    /// Stress at a point given by its coordinates (m), of which z alone counts: `at_surface + gradient (surface - z)`
    /// (Pa, tension positive). Above the surface it is zero if [`ends`](Self::ends) is true, and extrapolated by the
    /// same formula otherwise.
    pub fn at(&self, point: &Vec3) -> Stress {
        let depth = self.surface - point.z;
        if self.ends && depth < 0.0 {
            return Stress::default();
        }
        Stress(core::array::from_fn(|i| {
            self.at_surface.0[i] + self.gradient.0[i] * depth
        }))
    }

    /// Increase of the stress per height z at a point (Pa/m); zero above the surface if the stress [`ends`](Self::ends)
    /// there.
    pub fn slope_at(&self, point: &Vec3) -> Stress {
        if self.ends && point.z > self.surface {
            return Stress::default();
        }
        Stress(self.gradient.0.map(|gradient| -gradient))
    }

    /// The slopes of the stress (Pa/m) at the centroid of every element of a mesh, for
    /// [`State::initial_slope`](crate::State::initial_slope).
    pub fn slopes_of_elements(&self, mesh: &Mesh) -> Vec<Stress> {
        let elements = 0..mesh.element_count() as u32;
        elements
            .map(|element| self.slope_at(&mesh.centroid(element)))
            .collect()
    }

    /// The initial stress (Pa) at the centroid of every element of a mesh, for
    /// [`State::initial_stress`](crate::State::initial_stress).
    pub fn of_elements(&self, mesh: &Mesh) -> Vec<Stress> {
        let elements = 0..mesh.element_count() as u32;
        elements
            .map(|element| self.at(&mesh.centroid(element)))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The slope is the change of the stress with height, below and above the surface, whether the stress ends there or not.
    #[test]
    fn slopes_are_changes_of_the_stress_with_height() {
        for ends in [true, false] {
            let field = StressField {
                surface: 12.0,
                at_surface: Stress([-1.0e5, -2.0e5, 0.0, 3.0e4, 0.0, 1.0e3]),
                gradient: Stress([-2.0e4, -1.0e4, -2.7e4, 0.0, 500.0, -30.0]),
                ends,
            };
            for z in [-40.0, 11.0, 13.0, 60.0] {
                let at = |z: f64| field.at(&Vec3::new(3.0, 4.0, z)).0;
                let slope = field.slope_at(&Vec3::new(3.0, 4.0, z)).0;
                for (i, slope) in slope.into_iter().enumerate() {
                    let change = at(z + 0.5)[i] - at(z - 0.5)[i];
                    assert!((change - slope).abs() < 1e-6, "{ends} {z} {i}: {slope}");
                }
            }
        }
    }
}
