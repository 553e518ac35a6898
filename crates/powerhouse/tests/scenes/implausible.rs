//! Warnings about input that is probably not what was meant, and messages that name what is wrong.

use std::fs;

use powerhouse::{Error, FileScene, FolderError, Registry, Remark, ResultFolder, Scene, remark};

use super::support::*;

/// A record of two columns that ends at rest, with a peak of 0.3 in the file's unit.
fn record_file(variants: &Variants, name: &str, scale: f64) {
    let sample = |i: i32| {
        let time = 0.01 * f64::from(i);
        let wave = (4.0 * std::f64::consts::PI * time).cos();
        let value = if i < 100 { scale * 0.3 * wave } else { 0.0 };
        format!("{time:.2} {value}")
    };
    let lines: Vec<String> = (0..=100).map(sample).collect();
    fs::write(variants.0.join(name), lines.join("\n")).unwrap();
}

fn weak(scene: &Scene) -> Vec<(String, &'static str)> {
    let remarks = scene.remarks().iter().filter_map(|remark| match remark {
        Remark::WeakRecord(remark::WeakRecord { name, key, .. }) => {
            assert!(remark.is_warning());
            Some((name.clone(), *key))
        }
        _ => None,
    });
    remarks.collect()
}

/// A peak below 1 m/s2 (about 0.1 g), by the key `peak` or of a file that is declared in m/s2, has a warning that asks
/// for the unit; a file in g, and a stronger peak, have none. Of several components the largest counts.
#[test]
fn a_peak_that_may_be_in_g_is_warned_of() {
    let variants = Variants::new("weak-record");
    record_file(&variants, "r.txt", 1.0);
    record_file(&variants, "weaker.txt", 0.5);
    record_file(&variants, "strong.txt", 10.0);
    let pulse = "pulse = { kind = \"smooth\", displacement = 0.01, duration = 0.4 }";
    let found = |keys: &str, component: &str| {
        let record = format!(
            "record = \"r\"\n{component}[[record]]\nname = \"r\"\nconvention = \"incident\"\nbaseline = {{ kind = \"velocity-polynomial\", order = 5 }}\n{keys}"
        );
        weak(&variants.read(pulse, &record).unwrap())
    };
    let whole = |key| vec![("r".to_owned(), key)];
    let (file, si) = ("file = \"r.txt\"\n", "units = \"m/s2\"\n");
    assert_eq!(found(&[file, si].concat(), ""), whole("units"));
    assert_eq!(found(&[file, "units = \"g\"\n"].concat(), ""), []);
    assert_eq!(
        found(&[file, si, "peak = 0.3\n"].concat(), ""),
        whole("peak")
    );
    assert_eq!(
        found(&[file, "units = \"g\"\npeak = 0.3\n"].concat(), ""),
        whole("peak")
    );
    assert_eq!(found(&[file, si, "peak = 1.7\n"].concat(), ""), []);
    assert_eq!(found(&["file = \"strong.txt\"\n", si].concat(), ""), []);
    let two = "components = { x = \"weaker.txt\", y = \"r.txt\" }\n";
    let largest = vec![("r.y".to_owned(), "units")];
    assert_eq!(found(&[two, si].concat(), "component = \"x\"\n"), largest);
    let strong = "components = { x = \"strong.txt\", y = \"r.txt\" }\n";
    assert_eq!(found(&[strong, si].concat(), "component = \"y\"\n"), []);
    let text = Remark::from(remark::WeakRecord {
        name: "r".into(),
        peak: 0.3,
        key: "peak",
    });
    assert!(text.to_string().contains("0.3 g would be 2.942"), "{text}");
}

