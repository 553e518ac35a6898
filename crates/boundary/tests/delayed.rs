//! Dashpots of delayed slices.

use std::path::Path;

use powerhouse_boundary::{FaceCoefficients, Viscous, ViscousSpring};
use powerhouse_model::{
    AbsorbingBoundary, BoundarySite, ElasticMedium, Mat3, SiteFace, SiteNode, Vec3,
};

fn rock() -> ElasticMedium {
    ElasticMedium::new(9.0e9, 0.27, 2700.0).unwrap()
}

/// The coefficients are those of the table to 1e-8, at slownesses up to 0.95 of that of P waves.
#[test]
fn matched_dashpots_are_those_of_the_table() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/reference");
    let text = std::fs::read_to_string(root.join("matched_dashpots.csv")).unwrap();
    let rows = text.lines().filter(|line| !line.starts_with(['#', 's']));
    let mut count = 0;
    for row in rows {
        let numbers: Vec<f64> = row.split(',').map(|x| x.parse().unwrap()).collect();
        // The ratio has all its digits.
        let found = FaceCoefficients::matched(&rock(), numbers[0] / rock().p_speed());
        let found = [
            found.normal_dashpot,
            found.tangential_dashpot,
            found.axial_dashpot,
            found.coupling,
        ];
        for (found, expected) in found.iter().zip(&numbers[2..]) {
            let error = (found - expected).abs();
            assert!(error <= 1e-8 * numbers[2], "{row}: {found}");
        }
        count += 1;
    }
    assert_eq!(count, 7);
}

/// A plane wave that leaves along the normal with a slowness along y carries no force beyond that of the matrices: P, SV and
/// SH waves of all three directions, at oblique faces and both signs of the slowness.
#[test]
fn waves_leave_without_reflection() {
    let medium = rock();
    let (density, shear, lambda) = (medium.density, medium.shear(), medium.lambda());
    for normal in [Vec3::x(), -Vec3::z(), Vec3::new(0.6, 0.0, -0.8)] {
        for ratio in [0.3, -0.7, 0.94] {
            let s = ratio / medium.p_speed();
            let area = 1.7;
            let node = SiteNode {
                node: 0,
                position: normal * 30.0,
                faces: vec![SiteFace {
                    face: 0,
                    medium,
                    normal,
                    area,
                }],
            };
            let site = BoundarySite::new(vec!["face".into()], vec![node], Vec3::zeros(), None);
            let site = site.with_slowness(s);
            let viscous = Viscous::default().build(&site).unwrap();
            let [plain] = viscous.impedance[..] else {
                panic!("one node");
            };
            let across = normal.cross(&Vec3::y());
            let [p, sv, sh] = [medium.p_speed(), medium.s_speed(), medium.s_speed()].map(|speed| {
                let along = (1.0 / (speed * speed) - s * s).sqrt();
                normal * along + Vec3::y() * s
            });
            let polarised = [
                (p, p.normalize()),
                (sv, sv.cross(&across).normalize()),
                (sh, across),
            ];
            for (slowness, velocity) in polarised {
                // strain rate = -(s v + v s) / 2 times the rate of the velocity; traction per velocity.
                let gradient = -(velocity * slowness.transpose());
                let strain = (gradient + gradient.transpose()) * 0.5;
                let stress = Mat3::identity() * (lambda * strain.trace()) + strain * (2.0 * shear);
                let traction = stress * normal * area;
                let force = -(plain.dashpot + plain.gyroscopic) * velocity;
                let error = (traction - force).norm() / (density * medium.p_speed() * area);
                assert!(error < 1e-12, "{normal:?} {ratio} {velocity:?}: {error:e}");
            }
            let sprung = ViscousSpring::default().build(&site).unwrap();
            assert_eq!(sprung.impedance[0].dashpot, plain.dashpot);
            assert_eq!(sprung.impedance[0].gyroscopic, plain.gyroscopic);
        }
    }
}

/// Faces across y and slownesses past that of P waves are refused.
#[test]
fn faces_across_the_axis_and_fast_motion_are_refused() {
    let site = |normal: Vec3, ratio: f64| {
        let node = SiteNode {
            node: 0,
            position: normal * 30.0,
            faces: vec![SiteFace {
                face: 0,
                medium: rock(),
                normal,
                area: 1.0,
            }],
        };
        let site = BoundarySite::new(vec!["end".into()], vec![node], Vec3::zeros(), None);
        site.with_slowness(ratio / rock().p_speed())
    };
    let refused = |site: &BoundarySite| Viscous::default().build(site).err().unwrap().to_string();
    let oblique = Vec3::new(0.8, 0.6, 0.0);
    assert!(refused(&site(oblique, 0.5)).contains("'end' is not parallel to y"));
    assert!(refused(&site(Vec3::x(), 1.0)).contains("no P wave leaves"));
    assert!(Viscous::default().build(&site(oblique, 0.0)).is_ok());
}
