//! Tractions of joints by the stress of the elements beside them, where equilibrium alone does not determine them.
//!
//! The force between two nodes of a joint follows from the forces on either. It does not say how two pairs of these nodes, of
//! facets that meet at an edge, divide it; nor which part of the force on two nodes that one support holds goes through the
//! joint and which into the support. The stress on both sides of the joint does, `t = sigma n`. It is fitted to the mean
//! stresses of the elements around the node as a linear function of position, as in superconvergent patch recovery
//! (Zienkiewicz & Zhu 1992), which is exact for a stress that is linear over the patch. At rollers it has no shear along them.
//!
//! Where the joint has water, its pressure is added: the stress is the total one, and joints bear the effective one.
//!
//! What is cast against stressed ground is free of stress, and so is the joint between them: its tractions are those of the stress in
//! the side that was cast last. A joint that was grouted later than both sides were there bears none of the stress that they had
//! before; it has no such tractions.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use nalgebra::Matrix6x3;
use powerhouse_model::{
    ContactState, Facet, FacetGeometry, JointHistory, JointPair, JointRecord, Mat3, Mesh,
    StaticError, Stress, Vec3,
};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::Model;

/// Components of a traction below this share of the greatest of its joint are zero: what the tolerance of a static solution
/// leaves, such as shear across the plane of a slice.
const NEGLIGIBLE: f64 = 1.0e-5;
/// Square of the extent of a patch in a direction, over that of its widest one, below which it has no extent.
const FLAT: f64 = 1.0e-8;
/// Distance below which two places are the same, over displacements and the size of elements.
const SAME_PLACE: f64 = 1.0e-9;
/// Sine of the angle below which two directions count as parallel.
const PARALLEL: f64 = 1.0e-8;
/// Cosine of the angle between the normal of a pair and that of a facet along it.
const ALONG: f64 = 0.7;

/// Element near a joint with its initial stress and the mean change of its stress (Pa).
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Sample {
    element: u32,
    set: String,
    /// Number of its cast among those of the model, from one; zero for elements from the start.
    cast: usize,
    initial: [f64; 6],
    change: [f64; 6],
}

/// Side of a pair: the mesh nodes that have the motion of its node, and the outward normal of the side.
struct PairSide {
    nodes: Vec<u32>,
    normal: Vec3,
}

/// A pair whose traction equilibrium does not determine, by the number of its joint and its own in it.
struct Undetermined {
    joint: usize,
    pair: usize,
    geometry: JointPair,
    sides: [PairSide; 2],
    /// Orthonormal directions in which supports hold both nodes.
    held: Vec<Vec3>,
}

impl Model {
    /// Sets the [reference](powerhouse_model::JointRecord::reference) tractions of the pairs that need one, from the
    /// stress at the present displacement; returns the greatest change of one over the greatest traction.
    pub(super) fn set_reference_tractions(&mut self) -> Result<f64, StaticError> {
        let pairs = self.undetermined_pairs();
        let sides = pairs.iter().flat_map(|pair| &pair.sides);
        let own: BTreeSet<u32> = sides.flat_map(|side| &side.nodes).copied().collect();
        let nodes: BTreeSet<u32> = self.of_all_ranks(&own)?.into_iter().flatten().collect();
        if nodes.is_empty() {
            return Ok(0.0);
        }
        let near = self.samples_at(&nodes)?;
        let near = near.keys().flat_map(|&element| self.mesh.nodes_of(element));
        let samples = self.samples_at(&near.copied().collect())?;
        let patches = Patches::new(self, &samples);
        let mut joints = self.joint_histories();
        for joint in &mut joints {
            for record in &mut joint.records {
                record.reference = None;
            }
        }
        let mut strongest = 0.0_f64;
        for pair in &pairs {
            let sides = pair.sides.iter();
            let stresses: Vec<(usize, Stress)> =
                sides.filter_map(|side| patches.stress_at(side)).collect();
            let Some(last) = stresses.iter().map(|(cast, _)| *cast).max() else {
                continue;
            };
            let components = stresses.iter().flat_map(|(_, stress)| stress.0);
            strongest = components.fold(strongest, |most, component| most.max(component.abs()));
            let record = &mut joints[pair.joint].records[pair.pair];
            if !self.began_with(last, &pair.geometry, record) {
                continue;
            }
            let tractions = stresses.iter().filter(|(cast, _)| *cast == last);
            let tractions = tractions.map(|(_, stress)| {
                beside_supports(stress, &pair.held).traction(&pair.geometry.normal)
            });
            let tractions: Vec<Vec3> = tractions.collect();
            let mean = tractions.iter().sum::<Vec3>() / tractions.len() as f64;
            // The stress is the total one, the traction of a pair the effective one.
            let water = Vec3::x() * pair.geometry.water_pressure;
            record.reference = Some((pair.geometry.to_local(&mean) + water).into());
        }
        self.put_references(joints, strongest)
    }

