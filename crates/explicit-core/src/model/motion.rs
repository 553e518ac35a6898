//! Motion and state of a model, in the mesh's numbering.

use std::borrow::Cow;
use std::collections::BTreeMap;

use powerhouse_model::{
    EngineError, HistoryField, JointHistory, JointView, ModelError, NodalView, Precision, Quad,
    Renewal, State, Stress, Vec3,
};

use super::Model;
use crate::bay::BayMotion;
use crate::nodes::with_nodes;
use crate::ranks::{read, vector, write};

/// An element at a node.
#[derive(Clone, Debug, Default)]
pub(crate) struct ElementAt {
    /// Bound on its frequency (rad/s).
    pub(crate) frequency: f64,
    /// Global number of its block; none if there is no element.
    pub(crate) block: Option<u32>,
    /// Its number, and the name of its set.
    pub(crate) element: u64,
    pub(crate) set: String,
}

impl Model {
    /// Displacement (m) of a mesh node at [`time`](Self::time), in all stages together.
    ///
    /// # Panics
    /// If the node is out of range.
    pub fn displacement(&self, node: u32) -> Vec3 {
        self.displacement_of(self.engine(node))
    }
    /// Velocity (m/s) of a mesh node, half a step before [`time`](Self::time).
    ///
    /// # Panics
    /// If the node is out of range.
    pub fn velocity(&self, node: u32) -> Vec3 {
        self.velocity_of(self.engine(node))
    }
    pub(crate) fn displacement_of(&self, node: usize) -> Vec3 {
        if let Some([displacement, _]) = self.in_slice(node) {
            return displacement;
        }
        with_nodes!(&self.nodes, arrays => arrays.displacement[node].to_vector())
    }
    /// Displacement (m) of every local node.
    pub(crate) fn displacements(&self) -> Vec<Vec3> {
        let nodes = 0..self.mass.len();
        nodes.map(|node| self.displacement_of(node)).collect()
    }
    /// Displacement (m) of the nodes of a block, in the block's order.
    pub(crate) fn displacement_of_block(&self, block: usize) -> Vec<Quad<f64>> {
        if let Some(slice) = &self.delayed {
            return slice.displacement_of_block(&self.subdomain, &self.nodes, block);
        }
        if let Some(displacement) = self.delayed_displacement(block) {
            return displacement;
        }
        with_nodes!(&self.nodes, arrays => self.subdomain.values(block, &arrays.displacement))
    }
    /// Displacement (m) and velocity (m/s) of a node of a slice that moves; none in any other body.
    fn in_slice(&self, node: usize) -> Option<[Vec3; 2]> {
        self.delayed.as_ref()?.motion_of(node)
    }
    pub(crate) fn velocity_of(&self, node: usize) -> Vec3 {
        if let Some([_, velocity]) = self.in_slice(node) {
            return velocity;
        }
        with_nodes!(&self.nodes, arrays => arrays.velocity[node].to_vector())
    }
    /// The user's number of a local node; an additional node has its index.
    pub(crate) fn node_tag(&self, node: usize) -> u64 {
        let index_of = |node: usize| self.subdomain.numbering.mesh_of[node];
        let tag = |index: u32| self.mesh.node_tags().get(index as usize).copied();
        // A copy of a bay has the number of its node of the mesh.
        let of_copy = || {
            let (bay, group) = (self.bay.as_ref()?, self.group_of[node]?);
            tag(index_of(bay.lead(group) as usize))
        };
        let index = index_of(node);
        tag(index).or_else(of_copy).unwrap_or(u64::from(index))
    }
    /// The user's number of an element; an additional element has its index.
    pub(crate) fn element_tag(&self, element: u32) -> u64 {
        let tags = self.mesh.element_tags();
        tags.get(element as usize)
            .copied()
            .unwrap_or(u64::from(element))
    }
}

