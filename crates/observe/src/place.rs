//! Locations of observed quantities in the mesh.

use powerhouse_model::{Located, Mesh, ParameterError, Vec3};

use super::ObserveError;

/// Selection of the kinds of motion to be recorded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Motion {
    /// Whether the displacement (m) is recorded: components `ux`, `uy`, `uz`.
    pub displacement: bool,
    /// Whether the velocity (m/s) is recorded: components `vx`, `vy`, `vz`.
    pub velocity: bool,
    /// Whether acceleration (m/s2) is recorded.
    pub acceleration: bool,
}

impl Motion {
    /// Displacement, velocity and acceleration.
    pub const ALL: Self = Self {
        displacement: true,
        velocity: true,
        acceleration: true,
    };
    /// Displacement without velocity and acceleration.
    pub const DISPLACEMENT: Self = Self {
        displacement: true,
        velocity: false,
        acceleration: false,
    };
    /// Velocity without displacement and acceleration.
    pub const VELOCITY: Self = Self {
        displacement: false,
        velocity: true,
        acceleration: false,
    };
    /// Acceleration without displacement and velocity.
    pub const ACCELERATION: Self = Self {
        displacement: false,
        velocity: false,
        acceleration: true,
    };
}

/// Rule by which accelerations at the rows of a table follow from the motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AccelerationRule {
    /// The mean over the interval around the row, which is the change of the velocity over its length: the default.
    ///
    /// What happens between two rows is not lost, and the sum of the rows is the velocity.
    #[default]
    Mean,
    /// The acceleration of the steps around the row. Where cracks close or bodies hit each other it jumps from step to step, and
    /// rows far apart are an aliased motion, whose spectra may be wrong by an order of magnitude.
    Instant,
}

/// An observation point, given by coordinates; its values are interpolated in the element around it.
#[derive(Clone, Debug, PartialEq)]
pub struct ObservationPoint {
    /// Position in the undeformed mesh (m).
    pub position: Vec3,
    /// Name of the element set that contains the point; none for all solid elements. On a joint the set determines the
    /// side.
    pub elements: Option<String>,
    /// Largest permitted distance of the point from the elements (m).
    pub tolerance: f64,
}

impl ObservationPoint {
    /// A point in any solid element, with a tolerance of a millimetre.
    pub fn at(position: Vec3) -> Self {
        Self {
            position,
            elements: None,
            tolerance: 1e-3,
        }
    }
    /// Restricts the elements in which the point is sought to those of an element set, by name.
    #[must_use]
    pub fn among(mut self, elements: &str) -> Self {
        self.elements = Some(elements.into());
        self
    }
    /// Sets the largest distance of the point from an element (m), such as that of a round wall from its chord.
    #[must_use]
    pub fn within(mut self, tolerance: f64) -> Self {
        self.tolerance = tolerance;
        self
    }
}

/// Location at which motion is recorded.
#[derive(Clone, Debug, PartialEq)]
pub enum Place {
    /// A point; the motion is interpolated in the element around it.
    Point(ObservationPoint),
    /// A node, by the user's number.
    Node(u64),
    /// The mean over the active nodes of the node set of this name; of the facet set if there is no such node
    /// set, or of the element set if there is neither.
    NodeSet(String),
}

impl Place {
    /// Mesh indices of the nodes of a location without coordinates; none for a point, and for a node or set that the mesh lacks.
    pub fn nodes(&self, mesh: &Mesh) -> Vec<u32> {
        match self {
            Self::Point(_) => Vec::new(),
            Self::Node(tag) => index_of(mesh.node_tags(), *tag).into_iter().collect(),
            Self::NodeSet(name) => mesh.nodes_of_set(name).unwrap_or_default(),
        }
    }

    /// The points (m) whose mean motion is that of the location; none for a node or set that the mesh lacks.
    pub fn points(&self, mesh: &Mesh) -> Vec<Vec3> {
        match self {
            Self::Point(spot) => vec![spot.position],
            Self::Node(_) | Self::NodeSet(_) => {
                let nodes = self.nodes(mesh).into_iter();
                nodes.map(|node| mesh.positions()[node as usize]).collect()
            }
        }
    }
}

