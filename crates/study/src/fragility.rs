//! Fragility: the probability that a limit is exceeded against the intensity of the motion, as a lognormal curve.

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::rounded::rounded;

/// Quantile of the standard normal distribution between which and its negative 95 % lie.
const QUANTILE: f64 = 1.959_963_984_540_054;
/// Greatest number of Fisher's scoring steps; some ten are enough.
const MOST_STEPS: usize = 1000;
/// Change of the parameters, in units of their standard errors, below which they are the estimate.
const SETTLED: f64 = 1e-10;

/// Runs at one intensity, and how many of them exceed the limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stripe {
    /// Intensity of the motion, above 0, in any unit.
    pub intensity: f64,
    /// Number of runs.
    pub count: u32,
    /// Number of those that exceed the limit.
    pub exceeded: u32,
}

/// Lognormal fragility curve `P(exceedance | x) = Phi(ln(x / median) / dispersion)`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct LognormalFragility {
    /// Intensity at which half of the runs exceed the limit.
    pub median: f64,
    /// Standard deviation of the logarithm of the intensity at which a run begins to exceed it (1).
    pub dispersion: f64,
    /// Interval of 95 % confidence of the median, from the expected information.
    pub median_interval: [f64; 2],
    /// The same of the dispersion.
    pub dispersion_interval: [f64; 2],
}

/// Why runs determine no lognormal curve.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum FragilityError {
    /// A stripe without a positive intensity, or of which more runs exceed the limit than there are.
    #[error("{exceeded} of {count} runs at an intensity of {}", rounded(*intensity))]
    Stripe {
        /// Intensity.
        intensity: f64,
        /// Number of runs.
        count: u32,
        /// Number of those that exceed the limit.
        exceeded: u32,
    },
    /// No run.
    #[error("there is no run")]
    NoRun,
    /// All runs exceed the limit.
    #[error("all {count} runs exceed the limit: the median is below the least intensity, {}", rounded(*least))]
    All {
        /// Number of runs.
        count: u32,
        /// Least intensity.
        least: f64,
    },
    /// No run exceeds the limit.
    #[error(
        "none of {count} runs exceeds the limit: the median is above the greatest intensity, {}", rounded(*greatest)
    )]
    None {
        /// Number of runs.
        count: u32,
        /// Greatest intensity.
        greatest: f64,
    },
    /// An intensity parts the runs that exceed the limit from the others, so that no dispersion is too small.
    #[error(
        "no run up to an intensity of {} exceeds the limit and all from {} on do: the median is between, the dispersion takes more records or levels there",
        rounded(*below),
        rounded(*above)
    )]
    Parted {
        /// Greatest intensity of a run that does not exceed the limit.
        below: f64,
        /// Least intensity of a run that exceeds it.
        above: f64,
    },
    /// Exceedances do not become more frequent with the intensity.
    #[error("exceedances do not become more frequent with the intensity")]
    Falling,
}

