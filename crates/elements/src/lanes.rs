//! SIMD lanes: one element per lane, for the instruction sets of the processor.
//!
//! [`Lanes`] is the instruction set, chosen at run time, and runs a [`BatchOperation`] with its lane
//! type. Every function called by an operation must be `#[inline(always)]`: a function that is called
//! instead of inlined is compiled for the oldest processor and costs fifty times as much. Functions
//! of the standard library that take a closure, such as `array::map`, are not inlined: write loops. One
//! `map` over three vectors of lanes took a step of equal bricks from 26 to 76 ns per element.

use core::marker::PhantomData;
use core::ops::{Add, Div, Mul, Neg, Sub};

use powerhouse_model::{
    ConstitutiveLaw, Lane, LaneWidth, LawEnergy, LawInput, NodalScalar, RemainingStiffness, Stress,
    point_energy, point_stress_change,
};
use pulp::{Simd, WithSimd};

#[cfg(all(debug_assertions, target_arch = "x86_64"))]
use development::Arch;
#[cfg(not(all(debug_assertions, target_arch = "x86_64")))]
use pulp::Arch;

/// Instruction sets of builds with debug assertions: AVX2 at most, which halves
/// their compilation time. Results are bitwise independent of the width of lanes.
#[cfg(all(debug_assertions, target_arch = "x86_64"))]
mod development {
    use pulp::{Scalar, Simd, WithSimd, x86::V3};

    #[derive(Clone, Copy, Debug)]
    pub(super) enum Arch {
        Scalar,
        V3(V3),
    }

    impl Arch {
        pub(super) fn new() -> Self {
            V3::try_new().map_or(Self::Scalar, Self::V3)
        }
        #[inline(always)]
        pub(super) fn dispatch<O: WithSimd>(self, operation: O) -> O::Output {
            match self {
                Self::Scalar => Simd::vectorize(Scalar, operation),
                Self::V3(avx2) => Simd::vectorize(avx2, operation),
            }
        }
    }
}

/// Largest number of lanes of any instruction set.
pub(crate) const MOST_LANES: usize = 16;

/// Four numbers for each element of a batch, as nodal values are stored.
pub(crate) type Rows<S> = [[S; 4]; MOST_LANES];

/// A lane type that transposes rows of nodal values into components, one element per lane, and back.
///
/// The transposition may permute: element `j` of a batch is in lane `l` with `positions(..)[l] == j`.
pub(crate) trait BatchLane: Lane {
    /// The element of the batch in each lane.
    fn positions(token: Self::Token) -> [usize; MOST_LANES];
    /// The first three components of the first `WIDTH` rows.
    fn components(token: Self::Token, rows: &Rows<Self::Scalar>) -> [Self; 3];
    /// The first `WIDTH` rows of three components; the fourth is zero.
    fn write_rows(components: [Self; 3], rows: &mut Rows<Self::Scalar>);
    /// Change of stress of a law.
    #[inline(always)]
    fn stress_change<M: ConstitutiveLaw>(
        law: &M,
        input: &LawInput<Self>,
        new_history: &mut [Self],
    ) -> Stress<Self> {
        law.stress_change(input, new_history)
    }
    /// Energies of a law.
    #[inline(always)]
    fn energy<M: ConstitutiveLaw>(
        law: &M,
        input: &LawInput<Self>,
        new_history: &[Self],
    ) -> Option<LawEnergy<Self>> {
        law.energy(input, new_history)
    }
    /// Remaining stiffness of a law.
    #[inline(always)]
    fn remaining_stiffness<M: ConstitutiveLaw>(
        law: &M,
        input: &LawInput<Self>,
        new_history: &[Self],
        change: &Stress<Self>,
    ) -> RemainingStiffness<Self> {
        law.remaining_stiffness(input, new_history, change)
    }
}

