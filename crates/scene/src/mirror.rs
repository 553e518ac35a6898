//! Planes of symmetry or antisymmetry of body and motion.

use powerhouse_model::{Facet, FieldMotion, FieldSampler, IncidentField, Support, Vec3};
use thiserror::Error;

use crate::check_heights::CheckHeights;
use crate::{Error, Scene, Subject};

/// Parity of the motion about a symmetry plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parity {
    /// Symmetric: the other half moves as the mirror image of the modelled one.
    Symmetric,
    /// Antisymmetric: the other half moves as the mirror image with the opposite sign.
    Antisymmetric,
}

impl Parity {
    /// Name of the parity in messages.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Symmetric => "symmetric",
            Self::Antisymmetric => "antisymmetric",
        }
    }

    /// Vector of the other half: `v - 2 (v.n) n`, with the opposite sign if antisymmetric.
    fn image(self, normal: &Vec3, vector: &Vec3) -> Vec3 {
        let mirrored = reflected(normal, vector);
        match self {
            Self::Symmetric => mirrored,
            Self::Antisymmetric => -mirrored,
        }
    }
}

/// Symmetry plane at which half of a body is modelled in place of the whole.
///
/// Nodes on the plane have no displacement along its normal if the motion is symmetric, and none in the plane if it is
/// antisymmetric. Loads and prescribed motions are assumed to have the same parity; waves, weights and materials are
/// checked when the scene is prepared. A vertical plane is a plane of symmetry for P and SV waves that travel along
/// it, of antisymmetry for SH waves that travel along it and for vertically incident SV waves polarised along its
/// normal.
///
/// ```
/// use powerhouse_scene::{Mirror, Parity};
/// use powerhouse_model::{Mesh, Vec3};
/// let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(4.0), [4; 3], "rock")?;
/// let nodes = mesh.nodes_of_facets(mesh.facet_set("left")?);
/// let mirror = Mirror { nodes, normal: Vec3::x(), parity: Parity::Symmetric };
/// assert_eq!(mirror.nodes.len(), 25);
/// # Ok::<(), powerhouse_model::MeshError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Mirror {
    /// Nodes on the plane (mesh indices): all of the body.
    pub nodes: Vec<u32>,
    /// Normal of the plane, a nonzero vector of any length.
    pub normal: Vec3,
    /// Parity of the motion about the plane.
    pub parity: Parity,
}

impl Mirror {
    /// Supports of the nodes on the plane.
    pub fn supports(&self) -> Vec<Support> {
        let directions = match self.parity {
            Parity::Symmetric => vec![self.normal],
            Parity::Antisymmetric => {
                // The coordinate axis farthest from the normal, projected into the plane, and the third direction.
                let axis = Vec3::ith(self.normal.iamin(), 1.0);
                let across = self.normal.cross(&axis);
                vec![across, self.normal.cross(&across)]
            }
        };
        let roller = |direction| Support::roller(self.nodes.clone(), direction);
        directions.into_iter().map(roller).collect()
    }
}

/// Why a symmetry plane is refused.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum MirrorError {
    /// Symmetry plane without nodes or normal.
    #[error("a plane of symmetry needs nodes and a normal")]
    Nothing,
    /// Node of the symmetry plane that is not on the plane through its first node.
    #[error("node {node} lies {distance:.3e} m off the plane of symmetry")]
    OffPlane {
        /// Number of the node in the mesh file.
        node: u64,
        /// Distance of the node from the plane (m).
        distance: f64,
    },
    /// Body with nodes on both sides of the plane.
    #[error("the body is on both sides of the plane of symmetry: node {node} lies beyond it")]
    BothSides {
        /// Number of a node on the smaller side in the mesh file.
        node: u64,
    },
    /// Absorbing face with a facet in the plane.
    #[error("the absorbing face '{face}' lies in the plane of symmetry")]
    Absorbs {
        /// Facet set of the face.
        face: String,
    },
    /// Waves or gravity of the scene with another parity than the plane; those of stages are not checked.
    #[error(
        "{what} is not {parity} about this plane: it differs from its image by {deviation:.3} of its peak"
    )]
    Parity {
        /// Name of the field, or `a weight`.
        what: String,
        /// Parity of the plane.
        parity: &'static str,
        /// Largest difference of displacement (of a weight: of acceleration) from the mirror image over the peak (1).
        deviation: f64,
    },
    /// Plane of antisymmetry in a model with a part that is not linear elastic, a joint of any law, or an in-situ stress.
    #[error(
        "{what} is not elastic: opposite motions do not give opposite forces, as antisymmetry requires"
    )]
    Nonlinear {
        /// Subject of the message: the first such part or joint with its name, or the body with an initial stress.
        what: String,
    },
}

/// Tolerance of the distance of nodes from the plane, over the diagonal of the mesh.
const TOLERANCE: f64 = 1e-6;
/// Tolerance of the difference of a field from its mirror image, over its peak: the accuracy of the displacement tables
/// of waves past the critical angle.
const PARITY_TOLERANCE: f64 = 1e-5;
/// Numbers of points and instants at which a field is evaluated.
const POINTS: usize = 64;
const INSTANTS: usize = 400;

fn reflected(normal: &Vec3, vector: &Vec3) -> Vec3 {
    vector - normal * (2.0 * vector.dot(normal))
}

