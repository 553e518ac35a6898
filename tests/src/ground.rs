//! Bodies of one elastic material.

use powerhouse::engine::Model;
use powerhouse_elements::SolidKernel;
use powerhouse_material_damage::LinearElastic;
use powerhouse_model::{
    AbsorbingBoundary, BlockFactory, BlockOptions, BoundarySite, ElasticMedium, ElementKind,
    IncidentField, Mesh, MeshError, ModelSpec, Vec3,
};

/// The element set of every body.
const SET: &str = "ground";

/// A body of one elastic material, with the facet sets of a box: `left`, `right`, `front`, `back`,
/// `bottom`, `top`.
#[derive(Clone, Debug)]
pub struct Ground {
    /// Mesh of the body.
    pub mesh: Mesh,
    /// Material of all elements.
    pub medium: ElasticMedium,
    /// Element kernel.
    pub kernel: SolidKernel,
    /// Precision, lanes and damping.
    pub options: BlockOptions,
    /// Number of threads of the model; all cores if `None`.
    pub threads: Option<usize>,
}

/// A box of tetrahedra with midpoints.
fn box_of_tets_with_midpoints(
    low: Vec3,
    high: Vec3,
    cells: [usize; 3],
    elements: &str,
) -> Result<Mesh, MeshError> {
    Mesh::box_of_tets(low, high, cells, elements)?.with_midpoints()
}

impl Ground {
    /// Creates a box with one corner at the origin, of `size` (m), with cells of one hexahedron, two wedges, or
    /// six tetrahedra or pyramids, depending on the kernel.
    ///
    /// # Panics
    /// For an invalid box.
    pub fn boxed(
        size: Vec3,
        cells: [usize; 3],
        medium: ElasticMedium,
        kernel: SolidKernel,
    ) -> Self {
        let make = match kernel.kind() {
            ElementKind::Tet4 => Mesh::box_of_tets,
            ElementKind::Tet10 => box_of_tets_with_midpoints,
            ElementKind::Wedge6 => Mesh::box_of_wedges,
            ElementKind::Pyramid5 => Mesh::box_of_pyramids,
            _ => Mesh::box_of_hexes,
        };
        let mesh = make(Vec3::zeros(), size, cells, SET).expect("a box of cells");
        Self {
            mesh,
            medium,
            kernel,
            options: BlockOptions::default(),
            threads: None,
        }
    }

    /// Moves every node; edges stay straight.
    ///
    /// # Panics
    /// If an element is inverted or flat afterwards.
    #[must_use]
    pub fn mapped(mut self, map: impl Fn(Vec3) -> Vec3) -> Self {
        let mapped = self.mesh.map_positions(map).expect("finite positions");
        self.mesh = mapped.with_straight_edges();
        self.mesh.check().expect("sound elements");
        self
    }

    /// The nodes of a named face.
    ///
    /// # Panics
    /// If there is no such face.
    pub fn face_nodes(&self, face: &str) -> Vec<u32> {
        let facets = self.mesh.facet_set(face).expect("a face of the box");
        self.mesh.nodes_of_facets(facets)
    }

    /// The site of a boundary on some faces, with distances from the middle of the body.
    ///
    /// # Panics
    /// If there is no such face.
    pub fn site<'a>(
        &self,
        faces: &[&str],
        field: Option<&'a dyn IncidentField>,
    ) -> BoundarySite<'a> {
        let (low, high) = self.mesh.bounding_box();
        let named: Vec<_> = faces
            .iter()
            .map(|&face| (face, self.mesh.facet_set(face).expect("a face of the box")))
            .collect();
        let middle = 0.5 * (low + high);
        BoundarySite::from_mesh(&self.mesh, &named, |_| self.medium, middle, field)
    }

    /// A model builder with the elements and a boundary on some faces.
    ///
    /// # Panics
    /// If the boundary cannot be built.
    pub fn with_boundary(
        &self,
        boundary: &dyn AbsorbingBoundary,
        faces: &[&str],
        field: Option<&dyn IncidentField>,
    ) -> ModelSpec<'_> {
        let parts = boundary
            .build(&self.site(faces, field))
            .expect("a boundary");
        self.free().boundary(parts)
    }

    /// A model builder with the elements only.
    pub fn free(&self) -> ModelSpec<'_> {
        let factory = elastic(SET, self.kernel, self.medium, self.options);
        let builder = Model::builder(&self.mesh).elements(SET, factory);
        match self.threads {
            Some(threads) => builder.threads(threads),
            None => builder,
        }
    }
}

/// A set of elastic elements.
///
/// The one place where kernels and law meet at compile time: every other one would cost a minute
/// of compilation.
pub fn elastic(
    set: &str,
    kernel: SolidKernel,
    medium: ElasticMedium,
    options: BlockOptions,
) -> Box<dyn BlockFactory> {
    kernel.factory(set, LinearElastic::new(medium), options)
}
