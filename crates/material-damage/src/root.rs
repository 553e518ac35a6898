//! Zeros of functions of one unknown, on lanes.

use powerhouse_model::{Lane, Repeated};

/// Greatest number of evaluations. Smooth functions take three to six; the worst halve the bracket at
/// every third, and a zero may be at the 1e-130th part of it.
const MOST: usize = 1500;
/// Number of evaluations after which a bracket that has not become half as wide is halved.
const HALVING_INTERVAL: f64 = 3.0;

/// Function of one unknown.
///
/// A trait that laws implement rather than a closure that they pass: a closure over lanes with
/// several call sites may be compiled on its own, for the oldest processor.
pub(crate) trait Function<L> {
    /// Value at an argument.
    fn at(&self, argument: L) -> L;
}

impl<L, F: Fn(L) -> L> Function<L> for F {
    #[inline(always)]
    fn at(&self, argument: L) -> L {
        self(argument)
    }
}

/// Zero of a function between two arguments, given with their values, of which at most one is
/// positive and at most one negative.
///
/// False position with the rule of Anderson & Björck (1973), of order 1.7: the value at an end that
/// stays is scaled by `1 - f(new) / f(replaced)`, or by a half where that is not positive. The zero
/// stays enclosed, whatever the function, and a bracket that does not narrow is halved. A lane whose
/// value is not above the tolerance, or whose bracket has closed, is left unchanged while others go on:
/// the scalar form gives the same bits. Returns the argument with the smallest value found.
#[inline(always)]
pub(crate) fn zero_between<L: Lane>(
    first: [L; 2],
    second: [L; 2],
    tolerance: L,
    function: &impl Function<L>,
) -> L {
    let number = |value: f64| tolerance.constant(value);
    let [a, value_a] = first;
    let [b, value_b] = second;
    let a_is_less = value_a.abs().less(value_b.abs());
    let state = [
        a,
        value_a,
        b,
        value_b,
        a.select(a_is_less, b),
        value_a.abs().min(value_b.abs()),
        (b - a).abs(),
        number(1.0),
    ];
    let search = FalsePosition {
        tolerance,
        function,
    };
    let [_, _, _, _, best, ..] = L::repeat(MOST, state, &search);
    best
}

/// Turns of [`zero_between`]: the ends of the bracket with their values, the best argument, its value or zero in a
/// lane that is done, the width after the last halving, and the number of the evaluation in the interval of halvings.
struct FalsePosition<'a, L, F> {
    tolerance: L,
    function: &'a F,
}

impl<L: Lane, F: Function<L>> Repeated<L, 8> for FalsePosition<'_, L, F> {
    #[inline(always)]
    fn open(&self, &[.., least, _, _]: &[L; 8]) -> L::Mask {
        self.tolerance.less(least)
    }
    #[inline(always)]
    fn next(&self, state: [L; 8]) -> [L; 8] {
        let [a, value_a, b, value_b, best, least, width, evaluation] = state;
        let number = |value: f64| a.constant(value);
        let (zero, one, half) = (number(0.0), number(1.0), number(0.5));
        let open = self.open(&state);
        let (left, right) = (a.min(b), a.max(b));
        let middle = half.mul_add(right - left, left);
        let rise = value_b - value_a;
        let divisor = rise.select(zero.less(rise.abs()), one);
        let guess = b - value_b * ((b - a) / divisor);
        let guess = guess.select(left.less(guess), middle);
        let guess = guess.select(guess.less(right), middle);
        let is_halving = number(HALVING_INTERVAL - 0.5).less(evaluation);
        let now = right - left;
        let narrowed = (now + now).less(width);
        let width = now.select(is_halving, width);
        let guess = guess.select(narrowed, middle).select(is_halving, guess);
        let evaluation = one.select(is_halving, evaluation + one);
        let value = self.function.at(guess);

        let is_less = value.abs().less(least);
        let best = guess.select(is_less, best).select(open, best);
        let seen = value.abs().min(least);
        // The bracket has closed if no number is between its ends.
        let seen = seen.select(left.less(middle), zero);
        let seen = seen.select(middle.less(right), zero);
        let least = seen.select(open, least);

        let crosses = (value * value_b).less(zero);
        let divisor = value_b.select(zero.less(value_b.abs()), one);
        let share = one - value / divisor;
        let kept = value_a * share.select(zero.less(share), half);
        [
            b.select(crosses, a).select(open, a),
            value_b.select(crosses, kept).select(open, value_a),
            guess.select(open, b),
            value.select(open, value_b),
            best,
            least,
            width,
            evaluation,
        ]
    }
}

