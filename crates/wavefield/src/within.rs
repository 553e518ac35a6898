//! Deconvolution of a motion at a depth in a half-space into the incident wave.

use powerhouse_model::ParameterError;
use std::f64::consts::PI;

use crate::fourier::Fourier;
use crate::sampled::{SampledSignal, SignalWindow, falling};
use crate::signal::check_return;
use crate::{Complex, Signal, SurfaceComponent, SurfaceReflection, WaveError};

/// Regularisation of a record at a depth unless another is given (1).
pub(crate) const WITHIN_REGULARISATION: f64 = 0.05;

/// Quality of the division of a within motion by its transfer function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WithinReport {
    /// Regularisation r, relative to the sum of the waves' magnitudes (1); zero for an exact division.
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
    /// Value at an angular frequency (1/s).
    fn value(&self, frequency: Complex) -> Complex;
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
    let window = SignalWindow::new(signal.support(), transfer.longest_delay(), operation)?;
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
        least_transfer: least_transfer(&filter.transfer, &spectra[1]),
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

/// Incident wave of which a signal is the motion by a transfer function, where that motion is made by a wave from below that
/// began before it by the longest delay at most: exact up to a time (s) after its start, by default four lengths of it, and
/// faded out then.
///
/// Under the weight `exp(-g t)` spectra are those at frequencies `w - i g`. There the transfer function of a causal motion whose
/// resonances decay, or last, vanishes nowhere, and what comes after the window comes back at its start as a share `exp(-24)`.
pub(crate) fn causal_incident_of(
    signal: &dyn Signal,
    transfer: &dyn TransferFunction,
    until: Option<f64>,
) -> Result<(SampledSignal, WithinReport), WaveError> {
    const DECAY: f64 = 24.0;
    const USED: f64 = 0.5;
    const MOST_SAMPLES: usize = 1 << 20;
    let operation = "the division by the motion within layers";
    check_return(signal, operation)?;
    let support = signal.support();
    let lead = transfer.longest_delay();
    let length = support.end - support.start + lead;
    let known = lead + until.unwrap_or(4.0 * length);
    let needed = known / (USED * support.step);
    WaveError::check_samples(operation, needed, MOST_SAMPLES)?;
    let fourier = Fourier::new(needed.ceil() as usize);
    let (count, step) = (fourier.len(), support.step);
    let before = (lead / step).ceil() as usize;
    let start = support.start - before as f64 * step;
    let growth = DECAY / (count as f64 * step);
    let weight = |sample: usize| (-growth * sample as f64 * step).exp();
    let weighted = |values: &[f64]| -> Vec<f64> {
        let values = values.iter().enumerate();
        values.map(|(i, value)| value * weight(i)).collect()
    };
    let bin = 2.0 * PI / (count as f64 * step);
    let at = |growth: f64| -> Vec<Complex> {
        let frequencies = (0..=count / 2).map(|i| Complex::new(i as f64 * bin, -growth));
        frequencies.map(|w| transfer.value(w)).collect()
    };
    let of_weighted = at(growth);
    let end = before + ((support.end - support.start) / step).ceil() as usize;
    let mut record = [(); 3].map(|()| vec![0.0; count]);
    for i in before..=end.min(count - 1) {
        let motion = signal.motion(start + i as f64 * step);
        record[0][i] = motion.displacement;
        record[1][i] = motion.velocity;
        record[2][i] = motion.acceleration;
    }
    let mut found = record.each_ref().map(|values| {
        let spectrum = fourier.forward(&weighted(values)).into_iter();
        let divided = spectrum.zip(&of_weighted).map(|(s, h)| s / h);
        let values = fourier.inverse_of(divided).into_iter().enumerate();
        values
            .map(|(i, value)| value / weight(i))
            .collect::<Vec<f64>>()
    });
    let last = (known / step).ceil() as usize;
    fade_out(&mut found, [last, last + count / 10], step);

    let spectrum = fourier.forward(&weighted(&found[1])).into_iter();
    let back = fourier.inverse_of(spectrum.zip(&of_weighted).map(|(s, h)| s * h));
    let (mut missed, mut all) = (0.0, 0.0);
    for i in before..last {
        missed += (back[i] / weight(i) - record[1][i]).powi(2);
        all += record[1][i].powi(2);
    }
    let peak = |values: &[f64]| values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    let over = |a: f64, b: f64| if b > 0.0 { a / b } else { 0.0 };
    let report = WithinReport {
        regularisation: 0.0,
        least_transfer: least_transfer(&at(0.0), &fourier.forward(&record[1])),
        misfit: over(missed, all).sqrt(),
        amplification: over(peak(&found[0]), peak(&record[0])),
    };
    let moving = moving(&found);
    let start = start + moving.start as f64 * step;
    let samples = found.each_ref().map(|values| &values[moving.clone()]);
    Ok((SampledSignal::new(start, step, samples), report))
}

/// Fades displacement, velocity and acceleration out between two samples, by the product rule.
fn fade_out(samples: &mut [Vec<f64>; 3], [from, to]: [usize; 2], step: f64) {
    let [displacement, velocity, acceleration] = samples;
    let rate = 1.0 / ((to - from) as f64 * step);
    for i in from..displacement.len() {
        let x = ((i - from) as f64 * step * rate).min(1.0);
        let [w, w1, w2] = falling(x, rate);
        let (d, v, a) = (displacement[i], velocity[i], acceleration[i]);
        displacement[i] = d * w;
        velocity[i] = v * w + d * w1;
        acceleration[i] = a * w + 2.0 * v * w1 + d * w2;
    }
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
    fn value(&self, frequency: Complex) -> Complex {
        let phase = Complex::new(frequency.im, -frequency.re);
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

/// Least magnitude of a transfer function where a spectrum is above a hundredth of its peak.
fn least_transfer(transfer: &[Complex], spectrum: &[Complex]) -> f64 {
    let peak = spectrum.iter().map(|s| s.norm()).fold(0.0, f64::max);
    let strong = transfer.iter().zip(spectrum);
    let strong = strong.filter(|(_, s)| s.norm() >= 0.01 * peak);
    strong.map(|(h, _)| h.norm()).fold(f64::INFINITY, f64::min)
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
        let frequencies = (0..=count / 2).map(|i| 2.0 * PI * i as f64 * bin);
        let values = frequencies.map(|w| transfer.value(Complex::new(w, 0.0)));
        let transfer: Vec<Complex> = values.collect();
        let inverse = transfer.iter().map(|h| h.conj() / (h.norm_sqr() + floor));
        Self {
            inverse: inverse.collect(),
            transfer,
        }
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
