//! Added mass of water in scenes: keys, faults, facts, static equilibrium and direction.

use powerhouse::engine::observe::Motion;
use powerhouse::engine::{EngineError, NodalForce, SolidKernel, Support, WaterMass};
use powerhouse::material::LinearElastic;
use powerhouse::model::{ElasticMedium, Mesh, Vec3};
use powerhouse::nalgebra::{Rotation3, Unit};
use powerhouse::{
    Error, Material, OutputPlan, Part, Remark, Results, Scene, TimeStep, WaterBeside, WaterError,
};

use super::stages::{MATERIALS, ROLLERS, TRENCH, folder, mesh, read};
use super::support::{Variants, cube_scene, run};

fn table(level: f64, depths: &[f64], masses: &[f64]) -> WaterMass {
    WaterMass::Table {
        level,
        depths: depths.to_vec(),
        masses: masses.to_vec(),
    }
}

fn westergaard(density: f64, level: f64, depth: f64) -> WaterMass {
    WaterMass::Westergaard {
        density,
        level,
        depth,
    }
}

/// Every key of a file equals its counterpart in Rust, and changes the motion.
#[test]
fn keys_equal_their_counterparts() {
    let variants = Variants::new("added-mass");
    let without = run(cube_scene());
    for (keys, water) in [
        (
            "kind = \"westergaard\"\nlevel = 12.5\ndepth = 30\ndensity = 1100",
            westergaard(1100.0, 12.5, 30.0),
        ),
        (
            "kind = \"westergaard\"\nlevel = 20\nbottom = -40",
            westergaard(1000.0, 20.0, 60.0),
        ),
        (
            "kind = \"table\"\nlevel = 5\ndepths = [0, 4, 9]\nmasses = [0, 7e4, 5e4]",
            table(5.0, &[0.0, 4.0, 9.0], &[0.0, 7e4, 5e4]),
        ),
    ] {
        let new = format!("[[added_mass]]\nset = \"top\"\n{keys}\n[time]");
        let twin = || cube_scene().water_beside(WaterBeside::new("top", water.clone()));
        variants.equal(("[time]", &new), twin());
        let with = run(twin());
        assert_ne!(with.histories(), without.histories());
        // The mass is part of that of the step, which it may only lengthen.
        assert!(with.run.steps <= without.run.steps);
    }
}

/// What is wrong in a table of a file is refused at its place, with value and permitted range.
#[test]
fn faults_have_their_place() {
    let variants = Variants::new("added-mass-faults");
    let refused = |keys: &str| {
        let new = format!("[[added_mass]]\n{keys}\n[time]");
        let read = variants.read("[time]", &new);
        let error = match read {
            Ok(scene) => scene.prepare().err().expect("it should be refused"),
            Err(error) => error,
        };
        error.to_string()
    };
    let basin = "kind = \"westergaard\"\nset = \"top\"\nlevel = 10\n";
    let rows = "kind = \"table\"\nset = \"top\"\nlevel = 10\n";
    for (keys, wanted) in [
        (
            basin,
            &["exactly one of depth, bottom must be given, found 0"][..],
        ),
        (
            &format!("{basin}depth = 20\nbottom = -5"),
            &["exactly one of depth, bottom must be given, found 2"],
        ),
        (
            &format!("{basin}bottom = 12"),
            &["12 m", "a bottom below the level, 10 m"],
        ),
        (&format!("{basin}depth = 0"), &["a number above 0"]),
        (
            &format!("{basin}depth = 30\ndensity = 1"),
            &["density", "kg/m3"],
        ),
        (
            &format!("{basin}depth = 9"),
            &[
                "'top'",
                "reaches to 10.000000 m below the level",
                "defined to 9.000000 m",
            ],
        ),
        (&format!("{basin}height = 9"), &["unknown key 'height'"]),
        (
            "kind = \"westergaard\"\nset = \"top\"\nlevel = -1\ndepth = 9",
            &["none of the 36 facets is below the level -1 m"],
        ),
        (
            "kind = \"westergaard\"\nset = \"roof\"\nlevel = 1\ndepth = 9",
            &["roof"],
        ),
        (
            "kind = \"westergaard\"\nset = \"left\"\nlevel = 1\ndepth = 900",
            &["absorbing face 'left'", "'left' with added mass"],
        ),
        (
            "kind = \"basin\"\nset = \"top\"",
            &["'basin' is not permitted here"],
        ),
        (
            "kind = \"conduit\"\nset = \"top\"\ndiameter = 5",
            &["diameter 5 m", "curvature is that of inf m"],
        ),
        (
            "kind = \"conduit\"\nset = \"top\"",
            &["'diameter' is missing"],
        ),
        (
            &format!("{rows}depths = [0, 4, 4]\nmasses = [1, 2, 3]"),
            &["[0.0, 4.0, 4.0]", "rise from 0"],
        ),
        (
            &format!("{rows}depths = [1, 4]\nmasses = [1, 2]"),
            &["[1.0, 4.0]", "rise from 0"],
        ),
        (
            &format!("{rows}depths = [0]\nmasses = [1]"),
            &["[0.0]", "two at least"],
        ),
        (
            &format!("{rows}depths = [0, 40]\nmasses = [1]"),
            &["[1.0]", "as many masses as depths"],
        ),
        (
            &format!("{rows}depths = [0, 40]\nmasses = [1, -2]"),
            &["[1.0, -2.0]", "none negative"],
        ),
        (
            &format!("{rows}depths = [0, 4]\nmasses = [1, 2]"),
            &["defined to 4.000000 m"],
        ),
        (
            &format!("{basin}depth = 30\n[[added_mass]]\n{rows}depths = [0, 40]\nmasses = [1, 2]"),
            &["has the added mass of both 'top' and 'top'"],
        ),
    ] {
        let text = refused(keys);
        for wanted in wanted {
            assert!(text.contains(wanted), "{keys}: {wanted}: {text}");
        }
        assert!(text.contains("cube.toml:"), "{text}");
    }
}

