//! Checks of a scene against the surrounding ground: free field, absorbing faces, open sides, free surfaces.

use std::collections::{HashMap, HashSet};

use powerhouse_boundary::{BoundaryError, nodes_in_other_media};
use powerhouse_model::{BoundarySite, Facet, FieldMotion, FieldSampler, IncidentField, Mesh, Vec3};

use crate::{Error, InitialMotion, Remark, Scene, remark};
use powerhouse_laws::Damping;

/// Largest permitted displacement and velocity of a field over their peaks at the start of a body at rest. A single
/// wave is reduced to half of it, since several may add up.
const LEVEL_AT_REST: f64 = 2e-4;
/// Least duration (s) over which the peak of a field is determined; otherwise the duration of the run.
const PEAK_WINDOW: f64 = 60.0;
/// Number of instants at which the peak is determined.
const PEAK_INSTANTS: usize = 12_000;
/// Largest traction of a field on a free surface, over shear impedance times peak velocity, that rounding of a mesh
/// file or interpolation of a table can explain.
pub(super) const TRACTION_OF_NOTE: f64 = 0.01;
/// Number of stations at which the start of motions at stations is evaluated.
const START_STATIONS: usize = 1000;
/// Numbers of instants and points at which the traction is evaluated.
pub(super) const TRACTION_INSTANTS: usize = 500;
pub(super) const TRACTION_POINTS: usize = 256;
/// Tolerance of the distance from a side of the bounding box, over the diagonal of the mesh.
pub(super) const SIDE_TOLERANCE: f64 = 1e-6;
/// Least cosine between a support direction and the normal of a facet that it restrains: that of 45 degrees.
const HELD: f64 = 0.707;
/// Sides of a box except its top: name, axis, whether it is the upper one.
const SIDES: [(&str, usize, bool); 5] = [
    ("left", 0, false),
    ("right", 0, true),
    ("front", 1, false),
    ("back", 1, true),
    ("bottom", 2, false),
];

impl Scene {
    /// Rejects a field of another medium than that along the absorbing faces, and a field that is not negligible at the
    /// start of a body at rest.
    pub(super) fn check_field(
        &self,
        field: &dyn IncidentField,
        (faces, site): (&[(&str, &[Facet])], &BoundarySite),
    ) -> Result<(), Error> {
        // Through faces around a region nothing enters, and what the ground of stations is, is not known.
        if field.carries_stress() {
            self.check_media(field, (faces, site))?;
        } else if self.boundary.as_ref().is_none_or(|b| b.region.is_none()) {
            let field = field.name().into();
            return Err(Error::Model(BoundaryError::NoStress { field }.into()));
        }
        if self.initial == InitialMotion::Field {
            return Ok(());
        }
        let points = match field.stations() {
            None => self.outermost(site),
            Some(stations) => {
                let stride = stations.len().div_ceil(START_STATIONS).max(1);
                stations.iter().step_by(stride).copied().collect()
            }
        };
        let level = start_level(field.prepare(&points)?.as_ref(), self.start, self.duration);
        if level < LEVEL_AT_REST {
            return Ok(());
        }
        Err(Error::NotAtRest {
            field: field.name().into(),
            level,
            time: self.start,
        })
    }

    /// Rejects a field of another medium than that along the absorbing faces.
    fn check_media(
        &self,
        field: &dyn IncidentField,
        (faces, site): (&[(&str, &[Facet])], &BoundarySite),
    ) -> Result<(), Error> {
        self.check_layers(field, faces)?;
        let foreign = match self.without_structures(faces)? {
            None => nodes_in_other_media(site),
            Some(ground) => {
                let ground: Vec<(&str, &[Facet])> = ground
                    .iter()
                    .map(|(face, facets)| (*face, &facets[..]))
                    .collect();
                let medium = self.medium_of_elements()?;
                let (scatterer, field) = (site.scatterer, site.field);
                let ground = BoundarySite::from_mesh(&self.mesh, &ground, medium, scatterer, field);
                nodes_in_other_media(&ground)
            }
        };
        if let Some(&node) = foreign.first() {
            return Err(Error::ForeignMedium {
                field: field.name().into(),
                node: self.mesh.node_tags()[node as usize],
                count: foreign.len(),
            });
        }
        Ok(())
    }