/// Number format of element arithmetic.
pub(crate) trait BatchScalar: NodalScalar + BatchLane<Scalar = Self, Token = ()> {
    /// Lane type of this format for an instruction set.
    type Wide<T: Simd>: BatchLane<Scalar = Self, Token = T>;
}

macro_rules! scalar_batch_lane {
    ($scalar:ident, $wide:ident, { $($shared:item)* }) => {
        impl BatchScalar for $scalar {
            type Wide<T: Simd> = $wide<T>;
        }

        impl BatchLane for $scalar {
            #[inline(always)]
            fn positions(_token: ()) -> [usize; MOST_LANES] {
                [0; MOST_LANES]
            }
            #[inline(always)]
            fn components(_token: (), rows: &Rows<$scalar>) -> [Self; 3] {
                [rows[0][0], rows[0][1], rows[0][2]]
            }
            #[inline(always)]
            fn write_rows(components: [Self; 3], rows: &mut Rows<$scalar>) {
                rows[0] = [components[0], components[1], components[2], 0.0];
            }
            $($shared)*
        }
    };
}

scalar_batch_lane!(f64, WideF64, {
    fn stress_change<M: ConstitutiveLaw>(
        law: &M,
        input: &LawInput<f64>,
        new_history: &mut [f64],
    ) -> Stress {
        point_stress_change(law, input, new_history)
    }
    fn energy<M: ConstitutiveLaw>(
        law: &M,
        input: &LawInput<f64>,
        new_history: &[f64],
    ) -> Option<LawEnergy<f64>> {
        point_energy(law, input, new_history)
    }
});
scalar_batch_lane!(f32, WideF32, {});

