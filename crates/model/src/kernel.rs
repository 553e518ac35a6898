//! Element kernels, which compute one batch of elements in lanes.

use crate::{
    Absent, ElementKind, HistoryKernel, HourglassKernel, Lane, ModalKernel, Strain, Stress, Vec3,
};

/// Geometry numbers of one batch of elements, computed once by a kernel and read at every step.
///
/// They are lanes: a number is that of one element in each lane.
#[derive(Clone, Copy, Debug)]
pub struct Geometry<'a, L: Lane> {
    token: L::Token,
    numbers: &'a [L],
}

impl<'a, L: Lane> Geometry<'a, L> {
    /// A view of the numbers of a batch.
    #[inline(always)]
    pub fn new(token: L::Token, numbers: &'a [L]) -> Self {
        Self { token, numbers }
    }
    /// One geometry number of every lane.
    ///
    /// # Panics
    /// If the batch holds fewer numbers.
    #[inline(always)]
    pub fn get(&self, index: usize) -> L {
        self.numbers[index]
    }
    /// Three successive geometry numbers of every lane, such as a vector.
    ///
    /// # Panics
    /// If the batch holds fewer numbers.
    #[inline(always)]
    pub fn vector(&self, index: usize) -> [L; 3] {
        [self.get(index), self.get(index + 1), self.get(index + 2)]
    }
    /// Number with the same value in every lane.
    #[inline(always)]
    pub fn constant(&self, value: f64) -> L {
        L::splat(self.token, value)
    }
}

/// Moduli of the hourglass forces of a batch of elements, and the history on which the forces depend.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Hourglass<'a, L> {
    /// [`HourglassKernel::hourglass_moduli`] times the remaining share of the stiffness (Pa).
    pub moduli: [L; 3],
    /// Own history of the elements, as long as [`HistoryKernel::own_history`] says, or empty where it is all zero.
    pub history: &'a [L],
}

impl<'a, L: Lane> Hourglass<'a, L> {
    /// Hourglass forces with moduli (Pa), of elements without a history of their own.
    #[inline(always)]
    pub fn new(moduli: [L; 3]) -> Self {
        Self {
            moduli,
            history: &[],
        }
    }
    /// No hourglass forces, in the lanes of any value at hand.
    #[inline(always)]
    pub fn none(any: L) -> Self {
        Self::new([any.constant(0.0); 3])
    }
    /// The same with the own history of the elements.
    #[inline(always)]
    #[must_use]
    pub fn with_history(mut self, history: &'a [L]) -> Self {
        self.history = history;
        self
    }
}

/// A step of a batch of elements, from which their own history follows.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct OwnStep<'a, L, const N: usize, const P: usize> {
    /// Own history before the step.
    pub history: &'a [L],
    /// Modal displacements at the end of the step.
    pub modes: &'a [[L; 3]; N],
    /// Increments of the modal displacements in the step; zero where [`HourglassKernel::hourglass_moduli`] are none.
    pub moved: &'a [[L; 3]; N],
    /// Changes of stress at the points at the end of the step (Pa).
    pub stresses: &'a [Stress<L>; P],
    /// [`HourglassKernel::hourglass_moduli`] of the undamaged medium (Pa).
    pub moduli: [L; 3],
    /// Increment of the deviatoric elastic strain over that of the whole deviatoric strain, mean of the points, 0 to 1;
    /// one without plastic flow.
    pub elastic_share: L,
    /// Share of differences of stress within an element that plastic flow at its points leaves: as it holds the stress on the
    /// yield surface, `ds = 2 G (de - dp)` with `dp` along `s`, it relaxes all that differs from it by
    /// `|s| / (|s| + 2 G |dp|)`; one without plastic flow.
    pub kept: L,
}

impl<'a, L: Lane, const N: usize, const P: usize> OwnStep<'a, L, N, P> {
    /// An elastic step of elements without hourglass forces.
    #[inline(always)]
    pub fn new(history: &'a [L], modes: &'a [[L; 3]; N], stresses: &'a [Stress<L>; P]) -> Self {
        let one = modes[0][0].constant(1.0);
        Self {
            history,
            modes,
            moved: modes,
            stresses,
            moduli: [one.constant(0.0); 3],
            elastic_share: one,
            kept: one,
        }
    }
    /// The same with increments of the modal displacements, hourglass moduli (Pa), the elastic share of the strain
    /// increment and the share of differences of stress that are kept.
    #[inline(always)]
    #[must_use]
    pub fn with_flow(
        mut self,
        moved: &'a [[L; 3]; N],
        moduli: [L; 3],
        [elastic_share, kept]: [L; 2],
    ) -> Self {
        (self.moved, self.moduli) = (moved, moduli);
        (self.elastic_share, self.kept) = (elastic_share, kept);
        self
    }
}

