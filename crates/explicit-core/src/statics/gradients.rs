//! Preconditioned conjugate gradients.

use powerhouse_model::{StaticError, Vec3};
use rayon::prelude::*;

use super::system::System;

/// Number of products, over the cube root of the number of unknowns, that a mesh of one compressible material takes: a solution
/// that made no progress in so many does not converge.
const PROGRESS_PRODUCTS: f64 = 60.0;
/// The least number of such products.
const LEAST_PRODUCTS: f64 = 200.0;
/// Share of the least residual so far below which a residual is progress.
const PROGRESS: f64 = 0.9;
/// Share of the energy gained so far below which the energy of so many products is no progress.
const LEAST_GAIN: f64 = 1.0e-9;
/// Largest number of products over the number of unknowns; in exact arithmetic one suffices.
const MOST_PRODUCTS: u64 = 20;

/// Solves `K x = b` to a residual of `left` times the norm of `b`; returns the solution and the number of operator
/// products.
///
/// Hestenes & Stiefel (1952), preconditioned with the inverses of the nodal 3 x 3 diagonals. The number of products grows
/// with the root of the condition, which is not known: of the bulk modulus over the shear modulus where the body is nearly
/// incompressible. The residual may grow for long before it falls, but the energy `1/2 x K x - b x` falls with every product.
/// The solution therefore goes on as long as one of them still falls.
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
    let unknowns = 3 * system.node_count_of_all() as u64;
    let mut products = 0;
    let mut size = system.norm(&residual);
    let mut progress = Progress {
        window: (PROGRESS_PRODUCTS * (unknowns as f64).cbrt()).max(LEAST_PRODUCTS) as u64,
        since: 0,
        least: size,
        gained: 0.0,
        gained_then: 0.0,
    };
    loop {
        if size <= goal {
            return Ok((x, products));
        }
        system.check_stop()?;
        let image = system.product(&direction);
        let curvature = system.dot(&direction, &image);
        let is_sound = curvature > 0.0 && curvature.is_finite();
        let length = weight / curvature;
        let goes_on = products < MOST_PRODUCTS * unknowns + LEAST_PRODUCTS as u64;
        if !(is_sound && goes_on && progress.goes_on(products, size, 0.5 * length * weight)) {
            let residual = size / system.norm(b);
            return Err(StaticError::LinearSolver { residual, products });
        }
        (x.par_iter_mut().zip(&direction)).for_each(|(x, d)| *x += d * length);
        (residual.par_iter_mut().zip(&image)).for_each(|(r, w)| *r -= w * length);
        preconditioned = system.precondition(&residual);
        let next = system.dot(&residual, &preconditioned);
        let turn = next / weight;
        weight = next;
        (direction.par_iter_mut().zip(&preconditioned)).for_each(|(d, z)| *d = z + *d * turn);
        size = system.norm(&residual);
        products += 1;
    }
}

/// Whether a solution still approaches its goal.
struct Progress {
    /// Number of products without progress after which it ends.
    window: u64,
    /// Number of products when progress was last found.
    since: u64,
    /// Least residual (N) so far, but for the last window.
    least: f64,
    /// Energy (J) gained so far, and until progress was last found.
    gained: f64,
    gained_then: f64,
}

impl Progress {
    /// Whether the solution goes on after some products, with its residual (N) and the energy (J) that the next one gains.
    fn goes_on(&mut self, products: u64, size: f64, gain: f64) -> bool {
        self.gained += gain;
        if size < PROGRESS * self.least {
            (self.since, self.least, self.gained_then) = (products, size, self.gained);
        }
        if products - self.since < self.window {
            return true;
        }
        let gained = self.gained - self.gained_then;
        (self.since, self.gained_then) = (products, self.gained);
        gained > LEAST_GAIN * self.gained
    }
}
