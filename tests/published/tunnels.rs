//! Circular linings in a shear of the ground and under unequal stresses.

use powerhouse::Results;
use powerhouse_model::ElasticMedium;

use super::page::{Row, compare};
use super::ring::{Forces, Ring};
use super::run;

/// Shear stress of the scenes (Pa).
const SHEAR: f64 = 1e4;
/// Flexibility ratios of Wang (1993).
const FLEXIBILITIES: [f64; 4] = [0.5, 2.0, 5.0, 20.0];

fn medium(young: f64, poisson: f64) -> ElasticMedium {
    ElasticMedium::new(young, poisson, 2000.0).unwrap()
}

/// The ring of `ring.msh` in the ground of a flexibility ratio.
fn ring(flexibility: f64) -> Ring {
    let ring = Ring {
        radius: 5.0,
        thickness: 0.2,
        lining: medium(30e9, 0.2),
        ground: medium(1e7, 0.3),
    };
    ring.with_flexibility(flexibility)
}

/// Sections of a scene at an angle (degrees) from springline and crown, as changes of it.
fn sections_at(degrees: f64) -> [String; 4] {
    let (sin, cos) = degrees.to_radians().sin_cos();
    [
        format!(
            "output.section.springline.at=[{}, 0.5, {}]",
            5.0 * cos,
            5.0 * sin
        ),
        format!("output.section.springline.normal=[{}, 0, {cos}]", -sin),
        format!(
            "output.section.crown.at=[{}, 0.5, {}]",
            5.0 * sin,
            5.0 * cos
        ),
        format!("output.section.crown.normal=[{}, 0, {sin}]", -cos),
    ]
}

/// Last value of a column of the sections.
fn last(results: &Results, name: &str) -> f64 {
    let column = results.sections().column(name).expect("a section");
    *column.values.last().expect("a row")
}

/// Mean thrust (N/m, pressure positive), and the parts of thrust and moment that vary as `cos 2 theta`, of sections at an angle
/// (degrees) from springline and crown.
fn forces_at(results: &Results, degrees: f64) -> (f64, Forces) {
    let half = 0.5 / f64::to_radians(2.0 * degrees).cos();
    let [springline, crown] = ["springline", "crown"].map(|place| {
        ["axial", "moment"].map(|force| last(results, &format!("{place}.{force}_per_metre")))
    });
    let forces = Forces {
        thrust: half * (springline[0] - crown[0]).abs(),
        moment: half * (springline[1] - crown[1]).abs(),
    };
    (-0.5 * (springline[0] + crown[0]), forces)
}

/// The same of a scene with the sections of its file, 5.625 degrees from springline and crown.
fn forces(scene: &str, changes: &[String]) -> (f64, Forces) {
    forces_at(&run(scene, changes), 5.625)
}

/// Forces in the shear of ground of a flexibility ratio.
fn ovaling(flexibility: f64, slips: bool) -> Forces {
    let young = ring(flexibility).ground.young;
    let scene = if slips {
        "ovaling_slip.toml"
    } else {
        "ovaling.toml"
    };
    forces(scene, &[format!("material.ground.young={young}")]).1
}

/// Thrust and moment of linings from stiff to soft beside the ground, slipping and bonded, against Wang (1993) and Penzien (2000),
/// within 5 %, and against the exact solution for a ring as thick as that of the mesh, within 1 %.
#[test]
fn ovaling_of_linings() {
    let (mut wang, mut penzien, mut exact) = (Vec::new(), Vec::new(), Vec::new());
    for flexibility in FLEXIBILITIES {
        let (ring, found) = (ring(flexibility), ovaling(flexibility, true));
        assert!((ring.flexibility() / flexibility - 1.0).abs() < 1e-12);
        let (of_wang, of_penzien) = (ring.wang_full_slip(SHEAR), ring.penzien_full_slip(SHEAR));
        // One formula in two forms.
        assert!((of_wang.thrust / of_penzien.thrust - 1.0).abs() < 1e-12);
        assert!((of_wang.moment / of_penzien.moment - 1.0).abs() < 1e-12);
        let what = |force: &str| format!("F = {flexibility}, full slip, {force}");
        let pair = |rows: &mut Vec<Row>,
                    known: Forces,
                    found: Forces,
                    limit: f64,
                    what: &dyn Fn(&str) -> String| {
            rows.push(Row::new(
                what("thrust (kN/m)"),
                1e-3 * known.thrust,
                1e-3 * found.thrust,
                limit,
            ));
            rows.push(Row::new(
                what("moment (kN m/m)"),
                1e-3 * known.moment,
                1e-3 * found.moment,
                limit,
            ));
        };
        pair(&mut wang, of_wang, found, 0.05, &what);
        pair(&mut exact, ring.exact(SHEAR, true), found, 0.01, &what);
        let found = ovaling(flexibility, false);
        let what = |force: &str| format!("F = {flexibility}, bonded, {force}");
        let thrust = 1e-3 * ring.wang_bonded_thrust(SHEAR);
        wang.push(Row::new(
            what("thrust (kN/m)"),
            thrust,
            1e-3 * found.thrust,
            0.05,
        ));
        pair(&mut penzien, ring.penzien_bonded(SHEAR), found, 0.05, &what);
        pair(&mut exact, ring.exact(SHEAR, false), found, 0.01, &what);
    }
    compare("Wang", &wang);
    compare("Penzien", &penzien);
    compare("Exact ring", &exact);
}

