//! The state of a body, in the mesh's numbering.

use std::collections::HashSet;

use crate::{JointHistory, Stress, Vec3};

/// Values of one history variable (internal state variable) at the integration points of an element set.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct HistoryField {
    /// Name of the history variable, as its law calls it.
    pub name: String,
    /// Mesh indices of the elements.
    pub elements: Vec<u32>,
    /// Number of integration points per element.
    pub points: usize,
    /// Values, `points` consecutive ones for each element.
    pub values: Vec<f64>,
}

/// Cast elements (element birth) with their stress-free reference configuration, from which their
/// strain is measured.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Cast {
    /// Mesh indices of the elements.
    pub elements: Vec<u32>,
    /// Reference displacement (m) at which the elements are free of stress, one per mesh node.
    pub displacement: Vec<Vec3>,
}

/// State of a body from which a stage, a run or another engine continues, keyed by mesh indices.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct State {
    /// Present time (s), that of the displacement; construction stages have time zero.
    pub time: f64,
    /// Number of time steps taken until this time; 0 at the start of a stage.
    pub step: u64,
    /// Displacement at `time` (m), one per mesh node.
    pub displacement: Vec<Vec3>,
    /// Velocity half a step before `time` (m/s), one per mesh node.
    pub velocity: Vec<Vec3>,
    /// Displacement (m) at the start of the stage, one per mesh node; empty if it is zero. The
    /// springs of boundaries and the displacements that observers receive are relative to it.
    pub stage_start: Vec<Vec3>,
    /// Initial stress (Pa) at the [centroid](crate::Mesh::centroid), one per element; empty without initial stress.
    pub initial_stress: Vec<Stress>,
    /// Increase of the initial stress per height z (Pa/m), one per element; empty where it is the same all over each
    /// element. It counts in the nodal forces of the initial stress.
    pub initial_slope: Vec<Stress>,
    /// Mesh indices of absent (inactive) elements, excavated or yet to be cast, in rising order.
    pub absent: Vec<u32>,
    /// Elements cast in the course of the stages, with their reference configurations.
    pub casts: Vec<Cast>,
    /// Carried forces (N), which balance the body in addition to its loads, one per mesh node; empty without
    /// such forces: forces of the initial stress, reactions of former supports, residual of a static solution.
    pub carried_forces: Vec<Vec3>,
    /// History variables (internal state variables) of the laws.
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

    /// The same variable of these and further elements, which follow.
    #[must_use]
    pub fn with(mut self, further: Self) -> Self {
        self.elements.extend(further.elements);
        self.values.extend(further.values);
        self
    }

    /// Removes the values of some elements.
    fn remove(&mut self, elements: &HashSet<u32>) {
        let points = self.points;
        let kept: Vec<usize> = (0..self.elements.len())
            .filter(|&index| !elements.contains(&self.elements[index]))
            .collect();
        let values = kept
            .iter()
            .flat_map(|&index| index * points..(index + 1) * points);
        self.values = values.filter_map(|i| self.values.get(i).copied()).collect();
        self.elements = kept.iter().map(|&index| self.elements[index]).collect();
    }
}

impl State {
    /// The state of an undeformed, unstressed body at rest at time zero, with `nodes` mesh nodes.
    pub fn at_rest(nodes: usize) -> Self {
        Self {
            displacement: vec![Vec3::zeros(); nodes],
            velocity: vec![Vec3::zeros(); nodes],
            ..Self::default()
        }
    }

    /// The same body at the start of a new stage: velocity zero, time zero, without the additional
    /// nodes of a boundary.
    #[must_use]
    pub fn next_stage(mut self, nodes: usize) -> Self {
        (self.time, self.step) = (0.0, 0);
        self.displacement.truncate(nodes);
        self.carried_forces.truncate(nodes);
        self.stage_start.clear();
        self.velocity = vec![Vec3::zeros(); nodes];
        self
    }

    /// Removes elements (mesh indices) from the body (element death), with their initial stress and history variables.
    pub fn remove(&mut self, elements: &[u32]) {
        self.absent.extend_from_slice(elements);
        self.absent.sort_unstable();
        self.absent.dedup();
        self.clear_elements(elements);
    }

    /// Casts elements (mesh indices; element birth), free of stress at the present displacement.
    pub fn cast(&mut self, elements: &[u32]) {
        self.clear_elements(elements);
        let present: HashSet<u32> = elements.iter().copied().collect();
        self.absent.retain(|element| !present.contains(element));
        self.casts.push(Cast {
            elements: elements.to_vec(),
            displacement: self.displacement.clone(),
        });
    }

    /// Clears the initial stress with its slope, history variables and reference configurations of elements.
    fn clear_elements(&mut self, elements: &[u32]) {
        for &element in elements {
            for of_elements in [&mut self.initial_stress, &mut self.initial_slope] {
                if let Some(stress) = of_elements.get_mut(element as usize) {
                    *stress = Stress::default();
                }
            }
        }
        let removed: HashSet<u32> = elements.iter().copied().collect();
        for cast in &mut self.casts {
            cast.elements.retain(|element| !removed.contains(element));
        }
        self.casts.retain(|cast| !cast.elements.is_empty());
        for field in &mut self.history {
            field.remove(&removed);
        }
        self.history.retain(|field| !field.elements.is_empty());
    }
}
