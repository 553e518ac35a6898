//! Initial states of joints: every key of a scene file is equivalent to Rust, and errors are the same in both.

use powerhouse::contact::ContactError;
use powerhouse::model::{Bond, ContactState, Mesh, Stress, Vec3};
use powerhouse::{Error, GroundStress, InitialGap, JointZone, Preload, SceneJoint};

use super::joints::{JOINT, folder, halves, read, twin};
use super::support::*;

/// The halves with sets of nodes, facets and elements about the corner x = y = 0.
fn marked() -> Mesh {
    let mut mesh = halves();
    let (low, high) = (Vec3::new(0.0, 0.0, -150.0), Vec3::new(50.0, 50.0, -150.0));
    let nodes = mesh.nodes_in_box(&low, &high);
    mesh.set_node_set("corner nodes", nodes).unwrap();
    let (low, high) = (Vec3::new(0.0, 0.0, -200.0), Vec3::new(50.0, 50.0, -100.0));
    let elements = mesh.elements_in_box(&low, &high);
    mesh.set_element_set("corner", elements).unwrap();
    mesh
}

/// Keys of a joint without bond, which may have a gap.
const FREE: &str = "law = \"bonded-coulomb\"\nstatic_friction = 0.7\n";

/// Keys of the joint with further ones before its law.
fn with(keys: &str) -> String {
    JOINT.replace("law =", &format!("{keys}\nlaw ="))
}

/// Runs the joint with further keys and its counterpart in Rust, compares the bits, and returns the records of the pairs
/// at the end.
fn equal(keys: &str, change: impl Fn(SceneJoint) -> SceneJoint) -> powerhouse::Results {
    let folder = folder("joint-start");
    powerhouse::io::write_gmsh(folder.join("cube.msh"), &marked()).unwrap();
    let text = if keys.contains("law =") {
        let end = JOINT.find("law =").unwrap();
        format!("{}{keys}", &JOINT[..end])
    } else {
        with(keys)
    };
    let (mesh, joint) = twin(&marked());
    let twin = cube_scene_of(mesh, &["lower", "upper"]).joint(change(joint));
    let scene = read(&folder, &text).unwrap_or_else(|error| panic!("{keys}: {error}"));
    let (file, twin) = (run(scene), run(twin));
    assert_eq!(file.histories(), twin.histories(), "{keys}");
    assert_eq!(file.joints, twin.joints, "{keys}");
    file
}

/// Every kind of preload equals that of Rust: same bits; the joint carries its traction while it sticks.
#[test]
fn preloads() {
    let ground = GroundStress::new(0.0, 2750.0, 0.4).unwrap();
    let weight = 2750.0 * 9.81 * 150.0;
    let stress = Stress([-1e6, -2e6, -3e6, 0.0, 2e5, -1e5]);
    let traction = Vec3::new(1e5, -5e4, -2e6);
    for (keys, preload, expected) in [
        (
            "preload = { kind = \"pressure\", pressure = 2e6 }",
            Preload::Pressure(2e6),
            Vec3::new(0.0, 0.0, -2e6),
        ),
        (
            "preload = { kind = \"traction\", traction = [1e5, -5e4, -2e6] }",
            Preload::Traction(traction),
            traction,
        ),
        (
            "preload = { kind = \"stress\", stress = [-1e6, -2e6, -3e6, 0, 2e5, -1e5] }",
            Preload::Stress(stress),
            Vec3::new(-1e5, 2e5, -3e6),
        ),
        (
            "preload = { kind = \"ground\", level = 0, density = 2750, lateral = 0.4 }",
            Preload::Ground(ground),
            Vec3::new(0.0, 0.0, -weight),
        ),
    ] {
        equal(keys, |joint| joint.with_preload(preload));
        let (mesh, joint) = twin(&halves());
        let scene = cube_scene_of(mesh, &["lower", "upper"]).joint(joint.with_preload(preload));
        let simulation = scene.prepare().unwrap();
        let joints = simulation.model().output().unwrap().joints();
        let view = &joints[0];
        for (pair, record) in view.pairs.iter().zip(view.records) {
            let carried = pair.to_global(&record.traction);
            assert!((carried - expected).norm() < 1e-9 * weight, "{keys}");
        }
    }
    let vertical = ground.at(-100.0);
    assert_eq!(vertical.0[0], 0.4 * vertical.0[2]);
    assert_eq!(ground.at(3.0), Stress::default());
    for (level, density, lateral) in [
        (f64::NAN, 2750.0, 0.4),
        (0.0, 0.0, 0.4),
        (0.0, 2750.0, -0.1),
    ] {
        assert!(GroundStress::new(level, density, lateral).is_err());
    }
}

