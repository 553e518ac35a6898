//! Intersection of a plane with elements.

use powerhouse_model::{ElementKind, Mesh, Vec3};

use super::pieces::pieces;
use super::ramp::Ramp;
use super::{CrossSection, SectionGeometry, SectionPiece};

/// A plane that divides space; the normal points to the positive side.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    pub(super) point: Vec3,
    pub(super) normal: Vec3,
    /// Distance (m) below which a position counts as on the plane.
    pub(super) tolerance: f64,
    /// Whether positions on the plane belong to the positive side, else to the negative one.
    pub(super) own_positive: bool,
}

impl Plane {
    /// Signed distance (m) of a position, negative on the negative side.
    pub(super) fn distance(&self, position: &Vec3) -> f64 {
        self.normal.dot(&(position - self.point))
    }
    /// The same plane seen from its other side.
    pub(super) fn reversed(&self) -> Self {
        Self {
            normal: -self.normal,
            own_positive: !self.own_positive,
            ..*self
        }
    }
    /// Whether a position belongs to the positive side.
    pub(super) fn positive(&self, position: &Vec3) -> bool {
        if self.own_positive {
            self.distance(position) >= -self.tolerance
        } else {
            self.distance(position) > self.tolerance
        }
    }
}

/// Area, first moment and corners of polygons in a plane.
#[derive(Clone, Debug, Default)]
pub(super) struct PlaneArea {
    /// Area (m2).
    pub(super) area: f64,
    /// Integral of the position (m3).
    pub(super) first_moment: Vec3,
    /// Corners of the polygons (m).
    corners: Vec<Vec3>,
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
const PYRAMID_TETS: [[usize; 4]; 2] = [[0, 1, 2, 4], [0, 2, 3, 4]];

impl PlaneArea {
    /// Adds the intersection polygon of the plane with an element; warped sides are divided into triangles.
    pub(super) fn add(&mut self, plane: &Plane, kind: ElementKind, corners: &[Vec3]) {
        let tets: &[[usize; 4]] = match kind {
            ElementKind::Hex8 => &HEX_TETS,
            ElementKind::Wedge6 => &WEDGE_TETS,
            ElementKind::Tet4 | ElementKind::Tet10 => &TET,
            ElementKind::Pyramid5 => &PYRAMID_TETS,
            _ => &[],
        };
        for tet in tets {
            self.add_tet(plane, &tet.map(|corner| corners[corner]));
        }
    }

    fn add_tet(&mut self, plane: &Plane, corners: &[Vec3; 4]) {
        let above: Vec<usize> = (0..4).filter(|&i| plane.positive(&corners[i])).collect();
        let below: Vec<usize> = (0..4).filter(|&i| !plane.positive(&corners[i])).collect();
        // Intersection of the plane with the edge between a corner above and one below; a corner on the plane is the
        // intersection itself.
        let meet = |up: usize, down: usize| {
            let height = plane.distance(&corners[up]).max(0.0);
            let depth = (-plane.distance(&corners[down])).max(0.0);
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

    /// Extent of the polygons along a direction (m).
    pub(super) fn extent(&self, direction: &Vec3) -> f64 {
        let along = self.corners.iter().map(|corner| corner.dot(direction));
        let (low, high) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
            (low.min(x), high.max(x))
        });
        high - low
    }
}

/// Intersection of a plane with elements.
pub(super) struct Intersection {
    plane: Plane,
    polygons: PlaneArea,
    /// Elements that the plane intersects.
    elements: Vec<u32>,
    /// Mean length (m) of these elements across the plane.
    length: f64,
}

/// Intersection of a plane with elements; none without area.
pub(super) fn intersect(mesh: &Mesh, plane: Plane, elements: &[u32]) -> Option<Intersection> {
    let mut polygons = PlaneArea::default();
    let (mut cut, mut lengths) = (Vec::new(), 0.0);
    for &element in elements {
        let nodes = mesh.nodes_of(element).iter();
        let corners: Vec<Vec3> = nodes.map(|&node| mesh.positions()[node as usize]).collect();
        let distances = corners.iter().map(|corner| plane.distance(corner));
        let (low, high) = distances.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), d| {
            (low.min(d), high.max(d))
        });
        let above = corners
            .iter()
            .filter(|corner| plane.positive(corner))
            .count();
        if above > 0 && above < corners.len() {
            polygons.add(&plane, mesh.kind(element), &corners);
            cut.push(element);
            lengths += high - low;
        }
    }
    let length = lengths / cut.len() as f64;
    (polygons.area > 0.0).then_some(Intersection {
        plane,
        polygons,
        elements: cut,
        length,
    })
}

impl Intersection {
    /// The ramp across the plane of a virtual motion of the given elements.
    pub(super) fn ramp(&self, mesh: &Mesh, elements: &[u32]) -> Ramp {
        Ramp::across(mesh, &self.plane, elements, &self.elements, self.length)
    }

    /// Pieces of the section that do not touch, with their extents along and across.
    pub(super) fn pieces(&self, mesh: &Mesh, along: Vec3) -> Vec<SectionPiece> {
        let across = along.cross(&self.plane.normal);
        pieces(mesh, &self.plane, &self.elements, [along, across])
    }

    /// Geometry of the section, which cuts an end of the body or does not.
    pub(super) fn geometry(
        &self,
        mesh: &Mesh,
        section: &CrossSection,
        along: Vec3,
        cuts_end: bool,
    ) -> SectionGeometry {
        let across = along.cross(&self.plane.normal);
        SectionGeometry {
            name: section.name.clone(),
            area: self.polygons.area,
            centroid: self.polygons.first_moment / self.polygons.area,
            width: self.polygons.extent(&along),
            depth: self.polygons.extent(&across),
            normal: self.plane.normal,
            along,
            across,
            elements: self.elements.len(),
            cuts_end,
            pieces: self.pieces(mesh, along),
        }
    }
}
