//! How element sets become blocks.

use powerhouse_model::{ElementBlock, ElementKind, Mesh, ModelError, Numbering};

/// The number format of nodes and of element arithmetic.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// Nodes and elements in double precision.
    #[default]
    F64,
    /// Nodes in double precision, element arithmetic in single precision on displacement
    /// differences that are formed in double precision; double precision where the natural
    /// frequency of an element is far above that of the body, since rounding excites such elements
    /// most.
    Mixed,
    /// Displacements of nodes in double precision as their differences, velocities and forces of nodes in
    /// single precision, elements as in [`Mixed`](Self::Mixed).
    F32,
}

/// How many elements are computed with at once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LaneWidth {
    /// As many as the processor takes.
    #[default]
    Native,
    /// One: the oracle of the wide lanes, and the reference of their bits.
    One,
}

/// Rayleigh damping of a set: `C = mass * M + stiffness * K0`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rayleigh {
    /// Mass coefficient (1/s).
    pub mass: f64,
    /// Stiffness coefficient (s), on the initial stiffness.
    pub stiffness: f64,
}

/// What all blocks of a set share.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct BlockOptions {
    /// Number format.
    pub precision: Precision,
    /// Elements at once.
    pub lanes: LaneWidth,
    /// Damping.
    pub damping: Rayleigh,
}

/// A part of a set that becomes one block.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct BlockPart<'a> {
    /// The mesh.
    pub mesh: &'a Mesh,
    /// Mesh indices of the part's elements, in the order of computation.
    pub elements: &'a [u32],
    /// Engine numbers of all nodes.
    pub numbering: &'a Numbering,
    /// Engine numbers of the nodes that the part touches: those that it owns first, in rising
    /// order, then those of other blocks. Forces are written in this order.
    pub nodes: &'a [u32],
    /// Whether element arithmetic is to be in double precision whatever the options say.
    pub double: bool,
}

impl<'a> BlockPart<'a> {
    /// A part, for engines and tests.
    pub fn new(
        mesh: &'a Mesh,
        elements: &'a [u32],
        numbering: &'a Numbering,
        nodes: &'a [u32],
    ) -> Self {
        Self {
            mesh,
            elements,
            numbering,
            nodes,
            double: false,
        }
    }
    /// The same with element arithmetic in double precision, if so, whatever the options say.
    #[must_use]
    pub fn in_double(mut self, double: bool) -> Self {
        self.double = double;
        self
    }
}

/// Factory of the blocks of one element set; implemented by engines, and by users only to wrap the factory of
/// an engine.
///
/// [`solid`](crate::solid) makes one from any kernel and law; there is no central list. A factory that wraps
/// another one:
/// ```
/// use powerhouse_explicit_core::{BlockFactory, BlockOptions, BlockPart};
/// use powerhouse_model::{ElementBlock, ElementKind, ModelError};
/// /// Factory that prints the size of the blocks of another one.
/// struct Printed(Box<dyn BlockFactory>);
/// impl BlockFactory for Printed {
///     fn label(&self) -> &str { self.0.label() }
///     fn kind(&self) -> ElementKind { self.0.kind() }
///     fn options(&self) -> BlockOptions { self.0.options() }
///     fn build(&self, part: &BlockPart) -> Result<Box<dyn ElementBlock>, ModelError> {
///         println!("a block of {} elements of '{}'", part.elements.len(), self.label());
///         self.0.build(part)
///     }
/// }
/// ```
pub trait BlockFactory: Send + Sync {
    /// The set's name.
    fn label(&self) -> &str;
    /// The kind of element that the factory takes.
    fn kind(&self) -> ElementKind;
    /// What the blocks will share.
    fn options(&self) -> BlockOptions;
    /// Makes one block.
    ///
    /// # Errors
    /// If an element's shape does not suit the kernel, with the user's number.
    fn build(&self, part: &BlockPart) -> Result<Box<dyn ElementBlock>, ModelError>;
}
