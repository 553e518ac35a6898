//! A spherical cavity under a pressure step: spherical waves, and a boundary of springs and dashpots oblique to
//! all axes.
//!
//! By symmetry a thin pyramid with its apex at the centre is sufficient, with rollers on its sides.
//!
//! ```text
//!                     ___--- sides on rollers
//!   (centre)    a ---       R
//!       o       |) p     |)|  boundary
//!                 ---___
//! ```

use powerhouse::engine::{BuildModel, Model};
use powerhouse_boundary::{AxisParameters, InputMode, ViscousSpring};
use powerhouse_elements::{FacePressure, Profile, SolidKernel};
use powerhouse_model::{
    AbsorbingBoundary, BoundarySite, ElasticMedium, Support, TimeFunction, Vec3,
};
use powerhouse_tests::{Ground, motion_at};

const CAVITY: f64 = 10.0;
const PRESSURE: f64 = 1.0e6;
/// Rise time of the pressure (s).
const RISE: f64 = 1.0e-3;

fn rock() -> ElasticMedium {
    ElasticMedium::new(1.0e10, 0.25, 2700.0).unwrap()
}

/// A pyramid of half-opening 0.02 rad from the cavity to radius `far`, turned so that no face
/// lies along an axis, with the given parameters of a boundary at its far end.
fn pyramid(far: f64, elements: usize, parameters: AxisParameters) -> (Ground, Model) {
    let kernel = SolidKernel::Hex8OnePoint(Default::default());
    let turn = nalgebra::Rotation3::from_euler_angles(0.7, -0.4, 1.9);
    let unit = Vec3::repeat(1.0);
    let ground = Ground::boxed(unit, [1, 1, elements], rock(), kernel).mapped(|p| {
        let radius = CAVITY + (far - CAVITY) * p.z;
        let angle = |x: f64| 0.04 * (x - 0.5);
        let direction = Vec3::new(angle(p.x).tan(), angle(p.y).tan(), 1.0).normalize();
        turn * (radius * direction)
    });
    let boundary = ViscousSpring {
        axes: [parameters; 3],
        input: InputMode::Nothing,
        ..ViscousSpring::default()
    };
    let far_face = [("top", ground.mesh.facet_set("top").unwrap())];
    let site = BoundarySite::from_mesh(&ground.mesh, &far_face, |_| rock(), Vec3::zeros(), None);
    let near_face = ground.mesh.facet_set("bottom").unwrap();
    let step: Box<dyn TimeFunction> = Box::new(|t: f64| PRESSURE * (t / RISE).min(1.0));
    let profile = Profile::Uniform;
    let pressure = FacePressure::new(&ground.mesh, near_face, profile, step).unwrap();
    let mut builder = ground
        .free()
        .boundary(boundary.build(&site).unwrap())
        .load(Box::new(pressure));
    for side in ["left", "right", "front", "back"] {
        let facet = ground.mesh.facet_set(side).unwrap()[0];
        let normal = ground.mesh.facet_geometry(facet).normal();
        builder = builder.support(Support::roller(ground.face_nodes(side), normal));
    }
    let model = builder.build().unwrap();
    (ground, model)
}

/// Radial displacement of the cavity's wall over time, over the static one of infinite rock.
fn wall(far: f64, elements: usize, duration: f64) -> Vec<(f64, f64)> {
    let (ground, mut model) = pyramid(far, elements, AxisParameters::default());
    let node = ground.face_nodes("bottom")[0];
    let outward = ground.mesh.positions()[node as usize].normalize();
    let fixed = PRESSURE * CAVITY / (4.0 * rock().shear());
    let motion = motion_at(&mut model, node, duration);
    motion
        .iter()
        .map(|(t, u)| (*t, u.dot(&outward) / fixed))
        .collect()
}

