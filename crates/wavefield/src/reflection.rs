//! Reflection of plane waves at a free surface.

#[cfg(feature = "keys")]
use powerhouse_model::keys::*;
use powerhouse_model::{ElasticMedium, ParameterError};

use crate::{Angle, Complex, WaveError};

/// Type of a plane body wave.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "keys", derive(Deserialize, Serialize, JsonSchema))]
#[cfg_attr(feature = "keys", serde(rename_all = "lowercase"))]
pub enum WaveKind {
    /// Compressional wave, polarised along its direction of travel.
    P,
    /// Shear wave polarised in the vertical plane of travel.
    SV,
    /// Shear wave polarised horizontally.
    SH,
}

impl core::fmt::Display for WaveKind {
    fn fmt(&self, formatter: &mut core::fmt::Formatter) -> core::fmt::Result {
        formatter.write_str(match self {
            Self::P => "P",
            Self::SV => "SV",
            Self::SH => "SH",
        })
    }
}

impl WaveKind {
    /// Speed of this type of wave in a medium (m/s).
    pub fn speed(self, medium: &ElasticMedium) -> f64 {
        match self {
            Self::P => medium.p_speed(),
            Self::SV | Self::SH => medium.s_speed(),
        }
    }
    /// Greatest incidence under a free surface (degrees).
    pub(crate) fn greatest_incidence(self) -> f64 {
        match self {
            Self::P => 89.0,
            Self::SV => 89.9,
            Self::SH => 90.0,
        }
    }
}

/// Critical angle of SV incidence, `asin(cs/cp)`, at which the reflected P wave travels along the
/// surface; beyond it the P wave decays with depth and the field is not causal.
pub fn critical_angle(medium: &ElasticMedium) -> Angle {
    Angle::from_radians((medium.s_speed() / medium.p_speed()).asin())
}

/// Reflection coefficients of a unit plane wave at a free surface, for spectra of `exp(+i w t)`, `w > 0`.
///
/// With `p` the horizontal slowness, `xi` and `eta` the vertical slownesses of P and S,
/// `k = 1/cs^2 - 2 p^2`, `D = k^2 + 4 p^2 xi eta`:
/// `B1 = -(k^2 - 4 p^2 xi eta)/D`, `B2 = 4 (cs/cp) p eta k/D` for SV incidence,
/// `B3 = (k^2 - 4 p^2 xi eta)/D`, `B4 = 4 (cp/cs) p xi k/D` for P incidence, names and signs as in
/// X. Wang, J. Chen, M. Xiao (2019), Soil Dyn. Earthq. Eng. 119, Eqs. 8-9. Past the critical angle
/// `xi = -i sqrt(p^2 - 1/cp^2)`. SH is reflected with amplitude 1.
/// ```
/// use powerhouse_model::ElasticMedium;
/// use powerhouse_wavefield::{Angle, SurfaceReflection, WaveKind};
/// let rock = ElasticMedium::new(10e9, 0.3, 3000.0)?;
/// let reflection = SurfaceReflection::new(WaveKind::SV, Angle::from_degrees(15.0), &rock)?;
/// assert!((reflection.surface_motion()[0].re - 1.9207186).abs() < 1e-7);
/// assert!((reflection.surface_motion()[2].re + 0.5369212).abs() < 1e-7);
/// # Ok::<(), powerhouse_wavefield::WaveError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceReflection {
    /// Type of the incident wave.
    pub kind: WaveKind,
    /// Angle of incidence from the vertical.
    pub incidence: Angle,
    /// Amplitude of the reflected wave of the same type: B1, B3, or 1 for SH.
    pub same: Complex,
    /// Amplitude of the reflected wave of the other type: B2, B4, or 0 for SH.
    pub converted: Complex,
    /// Horizontal slowness of all three waves (s/m).
    pub horizontal_slowness: f64,
    /// Vertical slowness of the incident wave and the reflected one of its type (s/m).
    pub vertical_slowness: f64,
    /// Vertical slowness of the converted wave (s/m); past the critical angle `-i` times its decay rate.
    pub converted_slowness: Complex,
    /// Speed of the converted wave (m/s).
    pub(crate) converted_speed: f64,
}

