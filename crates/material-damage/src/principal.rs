//! Principal values and directions of symmetric tensors, on lanes.

use powerhouse_model::{Lane, Scalar, Stress, array, each};

/// Coefficients of the greatest root of `x^3 - 3 x = 2 h` in powers of `h`, for `h` from 0 to 1, to
/// 1.4e-6, by Chebyshev interpolation.
const ROOT: [f64; 6] = [
    1.732_052_122,
    0.333_237_713,
    -0.095_050_028,
    0.043_799_255,
    -0.017_932_902,
    0.003_894_603,
];
const ROOT_3: f64 = 1.732_050_807_568_877_2;

/// Principal values of a symmetric tensor in falling order, with their directions.
///
/// Two values that are equal, or nearly so, have directions that are any orthonormal pair in
/// their plane: a tensor rebuilt from values and directions is accurate all the same.
#[derive(Clone, Copy, Debug)]
pub struct PrincipalAxes<L> {
    /// Principal values: greatest, middle, least.
    pub values: [L; 3],
    /// Unit vectors of the principal directions: `directions[i]` belongs to `values[i]`.
    pub directions: [[L; 3]; 3],
}

impl<L: Lane> PrincipalAxes<L> {
    /// Principal axes of a stress.
    ///
    /// Without iteration over rotations: of the deviator, scaled to `r = sqrt(J2 / 3) = 1`, the
    /// principal value `x` that is most isolated is a root of `x^3 - 3 x = det`,
    /// between `sqrt 3` and 2 in size, where the slope of the cubic is at least 6. Its direction is
    /// the longest column of the adjugate of the remainder, which is `3 (x^2 - 1) v v^T`.
    /// In the plane across that direction, with entries `a`, `b` and `o / 2` off the diagonal,
    ///
    /// `(a + b + h) / 2` along `(h + d, o)`, `(a + b - h) / 2` across it, `d = a - b`, `h = sqrt(d^2 + o^2)`
    ///
    /// (`(o, h - d)` if `d < 0`). No step divides by a difference of principal values. Values are
    /// accurate to some ten rounding errors of the largest entry, directions are orthonormal to a few
    /// rounding errors. A tensor with an entry that is not finite has NaN for its values.
    ///
    /// Sources: the isolated root first: Eberly, *A Robust Eigensolver for 3 x 3 Symmetric Matrices*,
    /// 2014; two vectors across a third: Duff et al., *J. Computer Graphics Techniques* 6(1), 2017.
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
        let number = |value: f64| stress.0[0].constant(value);
        let (zero, half, one) = (number(0.0), number(0.5), number(1.0));
        let Scaled {
            deviator,
            radius,
            mean,
        } = Scaled::of(stress);
        let (is_least, root) = deviator.isolated();
        let value = (-root).select(is_least, root);
        let isolated = deviator.direction_of(value);

        // In the plane across.
        let [p, q] = across(&isolated);
        let turned = deviator.times(&p);
        let (entry, mixed) = (dot(&p, &turned), dot(&q, &turned));
        let sum = deviator.trace() - value;
        let d = entry + entry - sum;
        let o = mixed + mixed;
        let width = d.mul_add(d, o * o).sqrt();
        let long = d.abs() + width;
        let long = long.select(number(LEAST).less(long), one);
        let inverse = one / long.mul_add(long, o * o).sqrt();
        let (long, short) = (long * inverse, o * inverse);
        let is_falling = d.less(zero);
        let (along_p, along_q) = (
            short.select(is_falling, long),
            long.select(is_falling, short),
        );
        let (upper, lower) = ((sum + width) * half, (sum - width) * half);