/// Sections on the planes of symmetry, in the brick beside them and elsewhere show the thrust and the moment of the exact ring, which
/// vary as `cos 2 theta`, and no shear on the planes: a lining that slips, whose pressure of the ground is half a brick's beside the plane.
#[test]
fn sections_on_and_beside_a_plane_of_symmetry() {
    let exact = ring(5.0).exact(SHEAR, true);
    for degrees in [0.0_f64, 0.6, 1.875, 3.0, 5.625, 9.0] {
        let mut changes = sections_at(degrees).to_vec();
        changes.push(format!("material.ground.young={}", ring(5.0).ground.young));
        let results = run("ovaling_slip.toml", &changes);
        let Forces { thrust, moment } = forces_at(&results, degrees).1;
        assert!(
            (thrust / exact.thrust - 1.0).abs() < 0.03,
            "{degrees}: {thrust}, {exact:?}"
        );
        assert!(
            (moment / exact.moment - 1.0).abs() < 0.03,
            "{degrees}: {moment}, {exact:?}"
        );
        if degrees == 0.0 {
            for place in ["springline", "crown"] {
                let shear = last(&results, &format!("{place}.shear_per_metre"));
                let axial = last(&results, &format!("{place}.axial_per_metre"));
                assert!(
                    shear.abs() < 5e-3 * axial.abs(),
                    "{place}: {shear} of {axial}"
                );
            }
        }
    }
}

/// A lining that takes all that an excavation releases under unequal stresses, against Einstein & Schwartz (1979): within 5 %.
#[test]
fn a_lining_under_unequal_stresses() {
    let (ground, lining) = (medium(4.8e7, 0.34), medium(30e9, 0.2));
    let (radius, thickness, pressure, lateral) = (5.0_f64, 0.2_f64, 6e5, 0.5);
    let nu = ground.poisson;
    let stiffness =
        ground.young * (1.0 - lining.poisson.powi(2)) / (lining.young * (1.0 - nu * nu));
    let c = stiffness * radius / thickness;
    let f = stiffness * radius.powi(3) / (thickness.powi(3) / 12.0);
    let a0 = c * f * (1.0 - nu) / (c + f + c * f * (1.0 - nu));
    let mean = 0.5 * (1.0 + lateral) * (1.0 - a0) * pressure * radius;
    let half = 0.5 * (1.0 - lateral) * pressure * radius;
    let slip = 1.0 - 2.0 * (f + 6.0) * (1.0 - nu) / (2.0 * f * (1.0 - nu) + 6.0 * (5.0 - 6.0 * nu));
    let beta = ((6.0 + f) * c * (1.0 - nu) + 2.0 * f * nu)
        / (3.0 * f + 3.0 * c + 2.0 * c * f * (1.0 - nu));
    let b2 = c * (1.0 - nu)
        / (2.0 * (c * (1.0 - nu) + 4.0 * nu - 6.0 * beta - 3.0 * beta * c * (1.0 - nu)));
    let a2 = b2 * beta;
    let slipping = Forces {
        thrust: half * slip,
        moment: half * radius * slip,
    };
    let bonded = Forces {
        thrust: half * (1.0 + 2.0 * a2),
        moment: 0.5 * half * radius * (1.0 - 2.0 * a2 + 2.0 * b2),
    };
    let mut rows = Vec::new();
    for (scene, state, known) in [
        ("relief_slip.toml", "full slip", slipping),
        ("relief.toml", "bonded", bonded),
    ] {
        let (mean_found, found) = forces(scene, &[]);
        let mut row = |what: &str, known: f64, found: f64| {
            rows.push(Row::new(
                format!("{state}, {what}"),
                1e-3 * known,
                1e-3 * found,
                0.05,
            ));
        };
        row("mean thrust (kN/m)", mean, mean_found);
        row("varying thrust (kN/m)", known.thrust, found.thrust);
        row("moment (kN m/m)", known.moment, found.moment);
    }
    compare("Einstein & Schwartz", &rows);
}