    /// Whether a pair was closed when the elements of a cast came, or from the start for those that were always there.
    fn began_with(&self, cast: usize, pair: &JointPair, record: &JointRecord) -> bool {
        let cast = cast.checked_sub(1).and_then(|cast| self.casts.get(cast));
        let displacement = |node: u32| {
            let all = cast.map_or(&[][..], |cast| &cast.displacement);
            all.get(node as usize).copied().unwrap_or_default()
        };
        let [first, second] = pair.nodes.map(displacement);
        let off = record.origin() - pair.to_local(&(second - first));
        off.norm() <= SAME_PLACE * (first.norm() + second.norm() + pair.spacing)
    }

    /// Restores the joints with new references, rid of what is negligible; returns their greatest change over the greatest
    /// of all joints, or over what is negligible beside the strongest stress (Pa) there.
    fn put_references(
        &mut self,
        mut joints: Vec<JointHistory>,
        strongest: f64,
    ) -> Result<f64, StaticError> {
        let largest = |joint: &JointHistory| {
            let components = joint.records.iter().filter_map(|record| record.reference);
            components
                .flatten()
                .fold(0.0_f64, |most, component| most.max(component.abs()))
        };
        let own: Vec<(String, f64)> = (joints.iter())
            .map(|joint| (joint.name.clone(), largest(joint)))
            .collect();
        let mut of_joints = BTreeMap::<String, f64>::new();
        for (name, largest) in self.of_all_ranks(&own)?.into_iter().flatten() {
            let most = of_joints.entry(name).or_default();
            *most = most.max(largest);
        }
        let greatest = of_joints
            .values()
            .fold(0.0_f64, |most, of_joint| most.max(*of_joint));
        let mut change = 0.0_f64;
        for (joint, before) in joints.iter_mut().zip(self.joint_histories()) {
            for (record, before) in joint.records.iter_mut().zip(&before.records) {
                let Some(reference) = &mut record.reference else {
                    continue;
                };
                for component in &mut *reference {
                    if component.abs() < NEGLIGIBLE * of_joints[&joint.name] {
                        *component = 0.0;
                    }
                }
                let before = Vec3::from(before.reference.unwrap_or_default());
                change = change.max((Vec3::from(*reference) - before).amax());
            }
        }
        self.restore_joints(&joints);
        let greatest = greatest.max(NEGLIGIBLE * self.ranks.team.most_of(strongest));
        let relative = if change > 0.0 { change / greatest } else { 0.0 };
        Ok(self.ranks.team.most_of(relative))
    }

    /// The closed pairs of which two or more share a node, or whose nodes are both held in some direction.
    fn undetermined_pairs(&self) -> Vec<Undetermined> {
        let mut pairs = Vec::new();
        let mut joint = 0;
        for bound in &self.constraints {
            let views = bound.joints();
            let lead = |node: u32| self.members(&(self.engine(node) as u32))[0];
            let mut count = HashMap::<u32, usize>::new();
            for node in views
                .iter()
                .flat_map(|view| view.pairs)
                .flat_map(|pair| pair.nodes)
            {
                *count.entry(lead(node)).or_default() += 1;
            }
            for view in &views {
                for (index, (pair, record)) in view.pairs.iter().zip(view.records).enumerate() {
                    let leads = pair.nodes.map(lead);
                    let shared = leads.iter().any(|lead| count[lead] > 1);
                    let held = self.held_together(leads);
                    if (shared || !held.is_empty()) && record.state.contact != ContactState::Open {
                        pairs.push(Undetermined {
                            joint,
                            pair: index,
                            geometry: *pair,
                            sides: [0, 1].map(|side| self.side_of(pair, side)),
                            held,
                        });
                    }
                }
                joint += 1;
            }
        }
        pairs
    }

