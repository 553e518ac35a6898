//! Plane waves under a free surface and in a full space.

use crate::support::{SURFACE, motion, parameters, residuals, rock, size, wave};
use powerhouse_model::{ElasticMedium, IncidentField, Vec3};
use powerhouse_wavefield::{
    Angle, PlaneWave, PlaneWaveParameters, Ricker, RickerQuantity, Signal, Site, SmoothPulse,
    Superposition, WaveError, WaveKind, critical_angle,
};
use std::sync::Arc;

fn ricker() -> Arc<dyn Signal> {
    Arc::new(Ricker::new(RickerQuantity::Displacement, 1e-3, 3.0, 0.6).unwrap())
}

const KINDS: [WaveKind; 3] = [WaveKind::P, WaveKind::SV, WaveKind::SH];

/// The traction on the free surface is below 1e-12 of the incident stress, at every angle in half
/// degrees, for every Poisson's ratio, wave and azimuth, below and past the critical angle.
#[test]
fn the_surface_is_free_of_traction() {
    let point = Vec3::new(41.0, -17.0, SURFACE);
    let mut worst = 0.0f64;
    for poisson in [0.0, 0.1, 0.2, 0.27, 0.3456, 0.4, 0.45, 0.49] {
        for kind in KINDS {
            for half_degrees in 0..=178 {
                let degrees = 0.5 * half_degrees as f64;
                let azimuth = 37.0 * half_degrees as f64;
                let field = wave(kind, poisson, degrees, azimuth, ricker());
                let incident = field.incident_part().unwrap();
                let (free, incident) = (
                    field.prepare(&[point]).unwrap(),
                    incident.prepare(&[point]).unwrap(),
                );
                let peak_time = 0.6 + arrival(&field, point);
                let (mut traction, mut stress) = (0.0f64, 0.0f64);
                for i in -10..=10 {
                    let time = peak_time + 0.03 * i as f64;
                    let mut motion = [Default::default(); 2];
                    free.add_motion(time, &mut motion[..1]);
                    incident.add_motion(time, &mut motion[1..]);
                    traction = traction.max(motion[0].stress.traction(&Vec3::z()).amax());
                    stress = stress.max(size(&motion[1].stress.0));
                }
                assert!(stress > 0.0);
                worst = worst.max(traction / stress);
                assert!(
                    traction < 1e-12 * stress,
                    "{kind} nu {poisson} at {degrees}: {:e}",
                    traction / stress
                );
            }
        }
    }
    println!("figure wavefield.surface_traction {worst:e}");
}

/// Time of the signal's zero at a point, from the parameters alone.
fn arrival(field: &PlaneWave, point: Vec3) -> f64 {
    let parameters = field.parameters();
    let speed = parameters.kind.speed(&parameters.medium);
    (point - parameters.reference).dot(&parameters.direction()) / speed
}

/// The verification example of the method's source at 15 degrees: motion of the surface's centre
/// in amplitude and delay.
#[test]
fn the_surface_moves_as_the_closed_form_says() {
    let medium = ElasticMedium::new(10e9, 0.3, 3000.0).unwrap();
    for (kind, amplitudes, delay) in [
        (WaveKind::SV, [1.9207186, -0.5369212], 1.160849),
        (WaveKind::P, [0.5491206, 1.9271751], 0.620500),
    ] {
        let mut parameters = PlaneWaveParameters::vertical(kind, medium, 1200.0);
        parameters.incidence = Angle::from_degrees(15.0);
        let pulse = SmoothPulse::new(1.0, 0.8).unwrap();
        let field = PlaneWave::new(parameters, Arc::new(pulse)).unwrap();
        for i in 0..40 {
            let local = 0.025 * i as f64;
            let found = motion(&field, Vec3::new(600.0, 600.0, 1200.0), delay + local);
            let expected = pulse.motion(local);
            // Delays are given to 5e-7 s, amplitudes to 5e-8; the pulse moves at most 5 m/s.
            for (i, amplitude) in [(0, amplitudes[0]), (2, amplitudes[1])] {
                assert!(
                    (found.displacement[i] - amplitude * expected.displacement).abs() < 6e-6,
                    "{kind} {local} {i}"
                );
            }
        }
    }
}

