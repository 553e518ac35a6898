use powerhouse_model::{Mat3, Stress, Vec3};
use powerhouse_observe::principal_stresses;

use super::noise;

/// `Q diag(values) Q^T` for a random rotation.
fn rotated(values: [f64; 3], seed: u64) -> Stress {
    let axis = Vec3::new(noise(seed), noise(seed + 1), noise(seed + 2));
    let rotation = nalgebra::Rotation3::new(3.0 * axis);
    let q = rotation.matrix();
    Stress::from_matrix(&(q * Mat3::from_diagonal(&Vec3::from(values)) * q.transpose()))
}

/// Principal stresses agree with an iterative eigenvalue solver, and with the values that a
/// tensor was made of, within sixteen units in the last place of the largest, over random tensors of
/// all sizes.
#[test]
fn closed_form_agrees_with_iteration() {
    for seed in 0..20_000_u64 {
        let size = 10.0_f64.powi((seed % 41) as i32 - 20);
        let stress = Stress(core::array::from_fn(|i| size * noise(6 * seed + i as u64)));
        let found = principal_stresses(&stress);
        let iterated = stress.principal().values;
        let largest = iterated[0].abs().max(iterated[2].abs());
        for (found, iterated) in found.into_iter().zip(iterated) {
            assert!(
                (found - iterated).abs() <= 16.0 * f64::EPSILON * largest,
                "{stress:?}"
            );
        }
        assert!(found[0] >= found[1] && found[1] >= found[2]);
    }
}

/// Nearly and exactly equal principal stresses come out as accurately as others, however small
/// their difference, under a large mean stress too.
#[test]
fn coinciding_values_keep_their_digits() {
    for seed in 0..2000 {
        for gap in [0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3] {
            for values in [
                [1.0 + gap, 1.0, -2.0],
                [2.0, -1.0, -1.0 - gap],
                [1.0 + gap, 1.0, 1.0 - gap],
                [1e3 + gap, 1e3, 1e3 - 1.0],
            ] {
                let found = principal_stresses(&rotated(values, 3 * seed));
                for (found, made) in found.into_iter().zip(values) {
                    let largest = values[0].abs().max(values[2].abs());
                    assert!(
                        (found - made).abs() <= 16.0 * f64::EPSILON * largest,
                        "{values:?} {found}"
                    );
                }
            }
        }
    }
}

/// Limits: no stress, pressure, uniaxial tension and compression, pure shear, the largest and
/// smallest numbers, and numbers that are none.
#[test]
fn limits_are_exact() {
    assert_eq!(principal_stresses(&Stress([0.0; 6])), [0.0; 3]);
    assert_eq!(
        principal_stresses(&Stress([-7.0, -7.0, -7.0, 0.0, 0.0, 0.0])),
        [-7.0; 3]
    );
    let close = |stress: [f64; 6], expected: [f64; 3]| {
        let largest = expected[0].abs().max(expected[2].abs());
        for (found, expected) in principal_stresses(&Stress(stress))
            .into_iter()
            .zip(expected)
        {
            assert!((found / largest - expected / largest).abs() < 4.0 * f64::EPSILON);
        }
    };
    close([0.0, 5.0, 0.0, 0.0, 0.0, 0.0], [5.0, 0.0, 0.0]);
    close([0.0, 0.0, -5.0, 0.0, 0.0, 0.0], [0.0, 0.0, -5.0]);
    close([0.0, 0.0, 0.0, 0.0, 3.0, 0.0], [3.0, 0.0, -3.0]);
    close([0.0, 0.0, 0.0, 0.0, 0.0, 1e300], [1e300, 0.0, -1e300]);
    close([0.0, 0.0, 0.0, 1e-300, 0.0, 0.0], [1e-300, 0.0, -1e-300]);
    for broken in [f64::NAN, f64::INFINITY] {
        let found = principal_stresses(&Stress([0.0, 1.0, 0.0, broken, 0.0, 0.0]));
        assert!(found.iter().all(|value| !value.is_finite()));
    }
}
