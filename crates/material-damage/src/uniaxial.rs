//! Uniaxial stress against plastic strain, with damage and the width of a crack band.

use powerhouse_model::{Lane, ParameterError};

use crate::MaterialError;
use crate::exponential::decay;

/// The least inverse of a rate.
const STEEPEST: f64 = 1.0e-12;
/// The share of the effective strength that is never lost.
const LEAST_STRENGTH: f64 = 1.0e-3;

/// Strength and damage in uniaxial stress against the plastic strain `e`:
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
    /// `f` (Pa).
    limit: f64,
    /// `a`.
    bulge: f64,
    /// `r`.
    damage: f64,
    /// `1 / b = length / h - lost`.
    length: f64,
    lost: f64,
    /// The least `1 / b` at which strain does not turn back.
    steepest: f64,
}

impl UniaxialCurve {
    /// The curve of an elastic limit `f` (Pa), a bulge `a`, a share `r` of damage, 0 to 1, and an
    /// energy per area (N/m).
    pub(crate) fn new(
        limit: f64,
        bulge: f64,
        damage: f64,
        energy: f64,
        young: f64,
    ) -> Result<Self, MaterialError> {
        ParameterError::check("energy", energy, f64::MIN_POSITIVE, 1.0e12)?;
        let (a, r) = (bulge, damage);
        let area = 1.0 + 0.5 * a;
        let elastic =
            (1.0 + a).powi(2) / (2.0 - r) - 2.0 * a * (1.0 + a) / (3.0 - r) + a * a / (4.0 - r);
        // The steepest fall of the effective strength, at exp(-b e) = z: -f b times this.
        let z = (1.0 + a) * (1.0 - r).powi(2) / (a * (2.0 - r).powi(2));
        let fall = if z < 1.0 {
            (1.0 + a) * (1.0 - r) / (2.0 - r) * z.powf(1.0 - r)
        } else {
            (1.0 + a) * (1.0 - r) - a * (2.0 - r)
        };
        Ok(Self {
            limit,
            bulge,
            damage,
            length: energy / (limit * area),
            lost: 0.5 * r * limit / young * elastic / area,
            steepest: fall.max(0.0) * limit / young,
        })
    }

    /// The curve of a material whose elastic moduli are larger by a factor, and which takes the
    /// same energy.
    pub(crate) fn with_stiffness(mut self, factor: f64) -> Self {
        self.lost /= factor;
        self.steepest /= factor;
        self
    }

    /// The elastic limit `f` (Pa).
    pub(crate) fn limit(&self) -> f64 {
        self.limit
    }

    /// The largest width of an element in which strain does not turn back (m).
    pub(crate) fn largest_size(&self) -> f64 {
        self.length / (self.lost + self.steepest)
    }

    /// `b` in an element of a width (m); in one too wide the greatest that can be followed.
    #[inline(always)]
    pub(crate) fn rate<L: Lane>(&self, size: L) -> L {
        let number = |value: f64| size.constant(value);
        let room = number(self.length) - number(self.lost) * size;
        size / room.max(number(self.steepest.max(STEEPEST)) * size)
    }

    /// The inverse of the effective strength (1/Pa), which is at least a thousandth of the limit, and
    /// its slope over the plastic strain.
    #[inline(always)]
    pub(crate) fn inverse_strength<L: Lane>(&self, strain: L, rate: L) -> [L; 2] {
        let number = |value: f64| strain.constant(value);
        let (zero, one) = (number(0.0), number(1.0));
        let (a, kept) = (self.bulge, 1.0 - self.damage);
        let limit = number(1.0 / self.limit);
        // Curves that stay as they are cost nothing: `a` is zero in tension.
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
        let (softened, hollow) = (decay(number(kept) * fallen), decay(fallen));
        let shape = softened * (number(1.0 + a) - number(a) * hollow);
        let least = number(LEAST_STRENGTH);
        let falls = least.less(shape);
        let turned = one / shape.max(least);
        let swollen = number(a) * softened * hollow;
        let slope = rate * turned * (number(kept) - swollen * turned);
        [limit * turned, (limit * slope).select(falls, zero)]
    }

    /// The damage, at most `most`.
    #[inline(always)]
    pub(crate) fn damage<L: Lane>(&self, strain: L, rate: L, most: f64) -> L {
        let number = |value: f64| strain.constant(value);
        let left = decay(number(self.damage) * (rate * strain));
        (number(1.0) - left).min(number(most))
    }
}
