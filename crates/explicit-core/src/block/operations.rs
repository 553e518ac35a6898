//! What a block does to all of its batches at a step.

use powerhouse_model::{ConstitutiveLaw, ElementKernel, Geometry, LawInput, Quad, Strain, Stress};

use super::transfer::{Batch, Batches, gather, gather_from, scatter};
use crate::lanes::{Arrangement, BatchLane, BatchOperation, BatchScalar, MOST_LANES};

/// Elastic constants of the undamaged material (Pa).
#[derive(Clone, Copy, Debug)]
pub(super) struct Moduli {
    pub(super) lambda: f64,
    pub(super) shear: f64,
}

impl Moduli {
    /// `lambda + 2 G`, which hourglass resistance is measured in.
    pub(super) fn constrained(self) -> f64 {
        self.lambda + 2.0 * self.shear
    }
    /// Both times a factor.
    pub(super) fn scaled(self, factor: f64) -> Self {
        Self {
            lambda: self.lambda * factor,
            shear: self.shear * factor,
        }
    }
}

/// Nodal displacement, and where strain is measured from.
#[derive(Clone, Copy)]
pub(super) struct Displacement<'a, A: BatchScalar> {
    /// By engine number.
    pub(super) nodes: &'a [Quad<A>],
    /// By place in the block.
    pub(super) reference: Option<&'a [Quad<f64>]>,
}

/// `modes + factor rates`.
#[inline(always)]
fn combined<L: BatchLane, const N: usize>(
    mut modes: [[L; 3]; N],
    factor: L,
    rates: &[[L; 3]; N],
) -> [[L; 3]; N] {
    for a in 0..N {
        for i in 0..3 {
            modes[a][i] = rates[a][i].mul_add(factor, modes[a][i]);
        }
    }
    modes
}

/// Zero as long as every stress seen is a number, NaN afterwards.
#[derive(Clone, Copy)]
struct Watch<L>(L);

impl<L: BatchLane> Watch<L> {
    #[inline(always)]
    fn see(&mut self, stress: &Stress<L>) {
        let sum = stress.0[0] + stress.0[1] + stress.0[2];
        self.0 = self.0 + (sum - sum);
    }
    #[inline(always)]
    fn all_finite(self) -> bool {
        (0..L::WIDTH).all(|lane| self.0.extract(lane) == 0.0)
    }
}

/// The elastic operator times `displacement + factor velocity`; yields whether all is finite.
pub(super) struct Elastic<'a, K, A: BatchScalar, S, const N: usize, const P: usize> {
    pub(super) kernel: &'a K,
    pub(super) batches: Batches<'a, S, N>,
    pub(super) moduli: Moduli,
    pub(super) displacement: Displacement<'a, A>,
    pub(super) damping: Option<(&'a [Quad<A>], f64)>,
    pub(super) out: &'a mut [Quad<A>],
}

impl<K, A, S, const N: usize, const P: usize> BatchOperation<S> for Elastic<'_, K, A, S, N, P>
where
    K: ElementKernel<N, P>,
    A: BatchScalar,
    S: BatchScalar,
{
    type Output = bool;
    #[inline(always)]
    fn run<L: BatchLane<Scalar = S>>(self, token: L::Token) -> bool {
        let lambda = L::splat(token, self.moduli.lambda);
        let shear = L::splat(token, self.moduli.shear);
        let modulus = L::splat(token, self.moduli.constrained());
        let mut rows = [[[S::default(); 4]; MOST_LANES]; N];
        let mut watch = Watch(L::splat(token, 0.0));
        for index in 0..self.batches.count(L::WIDTH) {
            let batch = self.batches.batch(index, L::WIDTH);
            let geometry = Geometry::<L>::new(token, batch.geometry);
            let Displacement { nodes, reference } = self.displacement;
            let nodal = gather_from::<A, L, N>(token, nodes, reference, &batch);
            let mut modes = self.kernel.modes(&nodal);
            if let Some((velocity, factor)) = self.damping {
                let rates = gather::<A, L, N>(token, velocity, batch.engine);
                let rates = self.kernel.modes(&rates);
                modes = combined(modes, L::splat(token, factor), &rates);
            }
            let strains = self.kernel.strains(geometry, &modes);
            let mut stresses = [Stress::zero(token); P];
            for p in 0..P {
                stresses[p] = Stress::elastic(lambda, shear, &strains[p]);
                watch.see(&stresses[p]);
            }
            let forces = self.kernel.forces(geometry, &stresses, modulus, &modes);
            let forces = self.kernel.nodal_forces(&forces);
            scatter::<A, L, N>(&forces, &batch, &mut rows, self.out);
        }
        watch.all_finite()
    }
}

