//! Slices with delayed sides, under waves of any azimuth.

use powerhouse::io::write_gmsh;
use powerhouse::model::{
    AbsorbingBoundary, BoundaryParts, BoundarySite, Constraint, ConstraintWork, FieldMotion,
    IncidentField, Mesh, ModelError, PredictedMotion, RunError, Vec3,
};
use powerhouse::{Boundary, Error, FileScene, Registry, Results, RunHooks};

use super::support::Folder;

/// A slice of ground, 4 m thick, under an SV wave at an azimuth of 60 degrees.
pub(super) const GROUND: &str = r#"
title = "slice"
mesh = { file = "slice.msh" }
support = [{ kind = "delayed", from = "front", to = "back" }]
[[material]]
name = "granite"
law = "elastic"
young = 9.0e9
poisson = 0.27
density = 2750
[[part]]
set = "rock"
material = "granite"
kernel = "hex8-full"
[[wave]]
kind = "sv"
incidence = 25
azimuth = 60
pulse = { kind = "smooth", displacement = 0.01, duration = 0.4 }
[boundary]
kind = "viscous-spring"
faces = ["left", "right", "bottom"]
scatterer = [0, 0, -50]
spreading = "cylindrical"
[time]
duration = 0.7
[output]
every = 0.01
energies = 0.05
[[output.history]]
name = "back"
at = [0, 2, 0]
"#;

/// The mesh of the slice.
fn mesh() -> Mesh {
    let (low, high) = (Vec3::new(-100.0, -2.0, -100.0), Vec3::new(100.0, 2.0, 0.0));
    Mesh::box_of_hexes(low, high, [20, 1, 10], "rock").unwrap()
}

pub(super) fn scene(text: &str) -> Result<FileScene, Error> {
    scene_on(&mesh(), text)
}

pub(super) fn scene_on(mesh: &Mesh, text: &str) -> Result<FileScene, Error> {
    let folder = Folder::new("delayed-sides");
    write_gmsh(folder.join("slice.msh"), mesh).unwrap();
    if text.contains("stations.csv") {
        std::fs::write(folder.join("stations.csv"), still_stations(mesh)).unwrap();
    }
    FileScene::from_toml(
        text.to_owned(),
        folder.join("slice.toml"),
        &Registry::default(),
    )
}

/// A table of motions at all nodes of a mesh, which stay still, those of the region in the test below inside.
fn still_stations(mesh: &Mesh) -> String {
    let mut rows = "x [m],y [m],z [m],inner [1],time [s],ux [m],uy [m],uz [m]\n".to_owned();
    for at in mesh.positions() {
        let inner = u8::from(at.x.abs() < 40.1 && at.z > -40.1);
        for time in [0.0, 0.1, 0.2] {
            rows += &format!("{},{},{},{inner},{time},0,0,0\n", at.x, at.y, at.z);
        }
    }
    rows
}

fn run(text: &str) -> Results {
    let scene = scene(text).unwrap().into_scene();
    scene.prepare().unwrap().run(RunHooks::default()).unwrap()
}

/// The back of the slice has the motion of the free field there and then, and the energy balance closes.
#[test]
fn the_back_moves_as_the_ground_there() {
    let field = scene(GROUND).unwrap().into_scene().field().unwrap().clone();
    let simulation = scene(GROUND).unwrap().into_scene().prepare().unwrap();
    let warnings = simulation
        .remarks()
        .iter()
        .filter(|remark| remark.is_warning());
    assert_eq!(
        warnings.map(|w| w.to_string()).collect::<Vec<_>>(),
        Vec::<String>::new()
    );
    let results = run(GROUND);
    let error = error_of(&results, &*field, ("back", Vec3::new(0.0, 2.0, 0.0)));
    assert!(error < 5e-3, "{error:e}");
    assert!(
        results.run.energy_residual < 1e-11,
        "{:e}",
        results.run.energy_residual
    );
    let delay = results
        .run
        .energies
        .iter()
        .find(|(name, _)| *name == "delay");
    assert!(delay.is_some());
}

/// Relative difference of the motion of a history from the field at a point.
fn error_of(results: &Results, field: &dyn IncidentField, (name, at): (&str, Vec3)) -> f64 {
    let sampler = field.prepare(&[at]).unwrap();
    let table = results.histories();
    let (mut missed, mut all) = (0.0, 0.0);
    for (row, &time) in table.times.iter().enumerate() {
        let mut motion = [FieldMotion::default()];
        sampler.add_motion(time, &mut motion);
        for (c, axis) in ["ux", "uy", "uz"].iter().enumerate() {
            let column = table.column(&format!("{name}.{axis}")).unwrap();
            missed += (column.values[row] - motion[0].displacement[c]).powi(2);
            all += motion[0].displacement[c].powi(2);
        }
    }
    assert!(all > 1e-4, "{name}: {all:e}");
    f64::sqrt(missed / all)
}

