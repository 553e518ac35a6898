//! Sampling waves that are real multiples of their signal.

use powerhouse_model::{FieldMotion, FieldSampler, Vec3};
use std::sync::Arc;

use crate::Signal;
use crate::partial::PartialWave;

/// Points whose signals are fetched with one virtual call.
const BATCH: usize = 32;

/// The constants of one wave.
struct RealWave {
    polarisation: [f64; 3],
    stress: [f64; 6],
    /// One per point (s).
    delays: Vec<f64>,
}

/// Per point and wave: one delay, one look-up, twelve multiplications.
pub(crate) struct BodySampler {
    signal: Arc<dyn Signal>,
    waves: Vec<RealWave>,
    points: usize,
}

impl BodySampler {
    pub(crate) fn new(signal: Arc<dyn Signal>, waves: &[PartialWave], points: &[Vec3]) -> Self {
        let waves = waves.iter().map(|wave| RealWave {
            polarisation: wave.polarisation.map(|value| value.re),
            stress: wave.stress.map(|value| value.re),
            delays: points.iter().map(|point| wave.delay(point).re).collect(),
        });
        Self {
            signal,
            waves: waves.collect(),
            points: points.len(),
        }
    }
}

impl FieldSampler for BodySampler {
    fn len(&self) -> usize {
        self.points
    }

    fn add_motion(&self, time: f64, motion: &mut [FieldMotion]) {
        let mut times = [0.0; BATCH];
        let mut displacement = [0.0; BATCH];
        let mut velocity = [0.0; BATCH];
        let motion = &mut motion[..self.points];
        for (batch, motion) in motion.chunks_mut(BATCH).enumerate() {
            let count = motion.len();
            for wave in &self.waves {
                let delays = &wave.delays[batch * BATCH..][..count];
                for (local, delay) in times.iter_mut().zip(delays) {
                    *local = time - delay;
                }
                self.signal.sample(
                    &times[..count],
                    &mut displacement[..count],
                    &mut velocity[..count],
                );
                let signals = displacement.iter().zip(&velocity);
                for (motion, (d, v)) in motion.iter_mut().zip(signals) {
                    for i in 0..3 {
                        motion.displacement[i] += wave.polarisation[i] * d;
                        motion.velocity[i] += wave.polarisation[i] * v;
                    }
                    for i in 0..6 {
                        motion.stress.0[i] += wave.stress[i] * v;
                    }
                }
            }
        }
    }
}