/// What a law is told besides strain, for whole batches.
#[derive(Clone, Copy)]
pub(super) struct LawState<'a, S> {
    /// Six numbers per element, or empty.
    pub(super) initial: &'a [S],
    /// One number per element.
    pub(super) size: &'a [S],
    /// Numbers per point and element.
    pub(super) variables: usize,
    /// The committed history: variables of the points of a batch.
    pub(super) history: &'a [S],
    /// Where elements sit.
    pub(super) arrangement: Arrangement,
}

impl<S: BatchScalar> LawState<'_, S> {
    /// Stresses at the points of a batch; new histories go to `store(place, value)`.
    #[inline(always)]
    fn stresses<M, L, const P: usize>(
        &self,
        law: &M,
        token: L::Token,
        index: usize,
        strains: &[Strain<L>; P],
        (old, new): (&mut [L], &mut [L]),
        mut store: impl FnMut(usize, L),
    ) -> [Stress<L>; P]
    where
        M: ConstitutiveLaw,
        L: BatchLane<Scalar = S>,
    {
        let mut initial = Stress::zero(token);
        if !self.initial.is_empty() {
            for i in 0..6 {
                initial.0[i] = L::load(token, &self.initial[(6 * index + i) * L::WIDTH..]);
            }
        }
        let size = L::load(token, &self.size[index * L::WIDTH..]);
        let mut stresses = [initial; P];
        for p in 0..P {
            let place = (index * P + p) * self.variables;
            for h in 0..self.variables {
                old[h] = L::load(token, &self.history[(place + h) * L::WIDTH..]);
            }
            let input = LawInput::new(strains[p], old)
                .with_initial(initial)
                .with_size(size);
            stresses[p] = law.stress_change(&input, new);
            for h in 0..self.variables {
                store((place + h) * L::WIDTH, new[h]);
            }
        }
        stresses
    }
}

/// Forces of a law that is not linear; yields whether all is finite.
pub(super) struct Material<'a, K, M, A: BatchScalar, S, const N: usize, const P: usize> {
    pub(super) kernel: &'a K,
    pub(super) law: &'a M,
    pub(super) batches: Batches<'a, S, N>,
    pub(super) moduli: Moduli,
    pub(super) state: LawState<'a, S>,
    pub(super) displacement: Displacement<'a, A>,
    pub(super) damping: Option<(&'a [Quad<A>], f64)>,
    pub(super) new_history: &'a mut [S],
    pub(super) out: &'a mut [Quad<A>],
}

impl<K, M, A, S, const N: usize, const P: usize> BatchOperation<S>
    for Material<'_, K, M, A, S, N, P>
where
    K: ElementKernel<N, P>,
    M: ConstitutiveLaw,
    A: BatchScalar,
    S: BatchScalar,
{
    type Output = bool;
    #[inline(always)]
    fn run<L: BatchLane<Scalar = S>>(self, token: L::Token) -> bool {
        let modulus = L::splat(token, self.moduli.constrained());
        let mut rows = [[[S::default(); 4]; MOST_LANES]; N];
        let mut watch = Watch(L::splat(token, 0.0));
        let mut old = vec![L::splat(token, 0.0); self.state.variables];
        let mut new = old.clone();
        for index in 0..self.batches.count(L::WIDTH) {
            let batch = self.batches.batch(index, L::WIDTH);
            let geometry = Geometry::<L>::new(token, batch.geometry);
            let Displacement { nodes, reference } = self.displacement;
            let nodal = gather_from::<A, L, N>(token, nodes, reference, &batch);
            let mut modes = self.kernel.modes(&nodal);
            let strains = self.kernel.strains(geometry, &modes);
            let new_history = &mut *self.new_history;
            let mut stresses = self.state.stresses::<M, L, P>(
                self.law,
                token,
                index,
                &strains,
                (&mut old, &mut new),
                |place, value| value.store(&mut new_history[place..]),
            );
            if let Some((velocity, factor)) = self.damping {
                let rates = gather::<A, L, N>(token, velocity, batch.engine);
                let rates = self.kernel.modes(&rates);
                let viscous = self.moduli.scaled(factor);
                let lambda = L::splat(token, viscous.lambda);
                let shear = L::splat(token, viscous.shear);
                let strain_rates = self.kernel.strains(geometry, &rates);
                for p in 0..P {
                    stresses[p] = stresses[p] + Stress::elastic(lambda, shear, &strain_rates[p]);
                }
                modes = combined(modes, L::splat(token, factor), &rates);
            }
            for p in 0..P {
                watch.see(&stresses[p]);
            }
            if batch.active.is_some() {
                keep_history::<L, S, N>(&self.state, &batch, index, P, self.new_history);
            }
            let forces = self.kernel.forces(geometry, &stresses, modulus, &modes);
            let forces = self.kernel.nodal_forces(&forces);
            scatter::<A, L, N>(&forces, &batch, &mut rows, self.out);
        }
        watch.all_finite()
    }
}

