//! Absorbing boundaries: interface, site and parts.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::{
    ElasticMedium, ElementBlock, Facet, IncidentField, Mat3, Mesh, ModelError, NodalLoad, Vec3,
};

/// Tributary area of a boundary node on one face, for one medium and one normal direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SiteFace {
    /// Index of the named face in [`BoundarySite::faces`].
    pub face: usize,
    /// Elastic medium of the elements behind the area.
    pub medium: ElasticMedium,
    /// Unit normal of the area, out of the body.
    pub normal: Vec3,
    /// Tributary area of the node (m2).
    pub area: f64,
}

/// A boundary node with its tributary areas.
#[derive(Clone, Debug)]
pub struct SiteNode {
    /// Mesh index of the node.
    pub node: u32,
    /// Position of the node in the undeformed mesh (m).
    pub position: Vec3,
    /// Tributary areas of the node: one inside a plane face, two on an edge, three at a corner, also if
    /// the adjacent sides belong to the same named face. There is one entry for every face, medium and
    /// normal direction, so that areas times normals add up to the vector area of the
    /// face.
    pub faces: Vec<SiteFace>,
}

/// Geometry, ground and incident field from which an absorbing boundary is built.
#[non_exhaustive]
pub struct BoundarySite<'a> {
    /// Names of the absorbing faces, to which `SiteFace::face` is an index; in scenes their facet sets.
    pub faces: Vec<String>,
    /// Nodes with their tributary areas, each node once.
    pub nodes: Vec<SiteNode>,
    /// Centre of the scatterer (the structure), from which spring distances are measured (m).
    pub scatterer: Vec3,
    /// Free field (incident field with its reflections) to be applied at the boundary; none for a boundary without input.
    pub field: Option<&'a dyn IncidentField>,
    /// Slowness along y (s/m) of all motion of a delayed slice ([`DelayedPairs`](crate::DelayedPairs)); zero for every
    /// other body.
    pub slowness: f64,
}

impl<'a> BoundarySite<'a> {
    /// A site of nodes whose shares name faces by their index; `scatterer` (m) and `field` as in the struct.
    pub fn new(
        faces: Vec<String>,
        nodes: Vec<SiteNode>,
        scatterer: Vec3,
        field: Option<&'a dyn IncidentField>,
    ) -> Self {
        Self {
            faces,
            nodes,
            scatterer,
            field,
            slowness: 0.0,
        }
    }

    /// The same site of a delayed slice, with the slowness along y (s/m) of its motion.
    #[must_use]
    pub fn with_slowness(mut self, slowness: f64) -> Self {
        self.slowness = slowness;
        self
    }

    /// The site of named faces of a mesh, nodes in rising order.
    ///
    /// `medium` returns the elastic medium of an element (mesh index); `scatterer` and `field` as in the struct.
    ///
    /// # Panics
    /// If a facet does not belong to the mesh.
    pub fn from_mesh(
        mesh: &Mesh,
        faces: &[(&str, &[Facet])],
        medium: impl Fn(u32) -> ElasticMedium,
        scatterer: Vec3,
        field: Option<&'a dyn IncidentField>,
    ) -> Self {
        let mut shares: BTreeMap<u32, Vec<SiteFace>> = BTreeMap::new();
        for (face, (_, facets)) in faces.iter().enumerate() {
            for &facet in *facets {
                let medium = medium(facet.element);
                let geometry = mesh.facet_geometry(facet);
                let parts = geometry.shares.iter().zip(&geometry.areas);
                for (&node, (&vector, &area)) in geometry.nodes.iter().zip(parts) {
                    let share = SiteFace {
                        face,
                        medium,
                        normal: vector,
                        area,
                    };
                    add_share(shares.entry(node).or_default(), share);
                }
            }
        }
        for share in shares.values_mut().flatten() {
            share.normal = share.normal.try_normalize(0.0).unwrap_or_default();
        }
        Self {
            faces: faces.iter().map(|(name, _)| (*name).into()).collect(),
            nodes: shares
                .into_iter()
                .map(|(node, faces)| SiteNode {
                    node,
                    position: mesh.positions()[node as usize],
                    faces,
                })
                .collect(),
            scatterer,
            field,
            slowness: 0.0,
        }
    }
}