macro_rules! wide_lane {
    (
        $(#[$doc:meta])* $name:ident, $scalar:ident, $register:ident, $mask:ident, $lanes:ident,
        $splat:ident, $add:ident, $sub:ident, $mul:ident, $div:ident, $neg:ident, $mul_add:ident,
        $sqrt:ident, $abs:ident, $less:ident, $select:ident, $first_true:ident,
        $as_simd:ident, $as_mut_simd:ident, $deinterleave:ident, $interleave:ident,
        $min:ident, $max:ident, $power_of_two:ident
    ) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        pub(crate) struct $name<T: Simd> {
            register: T::$register,
            token: T,
        }

        impl<T: Simd> $name<T> {
            #[inline(always)]
            fn new(token: T, register: T::$register) -> Self {
                Self { register, token }
            }
        }

        impl<T: Simd> Add for $name<T> {
            type Output = Self;
            #[inline(always)]
            fn add(self, other: Self) -> Self {
                Self::new(self.token, self.token.$add(self.register, other.register))
            }
        }

        impl<T: Simd> Sub for $name<T> {
            type Output = Self;
            #[inline(always)]
            fn sub(self, other: Self) -> Self {
                Self::new(self.token, self.token.$sub(self.register, other.register))
            }
        }

        impl<T: Simd> Mul for $name<T> {
            type Output = Self;
            #[inline(always)]
            fn mul(self, other: Self) -> Self {
                Self::new(self.token, self.token.$mul(self.register, other.register))
            }
        }

        impl<T: Simd> Div for $name<T> {
            type Output = Self;
            #[inline(always)]
            fn div(self, other: Self) -> Self {
                Self::new(self.token, self.token.$div(self.register, other.register))
            }
        }

        impl<T: Simd> Neg for $name<T> {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                Self::new(self.token, self.token.$neg(self.register))
            }
        }

        impl<T: Simd> Lane for $name<T> {
            type Scalar = $scalar;
            type Token = T;
            type Mask = T::$mask;
            const WIDTH: usize = T::$lanes;

            #[inline(always)]
            fn splat(token: T, value: f64) -> Self {
                Self::new(token, token.$splat(value as $scalar))
            }
            #[inline(always)]
            fn load(token: T, from: &[$scalar]) -> Self {
                Self::new(token, T::$as_simd(&from[..Self::WIDTH]).0[0])
            }
            #[inline(always)]
            fn store(self, to: &mut [$scalar]) {
                T::$as_mut_simd(&mut to[..Self::WIDTH]).0[0] = self.register;
            }
            #[inline(always)]
            fn token(self) -> T {
                self.token
            }
            #[inline(always)]
            fn mul_add(self, factor: Self, summand: Self) -> Self {
                let product = self
                    .token
                    .$mul_add(self.register, factor.register, summand.register);
                Self::new(self.token, product)
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                Self::new(self.token, self.token.$sqrt(self.register))
            }
            #[inline(always)]
            fn abs(self) -> Self {
                Self::new(self.token, self.token.$abs(self.register))
            }
            #[inline(always)]
            fn less(self, other: Self) -> Self::Mask {
                self.token.$less(self.register, other.register)
            }
            #[inline(always)]
            fn select(self, mask: Self::Mask, other: Self) -> Self {
                let chosen = self.token.$select(mask, self.register, other.register);
                Self::new(self.token, chosen)
            }
            #[inline(always)]
            fn any(self, mask: Self::Mask) -> bool {
                self.token.$first_true(mask) < Self::WIDTH
            }
            #[inline(always)]
            fn extract(self, lane: usize) -> f64 {
                let mut lanes = [0.0; MOST_LANES];
                self.store(&mut lanes);
                assert!(lane < Self::WIDTH, "a lane beyond the width");
                f64::from(lanes[lane])
            }
            #[inline(always)]
            fn build(token: T, mut value: impl FnMut(usize) -> f64) -> Self {
                let mut lanes = [0.0; MOST_LANES];
                for lane in 0..Self::WIDTH {
                    lanes[lane] = value(lane) as $scalar;
                }
                Self::load(token, &lanes)
            }
            // If one of two numbers is NaN, the instructions of this family, unlike those of
            // others, return the second, as `Lane` requires.
            #[cfg(target_arch = "x86_64")]
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                Self::new(self.token, self.token.$min(self.register, other.register))
            }
            #[cfg(target_arch = "x86_64")]
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                Self::new(self.token, self.token.$max(self.register, other.register))
            }
            #[inline(always)]
            fn power_of_two(self) -> Self {
                let shifted = self + self.constant(1.5 / $scalar::EPSILON as f64);
                Self::new(self.token, $power_of_two(self.token, shifted.register))
            }
        }

        impl<T: Simd> BatchLane for $name<T> {
            #[inline(always)]
            fn positions(token: T) -> [usize; MOST_LANES] {
                let mut rows = [[0.0; 4]; MOST_LANES];
                for (position, row) in rows.iter_mut().enumerate() {
                    row[0] = position as $scalar;
                }
                let numbers = Self::components(token, &rows)[0];
                let mut positions = [0; MOST_LANES];
                for lane in 0..Self::WIDTH {
                    positions[lane] = numbers.extract(lane) as usize;
                }
                positions
            }
            #[inline(always)]
            fn components(token: T, rows: &Rows<$scalar>) -> [Self; 3] {
                let registers = T::$as_simd(rows[..Self::WIDTH].as_flattened()).0;
                let rows = [registers[0], registers[1], registers[2], registers[3]];
                let [x, y, z, _] = token.$deinterleave(rows);
                [
                    Self::new(token, x),
                    Self::new(token, y),
                    Self::new(token, z),
                ]
            }
            #[inline(always)]
            fn write_rows([x, y, z]: [Self; 3], rows: &mut Rows<$scalar>) {
                let zero = x.token.$splat(0.0);
                let transposed = x
                    .token
                    .$interleave([x.register, y.register, z.register, zero]);
                let registers = T::$as_mut_simd(rows[..Self::WIDTH].as_flattened_mut()).0;
                for i in 0..4 {
                    registers[i] = transposed[i];
                }
            }
        }
    };
}

