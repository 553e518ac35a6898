//! Stress that was there before everything else.

use powerhouse_model::{Mesh, ParameterError, Stress, Vec3};

/// An initial stress that is linear in depth,
///
/// `sigma(z) = at_surface + gradient (surface - z)`
///
/// above the surface, too, unless it [ends](Self::ends) there.
///
/// ```
/// use powerhouse_explicit_core::StressField;
/// use powerhouse_model::Vec3;
/// // Rock of 27 kN/m3 under a surface at z = 0, pressed by 0.8 of its weight along x, 1.2 along y.
/// let field = StressField::geostatic(0.0, 27.0e3, [0.8, 1.2])?;
/// let stress = field.at(&Vec3::new(3.0, 4.0, -100.0));
/// assert_eq!(stress.0, [-2.16e6, -3.24e6, -2.7e6, 0.0, 0.0, 0.0]);
/// # Ok::<(), powerhouse_model::ParameterError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StressField {
    /// Height of the surface (m).
    pub surface: f64,
    /// Stress at the surface (Pa).
    pub at_surface: Stress,
    /// Change of stress with depth (Pa/m).
    pub gradient: Stress,
    /// Whether there is none above the surface, as of ground under its own weight.
    pub ends: bool,
}

impl StressField {
    /// The stress under a weight (N/m3, positive), none above the surface, with the shares of the vertical stress that act
    /// along x and y (K0).
    ///
    /// # Errors
    /// A weight or a share that is negative or not finite.
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

    /// The stress (Pa) at a point (m).
    pub fn at(&self, point: &Vec3) -> Stress {
        let depth = self.surface - point.z;
        if self.ends && depth < 0.0 {
            return Stress::default();
        }
        Stress(core::array::from_fn(|i| {
            self.at_surface.0[i] + self.gradient.0[i] * depth
        }))
    }

    /// The stress (Pa) of every element of a mesh, as
    /// [`State::initial_stress`](powerhouse_model::State::initial_stress) takes it: that at its
    /// centroid.
    pub fn of_elements(&self, mesh: &Mesh) -> Vec<Stress> {
        let elements = 0..mesh.element_count() as u32;
        elements
            .map(|element| self.at(&mesh.centroid(element)))
            .collect()
    }
}
