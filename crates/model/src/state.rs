//! The state of a body, in the user's numbering.

use std::collections::HashSet;

use crate::{JointHistory, Stress, Vec3};

/// Values of one history variable (internal state variable) at the integration points of an element set.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct HistoryField {
    /// The name of the variable.
    pub name: String,
    /// Mesh indices of the elements.
    pub elements: Vec<u32>,
    /// Integration points per element.
    pub points: usize,
    /// Values, the points of an element side by side.
    pub values: Vec<f64>,
}

/// Activated elements (element birth) with their stress-free reference configuration, from which their
/// strain counts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cast {
    /// Mesh indices of the elements.
    pub elements: Vec<u32>,
    /// Displacement (m) at which they are free of stress, one per mesh node.
    pub displacement: Vec<Vec3>,
}

/// State of a body from which a stage, a run or another engine continues, keyed by mesh indices.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct State {
    /// Time (s).
    pub time: f64,
    /// Steps taken.
    pub step: u64,
    /// Displacement at `time` (m), one per mesh node.
    pub displacement: Vec<Vec3>,
    /// Velocity half a step before `time` (m/s), one per mesh node.
    pub velocity: Vec<Vec3>,
    /// Displacement (m) at the start of the stage, one per mesh node; empty where it is zero. The
    /// springs of boundaries are measured from it, and observers see displacements against it.
    pub stage_start: Vec<Vec3>,
    /// Mean initial stress per element (Pa); empty where there is none.
    pub initial_stress: Vec<Stress>,
    /// Mesh indices of elements that are not there, excavated or yet to be built, in rising order.
    pub absent: Vec<u32>,
    /// Elements that were put in later.
    pub casts: Vec<Cast>,
    /// Forces (N) that hold the body beside its loads, one per mesh node; empty where there are
    /// none: what balances the initial stress, reactions of supports, what a static solution left.
    pub standing: Vec<Vec3>,
    /// History variables of the laws.
    pub history: Vec<HistoryField>,
    /// Contact states and history variables of joints.
    pub joints: Vec<JointHistory>,
}

impl HistoryField {
    /// A variable of elements (mesh indices) with so many integration points each; the values of the points
    /// of an element stand side by side.
    pub fn new(
        name: impl Into<String>,
        elements: Vec<u32>,
        points: usize,
        values: Vec<f64>,
    ) -> Self {
        Self {
            name: name.into(),
            elements,
            points,
            values,
        }
    }

    fn forget(&mut self, gone: &HashSet<u32>) {
        let points = self.points;
        let kept: Vec<usize> = (0..self.elements.len())
            .filter(|&place| !gone.contains(&self.elements[place]))
            .collect();
        let values = kept
            .iter()
            .flat_map(|&place| place * points..(place + 1) * points);
        self.values = values.filter_map(|i| self.values.get(i).copied()).collect();
        self.elements = kept.iter().map(|&place| self.elements[place]).collect();
    }
}

impl State {
    /// A body at rest at time zero.
    pub fn at_rest(nodes: usize) -> Self {
        Self {
            displacement: vec![Vec3::zeros(); nodes],
            velocity: vec![Vec3::zeros(); nodes],
            ..Self::default()
        }
    }

    /// The same body at the start of a new stage: at rest, at time zero, without the additional
    /// nodes that a boundary had.
    #[must_use]
    pub fn next_stage(mut self, nodes: usize) -> Self {
        (self.time, self.step) = (0.0, 0);
        self.displacement.truncate(nodes);
        self.standing.truncate(nodes);
        self.stage_start.clear();
        self.velocity = vec![Vec3::zeros(); nodes];
        self
    }

    /// Takes elements out of the body, with all that belongs to them.
    pub fn remove(&mut self, elements: &[u32]) {
        self.absent.extend_from_slice(elements);
        self.absent.sort_unstable();
        self.absent.dedup();
        self.forget(elements);
    }

    /// Puts elements in, free of stress at the present displacement.
    pub fn cast(&mut self, elements: &[u32]) {
        self.forget(elements);
        let present: HashSet<u32> = elements.iter().copied().collect();
        self.absent.retain(|element| !present.contains(element));
        self.casts.push(Cast {
            elements: elements.to_vec(),
            displacement: self.displacement.clone(),
        });
    }

    /// Drops the initial stress, the history and the casting of elements.
    fn forget(&mut self, elements: &[u32]) {
        for &element in elements {
            if let Some(stress) = self.initial_stress.get_mut(element as usize) {
                *stress = Stress::default();
            }
        }
        let gone: HashSet<u32> = elements.iter().copied().collect();
        for cast in &mut self.casts {
            cast.elements.retain(|element| !gone.contains(element));
        }
        self.casts.retain(|cast| !cast.elements.is_empty());
        for field in &mut self.history {
            field.forget(&gone);
        }
        self.history.retain(|field| !field.elements.is_empty());
    }
}
