//! Checks of supports and periodic pairs against the free field.

use std::collections::{BTreeSet, HashMap, HashSet};

use powerhouse_model::{BoundarySite, Facet, FieldMotion, IncidentField, Mat3, Vec3};

use crate::check_heights::CheckHeights;
use crate::surroundings::{
    SIDE_TOLERANCE, TRACTION_INSTANTS, TRACTION_OF_NOTE, TRACTION_POINTS, is_held, larger,
};
use crate::{Error, Remark, Scene, remark};

/// Share of the slowness of a plane wave along a direction below which it travels across it: that of rounding.
const ACROSS: f64 = 1e-9;

/// Node that a support restrains: along a unit direction, or in all directions (`None`).
struct HeldNode {
    node: u32,
    along: Option<Vec3>,
}

/// Node of an outer facet that supports hold.
struct HeldPlane {
    node: u32,
    /// Unit normal of the facet.
    normal: Vec3,
    /// Projection on the directions that the supports of the node leave free.
    free: Mat3,
}

/// Points at which the free field is compared with supports and periodic pairs.
struct HeldPoints {
    nodes: Vec<HeldNode>,
    planes: Vec<HeldPlane>,
    pairs: Vec<[u32; 2]>,
}

/// Largest deviations of the free field from what supports and periodic pairs permit, each with its place in
/// [`HeldPoints`].
#[derive(Default)]
struct Deviations {
    /// Largest velocity of the field (m/s).
    fastest: f64,
    /// Largest velocity (m/s) along a restrained direction.
    held: (f64, usize),
    /// Largest traction (Pa) of a held plane in the directions that are left free.
    traction: (f64, usize),
    /// Largest difference of the velocities (m/s) of a pair.
    difference: (f64, usize),
    /// Largest difference of the displacements of a pair over its length (1).
    strain: (f64, usize),
}

impl Scene {
    /// Warnings about supports that restrain nodes where the free field moves, about supports on planes on which the
    /// free field has traction in the directions left free (unless the former), and about periodic pairs whose nodes move differently in the
    /// free field. With a domain reduction region only its nodes count: outside of it the motion is that of scattered
    /// waves alone.
    pub(super) fn field_at_supports(
        &self,
        field: &dyn IncidentField,
        (faces, site): (&[(&str, &[Facet])], &BoundarySite),
    ) -> Result<Vec<Remark>, Error> {
        let held = self.held_points(faces)?;
        if held.nodes.is_empty() && held.pairs.is_empty() {
            return Ok(Vec::new());
        }
        let found = self.deviations(field, site, &held)?;
        if found.fastest == 0.0 {
            return Ok(Vec::new());
        }
        let medium = field.medium();
        let tag = |node: u32| self.mesh.node_tags()[node as usize];
        let has_delayed_ends = self.delayed.is_some();
        let mut remarks = Vec::new();
        let share = found.held.0 / found.fastest;
        let held_node = held.nodes.get(found.held.1);
        let missing = found.traction.0 / (medium.density * medium.s_speed() * found.fastest);
        let plane = held.planes.get(found.traction.1);
        // A field that moves along the restrained directions has traction along the free ones: one warning is enough.
        if let Some(held) = held_node.filter(|_| is_notable(share)) {
            let node = tag(held.node);
            let remark = remark::RestrainedField {
                share,
                node,
                has_delayed_ends,
            };
            remarks.push(remark.into());
        } else if let Some(plane) = plane.filter(|_| is_notable(missing)) {
            remarks.push(Remark::from(remark::AsymmetricField {
                share: missing,
                node: tag(plane.node),
                speed: self.apparent_speed(&plane.normal),
                has_delayed_ends,
            }));
        }
        let share = found.difference.0 / found.fastest;
        let strain = found.strain.0 * medium.s_speed() / found.fastest;
        let worst = if share > strain {
            found.difference.1
        } else {
            found.strain.1
        };
        let pair = held.pairs.get(worst);
        if let Some(&[from, to]) = pair.filter(|_| is_notable(share) || is_notable(strain)) {
            let positions = self.mesh.positions();
            let along = positions[to as usize] - positions[from as usize];
            remarks.push(Remark::from(remark::PeriodicField {
                share,
                strain,
                nodes: [tag(from), tag(to)],
                distance: along.norm(),
                speed: self.apparent_speed(&along.normalize()),
                has_delayed_ends,
            }));
        }
        Ok(remarks)
    }

