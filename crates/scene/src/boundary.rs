//! The absorbing boundary of a scene.

use std::sync::Arc;

use powerhouse_model::{AbsorbingBoundary, Vec3};

/// Absorbing boundary of a scene: its condition, its faces and the scatterer.
#[derive(Clone)]
pub struct Boundary {
    /// Boundary condition: springs and dashpots.
    pub condition: Arc<dyn AbsorbingBoundary>,
    /// Facet sets of the absorbing faces.
    pub faces: Vec<String>,
    /// The scatterer (m): the centre of the structure, from which boundary springs take their distance; without one, the
    /// middle of the parts that touch no absorbing face, or of the mesh's box if all do.
    pub scatterer: Option<Vec3>,
    /// Element sets of parts of a structure, such as a lining or a fault zone, that run through the faces. They absorb there with
    /// their own impedance, and take the motion and the stress of the field in the ground without the structure.
    pub through: Vec<String>,
    /// Elements of a region (mesh indices) that the field enters through the layer of elements around
    /// it ([`DomainReduction`](powerhouse_boundary::DomainReduction)), in place of the faces. Outside
    /// the layer nothing but scattered waves moves.
    pub region: Option<Vec<u32>>,
}

impl Boundary {
    /// Absorbing boundary on faces of the mesh, given by the names of their facet sets.
    pub fn new<N: Into<String>>(
        condition: impl AbsorbingBoundary + 'static,
        faces: impl IntoIterator<Item = N>,
    ) -> Self {
        Self {
            condition: Arc::new(condition),
            faces: faces.into_iter().map(Into::into).collect(),
            scatterer: None,
            through: Vec::new(),
            region: None,
        }
    }
    /// Sets the scatterer (m): the centre of the structure, from which boundary springs take their distance.
    #[must_use]
    pub fn with_scatterer(mut self, centre: Vec3) -> Self {
        self.scatterer = Some(centre);
        self
    }
    /// Sets the element sets of parts of a structure that run through the faces.
    #[must_use]
    pub fn with_through<N: Into<String>>(mut self, parts: impl IntoIterator<Item = N>) -> Self {
        self.through = parts.into_iter().map(Into::into).collect();
        self
    }
    /// Sets the region (mesh indices of its elements) around which the field enters; the layer must be
    /// elastic, undamped ground of the field's medium.
    #[must_use]
    pub fn with_region(mut self, region: Vec<u32>) -> Self {
        self.region = Some(region);
        self
    }
}
