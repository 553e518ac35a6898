//! Material point driver, and yield stresses along the paths of laboratory tests.

use powerhouse_material_damage::{
    Control, ElastoPlastic, LinearElastic, MaterialError, MohrCoulomb, MohrCoulombParameters,
    PointDriver, media, presets,
};
use powerhouse_model::Stress;

fn rock(dilation: f64, tension_strength: Option<f64>) -> ElastoPlastic<MohrCoulomb> {
    let p = MohrCoulombParameters {
        dilation,
        tension_strength,
        ..presets::PAPER_ROCK
    };
    ElastoPlastic::new(MohrCoulomb::new(p).unwrap())
}

/// `N` and `2 c sqrt(N)` of the rock: phi 42 degrees, c 1.05 MPa.
fn constants() -> (f64, f64) {
    let ratio = 66.0_f64.to_radians().tan().powi(2);
    (ratio, 2.0 * 1.05e6 * ratio.sqrt())
}

/// The stress of an elastic bar with free sides is Young's modulus times its strain, and the work is half
/// the product of both.
#[test]
fn an_elastic_bar_carries_young_times_strain() {
    let mut point = PointDriver::new(LinearElastic::new(media::ROCK));
    let end = point.advance(Control::uniaxial(1.0e-4), 5).unwrap()[4].clone();
    let expected = media::ROCK.young * 1.0e-4;
    assert!((end.stress.0[2] - expected).abs() < 1e-10 * expected);
    assert!((end.work - 0.5 * expected * 1.0e-4).abs() < 1e-10 * expected * 1.0e-4);
    assert!(end.stress.0[0].abs() < 1e-10 * expected);
}

/// Yield stresses of the driven law in uniaxial, triaxial and biaxial compression, in extension,
/// tension, plane strain and shear are the closed forms, with and without dilation.
#[test]
fn yield_stresses_along_laboratory_paths_are_closed_forms() {
    let (ratio, strength) = constants();
    for dilation in [0.0, 10.0, 42.0] {
        let law = rock(dilation, None);
        let yields = |target: [Control; 6], initial: [f64; 6]| {
            let mut point = PointDriver::new(law).with_initial(Stress(initial)).unwrap();
            point.advance(target, 40).unwrap()[39].stress.0
        };
        let none = [0.0; 6];
        let pressure = [-2.0e6, -2.0e6, -2.0e6, 0.0, 0.0, 0.0];
        let deep = [-4.0e7, -4.0e7, -4.0e7, 0.0, 0.0, 0.0];
        let check = |stress: f64, expected: f64, what: &str| {
            let error = (stress - expected).abs() / expected.abs();
            assert!(
                error < 1e-10,
                "{what}, {dilation} degrees: {stress} {expected}"
            );
        };
        check(
            yields(Control::uniaxial(-2.0e-3), none)[2],
            -strength,
            "uniaxial",
        );
        check(
            yields(Control::uniaxial(1.0e-3), none)[2],
            strength / ratio,
            "tension",
        );
        check(
            yields(Control::biaxial(-2.0e-3), none)[0],
            -strength,
            "biaxial",
        );
        let triaxial = yields(Control::triaxial(-2.0e6, -6.0e-3), pressure)[2];
        check(triaxial, -2.0e6 * ratio - strength, "triaxial compression");
        let extension = yields(Control::triaxial(-4.0e7, 1.2e-2), deep)[2];
        check(extension, (-4.0e7 + strength) / ratio, "triaxial extension");
        let shear = yields(Control::simple_shear([0.0; 3], 2.0e-3), none)[3];
        let cosine = 42.0_f64.to_radians().cos();
        check(shear, 1.05e6 * cosine, "shear");
        let plane = yields(Control::plane_strain(-2.0e6, -6.0e-3), pressure)[2];
        check(plane, -2.0e6 * ratio - strength, "plane strain");
    }
    let cut = rock(0.0, Some(0.5e6));
    let mut point = PointDriver::new(cut);
    let end = point.advance(Control::uniaxial(1.0e-3), 10).unwrap()[9]
        .stress
        .0[2];
    assert!((end - 0.5e6).abs() < 1e-10 * 0.5e6, "{end}");
}

/// Targets that are not finite, and stresses beyond the strength, are errors, and the point remains
/// where it was.
#[test]
fn what_cannot_be_followed_is_refused() {
    let mut point = PointDriver::new(rock(0.0, None));
    for broken in [f64::NAN, f64::INFINITY, 1.0e300] {
        let before = point.state().clone();
        let refused = point.advance([Control::Strain(broken); 6], 1);
        assert!(
            matches!(refused, Err(MaterialError::NotFinite { .. })),
            "{refused:?}"
        );
        assert_eq!(point.state(), &before);
    }
    let mut target = Control::uniaxial(0.0);
    target[2] = Control::Stress(-2.0 * constants().1);
    let refused = point.advance(target, 20);
    assert!(
        matches!(refused, Err(MaterialError::Unreachable { .. })),
        "{refused:?}"
    );
    assert!(point.state().stress.0[2].abs() <= constants().1 * (1.0 + 1e-9));
    assert!(PointDriver::new(rock(0.0, None)).with_size(0.0).is_err());
}
