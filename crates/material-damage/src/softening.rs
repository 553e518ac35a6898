//! Damage evolution, and its regularisation by the width of a crack band.

#[cfg(feature = "keys")]
use powerhouse_model::keys::*;
use powerhouse_model::{Lane, ParameterError};

use crate::exponential::decay;
use crate::{MaterialError, SofteningOf};

/// Least inverse of a softening rate, for elements of a size that is not permitted.
pub(crate) const STEEPEST: f64 = 1.0e-12;

/// Checks that an element of a width (m) snaps back in none of the softenings; each comes with its
/// largest permitted width (m), if it has one. The error names the one that permits least.
pub(crate) fn check_size(
    size: f64,
    largest: &[(SofteningOf, Option<f64>)],
) -> Result<(), MaterialError> {
    ParameterError::check("size", size, f64::MIN_POSITIVE, f64::MAX)?;
    let limits = largest.iter().filter_map(|&(of, limit)| Some((of, limit?)));
    match limits.min_by(|a, b| a.1.total_cmp(&b.1)) {
        Some((of, largest)) if size >= largest => {
            Err(MaterialError::SnapBack { of, size, largest })
        }
        _ => Ok(()),
    }
}

/// Damage evolution of one kind, tensile or compressive, in its equivalent plastic strain `e`.
///
/// `d = 1 - (1 - A) e0 / e - A exp(-B (e - e0))` beyond the threshold `e0`, zero before
///
/// Source: Wang, Chen & Xiao (2019), Eq. (25), after Mazars (1986).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "keys", derive(Deserialize, Serialize, JsonSchema))]
#[cfg_attr(feature = "keys", serde(try_from = "SofteningKeys", untagged))]
pub enum Softening {
    /// No damage of this kind.
    #[default]
    None,
    /// Crack band that dissipates the same energy whatever its width `h`: `A = 1` and
    ///
    /// `B = 1 / (q (G / (h f) - f / 2E) - e0)`
    ///
    /// with the uniaxial strength `f` of the surface and `q` the growth of `e` with the
    /// strain along the load (1 unless flow is dilatant all around). The element's elastic energy
    /// at the peak, the flow up to the threshold and the softening then dissipate `G / h` together
    /// (crack band: Bazant & Oh 1983).
    FractureEnergy {
        /// Fracture energy `G` per area of crack (tension) or of crushing band (compression) (N/m).
        #[cfg_attr(feature = "keys", serde(rename = "fracture_energy"))]
        energy: f64,
        /// Equivalent plastic strain at first damage `e0` (1).
        threshold: f64,
    },
    /// Given coefficients of the equation. The dissipated energy then depends on the mesh.
    Rates {
        /// Share `A` (1), 0 to 2; above 1 damage is limited by the residual stiffness.
        share: f64,
        /// Rate `B` (1), above 0.
        rate: f64,
        /// Equivalent plastic strain at first damage `e0` (1).
        threshold: f64,
    },
}

/// Damage evolution: either `fracture_energy`, or `rate` and `share` as in Eq. (25).
#[cfg(feature = "keys")]
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct SofteningKeys {
    /// Fracture energy per area of a crack or crushing band (N/m), above 0; independent of the element size.
    fracture_energy: Option<Positive>,
    /// Parameter B (dimensionless), above 0; the dissipated energy then depends on the element size.
    rate: Option<Positive>,
    /// Parameter A (dimensionless), above 0 and at most 1, 1 by default.
    share: Option<NonNegative>,
    /// Damage threshold: equivalent plastic strain at first damage (dimensionless), 0 or above, 0 by default.
    #[serde(with = "NonNegative", default)]
    threshold: f64,
}

/// What is wrong with the keys of a softening.
#[cfg(feature = "keys")]
pub(crate) const SOFTENING_KEYS: &str =
    "either fracture_energy, or rate with optional share, must be given";

#[cfg(feature = "keys")]
impl TryFrom<SofteningKeys> for Softening {
    type Error = &'static str;
    fn try_from(keys: SofteningKeys) -> Result<Self, &'static str> {
        let threshold = keys.threshold;
        match (keys.fracture_energy, keys.rate, keys.share) {
            (Some(energy), None, None) => Ok(Self::FractureEnergy {
                energy: energy.get(),
                threshold,
            }),
            (None, Some(rate), share) => Ok(Self::Rates {
                share: share.map_or(1.0, NonNegative::get),
                rate: rate.get(),
                threshold,
            }),
            _ => Err(SOFTENING_KEYS),
        }
    }
}

/// Softening rate, given or by fracture energy.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Rate {
    Never,
    Fixed(f64),
    /// Rate by fracture energy, `1 / B = length / h - lost`.
    Band {
        length: f64,
        lost: f64,
    },
}

