//! Joints that a stage grouts in their current position, after gaps, opening or slip.

use powerhouse::contact::{BondedCoulomb, BondedCoulombParameters, JointSurface, SurfaceOptions};
use powerhouse::engine::{NodalForce, SolidKernel, StaticMethod, StaticOptions, Support};
use powerhouse::material::LinearElastic;
use powerhouse::model::{Bond, ContactState, ElasticMedium, JointRecord, Mesh, Vec3};
use powerhouse::{
    EquilibratedBody, InitialGap, JointZone, Material, Part, Remark, Results, RunHooks, Scene,
    SceneJoint, SceneStage,
};

use super::support::Folder;

const YOUNG: f64 = 2.0e9;
/// Of the bond, both in tension and in shear (Pa).
const STRENGTH: f64 = 1.0e6;
const RELAXED: StaticMethod = StaticMethod::DynamicRelaxation;
const GRADIENTS: StaticMethod = StaticMethod::ConjugateGradients;

/// Two blocks on each other along an axis, each of two layers of 2 x 2 bricks, held at both ends:
///
/// ```text
/// |== . == : == f == |    : the joint, f where forces act
/// ```
///
/// Of Poisson's ratio zero, so that all layers have one tension or one shear: a force `F` at f gives a
/// bonded joint `F / 4`, an open or slippery one moves the upper side by `F / k` of a layer's stiffness k.
#[derive(Clone, Copy)]
struct Blocks {
    axis: usize,
    /// Edge of a brick (m) along the axis and across it.
    edge: [f64; 2],
}

const SEVERAL: [Blocks; 3] = [
    Blocks {
        axis: 2,
        edge: [1.0, 1.0],
    },
    Blocks {
        axis: 0,
        edge: [0.4, 1.5],
    },
    Blocks {
        axis: 1,
        edge: [3.0, 0.7],
    },
];

/// Initial state and stages of the blocks.
struct Plan {
    gap: f64,
    /// Whether the joint starts without the bond of its law.
    loose: bool,
    stages: Vec<SceneStage>,
}

impl Blocks {
    fn area(&self) -> f64 {
        (2.0 * self.edge[1]).powi(2)
    }
    /// The stiffness of a layer (N/m) along the axis or across it.
    fn stiffness(&self, direction: usize) -> f64 {
        let modulus = if direction == self.axis {
            YOUNG
        } else {
            0.5 * YOUNG
        };
        modulus * self.area() / self.edge[0]
    }
    fn mesh(&self) -> (Mesh, JointSurface) {
        let mut high = Vec3::repeat(2.0 * self.edge[1]);
        high[self.axis] = 4.0 * self.edge[0];
        let mut counts = [2; 3];
        counts[self.axis] = 4;
        let mut mesh = Mesh::box_of_hexes(Vec3::zeros(), high, counts, "all").unwrap();
        let middle = 2.0 * self.edge[0];
        let below = |&e: &u32| mesh.centroid(e)[self.axis] < middle;
        let all = 0..mesh.element_count() as u32;
        let (lower, upper): (Vec<u32>, Vec<u32>) = all.partition(below);
        mesh.set_element_set("lower", lower.clone()).unwrap();
        mesh.set_element_set("upper", upper.clone()).unwrap();
        let split = mesh.split_between(&lower, &upper).unwrap();
        let options = SurfaceOptions::within(1e-6).unwrap();
        let surface = JointSurface::between(&split.mesh, &split.first, &split.second, &options);
        (split.mesh, surface.unwrap())
    }
    /// Nodes of a layer boundary, with the share of its area that belongs to each.
    fn layer(&self, mesh: &Mesh, layer: f64) -> Vec<(u32, f64)> {
        let width = 2.0 * self.edge[1];
        let nodes = (0..mesh.node_count() as u32).filter_map(|node| {
            let p = mesh.positions()[node as usize];
            let at = (p[self.axis] - layer * self.edge[0]).abs() < 1e-9;
            let across = (0..3).filter(|&i| i != self.axis);
            let share = across.map(|i| if p[i] % width == 0.0 { 0.25 } else { 0.5 });
            at.then(|| (node, share.product()))
        });
        nodes.collect()
    }
    /// A force (N) at f in a direction, from a stage on, until another stage removes it if one is named.
    fn pull(
        &self,
        stage: SceneStage,
        (direction, force): (usize, f64),
        removed_in: Option<&str>,
    ) -> SceneStage {
        let (mesh, _) = self.mesh();
        let nodes = self.layer(&mesh, 3.0).into_iter();
        nodes.fold(stage, |stage, (node, share)| {
            let force = Vec3::ith(direction, force * share);
            let load = NodalForce::new(vec![node], force, Box::new(|_: f64| 1.0));
            match removed_in {
                Some(name) => stage.temporary_load(load, name),
                None => stage.load(load),
            }
        })
    }
    /// The scene of a plan; motions are along one direction alone if it is given.
    fn scene(&self, plan: Plan, only: Option<usize>) -> Scene {
        let (mesh, surface) = self.mesh();
        let law = BondedCoulomb::new(BondedCoulombParameters {
            cohesion: STRENGTH,
            tensile_strength: STRENGTH,
            static_friction: 0.0,
            dynamic_friction: 0.0,
            cohesion_loss: true,
        });
        let mut joint = SceneJoint::new("seam", surface, law.unwrap());
        if plan.gap > 0.0 {
            joint = joint.with_gap(InitialGap::Distance(plan.gap));
        }
        if plan.loose {
            joint = joint.with_unbonded(JointZone::All);
        }
        let ends = [0.0, 4.0].map(|layer| self.layer(&mesh, layer));
        let ends = ends.iter().flatten().map(|(node, _)| *node).collect();
        let mut supports = vec![Support::fixed(ends)];
        for held in (0..3).filter(|&i| only.is_some_and(|only| only != i)) {
            let all = (0..mesh.node_count() as u32).collect();
            supports.push(Support::roller(all, Vec3::ith(held, 1.0)));
        }
        let rock = ElasticMedium::new(YOUNG, 0.0, 2600.0).unwrap();
        let material = Material::from(LinearElastic::new(rock));
        let part = |set: &str| Part::new(set, material.clone()).with_kernel(SolidKernel::Hex8Full);
        let scene = Scene::new("blocks", mesh)
            .part(part("lower"))
            .part(part("upper"))
            .joint(joint)
            .with_duration(0.01);
        let scene = supports.into_iter().fold(scene, Scene::support);
        plan.stages.into_iter().fold(scene, Scene::stage)
    }
}