wide_lane! {
    /// A SIMD register in double precision.
    WideF64, f64, f64s, m64s, F64_LANES,
    splat_f64s, add_f64s, sub_f64s, mul_f64s, div_f64s, neg_f64s, mul_add_f64s,
    sqrt_f64s, abs_f64s, less_than_f64s, select_f64s, first_true_m64s,
    as_simd_f64s, as_mut_simd_f64s, deinterleave_shfl_f64s, interleave_shfl_f64s,
    min_f64s, max_f64s, exponents_of_f64s
}

wide_lane! {
    /// A SIMD register in single precision.
    WideF32, f32, f32s, m32s, F32_LANES,
    splat_f32s, add_f32s, sub_f32s, mul_f32s, div_f32s, neg_f32s, mul_add_f32s,
    sqrt_f32s, abs_f32s, less_than_f32s, select_f32s, first_true_m32s,
    as_simd_f32s, as_mut_simd_f32s, deinterleave_shfl_f32s, interleave_shfl_f32s,
    min_f32s, max_f32s, exponents_of_f32s
}

/// Powers of two whose exponents are the integers in the last bits of a register.
#[inline(always)]
fn exponents_of_f32s<T: Simd>(token: T, shifted: T::f32s) -> T::f32s {
    let digits = token.splat_u32s(f32::MANTISSA_DIGITS - 1);
    let bits = token.wrapping_dyn_shl_u32s(token.transmute_u32s_f32s(shifted), digits);
    let bits = token.add_u32s(bits, token.splat_u32s(1.0_f32.to_bits()));
    token.transmute_f32s_u32s(bits)
}

/// The same in double precision, where the exponent is in the upper half of the bits: the lower half is moved
/// there, and the rest is masked.
#[inline(always)]
fn exponents_of_f64s<T: Simd>(token: T, shifted: T::f64s) -> T::f64s {
    let halves: T::u32s = pulp::bytemuck::cast(token.transmute_u64s_f64s(shifted));
    let halves = token.rotate_right_u32s(halves, 1);
    let digits = token.splat_u32s(f64::MANTISSA_DIGITS - 33);
    let bits = token.wrapping_dyn_shl_u32s(halves, digits);
    let bits = token.add_u32s(bits, token.splat_u32s((1.0_f64.to_bits() >> 32) as u32));
    let upper = token.splat_u64s(!0 << 32);
    let bits = token.and_u64s(pulp::bytemuck::cast(bits), upper);
    token.transmute_f64s_u64s(bits)
}

/// An operation on batches of elements, generic over the lane type.
pub(crate) trait BatchOperation<S: BatchScalar> {
    /// Its result.
    type Output;
    /// Runs the operation; implementations are `#[inline(always)]`.
    fn run<L: BatchLane<Scalar = S>>(self, token: L::Token) -> Self::Output;
}

/// The instruction set of a block.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lanes(Arch);

impl Lanes {
    /// The widest lanes of this processor, or one lane.
    pub(crate) fn new(width: LaneWidth) -> Self {
        match width {
            LaneWidth::Native => Self(Arch::new()),
            LaneWidth::One => Self(Arch::Scalar),
        }
    }
    /// Runs an operation.
    #[inline]
    pub(crate) fn dispatch<S: BatchScalar, O: BatchOperation<S>>(self, operation: O) -> O::Output {
        self.0.dispatch(Dispatched {
            operation,
            scalar: PhantomData::<S>,
        })
    }
    /// Number of elements per batch in a number format, and their lanes.
    pub(crate) fn arrangement<S: BatchScalar>(self) -> Arrangement {
        struct Arrange;
        impl<S: BatchScalar> BatchOperation<S> for Arrange {
            type Output = Arrangement;
            #[inline(always)]
            fn run<L: BatchLane<Scalar = S>>(self, token: L::Token) -> Arrangement {
                let element_in = L::positions(token);
                let mut lane_of = [0; MOST_LANES];
                for lane in 0..L::WIDTH {
                    lane_of[element_in[lane]] = lane;
                }
                Arrangement {
                    width: L::WIDTH,
                    element_in,
                    lane_of,
                }
            }
        }
        self.dispatch::<S, _>(Arrange)
    }
}

