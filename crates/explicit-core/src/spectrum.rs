//! Highest natural frequency of the assembled model, by the Lanczos method.

use powerhouse_model::{ElementBlock, Operator, Quad, Vec3};
use rayon::prelude::*;

use crate::Model;
use crate::applied::split;
use crate::inverse_root::InverseRoots;
use crate::nodes::{NodalArrays, Storage, with_nodes};
use crate::ranks::Ranked;
use crate::subdomain::Subdomain;

/// Relative error bound of the highest eigenvalue at which the Lanczos method stops.
pub(crate) const TOLERANCE: f64 = 5e-3;
/// Largest number of operator products.
pub(crate) const MOST_PRODUCTS: usize = 300;
/// Number of products between two computations of the eigenvalue.
pub(crate) const CHECK_INTERVAL: usize = 5;

/// Result of the Lanczos method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct HighestEigenvalue {
    /// The Ritz value (rad2/s2), from below.
    pub(crate) value: f64,
    /// Bound on the distance of the Ritz value from an eigenvalue (rad2/s2).
    pub(crate) residual: f64,
    /// Number of operator products.
    pub(crate) products: usize,
    /// Whether the residual is below the tolerance.
    pub(crate) converged: bool,
}

/// Tridiagonal matrix of the Lanczos method, row by row, and its largest eigenvalue so far.
pub(crate) struct Tridiagonal {
    diagonal: Vec<f64>,
    off: Vec<f64>,
    /// The eigenvalue of the last computation; zero, converged, before any.
    pub(crate) found: HighestEigenvalue,
}

impl Default for Tridiagonal {
    fn default() -> Self {
        Self {
            diagonal: Vec::new(),
            off: Vec::new(),
            found: HighestEigenvalue {
                value: 0.0,
                residual: 0.0,
                products: 0,
                converged: true,
            },
        }
    }
}

impl Tridiagonal {
    /// The last number off the diagonal.
    pub(crate) fn last(&self) -> Option<f64> {
        self.off.last().copied()
    }
    /// Adds the numbers of a product, on and off the diagonal; returns whether the eigenvalue is found, or no further product
    /// is permitted.
    pub(crate) fn extend(&mut self, alpha: f64, beta: f64) -> bool {
        self.diagonal.push(alpha);
        self.off.push(beta);
        let found = &mut self.found;
        found.products += 1;
        let exhausted = beta <= 1e-12 * alpha.abs().max(found.value);
        if !(exhausted || found.products.is_multiple_of(CHECK_INTERVAL)) {
            return false;
        }
        let (value, last) = largest_ritz(&self.diagonal, &self.off);
        found.value = value;
        found.residual = beta * last;
        found.converged = exhausted || found.residual <= TOLERANCE * value;
        found.converged || found.products >= MOST_PRODUCTS
    }
}

impl Model {
    /// Highest eigenvalue of `M^-1/2 K M^-1/2` (rad2/s2) with supports and ties, where `K` is the sum of the elastic
    /// operators of all blocks times `weight(block)`. Impedances are left out because they are
    /// implicit.
    ///
    /// Lanczos method without reorthogonalisation (Paige 1972: the extreme Ritz values converge
    /// nevertheless). The error bound is `beta |s_k|`, `s_k` the last component of the Ritz vector.
    pub(crate) fn highest_eigenvalue(
        &mut self,
        weight: impl Fn(&dyn ElementBlock) -> f64 + Sync,
    ) -> HighestEigenvalue {
        self.complete_kick();
        let count = self.mass.len();
        let roots = InverseRoots::new(self);
        let mut present = self.start_vector();
        let mut previous = vec![Vec3::zeros(); count];
        let mut tridiagonal = Tridiagonal::default();
        let size = self.node_sums().norm(&present);
        if size == 0.0 {
            return tridiagonal.found;
        }
        present.par_iter_mut().for_each(|x| *x /= size);
        loop {
            let mut next = self.scaled_product(&roots, &present, &weight);
            let alpha = self.node_sums().dot(&next, &present);
            let beta_before = tridiagonal.last().unwrap_or(0.0);
            next.par_iter_mut()
                .zip(&present)
                .zip(&previous)
                .for_each(|((w, x), y)| *w -= x * alpha + y * beta_before);
            let beta = self.node_sums().norm(&next);
            if tridiagonal.extend(alpha, beta) {
                return tridiagonal.found;
            }
            previous = present;
            present = next;
            present.par_iter_mut().for_each(|x| *x /= beta);
        }
    }

    /// A reproducible pseudo-random start vector with a share of every mode.
    fn start_vector(&self) -> Vec<Vec3> {
        let engine = |node: usize| self.ranks.engine(node) as u64;
        let mut vector: Vec<Vec3> = (0..self.mass.len())
            .map(|node| Vec3::from_fn(|c, _| noise(3 * engine(node) + c as u64)))
            .collect();
        self.reduce(&mut vector);
        vector
    }

    /// Restricts a vector to the lead nodes and the free directions of the groups.
    pub(crate) fn reduce(&self, vector: &mut [Vec3]) {
        for group in &self.groups.groups {
            for &member in &group.members[1..] {
                vector[member as usize] = Vec3::zeros();
            }
            let lead = &mut vector[group.members[0] as usize];
            *lead = group.condition.free(*lead);
        }
        for &orphan in &self.subdomain.orphans {
            let group = self.group_of[orphan as usize];
            let tied = group.is_some_and(|g| self.groups.groups[g as usize].mass > 0.0);
            if !tied {
                vector[orphan as usize] = Vec3::zeros();
            }
        }
    }

