//! Element kernels: bricks, wedge, tetrahedra and pyramid.

mod by_shape;
mod hex8_eas;
mod hex8_integrated;
mod hex8_natural;
mod hex8_one_point;
mod hexahedron;
mod mean_gradient;
mod natural_frame;
mod parallelepiped;
mod pyramid5;
mod straight_brick;
mod straight_natural;
#[cfg(test)]
mod tests;
mod tet10;
mod tet4;
mod vectors;
mod wedge6;

pub use hex8_eas::Hex8Eas;
pub use hex8_integrated::{Hex8BBar, Hex8Full};
pub use hex8_natural::Hex8Natural;
pub use hex8_one_point::Hex8OnePoint;
pub use pyramid5::Pyramid5;
pub use tet4::Tet4;
pub use tet10::Tet10;
pub use wedge6::Wedge6;

use powerhouse_model::{BlockFactory, BlockOptions, ElementKernel, ElementKind, PointLaw, Vec3};

use crate::AnyLaw;
use crate::block::of_any_law;

/// Element kernel of this crate, chosen by name.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum SolidKernel {
    /// Eight-node brick with one integration point, [`Hex8OnePoint`].
    Hex8OnePoint(Hex8OnePoint),
    /// Eight-node brick with one integration point that bends as its material does, [`Hex8Natural`].
    Hex8Natural,
    /// Eight-node brick with 2 x 2 x 2 integration points and the bending strains of its material, [`Hex8Eas`].
    Hex8Eas,
    /// Eight-node brick with 2 x 2 x 2 integration points, [`Hex8Full`].
    Hex8Full,
    /// Eight-node brick with mean dilatation, [`Hex8BBar`].
    Hex8BBar,
    /// Four-node tetrahedron, [`Tet4`].
    Tet4,
    /// Six-node wedge, [`Wedge6`].
    Wedge6,
    /// Five-node pyramid, [`Pyramid5`].
    Pyramid5,
    /// Ten-node composite tetrahedron, [`Tet10`].
    Tet10,
}

impl SolidKernel {
    /// The eight-node brick with one integration point, with its default parameters.
    pub const ONE_POINT: Self = Self::Hex8OnePoint(Hex8OnePoint::DEFAULT);

    /// All kernels, with their default parameters.
    pub const ALL: [Self; 9] = [
        Self::ONE_POINT,
        Self::Hex8Natural,
        Self::Hex8Eas,
        Self::Hex8Full,
        Self::Hex8BBar,
        Self::Tet4,
        Self::Wedge6,
        Self::Pyramid5,
        Self::Tet10,
    ];