/// Greatest relative change of a Newton step by curvature.
const MOST_CURVATURE: f64 = 0.25;

/// Function of one unknown with its derivative; a trait for the reason of [`Function`].
pub(crate) trait Differentiable<L> {
    /// Value and derivative at an argument.
    fn at(&self, argument: L) -> [L; 2];
}

/// Zero of a function between two arguments, from a guess; the value at the first is given and
/// positive, that at the second is negative.
///
/// Newton's method within the bracket, with the curvature from the last two arguments: a step that
/// leaves the bracket, or is more than half as long as the one before, is replaced by one to the
/// middle. A lane whose value is not above the tolerance, or whose bracket has closed, is left unchanged
/// while others go on: the scalar form gives the same bits. Returns the argument with the smallest
/// value found.
#[inline(always)]
pub(crate) fn zero_by_slope<L: Lane>(
    guess: L,
    [low, at_low]: [L; 2],
    high: L,
    tolerance: L,
    function: &impl Differentiable<L>,
) -> L {
    let search = Newton {
        tolerance,
        function,
    };
    let state = [guess, low, low, high, at_low, high - low, low, at_low];
    let [_, best, ..] = L::repeat(MOST, state, &search);
    best
}

/// Turns of [`zero_by_slope`]: the argument, the best one, the ends of the bracket, the smallest value or zero in a
/// lane that is done, the length of the last step, and the argument and the value before.
struct Newton<'a, L, F> {
    tolerance: L,
    function: &'a F,
}

impl<L: Lane, F: Differentiable<L>> Repeated<L, 8> for Newton<'_, L, F> {
    #[inline(always)]
    fn open(&self, &[_, _, _, _, least, ..]: &[L; 8]) -> L::Mask {
        self.tolerance.less(least)
    }
    #[inline(always)]
    fn next(&self, state: [L; 8]) -> [L; 8] {
        let [
            argument,
            best,
            low,
            high,
            least,
            stride,
            before,
            value_before,
        ] = state;
        let number = |value: f64| argument.constant(value);
        let (zero, half) = (number(0.0), number(0.5));
        let open = self.open(&state);
        let [value, slope] = self.function.at(argument);
        let size = value.abs();
        let best = argument.select(size.less(least), best).select(open, best);
        let is_low = zero.less(value);
        let low = argument.select(is_low, low);
        let high = high.select(is_low, argument);
        let middle = half.mul_add(high - low, low);
        let seen = size.min(least);
        // The bracket has closed if no number is between its ends.
        let seen = seen.select(low.less(middle), zero);
        let seen = seen.select(middle.less(high), zero);
        let least = seen.select(open, least);

        let inverse = number(1.0) / slope;
        let step = value * inverse;
        // Half the second derivative times the step, over the slope.
        let back = before - argument;
        let curved = (value_before - slope.mul_add(back, value)) / (back * back);
        let bend = curved * step * inverse;
        let bend = bend.select(bend.abs().less(number(MOST_CURVATURE)), zero);
        let step = step.mul_add(bend, step);
        let is_short = (step + step).abs().less(stride);
        let next = argument - step;
        let next = next.select(low.less(next), middle);
        let next = next.select(next.less(high), middle);
        let next = next.select(is_short, middle);
        let stride = (next - argument).abs();
        [next, best, low, high, least, stride, argument, value]
    }
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

    /// With derivatives zeros of smooth functions are found in few evaluations, and those of kinked, steep
    /// and flat ones too.
    #[test]
    fn zeros_are_found_by_slopes() {
        struct Counted<'a>(&'a dyn Fn(f64) -> [f64; 2], core::cell::Cell<usize>);
        impl Differentiable<f64> for Counted<'_> {
            fn at(&self, argument: f64) -> [f64; 2] {
                self.1.set(self.1.get() + 1);
                (self.0)(argument)
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
