//! Water in joints: friction and opening by effective tractions, tractions of stages pair by pair, uplift, levels of stages, and what
//! is refused.

use nalgebra::Rotation3;
use powerhouse::contact::{BondedCoulomb, ContactError, JointSurface, SurfaceOptions};
use powerhouse::engine::{NodalForce, StaticOptions, Support, WaterPressure};
use powerhouse::material::LinearElastic;
use powerhouse::model::{ContactState, ElasticMedium, Mesh, Stress, Vec3};
use powerhouse::{
    EquilibratedBody, Error, InSituStress, JointWater, Material, OutputPlan, Part, Preload, Remark,
    Results, Scene, SceneJoint, SceneStage, StageWater, TimeStep,
};

use super::joints::{JOINT, folder, halves, read, twin};
use super::support::*;

/// Extents of a body (m), whose joint is at half of its height, and numbers of bricks.
const BODY: Vec3 = Vec3::new(4.0, 2.0, 2.0);
const BRICKS: [usize; 3] = [4, 2, 4];
const AREA: f64 = 4.0 * 2.0;
const GRAVITY: f64 = 9.81;
/// Rock that does not widen under pressure, so that all pairs of a joint bear the same.
const STRAIGHT: ElasticMedium = ElasticMedium {
    poisson: 0.0,
    ..ROCK
};

/// The two halves of a body, the joint between them, and the mesh.
struct Halves {
    mesh: Mesh,
    joint: SceneJoint,
    /// Nodes of the lower half that are on its outside, and of the whole body.
    below: Vec<u32>,
    outside: Vec<u32>,
}

/// A joint with friction between the halves of a body whose positions are changed.
fn halves_of(friction: f64, height: f64, place: impl Fn(Vec3) -> Vec3) -> Halves {
    let size = Vec3::new(BODY.x, BODY.y, height);
    let mut mesh = Mesh::box_of_hexes(Vec3::zeros(), size, BRICKS, "rock").unwrap();
    let all = 0..mesh.element_count() as u32;
    let (lower, upper): (Vec<u32>, Vec<u32>) =
        all.partition(|&element| mesh.centroid(element).z < 0.5 * height);
    mesh.set_element_set("lower", lower.clone()).unwrap();
    mesh.set_element_set("upper", upper.clone()).unwrap();
    let split = mesh.split_between(&lower, &upper).unwrap();
    let is_outside = |at: &Vec3| (0..3).any(|axis| at[axis] == 0.0 || at[axis] == size[axis]);
    let nodes = (0..).zip(split.mesh.positions());
    let outside: Vec<u32> = nodes
        .filter(|(_, at)| is_outside(at))
        .map(|(node, _)| node)
        .collect();
    let floor = |node: &u32| split.mesh.positions()[*node as usize].z == 0.0;
    let below = outside.iter().copied().filter(floor).collect();
    let mesh = split.mesh.map_positions(place).unwrap();
    let within = SurfaceOptions::within(1e-6).unwrap();
    let surface = JointSurface::between(&mesh, &split.first, &split.second, &within).unwrap();
    let law = BondedCoulomb::unbonded(friction, friction).unwrap();
    Halves {
        joint: SceneJoint::new("seam", surface, law),
        mesh,
        below,
        outside,
    }
}

/// The scene of the halves with their joint, for a duration (s), with rows at intervals (s).
fn scene(mesh: Mesh, joint: SceneJoint, duration: f64, every: f64) -> Scene {
    let mut output = OutputPlan::default();
    output.every = every;
    output.energies = Some(0.01);
    let scene = Scene::new("wet joint", mesh)
        .joint(joint)
        .with_duration(duration)
        .with_output(output);
    ["lower", "upper"].iter().fold(scene, |scene, set| {
        let material = Material::from(LinearElastic::new(STRAIGHT));
        // Without damping sliding bodies flutter.
        scene.part(Part::new(*set, material).with_high_damping(0.1))
    })
}