impl Model {
    /// Of the elements at a node, the one with the highest frequency bound.
    pub(crate) fn element_at(&self, node: usize) -> ElementAt {
        let mesh_node = self.subdomain.numbering.mesh_of[node];
        let mut worst = ElementAt::default();
        for (index, block) in self.blocks.iter().enumerate() {
            if !self.subdomain.nodes_of(index).contains(&(node as u32)) {
                continue;
            }
            for bound in block.frequency_bounds() {
                let inside = (bound.element as usize) < self.mesh.element_count()
                    && (self.mesh_of_elements().nodes_of(bound.element)).contains(&mesh_node);
                let first = worst.block.is_none();
                if inside && (first || bound.frequency > worst.frequency) {
                    worst = ElementAt {
                        frequency: bound.frequency,
                        block: self.ranks.block_numbers.get(index).copied(),
                        element: self.element_tag(bound.element),
                        set: block.label().into(),
                    };
                }
            }
        }
        worst
    }

    /// Sets the initial motion: displacement (m) at the present time and velocity (m/s) half a step
    /// before it, one per mesh node. Velocity components along supports are set to zero.
    ///
    /// # Errors
    /// [`EngineError::State`] for a wrong length or a number that is not finite,
    /// [`EngineError::SinglePrecision`] for one beyond the range of single precision,
    /// [`EngineError::TiedVelocity`] if nodes that are tied have different velocities.
    pub fn set_initial(
        &mut self,
        displacement: &[Vec3],
        velocity: &[Vec3],
    ) -> Result<(), ModelError> {
        if self.precision != Precision::F64 {
            // With loads or prescribed motion the initial motion may be as small as it likes.
            let loaded = self.loads.any() || !self.prescribed.is_empty();
            let least = if loaded { 0.0 } else { LEAST_SINGLE };
            check_single("displacement", displacement, least)?;
            check_single("velocity", velocity, least)?;
        }
        let supported: Vec<Vec3> = velocity
            .iter()
            .enumerate()
            .map(|(node, &v)| {
                let local = self.subdomain.numbering.local(node);
                let group = local.and_then(|local| self.group_of[local]);
                group.map_or(v, |g| self.groups.groups[g as usize].condition.released(v))
            })
            .collect();
        self.put_motion(displacement, &supported)
    }

    fn put_motion(&mut self, displacement: &[Vec3], velocity: &[Vec3]) -> Result<(), ModelError> {
        let [displacement, velocity] =
            [displacement, velocity].map(|values| self.with_copies(values));
        let [displacement, velocity] = [&*displacement, &*velocity];
        let numbering = &self.subdomain.numbering;
        let (mesh_nodes, all) = (self.mesh.node_count(), numbering.local_of.len());
        for (what, values) in [("displacement", displacement), ("velocity", velocity)] {
            let finite = values.iter().all(|v| v.iter().all(|x| x.is_finite()));
            if (values.len() != mesh_nodes && values.len() != all) || !finite {
                return Err(EngineError::State {
                    what,
                    found: values.len(),
                    expected: mesh_nodes,
                }
                .into());
            }
        }
        self.check_ties(velocity)?;
        self.complete_kick();
        self.groups.motion.invalidate();
        if let Some(slice) = &mut self.delayed {
            slice.motion = None;
        }
        if let Some(bay) = &mut self.bay {
            bay.motion = BayMotion::default();
        }
        let numbering = &self.subdomain.numbering;
        let roller_nodes = &self.groups.motion.roller_nodes;
        with_nodes!(&mut self.nodes, arrays => {
            arrays.displacement.fill(Quad::default());
            arrays.velocity.fill(Quad::default());
            for (index, u) in displacement.iter().enumerate() {
                if let Some(local) = numbering.local(index) {
                    arrays.displacement[local] = Quad::from_vector(u);
                }
            }
            for (index, v) in velocity.iter().enumerate() {
                if let Some(local) = numbering.local(index) {
                    arrays.velocity[local] = Quad::from_vector(v);
                }
            }
            roller_nodes.stop(&mut arrays.velocity);
        });
        Ok(())
    }

