//! Anderson acceleration of fixed-point iterations.

use nalgebra::{DMatrix, DVector};
use powerhouse_model::Vec3;

use crate::node_ranges::NodeSums;

/// Anderson mixing (acceleration) of displacement corrections.
///
/// For an iteration `u <- u + g(u)` it finds the linear combination of the last iterates with the smallest
/// correction, `min |g - sum c_j dg_j|`, and continues from it:
///
/// `u <- u + g - sum c_j (du_j + dg_j)`
///
/// Source: Anderson (1965), *J. ACM* 12(4), 547-560; as least squares of differences: Walker & Ni
/// (2011), *SIAM J. Numer. Anal.* 49(4).
pub(super) struct Mixing {
    most: usize,
    last: Option<(Vec<Vec3>, Vec<Vec3>)>,
    /// Differences of iterates and of corrections, the oldest first.
    differences: Vec<(Vec<Vec3>, Vec<Vec3>)>,
    /// Norm of the last correction.
    size: f64,
}

/// Ratio of a correction to the last one above which the stored differences are discarded.
const WORSE: f64 = 4.0;
/// Eigenvalue of the normal equations, relative to the largest, below which a direction counts as dependent.
const DEPENDENT: f64 = 1.0e-12;

impl Mixing {
    /// Mixing with at most `most` stored differences.
    pub(super) fn new(most: usize) -> Self {
        Self {
            most,
            last: None,
            differences: Vec::new(),
            size: f64::INFINITY,
        }
    }

    /// Advances an iterate by its accelerated correction.
    pub(super) fn advance(&mut self, sums: NodeSums, u: &mut [Vec3], correction: Vec<Vec3>) {
        let size = sums.norm(&correction);
        if size > WORSE * self.size {
            self.differences.clear();
            self.last = None;
        }
        self.size = size;
        if let Some((point, before)) = self.last.take() {
            if self.differences.len() == self.most {
                self.differences.remove(0);
            }
            self.differences
                .push((minus(u, &point), minus(&correction, &before)));
        }
        let point = u.to_vec();
        let shares = self.shares(sums, &correction);
        for (u, g) in u.iter_mut().zip(&correction) {
            *u += g;
        }
        for (share, (moved, changed)) in shares.iter().zip(&self.differences) {
            for ((u, du), dg) in u.iter_mut().zip(moved).zip(changed) {
                *u -= (du + dg) * *share;
            }
        }
        self.last = Some((point, correction));
    }

    /// Coefficients `c_j` by least squares, from the eigenvalues of the normal equations without dependent directions.
    fn shares(&self, sums: NodeSums, correction: &[Vec3]) -> Vec<f64> {
        let count = self.differences.len();
        if count == 0 {
            return Vec::new();
        }
        let column = |i: usize| &self.differences[i].1;
        let scales: Vec<f64> = (0..count)
            .map(|i| sums.norm(column(i)))
            .map(|size| if size > 0.0 { 1.0 / size } else { 0.0 })
            .collect();
        let normal = DMatrix::from_fn(count, count, |i, j| {
            scales[i] * scales[j] * sums.dot(column(i), column(j))
        });
        let right = DVector::from_fn(count, |i, _| scales[i] * sums.dot(column(i), correction));
        let eigen = normal.symmetric_eigen();
        let largest = eigen.eigenvalues.max();
        let mut shares = vec![0.0; count];
        for (value, vector) in eigen
            .eigenvalues
            .iter()
            .zip(eigen.eigenvectors.column_iter())
        {
            if *value > DEPENDENT * largest {
                let along = vector.dot(&right) / value;
                for i in 0..count {
                    shares[i] += scales[i] * vector[i] * along;
                }
            }
        }
        shares
    }
}

fn minus(a: &[Vec3], b: &[Vec3]) -> Vec<Vec3> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}
