//! Ramp of the virtual motion across a section.

use std::collections::{HashMap, HashSet};

use powerhouse_model::{DisjointSets, ElementKind, Facet, Mesh, Vec3};

use super::functional::MOST_NODES;
use super::pieces::connected;
use super::plane::Plane;

/// Range of a ramp: signed distances (m) from the plane at which it is zero and one.
type Range = [f64; 2];

/// Distance from the plane, in lengths of an element, within which ends of the body are looked for: more than the farthest
/// node that a ramp and its correction reach.
pub(super) const REACH: f64 = 3.5;
/// Cosine of the angle between the normals of a section and of a facet above which the facet is an end, not a side.
const END: f64 = 0.5;
/// Distance of the centre of a ramp from the plane, in lengths of an element, up to which it is not corrected.
const CENTRED: f64 = 0.05;
/// Least distance between the centres of two ramps, in lengths of an element, between which values are extrapolated.
const APART: f64 = 0.25;

/// Factor of the virtual motion by distance from the plane: zero far on the negative side, one far on the positive side.
///
/// It increases over the length of an element about the plane. A resultant that it yields is the mean over this range. Where the
/// range cannot lie evenly about the plane, because the body ends beside it or the elements of its two sides differ in
/// length, the mean belongs to another place, the *centre* of the ramp; then two or three ramps are combined, so that a resultant
/// that changes linearly is that at the plane.
pub(super) struct Ramp {
    /// Weights, whose sum is one, of simple ramps.
    parts: Vec<(f64, Range)>,
    /// Whether the plane cuts a face at which the body ends, whose support then does work.
    pub(super) cuts_end: bool,
}

/// Factor of a simple ramp.
fn factor([from, to]: Range, distance: f64) -> f64 {
    ((distance - from) / (to - from)).clamp(0.0, 1.0)
}

impl Ramp {
    /// The ramp across a plane through some elements, of which it cuts those given, whose mean length across the plane is
    /// `length` (m).
    pub(super) fn across(
        mesh: &Mesh,
        plane: &Plane,
        elements: &[u32],
        cut: &[u32],
        length: f64,
    ) -> Self {
        let near = around(mesh, plane, elements, cut, REACH * length);
        let ends = [*plane, plane.reversed()].map(|plane| end(mesh, &plane, &near));
        let is_cut = |end: &End| end.highest > CENTRED * length;
        let cuts_end = (ends.iter()).any(|end| is_cut(end) && end.lowest > -REACH * length);
        let limits = ends
            .each_ref()
            .map(|end| if is_cut(end) { end.lowest } else { end.highest });
        // Two faces that nearly meet in the plane leave no room.
        let [low, high] = if limits[0] + limits[1] < -0.25 * length {
            [limits[0], -limits[1]]
        } else {
            [ends[0].lowest, -ends[1].lowest]
        };
        let from = if high - low > length {
            (-0.5 * length).max(low).min(high - length)
        } else {
            low
        };
        let first = [from, (from + length).min(high)];
        let centre = |range: Range| centre(mesh, plane, &near, range);
        let mut ramps = vec![(first, centre(first).unwrap_or(0.0))];
        let off = ramps[0].1;
        if off.abs() > CENTRED * length {
            let beside = |range: Range, above: bool| {
                if above {
                    [range[1], (range[1] + length).min(high)]
                } else {
                    [(range[0] - length).max(low), range[0]]
                }
            };
            let is_wide = |range: &Range| range[1] - range[0] >= 0.5 * length;
            // Interpolation, where there is room for it, is better than extrapolation.
            let over = beside(first, off < 0.0);
            let next = beside(first, off > 0.0);
            let others = if is_wide(&over) {
                vec![over]
            } else {
                vec![next, beside(next, off > 0.0)]
            };
            for range in others.into_iter().filter(is_wide) {
                let apart =
                    |known: &(Range, f64), other: f64| (known.1 - other).abs() > APART * length;
                let is_new = |&other: &f64| ramps.iter().all(|known| apart(known, other));
                if let Some(other) = centre(range).filter(is_new) {
                    ramps.push((range, other));
                }
            }
        }
        Self {
            parts: interpolated(&ramps),
            cuts_end,
        }
    }

