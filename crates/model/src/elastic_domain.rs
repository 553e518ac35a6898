//! Elastic domains of constitutive laws.

use crate::{Lane, Scalar, Stress};

/// Cone of stresses, `mean p + shear sqrt(J2) <= strength` with the mean stress `p` and the second
/// invariant `J2` of the deviator.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Cone {
    mean: f64,
    shear: f64,
    strength: f64,
}

/// Elastic domain of a virgin material in stress space, bounded by cones in the mean stress and `sqrt(J2)`:
/// total stresses at which the law is certainly elastic while its history variables are zero.
///
/// Engines use Hooke's law instead of the constitutive law for batches of points inside. The domain may be
/// smaller than that of the law, never larger.
///
/// ```
/// use powerhouse_model::{ElasticDomain, Stress};
/// // sqrt(J2) below 1 MPa, and no mean tension above 0.1 MPa.
/// let domain = ElasticDomain::EVERYTHING.within(0.0, 1.0, 1e6).within(1.0, 0.0, 1e5);
/// let pressed = |p: f64| Stress([-p, -p, -p, 0.9e6, 0.0, 0.0]);
/// assert!(domain.contains(&pressed(5e6)));
/// assert!(!domain.contains(&pressed(-2e5)));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ElasticDomain {
    cones: Vec<Cone>,
}

/// Margin in units of rounding, for laws whose yield surface is on a cone.
const ROUNDINGS: f64 = 64.0;

impl ElasticDomain {
    /// The domain of all stresses.
    pub const EVERYTHING: Self = Self { cones: Vec::new() };

    /// The part of the domain in which `mean p + shear sqrt(J2) <= strength` (Pa) with the mean stress `p`,
    /// for a factor `shear` that is not negative; the whole domain for an infinite strength.
    #[must_use]
    pub fn within(mut self, mean: f64, shear: f64, strength: f64) -> Self {
        if strength < f64::INFINITY {
            self.cones.push(Cone {
                mean,
                shear,
                strength,
            });
        }
        self
    }

    /// Whether the stresses (Pa) of all lanes are inside, by more than rounding; false if one is not a
    /// number.
    #[inline(always)]
    pub fn contains<L: Lane>(&self, stress: &Stress<L>) -> bool {
        let (mean, shear) = stress.mean_and_shear();
        let number = |value: f64| mean.constant(value);
        let (zero, one) = (number(0.0), number(1.0));
        let slack = number(ROUNDINGS * L::Scalar::EPSILON);
        // Stresses beyond the range of numbers are outside, also without any cone.
        let mut outside = (mean + shear) * zero;
        for cone in &self.cones {
            let pressed = number(cone.mean) * mean;
            let sheared = number(cone.shear) * shear;
            let strength = number(cone.strength);
            let size = pressed.abs() + sheared + strength.abs();
            let reach = slack.mul_add(size, pressed + sheared);
            outside = outside + zero.select(reach.less(strength), one);
        }
        let inside = zero.select(outside.less(one), one);
        !mean.any(zero.less(inside))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Stresses that are no numbers, or whose squares are beyond them, are outside of every domain; so
    /// is what lies on a cone to rounding.
    #[test]
    fn only_what_is_surely_inside_is() {
        let shear = |s: f64| Stress([0.0, 0.0, 0.0, s, 0.0, 0.0]);
        for domain in [
            ElasticDomain::EVERYTHING,
            ElasticDomain::EVERYTHING.within(0.0, 1.0, f64::MAX),
        ] {
            for s in [f64::NAN, f64::INFINITY, 1e200] {
                assert!(!domain.contains(&shear(s)), "{s}");
            }
            assert!(domain.contains(&shear(1e100)));
        }
        let domain = ElasticDomain::EVERYTHING.within(0.5, 1.0, 3.0);
        for (s, expected) in [(3.0, false), (3.0 - 1e-15, false), (3.0 - 1e-12, true)] {
            assert_eq!(domain.contains(&shear(s)), expected, "{s}");
        }
        let single = |s: f32| Stress([0.0_f32, 0.0, 0.0, s, 0.0, 0.0]);
        for (s, expected) in [(3.0, false), (2.999_999, false), (2.999, true)] {
            assert_eq!(domain.contains(&single(s)), expected, "{s}");
        }
    }
}
