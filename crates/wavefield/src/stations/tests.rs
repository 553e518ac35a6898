use super::*;

const STEP: f64 = 0.02;
const START: f64 = -0.3;
const COUNT: usize = 200;

fn medium() -> ElasticMedium {
    ElasticMedium::new(1e9, 0.25, 2000.0).unwrap()
}

fn place(station: usize) -> Vec3 {
    Vec3::new(5.0 * station as f64, 3.0, -1.0)
}

/// Displacement and velocity of a station: three sines.
fn exact(station: usize, time: f64) -> (Vec3, Vec3) {
    let rate = Vec3::new(9.0, 13.0, 17.0);
    let phase = |axis: usize| rate[axis] * time + station as f64 + axis as f64;
    let displacement = Vec3::from_fn(|axis, _| 0.1 * phase(axis).sin());
    let velocity = Vec3::from_fn(|axis, _| 0.1 * rate[axis] * phase(axis).cos());
    (displacement, velocity)
}

fn parameters(stations: usize, has_velocity: bool) -> StationParameters {
    let mut motion = Vec::new();
    for station in 0..stations {
        for sample in 0..COUNT {
            let (u, v) = exact(station, START + STEP * sample as f64);
            motion.extend(u.iter());
            motion.extend(v.iter().filter(|_| has_velocity));
        }
    }
    StationParameters {
        name: "sines".into(),
        positions: (0..stations).map(place).collect(),
        inner: Some((0..stations).map(|station| station % 2 == 0).collect()),
        medium: medium(),
        start: START,
        step: STEP,
        samples: COUNT,
        has_velocity,
        motion,
        tolerance: 1e-3,
    }
}

fn at(field: &StationField, station: usize, time: f64) -> FieldMotion {
    let mut motion = [FieldMotion::default()];
    let sampler = field.prepare(&[place(station)]).unwrap();
    sampler.add_motion(time, &mut motion);
    motion[0]
}

/// At its samples a field has them; between them a cubic errs as `w^4 h^4 / 384`, a line as `w^2 h^2 / 8`; the reported
/// error is of that size.
#[test]
fn motions_are_those_of_the_samples_and_between_them_of_the_interpolation() {
    let rate = 17.0_f64 * STEP;
    for (has_velocity, bound) in [(true, rate.powi(4) / 384.0), (false, rate.powi(2) / 8.0)] {
        let field = StationField::new(parameters(3, has_velocity)).unwrap();
        let (mut worst, peak) = (0.0_f64, field.report().peak_displacement);
        for tenth in 0..10 * (COUNT - 1) {
            let time = START + 0.1 * STEP * tenth as f64;
            let found = at(&field, 1, time);
            let off = (found.displacement - exact(1, time).0).norm();
            worst = worst.max(off);
            if tenth % 10 == 0 {
                assert!(off < 1e-12, "{off}");
            }
        }
        // Three components, of amplitude 0.1 each.
        assert!(worst < 0.1 * bound * 3.0_f64.sqrt(), "{worst}");
        let told = field.report().error * peak;
        assert!((0.5..3.0).contains(&(told / worst)), "{told} for {worst}");
    }
}

/// The velocity of a field is the derivative of its displacement.
#[test]
fn the_velocity_is_the_derivative() {
    for has_velocity in [true, false] {
        let field = StationField::new(parameters(2, has_velocity)).unwrap();
        for time in [0.013, 0.517, 1.0011] {
            let [before, after] = [-1e-6, 1e-6].map(|d| at(&field, 1, time + d).displacement);
            let slope = (after - before) / 2e-6;
            let velocity = at(&field, 1, time).velocity;
            assert!((slope - velocity).norm() < 1e-6, "{slope} {velocity}");
        }
    }
}

/// Before the first sample and after the last one the displacement is held, and nothing past the end is read.
#[test]
fn outside_of_the_samples_the_displacement_is_held() {
    let field = StationField::new(parameters(2, true)).unwrap();
    let end = field.report().end;
    assert!((end - (START + STEP * (COUNT - 1) as f64)).abs() < 1e-12);
    for (time, sample) in [(START - 5.0, START), (end + 1e-9, end), (end + 1e9, end)] {
        // The last station: after its samples there are no others.
        let found = at(&field, 1, time);
        assert!((found.displacement - exact(1, sample).0).norm() < 1e-9);
        assert_eq!(found.velocity, Vec3::zeros());
    }
    assert_eq!(at(&field, 1, f64::NAN).velocity, Vec3::zeros());
    assert!(at(&field, 1, end).velocity.norm() > 0.1);
}

/// A node without a station is an error with both places; of stations in another unit the extents are there.
#[test]
fn nodes_without_a_station_are_named() {
    let field = StationField::new(parameters(4, false)).unwrap();
    let mut nodes: Vec<Vec3> = (0..4).map(place).collect();
    nodes[2].z -= 0.9e-3;
    assert!(field.prepare(&nodes).is_ok());
    nodes[2].z -= 0.2e-3;
    let Err(error) = field.prepare(&nodes) else {
        panic!("no station there")
    };
    let text = error.to_string();
    for part in [
        "1 of 4 nodes",
        "(10.0000, 3.0000, -1.0011)",
        "0.0011 m from",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    assert!(!text.contains("km"));
    let far: Vec<Vec3> = (0..4).map(|n| 1000.0 * place(n) + Vec3::x()).collect();
    let text = field.prepare(&far).err().unwrap().to_string();
    for part in [
        "4 of 4 nodes",
        "extend over 15.0000 x 0.0000",
        "15000.0000",
        "km",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
}

/// Nodes of the layer must be on the side of their stations.
#[test]
fn a_node_on_another_side_is_named() {
    let field = StationField::new(parameters(4, false)).unwrap();
    let nodes: Vec<Vec3> = (0..4).map(place).collect();
    assert!(
        field
            .check_layer(&nodes, &[true, false, true, false])
            .is_ok()
    );
    let error = field.check_layer(&nodes, &[true, false, false, true]);
    let text = error.err().unwrap().to_string();
    for part in ["(10.0000,", "on the outer side", "2 such nodes"] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let unknown = StationParameters {
        inner: None,
        ..parameters(4, false)
    };
    let field = StationField::new(unknown).unwrap();
    assert!(field.check_layer(&nodes, &[true; 4]).is_ok());
}

/// What does not fit together is an error with its cause.
#[test]
fn parameters_that_do_not_fit_are_refused() {
    type Change = fn(&mut StationParameters);
    let changes: [(Change, &str); 8] = [
        (|p| p.step = 0.0, "step = 0"),
        (|p| p.samples = 1, "samples = 1"),
        (|p| p.motion.truncate(100), "100 entries"),
        (
            |p| p.inner = Some(vec![true]),
            "1 entries of the list 'side'",
        ),
        (
            |p| p.motion[6 * (COUNT + 7) + 1] = f64::NAN,
            "sample 7 of station 1",
        ),
        (
            |p| p.positions[2] = p.positions[1] + Vec3::x() * 1e-3,
            "stations 1 and 2",
        ),
        (
            |p| p.motion.chunks_mut(6).for_each(|c| c.swap(3, 5)),
            "is not that of its displacement",
        ),
        (
            |p| {
                p.motion
                    .iter_mut()
                    .skip(3)
                    .step_by(6)
                    .for_each(|v| *v *= 100.0)
            },
            "one unit",
        ),
    ];
    for (change, wanted) in changes {
        let mut changed = parameters(3, true);
        change(&mut changed);
        let text = StationField::new(changed).err().unwrap().to_string();
        assert!(text.contains(wanted), "{wanted}: {text}");
    }
}
