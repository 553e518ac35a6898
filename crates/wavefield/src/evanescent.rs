//! Sampler of fields past the critical angle, with phase shifts and a wave that decays with depth.

use powerhouse_model::{FieldMotion, FieldSampler, Vec3};

use crate::Complex;
use crate::analytic::{AnalyticSignal, AnalyticTables, Level, ShiftedSignal};
use crate::partial::{PartialWave, Vectors};

/// Number of points of which all waves are evaluated before any motion is written.
const BATCH: usize = 32;

/// Constants of a travelling wave: the signal under one phase shift.
struct TravellingWave {
    vectors: Vectors,
    signal: ShiftedSignal,
    /// Delay of each point (s).
    delays: Vec<f64>,
}

/// Constants of an evanescent wave, which decays with depth.
struct DecayingWave {
    polarisation: [Complex; 3],
    stress: [Complex; 6],
    /// Delay (s) and level of each point.
    arrivals: Vec<(f64, Level)>,
}

/// Sampler of phase-shifted waves: per point and wave one delay and one look-up in the table of the
/// point's height.
///
/// All waves read tables of the same coefficients, the incident one too: at the surface they then
/// cancel to rounding, whatever the tables' own error.
pub(crate) struct AnalyticSampler {
    signal: AnalyticSignal,
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
                signal: signal.phase_shifted(phase, &levels[0]),
                delays: delays(wave).iter().map(|delay| delay.re).collect(),
            }
        });
        let travelling = travelling.collect();
        Self {
            signal,
            travelling,
            decaying: decaying.map(|wave| DecayingWave {
                polarisation: wave.polarisation,
                stress: wave.stress,
                arrivals: arrivals.collect(),
            }),
            points: points.len(),
        }
    }

    /// Adds the `N` travelling waves and the decaying one: signals of all waves first, then one pass
    /// over the motion.
    #[inline(always)]
    fn add_waves<const N: usize>(&self, time: f64, motion: &mut [FieldMotion]) {
        let mut travelling = [[(0.0, 0.0); BATCH]; N];
        let zero = Complex::new(0.0, 0.0);
        let mut decaying = [(zero, zero); BATCH];
        let vectors: [Vectors; N] = core::array::from_fn(|i| self.travelling[i].vectors);
        for (batch, motion) in motion.chunks_mut(BATCH).enumerate() {
            let range = batch * BATCH..batch * BATCH + motion.len();
            for (wave, signals) in self.travelling.iter().zip(&mut travelling) {
                for (signal, delay) in signals.iter_mut().zip(&wave.delays[range.clone()]) {
                    *signal = wave.signal.value(time - delay, &self.signal);
                }
            }
            if let Some(wave) = &self.decaying {
                for (signal, (delay, level)) in decaying.iter_mut().zip(&wave.arrivals[range]) {
                    *signal = self.signal.value(time - delay, level);
                }
            }
            for (k, motion) in motion.iter_mut().enumerate() {
                let mut sum = *motion;
                for (vectors, signals) in vectors.iter().zip(&travelling) {
                    vectors.add(signals[k], &mut sum);
                }
                if let Some(wave) = &self.decaying {
                    wave.add(decaying[k], &mut sum);
                }
                *motion = sum;
            }
        }
    }
}

impl DecayingWave {
    /// Adds the wave's motion for a complex displacement and velocity of its signal.
    #[inline(always)]
    fn add(&self, (d, v): (Complex, Complex), motion: &mut FieldMotion) {
        for i in 0..3 {
            let p = self.polarisation[i];
            motion.displacement[i] += p.re * d.re - p.im * d.im;
            motion.velocity[i] += p.re * v.re - p.im * v.im;
        }
        for i in 0..6 {
            let s = self.stress[i];
            motion.stress.0[i] += s.re * v.re - s.im * v.im;
        }
    }
}

impl FieldSampler for AnalyticSampler {
    fn len(&self) -> usize {
        self.points
    }

    fn add_motion(&self, time: f64, motion: &mut [FieldMotion]) {
        let motion = &mut motion[..self.points];
        match self.travelling.len() {
            0 => self.add_waves::<0>(time, motion),
            1 => self.add_waves::<1>(time, motion),
            2 => self.add_waves::<2>(time, motion),
            _ => self.add_waves::<3>(time, motion),
        }
    }
}