    /// Supported nodes, held outer facets that do not absorb, and periodic pairs; of each at most a given number.
    fn held_points(&self, faces: &[(&str, &[Facet])]) -> Result<HeldPoints, Error> {
        let heights = CheckHeights::of(self)?;
        let height = |node: u32| self.mesh.positions()[node as usize].z;
        let region = self.boundary.as_ref().and_then(|b| b.region.as_deref());
        let region: Option<BTreeSet<u32>> =
            region.map(|region| self.mesh.nodes_of_elements(region).into_iter().collect());
        let is_above = self.above_field();
        let moves = |node: &u32| {
            let is_inside = region.as_ref().is_none_or(|region| region.contains(node));
            is_inside && !is_above(*node)
        };
        let mut nodes = Vec::new();
        let mut directions: HashMap<u32, Vec<Vec3>> = HashMap::new();
        for support in &self.supports {
            let along = support.held_direction().map(|along| along.normalize());
            let all = match along {
                Some(along) => vec![along],
                None => vec![Vec3::x(), Vec3::y(), Vec3::z()],
            };
            let of_support: Vec<u32> = support.nodes().iter().copied().filter(moves).collect();
            for &node in &of_support {
                directions.entry(node).or_default().extend(&all);
            }
            let sampled = heights.sample(of_support, TRACTION_POINTS, |node| height(*node));
            let sampled = sampled.into_iter();
            nodes.extend(sampled.map(|node| HeldNode { node, along }));
        }
        let absorbing: HashSet<Facet> = faces.iter().flat_map(|(_, f)| f.iter().copied()).collect();
        let mut planes = Vec::new();
        for facet in self.mesh.boundary_facets() {
            let on_facet = self.mesh.facet_nodes(facet);
            let of = |node: &u32| directions.get(node).map_or(&[][..], Vec::as_slice);
            let normal = self.mesh.facet_geometry(facet).normal();
            if absorbing.contains(&facet) || !on_facet.iter().all(|node| is_held(of(node), &normal))
            {
                continue;
            }
            planes.extend(on_facet.iter().map(|node| HeldPlane {
                node: *node,
                normal,
                free: free_directions(of(node)),
            }));
        }
        let pairs = self.periodic.iter().flat_map(|periodic| &periodic.pairs);
        let pairs = pairs.map(|&(from, to)| [from, to]);
        let pairs = pairs.filter(|pair| pair.iter().all(moves)).collect();
        let of_plane = |plane: &HeldPlane| height(plane.node);
        Ok(HeldPoints {
            nodes,
            planes: heights.sample(planes, TRACTION_POINTS, of_plane),
            pairs: heights.sample(pairs, TRACTION_POINTS, |pair: &[u32; 2]| height(pair[0])),
        })
    }

    /// Largest deviations of the field over the run.
    fn deviations(
        &self,
        field: &dyn IncidentField,
        site: &BoundarySite,
        held: &HeldPoints,
    ) -> Result<Deviations, Error> {
        let (nodes, planes) = (held.nodes.iter(), held.planes.iter());
        let position = |node: u32| self.mesh.positions()[node as usize];
        let points = (nodes.map(|held| held.node))
            .chain(planes.map(|plane| plane.node))
            .chain(held.pairs.iter().flatten().copied());
        let mut points: Vec<Vec3> = points.map(position).collect();
        points.extend(self.outermost(site));
        let sampler = field.prepare(&points)?;
        let mut motion = vec![FieldMotion::default(); points.len()];
        let mut found = Deviations::default();
        let interval = self.duration / TRACTION_INSTANTS as f64;
        for instant in 0..=TRACTION_INSTANTS {
            motion.fill(FieldMotion::default());
            sampler.add_motion(self.start + instant as f64 * interval, &mut motion);
            for motion in &motion {
                found.fastest = larger(found.fastest, motion.velocity.norm());
            }
            let (of_nodes, rest) = motion.split_at(held.nodes.len());
            let (of_planes, rest) = rest.split_at(held.planes.len());
            for (index, (held, motion)) in held.nodes.iter().zip(of_nodes).enumerate() {
                let speed = match held.along {
                    Some(along) => motion.velocity.dot(&along).abs(),
                    None => motion.velocity.norm(),
                };
                keep(&mut found.held, speed, index);
            }
            for (index, (plane, motion)) in held.planes.iter().zip(of_planes).enumerate() {
                let traction = plane.free * motion.stress.traction(&plane.normal);
                keep(&mut found.traction, traction.norm(), index);
            }
            for (index, (pair, motion)) in held.pairs.iter().zip(rest.chunks_exact(2)).enumerate() {
                let length = (position(pair[1]) - position(pair[0])).norm();
                let [from, to] = [&motion[0], &motion[1]];
                let difference = (to.velocity - from.velocity).norm();
                keep(&mut found.difference, difference, index);
                let strain = (to.displacement - from.displacement).norm() / length;
                keep(&mut found.strain, strain, index);
            }
        }
        Ok(found)
    }