    fn check_ties(&self, velocity: &[Vec3]) -> Result<(), EngineError> {
        let of = |engine: u32| {
            let index = self.subdomain.numbering.mesh_of[engine as usize] as usize;
            velocity.get(index).copied().unwrap_or_default()
        };
        for group in &self.groups.groups {
            let lead = group.members[0];
            for &member in &group.members[1..] {
                let scale = of(lead).norm().max(of(member).norm());
                if (of(member) - of(lead)).norm() > 1e-9 * scale {
                    return Err(EngineError::TiedVelocity {
                        node: self.node_tag(member as usize),
                        partner: self.node_tag(lead as usize),
                    });
                }
            }
        }
        Ok(())
    }

    /// Makes the present displacement the reference of a new stage: springs and blocks of boundaries are
    /// strained relative to it, and observers receive displacements relative to it.
    pub fn begin_stage(&mut self) {
        self.complete_kick();
        let numbering = &self.subdomain.numbering;
        let nodes = 0..numbering.local_of.len();
        // A rank reads those of its own nodes alone.
        let of = |local: Option<usize>| local.map(|local| self.displacement_of(local));
        let start = nodes.map(|node| of(numbering.local(node)).unwrap_or_default());
        self.put_stage_start(start.collect());
    }

    /// Sets the reference displacement (m) of the stage, of mesh nodes and additional ones.
    fn put_stage_start(&mut self, start: Vec<Vec3>) {
        let start = self.with_copies(&start).into_owned();
        let of = |node: u32| start.get(node as usize).copied().unwrap_or_default();
        for (group, origin) in self.groups.groups.iter().zip(&mut self.groups.origin) {
            *origin = of(self.subdomain.numbering.mesh_of[group.members[0] as usize]);
        }
        let moves = |node: &u32| of(*node) != Vec3::zeros();
        if self.embedded.end < self.blocks.len() {
            let reference: Vec<Quad<f64>> = (self.subdomain.numbering.mesh_of.iter())
                .map(|&node| Quad::from_vector(&of(node)))
                .collect();
            for index in self.embedded.end..self.blocks.len() {
                let own = self.subdomain.values(index, &reference);
                self.blocks[index].set_reference_displacement(NodalView::F64(&own));
            }
        }
        self.stage_start = if self.subdomain.numbering.mesh_of.iter().any(moves) {
            start
        } else {
            Vec::new()
        };
    }

    /// Mean stress change (Pa) of each element of the mesh against its initial stress, from the committed history
    /// variables; zero in absent elements.
    pub fn stress_changes(&self) -> Vec<Stress> {
        let mut all = vec![Stress::default(); self.mesh.element_count()];
        let mut own = Vec::new();
        for (index, block) in self.blocks.iter().enumerate() {
            let stresses = self.stresses_of(index, &self.displacement_of_block(index));
            for (&element, stress) in block.elements().iter().zip(stresses) {
                if self.ranks.is_single() {
                    if let Some(entry) = all.get_mut(element as usize) {
                        *entry = stress;
                    }
                } else {
                    write(element, &stress.0, &mut own);
                }
            }
        }
        if self.ranks.is_single() {
            return all;
        }
        for (element, stress) in (self.ranks.team.of_all(&own).iter()).flat_map(|b| read(b)) {
            if let Some(entry) = all.get_mut(element) {
                *entry = Stress(stress);
            }
        }
        all
    }

