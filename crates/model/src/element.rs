//! Elements: arithmetic on a batch, and blocks of them behind one virtual call.

use crate::{
    ElementKind, HistoryField, Lane, Mat3, NodalView, NodalViewMut, Quad, Strain, Stress, Vec3,
};

/// The geometry numbers of one batch of elements, read where they are used.
///
/// Number `i` of all lanes lies at `numbers[i * WIDTH..(i + 1) * WIDTH]`.
#[derive(Clone, Copy, Debug)]
pub struct Geometry<'a, L: Lane> {
    token: L::Token,
    numbers: &'a [L::Scalar],
}

impl<'a, L: Lane> Geometry<'a, L> {
    /// A view of stored numbers.
    #[inline(always)]
    pub fn new(token: L::Token, numbers: &'a [L::Scalar]) -> Self {
        Self { token, numbers }
    }
    /// One number of every lane.
    ///
    /// # Panics
    /// If the batch holds fewer numbers.
    #[inline(always)]
    pub fn get(&self, index: usize) -> L {
        L::load(
            self.token,
            &self.numbers[index * L::WIDTH..(index + 1) * L::WIDTH],
        )
    }
    /// Three successive numbers, such as a vector.
    ///
    /// # Panics
    /// If the batch holds fewer numbers.
    #[inline(always)]
    pub fn vector(&self, index: usize) -> [L; 3] {
        [self.get(index), self.get(index + 1), self.get(index + 2)]
    }
    /// The same number in every lane.
    #[inline(always)]
    pub fn constant(&self, value: f64) -> L {
        L::splat(self.token, value)
    }
}

/// Element arithmetic on one batch of lanes: it knows no mesh and no thread.
///
/// `N` is the number of nodes, `P` the number of integration points. A kernel turns corner
/// positions into geometry numbers once. At every step it turns nodal values into *modal* ones
/// (a fixed linear map of its choice, in which the arithmetic is short; the identity by default),
/// modal values into strains at the points, and stresses at the points into modal forces, which
/// the transposed map turns into nodal forces.
///
/// A bar of two nodes, as a kernel of one point:
/// ```
/// use powerhouse_model::{ElementKernel, ElementKind, Geometry, Lane, Strain, Stress, Vec3};
/// /// A bar along x with unit section.
/// #[derive(Clone)]
/// struct Bar;
/// impl ElementKernel<2, 1> for Bar {
///     fn name(&self) -> &'static str { "bar-x" }
///     fn kind(&self) -> ElementKind { ElementKind::Bar2 }
///     fn geometry_len(&self) -> usize { 1 }
///     fn geometry(&self, corners: &[Vec3; 2], out: &mut [f64]) { out[0] = corners[1].x - corners[0].x; }
///     fn volumes<L: Lane>(&self, geometry: Geometry<L>) -> [L; 1] { [geometry.get(0)] }
///     fn node_shares(&self, _corners: &[Vec3; 2]) -> [f64; 2] { [0.5, 0.5] }
///     fn strains<L: Lane>(&self, geometry: Geometry<L>, modes: &[[L; 3]; 2]) -> [Strain<L>; 1] {
///         let zero = geometry.constant(0.0);
///         [Strain([(modes[1][0] - modes[0][0]) / geometry.get(0), zero, zero, zero, zero, zero])]
///     }
///     fn forces<L: Lane>(&self, geometry: Geometry<L>, stresses: &[Stress<L>; 1], _modulus: L, _modes: &[[L; 3]; 2]) -> [[L; 3]; 2] {
///         let (zero, force) = (geometry.constant(0.0), stresses[0].0[0]);
///         [[-force, zero, zero], [force, zero, zero]]
///     }
/// }
/// let stress = [Stress([3.0, 0.0, 0.0, 0.0, 0.0, 0.0])];
/// let forces = Bar.forces(Geometry::new((), &[2.0]), &stress, 0.0, &[[0.0_f64; 3]; 2]);
/// assert_eq!(forces, [[-3.0, 0.0, 0.0], [3.0, 0.0, 0.0]]);
/// ```
pub trait ElementKernel<const N: usize, const P: usize>: Clone + Send + Sync + 'static {
    /// The kernel's name in scenes and reports.
    fn name(&self) -> &'static str;
    /// The kind of element that it computes.
    fn kind(&self) -> ElementKind;
    /// How many geometry numbers an element has.
    fn geometry_len(&self) -> usize;
    /// The geometry numbers of one element from its corners (m).
    fn geometry(&self, corners: &[Vec3; N], out: &mut [f64]);
    /// The volume that each integration point stands for (m3).
    fn volumes<L: Lane>(&self, geometry: Geometry<L>) -> [L; P];
    /// The share of the element's volume that lumps at each node; sums to one.
    fn node_shares(&self, corners: &[Vec3; N]) -> [f64; N];
    /// Modal values from nodal values, `T u`.
    #[inline(always)]
    fn modes<L: Lane>(&self, nodal: &[[L; 3]; N]) -> [[L; 3]; N] {
        *nodal
    }
    /// Nodal forces from modal forces, `T^T F`.
    #[inline(always)]
    fn nodal_forces<L: Lane>(&self, modal: &[[L; 3]; N]) -> [[L; 3]; N] {
        *modal
    }
    /// Strains at the points from modal displacements, or strain rates from modal velocities.
    fn strains<L: Lane>(&self, geometry: Geometry<L>, modes: &[[L; 3]; N]) -> [Strain<L>; P];
    /// Modal forces (N): `sum_p B_p^T sigma_p V_p`, plus what resists the part of the modal
    /// displacement `modes` that the points do not see (hourglass), for a medium of which
    /// [`hourglass_modulus`](Self::hourglass_modulus) is `modulus` (Pa); less of it where the law has
    /// less stiffness left.
    fn forces<L: Lane>(
        &self,
        geometry: Geometry<L>,
        stresses: &[Stress<L>; P],
        modulus: L,
        modes: &[[L; 3]; N],
    ) -> [[L; 3]; N];
    /// The modulus (Pa) that hourglass resistance is proportional to, of a medium with `lambda + 2 G` and
    /// `G` (Pa); none, the default, if the points see every mode.
    fn hourglass_modulus(&self, _constrained: f64, _shear: f64) -> Option<f64> {
        None
    }
    /// The energy (J) held by the hourglass resistance of [`forces`](Self::forces), or `None` if
    /// the points see every mode.
    #[inline(always)]
    fn hourglass_energy<L: Lane>(
        &self,
        _geometry: Geometry<L>,
        _modulus: L,
        _modes: &[[L; 3]; N],
    ) -> Option<L> {
        None
    }
}

