//! Principal values and directions.

use powerhouse_material_damage::PrincipalAxes;
use powerhouse_model::{Lane, Scalar, Stress};

use super::packs::Pack;
use super::random::Random;

/// Largest error of orthonormality, of order, and of the rebuilt tensor over its largest entry.
fn faults<L: Lane>(stress: &Stress<L>) -> [f64; 2] {
    let axes = PrincipalAxes::of(stress);
    let number = |x: L| x.extract(0);
    let mut orthonormal = 0.0_f64;
    for i in 0..3 {
        for j in 0..3 {
            let pairs = axes.directions[i].iter().zip(&axes.directions[j]);
            let product: f64 = pairs.map(|(a, b)| number(*a) * number(*b)).sum();
            let expected = if i == j { 1.0 } else { 0.0 };
            orthonormal = orthonormal.max((product - expected).abs());
        }
    }
    let values = axes.values.map(number);
    assert!(
        values[0] >= values[1] && values[1] >= values[2],
        "{values:?}"
    );
    let rebuilt = axes.tensor(&axes.values).map(number);
    let given = stress.0.map(number);
    let size = given.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let pairs = rebuilt.iter().zip(given);
    let rest = pairs.fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
    [orthonormal, if size > 0.0 { rest / size } else { rest }]
}

/// Stresses whose principal values are distinct, nearly equal to every degree, and equal.
fn stresses() -> Vec<Stress> {
    let mut random = Random(1);
    let mut stresses = vec![
        Stress([0.0; 6]),
        Stress([-7.0e6, -7.0e6, -7.0e6, 0.0, 0.0, 0.0]),
        Stress([3.0, 2.0, 1.0, 0.0, 0.0, 0.0]),
        Stress([1.0; 6]),
    ];
    for case in 0..4000 {
        let apart = 10.0_f64.powi(-(case % 18));
        let values = match case % 4 {
            0 => [1.0, 1.0 - apart, -2.0],
            1 => [1.0, -2.0, -2.0 - apart],
            2 => [1.0 + apart, 1.0, 1.0 - apart * random.unit()],
            _ => [random.signed(), random.signed(), random.signed()],
        };
        stresses.push(random.with_principal(values.map(|x| 1.0e7 * x)));
    }
    stresses
}

/// Directions are orthonormal and rebuild the tensor within a few roundings, however near the
/// principal values are to each other, in double and in single precision.
#[test]
fn axes_are_orthonormal_and_rebuild_the_tensor() {
    // Some twenty rotations, each with an error of a rounding or two.
    let (double, single) = (20.0 * f64::EPSILON, 20.0 * f64::from(f32::EPSILON));
    for stress in stresses() {
        for fault in faults(&stress) {
            assert!(fault < double, "{fault:e} {stress:?}");
        }
        for fault in faults(&Stress(stress.0.map(f32::from_f64))) {
            assert!(fault < single, "{fault:e} {stress:?}");
        }
    }
}

/// Values are those of which the tensor was built, to a few rounding errors of the largest.
#[test]
fn values_are_those_of_the_tensor() {
    let mut random = Random(2);
    for case in 0..2000 {
        let mut values = [random.signed(), random.signed(), random.signed()];
        if case % 2 == 0 {
            values[1] = values[0] + 1e-12 * random.signed();
        }
        values.sort_by(|a, b| b.total_cmp(a));
        let axes = PrincipalAxes::of(&random.with_principal(values));
        for i in 0..3 {
            // The turned tensor itself carries a few roundings.
            let error = (axes.values[i] - values[i]).abs();
            assert!(error < 20.0 * f64::EPSILON, "{error:e} {values:?}");
        }
    }
}

/// Tensors whose squares would overflow or vanish are decomposed as well as others; NaN remains
/// NaN.
#[test]
fn extreme_sizes_are_decomposed_and_nan_is_kept() {
    let mut random = Random(3);
    for exponent in [-307, -300, -200, -100, 100, 200, 300, 307] {
        let size = 10.0_f64.powi(exponent);
        let [orthonormal, rebuilt] = faults(&Stress(random.six().map(|x| size * x)));
        assert!(orthonormal < 20.0 * f64::EPSILON, "1e{exponent}");
        assert!(rebuilt < 1e-13, "1e{exponent}: {rebuilt:e}");
    }
    for exponent in [-35, -25, -12, 12, 25, 37] {
        let size = 10.0_f64.powi(exponent);
        let narrow = random.six().map(|x| f32::from_f64(size * x));
        for fault in faults(&Stress(narrow)) {
            assert!(fault < 20.0 * f64::from(f32::EPSILON), "1e{exponent}");
        }
    }
    for component in 0..6 {
        let mut broken = [1.0; 6];
        broken[component] = f64::NAN;
        let values = PrincipalAxes::of(&Stress(broken)).values;
        assert!(values.iter().any(|x| x.is_nan()), "{component}: {values:?}");
    }
}

fn same_bits<S>(stresses: &[Stress])
where
    S: Lane<Scalar = S, Token = (), Mask = bool> + Scalar,
{
    for group in stresses.chunks_exact(4) {
        let wide = Stress(core::array::from_fn(|i| {
            Pack::<S, 4>(core::array::from_fn(|lane| S::from_f64(group[lane].0[i])))
        }));
        let wide = PrincipalAxes::of(&wide);
        for (lane, stress) in group.iter().enumerate() {
            let scalar = PrincipalAxes::of(&Stress(stress.0.map(S::from_f64)));
            for i in 0..3 {
                let pair = [wide.values[i].extract(lane), scalar.values[i].to_f64()];
                assert_eq!(pair[0].to_bits(), pair[1].to_bits());
                for j in 0..3 {
                    let wide = wide.directions[i][j].extract(lane);
                    let scalar = scalar.directions[i][j].to_f64();
                    assert_eq!(wide.to_bits(), scalar.to_bits());
                }
            }
        }
    }
}

/// Packs give the same bits as single tensors.
#[test]
fn wide_and_scalar_axes_have_the_same_bits() {
    same_bits::<f64>(&stresses());
    same_bits::<f32>(&stresses());
}
