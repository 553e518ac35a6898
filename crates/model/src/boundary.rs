//! Where the mesh ends.

use crate::{
    ElasticMedium, ElementBlock, IncidentField, Mat3, ModelError, NodalLoad, Numbering, Vec3,
};

/// One face of the body at one of its nodes.
#[derive(Clone, Debug, PartialEq)]
pub struct SiteFace {
    /// Index of the named face in [`BoundarySite::faces`].
    pub face: usize,
    /// Outward unit normal, averaged over the face's facets at this node.
    pub normal: Vec3,
    /// The share of the face's area that belongs to this node (m2).
    pub area: f64,
}

/// One node of the boundary.
#[derive(Clone, Debug)]
pub struct SiteNode {
    /// Index in the mesh.
    pub node: u32,
    /// Position (m).
    pub position: Vec3,
    /// The medium of the elements behind this node.
    pub medium: ElasticMedium,
    /// The faces that meet here: one inside a face, two on an edge, three at a corner.
    pub faces: Vec<SiteFace>,
}

/// The boundary that is to be built.
pub struct BoundarySite<'a> {
    /// Names of the faces.
    pub faces: Vec<String>,
    /// Nodes with their shares of the faces, each node once.
    pub nodes: Vec<SiteNode>,
    /// The centre of what scatters (the structure), from which distances are taken (m).
    pub scatterer: Vec3,
    /// The motion of the site without the structure; none for a boundary that only absorbs.
    pub field: Option<&'a dyn IncidentField>,
}

/// A spring and a dashpot from a node to the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodalImpedance {
    /// Index of the node in the mesh.
    pub node: u32,
    /// Spring (N/m), symmetric and positive semi-definite; acts on the displacement since the
    /// stage's start.
    pub spring: Mat3,
    /// Dashpot (N s/m), symmetric and positive semi-definite.
    pub dashpot: Mat3,
}

/// Elements with degrees of freedom of their own that a boundary brings along.
pub struct ExtraBlock {
    /// Positions of the additional nodes (m); they are numbered after those of the mesh.
    pub nodes: Vec<Vec3>,
    /// Makes the block once the engine has numbered the nodes.
    pub build: Box<dyn FnOnce(&Numbering) -> Box<dyn ElementBlock> + Send>,
}

/// What a boundary hands to the engine. It applies nothing itself.
#[derive(Default)]
pub struct BoundaryParts {
    /// Springs and dashpots; the integrator puts them into the velocity solve of their node, so
    /// they cost no time step.
    pub impedance: Vec<NodalImpedance>,
    /// Input forces, on the boundary or inside; each is one unit of parallel work.
    pub loads: Vec<Box<dyn NodalLoad>>,
    /// Elements beyond the mesh, such as absorbing layers.
    pub blocks: Vec<ExtraBlock>,
}

/// A condition that lets waves leave the model, and brings the incident ones in.
///
/// ```
/// use powerhouse_model::{AbsorbingBoundary, BoundaryParts, BoundarySite, Mat3, ModelError, NodalImpedance};
/// /// Dashpots with the shear impedance in every direction.
/// struct Uniform;
/// impl AbsorbingBoundary for Uniform {
///     fn name(&self) -> &str { "uniform" }
///     fn build(&self, site: &BoundarySite) -> Result<BoundaryParts, ModelError> {
///         let impedance = site.nodes.iter().map(|node| {
///             let area: f64 = node.faces.iter().map(|face| face.area).sum();
///             NodalImpedance {
///                 node: node.node,
///                 spring: Mat3::zeros(),
///                 dashpot: Mat3::identity() * node.medium.density * node.medium.s_speed() * area,
///             }
///         });
///         Ok(BoundaryParts { impedance: impedance.collect(), ..BoundaryParts::default() })
///     }
/// }
/// ```
pub trait AbsorbingBoundary: Send + Sync {
    /// The boundary's name in reports.
    fn name(&self) -> &str;
    /// Springs, dashpots, loads and elements for a site.
    ///
    /// # Errors
    /// If the site has something the boundary cannot serve, such as a zero distance.
    fn build(&self, site: &BoundarySite) -> Result<BoundaryParts, ModelError>;
}