/// In layered ground the back has the motion of the layered field, under SV, P and SH waves of several azimuths, in both layers.
#[test]
fn layered_ground_moves_as_its_field() {
    let mut mesh = mesh();
    let (low, high) = (Vec3::new(-1e9, -1e9, -30.0), Vec3::new(1e9, 1e9, 0.0));
    let soil = mesh.elements_in_box(&low, &high);
    let all = 0..mesh.element_count() as u32;
    let rest = all.filter(|element| !soil.contains(element)).collect();
    mesh.set_element_set("soil", soil).unwrap();
    mesh.set_element_set("rock", rest).unwrap();
    let layers = "[[material]]\nname = \"soil\"\nlaw = \"elastic\"\nyoung = 4.5e9\npoisson = 0.3\ndensity = 2400\n\
        [[part]]\nset = \"soil\"\nmaterial = \"soil\"\nkernel = \"hex8-full\"\n\
        [[layer]]\nmaterial = \"soil\"\nbottom = -30\n[[layer]]\nmaterial = \"granite\"\n\
        [[output.history]]\nname = \"below\"\nat = [20, 2, -60]\n[boundary]";
    for (kind, incidence, azimuth) in [
        ("sv", 25, 60),
        ("sv", 20, 90),
        ("p", 50, 45),
        ("sh", 30, -90),
        ("sv", 25, 0),
    ] {
        let text = GROUND
            .replacen("kind = \"sv\"", &format!("kind = \"{kind}\""), 1)
            .replacen("incidence = 25", &format!("incidence = {incidence}"), 1)
            .replacen("azimuth = 60", &format!("azimuth = {azimuth}"), 1)
            .replacen("[boundary]", layers, 1);
        let scene = scene_on(&mesh, &text).unwrap().into_scene();
        let field = scene.field().unwrap().clone();
        let results = scene.prepare().unwrap().run(RunHooks::default()).unwrap();
        for place in [
            ("back", Vec3::new(0.0, 2.0, 0.0)),
            ("below", Vec3::new(20.0, 2.0, -60.0)),
        ] {
            let error = error_of(&results, &*field, place);
            println!(
                "{kind} {incidence} at azimuth {azimuth}, {}: {error:.4}",
                place.0
            );
            assert!(error < 0.005, "{kind} {azimuth} {}: {error:e}", place.0);
        }
        assert!(results.run.energy_residual < 1e-11);
    }
}

/// A slice whose sides are not plane is a slice: all of its nodes are on them, between the ends of the mesh along y or not.
#[test]
fn sides_that_are_not_plane_make_no_bay() {
    let oblique = mesh().map_positions(|x| Vec3::new(x.x, x.y + 0.1 * x.x, x.z));
    let scene = scene_on(&oblique.unwrap(), GROUND).unwrap().into_scene();
    assert!(!scene.is_bay());
}

/// P and SV waves of one slowness along y are accepted; waves along x need no delay.
#[test]
fn waves_of_one_slowness_add_up() {
    let speeds = powerhouse::model::ElasticMedium::new(9.0e9, 0.27, 2750.0).unwrap();
    let ratio = speeds.p_speed() / speeds.s_speed();
    let other = (25f64.to_radians().sin() * ratio).asin().to_degrees();
    let second = format!(
        "[[wave]]\nkind = \"p\"\nincidence = {other}\nazimuth = 60\npulse = {{ kind = \"smooth\", displacement = 0.01, duration = 0.4 }}\n[boundary]"
    );
    let both = GROUND.replacen("[boundary]", &second, 1);
    let scene_of = |text: &str| scene(text).unwrap().into_scene();
    scene_of(&both).prepare().unwrap();
    assert!(scene_of(&both).slowness_along_y() > 1e-4);
    let across = GROUND.replacen("azimuth = 60", "azimuth = 0", 1);
    assert_eq!(scene_of(&across).slowness_along_y(), 0.0);
    scene_of(&across).prepare().unwrap();
}