fn stage(name: &str, method: StaticMethod) -> SceneStage {
    SceneStage::new(name).with_options(StaticOptions::default().with_method(method))
}

fn run(scene: Scene) -> Results {
    scene.prepare().unwrap().run(RunHooks::default()).unwrap()
}

/// Records of the joint, and the peak of one of its columns.
fn seen(results: &Results) -> (&[JointRecord], impl Fn(&str) -> f64 + '_) {
    let most = |name: &str| {
        let column = results.joint_histories().column(&format!("seam.{name}"));
        let values = column.unwrap().values.iter();
        values.fold(f64::NEG_INFINITY, |most, value| most.max(*value))
    };
    (&results.joints[0].records, most)
}

fn intact(results: &Results) {
    let (records, most) = seen(results);
    for record in records {
        assert_eq!(
            (record.state.bond, record.state.contact),
            (Bond::Intact, ContactState::Stick),
            "{record:?}"
        );
        assert!(record.opening.abs() < 1e-12, "{record:?}");
    }
    for column in ["open", "broken", "sliding", "slip"] {
        assert_eq!(most(column), 0.0, "{column}");
    }
}

/// A joint with a gap or opening is closed and bonded everywhere after grouting, and at the start of the run: with either
/// method, along any axis.
#[test]
fn a_grouted_joint_keeps_its_bond() {
    for blocks in SEVERAL {
        for method in [GRADIENTS, RELAXED] {
            let gap = Plan {
                gap: 0.005,
                loose: false,
                stages: vec![
                    stage("ground", GRADIENTS),
                    stage("grout", method).bond("seam"),
                ],
            };
            intact(&run(blocks.scene(gap, None)));
            let at_once = Plan {
                gap: 0.005,
                loose: false,
                stages: vec![stage("grout", method).bond("seam")],
            };
            intact(&run(blocks.scene(at_once, None)));
            let load = (blocks.axis, 2.0e6);
            let opened = Plan {
                gap: 0.0,
                loose: true,
                stages: vec![
                    blocks.pull(stage("ground", RELAXED), load, None),
                    stage("grout", method).bond("seam"),
                ],
            };
            let results = run(blocks.scene(opened, None));
            intact(&results);
            let opening = load.1 / blocks.stiffness(blocks.axis);
            for record in &results.joints[0].records {
                let found = record.closed_at.unwrap()[0];
                assert!((found / opening - 1.0).abs() < 1e-4, "{found} {opening}");
            }
        }
    }
}

