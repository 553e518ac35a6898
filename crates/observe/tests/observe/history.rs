use powerhouse_model::{Cadence, Mat3, Mesh, MeshError, ModelError, Observer, Stress, Vec3};
use powerhouse_observe::{
    AccelerationRule, EnergyHistory, History, Motion, ObservationPoint, ObserveError, PeakTable,
    Place, StressPlace,
};

use super::{Fields, noise};

fn rough_block() -> Mesh {
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(10.0), [5, 5, 5], "rock").unwrap();
    mesh.map_positions(|p| {
        let seed = 3 * (p.x + 11.0 * p.y + 121.0 * p.z).round() as u64;
        p + 0.3 * Vec3::new(noise(seed), noise(seed + 1), noise(seed + 2))
    })
    .unwrap()
}

/// Probes given by coordinate, node and set show a motion that is linear in space to 1e-12, its
/// displacement, velocity and acceleration each, relative motions included.
#[test]
fn probes_in_a_linear_field_are_exact() {
    let mut mesh = rough_block();
    mesh.set_node_set("corner", vec![0, 1, 6, 7]).unwrap();
    let gradient = Mat3::new(0.3, -1.0, 0.2, 0.7, 0.1, -0.4, -0.6, 0.5, 0.9);
    let field = |p: &Vec3, t: f64| gradient * p * t + Vec3::new(1.0, t, -t);
    let x = |node: u32| mesh.positions()[node as usize];
    let crown = Vec3::new(5.1, 4.2, 8.3);
    let floor = Vec3::new(5.1, 4.2, 1.7);
    let mut history = History::builder(Cadence::Steps(1))
        .motion("crown", crown, Motion::ALL)
        .motion("node", Place::Node(9), Motion::VELOCITY)
        .motion("set", Place::NodeSet("corner".into()), Motion::DISPLACEMENT)
        .relative("closure", floor, crown, Motion::ALL)
        .build(&mesh)
        .unwrap();
    let recording = history.recording();
    let mut view = Fields::at_rest(mesh.node_count());
    view.displacement = Box::new(|node, t| field(&x(node), t));
    view.velocity = Box::new(|node, t| 10.0 * field(&x(node), t));
    view.acceleration = Box::new(|node, t| 100.0 * field(&x(node), t));
    for time in [0.25, 0.5, 0.75] {
        view.show(&mut history, time);
    }
    let table = recording.copy();
    assert_eq!(table.times, [0.25, 0.5, 0.75]);
    let mean = (x(0) + x(1) + x(6) + x(7)) / 4.0;
    for (row, &time) in table.times.iter().enumerate() {
        let check = |name: &str, unit: &str, expected: Vec3| {
            for (axis, expected) in ["x", "y", "z"].into_iter().zip(expected.iter()) {
                let column = table.column(&format!("{name}{axis}")).unwrap();
                assert_eq!(column.unit, unit);
                assert!((column.values[row] - expected).abs() < 1e-12 * (1.0 + expected.abs()));
            }
        };
        check("crown.u", "m", field(&crown, time));
        check("crown.v", "m/s", 10.0 * field(&crown, time));
        check("crown.a", "m/s2", 100.0 * field(&crown, time));
        check("node.v", "m/s", 10.0 * field(&x(8), time));
        check("set.u", "m", field(&mean, time));
        let relative = field(&crown, time) - field(&floor, time);
        check("closure.u", "m", relative);
        check("closure.v", "m/s", 10.0 * relative);
        check("closure.a", "m/s2", 100.0 * relative);
        // Floor and crown lie above one another: they part by the vertical motion.
        let apart = table.column("closure.apart").unwrap().values[row];
        assert!((apart - relative.z).abs() < 1e-12);
    }
    assert!(table.column("node.ux").is_none() && table.column("set.vx").is_none());
}

/// A set of facets is observed as the mean over its nodes; a node set of the same name goes first.
#[test]
fn facet_sets_are_observed_by_their_nodes() {
    let mesh = rough_block();
    let nodes = mesh.nodes_of_facets(mesh.facet_set("top").unwrap());
    let x = |node: u32| mesh.positions()[node as usize];
    let seen = |mesh: &Mesh| {
        let mut history = History::builder(Cadence::Steps(1))
            .motion("top", Place::NodeSet("top".into()), Motion::DISPLACEMENT)
            .build(mesh)
            .unwrap();
        let recording = history.recording();
        let mut view = Fields::at_rest(mesh.node_count());
        view.displacement = Box::new(|node, _| x(node));
        view.show(&mut history, 1.0);
        let table = recording.copy();
        ["x", "y", "z"].map(|axis| table.column(&format!("top.u{axis}")).unwrap().values[0])
    };
    let mean: Vec3 = nodes.iter().map(|&n| x(n)).sum::<Vec3>() / nodes.len() as f64;
    assert!((Vec3::from(seen(&mesh)) - mean).norm() < 1e-12);
    let mut named = mesh.clone();
    named.set_node_set("top", vec![3]).unwrap();
    assert_eq!(Vec3::from(seen(&named)), x(3));
}

