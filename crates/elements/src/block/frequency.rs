//! Highest natural frequency of single elements.

use powerhouse_model::{ElementKernel, Geometry, Hourglass, KernelArithmetic, Lane, Stress, Vec3};

use super::operations::Moduli;
use crate::lanes::{BatchLane, BatchOperation, MOST_LANES};

/// Relative margin that is added to the computed eigenvalue: well above its round-off error (about 1e-14),
/// well below any influence on the step.
const MARGIN: f64 = 1e-9;

/// Computation of the square of the highest angular frequency (1/s2) of each element with its lumped masses.
///
/// Lanczos iteration with `M^-1/2 K M^-1/2` of the kernel in use, reorthogonalised and complete: `K` has
/// rank `3 N - 6` at most, so that after as many vectors of its range the tridiagonal matrix has every
/// eigenvalue. The largest one is bracketed by bisection with Sturm sequences, and the upper end is used.
pub(super) struct HighestSquares<'a, K, const N: usize, const P: usize> {
    pub(super) kernel: &'a K,
    pub(super) moduli: Moduli,
    /// Corner positions (m) and lumped masses (kg) of each element.
    pub(super) elements: &'a [([Vec3; N], [f64; N])],
}

impl<K, const N: usize, const P: usize> BatchOperation<f64> for HighestSquares<'_, K, N, P>
where
    K: ElementKernel<N, P>,
{
    type Output = Vec<f64>;
    #[inline(always)]
    fn run<L: BatchLane<Scalar = f64>>(self, token: L::Token) -> Vec<f64> {
        let mut squares = Vec::with_capacity(self.elements.len());
        let length = self.kernel.geometry_len();
        let mut one = vec![0.0; length];
        let mut rows = vec![[0.0; MOST_LANES]; length];
        let mut numbers = vec![L::splat(token, 0.0); length];
        let mut workspace = Workspace::new(L::splat(token, 0.0));
        for batch in self.elements.chunks(L::WIDTH) {
            let element = |lane: usize| &batch[lane.min(batch.len() - 1)];
            for lane in 0..L::WIDTH {
                self.kernel.geometry(&element(lane).0, &mut one);
                for (row, number) in rows.iter_mut().zip(&one) {
                    row[lane] = *number;
                }
            }
            for (number, row) in numbers.iter_mut().zip(&rows) {
                *number = L::load(token, row);
            }
            let mut scale = [L::splat(token, 0.0); N];
            for (a, scale) in scale.iter_mut().enumerate() {
                let mut masses = [0.0; MOST_LANES];
                for (lane, mass) in masses.iter_mut().enumerate() {
                    *mass = element(lane).1[a];
                }
                *scale = L::splat(token, 1.0) / L::load(token, &masses).sqrt();
            }
            let operator = Operator {
                kernel: self.kernel,
                geometry: Geometry::new(token, &numbers),
                lambda: L::splat(token, self.moduli.lambda),
                shear: L::splat(token, self.moduli.shear),
                moduli: self.moduli.hourglass::<L>(token),
                scale,
            };
            tridiagonalise(&operator, &mut workspace);
            let largest = largest_eigenvalue(&workspace);
            let mut lanes = [0.0; MOST_LANES];
            largest.store(&mut lanes);
            squares.extend(lanes[..batch.len()].iter().map(|l| l * (1.0 + MARGIN)));
        }
        squares
    }
}

/// Mass-scaled stiffness `M^-1/2 K M^-1/2` of a batch of elements.
struct Operator<'a, K, L: Lane, const N: usize> {
    kernel: &'a K,
    geometry: Geometry<'a, L>,
    lambda: L,
    shear: L,
    moduli: [L; 3],
    scale: [L; N],
}

impl<K, L: Lane, const N: usize> Operator<'_, K, L, N> {
    #[inline(always)]
    fn times<const P: usize>(&self, vector: &[[L; 3]; N]) -> [[L; 3]; N]
    where
        K: ElementKernel<N, P>,
    {
        let modes = self.kernel.modes(&self.scaled(vector));
        let strains = self.kernel.strains(self.geometry, &modes);
        let mut stresses = [Stress([self.lambda; 6]); P];
        for p in 0..P {
            stresses[p] = Stress::elastic(self.lambda, self.shear, &strains[p]);
        }
        let hourglass = Hourglass::new(self.moduli);
        let forces = (self.kernel).forces(self.geometry, &stresses, &hourglass, &modes);
        self.scaled(&self.kernel.nodal_forces(&forces))
    }
    #[inline(always)]
    fn scaled(&self, vector: &[[L; 3]; N]) -> [[L; 3]; N] {
        let mut scaled = *vector;
        for a in 0..N {
            for i in 0..3 {
                scaled[a][i] = vector[a][i] * self.scale[a];
            }
        }
        scaled
    }
}