    /// Nodes of the boundary or region through which the field enters that are nearest to the corners of their bounding
    /// box.
    pub(super) fn outermost(&self, site: &BoundarySite) -> Vec<Vec3> {
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

    /// Rejects absorbing facets inside the body, and facets of two absorbing faces, which would have twice the
    /// impedance and input.
    pub(super) fn check_faces(&self, faces: &[(&str, &[Facet])]) -> Result<(), Error> {
        let outer: HashSet<Facet> = self.mesh.boundary_facets().into_iter().collect();
        let mut face_of: HashMap<Facet, &str> = HashMap::new();
        for (face, facets) in faces {
            for facet in *facets {
                if let Some(first) = face_of.insert(*facet, face) {
                    return Err(Error::SharedFacet {
                        first: first.into(),
                        second: (*face).into(),
                        element: self.mesh.element_tags()[facet.element as usize],
                    });
                }
            }
            if let Some(facet) = facets.iter().find(|facet| !outer.contains(facet)) {
                return Err(Error::InnerFacet {
                    face: (*face).into(),
                    element: self.mesh.element_tags()[facet.element as usize],
                });
            }
        }
        Ok(())
    }

    /// Warnings about the surroundings of the body: damped or nonlinear rims, open sides, a free surface that is not that
    /// of the field.
    pub(super) fn boundary_remarks(
        &self,
        faces: &[(&str, &[Facet])],
        site: &BoundarySite,
    ) -> Result<Vec<Remark>, Error> {
        let mut remarks = Vec::new();
        remarks.extend(self.scatterer_above());
        if site.field.is_some() {
            for index in self.parts_at_faces()? {
                let part = &self.parts[index];
                if part.rim.is_some() {
                    continue;
                }
                let is_damped = part.damping != Damping::None || self.has_damped_layers();
                if is_damped && !self.is_damped_like_field(index, faces)? {
                    let set = part.set.clone();
                    remarks.push(remark::DampedRim { set }.into());
                }
                if !part.material.is_linear() {
                    let (set, law) = (part.set.clone(), part.material.name().into());
                    remarks.push(remark::NonlinearRim { set, law }.into());
                }
            }
        }
        remarks.extend(self.structures_through(faces, site.field)?);
        let free = self.free_facets(faces);
        remarks.extend(self.absorbing_surfaces(faces));
        let (open, rest) = self.open_sides(&free);
        remarks.extend(open);
        // Motions at stations are known neither at supports nor at surfaces, and have no traction.
        if let Some(field) = site.field.filter(|field| field.stations().is_none()) {
            remarks.extend(self.field_at_supports(field, (faces, site))?);
            remarks.extend(self.loaded_surface(field, &rest, site)?);
            remarks.extend(self.relief(faces, &rest));
        }
        Ok(remarks)
    }

    /// Free outer facets: neither absorbing, nor a side of a joint, nor supported or prescribed along their normals or in
    /// both directions across them at all their nodes. Rollers of a plane slice do not support the edges of its other sides.
    fn free_facets(&self, faces: &[(&str, &[Facet])]) -> Vec<Facet> {
        let absorbing: HashSet<Facet> = faces.iter().flat_map(|(_, f)| f.iter().copied()).collect();
        let held = self.held_directions();
        let jointed = self.sides_of_joints();
        let is_free = |facet: &Facet| {
            let normal = self.mesh.facet_geometry(*facet).normal();
            let mut nodes = self.mesh.facet_nodes(*facet);
            let of = |node: &u32| held.get(node).map_or(&[][..], Vec::as_slice);
            let is_held = nodes.iter().all(|node| is_held(of(node), &normal));
            nodes.sort_unstable();
            !absorbing.contains(facet) && !is_held && !jointed.contains(&nodes)
        };
        self.mesh
            .boundary_facets()
            .into_iter()
            .filter(is_free)
            .collect()
    }

    /// Nodes, in rising order, of each facet of the two sides of all joints.
    fn sides_of_joints(&self) -> HashSet<Vec<u32>> {
        let mut sides = HashSet::new();
        for surface in self.joints.iter().map(|joint| &joint.surface) {
            for facet in &surface.facets {
                let opposite = |(&node, pair): (&u32, &Option<u32>)| {
                    // At a tip both sides share the node.
                    let pair = pair.map_or([node; 2], |pair| surface.pairs[pair as usize].nodes);
                    if pair[0] == node { pair[1] } else { pair[0] }
                };
                let second = facet.nodes.iter().zip(&facet.pairs).map(opposite);
                for mut nodes in [facet.nodes.clone(), second.collect()] {
                    nodes.sort_unstable();
                    sides.insert(nodes);
                }
            }
        }
        sides
    }

    /// Unit vectors of the directions in which nodes are supported, prescribed or periodic.
    fn held_directions(&self) -> HashMap<u32, Vec<Vec3>> {
        let mut held: HashMap<u32, Vec<Vec3>> = HashMap::new();
        let mut hold = |node: u32, direction: Vec3| {
            if direction.norm() > 0.0 {
                held.entry(node).or_default().push(direction.normalize());
            }
        };
        for support in &self.supports {
            let directions = match support.held_direction() {
                Some(direction) => vec![direction],
                None => vec![Vec3::x(), Vec3::y(), Vec3::z()],
            };
            for &node in support.nodes() {
                directions.iter().for_each(|&along| hold(node, along));
            }
        }
        for mirror in &self.mirrors {
            mirror.nodes.iter().for_each(|&n| hold(n, mirror.normal));
        }
        for driven in &self.prescribed {
            driven.nodes.iter().for_each(|&n| hold(n, driven.direction));
        }
        let positions = self.mesh.positions();
        for (from, to) in self.all_pairs() {
            let along = positions[to as usize] - positions[from as usize];
            hold(from, along);
            hold(to, along);
        }
        held
    }

    /// Warning about a scatterer that is given above the body.
    fn scatterer_above(&self) -> Option<Remark> {
        let (low, high) = self.mesh.bounding_box();
        let position = self.boundary.as_ref()?.scatterer?;
        let is_above = position.z - high.z > SIDE_TOLERANCE * (high - low).norm();
        is_above.then(|| {
            let (height, top) = (position.z, high.z);
            Remark::from(remark::ScattererAbove { height, top })
        })
    }

    /// Warnings about absorbing faces on the free surface of the half-space.
    fn absorbing_surfaces(&self, faces: &[(&str, &[Facet])]) -> Vec<Remark> {
        let (low, high) = self.mesh.bounding_box();
        let tolerance = SIDE_TOLERANCE * (high - low).norm();
        let Some(surface) = self.surface() else {
            return Vec::new();
        };
        let lies_on = |facet: &Facet| {
            let nodes = self.mesh.facet_nodes(*facet);
            let height = |node: &u32| self.mesh.positions()[*node as usize].z;
            nodes.iter().all(|node| height(node) >= surface - tolerance)
        };
        let faces = faces
            .iter()
            .filter(|(_, facets)| facets.iter().any(lies_on));
        let faces = faces.map(|(face, _)| (*face).to_owned());
        faces
            .map(|face| remark::AbsorbingSurface { face }.into())
            .collect()
    }

    /// Sides of the bounding box except its top with free facets, and all other free facets.
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
        let remarks = open.map(|(&(side, ..), area)| remark::OpenSide { side, area }.into());
        (remarks.collect(), others)
    }