/// A grouted joint that had opened carries its strength and not more, with any stages between; where it fails it opens
/// from its grouted position. Removal of the force that had opened it compresses it.
#[test]
fn a_grouted_joint_breaks_at_its_strength() {
    for blocks in SEVERAL {
        let full = 4.0 * STRENGTH * blocks.area();
        for between in [0, 2] {
            let of_share = |share: f64, gap: f64| {
                let mut stages = Vec::new();
                if gap == 0.0 {
                    let load = (blocks.axis, 0.3 * full);
                    stages.push(blocks.pull(stage("ground", RELAXED), load, None));
                }
                stages.push(stage("grout", GRADIENTS).bond("seam"));
                stages.extend((0..between).map(|i| stage(&format!("wait {i}"), GRADIENTS)));
                let load = (blocks.axis, share * full);
                stages.push(blocks.pull(stage("pull", RELAXED), load, None));
                let loose = gap == 0.0;
                let plan = Plan { gap, loose, stages };
                run(blocks.scene(plan, None))
            };
            for gap in [0.0, 0.01] {
                let holds = of_share(0.999, gap);
                intact(&holds);
                for record in seen(&holds).0 {
                    let share = record.traction.x / STRENGTH;
                    assert!((share - 0.999).abs() < 1e-5, "{record:?}");
                }
                let breaks = of_share(1.001, gap);
                let free = 1.001 * full / blocks.stiffness(blocks.axis);
                for record in seen(&breaks).0 {
                    assert_eq!(record.state.bond, Bond::Broken, "{record:?}");
                    assert!(
                        (record.opening / free - 1.0).abs() < 1e-4,
                        "{record:?} {free}"
                    );
                }
            }
        }
        let load = (blocks.axis, 0.3 * full);
        let unloaded = Plan {
            gap: 0.0,
            loose: true,
            stages: vec![
                blocks.pull(stage("ground", RELAXED), load, Some("unload")),
                stage("grout", GRADIENTS).bond("seam"),
                stage("unload", GRADIENTS),
            ],
        };
        let results = run(blocks.scene(unloaded, None));
        intact(&results);
        for record in seen(&results).0 {
            let share = record.traction.x / STRENGTH;
            assert!((share + 0.3).abs() < 1e-5, "{record:?}");
        }
    }
}

/// Displacement of the upper side of a joint without friction under three tenths of a load (m).
fn slid_by(blocks: &Blocks, along: usize, full: f64) -> f64 {
    0.3 * full / blocks.stiffness(along)
}

/// A joint that slid before it is grouted keeps its position, carries its cohesion in either direction and not more, and
/// its slip is counted from there.
#[test]
fn a_joint_that_slid_is_grouted_where_it_is() {
    for blocks in SEVERAL {
        let along = (blocks.axis + 1) % 3;
        let full = 4.0 * STRENGTH * blocks.area();
        let slid = slid_by(&blocks, along, full);
        let of_share = |share: f64| {
            let ground = stage("ground", RELAXED);
            let plan = Plan {
                gap: 0.0,
                loose: true,
                stages: vec![
                    blocks.pull(ground, (along, 0.3 * full), None),
                    stage("grout", GRADIENTS).bond("seam"),
                    blocks.pull(stage("pull", RELAXED), (along, share * full), None),
                ],
            };
            run(blocks.scene(plan, Some(along)))
        };
        for sign in [1.0, -1.0] {
            let holds = of_share(0.999 * sign);
            intact(&holds);
            for record in seen(&holds).0 {
                let [_, first, second] = record.closed_at.unwrap();
                assert!(
                    (first.hypot(second) / slid - 1.0).abs() < 1e-4,
                    "{record:?}"
                );
                let shear = record.traction.y.hypot(record.traction.z) / STRENGTH;
                assert!((shear - 0.999).abs() < 1e-5, "{record:?}");
            }
            let breaks = of_share(1.001 * sign);
            let broken = |record: &JointRecord| record.state.bond == Bond::Broken;
            assert!(seen(&breaks).0.iter().all(broken));
        }
        // Under pressure, and after removal of the force that made it slide.
        let pressed = |grouts: bool| {
            let ground = stage("ground", RELAXED);
            let ground = blocks.pull(ground, (along, 0.3 * full), Some("unload"));
            let second = stage("grout", RELAXED);
            let plan = Plan {
                gap: 0.0,
                loose: true,
                stages: vec![
                    blocks.pull(ground, (blocks.axis, -0.2 * full), None),
                    if grouts { second.bond("seam") } else { second },
                    stage("unload", RELAXED),
                ],
            };
            let mut scene = blocks.scene(plan, None);
            let all = (0..scene.mesh().node_count() as u32).collect();
            let third = Vec3::ith((blocks.axis + 2) % 3, 1.0);
            scene = scene.support(Support::roller(all, third));
            run(scene)
        };
        let (grouted, loose) = (pressed(true), pressed(false));
        intact(&grouted);
        let slid = |record: &JointRecord| record.state.slip > 0.0;
        assert!(seen(&loose).0.iter().all(slid));
        for record in seen(&grouted).0 {
            let [_, first, second] = record.closed_at.unwrap();
            assert!(
                first.hypot(second) > 0.5 * slid_by(&blocks, along, full),
                "{record:?}"
            );
            assert!(
                record.traction.y.hypot(record.traction.z) > 0.1 * STRENGTH,
                "{record:?}"
            );
        }
    }
}