/// Vectors and coefficients of the Lanczos recurrence.
struct Workspace<L, const N: usize> {
    basis: Vec<[[L; 3]; N]>,
    diagonal: Vec<L>,
    /// Squares of the off-diagonal elements.
    squares: Vec<L>,
    zero: L,
}

impl<L: Lane, const N: usize> Workspace<L, N> {
    #[inline(always)]
    fn new(zero: L) -> Self {
        Self {
            basis: Vec::with_capacity(3 * N - 6),
            diagonal: Vec::with_capacity(3 * N - 6),
            squares: Vec::with_capacity(3 * N - 6),
            zero,
        }
    }
}

#[inline(always)]
fn inner<L: Lane, const N: usize>(x: &[[L; 3]; N], y: &[[L; 3]; N]) -> L {
    let mut sum = x[0][0] * y[0][0];
    for k in 1..3 * N {
        sum = x[k / 3][k % 3].mul_add(y[k / 3][k % 3], sum);
    }
    sum
}

/// Unit vector `x / |x|`, or zero where `|x|` is not above `least`, and `|x|^2`.
#[inline(always)]
fn normalised<L: Lane, const N: usize>(x: &[[L; 3]; N], least: L) -> ([[L; 3]; N], L) {
    let zero = x[0][0].constant(0.0);
    let square = inner(x, x);
    let norm = square.sqrt();
    let present = least.less(norm);
    let inverse = (norm.constant(1.0) / norm).select(present, zero);
    let mut y = *x;
    for a in 0..N {
        for i in 0..3 {
            y[a][i] = x[a][i] * inverse;
        }
    }
    (y, square.select(present, zero))
}

#[inline(always)]
fn tridiagonalise<K, L, const N: usize, const P: usize>(
    operator: &Operator<K, L, N>,
    workspace: &mut Workspace<L, N>,
) where
    K: ElementKernel<N, P>,
    L: Lane,
{
    let zero = workspace.zero;
    workspace.basis.clear();
    workspace.diagonal.clear();
    workspace.squares.clear();
    // Any fixed vector without symmetry; the operator maps it into its range.
    let mut start = [[zero; 3]; N];
    let mut state = 0.5;
    for a in 0..N {
        for i in 0..3 {
            state = 3.99 * state * (1.0 - state) + 1e-3;
            start[a][i] = zero.constant(state - 0.4);
        }
    }
    let start = operator.times(&start);
    let (mut vector, _) = normalised(&start, zero);
    let mut least = zero;
    for step in 0..3 * N - 6 {
        let mut next = operator.times(&vector);
        let diagonal = inner(&vector, &next);
        if step == 0 {
            least = inner(&next, &next).sqrt() * zero.constant(1e-13);
        }
        workspace.diagonal.push(diagonal);
        workspace.basis.push(vector);
        for _twice in 0..2 {
            for known in &workspace.basis {
                let share = inner(known, &next);
                for a in 0..N {
                    for i in 0..3 {
                        next[a][i] = next[a][i] - share * known[a][i];
                    }
                }
            }
        }
        let (following, square) = normalised(&next, least);
        vector = following;
        workspace.squares.push(square);
    }
}

/// Upper end of a bracket of the largest eigenvalue.
#[inline(always)]
fn largest_eigenvalue<L: Lane, const N: usize>(workspace: &Workspace<L, N>) -> L {
    let zero = workspace.zero;
    let count = workspace.diagonal.len();
    let tiny = zero.constant(f64::MIN_POSITIVE);
    // Gershgorin's bound above, the largest diagonal element below.
    let mut low = zero;
    let mut high = tiny;
    let mut before = zero;
    for k in 0..count {
        let after = if k + 1 < count {
            workspace.squares[k].sqrt()
        } else {
            zero
        };
        low = low.max(workspace.diagonal[k]);
        high = high.max(workspace.diagonal[k] + before + after);
        before = after;
    }
    for _halving in 0..48 {
        let middle = (low + high) * zero.constant(0.5);
        // All eigenvalues are below the middle if the Sturm sequence stays negative.
        let mut most = -tiny;
        let mut pivot = -tiny;
        for k in 0..count {
            let square = if k == 0 {
                zero
            } else {
                workspace.squares[k - 1]
            };
            pivot = workspace.diagonal[k] - middle - square / pivot;
            most = most.max(pivot);
        }
        let below = most.less(zero);
        high = middle.select(below, high);
        low = low.select(below, middle);
    }
    high
}
