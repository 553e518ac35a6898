//! Drucker-Prager surface and its fits.

use nalgebra::{Matrix3, Vector3};
use powerhouse_material_damage::{
    ConeFit, DruckerPrager, DruckerPragerParameters, ElastoPlastic, MohrCoulomb,
    MohrCoulombParameters, YieldSurface, presets,
};
use powerhouse_model::{ConstitutiveLaw, LawInput, Strain};

use super::random::Random;

fn rock(dilation: f64, fit: ConeFit) -> DruckerPrager {
    DruckerPrager::new(DruckerPragerParameters {
        medium: presets::PAPER_ROCK.medium,
        friction: 42.0,
        dilation,
        cohesion: 1.05e6,
        fit,
    })
    .unwrap()
}

fn mohr_coulomb() -> MohrCoulomb {
    MohrCoulomb::new(MohrCoulombParameters {
        tension_strength: None,
        ..presets::PAPER_ROCK
    })
    .unwrap()
}

/// The circumscribed cone passes through the edges of compression of Mohr-Coulomb, and holds all
/// of its surface; the inscribed one touches its faces and lies within.
#[test]
fn cones_touch_mohr_coulomb_where_they_should() {
    let inner = rock(0.0, ConeFit::Inscribed);
    let outer = rock(0.0, ConeFit::Circumscribed);
    let exact = mohr_coulomb();
    let ucs = exact.uniaxial_compression();
    assert!((outer.uniaxial_compression() - ucs).abs() < 1e-10 * ucs);
    for cone in [&inner, &outer] {
        assert!((cone.apex() - exact.apex()).abs() < 1e-10 * exact.apex());
    }
    // All directions of one deviatoric plane: the least distance of cone and faces.
    let mut nearest = f64::INFINITY;
    for step in 0..=6000 {
        let angle = std::f64::consts::FRAC_PI_3 * f64::from(step) / 6000.0;
        let third = 2.0 * std::f64::consts::FRAC_PI_3;
        let axis = [angle, angle - third, angle + third].map(f64::cos);
        // Scale the deviator to the surface of Mohr-Coulomb at a mean stress of -2 MPa.
        let at = |size: f64| axis.map(|x| -2.0e6 + size * x);
        let sorted = |mut s: [f64; 3]| {
            s.sort_by(|a, b| b.total_cmp(a));
            s
        };
        let ratio = (66.0_f64).to_radians().tan().powi(2);
        let faces = |[s1, _, s3]: [f64; 3]| ratio * s1 - s3 - ucs;
        let [low, high] = [0.0, 1.0e6].map(|size| faces(sorted(at(size))));
        let size = 1.0e6 * -low / (high - low);
        let on_surface = sorted(at(size));
        assert!(outer.excess(&on_surface) < 1e-9 * size);
        assert!(inner.excess(&on_surface) > -1e-9 * size);
        nearest = nearest.min(inner.excess(&on_surface) / size);
    }
    // The square of the angular step.
    assert!(nearest < 1e-7, "{nearest:e}");
}

/// In plane strain the fitted cone collapses under the stresses at which Mohr-Coulomb does, with
/// and without dilation.
#[test]
fn plane_strain_fit_fails_with_mohr_coulomb() {
    for dilation in [0.0, 10.0, 42.0] {
        let cone = rock(dilation, ConeFit::PlaneStrain);
        let law = ElastoPlastic::new(cone);
        let (mut old, mut new) = ([0.0; 8], [0.0; 8]);
        let mut stress = [0.0; 3];
        // The lateral pressure is held by bisection in the lateral strain.
        let mut lateral = 0.0;
        let pressure = -2.0e6;
        for step in 1..=400 {
            let axial = -2.0e-2 * f64::from(step) / 400.0;
            let mut at = |lateral: f64, old: &[f64; 8]| {
                let strain = Strain([lateral, 0.0, axial, 0.0, 0.0, 0.0]);
                let s = law.stress_change(&LawInput::new(strain, old), &mut new);
                ([s.0[0], s.0[1], s.0[2]], new)
            };
            let (mut a, mut b) = (lateral - 1.0e-3, lateral + 1.0e-3);
            for _ in 0..200 {
                let middle = 0.5 * (a + b);
                if at(middle, &old).0[0] < pressure {
                    a = middle;
                } else {
                    b = middle;
                }
            }
            lateral = 0.5 * (a + b);
            (stress, old) = at(lateral, &old);
        }
        let expected = mohr_coulomb();
        let [friction, strength] = [42.0_f64, expected.uniaxial_compression()];
        let n = ((45.0 + 0.5 * friction).to_radians()).tan().powi(2);
        let collapse = n * stress[0] - strength;
        assert!(
            (stress[2] - collapse).abs() < 1e-6 * collapse.abs(),
            "{stress:?} {collapse}"
        );
    }
}

/// Associated returns are the closest points in energy, found by a search along the cone; all
/// returns lie on the surface, and their plastic strain follows the flow rule.
#[test]
fn returns_lie_on_the_cone_and_follow_the_flow() {
    let mut random = Random(21);
    for case in 0..10_000 {
        let fit = [
            ConeFit::Inscribed,
            ConeFit::Circumscribed,
            ConeFit::PlaneStrain,
        ][case % 3];
        let dilation = [0.0, 10.0, 42.0][case / 3 % 3];
        let cone = rock(dilation, fit);
        let mut s: [f64; 3] = core::array::from_fn(|_| 2.0e7 * random.signed());
        s.sort_by(|a, b| b.total_cmp(a));
        if cone.excess(&s) <= 0.0 {
            continue;
        }
        let returned = Vector3::from(cone.return_principal(&s).stress);
        let outside = cone.excess(&returned.into()).abs() / returned.norm().max(1.05e6);
        assert!(outside < 1e-12, "{outside:e}");
        let medium = cone.medium();
        let stiffness =
            Matrix3::from_element(medium.lambda()) + 2.0 * medium.shear() * Matrix3::identity();
        let loss = Vector3::from(s) - returned;
        let plastic = stiffness.try_inverse().unwrap() * loss;
        let mean = returned.mean();
        let deviator = returned.add_scalar(-mean);
        let shear = deviator.norm() / 2.0_f64.sqrt();
        let [a, b, _] = cone.coefficients();
        if shear > 1e-6 * returned.norm() {
            let direction = (deviator / (2.0 * shear)).add_scalar(b);
            let along = plastic.dot(&direction) / direction.norm_squared();
            let error = (plastic - along * direction).norm() / plastic.norm();
            assert!(along > 0.0 && error < 1e-8, "{error:e}");
        } else {
            // Apex: the plastic strain lies within the cone of the normals, at most as deviatoric
            // as the flow on the cone.
            let deviatoric = plastic.add_scalar(-plastic.mean()).norm() / 2.0_f64.sqrt();
            if b > 0.0 {
                assert!(b * deviatoric < 0.5 * (1.0 + 1e-9) * plastic.mean());
            }
        }
        if (a - b).abs() < 1e-12 {
            let energy = |x: Vector3<f64>| {
                let loss = Vector3::from(s) - x;
                loss.dot(&(stiffness.try_inverse().unwrap() * loss))
            };
            let here = energy(returned);
            for _ in 0..4 {
                let nudge = Vector3::from_fn(|_, _| 1.0e5 * random.signed());
                let mut near: [f64; 3] = (returned + nudge).into();
                near.sort_by(|a, b| b.total_cmp(a));
                if cone.excess(&near) > 0.0 {
                    near = cone.return_principal(&near).stress;
                }
                assert!(energy(Vector3::from(near)) >= here * (1.0 - 1e-12));
            }
        }
    }
}
