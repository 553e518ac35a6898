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
/// Difference from the solution, over it, at which iterations end: motions of bays then differ by some 1e-6 from those of 1e-10.
const EXACT: f64 = 1e-6;
/// Entry over the largest one that counts as zero.
const SMALL: f64 = 1e-12;

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
        // Nodes at the same y are not coupled but for rounding.
        let size = |matrix: &Mat3| matrix.amax();
        let least = SMALL * sums.iter().map(size).fold(0.0, f64::max);
        let (mut offsets, mut others) = (vec![0], Vec::new());
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
                if size(&matrix) <= least {
                    continue;
                }
                let entry = |i: usize| sign * matrix[(i / 3, i % 3)] as f32;
                skew.entries.push(core::array::from_fn(entry));
                others.push(skew.others[place]);
            }
            offsets.push(others.len() as u32);
        }
        (skew.offsets, skew.others) = (offsets, others);
        skew
    }

    fn entries_of(&self, group: usize) -> core::ops::Range<usize> {
        self.offsets[group] as usize..self.offsets[group + 1] as usize
    }

    /// Product of the rows of a group with a vector of all groups.
    fn row(&self, group: usize, x: &[Vec3]) -> Vec3 {
        let own = self.entries_of(group);
        let mut sum = Vec3::zeros();
        for (entry, &other) in self.entries[own.clone()].iter().zip(&self.others[own]) {
            let x = &x[other as usize];
            for (row, sum) in entry.chunks_exact(3).zip(sum.iter_mut()) {
                *sum += f64::from(row[0]) * x.x + f64::from(row[1]) * x.y + f64::from(row[2]) * x.z;
            }
        }
        sum
    }

    /// Solves `x + dt/2 P D x = b` from a first guess, and returns the number of iterations and `D x`; none if they do not converge.
    pub(super) fn solve<'s>(
        &self,
        (b, x): (&[Vec3], &mut Vec<Vec3>),
        step: f64,
        group: impl Fn(usize) -> [&'s Mat3; 2] + Sync + Copy,
    ) -> Option<(usize, Vec<Vec3>)> {
        let mut before = x.clone();
        let [mut product, mut change] = [(); 2].map(|()| vec![Vec3::zeros(); x.len()]);
        let (mut size_before, mut omega, mut least) = (0.0, 1.0, 0.0);
        for iteration in 0..MOST_ITERATIONS {
            // One pass over the matrix: the product, what x lacks, and the sizes of that and of `b`.
            let chunks = (product.par_chunks_mut(CHUNK)).zip(change.par_chunks_mut(CHUNK));
            let sizes = chunks.enumerate().map(|(chunk, (product, change))| {
                let mut sizes = [0.0; 2];
                for (g, (product, change)) in (chunk * CHUNK..).zip(product.iter_mut().zip(change))
                {
                    let [response, inertia] = group(g);
                    *product = self.row(g, x);
                    *change = b[g] - x[g] - response * *product * (0.5 * step);
                    sizes[0] += change.dot(&(inertia * *change));
                    if iteration == 0 {
                        sizes[1] += b[g].dot(&(inertia * b[g]));
                    }
                }
                sizes
            });
            let sizes: Vec<[f64; 2]> = sizes.collect();
            let [size, of_b] = [0, 1].map(|i| sizes.iter().map(|of| of[i]).sum::<f64>());
            if iteration == 0 {
                least = EXACT * EXACT * of_b;
            }
            if !size.is_finite() {
                return None;
            }
            if size <= least {
                balance((b, x), &mut product, group);
                return Some((iteration, product));
            }
            if iteration > 0 {
                omega = 1.0 / (1.0 + size / (size_before * omega));
            }
            size_before = size;
            let all = before.par_iter_mut().zip(&*x).zip(&change);
            all.with_min_len(CHUNK).for_each(|((before, x), change)| {
                *before += (change + x - *before) * omega;
            });
            core::mem::swap(&mut before, x);
        }
        None
    }
}

/// Multiplies a solution `x` and its product with the matrix by the number near one at which `x.A x = x.A b`, as of the exact solution:
/// the matrix then takes no energy, however exact the solution is.
fn balance<'s>(
    (b, x): (&[Vec3], &mut [Vec3]),
    product: &mut [Vec3],
    group: impl Fn(usize) -> [&'s Mat3; 2] + Sync,
) {
    let chunks = x.par_chunks(CHUNK).enumerate();
    let sums = chunks.map(|(chunk, x)| {
        (chunk * CHUNK..).zip(x).fold([0.0; 2], |sums, (g, x)| {
            let [_, inertia] = group(g);
            let impulse = inertia * x;
            [sums[0] + b[g].dot(&impulse), sums[1] + x.dot(&impulse)]
        })
    });
    let sums: Vec<[f64; 2]> = sums.collect();
    let [given, taken] = [0, 1].map(|i| sums.iter().map(|of| of[i]).sum::<f64>());
    if taken > 0.0 {
        let factor = given / taken;
        for value in x.iter_mut().chain(product) {
            *value *= factor;
        }
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
        let matrices: Vec<[Mat3; 2]> = (0..groups as usize)
            .map(|g| [1.0 / mass(g), mass(g)].map(|entry| Mat3::identity() * entry))
            .collect();
        let b: Vec<Vec3> = (0..groups as u64)
            .map(|g| Vec3::from_fn(|c, _| noise(5 * g + c as u64)))
            .collect();
        for step in [0.05, 0.3, 1.0] {
            let mut x = b.clone();
            let group = |g: usize| matrices[g].each_ref();
            let (iterations, product) = skew.solve((&b, &mut x), step, group).unwrap();
            assert!(iterations > 2, "{step}: {iterations}");
            for g in 0..groups as usize {
                let residual = x[g] + product[g] * (0.5 * step / mass(g)) - b[g];
                assert!(residual.norm() < 1e-5, "{step}, {g}: {residual}");
            }
            // The matrix takes no energy.
            let power: f64 = x.iter().zip(&product).map(|(x, y)| x.dot(y)).sum();
            assert!(power.abs() < 1e-8, "{step}: {power:e}");
            let taken = |x: &Vec3, b: &Vec3, g: usize| mass(g) * x.dot(&(x - b));
            let taken: f64 = (0..b.len()).map(|g| taken(&x[g], &b[g], g)).sum();
            assert!(taken.abs() < 1e-13, "{step}: {taken:e}");
        }
    }
}
