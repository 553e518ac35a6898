//! Extension of a mesh beyond one of its faces.

use std::collections::{BTreeMap, HashMap, HashSet};

use powerhouse::model::{ElementKind, Facet, Mesh, MeshError, ParameterError, Vec3};

use crate::StudyError;

/// Norm of the summed area vectors over the sum of areas from which on a face counts as plane.
const PLANE: f64 = 1.0 - 1e-9;

/// Extends a mesh by layers of elements that are extruded outwards from a plane facet set, with thicknesses (m) from
/// the face outwards.
///
/// Nodes and elements of the mesh keep their indices and numbers; new ones follow them. A new element belongs to the
/// element sets of the element from which it is extruded. Facet sets on the face move to the outermost layer, facet
/// sets that meet the face at an edge are continued along the new elements, and node sets are unchanged.
///
/// # Errors
/// A set that does not exist, is empty or not plane, or has elements with nodes on their edges; a thickness that is not
/// positive.
///
/// ```
/// use powerhouse::model::{Mesh, Vec3};
/// use powerhouse_study::grown;
/// let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(2.0), [2; 3], "rock")?;
/// let wide = grown(&mesh, "right", &[1.0, 1.5])?;
/// assert_eq!(wide.element_count(), 16);
/// assert_eq!(wide.bounding_box().1.x, 4.5);
/// assert_eq!(wide.facet_set("top")?.len(), 8);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn grown(mesh: &Mesh, face: &str, thicknesses: &[f64]) -> Result<Mesh, StudyError> {
    for &thickness in thicknesses {
        ParameterError::check("thickness", thickness, f64::MIN_POSITIVE, f64::MAX)?;
    }
    let facets = mesh.facet_set(face)?;
    let areas = facets.iter().map(|&f| mesh.facet_geometry(f).vector_area);
    let areas: Vec<Vec3> = areas.collect();
    let mean: Vec3 = areas.iter().sum();
    let sum: f64 = areas.iter().map(Vec3::norm).sum();
    if mean.norm() < PLANE * sum || sum <= 0.0 {
        return Err(StudyError::NotPlane { face: face.into() });
    }
    let has_midpoints = |facet: &&Facet| !mesh.kind(facet.element).edges_with_midpoint().is_empty();
    if let Some(facet) = facets.iter().find(has_midpoints) {
        let (face, element) = (face.into(), mesh.element_tags()[facet.element as usize]);
        return Err(StudyError::Midpoints { face, element });
    }
    let extrusion = Extrusion {
        mesh,
        facets,
        on_face: facets.iter().copied().collect(),
        normal: mean.normalize(),
        base: mesh.nodes_of_facets(facets),
        last: mesh.node_tags().iter().max().copied().unwrap_or(0),
    };
    Ok(extrusion.mesh(thicknesses)?)
}

/// Extrusion of a mesh beyond one of its faces.
struct Extrusion<'m> {
    mesh: &'m Mesh,
    facets: &'m [Facet],
    on_face: HashSet<Facet>,
    normal: Vec3,
    /// Nodes of the face.
    base: Vec<u32>,
    /// Greatest node number.
    last: u64,
}

impl Extrusion<'_> {
    /// The number of the node in a layer above a node of the face (layer 0).
    fn tag(&self, node: u32, layer: usize) -> u64 {
        if layer == 0 {
            return self.mesh.node_tags()[node as usize];
        }
        let index = self.base.partition_point(|&other| other < node);
        self.last + 1 + ((layer - 1) * self.base.len() + index) as u64
    }

    fn mesh(&self, thicknesses: &[f64]) -> Result<Mesh, MeshError> {
        let mesh = self.mesh;
        let tags = |nodes: &[u32], layer: usize| -> Vec<u64> {
            nodes.iter().map(|&node| self.tag(node, layer)).collect()
        };
        let mut builder = Mesh::builder();
        for (tag, position) in mesh.node_tags().iter().zip(mesh.positions()) {
            builder.node(*tag, *position);
        }
        let mut out = 0.0;
        for (layer, thickness) in thicknesses.iter().enumerate() {
            out += thickness;
            for &node in &self.base {
                let position = mesh.positions()[node as usize] + out * self.normal;
                builder.node(self.tag(node, layer + 1), position);
            }
        }
        let mut sets_of: Vec<Vec<&str>> = vec![Vec::new(); mesh.element_count()];
        for (set, elements) in mesh.element_sets() {
            for &element in elements {
                sets_of[element as usize].push(set);
            }
        }
        for (element, sets) in sets_of.iter().enumerate() {
            let nodes = tags(mesh.nodes_of(element as u32), 0);
            builder.element(
                mesh.element_tags()[element],
                mesh.kind(element as u32),
                &nodes,
                sets,
            );
        }
        let mut tag = mesh.element_tags().iter().max().copied().unwrap_or(0);
        for layer in 0..thicknesses.len() {
            for facet in self.facets {
                tag += 1;
                // Counter-clockwise seen from outside, as the bottom of an element is from above.
                let ring = mesh.facet_nodes(*facet);
                let nodes = [tags(&ring, layer), tags(&ring, layer + 1)].concat();
                let kind = match ring.len() {
                    3 => ElementKind::Wedge6,
                    _ => ElementKind::Hex8,
                };
                builder.element(tag, kind, &nodes, &sets_of[facet.element as usize]);
            }
        }
        for (set, facets) in mesh.facet_sets() {
            for facet in facets {
                let layer = if self.on_face.contains(facet) {
                    thicknesses.len()
                } else {
                    0
                };
                builder.facet(set, &tags(&mesh.facet_nodes(*facet), layer));
            }
        }
        for (edge, sets) in self.boundary_edges() {
            for layer in 0..thicknesses.len() {
                let side = [tags(&edge, layer), tags(&edge, layer + 1)].concat();
                for set in &sets {
                    builder.facet(set, &side);
                }
            }
        }
        for (set, nodes) in mesh.node_sets() {
            builder.node_set(set, &tags(nodes, 0));
        }
        let mut grown = builder.build()?;
        // Empty sets are kept, too.
        for set in mesh.facet_sets().keys() {
            if grown.facet_set(set).is_err() {
                grown.set_facet_set(set, Vec::new())?;
            }
        }
        Ok(grown)
    }

    /// The boundary edges of the face, with the other facet sets that contain them.
    fn boundary_edges(&self) -> BTreeMap<[u32; 2], Vec<&str>> {
        let mut counts: HashMap<[u32; 2], usize> = HashMap::new();
        for facet in self.facets {
            for edge in edges(&self.mesh.facet_nodes(*facet)) {
                *counts.entry(edge).or_default() += 1;
            }
        }
        let single = counts.into_iter().filter(|(_, count)| *count == 1);
        let mut found: BTreeMap<[u32; 2], Vec<&str>> =
            single.map(|(edge, _)| (edge, Vec::new())).collect();
        for (set, facets) in self.mesh.facet_sets() {
            for facet in facets.iter().filter(|facet| !self.on_face.contains(facet)) {
                for edge in edges(&self.mesh.facet_nodes(*facet)) {
                    if let Some(sets) = found.get_mut(&edge)
                        && !sets.contains(&set.as_str())
                    {
                        sets.push(set);
                    }
                }
            }
        }
        found
    }
}

/// The edges of a facet, each with its lower node first.
fn edges(nodes: &[u32]) -> impl Iterator<Item = [u32; 2]> {
    (0..nodes.len()).map(|i| {
        let mut edge = [nodes[i], nodes[(i + 1) % nodes.len()]];
        edge.sort_unstable();
        edge
    })
}