/// The same pressure (Pa) at all heights.
fn uniform(pressure: f64) -> WaterPressure {
    WaterPressure::table(&[[1e3, pressure], [-1e3, pressure]]).unwrap()
}

fn exact() -> StaticOptions {
    StaticOptions::default().with_tolerance(1e-12)
}

fn at_rest(scene: Scene) -> Result<EquilibratedBody, Error> {
    let found = scene.prepare()?.equilibrate(None, None)?;
    Ok(found.unwrap())
}

/// Tractions (Pa, in space) of the pairs of a joint in a body.
fn tractions(surface: &JointSurface, body: &EquilibratedBody) -> Vec<Vec3> {
    let records = surface.pairs.iter().zip(&body.state().joints[0].records);
    records
        .map(|(pair, record)| pair.to_global(&record.traction))
        .collect()
}

/// Largest difference of two lists of vectors.
fn apart(one: &[Vec3], other: &[Vec3]) -> f64 {
    assert_eq!(one.len(), other.len());
    let off = one.iter().zip(other).map(|(a, b)| (a - b).norm());
    off.fold(0.0, f64::max)
}

/// In a body under a uniform stress, held all around, each pair bears the total traction of the stress plus the pressure of the water,
/// also at the supports: of a level, of a table, dipping either way, when a stage raises the water and at the start of the run, in
/// which nothing moves and the energies are balanced.
#[test]
fn pairs_bear_effective_tractions_from_stage_to_stage() {
    let stress = Stress([-3e5, -4e5, -5e5, 2e4, -3e4, 5e4]);
    for (dip, turn) in [(0.0, 0.0), (0.3, 0.0), (-0.4, 0.8)] {
        let place = |at: Vec3| {
            let middle = 1.0 - (at.z - 1.0).abs();
            let dipping = Vec3::new(at.x, at.y, at.z + dip * (at.x - 2.0) * middle);
            Rotation3::from_euler_angles(0.0, 0.0, turn) * dipping
        };
        let Halves {
            mesh,
            joint,
            outside,
            ..
        } = halves_of(0.9, BODY.z, place);
        let surface = joint.surface.clone();
        let heights: Vec<f64> = surface.pairs.iter().map(|pair| pair.position.z).collect();
        let low = WaterPressure::hydrostatic(1.2, 1e4).unwrap();
        let high = WaterPressure::hydrostatic(9.0, 1e4).unwrap();
        let expected = |water: &WaterPressure| -> Vec<Vec3> {
            let pairs = surface.pairs.iter().zip(&heights);
            pairs
                .map(|(pair, height)| {
                    stress.traction(&pair.normal) + pair.normal * water.pressure(*height)
                })
                .collect()
        };
        let of_stages = |stages: usize| {
            let joint = SceneJoint::new(
                "seam",
                surface.clone(),
                BondedCoulomb::unbonded(0.9, 0.9).unwrap(),
            )
            .with_water(JointWater::new(low.clone()));
            let all = vec![stress; mesh.element_count()];
            let scene = scene(mesh.clone(), joint, 0.05, 1e-3)
                .support(Support::fixed(outside.clone()))
                .with_in_situ_stress(InSituStress::Elements(all))
                .stage(SceneStage::new("start").with_options(exact()));
            let risen = SceneStage::new("risen")
                .water(StageWater::new(high.clone()))
                .with_options(exact());
            match stages {
                1 => scene,
                _ => scene.stage(risen),
            }
        };
        for (stages, water) in [(1, &low), (2, &high)] {
            let body = at_rest(of_stages(stages)).unwrap();
            let found = tractions(&surface, &body);
            let expected = expected(water);
            let most = expected.iter().map(Vec3::norm).fold(0.0, f64::max);
            let off = apart(&found, &expected) / most;
            assert!(off < 1e-9, "dip {dip}, stage {stages}: {off:e}");
            let results = run(of_stages(stages));
            let table = &results.joints[0];
            let records = table.pairs.iter().zip(&table.records);
            let of_run: Vec<Vec3> = records
                .map(|(pair, record)| pair.to_global(&record.traction))
                .collect();
            let off = apart(&of_run, &found) / most;
            assert!(off < 1e-9, "dip {dip}, stage {stages}, in the run: {off:e}");
            let pressures = table.pairs.iter().zip(&heights);
            for (pair, height) in pressures {
                assert!((pair.water_pressure - water.pressure(*height)).abs() < 1e-9);
            }
            assert!(table.records.iter().all(|record| record.state.slip == 0.0));
            assert!(results.hand_over.unwrap().difference < 1e-12);
            assert!(
                results
                    .energy_residual()
                    .is_none_or(|residual| residual.largest < 1e-9)
            );
            // A stress of 5e5 Pa moves the body by 1e-4 m.
            let still = results.energy_terms().into_iter();
            let kinetic = still.filter(|(name, _)| *name == "kinetic").map(|(_, e)| e);
            assert!(kinetic.fold(0.0, f64::max) < 1e-12);
        }
    }
}

