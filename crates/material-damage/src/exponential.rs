//! The exponential function on lanes.

use powerhouse_model::Lane;

/// The greatest argument: below `exp(-87)` single precision has no normal numbers.
const MOST: f64 = 87.0;
/// `ln 2` in a part with nine bits, so that its multiples are exact, and the rest.
const LN_2: [f64; 2] = [0.693_359_375, -2.121_944_400_546_905_8e-4];
/// Terms of the series at `|r| < 0.73`, for a remainder below a rounding of doubles.
const TERMS: usize = 18;

/// `exp(-x)` for `x >= 0`, to a few roundings; `exp(-87)` beyond 87.
///
/// `x = n ln 2 + r`: halves are taken off bit by bit of `n`, then Taylor's series in `r`. The same
/// operations in every lane.
#[inline(always)]
pub(crate) fn decay<L: Lane>(x: L) -> L {
    let number = |value: f64| x.constant(value);
    let mut rest = x.min(number(MOST));
    let mut halvings = number(0.0);
    let mut scale = number(1.0);
    for bit in [64, 32, 16, 8, 4, 2, 1] {
        let bits = f64::from(bit);
        let part = number(bits * LN_2[0]);
        let keeps = rest.less(part);
        rest = rest.select(keeps, rest - part);
        halvings = halvings.select(keeps, halvings + number(bits));
        scale = scale.select(keeps, scale * number(0.5_f64.powi(bit)));
    }
    let negative = number(LN_2[1]).mul_add(halvings, -rest);
    let mut sum = number(1.0);
    for k in (1..=TERMS).rev() {
        // 1 + (y / k) (1 + (y / (k + 1)) (...))
        sum = (negative * number(1.0 / k as f64)).mul_add(sum, number(1.0));
    }
    sum * scale
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The function is that of the standard library to four roundings, in both precisions.
    #[test]
    fn decay_is_the_exponential() {
        for step in 0..=870_000 {
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
}
