//! Bodies whose ends are joined across a period, laid out beside themselves.

use std::collections::HashMap;
use std::sync::Arc;

use powerhouse_model::{Mesh, MeshArrays, MeshError};

use super::CrossSection;
use super::plane::Plane;
use super::ramp::REACH;

/// Elements near a plane of a body that repeats along the normal of the plane, with their copies in the next periods.
pub(super) struct Unfolded {
    /// The elements and their copies; at the ends of a period they have nodes in common.
    pub(super) mesh: Mesh,
    /// The element (mesh index) of the body that each of them is, or is a copy of.
    pub(super) originals: Vec<u32>,
}

/// Pairs of nodes at the two ends of a body that are a period apart along the normal of a plane.
struct Period {
    /// Length of the period along the normal (m).
    length: f64,
    /// The node at the other end of each node at the end of lower distance.
    upper_of: HashMap<u32, u32>,
}

impl Period {
    /// The shortest period along the normal of a plane, among the translations of pairs of nodes, that is at least as long as some elements.
    fn along(mesh: &Mesh, plane: &Plane, pairs: &[(u32, u32)], elements: &[u32]) -> Option<Self> {
        let distance = |node: u32| plane.distance(&mesh.positions()[node as usize]);
        let (low, high) = extent(elements.iter().flat_map(|&e| mesh.nodes_of(e)), distance);
        let mut found: Vec<(f64, u32, u32)> = Vec::new();
        for &(a, b) in pairs {
            let step = mesh.positions()[b as usize] - mesh.positions()[a as usize];
            let along = step.dot(&plane.normal);
            // The copies of a plane at an angle to the period would be other planes.
            let aside = (step - plane.normal * along).norm();
            if aside <= 2.0 * plane.tolerance && along.abs() > high - low - plane.tolerance {
                let (lower, upper) = if along > 0.0 { (a, b) } else { (b, a) };
                found.push((along.abs(), lower, upper));
            }
        }
        let length = found
            .iter()
            .map(|pair| pair.0)
            .min_by(f64::total_cmp)
            .filter(|&length| length > plane.tolerance)?;
        let of_length = found
            .into_iter()
            .filter(|pair| pair.0 <= length + 2.0 * plane.tolerance);
        Some(Self {
            length,
            upper_of: of_length.map(|(_, lower, upper)| (lower, upper)).collect(),
        })
    }
}

/// Least and greatest value at some nodes.
fn extent<'n>(nodes: impl Iterator<Item = &'n u32>, value: impl Fn(u32) -> f64) -> (f64, f64) {
    nodes.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &node| {
        let value = value(node);
        (low.min(value), high.max(value))
    })
}

impl Unfolded {
    /// Solid elements near the plane of a section with their copies in the next periods; none if no pairs of nodes (mesh indices) repeat the
    /// body along the normal.
    pub(super) fn around(
        mesh: &Mesh,
        plane: &Plane,
        pairs: &[(u32, u32)],
        section: &CrossSection,
        elements: &[u32],
    ) -> Result<Option<Self>, MeshError> {
        let solid: Vec<u32> = (elements.iter().copied())
            .filter(|&element| mesh.kind(element).is_solid())
            .collect();
        let Some(Period { length, upper_of }) = Period::along(mesh, plane, pairs, &solid) else {
            return Ok(None);
        };
        let distance = |node: u32| plane.distance(&mesh.positions()[node as usize]);
        let extents: Vec<(f64, f64)> = (solid.iter())
            .map(|&element| extent(mesh.nodes_of(element).iter(), distance))
            .collect();
        let longest = extents.iter().map(|(low, high)| high - low);
        let reach = REACH * longest.fold(0.0, f64::max);
        let copies = (reach / length).ceil() as i32 + 1;

        let mut nodes: HashMap<(u32, i32), u32> = HashMap::new();
        let (mut positions, mut connectivity, mut offsets) = (Vec::new(), Vec::new(), vec![0]);
        let (mut kinds, mut originals) = (Vec::new(), Vec::new());
        for copy in -copies..=copies {
            let shift = plane.normal * (f64::from(copy) * length);
            for (&element, &(low, high)) in solid.iter().zip(&extents) {
                let by = f64::from(copy) * length;
                let is_near = low + by <= reach && high + by >= -reach;
                if !is_near || !section.is_within(&(mesh.centroid(element) + shift)) {
                    continue;
                }
                for &node in mesh.nodes_of(element) {
                    // A node at the lower end is that of the upper end in the copy before.
                    let own = match upper_of.get(&node) {
                        Some(&upper) => (upper, copy - 1),
                        None => (node, copy),
                    };
                    let index = *nodes.entry(own).or_insert_with(|| {
                        let (node, copy) = own;
                        let shift = plane.normal * (f64::from(copy) * length);
                        positions.push(mesh.positions()[node as usize] + shift);
                        positions.len() as u32 - 1
                    });
                    connectivity.push(index);
                }
                offsets.push(connectivity.len() as u32);
                kinds.push(mesh.kind(element));
                originals.push(element);
            }
        }
        let unfolded = Mesh::from_arrays(MeshArrays {
            node_tags: Arc::new((1..=positions.len() as u64).collect::<Vec<u64>>()),
            element_tags: Arc::new((1..=kinds.len() as u64).collect::<Vec<u64>>()),
            positions: Arc::new(positions),
            kinds,
            offsets: Arc::new(offsets),
            connectivity: Arc::new(connectivity),
        })?;
        Ok(Some(Self {
            mesh: unfolded,
            originals,
        }))
    }

    /// Indices of all elements and copies.
    pub(super) fn elements(&self) -> Vec<u32> {
        (0..self.originals.len() as u32).collect()
    }
}
