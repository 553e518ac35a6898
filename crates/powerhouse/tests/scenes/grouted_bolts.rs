//! Bolts in grout with the segments that come by default, and with too few.

use std::sync::Arc;

use powerhouse::contact::{BondedCoulomb, JointSurface, SurfaceOptions, Tied};
use powerhouse::engine::{
    BoltEnd, BoltLine, BoltParameters, FaceTraction, Grout, Profile, Support,
};
use powerhouse::material::LinearElastic;
use powerhouse::model::{ContactLaw, ElasticMedium, Mesh, Vec3};
use powerhouse::{
    BoltLayout, Material, Part, Remark, RunHooks, Scene, SceneBolts, SceneJoint, SceneStage, remark,
};

const ROCK: ElasticMedium = ElasticMedium {
    young: 2.0e9,
    poisson: 0.0,
    density: 2400.0,
};
/// Axial stiffness of the bar (N), weak beside the rock.
const AXIAL: f64 = 2.0e3;

/// Greatest force of a bolt along a rod of some bricks of 1 m that is stretched by 1e-4, over that of a bar tied to the rock, and
/// the error that is warned of.
fn stretched(
    bricks: usize,
    (share, longest): (f64, f64),
    ends: [BoltEnd; 2],
) -> (f64, Option<f64>) {
    let length = bricks as f64;
    let (high, counts) = (Vec3::new(1.0, 1.0, length), [1, 1, bricks]);
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), high, counts, "rock").unwrap();
    let nodes = |name: &str| mesh.nodes_of_facets(mesh.facet_set(name).unwrap());
    let traction = FaceTraction::new(
        &mesh,
        mesh.facet_set("top").unwrap(),
        Vec3::new(0.0, 0.0, 2.0e5),
        Profile::Uniform,
        Box::new(|_: f64| 1.0),
    )
    .unwrap();
    let mut scene = Scene::new("rod", mesh.clone())
        .part(Part::new("rock", Material::from(LinearElastic::new(ROCK))))
        .support(Support::roller(nodes("bottom"), Vec3::z()))
        .support(Support::roller(nodes("left"), Vec3::x()))
        .support(Support::roller(nodes("front"), Vec3::y()))
        .with_duration(1e-5);
    let parameters = BoltParameters {
        young: 2.0e11,
        area: AXIAL / 2.0e11,
        grout: Some(Grout {
            stiffness: AXIAL * (share / length).powi(2),
            strength: f64::INFINITY,
            head: ends[0],
            toe: ends[1],
        }),
        longest_segment: longest,
        ..BoltParameters::steel(0.025).unwrap()
    };
    let line = BoltLine {
        head: Vec3::new(0.45, 0.55, length),
        toe: Vec3::new(0.45, 0.55, 0.0),
    };
    scene = scene.with_bolts(SceneBolts {
        name: "bolt".into(),
        layout: BoltLayout::Lines(vec![line]),
        parameters,
    });
    let stages = [
        SceneStage::new("bolt").install("bolt"),
        SceneStage::new("pull").load(traction),
    ];
    let scene = stages.into_iter().fold(scene, Scene::stage);
    let simulation = scene.prepare().unwrap();
    let warned = simulation.remarks().iter().find_map(|remark| match remark {
        Remark::CoarseBolts(remark::CoarseBolts { error, .. }) => Some(*error),
        _ => None,
    });
    let results = simulation.run(RunHooks::default()).unwrap();
    let force = results
        .bolt_histories()
        .column("bolt.greatest")
        .unwrap()
        .values[0];
    (force / (AXIAL * 1e-4), warned)
}

/// The greatest force of a bolt in grout in stretched rock is that of the closed form of a bar, `1 - 1 / cosh(alpha l / 2)` of the force of
/// a tied bar between free ends and `1 - 1 / cosh(alpha l)` from an anchored one, to 5 %, in one brick and in several, with grout
/// that holds little and much; and no warning is given.
#[test]
fn bolts_in_grout_have_enough_segments() {
    use BoltEnd::{Anchored, Free};
    for bricks in [1, 3] {
        for share in [0.3, 1.0, 2.0, 4.0, 12.0] {
            for (ends, factor) in [
                ([Free, Free], 0.5),
                ([Anchored, Free], 1.0),
                ([Free, Anchored], 1.0),
            ] {
                let (found, warned) = stretched(bricks, (share, f64::INFINITY), ends);
                let right = 1.0 - 1.0 / (factor * share).cosh();
                assert!(
                    (found / right - 1.0).abs() < 0.05,
                    "{bricks} {share} {ends:?}: {found} {right}"
                );
                assert_eq!(warned, None, "{bricks} {share} {ends:?}");
            }
        }
    }
}

