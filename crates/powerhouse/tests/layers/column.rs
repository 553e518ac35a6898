//! A column of layers between periodic sides, of which the bottom alone absorbs.

use std::path::PathBuf;

use powerhouse::RunHooks;
use powerhouse::model::{FieldMotion, IncidentField, Vec3};
use powerhouse::wavefield::{EndDisplacement, Signal};

use super::{SITE, read};

/// The layered site as a column: sides and ends are periodic, or rollers on the ends, and the wave comes in at the bottom.
pub(super) fn column(wave: &str, ends: &str, others: &[(&str, &str)]) -> String {
    let boundary = SITE.find("[boundary]").unwrap();
    let (start, end) = (SITE.find("[[wave]]").unwrap(), SITE.find("[time]").unwrap());
    let supports = SITE.find("[[support]]").unwrap();
    assert!(supports < boundary && boundary < start);
    let mut text = format!(
        "{}[[support]]\nkind = \"periodic\"\nfrom = \"left\"\nto = \"right\"\n{ends}\n[boundary]\nkind = \"viscous\"\nfaces = [\"bottom\"]\n{wave}\n{}",
        &SITE[..supports],
        &SITE[end..],
    );
    for (old, new) in others {
        assert!(text.contains(old), "{old}");
        text = text.replacen(old, new, 1);
    }
    text
}

pub(super) const PERIODIC: &str =
    "[[support]]\nkind = \"periodic\"\nfrom = \"front\"\nto = \"back\"\n";
const ROLLERS: &str = "[[support]]\nkind = \"roller\"\nset = \"front\"\n[[support]]\nkind = \"roller\"\nset = \"back\"\n";

/// Relative L2 error of the motion of the surface along an axis against the field of the layers.
fn error(text: &str, axis: usize) -> f64 {
    let scene = read(text).unwrap();
    let [wave] = scene.layered_waves() else {
        panic!("one wave");
    };
    let sampler = wave.prepare(&[Vec3::new(0.0, 2.0, 0.0)]).unwrap();
    let results = scene.prepare().unwrap().run(RunHooks::default()).unwrap();
    let name = ["surface.ux", "surface.uy", "surface.uz"][axis];
    let column = results.histories().column(name).unwrap();
    let (mut off, mut all) = (0.0, 0.0);
    for (time, value) in results.histories().times.iter().zip(&column.values) {
        let mut motion = [FieldMotion::default()];
        sampler.add_motion(*time, &mut motion);
        let exact = motion[0].displacement[axis];
        off += (value - exact) * (value - exact);
        all += exact * exact;
    }
    (off / all).sqrt()
}

/// The surface of a column whose bottom alone absorbs moves as the field of its layers: SV, SH and P waves straight up, elastic and
/// damped, between periodic ends and rollers; the error is that of elements of 4 m, 17 to 25 to the wavelength in clay.
#[test]
fn a_column_moves_like_its_layers() {
    let damping = "damping = { kind = \"flat\", ratio = 0.05, band = [0.5, 20] }";
    let part = |name: &str| format!("set = \"{name}\"\n{damping}");
    let layer = |bottom: &str| format!("{bottom}\n{damping}\n");
    let (clay, gravel) = (part("clay"), part("gravel"));
    let (upper, lower) = (layer("bottom = -20\n"), layer("bottom = -40\n"));
    let damped = [
        ("set = \"clay\"", clay.as_str()),
        ("set = \"gravel\"", gravel.as_str()),
        ("bottom = -20 ", upper.as_str()),
        ("bottom = -40\n", lower.as_str()),
    ];
    for (kind, ends, others, axis) in [
        ("sv", PERIODIC, &[][..], 0),
        ("sh", PERIODIC, &damped[..], 1),
        ("p", ROLLERS, &[][..], 2),
        ("sv", ROLLERS, &damped[..], 0),
    ] {
        let wave = format!(
            "[[wave]]\nkind = \"{kind}\"\nincidence = 0\npulse = {{ kind = \"ricker\", displacement = 0.01, frequency = 2 }}\n"
        );
        let error = error(&column(&wave, ends, others), axis);
        println!("figure layers.column_{kind} {error:.4}");
        assert!(error < 0.03, "{kind} {ends}: {error}");
    }
}

/// A record of the surface of the column, or of a depth in it, becomes the motion there: the field is that of the layers.
#[test]
fn a_column_takes_records_of_its_surface_and_of_a_depth() {
    let file = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let file = file.join("../../data/records/el_centro_1940_ns.csv");
    for (convention, depth) in [
        ("\"surface-along\"", 0.0),
        ("{ within = { depth = 20, component = \"along\" } }", 20.0),
        ("{ within = { depth = 56, component = \"along\" } }", 56.0),
    ] {
        let wave = format!(
            "[[record]]\nname = \"r\"\nfile = {file:?}\nunits = \"m/s2\"\ncut = [0, 5]\nbaseline = {{ kind = \"velocity-polynomial\", order = 5 }}\nconvention = {convention}\n[[wave]]\nkind = \"sv\"\nincidence = 0\nrecord = \"r\"\n"
        );
        // What comes after the end of the run is left out of the field.
        let scene = read(&column(
            &wave,
            PERIODIC,
            &[("duration = 3", "duration = 9")],
        ))
        .unwrap();
        let history = scene.records()["r"].clone();
        let record = history.into_signal(EndDisplacement::Declared(0.0)).unwrap();
        let field = &scene.layered_waves()[0];
        let sampler = field.prepare(&[Vec3::new(0.0, 2.0, -depth)]).unwrap();
        // Time zero of the record is that of the incident wave at the top of the half-space.
        let arrival = field.parameters().arrival_at(&Vec3::new(0.0, 2.0, -40.0));
        let (mut off, mut all) = (0.0, 0.0);
        for i in 0..250 {
            let time = 0.02 * f64::from(i);
            let mut motion = [FieldMotion::default()];
            sampler.add_motion(arrival + time, &mut motion);
            let expected = record.motion(time).velocity;
            off += (motion[0].velocity.x - expected).powi(2);
            all += expected * expected;
        }
        let error = f64::sqrt(off / all);
        println!("figure layers.column_record_{depth} {error:.2e}");
        assert!(error < 0.01, "{convention}: {error}");
    }
}

/// An interface that no plane of the mesh of a column has is refused, with the height of the next.
#[test]
fn a_column_needs_planes_at_its_interfaces() {
    let wave = "[[wave]]\nkind = \"sv\"\nincidence = 0\npulse = { kind = \"ricker\", displacement = 0.01, frequency = 2 }\n";
    let text = column(wave, PERIODIC, &[("bottom = -20 ", "bottom = -21 ")]);
    let told = read(&text).err().unwrap().to_string();
    assert!(told.contains("at z = -20 m"), "{told}");
}