    /// Product of `M^-1/2 K M^-1/2` with a reduced vector, `M` with added masses and the inertia that fibres add.
    fn scaled_product(
        &mut self,
        roots: &InverseRoots,
        vector: &[Vec3],
        weight: &(impl Fn(&dyn ElementBlock) -> f64 + Sync),
    ) -> Vec<Vec3> {
        let mut softened = Vec::new();
        if !self.groups.fibres.is_empty() {
            softened = vector.to_vec();
            (self.groups.fibres).apply_inverse_root(&self.groups.groups, roots, &mut softened);
        }
        let vector = if softened.is_empty() {
            vector
        } else {
            &softened
        };
        let (groups, group_of) = (&self.groups.groups, &self.group_of);
        let (blocks, subdomain, ranks) = (&self.blocks, &self.subdomain, &mut self.ranks);
        // Members of a group move as its lead does.
        let value = |node: usize| {
            let lead = group_of[node].map_or(node, |g| groups[g as usize].members[0] as usize);
            roots.times(lead, &vector[lead])
        };
        let mut product = with_nodes!(&mut self.nodes, arrays => {
            product(arrays, (subdomain, ranks), blocks, &value, (Operator::Elastic, weight))
        });
        for group in &self.groups.groups {
            let sum: Vec3 = group.members.iter().map(|&m| product[m as usize]).sum();
            product[group.members[0] as usize] = sum;
        }
        (product.par_iter_mut().enumerate()).for_each(|(node, x)| *x = roots.times(node, x));
        self.reduce(&mut product);
        (self.groups.fibres).apply_inverse_root(&self.groups.groups, roots, &mut product);
        product
    }

    /// Product of the weighted initial stiffness of all blocks, in steps or in static states, with a nodal vector.
    pub(crate) fn elastic_product(
        &mut self,
        operator: Operator,
        vector: &[Vec3],
        weight: &(impl Fn(&dyn ElementBlock) -> f64 + Sync),
    ) -> Vec<Vec3> {
        let (blocks, subdomain, ranks) = (&self.blocks, &self.subdomain, &mut self.ranks);
        with_nodes!(&mut self.nodes, arrays => {
            product(arrays, (subdomain, ranks), blocks, &|node| vector[node], (operator, weight))
        })
    }
}

fn product<S: Storage>(
    arrays: &mut NodalArrays<S>,
    (subdomain, ranks): (&Subdomain, &mut Ranked),
    blocks: &[Box<dyn ElementBlock>],
    value: &(impl Fn(usize) -> Vec3 + Sync),
    (operator, weight): (Operator, &(impl Fn(&dyn ElementBlock) -> f64 + Sync)),
) -> Vec<Vec3> {
    let buffers = split(&mut arrays.forces, &subdomain.lengths);
    blocks
        .par_iter()
        .zip(buffers)
        .enumerate()
        .with_max_len(1)
        .for_each(|(index, (block, buffer))| {
            let nodes = subdomain.nodes_of(index).iter();
            let own: Vec<Quad<S>> = nodes
                .map(|&node| Quad::from_vector(&value(node as usize)))
                .collect();
            block.apply(operator, S::view(&own), S::view_mut(buffer));
            let weight = S::from_f64(weight(block.as_ref()));
            for force in buffer.iter_mut().flat_map(|quad| &mut quad.values) {
                *force = *force * weight;
            }
        });
    ranks.exchange.swap(&ranks.team, &mut arrays.forces);
    (0..subdomain.node_count())
        .into_par_iter()
        .map(|node| arrays.internal(&subdomain.slots, node))
        .collect()
}

/// A pseudo-random number in [-1, 1) from an integer (the mixer of Steele, Lea & Flood 2014).
pub(crate) fn noise(index: u64) -> f64 {
    let mut z = index.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

/// Largest eigenvalue of a symmetric tridiagonal matrix, and magnitude of the last component of
/// its unit eigenvector. `off`, the off-diagonal, has one entry more than the matrix needs.
pub(crate) fn largest_ritz(diagonal: &[f64], off: &[f64]) -> (f64, f64) {
    let size = diagonal.len();
    let matrix = nalgebra::DMatrix::from_fn(size, size, |i, j| match i.abs_diff(j) {
        0 => diagonal[i],
        1 => off[i.min(j)],
        _ => 0.0,
    });
    let eigen = matrix.symmetric_eigen();
    let index = eigen.eigenvalues.imax();
    (
        eigen.eigenvalues[index],
        eigen.eigenvectors[(size - 1, index)].abs(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The largest eigenvalue of the second-difference matrix is `4 cos^2(pi / (2 (n + 1)))`.
    #[test]
    fn ritz_value_of_a_known_matrix() {
        let n = 12;
        let (value, last) = largest_ritz(&vec![2.0; n], &vec![-1.0; n]);
        let angle = core::f64::consts::PI / (n + 1) as f64;
        assert!((value - 4.0 * (0.5 * angle).cos().powi(2)).abs() < 1e-14);
        let component = (2.0 / (n + 1) as f64).sqrt() * angle.sin();
        assert!((last - component).abs() < 1e-13);
    }
}
