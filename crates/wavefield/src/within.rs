//! Deconvolution of a motion at a depth in a half-space into the incident wave.

use powerhouse_model::ParameterError;
use std::f64::consts::PI;

use crate::sampled::{SampledSignal, SignalWindow};
use crate::signal::check_return;
use crate::{Complex, Signal, SurfaceComponent, SurfaceReflection, WaveError};

/// Quality of the regularised division of a within motion by its transfer function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WithinReport {
    /// Regularisation r, relative to the sum of the waves' magnitudes (1).
    pub regularisation: f64,
    /// Least magnitude of the transfer function (1) over the frequencies at which the record has at
    /// least 1 % of its peak spectrum.
    pub least_transfer: f64,
    /// Relative L2 misfit, in velocity, between the record and the motion at its depth under the
    /// incident wave that was found (1).
    pub misfit: f64,
    /// Peak displacement of the incident wave over that of the record (1).
    pub amplification: f64,
}

/// A record of one component of the motion within a half-space.
#[derive(Clone, Copy)]
pub(crate) struct WithinRecord {
    /// Depth below the free surface (m).
    pub(crate) depth: f64,
    pub(crate) component: SurfaceComponent,
    /// Regularisation of the division, relative to the sum of the waves' magnitudes, 1e-3 to 0.5.
    pub(crate) regularisation: f64,
}

/// Incident wave at the recording point, of which `signal` is the given component at a depth.
///
/// The incident wave precedes the record by the travel time to the surface and rings after it: it is
/// computed from two lengths of the record before to four lengths after, and faded out over the
/// outer tenths of that.
pub(crate) fn incident_of_within(
    signal: &dyn Signal,
    reflection: &SurfaceReflection,
    record: WithinRecord,
) -> Result<(SampledSignal, WithinReport), WaveError> {
    let WithinRecord {
        depth,
        component,
        regularisation,
    } = record;
    ParameterError::check("depth", depth, f64::MIN_POSITIVE, 1e9)?;
    ParameterError::check("regularisation", regularisation, 1e-3, 0.5)?;
    let transfer = Transfer::new(reflection, depth, component)?;
    incident_of(signal, &transfer, regularisation)
}

/// Motion of a record for unit incident amplitude, against frequency.
pub(crate) trait TransferFunction {
    /// Value at a frequency (Hz).
    fn value(&self, frequency: f64) -> Complex;
    /// Its size (1), of which the regularisation is a share.
    fn magnitude(&self) -> f64;
    /// Longest delay of a wave after the incident one (s).
    fn longest_delay(&self) -> f64;
}

/// Incident wave of which a signal is the motion by a transfer function, from a regularised division.
pub(crate) fn incident_of(
    signal: &dyn Signal,
    transfer: &dyn TransferFunction,
    regularisation: f64,
) -> Result<(SampledSignal, WithinReport), WaveError> {
    check_return(signal, "the motion within a half-space")?;
    let operation = "the division by the motion within a half-space";
    let mut window = SignalWindow::new(signal.support(), transfer.longest_delay(), operation)?;
    let filter = Filter::new(transfer, regularisation, &window);
    let samples = window.samples(signal);
    let spectra = samples.each_ref().map(|samples| window.spectrum(samples));
    let mut filtered = spectra.each_ref().map(|spectrum| {
        let values = spectrum.iter().zip(&filter.inverse);
        window.inverse(&values.map(|(s, f)| s * f).collect::<Vec<_>>())
    });
    window.fade(&mut filtered);

    let peak = |values: &[f64]| values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    let report = WithinReport {
        regularisation,
        least_transfer: filter.least_transfer(&spectra[1]),
        misfit: filter.misfit(&spectra[1]),
        amplification: match peak(&samples[0]) {
            0.0 => 0.0,
            before => peak(&filtered[0]) / before,
        },
    };
    let moving = moving(&filtered);
    let start = window.start() + moving.start as f64 * window.step();
    let samples = filtered.each_ref().map(|values| &values[moving.clone()]);
    let signal = SampledSignal::new(start, window.step(), samples);
    Ok((signal, report))
}

