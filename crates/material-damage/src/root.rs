//! Zeros of functions of one unknown, many at once.

use powerhouse_model::Lane;

/// The most evaluations. Smooth functions take three to six; the worst halve the bracket at every
/// third, and a zero may lie at the 1e-130th part of it.
const MOST: usize = 1500;
/// A bracket that has not become half as wide in so many evaluations is halved.
const PATIENCE: usize = 3;

/// A function of one unknown.
///
/// A trait that laws implement rather than a closure that they pass: a closure over lanes that is
/// called at more than one place may be compiled on its own, for the oldest processor.
pub(crate) trait Function<L> {
    /// Its value.
    fn at(&self, place: L) -> L;
}

impl<L, F: Fn(L) -> L> Function<L> for F {
    #[inline(always)]
    fn at(&self, place: L) -> L {
        self(place)
    }
}

/// The zero of a function between two places, given with their values, of which at most one is
/// positive and at most one negative.
///
/// False position with the rule of Anderson & Björck (1973), of order 1.7: the value at an end that
/// stays is scaled by `1 - f(new) / f(replaced)`, or by a half where that is not positive. The zero
/// stays enclosed, whatever the function, and a bracket that does not narrow is halved. A lane whose
/// value is not above the tolerance, or whose ends have met, is left alone while others go on: the
/// scalar form gives the same bits. The answer is the place of the smallest value that was seen.
#[inline(always)]
pub(crate) fn zero_between<L: Lane>(
    first: [L; 2],
    second: [L; 2],
    tolerance: L,
    function: &impl Function<L>,
) -> L {
    let number = |value: f64| tolerance.constant(value);
    let (zero, one, half) = (number(0.0), number(1.0), number(0.5));
    let [mut a, mut value_a] = first;
    let [mut b, mut value_b] = second;
    let a_is_less = value_a.abs().less(value_b.abs());
    let mut best = a.select(a_is_less, b);
    // The smallest value, or zero in a lane that is done.
    let mut least = value_a.abs().min(value_b.abs());
    let mut width = (b - a).abs();
    for evaluation in 1..=MOST {
        let open = tolerance.less(least);
        if !zero.any(open) {
            break;
        }
        let (left, right) = (a.min(b), a.max(b));
        let middle = half.mul_add(right - left, left);
        let rise = value_b - value_a;
        let divisor = rise.select(zero.less(rise.abs()), one);
        let guess = b - value_b * ((b - a) / divisor);
        let guess = guess.select(left.less(guess), middle);
        let guess = guess.select(guess.less(right), middle);
        let guess = if evaluation % PATIENCE == 0 {
            let now = right - left;
            let narrowed = (now + now).less(width);
            width = now;
            guess.select(narrowed, middle)
        } else {
            guess
        };
        let value = function.at(guess);

        let is_less = value.abs().less(least);
        best = guess.select(is_less, best).select(open, best);
        let seen = value.abs().min(least);
        // The ends have met where nothing is between them.
        let seen = seen.select(left.less(middle), zero);
        let seen = seen.select(middle.less(right), zero);
        least = seen.select(open, least);

        let crosses = (value * value_b).less(zero);
        let divisor = value_b.select(zero.less(value_b.abs()), one);
        let share = one - value / divisor;
        let kept = value_a * share.select(zero.less(share), half);
        a = b.select(crosses, a).select(open, a);
        value_a = value_b.select(crosses, kept).select(open, value_a);
        b = guess.select(open, b);
        value_b = value.select(open, value_b);
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Zeros of smooth, kinked and steep functions are found to rounding, in few evaluations where
    /// they are smooth.
    #[test]
    fn zeros_are_found() {
        let count = core::cell::Cell::new(0);
        let find = |low: f64, high: f64, function: &dyn Fn(f64) -> f64| {
            count.set(0);
            let counted = |x| {
                count.set(count.get() + 1);
                function(x)
            };
            zero_between([low, function(low)], [high, function(high)], 0.0, &counted)
        };
        let smooth = find(0.0, 2.0, &|x| x * x - 2.0);
        assert!((smooth - 2.0_f64.sqrt()).abs() < 1e-15);
        assert!(count.get() < 12, "{}", count.get());
        let kinked = find(0.0, 5.0, &|x: f64| {
            if x < 1.0 { 1.0 - x } else { 100.0 * (1.0 - x) }
        });
        assert!((kinked - 1.0).abs() < 1e-15, "{kinked}");
        let steep = find(0.0, 1.0, &|x: f64| (40.0 * x).exp() - 1.0e9);
        assert!(
            (steep - 9.0 * 10.0_f64.ln() / 40.0).abs() < 1e-14,
            "{steep}"
        );
        assert_eq!(find(0.0, 1.0, &|x| x), 0.0);
    }
}
