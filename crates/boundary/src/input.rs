//! Equivalent nodal forces: the free field enters through an absorbing boundary.

use std::collections::{BTreeMap, BTreeSet};

#[cfg(feature = "keys")]
use powerhouse_model::keys::*;
use powerhouse_model::{
    BoundarySite, ElasticMedium, FieldMotion, IncidentField, Mat3, ModelError, NodalLoad, SiteFace,
    SiteNode, Vec3,
};

use crate::BoundaryError;
use crate::coefficients::{FaceCoefficients, ShareCoefficients, share_impedance};
use crate::field_load::{FieldForces, field_load};

/// Part of the free field that enters through an absorbing boundary.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "keys", derive(Deserialize, JsonSchema))]
#[cfg_attr(feature = "keys", serde(rename_all = "kebab-case"))]
pub enum InputMode {
    /// The full free field, incident and reflected waves, on every face.
    #[default]
    FullField,
    /// The incident wave alone on the named faces, as on the bottom in Wang, Chen & Xiao (2019),
    /// Eqs. 6 and 7; the full free field on the others.
    #[cfg_attr(feature = "keys", serde(deserialize_with = "Deserialize::deserialize"))]
    #[cfg_attr(feature = "keys", schemars(with = "Vec<String>"))]
    IncidentOnly {
        /// Names of the faces with the incident wave alone.
        faces: Vec<String>,
    },
    /// No input: the boundary only absorbs.
    Nothing,
}

/// Number of nodes per load: large enough that a virtual call costs nothing, small enough
/// that its motion stays in the first cache level and that threads share the work evenly.
const NODES_PER_LOAD: usize = 256;

/// Input loads of a site; none if it has no field.
pub(crate) fn input_loads(
    site: &BoundarySite,
    coefficients: &ShareCoefficients,
    mode: &InputMode,
) -> Result<Vec<Box<dyn NodalLoad>>, ModelError> {
    let Some(field) = site.field else {
        return Ok(Vec::new());
    };
    if !field.carries_stress() && *mode != InputMode::Nothing {
        let field = field.name().into();
        return Err(BoundaryError::NoStress { field }.into());
    }
    match mode {
        InputMode::Nothing => Ok(Vec::new()),
        InputMode::FullField => field_loads(site, coefficients, field, |_| true),
        InputMode::IncidentOnly { faces } => {
            let chosen = face_indices(site, faces)?;
            let incident = field
                .incident_part()
                .ok_or_else(|| BoundaryError::NoIncidentPart {
                    field: field.name().into(),
                })?;
            let is_chosen = |share: &SiteFace| chosen.contains(&share.face);
            let mut loads = field_loads(site, coefficients, field, |share| !is_chosen(share))?;
            loads.extend(field_loads(site, coefficients, &*incident, is_chosen)?);
            Ok(loads)
        }
    }
}

fn face_indices(site: &BoundarySite, names: &[String]) -> Result<Vec<usize>, BoundaryError> {
    let index = |name: &String| {
        let found = site.faces.iter().position(|face| face == name);
        found.ok_or_else(|| BoundaryError::NoSuchFace {
            name: name.clone(),
            available: site.faces.clone(),
        })
    };
    names.iter().map(index).collect()
}

/// Forces of one field on those shares of faces that `includes` selects.
fn field_loads(
    site: &BoundarySite,
    coefficients: &ShareCoefficients,
    field: &dyn IncidentField,
    includes: impl Fn(&SiteFace) -> bool,
) -> Result<Vec<Box<dyn NodalLoad>>, ModelError> {
    let (mut diagonal, mut full) = (Inputs::default(), Inputs::default());
    for (node, coefficients) in site.nodes.iter().zip(coefficients) {
        let shares = node.faces.iter().zip(coefficients);
        let mut left: Vec<_> = shares.filter(|(share, _)| includes(share)).collect();
        let mut is_first = true;
        while let Some((share, _)) = left.first() {
            // The stress of the field is that in the medium of the share.
            let medium = share.medium;
            let (of_medium, others): (Vec<_>, Vec<_>) = left
                .into_iter()
                .partition(|(share, _)| share.medium == medium);
            left = others;
            let matrices = MatrixForce::of_shares(&of_medium);
            let place = (node.node, node.position, medium);
            match matrices.diagonal() {
                Some(force) => diagonal.of(is_first).push((place, force)),
                None => full.of(is_first).push((place, matrices)),
            }
            is_first = false;
        }
    }
    if site.slowness != 0.0 {
        // The nodes of a pair have the motion in the middle of the slice.
        let along = site.nodes.iter().map(|node| node.position.y);
        let (low, high) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), y| {
            (low.min(y), high.max(y))
        });
        let middle = 0.5 * (low + high);
        diagonal.join(middle, high - low);
        full.join(middle, high - low);
    }
    let mut loads = Vec::new();
    diagonal.push_loads(field, &mut loads)?;
    full.push_loads(field, &mut loads)?;
    Ok(loads)
}