/// A wall of two parts, free but at its foot.
fn wall(turn: &Rotation3<f64>) -> Mesh {
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::new(4.0, 6.0, 20.0), [2, 3, 10], "wall");
    let mut mesh = mesh.unwrap();
    let lower = mesh.elements_in_box(&Vec3::zeros(), &Vec3::new(4.0, 6.0, 10.0));
    let upper = mesh.elements_in_box(&Vec3::new(0.0, 0.0, 10.0), &Vec3::new(4.0, 6.0, 20.0));
    mesh.set_element_set("lower", lower).unwrap();
    mesh.set_element_set("upper", upper).unwrap();
    mesh.map_positions(|x| turn * x).unwrap()
}

fn wall_scene(mesh: Mesh, push: Vec3) -> Scene {
    let concrete = |density| ElasticMedium::new(25e9, 0.2, density).unwrap();
    let part = |set: &str, density| {
        Part::new(set, Material::from(LinearElastic::new(concrete(density))))
            .with_kernel(SolidKernel::Hex8Natural)
    };
    let foot = mesh.nodes_of_facets(mesh.facet_set("bottom").unwrap());
    let top = mesh.nodes_of_facets(mesh.facet_set("top").unwrap());
    let corner = mesh.positions()[top[0] as usize];
    let mut output = OutputPlan::default().history("corner", corner, Motion::ALL);
    (output.every, output.energies) = (0.002, Some(0.01));
    Scene::new("wall", mesh)
        .part(part("lower", 2400.0))
        .part(part("upper", 2500.0))
        .support(Support::fixed(foot))
        .load(NodalForce::new(
            top,
            push,
            Box::new(|t: f64| (40.0 * t).sin()),
        ))
        .with_duration(0.3)
        .with_step(TimeStep::Seconds(2e-4))
        .with_output(output)
}

fn corner(results: &Results) -> Vec<Vec3> {
    let columns = ["ux", "uy", "uz"].map(|name| {
        let column = results
            .histories()
            .column(&format!("corner.{name}"))
            .unwrap();
        column.values.clone()
    });
    let [x, y, z] = columns;
    (0..x.len()).map(|i| Vec3::new(x[i], y[i], z[i])).collect()
}

