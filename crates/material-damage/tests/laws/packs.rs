//! A lane of fixed width in terms of arrays, against which scalar and wide forms are compared.

use core::ops::{Add, Div, Mul, Neg, Sub};

use powerhouse_model::{Lane, Scalar};

/// `N` numbers computed with together.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pack<S, const N: usize>(pub(crate) [S; N]);

macro_rules! operator {
    ($trait:ident, $method:ident) => {
        impl<S: Lane<Scalar = S, Token = ()>, const N: usize> $trait for Pack<S, N> {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                Self(core::array::from_fn(|i| {
                    $trait::$method(self.0[i], other.0[i])
                }))
            }
        }
    };
}
operator!(Add, add);
operator!(Sub, sub);
operator!(Mul, mul);
operator!(Div, div);

impl<S: Lane, const N: usize> Neg for Pack<S, N> {
    type Output = Self;
    fn neg(self) -> Self {
        Self(self.0.map(|x| -x))
    }
}

impl<S, const N: usize> Lane for Pack<S, N>
where
    S: Lane<Scalar = S, Token = (), Mask = bool> + Scalar,
{
    type Scalar = S;
    type Token = ();
    type Mask = [bool; N];
    const WIDTH: usize = N;

    fn splat(_token: (), value: f64) -> Self {
        Self([S::splat((), value); N])
    }
    fn load(_token: (), from: &[S]) -> Self {
        Self(core::array::from_fn(|i| from[i]))
    }
    fn store(self, to: &mut [S]) {
        to[..N].copy_from_slice(&self.0);
    }
    fn token(self) {}
    fn mul_add(self, factor: Self, summand: Self) -> Self {
        Self(core::array::from_fn(|i| {
            Lane::mul_add(self.0[i], factor.0[i], summand.0[i])
        }))
    }
    fn sqrt(self) -> Self {
        Self(self.0.map(Lane::sqrt))
    }
    fn abs(self) -> Self {
        Self(self.0.map(Lane::abs))
    }
    fn less(self, other: Self) -> [bool; N] {
        core::array::from_fn(|i| self.0[i].less(other.0[i]))
    }
    fn select(self, mask: [bool; N], other: Self) -> Self {
        Self(core::array::from_fn(|i| {
            self.0[i].select(mask[i], other.0[i])
        }))
    }
    fn any(self, mask: [bool; N]) -> bool {
        mask.contains(&true)
    }
    fn extract(self, lane: usize) -> f64 {
        self.0[lane].to_f64()
    }
    fn build(_token: (), mut value: impl FnMut(usize) -> f64) -> Self {
        Self(core::array::from_fn(|i| S::from_f64(value(i))))
    }
}
