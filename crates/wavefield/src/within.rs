//! Deconvolution of a motion at a depth in a half-space into the incident wave.

use powerhouse_model::ParameterError;
use std::f64::consts::PI;

use crate::fourier::Fourier;
use crate::hermite::Quintic;
use crate::signal::check_return;
use crate::{
    Complex, Signal, SignalMotion, SignalSupport, SurfaceComponent, SurfaceReflection, WaveError,
};

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

/// Signal given by samples with quintic interpolation.
pub(crate) struct SampledSignal {
    start: f64,
    step: f64,
    per_step: f64,
    intervals: Vec<Quintic<f64>>,
}

impl Signal for SampledSignal {
    fn motion(&self, time: f64) -> SignalMotion {
        let position = (time - self.start) * self.per_step;
        if position >= 0.0 && position < self.intervals.len() as f64 {
            let index = position as usize;
            let local = position - index as f64;
            let (displacement, velocity) = self.intervals[index].real_value(local);
            let curvature = self.intervals[index].second_derivative(local);
            return SignalMotion {
                displacement,
                velocity: velocity * self.per_step,
                acceleration: curvature * self.per_step * self.per_step,
            };
        }
        SignalMotion::default()
    }
    fn support(&self) -> SignalSupport {
        SignalSupport {
            start: self.start,
            end: self.start + self.step * self.intervals.len() as f64,
            step: self.step,
        }
    }
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
    const MOST_SAMPLES: usize = 1 << 20;
    let support = signal.support();
    let step = support.step;
    check_return(signal, "the motion within a half-space")?;
    // The longest travel time to the surface and back is part of the length.
    let length = support.end - support.start + transfer.longest_delay();
    let needed = 8.0 * length / step;
    WaveError::check_samples(
        "the division by the motion within a half-space",
        needed,
        MOST_SAMPLES,
    )?;
    let mut fourier = Fourier::new(needed.ceil() as usize);
    let count = fourier.len();
    let filter = Filter::new(transfer, regularisation, count, step);

    let quarter = count / 4;
    let mut samples = [(); 3].map(|()| vec![0.0; count]);
    for i in 0..count - quarter {
        let time = support.start + i as f64 * step;
        if time > support.end {
            break;
        }
        let motion = signal.motion(time);
        samples[0][quarter + i] = motion.displacement;
        samples[1][quarter + i] = motion.velocity;
        samples[2][quarter + i] = motion.acceleration;
    }
    let spectra = samples.each_ref().map(|samples| fourier.forward(samples));
    let mut filtered = spectra.each_ref().map(|spectrum| {
        let values = spectrum.iter().zip(&filter.inverse);
        fourier.inverse(&values.map(|(s, f)| s * f).collect::<Vec<_>>())
    });
    fade(&mut filtered, step);

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
    let node = |i: usize| filtered.each_ref().map(|values| values[i]);
    let intervals = (0..count - 1).map(|i| Quintic::new(node(i), node(i + 1), step));
    let signal = SampledSignal {
        start: support.start - quarter as f64 * step,
        step,
        per_step: 1.0 / step,
        intervals: intervals.collect(),
    };
    Ok((signal, report))
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
    fn new(transfer: &dyn TransferFunction, regularisation: f64, count: usize, step: f64) -> Self {
        let floor = (regularisation * transfer.magnitude()).powi(2);
        let bin = 1.0 / (count as f64 * step);
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

/// Fades displacement, velocity and acceleration at both ends, by the product rule.
fn fade([displacement, velocity, acceleration]: &mut [Vec<f64>; 3], step: f64) {
    let count = displacement.len();
    let width = (count / 10) as f64;
    for i in 0..count {
        let from_end = i.min(count - 1 - i) as f64;
        if from_end >= width {
            continue;
        }
        let sign = if 2 * i < count { 1.0 } else { -1.0 };
        let x = from_end / width;
        let rate = sign / (width * step);
        // 10 x^3 - 15 x^4 + 6 x^5 rises from 0 to 1 with two derivatives zero at both ends.
        let w = x * x * x * (10.0 + x * (6.0 * x - 15.0));
        let w1 = rate * 30.0 * x * x * (1.0 - x) * (1.0 - x);
        let w2 = rate * rate * 60.0 * x * (1.0 - x) * (1.0 - 2.0 * x);
        let (d, v, a) = (displacement[i], velocity[i], acceleration[i]);
        displacement[i] = d * w;
        velocity[i] = v * w + d * w1;
        acceleration[i] = a * w + 2.0 * v * w1 + d * w2;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A faded motion is consistent: velocity and acceleration are the derivatives of displacement
    /// and velocity, and the ends are at rest.
    #[test]
    fn a_faded_motion_is_a_motion() {
        let (count, step) = (2000, 0.01);
        let time = |i: usize| step * i as f64;
        let mut motion = [
            (0..count).map(|i| 1.0 + 1e-3 * time(i).powi(2)).collect(),
            (0..count).map(|i| 2e-3 * time(i)).collect(),
            vec![2e-3; count],
        ];
        fade(&mut motion, step);
        let [displacement, velocity, acceleration] = motion;
        for end in [0, count - 1] {
            assert_eq!((displacement[end], velocity[end]), (0.0, 0.0));
        }
        for i in 1..count - 1 {
            let slope = |values: &[f64]| (values[i + 1] - values[i - 1]) / (2.0 * step);
            // The faded ends are 200 steps long; there the third derivative reaches, and where
            // they end it jumps by, 60 / (200 step)^3 of at most 1.4. Differences miss step^2 / 6
            // of the one in velocity, and step / 4 of the other in acceleration.
            assert!((velocity[i] - slope(&displacement)).abs() < 2e-4, "{i}");
            assert!((acceleration[i] - slope(&velocity)).abs() < 0.03, "{i}");
        }
    }
}
