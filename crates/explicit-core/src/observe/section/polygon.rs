//! The area in which a plane meets elements.

use powerhouse_model::{ElementKind, Vec3};

/// A plane that cuts space in two; the normal points to the positive side.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    pub(super) point: Vec3,
    pub(super) normal: Vec3,
    /// Nodes this close (m) count as on the plane, and these as on the positive side.
    pub(super) tolerance: f64,
}

impl Plane {
    /// Distance (m) of a place on the positive side, none on the negative side.
    pub(super) fn positive(&self, place: &Vec3) -> Option<f64> {
        let distance = self.normal.dot(&(place - self.point));
        (distance >= -self.tolerance).then_some(distance.max(0.0))
    }
}

/// Area and first moments of polygons in a plane, and how far they reach.
#[derive(Clone, Debug, Default)]
pub(super) struct PlaneArea {
    /// Area (m2).
    pub(super) area: f64,
    /// Integral of the position (m3).
    pub(super) first_moment: Vec3,
    /// Corners of the polygons (m).
    pub(super) corners: Vec<Vec3>,
}

const HEX_TETS: [[usize; 4]; 6] = [
    [0, 1, 2, 6],
    [0, 5, 1, 6],
    [0, 2, 3, 6],
    [0, 3, 7, 6],
    [0, 4, 5, 6],
    [0, 7, 4, 6],
];
const WEDGE_TETS: [[usize; 4]; 3] = [[0, 1, 2, 5], [0, 1, 5, 4], [0, 4, 5, 3]];
const TET: [[usize; 4]; 1] = [[0, 1, 2, 3]];

impl PlaneArea {
    /// Adds the polygon in which the plane meets an element; warped sides are made of triangles.
    pub(super) fn add(&mut self, plane: &Plane, kind: ElementKind, corners: &[Vec3]) {
        let tets: &[[usize; 4]] = match kind {
            ElementKind::Hex8 => &HEX_TETS,
            ElementKind::Wedge6 => &WEDGE_TETS,
            ElementKind::Tet4 => &TET,
            _ => &[],
        };
        for tet in tets {
            self.add_tet(plane, &tet.map(|corner| corners[corner]));
        }
    }

    fn add_tet(&mut self, plane: &Plane, corners: &[Vec3; 4]) {
        let side = corners.map(|corner| plane.positive(&corner));
        let above: Vec<usize> = (0..4).filter(|&i| side[i].is_some()).collect();
        let below: Vec<usize> = (0..4).filter(|&i| side[i].is_none()).collect();
        // Where the plane meets the edge between a corner above and one below.
        let meet = |up: usize, down: usize| {
            let height = side[up].unwrap_or_default();
            let depth = plane.normal.dot(&(plane.point - corners[down]));
            corners[up] + (corners[down] - corners[up]) * (height / (height + depth))
        };
        match (&above[..], &below[..]) {
            ([a], [b, c, d]) => self.add_triangle([meet(*a, *b), meet(*a, *c), meet(*a, *d)]),
            ([b, c, d], [a]) => self.add_triangle([meet(*b, *a), meet(*c, *a), meet(*d, *a)]),
            ([a, b], [c, d]) => {
                let ring = [meet(*a, *c), meet(*a, *d), meet(*b, *d), meet(*b, *c)];
                self.add_triangle([ring[0], ring[1], ring[2]]);
                self.add_triangle([ring[0], ring[2], ring[3]]);
            }
            _ => {}
        }
    }

    fn add_triangle(&mut self, [a, b, c]: [Vec3; 3]) {
        let area = 0.5 * (b - a).cross(&(c - a)).norm();
        self.area += area;
        self.first_moment += (a + b + c) * (area / 3.0);
        if area > 0.0 {
            self.corners.extend([a, b, c]);
        }
    }

    /// How far the corners reach along a direction (m).
    pub(super) fn extent(&self, direction: &Vec3) -> f64 {
        let along = self.corners.iter().map(|corner| corner.dot(direction));
        let (low, high) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
            (low.min(x), high.max(x))
        });
        high - low
    }
}
