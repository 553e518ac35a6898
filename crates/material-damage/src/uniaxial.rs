//! Uniaxial softening curve: stress and damage against plastic strain in a crack band.

use powerhouse_model::{Lane, ParameterError};

use crate::MaterialError;
use crate::exponential::decay;

/// Least inverse of a softening rate.
const STEEPEST: f64 = 1.0e-12;
/// Share of the effective strength that always remains.
const LEAST_STRENGTH: f64 = 1.0e-3;

/// Effective strength and damage in uniaxial stress against the plastic strain `e`:
///
/// `(1 - d) s = f ((1 + a) exp(-b e) - a exp(-2 b e))`, `1 - d = exp(-r b e)`
///
/// with the effective strength `s`, the elastic limit `f`, and the share `r` of damage in
/// softening. The nominal stress peaks at `f (1 + a)^2 / 4a` if `a > 1`, at `f` otherwise.
///
/// Source: Lee & Fenves (1998), *J. Eng. Mech.* 124(8), Eqs. (15)-(20), in terms of the plastic
/// strain. The work to full opening, `(1/b) f (1 + a/2)` of plastic flow and of elastic energy
///
/// `r f^2 / 2E ((1 + a)^2 / (2 - r) - 2 a (1 + a) / (3 - r) + a^2 / (4 - r))`,
///
/// is the energy of the band over its width.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct UniaxialCurve {
    /// Elastic limit `f` (Pa).
    limit: f64,
    /// Hardening coefficient `a`.
    hardening: f64,
    /// Share of damage `r`.
    damage: f64,
    /// Length of the inverse rate, `1 / b = length / h - lost` (m).
    length: f64,
    lost: f64,
    /// Least `1 / b` without snap-back.
    steepest: f64,
}

impl UniaxialCurve {
    /// Curve of an elastic limit `f` (Pa), a hardening coefficient `a`, a share `r` of damage, 0 to 1, and
    /// a fracture energy per area (N/m).
    pub(crate) fn new(
        limit: f64,
        hardening: f64,
        damage: f64,
        energy: f64,
        young: f64,
    ) -> Result<Self, MaterialError> {
        ParameterError::check("energy", energy, f64::MIN_POSITIVE, 1.0e12)?;
        let (a, r) = (hardening, damage);
        let area = 1.0 + 0.5 * a;
        let elastic =
            (1.0 + a).powi(2) / (2.0 - r) - 2.0 * a * (1.0 + a) / (3.0 - r) + a * a / (4.0 - r);
        // Steepest fall of the effective strength, at exp(-b e) = z: -f b times this.
        let z = (1.0 + a) * (1.0 - r).powi(2) / (a * (2.0 - r).powi(2));
        let fall = if z < 1.0 {
            (1.0 + a) * (1.0 - r) / (2.0 - r) * z.powf(1.0 - r)
        } else {
            (1.0 + a) * (1.0 - r) - a * (2.0 - r)
        };
        Ok(Self {
            limit,
            hardening,
            damage,
            length: energy / (limit * area),
            lost: 0.5 * r * limit / young * elastic / area,
            steepest: fall.max(0.0) * limit / young,
        })
    }

    /// Curve of a material whose elastic moduli are multiplied by a factor, with the same fracture
    /// energy.
    pub(crate) fn with_stiffness(mut self, factor: f64) -> Self {
        self.lost /= factor;
        self.steepest /= factor;
        self
    }

    /// Elastic limit `f` (Pa).
    pub(crate) fn limit(&self) -> f64 {
        self.limit
    }

    /// Largest width of an element without snap-back (m).
    pub(crate) fn largest_size(&self) -> f64 {
        self.length / (self.lost + self.steepest)
    }

    /// Strain (1) at the greatest stress in an element of a width (m), elastic strain with a modulus (Pa) included.
    pub(crate) fn strain_at_peak(&self, size: f64, young: f64) -> f64 {
        let a = self.hardening;
        // (1 + a) z - a z^2 is greatest at this z = exp(-b e).
        let z = if a > 1.0 { (1.0 + a) / (2.0 * a) } else { 1.0 };
        let stress = self.limit * z * (1.0 + a - a * z);
        -z.ln() / self.rate(size) + stress / (young * z.powf(self.damage))
    }

    /// Softening rate `b` in an element of a width (m); in one too wide the greatest that can be followed.
    #[inline(always)]
    pub(crate) fn rate<L: Lane>(&self, size: L) -> L {
        let number = |value: f64| size.constant(value);
        let room = number(self.length) - number(self.lost) * size;
        size / room.max(number(self.steepest.max(STEEPEST)) * size)
    }

    /// Inverse of the effective strength (1/Pa), which is at least a thousandth of the limit, and its
    /// derivative with respect to the plastic strain.
    #[inline(always)]
    pub(crate) fn inverse_strength<L: Lane>(&self, strain: L, rate: L) -> [L; 2] {
        let number = |value: f64| strain.constant(value);
        let (zero, one) = (number(0.0), number(1.0));
        let (a, kept) = (self.hardening, 1.0 - self.damage);
        let limit = number(1.0 / self.limit);
        // Short cut for a constant strength: `a` is zero in tension.
        if a == 0.0 && kept == 0.0 {
            return [limit, zero];
        }
        let fallen = rate * strain;
        if a == 0.0 {
            let most = number(-LEAST_STRENGTH.ln());
            let exponent = number(kept) * fallen;
            let falls = exponent.less(most);
            let inverse = limit * decay(-exponent.min(most));
            return [inverse, (number(kept) * rate * inverse).select(falls, zero)];
        }
        let (softened, decayed) = (decay(number(kept) * fallen), decay(fallen));
        let shape = softened * (number(1.0 + a) - number(a) * decayed);
        let least = number(LEAST_STRENGTH);
        let falls = least.less(shape);
        let turned = one / shape.max(least);
        let hardened = number(a) * softened * decayed;
        let slope = rate * turned * (number(kept) - hardened * turned);
        [limit * turned, (limit * slope).select(falls, zero)]
    }

    /// Damage of a plastic strain at a softening rate, at most `most`.
    #[inline(always)]
    pub(crate) fn damage<L: Lane>(&self, strain: L, rate: L, most: f64) -> L {
        let number = |value: f64| strain.constant(value);
        let left = decay(number(self.damage) * (rate * strain));
        (number(1.0) - left).min(number(most))
    }
}
