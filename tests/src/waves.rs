//! Incident fields.

use std::sync::Arc;

use powerhouse_model::{ElasticMedium, IncidentField, Vec3};
use powerhouse_wavefield::{
    Angle, PlaneWave, PlaneWaveParameters, SmoothPulse, Superposition, WaveKind, first_hit_corner,
};

/// Smooth pulses (amplitude 1 m, some duration in s) of the given kinds at the given degrees from
/// the vertical, all towards one azimuth (degrees), under a free surface at the top of a box of
/// `size` (m) at the origin. Each reaches the box at time zero.
///
/// # Panics
/// If a wave cannot be made.
pub fn oblique_waves(
    medium: ElasticMedium,
    size: Vec3,
    waves: &[(WaveKind, f64)],
    azimuth: f64,
    duration: f64,
) -> Superposition {
    let fields = waves.iter().map(|&(kind, incidence)| {
        let mut parameters = PlaneWaveParameters::vertical(kind, medium, size.z);
        parameters.incidence = Angle::from_degrees(incidence);
        parameters.azimuth = Angle::from_degrees(azimuth);
        let direction = parameters.direction();
        parameters.reference = first_hit_corner(&Vec3::zeros(), &size, &direction);
        let pulse = SmoothPulse::new(1.0, duration).expect("a pulse");
        let wave = PlaneWave::new(parameters, Arc::new(pulse)).expect("a plane wave");
        Box::new(wave) as Box<dyn IncidentField>
    });
    Superposition::new(fields.collect()).expect("waves in one medium")
}