/// A gap from a file equals that of Rust: same bits; open pairs have no traction, and a closed mesh has no gap.
#[test]
fn gaps() {
    let free = |joint: SceneJoint| {
        let law = powerhouse::contact::BondedCoulomb::unbonded(0.7, 0.7).unwrap();
        SceneJoint::new(joint.name, joint.surface, law)
    };
    let wide = equal(&format!("gap = 0.5\n{FREE}"), |joint| {
        free(joint).with_gap(InitialGap::Distance(0.5))
    });
    let records = &wide.joints[0].records;
    assert!(
        records
            .iter()
            .all(|r| r.state.contact == ContactState::Open)
    );
    assert!(
        records
            .iter()
            .all(|r| r.traction == Vec3::zeros() && r.opening > 0.4)
    );
    let meshed = equal(&format!("gap = \"meshed\"\n{FREE}"), |joint| {
        free(joint).with_gap(InitialGap::Meshed)
    });
    let closed = equal(FREE, free);
    assert_eq!(meshed.joints, closed.joints);
    assert!(closed.joints[0].records.iter().any(|r| r.opening < 0.4));
}

/// Sides that are apart in the mesh have the gap of their nodes with `gap = "meshed"`.
#[test]
fn a_meshed_gap_is_the_distance_of_the_nodes() {
    let (mesh, joint) = twin(&halves());
    let second: Vec<u32> = joint
        .surface
        .pairs
        .iter()
        .map(|pair| pair.nodes[1])
        .collect();
    let next = std::cell::Cell::new(0);
    let apart = mesh.map_positions(|p| {
        let node: u32 = next.replace(next.get() + 1);
        let lift = if second.contains(&node) {
            1e-4 * p.x
        } else {
            0.0
        };
        Vec3::new(p.x, p.y, p.z + lift)
    });
    let apart = apart.unwrap();
    let law = powerhouse::contact::BondedCoulomb::unbonded(0.7, 0.7).unwrap();
    let joint = SceneJoint::new("bedding", joint.surface, law).with_gap(InitialGap::Meshed);
    let scene = cube_scene_of(apart, &["lower", "upper"]).joint(joint);
    let simulation = scene.with_duration(1e-9).prepare().unwrap();
    let model = simulation.model();
    let joints = model.output().unwrap().joints();
    let view = &joints[0];
    for (pair, record) in view.pairs.iter().zip(view.records) {
        let x = simulation.mesh().positions()[pair.nodes[0] as usize].x;
        let open = record.state.contact == ContactState::Open;
        assert_eq!(open, x > 0.0, "{x}");
    }
}