/// Angle (rad) below which two normals count as equal; rounded coordinates bend a plane by less.
const SAME_NORMAL: f64 = 1e-6;

/// Adds the tributary area of a node on one facet, with its vector area as `normal`, to the entry of the same
/// face, medium and direction.
fn add_share(shares: &mut Vec<SiteFace>, new: SiteFace) {
    let alike = |share: &&mut SiteFace| {
        let lengths = share.normal.norm() * new.normal.norm();
        (share.face, share.medium) == (new.face, new.medium)
            && share.normal.dot(&new.normal) > 0.0
            && share.normal.cross(&new.normal).norm() <= SAME_NORMAL * lengths
    };
    match shares.iter_mut().find(alike) {
        Some(share) => {
            share.normal += new.normal;
            share.area += new.area;
        }
        None => shares.push(new),
    }
}

/// Spring and dashpot matrices between one node and the ground (boundary impedance).
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct NodalImpedance {
    /// Mesh index of the node.
    pub node: u32,
    /// Spring matrix (N/m), symmetric and positive semi-definite; acts on the displacement since the
    /// start of the stage.
    pub spring: Mat3,
    /// Dashpot matrix (N s/m), symmetric and positive semi-definite; acts on the velocity.
    pub dashpot: Mat3,
    /// Gyroscopic matrix (N s/m), skew-symmetric: a force across the velocity, which does no work. It couples y with x and z
    /// at the faces of a delayed slice, and is zero everywhere else.
    pub gyroscopic: Mat3,
}

impl NodalImpedance {
    /// The impedance of a node (mesh index): spring (N/m) and dashpot (N s/m), both symmetric and positive
    /// semi-definite.
    pub fn new(node: u32, spring: Mat3, dashpot: Mat3) -> Self {
        Self {
            node,
            spring,
            dashpot,
            gyroscopic: Mat3::zeros(),
        }
    }
    /// The same impedance with a gyroscopic matrix (N s/m), skew-symmetric.
    #[must_use]
    pub fn with_gyroscopic(mut self, gyroscopic: Mat3) -> Self {
        self.gyroscopic = gyroscopic;
        self
    }
}

/// An element block of a boundary with additional nodes, such as an absorbing layer.
pub struct ExtraBlock {
    /// Positions of the additional nodes (m). The additional nodes of all blocks of a boundary are numbered after those
    /// of the mesh, in the order of the blocks.
    pub nodes: Vec<Vec3>,
    /// The block, with nodes of the mesh and additional nodes.
    pub block: Box<dyn ElementBlock>,
}

/// Springs, dashpots, input forces and additional elements of an absorbing boundary, which the engine
/// applies.
#[derive(Default)]
#[non_exhaustive]
pub struct BoundaryParts {
    /// Springs and dashpots of boundary nodes; they enter the effective mass of their node implicitly and do not
    /// reduce the stable step.
    pub impedance: Vec<NodalImpedance>,
    /// Equivalent nodal forces of the input, on the boundary or inside; each load is evaluated as one parallel task.
    pub loads: Vec<Box<dyn NodalLoad>>,
    /// Additional element blocks outside the mesh, such as absorbing layers.
    pub blocks: Vec<ExtraBlock>,
}

impl BoundaryParts {
    /// Adds springs and dashpots of nodes.
    #[must_use]
    pub fn with_impedance(mut self, impedance: impl IntoIterator<Item = NodalImpedance>) -> Self {
        self.impedance.extend(impedance);
        self
    }
    /// Adds nodal forces (N) by which the free field enters.
    #[must_use]
    pub fn with_loads(mut self, loads: Vec<Box<dyn NodalLoad>>) -> Self {
        self.loads.extend(loads);
        self
    }
    /// The same with these additional element blocks added.
    #[must_use]
    pub fn with_blocks(mut self, blocks: impl IntoIterator<Item = ExtraBlock>) -> Self {
        self.blocks.extend(blocks);
        self
    }
}

