//! What the ground around a scene demands of it, whether it was read from a file or composed.

use std::collections::HashSet;

use powerhouse_boundary::foreign_nodes;
use powerhouse_model::{BoundarySite, Facet, FieldMotion, FieldSampler, IncidentField, Vec3};

use super::{InitialMotion, Scene};
use crate::{Damping, Error, Remark};

/// Displacement and velocity of a field over their peaks when a body starts at rest. A wave alone is
/// brought below half of it; several may add up.
const LEVEL_AT_REST: f64 = 2e-4;
/// The peak of a field is sought over so long (s), or over the run if that is longer.
const PEAK_WINDOW: f64 = 60.0;
/// Instants at which the peak is sought.
const PEAK_INSTANTS: usize = 12_000;
/// Traction of a field on a free surface, over shear impedance times peak velocity, that is no
/// rounding of a mesh file and no error of a table.
const TRACTION_OF_NOTE: f64 = 0.01;
/// Instants and points at which the traction is looked at.
const TRACTION_INSTANTS: usize = 500;
const TRACTION_POINTS: usize = 256;
/// What lies within this share of the mesh's diagonal of a side of its box lies on it.
const SIDE_TOLERANCE: f64 = 1e-6;
/// The sides of a box but its top: name, axis, whether it is the upper one.
const SIDES: [(&str, usize, bool); 5] = [
    ("left", 0, false),
    ("right", 0, true),
    ("front", 1, false),
    ("back", 1, true),
    ("bottom", 2, false),
];

impl Scene {
    /// Refuses a field of another medium than the one that stands at the absorbing faces, and a
    /// field that moves already where the body starts at rest.
    pub(super) fn check_field(
        &self,
        field: &dyn IncidentField,
        site: &BoundarySite,
    ) -> Result<(), Error> {
        let foreign = foreign_nodes(site);
        if let Some(&node) = foreign.first() {
            return Err(Error::ForeignMedium {
                field: field.name().into(),
                node: self.mesh.node_tags()[node as usize],
                count: foreign.len(),
            });
        }
        if self.initial == InitialMotion::Field {
            return Ok(());
        }
        let sampler = field.prepare(&self.outermost(site))?;
        let level = start_level(sampler.as_ref(), self.start, self.duration);
        if level < LEVEL_AT_REST {
            return Ok(());
        }
        Err(Error::NotAtRest {
            field: field.name().into(),
            level,
            time: self.start,
        })
    }

    /// The nodes through which the field enters, those of the boundary or of a region, that are nearest
    /// to the corners of their box.
    fn outermost(&self, site: &BoundarySite) -> Vec<Vec3> {
        let region = self.boundary.as_ref().and_then(|b| b.region.as_deref());
        let entered: Vec<Vec3> = match region {
            None => site.nodes.iter().map(|node| node.position).collect(),
            Some(region) => {
                let nodes = self.mesh.nodes_of_elements(region).into_iter();
                nodes
                    .map(|node| self.mesh.positions()[node as usize])
                    .collect()
            }
        };
        let infinite = Vec3::repeat(f64::INFINITY);
        let (low, high) = (entered.iter()).fold((infinite, -infinite), |(low, high), position| {
            (low.inf(position), high.sup(position))
        });
        let nearest = |corner: Vec3| {
            let distance = |position: &&Vec3| (**position - corner).norm();
            let nearest = entered
                .iter()
                .min_by(|a, b| distance(a).total_cmp(&distance(b)));
            nearest.copied()
        };
        box_corners(&low, &high)
            .into_iter()
            .filter_map(nearest)
            .collect()
    }

    /// Refuses facets between two elements among the absorbing ones.
    pub(super) fn check_faces(&self, faces: &[(&str, &[Facet])]) -> Result<(), Error> {
        let outer: HashSet<Facet> = self.mesh.boundary_facets().into_iter().collect();
        for (face, facets) in faces {
            if let Some(facet) = facets.iter().find(|facet| !outer.contains(facet)) {
                return Err(Error::InnerFacet {
                    face: (*face).into(),
                    element: self.mesh.element_tags()[facet.element as usize],
                });
            }
        }
        Ok(())
    }

    /// Doubts about what surrounds the body: damped rims and such that yield, sides that were forgotten, a surface that
    /// is not the field's.
    pub(super) fn doubts_around(
        &self,
        faces: &[(&str, &[Facet])],
        site: &BoundarySite,
    ) -> Result<Vec<Remark>, Error> {
        let mut remarks = Vec::new();
        if site.field.is_some() {
            for part in self.parts_behind_boundary()? {
                let part = &self.parts[part];
                if part.rim.is_some() {
                    continue;
                }
                if part.damping != Damping::None {
                    let set = part.set.clone();
                    remarks.push(Remark::DampedRim { set });
                }
                if !part.material.is_linear() {
                    let (set, law) = (part.set.clone(), part.material.name().into());
                    remarks.push(Remark::NonlinearRim { set, law });
                }
            }
        }
        let free = self.free_facets(faces);
        let (open, rest) = self.open_sides(&free);
        remarks.extend(open);
        if let Some(field) = site.field {
            remarks.extend(self.loaded_surface(field, &rest, site)?);
        }
        Ok(remarks)
    }