impl SurfaceReflection {
    /// Reflection of a wave that is incident from below.
    ///
    /// # Errors
    /// [`WaveError::GrazingIncidence`] above 89 degrees for P, 89.9 for SV, 90 for SH; a
    /// parameter error for a negative angle or an invalid medium.
    pub fn new(
        kind: WaveKind,
        incidence: Angle,
        medium: &ElasticMedium,
    ) -> Result<Self, WaveError> {
        let degrees = incidence.degrees();
        ParameterError::check("incidence", degrees, 0.0, f64::MAX)?;
        let limit = kind.greatest_incidence();
        if degrees > limit * (1.0 + 1e-14) {
            return Err(WaveError::GrazingIncidence {
                kind,
                degrees,
                limit,
            });
        }
        let medium = ElasticMedium::new(medium.young, medium.poisson, medium.density)?;
        let (cp, cs) = (medium.p_speed(), medium.s_speed());
        let (sine, cosine) = incidence.radians().sin_cos();
        let real = |value: f64| Complex::new(value, 0.0);
        // Slownesses in units of 1/cs; ratio^2 - p^2 = xi^2.
        let ratio = cs / cp;
        let (p, square, xi, eta) = match kind {
            WaveKind::P => {
                let (p, xi) = (ratio * sine, ratio * cosine);
                (p, xi * xi, real(xi), (1.0 - p * p).sqrt())
            }
            WaveKind::SV | WaveKind::SH => {
                let square = (ratio - sine) * (ratio + sine);
                let xi = if square >= 0.0 {
                    real(square.sqrt())
                } else {
                    Complex::new(0.0, -(-square).sqrt())
                };
                (sine, square, xi, cosine)
            }
        };
        // 1 - 2 p^2, from xi: at nu = 0 both vanish at 45 degrees, and their ratio counts.
        let k = medium.poisson / (1.0 - medium.poisson) + 2.0 * square;
        let product = xi * (4.0 * p * p * eta);
        let mut sum = real(k * k) + product;
        let mut difference = real(k * k) - product;
        if sum == real(0.0) {
            // k^2 is of higher order than xi there.
            (sum, difference) = (real(1.0), real(-1.0));
        }
        let (same, converted, vertical, other, other_speed) = match kind {
            WaveKind::SV => {
                let converted = real(4.0 * (cs / cp) * p * eta * k) / sum;
                (-difference / sum, converted, eta, xi, cp)
            }
            WaveKind::P => {
                let converted = xi * (4.0 * (cp / cs) * p * k) / sum;
                (difference / sum, converted, xi.re, real(eta), cs)
            }
            WaveKind::SH => (real(1.0), real(0.0), eta, real(0.0), cp),
        };
        Ok(Self {
            kind,
            incidence,
            same,
            converted,
            horizontal_slowness: p / cs,
            vertical_slowness: vertical / cs,
            converted_slowness: other / cs,
            converted_speed: other_speed,
        })
    }

    /// Whether the incidence is past the critical angle, so that the reflected P wave decays with depth.
    pub fn past_critical(&self) -> bool {
        self.kind == WaveKind::SV && self.converted_slowness.im < 0.0
    }

    /// Displacement of the surface for unit incident amplitude: along the horizontal direction of
    /// travel, across it, and up.
    pub fn surface_motion(&self) -> [Complex; 3] {
        let [incident, same, converted] = self.polarisations();
        core::array::from_fn(|i| incident[i] + same[i] + converted[i])
    }

    /// Displacement vectors of the incident wave, the reflected one of its type and the converted
    /// one, amplitudes included, in the frame of [`surface_motion`](Self::surface_motion).
    pub(crate) fn polarisations(&self) -> [[Complex; 3]; 3] {
        let (sine, cosine) = self.incidence.radians().sin_cos();
        let zero = Complex::new(0.0, 0.0);
        let real = |x: f64, y: f64, z: f64| [x, y, z].map(|value| Complex::new(value, 0.0));
        let converted_sine = Complex::new(self.horizontal_slowness * self.converted_speed, 0.0);
        let converted_cosine = self.converted_slowness * self.converted_speed;
        let (incident, same, converted) = match self.kind {
            WaveKind::P => (
                real(sine, 0.0, cosine),
                real(-sine, 0.0, cosine),
                [converted_cosine, zero, converted_sine],
            ),
            WaveKind::SV => (
                real(cosine, 0.0, -sine),
                real(-cosine, 0.0, -sine),
                [converted_sine, zero, -converted_cosine],
            ),
            WaveKind::SH => (real(0.0, 1.0, 0.0), real(0.0, 1.0, 0.0), [zero; 3]),
        };
        [
            incident,
            same.map(|value| value * self.same),
            converted.map(|value| value * self.converted),
        ]
    }

    /// Shares of the incident energy flux in the reflected wave of the same type and in the converted
    /// wave; they sum to one. An evanescent wave has none.
    pub fn energy(&self) -> [f64; 2] {
        // Flux through the surface: rho c^2 q |B|^2, q the vertical slowness.
        // The incident speed follows from its two slownesses.
        let slowness = self.horizontal_slowness.hypot(self.vertical_slowness);
        let incident = self.vertical_slowness / (slowness * slowness);
        let other = self.converted_speed * self.converted_speed * self.converted_slowness.re;
        let same = self.same.norm_sqr();
        if incident > 0.0 {
            [same, self.converted.norm_sqr() * other / incident]
        } else {
            [same, 0.0]
        }
    }
}