/// An absorbing boundary: it transmits outgoing waves and applies the incident field.
///
/// It takes no part in the run: [`build`](Self::build) is called once for each model, before its first step, and returns
/// all that the engine applies. Equal sites must give equal parts: studies build the boundary for sites of their own.
///
/// ```
/// use powerhouse_model::{AbsorbingBoundary, BoundaryParts, BoundarySite, Mat3, ModelError, NodalImpedance};
/// /// Dashpots with the shear impedance in every direction.
/// struct Uniform;
/// impl AbsorbingBoundary for Uniform {
///     fn name(&self) -> &str { "uniform" }
///     fn build(&self, site: &BoundarySite) -> Result<BoundaryParts, ModelError> {
///         let impedance = site.nodes.iter().map(|node| {
///             let shear_impedance: f64 = node.faces.iter()
///                 .map(|face| face.medium.density * face.medium.s_speed() * face.area)
///                 .sum();
///             NodalImpedance::new(node.node, Mat3::zeros(), Mat3::identity() * shear_impedance)
///         });
///         Ok(BoundaryParts::default().with_impedance(impedance))
///     }
/// }
/// ```
pub trait AbsorbingBoundary: Send + Sync {
    /// Name of the boundary in reports.
    fn name(&self) -> &str;
    /// Computes the springs, dashpots, loads and additional blocks for a site.
    ///
    /// # Errors
    /// If the boundary cannot be built for the site, such as with a zero distance from the scatterer; the model is then
    /// not built.
    fn build(&self, site: &BoundarySite) -> Result<BoundaryParts, ModelError>;
    /// Impedances of its dashpots over those of plane waves in the medium (1), on faces whose normals are nearest to x, y and z: for
    /// predictions of its reflections, which take 1 where there are none, as by default.
    fn speed_ratios(&self) -> Option<[f64; 3]> {
        None
    }
}

impl<B: AbsorbingBoundary + ?Sized> AbsorbingBoundary for Box<B> {
    fn name(&self) -> &str {
        (**self).name()
    }
    fn speed_ratios(&self) -> Option<[f64; 3]> {
        (**self).speed_ratios()
    }
    fn build(&self, site: &BoundarySite) -> Result<BoundaryParts, ModelError> {
        (**self).build(site)
    }
}

impl<B: AbsorbingBoundary + ?Sized> AbsorbingBoundary for Arc<B> {
    fn name(&self) -> &str {
        (**self).name()
    }
    fn speed_ratios(&self) -> Option<[f64; 3]> {
        (**self).speed_ratios()
    }
    fn build(&self, site: &BoundarySite) -> Result<BoundaryParts, ModelError> {
        (**self).build(site)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ElementKind, MeshError};

    /// Two unit cubes side by side along x, the left one `rock`, the right one `lining`; their
    /// bottom is `base`, the left end `end`.
    fn two_cubes() -> Result<Mesh, MeshError> {
        let mut builder = Mesh::builder();
        let tag = |x: u64, y: u64, z: u64| 1 + x + 3 * y + 6 * z;
        for z in 0..2 {
            for y in 0..2 {
                for x in 0..3 {
                    builder.node(tag(x, y, z), Vec3::new(x as f64, y as f64, z as f64));
                }
            }
        }
        for (x, set) in [(0, "rock"), (1, "lining")] {
            let ring = |z| {
                [
                    tag(x, 0, z),
                    tag(x + 1, 0, z),
                    tag(x + 1, 1, z),
                    tag(x, 1, z),
                ]
            };
            builder.element(
                x + 1,
                ElementKind::Hex8,
                &[ring(0), ring(1)].concat(),
                &[set],
            );
            builder.facet("base", &ring(0));
        }
        builder.facet(
            "end",
            &[tag(0, 0, 0), tag(0, 1, 0), tag(0, 1, 1), tag(0, 0, 1)],
        );
        builder.build()
    }

