//! Where something is observed.

use powerhouse_model::{Located, Mesh, ParameterError, Vec3};

use super::ObserveError;

/// Which motions are wanted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Motion {
    /// Displacement (m).
    pub displacement: bool,
    /// Velocity (m/s).
    pub velocity: bool,
    /// Acceleration (m/s2).
    pub acceleration: bool,
}

impl Motion {
    /// All three.
    pub const ALL: Self = Self {
        displacement: true,
        velocity: true,
        acceleration: true,
    };
    /// Displacement alone.
    pub const DISPLACEMENT: Self = Self {
        displacement: true,
        velocity: false,
        acceleration: false,
    };
    /// Velocity alone.
    pub const VELOCITY: Self = Self {
        displacement: false,
        velocity: true,
        acceleration: false,
    };
    /// Acceleration alone.
    pub const ACCELERATION: Self = Self {
        displacement: false,
        velocity: false,
        acceleration: true,
    };
}

/// A point of a body, given by coordinate.
#[derive(Clone, Debug, PartialEq)]
pub struct Spot {
    /// Position (m).
    pub position: Vec3,
    /// The element set in which it lies; all solid elements if none. On a joint it decides the
    /// side.
    pub elements: Option<String>,
    /// How far it may be moved to lie in an element (m).
    pub tolerance: f64,
}

impl Spot {
    /// A spot in any solid element, moved by at most a millimetre.
    pub fn at(position: Vec3) -> Self {
        Self {
            position,
            elements: None,
            tolerance: 1e-3,
        }
    }
    /// The same spot in an element set.
    #[must_use]
    pub fn among(mut self, elements: &str) -> Self {
        self.elements = Some(elements.into());
        self
    }
    /// The same spot, moved by at most `tolerance` (m), such as onto the chord of a round wall.
    #[must_use]
    pub fn within(mut self, tolerance: f64) -> Self {
        self.tolerance = tolerance;
        self
    }
}

/// Where motion is observed.
#[derive(Clone, Debug, PartialEq)]
pub enum Place {
    /// A coordinate; the motion is interpolated in the element around it.
    Spot(Spot),
    /// A node, by the user's number.
    Node(u64),
    /// The mean over the nodes of a node set; of a facet set if there is no such node set, or of an
    /// element set if there is neither.
    NodeSet(String),
}

impl From<Vec3> for Place {
    fn from(position: Vec3) -> Self {
        Self::Spot(Spot::at(position))
    }
}

impl From<Spot> for Place {
    fn from(spot: Spot) -> Self {
        Self::Spot(spot)
    }
}

/// Where stress is observed.
#[derive(Clone, Debug, PartialEq)]
pub enum StressPlace {
    /// The element around a coordinate.
    Spot(Spot),
    /// An element, by the user's number.
    Element(u64),
}

impl From<Vec3> for StressPlace {
    fn from(position: Vec3) -> Self {
        Self::Spot(Spot::at(position))
    }
}

/// Nodes and weights whose sum is the value at a place.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Probe(Vec<(u32, f64)>);

impl Probe {
    pub(super) fn value(&self, field: impl Fn(u32) -> Vec3) -> Vec3 {
        let terms = self.0.iter();
        terms.map(|&(node, weight)| field(node) * weight).sum()
    }
}

impl From<Located> for Probe {
    fn from(located: Located) -> Self {
        Self(located.nodes.into_iter().zip(located.weights).collect())
    }
}

/// Where spots lie, in their order; one pass over the elements for each set and tolerance.
fn locate(mesh: &Mesh, spots: &[&Spot]) -> Result<Vec<Located>, ObserveError> {
    let mut located: Vec<Option<Located>> = vec![None; spots.len()];
    for first in 0..spots.len() {
        if located[first].is_some() {
            continue;
        }
        let Spot {
            elements,
            tolerance,
            ..
        } = spots[first];
        ParameterError::check("tolerance", *tolerance, 0.0, f64::MAX)?;
        let alike = |&i: &usize| spots[i].elements == *elements && spots[i].tolerance == *tolerance;
        let together: Vec<usize> = (first..spots.len()).filter(alike).collect();
        let points: Vec<Vec3> = together.iter().map(|&i| spots[i].position).collect();
        let found = match elements {
            Some(set) => mesh.locate_among(mesh.element_set(set)?, &points, *tolerance)?,
            None => {
                let all: Vec<u32> = (0..mesh.element_count() as u32).collect();
                mesh.locate_among(&all, &points, *tolerance)?
            }
        };
        for (i, found) in together.into_iter().zip(found) {
            located[i] = Some(found);
        }
    }
    Ok(located.into_iter().flatten().collect())
}

/// The probes of named places, in their order.
pub(super) fn probes(mesh: &Mesh, places: &[(String, Place)]) -> Result<Vec<Probe>, ObserveError> {
    let spots: Vec<&Spot> = places
        .iter()
        .filter_map(|(_, place)| match place {
            Place::Spot(spot) => Some(spot),
            _ => None,
        })
        .collect();
    let mut located = locate(mesh, &spots)?.into_iter();
    let mut probes = Vec::with_capacity(places.len());
    for (name, place) in places {
        match place {
            Place::Spot(_) => probes.extend(located.next().map(Probe::from)),
            Place::Node(tag) => {
                let node = index_of(mesh.node_tags(), *tag);
                let node = node.ok_or_else(|| ObserveError::NoSuchNode {
                    name: name.clone(),
                    node: *tag,
                })?;
                probes.push(Probe(vec![(node, 1.0)]));
            }
            Place::NodeSet(set) => {
                let nodes = mesh.nodes_of_set(set)?;
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

/// The elements of named places, in their order.
pub(super) fn elements(
    mesh: &Mesh,
    places: &[(String, StressPlace)],
) -> Result<Vec<u32>, ObserveError> {
    let spots: Vec<&Spot> = places
        .iter()
        .filter_map(|(_, place)| match place {
            StressPlace::Spot(spot) => Some(spot),
            StressPlace::Element(_) => None,
        })
        .collect();
    let mut located = locate(mesh, &spots)?.into_iter();
    let mut elements = Vec::with_capacity(places.len());
    for (name, place) in places {
        match place {
            StressPlace::Spot(_) => elements.extend(located.next().map(|found| found.element)),
            StressPlace::Element(tag) => {
                let element = index_of(mesh.element_tags(), *tag);
                elements.push(element.ok_or_else(|| ObserveError::NoSuchElement {
                    name: name.clone(),
                    element: *tag,
                })?);
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
