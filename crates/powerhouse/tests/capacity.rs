//! Section forces beside what reinforced sections bear.

use std::sync::Arc;

use powerhouse::boundary::ViscousSpring;
use powerhouse::engine::observe::{CrossSection, SectionCapacity, SectionReinforcement};
use powerhouse::material::{LinearElastic, media};
use powerhouse::model::{Mesh, Vec3};
use powerhouse::wavefield::{Angle, PlaneWave, PlaneWaveParameters, SmoothPulse, WaveKind};
use powerhouse::{
    Boundary, Error, Material, OutputPlan, Part, Remark, ResultFolder, RunHooks, RunNotes, Scene,
    SectionRequest,
};

use powerhouse_test_support::TestFolder as Folder;

/// Depth of the body (m).
const DEPTH: f64 = 30.0;

/// A body of rock under an oblique SV wave, with a reinforced section across.
fn scene(mesh: Mesh, cut: CrossSection, reinforcement: SectionReinforcement) -> Scene {
    let mut parameters = PlaneWaveParameters::vertical(WaveKind::SV, media::ROCK, 0.0);
    parameters.incidence = Angle::from_degrees(20.0);
    parameters.reference = mesh.bounding_box().0;
    let pulse = Arc::new(SmoothPulse::new(0.01, 0.1).unwrap());
    let rock = Material::from(LinearElastic::new(media::ROCK));
    let mut plan = OutputPlan::default().with_every(0.002);
    plan.cuts
        .push(SectionRequest::new("rock", cut).with_reinforcement(reinforcement));
    Scene::new("wall", mesh)
        .part(Part::new("rock", rock))
        .with_field(PlaneWave::new(parameters, pulse).unwrap())
        .with_boundary(Boundary::new(
            ViscousSpring::default(),
            ["left", "right", "front", "back", "bottom"],
        ))
        .with_duration(0.1)
        .with_output(plan)
}

fn block() -> Mesh {
    let (low, high) = (Vec3::new(0.0, 0.0, -DEPTH), Vec3::new(40.0, 20.0, 0.0));
    Mesh::box_of_hexes(low, high, [8, 4, 6], "rock").unwrap()
}

fn cut() -> CrossSection {
    CrossSection {
        name: "wall".into(),
        point: Vec3::new(20.0, 10.0, -10.0),
        normal: Vec3::x(),
        along: Vec3::y(),
        within: None,
    }
}