    /// The joints of all constraints, with the state of their node pairs.
    pub fn joints(&self) -> impl Iterator<Item = JointView<'_>> {
        (self.constraints.iter()).flat_map(|bound| bound.joints())
    }

    /// The complete state of the body, from which another model of the same mesh continues, in the mesh's numbering;
    /// additional nodes of boundaries follow those of the mesh.
    pub fn state(&mut self) -> State {
        let mut state = self.body_state();
        if !self.ranks.is_single() {
            // A failure of the communication is reported by the next operation that can.
            let blocks = self.all_histories(|_| true).unwrap_or_default();
            state.history = merged(blocks.into_iter());
            let joints = self.all_joints().unwrap_or_default();
            let views = self.ranks.joints.iter().zip(&joints);
            let views = views.map(|(joint, values)| joint.view(values));
            state.joints = views.map(|view| JointHistory::from(&view)).collect();
            return state;
        }
        let blocks = self.blocks.iter().enumerate();
        state.history = merged(blocks.map(|(index, block)| {
            let embedded = self.embedded.contains(&index);
            (block.label().to_string(), embedded, block.history())
        }));
        state.joints = self
            .joints()
            .map(|joint| JointHistory::from(&joint))
            .collect();
        state
    }

    /// The state without history variables and joints; those of the last step are committed.
    pub(crate) fn body_state(&mut self) -> State {
        self.complete_kick();
        self.commit();
        let mut state = State::default();
        (state.time, state.step) = (self.time, self.number);
        self.put_nodes(&mut state);
        state.initial_stress.clone_from(&self.initial.at_centroid);
        state.initial_slope.clone_from(&self.initial.slope);
        state.absent.clone_from(&self.absent);
        state.casts.clone_from(&self.casts);
        state
    }

    /// Writes motion, stage start and carried forces of all nodes of the body into a state.
    fn put_nodes(&self, state: &mut State) {
        let carried = self.loads.carried();
        let is_carried = carried.iter().any(|force| *force != Vec3::zeros());
        if self.ranks.is_single() {
            let local_of = &self.subdomain.numbering.local_of;
            let engines = || local_of.iter().map(|&engine| engine as usize);
            let displacement = engines().map(|engine| self.displacement_of(engine));
            state.displacement = displacement.collect();
            state.velocity = engines().map(|engine| self.velocity_of(engine)).collect();
            state.stage_start.clone_from(&self.stage_start);
            if is_carried {
                state.carried_forces = engines().map(|engine| carried[engine]).collect();
            }
            return;
        }
        let none = [
            u64::from(!is_carried),
            u64::from(self.stage_start.is_empty()),
        ];
        let [no_carried, no_start] = none.map(|none| self.ranks.team.least(none) == 1);
        let mesh_of = &self.subdomain.numbering.mesh_of;
        let all: Vec<[f64; 12]> = self.of_all_nodes(|node| {
            let start = self.stage_start.get(mesh_of[node] as usize).copied();
            let vectors = [
                self.displacement_of(node),
                self.velocity_of(node),
                start.unwrap_or_default(),
                carried.get(node).copied().unwrap_or_default(),
            ];
            core::array::from_fn(|i| vectors[i / 3][i % 3])
        });
        let column = |first: usize| all.iter().map(|node| vector(node, first)).collect();
        (state.displacement, state.velocity) = (column(0), column(3));
        if !no_start {
            state.stage_start = column(6);
        }
        if !no_carried {
            state.carried_forces = column(9);
        }
    }

    /// Sets the state of the body. A run continued from the state of another one is bitwise equal to one that was
    /// not interrupted.
    ///
    /// # Errors
    /// As [`set_initial`](Self::set_initial), [`EngineError::OtherElements`] and [`EngineError::UnknownJoint`].
    pub fn set_state(&mut self, state: &State) -> Result<(), ModelError> {
        let elements = self.mesh.element_count();
        for (what, of_elements) in [
            ("initial stress", &state.initial_stress),
            ("slope of the initial stress", &state.initial_slope),
        ] {
            if !(of_elements.is_empty() || of_elements.len() == elements) {
                return Err(EngineError::State {
                    what,
                    found: of_elements.len(),
                    expected: elements,
                }
                .into());
            }
        }
        if (&state.absent, &state.casts) != (&self.absent, &self.casts) {
            return Err(EngineError::OtherElements.into());
        }
        self.put_motion(&state.displacement, &state.velocity)?;
        self.install();
        self.commit();
        (self.time, self.number) = (state.time, state.step);
        self.put_stage_start(state.stage_start.clone());
        let mut carried = Vec::new();
        if !state.carried_forces.is_empty() {
            carried = vec![Vec3::zeros(); self.mass.len()];
            for (index, force) in state.carried_forces.iter().enumerate() {
                if let Some(local) = self.subdomain.numbering.local(index) {
                    carried[local] = *force;
                }
            }
        }
        self.set_carried_forces(carried);
        (self.initial.at_centroid).clone_from(&state.initial_stress);
        self.initial.slope.clone_from(&state.initial_slope);
        for block in &mut self.blocks {
            if !state.initial_stress.is_empty() {
                let of_block = block.elements().iter();
                let stress: Vec<Stress> = of_block
                    .filter_map(|&e| state.initial_stress.get(e as usize).copied())
                    .collect();
                block.set_initial_stress(&stress);
            }
        }
        for joint in &state.joints {
            if !self.restore_joint(joint)? {
                return Err(EngineError::UnknownJoint {
                    name: joint.name.clone(),
                    pairs: joint.records.len(),
                }
                .into());
            }
        }
        let indices = indices_of(&state.history, elements);
        for (index, block) in self.blocks.iter_mut().enumerate() {
            if self.embedded.contains(&index) {
                block.set_history(&state.history);
                continue;
            }
            let fields = own_fields(&state.history, &indices, block.elements());
            block.set_history(&fields);
        }
        Ok(())
    }

    /// Restores the state of a joint of the body; returns whether there is a joint of that name with these pairs.
    ///
    /// # Errors
    /// [`EngineError::UnknownJoint`] if no rank has one.
    pub(crate) fn restore_joint(&mut self, joint: &JointHistory) -> Result<bool, EngineError> {
        let here = if self.ranks.is_single() {
            Cow::Borrowed(joint)
        } else {
            match self.here(joint)? {
                Some(here) => Cow::Owned(here),
                None => return Ok(true),
            }
        };
        let mut constraints = self.constraints.iter_mut();
        Ok(constraints.any(|bound| {
            let jointed = bound.constraint.jointed_mut();
            jointed.is_some_and(|jointed| jointed.restore(&here))
        }))
    }

    /// Resets a joint, by name, at the present displacement, from which its opening and slip are measured from then
    /// on: grouted or released from a tie. Does nothing and returns false if the model has no joint of that name.
    pub fn renew_joint(&mut self, joint: &str, renewal: Renewal) -> bool {
        let mut constraints = core::mem::take(&mut self.constraints);
        let found = constraints.iter_mut().any(|bound| {
            let nodes = bound.nodes().iter();
            let displacement: Vec<Vec3> = nodes
                .map(|&node| self.displacement_of(node as usize))
                .collect();
            let jointed = bound.constraint.jointed_mut();
            jointed.is_some_and(|jointed| jointed.renew(joint, renewal, &displacement))
        });
        self.constraints = constraints;
        found
    }

    /// Sets the carried forces (N, engine numbering; none if empty), applied in addition to the loads.
    pub(crate) fn set_carried_forces(&mut self, forces: Vec<Vec3>) {
        let group_of = self.groups.kicked_of(&self.group_of);
        let count = self.groups.kicked();
        self.loads.set_carried(forces, &group_of, count);
        if let Some(slice) = &mut self.delayed {
            // They may act on groups that had no load before.
            slice.free.clear();
        }
        self.renew_external();
    }

    /// Makes room for the applied forces at plain nodes, if there are any.
    pub(super) fn renew_external(&mut self) {
        let loaded = self.loads.sums.on_plain_nodes();
        let nodes = if loaded { self.mass.len() } else { 0 };
        with_nodes!(&mut self.nodes, arrays => {
            arrays.external = vec![Default::default(); nodes];
        });
    }
}