/// What a block is told at a step. Fields may be added.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct BlockContext<'a> {
    /// Time (s).
    pub time: f64,
    /// Step number.
    pub number: u64,
    /// Length of the step (s).
    pub step: f64,
    /// Displacement (m), engine numbering.
    pub displacement: NodalView<'a>,
    /// Velocity half a step before `time` (m/s), engine numbering.
    pub velocity: NodalView<'a>,
    /// Added to the stiffness damping coefficient of every block (s); negative in the paper's
    /// one-sided scheme.
    pub damping_shift: f64,
    /// Whether the block must account for its energies in this step.
    pub ledger: bool,
    /// Whether history variables may be updated in place: nothing but a commit follows these forces, neither
    /// others from the same committed history nor a question about it.
    pub once: bool,
}

impl<'a> BlockContext<'a> {
    /// A context at a time, for engines and tests.
    pub fn new(
        (number, time, step): (u64, f64, f64),
        displacement: NodalView<'a>,
        velocity: NodalView<'a>,
    ) -> Self {
        Self {
            time,
            number,
            step,
            displacement,
            velocity,
            damping_shift: 0.0,
            ledger: false,
            once: false,
        }
    }
    /// The same with or without a commit as the only thing that follows.
    #[must_use]
    pub fn with_once(mut self, once: bool) -> Self {
        self.once = once;
        self
    }
    /// The same with the stiffness damping shifted (s).
    #[must_use]
    pub fn with_damping_shift(mut self, shift: f64) -> Self {
        self.damping_shift = shift;
        self
    }
    /// The same with or without the energy account.
    #[must_use]
    pub fn with_ledger(mut self, ledger: bool) -> Self {
        self.ledger = ledger;
        self
    }
}

/// A linear operator of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operator {
    /// Initial stiffness.
    Elastic,
    /// Stress over strain in the static state of the last forces, those of a step of no length.
    Secant,
    /// Derivative of stress in that state.
    Tangent,
}

/// Energies of a block (J).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BlockEnergy {
    /// Recoverable.
    pub elastic: f64,
    /// Held by hourglass resistance, and taken where that fell with the stiffness of the law.
    pub hourglass: f64,
    /// Dissipated by plastic flow, accumulated.
    pub plastic: f64,
    /// Dissipated by damage, accumulated.
    pub damage: f64,
    /// Given back by stiffness that closing cracks regain, accumulated; not positive.
    pub recovery: f64,
    /// Work of stresses beyond what their laws say they hold, take and give back, accumulated: the
    /// flow of a step counts with the stress at its end, its work with the mean. It falls with
    /// the step.
    pub integration: f64,
    /// Dissipated by stiffness damping, accumulated.
    pub damping: f64,
    /// Dissipated and stored by relaxation mechanisms, accumulated.
    pub relaxation: f64,
}