/// A block on a dipping joint slides when the shear of its weight and of a force that grows exceeds friction times the effective
/// pressure, `tau = (sigma_n - p) tan(phi)`, and then with the acceleration of what is left; a preload beyond that is refused.
#[test]
fn a_block_under_water_slides_by_effective_friction() {
    let (friction, normal, shear) = (0.6, 3e5, 6e4);
    for (dip, pressure) in [(0.0, 0.0), (0.35, 1e5), (-0.6, 1.5e5)] {
        // Thin, so that the force on its mass, half of the height above the joint, hardly unloads an edge.
        let height = 0.06;
        let turn = Rotation3::from_euler_angles(0.0, dip, 0.0);
        let built = || halves_of(friction, height, |at| turn * at);
        let [across, along] = [Vec3::z(), Vec3::x()].map(|axis| turn * axis);
        let preload = |shear: f64| Preload::Traction(-across * normal + along * shear);
        let wet = |joint: SceneJoint, shear: f64| {
            let water = JointWater::new(uniform(pressure));
            joint.with_water(water).with_preload(preload(shear))
        };
        let limit = friction * (normal - pressure);
        // The static limit, to rounding.
        for (share, admitted) in [(1.0 - 1e-9, true), (1.0 + 1e-9, false)] {
            let Halves { mesh, joint, .. } = built();
            let refused = wet(joint, share * limit).check(&mesh);
            assert_eq!(refused.is_ok(), admitted, "dip {dip}: {share} {refused:?}");
        }
        let Halves {
            mesh, joint, below, ..
        } = built();
        let upper = mesh.element_set("upper").unwrap().to_vec();
        let mass = ROCK.density * mesh.volume_of(&upper);
        // An acceleration of all that grows linearly (m/s3), in a second beyond the limit by far.
        let growth = 2.0 * (limit - shear) * AREA / mass;
        let (slides_at, end) = (0.5, 0.6);
        let scene = scene(mesh, wet(joint, shear), end, 1e-3)
            .support(Support::fixed(below))
            .gravity(along * growth, |time: f64| time)
            .allow_magnitudes();
        let results = run(scene);
        let records = &results.joints[0].records;
        let first = records.iter().filter_map(|record| record.first_slip);
        let [first, last] = first.fold([f64::INFINITY, 0.0_f64], |[a, b], t| [a.min(t), b.max(t)]);
        assert!(
            first > 0.97 * slides_at && last < 1.03 * slides_at,
            "dip {dip}: {first} to {last}"
        );
        // The force beyond the limit grows as the time since then.
        let expected = growth * (end - slides_at).powi(3) / 6.0;
        for record in records {
            let slip = record.slip();
            assert!(
                (slip / expected - 1.0).abs() < 0.02,
                "dip {dip}: {slip:e} {expected:e}"
            );
        }
        let residual = results.energy_residual().unwrap().largest;
        assert!(residual < 1e-9, "{residual:e}");
    }
}