    /// Least apparent speed (m/s) of the plane waves of the field along a unit direction; none if it is no sum of such
    /// waves, or if they travel across the direction.
    fn apparent_speed(&self, along: &Vec3) -> Option<f64> {
        let homogeneous = self
            .plane_waves()
            .iter()
            .map(|wave| wave.parameters().slowness());
        let layered = self
            .layered_waves()
            .iter()
            .map(|wave| wave.parameters().slowness());
        let shares = homogeneous.chain(layered).map(|slowness| {
            let share = slowness.dot(along).abs();
            if share > ACROSS * slowness.norm() {
                share
            } else {
                0.0
            }
        });
        let greatest = shares.fold(0.0_f64, f64::max);
        (greatest > 0.0).then(|| 1.0 / greatest)
    }
}

impl Scene {
    /// What repeats the body along a horizontal direction without end: periodic pairs, or rollers along that direction
    /// at both ends of the body.
    pub fn repeated_by(&self) -> Option<&'static str> {
        if self.delayed.is_some() {
            return Some(if self.is_bay() { "a bay" } else { "a slice" });
        }
        if !self.periodic.is_empty() {
            return Some("a body between periodic ends");
        }
        let rollers = self.supports.iter().filter_map(|support| {
            let along = support.held_direction()?.normalize();
            (along.z.abs() < ACROSS).then(|| (along, support.nodes()))
        });
        let rollers: Vec<(Vec3, &[u32])> = rollers.collect();
        let (low, high) = self.mesh.bounding_box();
        let tolerance = SIDE_TOLERANCE * (high - low).norm();
        let reaches_both = |along: &Vec3| {
            let along_it = |node: u32| self.mesh.positions()[node as usize].dot(along);
            let all = (0..self.mesh.node_count() as u32).map(along_it);
            let [least, most] = range(all);
            let parallel = rollers
                .iter()
                .filter(|(n, _)| n.cross(along).norm() < ACROSS);
            let held = parallel.flat_map(|(_, nodes)| nodes.iter().map(|&node| along_it(node)));
            let [lowest, highest] = range(held);
            lowest - least <= tolerance && most - highest <= tolerance
        };
        (rollers.iter().any(|(along, _)| reaches_both(along))).then_some("a body between rollers")
    }
}

/// Least and greatest of some numbers.
fn range(numbers: impl Iterator<Item = f64>) -> [f64; 2] {
    numbers.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
        [low.min(x), high.max(x)]
    })
}

/// Returns whether a share is above what rounding or interpolation can explain; an undefined one is.
fn is_notable(share: f64) -> bool {
    share.is_nan() || share > TRACTION_OF_NOTE
}

/// Keeps the larger value with its index; not a number if one of the two is not.
fn keep(worst: &mut (f64, usize), value: f64, index: usize) {
    if value.is_nan() || value > worst.0 {
        *worst = (value, index);
    }
}

/// Projection on the directions across all of the given unit vectors.
fn free_directions(held: &[Vec3]) -> Mat3 {
    held.iter().fold(Mat3::identity(), |free, along| {
        let rest = free * along;
        if rest.norm() > ACROSS {
            free - rest.normalize() * rest.normalize().transpose()
        } else {
            free
        }
    })
}
