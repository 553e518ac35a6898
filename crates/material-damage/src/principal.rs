//! Principal values and directions of symmetric tensors, many at once.

use powerhouse_model::{Lane, Scalar, Stress, array, each};

/// The most sweeps; quadratic convergence needs five for matrices of any kind.
const MOST_SWEEPS: usize = 8;

/// Principal values in falling order, with their directions.
///
/// Two values that are equal, or nearly so, have directions that are any orthonormal pair in
/// their plane: what is rebuilt from values and directions is accurate all the same.
#[derive(Clone, Copy, Debug)]
pub struct PrincipalAxes<L> {
    /// Greatest, middle, least.
    pub values: [L; 3],
    /// Unit vectors that belong to them: `directions[i]` belongs to `values[i]`.
    pub directions: [[L; 3]; 3],
}

impl<L: Lane> PrincipalAxes<L> {
    /// The axes of a stress.
    ///
    /// Cyclic rotations of Jacobi (1846) in the order xy, zx, yz, each of which makes one
    /// off-diagonal entry zero:
    ///
    /// `t = sgn(d) o / (|d| + sqrt(d^2 + o^2))`, `d = a_qq - a_pp`, `o = 2 a_pq`
    ///
    /// (Golub & Van Loan, *Matrix Computations*, 4th ed. 2013, section 8.5). An entry that is
    /// lost beside the largest entry of the tensor is left alone, so that a lane which is done
    /// stays as it is while others go on: the scalar form gives the same bits. Values are
    /// accurate to a few roundings of the largest, directions are orthonormal to a few roundings.
    /// A tensor with an entry that is not finite has NaN for its values.
    ///
    /// ```
    /// use powerhouse_material_damage::PrincipalAxes;
    /// use powerhouse_model::Stress;
    ///
    /// let shear = Stress([0.0, 0.0, 0.0, 5.0e6, 0.0, 0.0]);
    /// let axes = PrincipalAxes::of(&shear);
    /// assert_eq!(axes.values, [5.0e6, 0.0, -5.0e6]);
    /// ```
    #[inline(always)]
    pub fn of(stress: &Stress<L>) -> Self {
        let one = stress.0[0].constant(1.0);
        let zero = stress.0[0].constant(0.0);
        let mut largest = stress.0[0].abs();
        for entry in &stress.0[1..] {
            largest = largest.max(entry.abs());
        }
        let (down, up) = balance(largest);
        let size = largest * down;
        // Zero, or NaN if an entry is not finite: an entry off the diagonal could else be lost.
        let mut finite = stress.0[0] * zero;
        for entry in &stress.0[1..] {
            finite = finite + *entry * zero;
        }
        let [xx, yy, zz, xy, yz, zx] = each(&stress.0, |x| x * down);
        let mut matrix = [[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]];
        // Columns are the directions.
        let mut turn = [[one, zero, zero], [zero, one, zero], [zero, zero, one]];
        for _ in 0..MOST_SWEEPS {
            let rest = matrix[0][1].abs();
            let rest = rest.max(matrix[0][2].abs()).max(matrix[1][2].abs());
            if !size.any(size.less(size + rest)) {
                break;
            }
            rotate::<L, 0, 1, 2>(&mut matrix, &mut turn, size);
            rotate::<L, 0, 2, 1>(&mut matrix, &mut turn, size);
            rotate::<L, 1, 2, 0>(&mut matrix, &mut turn, size);
        }
        let mut axes = Self {
            values: array(|i| matrix[i][i] * up + finite),
            directions: [column(&turn, 0), column(&turn, 1), column(&turn, 2)],
        };
        axes.order(0, 1);
        axes.order(1, 2);
        axes.order(0, 1);
        axes
    }

    /// The symmetric tensor with these axes and other values, components xx yy zz xy yz zx.
    #[inline(always)]
    pub fn tensor(&self, values: &[L; 3]) -> [L; 6] {
        [
            self.entry(values, 0, 0),
            self.entry(values, 1, 1),
            self.entry(values, 2, 2),
            self.entry(values, 0, 1),
            self.entry(values, 1, 2),
            self.entry(values, 2, 0),
        ]
    }

    /// One entry of that tensor.
    #[inline(always)]
    fn entry(&self, values: &[L; 3], row: usize, column: usize) -> L {
        let [a, b, c] = &self.directions;
        values[0] * a[row] * a[column]
            + values[1] * b[row] * b[column]
            + values[2] * c[row] * c[column]
    }

    /// Exchanges two neighbours that stand in rising order.
    #[inline(always)]
    fn order(&mut self, first: usize, second: usize) {
        let (a, b) = (self.values[first], self.values[second]);
        let rising = a.less(b);
        self.values[first] = b.select(rising, a);
        self.values[second] = a.select(rising, b);
        for i in 0..3 {
            let (a, b) = (self.directions[first][i], self.directions[second][i]);
            self.directions[first][i] = b.select(rising, a);
            self.directions[second][i] = a.select(rising, b);
        }
    }
}

/// One column of a matrix.
#[inline(always)]
fn column<L: Lane>(matrix: &[[L; 3]; 3], place: usize) -> [L; 3] {
    array(|row| matrix[row][place])
}

/// A power of two that brings a size to where its square neither overflows nor vanishes, and its
/// inverse.
#[inline(always)]
fn balance<L: Lane>(size: L) -> (L, L) {
    let single = L::Scalar::from_f64(1.0 + f64::EPSILON).to_f64() == 1.0;
    // Beyond these powers of two the balance of this power of two is applied.
    let (large, small, power) = if single {
        (40, -40, 80)
    } else {
        (400, -400, 520)
    };
    let two = |exponent: i32| size.constant(2.0_f64.powi(exponent));
    let is_large = two(large).less(size);
    let is_small = size.less(two(small));
    let one = size.constant(1.0);
    let down = two(-power).select(is_large, two(power).select(is_small, one));
    let up = two(power).select(is_large, two(-power).select(is_small, one));
    (down, up)
}

/// One rotation in the plane of P and Q that makes their entry zero, where it counts beside
/// `size`.
#[inline(always)]
fn rotate<L: Lane, const P: usize, const Q: usize, const R: usize>(
    matrix: &mut [[L; 3]; 3],
    turn: &mut [[L; 3]; 3],
    size: L,
) {
    let zero = size.constant(0.0);
    let one = size.constant(1.0);
    let entry = matrix[P][Q];
    let counts = size.less(size + entry.abs());
    let d = matrix[Q][Q] - matrix[P][P];
    let o = entry + entry;
    let signed = (-o).select(d.less(zero), o);
    let tangent = signed / (d.abs() + d.mul_add(d, o * o).sqrt());
    let tangent = tangent.select(counts, zero);
    let cosine = one / tangent.mul_add(tangent, one).sqrt();
    let sine = tangent * cosine;

    matrix[P][P] = matrix[P][P] - tangent * entry;
    matrix[Q][Q] = matrix[Q][Q] + tangent * entry;
    matrix[P][Q] = zero.select(counts, entry);
    matrix[Q][P] = matrix[P][Q];
    let (p, q) = (matrix[R][P], matrix[R][Q]);
    matrix[R][P] = cosine * p - sine * q;
    matrix[R][Q] = sine * p + cosine * q;
    matrix[P][R] = matrix[R][P];
    matrix[Q][R] = matrix[R][Q];
    for row in turn {
        let (p, q) = (row[P], row[Q]);
        row[P] = cosine * p - sine * q;
        row[Q] = sine * p + cosine * q;
    }
}