    /// Warning about traction of the free field on free facets beside the absorbing faces, where the motion is that of
    /// the field, which must be free of traction there.
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
        Ok(is_loaded.then_some(Remark::from(remark::LoadedSurface { share, position })))
    }
}

/// Returns whether the supported directions (unit vectors) of a node restrain a facet with a normal: along it, or in two
/// directions across it, as on a plane of antisymmetry.
pub(super) fn is_held(directions: &[Vec3], normal: &Vec3) -> bool {
    let across: Vec<Vec3> = (directions.iter())
        .map(|along| along - normal * along.dot(normal))
        .collect();
    let spans = |a: &Vec3| across.iter().any(|b| a.cross(b).norm() > HELD);
    directions
        .iter()
        .any(|along| along.dot(normal).abs() > HELD)
        || across.iter().any(spans)
}

/// Corners of a box.
pub fn box_corners(low: &Vec3, high: &Vec3) -> [Vec3; 8] {
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

/// Larger ratio of displacement and velocity at the start to their later peaks; not a number if the field is not a
/// number somewhere.
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

/// Larger of two numbers; not a number if one of them is not, so that an undefined field does not count as zero.
pub(super) fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

/// Share of the extent of a body by which places along it are the same.
const SAME_PLACE: f64 = 1e-6;

/// Whether each of some elements reaches from end to end of a body along an axis (unit vector), as all do in a slice.
pub fn fill_body(mesh: &Mesh, mut elements: impl Iterator<Item = u32>, axis: &Vec3) -> bool {
    let extent = |nodes: &mut dyn Iterator<Item = u32>| {
        let places = nodes.map(|node| mesh.positions()[node as usize].dot(axis));
        places.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], place| {
            [low.min(place), high.max(place)]
        })
    };
    let body = extent(&mut (0..mesh.node_count() as u32));
    let tolerance = SAME_PLACE * (body[1] - body[0]);
    elements.all(|element| {
        let own = extent(&mut mesh.nodes_of(element).iter().copied());
        (own[0] - body[0]).abs() < tolerance && (own[1] - body[1]).abs() < tolerance
    })
}
