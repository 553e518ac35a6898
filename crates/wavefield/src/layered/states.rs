//! States at many depths of one layer, at all frequencies of a transform.
//!
//! What does not depend on the depth is computed once for all depths. A wave that has travelled a distance d has the factor
//! `exp(-i phase d)`, `phase = w s`; that of the next frequency is its product with `exp(-i change d)`, whose exponent is small:
//! a short series in place of exponential, sine and cosine. Every so many frequencies factors are computed anew.

use super::stack::{Amplitudes, Stack, WAVES, ZERO, propagated};
use crate::Complex;

/// Number of frequencies over which factors are multiplied.
const MULTIPLIED: usize = 64;
/// Largest exponent (1) of which the series is taken; its first missing term is 4e-17 then.
const SMALL: f64 = 1.0 / 16.0;
/// Quotients of the terms of the series, from the last to the first.
const QUOTIENTS: [f64; 8] = [
    1.0 / 8.0,
    1.0 / 7.0,
    1.0 / 6.0,
    1.0 / 5.0,
    1.0 / 4.0,
    1.0 / 3.0,
    1.0 / 2.0,
    1.0,
];

/// Spectra of the state at some depths (m) below the top of a layer: for each depth its displacements and tractions over `i w`,
/// of a unit incident displacement at the top of the half-space.
///
/// `amplitudes` are those of all layers, frequency after frequency (1/s).
pub(crate) fn spectra(
    stack: &Stack,
    (index, depths): (usize, &[f64]),
    frequencies: &[Complex],
    amplitudes: &[Amplitudes],
) -> Vec<[Vec<Complex>; 4]> {
    let layers = stack.count() + 1;
    let (count, rows) = (2 * stack.order, 2 * stack.order);
    let empty =
        || core::array::from_fn(|row| vec![ZERO; if row < rows { frequencies.len() } else { 0 }]);
    let mut spectra: Vec<[Vec<Complex>; 4]> = depths.iter().map(|_| empty()).collect();
    let mut waves = Vec::with_capacity(MULTIPLIED);
    for first in (0..frequencies.len()).step_by(MULTIPLIED) {
        let last = frequencies.len().min(first + MULTIPLIED);
        waves.clear();
        waves
            .extend((first..last).map(|bin| {
                stack.waves(index, frequencies[bin], &amplitudes[bin * layers + index])
            }));
        for (depth, spectrum) in depths.iter().zip(&mut spectra) {
            let distances = stack.distances((index, *depth));
            let mut factors: [Factor; WAVES] =
                core::array::from_fn(|wave| Factor::new(waves[0][wave].phase, distances[wave]));
            for (bin, waves) in (first..last).zip(&waves) {
                let mut state = [ZERO; 4];
                for (wave, factor) in waves.iter().zip(&mut factors).take(count) {
                    let factor = factor.follow(wave.phase);
                    for (value, share) in state.iter_mut().zip(&wave.state) {
                        *value += share * factor;
                    }
                }
                for (spectrum, value) in spectrum.iter_mut().zip(state).take(rows) {
                    spectrum[bin] = value;
                }
            }
        }
    }
    spectra
}

/// Factor of a wave after a distance (m), followed from phase to phase (1/m).
struct Factor {
    distance: f64,
    phase: Complex,
    value: Complex,
}

impl Factor {
    fn new(phase: Complex, distance: f64) -> Self {
        Self {
            distance,
            phase,
            value: propagated(phase * distance),
        }
    }

    /// The factor of the next phase.
    #[inline(always)]
    fn follow(&mut self, phase: Complex) -> Complex {
        let change = (phase - self.phase) * self.distance;
        self.value = if change.re.abs() + change.im.abs() <= SMALL {
            self.value * series(Complex::new(change.im, -change.re))
        } else {
            propagated(phase * self.distance)
        };
        self.phase = phase;
        self.value
    }
}

/// Exponential of a small number.
#[inline(always)]
fn series(exponent: Complex) -> Complex {
    let one = Complex::new(1.0, 0.0);
    let sum = QUOTIENTS.iter();
    sum.fold(one, |sum, quotient| one + sum * exponent * *quotient)
}
