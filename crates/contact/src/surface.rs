//! Node pairs from the facets of the two sides of a joint.

use std::collections::{BTreeMap, HashMap};

use powerhouse_model::{Facet, FacetGeometry, JointPair, Mesh, ParameterError, Vec3};

use crate::ContactError;
use crate::pairing::neighbours;

/// Options for making node pairs of the facets of two sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceOptions {
    /// Largest permitted distance between the nodes of a pair (m), above 0.
    pub tolerance: f64,
    /// Largest angle (rad) between the normals of facets that count as one smooth patch, 0 to a right angle.
    ///
    /// An averaged normal tilts every facet by half the angle between neighbours, so that a share
    /// `sin(angle/2)` of the pressure acts along the facet; a pair for each facet lets neither be
    /// opened nor penetrated, which locks slip across the edge. The first is right for a curved face made
    /// of plane facets, the second for a true corner. A ring of ten facets has 36 degrees between
    /// neighbours, a corner mostly 90: the default is 40 degrees.
    pub corner_angle: f64,
}

impl SurfaceOptions {
    /// Default of the corner angle (rad), 40 degrees.
    pub const CORNER_ANGLE: f64 = 40.0 * core::f64::consts::PI / 180.0;

    /// Options with a tolerance (m) and the default corner angle.
    ///
    /// # Errors
    /// A tolerance that is not positive.
    pub fn within(tolerance: f64) -> Result<Self, ParameterError> {
        Self::new(tolerance, Self::CORNER_ANGLE)
    }
    /// Options with a tolerance (m) and a corner angle (rad) between 0 and a right angle.
    ///
    /// # Errors
    /// Whichever is out of range.
    pub fn new(tolerance: f64, corner_angle: f64) -> Result<Self, ParameterError> {
        ParameterError::check("tolerance", tolerance, f64::MIN_POSITIVE, f64::MAX)?;
        let right_angle = core::f64::consts::FRAC_PI_2;
        ParameterError::check("corner_angle", corner_angle, 0.0, right_angle)?;
        Ok(Self {
            tolerance,
            corner_angle,
        })
    }
}

/// Facet of a joint with the pairs at its corners, for drawing results on the joint and for its edge lengths; areas and
/// tractions belong to the [pairs](JointSurface::pairs).
#[derive(Clone, Debug, PartialEq)]
pub struct JointFacet {
    /// The facet as a face of an element of the first side.
    pub first: Facet,
    /// Nodes of the facet (mesh indices), counter-clockwise seen from the second side.
    pub nodes: Vec<u32>,
    /// Index of the pair at each node; none at a tip, where both sides share the node.
    pub pairs: Vec<Option<u32>>,
}

/// Matched sides of a joint: node pairs and facets.
#[derive(Clone, Debug, PartialEq)]
pub struct JointSurface {
    /// Node pairs in rising order of their nodes. Nodes on an edge of the joint have one pair for each
    /// smooth patch that meets there; areas add up to that of the facets, tips left out.
    pub pairs: Vec<JointPair>,
    /// Facets, in the order of the first side.
    pub facets: Vec<JointFacet>,
    /// Largest distance between the nodes of a pair (m).
    pub worst_gap: f64,
    /// Numbers of the nodes of that pair in the mesh file.
    pub worst_nodes: [u64; 2],
}

