//! Blocks of elements, behind which an engine knows neither kernels nor laws.

use crate::{
    HistoryField, Mat3, NodalView, NodalViewMut, Program, ProgramError, Quad, StateError, StepTime,
    Stress, Vec3,
};

/// Storage of the new history variables of a force evaluation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum HistoryUpdate {
    /// New history variables are stored beside the committed ones, so that further forces, stresses and
    /// energies of the same step start from the committed ones.
    #[default]
    Buffered,
    /// New history variables may overwrite the committed ones, because the next operation is a commit:
    /// a step then touches half of the memory.
    InPlace,
}

/// Input of a block of elements at a time step: motion of the block's nodes, and what the step requires.
///
/// Nodal values are those of the block alone, in the order of [`ElementBlock::nodes`]. Fields may be added.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct BlockContext<'a> {
    /// Time at which the displacement is given (s); the velocity is that of half a step before.
    pub time: f64,
    /// Number of time steps taken before this one in the run.
    pub number: u64,
    /// Length of the step (s); zero for static forces.
    pub step: f64,
    /// Displacement (m) of the block's nodes.
    pub displacement: NodalView<'a>,
    /// Velocity half a step before `time` (m/s) of the block's nodes; empty where the block does not
    /// [read it](ElementBlock::reads_velocity).
    pub velocity: NodalView<'a>,
    /// Addition to the stiffness damping coefficient of every block (s); negative in the paper's
    /// one-sided scheme.
    pub damping_shift: f64,
    /// Whether the block must account for its energies in this step.
    pub ledger: bool,
    /// Where the block stores new history variables.
    pub history_update: HistoryUpdate,
    /// Whether the body rests, so that elements with numbers of their own bring these to equilibrium, whatever the length of the
    /// step; otherwise they follow step by step.
    pub rests: bool,
}

impl<'a> BlockContext<'a> {
    /// A context of a step, a displacement (m) and a velocity (m/s), without energy bookkeeping, with
    /// buffered history variables; of a body that rests if the step is zero.
    pub fn new(when: StepTime, displacement: NodalView<'a>, velocity: NodalView<'a>) -> Self {
        let StepTime { number, time, step } = when;
        Self {
            time,
            number,
            step,
            displacement,
            velocity,
            damping_shift: 0.0,
            ledger: false,
            history_update: HistoryUpdate::Buffered,
            rests: step == 0.0,
        }
    }
    /// The same context with new history variables stored as `update` says.
    #[must_use]
    pub fn with_history_update(mut self, update: HistoryUpdate) -> Self {
        self.history_update = update;
        self
    }
    /// The same context of a body that rests, if `rests` is true, or moves.
    #[must_use]
    pub fn with_rest(mut self, rests: bool) -> Self {
        self.rests = rests;
        self
    }
    /// Sets the addition to the stiffness damping coefficient of every block (s).
    #[must_use]
    pub fn with_damping_shift(mut self, shift: f64) -> Self {
        self.damping_shift = shift;
        self
    }
    /// The same context; blocks account for their energies in this step if `ledger` is true.
    #[must_use]
    pub fn with_ledger(mut self, ledger: bool) -> Self {
        self.ledger = ledger;
        self
    }
}

/// Linear stiffness operator of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Operator {
    /// Initial (elastic) stiffness.
    Elastic,
    /// The same in static states, in which water in pores is drained.
    Static,
    /// Secant stiffness, stress over strain, in the static state of the last forces, those of a step of
    /// zero length.
    Secant,
    /// Tangent stiffness, derivative of stress with respect to strain, in the same state.
    Tangent,
}

/// Energies of a block (J): stored ones of the present state, and accumulated dissipation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BlockEnergy {
    /// Stored (recoverable) strain energy (J) of the present state.
    pub elastic: f64,
    /// Energy (J) stored by hourglass forces, and lost where their stiffness fell with that of the law.
    pub hourglass: f64,
    /// Stored strain energy (J) of bending that hourglass forces stand for, as those of `hex8-natural`; what damage and
    /// plastic flow take of it is in their own energies.
    pub bending: f64,
    /// Energy dissipated by plastic flow (J), accumulated over the steps with energy bookkeeping.
    pub plastic: f64,
    /// Energy dissipated by damage (J), accumulated alike.
    pub damage: f64,
    /// Energy of stiffness that closing cracks regain (J), accumulated alike; not positive.
    pub recovery: f64,
    /// Error of the integration of the law in time, accumulated: work of stresses beyond the energies
    /// that their laws account for.
    ///
    /// The plastic flow of a step counts with the stress at its end, its work with the mean stress. The
    /// error falls with the step.
    pub integration: f64,
    /// Energy dissipated by stiffness damping (J), accumulated alike.
    pub damping: f64,
    /// Energy dissipated and stored by relaxation mechanisms (J), accumulated alike.
    pub relaxation: f64,
}

