//! Lanes: arithmetic on one number or on a SIMD register of them.

use core::fmt::Debug;
use core::ops::{Add, Div, Mul, Neg, Sub};

/// Floating-point type in which numbers are stored: `f64` or `f32`.
pub trait Scalar: Copy + Send + Sync + PartialOrd + Debug + Default + 'static {
    /// Machine epsilon, the distance from one to the next larger number.
    const EPSILON: f64;
    /// The double rounded to this type.
    fn from_f64(value: f64) -> Self;
    /// The value as a double, without rounding.
    fn to_f64(self) -> f64;
}

impl Scalar for f64 {
    const EPSILON: f64 = f64::EPSILON;
    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        self
    }
}

impl Scalar for f32 {
    const EPSILON: f64 = f32::EPSILON as f64;
    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        value as f32
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        f64::from(self)
    }
}

/// SIMD pack of [`WIDTH`](Self::WIDTH) numbers with element-wise arithmetic, one finite element per lane.
///
/// Kernels and laws are written once, generic over the lane type. The scalar instantiations (`f64`,
/// `f32`) are the reference of the wide ones: the same operations in the same order, hence the same
/// bits. Fused multiply-add is used only where [`mul_add`](Self::mul_add) is written.
///
/// Wide lane types belong to the engine; a [`Token`](Self::Token) proves that the processor has their
/// instructions. Every value carries its token, hence constants are made from a value at hand:
/// `x.constant(0.5)`.
///
/// ```
/// use powerhouse_model::Lane;
/// fn square_root_of_sum<L: Lane>(a: L, b: L) -> L {
///     a.mul_add(a, b * b).sqrt()
/// }
/// assert_eq!(square_root_of_sum(3.0_f64, 4.0), 5.0);
/// assert_eq!(square_root_of_sum(3.0_f32, 4.0), 5.0);
/// ```
pub trait Lane:
    Copy
    + Send
    + Sync
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + 'static
{
    /// Storage type of one number.
    type Scalar: Scalar;
    /// Proof that the processor has the instructions of the lane type.
    type Token: Copy + Send + Sync + 'static;
    /// Mask: one truth value per lane.
    type Mask: Copy;
    /// Number of lanes.
    const WIDTH: usize;

    /// A constant in every lane.
    fn splat(token: Self::Token, value: f64) -> Self;
    /// Reads the first [`WIDTH`](Self::WIDTH) numbers of a slice.
    ///
    /// # Panics
    /// If the slice is shorter.
    fn load(token: Self::Token, from: &[Self::Scalar]) -> Self;
    /// Writes the lanes to the first [`WIDTH`](Self::WIDTH) numbers of a slice.
    ///
    /// # Panics
    /// If the slice is shorter.
    fn store(self, to: &mut [Self::Scalar]);
    /// The token of this value.
    fn token(self) -> Self::Token;
    /// Fused multiply-add `self * factor + summand`, rounded once.
    fn mul_add(self, factor: Self, summand: Self) -> Self;
    /// The square root, correctly rounded; NaN below zero.
    fn sqrt(self) -> Self;
    /// The absolute value.
    fn abs(self) -> Self;
    /// Mask of `self < other`, lane by lane; false where either is NaN.
    fn less(self, other: Self) -> Self::Mask;
    /// Selection by a mask: `self` where it is true, `other` elsewhere.
    fn select(self, mask: Self::Mask, other: Self) -> Self;
    /// Whether any lane of the mask is true.
    fn any(self, mask: Self::Mask) -> bool;
    /// The number in one lane.
    ///
    /// # Panics
    /// If `lane >= WIDTH`.
    fn extract(self, lane: usize) -> f64;
    /// A value whose lanes are computed one by one; the numbers are rounded to the storage type.
    fn build(token: Self::Token, value: impl FnMut(usize) -> f64) -> Self;

    /// State after the turns of a loop, at most `most` of them: one turn after the other while any lane is
    /// [open](Repeated::open). `N` is at least one.
    ///
    /// A loop whose end depends on numbers is written with this method instead of one of Rust, so that a lane type that
    /// records operations can record the loop.
    #[inline(always)]
    fn repeat<const N: usize>(
        most: usize,
        start: [Self; N],
        turns: &impl Repeated<Self, N>,
    ) -> [Self; N] {
        let mut state = start;
        for _ in 0..most {
            if !state[0].any(turns.open(&state)) {
                break;
            }
            state = turns.next(state);
        }
        state
    }
    /// A constant in every lane, with the token of this value.
    #[inline(always)]
    fn constant(self, value: f64) -> Self {
        Self::splat(self.token(), value)
    }
    /// The smaller of two numbers; `other` where either is NaN.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.select(self.less(other), other)
    }
    /// The larger of two numbers; `other` where either is NaN.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.select(other.less(self), other)
    }
    /// The nearest integer, ties to even, of values of magnitude below `1 / (2 EPSILON)`.
    #[inline(always)]
    fn round(self) -> Self {
        let shift = self.constant(1.5 / Self::Scalar::EPSILON);
        (self + shift) - shift
    }
    /// Power of two `2^x` of integers `x` for which it is a normal number; meaningless for others.
    #[inline(always)]
    fn power_of_two(self) -> Self {
        Self::build(self.token(), |lane| 2.0_f64.powi(self.extract(lane) as i32))
    }
}

