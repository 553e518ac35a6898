//! Interface of processors beside the host, such as graphics processors, that take time steps of a model.

use core::ops::Range;

use thiserror::Error;

use crate::{ElementBlock, Mat3, NodalViewMut, Quad, Vec3};

/// Failure of a processor beside the host.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum DeviceError {
    /// A library, driver or device that is not on the machine.
    #[error("{what} is not on this machine: {reason}")]
    Missing {
        /// What is missing.
        what: String,
        /// What was tried, or the message of the system.
        reason: String,
    },
    /// A part of a model that the device cannot compute; without a device the same run is possible.
    #[error("{part} cannot be computed on the device: {reason}")]
    Refused {
        /// The part of the model or the option of the run.
        part: String,
        /// Reason in words.
        reason: String,
    },
    /// An operation of the device that failed, such as a compilation or an allocation.
    #[error("{operation} failed: {reason}")]
    Failed {
        /// The operation.
        operation: String,
        /// Message of the device.
        reason: String,
    },
}

impl DeviceError {
    /// Something that is not on the machine.
    pub fn missing(what: impl Into<String>, reason: impl Into<String>) -> Self {
        let (what, reason) = (what.into(), reason.into());
        Self::Missing { what, reason }
    }
    /// A part of a model that the device cannot compute.
    pub fn refused(part: impl Into<String>, reason: impl Into<String>) -> Self {
        let (part, reason) = (part.into(), reason.into());
        Self::Refused { part, reason }
    }
    /// An operation that failed.
    pub fn failed(operation: impl Into<String>, reason: impl Into<String>) -> Self {
        let (operation, reason) = (operation.into(), reason.into());
        Self::Failed { operation, reason }
    }
}

/// Block of elements of a [`DeviceModel`].
pub struct DeviceBlock<'a> {
    /// The block, of which a device reads the [program](crate::ProgrammedBlock::program) and its inputs.
    pub block: &'a dyn ElementBlock,
    /// Slots of the block's nodes, in their order.
    pub slots: Range<usize>,
    /// Slots of the nodes of every element, element after element, in the order of the element's nodes.
    pub corners: Vec<u32>,
}

/// Group of nodes with one common motion, with dashpots, springs, supports or ties, of a [`DeviceModel`].
///
/// With the force `F` on all members, the elongation `s` of the spring since `origin` and the old velocity `v` of the first
/// member, the new one is `carry v + inverse (step (F - spring s))`; in a diagonal group it is, component by component,
/// `carry v + response (F - spring s)` with the diagonals of the matrices.
#[derive(Clone, Debug)]
pub struct DeviceGroup {
    /// Nodes, by number in the nodal vectors; at least one.
    pub members: Vec<u32>,
    /// Whether all matrices are diagonal, and there is one member.
    pub is_diagonal: bool,
    /// New velocity per old velocity.
    pub carry: Mat3,
    /// Inverse of the effective mass (1/kg); in a diagonal group times the step (s/kg), the `response`.
    pub inverse: Mat3,
    /// Spring (N/m).
    pub spring: Mat3,
    /// Displacement (m) from which the spring is measured.
    pub origin: Vec3,
}

/// A model in the form that a [`StepDevice`] takes over: nodes, blocks, groups and coefficients of one step length.
///
/// Every block writes forces of its nodes to a range of slots; the force at a node is the sum of its slots in their order, each of which
/// is the sum over the elements of its block in their order, from zero on. With `internal` the sum, `external` the applied force and
/// `force = external - internal`, the new velocity of a node is `decay v + gain force` (without `decay` where that list is empty), after that of
/// members of groups has been replaced by the group's; along held axes the force is zero. The displacement grows by the step times it.
pub struct DeviceModel<'a> {
    /// Length of the steps (s).
    pub step: f64,
    /// Bound on each component of velocity (m/s), beyond which the motion counts as diverged.
    pub speed_limit: f64,
    /// Whether velocities and forces of nodes are in single precision.
    pub single: bool,
    /// Node of each slot.
    pub slot_nodes: &'a [u32],
    /// Slots of each node, in the order of summation.
    pub slots_of_nodes: Vec<&'a [u32]>,
    /// Blocks of elements.
    pub blocks: Vec<DeviceBlock<'a>>,
    /// Velocity per force of each node (m/s/N), rounded to the format of the nodes.
    pub gain: Vec<f64>,
    /// New velocity per old velocity of each node; empty if it is one everywhere.
    pub decay: Vec<f64>,
    /// Nodes that are held along axes.
    pub held: Vec<(u32, [bool; 3])>,
    /// Groups.
    pub groups: Vec<DeviceGroup>,
    /// Whether any node outside of groups has applied forces, of which [`loaded_nodes`](Self::loaded_nodes) change in time.
    pub has_external: bool,
    /// Nodes outside of groups with applied forces that change in time.
    pub loaded_nodes: Vec<u32>,
    /// Indices of the groups with applied forces that change in time.
    pub loaded_groups: Vec<u32>,
}

/// Applied forces of successive steps, input of a [`StepDevice`].
#[derive(Clone, Debug, Default)]
pub struct DeviceLoads {
    /// Number of steps.
    pub steps: usize,
    /// Applied force (N) at every node at the first step; empty if there is none.
    pub at_nodes: Vec<Vec3>,
    /// Applied force (N) on every group at the first step.
    pub on_groups: Vec<Vec3>,
    /// Forces (N) of every step at [`DeviceModel::loaded_nodes`], step after step.
    pub of_nodes: Vec<Vec3>,
    /// Forces (N) of every step on [`DeviceModel::loaded_groups`], step after step.
    pub of_groups: Vec<Vec3>,
}

/// Motion of all nodes, which a [`StepDevice`] advances.
pub struct DeviceMotion<'a> {
    /// Displacement (m).
    pub displacement: &'a mut [Quad<f64>],
    /// Velocity (m/s) half a step before.
    pub velocity: NodalViewMut<'a>,
}

/// Processor beside the host that takes time steps of one model, such as a graphics processor.
///
/// An engine hands over the steps that nobody observes, and takes those between them itself.
pub trait StepDevice: Send {
    /// Name of the device in reports.
    fn name(&self) -> &str;
    /// Takes over a model: compiles its programs and copies what does not change in its steps.
    ///
    /// # Errors
    /// [`DeviceError::Refused`] for a part that the device cannot compute; an operation that failed.
    fn load(&mut self, model: &DeviceModel) -> Result<(), DeviceError>;
    /// Takes as many steps as `loads` has, from the motion and the committed history variables of the blocks, which are those
    /// of the model it took over, in its order; replaces both by the new ones and returns true. Returns false and changes nothing if a velocity was
    /// not finite or beyond the bound.
    ///
    /// # Errors
    /// An operation that failed; motion and history variables are then unchanged.
    fn advance(
        &mut self,
        blocks: &mut [Box<dyn ElementBlock>],
        motion: DeviceMotion,
        loads: &DeviceLoads,
    ) -> Result<bool, DeviceError>;
}

/// Source of devices, of which every model has its own.
pub trait StepDevices: Send + Sync {
    /// Name of the kind of device, such as `gpu`.
    fn name(&self) -> &str;
    /// A device for a model.
    ///
    /// # Errors
    /// [`DeviceError::Missing`] if there is none on the machine.
    fn device(&self) -> Result<Box<dyn StepDevice>, DeviceError>;
}
