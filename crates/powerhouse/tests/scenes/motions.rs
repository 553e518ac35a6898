//! Recorded motions of three components: the waves that they are split into, and what is refused.

use powerhouse::io::write_gmsh;
use powerhouse::model::{FieldMotion, FieldSampler, IncidentField, Mesh, Vec3};
use powerhouse::wavefield::WaveKind;
use powerhouse::{Error, FileScene, Registry, Remark, RenderFault as _, RunHooks, Scene, remark};

use super::support::{Folder, Variants, WAVE};

/// Step of the records (s).
const STEP: f64 = 0.01;

/// Acceleration of a component, which ends at rest.
fn acceleration(component: usize, time: f64) -> f64 {
    let bell = |frequency: f64, delay: f64| {
        let a = (std::f64::consts::PI * frequency * (time - delay)).powi(2);
        (1.0 - 2.0 * a) * (-a).exp()
    };
    let [strong, weak] = [[3.0, 1.0], [2.0, -1.5], [1.0, 1.0]][component];
    strong * bell(2.0 + component as f64, 1.0) + weak * bell(4.0, 1.4 + 0.2 * component as f64)
}

/// Writes the three files of a station.
fn write_station(folder: &Folder) {
    for (component, name) in ["x.txt", "y.txt", "z.txt"].into_iter().enumerate() {
        let rows = (0..=300).map(|i| {
            let time = STEP * f64::from(i);
            format!("{time} {}\n", acceleration(component, time))
        });
        std::fs::write(folder.join(name), rows.collect::<String>()).unwrap();
    }
}

fn record(convention: &str) -> String {
    format!(
        "[[record]]\nname = \"station\"\nconvention = {convention}\ncomponents = {{ x = \"x.txt\", y = \"y.txt\", z = \"z.txt\" }}\nunits = \"m/s2\"\n"
    )
}

const MOTION: &str = "[[motion]]\nrecord = \"station\"\nincidence = { p = 10, sv = 20, sh = 30 }\nazimuth = 30\nat = [100, 40]\n";

/// Acceleration of a sum of fields at a point, as the mean over the record's step.
fn of_fields(fields: &[&dyn IncidentField], point: Vec3, time: f64) -> Vec3 {
    let samplers = fields.iter().map(|field| field.prepare(&[point]).unwrap());
    let samplers: Vec<Box<dyn FieldSampler>> = samplers.collect();
    let at = |time: f64| {
        let mut motion = [FieldMotion::default()];
        samplers
            .iter()
            .for_each(|s| s.add_motion(time, &mut motion));
        motion[0].velocity
    };
    (at(time + 0.5 * STEP) - at(time - 0.5 * STEP)) / STEP
}

/// Checks that the sum of fields at a point is the station's motion, times a factor, to 1e-3 of each peak, from an arrival on.
fn check_sum(fields: &[&dyn IncidentField], point: Vec3, arrival: f64, factor: f64) {
    let (mut missed, mut peak) = ([0.0f64; 3], [0.0f64; 3]);
    for i in 2..298 {
        let time = STEP * (f64::from(i) + 0.5);
        let found = of_fields(fields, point, arrival + time);
        for axis in 0..3 {
            let [a, b] = [time - 0.5 * STEP, time + 0.5 * STEP];
            let recorded = 0.5 * factor * (acceleration(axis, a) + acceleration(axis, b));
            missed[axis] = missed[axis].max((found[axis] - recorded).abs());
            peak[axis] = peak[axis].max(recorded.abs());
        }
    }
    let misfit: [f64; 3] = core::array::from_fn(|axis| missed[axis] / peak[axis]);
    println!("figure motion.misfit {misfit:?}");
    assert!(misfit.iter().all(|m| *m <= 1e-3), "{misfit:?}");
}

/// Arrival, place and quality of the split that a scene reports, with its text.
fn split(scene: &Scene) -> (f64, Vec3, String) {
    let found = scene.remarks().iter().find_map(|remark| match remark {
        Remark::Split(remark::Split { arrival, place, .. }) => {
            Some((*arrival, *place, remark.to_string()))
        }
        _ => None,
    });
    found.unwrap()
}

