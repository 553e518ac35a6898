//! Boundaries, joints, loads, prescribed motions and ties, one by one.

use core::f64::consts::TAU;

use powerhouse_boundary::ViscousSpring;
use powerhouse_contact::{
    BondedCoulomb, BondedCoulombParameters, Joint, JointSurface, SurfaceOptions,
};
use powerhouse_elements::{FacePressure, NodalForce, Profile};
use powerhouse_material_damage::media;
use powerhouse_model::{
    AbsorbingBoundary, BoundarySite, Mesh, PeriodicPairs, Prescribed, Support, Vec3,
};
use powerhouse_tests::oblique_waves;
use powerhouse_wavefield::WaveKind;

use super::{Case, boxed, face};

const SIDES: [&str; 5] = ["left", "right", "front", "back", "bottom"];

/// Springs and dashpots at any angle, and the waves that enter through them.
#[test]
fn boundaries_absorb_alike() {
    let mesh = boxed(Mesh::box_of_hexes, 0.05);
    let faces = SIDES.map(|side| (side, mesh.facet_set(side).unwrap()));
    // The free surface is above the highest node of the bent box.
    let size = Vec3::new(3.5, 2.5, 2.1);
    let field = oblique_waves(media::ROCK, size, &[(WaveKind::SV, 20.0)], 37.0, 5e-3);
    let middle = Vec3::new(1.7, 1.2, 2.0);
    let site = BoundarySite::from_mesh(&mesh, &faces, |_| media::ROCK, middle, Some(&field));
    for speed in [0.0, 0.5] {
        let case = Case {
            name: format!("boundary, initial velocity {speed}"),
            mesh: &mesh,
            speed,
            conditions: &|spec| spec.boundary(ViscousSpring::default().build(&site).unwrap()),
        };
        case.check_elastic();
    }
}

/// A joint whose bond cracks, and which then slides, opens and closes.
#[test]
fn joints_move_alike() {
    let whole = Mesh::box_of_hexes(Vec3::zeros(), Vec3::new(2.0, 2.0, 4.0), [3, 3, 6], "rock");
    let whole = whole.unwrap();
    let half = |below: bool| -> Vec<u32> {
        let inside = |&e: &u32| (whole.centroid(e).z < 2.0) == below;
        (0..whole.element_count() as u32).filter(inside).collect()
    };
    let split = whole
        .clone()
        .split_between(&half(true), &half(false))
        .unwrap();
    let options = SurfaceOptions::within(1e-6).unwrap();
    let surface = JointSurface::between(&split.mesh, &split.first, &split.second, &options);
    let surface = surface.unwrap();
    let law = BondedCoulomb::new(BondedCoulombParameters {
        cohesion: 2e5,
        tensile_strength: 1e5,
        static_friction: 0.6,
        dynamic_friction: 0.4,
        cohesion_loss: true,
    });
    let law = law.unwrap();
    let bottom = face(&split.mesh, "bottom");
    let apart = |motion: &super::Motion| {
        let pairs = surface.pairs.iter().map(|pair| pair.nodes);
        let gaps = pairs.map(|[a, b]| (motion.0[0][a as usize] - motion.0[0][b as usize]).norm());
        gaps.fold(0.0, f64::max)
    };
    let case = Case {
        name: "joint".into(),
        mesh: &split.mesh,
        speed: 0.1,
        conditions: &|spec| {
            let joint = Joint::new("joint", surface.pairs.clone(), law).unwrap();
            spec.support(Support::fixed(bottom.clone()))
                .constraint(Box::new(joint))
        },
    };
    let motion = case.check_elastic();
    assert!(apart(&motion) > 1e-6, "the joint stays bonded");
}

/// Prescribed motions along oblique directions, beside a support.
#[test]
fn prescribed_motions_are_alike() {
    let mesh = boxed(Mesh::box_of_hexes, 0.05);
    let (bottom, top) = (face(&mesh, "bottom"), face(&mesh, "top"));
    let case = Case {
        name: "prescribed motion".into(),
        mesh: &mesh,
        speed: 0.0,
        conditions: &|spec| {
            let prescribed = |direction: Vec3, frequency: f64| Prescribed {
                nodes: bottom.clone(),
                direction,
                displacement: Box::new(move |t: f64| 1e-3 * (1.0 - (TAU * frequency * t).cos())),
            };
            spec.support(Support::roller(bottom.clone(), Vec3::z()))
                .prescribed(prescribed(Vec3::new(1.0, 0.4, 0.3), 300.0))
                .support(Support::roller(top.clone(), Vec3::new(0.1, 0.2, 1.0)))
        },
    };
    case.check_elastic();
}

/// Forces of nodes, pressures of faces and weight.
#[test]
fn loads_act_alike() {
    let mesh = boxed(Mesh::box_of_hexes, 0.05);
    let (bottom, top) = (face(&mesh, "bottom"), face(&mesh, "top"));
    let wave = |size: f64, frequency: f64| move |t: f64| size * (TAU * frequency * t).sin();
    let right = mesh.facet_set("right").unwrap();
    for load in ["nodal force", "pressure", "weight"] {
        let case = Case {
            name: load.into(),
            mesh: &mesh,
            speed: 0.0,
            conditions: &|spec| {
                let spec = spec.support(Support::fixed(bottom.clone()));
                let history = Box::new(wave(2e5, 250.0));
                match load {
                    "nodal force" => {
                        let direction = Vec3::new(1.0, 0.5, -0.2);
                        spec.load(Box::new(NodalForce::new(top.clone(), direction, history)))
                    }
                    "pressure" => {
                        let profile = Profile::Depth {
                            gradient: 1.0,
                            level: 2.5,
                        };
                        let pressure = FacePressure::new(&mesh, right, profile, history);
                        spec.load(Box::new(pressure.unwrap()))
                    }
                    _ => spec.gravity(Vec3::new(0.1, 0.2, -9.81), Box::new(wave(1.0, 250.0))),
                }
            },
        };
        case.check_elastic();
    }
}

/// Nodes that are tied move as one.
#[test]
fn tied_nodes_move_alike() {
    let mesh = boxed(Mesh::box_of_hexes, 0.0);
    let pairs = |from: &str, to: &str| {
        PeriodicPairs::by_translation(&mesh, &face(&mesh, from), &face(&mesh, to), 1e-6).unwrap()
    };
    let (along, across) = (pairs("left", "right"), pairs("front", "back"));
    let (bottom, top) = (face(&mesh, "bottom"), face(&mesh, "top"));
    let case = Case {
        name: "ties".into(),
        mesh: &mesh,
        speed: 0.0,
        conditions: &|spec| {
            let history = Box::new(|t: f64| 2e5 * (TAU * 250.0 * t).sin());
            let direction = Vec3::new(1.0, 0.5, -0.2);
            spec.periodic(along.clone())
                .periodic(across.clone())
                .support(Support::fixed(bottom.clone()))
                .load(Box::new(NodalForce::new(top.clone(), direction, history)))
        },
    };
    case.check_elastic();
}
