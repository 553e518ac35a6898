//! Cross sections around a lining.

use std::collections::HashMap;

use powerhouse_model::{Mesh, Vec3};

use super::pieces::joined_by_nodes;
use super::plane::{Plane, intersect};
use super::{CrossSection, ObserveError, SectionPiece};

/// Sections around the lining of a tunnel or cavern, normal to its centre line, at equal angles about an axis.
///
/// The angles are those of rays from the centre, the first upward, or along x if the axis is vertical, and turn about the axis by
/// the right-hand rule. Where a ray meets several walls, the nearest is cut; where it meets none, as below an arch without
/// invert, there is no section. Across is towards the centre: the moment is positive with tension at the inner face.
///
/// ```
/// use powerhouse_model::{Mesh, Vec3};
/// use powerhouse_observe::SectionRing;
/// // A quarter of a ring of radii 4 and 5 m about the y axis.
/// let block = Mesh::box_of_hexes(Vec3::new(4.0, 0.0, 0.0), Vec3::new(5.0, 2.0, 1.0), [1, 1, 8], "lining")?;
/// let quarter = block.map_positions(|at| {
///     let angle = at.z * std::f64::consts::FRAC_PI_2;
///     Vec3::new(at.x * angle.cos(), at.y, at.x * angle.sin())
/// })?;
/// let ring = SectionRing::new("lining", Vec3::new(0.0, 1.0, 0.0), Vec3::y(), 16);
/// let sections = ring.sections(&quarter, quarter.element_set("lining")?)?;
/// assert_eq!(sections.len(), 5);
/// assert!((sections[0].section.point.norm() - 4.5).abs() < 0.3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct SectionRing {
    /// Name of the ring, before the angles in the names of its sections.
    pub name: String,
    /// Point within the lining (m), from which the rays go out.
    pub centre: Vec3,
    /// Axis of the tunnel, of any length but zero: the direction of the width of the sections.
    pub axis: Vec3,
    /// Number of rays, at equal angles.
    pub rays: usize,
}

/// A section of a [ring](SectionRing).
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct RingSection {
    /// Angle of the ray from upward about the axis (degrees).
    pub angle: f64,
    /// The section, named after the ring and its angle in whole degrees.
    pub section: CrossSection,
    /// Elements (mesh indices) on the side of the ray, among which those of the section are.
    pub elements: Vec<u32>,
}

/// Where a ray meets the lining.
struct Met {
    ray: usize,
    centroid: Vec3,
    /// Elements on the side of the ray, of the body that it meets.
    elements: Vec<u32>,
    /// Normal to the ray if the body ends there, as at a plane of symmetry.
    face: Option<Vec3>,
    /// Element of the section that reaches behind the centre.
    around_centre: Option<u32>,
    /// Distance from the centre, and thickness (m).
    distance: f64,
    depth: f64,
}

impl Met {
    /// Leaves out what is nearer to other walls that the plane normal to the centre line cuts than to this one.
    fn confine(&mut self, mesh: &Mesh, [normal, axis]: [Vec3; 2], tolerance: f64) {
        let pieces = pieces_of_cut(
            mesh,
            &self.elements,
            [self.centroid, normal, axis],
            tolerance,
        );
        let from = |at: &Vec3, to: &Vec3| (at - to).norm();
        let own = (pieces.iter().map(|piece| piece.centroid))
            .min_by(|a, b| from(a, &self.centroid).total_cmp(&from(b, &self.centroid)));
        let Some(own) = own else {
            return;
        };
        for other in pieces.iter().map(|piece| piece.centroid) {
            self.elements.retain(|&element| {
                let at = mesh.centroid(element);
                from(&at, &own) <= from(&at, &other)
            });
        }
    }
}

/// Pieces of the cut through elements of a plane, given by a point, its normal and the direction of the width.
fn pieces_of_cut(
    mesh: &Mesh,
    elements: &[u32],
    [point, normal, along]: [Vec3; 3],
    tolerance: f64,
) -> Vec<SectionPiece> {
    let plane = |own_positive| Plane {
        point,
        normal,
        tolerance,
        own_positive,
    };
    (intersect(mesh, plane(true), elements))
        .or_else(|| intersect(mesh, plane(false), elements))
        .map_or(Vec::new(), |cut| cut.pieces(mesh, along))
}