/// What such slices do not take is refused with its name and a way out.
#[test]
fn what_a_slice_does_not_take_is_refused() {
    let wave = "[[wave]]\nkind = \"p\"\nincidence = 25\nazimuth = 60\npulse = { kind = \"smooth\", displacement = 0.01, duration = 0.4 }\n[boundary]";
    let delayed = "{ kind = \"delayed\", from = \"front\", to = \"back\" }";
    let other = "{ kind = \"delayed\", from = \"back\", to = \"front\" }";
    let twice = format!("{delayed}, {other}");
    let roller = format!("{delayed}, {{ kind = \"roller\", set = \"front\" }}");
    let periodic = format!("{delayed}, {{ kind = \"periodic\", from = \"left\", to = \"right\" }}");
    let fixed = format!("{delayed}, {{ kind = \"fixed\", set = \"bottom\" }}");
    let prescribed = format!(
        "{delayed}, {{ kind = \"prescribed\", set = \"top\", direction = [1, 0, 0], displacement = 0.01 }}"
    );
    let own_wave = &GROUND[GROUND.find("[[wave]]").unwrap()..GROUND.find("[time]").unwrap()];
    let stations = "[boundary]\nkind = \"viscous\"\nfaces = [\"left\", \"right\", \"bottom\"]\nregion = { box = [[-40, -2, -40], [40, 2, 0]] }\nstations = { file = \"stations.csv\" }\n";
    let cases = [
        ("[boundary]", wave, "one slowness along y", "sin(i_p)/c_p"),
        (
            "incidence = 25\nazimuth = 60",
            "incidence = 40\nazimuth = 20",
            "past the critical angle",
            "34.",
        ),
        (
            "kind = \"sv\"\nincidence = 25\nazimuth = 60",
            "kind = \"p\"\nincidence = 85\nazimuth = 90",
            "part 'rock' travel at 2022 m/s",
            "at most 81.8 degrees",
        ),
        (delayed, &twice, "one pair of delayed sides", ""),
        (
            delayed,
            &roller,
            "supports along y",
            "need no other support",
        ),
        (
            delayed,
            &periodic,
            "periodic pairs beside them",
            "absorb at the sides",
        ),
        (
            "[time]",
            "[time]\ninitial = \"field\"",
            "the motion of the field at the start",
            "start at rest",
        ),
        (
            "mesh = {",
            "precision = \"mixed\"\nmesh = {",
            "single or mixed precision",
            "double precision",
        ),
        (
            "kernel = \"hex8-full\"",
            "kernel = \"hex8-full\"\ndamping = { kind = \"high\", ratio = 0.05 }",
            "stiffness damping of part 'rock'",
            "proportional to mass",
        ),
        (
            own_wave,
            stations,
            "and the field 'stations",
            "whole length",
        ),
        (
            "kernel = \"hex8-full\"",
            "kernel = \"hex8-full\"\ndamping = { kind = \"flat\", ratio = 0.02, band = [0.5, 20] }",
            "flat damping of part 'rock'",
            "proportional to mass",
        ),
        (
            "young = 9.0e9\npoisson = 0.27\ndensity = 2750",
            "young = 60e9\npoisson = 0.27\ndensity = 2750\npore_water = { porosity = 0.15 }",
            "water in the pores of part 'rock'",
            "without water",
        ),
        (
            "[time]",
            "[[bolt]]\nname = \"nail\"\nsection = 4e-4\nyoung = 210e9\nlines = [[[0, 0, -50], [9, 0, -50]]]\n[[stage]]\nname = \"ground\"\nbolts = [\"nail\"]\nsupport = [{ kind = \"fixed\", set = \"bottom\" }]\n[time]",
            "does not take bolts",
            "whole length",
        ),
        (
            delayed,
            &prescribed,
            "prescribed motions",
            "through absorbing faces",
        ),
        (delayed, &fixed, "supports along y", "need no other support"),
        (
            "[time]",
            "[[load]]\nkind = \"pressure\"\nset = \"top\"\npressure = 1e5\nfunction = { kind = \"table\", times = [0, 1], values = [0, 1] }\n[time]",
            "loads that change in time",
            "whole length",
        ),
        (
            "scatterer =",
            "region = { box = [[-40, -2, -40], [40, 2, 0]] }\nscatterer =",
            "a region around which the field enters",
            "through the faces",
        ),
        (
            "[time]",
            "[[load]]\nkind = \"gravity\"\nfunction = { kind = \"table\", times = [0, 1], values = [0, 1] }\n[time]",
            "loads that change in time",
            "whole length",
        ),
    ];
    let missed = cases.into_iter().filter_map(|(from, to, message, way)| {
        assert!(GROUND.contains(from), "{from}");
        let refused = match scene(&GROUND.replacen(from, to, 1)) {
            Err(error) => Some(error),
            Ok(scene) => scene.into_scene().prepare().err(),
        };
        let refused = refused.map_or_else(String::new, |error| error.to_string());
        let is_named = refused.contains(message) && refused.contains(way);
        (!is_named).then(|| format!("{message}: {refused}"))
    });
    let missed: Vec<String> = missed.collect();
    assert!(missed.is_empty(), "{missed:#?}");
}