/// The displacement of the wall, over the static one, under a pressure that rises evenly over
/// `RISE`: `(U(t) - U(t - RISE))/RISE`, `U(t) = t - exp(-g t) sin(w t)/w`, with
/// `g = 2 cs^2/(a cp)`, `w^2 = (2 cs/a)^2 - g^2`. The derivative of U is the answer to a step.
fn closed_form(time: f64) -> f64 {
    let (p, s) = (rock().p_speed(), rock().s_speed());
    let decay = 2.0 * s * s / (CAVITY * p);
    let frequency = ((2.0 * s / CAVITY).powi(2) - decay * decay).sqrt();
    let integral = |t: f64| {
        let t = t.max(0.0);
        t - (-decay * t).exp() * (frequency * t).sin() / frequency
    };
    (integral(time) - integral(time - RISE)) / RISE
}

/// Before the reflection from the far end arrives the wall moves as in infinite rock, with second order in the
/// element size: an overshoot of 25.9 %, 9.6 ms after a pressure step.
#[test]
fn the_wall_of_a_cavity_overshoots() {
    // The reflection from the far end arrives after 2 (80 - 10) m / 2108 m/s = 66 ms.
    let runs = [140, 280].map(|elements| wall(80.0, elements, 0.06));
    let errors = [0, 1].map(|run: usize| -> f64 {
        let squares = runs[run].iter().map(|(t, u)| (u - closed_form(*t)).powi(2));
        (squares.sum::<f64>() / runs[run].len() as f64).sqrt()
    });
    let slope = (errors[0] / errors[1]).log2();
    assert!(
        errors[1] < 1e-3 && (slope - 2.0).abs() < 0.3,
        "{errors:?} {slope}"
    );
    let peak = runs[1].iter().map(|(_, u)| *u).fold(0.0, f64::max);
    // The rise time reduces the peak of the step response, 1.258974, by (w RISE)^2/24 of 0.26.
    assert!((peak - 1.258974).abs() < 2e-3, "{peak}");
}

/// In the static limit the rock between wall and springs is a hollow sphere on an elastic foundation of (lambda
/// + 2 G)/((1 + A) R) per area: springs oblique to all axes have the correct stiffness along the normal.
#[test]
fn springs_carry_a_static_pressure() {
    let far = 20.0;
    let m = rock();
    let bed = m.constrained() / (1.8 * far);
    // u = c1 r + c2 / r^2 with sigma_r(a) = -p and sigma_r(R) = -bed u(R).
    let radial = |r: f64| {
        nalgebra::RowVector2::new(
            3.0 * m.lambda() + 2.0 * m.shear(),
            -4.0 * m.shear() / r.powi(3),
        )
    };
    let moved = |r: f64| nalgebra::RowVector2::new(r, 1.0 / (r * r));
    let conditions =
        nalgebra::Matrix2::from_rows(&[radial(CAVITY), radial(far) + bed * moved(far)]);
    let constants = conditions
        .lu()
        .solve(&nalgebra::Vector2::new(-PRESSURE, 0.0))
        .unwrap();
    let expected = (moved(CAVITY) * constants)[0] * 4.0 * m.shear() / (PRESSURE * CAVITY);
    let motion = wall(far, 40, 0.5);
    let last = motion.last().unwrap().1;
    // Elements of a/40: their error in 1/r^2 is of the order (h/a)^2, that of the opening angle 0.02^2.
    assert!((last - expected).abs() < 1e-3, "{last} {expected}");
    // In infinite rock the displacement would be 1, with a free outer face this.
    let free = nalgebra::Matrix2::from_rows(&[radial(CAVITY), radial(far)]);
    let constants = free
        .lu()
        .solve(&nalgebra::Vector2::new(-PRESSURE, 0.0))
        .unwrap();
    let without = (moved(CAVITY) * constants)[0] * 4.0 * m.shear() / (PRESSURE * CAVITY);
    assert!(
        expected > 1.02 && expected < without - 0.02,
        "{expected} {without}"
    );
}