        // Of the two in the plane: the one at the other end of the order, and the one between.
        let (end_p, end_q) = (
            along_p.select(is_least, -along_q),
            along_q.select(is_least, along_p),
        );
        let end: [L; 3] = array(|i| end_p * p[i] + end_q * q[i]);
        let between: [L; 3] = array(|i| end_q * p[i] - end_p * q[i]);
        let values = [
            upper.select(is_least, value),
            lower.select(is_least, upper),
            value.select(is_least, lower),
        ];
        Self {
            values: each(&values, |scaled| scaled.mul_add(radius, mean)),
            directions: [
                array(|i| end[i].select(is_least, isolated[i])),
                between,
                array(|i| isolated[i].select(is_least, end[i])),
            ],
        }
    }

    /// Symmetric tensor with these directions and other principal values, components xx yy zz xy yz zx.
    #[inline(always)]
    pub fn tensor(&self, &[first, middle, last]: &[L; 3]) -> [L; 6] {
        // The middle value times unity, plus the differences of the other two.
        let [a, _, c] = self.directions;
        let (up, down) = (first - middle, last - middle);
        let scaled_a = each(&a, |x| x * up);
        let scaled_c = each(&c, |x| x * down);
        let mut entries = [middle; 6];
        for (index, [row, column]) in ENTRIES.into_iter().enumerate() {
            let entry = scaled_a[row].mul_add(a[column], scaled_c[row] * c[column]);
            entries[index] = if row == column { entry + middle } else { entry };
        }
        entries
    }
}

/// Rows and columns of the components xx yy zz xy yz zx.
const ENTRIES: [[usize; 2]; 6] = [[0, 0], [1, 1], [2, 2], [0, 1], [1, 2], [2, 0]];

/// Lanes of magnitudes whose squares are near the ends of the range of numbers or outside, or of NaN.
#[inline(always)]
pub(crate) fn is_extreme<L: Lane>(size: L) -> L::Mask {
    let [low, high] = if L::Scalar::EPSILON > f64::EPSILON {
        [1.0e-15, 1.0e15]
    } else {
        [1.0e-140, 1.0e140]
    };
    let number = |value: f64| size.constant(value);
    let (zero, one) = (number(0.0), number(1.0));
    let inside = one.select(number(low).less(size), zero);
    inside.select(size.less(number(high)), zero).less(one)
}

/// Length below which a vector counts as zero beside one of length one.
const LEAST: f64 = 1.0e-15;

/// Tensor as `mean + radius deviator`.
struct Scaled<L> {
    /// Deviator over `sqrt(J2 / 3)`, or as it is if that is zero.
    deviator: Symmetric<L>,
    radius: L,
    mean: L,
}

impl<L: Lane> Scaled<L> {
    #[inline(always)]
    fn of(stress: &Stress<L>) -> Self {
        let number = |value: f64| stress.0[0].constant(value);
        let (zero, one) = (number(0.0), number(1.0));
        let (mut mean, mut shear) = stress.mean_and_shear();
        let (mut tensor, mut up, mut finite) = (*stress, one, zero);
        if zero.any(is_extreme(shear)) {
            let mut largest = zero;
            for entry in &stress.0 {
                largest = largest.max(entry.abs());
                // Zero, or NaN if an entry is not finite: one off the diagonal could otherwise be lost.
                finite = finite + *entry * zero;
            }
            let down;
            (down, up) = balance(largest);
            tensor = Stress(each(&stress.0, |x| x * down));
            (mean, shear) = tensor.mean_and_shear();
        }
        let some = shear.select(zero.less(shear), one);
        let scale = number(ROOT_3) / some;
        let [xx, yy, zz, xy, yz, zx] = tensor.0;
        let deviator = [xx - mean, yy - mean, zz - mean, xy, yz, zx];
        Self {
            deviator: Symmetric(each(&deviator, |x| x * scale)),
            radius: shear * number(1.0 / ROOT_3) * up,
            mean: mean * up + finite,
        }
    }
}