/// Samples between which histories are above a billionth of their peaks, with a margin; at least four of them. The window of the
/// transform is many times as long as a motion, and all that is computed from the signal takes its length.
fn moving(histories: &[Vec<f64>; 3]) -> core::ops::Range<usize> {
    const STILL: f64 = 1e-9;
    const MARGIN: usize = 8;
    let length = histories[0].len();
    let (mut first, mut last) = (length, 0);
    for values in histories {
        let limit = STILL * values.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        let is_moving = |value: &f64| value.abs() > limit;
        first = first.min(values.iter().position(is_moving).unwrap_or(length));
        last = last.max(values.iter().rposition(is_moving).unwrap_or(0));
    }
    let first = first
        .saturating_sub(MARGIN)
        .min(length.saturating_sub(MARGIN));
    first..(last + MARGIN).clamp(first + 4, length)
}

/// Transfer function: motion at a depth for unit incident amplitude at the same point.
struct Transfer {
    /// Amplitude of each wave, and its delay (s) after the incident one.
    waves: [(Complex, Complex); 3],
}

impl Transfer {
    fn new(
        reflection: &SurfaceReflection,
        depth: f64,
        component: SurfaceComponent,
    ) -> Result<Self, WaveError> {
        let [incident, same, converted] = reflection
            .polarisations()
            .map(|polarisation| polarisation[component.index()]);
        if [incident, same, converted].iter().all(|p| p.norm() < 1e-12) {
            return Err(WaveError::WeakComponent {
                kind: reflection.kind,
                component,
                coefficient: 0.0,
                limit: 1e-12,
            });
        }
        let rise = reflection.vertical_slowness;
        let zero = Complex::new(0.0, 0.0);
        Ok(Self {
            waves: [
                (incident, zero),
                (same, Complex::new(2.0 * rise * depth, 0.0)),
                (converted, (reflection.converted_slowness + rise) * depth),
            ],
        })
    }
}

impl TransferFunction for Transfer {
    fn value(&self, frequency: f64) -> Complex {
        let phase = Complex::new(0.0, -2.0 * PI * frequency);
        let terms = self.waves.iter();
        terms
            .map(|(wave, delay)| wave * (phase * delay).exp())
            .sum()
    }

    fn magnitude(&self) -> f64 {
        self.waves.iter().map(|(wave, _)| wave.norm()).sum()
    }

    fn longest_delay(&self) -> f64 {
        self.waves
            .iter()
            .map(|(_, delay)| delay.re)
            .fold(0.0, f64::max)
    }
}

/// Transfer function and its regularised inverse at the frequencies of a transform.
struct Filter {
    transfer: Vec<Complex>,
    inverse: Vec<Complex>,
}

impl Filter {
    fn new(transfer: &dyn TransferFunction, regularisation: f64, window: &SignalWindow) -> Self {
        let floor = (regularisation * transfer.magnitude()).powi(2);
        let (count, bin) = (window.count(), window.bin());
        let values = (0..=count / 2).map(|i| transfer.value(i as f64 * bin));
        let transfer: Vec<Complex> = values.collect();
        let inverse = transfer.iter().map(|h| h.conj() / (h.norm_sqr() + floor));
        Self {
            inverse: inverse.collect(),
            transfer,
        }
    }

    fn least_transfer(&self, spectrum: &[Complex]) -> f64 {
        let peak = spectrum.iter().map(|s| s.norm()).fold(0.0, f64::max);
        let strong = self.transfer.iter().zip(spectrum);
        let strong = strong.filter(|(_, s)| s.norm() >= 0.01 * peak);
        strong.map(|(h, _)| h.norm()).fold(f64::INFINITY, f64::min)
    }

    fn misfit(&self, spectrum: &[Complex]) -> f64 {
        let (mut missed, mut all) = (0.0, 0.0);
        for ((h, inverse), s) in self.transfer.iter().zip(&self.inverse).zip(spectrum) {
            missed += (s * (h * inverse - 1.0)).norm_sqr();
            all += s.norm_sqr();
        }
        if all > 0.0 {
            (missed / all).sqrt()
        } else {
            0.0
        }
    }
}