/// A wall with water on two sides that is turned about the vertical, and one with water of one mass on all sides that is turned about any axis,
/// moves as the turned motion; a push along a dry direction has the motion of the dry wall. The balance closes.
#[test]
fn a_turned_body_moves_as_the_turned_motion() {
    let upright = Rotation3::identity();
    let about = |axis: Vec3, angle| Rotation3::from_axis_angle(&Unit::new_normalize(axis), angle);
    let basin = westergaard(1000.0, 17.0, 17.0);
    let deep = table(50.0, &[0.0, 120.0], &[2e4, 2e4]);
    let push = Vec3::new(3e4, 1e4, 5e3);
    for (water, sides, turn) in [
        (&basin, &["left", "back"][..], about(Vec3::z(), 0.7)),
        (
            &deep,
            &["left", "right", "front"],
            about(Vec3::new(1.0, -0.4, 0.3), 1.2),
        ),
    ] {
        let with = |turn: &Rotation3<f64>| {
            let scene = wall_scene(wall(turn), turn * push);
            let add = |scene: Scene, side: &&str| {
                scene.water_beside(WaterBeside::new(*side, water.clone()))
            };
            run(sides.iter().fold(scene, add))
        };
        let (own, turned) = (with(&upright), with(&turn));
        let [before, after] = [&own, &turned].map(corner);
        let most = before.iter().map(Vec3::norm).fold(0.0, f64::max);
        assert!(most > 0.0 && before.len() == after.len());
        for (before, after) in before.iter().zip(&after) {
            assert!((turn * before - after).norm() < 1e-9 * most);
        }
        let dry = corner(&run(wall_scene(wall(&upright), push)));
        let apart = before.iter().zip(&dry).map(|(a, b)| (a - b).norm());
        assert!(apart.fold(0.0, f64::max) > 0.02 * most);
        let energies = own.energies();
        assert!(
            energies
                .column("added mass")
                .unwrap()
                .values
                .iter()
                .any(|e| *e > 0.0)
        );
    }
}

/// The facts of a check: mass along the axes, that of the part beside it, and the limits of the formula; facets that lean
/// are a warning.
#[test]
fn the_check_says_what_is_added() {
    let upright = wall(&Rotation3::identity());
    let facts = |scene: Scene| {
        let simulation = scene.prepare().unwrap();
        let found = simulation.remarks().iter();
        let found: Vec<Remark> = found
            .filter(|remark| matches!(remark, Remark::AddedWater(_)))
            .cloned()
            .collect();
        assert_eq!(found.len(), 1);
        found[0].clone()
    };
    let basin = |level| WaterBeside::new("left", westergaard(1000.0, level, level));
    let fact = facts(wall_scene(upright.clone(), Vec3::x()).water_beside(basin(8.0)));
    let Remark::AddedWater(water) = &fact else {
        unreachable!()
    };
    let exact = 7.0 / 12.0 * 1000.0 * 64.0 * 6.0;
    assert!((water.mass / exact - 1.0).abs() < 1e-12);
    assert!((water.along[0] / exact - 1.0).abs() < 1e-12);
    assert!((water.area / 48.0 - 1.0).abs() < 1e-12);
    let lower = 2400.0 * 4.0 * 6.0 * 10.0;
    let upper = 2500.0 * 4.0 * 6.0 * 10.0;
    let masses: Vec<f64> = water.parts.iter().map(|(_, mass)| *mass).collect();
    for (found, expected) in masses.iter().zip([lower, upper]) {
        assert!((found / expected - 1.0).abs() < 1e-12, "{masses:?}");
    }
    assert!(!fact.is_warning());
    let text = fact.to_string();
    for wanted in [
        "beside 'left' (Westergaard): 2.2400e5 kg on 4.8000e1 m2",
        "x has 2.240e5 kg",
        "y 0.000e0",
        "without weight",
        "5.7600e5 kg ('lower')",
        "well below 46.3 Hz",
    ] {
        assert!(text.contains(wanted), "{wanted}: {text}");
    }
    assert!(!text.contains("lean"), "{text}");

    let about = |angle: f64| Rotation3::from_axis_angle(&Vec3::y_axis(), angle.to_radians());
    for (angle, warns) in [(20.0, false), (40.0, true)] {
        let turn = about(angle);
        let fact = facts(
            wall_scene(wall(&turn), Vec3::x())
                .water_beside(WaterBeside::new("left", westergaard(1000.0, 5.0, 60.0))),
        );
        assert_eq!(fact.is_warning(), warns);
        let text = fact.to_string();
        assert!(
            text.contains(&format!("lean up to {angle:.0} degrees")),
            "{text}"
        );
    }
}

