//! Selection of pairs of a joint.

use core::fmt;

use powerhouse_contact::JointSurface;
use powerhouse_model::{Mesh, Vec3};

use crate::Error;

/// Selection of pairs of a joint.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum JointZone {
    /// All pairs.
    #[default]
    All,
    /// Pairs at a node of either side, by the number of the node in the mesh file.
    Node(u64),
    /// Pairs with a node in a node set; in a facet set if there is no such node set, or in an element
    /// set if there is neither.
    Set(String),
    /// Pairs whose first node lies in a box along the axes, its faces included.
    Box {
        /// Lowest corner of the box (m).
        low: Vec3,
        /// Highest corner of the box (m).
        high: Vec3,
    },
    /// Pairs whose first node is nearest to a point.
    Near {
        /// Position of the point (m).
        position: Vec3,
        /// Largest permitted distance of the node from the point (m).
        within: f64,
    },
}

impl fmt::Display for JointZone {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let at = |p: &Vec3| format!("({}, {}, {}) m", p.x, p.y, p.z);
        match self {
            Self::All => f.write_str("all of it"),
            Self::Node(node) => write!(f, "node {node}"),
            Self::Set(set) => write!(f, "set '{set}'"),
            Self::Box { low, high } => write!(f, "the box from {} to {}", at(low), at(high)),
            Self::Near { position, within } => {
                write!(f, "{within} m around {}", at(position))
            }
        }
    }
}

impl JointZone {
    /// Indices of its pairs among those of a named joint, rising and at least one.
    ///
    /// # Errors
    /// A set that does not exist, [`Error::EmptyZone`].
    pub fn pairs(
        &self,
        mesh: &Mesh,
        (joint, surface): (&str, &JointSurface),
    ) -> Result<Vec<usize>, Error> {
        let position = |node: u32| mesh.positions()[node as usize];
        let where_nodes = |inside: &dyn Fn([u32; 2]) -> bool| -> Vec<usize> {
            let pairs = surface.pairs.iter().enumerate();
            let inside = pairs.filter(|(_, pair)| inside(pair.nodes));
            inside.map(|(index, _)| index).collect()
        };
        let of_set = |nodes: &[u32]| {
            let has = |node: &u32| nodes.binary_search(node).is_ok();
            where_nodes(&|nodes| nodes.iter().any(has))
        };
        let mut distance = None;
        let found = match self {
            Self::All => where_nodes(&|_| true),
            Self::Node(tag) => {
                where_nodes(&|nodes| nodes.iter().any(|&n| mesh.node_tags()[n as usize] == *tag))
            }
            Self::Set(set) => match (mesh.node_set(set), mesh.facet_set(set)) {
                (Ok(nodes), _) => of_set(nodes),
                (_, Ok(facets)) => of_set(&mesh.nodes_of_facets(facets)),
                _ => of_set(&mesh.nodes_of_elements(mesh.element_set(set)?)),
            },
            Self::Box { low, high } => where_nodes(&|[node, _]| {
                let p = position(node);
                (0..3).all(|i| (low[i]..=high[i]).contains(&p[i]))
            }),
            Self::Near {
                position: point,
                within,
            } => {
                let to = |node: u32| (position(node) - point).norm();
                let all = surface.pairs.iter().map(|pair| to(pair.nodes[0]));
                let least = all.fold(f64::INFINITY, f64::min);
                distance = Some(least);
                let close = least <= *within;
                where_nodes(&|[node, _]| close && to(node) == least)
            }
        };
        if found.is_empty() {
            return Err(Error::EmptyZone {
                joint: joint.into(),
                zone: self.to_string(),
                distance,
            });
        }
        Ok(found)
    }
}