impl JointSurface {
    /// Matches each facet of one side with the coincident one of the other side, corner by
    /// corner, and makes pairs of their nodes: normals are those of the first side, averaged with
    /// the second, areas what the facets give to their nodes.
    ///
    /// # Errors
    /// [`ContactError::Empty`], or [`ContactError::Unmatched`] with the facet that is farthest from
    /// any partner.
    ///
    /// # Panics
    /// If a facet does not belong to the mesh.
    pub fn between(
        mesh: &Mesh,
        first: &[Facet],
        second: &[Facet],
        options: &SurfaceOptions,
    ) -> Result<Self, ContactError> {
        if first.is_empty() || second.is_empty() {
            return Err(ContactError::Empty);
        }
        let geometry = |facets: &[Facet]| -> Vec<FacetGeometry> {
            facets
                .iter()
                .map(|&facet| mesh.facet_geometry(facet))
                .collect()
        };
        let (own, other) = (geometry(first), geometry(second));
        let partners = match_facets(mesh, (first, &own), (second, &other), options.tolerance)?;
        let patches = patches(&own, &other, &partners, options.corner_angle);

        let mut surface = Self {
            pairs: Vec::new(),
            facets: Vec::new(),
            worst_gap: 0.0,
            worst_nodes: [0; 2],
        };
        let mut pair_of = HashMap::new();
        for (&nodes, corners) in &patches {
            let [a, b] = nodes.map(|node| mesh.positions()[node as usize]);
            for (patch, (vector, area)) in corners.sums() {
                pair_of.insert((nodes, patch), surface.pairs.len() as u32);
                let pair = JointPair::of_facets(nodes, vector, area);
                surface.pairs.push(pair.with_position((a + b) * 0.5));
            }
            let gap = (b - a).norm();
            if gap >= surface.worst_gap {
                surface.worst_gap = gap;
                surface.worst_nodes = nodes.map(|node| mesh.node_tags()[node as usize]);
            }
        }
        if surface.pairs.is_empty() {
            return Err(ContactError::Empty);
        }
        for (index, (facet, own)) in first.iter().zip(&own).enumerate() {
            let pairs = own
                .nodes
                .iter()
                .zip(&partners[index].corners)
                .map(|(&node, &corner)| {
                    let nodes = [node, other[partners[index].facet].nodes[corner]];
                    let patch = patches.get(&nodes)?.patch_of(index)?;
                    pair_of.get(&(nodes, patch)).copied()
                });
            surface.facets.push(JointFacet {
                first: *facet,
                pairs: pairs.collect(),
                nodes: own.nodes.clone(),
            });
        }
        surface.set_spacing();
        Ok(surface)
    }

    /// Sets the distance of each pair to the farthest of its neighbours along the edges of facets.
    fn set_spacing(&mut self) {
        let mut spacing = vec![0.0_f64; self.pairs.len()];
        for facet in &self.facets {
            for (corner, &one) in facet.pairs.iter().enumerate() {
                let next = facet.pairs[(corner + 1) % facet.pairs.len()];
                if let (Some(one), Some(next)) = (one, next) {
                    let [one, next] = [one, next].map(|pair| pair as usize);
                    let away = (self.pairs[next].position - self.pairs[one].position).norm();
                    spacing[one] = spacing[one].max(away);
                    spacing[next] = spacing[next].max(away);
                }
            }
        }
        for (pair, spacing) in self.pairs.iter_mut().zip(spacing) {
            if spacing > 0.0 {
                pair.spacing = spacing;
            }
        }
    }