/// A baseline correction that changes a record by more than 5 % of its peak is warned of, whatever the size of the
/// record: so is a velocity that is read as an acceleration, and not the accelerogram from which it is, or one that a
/// filter changes.
#[test]
fn a_correction_that_is_too_large_is_warned_of() {
    let variants = Variants::new("large-correction");
    let step = 0.01;
    let acceleration = |i: i32| {
        let time = step * f64::from(i);
        0.002 + (6.0 * time).sin() * (-(time - 3.0).powi(2)).exp()
    };
    let mut velocity = 0.0;
    let mut rows = [Vec::new(), Vec::new()];
    for i in 0..600 {
        velocity += 0.5 * step * (acceleration(i) + acceleration(i - 1));
        for (rows, value) in rows.iter_mut().zip([acceleration(i), velocity]) {
            rows.push(format!("{:.2} {value:.9}", step * f64::from(i)));
        }
    }
    for (name, rows) in ["acceleration.txt", "velocity.txt"].into_iter().zip(rows) {
        fs::write(variants.0.join(name), rows.join("\n")).unwrap();
    }
    let pulse = "pulse = { kind = \"smooth\", displacement = 0.01, duration = 0.4 }";
    let found = |file: &str, keys: &str| {
        let record = format!(
            "record = \"r\"\n[[record]]\nname = \"r\"\nconvention = \"incident\"\nunits = \"m/s2\"\nfile = \"{file}\"\n{keys}"
        );
        let scene = variants.read(pulse, &record).unwrap();
        let share = |remark: &Remark| match remark {
            Remark::LargeCorrection(remark::LargeCorrection { share, .. }) => {
                assert!(remark.is_warning() && remark.to_string().contains("velocity"));
                Some(*share)
            }
            _ => None,
        };
        scene.remarks().iter().find_map(share)
    };
    let polynomial = "baseline = { kind = \"velocity-polynomial\", order = 3 }\n";
    assert_eq!(found("acceleration.txt", polynomial), None);
    for scale in ["", "peak = 2.0\n"] {
        let share = found("velocity.txt", &[polynomial, scale].concat()).unwrap();
        assert!(share > 0.05 && share < 10.0, "{share}");
    }
    let filter = "baseline = { kind = \"high-pass\", corner = 1.0, order = 4 }\n";
    assert_eq!(found("velocity.txt", filter), None);
}

/// A cut beyond the end of the record is an error with this end.
#[test]
fn a_cut_beyond_the_record_is_refused_with_its_end() {
    let variants = Variants::new("long-cut");
    record_file(&variants, "r.txt", 10.0);
    let record = |cut: &str| {
        format!(
            "[[record]]\nname = \"r\"\nfile = \"r.txt\"\nunits = \"m/s2\"\nconvention = \"incident\"\ncut = {cut}\nbaseline = {{ kind = \"velocity-polynomial\", order = 5 }}\n[time]"
        )
    };
    assert!(variants.read("[time]", &record("[0, 1]")).is_ok());
    let Err(Error::Scene(fault)) = variants.read("[time]", &record("[0, 40]")) else {
        panic!("a cut at 40 s of a record of 1 s was accepted")
    };
    let text = fault.to_string();
    assert!(text.contains("a cut that ends at 40 s"), "{text}");
    assert!(
        text.contains("at most 1 s, the end of the record"),
        "{text}"
    );
}

/// An SV wave past the critical angle has a remark with this angle and what the taper removed; one below has none.
#[test]
fn waves_past_the_critical_angle_are_named() {
    let variants = Variants::new("past-critical");
    let found = |incidence: &str| {
        let scene = variants.read("incidence = 20", incidence).unwrap();
        let mut remarks = scene.remarks().iter().filter_map(|remark| match remark {
            Remark::PastCritical(remark::PastCritical {
                critical, removed, ..
            }) => Some((*critical, *removed, remark.to_string())),
            _ => None,
        });
        remarks.next()
    };
    assert_eq!(found("incidence = 34"), None);
    let zero_mean = "kind = \"zero-mean\"";
    let text = CUBE
        .replace("kind = \"smooth\"", zero_mean)
        .replace("incidence = 20", "incidence = 42");
    let path = variants.0.join("past.toml");
    let scene = FileScene::from_toml(text, path, &Registry::default()).unwrap();
    let told = scene.remarks().iter().find_map(|remark| match remark {
        Remark::PastCritical(remark::PastCritical {
            critical, removed, ..
        }) => Some((*critical, *removed, remark.to_string())),
        _ => None,
    });
    let (critical, removed, text) = told.unwrap();
    let expected = (ROCK.s_speed() / ROCK.p_speed()).asin().to_degrees();
    assert!((critical - expected).abs() < 1e-9, "{critical}");
    assert!(removed.is_some_and(|removed| removed > 0.0 && removed < 1.0));
    assert!(
        text.contains(&format!("critical angle of {expected:.2} degrees")),
        "{text}"
    );
}