    /// A site shares every face's area among its nodes, keeps the media behind a node apart, and
    /// lists every face that meets at an edge.
    #[test]
    fn a_site_divides_faces_by_node_and_medium() {
        let mesh = two_cubes().unwrap();
        let rock = ElasticMedium::new(9.0e9, 0.27, 2750.0).unwrap();
        let lining = ElasticMedium::new(25.0e9, 0.17, 2500.0).unwrap();
        let in_rock = mesh.element_set("rock").unwrap().to_vec();
        let site = BoundarySite::from_mesh(
            &mesh,
            &[
                ("base", mesh.facet_set("base").unwrap()),
                ("end", mesh.facet_set("end").unwrap()),
            ],
            |element| {
                if in_rock.contains(&element) {
                    rock
                } else {
                    lining
                }
            },
            Vec3::zeros(),
            None,
        );
        assert_eq!(site.faces, ["base", "end"]);
        let area = |face| -> f64 {
            let shares = site.nodes.iter().flat_map(|node| &node.faces);
            shares.filter(|f| f.face == face).map(|f| f.area).sum()
        };
        assert!((area(0) - 2.0).abs() < 1e-14 && (area(1) - 1.0).abs() < 1e-14);
        let at = |x: f64, y: f64, z: f64| {
            let position = Vec3::new(x, y, z);
            site.nodes.iter().find(|n| n.position == position).unwrap()
        };
        let contact = &at(1.0, 0.0, 0.0).faces;
        assert_eq!(contact.len(), 2);
        assert_eq!((contact[0].medium, contact[1].medium), (rock, lining));
        assert!(contact.iter().all(|f| (f.area - 0.25).abs() < 1e-14));
        let edge = &at(0.0, 0.0, 0.0).faces;
        assert_eq!(edge.len(), 2);
        assert!((edge[0].normal + Vec3::z()).norm() < 1e-14);
        assert!((edge[1].normal + Vec3::x()).norm() < 1e-14);
    }
    /// An edge inside one face is the edge between two: the areas along their normals add up to
    /// the face's vector area at every node, whatever the names.
    #[test]
    fn a_face_around_an_edge_keeps_both_directions() {
        let mesh = two_cubes().unwrap();
        let rock = ElasticMedium::new(9.0e9, 0.27, 2750.0).unwrap();
        let (base, end) = (
            mesh.facet_set("base").unwrap(),
            mesh.facet_set("end").unwrap(),
        );
        let shell = [base, end].concat();
        let site = |faces: &[(&str, &[Facet])]| {
            BoundarySite::from_mesh(&mesh, faces, |_| rock, Vec3::zeros(), None)
        };
        let (one, two) = (site(&[("shell", &shell)]), site(&[("b", base), ("e", end)]));
        assert_eq!(one.nodes.len(), two.nodes.len());
        for (one, two) in one.nodes.iter().zip(&two.nodes) {
            let directions = |node: &SiteNode| -> Vec<(Vec3, f64)> {
                node.faces.iter().map(|f| (f.normal, f.area)).collect()
            };
            assert_eq!(directions(one), directions(two));
        }
    }

    /// However flat a fold in a face is, areas along their normals add up to the vector area of its facets at every node.
    #[test]
    fn a_folded_face_keeps_its_directions() {
        let rock = ElasticMedium::new(9.0e9, 0.27, 2750.0).unwrap();
        for fold in [0.01, 0.3, 2.0] {
            let folded = |at: Vec3| Vec3::new(at.x, at.y, at.z + fold * (at.x - 1.0).abs());
            let mesh = two_cubes().unwrap().map_positions(folded).unwrap();
            let base = mesh.facet_set("base").unwrap();
            let faces = [("base", base)];
            let site = BoundarySite::from_mesh(&mesh, &faces, |_| rock, Vec3::zeros(), None);
            for node in &site.nodes {
                let mut expected = Vec3::zeros();
                for &facet in base {
                    let geometry = mesh.facet_geometry(facet);
                    let place = geometry.nodes.iter().position(|n| *n == node.node);
                    expected += place.map_or(Vec3::zeros(), |place| geometry.shares[place]);
                }
                let found: Vec3 = node.faces.iter().map(|f| f.normal * f.area).sum();
                assert!((found - expected).norm() < 1e-12, "{fold} {node:?}");
            }
        }
    }
}