    /// Surface in a body some nodes of which share one motion, as on periodic faces: pairs of the same
    /// nodes, and of one smooth patch, become one pair of the sum of their areas. `lead` returns the node
    /// that represents all nodes of one motion (mesh indices).
    #[must_use]
    pub fn united(self, lead: impl Fn(u32) -> u32) -> Self {
        let least = SurfaceOptions::CORNER_ANGLE.cos();
        let mut kept: Vec<(JointPair, Vec<[u32; 2]>)> = Vec::with_capacity(self.pairs.len());
        let mut at: HashMap<[u32; 2], Vec<usize>> = HashMap::new();
        let index_of: Vec<usize> = (self.pairs.iter())
            .map(|pair| {
                let nodes = pair.nodes.map(&lead);
                let same = at.entry(nodes).or_default();
                let along = |index: &usize| kept[*index].0.normal.dot(&pair.normal);
                let joins = |index: &&usize| {
                    along(index) >= least && !kept[**index].1.contains(&pair.nodes)
                };
                let found = same.iter().filter(joins);
                match found.max_by(|a, b| along(a).total_cmp(&along(b))).copied() {
                    Some(index) => {
                        let (one, of) = &mut kept[index];
                        let vector = |pair: &JointPair| pair.normal * pair.projected_area;
                        let (sum, area) = (vector(one) + vector(pair), one.area + pair.area);
                        let spacing = one.spacing.max(pair.spacing);
                        *one = JointPair::of_facets(nodes, sum, area)
                            .with_position(one.position)
                            .with_water_pressure(one.water_pressure)
                            .with_spacing(spacing);
                        of.push(pair.nodes);
                        index
                    }
                    None => {
                        same.push(kept.len());
                        kept.push((pair.with_nodes(nodes), vec![pair.nodes]));
                        kept.len() - 1
                    }
                }
            })
            .collect();
        let mut order: Vec<usize> = (0..kept.len()).collect();
        order.sort_by_key(|&index| kept[index].0.nodes);
        let mut rank = vec![0; kept.len()];
        for (new, &old) in order.iter().enumerate() {
            rank[old] = new as u32;
        }
        let renumbered = |pair: u32| rank[index_of[pair as usize]];
        let facets = self.facets.into_iter().map(|facet| JointFacet {
            pairs: (facet.pairs.iter())
                .map(|pair| pair.map(renumbered))
                .collect(),
            ..facet
        });
        Self {
            facets: facets.collect(),
            pairs: order.iter().map(|&index| kept[index].0).collect(),
            worst_gap: self.worst_gap,
            worst_nodes: self.worst_nodes,
        }
    }

    /// Shortest edge of its facets (m).
    ///
    /// # Panics
    /// If the surface belongs to another mesh.
    pub fn shortest_edge(&self, mesh: &Mesh) -> f64 {
        let at = |node: u32| mesh.positions()[node as usize];
        let edges = self.facets.iter().flat_map(|facet| {
            let next = facet.nodes.iter().cycle().skip(1);
            (facet.nodes.iter().zip(next)).map(|(&a, &b)| (at(b) - at(a)).norm())
        });
        edges.fold(f64::INFINITY, f64::min)
    }

    /// Area of all pairs (m2).
    pub fn area(&self) -> f64 {
        self.pairs.iter().map(|pair| pair.area).sum()
    }
}

/// Partner of a facet: index of the facet of the other side, and its corner at each corner.
struct Partner {
    facet: usize,
    corners: Vec<usize>,
}

type Side<'a> = (&'a [Facet], &'a [FacetGeometry]);

/// Partner of each facet of the first side; all facets of the second side must be partners.
fn match_facets(
    mesh: &Mesh,
    first: Side,
    second: Side,
    tolerance: f64,
) -> Result<Vec<Partner>, ContactError> {
    let forward = partners(mesh, first, second, tolerance)?;
    let mut taken = vec![false; second.0.len()];
    for partner in &forward {
        taken[partner.facet] = true;
    }
    if taken.contains(&false) {
        partners(mesh, second, first, tolerance)?;
    }
    Ok(forward)
}