/// Every kind of zone selects the same unbonded pairs as its counterpart in Rust.
#[test]
fn unbonded_zones() {
    let corner = (Vec3::new(0.0, 0.0, -151.0), Vec3::new(50.0, 50.0, -149.0));
    let near = Vec3::new(99.0, 101.0, -150.0);
    for (keys, zone, count) in [
        (
            "{ low = [0, 0, -151], high = [50, 50, -149] }",
            JointZone::Box {
                low: corner.0,
                high: corner.1,
            },
            4,
        ),
        (
            "{ set = \"corner nodes\" }",
            JointZone::Set("corner nodes".into()),
            4,
        ),
        ("{ set = \"corner\" }", JointZone::Set("corner".into()), 4),
        // The facets of one side wall: those of its nodes that are on the joint.
        ("{ set = \"left\" }", JointZone::Set("left".into()), 7),
        (
            "{ at = [99, 101, -150], within = 2 }",
            JointZone::Near {
                position: near,
                within: 2.0,
            },
            1,
        ),
        ("{ node = 172 }", JointZone::Node(172), 1),
    ] {
        let pressed = "preload = { kind = \"pressure\", pressure = 1e5 }\n";
        let keys = format!("{pressed}unbonded = [{keys}]");
        let preload = Preload::Pressure(1e5);
        let results = equal(&keys, |joint| {
            joint.with_preload(preload).with_unbonded(zone.clone())
        });
        let records = &results.joints[0].records;
        let never = records.iter().filter(|r| r.state.bond == Bond::Never);
        assert_eq!(never.count(), count, "{keys}");
    }
    // Several zones add up.
    let keys = "unbonded = [{ node = 172 }, { set = \"left\" }]";
    let results = equal(keys, |joint| {
        let zones = [JointZone::Node(172), JointZone::Set("left".into())];
        zones.into_iter().fold(joint, SceneJoint::with_unbonded)
    });
    let records = results.joints[0].records.iter();
    let never = records.filter(|r| r.state.bond == Bond::Never).count();
    assert_eq!(never, 8);
}

/// An invalid initial state of a joint is an error of the builder with the node numbers of the mesh file.
#[test]
fn the_builder_refuses_with_the_numbers_of_the_mesh() {
    let refused = |change: &dyn Fn(SceneJoint) -> SceneJoint| -> Error {
        let (mesh, joint) = twin(&halves());
        let scene = cube_scene_of(mesh, &["lower", "upper"]).joint(change(joint));
        scene.prepare().map(|_| ()).unwrap_err()
    };
    let error = refused(&|joint| joint.with_preload(Preload::Traction(Vec3::new(0.0, 0.0, 5e4))));
    let Error::Joint { joint, source, .. } = &error else {
        panic!("{error}")
    };
    assert_eq!(joint, "bedding");
    assert!(matches!(source, ContactError::Preload { normal, .. } if *normal == 5e4));
    let error = refused(&|joint| joint.with_gap(InitialGap::Distance(-1e-3)));
    assert!(
        matches!(error, Error::Joint { source: ContactError::Gap { gap, .. }, .. } if gap == -1e-3)
    );
    let bare = |joint: SceneJoint| {
        let law = powerhouse::contact::Tied;
        SceneJoint::new(joint.name, joint.surface, law).with_unbonded(JointZone::All)
    };
    let Error::Joint {
        first,
        second,
        source,
        ..
    } = refused(&bare)
    else {
        panic!("a bond was taken from a tie")
    };
    let (mesh, joint) = twin(&halves());
    let nodes = joint.surface.pairs[0]
        .nodes
        .map(|node| mesh.node_tags()[node as usize]);
    assert_eq!(
        ([first, second], source.pair()),
        (nodes, Some(joint.surface.pairs[0].nodes))
    );
    let near = JointZone::Near {
        position: Vec3::new(0.0, 0.0, -149.0),
        within: 0.5,
    };
    let error = refused(&|joint| joint.with_unbonded(near.clone()));
    assert!(
        matches!(error, Error::EmptyZone { distance: Some(d), .. } if d == 1.0),
        "{error}"
    );
    let error = refused(&|joint| joint.with_unbonded(JointZone::Set("lid".into())));
    assert!(matches!(error, Error::Mesh(_)), "{error}");
    let error = refused(&|joint| joint.with_preload(Preload::Pressure(f64::NAN)));
    assert!(matches!(error, Error::Parameter(_)), "{error}");
}