/// Grazing incidence is refused with the angle as it was given, in words of scene files.
#[test]
fn grazing_incidence_is_refused_in_plain_words() {
    let variants = Variants::new("grazing");
    let Err(Error::Scene(fault)) = variants.read("incidence = 20", "incidence = 89.95") else {
        panic!("grazing incidence was accepted")
    };
    let text = fault.to_string();
    assert!(text.contains("incidence of 89.95 degrees"), "{text}");
    assert!(
        text.contains("a full space") && !text.contains("::"),
        "{text}"
    );
}

/// A material that no part uses has a warning with its name.
#[test]
fn a_material_without_part_is_warned_of() {
    let variants = Variants::new("idle-material");
    let other = "[[material]]\nname = \"shotcrete\"\nlaw = \"elastic\"\nyoung = 2e10\npoisson = 0.2\ndensity = 2400\n[[part]]";
    let scene = variants.read("[[part]]", other).unwrap();
    let idle = Remark::from(remark::UnusedMaterial {
        name: "shotcrete".into(),
    });
    assert!(scene.remarks().contains(&idle) && idle.is_warning());
    let scene = variants.read("[[part]]", "[[part]]").unwrap();
    let is_idle = |remark: &Remark| matches!(remark, Remark::UnusedMaterial(_));
    assert!(!scene.remarks().iter().any(is_idle));
    // A case may take it for a part.
    let case =
        "[[case]]\nname = \"other\"\npart = [{ set = \"rock\", material = \"shotcrete\" }]\n";
    let scene = variants.read(
        "[[part]]",
        &other.replace("[[part]]", &[case, "[[part]]"].concat()),
    );
    assert!(!scene.unwrap().remarks().iter().any(is_idle));
}

/// A scatterer above the body has a warning; at its top it has none.
#[test]
fn a_scatterer_in_the_air_is_warned_of() {
    let variants = Variants::new("scatterer");
    let above = |height: &str| {
        let scatterer = format!("scatterer = [150, 150, {height}]");
        let scene = variants.read("scatterer = [150, 150, 0]", &scatterer);
        let simulation = scene.unwrap().prepare().unwrap();
        let remarks = simulation.remarks().iter();
        remarks
            .filter(|remark| matches!(remark, Remark::ScattererAbove(_)))
            .count()
    };
    assert_eq!([above("0"), above("-20"), above("12")], [0, 0, 1]);
}

/// Springs for spherical spreading have a warning in a slice, between periodic ends and between rollers on two opposite
/// sides, whatever their axis; rollers on one side, and springs for cylindrical spreading, have none.
#[test]
fn spherical_springs_of_long_bodies_are_warned_of() {
    let variants = Variants::new("spreading");
    let roller = |set: &str| format!("[[support]]\nkind = \"roller\"\nset = \"{set}\"\n");
    let both = |a: &str, b: &str| roller(a) + &roller(b);
    let ends = |faces: &str, supports: &str, mesh: &str, spreading: &str| {
        let text = CUBE
            .replace(
                "\"left\", \"right\", \"front\", \"back\", \"bottom\"",
                faces,
            )
            .replace(
                "file = \"cube.msh\"\n",
                &format!("file = \"cube.msh\"\n{mesh}"),
            )
            .replace("[boundary]\n", &format!("[boundary]\n{spreading}"))
            .replace("at = [150, 150, 0]", "at = [150, 125, 0]")
            .replace("[time]", &format!("{supports}[time]"));
        let path = variants.0.join("long.toml");
        let scene = FileScene::from_toml(text, path, &Registry::default()).unwrap();
        let mut remarks = scene.remarks().iter().filter_map(|remark| match remark {
            Remark::SphericalSpreading(remark::SphericalSpreading { ends }) => Some(*ends),
            _ => None,
        });
        remarks.next()
    };
    let (along_y, along_x) = (
        "\"left\", \"right\", \"bottom\"",
        "\"front\", \"back\", \"bottom\"",
    );
    let periodic = "[[support]]\nkind = \"periodic\"\nfrom = \"left\"\nto = \"right\"\n";
    for (faces, supports, mesh, expected) in [
        (
            along_y,
            both("front", "back"),
            "",
            Some("a body between rollers"),
        ),
        (
            along_x,
            both("left", "right"),
            "",
            Some("a body between rollers"),
        ),
        (
            along_x,
            periodic.into(),
            "",
            Some("a body between periodic ends"),
        ),
        (
            along_y,
            both("front", "back"),
            "slice = { across = \"y\", at = 120 }\n",
            Some("a slice"),
        ),
        (
            "\"left\", \"right\", \"back\", \"bottom\"",
            roller("front"),
            "",
            None,
        ),
        (
            "\"right\", \"back\", \"bottom\"",
            both("front", "left"),
            "",
            None,
        ),
    ] {
        assert_eq!(ends(faces, &supports, mesh, ""), expected, "{supports}");
        assert_eq!(
            ends(faces, &supports, mesh, "spreading = \"spherical\"\n"),
            expected
        );
        let cylindrical = "spreading = \"cylindrical\"\n";
        assert_eq!(
            ends(faces, &supports, mesh, cylindrical),
            None,
            "{supports}"
        );
    }
}

