//! Baseline corrections of records.

use nalgebra::{DMatrix, DVector};
use powerhouse_model::ParameterError;

use super::edit::MOST_SAMPLES;
use super::{RecordReport, TimeHistory};
use crate::WaveError;
use crate::fourier::Fourier;

/// Method of baseline correction: how the drift of a record's integrals is removed. No correction is
/// made unless one is given, and only [`HighPass`](Self::HighPass) changes the length of the record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BaselineCorrection {
    /// No correction.
    None,
    /// Subtracts the mean acceleration (by the trapezoidal rule): the end velocity vanishes.
    Mean,
    /// Subtracts the polynomial in time, of order 0 to 8, that fits the acceleration best.
    AccelerationPolynomial {
        /// Order of the polynomial.
        order: usize,
    },
    /// Subtracts from the acceleration the polynomial, of the given order 0 to 8, that leaves the
    /// least mean square velocity; order 2 is the parabolic baseline of G. V. Berg and
    /// G. W. Housner (1961), Bull. Seism. Soc. Am. 51(2). The end velocity becomes small, not zero.
    LeastVelocity {
        /// Order of the polynomial that is subtracted from the acceleration.
        order: usize,
    },
    /// Subtracts from the velocity a polynomial of the given order, 2 to 9, that starts at zero:
    /// the one that leaves the least mean square velocity among those that bring end velocity
    /// and end displacement to zero.
    VelocityPolynomial {
        /// Order of the polynomial that is subtracted from the velocity.
        order: usize,
    },
    /// Removes low frequencies without phase shift by a Butterworth filter of the given order,
    /// run forwards and backwards, `H = (f/fc)^(2n) / (1 + (f/fc)^(2n))`. The filter rings on both
    /// sides of the record, which therefore grows by 1.5 n / fc at each end, as D. M. Boore (2005),
    /// Bull. Seism. Soc. Am. 95(2) advises.
    HighPass {
        /// Corner frequency fc (Hz), at which half of the amplitude is left; at most the Nyquist frequency.
        corner: f64,
        /// Order n, 1 to 8.
        order: usize,
    },
}

impl BaselineCorrection {
    /// Name of the method in scenes and reports.
    pub fn name(&self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Mean => "mean",
            Self::AccelerationPolynomial { .. } => "acceleration-polynomial",
            Self::LeastVelocity { .. } => "least-velocity",
            Self::VelocityPolynomial { .. } => "velocity-polynomial",
            Self::HighPass { .. } => "high-pass",
        }
    }

    /// Whether the correction is a filter, which is meant to change a record and makes it longer.
    pub fn is_filter(&self) -> bool {
        matches!(self, Self::HighPass { .. })
    }
}

/// Effect of a baseline correction on a record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BaselineReport {
    /// Method of correction.
    pub correction: BaselineCorrection,
    /// Peaks and end values before the correction.
    pub before: RecordReport,
    /// Peaks and end values after the correction.
    pub after: RecordReport,
    /// Largest magnitude of the difference in acceleration (m/s2).
    pub largest_change: f64,
    /// Length added before the former start of the record (s).
    pub leading_pad: f64,
}

impl BaselineReport {
    /// Report of two corrections between which the record was changed on purpose. The change is that of the first one; the second one
    /// corrects what has been added.
    #[must_use]
    pub fn followed_by(self, second: &Self) -> Self {
        Self {
            after: second.after,
            leading_pad: self.leading_pad + second.leading_pad,
            ..self
        }
    }
}

impl TimeHistory {
    /// History with its baseline corrected, and a report of the change.
    ///
    /// # Errors
    /// If an order or a corner frequency is outside its range, or the record has fewer samples
    /// than the polynomial has coefficients plus one.
    pub fn corrected(
        &self,
        correction: BaselineCorrection,
    ) -> Result<(Self, BaselineReport), WaveError> {
        let mut pad = 0;
        let corrected = match correction {
            BaselineCorrection::None => self.clone(),
            BaselineCorrection::Mean => {
                let mean = self.nodes[self.nodes.len() - 1].velocity / self.duration();
                let samples = self.nodes.iter().map(|node| node.acceleration - mean);
                Self::new(self.step, samples.collect())?
            }
            BaselineCorrection::AccelerationPolynomial { order } => {
                self.without_polynomial(order, Fit::Acceleration)?
            }
            BaselineCorrection::LeastVelocity { order } => {
                self.without_polynomial(order, Fit::Velocity)?
            }
            BaselineCorrection::VelocityPolynomial { order } => {
                check_order(order, 2, 9)?;
                self.without_polynomial(order - 1, Fit::VelocityConstrained)?
            }
            BaselineCorrection::HighPass { corner, order } => {
                let (history, added) = self.high_pass(corner, order)?;
                pad = added;
                history
            }
        };
        let changes = self.nodes.iter().zip(&corrected.nodes[pad..]);
        let changes = changes.map(|(old, new)| (old.acceleration - new.acceleration).abs());
        let report = BaselineReport {
            correction,
            before: self.report(),
            after: corrected.report(),
            largest_change: changes.fold(0.0, f64::max),
            leading_pad: pad as f64 * self.step,
        };
        Ok((corrected, report))
    }

