//! The skew matrix of a bay between its groups, and the velocities that follow from it.
//!
//! A step has `A (v+ - v-) = ... - dt D (v- + v+) / 2`, with the effective mass `A` of each group and the skew matrix `D` between groups. With
//! the velocities `v` that the step would have without `D`, and `P` the inverse of `A` in the free directions, the sum
//! `x = v- + v+` obeys `x + dt/2 P D x = v- + v`: identity and a matrix that is skew in the product `x.A y`. The method of conjugate
//! gradients for such systems (Concus & Golub 1976; Widlund 1978) needs one product in an iteration and converges for any step.

use core::cmp::Ordering;

use powerhouse_model::{Mat3, Vec3};
use rayon::prelude::*;

use crate::gather::CHUNK;

/// Most iterations of a step.
const MOST_ITERATIONS: usize = 200;
/// Difference from the solution, over it, at which iterations end.
const EXACT: f64 = 1e-10;

/// A sparse matrix of groups by groups.
#[derive(Clone, Debug, Default)]
pub(super) struct Skew {
    offsets: Vec<u32>,
    others: Vec<u32>,
    /// In single precision, which leaves the matrix skew: half of the time of a product is the memory that it reads.
    entries: Vec<[f32; 9]>,
}

impl Skew {
    /// From the entries of groups between which elements couple, each a pair of groups and a matrix that counts with others of the same pair.
    pub(super) fn new(
        groups: usize,
        elements: &[Vec<u32>],
        fill: impl FnOnce(&mut dyn FnMut([u32; 2], &Mat3)),
    ) -> Self {
        let mut rows: Vec<Vec<u32>> = vec![Vec::new(); groups];
        for element in elements {
            for &group in element {
                rows[group as usize].extend_from_slice(element);
            }
        }
        let mut offsets = vec![0];
        for (group, row) in (0..).zip(&mut rows) {
            row.push(group);
            row.sort_unstable();
            row.dedup();
            offsets.push(offsets[offsets.len() - 1] + row.len() as u32);
        }
        let mut skew = Self {
            offsets,
            others: rows.concat(),
            entries: Vec::new(),
        };
        let mut sums = vec![Mat3::zeros(); skew.others.len()];
        fill(&mut |[row, column], matrix| {
            let own = skew.entries_of(row as usize);
            if let Ok(place) = skew.others[own.clone()].binary_search(&column) {
                sums[own.start + place] += matrix;
            }
        });
        skew.entries.reserve(sums.len());
        for row in 0..groups {
            for place in skew.entries_of(row) {
                // The entries below the diagonal are those above it, so that rounding keeps the matrix skew.
                let column = skew.others[place] as usize;
                let own = skew.entries_of(column);
                let of_row = skew.others[own.clone()].binary_search(&(row as u32));
                let other = of_row.map_or(sums[place], |index| sums[own.start + index]);
                let (matrix, sign) = match row.cmp(&column) {
                    Ordering::Less => (sums[place], 1.0),
                    Ordering::Equal => ((sums[place] - sums[place].transpose()) * 0.5, 1.0),
                    Ordering::Greater => (other.transpose(), -1.0),
                };
                let entry = |i: usize| sign * matrix[(i / 3, i % 3)] as f32;
                skew.entries.push(core::array::from_fn(entry));
            }
        }
        skew
    }

    fn entries_of(&self, group: usize) -> core::ops::Range<usize> {
        self.offsets[group] as usize..self.offsets[group + 1] as usize
    }

    /// Product with a vector of all groups.
    pub(super) fn times(&self, x: &[Vec3], out: &mut Vec<Vec3>) {
        out.resize(x.len(), Vec3::zeros());
        out.par_chunks_mut(CHUNK)
            .enumerate()
            .for_each(|(chunk, out)| {
                for (group, out) in (chunk * CHUNK..).zip(out) {
                    let own = self.entries_of(group);
                    let mut sum = Vec3::zeros();
                    for (entry, &other) in self.entries[own.clone()].iter().zip(&self.others[own]) {
                        let x = &x[other as usize];
                        for (row, sum) in entry.chunks_exact(3).zip(sum.iter_mut()) {
                            *sum += f64::from(row[0]) * x.x
                                + f64::from(row[1]) * x.y
                                + f64::from(row[2]) * x.z;
                        }
                    }
                    *out = sum;
                }
            });
    }

