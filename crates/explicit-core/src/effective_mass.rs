//! Inverse of the effective mass of a node with dashpots and springs, which may exceed the mass by many orders.

use powerhouse_model::{Mat3, Vec3};

/// Inverse of the effective mass `m I + D` (1/kg), for a mass (kg) and a symmetric positive semi-definite matrix (kg).
///
/// It is computed from the eigenvectors of `D` alone: in the sum the mass is lost to rounding where `D` is much
/// larger, and an inversion by cofactors loses twice as many digits, all of them from `D/m` of about 1e8
/// on. Eigenvalues below the rounding of the greatest belong to directions without a dashpot and count as zero.
pub(crate) fn inverse(mass: f64, added: &Mat3) -> Mat3 {
    if *added == Mat3::from_diagonal(&added.diagonal()) {
        return Mat3::from_diagonal(&added.diagonal().map(|d| 1.0 / (mass + d)));
    }
    let (values, vectors) = eigen(added);
    let rounding = 1e-15 * values.amax();
    let mut inverse = Mat3::zeros();
    for (value, vector) in values.iter().zip(vectors.column_iter()) {
        let value = if *value > rounding { *value } else { 0.0 };
        inverse += vector * vector.transpose() / (mass + value);
    }
    (inverse + inverse.transpose()) * 0.5
}

/// Eigenvalues and eigenvectors of a symmetric matrix by cyclic rotations (Jacobi 1846; Golub & Van
/// Loan, Matrix Computations, 4th ed., section 8.5).
///
/// Errors are some units in the last place of the largest entry.
fn eigen(matrix: &Mat3) -> (Vec3, Mat3) {
    let (mut rest, mut vectors) = (*matrix, Mat3::identity());
    // Convergence is quadratic: four or five passes suffice for any matrix.
    for _ in 0..8 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            let across = rest[(p, q)];
            if across == 0.0 {
                continue;
            }
            // The smaller root of t^2 + 2 t cot(2 angle) - 1 = 0.
            let cotangent = (rest[(q, q)] - rest[(p, p)]) / (2.0 * across);
            let tangent = cotangent.signum() / (cotangent.abs() + cotangent.hypot(1.0));
            let cosine = 1.0 / tangent.hypot(1.0);
            let sine = tangent * cosine;
            let mut turn = Mat3::identity();
            (turn[(p, p)], turn[(q, q)]) = (cosine, cosine);
            (turn[(p, q)], turn[(q, p)]) = (sine, -sine);
            rest = turn.transpose() * rest * turn;
            (rest[(p, q)], rest[(q, p)]) = (0.0, 0.0);
            vectors *= turn;
        }
    }
    (rest.diagonal(), vectors)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Inverses are exact to rounding, for dashpots at any angle that outweigh the mass by up to 1e12
    /// and for normals that are off an axis by any small angle.
    #[test]
    fn inverses_keep_their_digits() {
        let mass = 3.0;
        for ratio in [1e-3, 1.0, 1e4, 1e8, 1e12] {
            for tilt in [1.0, 1e-2, 1e-5, 1e-8, 1e-9, 1e-11, 1e-15, 0.0] {
                let normal = Vec3::new(tilt, 1.0, -0.4 * tilt).normalize();
                let along = normal * normal.transpose();
                let across = Mat3::identity() - along;
                // Three times as much along the normal as across it, and nothing across it.
                for side in [0.0, 1.0 / 3.0] {
                    let added = (along + across * side) * (ratio * mass);
                    let exact = along / (1.0 + ratio) + across / (1.0 + side * ratio);
                    let found = inverse(mass, &added);
                    let error = (found * mass - exact).amax() / exact.amax();
                    // The mass counts for nothing in the rounding of a small dashpot across.
                    assert!(error < 2e-14, "{ratio:e} {tilt:e} {side}: {error:e}");
                    assert_eq!(found, found.transpose());
                }
            }
        }
    }
}