/// A motion becomes a P, an SV and an SH wave, whose sum at its point is the record; the first of them
/// reaches the body at the start of the run, unless an arrival is given; and the run reports it.
#[test]
fn the_waves_of_a_motion_are_its_record() {
    let variants = Variants::new("motions");
    write_station(&variants.0);
    let text = format!("{}{MOTION}", record("\"surface\""));
    let scene = variants.read(WAVE, &text).unwrap();
    let kinds: Vec<WaveKind> = scene
        .plane_waves()
        .iter()
        .map(|w| w.parameters().kind)
        .collect();
    assert_eq!(kinds, [WaveKind::P, WaveKind::SV, WaveKind::SH]);
    let waves: Vec<&dyn IncidentField> = scene
        .plane_waves()
        .iter()
        .map(|wave| wave as &dyn IncidentField)
        .collect();
    let (arrival, place, told) = split(&scene);
    assert_eq!(place, Vec3::new(100.0, 40.0, 0.0));
    // From the corner that SH at 30 degrees reaches first, the way of which takes longest.
    assert!(arrival > 0.15 && arrival < 0.5, "{arrival}");
    check_sum(&waves, place, arrival, 1.0);
    assert!(
        told.starts_with("record 'station' is split into P at 10.0000, SV at 20.0000, SH at 30.0000 degrees, azimuth 30.0000: condition number at most 1."),
        "{told}"
    );
    let kinds = scene
        .input()
        .waves
        .iter()
        .map(|wave| (wave.kind, wave.incidence));
    let expected = [
        (WaveKind::P, 10.0),
        (WaveKind::SV, 20.0),
        (WaveKind::SH, 30.0),
    ];
    assert_eq!(kinds.collect::<Vec<_>>(), expected);
    let simulation = scene.into_scene().with_duration(1.6).prepare().unwrap();
    let mut remarks = simulation.remarks().iter();
    assert!(remarks.any(|r| matches!(r, Remark::Split(_)) && !r.is_warning()));
    let results = simulation.run(RunHooks::default()).unwrap();
    let peak = results
        .histories()
        .column("surface.ax")
        .unwrap()
        .values
        .iter();
    assert!(peak.fold(0.0f64, |m, a| m.max(a.abs())) > 0.5);

    let later = text.replace("at = [100, 40]", "arrival = 0.7\nfactor = -0.5");
    let scene = variants.read(WAVE, &later).unwrap();
    let waves: Vec<&dyn IncidentField> = scene
        .plane_waves()
        .iter()
        .map(|wave| wave as &dyn IncidentField)
        .collect();
    let (arrival, place, _) = split(&scene);
    assert_eq!((arrival, place), (0.7, Vec3::new(150.0, 150.0, 0.0)));
    check_sum(&waves, place, arrival, -0.5);
}

/// A record within the rock is split so, too: a shallow one comes back at its depth.
#[test]
fn the_waves_of_a_motion_at_a_depth_are_its_record() {
    let variants = Variants::new("motions-within");
    write_station(&variants.0);
    let within = "{ within = { depth = 20, regularisation = 0.001 } }";
    let text = format!("{}{MOTION}", record(within));
    let scene = variants.read(WAVE, &text).unwrap();
    let waves: Vec<&dyn IncidentField> = scene
        .plane_waves()
        .iter()
        .map(|wave| wave as &dyn IncidentField)
        .collect();
    let (arrival, place, _) = split(&scene);
    assert_eq!(place, Vec3::new(100.0, 40.0, -20.0));
    check_sum(&waves, place, arrival, 1.0);
}

/// In layered ground the same holds for records of the surface.
#[test]
fn the_waves_of_a_motion_in_layers_are_its_record() {
    let folder = Folder::new("motions-layers");
    write_station(&folder);
    let (low, high) = (Vec3::new(-40.0, 0.0, -60.0), Vec3::new(40.0, 40.0, 0.0));
    let mut mesh = Mesh::box_of_hexes(low, high, [4, 2, 6], "all").unwrap();
    for (name, range) in [("clay", -20.0..0.0), ("rock", -60.0..-20.0)] {
        let lies_in = |element: &u32| range.contains(&mesh.centroid(*element).z);
        let elements = (0..mesh.element_count() as u32).filter(lies_in).collect();
        mesh.set_element_set(name, elements).unwrap();
    }
    write_gmsh(folder.join("site.msh"), &mesh).unwrap();
    let material = |name: &str, young: f64| {
        format!(
            "[[material]]\nname = \"{name}\"\nlaw = \"elastic\"\nyoung = {young:e}\npoisson = 0.35\ndensity = 2000\n[[part]]\nset = \"{name}\"\nmaterial = \"{name}\"\n"
        )
    };
    let text = format!(
        "title = \"site\"\n[mesh]\nfile = \"site.msh\"\n{}{}[[layer]]\nmaterial = \"clay\"\nbottom = -20\n[[layer]]\nmaterial = \"rock\"\n{}[[motion]]\nrecord = \"station\"\nincidence = {{ p = 15, sv = 10, sh = 20 }}\nat = [10, 5]\n[boundary]\nkind = \"viscous-spring\"\nfaces = [\"left\", \"right\", \"front\", \"back\", \"bottom\"]\nscatterer = [0, 20, 0]\n[time]\nduration = 4\n",
        material("clay", 3e8),
        material("rock", 5e9),
        record("\"surface\"")
    );
    let read =
        |text: &str| FileScene::from_toml(text, folder.join("site.toml"), &Registry::default());
    let scene = read(&text).unwrap();
    let waves: Vec<&dyn IncidentField> = scene
        .layered_waves()
        .iter()
        .map(|wave| wave as &dyn IncidentField)
        .collect();
    assert_eq!(waves.len(), 3);
    let (arrival, place, told) = split(&scene);
    assert_eq!(place, Vec3::new(10.0, 5.0, 0.0));
    assert!(arrival > 0.05 && arrival < 0.5, "{arrival}");
    check_sum(&waves, place, arrival, 1.0);
    assert!(told.contains("between 0.1 and 15 Hz"), "{told}");
    scene.prepare().unwrap();
    // An outcrop is that of rock, at the top of the half-space.
    let scene = read(&text.replace("\"surface\"", "\"outcrop\"")).unwrap();
    assert_eq!(split(&scene).1, Vec3::new(10.0, 5.0, -20.0));
}

