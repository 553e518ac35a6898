//! Linear combinations of signals.

use std::sync::Arc;

use crate::{Signal, SignalMotion, SignalSupport};

/// Number of times that a combination samples at once.
const CHUNK: usize = 64;
/// Factor below which a part of a combination is left out: the rounding of sines and cosines.
const ROUNDING: f64 = 1e-12;

/// Sum of signals, each times a factor.
struct Combined {
    parts: Vec<(f64, Arc<dyn Signal>)>,
    support: SignalSupport,
}

/// Sum of signals, each times a factor; none if no signal with a factor is there.
pub(crate) fn combined(parts: &[(f64, &Option<Arc<dyn Signal>>)]) -> Option<Arc<dyn Signal>> {
    let parts = parts.iter().filter(|(factor, _)| factor.abs() > ROUNDING);
    let parts = parts.filter_map(|(factor, signal)| Some((*factor, (*signal).clone()?)));
    let parts: Vec<(f64, Arc<dyn Signal>)> = parts.collect();
    let supports = parts.iter().map(|(_, signal)| signal.support());
    let support = supports.reduce(SignalSupport::with)?;
    Some(match &parts[..] {
        [(1.0, signal)] => signal.clone(),
        _ => Arc::new(Combined { parts, support }),
    })
}

impl Signal for Combined {
    fn motion(&self, time: f64) -> SignalMotion {
        let mut sum = SignalMotion::default();
        for (factor, signal) in &self.parts {
            let motion = signal.motion(time);
            sum.displacement += factor * motion.displacement;
            sum.velocity += factor * motion.velocity;
            sum.acceleration += factor * motion.acceleration;
        }
        sum
    }
    fn support(&self) -> SignalSupport {
        self.support
    }
    fn sample(&self, times: &[f64], displacement: &mut [f64], velocity: &mut [f64]) {
        let outputs = displacement
            .chunks_mut(CHUNK)
            .zip(velocity.chunks_mut(CHUNK));
        for (times, (displacement, velocity)) in times.chunks(CHUNK).zip(outputs) {
            let count = times.len();
            let (displacement, velocity) = (&mut displacement[..count], &mut velocity[..count]);
            displacement.fill(0.0);
            velocity.fill(0.0);
            let mut own = [[0.0; CHUNK]; 2];
            let [d, v] = &mut own;
            for (factor, signal) in &self.parts {
                signal.sample(times, &mut d[..count], &mut v[..count]);
                for i in 0..count {
                    displacement[i] += factor * d[i];
                    velocity[i] += factor * v[i];
                }
            }
        }
    }
}
