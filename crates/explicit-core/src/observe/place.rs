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
    /// The mean over the nodes of a node set that are there; of a facet set if there is no such node
    /// set, or of an element set if there is neither.
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

/// Which elements of a mesh there are; all if no flags are given.
#[derive(Clone, Copy)]
pub(super) struct Presence<'p>(pub(super) Option<&'p [bool]>);

impl Presence<'_> {
    fn has(self, element: u32) -> bool {
        let flag = |flags: &[bool]| flags.get(element as usize).copied().unwrap_or(true);
        self.0.is_none_or(flag)
    }
    /// Of elements, those that are there.
    fn of(self, elements: impl IntoIterator<Item = u32>) -> Vec<u32> {
        (elements.into_iter())
            .filter(|element| self.has(*element))
            .collect()
    }
    /// The nodes of elements that are there, one flag per node of the mesh; none if all are.
    fn nodes(self, mesh: &Mesh) -> Option<Vec<bool>> {
        self.0?;
        let mut there = vec![false; mesh.node_count()];
        for element in self.of(0..mesh.element_count() as u32) {
            for &node in mesh.nodes_of(element) {
                there[node as usize] = true;
            }
        }
        Some(there)
    }
}

/// Where named spots lie, in their order; one pass over the elements for each set and tolerance.
fn locate(
    mesh: &Mesh,
    named: &[(&str, &Spot)],
    presence: Presence,
) -> Result<Vec<Located>, ObserveError> {
    let spots: Vec<&Spot> = named.iter().map(|(_, spot)| *spot).collect();
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
        let all: Vec<u32> = match elements {
            Some(set) => mesh.element_set(set)?.to_vec(),
            None => (0..mesh.element_count() as u32).collect(),
        };
        let there = presence.of(all.iter().copied());
        let found = match mesh.locate_among(&there, &points, *tolerance) {
            Ok(found) => found,
            Err(outside) => {
                // Outside of the mesh, or of what there is of it.
                let is_lost = |&i: &&usize| {
                    let point = [spots[*i].position];
                    mesh.locate_among(&there, &point, *tolerance).is_err()
                        && mesh.locate_among(&all, &point, *tolerance).is_ok()
                };
                return Err(match together.iter().find(is_lost) {
                    Some(&lost) => nothing_at(named[lost].0, &spots[lost].position),
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

/// A spot in elements that are not there.
fn nothing_at(name: &str, position: &Vec3) -> ObserveError {
    let [x, y, z] = [position.x, position.y, position.z];
    ObserveError::NothingThere {
        name: name.into(),
        place: format!("the point ({x}, {y}, {z}) m"),
    }
}

/// The probes of named places, in their order.
pub(super) fn probes(
    mesh: &Mesh,
    places: &[(String, Place)],
    presence: Presence,
) -> Result<Vec<Probe>, ObserveError> {
    let spots: Vec<(&str, &Spot)> = places
        .iter()
        .filter_map(|(name, place)| match place {
            Place::Spot(spot) => Some((name.as_str(), spot)),
            _ => None,
        })
        .collect();
    let mut located = locate(mesh, &spots, presence)?.into_iter();
    let nodes_there = presence.nodes(mesh);
    let is_there = |node: u32| (nodes_there.as_ref()).is_none_or(|there| there[node as usize]);
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
                if !is_there(node) {
                    return Err(ObserveError::NothingThere {
                        name: name.clone(),
                        place: format!("node {tag}"),
                    });
                }
                probes.push(Probe(vec![(node, 1.0)]));
            }
            Place::NodeSet(set) => {
                let all = mesh.nodes_of_set(set)?;
                let nodes: Vec<u32> = all.iter().copied().filter(|n| is_there(*n)).collect();
                if nodes.is_empty() && !all.is_empty() {
                    return Err(ObserveError::NothingThere {
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

/// The elements of named places, in their order.
pub(super) fn elements(
    mesh: &Mesh,
    places: &[(String, StressPlace)],
    presence: Presence,
) -> Result<Vec<u32>, ObserveError> {
    let spots: Vec<(&str, &Spot)> = places
        .iter()
        .filter_map(|(name, place)| match place {
            StressPlace::Spot(spot) => Some((name.as_str(), spot)),
            StressPlace::Element(_) => None,
        })
        .collect();
    let mut located = locate(mesh, &spots, presence)?.into_iter();
    let mut elements = Vec::with_capacity(places.len());
    for (name, place) in places {
        match place {
            StressPlace::Spot(_) => elements.extend(located.next().map(|found| found.element)),
            StressPlace::Element(tag) => {
                let element = index_of(mesh.element_tags(), *tag);
                let element = element.ok_or_else(|| ObserveError::NoSuchElement {
                    name: name.clone(),
                    element: *tag,
                })?;
                if !presence.has(element) {
                    return Err(ObserveError::NothingThere {
                        name: name.clone(),
                        place: format!("element {tag}"),
                    });
                }
                elements.push(element);
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
