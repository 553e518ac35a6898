//! Output of joints: keys and builder are equivalent, content of columns and files.

use powerhouse::engine::observe::JointQuantities;
use powerhouse::io::read_table;
use powerhouse::model::{Bond, ContactState, JointRecord, Vec3};
use powerhouse::{
    Error, JointRequest, JointZone, OutputPlan, ResultFolder, RunHooks, RunNotes, SnapshotRequest,
};

use super::joints::{JOINT, folder, halves, read, twin};
use super::support::*;

/// The halves of the joint, x < 150 m and the rest.
fn half(low: f64, high: f64) -> JointZone {
    JointZone::Box {
        low: Vec3::new(low, 0.0, -151.0),
        high: Vec3::new(high, 300.0, -149.0),
    }
}

/// Every key of a joint history gives the request of the Rust interface.
#[test]
fn requests() {
    let folder = folder("joint-requests");
    let near = |within| JointZone::Near {
        position: Vec3::new(150.0, 150.0, -150.0),
        within,
    };
    let all = JointQuantities::ALL;
    let some = |f: fn(&mut JointQuantities)| {
        let mut quantities = JointQuantities::default();
        f(&mut quantities);
        quantities
    };
    for (keys, zone, quantities) in [
        ("", JointZone::All, all),
        ("at = [150, 150, -150]", near(1e-3), all),
        ("at = [150, 150, -150]\nwithin = 3", near(3.0), all),
        ("node = 172", JointZone::Node(172), all),
        ("set = \"left\"", JointZone::Set("left".into()), all),
        (
            "low = [0, 0, -151]\nhigh = [140, 300, -149]",
            half(0.0, 140.0),
            all,
        ),
        (
            "quantities = [\"state\"]",
            JointZone::All,
            some(|q| q.state = true),
        ),
        (
            "quantities = [\"slip\"]",
            JointZone::All,
            some(|q| q.slip = true),
        ),
        (
            "quantities = [\"opening\"]",
            JointZone::All,
            some(|q| q.opening = true),
        ),
        (
            "quantities = [\"peak-opening\"]",
            JointZone::All,
            some(|q| q.peak_opening = true),
        ),
        (
            "quantities = [\"traction\"]",
            JointZone::All,
            some(|q| q.traction = true),
        ),
        (
            "quantities = [\"friction\"]",
            JointZone::All,
            some(|q| q.friction = true),
        ),
        (
            "quantities = [\"bond\"]",
            JointZone::All,
            some(|q| q.bond = true),
        ),
        (
            "quantities = [\"impact\", \"slip\"]",
            JointZone::All,
            some(|q| (q.impact, q.slip) = (true, true)),
        ),
    ] {
        let history = "[[output.joint]]\nname = \"p\"\njoint = \"bedding\"\n";
        // The joint history is part of the plan.
        let text = format!("{JOINT}\n{history}{keys}\n");
        let scene = read(&folder, &text).unwrap_or_else(|error| panic!("{keys}: {error}"));
        let request = JointRequest::new("p", "bedding", zone, quantities);
        assert_eq!(scene.output().joints, [request], "{keys}");
        scene
            .prepare()
            .unwrap_or_else(|error| panic!("{keys}: {error}"));
    }
}

/// A plan with a joint or zone that does not exist is an error before the run.
#[test]
fn requests_without_pairs_are_refused() {
    let prepared = |joint: &str, zone: JointZone| {
        let (mesh, bedding) = twin(&halves());
        let plan = OutputPlan::default().joint("p", joint, zone, JointQuantities::ALL);
        let scene = cube_scene_of(mesh, &["lower", "upper"]).joint(bedding);
        scene.with_output(plan).prepare().map(|_| ()).unwrap_err()
    };
    let error = prepared("seam", JointZone::All);
    assert!(matches!(error, Error::NoSuchJoint { name } if name == "seam"));
    let error = prepared("bedding", half(400.0, 500.0));
    assert!(matches!(error, Error::EmptyZone { .. }), "{error}");
    // Two results with one name.
    let (mesh, bedding) = twin(&halves());
    let plan =
        OutputPlan::default().joint("bedding", "bedding", JointZone::All, JointQuantities::ALL);
    let scene = cube_scene_of(mesh, &["lower", "upper"]).joint(bedding);
    let error = scene.with_output(plan).prepare().map(|_| ()).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("two results have the name 'bedding'"),
        "{error}"
    );
}