/// Facets inside the body or of excavated elements carry none: a set without others is refused, and
/// of one with some the number is stated.
#[test]
fn water_is_beside_the_surface_alone() {
    let mesh = mesh();
    let folder = folder(&mesh);
    let text = [MATERIALS, ROLLERS, TRENCH]
        .concat()
        .replace("bolts = [\"nail\"]\n", "");
    let text = text.replace("bolts = [\"anchors\"]\n", "");
    let with = |set: &str| {
        let table = format!(
            "[[added_mass]]\nkind = \"table\"\nset = \"{set}\"\nlevel = 15\ndepths = [0, 20]\nmasses = [8e3, 8e3]\n[time]"
        );
        read(&folder, &text.replacen("[time]", &table, 1)).unwrap()
    };
    let simulation = with("top").prepare().unwrap();
    let found = simulation.remarks().iter().find_map(|remark| match remark {
        Remark::AddedWater(water) => Some(water.clone()),
        _ => None,
    });
    let water = found.unwrap();
    // The top of 6 by 5 facets has a trench of 2 by 5, of which the lining covers half.
    assert_eq!(water.left_out, 5);
    assert!(
        (water.mass / (8e3 * 25.0 * 4.0) - 1.0).abs() < 1e-12,
        "{}",
        water.mass
    );
    assert!(
        water
            .to_string()
            .contains("5 facets of the set are not on the surface")
    );

    let mut inside = wall(&Rotation3::identity());
    let element = inside.element_set("lower").unwrap()[0];
    let inner: Vec<_> = (0..6)
        .map(|side| powerhouse::model::Facet { element, side })
        .filter(|facet| inside.facet_geometry(*facet).normal().z > 0.5)
        .collect();
    inside.set_facet_set("inside", inner).unwrap();
    let water = WaterBeside::new("inside", table(50.0, &[0.0, 60.0], &[1e3, 1e3]));
    let scene = wall_scene(inside, Vec3::x()).water_beside(water);
    let Error::Water(error) = scene.prepare().err().unwrap() else {
        panic!("another error")
    };
    let (set, count) = ("inside".to_owned(), 1);
    assert_eq!(error, WaterError::NotOnSurface { set, count });
    let dry = WaterBeside::new("left", westergaard(1000.0, -3.0, 9.0));
    let scene = wall_scene(wall(&Rotation3::identity()), Vec3::x()).water_beside(dry);
    let Error::Water(WaterError::Facets { source, .. }) = scene.prepare().err().unwrap() else {
        panic!("another error")
    };
    assert!(
        matches!(source, EngineError::DryFacets { count: 30, .. }),
        "{source}"
    );
}

/// Stages have the displacement that they have without added mass, and a run without input begins at rest and stays there.
#[test]
fn stages_do_not_feel_it_and_a_body_at_rest_stays_there() {
    let mesh = mesh();
    let folder = folder(&mesh);
    let text = [MATERIALS, ROLLERS, TRENCH]
        .concat()
        .replace("bolts = [\"nail\"]\n", "");
    let text = text.replace("bolts = [\"anchors\"]\n", "");
    let text = text.replace("at = [2, 4, 12]", "at = [5, 4, 8]");
    let table = "[[added_mass]]\nkind = \"table\"\nset = \"top\"\nlevel = 15\ndepths = [0, 20]\nmasses = [8e5, 8e5]\n[time]";
    let wet = text.replacen("[time]", table, 1);
    let [dry, wet] = [&text, &wet].map(|text| run(read(&folder, text).unwrap()));
    for (dry, wet) in dry.stages.iter().zip(&wet.stages) {
        let [a, b] = [dry, wet].map(|stage| stage.largest_displacement.0);
        assert!((a - b).abs() <= 1e-12 * a, "{a} {b}");
    }
    assert!(dry.stages[1].largest_displacement.0 > 1e-5);
    assert!(wet.run.steps <= dry.run.steps);
    for component in ["ux", "uy", "uz", "vx", "vy", "vz"] {
        let column = wet.histories().column(&format!("corner.{component}"));
        let most = column
            .unwrap()
            .values
            .iter()
            .fold(0.0_f64, |most, v| most.max(v.abs()));
        assert!(most < 1e-10, "{component}: {most:e}");
    }
}
