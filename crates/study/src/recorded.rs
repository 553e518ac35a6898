//! Where a scene records, as nodes and elements of its mesh.

use powerhouse::Scene;
use powerhouse::engine::observe::{Place, Spot, StressPlace};
use powerhouse::model::{Mesh, Vec3};

/// What of a mesh a scene records.
#[derive(Default)]
pub(crate) struct Recorded {
    /// Nodes whose motion, or whose mean motion, is recorded.
    pub(crate) nodes: Vec<u32>,
    /// Elements that are recorded, or in which points are.
    pub(crate) elements: Vec<u32>,
    /// The points (m).
    pub(crate) points: Vec<Vec3>,
}

impl Recorded {
    /// What a scene records of motion, stress and state.
    pub(crate) fn of(scene: &Scene) -> Self {
        let (mesh, plan) = (scene.mesh(), scene.output());
        let mut recorded = Self::default();
        let places = (plan.histories.iter().map(|wish| &wish.place))
            .chain(plan.relative.iter().flat_map(|wish| [&wish.at, &wish.from]));
        for place in places {
            match place {
                Place::Spot(spot) => recorded.add_spot(mesh, spot),
                Place::Node(_) | Place::NodeSet(_) => recorded.nodes.extend(nodes_of(mesh, place)),
            }
        }
        for wish in plan.stresses.iter().chain(&plan.state.places) {
            match &wish.place {
                StressPlace::Spot(spot) => recorded.add_spot(mesh, spot),
                StressPlace::Element(tag) => {
                    let known = mesh.element_tags().iter().position(|other| other == tag);
                    recorded
                        .elements
                        .extend(known.map(|element| element as u32));
                }
            }
        }
        recorded
    }

    fn add_spot(&mut self, mesh: &Mesh, spot: &Spot) {
        self.points.push(spot.position);
        let among = spot.elements.as_ref().map(|set| mesh.element_set(set));
        let all = || (0..mesh.element_count() as u32).collect();
        let among = among.and_then(Result::ok).map_or_else(all, <[u32]>::to_vec);
        // One that lies nowhere is refused where the scene is prepared.
        let found = mesh.locate_among(&among, &[spot.position], spot.tolerance);
        let found = found.into_iter().flatten();
        self.elements.extend(found.map(|place| place.element));
    }
}

/// The nodes whose mean motion a place without coordinates has; none of a set that does not exist, which is
/// refused where the scene is prepared.
pub(crate) fn nodes_of(mesh: &Mesh, place: &Place) -> Vec<u32> {
    match place {
        Place::Spot(_) => Vec::new(),
        Place::Node(tag) => {
            let known = mesh.node_tags().iter().position(|other| other == tag);
            known.map(|node| node as u32).into_iter().collect()
        }
        Place::NodeSet(name) => mesh.nodes_of_set(name).unwrap_or_default(),
    }
}
