//! Direction from which a picture is drawn.

use powerhouse_model::Vec3;

use super::SectionPlane;

/// Extent of a body over its next larger one (1) below which it is a slice.
const SLICE: f64 = 0.15;

/// View of a picture: a parallel projection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PictureView {
    /// Direction of view, away from the viewer, of any length.
    pub direction: Vec3,
    /// Direction that points up in the picture, of any length; if it is along the direction of view,
    /// another axis is used.
    pub up: Vec3,
}

impl PictureView {
    /// View from above, the front (small y) and the side (large x), with z up.
    pub fn aslant() -> Self {
        Self {
            direction: Vec3::new(-0.5, 1.0, -0.55),
            up: Vec3::z(),
        }
    }
    /// View along a direction, with z up or, for a view along z, y up.
    pub fn along(direction: Vec3) -> Self {
        Self {
            direction,
            up: Vec3::z(),
        }
    }

    /// View of a body of a box (lower and upper corner, m): of a slice straight on, of any other body aslant, with the plane
    /// that cuts it across y in its middle.
    pub fn into_body([low, high]: [Vec3; 2]) -> (Self, Option<SectionPlane>) {
        match slice(&(high - low)) {
            Some(direction) => (Self::along(direction), None),
            None => {
                let plane = SectionPlane {
                    point: (low + high) / 2.0,
                    normal: -Vec3::y(),
                };
                (Self::aslant(), Some(plane))
            }
        }
    }

    /// Unit vectors to the right, up and away from the viewer.
    pub(super) fn axes(&self) -> [Vec3; 3] {
        let away = self.direction.normalize();
        let across = |up: Vec3| away.cross(&up);
        let right = [self.up.normalize(), Vec3::y(), Vec3::x()]
            .into_iter()
            .map(across)
            .find(|right| right.norm() > 1e-6)
            .unwrap_or_else(Vec3::x)
            .normalize();
        [right, right.cross(&away), away]
    }
}

/// Direction across a body of given extents that is a slice.
fn slice(extents: &Vec3) -> Option<Vec3> {
    let thin = extents.imin();
    let others = (0..3).filter(|axis| *axis != thin);
    let next = others
        .map(|axis| extents[axis])
        .fold(f64::INFINITY, f64::min);
    let directions = [-Vec3::x(), Vec3::y(), -Vec3::z()];
    (extents[thin] < SLICE * next).then_some(directions[thin])
}