/// Each wave arrives inside at the time and with the vector that follow from the geometry of its ray.
#[test]
fn every_reflection_arrives_along_its_own_ray() {
    let (depth, degrees, poisson) = (400.0, 20.0f64, 0.25);
    let medium = rock(poisson);
    let (cp, cs) = (medium.p_speed(), medium.s_speed());
    let pulse = SmoothPulse::new(1.0, 0.02).unwrap();
    let field = wave(WaveKind::SV, poisson, degrees, 0.0, Arc::new(pulse));
    let reference = field.parameters().reference;
    let point = Vec3::new(reference.x, reference.y, SURFACE - depth);
    let (a, b) = (
        degrees.to_radians(),
        (cp / cs * degrees.to_radians().sin()).asin(),
    );
    let up = depth + SURFACE - reference.z - depth;
    // Where a reflected ray that reaches the point leaves the surface, and when.
    let surface_time = |back: f64| (-back * a.sin() + up * a.cos()) / cs;
    let sv = surface_time(depth * a.tan()) + depth / a.cos() / cs;
    let p = surface_time(depth * b.tan()) + depth / b.cos() / cp;
    // Table: nu 0.25, SV at 20 degrees.
    let (b1, b2) = (-0.4831095569, 0.7184989475);
    for (time, expected) in [
        (sv, Vec3::new(-a.cos(), 0.0, -a.sin()) * b1),
        (p, Vec3::new(b.sin(), 0.0, -b.cos()) * b2),
    ] {
        let found = motion(&field, point, time + 0.01).displacement;
        assert!((found - expected).norm() < 1e-8, "{found} {expected}");
    }
}

/// The field satisfies the equation of motion, and its stress is the elastic stress of its
/// displacement, for all waves, oblique in both angles.
#[test]
fn the_field_is_elastic_and_in_motion() {
    let point = Vec3::new(20.0, 11.0, -60.0);
    for kind in KINDS {
        for degrees in [0.0, 17.0, 30.0] {
            let field = wave(kind, 0.27, degrees, 37.0, ricker());
            let time = arrival(&field, point) + 0.57;
            // Four points to the fourth order: (k h)^4 / 30 with k h = 0.02 is 5e-9.
            let (motion, stress) = residuals(&field, point, time, 1.0);
            assert!(
                motion < 1e-6 && stress < 1e-6,
                "{kind} {degrees} {motion:e} {stress:e}"
            );
        }
    }
}

/// Turning the azimuth turns the whole field about the vertical.
#[test]
fn azimuth_turns_the_field() {
    let reference = Vec3::new(-80.0, 30.0, -150.0);
    let offset = Vec3::new(50.0, 20.0, 100.0);
    let angle = 1.1f64;
    let rotation = nalgebra::Rotation3::from_axis_angle(&Vec3::z_axis(), angle);
    for kind in KINDS {
        for degrees in [25.0, 40.0] {
            let straight = wave(kind, 0.27, degrees, 0.0, ricker());
            let turned = wave(kind, 0.27, degrees, angle.to_degrees(), ricker());
            let time = arrival(&straight, reference + offset) + 0.55;
            let a = motion(&straight, reference + offset, time);
            let b = motion(&turned, reference + rotation * offset, time);
            let scale = a.displacement.norm();
            assert!((rotation * a.displacement - b.displacement).norm() < 1e-12 * scale);
            assert!((rotation * a.velocity - b.velocity).norm() < 1e-12 * a.velocity.norm());
            let stress = rotation.matrix() * a.stress.matrix() * rotation.matrix().transpose();
            assert!((stress - b.stress.matrix()).norm() < 1e-12 * stress.norm());
        }
    }
}

/// The incident part has unit amplitude, the polarisation of the conventions, and the signal at
/// the reference point as it is.
#[test]
fn the_incident_part_is_the_signal() {
    let (sine, cosine) = 40f64.to_radians().sin_cos();
    for (kind, polarisation) in [
        (WaveKind::P, Vec3::new(sine, 0.0, cosine)),
        (WaveKind::SV, Vec3::new(cosine, 0.0, -sine)),
        (WaveKind::SH, Vec3::y()),
    ] {
        let field = wave(kind, 0.27, 40.0, 0.0, ricker());
        let incident = field.incident_part().unwrap();
        let reference = field.parameters().reference;
        for i in 0..20 {
            let time = 0.06 * i as f64;
            let expected = ricker().motion(time);
            let found = motion(&*incident, reference, time);
            let (d, v) = (expected.displacement, expected.velocity);
            assert!((found.displacement - polarisation * d).norm() < 1e-15);
            assert!((found.velocity - polarisation * v).norm() < 1e-13);
        }
    }
}

/// A wave in a full space goes in any direction, horizontal and down too, and obeys the equations.
#[test]
fn a_full_space_takes_any_direction() {
    for kind in KINDS {
        for degrees in [0.0, 60.0, 90.0, 130.0, 180.0] {
            let mut parameters = parameters(kind, 0.27, degrees, 200.0);
            parameters.site = Site::FullSpace;
            let field = PlaneWave::new(parameters, ricker()).unwrap();
            let point = Vec3::new(10.0, 20.0, 500.0);
            let time = arrival(&field, point) + 0.57;
            let (motion, stress) = residuals(&field, point, time, 1.0);
            assert!(
                motion < 1e-6 && stress < 1e-6,
                "{kind} {degrees} {motion:e} {stress:e}"
            );
        }
    }
}