impl From<Vec3> for Place {
    fn from(position: Vec3) -> Self {
        Self::Point(ObservationPoint::at(position))
    }
}

impl From<Vec3> for ObservationPoint {
    fn from(position: Vec3) -> Self {
        Self::at(position)
    }
}

impl From<ObservationPoint> for Place {
    fn from(point: ObservationPoint) -> Self {
        Self::Point(point)
    }
}

/// Element of which stress or history variables are recorded.
#[derive(Clone, Debug, PartialEq)]
pub enum StressPlace {
    /// The element around a point.
    Point(ObservationPoint),
    /// An element, by the user's number.
    Element(u64),
}

impl From<Vec3> for StressPlace {
    fn from(position: Vec3) -> Self {
        Self::Point(ObservationPoint::at(position))
    }
}

/// Interpolation of a nodal field at a location: nodes and weights.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Probe(Vec<(u32, f64)>);

impl Probe {
    pub(super) fn value(&self, field: impl Fn(u32) -> Vec3) -> Vec3 {
        let terms = self.0.iter();
        terms.map(|&(node, weight)| field(node) * weight).sum()
    }
    /// Mesh indices of the nodes.
    pub(super) fn nodes(&self) -> impl Iterator<Item = u32> + '_ {
        self.0.iter().map(|&(node, _)| node)
    }
}

impl From<Located> for Probe {
    fn from(located: Located) -> Self {
        Self(located.nodes.into_iter().zip(located.weights).collect())
    }
}

/// Active elements of a mesh, one flag per element; all if no flags are given.
#[derive(Clone, Copy)]
pub(super) struct ActiveElements<'p>(pub(super) Option<&'p [bool]>);

impl ActiveElements<'_> {
    fn contains(self, element: u32) -> bool {
        let flag = |flags: &[bool]| flags.get(element as usize).copied().unwrap_or(true);
        self.0.is_none_or(flag)
    }
    /// The active ones of some elements.
    fn of(self, elements: impl IntoIterator<Item = u32>) -> Vec<u32> {
        (elements.into_iter())
            .filter(|element| self.contains(*element))
            .collect()
    }
    /// The nodes of active elements, one flag per node of the mesh; none if all elements are active.
    fn nodes(self, mesh: &Mesh) -> Option<Vec<bool>> {
        self.0?;
        let mut active = vec![false; mesh.node_count()];
        for element in self.of(0..mesh.element_count() as u32) {
            for &node in mesh.nodes_of(element) {
                active[node as usize] = true;
            }
        }
        Some(active)
    }
}

/// Locates named points in the mesh, in their order; one pass over the elements for each set and tolerance.
fn locate(
    mesh: &Mesh,
    named: &[(&str, &ObservationPoint)],
    active: ActiveElements,
) -> Result<Vec<Located>, ObserveError> {
    let wanted: Vec<&ObservationPoint> = named.iter().map(|(_, point)| *point).collect();
    let mut located: Vec<Option<Located>> = vec![None; wanted.len()];
    for first in 0..wanted.len() {
        if located[first].is_some() {
            continue;
        }
        let ObservationPoint {
            elements,
            tolerance,
            ..
        } = wanted[first];
        ParameterError::check("tolerance", *tolerance, 0.0, f64::MAX)?;
        let alike =
            |&i: &usize| wanted[i].elements == *elements && wanted[i].tolerance == *tolerance;
        let together: Vec<usize> = (first..wanted.len()).filter(alike).collect();
        let points: Vec<Vec3> = together.iter().map(|&i| wanted[i].position).collect();
        let all: Vec<u32> = match elements {
            Some(set) => mesh.element_set(set)?.to_vec(),
            None => (0..mesh.element_count() as u32).collect(),
        };
        let chosen = active.of(all.iter().copied());
        let found = match mesh.locate_among(&chosen, &points, *tolerance) {
            Ok(found) => found,
            Err(outside) => {
                // Outside of the mesh, or of its active elements.
                let is_inactive = |&i: &&usize| {
                    let point = [wanted[*i].position];
                    mesh.locate_among(&chosen, &point, *tolerance).is_err()
                        && mesh.locate_among(&all, &point, *tolerance).is_ok()
                };
                return Err(match together.iter().find(is_inactive) {
                    Some(&i) => inactive(named[i].0, &wanted[i].position),
                    None => outside.into(),
                });
            }
        };
        for (i, found) in together.into_iter().zip(found) {
            located[i] = Some(found);
        }
    }
    Ok(located.into_iter().flatten().collect())
}

