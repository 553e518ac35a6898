//! Exact sums against integers of any length.

use num_bigint::BigInt;
use powerhouse_explicit_core::ExactSum;
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::Index;

/// A finite number in units of the least subnormal one, `2^-1074`.
fn units(number: f64) -> BigInt {
    let bits = number.abs().to_bits();
    let (exponent, fraction) = (bits >> 52, bits & ((1 << 52) - 1));
    let size = match exponent {
        0 => BigInt::from(fraction),
        _ => BigInt::from(fraction | (1 << 52)) << (exponent - 1),
    };
    if number < 0.0 { -size } else { size }
}

/// The exact sum in units of the least subnormal number.
fn exact(terms: &[f64]) -> BigInt {
    terms.iter().map(|&term| units(term)).sum()
}

/// Whether a number is the one nearest to an exact value, with an even mantissa if two are equally near. Infinity counts
/// as the number after the largest finite one.
fn is_nearest(found: f64, exact: &BigInt) -> bool {
    let beyond = || -> BigInt { BigInt::from(1) << (1024 + 1074) };
    let place = |number: f64| match number {
        f64::INFINITY => beyond(),
        f64::NEG_INFINITY => -beyond(),
        finite => units(finite),
    };
    let distance = |number: f64| (place(number) - exact).magnitude().clone();
    let neighbours = [found.next_down(), found.next_up()];
    let is_even = found.to_bits().is_multiple_of(2);
    !found.is_nan()
        && neighbours.iter().all(|&other| {
            let (own, others) = (distance(found), distance(other));
            // Infinity has no neighbour on its far side.
            found == other || own < others || (own == others && is_even)
        })
}

fn sum(terms: &[f64]) -> ExactSum {
    terms.iter().copied().collect()
}

/// Numbers from 1e-300 to 1e300 in size, with either sign.
fn wide() -> impl Strategy<Value = f64> {
    let parts = (any::<bool>(), 1.0..10.0_f64, -300..300_i32);
    parts.prop_map(|(negative, mantissa, exponent)| {
        let size = mantissa * 10.0_f64.powi(exponent);
        if negative { -size } else { size }
    })
}

/// Wide terms, of which some are cancelled by others up to the last bits.
fn cancelling() -> impl Strategy<Value = Vec<f64>> {
    let cancelled = vec((any::<Index>(), 0..3_u8), 0..60);
    (vec(wide(), 1..60), cancelled).prop_map(|(mut terms, cancelled)| {
        let own = terms.len();
        for (index, by) in cancelled {
            let term = terms[index.index(own)];
            terms.push(match by {
                0 => -term,
                1 => -term.next_up(),
                _ => -term.next_down(),
            });
        }
        terms
    })
}

/// All finite bit patterns, subnormal numbers and the largest ones among them.
fn any_finite() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<u64>().prop_map(f64::from_bits),
        (0..1_u64 << 54, any::<bool>())
            .prop_map(|(bits, negative)| f64::from_bits(bits | u64::from(negative) << 63)),
        (0..1_u64 << 54, any::<bool>()).prop_map(|(bits, negative)| {
            let size = f64::from_bits(f64::MAX.to_bits() - bits);
            if negative { -size } else { size }
        }),
    ]
    .prop_filter("finite", |number| number.is_finite())
}

proptest! {
    /// Sums of terms over six hundred orders of magnitude that cancel are rounded correctly and have the same bits in any
    /// order, and from partial sums merged in any order.
    #[test]
    fn any_order_and_division_gives_the_nearest_number(
        (terms, shuffled) in cancelling().prop_flat_map(|terms| {
            (Just(terms.clone()), Just(terms).prop_shuffle())
        }),
        cuts in [any::<Index>(), any::<Index>()],
    ) {
        let found = sum(&terms).round();
        prop_assert!(is_nearest(found, &exact(&terms)), "{found:e}");

        let mut sorted = terms.clone();
        sorted.sort_by(f64::total_cmp);
        let reversed: Vec<f64> = terms.iter().rev().copied().collect();
        for other in [&sorted, &reversed, &shuffled] {
            prop_assert_eq!(sum(other).round().to_bits(), found.to_bits());
        }

        let mut cuts = cuts.map(|cut| cut.index(terms.len()));
        cuts.sort_unstable();
        let parts = [&terms[..cuts[0]], &terms[cuts[0]..cuts[1]], &terms[cuts[1]..]].map(sum);
        for order in [[0, 1, 2], [2, 0, 1], [1, 2, 0]] {
            let mut merged = ExactSum::new();
            for part in order {
                merged.merge(&parts[part]);
            }
            prop_assert_eq!(merged.round().to_bits(), found.to_bits());
        }
        let all = parts.map(|part| part.digits());
        let digits = core::array::from_fn(|k| all[0][k] + all[1][k] + all[2][k]);
        prop_assert_eq!(ExactSum::from_digits(&digits).round().to_bits(), found.to_bits());
    }

    /// Sums of arbitrary finite numbers, subnormal and close to overflow, are rounded correctly; they are infinite where
    /// the exact sum is.
    #[test]
    fn every_finite_number_counts(terms in vec(any_finite(), 0..40)) {
        let found = sum(&terms).round();
        prop_assert!(is_nearest(found, &exact(&terms)), "{found:e}");
    }

    /// Subnormal numbers add up without any rounding.
    #[test]
    fn subnormal_numbers_are_exact(terms in vec((0..1_u64 << 52, any::<bool>()), 1..40)) {
        let whole: i128 = terms.iter().map(|&(bits, negative)| {
            if negative { -i128::from(bits) } else { i128::from(bits) }
        }).sum();
        let terms = terms.iter().map(|&(bits, negative)| {
            f64::from_bits(bits | u64::from(negative) << 63)
        });
        let found: ExactSum = terms.collect();
        prop_assert!(is_nearest(found.round(), &BigInt::from(whole)));
    }
}