/// Power of two that scales a magnitude so that its square neither overflows nor vanishes, and its
/// inverse.
#[inline(always)]
fn balance<L: Lane>(size: L) -> (L, L) {
    // Beyond these powers of two the scale of this power of two is applied.
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

/// Symmetric tensor, components xx yy zz xy yz zx.
struct Symmetric<L>([L; 6]);

impl<L: Lane> Symmetric<L> {
    #[inline(always)]
    fn trace(&self) -> L {
        let [xx, yy, zz, ..] = self.0;
        xx + yy + zz
    }

    #[inline(always)]
    fn times(&self, a: &[L; 3]) -> [L; 3] {
        let [xx, yy, zz, xy, yz, zx] = self.0;
        [
            dot(&[xx, xy, zx], a),
            dot(&[xy, yy, yz], a),
            dot(&[zx, yz, zz], a),
        ]
    }

    /// Whether the most isolated principal value of a scaled deviator is the least one, and its
    /// magnitude.
    #[inline(always)]
    fn isolated(&self) -> (L::Mask, L) {
        let [xx, yy, zz, xy, yz, zx] = self.0;
        let number = |value: f64| xx.constant(value);
        let (one, three) = (number(1.0), number(3.0));
        let minors = [
            minor(yy, zz, yz, yz),
            minor(yz, zx, xy, zz),
            minor(xy, yz, yy, zx),
        ];
        let determinant = dot(&[xx, xy, zx], &minors);
        let half = (determinant.abs() * number(0.5)).min(one);
        let mut root = number(ROOT[ROOT.len() - 1]);
        for power in 1..ROOT.len() {
            root = root.mul_add(half, number(ROOT[ROOT.len() - 1 - power]));
        }
        // One step of Newton squares the error; a second one may reuse the slope of the first.
        let square = root * root;
        let inverse = one / (three * (square - one));
        root = root - (root * (square - three) - (half + half)) * inverse;
        if L::Scalar::EPSILON < 1.0e-10 {
            root = root - (root * (root * root - three) - (half + half)) * inverse;
        }
        (determinant.less(number(0.0)), root)
    }

    /// Unit vector of the most isolated principal value.
    #[inline(always)]
    fn direction_of(&self, value: L) -> [L; 3] {
        let [xx, yy, zz, xy, yz, zx] = self.0;
        let number = |value: f64| xx.constant(value);
        let (zero, one) = (number(0.0), number(1.0));
        let (x, y, z) = (xx - value, yy - value, zz - value);
        // Adjugate.
        let normal = [
            minor(y, z, yz, yz),
            minor(z, x, zx, zx),
            minor(x, y, xy, xy),
        ];
        let shear = [
            minor(yz, zx, xy, z),
            minor(zx, xy, yz, x),
            minor(xy, yz, zx, y),
        ];
        let ([xx, yy, zz], [xy, yz, zx]) = (normal, shear);
        let (mut longest, mut entry) = ([xx, xy, zx], xx);
        for (column, own) in [([xy, yy, yz], yy), ([zx, yz, zz], zz)] {
            let longer = entry.less(own);
            entry = own.select(longer, entry);
            longest = array(|i| column[i].select(longer, longest[i]));
        }
        // Of a deviator of rounding errors alone nothing may remain.
        let some = number(LEAST).less(entry);
        let longest = [
            longest[0].select(some, one),
            longest[1].select(some, zero),
            longest[2].select(some, zero),
        ];
        let inverse = one / dot(&longest, &longest).sqrt();
        each(&longest, |entry| entry * inverse)
    }
}

/// Two unit vectors normal to a unit vector and to each other.
#[inline(always)]
fn across<L: Lane>(&[x, y, z]: &[L; 3]) -> [[L; 3]; 2] {
    let (zero, one) = (z.constant(0.0), z.constant(1.0));
    let sign = (-one).select(z.less(zero), one);
    let a = -(one / (sign + z));
    let b = x * y * a;
    [
        [(x * x * a).mul_add(sign, one), sign * b, -(sign * x)],
        [b, (y * y).mul_add(a, sign), -y],
    ]
}

/// Minor `a b - c d`.
#[inline(always)]
fn minor<L: Lane>(a: L, b: L, c: L, d: L) -> L {
    a.mul_add(b, -(c * d))
}

#[inline(always)]
fn dot<L: Lane>(a: &[L; 3], b: &[L; 3]) -> L {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]))
}