    /// Orthonormal directions in which supports hold, or move, two engine nodes.
    fn held_together(&self, nodes: [u32; 2]) -> Vec<Vec3> {
        let conditions = nodes.map(|node| {
            let group = self.group_of[node as usize];
            group.map(|group| &self.groups.groups[group as usize].condition)
        });
        let [Some(one), Some(other)] = conditions else {
            return Vec::new();
        };
        let (few, many) = if one.directions().len() <= other.directions().len() {
            (one, other)
        } else {
            (other, one)
        };
        let held = few.directions().iter().copied();
        held.filter(|&along| many.free(along).norm() < PARALLEL)
            .collect()
    }

    fn side_of(&self, pair: &JointPair, side: usize) -> PairSide {
        let node = self.engine(pair.nodes[side]) as u32;
        let members = self.members(&node).iter();
        let mesh_of = &self.subdomain.numbering.mesh_of;
        let nodes = members.map(|&member| mesh_of[member as usize]);
        PairSide {
            nodes: nodes
                .filter(|&node| (node as usize) < self.mesh.node_count())
                .collect(),
            normal: if side == 0 { pair.normal } else { -pair.normal },
        }
    }

    /// The active solid elements of all ranks at some nodes (mesh indices), with their mean stresses.
    fn samples_at(&self, nodes: &BTreeSet<u32>) -> Result<BTreeMap<u32, Sample>, StaticError> {
        let absent: BTreeSet<u32> = self.absent.iter().copied().collect();
        let mut cast_of = HashMap::new();
        for (cast, number) in self.casts.iter().zip(1..) {
            cast_of.extend(cast.elements.iter().map(|&element| (element, number)));
        }
        let mut own = Vec::new();
        for (index, block) in self.blocks.iter().enumerate() {
            let here = |element: u32| {
                let known = (element as usize) < self.mesh.element_count();
                known
                    && self.mesh.kind(element).is_solid()
                    && !absent.contains(&element)
                    && self
                        .mesh
                        .nodes_of(element)
                        .iter()
                        .any(|node| nodes.contains(node))
            };
            let of_block = block.elements().iter().enumerate();
            let wanted: Vec<(usize, u32)> = of_block
                .map(|(place, &element)| (place, element))
                .filter(|&(_, element)| here(element))
                .collect();
            if wanted.is_empty() {
                continue;
            }
            let changes = self.stresses_of(index, &self.displacement_of_block(index));
            own.extend(wanted.into_iter().map(|(place, element)| {
                let initial = self.initial.stress(element);
                Sample {
                    element,
                    set: block.label().into(),
                    cast: cast_of.get(&element).copied().unwrap_or(0),
                    initial: initial.0,
                    change: changes[place].0,
                }
            }));
        }
        let all = self.of_all_ranks(&own)?.into_iter().flatten();
        Ok(all.map(|sample| (sample.element, sample)).collect())
    }

    /// A value of each rank, in their order, on all ranks.
    fn of_all_ranks<T>(&self, own: &T) -> Result<Vec<T>, StaticError>
    where
        T: Clone + Serialize + DeserializeOwned,
    {
        let team = &self.ranks.team;
        if team.is_single() {
            return Ok(vec![own.clone()]);
        }
        team.all(own).map_err(|error| StaticError::OnRank {
            rank: team.rank(),
            message: error.to_string(),
        })
    }
}

/// Stress at a place where supports hold one or two directions, whose faces bear no shear.
fn beside_supports(stress: &Stress, held: &[Vec3]) -> Stress {
    if held.is_empty() || held.len() > 2 {
        return *stress;
    }
    let matrix = stress.matrix();
    let along =
        |part: Mat3, axis: &Vec3| part + axis * axis.transpose() * axis.dot(&(matrix * axis));
    let supported = held.iter().fold(Mat3::zeros(), along);
    let across = held.iter().fold(Mat3::identity(), |rest, axis| {
        rest - axis * axis.transpose()
    });
    Stress::from_matrix(&(supported + across * matrix * across))
}

/// Elements near the joints, by their nodes.
struct Patches<'a> {
    mesh: &'a Mesh,
    samples: &'a BTreeMap<u32, Sample>,
    at: HashMap<u32, Vec<u32>>,
    /// Whether the initial stress is uniform in each element.
    is_uniform: bool,
}

impl<'a> Patches<'a> {
    fn new(model: &'a Model, samples: &'a BTreeMap<u32, Sample>) -> Self {
        let mesh = &model.mesh;
        let mut at = HashMap::<u32, Vec<u32>>::new();
        for &element in samples.keys() {
            for &node in mesh.nodes_of(element) {
                at.entry(node).or_default().push(element);
            }
        }
        Self {
            is_uniform: model.initial.slope.is_empty(),
            mesh,
            samples,
            at,
        }
    }

