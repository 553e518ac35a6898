//! Element kernels: bricks, wedge and tetrahedron.

mod hex8_integrated;
mod hex8_one_point;
mod hexahedron;
mod parallelepiped;
#[cfg(test)]
mod tests;
mod tet4;
mod vectors;
mod wedge6;

pub use hex8_integrated::{Hex8BBar, Hex8Full};
pub use hex8_one_point::Hex8OnePoint;
pub use tet4::Tet4;
pub use wedge6::Wedge6;

use powerhouse_model::{ConstitutiveLaw, ElementKernel, ElementKind};

use crate::block::{Erased, erased};
use crate::{BlockFactory, BlockOptions};

/// The kernels of this crate, by name.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum SolidKernel {
    /// [`Hex8OnePoint`].
    Hex8OnePoint(Hex8OnePoint),
    /// [`Hex8Full`].
    Hex8Full,
    /// [`Hex8BBar`].
    Hex8BBar,
    /// [`Tet4`].
    Tet4,
    /// [`Wedge6`].
    Wedge6,
}

impl SolidKernel {
    /// All of them, with their default parameters.
    pub const ALL: [Self; 5] = [
        Self::Hex8OnePoint(Hex8OnePoint::DEFAULT),
        Self::Hex8Full,
        Self::Hex8BBar,
        Self::Tet4,
        Self::Wedge6,
    ];

    /// The name in scenes and reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Hex8OnePoint(kernel) => kernel.name(),
            Self::Hex8Full => Hex8Full.name(),
            Self::Hex8BBar => Hex8BBar.name(),
            Self::Tet4 => Tet4.name(),
            Self::Wedge6 => Wedge6.name(),
        }
    }
    /// The kernel of a name, with its default parameters.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kernel| kernel.name() == name)
    }
    /// The kind of element that it computes.
    pub fn kind(self) -> ElementKind {
        match self {
            Self::Hex8OnePoint(_) | Self::Hex8Full | Self::Hex8BBar => ElementKind::Hex8,
            Self::Tet4 => ElementKind::Tet4,
            Self::Wedge6 => ElementKind::Wedge6,
        }
    }
    /// How many integration points an element has.
    pub fn points(self) -> usize {
        fn points<K: ElementKernel<N, P>, const N: usize, const P: usize>(_kernel: &K) -> usize {
            P
        }
        match self {
            Self::Hex8OnePoint(kernel) => points(&kernel),
            Self::Hex8Full => points(&Hex8Full),
            Self::Hex8BBar => points(&Hex8BBar),
            Self::Tet4 => points(&Tet4),
            Self::Wedge6 => points(&Wedge6),
        }
    }
    /// The kernel that suits a kind of element if none is named; none for kinds without volume.
    pub fn default_for(kind: ElementKind) -> Option<Self> {
        Self::ALL.into_iter().find(|kernel| kernel.kind() == kind)
    }
    /// A factory of blocks of this kernel and a law.
    pub fn factory<M: ConstitutiveLaw>(
        self,
        label: &str,
        law: M,
        options: BlockOptions,
    ) -> Box<dyn BlockFactory> {
        self.erased(label, Erased::new(law), options)
    }

    /// Blocks are compiled here, once, and in no crate that uses this one.
    fn erased(self, label: &str, law: Erased, options: BlockOptions) -> Box<dyn BlockFactory> {
        match self {
            Self::Hex8OnePoint(kernel) => {
                parallelepiped::one_point_bricks(label, kernel, law, options)
            }
            Self::Hex8Full => erased(label, Hex8Full, law, options),
            Self::Hex8BBar => erased(label, Hex8BBar, law, options),
            Self::Tet4 => erased(label, Tet4, law, options),
            Self::Wedge6 => erased(label, Wedge6, law, options),
        }
    }
}