/// Damage evolution with the coefficients for a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DamageCurve {
    threshold: f64,
    share: f64,
    rate: Rate,
}

impl DamageCurve {
    /// Damage curve for a uniaxial `strength` (Pa), Young's modulus (Pa), and growth of the
    /// equivalent plastic strain with the strain along the load.
    pub(crate) fn new(
        softening: Softening,
        strength: f64,
        young: f64,
        growth: f64,
    ) -> Result<Self, MaterialError> {
        let most = 1.0;
        Ok(match softening {
            Softening::None => Self {
                threshold: 0.0,
                share: 1.0,
                rate: Rate::Never,
            },
            Softening::FractureEnergy { energy, threshold } => {
                ParameterError::check("energy", energy, f64::MIN_POSITIVE, 1.0e12)?;
                ParameterError::check("threshold", threshold, 0.0, most)?;
                ParameterError::check("strength", strength, f64::MIN_POSITIVE, f64::MAX)?;
                Self {
                    threshold,
                    share: 1.0,
                    rate: Rate::Band {
                        length: growth * energy / strength,
                        lost: 0.5 * growth * strength / young + threshold,
                    },
                }
            }
            Softening::Rates {
                share,
                rate,
                threshold,
            } => {
                ParameterError::check("share", share, 0.0, 2.0)?;
                ParameterError::check("rate", rate, f64::MIN_POSITIVE, 1.0e12)?;
                ParameterError::check("threshold", threshold, 0.0, most)?;
                Self {
                    threshold,
                    share,
                    rate: Rate::Fixed(rate),
                }
            }
        })
    }

    /// Damage curve of a material whose elastic moduli are multiplied by a factor, with the same fracture
    /// energy.
    pub(crate) fn with_stiffness(mut self, factor: f64) -> Self {
        if let Rate::Band { lost, .. } = &mut self.rate {
            *lost = (*lost - self.threshold) / factor + self.threshold;
        }
        self
    }

    /// Largest width of an element that does not snap back (m), if there is one.
    pub(crate) fn largest_size(&self) -> Option<f64> {
        match self.rate {
            Rate::Band { length, lost } => Some(length / lost),
            _ => None,
        }
    }

    /// Damage of an equivalent plastic strain in an element of a width (m), at most `most`.
    #[inline(always)]
    pub(crate) fn damage<L: Lane>(&self, strain: L, size: L, most: f64) -> L {
        let number = |value: f64| strain.constant(value);
        let rate = match self.rate {
            Rate::Never => return number(0.0),
            Rate::Fixed(rate) => number(rate),
            Rate::Band { length, lost } => {
                let room = number(length) - number(lost) * size;
                size / room.max(number(STEEPEST) * size)
            }
        };
        damage_of(strain, self.threshold, self.share, rate, most)
    }
}

/// Damage `1 - (1 - A) e0 / e - A exp(-B (e - e0))` beyond the threshold, at most `most`.
#[inline(always)]
pub(crate) fn damage_of<L: Lane>(strain: L, threshold: f64, share: f64, rate: L, most: f64) -> L {
    let number = |value: f64| strain.constant(value);
    let (zero, one) = (number(0.0), number(1.0));
    let first = number(threshold);
    let beyond = first.less(strain);
    if !strain.any(beyond) {
        return zero;
    }
    let softened = number(share) * decay(rate * (strain - first).max(zero));
    let mut damage = one - softened;
    let stays = (1.0 - share) * threshold;
    if stays != 0.0 {
        damage = damage - number(stays) / strain.select(beyond, one);
    }
    damage.max(zero).min(number(most)).select(beyond, zero)
}

/// Damage `1 - (e0 / e) exp(-B (e - e0))` beyond the threshold, at most `most`.
#[inline(always)]
pub(crate) fn damage_of_falling_stress<L: Lane>(
    strain: L,
    threshold: f64,
    rate: L,
    most: f64,
) -> L {
    let number = |value: f64| strain.constant(value);
    let (zero, first) = (number(0.0), number(threshold));
    let beyond = first.less(strain);
    let divisor = strain.select(beyond, number(1.0));
    let kept = first / divisor * decay(rate * (strain - first).max(zero));
    (number(1.0) - kept).min(number(most)).select(beyond, zero)
}

/// Inverse rate `1 / B` of `G / (h E) = e0^2 / 2 + e0 / B + 1 / B^2`, with `length = G / E` (m).
#[inline(always)]
pub(crate) fn inverse_rate_in_total_strain<L: Lane>(size: L, length: f64, threshold: f64) -> L {
    let number = |value: f64| size.constant(value);
    let square = number(4.0 * length) / size - number(threshold * threshold);
    let inverse = (square.max(number(0.0)).sqrt() - number(threshold)) * number(0.5);
    inverse.max(number(STEEPEST))
}