impl core::ops::AddAssign for BlockEnergy {
    fn add_assign(&mut self, other: Self) {
        self.elastic += other.elastic;
        self.hourglass += other.hourglass;
        self.bending += other.bending;
        self.plastic += other.plastic;
        self.damage += other.damage;
        self.recovery += other.recovery;
        self.integration += other.integration;
        self.damping += other.damping;
        self.relaxation += other.relaxation;
    }
}

impl BlockEnergy {
    /// Energies of an elastic block: stored strain energy (J), all others zero.
    pub fn elastic(elastic: f64) -> Self {
        Self {
            elastic,
            ..Self::default()
        }
    }
    /// Sum of all stored and dissipated energies of the block (J).
    pub fn total(&self) -> f64 {
        self.elastic
            + self.hourglass
            + self.bending
            + self.plastic
            + self.damage
            + self.recovery
            + self.integration
            + self.damping
            + self.relaxation
    }
}

/// Term that limits the stable time step of an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum LimitingTerm {
    /// Stiffness and mass of the element.
    Stiffness,
    /// Stiffness damping of the element.
    StiffnessDamping,
    /// Mass damping of the element, far beyond critical.
    MassDamping,
}

impl LimitingTerm {
    /// Name of the term in reports, such as `stiffness damping`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Stiffness => "stiffness",
            Self::StiffnessDamping => "stiffness damping",
            Self::MassDamping => "mass damping",
        }
    }
}

/// Bound on the highest natural frequency of one element without its neighbours.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct FrequencyBound {
    /// Mesh index of the element.
    pub element: u32,
    /// Bound on the angular frequency (rad/s), from the largest eigenvalue of the kernel in use.
    pub frequency: f64,
    /// Stiffness damping coefficient of the element (s).
    pub stiffness_damping: f64,
}

impl FrequencyBound {
    /// A bound (rad/s) of the element with a mesh index, without damping.
    pub fn new(element: u32, frequency: f64) -> Self {
        Self {
            element,
            frequency,
            stiffness_damping: 0.0,
        }
    }
    /// Sets the coefficient of damping proportional to stiffness of the element (s).
    #[must_use]
    pub fn with_stiffness_damping(mut self, coefficient: f64) -> Self {
        self.stiffness_damping = coefficient;
        self
    }
}

/// Failure of the force evaluation of one element.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ElementFault {
    /// Mesh index of the element.
    pub element: u32,
    /// Reason of the failure in words, without the element.
    pub reason: String,
}

impl ElementFault {
    /// A failure of the element with a mesh index, for a reason.
    pub fn new(element: u32, reason: impl Into<String>) -> Self {
        Self {
            element,
            reason: reason.into(),
        }
    }
}

