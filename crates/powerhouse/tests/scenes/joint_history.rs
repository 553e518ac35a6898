//! History variables of the contact law of a joint, in the results of a scene.

use std::sync::Arc;

use powerhouse::contact::BondedCoulomb;
use powerhouse::engine::observe::JointQuantities;
use powerhouse::model::{
    ContactLaw, ContactState, HistoryVariable, JointInput, JointResponse, JointState,
};
use powerhouse::{JointZone, ResultFolder, RunHooks, RunNotes, SnapshotRequest};

use super::joints::{halves, twin};
use super::support::*;

/// Coulomb friction that sums up its slip and flags that it has slid.
struct Wearing(BondedCoulomb);

const VARIABLES: [HistoryVariable; 2] = [
    HistoryVariable::amount("wear", "m"),
    HistoryVariable::flags("worn"),
];

impl ContactLaw for Wearing {
    fn name(&self) -> &str {
        "wearing"
    }
    fn initial(&self) -> JointState {
        self.0.initial()
    }
    fn history(&self) -> &[HistoryVariable] {
        &VARIABLES
    }
    fn admissible(&self, input: &JointInput, new_history: &mut [f64]) -> JointResponse {
        let response = self.0.admissible(input, &mut []);
        if response.state.contact == ContactState::Slide {
            let [first, second] = input.slip_rate_after(&response.traction);
            new_history[0] += first.hypot(second) * input.step;
            new_history[1] = 2.0;
        }
        response
    }
    fn sliding_strength(&self, normal: f64, input: &JointInput) -> f64 {
        self.0.sliding_strength(normal, input)
    }
}

/// The history variables of a joint's law are in the table of its pairs, as columns against time, and in
/// the files of its facets, at the end and in snapshots.
#[test]
fn history_variables_of_a_contact_law_are_results() {
    let (mesh, mut joint) = twin(&halves());
    joint.law = Arc::new(Wearing(BondedCoulomb::unbonded(0.7, 0.5).unwrap()));
    let pairs = joint.surface.pairs.clone();
    let node = mesh.node_tags()[pairs[0].nodes[0] as usize];
    let only_history = JointQuantities {
        history: true,
        ..JointQuantities::default()
    };
    let mut scene = cube_scene_of(mesh, &["lower", "upper"]).joint(joint);
    let mut plan = scene.output().clone();
    plan = plan.joint("corner", "bedding", JointZone::Node(node), only_history);
    plan.snapshots = Some(SnapshotRequest::new(0.2));
    scene = scene.with_output(plan);
    let mesh = scene.mesh().clone();
    let simulation = scene.prepare().unwrap();
    let folder = Folder::new("joint-history");
    let output = ResultFolder::new(&folder);
    let hooks = RunHooks::default().with_snapshots(output.snapshots(&simulation).unwrap());
    let results = simulation.run(hooks).unwrap();

    let table = &results.joints[0];
    assert_eq!(table.variables, VARIABLES);
    let wear = |pair: usize| table.history[2 * pair];
    let slipped = table.records.iter().map(|record| record.state.slip);
    assert!(slipped.clone().fold(0.0, f64::max) > 1e-4);
    for (pair, slip) in slipped.enumerate() {
        // Pairs with dashpots at an angle are solved by sweeps, with a compliance that is near theirs.
        assert!(
            (wear(pair) - slip).abs() <= 0.1 * slip,
            "{} {slip}",
            wear(pair)
        );
        assert_eq!(
            table.history[2 * pair + 1],
            if slip > 0.0 { 2.0 } else { 0.0 }
        );
    }
    let last = |name: &str| {
        let column = results.joint_histories().column(name).unwrap();
        (*column.values.last().unwrap(), column.unit)
    };
    let sum: f64 = (pairs.iter().enumerate())
        .map(|(i, pair)| pair.area * wear(i))
        .sum();
    let (mean, unit) = last("bedding.wear");
    assert!((mean / (sum / 9e4) - 1.0).abs() < 1e-12 && unit == "m");
    assert_eq!(last("bedding.worn"), (2.0, "1"));
    assert_eq!(last("corner.wear").0, wear(0));
    let columns = results.joint_histories().columns.iter();
    let of_corner = columns.filter(|column| column.name.starts_with("corner."));
    assert_eq!(of_corner.count(), 2);

    output
        .write(("cube", &mesh), &results, &RunNotes::default(), None)
        .unwrap();
    for file in [
        "joints/bedding.vtu",
        "snapshots/snapshots_00001_bedding.vtu",
    ] {
        let vtu = std::fs::read(folder.join(file)).unwrap();
        let vtu = String::from_utf8_lossy(&vtu);
        for name in ["Name=\"wear\"", "Name=\"worn\""] {
            assert!(vtu.contains(name), "{file} {name}");
        }
    }
    let header = std::fs::read_to_string(folder.join("joints.csv")).unwrap();
    assert!(header.contains("bedding.wear") && header.contains("corner.worn"));
}