/// A block on a joint under uplift bears its weight less the pressure, lifts off when a force that grows exceeds that, goes on with the
/// pressure below it, and is refused in a stage whose water lifts it.
#[test]
fn a_block_lifts_off_when_the_uplift_exceeds_its_weight() {
    let share = 0.6;
    let built = |share: f64| {
        let Halves {
            mesh, joint, below, ..
        } = halves_of(0.5, BODY.z, |at| at);
        let upper = mesh.element_set("upper").unwrap().to_vec();
        let weight = ROCK.density * GRAVITY * mesh.volume_of(&upper);
        let top: Vec<u32> = mesh.nodes_in_box(&Vec3::new(0.0, 0.0, BODY.z), &BODY);
        let surface = joint.surface.clone();
        let joint = joint.with_water(JointWater::default());
        let level = StageWater::new(uniform(share * weight / AREA));
        let scene = scene(mesh, joint, 0.5, 1e-3)
            .support(Support::fixed(below))
            .gravity(-Vec3::z() * GRAVITY, |_: f64| 1.0)
            .stage(SceneStage::new("dry").with_options(exact()))
            .stage(SceneStage::new("wet").water(level).with_options(exact()));
        (scene, surface, weight, top)
    };
    let (still, surface, weight, top) = built(share);
    let body = at_rest(still).unwrap();
    let mean: Vec3 = (surface.pairs.iter().zip(tractions(&surface, &body)))
        .map(|(pair, traction)| traction * pair.projected_area)
        .sum();
    let expected = -Vec3::z() * (1.0 - share) * weight;
    assert!(
        (mean - expected).norm() < 1e-9 * weight,
        "{mean} {expected}"
    );
    let refused = at_rest(built(1.05).0).unwrap_err().to_string();
    assert!(refused.contains("slides, opens or closes"), "{refused}");

    // Corners of a brick have a quarter of the force of a node within.
    let (scene, ..) = built(share);
    let force = |node: u32| {
        let at = scene.mesh().positions()[node as usize];
        let edges = [(at.x, BODY.x), (at.y, BODY.y)];
        let at_edge = edges
            .iter()
            .filter(|(x, end)| *x == 0.0 || x == end)
            .count();
        weight / 8.0 * 0.5_f64.powi(at_edge as i32)
    };
    let forces: Vec<(u32, f64)> = top.iter().map(|&node| (node, force(node))).collect();
    let all: f64 = forces.iter().map(|(_, force)| force).sum();
    assert!((all / weight - 1.0).abs() < 1e-12);
    // The weight in a second: off when it is the share that the water leaves.
    let scene = forces.into_iter().fold(scene, |scene, (node, force)| {
        let grows = Box::new(|time: f64| time);
        scene.load(NodalForce::new(vec![node], Vec3::z() * force, grows))
    });
    let lifts_at = 1.0 - share;
    let results = run(scene);
    let records = &results.joints[0].records;
    let first = records.iter().filter_map(|record| record.first_crack);
    let [first, last] = first.fold([f64::INFINITY, 0.0_f64], |[a, b], t| [a.min(t), b.max(t)]);
    assert!(
        first > 0.95 * lifts_at && last < 1.05 * lifts_at,
        "{first} to {last}"
    );
    let expected = GRAVITY * (0.5 - lifts_at).powi(3) / 6.0;
    for record in records {
        assert_eq!(record.state.contact, ContactState::Open);
        let ratio = record.opening / expected;
        assert!(
            (ratio - 1.0).abs() < 0.05,
            "{:e} {expected:e}",
            record.opening
        );
    }
    assert!(results.energy_residual().unwrap().largest < 1e-9);
}