fn partners(
    mesh: &Mesh,
    (facets, own): Side,
    (others, candidates): Side,
    tolerance: f64,
) -> Result<Vec<Partner>, ContactError> {
    // Cells as wide as the tolerance: whatever is close enough lies in one of 27.
    let cell = |p: &Vec3| [p.x, p.y, p.z].map(|x| (x / tolerance).floor() as i64);
    let mut cells: HashMap<[i64; 3], Vec<usize>> = HashMap::new();
    for (index, candidate) in candidates.iter().enumerate() {
        cells
            .entry(cell(&candidate.centroid))
            .or_default()
            .push(index);
    }
    let mut partners = Vec::with_capacity(own.len());
    let mut worst: Option<ContactError> = None;
    let mut most = f64::NEG_INFINITY;
    for (facet, geometry) in facets.iter().zip(own) {
        let near = neighbours(cell(&geometry.centroid))
            .filter_map(|c| cells.get(&c))
            .flatten();
        let found = near.copied().find_map(|index| {
            let corners = corners(mesh, geometry, &candidates[index], tolerance)?;
            Some(Partner {
                facet: index,
                corners,
            })
        });
        if let Some(partner) = found {
            partners.push(partner);
            continue;
        }
        let distance = |index: &usize| (candidates[*index].centroid - geometry.centroid).norm();
        let nearest = (0..candidates.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let Some(nearest) = nearest else {
            return Err(ContactError::Empty);
        };
        if distance(&nearest) > most {
            most = distance(&nearest);
            let element = |facet: Facet| mesh.element_tags()[facet.element as usize];
            worst = Some(ContactError::Unmatched {
                element: element(*facet),
                nearest: element(others[nearest]),
                distance: most,
                tolerance,
            });
        }
    }
    worst.map_or(Ok(partners), Err)
}

/// For each corner of a facet the corner of another one within the tolerance; none unless all have one.
fn corners(
    mesh: &Mesh,
    facet: &FacetGeometry,
    other: &FacetGeometry,
    tolerance: f64,
) -> Option<Vec<usize>> {
    if facet.nodes.len() != other.nodes.len() {
        return None;
    }
    let position = |node: u32| mesh.positions()[node as usize];
    let mut found = Vec::with_capacity(facet.nodes.len());
    for &node in &facet.nodes {
        let distance = |corner: usize| (position(other.nodes[corner]) - position(node)).norm();
        let corner = (0..other.nodes.len())
            .filter(|corner| !found.contains(corner))
            .min_by(|&a, &b| distance(a).total_cmp(&distance(b)))?;
        if distance(corner) > tolerance {
            return None;
        }
        found.push(corner);
    }
    Some(found)
}

/// Facets at one pair of nodes.
#[derive(Default)]
struct Corners {
    /// Index of each facet, its unit normal, and its share of vector area and area (m2).
    facets: Vec<(usize, Vec3, Vec3, f64)>,
    /// Patch of each facet.
    patch: Vec<usize>,
}

impl Corners {
    fn patch_of(&self, facet: usize) -> Option<usize> {
        let index = self.facets.iter().position(|(other, ..)| *other == facet)?;
        Some(self.patch[index])
    }
    /// Vector area and area (m2) of each patch.
    fn sums(&self) -> BTreeMap<usize, (Vec3, f64)> {
        let mut sums: BTreeMap<usize, (Vec3, f64)> = BTreeMap::new();
        for ((_, _, vector, area), &patch) in self.facets.iter().zip(&self.patch) {
            let sum = sums.entry(patch).or_default();
            sum.0 += vector;
            sum.1 += area;
        }
        sums
    }
}

/// Facets at every pair of nodes, in smooth patches: facets whose normals differ by no more than
/// the angle are in one patch, and so are those that others connect.
fn patches(
    own: &[FacetGeometry],
    other: &[FacetGeometry],
    partners: &[Partner],
    angle: f64,
) -> BTreeMap<[u32; 2], Corners> {
    let mut all: BTreeMap<[u32; 2], Corners> = BTreeMap::new();
    for (index, (facet, partner)) in own.iter().zip(partners).enumerate() {
        let opposite = &other[partner.facet];
        for (corner, &facing) in partner.corners.iter().enumerate() {
            let nodes = [facet.nodes[corner], opposite.nodes[facing]];
            if nodes[0] == nodes[1] {
                continue;
            }
            let vector = (facet.shares[corner] - opposite.shares[facing]) * 0.5;
            let area = (facet.areas[corner] + opposite.areas[facing]) * 0.5;
            let corners = all.entry(nodes).or_default();
            corners.patch.push(corners.facets.len());
            corners.facets.push((index, facet.normal(), vector, area));
        }
    }
    // Rounding does not separate facets at the very angle.
    let least = angle.cos() - 1e-9;
    for Corners { facets, patch } in all.values_mut() {
        for i in 0..facets.len() {
            for j in 0..i {
                if facets[i].1.dot(&facets[j].1) >= least && patch[i] != patch[j] {
                    let (kept, gone) = (patch[i].min(patch[j]), patch[i].max(patch[j]));
                    patch
                        .iter_mut()
                        .filter(|p| **p == gone)
                        .for_each(|p| *p = kept);
                }
            }
        }
    }
    all
}
