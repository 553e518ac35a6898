//! How a plane meets elements.

use powerhouse_model::{ElementKind, Mesh, Vec3};

use super::{Cut, SectionGeometry};

/// A plane that cuts space in two; the normal points to the positive side.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    pub(super) point: Vec3,
    pub(super) normal: Vec3,
    /// Places this close (m) count as on the plane.
    pub(super) tolerance: f64,
    /// Whether what is on the plane counts with the positive side, or with the negative one.
    pub(super) own_positive: bool,
}

impl Plane {
    /// Distance (m), negative on the negative side.
    pub(super) fn distance(&self, place: &Vec3) -> f64 {
        self.normal.dot(&(place - self.point))
    }
    /// Whether a place counts with the positive side.
    pub(super) fn positive(&self, place: &Vec3) -> bool {
        match self.own_positive {
            true => self.distance(place) >= -self.tolerance,
            false => self.distance(place) > self.tolerance,
        }
    }
}

/// Area and first moments of polygons in a plane, and how far they reach.
#[derive(Clone, Debug, Default)]
struct PlaneArea {
    /// Area (m2).
    area: f64,
    /// Integral of the position (m3).
    first_moment: Vec3,
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

impl PlaneArea {
    /// Adds the polygon in which the plane meets an element; warped sides are made of triangles.
    fn add(&mut self, plane: &Plane, kind: ElementKind, corners: &[Vec3]) {
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
        let above: Vec<usize> = (0..4).filter(|&i| plane.positive(&corners[i])).collect();
        let below: Vec<usize> = (0..4).filter(|&i| !plane.positive(&corners[i])).collect();
        // Where the plane meets the edge between a corner above and one below; on the plane, the
        // one that counts as on it.
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

    /// How far the corners reach along a direction (m).
    fn extent(&self, direction: &Vec3) -> f64 {
        let along = self.corners.iter().map(|corner| corner.dot(direction));
        let (low, high) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
            (low.min(x), high.max(x))
        });
        high - low
    }
}

/// What a plane meets of a body, and how a virtual motion rises across it.
pub(super) struct Section {
    plane: Plane,
    polygons: PlaneArea,
    /// How many elements the plane meets.
    elements: usize,
    /// Distances (m) from the plane between which the motion rises.
    rise: (f64, f64),
}

/// What a plane meets of elements, or nothing.
pub(super) fn meet(mesh: &Mesh, plane: Plane, elements: &[u32]) -> Option<Section> {
    let mut polygons = PlaneArea::default();
    let (mut lowest, mut highest) = (f64::INFINITY, f64::NEG_INFINITY);
    let (mut met, mut lengths) = (0, 0.0);
    for &element in elements {
        let nodes = mesh.nodes_of(element).iter();
        let corners: Vec<Vec3> = nodes.map(|&node| mesh.positions()[node as usize]).collect();
        let distances = corners.iter().map(|corner| plane.distance(corner));
        let (low, high) = distances.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), d| {
            (low.min(d), high.max(d))
        });
        (lowest, highest) = (lowest.min(low), highest.max(high));
        let above = corners
            .iter()
            .filter(|corner| plane.positive(corner))
            .count();
        if above > 0 && above < corners.len() {
            polygons.add(&plane, mesh.kind(element), &corners);
            met += 1;
            lengths += high - low;
        }
    }
    let half = 0.5 * lengths / f64::from(met);
    (polygons.area > 0.0).then_some(Section {
        plane,
        polygons,
        elements: met as usize,
        rise: (lowest.max(-half), highest.min(half)),
    })
}

impl Section {
    /// Zero on the negative side, one on the positive side.
    pub(super) fn ramp(&self, place: &Vec3) -> f64 {
        let (from, to) = self.rise;
        ((self.plane.distance(place) - from) / (to - from)).clamp(0.0, 1.0)
    }

    /// The elements that the virtual motion strains.
    pub(super) fn strained(&self, mesh: &Mesh, elements: &[u32]) -> Vec<u32> {
        let strained = |&element: &u32| {
            let nodes = mesh.nodes_of(element).iter();
            let shares = nodes.map(|&node| self.ramp(&mesh.positions()[node as usize]));
            let (low, high) = shares.fold((1.0_f64, 0.0_f64), |(low, high), share| {
                (low.min(share), high.max(share))
            });
            high > 0.0 && low < 1.0
        };
        elements.iter().copied().filter(strained).collect()
    }

    pub(super) fn geometry(&self, cut: &Cut, along: Vec3) -> SectionGeometry {
        let across = along.cross(&self.plane.normal);
        SectionGeometry {
            name: cut.name.clone(),
            area: self.polygons.area,
            centroid: self.polygons.first_moment / self.polygons.area,
            width: self.polygons.extent(&along),
            depth: self.polygons.extent(&across),
            normal: self.plane.normal,
            along,
            across,
            elements: self.elements,
        }
    }
}