/// A joint with water of a file is that of Rust; what it says, and what is refused, by name.
#[test]
fn files_and_refusals() {
    let folder = folder("joint-water");
    let with = |keys: &str| JOINT.replace("law =", &format!("{keys}\nlaw ="));
    let preload = "preload = { kind = \"pressure\", pressure = 1.05e6 }\n";
    let text = with(&format!(
        "water = {{ level = -50, density = 1030 }}\n{preload}"
    ));
    let scene = read(&folder, &text).unwrap();
    let (mesh, joint) = twin(&halves());
    let level = WaterPressure::hydrostatic(-50.0, 1030.0 * GRAVITY).unwrap();
    let joint = joint
        .with_water(JointWater::new(level))
        .with_preload(Preload::Pressure(1.05e6));
    let twin = cube_scene_of(mesh, &["lower", "upper"]).joint(joint);
    let simulation = scene.prepare().unwrap();
    let texts: Vec<String> = simulation.remarks().iter().map(Remark::to_string).collect();
    let said = "water in joint 'bedding': 1.010e6 to 1.010e6 Pa";
    assert!(texts.iter().any(|text| text.contains(said)), "{texts:?}");
    let (file, twin): (Results, Results) = (run(read(&folder, &text).unwrap()), run(twin));
    assert_eq!(file.histories(), twin.histories());
    assert_eq!(file.joints, twin.joints);
    // Most of the pressure is the water's: the joint slides further than the same one without.
    let dry = run(read(&folder, &with(preload)).unwrap());
    let slip = |results: &Results| {
        let records = results.joints[0].records.iter();
        records.map(|record| record.slip()).fold(0.0, f64::max)
    };
    assert!(
        slip(&file) > slip(&dry),
        "{:e} {:e}",
        slip(&file),
        slip(&dry)
    );

    for (keys, expected) in [
        (
            "water = { level = -50 }",
            "a joint with water and without a preload",
        ),
        (
            "water = { pressures = [[0, 0], [-100, 1e6]] }",
            "joint 'bedding' has a node pair at z = -150 m, and the table of pressures reaches from -100 to 0 m",
        ),
        (
            "water = { level = -50, pressures = [[0, 0], [-300, 1e6]] }",
            "one of `level` and `pressures`",
        ),
    ] {
        let refused = read(&folder, &with(keys)).and_then(Scene::prepare);
        let refused = refused.err().unwrap().to_string();
        assert!(refused.contains(expected), "{keys}: {refused}");
    }
    let more = "water = { level = 100 }\npreload = { kind = \"pressure\", pressure = 1e5 }";
    match read(&folder, &with(more)).map_err(|error| error.to_string()) {
        Err(text) => assert!(
            text.contains("preload") || text.contains("traction"),
            "{text}"
        ),
        Ok(_) => panic!("an effective tension is admitted"),
    }
    let (mesh, joint) = self::twin(&halves());
    let deep = WaterPressure::hydrostatic(100.0, 1e4).unwrap();
    let joint = joint
        .with_water(JointWater::new(deep))
        .with_preload(Preload::Pressure(1e5));
    let refused = joint.check(&mesh);
    let is_preload = |error: &Error| {
        matches!(
            error,
            Error::Joint {
                source: ContactError::Preload { .. },
                ..
            }
        )
    };
    assert!(refused.as_ref().is_err_and(is_preload), "{refused:?}");
}

