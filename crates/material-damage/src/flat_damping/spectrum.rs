//! Relaxation spectra whose damping is constant over a band of frequencies.

use core::f64::consts::TAU;

use nalgebra::{Complex, DMatrix, DVector};
use powerhouse_model::ParameterError;

/// Greatest number of mechanisms of a [`RelaxationSpectrum`].
pub const MOST_MECHANISMS: usize = 4;

/// Damping ratio, frequency band and number of mechanisms to which a [`RelaxationSpectrum`] is fitted.
///
/// ```
/// use powerhouse_material_damage::{DampingBand, RelaxationSpectrum};
/// let band = DampingBand { ratio: 0.05, lowest: 0.5, highest: 20.0, mechanisms: 3 };
/// let spectrum = RelaxationSpectrum::fit(band)?;
/// assert!(spectrum.deviation() < 0.013);
/// assert!((spectrum.damping_ratio(3.0) / 0.05 - 1.0).abs() < 0.013);
/// # Ok::<(), powerhouse_model::ParameterError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DampingBand {
    /// Damping ratio, half the loss factor `Im M / Re M` (1); above 0, at most 0.2.
    pub ratio: f64,
    /// Lowest frequency of the band (Hz), above zero.
    pub lowest: f64,
    /// Highest frequency of the band (Hz), 1.5 to 1000 times the lowest.
    pub highest: f64,
    /// Number of relaxation mechanisms, 2 to 4: more fit a wider band, each at a cost in memory and
    /// time.
    pub mechanisms: usize,
}

/// Relaxation mechanism: a Maxwell element, a spring and a dashpot in series.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mechanism {
    /// Relaxation frequency, at which it dissipates most (Hz).
    pub frequency: f64,
    /// Stiffness of its spring relative to the static modulus (1).
    pub weight: f64,
}

/// Relaxation mechanisms in parallel with a spring whose damping is constant over a band of frequencies.
///
/// `M(w) / M(0) = 1 + sum y_l i w / (i w + w_l)`
///
/// The frequencies and weights minimise the largest deviation of `Im M / (2 Re M)`
/// from the ratio (a minimax fit by the exchange of Remez 1934): the deviation has the same size
/// at `2 n + 1` frequencies, with alternating sign. Below the band damping falls with the
/// frequency, above it with its inverse.
///
/// Causality makes every such medium dispersive: waves of high frequency travel faster, see
/// [`velocity`](Self::velocity).
///
/// Source of the model: Emmerich & Korn (1987), Geophysics 52(9), 1252-1264.
#[derive(Clone, Debug, PartialEq)]
pub struct RelaxationSpectrum {
    band: DampingBand,
    mechanisms: Vec<Mechanism>,
    deviation: f64,
}

/// Number of intervals of the search for extremes of the deviation.
const INTERVALS: usize = 400;

/// Greatest number of exchanges of extremes; a few suffice.
const MOST_EXCHANGES: usize = 60;

impl RelaxationSpectrum {
    /// Spectrum fitted to a damping band.
    ///
    /// # Errors
    /// If a field is outside its range.
    pub fn fit(band: DampingBand) -> Result<Self, ParameterError> {
        ParameterError::check("ratio", band.ratio, 1.0e-6, 0.2)?;
        ParameterError::check("lowest", band.lowest, f64::MIN_POSITIVE, 1.0e6)?;
        let width = [1.5 * band.lowest, 1000.0 * band.lowest];
        ParameterError::check("highest", band.highest, width[0], width[1])?;
        let most = MOST_MECHANISMS as f64;
        ParameterError::check("mechanisms", band.mechanisms as f64, 2.0, most)?;

        // Small damping first, then larger in steps: each fit starts from the one before.
        let mut parameters = start(&band);
        let mut fitted = exchange(&band, 0.02 * band.ratio, &mut parameters);
        for share in [0.1, 0.3, 0.6, 1.0] {
            fitted = exchange(&band, share * band.ratio, &mut parameters);
        }
        let n = band.mechanisms;
        let mechanisms = (0..n).map(|l| Mechanism {
            frequency: parameters[l].exp(),
            weight: parameters[n + l].exp(),
        });
        Ok(Self {
            band,
            mechanisms: mechanisms.collect(),
            deviation: fitted,
        })
    }

