//! What damage leaves of stiffness damping and of hourglass resistance.

use super::*;

/// In elements that are damaged alike, stiffness damping and hourglass resistance act with the share of the
/// stiffness that is left, in every kernel and precision.
#[test]
fn damping_and_hourglass_resistance_keep_what_is_left() {
    for kernel in SolidKernel::ALL {
        for (precision, tolerance) in [(Precision::F64, 1e-10), (Precision::Mixed, 1e-3)] {
            let options = options(precision, LaneWidth::Native, 1e-3);
            let mesh = distorted(kernel.kind(), [2, 2, 2]);
            let mut fixture = Fixture::of(mesh.clone(), kernel, Softening(rock()), options);
            let mut elastic = Fixture::of(mesh, kernel, Linear(rock()), options);
            let gradient = GRADIENT * 1e-2;
            let u = fixture.field(|x| gradient * x);
            let (noise, rest) = (fixture.noise(4, 1e-1), zeros(u.len()));
            // Every element has the same strain, and the same share is left.
            let still = fixture.forces(&u, &rest);
            let whole = elastic.forces(&u, &rest);
            let left = largest(&still) / largest(&whole);
            assert!(left < 0.2);
            let moving = fixture.forces(&u, &noise);
            let damped = elastic.forces(&rest, &noise);
            for ((moving, still), damped_force) in moving.iter().zip(&still).zip(&damped) {
                let error = (moving - still - damped_force * left).norm();
                assert!(
                    error < tolerance * largest(&damped),
                    "{} {precision:?}: {error}",
                    kernel.name()
                );
            }
        }
    }
}

/// A bending mode of a damaged one-point brick is resisted by the share of its stiffness that is left, and
/// by a hundredth at least.
#[test]
fn a_cracked_brick_does_not_bend_by_its_hourglass_stiffness() {
    let kernel = SolidKernel::Hex8OnePoint(Hex8OnePoint::DEFAULT);
    let options = options(Precision::F64, LaneWidth::Native, 0.0);
    for (size, least) in [(0.0, 0.99), (1e-3, 0.3), (1e-1, 0.0), (10.0, 0.0)] {
        let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::new(2.0, 1.0, 1.0), [1, 1, 1], "rock");
        let mut fixture = Fixture::of(mesh.unwrap(), kernel, Softening(rock()), options);
        let bent = |x: &Vec3| Vec3::new(1e-7 * (x.x - 1.0) * (x.z - 0.5), 0.0, 0.0);
        let stretched = |x: &Vec3| Vec3::new(size * x.x, 0.0, 0.0);
        let (bending, stretch) = (fixture.field(bent), fixture.field(stretched));
        let both = fixture.field(|x| bent(x) + stretched(x));
        let rest = zeros(both.len());
        let whole = largest(&fixture.forces(&bending, &rest));
        let alone = fixture.forces(&stretch, &rest);
        let together = fixture.forces(&both, &rest);
        let difference: Vec<Vec3> = together.iter().zip(&alone).map(|(a, b)| a - b).collect();
        let left = largest(&difference) / whole;
        let kept = 1e-3 / (1e-3 + size);
        let expected = kept.max(0.01);
        assert!(
            (left / expected - 1.0).abs() < 1e-3,
            "{size}: {left} {expected}"
        );
        assert!(left > least);
    }
}
