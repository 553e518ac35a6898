//! Isotropic elastic media.

use crate::ParameterError;
#[cfg(feature = "keys")]
use crate::keys::*;

/// A homogeneous isotropic elastic medium.
///
/// ```
/// let rock = powerhouse_model::ElasticMedium::new(9.0e9, 0.27, 2750.0)?;
/// assert!((rock.p_speed() - 2022.253).abs() < 1e-3);
/// assert!((rock.s_speed() - 1135.110).abs() < 1e-3);
/// # Ok::<(), powerhouse_model::ParameterError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "keys", derive(Deserialize, Serialize, JsonSchema))]
#[cfg_attr(feature = "keys", serde(deny_unknown_fields))]
pub struct ElasticMedium {
    /// Young's modulus (Pa), above 0.
    #[cfg_attr(feature = "keys", serde(with = "Positive"))]
    pub young: f64,
    /// Poisson's ratio (dimensionless), above -1 and below 0.5.
    #[cfg_attr(feature = "keys", serde(with = "PoissonRatio"))]
    pub poisson: f64,
    /// Mass density (kg/m3), above 0.
    #[cfg_attr(feature = "keys", serde(with = "Positive"))]
    pub density: f64,
}

impl ElasticMedium {
    /// A medium from Young's modulus (Pa), Poisson's ratio and density (kg/m3).
    ///
    /// # Errors
    /// [`ParameterError`] names the field, its value and the permitted range.
    pub fn new(young: f64, poisson: f64, density: f64) -> Result<Self, ParameterError> {
        let medium = Self {
            young,
            poisson,
            density,
        };
        medium.checked()
    }
    /// The medium, if its parameters are in their ranges.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn checked(self) -> Result<Self, ParameterError> {
        ParameterError::check("young", self.young, f64::MIN_POSITIVE, f64::MAX)?;
        ParameterError::check("poisson", self.poisson, -1.0 + 1e-9, 0.5 - 1e-9)?;
        ParameterError::check("density", self.density, f64::MIN_POSITIVE, f64::MAX)?;
        Ok(self)
    }

    /// Lamé's first parameter `lambda = E nu / ((1 + nu)(1 - 2 nu))` (Pa).
    pub fn lambda(&self) -> f64 {
        self.young * self.poisson / ((1.0 + self.poisson) * (1.0 - 2.0 * self.poisson))
    }
    /// Shear modulus, `E / (2 (1 + nu))` (Pa).
    pub fn shear(&self) -> f64 {
        self.young / (2.0 * (1.0 + self.poisson))
    }
    /// Bulk modulus, `E / (3 (1 - 2 nu))` (Pa).
    pub fn bulk(&self) -> f64 {
        self.young / (3.0 * (1.0 - 2.0 * self.poisson))
    }
    /// Constrained modulus, `lambda + 2 G` (Pa).
    pub fn constrained(&self) -> f64 {
        self.lambda() + 2.0 * self.shear()
    }
    /// Speed of compressional (P) waves, `sqrt((lambda + 2 G) / rho)` (m/s).
    pub fn p_speed(&self) -> f64 {
        (self.constrained() / self.density).sqrt()
    }
    /// Speed of shear (S) waves, `sqrt(G / rho)` (m/s).
    pub fn s_speed(&self) -> f64 {
        (self.shear() / self.density).sqrt()
    }
}
