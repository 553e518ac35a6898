//! A column of the atlas: kernel, number format and scheme.

use powerhouse::engine::{Leapfrog, OneSided};
use powerhouse::{Kernel, Material};
use powerhouse_elements::{Hex8OnePoint, SolidKernel};
use powerhouse_model::{
    BlockFactory, BlockOptions, ElementKind, Mesh, MeshError, Precision, Rayleigh, TimeIntegrator,
    Vec3,
};

/// The element set of every body.
pub(super) const SET: &str = "ground";

/// A kernel, a number format and a scheme.
#[derive(Clone, Copy, Debug)]
pub(super) struct Column {
    pub(super) name: &'static str,
    kernel: SolidKernel,
    pub(super) precision: Precision,
    pub(super) one_sided: bool,
}

const ONE_POINT: SolidKernel = SolidKernel::Hex8OnePoint(Hex8OnePoint::DEFAULT);

impl Column {
    pub(super) const ALL: [Self; 9] = [
        Self::of("one point", ONE_POINT, Precision::F64),
        Self::of("one point, mixed", ONE_POINT, Precision::Mixed),
        Self::of("one point, f32", ONE_POINT, Precision::F32),
        Self {
            one_sided: true,
            ..Self::of("one point, one-sided", ONE_POINT, Precision::F64)
        },
        Self::of("full", SolidKernel::Hex8Full, Precision::F64),
        Self::of("full, mixed", SolidKernel::Hex8Full, Precision::Mixed),
        Self::of("B-bar", SolidKernel::Hex8BBar, Precision::F64),
        Self::of("wedge", SolidKernel::Wedge6, Precision::F64),
        Self::of("tetrahedron", SolidKernel::Tet4, Precision::F64),
    ];

    const fn of(name: &'static str, kernel: SolidKernel, precision: Precision) -> Self {
        Self {
            name,
            kernel,
            precision,
            one_sided: false,
        }
    }

    pub(super) fn integrator(&self) -> &'static dyn TimeIntegrator {
        if self.one_sided { &OneSided } else { &Leapfrog }
    }

    /// A box of cells with one corner at the origin, of the kind of element that the kernel takes.
    pub(super) fn boxed(&self, size: Vec3, cells: [usize; 3]) -> Result<Mesh, MeshError> {
        let make = match self.kernel.kind() {
            ElementKind::Tet4 => Mesh::box_of_tets,
            ElementKind::Wedge6 => Mesh::box_of_wedges,
            _ => Mesh::box_of_hexes,
        };
        make(Vec3::zeros(), size, cells, SET)
    }

    /// Number of elements of a cell of such a box.
    pub(super) fn elements_per_cell(&self) -> usize {
        match self.kernel.kind() {
            ElementKind::Tet4 => 6,
            ElementKind::Wedge6 => 2,
            _ => 1,
        }
    }

    /// The kernel with a material.
    pub(super) fn factory(&self, material: &Material, damping: Rayleigh) -> Box<dyn BlockFactory> {
        let mut options = BlockOptions::default();
        (options.precision, options.damping) = (self.precision, damping);
        Kernel::from(self.kernel).factory(SET, material, options)
    }
}