    /// The factor at a signed distance (m) from the plane.
    pub(super) fn factor(&self, distance: f64) -> f64 {
        let parts = self.parts.iter();
        parts
            .map(|&(weight, range)| weight * factor(range, distance))
            .sum()
    }
}

/// Ramps with weights that make a resultant at the plane of those at their centres: with two exact for a linear one, with three for one
/// that is that of the first ramp but for its linear part. (Moments of lateral loads about the centroid of the section have no linear
/// part, and on an end face those of the first ramp are exact, since the nodal loads there have no arm.)
fn interpolated(ramps: &[(Range, f64)]) -> Vec<(f64, Range)> {
    let weighted = |weight: f64, ramp: &(Range, f64)| (weight, ramp.0);
    match ramps {
        [a, b] => {
            let apart = b.1 - a.1;
            vec![weighted(b.1 / apart, a), weighted(-a.1 / apart, b)]
        }
        [a, b, c] => {
            let square = a.1 * a.1;
            let weight = |own: f64, first: f64, second: f64| {
                (square + first * second) / ((own - first) * (own - second))
            };
            vec![
                weighted(weight(a.1, b.1, c.1), a),
                weighted(weight(b.1, a.1, c.1), b),
                weighted(weight(c.1, a.1, b.1), c),
            ]
        }
        _ => ramps.iter().map(|ramp| weighted(1.0, ramp)).collect(),
    }
}

/// Elements with a node within a distance (m) of the plane that are connected to those it cuts.
fn around(mesh: &Mesh, plane: &Plane, elements: &[u32], cut: &[u32], reach: f64) -> Vec<u32> {
    let is_near = |&element: &u32| {
        let nodes = mesh.nodes_of(element).iter();
        let mut distances = nodes.map(|&node| plane.distance(&mesh.positions()[node as usize]));
        distances.any(|distance| distance.abs() <= reach)
    };
    let near: Vec<u32> = elements.iter().copied().filter(is_near).collect();
    let mut sets = connected(mesh, &near, plane.tolerance);
    let index_of: HashMap<u32, u32> = near.iter().copied().zip(0..).collect();
    let cut = cut.iter().filter_map(|element| index_of.get(element));
    let roots: HashSet<u32> = cut.map(|&index| sets.root(index)).collect();
    (near.iter().zip(0..))
        .filter(|&(_, index)| roots.contains(&sets.root(index)))
        .map(|(&element, _)| element)
        .collect()
}

/// Where a body ends on the negative side of a plane.
struct End {
    /// Signed distances (m) of its lowest node, and of the highest node of the face at that node.
    lowest: f64,
    highest: f64,
}

/// Where elements around a plane end on its negative side.
fn end(mesh: &Mesh, plane: &Plane, elements: &[u32]) -> End {
    let distance = |node: &u32| plane.distance(&mesh.positions()[*node as usize]);
    let nodes = elements.iter().flat_map(|&element| mesh.nodes_of(element));
    let lowest = nodes.map(distance).fold(f64::INFINITY, f64::min);
    let facets: Vec<Vec<u32>> = outer_facets(mesh, elements)
        .into_iter()
        .filter(|&facet| mesh.facet_geometry(facet).normal().dot(&plane.normal) < -END)
        .map(|facet| mesh.facet_corners(facet))
        .collect();
    let mut sets = DisjointSets::new(facets.len());
    let mut first_of: HashMap<[u32; 2], u32> = HashMap::new();
    for (facet, index) in facets.iter().zip(0..) {
        let following = facet.iter().cycle().skip(1);
        for (&from, &to) in facet.iter().zip(following) {
            let first = *first_of
                .entry([from.min(to), from.max(to)])
                .or_insert(index);
            sets.join(first, index);
        }
    }
    let at_lowest =
        |facet: &&Vec<u32>| (facet.iter()).any(|node| distance(node) <= lowest + plane.tolerance);
    let of_end: HashSet<u32> = (facets.iter().zip(0..))
        .filter(|(facet, _)| at_lowest(facet))
        .map(|(_, index)| sets.root(index))
        .collect();
    let highest = (facets.iter().zip(0..))
        .filter(|&(_, index)| of_end.contains(&sets.root(index)))
        .flat_map(|(facet, _)| facet.iter().map(distance))
        .fold(lowest, f64::max);
    End { lowest, highest }
}