/// Distance across y of the nodes of a pair, over the thickness of the slice: rounding of mesh files.
const PAIRED: f64 = 1e-4;

/// Mesh index and position of a node, with the medium of some of its shares.
type Place = (u32, Vec3, ElasticMedium);

/// Forces of nodes: those of the first medium of each node, and those of others.
struct Inputs<F> {
    first: Vec<(Place, F)>,
    others: Vec<(Place, F)>,
}

impl<F> Default for Inputs<F> {
    fn default() -> Self {
        Self {
            first: Vec::new(),
            others: Vec::new(),
        }
    }
}

impl<F: NodeForce> Inputs<F> {
    fn of(&mut self, is_first: bool) -> &mut Vec<(Place, F)> {
        if is_first {
            &mut self.first
        } else {
            &mut self.others
        }
    }

    /// Evaluates the field at another y (m) for all nodes, once for the two nodes of a pair in a slice of a thickness (m): the
    /// first one takes the force of both.
    fn join(&mut self, y: f64, thickness: f64) {
        for nodes in [&mut self.first, &mut self.others] {
            let mut cells: BTreeMap<[i64; 2], Vec<usize>> = BTreeMap::new();
            for (index, ((_, position, _), _)) in nodes.iter().enumerate() {
                let cell = [position.x, position.z].map(|x| (x / (PAIRED * thickness)).floor());
                let own = cells.entry(cell.map(|x| x as i64)).or_default();
                own.push(index);
            }
            let mut is_joined = vec![false; nodes.len()];
            for own in cells.values() {
                // A pair on the limit of two cells keeps two loads, as nodes in one place do.
                let &[a, b] = &own[..] else {
                    continue;
                };
                let [(_, at_a, of_a), (_, at_b, of_b)] = [nodes[a].0, nodes[b].0];
                if of_a == of_b && (at_a.y - at_b.y).abs() > 0.5 * thickness {
                    is_joined[b] = true;
                    let of_other = nodes[b].1;
                    nodes[a].1.add(&of_other);
                }
            }
            let mut index = 0;
            nodes.retain_mut(|((_, position, _), _)| {
                position.y = y;
                index += 1;
                !is_joined[index - 1]
            });
        }
    }

    /// Adds loads, in each of which a node is at most once.
    fn push_loads(
        self,
        field: &dyn IncidentField,
        loads: &mut Vec<Box<dyn NodalLoad>>,
    ) -> Result<(), ModelError> {
        push_loads(&self.first, field, loads)?;
        let mut others = self.others;
        while !others.is_empty() {
            let mut known = BTreeSet::new();
            let (now, later): (Vec<_>, Vec<_>) = others
                .into_iter()
                .partition(|((node, ..), _)| known.insert(*node));
            push_loads(&now, field, loads)?;
            others = later;
        }
        Ok(())
    }
}

fn push_loads<F: NodeForce>(
    nodes: &[(Place, F)],
    field: &dyn IncidentField,
    loads: &mut Vec<Box<dyn NodalLoad>>,
) -> Result<(), ModelError> {
    for chunk in nodes.chunks(NODES_PER_LOAD) {
        let points: Vec<Vec3> = chunk.iter().map(|((_, x, _), _)| *x).collect();
        let media: Vec<ElasticMedium> = chunk.iter().map(|((.., m), _)| *m).collect();
        let nodes = chunk.iter().map(|((node, ..), _)| *node).collect();
        let forces: Vec<F> = chunk.iter().map(|(_, force)| *force).collect();
        let sampler = field.prepare_in(&points, &media)?;
        loads.push(field_load(field.name(), nodes, sampler, forces));
    }
    Ok(())
}

/// Equivalent force of a motion on one node: `K u + C v + sigma a`, with the vector area `a`.
trait NodeForce: Copy + Send + 'static {
    fn force(&self, motion: &FieldMotion) -> Vec3;
    /// Adds the coefficients of another node.
    fn add(&mut self, other: &Self);
}

