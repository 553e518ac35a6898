//! Acceleration of the iterations `x <- x + f(x)` to `f(x) = 0`.

use std::collections::VecDeque;

use nalgebra::{DMatrix, DVector};
use powerhouse_model::Vec3;

/// Number of earlier iterates that are kept.
const KEPT: usize = 5;
/// Singular value over the largest one that counts as zero.
const DEPENDENT: f64 = 1e-9;

/// Iterates and their `f`, of which the method of Anderson (1965) makes the next iterate: that combination whose `f` is
/// smallest (Walker & Ni 2011, eq. 2.1).
#[derive(Default)]
pub(super) struct Mixing {
    /// Differences of successive iterates, and of their `f`.
    changes: VecDeque<[Vec<Vec3>; 2]>,
    last: Option<[Vec<Vec3>; 2]>,
}

impl Mixing {
    /// Forgets all iterates.
    pub(super) fn clear(&mut self) {
        self.changes.clear();
        self.last = None;
    }

    /// The next iterate after `x`, with an inner product.
    pub(super) fn next(
        &mut self,
        x: &[Vec3],
        f: Vec<Vec3>,
        product: impl Fn(&[Vec3], &[Vec3]) -> f64,
    ) -> Vec<Vec3> {
        let minus = |a: &[Vec3], b: &[Vec3]| a.iter().zip(b).map(|(a, b)| a - b).collect();
        let now = [x.to_vec(), f];
        if let Some(last) = &self.last {
            if self.changes.len() == KEPT {
                self.changes.pop_front();
            }
            let change = [0, 1].map(|k| minus(&now[k], &last[k]));
            self.changes.push_back(change);
        }
        let f = &now[1];
        let mut next: Vec<Vec3> = x.iter().zip(f).map(|(x, f)| x + f).collect();
        let count = self.changes.len();
        if count == 0 {
            self.last = Some(now);
            return next;
        }
        let of = |i: usize| &self.changes[i][1][..];
        let gram = DMatrix::from_fn(count, count, |i, j| product(of(i), of(j)));
        let right = DVector::from_fn(count, |i, _| product(of(i), f));
        let shares = gram.svd(true, true).solve(&right, DEPENDENT * DEPENDENT);
        if let Ok(shares) = shares {
            for (share, [of_x, of_f]) in shares.iter().zip(&self.changes) {
                let both = of_x.iter().zip(of_f);
                for (next, (of_x, of_f)) in next.iter_mut().zip(both) {
                    *next -= (of_x + of_f) * *share;
                }
            }
        }
        self.last = Some(now);
        next
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::noise;

    /// A linear map of five values that would diverge is solved in as many iterations as it has different values.
    #[test]
    fn a_linear_problem_is_solved_in_as_many_iterations_as_it_has_dimensions() {
        let scale = [-1.8, -0.4, 0.3, 0.9, 0.95];
        let start: Vec<Vec3> = (0..5).map(|i| Vec3::repeat(noise(i))).collect();
        let product = |a: &[Vec3], b: &[Vec3]| a.iter().zip(b).map(|(a, b)| a.dot(b)).sum();
        let (mut mixing, mut x) = (Mixing::default(), start);
        let mut sizes = Vec::new();
        for _ in 0..8 {
            // x = scale x + 1
            let f: Vec<Vec3> = (x.iter().zip(scale))
                .map(|(x, scale)| x * scale + Vec3::repeat(1.0) - x)
                .collect();
            sizes.push(f.iter().map(|f| f.norm()).fold(0.0, f64::max));
            x = mixing.next(&x, f, product);
        }
        assert!(sizes[6] < 1e-8 && sizes[3] > 1e-4, "{sizes:?}");
    }
}
