//! Frequencies that the mesh resolves, and the frequency content of the input.

use powerhouse::{EnergySpectrum, Resolution, Scene};

use crate::{StudyError, Warning};

/// Share of a motion's energy above the resolved frequency from which on a warning is due.
const LOST_SHARE: f64 = 0.01;

/// Warnings of motion that parts do not resolve, and of a field without motion within the run.
pub(crate) fn warnings(
    scene: &Scene,
    resolution: &[Resolution],
) -> Result<Vec<Warning>, StudyError> {
    let mut motions: Vec<(String, EnergySpectrum)> = Vec::new();
    let mut warnings = Vec::new();
    if let Some(spectrum) = scene.incident_spectrum()? {
        if spectrum.iter().all(|(_, energy)| *energy == 0.0) {
            let duration = scene.duration();
            warnings.push(Warning::StillField { duration });
        }
        motions.push(("the incident motion".into(), spectrum));
    } else {
        let of_records = scene.record_spectra();
        motions.extend(of_records.map(|(name, spectrum)| (format!("record '{name}'"), spectrum)));
    }
    for (motion, spectrum) in motions {
        let energy_from = |from: f64| -> f64 {
            let lines = spectrum.iter().filter(|(frequency, _)| *frequency >= from);
            lines.map(|(_, energy)| energy).sum()
        };
        let whole = energy_from(0.0);
        for part in resolution.iter().filter(|_| whole > 0.0) {
            let share = energy_from(part.frequency) / whole;
            if share > LOST_SHARE {
                warnings.push(Warning::Unresolved {
                    motion: motion.clone(),
                    set: part.set.clone(),
                    share,
                    frequency: part.frequency,
                });
            }
        }
    }
    Ok(warnings)
}
