//! Incident fields.

use std::sync::Arc;

use powerhouse_model::{ElasticMedium, IncidentField, Vec3};
use powerhouse_wavefield::{
    Angle, PlaneWave, PlaneWaveParameters, SmoothPulse, Superposition, WaveKind, first_hit_corner,
};

/// Superposition of plane waves with smooth pulses (amplitude 1 m, duration in s), of given types and angles of
/// incidence and one azimuth (degrees), under a free surface at the top of a box of `size` (m) at the origin.
/// Each arrives at the box at time zero.
///
/// # Panics
/// For an invalid wave.
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