/// An element of several parts, or of none, is refused with the names of the sets that contain it.
#[test]
fn an_element_of_two_parts_is_refused_with_their_names() {
    let variants = Variants::new("two-parts");
    let mut mesh = cube();
    let every: Vec<u32> = (0..mesh.element_count() as u32).collect();
    mesh.set_element_set("lower", every[..30].to_vec()).unwrap();
    mesh.set_element_set("rest", every[30..].to_vec()).unwrap();
    powerhouse::io::write_gmsh(variants.0.join("cube.msh"), &mesh).unwrap();
    let refused = |sets: &[&str]| {
        let parts: Vec<String> = (sets.iter())
            .map(|set| format!("[[part]]\nset = \"{set}\"\nmaterial = \"granite\"\n"))
            .collect();
        let part = "[[part]]\nset = \"rock\"\nmaterial = \"granite\"\nkernel = \"hex8-full\"\n";
        match variants.read(part, &parts.concat()) {
            Err(Error::Scene(fault)) => fault.to_string(),
            _ => panic!("{sets:?} were accepted"),
        }
    };
    let twice = refused(&["lower", "rock"]);
    assert!(twice.contains("belongs to 2 parts"), "{twice}");
    assert!(twice.contains("it is in 'lower', 'rock'"), "{twice}");
    let forgotten = refused(&["lower"]);
    assert!(forgotten.contains("belongs to 0 parts"), "{forgotten}");
    assert!(
        forgotten.contains("it is in 'rest', 'rock', of which the scene has no part"),
        "{forgotten}"
    );
}

/// A folder in which no file can be written is refused by its own name, before a run and by a check that leaves no trace.
#[test]
fn an_unwritable_folder_is_named() {
    let folder = Folder::new("unwritable");
    let new = ResultFolder::new(folder.join("deep/new"));
    new.check_writable().unwrap();
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 0);
    fs::write(folder.join("file"), "").unwrap();
    let path = folder.join("file/results");
    let within_file = ResultFolder::new(&path);
    let refusals = [
        within_file.check_writable().unwrap_err(),
        within_file.lock().unwrap_err(),
    ];
    for refused in refusals {
        assert!(matches!(
            &refused,
            Error::Folder(FolderError::Unwritable { folder, .. }) if *folder == path
        ));
        let text = refused.to_string();
        assert!(text.contains("cannot write into this folder"), "{text}");
        assert!(!text.contains("lock"), "{text}");
    }
}

/// Checks of one folder by several threads at a time do not disturb each other.
#[test]
fn checks_of_a_folder_run_side_by_side() {
    let folder = Folder::new("side-by-side");
    let checks: Vec<_> = (0..8)
        .map(|_| {
            let shared = ResultFolder::new(folder.join("new"));
            std::thread::spawn(move || (0..100).try_for_each(|_| shared.check_writable()))
        })
        .collect();
    for check in checks {
        check.join().unwrap().unwrap();
    }
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 0);
}
