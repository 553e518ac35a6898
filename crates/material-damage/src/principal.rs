//! Principal values and directions of symmetric tensors, many at once.

use powerhouse_model::{Lane, Scalar, Stress, array, each};

/// The greatest root of `x^3 - 3 x = 2 h` for `h` from 0 to 1, to 1e-5: Chebyshev interpolation,
/// powers of `h`.
const ROOT: [f64; 5] = [
    1.732_059_69,
    0.332_858_23,
    -0.092_011_07,
    0.035_285_24,
    -0.008_198_94,
];
/// Newton steps from there, each of which squares the error.
const NEWTON_STEPS: usize = 2;

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
    /// Without iteration over rotations: of the deviator, scaled to `r = sqrt(J2 / 3) = 1`, the
    /// principal value that stands apart from the other two is a root of `x^3 - 3 x = det`,
    /// between `sqrt 3` and 2 in size, where the slope of the cubic is at least 6. Its direction is
    /// the longest of the products of two rows of what is left without it. In the plane across
    /// that direction one rotation of Jacobi (1846) finishes,
    ///
    /// `t = sgn(d) o / (|d| + sqrt(d^2 + o^2))`, `d = a_qq - a_pp`, `o = 2 a_pq`
    ///
    /// (Golub & Van Loan, *Matrix Computations*, 4th ed. 2013, section 8.5; the isolated root
    /// first: Eberly, *A Robust Eigensolver for 3 x 3 Symmetric Matrices*, 2014). No step divides by a
    /// difference of principal values. Values are accurate to some ten roundings of the largest
    /// entry, directions are orthonormal to a few roundings. A tensor with an entry that is not
    /// finite has NaN for its values.
    ///
    /// ```
    /// use powerhouse_material_damage::PrincipalAxes;
    /// use powerhouse_model::Stress;
    ///
    /// let shear = Stress([0.0, 0.0, 0.0, 5.0e6, 0.0, 0.0]);
    /// let axes = PrincipalAxes::of(&shear);
    /// for (value, exact) in axes.values.iter().zip([5.0e6_f64, 0.0, -5.0e6]) {
    ///     assert!((value - exact).abs() < 1.0e-8);
    /// }
    /// ```
    #[inline(always)]
    pub fn of(stress: &Stress<L>) -> Self {
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
        let matrix = Symmetric(each(&stress.0, |x| x * down));
        let apart = matrix.direction_apart();
        let [p, q] = across(&apart);
        let [p, q] = matrix.turned(p, q, size);
        let values = [
            matrix.along(&apart, &apart),
            matrix.along(&p, &p),
            matrix.along(&q, &q),
        ];
        let mut axes = Self {
            values: each(&values, |value| value * up + finite),
            directions: [apart, p, q],
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

/// A power of two that brings a size to where its square neither overflows nor vanishes, and its
/// inverse.
#[inline(always)]
fn balance<L: Lane>(size: L) -> (L, L) {
    // Beyond these powers of two the balance of this power of two is applied.
    let (large, small, power) = if L::Scalar::EPSILON > f64::EPSILON {
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

/// A symmetric tensor, components xx yy zz xy yz zx.
struct Symmetric<L>([L; 6]);

impl<L: Lane> Symmetric<L> {
    #[inline(always)]
    fn rows(&self) -> [[L; 3]; 3] {
        let [xx, yy, zz, xy, yz, zx] = self.0;
        [[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]]
    }

    /// `a . T . b`.
    #[inline(always)]
    fn along(&self, a: &[L; 3], b: &[L; 3]) -> L {
        let [x, y, z] = self.rows();
        dot(a, &[dot(&x, b), dot(&y, b), dot(&z, b)])
    }

    /// The deviator over `sqrt(J2 / 3)`, or as it is if that is zero.
    #[inline(always)]
    fn scaled_deviator(&self) -> Self {
        let [xx, yy, zz, xy, yz, zx] = self.0;
        let number = |value: f64| xx.constant(value);
        let mean = (xx + yy + zz) * number(1.0 / 3.0);
        let (x, y, z) = (xx - mean, yy - mean, zz - mean);
        let normal = x.mul_add(x, y.mul_add(y, z * z)) * number(0.5);
        let square = normal + xy.mul_add(xy, yz.mul_add(yz, zx * zx));
        let radius = (square * number(1.0 / 3.0)).sqrt();
        let one = number(1.0);
        let scale = one / radius.select(number(0.0).less(radius), one);
        Self(each(&[x, y, z, xy, yz, zx], |entry| entry * scale))
    }

    /// The unit vector of the principal value that is furthest from the others.
    #[inline(always)]
    fn direction_apart(&self) -> [L; 3] {
        let deviator = self.scaled_deviator();
        let [x, y, z] = deviator.rows();
        let number = |value: f64| x[0].constant(value);
        let (zero, one) = (number(0.0), number(1.0));
        let determinant = dot(&x, &cross(&y, &z));
        let half = determinant.abs() * number(0.5);
        let half = one.select(one.less(half), half);
        let mut root = number(ROOT[4]);
        for power in 1..ROOT.len() {
            root = root.mul_add(half, number(ROOT[ROOT.len() - 1 - power]));
        }
        for _ in 0..NEWTON_STEPS {
            let square = root * root;
            let value = root * (square - number(3.0)) - (half + half);
            root = root - value / (number(3.0) * (square - one));
        }
        let value = (-root).select(determinant.less(zero), root);
        let x = [x[0] - value, x[1], x[2]];
        let y = [y[0], y[1] - value, y[2]];
        let z = [z[0], z[1], z[2] - value];
        let (mut longest, mut square) = ([one, zero, zero], zero);
        for product in [cross(&x, &y), cross(&y, &z), cross(&z, &x)] {
            let found = dot(&product, &product);
            let longer = square.less(found);
            square = found.select(longer, square);
            longest = array(|i| product[i].select(longer, longest[i]));
        }
        let length = square.select(zero.less(square), one).sqrt();
        each(&longest, |entry| entry / length)
    }

    /// Two unit vectors across each other, turned in their plane until their entry is zero, where it
    /// counts beside `size`.
    #[inline(always)]
    fn turned(&self, p: [L; 3], q: [L; 3], size: L) -> [[L; 3]; 2] {
        let zero = size.constant(0.0);
        let one = size.constant(1.0);
        let entry = self.along(&p, &q);
        let counts = size.less(size + entry.abs());
        let d = self.along(&q, &q) - self.along(&p, &p);
        let o = entry + entry;
        let signed = (-o).select(d.less(zero), o);
        let tangent = signed / (d.abs() + d.mul_add(d, o * o).sqrt());
        let tangent = tangent.select(counts, zero);
        let cosine = one / tangent.mul_add(tangent, one).sqrt();
        let sine = tangent * cosine;
        [
            array(|i| cosine * p[i] - sine * q[i]),
            array(|i| sine * p[i] + cosine * q[i]),
        ]
    }
}

/// Two unit vectors across a unit vector and each other.
#[inline(always)]
fn across<L: Lane>(unit: &[L; 3]) -> [[L; 3]; 2] {
    let [x, y, z] = *unit;
    let zero = x.constant(0.0);
    let wide = y.abs().less(x.abs());
    let longer = x.select(wide, y);
    let length = longer.mul_add(longer, z * z).sqrt();
    let (sine, cosine) = (z / length, longer / length);
    let first = [
        (-sine).select(wide, zero),
        zero.select(wide, sine),
        cosine.select(wide, -cosine),
    ];
    [first, cross(unit, &first)]
}

#[inline(always)]
fn dot<L: Lane>(a: &[L; 3], b: &[L; 3]) -> L {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]))
}

#[inline(always)]
fn cross<L: Lane>(a: &[L; 3], b: &[L; 3]) -> [L; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}
