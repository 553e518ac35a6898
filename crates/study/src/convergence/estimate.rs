//! Estimate of the discretisation error of a result on two or three meshes.

use serde::{Deserialize, Serialize};

/// Number of bisections for the observed order: its interval shrinks to rounding.
const BISECTIONS: u32 = 60;
/// Range in which the observed order is sought.
const SOUGHT: [f64; 2] = [0.05, 12.0];
/// Least observed order of a converging result. Slower differences give no limit that could be trusted.
const LEAST_ORDER: f64 = 0.5;
/// Largest relative deviation of the observed order from the formal one with the small factor of safety.
const NEAR_FORMAL: f64 = 0.1;
/// Factors of safety on the estimated error: observed order near the formal one, and otherwise.
const FACTORS_OF_SAFETY: [f64; 2] = [1.25, 3.0];
/// Factor on the change between two runs whose waves differ by 1e-6: two samples of a distribution differ by about
/// 1.1 standard deviations on average, and the band has two.
const OF_SCATTER: f64 = 2.0;

/// How a result changes from mesh to mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Trend {
    /// The same value on all meshes.
    Constant,
    /// Differences of three meshes fall, with the observed order.
    Converging,
    /// Two meshes only: the formal order is assumed.
    Assumed,
    /// Differences of three meshes alternate in sign.
    Oscillating,
    /// The finest difference is within the scatter of runs under waves that differ by 1e-6, or within what sampling changes.
    Scattered,
    /// The value falls so much from mesh to mesh that its limit would have the other sign, such as a peak below zero.
    TooCoarse,
    /// Differences grow, or fall more slowly than with order 0.5.
    Diverging,
}

impl Trend {
    /// Description in messages and tables.
    #[must_use]
    pub fn text(self) -> &'static str {
        match self {
            Self::Constant => "constant",
            Self::Converging => "converging",
            Self::Assumed => "order assumed",
            Self::Oscillating => "oscillating",
            Self::Scattered => "scattered",
            Self::TooCoarse => "too coarse",
            Self::Diverging => "not converging",
        }
    }
}

/// Estimate of a result for vanishing element size.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// How the result changes from mesh to mesh.
    pub trend: Trend,
    /// Observed order of convergence; `None` unless three meshes converge or diverge.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub order: Option<f64>,
    /// Extrapolated value, in the unit of the result; `None` unless an order is observed or assumed.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub extrapolated: Option<f64>,
    /// Half width of the error band around the value of the finest mesh, in the unit of the result; `None` for a result that
    /// does not converge.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub band: Option<f64>,
}

