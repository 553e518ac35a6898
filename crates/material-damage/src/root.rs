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

/// The greatest share by which curvature lengthens a step of Newton's.
const BENT: f64 = 0.25;

/// A function of one unknown that knows its slope; a trait for the reason of [`Function`].
pub(crate) trait Sloping<L> {
    /// Its value and its slope.
    fn at(&self, place: L) -> [L; 2];
}

/// The zero of a function between two places, with the value at the first, which is positive, while
/// that at the second is negative, from a guess.
///
/// Newton's method within the bracket, with the curvature that the last two places tell: a step that
/// leads out of the bracket, or is not half as long as the one before, is replaced by one to the
/// middle. A lane whose value is not above the tolerance, or whose
/// ends have met, is left alone while others go on: the scalar form gives the same bits. The answer is
/// the place of the smallest value that was seen.
#[inline(always)]
pub(crate) fn zero_by_slope<L: Lane>(
    guess: L,
    [mut low, at_low]: [L; 2],
    mut high: L,
    tolerance: L,
    function: &impl Sloping<L>,
) -> L {
    let number = |value: f64| tolerance.constant(value);
    let (zero, half) = (number(0.0), number(0.5));
    let (mut place, mut best) = (guess, low);
    // The smallest value, or zero in a lane that is done.
    let mut least = at_low;
    let mut stride = high - low;
    let (mut before, mut value_before) = (low, at_low);
    for _ in 1..=MOST {
        let open = tolerance.less(least);
        if !zero.any(open) {
            break;
        }
        let [value, slope] = function.at(place);
        let size = value.abs();
        best = place.select(size.less(least), best).select(open, best);
        let is_low = zero.less(value);
        low = place.select(is_low, low);
        high = high.select(is_low, place);
        let middle = half.mul_add(high - low, low);
        let seen = size.min(least);
        // The ends have met where nothing is between them.
        let seen = seen.select(low.less(middle), zero);
        let seen = seen.select(middle.less(high), zero);
        least = seen.select(open, least);

        let inverse = number(1.0) / slope;
        let step = value * inverse;
        // Half the second derivative times the step, over the slope.
        let back = before - place;
        let curved = (value_before - slope.mul_add(back, value)) / (back * back);
        let bend = curved * step * inverse;
        let bend = bend.select(bend.abs().less(number(BENT)), zero);
        let step = step.mul_add(bend, step);
        let is_short = (step + step).abs().less(stride);
        let next = place - step;
        let next = next.select(low.less(next), middle);
        let next = next.select(next.less(high), middle);
        let next = next.select(is_short, middle);
        stride = (next - place).abs();
        (before, value_before) = (place, value);
        place = next;
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

    /// With slopes zeros of smooth functions are found in few evaluations, and those of kinked, steep
    /// and flat ones all the same.
    #[test]
    fn zeros_are_found_by_slopes() {
        struct Counted<'a>(&'a dyn Fn(f64) -> [f64; 2], core::cell::Cell<usize>);
        impl Sloping<f64> for Counted<'_> {
            fn at(&self, place: f64) -> [f64; 2] {
                self.1.set(self.1.get() + 1);
                (self.0)(place)
            }
        }
        let find = |guess: f64, high: f64, function: &dyn Fn(f64) -> [f64; 2]| {
            let counted = Counted(function, core::cell::Cell::new(0));
            let zero = zero_by_slope(guess, [0.0, function(0.0)[0]], high, 0.0, &counted);
            (zero, counted.1.get())
        };
        let (smooth, count) = find(1.2, 2.0, &|x| [2.0 - x * x, -2.0 * x]);
        assert!((smooth - 2.0_f64.sqrt()).abs() < 1e-15, "{smooth}");
        assert!(count < 8, "{count}");
        let kinked = |x: f64| {
            if x < 1.0 {
                [1.0 - x, -1.0]
            } else {
                [100.0 * (1.0 - x), -100.0]
            }
        };
        assert_eq!(find(4.9, 5.0, &kinked).0, 1.0);
        let steep = |x: f64| [1.0e9 - (40.0 * x).exp(), -40.0 * (40.0 * x).exp()];
        let exact = 9.0 * 10.0_f64.ln() / 40.0;
        assert!((find(0.0, 1.0, &steep).0 - exact).abs() < 1e-14);
        let flat = |x: f64| [1.0 / 3.0 - x, 0.0];
        assert!((find(0.0, 1.0, &flat).0 - 1.0 / 3.0).abs() < 1e-15);
        assert_eq!(find(0.5, 1.0, &|x| [-x, -1.0]).0, 0.0);
    }
}