    /// Solves `x + dt/2 P D x = b` from a first guess, and returns the number of iterations and `D x`; none if they do not converge. `response` is `P x`
    /// of a group, `weight` its `x.A x`.
    pub(super) fn solve(
        &self,
        (b, x): (&[Vec3], &mut Vec<Vec3>),
        step: f64,
        response: impl Fn(usize, &Vec3) -> Vec3 + Sync,
        weight: impl Fn(usize, &Vec3) -> f64 + Sync,
    ) -> Option<(usize, Vec<Vec3>)> {
        let norm = |x: &[Vec3]| -> f64 {
            let chunks = x.par_chunks(CHUNK).enumerate();
            let sums = chunks.map(|(chunk, x)| -> f64 {
                (chunk * CHUNK..).zip(x).map(|(g, x)| weight(g, x)).sum()
            });
            sums.collect::<Vec<f64>>().iter().sum()
        };
        let least = EXACT * EXACT * norm(b);
        let mut before: Vec<Vec3> = Vec::new();
        let mut product = Vec::new();
        let (mut size_before, mut omega) = (0.0, 1.0);
        for iteration in 0..MOST_ITERATIONS {
            self.times(x, &mut product);
            let change: Vec<Vec3> = (0..x.len())
                .into_par_iter()
                .map(|g| b[g] - x[g] - response(g, &product[g]) * (0.5 * step))
                .collect();
            let size = norm(&change);
            if !size.is_finite() {
                return None;
            }
            if size <= least {
                return Some((iteration, product));
            }
            omega = if iteration == 0 {
                1.0
            } else {
                1.0 / (1.0 + size / (size_before * omega))
            };
            size_before = size;
            if before.is_empty() {
                before.clone_from(x);
            }
            let next = (0..x.len())
                .into_par_iter()
                .map(|g| before[g] + (change[g] + x[g] - before[g]) * omega);
            let next = next.collect();
            before = core::mem::replace(x, next);
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::noise;

    /// A skew matrix of 60 groups with random masses, for steps at which `dt/2 P D` has norms below one and above.
    #[test]
    fn the_sum_of_velocities_obeys_its_equation() {
        let groups = 60;
        let elements: Vec<Vec<u32>> = (0..groups - 4).map(|g| vec![g, g + 1, g + 4]).collect();
        let skew = Skew::new(groups as usize, &elements, |add| {
            for (index, element) in (0..).zip(&elements) {
                for (i, &a) in element.iter().enumerate() {
                    for (j, &b) in element.iter().enumerate().take(i) {
                        let seed = 100 * index + 10 * i as u64 + j as u64;
                        let entry = |r, c| noise(9 * seed + 3 * r as u64 + c as u64);
                        let matrix = Mat3::from_fn(entry);
                        add([a, b], &matrix);
                        add([b, a], &-matrix.transpose());
                    }
                }
            }
        });
        let mass = |g: usize| 2.0 + noise(7 * g as u64);
        let b: Vec<Vec3> = (0..groups as u64)
            .map(|g| Vec3::from_fn(|c, _| noise(5 * g + c as u64)))
            .collect();
        for step in [0.05, 0.3, 1.0] {
            let mut x = b.clone();
            let (response, weight) = (
                |g: usize, x: &Vec3| x / mass(g),
                |g: usize, x: &Vec3| mass(g) * x.norm_squared(),
            );
            let (iterations, product) = skew.solve((&b, &mut x), step, response, weight).unwrap();
            assert!(iterations > 2, "{step}: {iterations}");
            for g in 0..groups as usize {
                let residual = x[g] + product[g] * (0.5 * step / mass(g)) - b[g];
                assert!(residual.norm() < 1e-8, "{step}, {g}: {residual}");
            }
            // The matrix takes no energy.
            let power: f64 = x.iter().zip(&product).map(|(x, y)| x.dot(y)).sum();
            assert!(power.abs() < 1e-8, "{step}: {power:e}");
        }
    }
}