/// The columns of a single pair agree with its record, those of two halves add up to the whole, and the outcomes contain
/// the times of first slip and crack; all is in the files.
#[test]
fn columns_hold_the_contact_states_of_the_pairs() {
    let (mesh, joint) = twin(&halves());
    let pairs = joint.surface.pairs.clone();
    let mut plan = OutputPlan::default()
        .joint("west", "bedding", half(0.0, 140.0), JointQuantities::ALL)
        .joint("east", "bedding", half(140.0, 300.0), JointQuantities::ALL);
    plan.every = 0.005;
    for (index, pair) in pairs.iter().enumerate() {
        let node = JointZone::Node(mesh.node_tags()[pair.nodes[0] as usize]);
        plan = plan.joint(
            &format!("pair {index}"),
            "bedding",
            node,
            JointQuantities::ALL,
        );
    }
    let scene = cube_scene_of(mesh, &["lower", "upper"])
        .joint(joint)
        .with_output(plan);
    let mesh = scene.mesh().clone();
    let results = run(scene);
    let last = |name: &str| {
        let column = results.joint_histories().column(name);
        *column
            .unwrap_or_else(|| panic!("{name}"))
            .values
            .last()
            .unwrap()
    };
    let table = &results.joints[0];
    let is = |yes: bool| f64::from(u8::from(yes));
    for (index, r) in table.records.iter().enumerate() {
        let of = |quantity: &str| last(&format!("pair {index}.{quantity}"));
        let JointRecord { state, .. } = r;
        assert_eq!(of("sliding"), is(state.contact == ContactState::Slide));
        assert_eq!(of("open"), is(state.contact == ContactState::Open));
        assert_eq!(of("broken"), is(state.bond == Bond::Broken));
        assert_eq!((of("slip"), of("opening")), (r.slip(), r.opening));
        assert_eq!(
            (of("peak_opening"), of("impact")),
            (r.peak_opening, r.impact)
        );
        assert_eq!((of("friction"), of("bond")), (r.friction, r.bond_energy));
        let shear = r.traction.y.hypot(r.traction.z);
        let close = |a: f64, b: f64| (a - b).abs() <= 1e-12 * b.abs();
        assert!(close(of("normal"), r.traction.x) && close(of("shear"), shear));
        // Greatest tractions are those of the column, with their times.
        let column = |quantity: &str| {
            let name = format!("pair {index}.{quantity}");
            results
                .joint_histories()
                .column(&name)
                .unwrap()
                .values
                .clone()
        };
        let greatest = column("normal").into_iter().fold(f64::MIN, f64::max);
        let peak = &table.tractions.greatest_normal;
        assert!(
            close(peak.values[index], greatest),
            "{} {greatest}",
            peak.values[index]
        );
        let row = results
            .joint_histories()
            .times
            .iter()
            .position(|&t| t == peak.times[index]);
        assert!(close(column("normal")[row.unwrap()], greatest));
        let least = column("normal").into_iter().fold(f64::MAX, f64::min);
        assert!(close(table.tractions.least_normal.values[index], least));
        let shear = column("shear").into_iter().fold(f64::MIN, f64::max);
        assert!(close(table.tractions.greatest_shear.values[index], shear));
    }
    for sum in ["friction", "bond", "impact"] {
        let [west, east, all] =
            ["west", "east", "bedding"].map(|name| last(&format!("{name}.{sum}")));
        assert!(
            all > 0.0 && (west + east - all).abs() < 1e-12 * all,
            "{sum}"
        );
    }
    let [west, east, all] = ["west", "east", "bedding"].map(|name| last(&format!("{name}.broken")));
    // Columns of pairs at 0, 50 and 100 m have 2.5 of 6 parts of the area.
    assert!((west * 2.5 / 6.0 + east * 3.5 / 6.0 - all).abs() < 1e-12 && all > 0.0);
    assert_eq!(
        last("west.slip").max(last("east.slip")),
        last("bedding.slip")
    );

    let outcome = |name: &str| {
        results
            .joint_outcomes
            .iter()
            .find(|o| o.name == name)
            .unwrap()
    };
    let whole = outcome("bedding");
    assert_eq!((whole.pairs, outcome("west").pairs), (49, 21));
    assert!((whole.area - 9e4).abs() < 1e-6 && (outcome("west").area - 3.75e4).abs() < 1e-6);
    let first = |time: fn(&JointRecord) -> Option<f64>| {
        table.records.iter().filter_map(time).reduce(f64::min)
    };
    let slid = whole.first_slip.unwrap();
    assert_eq!(Some(slid.0), first(|r| r.first_slip));
    assert_eq!(table.records[slid.1].first_slip, Some(slid.0));
    let cracked = whole.first_crack.unwrap();
    assert_eq!(Some(cracked.0), first(|r| r.first_crack));
    assert_eq!(table.records[cracked.1].first_crack, Some(cracked.0));
    let of = |name: &str| outcome(name).first_slip.unwrap().0;
    let earliest = of("west").min(of("east"));
    assert_eq!(slid.0, earliest);
    // The index of a pair is that among all pairs of the joint, also for a zone.
    let east = outcome("east");
    let (slip, pair) = east.slip;
    assert_eq!(
        (table.records[pair].slip(), slip),
        (slip, last("east.slip"))
    );
    let (opening, pair) = east.peak_opening;
    assert_eq!(table.records[pair].peak_opening, opening);
    assert!(mesh.positions()[pairs[pair].nodes[0] as usize].x >= 140.0);
    assert_eq!(
        (whole.never_bonded, whole.broken),
        (0.0, last("bedding.broken"))
    );
    assert!(whole.slipped > 0.0 && whole.slipped <= 1.0 + 1e-12 && whole.opened > 0.0);
    // A history of states begins at the first time.
    let times = results.joint_histories().times.iter();
    let sliding = &results
        .joint_histories()
        .column("bedding.sliding")
        .unwrap()
        .values;
    let seen = times
        .zip(sliding)
        .find(|(_, share)| **share > 0.0)
        .unwrap()
        .0;
    assert!(
        *seen >= earliest && *seen - earliest < 0.03,
        "{seen} {earliest}"
    );

    let folder = Folder::new("joint-columns");
    let output = ResultFolder::new(&folder);
    let written = output
        .write(("cube", &mesh), &results, &RunNotes::default(), None)
        .unwrap();
    for name in [
        "joints.csv",
        "joints/bedding.vtu",
        "plots/joint-west.svg",
        "plots/joint-bedding.svg",
        "pictures/joint-bedding-state.png",
        "pictures/joint-bedding-bond.png",
        "pictures/joint-bedding-slip.png",
        "pictures/joint-bedding-peak-opening.png",
    ] {
        assert!(written.contains(&folder.join(name)), "{name}: {written:?}");
    }
    let columns = read_table(&folder.join("joints.csv")).unwrap();
    let friction = columns.iter().find(|c| c.name == "west.friction").unwrap();
    assert_eq!(*friction.values.last().unwrap(), last("west.friction"));
    let summary = std::fs::read_to_string(folder.join("summary.json")).unwrap();
    for key in [
        "\"first_slip\"",
        "\"first_crack_node\"",
        "\"never_bonded\"",
        "\"west\"",
        "\"slipped\"",
    ] {
        assert!(summary.contains(key), "{key}: {summary}");
    }
    let vtu = std::fs::read(folder.join("joints/bedding.vtu")).unwrap();
    let vtu = String::from_utf8_lossy(&vtu);
    for field in [
        "greatest normal traction",
        "time of least normal traction",
        "time of first crack",
    ] {
        assert!(vtu.contains(field), "{field}");
    }
    output.clear().unwrap();
    assert!(!folder.join("plots/joint-west.svg").exists());
    assert!(!folder.join("pictures/joint-bedding-slip.png").exists());
}

