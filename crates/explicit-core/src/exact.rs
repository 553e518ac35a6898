//! Exact sums of floating-point numbers.

/// Number of digits of the value.
const DIGITS: usize = 67;
/// Bits of a digit.
const WIDTH: usize = 32;
const MASK: i64 = (1 << WIDTH) - 1;
/// Exponent of the value of the lowest bit of the first digit: that of the least subnormal number, negated.
const FRACTION_BITS: u32 = f64::MANTISSA_DIGITS - 1;
/// Field of the exponent of infinities and NaN.
const SPECIAL: usize = 0x7ff;
/// Largest number of terms between two passes of carries: a term adds less than `2^52 + 2^32` to a digit.
const MOST_PENDING: u32 = 2000;

/// An exact sum of double-precision numbers, rounded once at the end: the same bits for any order of the terms and any
/// division into partial sums.
///
/// The sum is a fixed-point number `sum d_k 2^(32 k - 1074)` with 67 integer digits `d_k`, which covers `2^60` terms of
/// any finite size. A term costs about 3 ns, rounding and merging 0.1 us each.
///
/// Sources: Kulisch & Miranker (1986), *SIAM Review* 28(1) (fixed-point accumulator); Neal (2015), *Fast exact summation
/// using small and large superaccumulators*, arXiv:1505.05571 (overlapping digits of 64 bits, deferred carries).
///
/// # Examples
/// ```
/// use powerhouse_explicit_core::ExactSum;
///
/// let terms = [1.0e300, 1.0, -1.0e300, 2.0_f64.powi(-60)];
/// let sum: ExactSum = terms.into_iter().collect();
/// assert_eq!(sum.round(), 1.0);
/// // Two processes add the digits of their partial sums as integers.
/// let partial = |terms: &[f64]| terms.iter().copied().collect::<ExactSum>().digits();
/// let (first, second) = (partial(&terms[..1]), partial(&terms[1..]));
/// let digits = std::array::from_fn(|k| first[k] + second[k]);
/// assert_eq!(ExactSum::from_digits(&digits).round(), 1.0);
/// ```
#[derive(Clone, Debug)]
pub struct ExactSum {
    digits: [i64; DIGITS],
    /// Number of terms since the last pass of carries.
    pending: u32,
    /// Terms that are not finite.
    special: Special,
}

/// Occurrence of terms that are not finite.
#[derive(Clone, Copy, Debug, Default)]
struct Special {
    nan: bool,
    /// Positive infinity.
    positive: bool,
    /// Negative infinity.
    negative: bool,
}

impl Default for ExactSum {
    fn default() -> Self {
        Self::new()
    }
}

impl ExactSum {
    /// Length of the integer representation: the digits of the value, then the numbers of partial sums with a NaN, with
    /// positive and with negative infinity.
    pub const LENGTH: usize = DIGITS + 3;

    /// The sum of no terms, zero.
    pub const fn new() -> Self {
        Self {
            digits: [0; DIGITS],
            pending: 0,
            special: Special {
                nan: false,
                positive: false,
                negative: false,
            },
        }
    }

    /// Adds a term. NaN and infinities are taken as in any other sum: infinities of both signs give NaN.
    #[inline]
    pub fn add(&mut self, term: f64) {
        let bits = term.to_bits();
        let exponent = (bits >> FRACTION_BITS) as usize & SPECIAL;
        if exponent == SPECIAL {
            self.special.nan |= term.is_nan();
            self.special.positive |= term == f64::INFINITY;
            self.special.negative |= term == f64::NEG_INFINITY;
            return;
        }
        let fraction = bits & ((1 << FRACTION_BITS) - 1);
        let leading = u64::from(exponent != 0) << FRACTION_BITS;
        let mantissa = fraction | leading;
        let position = exponent.saturating_sub(1);
        let (digit, shift) = (position / WIDTH, position % WIDTH);
        let low = (mantissa << shift) as i64 & MASK;
        let high = (mantissa >> (WIDTH - shift)) as i64;
        // Minus one for a negative term: `(x ^ sign) - sign` is then `-x`.
        let sign = bits as i64 >> 63;
        self.digits[digit] += (low ^ sign) - sign;
        self.digits[digit + 1] += (high ^ sign) - sign;
        self.pending += 1;
        if self.pending == MOST_PENDING {
            self.carry();
        }
    }