/// A sum of fields moves by the sum of their motions; empty sums and mixed media are refused.
#[test]
fn fields_add_up() {
    let first = || wave(WaveKind::P, 0.27, 20.0, 10.0, ricker());
    let second = || wave(WaveKind::SV, 0.27, 30.0, -50.0, ricker());
    let sum = Superposition::new(vec![Box::new(first()), Box::new(second())]).unwrap();
    let point = Vec3::new(20.0, 11.0, -60.0);
    let check = |sum: &dyn IncidentField, first: &dyn IncidentField, second: &dyn IncidentField| {
        for time in [0.5, 0.7, 0.9] {
            let [found, first, second] = [sum, first, second].map(|f| motion(f, point, time));
            let missed = found.displacement - first.displacement - second.displacement;
            assert!(missed.norm() < 1e-14 * found.displacement.norm());
            let missed = found.velocity - first.velocity - second.velocity;
            assert!(missed.norm() < 1e-14 * found.velocity.norm());
            let missed = found.stress - first.stress - second.stress;
            assert!(size(&missed.0) < 1e-14 * size(&found.stress.0));
        }
    };
    check(&sum, &first(), &second());
    let part = |field: &dyn IncidentField| field.incident_part().unwrap();
    check(&*part(&sum), &*part(&first()), &*part(&second()));
    assert_eq!(
        Superposition::new(Vec::new()).err(),
        Some(WaveError::NoFields)
    );
    let other = wave(WaveKind::P, 0.3, 20.0, 10.0, ricker());
    let mixed = Superposition::new(vec![Box::new(first()), Box::new(other)]);
    assert_eq!(mixed.err(), Some(WaveError::MediaDiffer { index: 1 }));
}

/// Batches change nothing: each point of many moves as it does alone, bit by bit.
#[test]
fn points_are_independent() {
    for degrees in [20.0, 50.0] {
        let field = wave(WaveKind::SV, 0.27, degrees, 37.0, ricker());
        let points: Vec<Vec3> = (0..77)
            .map(|i| Vec3::new(i as f64, 0.3 * i as f64, SURFACE - 2.0 * i as f64))
            .collect();
        let mut together = vec![Default::default(); points.len()];
        field
            .prepare(&points)
            .unwrap()
            .add_motion(0.8, &mut together);
        for (point, found) in points.iter().zip(together) {
            assert_eq!(motion(&field, *point, 0.8), found);
        }
    }
}

/// Points above the surface or with NaN are refused with their index; rounding of a mesh file is not.
#[test]
fn points_above_the_surface_are_refused() {
    let field = wave(WaveKind::SV, 0.27, 20.0, 0.0, ricker());
    let inside = Vec3::new(0.0, 0.0, SURFACE);
    let points = |z: f64| [inside, Vec3::new(100.0, 0.0, z)];
    assert!(field.prepare(&points(SURFACE + 5e-5)).is_ok());
    let error = field.prepare(&points(SURFACE + 0.1)).err().unwrap();
    assert!(error.to_string().contains("point 1"), "{error}");
    assert!(field.prepare(&points(f64::NAN)).is_err());
}

/// Every angle that is permitted gives finite motion, the critical one and its neighbours too.
#[test]
fn no_angle_gives_nonsense() {
    let critical = critical_angle(&rock(0.27)).degrees();
    let near = [-1e-3, -1e-9, 0.0, 1e-9, 1e-3].map(|shift| critical + shift);
    let points = [Vec3::new(3.0, 4.0, SURFACE), Vec3::new(3.0, 4.0, -500.0)];
    for kind in KINDS {
        let most = if kind == WaveKind::P { 89.0 } else { 89.9 };
        for degrees in near.into_iter().chain([0.0, 1e-9, 45.0, 89.0, most]) {
            let field = wave(kind, 0.27, degrees, 0.0, ricker());
            let sampler = field.prepare(&points).unwrap();
            for time in [-1e3, -1.0, 0.0, 0.5, 0.7, 1.0, 10.0, 1e6] {
                let mut motion = [Default::default(); 2];
                sampler.add_motion(time, &mut motion);
                for motion in motion {
                    assert!(motion.displacement.norm() < 0.01, "{kind} {degrees} {time}");
                    assert!(motion.velocity.norm().is_finite());
                    assert!(motion.stress.0.iter().all(|s| s.is_finite()));
                }
            }
        }
    }
}