/// Levels of a stage are those of joints, too: that of a set for the pairs beside it, that of no set for all others; two levels at one
/// pair, and a level of a set beside nothing wet, are refused.
#[test]
fn levels_of_stages_are_those_of_joints() {
    let [high, low] = [9.0, 4.0].map(|level| WaterPressure::hydrostatic(level, 1e4).unwrap());
    let pressures = |levels: Vec<StageWater>| -> Result<Vec<f64>, Error> {
        let Halves {
            mut mesh,
            joint,
            below,
            ..
        } = halves_of(0.5, BODY.z, |at| at);
        for (name, from, to) in [("left", 0.0, 1.0), ("right", 2.0, 4.0), ("all", 0.0, 4.0)] {
            let [from, to] = [Vec3::new(from, 0.0, 0.0), Vec3::new(to, 2.0, 2.0)];
            let elements = mesh.elements_in_box(&from, &to);
            mesh.set_element_set(name, elements).unwrap();
        }
        let load = SceneStage::new("water").with_options(exact());
        let stage = levels.into_iter().fold(load, SceneStage::water);
        let scene = scene(mesh, joint.with_water(JointWater::default()), 1e-3, 1e-3)
            .support(Support::fixed(below))
            .gravity(-Vec3::z() * 20.0 * GRAVITY, |_: f64| 1.0)
            .stage(stage)
            .stage(SceneStage::new("later").with_options(exact()))
            .with_step(TimeStep::OfStable(0.9));
        let results = run_of(scene)?;
        let pairs = results.joints[0].pairs.iter();
        Ok(pairs.map(|pair| pair.water_pressure).collect())
    };
    let of = |level: &WaterPressure| StageWater::new(level.clone());
    let [of_high, of_low] = [&high, &low].map(|level| level.pressure(1.0));
    assert!(
        pressures(vec![of(&high)])
            .unwrap()
            .iter()
            .all(|p| *p == of_high)
    );
    // Pairs at x of 0 and 1 are beside the set, three across.
    let some = pressures(vec![of(&high), of(&low).within("left")]).unwrap();
    let count = |pressure: f64| some.iter().filter(|p| **p == pressure).count();
    assert_eq!([count(of_low), count(of_high)], [6, 9]);
    let alone = pressures(vec![of(&low).within("left")]).unwrap();
    assert_eq!(alone.iter().filter(|p| **p == 0.0).count(), 9);
    // Equal levels of two sets are one.
    assert!(pressures(vec![of(&low).within("left"), of(&low).within("all")]).is_ok());
    for (levels, expected) in [
        (
            vec![of(&low).within("left"), of(&high).within("all")],
            "joint 'seam' has node pairs beside set 'all' that have another water level",
        ),
        (
            vec![of(&low), of(&high)],
            "two water levels of the stage name no set",
        ),
        (
            vec![StageWater::new(
                WaterPressure::table(&[[9.0, 0.0], [5.0, 1e4]]).unwrap(),
            )],
            "joint 'seam' has a node pair at z = 1 m",
        ),
    ] {
        let refused = pressures(levels).unwrap_err().to_string();
        assert!(refused.contains(expected), "{refused}");
    }
}

fn run_of(scene: Scene) -> Result<Results, Error> {
    scene.prepare()?.run(powerhouse::RunHooks::default())
}

/// Where the ground beside a joint without water has some, a warning states by how much its friction is too high; none where the joint
/// has water, or no friction sees it.
#[test]
fn a_dry_joint_in_wet_ground_is_warned_of() {
    let wet = Material::from(LinearElastic::new(ROCK)).with_pore_water(
        powerhouse::engine::PoreWater::new(2.2e9, 0.1)
            .unwrap()
            .with_pressure(uniform(2e5)),
    );
    let warnings = |water: Option<JointWater>| -> Vec<String> {
        let Halves {
            mesh,
            mut joint,
            outside,
            ..
        } = halves_of(0.5, BODY.z, |at| at);
        joint.water = water;
        let all = vec![Stress([-1e6, -1e6, -1e6, 0.0, 0.0, 0.0]); mesh.element_count()];
        let scene = Scene::new("wet ground", mesh)
            .joint(joint)
            .part(Part::new("lower", wet.clone()))
            .part(Part::new("upper", wet.clone()))
            .support(Support::fixed(outside))
            .with_in_situ_stress(InSituStress::Elements(all))
            .stage(SceneStage::new("start").with_options(exact()))
            .with_duration(1e-3);
        let simulation = scene.prepare().unwrap();
        let own = simulation
            .remarks()
            .iter()
            .filter(|remark| matches!(remark, Remark::WetJoint(_)) && remark.is_warning());
        own.map(Remark::to_string).collect()
    };
    let found = warnings(None);
    assert!(
        matches!(&found[..], [one] if one.contains("joint 'seam' has no `water`") && one.contains("2.000e5 Pa in its pores")
            && one.contains("at up to 1.000e5 Pa (friction 0.50 times the pressure)")),
        "{found:?}"
    );
    assert!(warnings(Some(JointWater::default())).is_empty());
}