/// Element kernel: the arithmetic of one element type on a batch of elements in lanes, without knowledge of
/// mesh and threads.
///
/// `N` is the number of nodes, `P` the number of integration points. A kernel computes geometry numbers
/// from corner positions once. At every step it maps nodal values to *modal* ones (a fixed linear map of
/// its choice, in which the arithmetic is short; the identity without [one](ElementKernel::modal)), modal values to strains at the
/// integration points, and stresses at the points to modal forces, which the transposed map turns into
/// nodal forces.
///
/// A bar of two nodes, as a kernel of one point:
/// ```
/// use powerhouse_model::{ElementKernel, ElementKind, Geometry, Hourglass, Lane, Strain, Stress, Vec3};
/// /// A bar along x with unit section.
/// #[derive(Clone)]
/// struct Bar;
/// impl ElementKernel<2, 1> for Bar {
///     fn name(&self) -> &'static str { "bar-x" }
///     fn kind(&self) -> ElementKind { ElementKind::Bar2 }
///     fn geometry_len(&self) -> usize { 1 }
///     fn geometry(&self, corners: &[Vec3; 2], out: &mut [f64]) { out[0] = corners[1].x - corners[0].x; }
///     fn point_positions(&self, corners: &[Vec3; 2]) -> [Vec3; 1] { [(corners[0] + corners[1]) / 2.0] }
///     fn volumes<L: Lane>(&self, geometry: Geometry<L>) -> [L; 1] { [geometry.get(0)] }
///     fn node_shares(&self, _corners: &[Vec3; 2]) -> [f64; 2] { [0.5, 0.5] }
///     fn strains<L: Lane>(&self, geometry: Geometry<L>, modes: &[[L; 3]; 2]) -> [Strain<L>; 1] {
///         let zero = geometry.constant(0.0);
///         [Strain([(modes[1][0] - modes[0][0]) / geometry.get(0), zero, zero, zero, zero, zero])]
///     }
///     fn forces<L: Lane>(&self, geometry: Geometry<L>, stresses: &[Stress<L>; 1], _hourglass: &Hourglass<L>, _modes: &[[L; 3]; 2]) -> [[L; 3]; 2] {
///         let (zero, force) = (geometry.constant(0.0), stresses[0].0[0]);
///         [[-force, zero, zero], [force, zero, zero]]
///     }
/// }
/// let stress = [Stress([3.0, 0.0, 0.0, 0.0, 0.0, 0.0])];
/// let forces = Bar.forces(Geometry::new((), &[2.0]), &stress, &Hourglass::none(0.0), &[[0.0_f64; 3]; 2]);
/// assert_eq!(forces, [[-3.0, 0.0, 0.0], [3.0, 0.0, 0.0]]);
/// ```
pub trait ElementKernel<const N: usize, const P: usize>: Clone + Send + Sync + 'static {
    /// The kernel's name in scenes and reports.
    fn name(&self) -> &'static str;
    /// The kind of elements that the kernel computes.
    fn kind(&self) -> ElementKind;
    /// Number of geometry numbers per element.
    fn geometry_len(&self) -> usize;
    /// Writes the geometry numbers of one element from its corners (m).
    fn geometry(&self, corners: &[Vec3; N], out: &mut [f64]);
    /// Positions of the integration points (m) of one element from its corners (m).
    fn point_positions(&self, corners: &[Vec3; N]) -> [Vec3; P];
    /// Volume of each integration point (m3): the weights of the quadrature; they sum to the volume of the
    /// element.
    fn volumes<L: Lane>(&self, geometry: Geometry<L>) -> [L; P];
    /// Shares of the element's mass that are lumped at its nodes; they sum to one.
    fn node_shares(&self, corners: &[Vec3; N]) -> [f64; N];
    /// Strains at the integration points from modal displacements, or strain rates from modal velocities.
    fn strains<L: Lane>(&self, geometry: Geometry<L>, modes: &[[L; 3]; N]) -> [Strain<L>; P];
    /// Modal internal forces (N): `sum_p B_p^T sigma_p V_p`, plus hourglass forces.
    ///
    /// Hourglass forces resist the part of the modal displacement `modes` that the integration points do not
    /// see, in proportion to the moduli of `hourglass`: [`hourglass_moduli`](HourglassKernel::hourglass_moduli) times the
    /// remaining share of them.
    fn forces<L: Lane>(
        &self,
        geometry: Geometry<L>,
        stresses: &[Stress<L>; P],
        hourglass: &Hourglass<L>,
        modes: &[[L; 3]; N],
    ) -> [[L; 3]; N];
    /// Its modes, a linear map of nodal values; none, the default, if the arithmetic is that of nodal values.
    #[inline(always)]
    fn modal(&self) -> Option<&impl ModalKernel<N, P>> {
        None::<&Absent>
    }
    /// Its resistance to deformation that the integration points do not see; none, the default, if they see every mode.
    #[inline(always)]
    fn hourglass(&self) -> Option<&impl HourglassKernel<N, P>> {
        None::<&Absent>
    }
    /// The history variables of its elements as a whole, beside those of the law at their points; none by default.
    #[inline(always)]
    fn history(&self) -> Option<&impl HistoryKernel<N, P>> {
        None::<&Absent>
    }
}