impl core::ops::AddAssign for BlockEnergy {
    fn add_assign(&mut self, other: Self) {
        self.elastic += other.elastic;
        self.hourglass += other.hourglass;
        self.plastic += other.plastic;
        self.damage += other.damage;
        self.recovery += other.recovery;
        self.integration += other.integration;
        self.damping += other.damping;
        self.relaxation += other.relaxation;
    }
}

impl BlockEnergy {
    /// The sum of all columns (J).
    pub fn total(&self) -> f64 {
        self.elastic
            + self.hourglass
            + self.plastic
            + self.damage
            + self.recovery
            + self.integration
            + self.damping
            + self.relaxation
    }
}

/// Which term sets an element's bound.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LimitingTerm {
    /// The element's own stiffness and mass.
    Stiffness,
    /// Its stiffness damping.
    StiffnessDamping,
    /// Its mass damping, far beyond critical.
    MassDamping,
}

/// The highest natural frequency that one element can have alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrequencyBound {
    /// Mesh index of the element.
    pub element: u32,
    /// Bound on the angular frequency (rad/s), from the eigenvalue of the actual kernel.
    pub frequency: f64,
    /// Stiffness damping coefficient of the element (s).
    pub stiffness_damping: f64,
}

/// An element could not be computed.
#[derive(Clone, Debug, PartialEq)]
pub struct ElementFault {
    /// Mesh index of the element.
    pub element: u32,
    /// Why.
    pub reason: String,
}

/// How an engine numbers nodes.
#[derive(Clone, Debug, Default)]
pub struct Numbering {
    /// Engine number of each mesh node (and of additional nodes after them).
    pub engine_of: Vec<u32>,
    /// Mesh index of each engine node.
    pub mesh_of: Vec<u32>,
}