/// Range of motions (m, m/s) whose stresses and forces stay within single precision, 1e-38 to
/// 1e38, for all moduli and areas that occur.
const LEAST_SINGLE: f64 = 1e-24;
const MOST_SINGLE: f64 = 1e24;

/// Refuses a motion whose forces leave the range of single precision. Numbers that are not finite are refused
/// elsewhere.
fn check_single(what: &'static str, values: &[Vec3], least: f64) -> Result<(), EngineError> {
    let most = MOST_SINGLE;
    let largest = values.iter().fold(0.0_f64, |most, v| most.max(v.amax()));
    if largest == 0.0 || largest.is_infinite() || (least..=most).contains(&largest) {
        return Ok(());
    }
    Err(EngineError::SinglePrecision {
        what,
        largest,
        least,
        most,
    })
}

/// Concatenates the history fields of all blocks of a set, given by the label of each block, whether it is
/// embedded, and its fields; those of embedded blocks are brought into the order of their elements.
fn merged(blocks: impl Iterator<Item = (String, bool, Vec<HistoryField>)>) -> Vec<HistoryField> {
    let mut index_of: BTreeMap<(String, String, usize), usize> = BTreeMap::new();
    let mut all: Vec<(bool, HistoryField)> = Vec::new();
    for (label, embedded, fields) in blocks {
        for field in fields {
            let key = (label.clone(), field.name.clone(), field.points);
            match index_of.get(&key) {
                Some(&at) => {
                    let whole = core::mem::take(&mut all[at].1);
                    all[at].1 = whole.with(field);
                }
                None => {
                    index_of.insert(key, all.len());
                    all.push((embedded, field));
                }
            }
        }
    }
    let in_order = |(embedded, field)| if embedded { by_element(field) } else { field };
    all.into_iter().map(in_order).collect()
}