/// Takes the history of inactive elements back.
#[inline(always)]
fn keep_history<L: BatchLane<Scalar = S>, S: BatchScalar, const N: usize>(
    state: &LawState<S>,
    batch: &Batch<S, N>,
    index: usize,
    points: usize,
    new_history: &mut [S],
) {
    let numbers = points * state.variables;
    for lane in 0..L::WIDTH {
        if batch.has(state.arrangement.element_in[lane]) {
            continue;
        }
        for number in 0..numbers {
            let place = (index * numbers + number) * L::WIDTH + lane;
            new_history[place] = state.history[place];
        }
    }
}

/// Stresses and strains at the points of one batch, handed to a [`Visitor`].
pub(super) struct PointFields<L, const N: usize, const P: usize> {
    /// Strains.
    pub(super) strains: [Strain<L>; P],
    /// Changes of stress (Pa).
    pub(super) stresses: [Stress<L>; P],
    /// Modal displacements.
    pub(super) modes: [[L; 3]; N],
}

/// Work on the fields of every batch.
pub(super) trait Visitor<S: BatchScalar, const N: usize, const P: usize> {
    /// Sees one batch.
    fn visit<L: BatchLane<Scalar = S>>(
        &mut self,
        token: L::Token,
        batch: &Batch<S, N>,
        fields: &PointFields<L, N, P>,
    );
}

/// Shows a visitor the fields of every batch under the committed history.
pub(super) struct Visit<'a, K, M, A: BatchScalar, S, V, const N: usize, const P: usize> {
    pub(super) kernel: &'a K,
    pub(super) law: &'a M,
    pub(super) batches: Batches<'a, S, N>,
    pub(super) moduli: Moduli,
    pub(super) state: LawState<'a, S>,
    pub(super) displacement: Displacement<'a, A>,
    pub(super) visitor: &'a mut V,
}

impl<K, M, A, S, V, const N: usize, const P: usize> BatchOperation<S>
    for Visit<'_, K, M, A, S, V, N, P>
where
    K: ElementKernel<N, P>,
    M: ConstitutiveLaw,
    A: BatchScalar,
    S: BatchScalar,
    V: Visitor<S, N, P>,
{
    type Output = ();
    #[inline(always)]
    fn run<L: BatchLane<Scalar = S>>(self, token: L::Token) {
        let lambda = L::splat(token, self.moduli.lambda);
        let shear = L::splat(token, self.moduli.shear);
        let linear = self.law.is_linear();
        let mut old = vec![L::splat(token, 0.0); self.state.variables];
        let mut new = old.clone();
        for index in 0..self.batches.count(L::WIDTH) {
            let batch = self.batches.batch(index, L::WIDTH);
            let geometry = Geometry::<L>::new(token, batch.geometry);
            let Displacement { nodes, reference } = self.displacement;
            let nodal = gather_from::<A, L, N>(token, nodes, reference, &batch);
            let modes = self.kernel.modes(&nodal);
            let strains = self.kernel.strains(geometry, &modes);
            let mut stresses = [Stress::zero(token); P];
            if linear {
                for p in 0..P {
                    stresses[p] = Stress::elastic(lambda, shear, &strains[p]);
                }
            } else {
                stresses = self.state.stresses::<M, L, P>(
                    self.law,
                    token,
                    index,
                    &strains,
                    (&mut old, &mut new),
                    |_, _| (),
                );
            }
            let fields = PointFields {
                strains,
                stresses,
                modes,
            };
            self.visitor.visit::<L>(token, &batch, &fields);
        }
    }
}
