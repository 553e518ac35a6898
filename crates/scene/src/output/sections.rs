//! Warnings about sections whose forces are not those of the part that the user has in mind.

use powerhouse_model::{ElementKind, Mesh, Vec3};
use powerhouse_observe::{CrossSection, SectionGeometry};

use super::SectionRequest;
use crate::surroundings::fill_body;
use crate::{Remark, remark};

/// Warning about a section through pieces that do not touch, such as crown and invert of a lining.
pub(super) fn in_pieces(
    mesh: &Mesh,
    request: &SectionRequest,
    geometry: &SectionGeometry,
) -> Option<Remark> {
    (geometry.pieces.len() > 1).then(|| {
        Remark::from(remark::DividedSection {
            section: request.cut.name.clone(),
            set: request.set.clone(),
            pieces: geometry.pieces.clone(),
            half_extent: half_extent_of_nearest(mesh, &request.cut.point, geometry),
        })
    })
}

/// Share of the product of its extents that the area of a section fills, below which it is a frame or a ring.
const FILLED: f64 = 0.5;

/// Whether every element that a section cuts reaches from end to end of the body along the normal: the section of the whole tube
/// in a slice, of which there is no other.
pub(super) fn is_of_slice(mesh: &Mesh, geometry: &SectionGeometry) -> bool {
    let elements = geometry.pieces.iter().flat_map(|piece| &piece.elements);
    fill_body(mesh, elements.copied(), &geometry.normal)
}

/// Warning about a section in one piece that is a frame or a ring, such as that of a closed lining.
pub(super) fn hollow(request: &SectionRequest, geometry: &SectionGeometry) -> Option<Remark> {
    let [piece] = &geometry.pieces[..] else {
        return None;
    };
    let filled = piece.area / (piece.width * piece.depth);
    (filled < FILLED).then(|| {
        Remark::from(remark::HollowSection {
            section: request.cut.name.clone(),
            set: request.set.clone(),
            filled,
            width: piece.width,
            depth: piece.depth,
        })
    })
}

/// Warning about a section that cuts a face at which its elements end.
pub(super) fn through_end(request: &SectionRequest, geometry: &SectionGeometry) -> Option<Remark> {
    geometry.cuts_end.then(|| {
        Remark::from(remark::SectionThroughEnd {
            section: request.cut.name.clone(),
            set: request.set.clone(),
        })
    })
}

/// Half edge lengths (m) of cubes around a point that contain the centroids of the elements of the nearest piece and of
/// no other one: the least and the greatest. None if there are no such cubes.
fn half_extent_of_nearest(
    mesh: &Mesh,
    point: &Vec3,
    geometry: &SectionGeometry,
) -> Option<[f64; 2]> {
    let extents = geometry.pieces.iter().map(|piece| {
        let distances = piece.elements.iter();
        let distances = distances.map(|&element| (mesh.centroid(element) - point).amax());
        distances.fold((f64::INFINITY, 0.0_f64), |(least, most), distance| {
            (least.min(distance), most.max(distance))
        })
    });
    let mut extents: Vec<(f64, f64)> = extents.collect();
    extents.sort_by(|a, b| a.0.total_cmp(&b.0));
    let millimetres = |length: f64| 1e3 * length;
    match extents[..] {
        [(_, needed), (others, _), ..] => {
            let reach = [
                millimetres(needed).ceil().max(1.0) / 1e3,
                millimetres(others).floor() / 1e3,
            ];
            (reach[0] < reach[1]).then_some(reach)
        }
        _ => None,
    }
}

/// Warning about a section through linear tetrahedra.
pub(super) fn through_tetrahedra(
    mesh: &Mesh,
    request: &SectionRequest,
    elements: &[u32],
) -> Option<Remark> {
    let CrossSection {
        point,
        normal,
        within,
        ..
    } = &request.cut;
    let beyond = |&node: &u32| (mesh.positions()[node as usize] - point).dot(normal);
    let counts = |element: u32| {
        let centre = mesh.centroid(element);
        within.as_ref().is_none_or(|(low, high)| {
            (0..3).all(|axis| (low[axis]..=high[axis]).contains(&centre[axis]))
        })
    };
    let is_cut = |element: &&u32| {
        let sides = mesh.nodes_of(**element).iter().map(beyond);
        let [least, most] = sides.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], side| {
            [low.min(side), high.max(side)]
        });
        least <= 0.0 && most >= 0.0 && counts(**element)
    };
    let cut: Vec<&u32> = elements.iter().filter(is_cut).collect();
    let tetrahedra = cut.iter().filter(|e| mesh.kind(***e) == ElementKind::Tet4);
    let tetrahedra = tetrahedra.count();
    (tetrahedra > 0).then(|| {
        Remark::from(remark::TetrahedralSection {
            section: request.cut.name.clone(),
            set: request.set.clone(),
            elements: tetrahedra,
            of: cut.len(),
        })
    })
}