impl LognormalFragility {
    /// Curve of the greatest likelihood, of runs whose exceedances are binomial at each intensity (J. W. Baker (2015), Efficient
    /// analytical fragility function fitting using dynamic structural analysis, Earthquake Spectra 31(1)):
    ///
    /// ```text
    /// sum over stripes  z ln(p) + (n - z) ln(1 - p),   p = Phi(ln(x / median) / dispersion)
    /// ```
    ///
    /// The logarithm of this likelihood is concave in `1 / dispersion` and `ln(median) / dispersion`, in which Fisher's scoring
    /// finds its only maximum. The intervals are those of the normal distribution of the logarithms of both parameters, with the
    /// inverse of the expected information matrix at the estimate as covariance: approximations for many runs, too
    /// narrow for few.
    ///
    /// ```
    /// use powerhouse_study::fragility::{LognormalFragility, Stripe};
    /// let stripe = |intensity, exceeded| Stripe { intensity, count: 20, exceeded };
    /// let stripes = [stripe(1.0, 2), stripe(2.0, 10), stripe(4.0, 18)];
    /// let fitted = LognormalFragility::fit(&stripes)?;
    /// assert!((fitted.median - 2.0).abs() < 1e-9); // by symmetry
    /// # Ok::<(), powerhouse_study::fragility::FragilityError>(())
    /// ```
    ///
    /// # Errors
    /// If all runs exceed the limit, or none; if an intensity parts them; if they exceed it less often where the motion is stronger.
    pub fn fit(stripes: &[Stripe]) -> Result<Self, FragilityError> {
        check(stripes)?;
        let stripes: Vec<&Stripe> = stripes.iter().filter(|stripe| stripe.count > 0).collect();
        // In units of their spread from their centre, so that both parameters are of the order of one.
        let total: f64 = stripes.iter().map(|stripe| f64::from(stripe.count)).sum();
        let mean = |value: &dyn Fn(&Stripe) -> f64| {
            let sum = stripes
                .iter()
                .map(|stripe| f64::from(stripe.count) * value(stripe));
            sum.sum::<f64>() / total
        };
        let centre = mean(&|stripe| stripe.intensity.ln());
        let spread = mean(&|stripe| (stripe.intensity.ln() - centre).powi(2)).sqrt();
        let runs = stripes.iter().map(|stripe| {
            let place = (stripe.intensity.ln() - centre) / spread;
            [place, stripe.count.into(), stripe.exceeded.into()]
        });
        let runs: Vec<[f64; 3]> = runs.collect();
        let ([level, slope], information) = greatest(&runs);
        if slope <= 0.0 {
            return Err(FragilityError::Falling);
        }
        let log_median = centre - spread * level / slope;
        let dispersion = spread / slope;
        // Variances of both logarithms, by their derivatives with respect to level and slope.
        let variance = |[of_level, of_slope]: [f64; 2]| {
            let [a, b, c] = information;
            let determinant = a * c - b * b;
            (c * of_level * of_level - 2.0 * b * of_level * of_slope + a * of_slope * of_slope)
                / determinant
        };
        let of_median = variance([-spread / slope, spread * level / (slope * slope)]);
        let of_dispersion = variance([0.0, -1.0 / slope]);
        let interval = |value: f64, variance: f64| {
            let factor = (QUANTILE * variance.sqrt()).exp();
            [value / factor, value * factor]
        };
        let median = log_median.exp();
        Ok(Self {
            median,
            dispersion,
            median_interval: interval(median, of_median),
            dispersion_interval: interval(dispersion, of_dispersion),
        })
    }

    /// Probability that the limit is exceeded at an intensity above 0.
    pub fn probability(&self, intensity: f64) -> f64 {
        upper_tail(-(intensity / self.median).ln() / self.dispersion)
    }
}

/// Checks that the likelihood has its greatest value at a finite slope.
fn check(stripes: &[Stripe]) -> Result<(), FragilityError> {
    for &Stripe {
        intensity,
        count,
        exceeded,
    } in stripes
    {
        if !(intensity > 0.0 && intensity.is_finite()) || exceeded > count {
            return Err(FragilityError::Stripe {
                intensity,
                count,
                exceeded,
            });
        }
    }
    // Least and greatest intensity of the runs that exceed the limit, and of the others.
    let range = |counts: &dyn Fn(&Stripe) -> bool| {
        let of = stripes.iter().filter(|stripe| counts(stripe));
        of.fold(None, |range: Option<[f64; 2]>, stripe| {
            let [least, greatest] = range.unwrap_or([stripe.intensity; 2]);
            Some([least.min(stripe.intensity), greatest.max(stripe.intensity)])
        })
    };
    let count = stripes.iter().map(|stripe| stripe.count).sum();
    match [range(&|s| s.exceeded > 0), range(&|s| s.exceeded < s.count)] {
        [None, None] => Err(FragilityError::NoRun),
        [Some([least, _]), None] => Err(FragilityError::All { count, least }),
        [None, Some([_, greatest])] => Err(FragilityError::None { count, greatest }),
        [Some([least, greatest]), Some([other_least, other_greatest])] => {
            if other_least >= greatest {
                // All runs at one intensity, too.
                return Err(FragilityError::Falling);
            }
            if least >= other_greatest {
                let (below, above) = (other_greatest, least);
                return Err(FragilityError::Parted { below, above });
            }
            Ok(())
        }
    }
}

