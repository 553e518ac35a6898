//! Points of many heights in layered ground, as of meshes of tetrahedra.

use powerhouse_model::{ElasticMedium, FieldMotion, IncidentField, Vec3};
use powerhouse_wavefield::{
    Angle, Ground, GroundLayer, LayerDamping, LayerMechanism, LayeredWave, LayeredWaveParameters,
    Ricker, RickerQuantity, WaveKind,
};
use std::sync::Arc;

/// Medium of a density (kg/m3) and of wave speeds (m/s).
fn medium(density: f64, cs: f64, cp: f64) -> ElasticMedium {
    let (shear, constrained) = (density * cs * cs, density * cp * cp);
    let lambda = constrained - 2.0 * shear;
    let poisson = lambda / (2.0 * (lambda + shear));
    ElasticMedium::new(2.0 * shear * (1.0 + poisson), poisson, density).unwrap()
}

/// Two layers over rock, the lower one 12 or 90 m thick.
fn ground(bottom: f64, damping: &LayerDamping) -> Ground {
    let layers = vec![
        GroundLayer::new(-20.0, medium(1800.0, 200.0, 500.0)).with_damping(damping.clone()),
        GroundLayer::new(bottom, medium(2000.0, 400.0, 1000.0)).with_damping(damping.clone()),
    ];
    Ground::new(0.0, layers, medium(2300.0, 900.0, 2000.0)).unwrap()
}

/// Largest differences of displacement, velocity and stress at every fifth of some points over their peaks, if all are asked for
/// at once and if these are asked for alone: so few heights have tables of their own.
fn difference(wave: &LayeredWave, points: &[Vec3], times: &[f64]) -> [f64; 3] {
    let together = wave.prepare(points).unwrap();
    assert_eq!(together.len(), points.len());
    let some: Vec<Vec3> = points.iter().copied().step_by(5).collect();
    let alone = wave.prepare(&some).unwrap();
    let (mut worst, mut peaks) = ([0.0_f64; 3], [0.0_f64; 3]);
    for &time in times {
        let mut found = vec![FieldMotion::default(); points.len()];
        together.add_motion(time, &mut found);
        let mut expected = vec![FieldMotion::default(); some.len()];
        alone.add_motion(time, &mut expected);
        for (found, expected) in found.iter().step_by(5).zip(&expected) {
            let stress = |motion: &FieldMotion| nalgebra::Vector6::from(motion.stress.0);
            let pairs = [
                (
                    (found.displacement - expected.displacement).norm(),
                    expected.displacement.norm(),
                ),
                (
                    (found.velocity - expected.velocity).norm(),
                    expected.velocity.norm(),
                ),
                (
                    (stress(found) - stress(expected)).norm(),
                    stress(expected).norm(),
                ),
            ];
            for (k, (off, size)) in pairs.into_iter().enumerate() {
                worst[k] = worst[k].max(off);
                peaks[k] = peaks[k].max(size);
            }
        }
    }
    core::array::from_fn(|k| worst[k] / peaks[k])
}

/// The motion of more heights than there are tables for is that of tables at each height to 1e-4 of the peak displacement and
/// 1e-3 of velocity and stress, for all waves, past the critical angle, in damped layers and down into the half-space; the
/// report states number and error.
#[test]
fn many_heights_are_interpolated() {
    let flat = LayerDamping::Flat {
        mechanisms: vec![LayerMechanism {
            frequency: 3.0,
            weight: 0.08,
        }],
        velocity: 1.02,
    };
    let mut all = [0.0_f64; 3];
    for (kind, degrees, bottom, damping) in [
        (WaveKind::SV, 15.0, -32.0, LayerDamping::None),
        (WaveKind::SV, 40.0, -110.0, LayerDamping::None),
        (WaveKind::P, 30.0, -110.0, flat.clone()),
        (WaveKind::SH, 50.0, -32.0, flat),
    ] {
        let mut parameters =
            LayeredWaveParameters::vertical(kind, ground(bottom, &damping), bottom - 25.0);
        parameters.incidence = Angle::from_degrees(degrees);
        parameters.azimuth = Angle::from_degrees(20.0);
        parameters.until = Some(3.0);
        let ricker = Ricker::new(RickerQuantity::Displacement, 0.01, 4.0, 0.5).unwrap();
        let wave = LayeredWave::new(parameters, Arc::new(ricker)).unwrap();
        // Heights without any order, the surface, the interfaces and the lowest among them.
        let depth = 25.0 - bottom;
        let mut points: Vec<Vec3> = (0..1100_u32)
            .map(|i| {
                let share = (f64::from(i) * 0.618_033_988_7).fract();
                Vec3::new(f64::from(i % 37), f64::from(i % 11), -depth * share)
            })
            .collect();
        for (point, z) in points
            .iter_mut()
            .step_by(5)
            .zip([0.0, -20.0, bottom, bottom - 25.0])
        {
            point.z = z;
        }
        let times: Vec<f64> = (0..60).map(|i| 0.05 * f64::from(i)).collect();
        let off = difference(&wave, &points, &times);
        let (heights, measured) = wave.report().tables.between_heights.unwrap();
        let [reported, found] = [measured, off].map(|of| of.map(|value| format!("{value:.1e}")));
        println!("{kind} {degrees}: {heights} heights, reported {reported:?}, found {found:?}");
        assert!((20..700).contains(&heights), "{heights}");
        for ((off, measured), most) in off.into_iter().zip(measured).zip([1e-4, 1e-3, 1e-3]) {
            // At half of the distance a sixteenth of the reported error.
            assert!(
                measured <= most && off <= 0.25 * measured,
                "{off} {measured} {most}"
            );
        }
        for (all, off) in all.iter_mut().zip(off) {
            *all = all.max(off);
        }
    }
    let [u, v, s] = all;
    println!("figure many_heights {u:.1e} {v:.1e} {s:.1e}");
}