    /// Adds all terms of another sum.
    pub fn merge(&mut self, other: &Self) {
        self.carry();
        for (digit, add) in self.digits.iter_mut().zip(other.digits) {
            *digit += add;
        }
        self.carry();
        self.special.nan |= other.special.nan;
        self.special.positive |= other.special.positive;
        self.special.negative |= other.special.negative;
    }

    /// The sum, rounded to the nearest number, to the one with an even mantissa if two are equally near; infinite only if
    /// the exact sum is beyond the largest finite number, or a term was infinite. A sum of zero has a positive sign.
    pub fn round(&self) -> f64 {
        let Special {
            nan,
            positive,
            negative,
        } = self.special;
        if nan || (positive && negative) {
            return f64::NAN;
        }
        if positive || negative {
            return if positive {
                f64::INFINITY
            } else {
                f64::NEG_INFINITY
            };
        }
        let mut size = self.clone();
        size.carry();
        let is_negative = size.digits[DIGITS - 1] < 0;
        if is_negative {
            for digit in &mut size.digits {
                *digit = -*digit;
            }
            size.carry();
        }
        let magnitude = size.rounded_magnitude();
        if is_negative { -magnitude } else { magnitude }
    }

    /// Rounds a sum that is not negative and has no pending carries.
    fn rounded_magnitude(&self) -> f64 {
        const MANTISSA: u32 = f64::MANTISSA_DIGITS;
        let Some(top) = self.digits.iter().rposition(|&digit| digit != 0) else {
            return 0.0;
        };
        // The three highest digits hold the mantissa and at least twelve further bits, unless they are all digits.
        let first = top.saturating_sub(2);
        let highest = (self.digits[first..=top].iter().rev())
            .fold(0, |window: u128, &digit| (window << WIDTH) + digit as u128);
        let length = u128::BITS - highest.leading_zeros();
        let dropped = length.saturating_sub(MANTISSA);
        let mut mantissa = (highest >> dropped) as u64;
        if dropped > 0 {
            let rest = highest & ((1 << dropped) - 1);
            let half = 1 << (dropped - 1);
            let is_exact = self.digits[..first].iter().all(|&digit| digit == 0);
            let is_odd = mantissa % 2 == 1;
            mantissa += u64::from(rest > half || (rest == half && (!is_exact || is_odd)));
        }
        // The leading bit of the mantissa adds one to the exponent, as does a mantissa rounded up to a power of two.
        let exponent = (WIDTH * first) as u64 + u64::from(dropped);
        let bits = (exponent << FRACTION_BITS) + mantissa;
        f64::from_bits(bits.min(f64::INFINITY.to_bits()))
    }

    /// The sum as integers: the sum over partial sums of each integer, by `from_digits`, is the sum of all terms, for up
    /// to `2^30` partial sums.
    pub fn digits(&self) -> [i64; Self::LENGTH] {
        let mut sum = self.clone();
        sum.carry();
        let mut all = [0; Self::LENGTH];
        all[..DIGITS].copy_from_slice(&sum.digits);
        let special = self.special;
        let flags = [special.nan, special.positive, special.negative];
        all[DIGITS..].copy_from_slice(&flags.map(i64::from));
        all
    }

    /// The sum with these [digits](Self::digits), which may be sums of those of several partial sums.
    pub fn from_digits(digits: &[i64; Self::LENGTH]) -> Self {
        let mut sum = Self::new();
        sum.digits.copy_from_slice(&digits[..DIGITS]);
        sum.carry();
        sum.special = Special {
            nan: digits[DIGITS] != 0,
            positive: digits[DIGITS + 1] != 0,
            negative: digits[DIGITS + 2] != 0,
        };
        sum
    }

    /// Carries the excess of each digit to the next one: all but the last are then from zero to `2^32 - 1`, and the last
    /// has the sign of the sum.
    fn carry(&mut self) {
        let mut carry = 0;
        let (last, lower) = (DIGITS - 1, 0..DIGITS - 1);
        for digit in &mut self.digits[lower] {
            let whole = *digit + carry;
            *digit = whole & MASK;
            carry = whole >> WIDTH;
        }
        self.digits[last] += carry;
        self.pending = 0;
    }
}

impl Extend<f64> for ExactSum {
    fn extend<I: IntoIterator<Item = f64>>(&mut self, terms: I) {
        terms.into_iter().for_each(|term| self.add(term));
    }
}

impl FromIterator<f64> for ExactSum {
    fn from_iter<I: IntoIterator<Item = f64>>(terms: I) -> Self {
        let mut sum = Self::new();
        sum.extend(terms);
        sum
    }
}