/// Estimates a result from its values on two or more meshes, the coarsest first, with as many element sizes (m, falling), the
/// scatter of the values under waves that differ by 1e-6 or by their sampling, and the formal order of convergence. Of more meshes the
/// three finest count.
///
/// Of three meshes the order p follows from `f_i = f + C h_i^p`. The band around the finest value is a factor of safety times
/// the difference from the extrapolated value: 1.25 where p is within 10 % of the formal order, otherwise 3 with p limited
/// to the range from 0.5 to the formal order (Oberkampf and Roy 2010, Verification and Validation in Scientific Computing,
/// section 8.7). Two meshes have the factor 3 with the formal order. An oscillating result has three times its largest
/// difference between meshes as band. No band is narrower than twice the scatter.
pub(super) fn estimate(values: &[f64], sizes: &[f64], scatter: f64, formal: f64) -> Estimate {
    let least = OF_SCATTER * scatter;
    let first = values.len().saturating_sub(3);
    let (values, sizes) = (&values[first..], &sizes[first..]);
    let Some((&finest, coarser)) = values.split_last() else {
        return Estimate {
            trend: Trend::Diverging,
            order: None,
            extrapolated: None,
            band: None,
        };
    };
    let spread = (coarser.iter()).fold(0.0_f64, |most, value| most.max((value - finest).abs()));
    let without_order = |trend, band: f64| Estimate {
        trend,
        order: None,
        extrapolated: None,
        band: Some(band.max(least)),
    };
    if spread == 0.0 {
        return without_order(Trend::Constant, 0.0);
    }
    let Some(&middle) = coarser.last() else {
        return without_order(Trend::Constant, 0.0);
    };
    let fine = middle - finest;
    if fine.abs() <= least {
        return without_order(Trend::Scattered, spread);
    }
    let ratio = sizes[sizes.len() - 2] / sizes[sizes.len() - 1];
    let extrapolated = |order: f64| finest - fine / (ratio.powf(order) - 1.0);
    let changes_sign = |order: f64| {
        let limit = extrapolated(order);
        values.iter().all(|value| value * limit < 0.0)
    };
    let band = |safety: f64, order: f64| {
        Some((safety * fine.abs() / (ratio.powf(order) - 1.0)).max(least))
    };
    let [near, safe] = FACTORS_OF_SAFETY;
    let [coarsest, _] = *coarser else {
        if changes_sign(formal) {
            return without_order(Trend::TooCoarse, safe * spread);
        }
        return Estimate {
            trend: Trend::Assumed,
            order: None,
            extrapolated: Some(extrapolated(formal)),
            band: band(safe, formal),
        };
    };
    let coarse = coarsest - middle;
    if coarse * fine < 0.0 || coarse == 0.0 {
        return without_order(Trend::Oscillating, safe * spread);
    }
    let order = observed_order(coarse / fine, [sizes[0], sizes[1], sizes[2]]);
    if order < LEAST_ORDER {
        return Estimate {
            trend: Trend::Diverging,
            order: Some(order),
            extrapolated: None,
            band: None,
        };
    }
    let limited = order.clamp(LEAST_ORDER, formal);
    if changes_sign(limited) {
        return without_order(Trend::TooCoarse, safe * spread);
    }
    let (safety, used) = if (order - formal).abs() <= NEAR_FORMAL * formal {
        (near, formal)
    } else {
        (safe, limited)
    };
    Estimate {
        trend: Trend::Converging,
        order: Some(order),
        extrapolated: Some(extrapolated(limited)),
        band: band(safety, used),
    }
}

