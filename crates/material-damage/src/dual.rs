//! Dual numbers, for automatic differentiation.

use core::ops::{Add, Div, Mul, Neg, Sub};

use powerhouse_model::Lane;

/// Dual number: a value and its derivatives with respect to three variables. A law evaluated with
/// dual numbers returns its derivatives too, without a difference quotient.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Dual {
    pub(crate) value: f64,
    pub(crate) slope: [f64; 3],
}

impl Dual {
    /// Independent variable with the given index among the three.
    pub(crate) fn variable(value: f64, index: usize) -> Self {
        let slope = core::array::from_fn(|i| f64::from(u8::from(i == index)));
        Self { value, slope }
    }

    /// Constant, whose derivatives are zero.
    pub(crate) fn fixed(value: f64) -> Self {
        Self {
            value,
            slope: [0.0; 3],
        }
    }

    /// Value `f` of a function of this number, by the chain rule with its derivative `f'`.
    fn through(self, value: f64, derivative: f64) -> Self {
        Self {
            value,
            slope: self.slope.map(|s| derivative * s),
        }
    }

    /// Value of a function of two numbers, by the chain rule with its two derivatives.
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
        // At zero the slope is unbounded; no direction is preferred there.
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
    /// The derivative of a rounded number is zero.
    fn round(self) -> Self {
        Self::fixed(Lane::round(self.value))
    }
    fn power_of_two(self) -> Self {
        Self::fixed(self.value.power_of_two())
    }
}
