//! Recorded nodes, elements and points of a scene.

use powerhouse::Scene;
use powerhouse::engine::observe::{ObservationPoint, Place, StressPlace};
use powerhouse::model::{Mesh, Selection, Vec3};

/// Nodes, elements and points that the output requests of a scene refer to.
#[derive(Default)]
pub(crate) struct Recorded {
    /// Nodes whose motion or mean motion is recorded.
    pub(crate) nodes: Vec<u32>,
    /// Elements that are recorded or contain recorded points.
    pub(crate) elements: Vec<u32>,
    /// Recorded points (m).
    pub(crate) points: Vec<Vec3>,
}

impl Recorded {
    /// Collects the nodes, elements and points of all requests of motion, stress and history variables.
    pub(crate) fn of(scene: &Scene) -> Self {
        let (mesh, plan) = (scene.mesh(), scene.output());
        let mut recorded = Self::default();
        let places = (plan.histories.iter().map(|request| &request.place)).chain(
            plan.relative
                .iter()
                .flat_map(|request| [&request.at, &request.from]),
        );
        for place in places {
            match place {
                Place::Point(spot) => recorded.add_spot(mesh, spot),
                Place::Node(_) | Place::NodeSet(_) => recorded.nodes.extend(place.nodes(mesh)),
            }
        }
        for request in plan.stresses.iter().chain(&plan.state.places) {
            match &request.place {
                StressPlace::Point(spot) => recorded.add_spot(mesh, spot),
                StressPlace::Element(tag) => {
                    let known = mesh.element_tags().iter().position(|other| other == tag);
                    recorded
                        .elements
                        .extend(known.map(|element| element as u32));
                }
            }
        }
        for request in &plan.sampled {
            let reach = request.sampler.reach();
            if let Selection::These(nodes) = reach.nodes {
                recorded.nodes.extend(nodes);
            }
            if let Selection::These(elements) = reach.elements {
                recorded.elements.extend(elements);
            }
        }
        recorded
    }

    fn add_spot(&mut self, mesh: &Mesh, spot: &ObservationPoint) {
        self.points.push(spot.position);
        let among = spot.elements.as_ref().map(|set| mesh.element_set(set));
        let all = || (0..mesh.element_count() as u32).collect();
        let among = among.and_then(Result::ok).map_or_else(all, <[u32]>::to_vec);
        // A point outside all elements is an error when the scene is prepared.
        let found = mesh.locate_among(&among, &[spot.position], spot.tolerance);
        let found = found.into_iter().flatten();
        self.elements.extend(found.map(|location| location.element));
    }
}
