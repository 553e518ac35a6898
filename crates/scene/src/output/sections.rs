//! Section forces, and warnings about those that are not of the part that the user has in mind.

use powerhouse_model::{ElementKind, Mesh, Vec3};
use powerhouse_observe::{CrossSection, SectionForces, SectionGeometry};

use super::{
    OutputItem, OutputPrice, OutputScale, OutputSite, Recorder, RingRequest, SectionRequest,
    TableForm, TablePeaks, TablePlots, capacity, coarse_in_bending, model,
};
use crate::surroundings::fill_body;
use crate::{Error, Remark, Topic, remark};

/// Section forces, with interaction diagrams and the tables of rings.
#[derive(Debug)]
pub(super) struct Sections;

/// Name of the table.
pub(super) const SECTIONS: &str = "sections";
/// Columns of a section.
const COLUMNS: f64 = 9.0;

impl OutputItem for Sections {
    fn record(&self, site: &OutputSite, into: &mut Recorder) -> Result<(), Error> {
        let OutputSite { mesh, plan, .. } = *site;
        if plan.cuts.is_empty() {
            return Ok(());
        }
        let remarks = &mut into.remarks;
        let mut forces = SectionForces::new(site.cadence()).map_err(model)?;
        forces = forces.with_joined_ends(site.pairs.iter().copied());
        let mut capacities = Vec::new();
        for request in &plan.cuts {
            let is_there = |e: &u32| site.present.is_none_or(|present| present[*e as usize]);
            let set = mesh.element_set(&request.set)?;
            let set = request.elements.as_deref().unwrap_or(set).iter().copied();
            let elements: Vec<u32> = set.filter(is_there).collect();
            let geometry = forces
                .add_section(mesh, &request.cut, &elements)
                .map_err(model)?;
            if let Some(bears) = capacity::of_section(request, geometry).map_err(model)? {
                capacities.push((request.cut.name.clone(), bears));
            }
            remarks.extend(in_pieces(mesh, request, geometry));
            if !is_of_slice(mesh, geometry) {
                remarks.extend(hollow(request, geometry));
            }
            remarks.extend(through_end(request, geometry));
            remarks.extend(through_tetrahedra(mesh, request, &elements));
        }
        remarks.extend(plan.rings.iter().filter_map(RingRequest::partial));
        into.geometry = forces.geometries().cloned().collect();
        for (request, geometry) in plan.cuts.iter().zip(&into.geometry) {
            remarks.extend(coarse_in_bending(mesh, request, geometry, site.parts));
        }
        // Sections around a lining have one plot in common.
        let rings = plan.rings.clone();
        let around = rings.iter().flat_map(|ring| &ring.sections);
        let plots = TablePlots::OfNames {
            prefix: "",
            except: around.map(|(_, name)| name.clone()).collect(),
        };
        let mut form = TableForm::new(SECTIONS, plots, TablePeaks::All);
        form.topic = Some(Topic::Sections);
        into.table(form, forces.recording(), |table| table);
        into.observe(forces);
        for (section, bears) in &capacities {
            capacity::list(into, section.clone(), *bears);
        }
        for ring in &rings {
            ring.list(into);
        }
        into.end(move |results| {
            (results.section_capacities, results.section_rings) = (capacities, rings);
        });
        Ok(())
    }
    fn price(&self, scale: &OutputScale) -> OutputPrice {
        let columns = COLUMNS * scale.plan.cuts.len() as f64;
        scale.table(columns, scale.plan.every)
    }
}

/// Warning about a section through pieces that do not touch, such as crown and invert of a lining.
fn in_pieces(mesh: &Mesh, request: &SectionRequest, geometry: &SectionGeometry) -> Option<Remark> {
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
fn is_of_slice(mesh: &Mesh, geometry: &SectionGeometry) -> bool {
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
fn through_end(request: &SectionRequest, geometry: &SectionGeometry) -> Option<Remark> {
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
fn through_tetrahedra(mesh: &Mesh, request: &SectionRequest, elements: &[u32]) -> Option<Remark> {
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