/// Coefficients of a node with diagonal matrices: all its faces lie along the axes.
#[derive(Clone, Copy, Debug)]
struct DiagonalForce {
    spring: Vec3,
    dashpot: Vec3,
    vector_area: Vec3,
}

impl NodeForce for DiagonalForce {
    #[inline(always)]
    fn force(&self, motion: &FieldMotion) -> Vec3 {
        self.spring.component_mul(&motion.displacement)
            + self.dashpot.component_mul(&motion.velocity)
            + motion.stress.traction(&self.vector_area)
    }
    fn add(&mut self, other: &Self) {
        self.spring += other.spring;
        self.dashpot += other.dashpot;
        self.vector_area += other.vector_area;
    }
}

/// Coefficients of any node, with full matrices.
#[derive(Clone, Copy, Debug)]
struct MatrixForce {
    spring: Mat3,
    dashpot: Mat3,
    vector_area: Vec3,
}

impl MatrixForce {
    fn of_shares(shares: &[(&SiteFace, &FaceCoefficients)]) -> Self {
        let mut sum = Self {
            spring: Mat3::zeros(),
            dashpot: Mat3::zeros(),
            vector_area: Vec3::zeros(),
        };
        for (share, coefficients) in shares {
            let [spring, dashpot, gyroscopic] = share_impedance(share, coefficients);
            sum.spring += spring;
            sum.dashpot += dashpot + gyroscopic;
            sum.vector_area += share.area * share.normal;
        }
        sum
    }

    fn diagonal(&self) -> Option<DiagonalForce> {
        let is_diagonal = |m: &Mat3| *m == Mat3::from_diagonal(&m.diagonal());
        (is_diagonal(&self.spring) && is_diagonal(&self.dashpot)).then(|| DiagonalForce {
            spring: self.spring.diagonal(),
            dashpot: self.dashpot.diagonal(),
            vector_area: self.vector_area,
        })
    }
}

impl NodeForce for MatrixForce {
    #[inline(always)]
    fn force(&self, motion: &FieldMotion) -> Vec3 {
        self.spring * motion.displacement
            + self.dashpot * motion.velocity
            + motion.stress.traction(&self.vector_area)
    }
    fn add(&mut self, other: &Self) {
        self.spring += other.spring;
        self.dashpot += other.dashpot;
        self.vector_area += other.vector_area;
    }
}

impl<F: NodeForce> FieldForces for Vec<F> {
    fn add(&self, motion: &[FieldMotion], forces: &mut [Vec3]) {
        for ((force, motion), node) in forces.iter_mut().zip(motion).zip(self) {
            *force += node.force(motion);
        }
    }
}

/// Boundary nodes (mesh indices) in a medium other than the field's, where the free field is not the
/// motion of the site and a check of the model should warn of it; none if the site has no field.
///
/// Media count as equal if both wave impedances agree to 1e-6. Of a field in layers the medium counts that is
/// at the node, on an interface that on either side.
pub fn nodes_in_other_media(site: &BoundarySite) -> Vec<u32> {
    let Some(field) = site.field else {
        return Vec::new();
    };
    let differs = |share: &SiteFace, of_field: &ElasticMedium| {
        let here = FaceCoefficients::viscous(&share.medium);
        let of_field = FaceCoefficients::viscous(of_field);
        let apart = |a: f64, b: f64| (a - b).abs() > 1.0e-6 * b;
        apart(here.normal_dashpot, of_field.normal_dashpot)
            || apart(here.tangential_dashpot, of_field.tangential_dashpot)
    };
    let is_foreign = |node: &&SiteNode| {
        let position = node.position;
        let near = Vec3::z() * (NEAR_INTERFACE * position.z.abs().max(1.0));
        let media = match field.interfaces() {
            [] => [field.medium(); 2],
            _ => [position + near, position - near].map(|point| field.medium_at(&point)),
        };
        let mut shares = node.faces.iter();
        shares.any(|share| media.iter().all(|medium| differs(share, medium)))
    };
    let nodes = site.nodes.iter().filter(is_foreign);
    nodes.map(|node| node.node).collect()
}

/// Distance from an interface, over the height, within which a node lies on it: rounding of mesh files.
const NEAR_INTERFACE: f64 = 1e-6;