/// A run continued from a body file, over two further stages, has the bits of an uninterrupted one; without grouting no
/// pair has an origin.
#[test]
fn grouting_is_carried_over() {
    let blocks = SEVERAL[1];
    let plan = |grouts: bool| {
        let grout = stage("grout", GRADIENTS);
        let load = (blocks.axis, 1.0e6);
        Plan {
            gap: 0.0,
            loose: true,
            stages: vec![
                blocks.pull(stage("ground", RELAXED), load, None),
                if grouts {
                    grout.bond("seam")
                } else {
                    stage("grout", RELAXED)
                },
                stage("wait", RELAXED),
                stage("wait again", RELAXED),
            ],
        }
    };
    let folder = Folder::new("grouting");
    let file = folder.join("rest.body");
    let body = blocks.scene(plan(true), None).prepare().unwrap();
    let body = body.equilibrate(None, None).unwrap().unwrap();
    body.write(&file).unwrap();
    let back = EquilibratedBody::read(&file).unwrap();
    assert_eq!(back, body);
    assert!(
        back.state().joints[0]
            .records
            .iter()
            .all(|record| record.closed_at.is_some())
    );
    let hooks = RunHooks::default().with_equilibrated_body(back);
    let resumed = blocks
        .scene(plan(true), None)
        .prepare()
        .unwrap()
        .run(hooks)
        .unwrap();
    intact(&resumed);
    let whole = run(blocks.scene(plan(true), None));
    assert_eq!(resumed.joints, whole.joints);
    assert_eq!(resumed.joint_histories(), whole.joint_histories());
    let never = run(blocks.scene(plan(false), None));
    assert!(
        seen(&never)
            .0
            .iter()
            .all(|record| record.closed_at.is_none())
    );
}

/// A tie keeps a joint in its position. After its removal the joint is as defined, its gap counted from there, or as
/// grouted if it was grouted; grouting before or after the tie is equivalent.
#[test]
fn ties_and_grouting_in_any_order() {
    for blocks in SEVERAL {
        let load = (blocks.axis, 1.0e6);
        let opened = |loose: bool, gap: f64, stages: Vec<SceneStage>| {
            let ground = stage("ground", RELAXED);
            let ground = if loose {
                blocks.pull(ground, load, None)
            } else {
                ground
            };
            let stages = [ground].into_iter().chain(stages).collect();
            run(blocks.scene(Plan { gap, loose, stages }, None))
        };
        for (loose, gap) in [(true, 0.0), (false, 0.002)] {
            for stages in [
                vec![
                    stage("tie", GRADIENTS).tie("seam"),
                    stage("grout", GRADIENTS).bond("seam"),
                ],
                vec![
                    stage("grout", GRADIENTS).bond("seam"),
                    stage("tie", GRADIENTS).tie("seam"),
                ],
                vec![
                    stage("grout", GRADIENTS).bond("seam"),
                    stage("tie", GRADIENTS).tie("seam"),
                    stage("free", GRADIENTS),
                ],
            ] {
                intact(&opened(loose, gap, stages));
            }
        }
        for last in [vec![], vec![stage("free", GRADIENTS)]] {
            let tie = vec![stage("tie", GRADIENTS).tie("seam")];
            let stages = tie.into_iter().chain(last).collect();
            let results = opened(false, 0.002, stages);
            for record in seen(&results).0 {
                assert_eq!(record.state.contact, ContactState::Open);
                assert!((record.opening - 0.002).abs() < 1e-12, "{record:?}");
            }
        }
    }
}

/// The reference position of opening and slip is reported when the scene is prepared.
#[test]
fn from_where_joints_count_is_said() {
    let blocks = SEVERAL[0];
    let said = |stages: Vec<SceneStage>| {
        let plan = Plan {
            gap: 0.001,
            loose: false,
            stages,
        };
        let simulation = blocks.scene(plan, None).prepare().unwrap();
        let remarks = simulation.remarks().iter();
        let anew = remarks.filter(|remark| matches!(remark, Remark::JointRenewed(_)));
        anew.map(Remark::to_string).collect::<Vec<_>>().join("\n")
    };
    assert_eq!(said(vec![stage("ground", GRADIENTS)]), "");
    let grouted = || stage("injection", GRADIENTS).bond("seam");
    let found = said(vec![
        stage("ground", GRADIENTS),
        grouted(),
        stage("wait", GRADIENTS),
    ]);
    let expected = "joint 'seam' are counted from its position before stage 'injection'";
    assert!(
        found.contains(expected) && found.contains("grouted"),
        "{found}"
    );
    let found = said(vec![stage("ground", GRADIENTS).tie("seam")]);
    assert!(
        found.contains("its position at the start of the run"),
        "{found}"
    );
}