impl Scene {
    /// Checks that body and waves have the parity of every symmetry plane.
    ///
    /// # Errors
    /// Error of the first invalid plane, with its position in the scene file.
    pub(super) fn check_mirrors(&self) -> Result<(), Error> {
        for (index, mirror) in self.mirrors.iter().enumerate() {
            let checked = self.check_mirror(mirror);
            checked.map_err(|error| self.placed(Subject::Mirror(index), error))?;
        }
        Ok(())
    }

    fn check_mirror(&self, mirror: &Mirror) -> Result<(), Error> {
        let normal = mirror.normal.try_normalize(0.0);
        let (Some(normal), Some(&first)) = (normal, mirror.nodes.first()) else {
            return Err(MirrorError::Nothing.into());
        };
        let positions = self.mesh.positions();
        if mirror
            .nodes
            .iter()
            .any(|&node| node as usize >= positions.len())
        {
            // Supports on nodes that do not exist are rejected when the model is built.
            return Ok(());
        }
        let origin = positions[first as usize];
        let (low, high) = self.mesh.bounding_box();
        let tolerance = TOLERANCE * (high - low).norm();
        let height = |node: u32| (positions[node as usize] - origin).dot(&normal);
        let tag = |node: u32| self.mesh.node_tags()[node as usize];
        if let Some(&node) = mirror.nodes.iter().find(|&&n| height(n).abs() > tolerance) {
            let (node, distance) = (tag(node), height(node).abs());
            return Err(MirrorError::OffPlane { node, distance }.into());
        }
        let all = || 0..positions.len() as u32;
        let above: Vec<u32> = all().filter(|&node| height(node) > tolerance).collect();
        let below: Vec<u32> = all().filter(|&node| height(node) < -tolerance).collect();
        let smaller = if above.len() < below.len() {
            above
        } else {
            below
        };
        if let Some(&node) = smaller.first() {
            return Err(MirrorError::BothSides { node: tag(node) }.into());
        }
        let in_plane = |facet: &Facet| {
            let nodes = self.mesh.facet_nodes(*facet);
            nodes.iter().all(|&node| height(node).abs() <= tolerance)
        };
        for (face, facets) in self.absorbing_facets()? {
            if facets.iter().any(in_plane) {
                return Err(MirrorError::Absorbs { face: face.into() }.into());
            }
        }
        if mirror.parity == Parity::Antisymmetric {
            self.check_linear()?;
        }
        for (weight, _) in &self.weights {
            let deviation = (weight - mirror.parity.image(&normal, weight)).norm() / weight.norm();
            if deviation > TOLERANCE {
                return Err(MirrorError::Parity {
                    what: "a weight".into(),
                    parity: mirror.parity.name(),
                    deviation,
                }
                .into());
            }
        }
        match self.field() {
            Some(field) => self.check_parity(field.as_ref(), mirror.parity, (&origin, &normal)),
            None => Ok(()),
        }
    }

    /// Checks that parts, joints and initial stress are linear elastic.
    fn check_linear(&self) -> Result<(), Error> {
        let parts = self.parts.iter().filter(|part| !part.material.is_linear());
        let parts = parts.map(|part| format!("part '{}'", part.set));
        let joints = self.joints.iter();
        let joints = joints.map(|joint| format!("joint '{}'", joint.name));
        let stress = self.in_situ_stress.iter();
        let stress = stress.map(|_| "a body with an initial stress".to_owned());
        match parts.chain(joints).chain(stress).next() {
            Some(what) => Err(MirrorError::Nonlinear { what }.into()),
            None => Ok(()),
        }
    }

    /// Compares a field with its image.
    fn check_parity(
        &self,
        field: &dyn IncidentField,
        parity: Parity,
        (origin, normal): (&Vec3, &Vec3),
    ) -> Result<(), Error> {
        let heights = CheckHeights::of(self)?;
        let points = self.mesh.positions().to_vec();
        let points = heights.sample(points, POINTS, |point| point.z);
        let images: Vec<Vec3> = (points.iter())
            .map(|point| origin + reflected(normal, &(point - origin)))
            .collect();
        let here = field.prepare(&points)?;
        let there = field.prepare(&images)?;
        let (mut peak, mut worst) = (0.0_f64, 0.0_f64);
        for instant in 0..=INSTANTS {
            let time = self.start + self.duration * instant as f64 / INSTANTS as f64;
            let (here, there) = (moved(here.as_ref(), time), moved(there.as_ref(), time));
            for (here, there) in here.iter().zip(&there) {
                let difference = (here - parity.image(normal, there)).norm();
                peak = peak.max(here.norm());
                // A value that is not a number counts as the largest difference.
                worst = if difference <= worst {
                    worst
                } else {
                    difference
                };
            }
        }
        if worst <= PARITY_TOLERANCE * peak {
            return Ok(());
        }
        Err(MirrorError::Parity {
            what: format!("the field '{}'", field.name()),
            parity: parity.name(),
            deviation: worst / peak,
        }
        .into())
    }
}

/// Displacements of a field at points and instants (m).
fn moved(sampler: &dyn FieldSampler, time: f64) -> Vec<Vec3> {
    let mut motion = vec![FieldMotion::default(); sampler.len()];
    sampler.add_motion(time, &mut motion);
    motion.iter().map(|motion| motion.displacement).collect()
}
