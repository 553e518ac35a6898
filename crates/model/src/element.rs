//! Blocks of elements, behind which an engine knows neither kernels nor laws.

use crate::{
    BlockOutput, BlockStiffness, DampedBlock, NodalView, NodalViewMut, ProgrammedBlock,
    StatefulBlock, StepTime,
};

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
    /// [read it](DampedBlock::reads_velocity).
    pub velocity: NodalView<'a>,
    /// Addition to the stiffness damping coefficient of every block (s); negative in the paper's
    /// one-sided scheme.
    pub damping_shift: f64,
    /// Whether the block must account for its energies in this step.
    pub ledger: bool,
    /// Whether stresses, energies or history variables are read between these forces and the next commit.
    pub shown: bool,
    /// Whether forces may be evaluated again from the same committed state before the next commit.
    pub repeats: bool,
    /// Whether the body rests, so that elements with numbers of their own bring these to equilibrium, whatever the length of the
    /// step; otherwise they follow step by step.
    pub rests: bool,
}

impl<'a> BlockContext<'a> {
    /// A context of a step, a displacement (m) and a velocity (m/s), without energy bookkeeping, which is not shown and
    /// may be repeated; of a body that rests if the step is zero.
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
            shown: false,
            repeats: true,
            rests: step == 0.0,
        }
    }
    /// The same context of a step that is shown, if `shown` is true: the block can keep what output reads.
    #[must_use]
    pub fn with_shown(mut self, shown: bool) -> Self {
        self.shown = shown;
        self
    }
    /// The same context of forces that may be repeated, if `repeats` is true. Otherwise the next operation but reads is a commit,
    /// and the block may overwrite its committed state unless the step is shown.
    #[must_use]
    pub fn with_repeats(mut self, repeats: bool) -> Self {
        self.repeats = repeats;
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
/// In a run [`forces`](Self::forces) is called once in every step, after a [`commit`](StatefulBlock::commit) of the step before;
/// static solutions call it with trial displacements any number of times between two commits.
///
/// What stable steps, damping, results, states and programs need in addition is behind methods that return none by default.
/// Engines call it by the methods of `dyn ElementBlock`, which define what a block without it does.
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
///     fn add_mass(&self, _out: &mut [f64]) {}
///     fn frequency_bounds(&self) -> Vec<FrequencyBound> { Vec::new() }
///     fn stiffness(&self) -> Option<&dyn BlockStiffness> { Some(self) }
///     fn output(&self) -> Option<&dyn BlockOutput> { Some(self) }
/// }
/// impl BlockStiffness for Anchor {
///     fn apply(&self, _operator: Operator, x: NodalView, out: NodalViewMut) {
///         let force = x.vector(0) * self.stiffness;
///         match out {
///             NodalViewMut::F64(out) => out[0] = Quad::from_vector(&force),
///             NodalViewMut::F32(out) => out[0] = Quad::from_vector(&force),
///         }
///     }
/// }
/// impl BlockOutput for Anchor {
///     fn energy(&self, context: &BlockContext) -> BlockEnergy {
///         let u = context.displacement.vector(0);
///         BlockEnergy::elastic(0.5 * self.stiffness * u.norm_squared())
///     }
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
    /// Writes the internal forces (N) of every node of the block, stiffness damping included, and computes
    /// new history variables without committing them.
    ///
    /// Internal forces resist the motion.
    ///
    /// # Errors
    /// The first element of which displacement, velocity, stress or force is not finite.
    fn forces(&mut self, context: &BlockContext, out: NodalViewMut) -> Result<(), ElementFault>;
    /// Adds the lumped masses of the nodes (kg), in the order of [`nodes`](Self::nodes).
    fn add_mass(&self, out: &mut [f64]);
    /// Frequency bound of each active element.
    fn frequency_bounds(&self) -> Vec<FrequencyBound>;
    /// Its damping, for forces that depend on velocities; none, the default, if they do not.
    fn damped(&self) -> Option<&dyn DampedBlock> {
        None
    }
    /// Its stiffness, for stable steps and static solutions; none, the default, if its forces do not depend on displacements.
    fn stiffness(&self) -> Option<&dyn BlockStiffness> {
        None
    }
    /// Its energies, stresses and shown history variables; none by default.
    fn output(&self) -> Option<&dyn BlockOutput> {
        None
    }
    /// Its state: active elements, reference displacement, initial stress and history variables; none by default.
    fn stateful(&self) -> Option<&dyn StatefulBlock> {
        None
    }
    /// The same state, to be changed; none by default.
    fn stateful_mut(&mut self) -> Option<&mut dyn StatefulBlock> {
        None
    }
    /// The program of its elements, for other processors; none by default.
    fn programmed(&self) -> Option<&dyn ProgrammedBlock> {
        None
    }
}