struct Dispatched<S, O> {
    operation: O,
    scalar: PhantomData<S>,
}

impl<S: BatchScalar, O: BatchOperation<S>> WithSimd for Dispatched<S, O> {
    type Output = O::Output;
    #[inline(always)]
    fn with_simd<T: Simd>(self, token: T) -> O::Output {
        if const { T::IS_SCALAR } {
            self.operation.run::<S>(())
        } else {
            self.operation.run::<S::Wide<T>>(token)
        }
    }
}

/// Arrangement of the elements of a batch in lanes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arrangement {
    /// Number of elements per batch.
    pub(crate) width: usize,
    /// The element of the batch in each lane.
    pub(crate) element_in: [usize; MOST_LANES],
    /// The lane of each element of the batch.
    pub(crate) lane_of: [usize; MOST_LANES],
}

impl Arrangement {
    /// Storage index of number `index` of `count` per element, for an element of a block.
    pub(crate) fn place(&self, element: usize, index: usize, count: usize) -> usize {
        let (batch, j) = (element / self.width, element % self.width);
        (batch * count + index) * self.width + self.lane_of[j]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Least and greatest, whole numbers and powers of two of a pack.
    struct Pick([f64; 2 * MOST_LANES]);

    impl<S: BatchScalar> BatchOperation<S> for Pick {
        type Output = Vec<f64>;
        #[inline(always)]
        fn run<L: BatchLane<Scalar = S>>(self, token: L::Token) -> Vec<f64> {
            let mut found = Vec::new();
            for start in (0..MOST_LANES).step_by(L::WIDTH) {
                let a = L::build(token, |lane| self.0[start + lane]);
                let b = L::build(token, |lane| self.0[MOST_LANES + start + lane]);
                let whole = a.min(a.constant(120.0)).max(a.constant(-120.0)).round();
                for result in [a.min(b), a.max(b), b.min(a), whole, whole.power_of_two()] {
                    found.extend((0..L::WIDTH).map(|lane| result.extract(lane)));
                }
            }
            found
        }
    }

    fn same_bits<S: BatchScalar>() {
        let special = [
            f64::NAN,
            f64::INFINITY,
            f64::NEG_INFINITY,
            0.0,
            -0.0,
            1.0,
            -2.5,
            99.5,
        ];
        let mut numbers = [0.0; 2 * MOST_LANES];
        for turn in 0..special.len() {
            for (index, number) in numbers.iter_mut().enumerate() {
                let turn = turn * (index / MOST_LANES);
                *number = special[(index + turn) % special.len()];
            }
            let wide = |lanes: Lanes| {
                let width = lanes.arrangement::<S>().width;
                let found = lanes.dispatch::<S, _>(Pick(numbers));
                // In the order of the input, whatever the width.
                let mut ordered = vec![0_u64; found.len()];
                for (index, number) in found.iter().enumerate() {
                    let (pack, rest) = (index / (5 * width), index % (5 * width));
                    let position = rest / width * MOST_LANES + pack * width + rest % width;
                    ordered[position] = number.to_bits();
                }
                ordered
            };
            assert_eq!(
                wide(Lanes::new(LaneWidth::Native)),
                wide(Lanes::new(LaneWidth::One)),
                "{turn}"
            );
        }
    }

    /// The least and the greatest of two numbers, whole numbers and powers of two are bitwise the same in wide lanes
    /// as in one, NaN included.
    #[test]
    fn operations_of_packs_have_the_bits_of_scalars() {
        same_bits::<f64>();
        same_bits::<f32>();
    }
}