/// Stress of an element is recorded as six components and three principal stresses, the element found by
/// number or by coordinate in its set.
#[test]
fn stresses_are_kept_with_their_principal_values() {
    let mut mesh = rough_block();
    let half: Vec<u32> = (62..125).collect();
    mesh.set_element_set("upper", half).unwrap();
    let centre = mesh.centroid(62);
    let mut history = History::builder(Cadence::Steps(1))
        .stress("seventh", StressPlace::Element(7))
        .stress(
            "upper",
            StressPlace::Point(ObservationPoint::at(centre).among("upper")),
        )
        .build(&mesh)
        .unwrap();
    assert!(history.fields().stress && !history.fields().acceleration);
    let recording = history.recording();
    let mut view = Fields::at_rest(mesh.node_count());
    view.stress = Box::new(|element, t| {
        let size = f64::from(element) * t;
        Stress([size, 3.0 * size, 2.0 * size, 0.0, 0.0, 0.0])
    });
    view.show(&mut history, 2.0);
    let table = recording.copy();
    for (name, size) in [("seventh", 12.0), ("upper", 124.0)] {
        let expected = [1.0, 3.0, 2.0, 0.0, 0.0, 0.0, 3.0, 2.0, 1.0];
        let names = ["xx", "yy", "zz", "xy", "yz", "zx", "s1", "s2", "s3"];
        for (component, expected) in names.into_iter().zip(expected) {
            let column = table.column(&format!("{name}.{component}")).unwrap();
            assert_eq!(column.unit, "Pa");
            assert!((column.values[0] - size * expected).abs() < 1e-13 * size);
        }
    }
}

/// What cannot be observed is refused before the run, by name.
#[test]
fn impossible_histories_are_refused() {
    let mut mesh = rough_block();
    mesh.set_node_set("empty", vec![]).unwrap();
    let build = |cadence, place: Place| {
        let history = History::builder(cadence).motion("p", place, Motion::ALL);
        history.build(&mesh).err().unwrap()
    };
    let every = Cadence::Steps(1);
    let error = build(every, Place::Node(217));
    assert!(matches!(error, ObserveError::NoSuchNode { node: 217, .. }));
    let error = build(every, Place::NodeSet("empty".into()));
    assert!(matches!(error, ObserveError::EmptySet { .. }));
    let error = build(every, Place::NodeSet("missing".into()));
    assert!(matches!(
        error,
        ObserveError::Mesh(MeshError::NoSuchSet { .. })
    ));
    let error = build(every, Vec3::new(5.0, 5.0, 11.0).into());
    assert!(matches!(
        error,
        ObserveError::Mesh(MeshError::PointOutside { .. })
    ));
    let spot = ObservationPoint::at(Vec3::repeat(5.0)).within(-1.0);
    let error = build(every, Place::Point(spot));
    assert!(matches!(error, ObserveError::Parameter(_)));
    for cadence in [
        Cadence::Steps(0),
        Cadence::Seconds(0.0),
        Cadence::Seconds(f64::NAN),
    ] {
        let error = build(cadence, Place::Node(1));
        assert!(matches!(error, ObserveError::Parameter(_)));
    }
    let twice = History::builder(every)
        .motion("p", Place::Node(1), Motion::VELOCITY)
        .motion("p", Place::Node(2), Motion::VELOCITY)
        .build(&mesh);
    assert!(matches!(twice.err(), Some(ObserveError::NameTwice { name }) if name == "p.vx"));
    let lost = History::builder(every)
        .stress("p", StressPlace::Element(126))
        .build(&mesh);
    assert!(matches!(
        lost.err(),
        Some(ObserveError::NoSuchElement { element: 126, .. })
    ));
}

/// Energies stand under the ledger's own names; a run without a ledger, or with another, fails.
#[test]
fn energies_stand_under_their_names() {
    let mut history = EnergyHistory::new(Cadence::Seconds(0.1)).unwrap();
    assert!(history.fields().energy);
    let recording = history.recording();
    let mut view = Fields::at_rest(8);
    let refused = |result: Result<_, ModelError>| result.err().unwrap().to_string();
    assert!(refused(history.observe(&view)).contains("no energy ledger"));
    for time in [0.0, 0.1] {
        view.energies = vec![("kinetic", 3.0 * time), ("elastic", -time)];
        view.show(&mut history, time);
    }
    view.energies = vec![("kinetic", 0.0)];
    assert!(refused(history.observe(&view)).contains("kinetic"));
    let table = recording.copy();
    assert_eq!(table.times, [0.0, 0.1]);
    assert_eq!(table.column("elastic").unwrap().values, [0.0, -0.1]);
    assert_eq!(table.columns[0].unit, "J");
    let mut peaks = PeakTable::default();
    peaks.add_history(&table);
    let rows: Vec<(&str, f64, f64)> = peaks
        .rows
        .iter()
        .map(|r| (r.name.as_str(), r.value, r.time))
        .collect();
    assert_eq!(rows[1], ("elastic", -0.1, 0.1));
    assert!((rows[0].1 - 0.3).abs() < 1e-15);
    assert!(peaks.to_string().lines().all(|line| line.contains(" J ")));
}

