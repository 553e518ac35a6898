//! Discrete Fourier transforms of real samples, in powers of two.

use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use std::sync::Arc;

use crate::Complex;

/// Forward and inverse transform of one length: spectra of `exp(+i w t)`, from zero to the Nyquist
/// frequency.
pub(crate) struct Fourier {
    forward: Arc<dyn RealToComplex<f64>>,
    inverse: Arc<dyn ComplexToReal<f64>>,
}

impl Fourier {
    /// Transform of at least `least` samples: its length is the next power of two.
    pub(crate) fn new(least: usize) -> Self {
        let length = least.max(4).next_power_of_two();
        let mut planner = RealFftPlanner::new();
        Self {
            forward: planner.plan_fft_forward(length),
            inverse: planner.plan_fft_inverse(length),
        }
    }

    /// Number of samples.
    pub(crate) fn len(&self) -> usize {
        self.forward.len()
    }

    /// Spectrum `sum_k x_k exp(-2 pi i j k / n)` for j from 0 to n/2; missing samples are zero.
    pub(crate) fn forward(&self, samples: &[f64]) -> Vec<Complex> {
        let mut input = self.forward.make_input_vec();
        let mut output = self.forward.make_output_vec();
        let given = samples.len().min(input.len());
        input[..given].copy_from_slice(&samples[..given]);
        transformed(self.forward.process(&mut input, &mut output));
        output
    }

    /// Samples of a spectrum, scaled so that this is the inverse of
    /// [`forward`](Self::forward).
    pub(crate) fn inverse(&self, spectrum: &[Complex]) -> Vec<f64> {
        self.inverse_of(spectrum.iter().copied())
    }

    /// As [`inverse`](Self::inverse), of values one by one.
    pub(crate) fn inverse_of(&self, spectrum: impl Iterator<Item = Complex>) -> Vec<f64> {
        let mut input = self.inverse.make_input_vec();
        let mut output = self.inverse.make_output_vec();
        for (input, value) in input.iter_mut().zip(spectrum) {
            *input = value;
        }
        // Real samples have real values at both ends of the spectrum.
        let last = input.len() - 1;
        input[0].im = 0.0;
        input[last].im = 0.0;
        transformed(self.inverse.process(&mut input, &mut output));
        let scale = 1.0 / output.len() as f64;
        for value in &mut output {
            *value *= scale;
        }
        output
    }
}

/// Asserts that a transform succeeded: it fails only for arrays of wrong lengths, which the plan made.
fn transformed(result: Result<(), realfft::FftError>) {
    debug_assert!(result.is_ok(), "{result:?}");
}