    /// Outer facets that neither absorb nor are held or driven at all their nodes.
    fn free_facets(&self, faces: &[(&str, &[Facet])]) -> Vec<Facet> {
        let absorbing: HashSet<Facet> = faces.iter().flat_map(|(_, f)| f.iter().copied()).collect();
        let held = self.supports.iter().flat_map(|support| support.nodes());
        let driven = self.prescribed.iter().flat_map(|motion| &motion.nodes);
        let tied = self.periodic.iter().flat_map(|periodic| &periodic.pairs);
        let mut held: HashSet<u32> = held.chain(driven).copied().collect();
        held.extend(tied.flat_map(|&(from, to)| [from, to]));
        let is_free = |facet: &Facet| {
            !absorbing.contains(facet)
                && !self
                    .mesh
                    .facet_nodes(*facet)
                    .iter()
                    .all(|node| held.contains(node))
        };
        self.mesh
            .boundary_facets()
            .into_iter()
            .filter(is_free)
            .collect()
    }

    /// The sides of the mesh's box, its top aside, on which free facets lie, and all other free
    /// facets.
    fn open_sides(&self, free: &[Facet]) -> (Vec<Remark>, Vec<Facet>) {
        let (low, high) = self.mesh.bounding_box();
        let tolerance = SIDE_TOLERANCE * (high - low).norm();
        let mut areas = [0.0; SIDES.len()];
        let mut others = Vec::new();
        for &facet in free {
            let nodes = self.mesh.facet_nodes(facet);
            let lies_on = |&(_, axis, upper): &(&str, usize, bool)| {
                let plane = if upper { high[axis] } else { low[axis] };
                let height = |node: &u32| self.mesh.positions()[*node as usize][axis];
                nodes
                    .iter()
                    .all(|node| (height(node) - plane).abs() <= tolerance)
            };
            match SIDES.iter().position(lies_on) {
                Some(side) => areas[side] += self.mesh.facet_geometry(facet).area(),
                None => others.push(facet),
            }
        }
        let open = SIDES.iter().zip(areas).filter(|(_, area)| *area > 0.0);
        let remarks = open.map(|(&(side, ..), area)| Remark::OpenSide { side, area });
        (remarks.collect(), others)
    }

    /// Where free facets touch the absorbing faces, the site moves as the field does, so the field
    /// must leave them without traction.
    fn loaded_surface(
        &self,
        field: &dyn IncidentField,
        free: &[Facet],
        site: &BoundarySite,
    ) -> Result<Option<Remark>, Error> {
        let absorbing: HashSet<u32> = site.nodes.iter().map(|node| node.node).collect();
        let mut rim: Vec<(Vec3, Vec3)> = Vec::new();
        for &facet in free {
            let nodes = self.mesh.facet_nodes(facet);
            let mut shared = nodes
                .iter()
                .filter(|node| absorbing.contains(node))
                .peekable();
            if shared.peek().is_some() {
                let normal = self.mesh.facet_geometry(facet).normal();
                let positions = self.mesh.positions();
                rim.extend(shared.map(|&node| (positions[node as usize], normal)));
            }
        }
        let stride = rim.len().div_ceil(TRACTION_POINTS).max(1);
        let rim: Vec<(Vec3, Vec3)> = rim.into_iter().step_by(stride).collect();
        let points: Vec<Vec3> = rim.iter().map(|(point, _)| *point).collect();
        let sampler = field.prepare(&points)?;
        let (mut fastest, mut worst) = (0.0_f64, (0.0_f64, Vec3::zeros()));
        let interval = self.duration / TRACTION_INSTANTS as f64;
        let mut motion = vec![FieldMotion::default(); points.len()];
        for instant in 0..=TRACTION_INSTANTS {
            motion.fill(FieldMotion::default());
            sampler.add_motion(self.start + instant as f64 * interval, &mut motion);
            for (motion, (point, normal)) in motion.iter().zip(&rim) {
                fastest = larger(fastest, motion.velocity.norm());
                let traction = motion.stress.traction(normal).norm();
                if traction.is_nan() || traction > worst.0 {
                    worst = (traction, *point);
                }
            }
        }
        let medium = field.medium();
        if worst.0 == 0.0 {
            return Ok(None);
        }
        let share = worst.0 / (medium.density * medium.s_speed() * fastest);
        let position = worst.1;
        let is_loaded = share.is_nan() || share > TRACTION_OF_NOTE;
        Ok(is_loaded.then_some(Remark::LoadedSurface { share, position }))
    }
}

/// The corners of a box.
pub(crate) fn box_corners(low: &Vec3, high: &Vec3) -> [Vec3; 8] {
    core::array::from_fn(|corner| {
        Vec3::from_fn(|axis, _| {
            if corner >> axis & 1 == 0 {
                low[axis]
            } else {
                high[axis]
            }
        })
    })
}

/// Displacement and velocity at the start over their peaks from then on, the larger of the two; not
/// a number if the field is none somewhere.
fn start_level(sampler: &dyn FieldSampler, start: f64, duration: f64) -> f64 {
    let mut motion = vec![FieldMotion::default(); sampler.len()];
    let mut largest = |time: f64| {
        motion.fill(FieldMotion::default());
        sampler.add_motion(time, &mut motion);
        motion.iter().fold([0.0_f64; 2], |[u, v], m| {
            [
                larger(u, m.displacement.norm()),
                larger(v, m.velocity.norm()),
            ]
        })
    };
    let at_start = largest(start);
    if at_start == [0.0; 2] {
        return 0.0;
    }
    let interval = duration.max(PEAK_WINDOW) / PEAK_INSTANTS as f64;
    let mut peak = at_start;
    for instant in 1..=PEAK_INSTANTS {
        let now = largest(start + instant as f64 * interval);
        peak = [larger(peak[0], now[0]), larger(peak[1], now[1])];
    }
    let over = |i: usize| {
        if at_start[i] == 0.0 {
            0.0
        } else {
            at_start[i] / peak[i]
        }
    };
    larger(over(0), over(1))
}

/// The larger of two numbers, or none if one of them is none: what a field is not known to do must
/// not pass for rest.
fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}