/// Sums half-way between two numbers are rounded to the even one, whatever lies far below breaks the tie, and a sum is
/// infinite only if the exact sum rounds to more than the largest number.
#[test]
fn ties_and_overflow() {
    let tiny = f64::from_bits(1);
    let half = 0.5 * f64::EPSILON;
    let last = 2.0_f64.powi(970);
    let cases: [(&[f64], f64); 12] = [
        (&[], 0.0),
        (&[-0.0], 0.0),
        (&[1.0, half], 1.0),
        (&[1.0, half, tiny], 1.0 + f64::EPSILON),
        (&[1.0 + f64::EPSILON, half], 1.0 + 2.0 * f64::EPSILON),
        (&[1.0 + f64::EPSILON, half, -tiny], 1.0 + f64::EPSILON),
        (&[-1.0, -half, -tiny], -1.0 - f64::EPSILON),
        (&[f64::MAX, f64::MAX, -f64::MAX], f64::MAX),
        (&[f64::MAX, last, -tiny], f64::MAX),
        (&[f64::MAX, last], f64::INFINITY),
        (&[-f64::MAX, -last], f64::NEG_INFINITY),
        (&[f64::MAX, f64::MAX], f64::INFINITY),
    ];
    for (terms, expected) in cases {
        let found = sum(terms).round();
        assert_eq!(found.to_bits(), expected.to_bits(), "{terms:?}: {found:e}");
    }
}

/// Many terms of one size overflow no digit, whatever the place of their bits in the digits; many of the largest size
/// less all but one of them are the one.
#[test]
fn many_large_terms() {
    for exponent in 0..32 {
        let term = -2.0_f64.powi(exponent).next_down();
        let found: ExactSum = core::iter::repeat_n(term, 1 << 14).collect();
        assert_eq!(found.round(), term * f64::from(1 << 14), "{exponent}");
    }
    let count = 100_000;
    let (mut up, mut down) = (ExactSum::new(), ExactSum::new());
    for term in 0..count {
        up.add(f64::MAX);
        down.add(if term > 0 { -f64::MAX } else { 0.0 });
    }
    let mut all = up.clone();
    all.merge(&down);
    assert_eq!(all.round(), f64::MAX);
    let (up, down) = (up.digits(), down.digits());
    let digits = core::array::from_fn(|k| 1000 * (up[k] + down[k]));
    assert_eq!(ExactSum::from_digits(&digits).round(), f64::INFINITY);
    let small = sum(&[-3.0, 2.0_f64.powi(-40)]).digits();
    let digits = small.map(|digit| 1024 * digit);
    let expected = 1024.0 * (2.0_f64.powi(-40) - 3.0);
    assert_eq!(ExactSum::from_digits(&digits).round(), expected);
}

/// Terms that are not finite give what they give in any sum, in partial sums and as digits too.
#[test]
fn terms_that_are_not_finite() {
    let (up, down) = (f64::INFINITY, f64::NEG_INFINITY);
    let cases: [(&[f64], f64); 8] = [
        (&[down, down], down),
        (&[f64::NAN, f64::NAN], f64::NAN),
        (&[1.0, up], up),
        (&[down, f64::MAX], down),
        (&[up, up], up),
        (&[up, down], f64::NAN),
        (&[1.0, f64::NAN], f64::NAN),
        (&[f64::NAN, up], f64::NAN),
    ];
    for (terms, expected) in cases {
        let parts = terms.iter().map(|&term| sum(&[term]));
        let mut merged = ExactSum::new();
        let mut digits = [0; ExactSum::LENGTH];
        for part in parts {
            merged.merge(&part);
            for (digit, add) in digits.iter_mut().zip(part.digits()) {
                *digit += add;
            }
        }
        for found in [sum(terms), merged, ExactSum::from_digits(&digits)] {
            let found = found.round();
            let same = found == expected || (found.is_nan() && expected.is_nan());
            assert!(same, "{terms:?}: {found}");
        }
    }
}
