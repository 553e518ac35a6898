//! Preconditioned conjugate gradients.

use powerhouse_model::{StaticError, Vec3};
use rayon::prelude::*;

use super::system::System;

/// Largest number of products over the cube root of the number of unknowns.
const MOST_PRODUCTS: f64 = 60.0;

/// Solves `K x = b` to a residual of `left` times the norm of `b`; returns the solution and the number of operator
/// products.
///
/// Hestenes & Stiefel (1952), preconditioned with the inverses of the nodal 3 x 3 diagonals.
pub(super) fn solve(
    system: &mut System,
    b: &[Vec3],
    left: f64,
) -> Result<(Vec<Vec3>, u64), StaticError> {
    let goal = left * system.norm(b);
    let mut x = vec![Vec3::zeros(); b.len()];
    let mut residual = b.to_vec();
    let mut preconditioned = system.precondition(&residual);
    let mut direction = preconditioned.clone();
    let mut weight = system.dot(&residual, &preconditioned);
    let unknowns = 3.0 * system.node_count_of_all() as f64;
    let most = (MOST_PRODUCTS * unknowns.cbrt()).max(200.0) as u64;
    let mut size = system.norm(&residual);
    for products in 0..most {
        if size <= goal {
            return Ok((x, products));
        }
        system.check_stop()?;
        let image = system.product(&direction);
        let curvature = system.dot(&direction, &image);
        if !(curvature > 0.0 && curvature.is_finite()) {
            let residual = size / system.norm(b);
            return Err(StaticError::LinearSolver { residual, products });
        }
        let length = weight / curvature;
        (x.par_iter_mut().zip(&direction)).for_each(|(x, d)| *x += d * length);
        (residual.par_iter_mut().zip(&image)).for_each(|(r, w)| *r -= w * length);
        preconditioned = system.precondition(&residual);
        let next = system.dot(&residual, &preconditioned);
        let turn = next / weight;
        weight = next;
        (direction.par_iter_mut().zip(&preconditioned)).for_each(|(d, z)| *d = z + *d * turn);
        size = system.norm(&residual);
    }
    let residual = size / system.norm(b);
    Err(StaticError::LinearSolver {
        residual,
        products: most,
    })
}