/// A field of history variables with its elements in rising order.
pub(crate) fn by_element(field: HistoryField) -> HistoryField {
    if field.elements.is_sorted() {
        return field;
    }
    let mut order: Vec<usize> = (0..field.elements.len()).collect();
    order.sort_by_key(|&index| field.elements[index]);
    let elements = order.iter().map(|&index| field.elements[index]).collect();
    let of = |&index: &usize| &field.values[index * field.points..(index + 1) * field.points];
    let values = order.iter().flat_map(of).copied().collect();
    HistoryField::new(field.name, elements, field.points, values)
}

/// For each field, the index of each mesh element in it.
fn indices_of(fields: &[HistoryField], elements: usize) -> Vec<Vec<Option<u32>>> {
    fields
        .iter()
        .map(|field| {
            let mut indices = vec![None; elements];
            for (index, &element) in field.elements.iter().enumerate() {
                if let Some(entry) = indices.get_mut(element as usize) {
                    *entry = Some(index as u32);
                }
            }
            indices
        })
        .collect()
}

/// The values of each field that belong to some elements.
fn own_fields(
    fields: &[HistoryField],
    indices: &[Vec<Option<u32>>],
    elements: &[u32],
) -> Vec<HistoryField> {
    let mut own = Vec::new();
    for (field, indices) in fields.iter().zip(indices) {
        let mut part = HistoryField::new(field.name.as_str(), Vec::new(), field.points, Vec::new());
        for &element in elements {
            let index = indices.get(element as usize).copied().flatten();
            let values = index.and_then(|index| {
                let start = index as usize * field.points;
                field.values.get(start..start + field.points)
            });
            if let Some(values) = values {
                part.elements.push(element);
                part.values.extend_from_slice(values);
            }
        }
        if !part.elements.is_empty() {
            own.push(part);
        }
    }
    own
}