/// Rows of an interval in seconds are at its multiples, with values on the line between the steps around them, also of
/// observers that are saved and restored between the two: for steps above half of the interval, far below it, that divide
/// it and that are longer than it.
#[test]
fn rows_are_at_multiples_of_the_interval() {
    let mesh = rough_block();
    let wave = |t: f64| Vec3::new((40.0 * t).sin(), t * t, 1.0 - 3.0 * t);
    for (step, interval) in [
        (2.94e-3, 5e-3),
        (2.94e-3, 0.02),
        (1.7e-4, 0.003),
        (4.9e-3, 5e-3),
        (1e-3, 5e-3),
        (7e-3, 5e-3),
    ] {
        let mut history = History::builder(Cadence::Seconds(interval))
            .motion("a", Place::Node(9), Motion::ALL)
            .accelerations(AccelerationRule::Instant)
            .build(&mesh)
            .unwrap();
        let recording = history.recording();
        let mut view = Fields::at_rest(mesh.node_count());
        view.step = step;
        view.displacement = Box::new(|_, t| wave(t));
        view.acceleration = Box::new(|_, t| 2.0 * wave(t));
        let steps = (0.31_f64 / step).ceil() as u64 + 1;
        view.run(&mut [&mut history], steps);
        let table = recording.copy();
        let expected = if interval > step { interval } else { step };
        let rows = 1 + (0.31 / expected + 1e-6).floor() as usize;
        assert!(
            table.times.len() >= rows,
            "{step} {interval}: {}",
            table.times.len()
        );
        for (row, &time) in table.times.iter().enumerate() {
            if interval > step {
                // The number that its decimal digits are.
                let digits: f64 = format!("{:.6}", row as f64 * interval).parse().unwrap();
                assert_eq!(time, digits, "{step} {interval}");
            }
            let before = (time / step + 1e-6).floor() * step;
            let share = (time - before) / step;
            let value = wave(before) * (1.0 - share) + wave(before + step) * share;
            for (axis, value) in ["x", "y", "z"].into_iter().zip(value.iter()) {
                let at = |name: &str| table.column(&format!("a.{name}{axis}")).unwrap().values[row];
                assert!(
                    (at("u") - value).abs() < 1e-9,
                    "{step} {interval} {time}: {}",
                    at("u")
                );
                assert!((at("a") - 2.0 * value).abs() < 1e-9);
            }
        }
    }
}

/// The peak of a motion is that of all steps, whatever the interval of its rows.
#[test]
fn peaks_do_not_depend_on_the_interval() {
    let mesh = rough_block();
    let step = 2.9e-3;
    let pulse = |t: f64| -3.125 * (-((t - 0.101) / 4e-3).powi(2)).exp();
    let greatest = (0..120)
        .map(|n| pulse(f64::from(n) * step))
        .fold(0.0, f64::min);
    for interval in [1e-3, 5e-3, 0.02, 0.3] {
        let mut history = History::builder(Cadence::Seconds(interval))
            .stress("before", StressPlace::Element(7))
            .motion("a", Place::Node(9), Motion::ACCELERATION)
            .relative("b", Place::Node(3), Place::Node(9), Motion::DISPLACEMENT)
            .accelerations(AccelerationRule::Instant)
            .build(&mesh)
            .unwrap();
        let recording = history.recording();
        let mut peaks = history.motion_peaks().unwrap();
        let mut view = Fields::at_rest(mesh.node_count());
        view.step = step;
        view.acceleration = Box::new(|_, t| Vec3::new(0.0, pulse(t), 0.0));
        view.displacement =
            Box::new(|node, t| Vec3::new(f64::from(u8::from(node == 8)) * pulse(t), 0.0, 0.0));
        view.run(&mut [&mut peaks, &mut history], 120);
        let mut table = PeakTable::default();
        table.add_history(&recording.copy());
        for name in ["a.ay", "b.ux"] {
            let row = table.rows.iter().find(|row| row.name == name).unwrap();
            assert!(
                (row.value - greatest).abs() < 1e-12,
                "{name} {interval}: {}",
                row.value
            );
            assert!((row.time - 35.0 * step).abs() < 1e-9, "{}", row.time);
        }
    }
    let stress = History::builder(Cadence::Steps(1)).stress("s", StressPlace::Element(7));
    assert!(stress.build(&mesh).unwrap().motion_peaks().is_none());
}
