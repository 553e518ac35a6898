//! Where a picture is taken from.

use powerhouse_model::Vec3;

/// A parallel projection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PictureView {
    /// The direction of sight, of any length.
    pub direction: Vec3,
    /// What points up in the picture, of any length; if it lies along the direction of sight,
    /// another axis takes its place.
    pub up: Vec3,
}

impl PictureView {
    /// From above, in front (small y) and aside (large x); z is up.
    pub fn aslant() -> Self {
        Self {
            direction: Vec3::new(-0.5, 1.0, -0.55),
            up: Vec3::z(),
        }
    }
    /// Along a direction, z up or, seen along z, y up.
    pub fn along(direction: Vec3) -> Self {
        Self {
            direction,
            up: Vec3::z(),
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