    /// Damping band to which the mechanisms were fitted.
    pub fn band(&self) -> DampingBand {
        self.band
    }
    /// Mechanisms in the order of rising frequency.
    pub fn mechanisms(&self) -> &[Mechanism] {
        &self.mechanisms
    }
    /// Largest deviation of the damping ratio within the band, relative to its target (1).
    pub fn deviation(&self) -> f64 {
        self.deviation
    }
    /// Complex modulus at a frequency (Hz), relative to the static one (1).
    pub fn modulus(&self, frequency: f64) -> Complex<f64> {
        let terms = self.mechanisms.iter().map(|mechanism| {
            let ratio = Complex::new(0.0, frequency / mechanism.frequency);
            mechanism.weight * ratio / (ratio + 1.0)
        });
        terms.fold(Complex::new(1.0, 0.0), |sum, term| sum + term)
    }
    /// Damping ratio at a frequency (Hz), half the loss factor (1).
    pub fn damping_ratio(&self, frequency: f64) -> f64 {
        let modulus = self.modulus(frequency);
        0.5 * modulus.im / modulus.re
    }
    /// Phase velocity at a frequency (Hz), relative to that of static moduli (1).
    pub fn velocity(&self, frequency: f64) -> f64 {
        1.0 / self.modulus(frequency).sqrt().inv().re
    }
    /// Unrelaxed modulus, at infinite frequency, relative to the static one (1).
    pub fn unrelaxed(&self) -> f64 {
        self.mechanisms.iter().fold(1.0, |sum, m| sum + m.weight)
    }
    /// Geometric centre of the band (Hz).
    pub fn centre(&self) -> f64 {
        (self.band.lowest * self.band.highest).sqrt()
    }
}

/// Initial logarithms of frequencies and weights: evenly over the band, with the weights
/// of small damping, whose sum of overlapping bells is about their spacing.
fn start(band: &DampingBand) -> DVector<f64> {
    let n = band.mechanisms;
    let (low, high) = (band.lowest.ln(), band.highest.ln());
    let spacing = (high - low) / n as f64;
    DVector::from_fn(2 * n, |row, _| {
        if row < n {
            low + spacing * (row as f64 + 0.5)
        } else {
            // The integral of x / (1 + x^2) over ln x is pi / 2.
            (0.04 * band.ratio * spacing.max(1.0) / core::f64::consts::FRAC_PI_2).ln()
        }
    })
}

/// Improves the parameters to the minimax fit of a ratio; returns its deviation.
fn exchange(band: &DampingBand, ratio: f64, parameters: &mut DVector<f64>) -> f64 {
    let unknowns = parameters.len();
    let (low, high) = (band.lowest.ln(), band.highest.ln());
    // Extremes of a Chebyshev polynomial of the degree that the unknowns permit.
    let mut nodes: Vec<f64> = (0..=unknowns)
        .map(|i| {
            let angle = core::f64::consts::PI * i as f64 / unknowns as f64;
            0.5 * (low + high) - 0.5 * (high - low) * angle.cos()
        })
        .collect();
    let mut largest = f64::INFINITY;
    for _ in 0..MOST_EXCHANGES {
        level(&nodes, ratio, parameters);
        let (extremes, found) = extremes(band, ratio, parameters);
        let settled = (found - largest).abs() < 1.0e-12;
        largest = found;
        if extremes.len() == unknowns + 1 {
            nodes = extremes;
        }
        if settled {
            break;
        }
    }
    largest
}

/// Newton's method for deviations of equal size and alternating sign at given logarithms of frequency.
fn level(nodes: &[f64], ratio: f64, parameters: &mut DVector<f64>) {
    let unknowns = parameters.len();
    for _ in 0..40 {
        let mut matrix = DMatrix::zeros(unknowns + 1, unknowns + 1);
        let mut wrong = DVector::zeros(unknowns + 1);
        for (row, &log_frequency) in nodes.iter().enumerate() {
            let (value, slope) = deviation(log_frequency, ratio, parameters);
            wrong[row] = -value;
            matrix
                .row_mut(row)
                .columns_mut(0, unknowns)
                .copy_from(&slope.transpose());
            matrix[(row, unknowns)] = if row % 2 == 0 { 1.0 } else { -1.0 };
        }
        let Some(step) = matrix.lu().solve(&wrong) else {
            return;
        };
        let step = step.rows(0, unknowns);
        let length = step.amax();
        if !length.is_finite() {
            return;
        }
        *parameters += step * (0.5 / length.max(0.5));
        if length < 1.0e-14 {
            return;
        }
    }
}