/// One segment, where the scene asks for it, has the force `1 / (1 + 4 / (alpha l)^2)` of a tied bar, 1.77 and 1.09 times the right
/// one for alpha l = 1 and 4; the warning has its error.
#[test]
fn too_few_segments_are_warned_of() {
    for share in [1.0, 4.0_f64] {
        let (found, warned) = stretched(1, (share, 9.0), [BoltEnd::Free; 2]);
        let one = 1.0 / (1.0 + 4.0 / (share * share));
        assert!((found / one - 1.0).abs() < 1e-3, "{share}: {found}");
        let error = one * (0.5 * share).cosh() / ((0.5 * share).cosh() - 1.0) - 1.0;
        assert!(
            (warned.unwrap() - error).abs() < 1e-3,
            "{share}: {warned:?} {error}"
        );
    }
    assert_eq!(stretched(1, (4.0, 0.1), [BoltEnd::Free; 2]).1, None);
}

/// Bolts without grout that cross a joint which may move are warned of, with their number, at any height and inclination of the
/// bolts; those in grout, beside the joint or across a tie are not.
#[test]
fn bolts_that_a_joint_cuts_are_warned_of() {
    let (size, counts) = (Vec3::new(2.0, 1.0, 4.0), [4, 2, 8]);
    let warned = |height: f64, law: Arc<dyn ContactLaw>, grouted: bool| {
        let mesh = Mesh::box_of_hexes(Vec3::zeros(), size, counts, "rock").unwrap();
        let all = 0..mesh.element_count() as u32;
        let (lower, upper): (Vec<u32>, Vec<u32>) =
            all.partition(|&element| mesh.centroid(element).z < height);
        let split = mesh.split_between(&lower, &upper).unwrap();
        let options = SurfaceOptions::within(1e-6).unwrap();
        let surface = JointSurface::between(&split.mesh, &split.first, &split.second, &options);
        let nodes = |name: &str| {
            split
                .mesh
                .nodes_of_facets(split.mesh.facet_set(name).unwrap())
        };
        let line = |head: [f64; 3], toe: [f64; 3]| BoltLine {
            head: head.into(),
            toe: toe.into(),
        };
        let grout = Grout {
            stiffness: 1e7,
            strength: f64::INFINITY,
            head: BoltEnd::Free,
            toe: BoltEnd::Free,
        };
        let bolts = SceneBolts {
            name: "bolts".into(),
            layout: BoltLayout::Lines(vec![
                line([0.3, 0.4, 4.0], [0.3, 0.4, 0.6]),
                line([0.2, 0.3, 3.9], [1.7, 0.8, 0.6]),
                line([0.3, 0.4, 4.0], [1.1, 0.6, 3.2]),
            ]),
            parameters: BoltParameters {
                grout: grouted.then_some(grout),
                ..BoltParameters::steel(0.025).unwrap()
            },
        };
        let scene = Scene::new("cut", split.mesh.clone())
            .part(Part::new("rock", Material::from(LinearElastic::new(ROCK))))
            .support(Support::fixed(nodes("bottom")))
            .with_duration(1e-5)
            .with_bolts(bolts)
            .joint(SceneJoint::new("seam", surface.unwrap(), law))
            .stage(SceneStage::new("bolts").install("bolts"));
        let simulation = scene.prepare().unwrap();
        simulation.remarks().iter().find_map(|remark| match remark {
            Remark::CutBolts(remark::CutBolts {
                bolts,
                joint,
                crossing,
            }) => {
                assert_eq!((bolts.as_str(), joint.as_str()), ("bolts", "seam"));
                Some(*crossing)
            }
            _ => None,
        })
    };
    let friction = || Arc::new(BondedCoulomb::unbonded(0.5, 0.5).unwrap());
    assert_eq!(warned(2.0, friction(), false), Some(2));
    assert_eq!(warned(3.5, friction(), false), Some(3));
    assert_eq!(warned(2.0, friction(), true), None);
    assert_eq!(warned(0.5, friction(), false), None);
    assert_eq!(warned(2.0, Arc::new(Tied), false), None);
}
