//! Factories of bricks that choose the shortest arithmetic for the shapes of a block.

use powerhouse_model::{
    BlockFactory, BlockOptions, BlockPart, ElementBlock, ElementKind, ModelError, Vec3,
};

use super::hex8_one_point::Hex8OnePoint;
use super::parallelepiped::{Parallelepiped, is_parallelepiped};
use super::straight_brick::{StraightBrick, is_along_axes};
use super::straight_natural::StraightNatural;
use crate::AnyLaw;
use crate::block::of_any_law;

/// Whether a brick with some corners has a shape.
type Shape = fn(&[Vec3; 8]) -> bool;

/// Factory of bricks of any shape, and factories of shorter arithmetic for blocks in which all bricks have a shape.
struct ByShape {
    general: Box<dyn BlockFactory>,
    /// In the order of preference.
    special: Vec<(Shape, Box<dyn BlockFactory>)>,
}

/// A factory of one-point bricks, with the shorter arithmetic where the shapes permit it; `general` makes those of any
/// shape.
pub(super) fn one_point_bricks(
    general: Box<dyn BlockFactory>,
    kernel: Hex8OnePoint,
    law: AnyLaw,
) -> Box<dyn BlockFactory> {
    let kernel = Parallelepiped(kernel);
    let straight = of_any_law(general.label(), kernel, law, general.options());
    let special: Vec<(Shape, _)> = vec![(is_parallelepiped, straight)];
    Box::new(ByShape { general, special })
}

/// A factory of one-point bricks that bend as their material does, likewise.
pub(super) fn natural_bricks(
    general: Box<dyn BlockFactory>,
    law: &AnyLaw,
) -> Box<dyn BlockFactory> {
    let of = |along_axes| {
        let kernel = StraightNatural { along_axes };
        of_any_law(general.label(), kernel, law.clone(), general.options())
    };
    let special: Vec<(Shape, _)> = vec![(is_along_axes, of(true)), (is_parallelepiped, of(false))];
    Box::new(ByShape { general, special })
}

/// A factory of bricks with 2 x 2 x 2 points, likewise, with the mean dilatation if `mean_dilatation` is true.
pub(super) fn integrated_bricks(
    general: Box<dyn BlockFactory>,
    mean_dilatation: bool,
    law: &AnyLaw,
) -> Box<dyn BlockFactory> {
    let of = |along_axes| {
        let kernel = StraightBrick {
            along_axes,
            mean_dilatation,
        };
        of_any_law(general.label(), kernel, law.clone(), general.options())
    };
    let special: Vec<(Shape, _)> = vec![(is_along_axes, of(true)), (is_parallelepiped, of(false))];
    Box::new(ByShape { general, special })
}

impl BlockFactory for ByShape {
    fn label(&self) -> &str {
        self.general.label()
    }
    fn kind(&self) -> ElementKind {
        self.general.kind()
    }
    fn options(&self) -> BlockOptions {
        self.general.options()
    }
    fn relative_cost(&self) -> f64 {
        self.general.relative_cost()
    }
    fn build(&self, part: &BlockPart) -> Result<Box<dyn ElementBlock>, ModelError> {
        let all = |shape: &Shape| {
            part.elements.iter().all(|&element| {
                let nodes: Result<[u32; 8], _> = part.mesh.nodes_of(element).try_into();
                nodes.is_ok_and(|nodes| {
                    shape(&nodes.map(|node| part.mesh.positions()[node as usize]))
                })
            })
        };
        let found = self.special.iter().find(|(shape, _)| all(shape));
        let factory = found.map_or(&self.general, |(_, factory)| factory);
        factory.build(part)
    }
}
