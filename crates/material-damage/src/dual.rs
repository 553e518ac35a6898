//! Numbers that carry their derivatives.

use core::ops::{Add, Div, Mul, Neg, Sub};

use powerhouse_model::Lane;

/// A number and its derivatives with respect to three others: a law computed with it is
/// differentiated along the way, without a difference quotient.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Dual {
    pub(crate) value: f64,
    pub(crate) slope: [f64; 3],
}

impl Dual {
    /// The number of which the derivative at a place is one.
    pub(crate) fn variable(value: f64, place: usize) -> Self {
        let slope = core::array::from_fn(|i| f64::from(u8::from(i == place)));
        Self { value, slope }
    }

    /// A number that does not change.
    pub(crate) fn fixed(value: f64) -> Self {
        Self {
            value,
            slope: [0.0; 3],
        }
    }

    /// `f` of this number, with the derivative `f'`.
    fn through(self, value: f64, derivative: f64) -> Self {
        Self {
            value,
            slope: self.slope.map(|s| derivative * s),
        }
    }

    /// A function of two numbers, with its derivatives.
    fn combine(self, other: Self, value: f64, [first, second]: [f64; 2]) -> Self {
        let slope = core::array::from_fn(|i| first * self.slope[i] + second * other.slope[i]);
        Self { value, slope }
    }
}

impl Add for Dual {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.combine(other, self.value + other.value, [1.0, 1.0])
    }
}
impl Sub for Dual {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self.combine(other, self.value - other.value, [1.0, -1.0])
    }
}
impl Mul for Dual {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        self.combine(other, self.value * other.value, [other.value, self.value])
    }
}
impl Div for Dual {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        let inverse = 1.0 / other.value;
        self.combine(other, value, [inverse, -value * inverse])
    }
}
impl Neg for Dual {
    type Output = Self;
    fn neg(self) -> Self {
        self.through(-self.value, -1.0)
    }
}

impl Lane for Dual {
    type Scalar = f64;
    type Token = ();
    type Mask = bool;
    const WIDTH: usize = 1;

    fn splat(_token: (), value: f64) -> Self {
        Self::fixed(value)
    }
    fn load(token: (), from: &[f64]) -> Self {
        Self::splat(token, from[0])
    }
    fn store(self, to: &mut [f64]) {
        to[0] = self.value;
    }
    fn token(self) {}
    fn mul_add(self, factor: Self, summand: Self) -> Self {
        self * factor + summand
    }
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        // At zero the slope is without bound; no direction is preferred there.
        let derivative = if root > 0.0 { 0.5 / root } else { 0.0 };
        self.through(root, derivative)
    }
    fn abs(self) -> Self {
        if self.value < 0.0 { -self } else { self }
    }
    fn less(self, other: Self) -> bool {
        self.value < other.value
    }
    fn select(self, mask: bool, other: Self) -> Self {
        if mask { self } else { other }
    }
    fn any(self, mask: bool) -> bool {
        mask
    }
    fn extract(self, _lane: usize) -> f64 {
        self.value
    }
    fn build(token: (), mut value: impl FnMut(usize) -> f64) -> Self {
        Self::splat(token, value(0))
    }
    /// Whole numbers do not change.
    fn round(self) -> Self {
        Self::fixed(Lane::round(self.value))
    }
    fn power_of_two(self) -> Self {
        Self::fixed(self.value.power_of_two())
    }
}
