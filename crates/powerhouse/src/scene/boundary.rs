//! What a scene says of where the mesh ends.

use std::sync::Arc;

use powerhouse_model::{AbsorbingBoundary, Vec3};

/// Where the mesh ends and the ground goes on.
#[derive(Clone)]
pub struct Boundary {
    /// What absorbs.
    pub condition: Arc<dyn AbsorbingBoundary>,
    /// The facet sets on which it stands.
    pub faces: Vec<String>,
    /// The centre of what scatters (m); without one, the middle of the parts that touch no
    /// absorbing face, or of the mesh's box if all do.
    pub scatterer: Option<Vec3>,
    /// Elements of a region (mesh indices) that the field enters through the layer of elements around
    /// it ([`DomainReduction`](powerhouse_boundary::DomainReduction)), in place of the faces. Outside
    /// the layer nothing but scattered waves moves.
    pub region: Option<Vec<u32>>,
}

impl Boundary {
    /// A boundary on faces of the mesh.
    pub fn new<N: Into<String>>(
        condition: impl AbsorbingBoundary + 'static,
        faces: impl IntoIterator<Item = N>,
    ) -> Self {
        Self {
            condition: Arc::new(condition),
            faces: faces.into_iter().map(Into::into).collect(),
            scatterer: None,
            region: None,
        }
    }
    /// The same around a scatterer (m).
    #[must_use]
    pub fn scatterer(mut self, centre: Vec3) -> Self {
        self.scatterer = Some(centre);
        self
    }
    /// The same with a field that enters through the layer around a region (mesh indices of its
    /// elements), which must be elastic, undamped ground of the field's medium.
    #[must_use]
    pub fn entering_around(mut self, region: Vec<u32>) -> Self {
        self.region = Some(region);
        self
    }
}
