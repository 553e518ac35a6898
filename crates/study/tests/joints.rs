//! Overview of joints and warnings about them before a run.

use powerhouse::boundary::{InputMode, ViscousSpring};
use powerhouse::contact::{BondedCoulomb, JointSurface, SurfaceOptions, Tied};
use powerhouse::material::{LinearElastic, media};
use powerhouse::model::{ContactLaw, Mesh, Vec3};
use powerhouse::{Boundary, Material, Part, Scene, SceneJoint};
use powerhouse_study::{Warning, check, warnings};

/// A cube of rock of 40 m, cut at half its height, absorbing below.
fn cut(
    law: impl ContactLaw + 'static,
    change: impl Fn(&mut JointSurface),
    faces: &[&str],
) -> Scene {
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(40.0), [4; 3], "rock").unwrap();
    let (lower, upper): (Vec<u32>, Vec<u32>) = (0..64).partition(|&e| mesh.centroid(e).z < 20.0);
    let split = mesh.split_between(&lower, &upper).unwrap();
    let options = SurfaceOptions::within(1e-6).unwrap();
    let surface = JointSurface::between(&split.mesh, &split.first, &split.second, &options);
    let mut surface = surface.unwrap();
    change(&mut surface);
    let boundary = ViscousSpring {
        input: InputMode::Nothing,
        ..ViscousSpring::default()
    };
    Scene::new("cut", split.mesh)
        .part(Part::new(
            "rock",
            Material::from(LinearElastic::new(media::ROCK)),
        ))
        .with_boundary(
            Boundary::new(boundary, faces.iter().copied()).with_scatterer(Vec3::repeat(20.0)),
        )
        .joint(SceneJoint::new("bedding", surface, law))
        .with_duration(0.1)
}

fn warnings_of(scene: &Scene) -> Vec<Warning> {
    let all = warnings(scene).unwrap().into_iter();
    all.filter(|warning| !matches!(warning, Warning::NoExcitation))
        .collect()
}

/// The overview describes the surface of a joint; a joint with matching sides away from absorbing faces has no warning.
#[test]
fn joints_are_listed() {
    let friction = BondedCoulomb::unbonded(0.6, 0.5).unwrap();
    assert_eq!(warnings_of(&cut(friction, |_| {}, &["bottom"])), []);
    let report = check(cut(friction, |_| {}, &["bottom"])).unwrap();
    let [joint] = &report.joints[..] else {
        panic!("one joint")
    };
    assert_eq!(
        (joint.name.as_str(), joint.law.as_str()),
        ("bedding", "bonded-coulomb")
    );
    assert_eq!((joint.pairs, joint.worst_gap), (25, 0.0));
    assert!((joint.area - 1600.0).abs() < 1e-9 && (joint.shortest_edge - 10.0).abs() < 1e-12);
    // What is written grows with the joint.
    let plain = Scene::new(
        "whole",
        Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(40.0), [4; 3], "rock").unwrap(),
    )
    .part(Part::new(
        "rock",
        Material::from(LinearElastic::new(media::ROCK)),
    ))
    .with_duration(0.1);
    let plain = check(plain).unwrap();
    assert!(report.cost.output > plain.cost.output && report.cost.memory > plain.cost.memory);
}

/// Distant paired nodes, and joints with nodes on absorbing faces, have warnings; a tie has none.
#[test]
fn joints_have_warnings() {
    let friction = BondedCoulomb::unbonded(0.6, 0.5).unwrap();
    let apart = |surface: &mut JointSurface| {
        (surface.worst_gap, surface.worst_nodes) = (0.6, [7, 130]);
    };
    let found = warnings_of(&cut(friction, apart, &["bottom"]));
    let [
        Warning::Mismatch {
            joint,
            distance,
            nodes,
            ..
        },
    ] = &found[..]
    else {
        panic!("{found:?}")
    };
    assert_eq!(
        (joint.as_str(), *distance, *nodes),
        ("bedding", 0.6, [7, 130])
    );
    assert!(found[0].to_string().contains("are 6.000e-1 m apart"));
    let found = warnings_of(&cut(friction, |_| {}, &["bottom", "left"]));
    let [Warning::JointAtBoundary { joint, pairs: 5 }] = &found[..] else {
        panic!("{found:?}")
    };
    assert_eq!(joint, "bedding");
    assert!(found[0].to_string().contains("5 node pairs"));
    assert_eq!(warnings_of(&cut(Tied, |_| {}, &["bottom", "left"])), []);
}