/// Level and slope of the greatest likelihood of runs (place, number, exceedances), and the upper triangle of their expected
/// information.
fn greatest(runs: &[[f64; 3]]) -> ([f64; 2], [f64; 3]) {
    let likelihood = |[level, slope]: [f64; 2]| -> f64 {
        let of = runs.iter().map(|&[place, count, exceeded]| {
            let reach = level + slope * place;
            exceeded * log_upper_tail(-reach) + (count - exceeded) * log_upper_tail(reach)
        });
        of.sum()
    };
    let mut estimate = [0.0, 1.0];
    let mut information = [0.0; 3];
    for _ in 0..MOST_STEPS {
        let mut score = [0.0; 2];
        information = [0.0; 3];
        for &[place, count, exceeded] in runs {
            let reach = estimate[0] + estimate[1] * place;
            let (lower, upper) = (hazard(-reach), hazard(reach));
            let slope = exceeded * lower - (count - exceeded) * upper;
            let weight = count * lower * upper;
            score = [score[0] + slope, score[1] + slope * place];
            for (sum, part) in information.iter_mut().zip([1.0, place, place * place]) {
                *sum += weight * part;
            }
        }
        let [a, b, c] = information;
        let determinant = a * c - b * b;
        let mut step = [
            (c * score[0] - b * score[1]) / determinant,
            (a * score[1] - b * score[0]) / determinant,
        ];
        let size = step[0] * score[0] + step[1] * score[1];
        if size.is_nan() || size <= SETTLED * SETTLED {
            break;
        }
        let before = likelihood(estimate);
        let moved = |step: [f64; 2]| [estimate[0] + step[0], estimate[1] + step[1]];
        // A step that is too long is halved; one that rounding alone makes worse ends the search.
        let mut halvings = 0;
        while likelihood(moved(step)) < before && halvings < 40 {
            step = step.map(|part| 0.5 * part);
            halvings += 1;
        }
        if halvings == 40 {
            break;
        }
        estimate = moved(step);
    }
    (estimate, information)
}

/// Density of the standard normal distribution.
fn density(x: f64) -> f64 {
    (-0.5 * x * x).exp() / (2.0 * std::f64::consts::PI).sqrt()
}

/// Probability above `x >= 0` over the density there: Mills' ratio. Its power series below 3, its continued fraction above.
fn mills_ratio(x: f64) -> f64 {
    if x < 3.0 {
        let (mut term, mut sum, mut odd) = (x, x, 1.0);
        while term > 1e-17 * sum {
            odd += 2.0;
            term *= x * x / odd;
            sum += term;
        }
        (0.5 * std::f64::consts::PI).sqrt() * (0.5 * x * x).exp() - sum
    } else {
        (1..=100)
            .rev()
            .fold(x, |rest, k| x + f64::from(k) / rest)
            .recip()
    }
}

/// Probability that a standard normal variable is above `x`.
fn upper_tail(x: f64) -> f64 {
    if x >= 0.0 {
        density(x) * mills_ratio(x)
    } else {
        1.0 - upper_tail(-x)
    }
}

/// Its logarithm.
fn log_upper_tail(x: f64) -> f64 {
    if x >= 0.0 {
        -0.5 * x * x - 0.5 * (2.0 * std::f64::consts::PI).ln() + mills_ratio(x).ln()
    } else {
        (-upper_tail(-x)).ln_1p()
    }
}