/// The error of a point in inactive elements.
fn inactive(name: &str, position: &Vec3) -> ObserveError {
    let [x, y, z] = [position.x, position.y, position.z];
    ObserveError::InactiveLocation {
        name: name.into(),
        place: format!("the point ({x}, {y}, {z}) m"),
    }
}

/// The probes of named locations, in their order.
pub(super) fn probes(
    mesh: &Mesh,
    places: &[(String, Place)],
    active: ActiveElements,
) -> Result<Vec<Probe>, ObserveError> {
    let points: Vec<(&str, &ObservationPoint)> = places
        .iter()
        .filter_map(|(name, place)| match place {
            Place::Point(point) => Some((name.as_str(), point)),
            _ => None,
        })
        .collect();
    let mut located = locate(mesh, &points, active)?.into_iter();
    let active_nodes = active.nodes(mesh);
    let is_active = |node: u32| (active_nodes.as_ref()).is_none_or(|flags| flags[node as usize]);
    let mut probes = Vec::with_capacity(places.len());
    for (name, place) in places {
        match place {
            Place::Point(_) => probes.extend(located.next().map(Probe::from)),
            Place::Node(tag) => {
                let node = index_of(mesh.node_tags(), *tag);
                let node = node.ok_or_else(|| ObserveError::NoSuchNode {
                    name: name.clone(),
                    node: *tag,
                })?;
                if !is_active(node) {
                    return Err(ObserveError::InactiveLocation {
                        name: name.clone(),
                        place: format!("node {tag}"),
                    });
                }
                probes.push(Probe(vec![(node, 1.0)]));
            }
            Place::NodeSet(set) => {
                let all = mesh.nodes_of_set(set)?;
                let nodes: Vec<u32> = all.iter().copied().filter(|n| is_active(*n)).collect();
                if nodes.is_empty() && !all.is_empty() {
                    return Err(ObserveError::InactiveLocation {
                        name: name.clone(),
                        place: format!("the mean of the set '{set}'"),
                    });
                }
                if nodes.is_empty() {
                    return Err(ObserveError::EmptySet {
                        name: name.clone(),
                        set: set.clone(),
                    });
                }
                let share = 1.0 / nodes.len() as f64;
                probes.push(Probe(nodes.iter().map(|&node| (node, share)).collect()));
            }
        }
    }
    Ok(probes)
}

/// The elements of named locations, in their order, with natural coordinates: those of points, or of the centre.
pub(super) fn elements(
    mesh: &Mesh,
    places: &[(String, StressPlace)],
    active: ActiveElements,
) -> Result<Vec<(u32, Vec3)>, ObserveError> {
    let points: Vec<(&str, &ObservationPoint)> = places
        .iter()
        .filter_map(|(name, place)| match place {
            StressPlace::Point(point) => Some((name.as_str(), point)),
            StressPlace::Element(_) => None,
        })
        .collect();
    let mut located = locate(mesh, &points, active)?.into_iter();
    let mut elements = Vec::with_capacity(places.len());
    for (name, place) in places {
        match place {
            StressPlace::Point(_) => {
                elements.extend(located.next().map(|found| (found.element, found.natural)));
            }
            StressPlace::Element(tag) => {
                let element = index_of(mesh.element_tags(), *tag);
                let element = element.ok_or_else(|| ObserveError::NoSuchElement {
                    name: name.clone(),
                    element: *tag,
                })?;
                if !active.contains(element) {
                    return Err(ObserveError::InactiveLocation {
                        name: name.clone(),
                        place: format!("element {tag}"),
                    });
                }
                elements.push((element, mesh.kind(element).natural_centre()));
            }
        }
    }
    Ok(elements)
}

fn index_of(tags: &[u64], tag: u64) -> Option<u32> {
    tags.iter()
        .position(|&t| t == tag)
        .map(|index| index as u32)
}