/// Turns of a loop whose end depends on lanes, for [`Lane::repeat`].
///
/// Lanes that are done go through the further turns of the others: numbers that are used after the loop must keep their
/// bits in them, and they must stay done.
///
/// The square root by Newton's method, to a relative error of 1e-12 of the square:
/// ```
/// use powerhouse_model::{Lane, Repeated};
///
/// struct Root<L>(L);
///
/// impl<L: Lane> Repeated<L, 1> for Root<L> {
///     fn open(&self, [root]: &[L; 1]) -> L::Mask {
///         (self.0 * root.constant(1e-12)).less((*root * *root - self.0).abs())
///     }
///     fn next(&self, [root]: [L; 1]) -> [L; 1] {
///         let better = (root + self.0 / root) * root.constant(0.5);
///         [better.select(self.open(&[root]), root)]
///     }
/// }
///
/// let [root] = f64::repeat(50, [1.0], &Root(2.0));
/// assert!((root - 2.0_f64.sqrt()).abs() < 1e-12);
/// ```
pub trait Repeated<L: Lane, const N: usize> {
    /// Lanes that need a further turn.
    fn open(&self, state: &[L; N]) -> L::Mask;
    /// State after one more turn.
    fn next(&self, state: [L; N]) -> [L; N];
}

/// Array of `f` of each value of an array.
///
/// Laws and kernels use this instead of `array::map`, which the compiler may leave as a separate function
/// without the instructions of the lane type.
#[inline(always)]
pub fn each<L: Lane, const N: usize>(values: &[L; N], f: impl Fn(L) -> L) -> [L; N] {
    let mut out = *values;
    for value in &mut out {
        *value = f(*value);
    }
    out
}

/// Array of `f` of each index; for laws and kernels, as [`each`], instead of `array::from_fn`.
#[inline(always)]
pub fn array<L: Lane, const N: usize>(f: impl Fn(usize) -> L) -> [L; N] {
    let mut out = [f(0); N];
    for (index, value) in out.iter_mut().enumerate().skip(1) {
        *value = f(index);
    }
    out
}

macro_rules! scalar_lane {
    ($float:ident) => {
        impl Lane for $float {
            type Scalar = $float;
            type Token = ();
            type Mask = bool;
            const WIDTH: usize = 1;

            #[inline(always)]
            fn splat(_token: (), value: f64) -> Self {
                value as $float
            }
            #[inline(always)]
            fn load(_token: (), from: &[$float]) -> Self {
                from[0]
            }
            #[inline(always)]
            fn store(self, to: &mut [$float]) {
                to[0] = self;
            }
            #[inline(always)]
            fn token(self) {}
            #[inline(always)]
            fn mul_add(self, factor: Self, summand: Self) -> Self {
                <$float>::mul_add(self, factor, summand)
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                <$float>::sqrt(self)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                <$float>::abs(self)
            }
            #[inline(always)]
            fn less(self, other: Self) -> bool {
                self < other
            }
            #[inline(always)]
            fn select(self, mask: bool, other: Self) -> Self {
                if mask { self } else { other }
            }
            #[inline(always)]
            fn any(self, mask: bool) -> bool {
                mask
            }
            #[inline(always)]
            fn extract(self, lane: usize) -> f64 {
                assert!(lane == 0, "a scalar has one lane");
                f64::from(self)
            }
            #[inline(always)]
            fn build(_token: (), mut value: impl FnMut(usize) -> f64) -> Self {
                value(0) as $float
            }
            #[inline(always)]
            fn power_of_two(self) -> Self {
                // A shifted number has its whole part in the last bits.
                let bits = (self + 1.5 / $float::EPSILON).to_bits();
                let digits = $float::MANTISSA_DIGITS - 1;
                let one = (1.0 as $float).to_bits();
                $float::from_bits((bits << digits).wrapping_add(one))
            }
        }
    };
}

scalar_lane!(f64);
scalar_lane!(f32);

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers are rounded to the nearest whole one, and powers of two are exact over the range of
    /// normal numbers, in both precisions.
    #[test]
    fn whole_numbers_and_powers_of_two_are_exact() {
        for exponent in -1022..=1023_i32 {
            let (x, power) = (f64::from(exponent), 2.0_f64.powi(exponent));
            assert_eq!(Lane::power_of_two(x), power, "{exponent}");
            for part in [-0.49, 0.0, 0.49] {
                assert_eq!(Lane::round(x + part), x, "{exponent} {part}");
            }
            if (-126..=127).contains(&exponent) {
                assert_eq!(Lane::power_of_two(x as f32), power as f32, "{exponent}");
                assert_eq!(Lane::round(x as f32 + 0.4), x as f32, "{exponent}");
            }
        }
        assert_eq!([2.5, 3.5, -0.5].map(Lane::round), [2.0, 4.0, 0.0]);
    }
}
