//! Principal stresses in closed form.

use powerhouse_model::Stress;

/// Principal stresses (Pa) in closed form, greatest first.
///
/// With the deviator `s`, `J2 = s:s / 2`, `J3 = det s`, they are
/// ```text
/// p + 2 sqrt(J2/3) cos(theta + 2 pi k/3),  3 theta = atan2(sqrt(4 J2^3 - 27 J3^2), sqrt(27) J3)
/// ```
/// The discriminant under the root vanishes where two of them coincide, and the difference of
/// cubes would lose half the digits there. It is instead Gram's determinant of `I, s, s^2`, by
/// Lagrange's identity a sum of squares: `4 J2^3 - 27 J3^2 = 3 sum (s_i t_j - s_j t_i)^2` over pairs
/// of the five components of `s` and of the deviator `t` of `s^2` in an orthonormal basis. The error
/// is some units in the last place of the largest principal stress, also where they coincide.
///
/// ```
/// use powerhouse_observe::principal_stresses;
/// use powerhouse_model::Stress;
/// let [greatest, middle, least] = principal_stresses(&Stress([1.0, 1.0, -2.0, 3.0, 0.0, 0.0]));
/// assert!((greatest - 4.0).abs() < 1e-14 && (middle + 2.0).abs() < 1e-14 && (least + 2.0).abs() < 1e-14);
/// ```
pub fn principal_stresses(stress: &Stress) -> [f64; 3] {
    let size = stress.0.iter().fold(0.0_f64, |size, x| size.max(x.abs()));
    // Also where a component is NaN or infinite, so that the result is not finite either.
    if !(size > 0.0 && size.is_finite()) {
        return [stress.0.iter().sum(); 3];
    }
    let [xx, yy, zz, xy, yz, zx] = stress.0.map(|x| x / size);
    let mean = (xx + yy + zz) / 3.0;
    let (a, b, c) = (xx - mean, yy - mean, zz - mean);
    // Components of s^2.
    let (aa, bb, cc) = (
        a * a + xy * xy + zx * zx,
        b * b + xy * xy + yz * yz,
        c * c + yz * yz + zx * zx,
    );
    let (ab, bc, ca) = (
        xy * (a + b) + yz * zx,
        yz * (b + c) + xy * zx,
        zx * (c + a) + xy * yz,
    );
    let basis = |xx: f64, yy: f64, zz: f64, xy: f64, yz: f64, zx: f64| {
        let half = 0.5_f64.sqrt();
        let double = 2.0_f64.sqrt();
        [
            half * (xx - yy),
            (2.0 * zz - xx - yy) / 6.0_f64.sqrt(),
            double * xy,
            double * yz,
            double * zx,
        ]
    };
    let s = basis(a, b, c, xy, yz, zx);
    let t = basis(aa, bb, cc, ab, bc, ca);
    let mut squares = 0.0;
    for i in 0..5 {
        for j in i + 1..5 {
            let minor = s[i] * t[j] - s[j] * t[i];
            squares += minor * minor;
        }
    }
    let j2 = 0.5 * s.iter().map(|x| x * x).sum::<f64>();
    let j3 = a * (b * c - yz * yz) - xy * (xy * c - yz * zx) + zx * (xy * yz - b * zx);
    let third = core::f64::consts::TAU / 3.0;
    let theta = (3.0 * squares).sqrt().atan2(27.0_f64.sqrt() * j3) / 3.0;
    let radius = 2.0 * (j2 / 3.0).sqrt();
    [theta, theta - third, theta + third].map(|angle| size * (mean + radius * angle.cos()))
}