/// Relative deviation of the damping at `ln frequency`, and its derivatives.
fn deviation(log_frequency: f64, ratio: f64, parameters: &DVector<f64>) -> (f64, DVector<f64>) {
    let n = parameters.len() / 2;
    let mut modulus = Complex::new(1.0, 0.0);
    let mut slopes = vec![Complex::new(0.0, 0.0); 2 * n];
    for l in 0..n {
        let weight = parameters[n + l].exp();
        let turn = Complex::new(0.0, (log_frequency - parameters[l]).exp());
        let term = weight * turn / (turn + 1.0);
        modulus += term;
        slopes[n + l] = term;
        slopes[l] = -term / (turn + 1.0);
    }
    let loss = modulus.im / modulus.re;
    let slope = DVector::from_fn(2 * n, |i, _| {
        (slopes[i].im - loss * slopes[i].re) / modulus.re / (2.0 * ratio)
    });
    (loss / (2.0 * ratio) - 1.0, slope)
}

/// Logarithms of frequency at which the deviation is extreme, alternating in sign, and the largest deviation.
fn extremes(band: &DampingBand, ratio: f64, parameters: &DVector<f64>) -> (Vec<f64>, f64) {
    let (low, high) = (band.lowest.ln(), band.highest.ln());
    let spacing = (high - low) / INTERVALS as f64;
    let value = |log_frequency: f64| deviation(log_frequency, ratio, parameters).0;
    let mut found: Vec<(f64, f64)> = Vec::new();
    for i in 0..=INTERVALS {
        let log_frequency = low + spacing * i as f64;
        let mut here = (log_frequency, value(log_frequency));
        let sign = here.1.signum();
        if i > 0 && i < INTERVALS {
            let (before, after) = (
                value(log_frequency - spacing),
                value(log_frequency + spacing),
            );
            if (here.1 - before) * sign < 0.0 || (here.1 - after) * sign < 0.0 {
                continue;
            }
            // Vertex of the parabola through the three.
            let bend = before - 2.0 * here.1 + after;
            if bend != 0.0 {
                let log_frequency = log_frequency + 0.5 * spacing * (before - after) / bend;
                here = (log_frequency, value(log_frequency));
            }
        }
        match found.last_mut() {
            Some(last) if last.1 * here.1 > 0.0 => {
                if here.1.abs() > last.1.abs() {
                    *last = here;
                }
            }
            _ => found.push(here),
        }
    }
    let largest = found.iter().fold(0.0_f64, |most, (_, e)| most.max(e.abs()));
    (
        found
            .into_iter()
            .map(|(log_frequency, _)| log_frequency)
            .collect(),
        largest,
    )
}

/// Coefficients of a mechanism for steps of a given length (s).
///
/// With `x = w_l dt / 2` and strain taken as linear within the step, a mechanism's dashpot strain is
/// `v_1 = a v_0 + alpha e_0 + beta e_1`, `a = exp(-2 x)`, `beta = 1 - (1 - a) / (2 x)`,
/// `alpha = 1 - a - beta`: exact for such a strain, and passive for every step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Decay {
    /// Decay factor `a` of the dashpot's strain.
    pub(super) kept: f64,
    /// Coefficient `beta` of the strain at the end of the step.
    pub(super) after: f64,
}

impl Decay {
    pub(super) fn new(mechanism: &Mechanism, step: f64) -> Self {
        let turn = TAU * mechanism.frequency * step;
        let kept = (-turn).exp();
        // 1 - (1 - exp(-t)) / t, by its series where the difference loses digits.
        let after = if turn < 1.0e-2 {
            turn * (0.5 - turn * (1.0 / 6.0 - turn * (1.0 / 24.0 - turn / 120.0)))
        } else {
            1.0 + (-turn).exp_m1() / turn
        };
        Self { kept, after }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The coefficients of a step are the exact solution for a strain that grows linearly,
    /// `1 - (1 - exp(-t)) / t` summed up to its last digit, from very short steps to those in which the mechanism
    /// relaxes, on both sides of the change of formula.
    #[test]
    fn a_step_is_solved_exactly() {
        for turn in [1e-9, 1e-5, 3e-3, 0.9999e-2, 1.0001e-2, 0.1, 0.5, 1.0] {
            let mechanism = Mechanism {
                frequency: 1.0 / TAU,
                weight: 0.1,
            };
            let decay = Decay::new(&mechanism, turn);
            // t / 2! - t^2 / 3! + t^3 / 4! - ...
            let (mut term, mut sum) = (0.5 * turn, 0.0);
            for k in 3..40 {
                sum += term;
                term *= -turn / f64::from(k);
            }
            assert!(
                (decay.after / sum - 1.0).abs() < 1e-10,
                "{turn} {decay:?} {sum}"
            );
            assert!((decay.kept / f64::exp(-turn) - 1.0).abs() < 1e-14, "{turn}");
        }
    }
}
