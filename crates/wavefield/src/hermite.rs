//! Quintic Hermite interpolation.

use core::ops::{Add, Mul, Sub};

/// Quintic that interpolates displacement, velocity and acceleration at both ends of an interval:
/// coefficients of `sum_k c_k s^k`, `s` from 0 to 1 over an interval of length `step`.
///
/// The interpolation error of the displacement is at most `step^6/46080 max|d^6 u/dt^6|`, and the
/// velocity is the exact derivative of the displacement. `s` may be complex where the function is
/// analytic.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Quintic<T>([T; 6]);

impl<T> Quintic<T>
where
    T: Copy + Add<Output = T> + Sub<Output = T> + Mul<Output = T> + Mul<f64, Output = T>,
{
    /// Quintic of displacement, velocity and acceleration at the start and at the end.
    pub(crate) fn new(start: [T; 3], end: [T; 3], step: f64) -> Self {
        let [d0, v0, a0] = [start[0], start[1] * step, start[2] * (step * step)];
        let [d1, v1, a1] = [end[0], end[1] * step, end[2] * (step * step)];
        let rise = d1 - d0;
        Self([
            d0,
            v0,
            a0 * 0.5,
            rise * 10.0 - v0 * 6.0 - v1 * 4.0 - a0 * 1.5 + a1 * 0.5,
            v0 * 8.0 + v1 * 7.0 - rise * 15.0 + a0 * 1.5 - a1,
            rise * 6.0 - (v0 + v1) * 3.0 - (a0 - a1) * 0.5,
        ])
    }

    /// Quintic whose coefficients are a linear function of these.
    pub(crate) fn map<U>(&self, of: impl Fn(T) -> U) -> Quintic<U> {
        Quintic(self.0.map(of))
    }

    /// Displacement, and velocity times the step's length, at `s`.
    #[inline(always)]
    pub(crate) fn value(&self, s: T) -> (T, T) {
        let c = &self.0;
        let mut value = c[5];
        let mut derivative = c[5];
        for k in (1..5).rev() {
            value = value * s + c[k];
            derivative = derivative * s + value;
        }
        (value * s + c[0], derivative)
    }

    /// As [`value`](Self::value), at a real `s`.
    #[inline(always)]
    pub(crate) fn real_value(&self, s: f64) -> (T, T) {
        let c = &self.0;
        let mut value = c[5];
        let mut derivative = c[5];
        for k in (1..5).rev() {
            value = value * s + c[k];
            derivative = derivative * s + value;
        }
        (value * s + c[0], derivative)
    }

    /// Second derivative times the step's length squared, at `s`.
    #[inline(always)]
    pub(crate) fn second_derivative(&self, s: T) -> T {
        let c = &self.0;
        ((c[5] * 20.0 * s + c[4] * 12.0) * s + c[3] * 6.0) * s + c[2] * 2.0
    }
}