/// The order p for which the ratio of the coarse to the fine difference of `C h^p` is as given, within the sought range;
/// differences that grow have an order below its lower end, which is returned.
fn observed_order(ratio: f64, [coarsest, middle, finest]: [f64; 3]) -> f64 {
    let of_order = |order: f64| {
        let [a, b] = [coarsest / finest, middle / finest].map(|h: f64| h.powf(order));
        (a - b) / (b - 1.0)
    };
    let [mut low, mut high] = SOUGHT;
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        if of_order(middle) < ratio {
            low = middle
        } else {
            high = middle
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZES: [f64; 3] = [4.0, 2.5, 1.0];

    fn values(order: f64, sizes: &[f64]) -> Vec<f64> {
        sizes.iter().map(|h| 7.0 - 0.3 * h.powf(order)).collect()
    }

    /// Of `f + C h^p` on meshes of any ratio the order and the limit are found to rounding.
    #[test]
    fn a_power_of_the_element_size_is_extrapolated_exactly() {
        for order in [0.7, 1.0, 1.4, 2.0] {
            for sizes in [SIZES, [9.0, 8.0, 1.0], [1.3, 1.2, 1.1]] {
                let found = estimate(&values(order, &sizes), &sizes, 0.0, 2.0);
                assert_eq!(found.trend, Trend::Converging);
                assert!((found.order.unwrap() - order).abs() < 1e-9, "{found:?}");
                assert!(
                    (found.extrapolated.unwrap() - 7.0).abs() < 1e-8,
                    "{found:?}"
                );
                // The band contains the exact value.
                let finest = values(order, &sizes)[2];
                assert!(found.band.unwrap() >= (finest - 7.0).abs(), "{found:?}");
            }
        }
    }

    /// The band is 1.25 times the estimated error at the formal order and 3 times it elsewhere; an order above the formal
    /// one gains nothing.
    #[test]
    fn the_factor_of_safety_follows_the_observed_order() {
        let sizes = [4.0, 2.0, 1.0];
        let band = |order: f64| {
            estimate(&values(order, &sizes), &sizes, 0.0, 2.0)
                .band
                .unwrap()
        };
        assert!((band(2.0) - 1.25 * 0.3).abs() < 1e-9, "{}", band(2.0));
        assert!((band(1.0) - 3.0 * 0.3).abs() < 1e-9, "{}", band(1.0));
        // 0.3 (2^3 - 1) between the finest meshes, divided by 2^2 - 1.
        assert!((band(3.0) - 3.0 * 0.7).abs() < 1e-9, "{}", band(3.0));
    }

    #[test]
    fn two_meshes_have_the_formal_order() {
        let found = estimate(&[10.0, 8.0], &[2.0, 1.0], 0.0, 2.0);
        assert_eq!((found.trend, found.order), (Trend::Assumed, None));
        assert!((found.extrapolated.unwrap() - (8.0 - 2.0 / 3.0)).abs() < 1e-12);
        assert!((found.band.unwrap() - 2.0).abs() < 1e-12);
    }

    /// Differences that grow, fall too slowly or alternate have no extrapolated value.
    #[test]
    fn without_an_order_nothing_is_extrapolated() {
        let sizes = [4.0, 2.0, 1.0];
        let of = |values: [f64; 3]| estimate(&values, &sizes, 0.0, 2.0);
        for growing in [[1.0, 2.0, 4.0], [1.0, 2.0, 3.0], [3.0, 2.0, 1.1]] {
            let found = of(growing);
            assert_eq!(found.trend, Trend::Diverging, "{growing:?}");
            assert_eq!((found.extrapolated, found.band), (None, None));
        }
        let found = of([1.0, 3.0, 2.0]);
        assert_eq!(found.trend, Trend::Oscillating);
        assert_eq!((found.extrapolated, found.band), (None, Some(3.0)));
        let found = of([5.0, 5.0, 5.0]);
        assert_eq!((found.trend, found.band), (Trend::Constant, Some(0.0)));
    }

    /// A difference within twice the scatter is no convergence, and no band is narrower than twice the scatter.
    #[test]
    fn scatter_limits_the_band() {
        let sizes = [4.0, 2.0, 1.0];
        let found = estimate(&[10.0, 9.0, 8.9], &sizes, 0.06, 2.0);
        assert_eq!(found.trend, Trend::Scattered);
        assert!((found.band.unwrap() - 1.1).abs() < 1e-12);
        let found = estimate(&[14.0, 11.0, 10.0], &sizes, 0.3, 2.0);
        assert_eq!(found.trend, Trend::Converging);
        assert!(found.band.unwrap() >= 0.6);
        // The error by the meshes alone, 0.125, is within the scatter.
        let found = estimate(&[11.6, 10.4, 10.1], &sizes, 0.14, 2.0);
        assert_eq!(found.trend, Trend::Converging);
        assert!((found.band.unwrap() - 0.28).abs() < 1e-12);
        let quiet = estimate(&[10.0, 10.0, 10.0], &sizes, 0.3, 2.0);
        assert_eq!(quiet.band, Some(0.6));
    }

    /// Of more than three meshes the three finest count.
    #[test]
    fn the_finest_three_count() {
        let sizes = [8.0, 4.0, 2.0, 1.0];
        let four = [-50.0, 14.0, 11.0, 10.0];
        let three = estimate(&four[1..], &sizes[1..], 0.0, 2.0);
        assert_eq!(estimate(&four, &sizes, 0.0, 2.0), three);
    }

    /// A peak that falls so much that its limit would be below zero has none; nor has one of three meshes.
    #[test]
    fn a_peak_has_no_limit_below_zero() {
        let falling = estimate(&[9.0639e4, 2.8954e4], &[2.0, 1.0], 0.0, 1.0);
        assert_eq!(
            (falling.trend, falling.extrapolated),
            (Trend::TooCoarse, None)
        );
        let falling = estimate(&[-9.0, -4.0, -1.0], &[4.0, 2.0, 1.0], 0.0, 1.0);
        assert_eq!(
            (falling.trend, falling.extrapolated),
            (Trend::TooCoarse, None)
        );
        // What changes its sign between the meshes may do so again.
        let signed = estimate(&[-1.0, 1.0], &[2.0, 1.0], 0.0, 1.0);
        assert_eq!(signed.extrapolated, Some(3.0));
        let slight = estimate(&[1.2, 1.1], &[2.0, 1.0], 0.0, 1.0);
        assert_eq!(slight.trend, Trend::Assumed);
    }
}