/// Density over the probability above.
fn hazard(x: f64) -> f64 {
    if x >= 0.0 {
        mills_ratio(x).recip()
    } else {
        density(x) / upper_tail(x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Simpson's rule with many intervals.
    fn integral(f: impl Fn(f64) -> f64, from: f64, to: f64) -> f64 {
        let (intervals, mut sum) = (20_000, 0.0);
        let step = (to - from) / f64::from(intervals);
        for i in 0..=intervals {
            let weight = match i {
                0 => 1.0,
                i if i == intervals => 1.0,
                i if i % 2 == 1 => 4.0,
                _ => 2.0,
            };
            sum += weight * f(from + f64::from(i) * step);
        }
        sum * step / 3.0
    }

    /// Probabilities of the normal distribution are those of its integral, also far out, and at the join of series and fraction.
    #[test]
    fn tails_are_integrals_of_the_density() {
        for x in [0.0, 0.3, 1.0, 2.5, 2.999_999, 3.0, 3.7, 6.0, 12.0, 30.0] {
            // Over the density at x, so that nothing underflows.
            let ratio = integral(
                |t| (-x * t - 0.5 * t * t).exp(),
                0.0,
                15.0f64.min(40.0 / (1.0 + x)),
            );
            assert!(
                (mills_ratio(x) / ratio - 1.0).abs() < 1e-10,
                "{x}: {} {ratio}",
                mills_ratio(x)
            );
            assert!((upper_tail(x) + upper_tail(-x) - 1.0).abs() < 1e-15);
            let log = ratio.ln() - 0.5 * x * x - 0.5 * (2.0 * std::f64::consts::PI).ln();
            assert!((log_upper_tail(x) - log).abs() < 1e-9 * log.abs());
        }
        assert!((upper_tail(QUANTILE) - 0.025).abs() < 1e-15);
    }

    /// Logarithm of the binomial likelihood of a curve.
    fn likelihood(stripes: &[Stripe], log_median: f64, dispersion: f64) -> f64 {
        let of = stripes.iter().map(|stripe| {
            let reach = (stripe.intensity.ln() - log_median) / dispersion;
            let (count, exceeded) = (f64::from(stripe.count), f64::from(stripe.exceeded));
            exceeded * upper_tail(-reach).ln() + (count - exceeded) * upper_tail(reach).ln()
        });
        of.sum()
    }

    fn stripes(all: &[(f64, u32, u32)]) -> Vec<Stripe> {
        let stripe = |&(intensity, count, exceeded)| Stripe {
            intensity,
            count,
            exceeded,
        };
        all.iter().map(stripe).collect()
    }

    /// Runs whose shares are exactly those of a lognormal distribution have this distribution, for any median, dispersion and unit.
    #[test]
    fn exact_shares_have_their_own_curve() {
        for (median, dispersion) in [(1.7, 0.4), (320.0, 0.9), (0.02, 0.15)] {
            let known = |x: f64| upper_tail(-f64::ln(x / median) / dispersion);
            let levels =
                [-1.3, -0.4, 0.2, 1.1].map(|reach: f64| median * (dispersion * reach).exp());
            // Counts of a million are exact to their rounding.
            let of = |x: f64| (x, 4_000_000, (4e6 * known(x)).round() as u32);
            let fitted = LognormalFragility::fit(&stripes(&levels.map(of))).unwrap();
            assert!((fitted.median / median - 1.0).abs() < 1e-6, "{fitted:?}");
            assert!(
                (fitted.dispersion / dispersion - 1.0).abs() < 1e-6,
                "{fitted:?}"
            );
            assert!((fitted.probability(levels[3]) - known(levels[3])).abs() < 1e-6);
        }
    }

    /// The curve of few runs is the greatest likelihood that a search over medians and dispersions finds, also where every run has an
    /// intensity of its own.
    #[test]
    fn the_likelihood_is_the_greatest() {
        let single = [
            (0.8, 1, 0),
            (1.1, 1, 0),
            (1.3, 1, 1),
            (1.9, 1, 0),
            (2.2, 1, 1),
            (2.4, 1, 0),
            (3.5, 1, 1),
            (5.0, 1, 1),
        ];
        let few = [(0.1, 5, 0), (0.2, 5, 1), (0.4, 5, 1), (0.8, 5, 4)];
        let skewed = [(3.0, 40, 1), (9.0, 40, 2), (30.0, 3, 1)];
        for runs in [&single[..], &few, &skewed].map(stripes) {
            let fitted = LognormalFragility::fit(&runs).unwrap();
            // A search over ever finer grids, which knows nothing of derivatives.
            let (mut best, mut at, mut width) = (f64::NEG_INFINITY, [1.0, 0.0], [6.0, 4.0]);
            for _ in 0..60 {
                let centre = at;
                for i in -10..=10 {
                    for j in -10..=10 {
                        let tried = [
                            centre[0] + width[0] * f64::from(i) / 10.0,
                            centre[1] + width[1] * f64::from(j) / 10.0,
                        ];
                        let found = likelihood(&runs, tried[0], tried[1].exp());
                        if found > best {
                            (best, at) = (found, tried);
                        }
                    }
                }
                width = width.map(|width| 0.6 * width);
            }
            // A maximum is known to the root of the rounding of its value.
            assert!(
                (fitted.median.ln() - at[0]).abs() < 1e-6,
                "{fitted:?} {at:?}"
            );
            assert!(
                (fitted.dispersion.ln() - at[1]).abs() < 1e-6,
                "{fitted:?} {at:?}"
            );
            let own = likelihood(&runs, fitted.median.ln(), fitted.dispersion);
            assert!(own >= best - 1e-12, "{own} {best}");
        }
    }

    /// Intervals are those of the curvature of the likelihood where runs are many, where those of the profile likelihood are the same,
    /// and become narrower with the root of their number.
    #[test]
    fn intervals_are_those_of_the_profile_of_many_runs() {
        let shares = [(0.5, 0.02), (1.0, 0.21), (2.0, 0.62), (4.0, 0.93)];
        let of = |count: u32| {
            let runs =
                shares.map(|(x, share)| (x, count, (share * f64::from(count)).round() as u32));
            stripes(&runs)
        };
        let runs = of(10_000);
        let fitted = LognormalFragility::fit(&runs).unwrap();
        let greatest = likelihood(&runs, fitted.median.ln(), fitted.dispersion);
        // The least loss of likelihood over the other parameter, half of the chi-square quantile of 3.841 at the ends.
        let profile = |loss: &dyn Fn(f64) -> f64, centre: f64| {
            let (mut low, mut high) = (centre - 0.1, centre + 0.1);
            for _ in 0..100 {
                let [a, b] = [low + (high - low) / 3.0, high - (high - low) / 3.0];
                if loss(a) < loss(b) { high = b } else { low = a }
            }
            loss(0.5 * (low + high))
        };
        let limit = 0.5 * QUANTILE * QUANTILE;
        for end in fitted.median_interval {
            let loss = |log: f64| greatest - likelihood(&runs, end.ln(), log.exp());
            let least = profile(&loss, fitted.dispersion.ln());
            assert!((least / limit - 1.0).abs() < 0.03, "{least} {limit}");
        }
        for end in fitted.dispersion_interval {
            let loss = |log: f64| greatest - likelihood(&runs, log, end);
            let least = profile(&loss, fitted.median.ln());
            assert!((least / limit - 1.0).abs() < 0.03, "{least} {limit}");
        }
        let fewer = LognormalFragility::fit(&of(100)).unwrap();
        for [own, other] in [
            [fitted.median_interval, fewer.median_interval],
            [fitted.dispersion_interval, fewer.dispersion_interval],
        ] {
            let width = |[low, high]: [f64; 2]| (high / low).ln();
            assert!((width(other) / width(own) - 10.0).abs() < 1e-6);
        }
    }

    /// Runs that determine no curve are refused, each with its reason.
    #[test]
    fn runs_without_a_curve_are_refused() {
        let refused =
            |runs: &[(f64, u32, u32)]| LognormalFragility::fit(&stripes(runs)).unwrap_err();
        assert_eq!(refused(&[]), FragilityError::NoRun);
        assert_eq!(
            refused(&[(1.0, 3, 3), (2.0, 2, 2)]),
            FragilityError::All {
                count: 5,
                least: 1.0
            }
        );
        assert_eq!(
            refused(&[(1.0, 3, 0), (2.0, 2, 0)]),
            FragilityError::None {
                count: 5,
                greatest: 2.0
            }
        );
        // Also where both are found at one intensity.
        for runs in [
            &[(1.0, 3, 0), (2.0, 2, 2)][..],
            &[(1.0, 3, 0), (2.0, 4, 2), (3.0, 1, 1)],
        ] {
            assert!(
                matches!(refused(runs), FragilityError::Parted { .. }),
                "{runs:?}"
            );
        }
        for runs in [
            &[(1.0, 3, 2), (2.0, 3, 0)][..],
            &[(1.0, 4, 2)],
            &[(1.0, 9, 8), (2.0, 9, 5), (4.0, 9, 2)],
        ] {
            assert_eq!(refused(runs), FragilityError::Falling, "{runs:?}");
        }
        assert!(matches!(
            refused(&[(0.0, 3, 2)]),
            FragilityError::Stripe { .. }
        ));
        assert!(matches!(
            refused(&[(1.0, 3, 4)]),
            FragilityError::Stripe { .. }
        ));
    }
}
