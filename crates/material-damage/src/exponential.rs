//! Exponential and power functions on lanes.

use powerhouse_model::{Lane, Scalar};

/// Greatest argument: below `exp(-87)` single precision has no normal numbers.
const MOST: f64 = 87.0;
/// `ln 2` as a part with nine bits, so that its multiples are exact, and the difference.
const LN_2: [f64; 2] = [0.693_359_375, -2.121_944_400_546_905_8e-4];
/// Number of factors of a power outside the range of the exponential: `2 ln(1e308) / 87` and some.
const PARTS: usize = 20;
/// Highest power of the Taylor series at `|y| < 0.35`, for a remainder below double rounding;
/// half of it does for single precision.
const TERMS: usize = 13;
/// Taylor coefficients `1 / k!`.
const INVERSE_FACTORIALS: [f64; TERMS + 1] = {
    let mut inverse = [1.0; TERMS + 1];
    let mut factorial = 1.0;
    let mut k = 1;
    while k <= TERMS {
        factorial *= k as f64;
        inverse[k] = 1.0 / factorial;
        k += 1;
    }
    inverse
};

/// `exp(-x)` for `x` above -87, to a few rounding errors; `exp(-87)` beyond 87.
///
/// `x = n ln 2 - y` with the nearest integer `n`: Taylor series in `y`, even and odd powers separately,
/// for instruction-level parallelism, and `2^-n`. The operations are the same in every lane.
#[inline(always)]
pub(crate) fn decay<L: Lane>(x: L) -> L {
    let number = |value: f64| x.constant(value);
    let x = x.min(number(MOST));
    let halvings = (x * number(core::f64::consts::LOG2_E)).round();
    let y = number(LN_2[1]).mul_add(halvings, number(LN_2[0]).mul_add(halvings, -x));
    let square = y * y;
    // Odd, so that the highest odd power is the next above the highest even one.
    let mut k = if L::Scalar::EPSILON > 1.0e-10 {
        TERMS / 2 + 1
    } else {
        TERMS
    };
    let mut odd = number(INVERSE_FACTORIALS[k]);
    let mut even = number(INVERSE_FACTORIALS[k - 1]);
    while k > 1 {
        k -= 2;
        odd = odd.mul_add(square, number(INVERSE_FACTORIALS[k]));
        even = even.mul_add(square, number(INVERSE_FACTORIALS[k - 1]));
    }
    y.mul_add(odd, even) * (-halvings).power_of_two()
}

/// Square root of a half: the reduced argument of the logarithm is around one.
const LEAST: f64 = core::f64::consts::FRAC_1_SQRT_2;
/// Number of terms of the series at `|z| < 0.172`, for a remainder below double rounding.
const LOGARITHM_TERMS: usize = 11;

/// `ln x` for positive normal numbers, to a few rounding errors of the value or of one, the larger.
///
/// Powers of two are removed bit by bit, then `ln m = 2 (z + z^3 / 3 + ...)` with `z = (m - 1) /
/// (m + 1)`.
#[inline(always)]
fn logarithm<L: Lane>(x: L) -> L {
    let number = |value: f64| x.constant(value);
    let mut rest = x;
    let mut doublings = number(0.0);
    for bit in [512, 256, 128, 64, 32, 16, 8, 4, 2, 1] {
        // Powers outside the range of single precision.
        if bit > 64 && L::Scalar::EPSILON > 1.0e-10 {
            continue;
        }
        let (up, count) = (2.0_f64.powi(bit), number(f64::from(bit)));
        let is_large = number(up * LEAST).less(rest);
        rest = (rest * number(1.0 / up)).select(is_large, rest);
        doublings = (doublings + count).select(is_large, doublings);
        let is_small = rest.less(number(2.0 * LEAST / up));
        rest = (rest * number(up)).select(is_small, rest);
        doublings = (doublings - count).select(is_small, doublings);
    }
    let one = number(1.0);
    // Still up to twice too large.
    let is_large = number(2.0 * LEAST).less(rest);
    rest = (rest * number(0.5)).select(is_large, rest);
    doublings = (doublings + one).select(is_large, doublings);
    let z = (rest - one) / (rest + one);
    let square = z * z;
    let mut sum = number(0.0);
    for k in (0..LOGARITHM_TERMS).rev() {
        sum = sum.mul_add(square, number(2.0 / (2 * k + 1) as f64));
    }
    let fine = z.mul_add(sum, doublings * number(LN_2[1]));
    doublings.mul_add(number(LN_2[0]), fine)
}

/// `x^p` for `x >= 0` and a power `0 < p <= 2`, to a few rounding errors times the logarithm; zero at
/// zero, and below the normal numbers.
#[inline(always)]
pub(crate) fn power<L: Lane>(x: L, p: f64) -> L {
    let number = |value: f64| x.constant(value);
    let (zero, one) = (number(0.0), number(1.0));
    let normal = if L::Scalar::EPSILON > 1.0e-10 {
        f64::from(f32::MIN_POSITIVE)
    } else {
        f64::MIN_POSITIVE
    };
    let is_normal = number(normal).less(x);
    let exponent = number(p) * logarithm(x.select(is_normal, one));
    let is_small = exponent.less(zero);
    let size = decay(exponent.abs());
    let grown = size.select(is_small, one / size);
    // Outside the range of the exponential, as a product of two.
    let most = number(MOST);
    let beyond = most.less(exponent.abs());
    let halves = if zero.any(beyond) {
        let mut all = one;
        for _ in 0..PARTS {
            let part = decay(exponent.abs() * number(1.0 / PARTS as f64));
            all = all * part;
        }
        all.select(is_small, one / all)
    } else {
        grown
    };
    halves.select(beyond, grown).select(is_normal, zero)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The function agrees with the standard library to four rounding errors, in both precisions.
    #[test]
    fn decay_is_the_exponential() {
        for step in -860_000..=870_000 {
            let x = 1.0e-4 * f64::from(step);
            let error = (decay(x) / (-x).exp() - 1.0).abs();
            assert!(error < 4.0 * f64::EPSILON, "{x}: {error:e}");
            if step % 100 == 0 {
                let x = x as f32;
                let error = (f64::from(decay(x)) / (-f64::from(x)).exp() - 1.0).abs();
                assert!(error < 4.0 * f64::from(f32::EPSILON), "{x}: {error:e}");
            }
        }
        assert_eq!(decay(0.0), 1.0);
        assert_eq!(decay(1.0e300), decay(87.0));
    }

    /// Powers agree with the standard library, to rounding errors of the exponent, in both precisions,
    /// over the whole range of numbers.
    #[test]
    fn powers_are_powers() {
        for step in -3000..=3000_i32 {
            let x = 10.0_f64.powf(0.1 * f64::from(step));
            for p in [0.5, 0.501, 0.66, 0.97, 1.0] {
                let error = (power(x, p) / x.powf(p) - 1.0).abs();
                let limit = 4.0 * f64::EPSILON * (2.0 + x.ln().abs());
                assert!(error < limit, "{x} {p}: {error:e}");
            }
            if step.abs() < 370 {
                let x = x as f32;
                let exact = f64::from(x).powf(0.6);
                let error = (f64::from(power(x, 0.6)) / exact - 1.0).abs();
                let limit = 4.0 * f64::from(f32::EPSILON) * (2.0 + f64::from(x.ln().abs()));
                assert!(error < limit, "{x}: {error:e}");
            }
        }
        assert_eq!([power(0.0, 0.5), power(1.0, 0.7)], [0.0, 1.0]);
    }
}
