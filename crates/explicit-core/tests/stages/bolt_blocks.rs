//! Rock bolts in several blocks.

use powerhouse_elements::{BoltEnd, BoltLine, BoltParameters, BoltSet, Grout, NodalForce};
use powerhouse_explicit_core::{BuildModel, Leapfrog, Model, run};
use powerhouse_model::{Cadence, EnergyCheck, Mesh, RunOptions, State, StepChoice, Vec3};
use powerhouse_observe::BoltHistories;

use super::{bent_box, elastic_body, face_nodes, on_rollers};

/// Bolts that cross several blocks of a bent body, in an order that is not that of their hosts.
fn bolts(mesh: &Mesh, grout: Option<Grout>) -> BoltSet {
    let line = |i: usize| {
        let at = f64::from((i * 5 % 12) as u32);
        let head = Vec3::new(0.6 + 0.9 * at, 2.0 + 0.5 * at, 8.5);
        BoltLine {
            head,
            toe: head + Vec3::new(0.3, 0.4, -6.0),
        }
    };
    let lines: Vec<BoltLine> = (0..12).map(line).collect();
    let parameters = BoltParameters {
        yield_force: 2.0e3,
        grout,
        ..BoltParameters::steel(0.025).unwrap()
    };
    let hosts: Vec<u32> = (0..mesh.element_count() as u32).collect();
    BoltSet::new("roof", mesh, &hosts, &lines, parameters).unwrap()
}

/// The body with its bolts in blocks of a size, drawn up and down at the top.
fn body(mesh: &Mesh, bolts: &BoltSet, block_size: usize) -> Model {
    let pull = NodalForce::new(
        face_nodes(mesh, "top"),
        Vec3::new(0.0, 0.0, 1.0e6),
        Box::new(|t: f64| (300.0 * t).sin()),
    );
    let builder = on_rollers(mesh, elastic_body(mesh)).embed(Box::new(bolts.clone()));
    let builder = builder.load(Box::new(pull)).block_size(block_size);
    builder.build().unwrap()
}

fn axial_forces(bolts: &BoltSet, state: &State) -> Vec<f64> {
    bolts.axial_forces(state).unwrap()
}

/// In however many blocks bolts are, states and observers have their segments bolt by bolt, with the same values
/// to rounding; a state is taken over to the bit by bolts in other blocks.
#[test]
fn results_do_not_know_the_blocks_of_bolts() {
    let mesh = bent_box(Vec3::new(12.0, 10.0, 10.0), [6, 5, 5], 0.4);
    let grout = Grout {
        stiffness: 2.0e8,
        strength: 5.0e2,
        head: BoltEnd::Anchored,
        toe: BoltEnd::Free,
    };
    for grout in [None, Some(grout)] {
        let bolts = bolts(&mesh, grout);
        let options = RunOptions::steps(200)
            .with_step(StepChoice::Fixed(1.0e-4))
            .with_energy(EnergyCheck::every(10));
        let moved = |block_size: usize| {
            let mut model = body(&mesh, &bolts, block_size);
            let watch = BoltHistories::new(Cadence::Steps(10), [&bolts]).unwrap();
            let recording = watch.recording();
            let mut observers: [Box<dyn powerhouse_model::Observer>; 1] = [Box::new(watch)];
            let report = run(&mut model, &Leapfrog, &options, &mut observers, &mut |_| {});
            assert!(report.unwrap().energy_residual < 1.0e-9);
            (model, recording.copy())
        };
        let (mut whole, of_whole) = moved(1000);
        let (mut many, of_many) = moved(8);
        assert_eq!(whole.embedded_hosts().len(), 1);
        assert!(many.embedded_hosts().len() > 1);
        let (first, second) = (whole.state(), many.state());
        let near = |a: f64, b: f64, size: f64| (a - b).abs() <= 1.0e-9 * size;
        for (one, other) in first.history.iter().zip(&second.history) {
            assert_eq!((&one.name, one.points), (&other.name, other.points));
            if one.name.starts_with("roof/") {
                assert_eq!(one.elements, other.elements);
                let largest = one.values.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
                let mut pairs = one.values.iter().zip(&other.values);
                assert!(pairs.all(|(&a, &b)| near(a, b, largest)), "{}", one.name);
            }
        }
        let plastic = first
            .history
            .iter()
            .find(|f| f.name == "roof/dissipated_by_bolt");
        assert!(plastic.unwrap().values.iter().any(|&spent| spent > 0.0));
        let peaks = [&of_whole, &of_many].map(|tables| &tables.peaks[0].greatest.values);
        let largest = peaks[0].iter().fold(0.0_f64, |most, v| most.max(*v));
        assert!(
            peaks[0]
                .iter()
                .zip(peaks[1])
                .all(|(&a, &b)| near(a, b, largest))
        );

        let mut third = body(&mesh, &bolts, 30);
        third.set_state(&first).unwrap();
        let found = third.state();
        assert_eq!(axial_forces(&bolts, &found), axial_forces(&bolts, &first));
        for (one, other) in first.history.iter().zip(&found.history) {
            if one.name.starts_with("roof/") {
                assert_eq!(one, other);
            }
        }
    }
}
