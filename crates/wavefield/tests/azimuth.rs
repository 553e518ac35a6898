//! Amplitudes of the free field at any azimuth.

use std::f64::consts::TAU;
use std::path::Path;
use std::sync::Arc;

use powerhouse_model::{ElasticMedium, FieldMotion, IncidentField, Vec3};
use powerhouse_wavefield::{
    Angle, PlaneWave, PlaneWaveParameters, Signal, SignalMotion, SignalSupport, WaveKind,
};

/// A cosine or sine of 4 Hz without end.
#[derive(Debug)]
struct Steady {
    phase: f64,
}

impl Signal for Steady {
    fn motion(&self, time: f64) -> SignalMotion {
        let rate = TAU * 4.0;
        let (sine, cosine) = (rate * time + self.phase).sin_cos();
        SignalMotion {
            displacement: cosine,
            velocity: -rate * sine,
            acceleration: -rate * rate * cosine,
        }
    }
    fn support(&self) -> SignalSupport {
        SignalSupport {
            start: -100.0,
            end: 100.0,
            step: 0.01,
        }
    }
}

/// Displacement amplitudes of P, SV and SH waves with their reflections at several depths are those of the table to 1e-9, and the
/// slowness along y is its own.
#[test]
fn amplitudes_are_those_of_the_table() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/reference");
    let text = std::fs::read_to_string(root.join("free_field_azimuth.csv")).unwrap();
    let rows = text.lines().filter(|line| !line.starts_with(['#', 'k']));
    let mut count = 0;
    for row in rows {
        let words: Vec<&str> = row.split(',').collect();
        let numbers: Vec<f64> = words[1..].iter().map(|x| x.parse().unwrap()).collect();
        let [incidence, azimuth, z, slowness] = numbers[..4] else {
            panic!("{row}");
        };
        let kind = match words[0] {
            "p" => WaveKind::P,
            "sv" => WaveKind::SV,
            _ => WaveKind::SH,
        };
        let medium = ElasticMedium::new(9.0e9, 0.27, 2700.0).unwrap();
        let mut parameters = PlaneWaveParameters::vertical(kind, medium, 0.0);
        parameters.incidence = Angle::from_degrees(incidence);
        parameters.azimuth = Angle::from_degrees(azimuth);
        let own = parameters.slowness().y;
        assert!((own - slowness).abs() <= 1e-9 * slowness, "{row}: {own:e}");
        // At time zero the cosine has the real part, and the cosine a quarter of a period later less the imaginary one.
        let parts = [0.0, -TAU / 4.0].map(|phase| {
            let wave = PlaneWave::new(parameters, Arc::new(Steady { phase })).unwrap();
            let sampler = wave.prepare(&[Vec3::new(30.0, 20.0, z)]).unwrap();
            let mut motion = [FieldMotion::default()];
            sampler.add_motion(0.0, &mut motion);
            motion[0].displacement
        });
        for c in 0..3 {
            for (part, found) in parts.iter().enumerate() {
                let expected = numbers[4 + 2 * c + part];
                let error = (found[c] - expected).abs();
                assert!(error < 1e-9, "{row}: {c} {part} {}", found[c]);
            }
        }
        count += 1;
    }
    assert!(count > 20, "{count} rows");
}