/// Facets that belong to one of the elements alone.
fn outer_facets(mesh: &Mesh, elements: &[u32]) -> Vec<Facet> {
    let mut facets: Vec<(Vec<u32>, Facet)> = Vec::new();
    for &element in elements {
        let sides = 0..mesh.kind(element).sides().len() as u8;
        facets.extend(sides.map(|side| {
            let facet = Facet { element, side };
            let mut corners = mesh.facet_corners(facet);
            corners.sort_unstable();
            (corners, facet)
        }));
    }
    facets.sort_unstable_by(|a, b| a.0.cmp(&b.0));
    let groups = facets.chunk_by(|a, b| a.0 == b.0);
    groups
        .filter(|group| group.len() == 1)
        .map(|group| group[0].1)
        .collect()
}

/// Signed distance (m) from the plane of the place to which resultants by a simple ramp belong: the mean of the distance, weighted by
/// the derivative across the plane of the virtual motion, as the elements interpolate it. None if it strains no element.
fn centre(mesh: &Mesh, plane: &Plane, elements: &[u32], range: Range) -> Option<f64> {
    let (mut whole, mut moment) = (0.0, 0.0);
    let (mut values, mut gradients) = ([0.0; MOST_NODES], [Vec3::zeros(); MOST_NODES]);
    for &element in elements {
        let kind = mesh.kind(element);
        let nodes = mesh.nodes_of(element);
        let at = nodes.iter().map(|&node| mesh.positions()[node as usize]);
        let at: Vec<(Vec3, f64)> = at.map(|at| (at, plane.distance(&at))).collect();
        let natural = kind.natural_corners();
        let middle = natural.iter().copied().map(Vec3::from).sum::<Vec3>() / natural.len() as f64;
        for &corner in natural {
            // The points of two by two by two of a brick; in other shapes alike.
            let point = middle + (Vec3::from(corner) - middle) / 3.0_f64.sqrt();
            kind.shape_functions(&point, &mut values);
            kind.shape_gradients(&point, &mut gradients);
            let (mut jacobian, mut slope, mut distance) = ([Vec3::zeros(); 3], Vec3::zeros(), 0.0);
            for ((at, from_plane), (value, gradient)) in
                at.iter().zip(values.iter().zip(&gradients))
            {
                distance += value * from_plane;
                slope += gradient * factor(range, *from_plane);
                for (row, by) in jacobian.iter_mut().zip(gradient.iter()) {
                    *row += at * *by;
                }
            }
            let [r, s, t] = jacobian;
            let cofactors = [s.cross(&t), t.cross(&r), r.cross(&s)];
            // The gradient times the determinant, which is the volume of a point but for a factor of the shape.
            let gradient: Vec3 = cofactors
                .iter()
                .zip(slope.iter())
                .map(|(c, by)| c * *by)
                .sum();
            let volume = natural_volume(kind) / natural.len() as f64;
            let weight = volume * gradient.dot(&plane.normal);
            whole += weight;
            moment += weight * distance;
        }
    }
    (whole > 0.0).then(|| moment / whole)
}

/// Volume of a shape in natural coordinates.
fn natural_volume(kind: ElementKind) -> f64 {
    match kind {
        ElementKind::Wedge6 => 1.0,
        ElementKind::Tet4 | ElementKind::Tet10 => 1.0 / 6.0,
        // Pyramids are bricks whose top is one node.
        _ => 8.0,
    }
}