    /// Stress on a side of a pair, whose force on the node is its product with the area, by the elements within two layers
    /// around its nodes that are of one set and cast with an element along the joint, and the last of these casts; none without
    /// elements.
    ///
    /// The force of a stress that varies is that of the mean weighted by the shape function of the node, that of an initial stress
    /// that is uniform in each element that of the mean over the facets.
    fn stress_at(&self, side: &PairSide) -> Option<(usize, Stress)> {
        let (mut initial, mut change, mut last) = (Vec::new(), Vec::new(), 0);
        let (mut middle, mut weighted, mut area) = (Vec3::zeros(), Vec3::zeros(), 0.0);
        for &node in &side.nodes {
            let here = self.mesh.positions()[node as usize];
            let first = self.around(node);
            let nodes = first
                .iter()
                .flat_map(|&element| self.mesh.nodes_of(element));
            let patch: BTreeSet<u32> = nodes.flat_map(|&node| self.around(node)).copied().collect();
            let mut sets = BTreeSet::<(&str, usize)>::new();
            for &element in first {
                for facet in self.facets_along(element, node, &side.normal) {
                    let sample = &self.samples[&element];
                    sets.insert((&sample.set, sample.cast));
                    last = last.max(sample.cast);
                    if self.is_free(element, &facet.nodes) {
                        let share = Share::of(self.mesh, &facet, node);
                        middle += (facet.centroid - here) * share.area;
                        weighted += (share.centre - here) * share.area;
                        area += share.area;
                    }
                }
            }
            for &element in &patch {
                let sample = &self.samples[&element];
                if sets.contains(&(sample.set.as_str(), sample.cast)) {
                    let away = self.mesh.centroid(element) - here;
                    initial.push((away, sample.initial));
                    change.push((away, sample.change));
                }
            }
        }
        let from = |sum: Vec3| {
            if area > 0.0 {
                sum / area
            } else {
                Vec3::zeros()
            }
        };
        let uniform = if self.is_uniform { middle } else { weighted };
        let initial = linear_fit(&initial, &from(uniform))?;
        let change = linear_fit(&change, &from(weighted))?;
        let stress = Stress(core::array::from_fn(|i| initial[i] + change[i]));
        Some((last, stress))
    }

    fn around(&self, node: u32) -> &[u32] {
        self.at.get(&node).map_or(&[], Vec::as_slice)
    }

    /// Facets of an element at a node with about a normal.
    fn facets_along(
        &self,
        element: u32,
        node: u32,
        normal: &Vec3,
    ) -> impl Iterator<Item = FacetGeometry> {
        let sides = 0..self.mesh.kind(element).sides().len() as u8;
        let facets = sides.map(move |side| self.mesh.facet_geometry(Facet { element, side }));
        facets
            .filter(move |facet| facet.nodes.contains(&node) && facet.normal().dot(normal) > ALONG)
    }

    /// Whether no other element lies behind a facet of an element.
    fn is_free(&self, element: u32, facet: &[u32]) -> bool {
        let beside = facet.first().map_or(&[][..], |&node| self.around(node));
        !beside.iter().any(|&other| {
            let nodes = self.mesh.nodes_of(other);
            other != element && facet.iter().all(|node| nodes.contains(node))
        })
    }
}

/// Share of a node in a facet: its area `integral of N dA` (m2), and the mean position weighted by `N` (m).
struct Share {
    area: f64,
    centre: Vec3,
}

impl Share {
    fn of(mesh: &Mesh, facet: &FacetGeometry, node: u32) -> Self {
        let count = facet.nodes.len();
        let own = facet
            .nodes
            .iter()
            .position(|&other| other == node)
            .unwrap_or(0);
        let at = |k: usize| mesh.positions()[facet.nodes[(own + k) % count] as usize];
        let centre = match count {
            3 => (at(0) * 2.0 + at(1) + at(2)) / 4.0,
            4 => (at(0) * 4.0 + (at(1) + at(3)) * 2.0 + at(2)) / 9.0,
            // Of four plane triangles: a corner is in one, a midpoint in three.
            6 if own % 2 == 0 => (at(0) * 2.0 + at(1) + at(5)) / 4.0,
            6 => (at(0) * 6.0 + at(1) + at(5) + (at(2) + at(4)) * 2.0) / 12.0,
            _ => facet.centroid,
        };
        Self {
            area: facet.areas[own],
            centre,
        }
    }
}

