//! Frequencies that the mesh resolves, and the frequency content of the input.

use powerhouse::model::{FieldMotion, Vec3};
use powerhouse::wavefield::TimeHistory;
use powerhouse::{Error, Resolution, Scene};

use crate::{StudyError, Warning};

/// Share of a motion's energy above the resolved frequency from which on a warning is due.
const LOST_SHARE: f64 = 0.01;
/// Instants at which the incident motion is sampled.
const INSTANTS: usize = 16_384;
/// Least duration of the taper after the run, over the duration of the run.
const FADING_SHARE: f64 = 0.05;
/// Least duration of the taper (s): a cut-off within a few periods would have energy at all frequencies.
const LEAST_FADING: f64 = 1.0;

/// Energy spectrum of acceleration: frequency (Hz) and energy of each line.
pub(crate) type Spectrum = Vec<(f64, f64)>;

/// Warnings of motion that parts do not resolve, and of a field without motion within the run.
pub(crate) fn warnings(
    scene: &Scene,
    resolution: &[Resolution],
) -> Result<Vec<Warning>, StudyError> {
    let mut motions: Vec<(String, Spectrum)> = Vec::new();
    let mut warnings = Vec::new();
    if let Some(spectrum) = incoming(scene)? {
        if spectrum.iter().all(|(_, energy)| *energy == 0.0) {
            let duration = scene.duration();
            warnings.push(Warning::StillField { duration });
        }
        motions.push(("the incident motion".into(), spectrum));
    } else {
        for (name, history) in scene.records() {
            let mut spectrum = Vec::new();
            add(&mut spectrum, history);
            motions.push((format!("record '{name}'"), spectrum));
        }
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

/// The spectrum of the incident field at the middle of the top of the mesh; `None` without a field.
pub(crate) fn incoming(scene: &Scene) -> Result<Option<Spectrum>, StudyError> {
    let Some(field) = scene.field() else {
        return Ok(None);
    };
    let (low, high) = scene.mesh().bounding_box();
    let middle = (low + high) / 2.0;
    let point = Vec3::new(middle.x, middle.y, high.z);
    // Of a field that is given at stations, that next to it.
    let distance = |station: &&Vec3| (**station - point).norm();
    let stations = field.stations().unwrap_or_default().iter();
    let nearest = stations.min_by(|a, b| distance(a).total_cmp(&distance(b)));
    let sampler = field
        .prepare(&[*nearest.unwrap_or(&point)])
        .map_err(Error::from)?;
    let run = scene.duration();
    let fading = LEAST_FADING.max(FADING_SHARE * run);
    let interval = (run + fading) / INSTANTS as f64;
    let velocities: Vec<Vec3> = (0..=INSTANTS)
        .map(|instant| {
            let mut motion = [FieldMotion::default()];
            let time = scene.start_time() + instant as f64 * interval;
            sampler.add_motion(time, &mut motion);
            motion[0].velocity
        })
        .collect();
    let within = (run / interval) as usize;
    if velocities[..=within].iter().all(|v| *v == Vec3::zeros()) {
        return Ok(Some(vec![(0.0, 0.0)]));
    }
    let mut spectrum = Vec::new();
    for axis in 0..3 {
        let accelerations = velocities.windows(2).enumerate().map(|(instant, pair)| {
            let taper = (instant as f64 * interval - run).max(0.0) / fading;
            let left = 0.5 * (1.0 + (core::f64::consts::PI * taper).cos());
            left * (pair[1][axis] - pair[0][axis]) / interval
        });
        let history = TimeHistory::new(interval, accelerations.collect());
        let history =
            history.map_err(|error| Error::from(powerhouse::model::ModelError::from(error)))?;
        add(&mut spectrum, &history);
    }
    Ok(Some(spectrum))
}

/// Adds the energy of a history's acceleration to a spectrum.
fn add(spectrum: &mut Spectrum, history: &TimeHistory) {
    let lines = history.fourier_spectrum();
    if spectrum.is_empty() {
        spectrum.extend(lines.iter().map(|line| (line.frequency, 0.0)));
    }
    for (sum, line) in spectrum.iter_mut().zip(lines) {
        sum.1 += line.amplitude * line.amplitude;
    }
}
