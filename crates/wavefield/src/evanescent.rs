//! Sampling waves with complex coefficients or decay with depth.

use powerhouse_model::{FieldMotion, FieldSampler, Vec3};

use crate::Complex;
use crate::analytic::{AnalyticSignal, AnalyticTables, Level};
use crate::partial::{PartialWave, Vectors};

/// Points of which all waves are evaluated before any motion is written.
const BATCH: usize = 32;

/// A wave that travels: the signal under one phase shift.
struct TravellingWave {
    vectors: Vectors,
    phase: Complex,
    /// One per point (s).
    delays: Vec<f64>,
}

/// A wave that decays with depth.
struct DecayingWave {
    polarisation: [Complex; 3],
    stress: [Complex; 6],
    /// Delay (s) and level of each point.
    arrivals: Vec<(f64, Level)>,
}

/// Per point and wave: one delay, one look-up in the table of the point's height.
///
/// All waves read the same tables, the incident one too: at the surface they then cancel to
/// rounding, whatever the tables' own error.
pub(crate) struct AnalyticSampler {
    signal: AnalyticSignal,
    surface: Level,
    travelling: Vec<TravellingWave>,
    decaying: Option<DecayingWave>,
    points: usize,
}

impl AnalyticSampler {
    pub(crate) fn new(tables: &AnalyticTables, waves: &[PartialWave], points: &[Vec3]) -> Self {
        let delays = |wave: &PartialWave| -> Vec<Complex> {
            points.iter().map(|point| wave.delay(point)).collect()
        };
        let decaying = waves.iter().find(|wave| wave.decays());
        let arrivals = decaying.map(delays).unwrap_or_default();
        // The first level is that of the waves that do not decay.
        let mut heights = vec![0.0];
        heights.extend(arrivals.iter().map(|delay| (-delay.im).max(0.0)));
        let (signal, levels) = tables.at(&heights);
        let arrivals = arrivals.iter().map(|delay| delay.re);
        let arrivals = arrivals.zip(levels[1..].iter().copied());
        let travelling = waves.iter().filter(|wave| !wave.decays()).map(|wave| {
            let (phase, vectors) = wave.phase_and_vectors();
            TravellingWave {
                vectors,
                phase,
                delays: delays(wave).iter().map(|delay| delay.re).collect(),
            }
        });
        Self {
            signal,
            surface: levels[0],
            travelling: travelling.collect(),
            decaying: decaying.map(|wave| DecayingWave {
                polarisation: wave.polarisation,
                stress: wave.stress,
                arrivals: arrivals.collect(),
            }),
            points: points.len(),
        }
    }

    fn add_travelling(&self, wave: &TravellingWave, time: f64, motion: &mut [FieldMotion]) {
        let mut signals = [(0.0, 0.0); BATCH];
        let batches = motion.chunks_mut(BATCH).zip(wave.delays.chunks(BATCH));
        let vectors = wave.vectors;
        for (motion, delays) in batches {
            for (signal, delay) in signals.iter_mut().zip(delays) {
                let (d, v) = self.signal.value(time - delay, &self.surface);
                *signal = (
                    wave.phase.re * d.re - wave.phase.im * d.im,
                    wave.phase.re * v.re - wave.phase.im * v.im,
                );
            }
            for (motion, signal) in motion.iter_mut().zip(&signals) {
                vectors.add(*signal, motion);
            }
        }
    }

    fn add_decaying(&self, wave: &DecayingWave, time: f64, motion: &mut [FieldMotion]) {
        let zero = Complex::new(0.0, 0.0);
        let mut signals = [(zero, zero); BATCH];
        let batches = motion.chunks_mut(BATCH).zip(wave.arrivals.chunks(BATCH));
        let (polarisation, stress) = (wave.polarisation, wave.stress);
        for (motion, arrivals) in batches {
            for (signal, (delay, level)) in signals.iter_mut().zip(arrivals) {
                *signal = self.signal.value(time - delay, level);
            }
            for (motion, (d, v)) in motion.iter_mut().zip(&signals) {
                for i in 0..3 {
                    let p = polarisation[i];
                    motion.displacement[i] += p.re * d.re - p.im * d.im;
                    motion.velocity[i] += p.re * v.re - p.im * v.im;
                }
                for i in 0..6 {
                    let s = stress[i];
                    motion.stress.0[i] += s.re * v.re - s.im * v.im;
                }
            }
        }
    }
}

impl FieldSampler for AnalyticSampler {
    fn len(&self) -> usize {
        self.points
    }

    fn add_motion(&self, time: f64, motion: &mut [FieldMotion]) {
        let motion = &mut motion[..self.points];
        for wave in &self.travelling {
            self.add_travelling(wave, time, motion);
        }
        if let Some(wave) = &self.decaying {
            self.add_decaying(wave, time, motion);
        }
    }
}
