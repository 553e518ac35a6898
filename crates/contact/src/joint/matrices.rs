//! Matrices of a group of connected pairs.

use nalgebra::{DMatrix, DVector};

/// Relative rounding error of a term that cancels.
const ROUNDING: f64 = 1e-12;

/// Relative velocities of a group's pairs per impulses on them, with the held pairs eliminated.
///
/// In components along the normals and tangents of the pairs, the relative velocities are
/// `r - G p` for impulses `p` (N s). Held pairs have none, which gives their impulses
/// `p_h = H r_h - C^T p_f` with `H` the inverse of `G_hh` and `C = G_fh H`, and the relative velocities
/// of the others: `q - S p_f` with `q = r_f - C r_h` and `S = G_ff - C G_hf`. Where `G_hh` is singular, some impulses `N p`
/// move nothing; of them the held pairs have those of a reference.
#[derive(Clone, Debug)]
pub(super) struct Matrices {
    /// Whether each pair is held.
    pub(super) held: Vec<bool>,
    /// Rows of the held pairs, and of the free ones.
    held_rows: Vec<usize>,
    free_rows: Vec<usize>,
    /// `H`.
    inverse: DMatrix<f64>,
    /// `N`, the part of impulses on held pairs that moves nothing; none where there is no such part.
    still: Option<DMatrix<f64>>,
    /// `C`.
    carry: DMatrix<f64>,
    /// `S`.
    pub(super) schur: DMatrix<f64>,
    /// For each free pair, greatest eigenvalue of the tangential part of its own block of `S`.
    pub(super) tangential: Vec<f64>,
    /// For each free pair, normal relative velocity per tangential impulse (1/kg).
    pub(super) mixed: Vec<f64>,
}

impl Matrices {
    /// Eliminates the held pairs from `G`.
    pub(super) fn new(coupling: &DMatrix<f64>, held: &[bool]) -> Self {
        let rows = |wanted: bool| -> Vec<usize> {
            let of_kind = (0..held.len()).filter(|&pair| held[pair] == wanted);
            of_kind.flat_map(|pair| 3 * pair..3 * pair + 3).collect()
        };
        let (held_rows, free_rows) = (rows(true), rows(false));
        let part = |rows: &[usize], columns: &[usize]| {
            DMatrix::from_fn(rows.len(), columns.len(), |i, j| {
                coupling[(rows[i], columns[j])]
            })
        };
        let (inverse, still) = pseudo_inverse(&part(&held_rows, &held_rows));
        let carry = part(&free_rows, &held_rows) * &inverse;
        let mut schur = part(&free_rows, &free_rows) - &carry * part(&held_rows, &free_rows);
        for (i, &row) in free_rows.iter().enumerate() {
            // A direction in which other pairs hold the nodes of a free pair together.
            if schur[(i, i)] < ROUNDING * coupling[(row, row)] {
                schur.row_mut(i).fill(0.0);
                schur.column_mut(i).fill(0.0);
            }
        }
        let firsts = || (0..free_rows.len()).step_by(3);
        let tangential = firsts().map(|i| greatest_tangential(&schur, i)).collect();
        let mixed = firsts()
            .map(|i| schur[(i, i + 1)].hypot(schur[(i, i + 2)]))
            .collect();
        Self {
            held: held.to_vec(),
            held_rows,
            free_rows,
            inverse,
            still,
            carry,
            schur,
            tangential,
            mixed,
        }
    }

    /// Relative velocities `q` of the free pairs without their impulses, from `r`.
    pub(super) fn free_excess(&self, excess: &DVector<f64>) -> DVector<f64> {
        let free = excess.select_rows(&self.free_rows);
        if self.held_rows.is_empty() {
            return free;
        }
        free - &self.carry * excess.select_rows(&self.held_rows)
    }

    /// Writes all impulses: those of the free pairs, and those of the held ones that result, nearest to a reference.
    pub(super) fn complete(
        &self,
        (excess, reference): (&DVector<f64>, &DVector<f64>),
        free: &DVector<f64>,
        impulses: &mut DVector<f64>,
    ) {
        let mut held =
            &self.inverse * excess.select_rows(&self.held_rows) - self.carry.tr_mul(free);
        if let Some(still) = &self.still {
            held += still * reference.select_rows(&self.held_rows);
        }
        for (&row, &impulse) in self.held_rows.iter().zip(held.iter()) {
            impulses[row] = impulse;
        }
        for (&row, &impulse) in self.free_rows.iter().zip(free.iter()) {
            impulses[row] = impulse;
        }
    }

    /// Values of the free pairs.
    pub(super) fn free_part(&self, values: &DVector<f64>) -> DVector<f64> {
        values.select_rows(&self.free_rows)
    }
}

/// Greatest eigenvalue of the two tangential rows of a pair's block.
fn greatest_tangential(schur: &DMatrix<f64>, first: usize) -> f64 {
    let (i, j) = (first + 1, first + 2);
    let (a, b, c) = (schur[(i, i)], schur[(j, j)], schur[(i, j)]);
    0.5 * (a + b) + (0.25 * (a - b) * (a - b) + c * c).sqrt()
}

/// Pseudo-inverse of a symmetric positive semi-definite matrix, and the projection on its null space; none where that is
/// empty.
///
/// Pairs are scaled to a unit greatest diagonal first, so that masses of very different size are not
/// mistaken for a lost rank; the three rows of a pair by the same factor, so that directions do not
/// change. Of impulses that are not unique the pseudo-inverse takes those with the least sum of `G_max p^2` over the pairs;
/// with the projection of a reference added, those whose difference from it has the least sum.
fn pseudo_inverse(matrix: &DMatrix<f64>) -> (DMatrix<f64>, Option<DMatrix<f64>>) {
    let count = matrix.nrows();
    let scale = DVector::from_fn(count, |i, _| {
        let pair = i - i % 3;
        let greatest = (pair..pair + 3).fold(0.0_f64, |most, row| most.max(matrix[(row, row)]));
        if greatest > 0.0 {
            1.0 / greatest.sqrt()
        } else {
            1.0
        }
    });
    let scaled = |from: &DMatrix<f64>| {
        DMatrix::from_fn(count, count, |i, j| from[(i, j)] * scale[i] * scale[j])
    };
    if count == 0 {
        return (matrix.clone(), None);
    }
    let eigen = scaled(matrix).symmetric_eigen();
    let (mut inverse, mut still) = (DMatrix::zeros(count, count), None);
    for (value, vector) in (eigen.eigenvalues.iter()).zip(eigen.eigenvectors.column_iter()) {
        if *value > ROUNDING {
            inverse.ger(1.0 / value, &vector, &vector, 1.0);
        } else {
            let still = still.get_or_insert_with(|| DMatrix::zeros(count, count));
            let (right, left) = (vector.component_div(&scale), vector.component_mul(&scale));
            still.ger(1.0, &left, &right, 1.0);
        }
    }
    (scaled(&inverse), still)
}
