//! Waves in layers that share the tables of equal ones.

use std::sync::{Arc, Mutex, PoisonError, Weak};

use super::tables::LayeredTables;
use super::{LayeredWave, LayeredWaveParameters};
use crate::{InputConversion, Signal, SignalMotion, SignalSupport, WaveError};

/// Waves in layers that were made before and still exist: another one of the same parameters and signal shares their tables.
///
/// Copies of it know the same waves.
#[derive(Clone, Default)]
pub struct KnownLayeredWaves(Arc<Mutex<Vec<Known>>>);

/// A wave without its tables, which do not outlive it here.
struct Known {
    parameters: LayeredWaveParameters,
    of_signal: (SignalSupport, Vec<SignalMotion>),
    tables: Weak<LayeredTables>,
    base_time: f64,
    causal: bool,
    residue: f64,
    support: SignalSupport,
    conversion: InputConversion,
    name: String,
}

impl KnownLayeredWaves {
    /// Wave of the given parameters and signal, with the tables of a known one that is equal.
    ///
    /// # Errors
    /// As [`LayeredWave::new`].
    pub fn wave(
        &self,
        parameters: LayeredWaveParameters,
        signal: Arc<dyn Signal>,
    ) -> Result<LayeredWave, WaveError> {
        let support = signal.support();
        let count = ((support.end - support.start) / support.step).ceil() as usize;
        let instants = (0..=count + 1).map(|i| support.start + i as f64 * support.step);
        let of_signal = (support, instants.map(|time| signal.motion(time)).collect());
        let lock = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let mut known = lock();
        known.retain(|known| known.tables.strong_count() > 0);
        let equal = known
            .iter()
            .filter(|known| known.parameters == parameters && known.of_signal == of_signal)
            .find_map(|known| Some((known, known.tables.upgrade()?)));
        if let Some((known, tables)) = equal {
            return Ok(LayeredWave {
                parameters,
                tables,
                base_time: known.base_time,
                causal: known.causal,
                residue: known.residue,
                support: known.support,
                conversion: known.conversion,
                name: known.name.clone(),
            });
        }
        drop(known);
        let wave = LayeredWave::new(parameters.clone(), signal)?;
        lock().push(Known {
            parameters,
            of_signal,
            tables: Arc::downgrade(&wave.tables),
            base_time: wave.base_time,
            causal: wave.causal,
            residue: wave.residue,
            support: wave.support,
            conversion: wave.conversion,
            name: wave.name.clone(),
        });
        Ok(wave)
    }
}