/// Value at a place of the linear function of position that fits some values best; its gradient is zero in directions
/// in which the positions have no extent. None without values.
fn linear_fit(points: &[(Vec3, [f64; 6])], place: &Vec3) -> Option<[f64; 6]> {
    let count = points.len() as f64;
    if points.is_empty() {
        return None;
    }
    let middle = points.iter().map(|(at, _)| at).sum::<Vec3>() / count;
    let mean: [f64; 6] =
        core::array::from_fn(|i| points.iter().map(|(_, value)| value[i]).sum::<f64>() / count);
    let (mut spread, mut moment) = (Mat3::zeros(), Matrix6x3::zeros());
    for (at, value) in points {
        let away = at - middle;
        spread += away * away.transpose();
        let change = nalgebra::Vector6::from_fn(|i, _| value[i] - mean[i]);
        moment += change * away.transpose();
    }
    let eigen = spread.symmetric_eigen();
    let widest = eigen.eigenvalues.max();
    let mut inverse = Mat3::zeros();
    for (&value, vector) in eigen
        .eigenvalues
        .iter()
        .zip(eigen.eigenvectors.column_iter())
    {
        if value > FLAT * widest {
            inverse += vector * vector.transpose() / value;
        }
    }
    let change = moment * inverse * (place - middle);
    Some(core::array::from_fn(|i| mean[i] + change[i]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A linear function is recovered from values elsewhere, whatever the positions' extents; of positions in a plane its part
    /// along that, and of one position its value.
    #[test]
    fn a_linear_function_is_recovered() {
        let slope = Vec3::new(3.0, -2.0, 0.5);
        let of = |at: &Vec3| core::array::from_fn(|i| 7.0 + (i as f64 + 1.0) * slope.dot(at));
        let corners = |extent: Vec3| -> Vec<(Vec3, [f64; 6])> {
            let corner = |k: usize| Vec3::from_fn(|c, _| f64::from((k >> c & 1) as u8));
            let at = (0..8).map(|k| corner(k).component_mul(&extent) + Vec3::new(4.0, 0.0, 2.0));
            at.map(|at| (at, of(&at))).collect()
        };
        let place = Vec3::new(1.0, 0.0, -2.0);
        let recovered = |extent: Vec3| {
            let found = linear_fit(&corners(extent), &place).unwrap();
            let expected: [f64; 6] = of(&place);
            let errors = found.iter().zip(&expected).map(|(a, b)| (a - b).abs());
            errors.fold(0.0_f64, f64::max)
        };
        assert!(recovered(Vec3::new(1.0, 2.0, 3.0)) < 1e-11);
        assert!(recovered(Vec3::new(10.0, 0.1, 1.0)) < 1e-11);
        assert!(recovered(Vec3::new(1.0, 0.0, 2.0)) < 1e-11);
        let one = [(Vec3::x(), of(&Vec3::x()))];
        assert_eq!(linear_fit(&one, &place).unwrap(), one[0].1);
        assert_eq!(linear_fit(&[], &place), None);
    }

    /// The shares of the nodes of a facet of any shape add up to its area and to its area times its centroid.
    #[test]
    fn shares_add_up_to_the_facet() {
        let meshes = [
            Mesh::box_of_hexes(Vec3::zeros(), Vec3::new(1.0, 2.0, 3.0), [1, 1, 1], "rock"),
            Mesh::box_of_tets(Vec3::zeros(), Vec3::new(1.0, 2.0, 3.0), [1, 1, 1], "rock"),
        ];
        let mut meshes: Vec<Mesh> = meshes.into_iter().map(Result::unwrap).collect();
        meshes.push(meshes[1].with_midpoints().unwrap());
        for mesh in &meshes {
            for side in 0..mesh.kind(0).sides().len() as u8 {
                let facet = mesh.facet_geometry(Facet { element: 0, side });
                let shares = facet
                    .nodes
                    .iter()
                    .map(|&node| Share::of(mesh, &facet, node));
                let (mut area, mut moment) = (0.0, Vec3::zeros());
                for share in shares {
                    area += share.area;
                    moment += share.centre * share.area;
                }
                let corners = mesh.facet_corners(Facet { element: 0, side });
                let middle = corners
                    .iter()
                    .map(|&n| mesh.positions()[n as usize])
                    .sum::<Vec3>()
                    / corners.len() as f64;
                assert!((area - facet.area()).abs() < 1e-14);
                assert!(
                    (moment / area - middle).norm() < 1e-14,
                    "{:?}",
                    mesh.kind(0)
                );
            }
        }
    }
}
