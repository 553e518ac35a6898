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
    /// that cuts it across y, through the middle of its elements by their centroids, or of the box if none are given.
    pub fn into_body([low, high]: [Vec3; 2], centroids: &[Vec3]) -> (Self, Option<SectionPlane>) {
        match slice(&(high - low)) {
            Some(direction) => (Self::along(direction), None),
            None => {
                let plane = SectionPlane {
                    point: middle(centroids).unwrap_or((low + high) / 2.0),
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

/// Where most of some points are: along each axis the middle between a quarter and three quarters of them. It is the middle of a
/// symmetric body, and in small elements where those of a structure are smaller.
fn middle(points: &[Vec3]) -> Option<Vec3> {
    let last = points.len().checked_sub(1)?;
    let along = |axis: usize| {
        let mut all: Vec<f64> = points.iter().map(|point| point[axis]).collect();
        let quarter = last / 4;
        let (_, &mut low, rest) = all.select_nth_unstable_by(quarter, f64::total_cmp);
        // The place from the other end, so that both quarters have the same number of points.
        let from_low = (last - quarter).checked_sub(quarter + 1);
        let high = match from_low {
            Some(place) => *rest.select_nth_unstable_by(place, f64::total_cmp).1,
            None => low,
        };
        (low + high) / 2.0
    };
    Some(Vec3::new(along(0), along(1), along(2)))
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

#[cfg(test)]
mod tests {
    use super::*;

    /// The middle of a symmetric body is that of its box; small elements on one side draw it there.
    #[test]
    fn a_body_is_cut_where_most_elements_are() {
        let cut = |heights: &[f64]| {
            let centroids: Vec<Vec3> = heights.iter().map(|&y| Vec3::new(5.0, y, 5.0)).collect();
            let (_, plane) =
                PictureView::into_body([Vec3::zeros(), Vec3::repeat(10.0)], &centroids);
            plane.unwrap().point.y
        };
        assert_eq!(cut(&[]), 5.0);
        assert_eq!(cut(&[1.0, 3.0, 7.0, 9.0]), 5.0);
        assert_eq!(cut(&[9.0, 1.0, 5.0]), 5.0);
        assert_eq!(cut(&[2.0]), 2.0);
        let near = cut(&[1.0, 1.5, 1.75, 2.0, 2.25, 2.5, 4.0, 7.0, 9.0]);
        // Between the third from either end.
        assert_eq!(near, (1.75 + 4.0) / 2.0);
    }
}