    /// Name of the kernel in scenes and reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Hex8OnePoint(kernel) => kernel.name(),
            Self::Hex8Natural => Hex8Natural.name(),
            Self::Hex8Eas => Hex8Eas::NAME,
            Self::Hex8Full => Hex8Full.name(),
            Self::Hex8BBar => Hex8BBar.name(),
            Self::Tet4 => Tet4.name(),
            Self::Wedge6 => Wedge6.name(),
            Self::Pyramid5 => Pyramid5.name(),
            Self::Tet10 => Tet10::NAME,
        }
    }
    /// The kernel with a name, with its default parameters.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kernel| kernel.name() == name)
    }
    /// Kind of elements that the kernel computes.
    pub fn kind(self) -> ElementKind {
        match self {
            Self::Hex8OnePoint(_)
            | Self::Hex8Natural
            | Self::Hex8Eas
            | Self::Hex8Full
            | Self::Hex8BBar => ElementKind::Hex8,
            Self::Tet4 => ElementKind::Tet4,
            Self::Wedge6 => ElementKind::Wedge6,
            Self::Pyramid5 => ElementKind::Pyramid5,
            Self::Tet10 => ElementKind::Tet10,
        }
    }
    /// Number of integration points of an element.
    pub fn points(self) -> usize {
        fn points<K: ElementKernel<N, P>, const N: usize, const P: usize>(_kernel: &K) -> usize {
            P
        }
        match self {
            Self::Hex8OnePoint(kernel) => points(&kernel),
            Self::Hex8Natural => points(&Hex8Natural),
            Self::Hex8Eas | Self::Hex8Full => points(&Hex8Full),
            Self::Hex8BBar => points(&Hex8BBar),
            Self::Tet4 => points(&Tet4),
            Self::Wedge6 => points(&Wedge6),
            Self::Pyramid5 => points(&Pyramid5),
            Self::Tet10 => Tet10::POINTS,
        }
    }
    /// Number of history variables of an element as a whole, with laws that have a history.
    pub fn own_history(self) -> usize {
        match self {
            Self::Hex8Natural => powerhouse_model::HistoryKernel::<8, 1>::own_history(&Hex8Natural),
            Self::Hex8Eas => Hex8Eas::HISTORY,
            Self::Pyramid5 => powerhouse_model::HistoryKernel::<5, 1>::own_history(&Pyramid5),
            _ => 0,
        }
    }
    /// Whether straight elements in one layer have the bending stiffness of a plate of their material.
    pub fn bends_as_its_material(self) -> bool {
        matches!(self, Self::Hex8Natural | Self::Hex8Eas)
    }
    /// The default kernel of a kind of elements; none for kinds without volume.
    pub fn default_for(kind: ElementKind) -> Option<Self> {
        match kind {
            ElementKind::Hex8 => Some(Self::Hex8Natural),
            _ => Self::ALL.into_iter().find(|kernel| kernel.kind() == kind),
        }
    }
    /// A factory of blocks of this kernel and a law for an element set.
    pub fn factory(
        self,
        label: &str,
        law: impl Into<AnyLaw>,
        options: BlockOptions,
    ) -> Box<dyn BlockFactory> {
        self.of_any_law(label, law.into(), options)
    }

    /// A factory of blocks of this kernel with the arithmetic of elements of any shape, also where those of
    /// [`factory`](Self::factory) use a shorter form for boxes and parallelepipeds: to compare one with the other.
    pub fn factory_of_any_shape(
        self,
        label: &str,
        law: impl Into<AnyLaw>,
        options: BlockOptions,
    ) -> Box<dyn BlockFactory> {
        self.of_any_shape(label, law.into(), options)
    }

    /// Blocks are compiled here, once, and in no crate that uses this one.
    fn of_any_law(self, label: &str, law: AnyLaw, options: BlockOptions) -> Box<dyn BlockFactory> {
        let general = self.of_any_shape(label, law.clone(), options);
        match self {
            Self::Hex8OnePoint(kernel) => by_shape::one_point_bricks(general, kernel, law),
            Self::Hex8Natural => by_shape::natural_bricks(general, &law),
            Self::Hex8Full => by_shape::integrated_bricks(general, false, &law),
            Self::Hex8BBar => by_shape::integrated_bricks(general, true, &law),
            _ => general,
        }
    }

    fn of_any_shape(
        self,
        label: &str,
        law: AnyLaw,
        options: BlockOptions,
    ) -> Box<dyn BlockFactory> {
        match self {
            Self::Hex8OnePoint(kernel) => of_any_law(label, kernel, law, options),
            Self::Hex8Natural => of_any_law(label, Hex8Natural, law, options),
            Self::Hex8Eas => {
                let kernel = Hex8Eas::new(&law.medium());
                of_any_law(label, kernel, law, options)
            }
            Self::Hex8Full => of_any_law(label, Hex8Full, law, options),
            Self::Hex8BBar => of_any_law(label, Hex8BBar, law, options),
            Self::Tet4 => of_any_law(label, Tet4, law, options),
            Self::Wedge6 => of_any_law(label, Wedge6, law, options),
            Self::Pyramid5 => of_any_law(label, Pyramid5, law, options),
            Self::Tet10 => {
                let kernel = Tet10::new(&law.medium());
                of_any_law(label, kernel, law, options)
            }
        }
    }
}

/// Positions (m) of points with natural coordinates in an element of a kind with some corners (m).
fn positions<const N: usize, const P: usize>(
    kind: ElementKind,
    corners: &[Vec3; N],
    points: [[f64; 3]; P],
) -> [Vec3; P] {
    points.map(|natural| {
        let mut values = [0.0; N];
        kind.shape_functions(&Vec3::from(natural), &mut values);
        let terms = corners.iter().zip(values);
        terms.fold(Vec3::zeros(), |sum, (corner, value)| sum + corner * value)
    })
}