impl SectionRing {
    /// Least and greatest number of rays of a ring.
    pub const RAYS: [usize; 2] = [4, 360];

    /// Rings of a name about a centre (m) and an axis.
    pub fn new(name: impl Into<String>, centre: Vec3, axis: Vec3, rays: usize) -> Self {
        Self {
            name: name.into(),
            centre,
            axis,
            rays,
        }
    }

    /// The sections through some elements (mesh indices), in the order of their angles.
    ///
    /// # Errors
    /// An axis without length, a number of rays outside 4 to 360, a ring of which no ray meets an element, a centre outside of
    /// the lining or in it, elements that are no lining. A lining that ends at planes of symmetry, met by rays, may be less than half
    /// of a ring.
    pub fn sections(
        &self,
        mesh: &Mesh,
        elements: &[u32],
    ) -> Result<Vec<RingSection>, ObserveError> {
        let refused = |reason: String| ObserveError::Ring {
            ring: self.name.clone(),
            reason,
        };
        let [least, most] = Self::RAYS;
        if !(least..=most).contains(&self.rays) {
            let rays = self.rays;
            return Err(refused(format!(
                "the number of rays is {rays}, permitted are {least} to {most}"
            )));
        }
        let finite = |unit: &Vec3| unit.iter().all(|x| x.is_finite());
        let axis = self.axis.try_normalize(0.0).filter(finite);
        let axis = axis.ok_or_else(|| refused("its axis has no direction".into()))?;
        let upward = |up: Vec3| (up - axis * axis.dot(&up)).try_normalize(1e-6);
        let first = upward(Vec3::z())
            .or_else(|| upward(Vec3::x()))
            .unwrap_or_default();
        let solid: Vec<u32> = (elements.iter().copied())
            .filter(|&element| mesh.kind(element).is_solid())
            .collect();
        let bodies = bodies(mesh, &solid);
        let (low, high) = mesh.bounding_box();
        let tolerance = 1e-6 * (high - low).norm();
        let mut met: Vec<Met> = Vec::new();
        for ray in 0..self.rays {
            let turn = std::f64::consts::TAU * ray as f64 / self.rays as f64;
            let outward = first * turn.cos() + axis.cross(&first) * turn.sin();
            let beyond =
                |&element: &u32| (mesh.centroid(element) - self.centre).dot(&outward) > 0.0;
            let side: Vec<u32> = solid.iter().copied().filter(beyond).collect();
            let normal = axis.cross(&outward);
            let pieces = pieces_of_cut(mesh, &side, [self.centre, normal, axis], tolerance);
            let distance = |at: &Vec3| (at - self.centre).dot(&outward);
            let nearest = pieces.iter().min_by(|a, b| {
                let [a, b] = [a, b].map(|piece| distance(&piece.centroid));
                a.total_cmp(&b)
            });
            if let Some(nearest) = nearest {
                let body = bodies.get(&nearest.elements[0]);
                let own = |element: &u32| bodies.get(element) == body;
                let elements: Vec<u32> = side.iter().copied().filter(own).collect();
                let height =
                    |node: u32| (mesh.positions()[node as usize] - self.centre).dot(&normal);
                let heights = mesh.nodes_of_elements(&elements).into_iter().map(height);
                let [least, most] = heights
                    .fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], h| {
                        [a.min(h), b.max(h)]
                    });
                let inward = |&&element: &&u32| {
                    let nodes = mesh.nodes_of(element).iter();
                    let mut at = nodes.map(|&node| mesh.positions()[node as usize] - self.centre);
                    at.any(|at| at.dot(&outward) < -tolerance)
                };
                met.push(Met {
                    around_centre: nearest.elements.iter().find(inward).copied(),
                    distance: distance(&nearest.centroid),
                    depth: nearest.depth,
                    ray,
                    centroid: nearest.centroid,
                    elements,
                    face: (least >= -tolerance || most <= tolerance).then_some(normal),
                });
            }
        }
        if met.is_empty() {
            return Err(refused("no ray from its centre meets an element".into()));
        }
        if let Some(element) = met.iter().find_map(|of_ray| of_ray.around_centre) {
            let number = mesh.element_tags()[element as usize];
            return Err(refused(format!(
                "its centre lies in element {number} of the lining, not in the opening"
            )));
        }
        // Models of a half or a quarter end at planes of symmetry.
        let gap = self.largest_gap(&met);
        let is_cut_off = |of_ray: &Met| of_ray.face.is_some();
        let ends = met.iter().filter(|of_ray| is_cut_off(of_ray)).count();
        let step = 360.0 / self.rays as f64;
        if gap > 180.0 + 1.5 * step && ends < 2 {
            return Err(refused(format!(
                "its centre is not within the lining: rays meet it within {} degrees alone",
                360.0 - gap
            )));
        }
        let is_thick = |of_ray: &&Met| of_ray.depth > of_ray.distance;
        if met.iter().filter(is_thick).count() > met.len() / 2 {
            return Err(refused(
                "most sections are thicker than their distance from its centre: the elements are no lining".into(),
            ));
        }
        let tangents: Vec<Vec3> = (0..met.len())
            .map(|index| self.tangent(&met, index, axis))
            .collect();
        let mut sections = Vec::new();
        for (mut of_ray, tangent) in met.into_iter().zip(tangents) {
            let normal = of_ray.face.unwrap_or(tangent);
            of_ray.confine(mesh, [normal, axis], tolerance);
            let angle = 360.0 * of_ray.ray as f64 / self.rays as f64;
            let section = CrossSection {
                name: format!("{}-{:03.0}", self.name, angle),
                point: of_ray.centroid,
                normal,
                along: axis,
                within: None,
            };
            sections.push(RingSection {
                angle,
                section,
                elements: of_ray.elements,
            });
        }
        Ok(sections)
    }

    /// Largest angle between two neighbouring rays that meet the lining (degrees).
    fn largest_gap(&self, met: &[Met]) -> f64 {
        let step = 360.0 / self.rays as f64;
        let next = met.iter().cycle().skip(1);
        let gaps = met.iter().zip(next).map(|(from, to)| {
            let rays = (to.ray + self.rays - from.ray) % self.rays;
            step * if rays == 0 { self.rays } else { rays } as f64
        });
        gaps.fold(0.0, f64::max)
    }

    /// Direction of the centre line at one of the places where rays meet it, from the places before and after it, at an end from
    /// the parabola through it and two others; that normal to its ray if it has no neighbours.
    fn tangent(&self, met: &[Met], index: usize, axis: Vec3) -> Vec3 {
        let (ray, here) = (met[index].ray, met[index].centroid);
        let at = |turn: usize| {
            let ray = (ray + turn) % self.rays;
            met.iter().find(|of| of.ray == ray).map(|of| of.centroid)
        };
        let end = |next: Option<Vec3>, second: Option<Vec3>| match (next, second) {
            (Some(next), Some(second)) => 4.0 * next - second - 3.0 * here,
            (Some(next), None) => next - here,
            (None, _) => axis.cross(&(here - self.centre)),
        };
        let line = match (at(1), at(self.rays - 1)) {
            (Some(after), Some(before)) => after - before,
            (None, Some(before)) => -end(Some(before), at(self.rays - 2)),
            (after, None) => end(after, at(2)),
        };
        let flat = line - axis * axis.dot(&line);
        flat.try_normalize(0.0).unwrap_or(axis)
    }
}

/// A number of the body of each element: one for all that share nodes.
fn bodies(mesh: &Mesh, elements: &[u32]) -> HashMap<u32, u32> {
    let (mut sets, _) = joined_by_nodes(mesh, elements);
    let indices = elements.iter().zip(0..);
    indices
        .map(|(&element, index)| (element, sets.root(index)))
        .collect()
}