/// Block of elements of one set with one kernel, one law and one lane type, behind one virtual call per
/// step.
///
/// A block is also the unit of parallel work: an engine splits a large set into blocks and computes them
/// in parallel. A block knows its own nodes alone, by their order in [`nodes`](Self::nodes): every nodal
/// vector that it reads or writes has one entry per node in this order. The engine copies values to the block
/// and sums the forces of all blocks at each node in a fixed order, for any number of threads.
///
/// In a run [`forces`](Self::forces) is called once in every step, after a [`commit`](Self::commit) of the step before;
/// static solutions call it with trial displacements any number of times between two commits.
///
/// A massless spring between one node and the ground:
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
///         let force = x.vector(0) * self.stiffness;
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
///         let u = context.displacement.vector(0);
///         BlockEnergy::elastic(0.5 * self.stiffness * u.norm_squared())
///     }
///     fn history(&self) -> Vec<HistoryField> { Vec::new() }
///     fn set_history(&mut self, _fields: &[HistoryField]) {}
/// }
/// ```
pub trait ElementBlock: Send + Sync {
    /// Name of the element set to which the block belongs.
    fn label(&self) -> &str;
    /// Mesh indices of the elements, in the block's order.
    fn elements(&self) -> &[u32];
    /// Mesh indices of the block's nodes, each once; additional nodes of a boundary follow those of the mesh, in the
    /// order in which the boundary lists them. Nodal vectors of the block are in this order.
    fn nodes(&self) -> &[u32];
    /// Whether [`forces`](Self::forces) reads velocities, with an addition to the stiffness damping coefficient (s)
    /// and with or without energy bookkeeping. If not, the velocity of the context may be empty. True by default.
    fn reads_velocity(&self, _damping_shift: f64, _ledger: bool) -> bool {
        true
    }
    /// Whether [`forces`](Self::forces) are the product of the elastic stiffness, [`Operator::Elastic`], with the displacement since
    /// the reference displacement, and nothing else. False by default, which is right for every block.
    fn is_linear_elastic(&self) -> bool {
        false
    }
    /// Program of one element of the block in a dynamic step of a length (s): the arithmetic of [`forces`](Self::forces)
    /// from the displacement of its nodes to their forces, without ledger, for other processors. None by default.
    ///
    /// Its inputs and outputs have names, with nodes, components, integration points and history variables. Inputs are
    /// `displacement` of the nodes (m), that of the elements' first node subtracted where elements are computed in single
    /// precision; `velocity` likewise (m/s), if damping or flow needs it; the numbers of `geometry`; with a law that is not linear
    /// also `initial` stress (Pa), `extents` (m2), `history` of every point and `element_history`. Outputs are `force` (N)
    /// and the new histories. With a linear law the `displacement` is that with the velocity, times the coefficient of stiffness damping,
    /// added. The displacement is that since the reference displacement. `forks` is the number of forks at most.
    ///
    /// # Errors
    /// What has no program, with the reason.
    fn program(&self, _step: f64, _forks: usize) -> Result<Program, ProgramError> {
        Err(ProgramError::None {
            name: self.label().to_owned(),
        })
    }
    /// Inputs of the [program](Self::program) for an element, given by its index in [`elements`](Self::elements), in the order
    /// of their names: at a displacement (m) and a velocity (m/s) of the block's nodes, from the committed history variables. Empty for
    /// blocks without a program.
    fn program_inputs(
        &self,
        _index: usize,
        _displacement: NodalView,
        _velocity: NodalView,
    ) -> Vec<f64> {
        Vec::new()
    }
    /// Writes the internal forces (N) of every node of the block, stiffness damping included, and computes
    /// new history variables without committing them.
    ///
    /// Internal forces resist the motion.
    ///
    /// # Errors
    /// The first element of which displacement, velocity, stress or force is not finite.
    fn forces(&mut self, context: &BlockContext, out: NodalViewMut) -> Result<(), ElementFault>;
    /// Commits the history variables of the last [`forces`](Self::forces).
    fn commit(&mut self);
    /// Writes the product of a stiffness operator and a nodal vector, both in the order of
    /// [`nodes`](Self::nodes).
    fn apply(&self, operator: Operator, x: NodalView, out: NodalViewMut);
    /// Adds the nodal 3 x 3 diagonal blocks of a stiffness operator (N/m), in the order of
    /// [`nodes`](Self::nodes).
    fn diagonal(&self, operator: Operator, out: &mut [Mat3]);
    /// Calls a function with every element stiffness matrix of an operator: indices in [`nodes`](Self::nodes) of
    /// the nodes that the matrix couples, and its entries (N/m), row by row, three rows and three columns per node.
    ///
    /// By default there is one matrix for all nodes of the block, each column from
    /// [`apply`](Self::apply): right for a few nodes, expensive for many.
    fn each_matrix(&self, operator: Operator, visit: &mut dyn FnMut(&[u32], &[f64])) {
        let count = self.nodes().len();
        let mut unit = vec![Quad::<f64>::default(); count];
        let mut forces = unit.clone();
        let size = 3 * count;
        let mut matrix = vec![0.0; size * size];
        for column in 0..size {
            unit[column / 3].values[column % 3] = 1.0;
            self.apply(
                operator,
                NodalView::F64(&unit),
                NodalViewMut::F64(&mut forces),
            );
            unit[column / 3].values[column % 3] = 0.0;
            for row in 0..size {
                matrix[row * size + column] = forces[row / 3].values[row % 3];
            }
        }
        let every: Vec<u32> = (0..count as u32).collect();
        visit(&every, &matrix);
    }
    /// Adds the lumped masses of the nodes (kg), in the order of [`nodes`](Self::nodes).
    fn add_mass(&self, out: &mut [f64]);
    /// Frequency bound of each active element.
    fn frequency_bounds(&self) -> Vec<FrequencyBound>;
    /// Stiffness damping coefficient of Rayleigh damping (s).
    fn stiffness_damping(&self) -> f64;
    /// Mass damping coefficient of Rayleigh damping (1/s).
    fn mass_damping(&self) -> f64;
    /// Activates and deactivates elements, in the order of [`elements`](Self::elements).
    fn set_active(&mut self, active: &[bool]);
    /// Sets the reference displacement (m) of the block's nodes, from which strain and hourglass deformation
    /// are measured: elements that are cast later are free of stress in the deformed body.
    fn set_reference_displacement(&mut self, displacement: NodalView);
    /// Sets the initial stress (Pa) of each element, in the order of [`elements`](Self::elements).
    fn set_initial_stress(&mut self, stress: &[Stress]);
    /// Adds the nodal forces (N) of uniform element stresses (Pa), such as initial stresses: stresses in the
    /// order of [`elements`](Self::elements), forces in that of [`nodes`](Self::nodes).
    ///
    /// By default nothing is added, which is right for blocks that bear no initial stress, such as bolts
    /// and boundary elements; a block with initial stress must override it, or the initial stress is not
    /// in equilibrium.
    fn add_forces_of(&self, _stress: &[Stress], _out: &mut [Vec3]) {}
    /// Adds the mean change of stress (Pa) over the volume of each element at a displacement (m) of the block's nodes,
    /// from the committed history variables, in the order of [`elements`](Self::elements).
    fn add_stress(&self, displacement: NodalView, out: &mut [Stress]);
    /// Writes the internal forces (N) of one element, given by its index in [`elements`](Self::elements), at
    /// its nodes in the mesh's order; returns whether they were written.
    ///
    /// They are the forces of an initial stress (Pa) and of the change of stress at a displacement (m) of the block's
    /// nodes from the committed history variables, and hourglass forces, without stiffness damping. By default nothing
    /// is written and the result is false, which says that the block has no forces per element: section
    /// forces leave its elements out.
    fn element_forces(
        &self,
        _index: usize,
        _displacement: NodalView,
        _initial: &Stress,
        _out: &mut [Vec3],
    ) -> bool {
        false
    }
    /// Stress (Pa) on the faces of an element at the natural coordinates r = 1, s = 1 and t = 1 less its mean stress, at a
    /// displacement (m) of the block's nodes from the committed history variables; on the opposite faces it has the other
    /// sign. None, the default, where the stress of elements does not vary within them, or is that of several points.
    fn surface_stresses(&self, _index: usize, _displacement: NodalView) -> Option<[Stress; 3]> {
        None
    }
    /// Energies (J): elastic and hourglass energy at the context's displacement, and accumulated dissipation.
    fn energy(&self, context: &BlockContext) -> BlockEnergy;
    /// Committed history variables of all elements, one field per variable.
    fn history(&self) -> Vec<HistoryField>;
    /// Sets committed history variables from fields, those of the block's own elements and variables.
    fn set_history(&mut self, fields: &[HistoryField]);
    /// Element value of a history variable after the last [`forces`](Self::forces), committed or not, of the
    /// element with an index in [`elements`](Self::elements); none if its law has no such variable.
    ///
    /// By default it is the mean over the integration points of the committed [`history`](Self::history),
    /// which is right for blocks whose history variables change only at a commit. Blocks with water in their pores also answer
    /// [`PORE_PRESSURE`](crate::PORE_PRESSURE) and [`PORE_PRESSURE_RATIO`](crate::PORE_PRESSURE_RATIO).
    fn shown_history(&self, index: usize, variable: &str) -> Option<f64> {
        let fields = self.history();
        let field = fields.iter().find(|field| field.name == variable)?;
        let values = field
            .values
            .get(index * field.points..(index + 1) * field.points)?;
        Some(values.iter().sum::<f64>() / field.points as f64)
    }
    /// State of the block between two steps as bytes, with the committed history variables, from which a block of the
    /// same elements goes on in a resumed run. None by default: the engine then keeps the [`history`](Self::history),
    /// which suffices for blocks whose energies follow from it.
    ///
    /// The bytes are in the order of [`elements`](Self::elements), so that blocks of other lane widths can restore them.
    ///
    /// # Errors
    /// A state that cannot be saved.
    fn save_state(&self) -> Result<Option<Vec<u8>>, StateError> {
        Ok(None)
    }
    /// Restores a state that a block of the same elements [saved](Self::save_state).
    ///
    /// # Errors
    /// A state of another block; by default every one.
    fn restore_state(&mut self, _saved: &[u8]) -> Result<(), StateError> {
        Err(StateError::Unexpected)
    }
}