/// What does not fit is refused at its place, and says what would.
#[test]
fn motions_that_do_not_fit_are_refused() {
    let variants = Variants::new("motions-refused");
    write_station(&variants.0);
    let told = |convention: &str, old: &str, new: &str| {
        let text = format!("{}{MOTION}", record(convention));
        assert!(text.contains(old), "{old}");
        match variants.read(WAVE, &text.replacen(old, new, 1)) {
            Err(Error::Scene(fault)) => fault.render(false),
            Err(error) => panic!("{new}: {error}"),
            Ok(_) => panic!("{new} was accepted"),
        }
    };
    let surface = "\"surface\"";
    let within = "{ within = { depth = 150, regularisation = 0.001 } }";
    for (convention, old, new, message) in [
        (
            "\"incident\"",
            "azimuth",
            "azimuth",
            "`surface`, `outcrop`, or `within`",
        ),
        (
            "\"surface-z\"",
            "azimuth",
            "azimuth",
            "one component for a motion",
        ),
        (
            "{ within = { depth = 9, component = \"z\" } }",
            "azimuth",
            "azimuth",
            "without a component",
        ),
        (surface, "p = 10, ", "", "the key 'p' is missing"),
        (
            surface,
            ", sh = 30",
            "",
            "across the direction of travel, which takes SH",
        ),
        (surface, "sv = 20", "sv = 40", "critical angle"),
        (
            surface,
            "p = 10, sv = 20",
            "p = 89, sv = 0",
            "condition number of the split is",
        ),
        (
            within,
            "azimuth",
            "azimuth",
            "in the band from 0.1 to 15 Hz",
        ),
        (
            surface,
            "azimuth = 30",
            "band = [5, 1]",
            "the lower one first",
        ),
        (
            surface,
            ", z = \"z.txt\"",
            "",
            "there is no record 'station.z'",
        ),
        (surface, ", z = \"z.txt\"", "", "if the others do not move"),
        (surface, "azimuth = 30", "components = []", "one or more"),
        (surface, "azimuth = 30", "arrival = -1", "at rest"),
        (
            surface,
            "[[motion]]",
            "[ground]\nspace = \"full-space\"\n[[motion]]",
            "a full space has none",
        ),
        (
            surface,
            "[[motion]]\nrecord = \"station\"\nincidence = { p = 10, sv = 20, sh = 30 }\nazimuth = 30\nat = [100, 40]\n",
            "[[wave]]\nkind = \"sv\"\nincidence = 5\nrecord = \"station\"\ncomponent = \"x\"\n",
            "or a [[motion]] in place of the wave",
        ),
    ] {
        let told = told(convention, old, new);
        assert!(told.contains(message), "{convention} {new}: {told}");
    }
    // Components that do not move are named.
    let text = format!("{}{MOTION}", record(surface));
    let plane = text
        .replace("azimuth = 30", "components = [\"x\", \"z\"]")
        .replace(", sh = 30", "");
    let scene = variants.read(WAVE, &plane).unwrap();
    assert_eq!(scene.plane_waves().len(), 2);
    assert!(split(&scene).2.ends_with("nothing moves along y"));
    // A narrower band of the same record does.
    let text = format!("{}{MOTION}band = [0.1, 2]\n", record(within));
    assert!(variants.read(WAVE, &text).is_ok());
}