/// The mesh with a core of the elements at some places.
fn with_core(is_core: impl Fn(Vec3) -> bool) -> Mesh {
    let mut mesh = mesh();
    let all = 0..mesh.element_count() as u32;
    let (core, rest): (Vec<u32>, Vec<u32>) =
        all.partition(|element| is_core(mesh.centroid(*element)));
    mesh.set_element_set("core", core).unwrap();
    mesh.set_element_set("rock", rest).unwrap();
    mesh
}

/// A wall in the ground whose P waves are faster than the motion along y comes with a warning that has their ratio, one that is
/// slower without, and one that is too fast is refused with the largest incidence; at that incidence it is accepted.
#[test]
fn stiff_parts_come_with_a_warning_up_to_a_bound() {
    let mesh = with_core(|at| at.x.abs() < 10.0 && at.z > -70.0 && at.z < -30.0);
    let part = "[[material]]\nname = \"concrete\"\nlaw = \"elastic\"\nyoung = 40e9\npoisson = 0.2\ndensity = 2500\n[[part]]\nset = \"core\"\nmaterial = \"concrete\"\nkernel = \"hex8-full\"\n";
    let told = |incidence: f64| {
        let text = GROUND.replacen("[[wave]]", &format!("{part}[[wave]]"), 1);
        let own = format!("incidence = {incidence}\nazimuth = 90");
        let text = text.replacen("incidence = 25\nazimuth = 60", &own, 1);
        let scene = scene_on(&mesh, &text).map_err(|error| error.to_string())?;
        let scene = scene.into_scene();
        let stiff = scene.stiff_parts();
        let simulation = scene.prepare().map_err(|error| error.to_string())?;
        let warnings = simulation.remarks().iter().filter(|r| r.is_warning());
        Ok((stiff, warnings.map(|r| r.to_string()).collect::<Vec<_>>()))
    };
    let speeds = [9.0e9, 40.0e9].map(|young| {
        let [poisson, density] = if young > 1e10 {
            [0.2, 2500.0]
        } else {
            [0.27, 2750.0]
        };
        powerhouse::model::ElasticMedium::new(young, poisson, density).unwrap()
    });
    let ratio =
        |degrees: f64| degrees.to_radians().sin() * speeds[1].p_speed() / speeds[0].s_speed();
    for (incidence, most) in [(14.0, None), (16.0, Some("3 %")), (25.0, Some("8 %"))] {
        let (stiff, warnings) = told(incidence).unwrap_or_else(|error: String| panic!("{error}"));
        let Some(most) = most else {
            assert!(stiff.is_empty() && warnings.is_empty(), "{warnings:?}");
            continue;
        };
        assert_eq!(stiff.len(), 1);
        assert!((stiff[0].ratio - ratio(incidence)).abs() < 1e-9);
        let expected = format!("part 'core' travel at {:.2} of the speed", ratio(incidence));
        let found = warnings.iter().filter(|w| w.contains(&expected));
        let found: Vec<&String> = found.collect();
        assert!(found.len() == 1 && found[0].contains(most), "{warnings:?}");
    }
    let refused = told(30.0).unwrap_err();
    let largest = (1.6 * speeds[0].s_speed() / speeds[1].p_speed())
        .asin()
        .to_degrees();
    // Rounded down, so that the angle that is named is permitted.
    let largest = (10.0 * largest).floor() / 10.0;
    let way = format!("of SV waves is at most {largest:.1} degrees");
    assert!(
        refused.contains("part 'core'") && refused.contains(&way),
        "{refused}"
    );
    assert!(told(largest).is_ok());
    // The refusal of a wave past the critical angle names the same.
    let past = told(45.0).unwrap_err();
    assert!(
        past.contains(&format!("of at most {largest:.1} degrees")),
        "{past}"
    );
}

