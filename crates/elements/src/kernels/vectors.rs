//! Small vector algebra on lanes.

use powerhouse_model::{Geometry, Lane, Strain, Stress};

/// Sum `a + b`.
#[inline(always)]
pub(super) fn sum<L: Lane>(a: [L; 3], b: [L; 3]) -> [L; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// Difference `a - b`.
#[inline(always)]
pub(super) fn difference<L: Lane>(a: [L; 3], b: [L; 3]) -> [L; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Product of a vector and a factor.
#[inline(always)]
pub(super) fn scaled<L: Lane>(a: [L; 3], factor: L) -> [L; 3] {
    [a[0] * factor, a[1] * factor, a[2] * factor]
}

/// Sum `a factor + b`.
#[inline(always)]
pub(super) fn scaled_sum<L: Lane>(a: [L; 3], factor: L, b: [L; 3]) -> [L; 3] {
    [
        a[0].mul_add(factor, b[0]),
        a[1].mul_add(factor, b[1]),
        a[2].mul_add(factor, b[2]),
    ]
}

/// Inner product `a . b`.
#[inline(always)]
pub(super) fn dot<L: Lane>(a: [L; 3], b: [L; 3]) -> L {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]))
}

/// Cross product `a x b`.
#[inline(always)]
pub(super) fn cross<L: Lane>(a: [L; 3], b: [L; 3]) -> [L; 3] {
    [
        a[1].mul_add(b[2], -(a[2] * b[1])),
        a[2].mul_add(b[0], -(a[0] * b[2])),
        a[0].mul_add(b[1], -(a[1] * b[0])),
    ]
}

/// Sum `a . b + c`.
#[inline(always)]
pub(super) fn dot_sum<L: Lane>(a: [L; 3], b: [L; 3], c: L) -> L {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2].mul_add(b[2], c)))
}

/// Sum of cross products `a_0 x b_0 + a_1 x b_1`.
#[inline(always)]
pub(super) fn cross_sum<L: Lane>(a: [[L; 3]; 2], b: [[L; 3]; 2]) -> [L; 3] {
    let mut sum = cross(a[0], b[0]);
    for i in 0..3 {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        let less = (-a[1][k]).mul_add(b[1][j], sum[i]);
        sum[i] = a[1][j].mul_add(b[1][k], less);
    }
    sum
}

/// A 3 x 3 matrix by rows.
pub(super) type Matrix<L> = [[L; 3]; 3];

/// Product of a matrix and a vector.
#[inline(always)]
pub(super) fn product<L: Lane>(matrix: &Matrix<L>, vector: [L; 3]) -> [L; 3] {
    [
        dot(matrix[0], vector),
        dot(matrix[1], vector),
        dot(matrix[2], vector),
    ]
}

/// Sum of outer products `sum_k a_k (x) b_k`: row `i`, column `j` holds `sum_k a_k[i] b_k[j]`.
#[inline(always)]
pub(super) fn outer_sum<L: Lane, const K: usize>(a: [[L; 3]; K], b: [[L; 3]; K]) -> Matrix<L> {
    // Row after row, so that the factors of a row leave the registers before the next one.
    let mut matrix = [b[0]; 3];
    for i in 0..3 {
        matrix[i] = scaled(b[0], a[0][i]);
        for k in 1..K {
            matrix[i] = scaled_sum(b[k], a[k][i], matrix[i]);
        }
    }
    matrix
}

/// Gradients of three linear modes, the first geometry numbers of an element.
#[inline(always)]
pub(super) fn linear_gradients<L: Lane>(geometry: &Geometry<L>) -> Matrix<L> {
    [geometry.vector(0), geometry.vector(3), geometry.vector(6)]
}

/// Forces on three linear modes under a uniform stress: `V sigma g_k`.
#[inline(always)]
pub(super) fn uniform_forces<L: Lane>(
    stress: &Stress<L>,
    volume: L,
    gradients: Matrix<L>,
) -> Matrix<L> {
    let mut stress = stress_matrix(stress);
    for i in 0..3 {
        stress[i] = scaled(stress[i], volume);
    }
    [
        product(&stress, gradients[0]),
        product(&stress, gradients[1]),
        product(&stress, gradients[2]),
    ]
}

/// The stress as a matrix.
#[inline(always)]
pub(super) fn stress_matrix<L: Lane>(stress: &Stress<L>) -> Matrix<L> {
    let [xx, yy, zz, xy, yz, zx] = stress.0;
    [[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]]
}

/// The strain of a displacement gradient (row: component, column: direction).
#[inline(always)]
pub(super) fn strain_of<L: Lane>(gradient: &Matrix<L>) -> Strain<L> {
    Strain([
        gradient[0][0],
        gradient[1][1],
        gradient[2][2],
        gradient[0][1] + gradient[1][0],
        gradient[1][2] + gradient[2][1],
        gradient[2][0] + gradient[0][2],
    ])
}

/// The cofactors of a Jacobian with columns `a b c`, which are `det J` times the rows of its
/// inverse, and the determinant.
#[inline(always)]
pub(super) fn cofactors<L: Lane>([a, b, c]: [[L; 3]; 3]) -> (Matrix<L>, L) {
    let rows = [cross(b, c), cross(c, a), cross(a, b)];
    (rows, dot(a, rows[0]))
}