/// The greatest utilisation is that of the forces in the table, by the capacity of a section as thick as the cut; beyond
/// one a warning is beside them, below there is none. The diagram is written, with the forces in a plot.
#[test]
fn utilisation_is_that_of_the_recorded_forces() {
    for (strength, is_beyond) in [(20.0e6, false), (2.0e5, true)] {
        let reinforcement = SectionReinforcement {
            concrete_strength: strength,
            bars: [0.2 * strength / 20.0e6, 0.6 * strength / 20.0e6],
            cover: 0.5,
            yield_stress: 4.0e8,
        };
        let folder = Folder::new(&format!("capacity-{is_beyond}"));
        let simulation = scene(block(), cut(), reinforcement).prepare().unwrap();
        let announced = powerhouse::result_files(&simulation);
        let notes = RunNotes::new(simulation.remarks().to_vec());
        let mesh = simulation.mesh().clone();
        let results = simulation.run(RunHooks::default()).unwrap();
        let out = ResultFolder::new(&folder);
        out.write(("wall", &mesh), &results, &notes, None).unwrap();

        let capacity = SectionCapacity::new(DEPTH, reinforcement).unwrap();
        let columns = powerhouse::io::read_table(&folder.join("sections.csv")).unwrap();
        let column = |name: &str| {
            let found = columns.iter().find(|column| column.name == name).unwrap();
            found.values.clone()
        };
        let (axial, moment) = (
            column("wall.axial_per_metre"),
            column("wall.moment_per_metre"),
        );
        let uses: Vec<f64> = axial
            .iter()
            .zip(&moment)
            .map(|(n, m)| capacity.utilisation(*n, *m))
            .collect();
        let greatest = uses.iter().copied().fold(0.0, f64::max);
        assert_eq!(greatest > 1.0, is_beyond, "{greatest}");
        let [of] = &results.section_uses()[..] else {
            panic!("one section");
        };
        assert!((of.capacity.thickness() - DEPTH).abs() < 1e-9);
        // The table is written with some digits less.
        let is_near = |a: f64, b: f64| a == b || (a - b).abs() < 1e-6 * b.abs();
        assert!(
            is_near(of.utilisation, greatest),
            "{} {greatest}",
            of.utilisation
        );
        let first = uses.iter().position(|used| *used > 1.0);
        let times = column("time");
        assert_eq!(of.beyond_from.is_some(), first.is_some());
        if let (Some(found), Some(first)) = (of.beyond_from, first) {
            assert!((found - times[first]).abs() < 1e-9);
        }

        let warned = results.warnings(&mesh);
        let warned = warned
            .iter()
            .find(|remark| matches!(remark, Remark::BeyondCapacity(_)));
        assert_eq!(warned.is_some_and(Remark::is_warning), is_beyond);
        let read = |file: &str| std::fs::read_to_string(folder.join(file)).unwrap();
        let summary: serde_json::Value = serde_json::from_str(&read("summary.json")).unwrap();
        let written = &summary["section_uses"][0];
        assert_eq!(written["section"], "wall");
        assert_eq!(written["beyond_from"].is_number(), is_beyond);
        let text = "section 'wall' is beyond what its reinforcement bears from";
        assert_eq!(summary["warnings"].to_string().contains(text), is_beyond);
        for file in ["capacity/wall.csv", "plots/capacity-wall.svg"] {
            assert!(folder.join(file).is_file(), "{file}");
            assert!(announced.iter().any(|name| name == file), "{announced:?}");
        }
        let diagram = powerhouse::io::read_table(&folder.join("capacity/wall.csv")).unwrap();
        let [least, most] = capacity.axial_range();
        let ends = diagram[0]
            .values
            .iter()
            .fold([0.0_f64; 2], |[low, high], n| [low.min(*n), high.max(*n)]);
        assert!(
            is_near(ends[0], least) && is_near(ends[1], most),
            "{ends:?}"
        );

        out.clear().unwrap();
        assert!(!folder.join("capacity/wall.csv").exists());
    }
}

/// A reinforcement that does not fit its section is refused before the run, with the name of the section.
#[test]
fn reinforcement_must_fit_its_section() {
    let good = SectionReinforcement {
        concrete_strength: 20.0e6,
        bars: [1.0e-2; 2],
        cover: 0.5,
        yield_stress: 4.0e8,
    };
    let refused = |mesh: Mesh, reinforcement| {
        let error: Error = scene(mesh, cut(), reinforcement).prepare().err().unwrap();
        error.to_string()
    };
    let deep = SectionReinforcement {
        cover: 15.5,
        ..good
    };
    let text = refused(block(), deep);
    assert!(
        text.contains("'wall'") && text.contains("cover") && text.contains("15"),
        "{text}"
    );
    // Three quarters of a ring, which a plane cuts twice.
    let (low, high) = (Vec3::new(0.0, 0.0, 4.8), Vec3::new(1.0, 2.0, 5.2));
    let strip = Mesh::box_of_hexes(low, high, [16, 2, 2], "rock").unwrap();
    let ring = strip.map_positions(|p| {
        let (sin, cos) = (1.5 * std::f64::consts::PI * p.x).sin_cos();
        Vec3::new(-p.z * cos, p.y, p.z * sin)
    });
    let across = CrossSection {
        point: Vec3::new(-4.9, 1.0, 1.0),
        normal: Vec3::z(),
        ..cut()
    };
    let request = SectionRequest::new("rock", across).with_reinforcement(good);
    let mut plan = OutputPlan::default();
    plan.cuts.push(request);
    let rock = Material::from(LinearElastic::new(media::ROCK));
    let scene = Scene::new("ring", ring.unwrap())
        .part(Part::new("rock", rock))
        .with_duration(0.001)
        .with_output(plan);
    let text = scene.prepare().err().unwrap().to_string();
    assert!(
        text.contains("'wall'") && text.contains("`half_extent`"),
        "{text}"
    );
}
