use powerhouse_model::{Cadence, Mesh, Observer, Stress, Vec3};
use powerhouse_observe::{AccelerationRule, Envelope, Motion, ObserveError, PeakPlace, PeakTable};

use super::Fields;

/// Each node's and element's extremes are those of its own oscillation, at its own time, among the
/// chosen ones alone.
#[test]
fn extremes_stand_with_their_times() {
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(4.0), [4, 4, 4], "rock").unwrap();
    let (nodes, elements) = ([3_u32, 70, 100], [10_u32, 63]);
    let cadence = Cadence::Steps(1);
    let envelope = Envelope::new(&mesh, &nodes, Motion::ALL, &elements, cadence).unwrap();
    let mut envelope = envelope.accelerations(AccelerationRule::Instant);
    let recording = envelope.recording();
    // Node n peaks once, at t = n / 100: a hump of height 1 + n around it, in a direction of its own.
    let hump = |number: u32, t: f64| {
        (1.0 + f64::from(number)) / (1.0 + 400.0 * (t - f64::from(number) / 100.0).powi(2))
    };
    let direction = Vec3::new(2.0, -3.0, 6.0) / 7.0;
    let mut view = Fields::at_rest(mesh.node_count());
    view.displacement = Box::new(|node, t| hump(node, t) * direction);
    view.velocity = Box::new(|node, t| -2.0 * hump(node, t) * direction);
    view.acceleration = Box::new(|node, t| 3.0 * hump(node, t) * direction);
    // Tension early, shear at the hump; principal stresses of pure shear are +- it.
    view.stress = Box::new(|element, t| {
        let early = if t < 0.005 { 50.0 } else { 0.0 };
        Stress([0.0, 0.0, early, hump(element, t), 0.0, 0.0])
    });
    for step in 0..=100 {
        view.show(&mut envelope, f64::from(step) / 100.0);
    }
    let table = recording.copy();
    assert_eq!(table.observations, 101);
    for (index, &node) in nodes.iter().enumerate() {
        let (height, time) = (1.0 + f64::from(node), f64::from(node) / 100.0);
        for (field, factor) in [
            (&table.displacement, 1.0),
            (&table.velocity, 2.0),
            (&table.acceleration, 3.0),
        ] {
            assert!((field.values[index] - factor * height).abs() < 1e-12 * height);
            assert_eq!(field.times[index], time);
        }
    }
    assert!((table.greatest_stress.values[0] - 50.0).abs() < 1e-13);
    assert_eq!(table.greatest_stress.times, [0.0, 0.63]);
    assert!((table.greatest_stress.values[1] - 64.0).abs() < 1e-13);
    assert_eq!(table.least_stress.times, [0.1, 0.63]);
    assert!((table.least_stress.values[0] + 11.0).abs() < 1e-13);

    let mut peaks = PeakTable::default();
    peaks.add_envelope("surface", &table, &mesh);
    let row = |name: &str| peaks.rows.iter().find(|row| row.name == name).unwrap();
    let acceleration = row("surface acceleration");
    assert_eq!(
        (acceleration.place, acceleration.time),
        (Some(PeakPlace::Node(101)), 1.0)
    );
    let least = row("surface least stress");
    assert_eq!(
        (least.place, least.time),
        (Some(PeakPlace::Element(64)), 0.63)
    );
    assert!((least.value + 64.0).abs() < 1e-12);
    assert!(peaks.to_string().contains("element 64"));
}

/// An envelope reads only the requested fields, and a motion that is not finite
/// ends the run with the node's number.
#[test]
fn only_what_is_wanted_and_finite() {
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(1.0), [1, 1, 1], "rock").unwrap();
    let every = Cadence::Steps(1);
    let mut envelope = Envelope::new(&mesh, &[6], Motion::VELOCITY, &[], every).unwrap();
    let fields = envelope.fields();
    assert!(!fields.acceleration && !fields.stress && !fields.energy);
    let recording = envelope.recording();
    let mut unseen = PeakTable::default();
    recording.read(|table| unseen.add_envelope("nothing", table, &mesh));
    assert!(unseen.rows.is_empty());
    let mut view = Fields::at_rest(8);
    view.show(&mut envelope, 0.0);
    view.show(&mut envelope, 0.5);
    // Of equal peaks the first counts.
    assert_eq!(recording.read(|table| table.velocity.times[0]), 0.0);
    view.velocity = Box::new(|_, _| Vec3::new(0.0, f64::NAN, 0.0));
    let error = envelope.observe(&view).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("velocity of node 7 is not finite"),
        "{error}"
    );
    recording.read(|table| {
        assert!(table.displacement.values.is_empty());
        assert_eq!(table.velocity.values, [0.0]);
    });

    let mut stressed = Envelope::new(&mesh, &[], Motion::ALL, &[0], every).unwrap();
    assert!(stressed.fields().stress && !stressed.fields().acceleration);
    view.show(&mut stressed, 0.0);
    view.show(&mut stressed, 0.5);
    stressed.recording().read(|table| {
        assert_eq!(table.greatest_stress.times, [0.0]);
        assert_eq!(table.least_stress.times, [0.0]);
    });
    view.stress = Box::new(|_, _| Stress([0.0, 0.0, 0.0, f64::INFINITY, 0.0, 0.0]));
    let error = stressed.observe(&view).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("stress of element 1 is not finite"),
        "{error}"
    );

    let beyond = Envelope::new(&mesh, &[8], Motion::ALL, &[], every);
    assert!(matches!(
        beyond.err(),
        Some(ObserveError::NoSuchNode { node: 8, .. })
    ));
    let beyond = Envelope::new(&mesh, &[], Motion::ALL, &[1], every);
    assert!(matches!(
        beyond.err(),
        Some(ObserveError::NoSuchElement { element: 1, .. })
    ));
}