    /// Subtracts a polynomial fitted by least squares over the samples; its integrals are computed as
    /// those of the record, so that constraints at the end hold to rounding.
    fn without_polynomial(&self, order: usize, fit: Fit) -> Result<Self, WaveError> {
        check_order(order, 0, 8)?;
        let terms = order + 1;
        if self.samples() < terms + 1 {
            return Err(WaveError::TooFewSamples {
                operation: "a baseline of this order",
                given: self.samples(),
                least: terms + 1,
            });
        }
        let basis = (0..terms).map(|term| self.chebyshev(term));
        let basis = basis.collect::<Result<Vec<_>, _>>()?;
        let fitted = |history: &Self, i: usize| match fit {
            Fit::Acceleration => history.nodes[i].acceleration,
            Fit::Velocity | Fit::VelocityConstrained => history.nodes[i].velocity,
        };
        let last = self.samples() - 1;
        let constraints: &[fn(&super::Node) -> f64] = match fit {
            Fit::VelocityConstrained => &[|node| node.velocity, |node| node.displacement],
            Fit::Acceleration | Fit::Velocity => &[],
        };
        // [ G  C^T ] [c]   [g]
        // [ C   0  ] [l] = [e]
        let size = terms + constraints.len();
        let mut matrix = DMatrix::zeros(size, size);
        let mut right = DVector::zeros(size);
        for i in 0..=last {
            for (row, left) in basis.iter().enumerate() {
                let value = fitted(left, i);
                right[row] += value * fitted(self, i);
                for (column, other) in basis.iter().enumerate() {
                    matrix[(row, column)] += value * fitted(other, i);
                }
            }
        }
        for (k, constraint) in constraints.iter().enumerate() {
            // Both constraints are scaled so that the basis is of order one.
            let scale = 1.0 / constraint(&basis[0].nodes[last]);
            for (column, term) in basis.iter().enumerate() {
                let value = scale * constraint(&term.nodes[last]);
                matrix[(terms + k, column)] = value;
                matrix[(column, terms + k)] = value;
            }
            right[terms + k] = scale * constraint(&self.nodes[last]);
        }
        let scale = matrix[(0, 0)];
        for row in 0..terms {
            right[row] /= scale;
            for column in 0..terms {
                matrix[(row, column)] /= scale;
            }
        }
        let solution = matrix.full_piv_lu().solve(&right);
        let coefficients = solution.ok_or(WaveError::TooFewSamples {
            operation: "a baseline of this order",
            given: self.samples(),
            least: terms + 2,
        })?;
        let samples = (0..=last).map(|i| {
            let terms = basis.iter().zip(coefficients.iter());
            let baseline: f64 = terms.map(|(term, c)| c * term.nodes[i].acceleration).sum();
            self.nodes[i].acceleration - baseline
        });
        Self::new(self.step, samples.collect())
    }

    /// History whose acceleration is a Chebyshev polynomial over the record's duration.
    fn chebyshev(&self, order: usize) -> Result<Self, WaveError> {
        let last = (self.samples() - 1) as f64;
        let samples = (0..self.samples()).map(|i| {
            let x = 2.0 * i as f64 / last - 1.0;
            let (mut before, mut value) = (x, 1.0);
            for _ in 0..order {
                (before, value) = (value, 2.0 * x * value - before);
            }
            value
        });
        Self::new(self.step, samples.collect())
    }

    fn high_pass(&self, corner: f64, order: usize) -> Result<(Self, usize), WaveError> {
        check_order(order, 1, 8)?;
        let nyquist = 0.5 / self.step;
        ParameterError::check("corner", corner, 1e-6, nyquist)?;
        let pad = (1.5 * order as f64 / corner / self.step).ceil();
        let needed = 2.0 * (self.samples() as f64 + 2.0 * pad);
        WaveError::check_samples("a high-pass filter with its padding", needed, MOST_SAMPLES)?;
        let pad = pad as usize;
        let length = self.samples() + 2 * pad;
        let fourier = Fourier::new(2 * length);
        let mut samples = vec![0.0; fourier.len()];
        for (sample, node) in samples[pad..].iter_mut().zip(&self.nodes) {
            *sample = node.acceleration;
        }
        let mut spectrum = fourier.forward(&samples);
        let bin = 1.0 / (fourier.len() as f64 * self.step);
        for (i, value) in spectrum.iter_mut().enumerate() {
            let power = (i as f64 * bin / corner).powi(2 * order as i32);
            *value *= 1.0 / (1.0 + 1.0 / power);
        }
        let mut filtered = fourier.inverse(&spectrum);
        filtered.truncate(length);
        Ok((Self::new(self.step, filtered)?, pad))
    }
}

/// Quantity that a polynomial baseline is fitted to.
#[derive(Clone, Copy)]
enum Fit {
    Acceleration,
    Velocity,
    /// Velocity, under the constraints that end velocity and end displacement are zero.
    VelocityConstrained,
}

fn check_order(order: usize, least: usize, most: usize) -> Result<(), ParameterError> {
    ParameterError::check("order", order as f64, least as f64, most as f64)
}
