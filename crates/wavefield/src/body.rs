//! Sampler of fields below the critical angle, whose waves are real multiples of the signal.

use powerhouse_model::{FieldMotion, FieldSampler, Vec3};
use std::sync::Arc;

use crate::Signal;
use crate::partial::{PartialWave, Vectors};

/// Number of points per virtual call of the signal.
const BATCH: usize = 32;

/// Constants of one wave.
struct RealWave {
    vectors: Vectors,
    /// Delay of each point (s).
    delays: Vec<f64>,
}

/// Sampler of waves without phase shift: per point and wave one delay, one look-up and twelve
/// multiplications.
pub(crate) struct BodySampler {
    signal: Arc<dyn Signal>,
    waves: Vec<RealWave>,
    points: usize,
}

impl BodySampler {
    pub(crate) fn new(signal: Arc<dyn Signal>, waves: &[PartialWave], points: &[Vec3]) -> Self {
        let waves = waves.iter().map(|wave| RealWave {
            vectors: Vectors {
                polarisation: wave.polarisation.map(|value| value.re),
                stress: wave.stress.map(|value| value.re),
            },
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
        match self.waves.len() {
            1 => self.add_waves::<1>(time, motion),
            2 => self.add_waves::<2>(time, motion),
            _ => self.add_waves::<3>(time, motion),
        }
    }
}

impl BodySampler {
    /// Adds the `N` waves of the field: signals of all waves first, then one pass over the motion.
    #[inline(always)]
    fn add_waves<const N: usize>(&self, time: f64, motion: &mut [FieldMotion]) {
        let mut times = [0.0; BATCH];
        let mut signals = [[[0.0; BATCH]; 2]; N];
        let vectors: [Vectors; N] = core::array::from_fn(|i| self.waves[i].vectors);
        let motion = &mut motion[..self.points];
        for (batch, motion) in motion.chunks_mut(BATCH).enumerate() {
            let count = motion.len();
            for (wave, [displacement, velocity]) in self.waves.iter().zip(&mut signals) {
                let delays = &wave.delays[batch * BATCH..][..count];
                for (local, delay) in times.iter_mut().zip(delays) {
                    *local = time - delay;
                }
                self.signal.sample(&times[..count], displacement, velocity);
            }
            for (k, motion) in motion.iter_mut().enumerate() {
                let mut sum = *motion;
                for (vectors, [displacement, velocity]) in vectors.iter().zip(&signals) {
                    vectors.add((displacement[k], velocity[k]), &mut sum);
                }
                *motion = sum;
            }
        }
    }
}