/// Elements of one set with one kernel, one law and one lane, behind one virtual call per step.
///
/// A block is also the unit of parallel work: an engine splits a large set into blocks and calls
/// them side by side. It reads nodes in engine numbering and writes the forces of its own nodes,
/// so that their sum has a fixed order whatever the number of threads. Blocks carry a level
/// (local time steps) and an owner (rank or device), today always zero.
///
/// A massless block that pulls one node to its place:
/// ```
/// use powerhouse_model::*;
/// struct Anchor { nodes: Vec<u32>, stiffness: f64 }
/// impl ElementBlock for Anchor {
///     fn label(&self) -> &str { "anchor" }
///     fn elements(&self) -> &[u32] { &[] }
///     fn nodes(&self) -> &[u32] { &self.nodes }
///     fn forces(&mut self, context: &BlockContext, out: NodalViewMut) -> Result<(), ElementFault> {
///         self.apply(Operator::Elastic, context.displacement, out);
///         Ok(())
///     }
///     fn commit(&mut self) {}
///     fn apply(&self, _operator: Operator, x: NodalView, out: NodalViewMut) {
///         let force = x.vector(self.nodes[0] as usize) * self.stiffness;
///         match out {
///             NodalViewMut::F64(out) => out[0] = Quad::from_vector(&force),
///             NodalViewMut::F32(out) => out[0] = Quad::from_vector(&force),
///         }
///     }
///     fn diagonal(&self, _operator: Operator, out: &mut [Mat3]) { out[0] += Mat3::identity() * self.stiffness; }
///     fn add_mass(&self, _out: &mut [f64]) {}
///     fn frequency_bounds(&self) -> Vec<FrequencyBound> { Vec::new() }
///     fn stiffness_damping(&self) -> f64 { 0.0 }
///     fn mass_damping(&self) -> f64 { 0.0 }
///     fn set_active(&mut self, _active: &[bool]) {}
///     fn set_reference_displacement(&mut self, _displacement: NodalView) {}
///     fn set_initial_stress(&mut self, _stress: &[Stress]) {}
///     fn add_stress(&self, _displacement: NodalView, _out: &mut [Stress]) {}
///     fn energy(&self, context: &BlockContext) -> BlockEnergy {
///         let u = context.displacement.vector(self.nodes[0] as usize);
///         BlockEnergy { elastic: 0.5 * self.stiffness * u.norm_squared(), ..BlockEnergy::default() }
///     }
///     fn history(&self) -> Vec<HistoryField> { Vec::new() }
///     fn set_history(&mut self, _fields: &[HistoryField]) {}
/// }
/// ```
pub trait ElementBlock: Send + Sync {
    /// The element set that the block belongs to.
    fn label(&self) -> &str;
    /// Mesh indices of its elements, in its own order.
    fn elements(&self) -> &[u32];
    /// Engine numbers of the nodes that it touches; forces are written in this order.
    fn nodes(&self) -> &[u32];
    /// The level of local time stepping: the block steps with `dt / 2^level`.
    fn level(&self) -> u8 {
        0
    }
    /// The rank or device that owns the block.
    fn owner(&self) -> u32 {
        0
    }
    /// Writes the internal forces (N), stiffness damping included, of every node of the block;
    /// they resist the motion. Computes, but does not commit, the new history.
    ///
    /// # Errors
    /// If an element's strain is not finite or its law fails.
    fn forces(&mut self, context: &BlockContext, out: NodalViewMut) -> Result<(), ElementFault>;
    /// Makes the history of the last [`forces`](Self::forces) the old one.
    fn commit(&mut self);
    /// Writes the operator times a nodal vector, for every node of the block.
    fn apply(&self, operator: Operator, x: NodalView, out: NodalViewMut);
    /// Adds the 3 x 3 diagonal blocks of the operator, in the order of [`nodes`](Self::nodes).
    fn diagonal(&self, operator: Operator, out: &mut [Mat3]);
    /// Shows the matrices that the operator is the sum of, one after another: engine numbers of the
    /// nodes that a matrix couples, and its entries (N/m), row by row, three rows and three columns
    /// per node.
    ///
    /// By default the block is one matrix of all its nodes, each column an [`apply`](Self::apply):
    /// right for a few nodes, too much for many.
    fn each_matrix(&self, operator: Operator, show: &mut dyn FnMut(&[u32], &[f64])) {
        let nodes = self.nodes();
        let count = nodes.iter().max().map_or(0, |&most| most as usize + 1);
        let mut unit = vec![Quad::<f64>::default(); count];
        let mut forces = vec![Quad::<f64>::default(); nodes.len()];
        let size = 3 * nodes.len();
        let mut matrix = vec![0.0; size * size];
        for column in 0..size {
            let node = nodes[column / 3] as usize;
            unit[node].values[column % 3] = 1.0;
            self.apply(
                operator,
                NodalView::F64(&unit),
                NodalViewMut::F64(&mut forces),
            );
            unit[node].values[column % 3] = 0.0;
            for row in 0..size {
                matrix[row * size + column] = forces[row / 3].values[row % 3];
            }
        }
        show(nodes, &matrix);
    }
    /// Adds lumped masses (kg), in the order of [`nodes`](Self::nodes).
    fn add_mass(&self, out: &mut [f64]);
    /// The bound of each element.
    fn frequency_bounds(&self) -> Vec<FrequencyBound>;
    /// The stiffness damping coefficient (s).
    fn stiffness_damping(&self) -> f64;
    /// The mass damping coefficient (1/s).
    fn mass_damping(&self) -> f64;
    /// Switches elements on and off, in the order of [`elements`](Self::elements).
    fn set_active(&mut self, active: &[bool]);
    /// From now on strain, hourglass included, is measured from this displacement (engine
    /// numbering): what is cast later is stress-free in the deformed state.
    fn set_reference_displacement(&mut self, displacement: NodalView);
    /// Sets the initial stress (Pa), in the order of [`elements`](Self::elements).
    fn set_initial_stress(&mut self, stress: &[Stress]);
    /// Adds the nodal forces (N) of stresses (Pa) that are the same all over each element, given in
    /// the order of [`elements`](Self::elements), in the order of [`nodes`](Self::nodes): what an
    /// initial stress asks of the nodes. None by default, for blocks that bear no initial stress.
    fn add_forces_of(&self, _stress: &[Stress], _out: &mut [Vec3]) {}
    /// Adds the mean change of stress (Pa) of each element under the committed history, in the
    /// order of [`elements`](Self::elements).
    fn add_stress(&self, displacement: NodalView, out: &mut [Stress]);
    /// Writes the internal forces (N) of the element at a place of [`elements`](Self::elements) at its
    /// nodes, in the mesh's order: those of its change of stress under the committed history on top of an
    /// initial stress (Pa), and of hourglass resistance, without stiffness damping. Yields whether they are
    /// known; they are not by default.
    fn element_forces(
        &self,
        _place: usize,
        _displacement: NodalView,
        _initial: &Stress,
        _out: &mut [Vec3],
    ) -> bool {
        false
    }
    /// Energies at the context's displacement (elastic, hourglass) and accumulated ones.
    fn energy(&self, context: &BlockContext) -> BlockEnergy;
    /// The committed history, by name.
    fn history(&self) -> Vec<HistoryField>;
    /// Takes over what belongs to its elements.
    fn set_history(&mut self, fields: &[HistoryField]);
    /// What the element at a place of [`elements`](Self::elements) shows of a history variable,
    /// as of the last [`forces`](Self::forces), committed or not; none if its law has no such
    /// variable. By default the mean over the points of the committed
    /// [`history`](Self::history).
    fn shown_history(&self, place: usize, variable: &str) -> Option<f64> {
        let fields = self.history();
        let field = fields.iter().find(|field| field.name == variable)?;
        let values = field
            .values
            .get(place * field.points..(place + 1) * field.points)?;
        Some(values.iter().sum::<f64>() / field.points as f64)
    }
}