/// Parts, joints and structures beside the ground that such slices do not take.
#[test]
fn what_lies_in_the_ground_of_a_slice_may_be_refused() {
    let mesh = with_core(|at| at.x.abs() < 20.0);
    let part = "[[part]]\nset = \"core\"\nmaterial = \"granite\"\nkernel = \"hex8-full\"\n";
    let joint =
        "[[joint]]\nname = \"seam\"\nbetween = [\"rock\", \"core\"]\nlaw = \"frictionless\"\n";
    let refused = |part: &str, more: &str| {
        let text = GROUND.replacen("[[wave]]", &format!("{part}[[wave]]"), 1);
        let text = text.replacen("scatterer =", &format!("{more}scatterer ="), 1);
        let error = match scene_on(&mesh, &text) {
            Err(error) => error,
            Ok(scene) => scene.into_scene().prepare().err()?,
        };
        Some(error.to_string())
    };
    assert_eq!(refused(part, ""), None);
    for (part, more, message, way) in [
        (
            format!("{part}{joint}"),
            "",
            "does not take joint 'seam'",
            "whole length",
        ),
        (
            part.to_owned(),
            "through = [\"core\"]\n",
            "structures `through` its faces",
            "end it before",
        ),
    ] {
        let found = refused(&part, more).unwrap_or_else(|| panic!("{message}"));
        assert!(
            found.contains(message) && found.contains(way),
            "{message}: {found}"
        );
    }
}

/// Constraints and boundaries of a program's own, which scenes in Rust have, are refused.
#[test]
fn constraints_and_boundaries_of_other_crates_are_refused() {
    struct Glue;
    impl Constraint for Glue {
        fn name(&self) -> &str {
            "glue"
        }
        fn nodes(&self) -> &[u32] {
            &[0, 1]
        }
        fn correct(&mut self, _motion: PredictedMotion) -> Result<ConstraintWork, RunError> {
            Ok(ConstraintWork::default())
        }
    }
    struct Wall;
    impl AbsorbingBoundary for Wall {
        fn name(&self) -> &str {
            "wall"
        }
        fn build(&self, _site: &BoundarySite) -> Result<BoundaryParts, ModelError> {
            Ok(BoundaryParts::default())
        }
    }
    let sound = || scene(GROUND).unwrap().into_scene();
    let wall = Boundary::new(Wall, ["left", "right", "bottom"]);
    for (scene, message, way) in [
        (sound().constraint(Glue), "constraints", "whole length"),
        (
            sound().with_boundary(wall),
            "the boundary 'wall'",
            "take 'viscous-spring'",
        ),
    ] {
        let found = scene.prepare().err().unwrap().to_string();
        assert!(
            found.contains(message) && found.contains(way),
            "{message}: {found}"
        );
    }
}

/// The section of a tube across the axis of its slice is all that there is, and draws no warning as a frame; across half of the length it
/// does.
#[test]
fn the_section_of_a_whole_tube_is_no_frame() {
    let is_tube = |at: Vec3| {
        let (x, z) = (at.x.abs(), (at.z + 50.0).abs());
        x < 40.0 && z < 40.0 && (x > 30.0 || z > 30.0)
    };
    let part = "[[part]]\nset = \"core\"\nmaterial = \"granite\"\n";
    let section = "[[output.section]]\nname = \"tube\"\nset = \"core\"\nat = [0, 0, -50]\nnormal = [0, 1, 0]\nalong = [1, 0, 0]\n";
    let text = GROUND.replacen("[[wave]]", &format!("{part}[[wave]]"), 1) + section;
    let is_frame = |mesh: &Mesh, text: &str| {
        let scene = scene_on(mesh, text).unwrap().into_scene();
        let simulation = scene.prepare().unwrap();
        let mut remarks = simulation.remarks().iter();
        remarks.any(|remark| matches!(remark, powerhouse::Remark::HollowSection(_)))
    };
    let mesh = with_core(is_tube);
    assert!(!is_frame(&mesh, &text));
    let (low, high) = (Vec3::new(-100.0, -2.0, -100.0), Vec3::new(100.0, 2.0, 0.0));
    let mut two = Mesh::box_of_hexes(low, high, [20, 2, 10], "rock").unwrap();
    let all = 0..two.element_count() as u32;
    let (core, rest): (Vec<u32>, Vec<u32>) = all.partition(|e| is_tube(two.centroid(*e)));
    two.set_element_set("core", core).unwrap();
    two.set_element_set("rock", rest).unwrap();
    let rollers = "[{ kind = \"roller\", set = \"front\" }, { kind = \"roller\", set = \"back\" }]";
    let text = text
        .replace(
            "[{ kind = \"delayed\", from = \"front\", to = \"back\" }]",
            rollers,
        )
        .replace("azimuth = 60", "azimuth = 0")
        .replace("at = [0, 0, -50]\nnormal", "at = [0, 1, -50]\nnormal");
    assert!(is_frame(&two, &text));
}
