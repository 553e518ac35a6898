//! Sampling waves with complex coefficients or decay with depth.

use powerhouse_model::{FieldMotion, FieldSampler, Vec3};

use crate::analytic::{AnalyticSignal, Level, StartTaper};
use crate::partial::PartialWave;
use crate::{Complex, Signal, WaveError};

/// The constants of one wave.
struct ComplexWave {
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
    waves: Vec<ComplexWave>,
    points: usize,
}

impl AnalyticSampler {
    pub(crate) fn new(
        signal: &dyn Signal,
        taper: Option<StartTaper>,
        waves: &[PartialWave],
        points: &[Vec3],
    ) -> Result<Self, WaveError> {
        let delays = waves.iter().flat_map(|wave| {
            let delays = points.iter().map(|point| wave.delay(point));
            delays.map(|delay| (delay.re, (-delay.im).max(0.0)))
        });
        let delays: Vec<(f64, f64)> = delays.collect();
        let heights: Vec<f64> = delays.iter().map(|(_, height)| *height).collect();
        let (signal, levels) = AnalyticSignal::new(signal, &heights, taper)?;
        let arrivals = delays.iter().zip(levels);
        let mut arrivals = arrivals.map(|((delay, _), level)| (*delay, level));
        let waves = waves.iter().map(|wave| ComplexWave {
            polarisation: wave.polarisation,
            stress: wave.stress,
            arrivals: arrivals.by_ref().take(points.len()).collect(),
        });
        Ok(Self {
            signal,
            waves: waves.collect(),
            points: points.len(),
        })
    }
}

impl FieldSampler for AnalyticSampler {
    fn len(&self) -> usize {
        self.points
    }

    fn add_motion(&self, time: f64, motion: &mut [FieldMotion]) {
        let motion = &mut motion[..self.points];
        for wave in &self.waves {
            for (motion, (delay, level)) in motion.iter_mut().zip(&wave.arrivals) {
                let (d, v) = self.signal.value(time - delay, level);
                for i in 0..3 {
                    let p = wave.polarisation[i];
                    motion.displacement[i] += p.re * d.re - p.im * d.im;
                    motion.velocity[i] += p.re * v.re - p.im * v.im;
                }
                for i in 0..6 {
                    let s = wave.stress[i];
                    motion.stress.0[i] += s.re * v.re - s.im * v.im;
                }
            }
        }
    }
}