/// Snapshots contain the facets of each joint beside the body, and are removed with them.
#[test]
fn snapshots_hold_joints() {
    let (mesh, joint) = twin(&halves());
    let mut scene = cube_scene_of(mesh, &["lower", "upper"]).joint(joint);
    let mut plan = scene.output().clone();
    plan.snapshots = Some(SnapshotRequest::new(0.2));
    scene = scene.with_output(plan);
    let simulation = scene.prepare().unwrap();
    let folder = Folder::new("joint-snapshots");
    let output = ResultFolder::new(&folder);
    let sink = output.snapshots(&simulation).unwrap();
    let hooks = RunHooks::default().with_snapshots(sink);
    let results = simulation.run(hooks).unwrap();
    assert_eq!(results.snapshots, 4);
    let collection = std::fs::read_to_string(folder.join("snapshots.pvd")).unwrap();
    let entries: Vec<&str> = collection
        .lines()
        .filter(|line| line.contains("<DataSet"))
        .collect();
    assert_eq!(entries.len(), 8);
    for (place, entry) in entries.iter().enumerate() {
        let part = place % 2;
        assert!(entry.contains(&format!("part=\"{part}\"")), "{entry}");
        let file = entry
            .split("file=\"")
            .nth(1)
            .unwrap()
            .split('"')
            .next()
            .unwrap();
        assert_eq!(file.ends_with("_bedding.vtu"), part == 1, "{file}");
        let vtu = std::fs::read(folder.join(file)).unwrap();
        let vtu = String::from_utf8_lossy(&vtu);
        let size = if part == 1 {
            "NumberOfPoints=\"144\" NumberOfCells=\"36\""
        } else {
            "NumberOfPoints=\"392\" NumberOfCells=\"216\""
        };
        assert!(vtu.contains(size), "{}", &vtu[..400]);
        assert_eq!(vtu.contains("Name=\"peak opening\""), part == 1);
    }
    output.clear().unwrap();
    assert_eq!(
        std::fs::read_dir(folder.join("snapshots")).unwrap().count(),
        0
    );
}
