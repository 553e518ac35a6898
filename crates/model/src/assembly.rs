//! Factories of element blocks, and their options.

#[cfg(feature = "keys")]
use crate::keys::*;
use crate::{ElementBlock, ElementKind, Mesh, ModelError};

/// Number format of nodal values and element arithmetic.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "keys", derive(Deserialize, Serialize, JsonSchema))]
#[cfg_attr(feature = "keys", serde(rename_all = "kebab-case"))]
pub enum Precision {
    /// Double precision of nodal values and element arithmetic.
    #[default]
    F64,
    /// Mixed precision: nodal values in double precision, element arithmetic in single precision on displacement
    /// differences that are formed in double precision. Elements with a natural
    /// frequency far above that of the body are computed in double precision, since rounding excites them
    /// most.
    Mixed,
    /// Single precision of nodal velocities and forces; displacements and their differences in double precision, element
    /// arithmetic as in [`Mixed`](Self::Mixed).
    F32,
}

/// Number of elements computed at once by SIMD instructions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LaneWidth {
    /// As many elements at once as the widest SIMD registers of the processor hold.
    #[default]
    Native,
    /// One element at a time: the scalar reference of the wide lanes, with bitwise equal results.
    One,
}

/// Rayleigh damping of an element set: `C = mass * M + stiffness * K0`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rayleigh {
    /// Coefficient of damping proportional to mass, Rayleigh's alpha (1/s).
    pub mass: f64,
    /// Stiffness-proportional coefficient (s), applied to the initial elastic stiffness `K0`.
    pub stiffness: f64,
}

/// Options of all blocks of an element set.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct BlockOptions {
    /// Number format of nodes and elements.
    pub precision: Precision,
    /// Number of elements that are computed at once, one in each SIMD lane.
    pub lanes: LaneWidth,
    /// Rayleigh damping of the elements: coefficients proportional to mass (1/s) and to stiffness (s).
    pub damping: Rayleigh,
}

/// Part of an element set that forms one block: its elements and nodes.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct BlockPart<'a> {
    /// The mesh of the model.
    pub mesh: &'a Mesh,
    /// Mesh indices of the part's elements, in the order of computation.
    pub elements: &'a [u32],
    /// Mesh indices of the nodes of these elements, each once. The nodal vectors of the block are in this order.
    pub nodes: &'a [u32],
    /// Whether element arithmetic is in double precision regardless of the options.
    pub double: bool,
}

impl<'a> BlockPart<'a> {
    /// A part of given elements and nodes, for engines and tests.
    pub fn new(mesh: &'a Mesh, elements: &'a [u32], nodes: &'a [u32]) -> Self {
        Self {
            mesh,
            elements,
            nodes,
            double: false,
        }
    }
    /// Sets whether element arithmetic is in double precision regardless of the options.
    #[must_use]
    pub fn in_double(mut self, double: bool) -> Self {
        self.double = double;
        self
    }
}

/// Factory of the element blocks of one set; implemented by engines, and by users only to wrap the factory of
/// an engine.
///
/// `powerhouse_elements::solid` makes one from any kernel and law; there is no central list. A factory that wraps
/// another one:
/// ```
/// use powerhouse_model::{BlockFactory, BlockOptions, BlockPart, ElementBlock, ElementKind, ModelError};
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
    /// Name of the element set.
    fn label(&self) -> &str;
    /// Kind of element that the factory supports.
    fn kind(&self) -> ElementKind;
    /// Options of all blocks.
    fn options(&self) -> BlockOptions;
    /// Estimated cost of an element in a step over that of an elastic brick with one integration point, by which ranks
    /// share the blocks; 1 by default. Results do not depend on it.
    fn relative_cost(&self) -> f64 {
        1.0
    }
    /// Builds one block, once for each part of the set; parts are built in parallel.
    ///
    /// # Errors
    /// If the shape of an element is invalid for the kernel or law, with the user's number of the element.
    fn build(&self, part: &BlockPart) -> Result<Box<dyn ElementBlock>, ModelError>;
}
