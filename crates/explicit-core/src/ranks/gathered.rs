//! State of the body for observers, gathered on rank 0.

use std::cell::Cell;

use powerhouse_model::{
    HistoryField, JointView, Mesh, Observer, Reach, Selection, StepView, Stress, Vec3,
};

use super::whole::{JointValues, SentJoint, joint_values, read, vector, write};
use crate::Model;
use crate::model::by_element;
use crate::view::View;

/// Nodes or elements (mesh indices, in rising order) that some observers read; none if they read all.
type Chosen = Option<Vec<u32>>;

/// What the observers that are due in a step read together.
#[derive(Default)]
pub(crate) struct Wanted {
    nodes: Chosen,
    stresses: Chosen,
    forces: Chosen,
    states: Chosen,
    variables: Vec<String>,
    embedded: bool,
    joints: bool,
}

/// The union of some selections.
fn union<'s>(selections: impl Iterator<Item = &'s Selection>) -> Chosen {
    let mut all = Vec::new();
    for selection in selections {
        match selection {
            Selection::All => return None,
            Selection::These(own) => all.extend_from_slice(own),
        }
    }
    all.sort_unstable();
    all.dedup();
    Some(all)
}

impl Wanted {
    /// From the observers that are due and what each of them reads.
    pub(crate) fn of<'o>(due: impl Iterator<Item = (&'o dyn Observer, &'o Reach)> + Clone) -> Self {
        let reach = || due.clone().map(|(_, reach)| reach);
        let elements = |read: &dyn Fn(&dyn Observer, &Reach) -> bool| {
            let those = due
                .clone()
                .filter(|(observer, reach)| read(*observer, reach));
            union(those.map(|(_, reach)| &reach.elements))
        };
        let variables = reach().flat_map(|reach| reach.variables.iter().cloned());
        let mut variables: Vec<String> = variables.collect();
        variables.sort_unstable();
        variables.dedup();
        Self {
            nodes: union(reach().map(|reach| &reach.nodes)),
            stresses: elements(&|observer, _| observer.fields().stress),
            forces: elements(&|_, reach| reach.element_forces),
            states: elements(&|_, reach| !reach.variables.is_empty()),
            variables,
            embedded: reach().any(|reach| reach.embedded),
            joints: reach().any(|reach| reach.joints),
        }
    }
}

/// Values of chosen nodes or elements.
struct Picked<T> {
    chosen: Chosen,
    values: Vec<T>,
}

impl<T: Clone> Picked<T> {
    /// Equal values of the chosen ones of `count`.
    fn new(chosen: Chosen, count: usize, value: T) -> Self {
        let count = chosen.as_ref().map_or(count, Vec::len);
        Self {
            chosen,
            values: vec![value; count],
        }
    }
    fn place(&self, index: usize) -> Option<usize> {
        match &self.chosen {
            None => Some(index),
            Some(chosen) => chosen.binary_search(&(index as u32)).ok(),
        }
    }
    fn get(&self, index: u32) -> Option<&T> {
        self.values.get(self.place(index as usize)?)
    }
    fn put(&mut self, index: usize, value: T) {
        let place = self.place(index);
        if let Some(entry) = place.and_then(|place| self.values.get_mut(place)) {
            *entry = value;
        }
    }
}

/// What a rank sends to rank 0.
#[derive(Default)]
struct Sent {
    nodes: Vec<u8>,
    stresses: Vec<u8>,
    forces: Vec<u8>,
    states: Vec<u8>,
    joints: Vec<SentJoint>,
    embedded: Vec<(u32, String, Vec<HistoryField>)>,
}

/// Calls a function with each of the chosen ones of `count` that are here.
fn each(chosen: &Chosen, count: usize, here: impl Fn(u32) -> bool, mut visit: impl FnMut(u32)) {
    match chosen {
        None => (0..count as u32)
            .filter(|&index| here(index))
            .for_each(&mut visit),
        Some(chosen) => {
            let chosen = chosen.iter().copied();
            chosen.filter(|&index| here(index)).for_each(&mut visit);
        }
    }
}

impl Sent {
    /// The state of the nodes, elements and joints of this rank, between kick and drift.
    fn of(model: &Model, view: &View, wanted: &Wanted) -> Self {
        let (subdomain, mesh) = (&model.subdomain, &model.mesh);
        let mut sent = Self::default();
        let is_owned = |node: u32| {
            let local = subdomain.numbering.local(node as usize);
            local.is_some_and(|local| subdomain.node_ranges.has(local))
        };
        each(&wanted.nodes, mesh.node_count(), is_owned, |node| {
            let vectors = [
                view.displacement(node),
                view.velocity(node),
                view.acceleration(node),
            ];
            let numbers: [f64; 9] = core::array::from_fn(|i| vectors[i / 3][i % 3]);
            write(node, &numbers, &mut sent.nodes);
        });
        let elements = mesh.element_count();
        let is_here = |element: u32| subdomain.block_of(element).is_some();
        each(&wanted.stresses, elements, is_here, |element| {
            write(element, &view.stress(element).0, &mut sent.stresses);
        });
        let mut forces = Vec::new();
        each(&wanted.forces, elements, is_here, |element| {
            forces.clear();
            forces.resize(mesh.nodes_of(element).len(), Vec3::zeros());
            let known = f64::from(u8::from(view.element_forces(element, &mut forces)));
            let of_nodes = forces.iter().flat_map(|f| [f.x, f.y, f.z]);
            let numbers: Vec<f64> = core::iter::once(known).chain(of_nodes).collect();
            write(element, &numbers, &mut sent.forces);
        });
        each(&wanted.states, elements, is_here, |element| {
            // Whether the law has each variable, and its value.
            let values = wanted
                .variables
                .iter()
                .map(|name| view.history(element, name));
            let numbers = values.flat_map(|value| match value {
                Some(value) => [1.0, value],
                None => [0.0; 2],
            });
            write(element, &numbers.collect::<Vec<f64>>(), &mut sent.states);
        });
        if wanted.joints {
            sent.joints = model.own_joints();
        }
        if wanted.embedded {
            sent.embedded = model.own_embedded();
        }
        sent
    }
}

/// State of the body at a step, from the nodes and elements of all ranks.
pub(crate) struct Gathered<'a> {
    model: &'a Model,
    number: u64,
    time: f64,
    step: f64,
    /// Displacement since the start of the stage (m), velocity (m/s) and acceleration (m/s2).
    motion: Picked<[Vec3; 3]>,
    /// Mean stress (Pa).
    stress: Picked<Stress>,
    /// Forces (N) at the nodes of an element; empty if they are zero, none if they are not known.
    forces: Picked<Option<Vec<Vec3>>>,
    /// Values of the variables.
    states: Picked<Vec<Option<f64>>>,
    variables: Vec<String>,
    joints: Option<Vec<JointValues>>,
    embedded: Option<Vec<(u32, String, Vec<HistoryField>)>>,
    energies: &'a [(&'static str, f64)],
    /// What an observer has read that is not gathered.
    missing: Cell<Option<&'static str>>,
}

/// Vectors from consecutive numbers.
fn vectors(numbers: &[f64]) -> Vec<Vec3> {
    numbers
        .chunks_exact(3)
        .map(|v| Vec3::new(v[0], v[1], v[2]))
        .collect()
}

/// The elements and numbers that [`write`] wrote, as many as an element has.
fn each_element<'b>(
    mut bytes: &'b [u8],
    count: impl Fn(u32) -> usize + 'b,
) -> impl Iterator<Item = (u32, Vec<f64>)> + 'b {
    core::iter::from_fn(move || {
        let (index, rest) = bytes.split_first_chunk::<4>()?;
        let element = u32::from_le_bytes(*index);
        let (numbers, rest) = rest.split_at_checked(count(element) * size_of::<f64>())?;
        bytes = rest;
        let (numbers, _) = numbers.as_chunks::<8>();
        Some((
            element,
            numbers.iter().copied().map(f64::from_le_bytes).collect(),
        ))
    })
}

impl<'a> Gathered<'a> {
    /// Gathers the state between kick and drift; none on other ranks than rank 0.
    pub(crate) fn of(
        model: &'a Model,
        step: f64,
        wanted: Wanted,
        energies: &'a [(&'static str, f64)],
    ) -> Option<Self> {
        let view = View::new(model, step, energies);
        let mesh = &model.mesh;
        let sent = Sent::of(model, &view, &wanted);
        let team = &model.ranks.team;
        let nodes = team.at_first(&sent.nodes);
        let stresses = team.at_first(&sent.stresses);
        let forces = team.at_first(&sent.forces);
        let states = team.at_first(&sent.states);
        let joints = wanted.joints.then(|| team.all_at_first(&sent.joints));
        let embedded = wanted.embedded.then(|| team.all_at_first(&sent.embedded));
        if team.rank() != 0 {
            return None;
        }
        let elements = mesh.element_count();
        let none = vec![None; wanted.variables.len()];
        let mut gathered = Self {
            model,
            number: view.number(),
            time: view.time(),
            step,
            motion: Picked::new(wanted.nodes, mesh.node_count(), [Vec3::zeros(); 3]),
            stress: Picked::new(wanted.stresses, elements, Stress::default()),
            forces: Picked::new(wanted.forces, elements, Some(Vec::new())),
            states: Picked::new(wanted.states, elements, none),
            variables: wanted.variables,
            joints: joints.map(|sent| joint_values(&model.ranks.joints, sent)),
            embedded: embedded.map(|sent| {
                let mut all: Vec<_> = sent.into_iter().flatten().collect();
                all.sort_by_key(|(number, ..)| *number);
                all
            }),
            energies,
            missing: Cell::new(None),
        };
        for (node, numbers) in nodes.iter().flat_map(|bytes| read::<9>(bytes)) {
            let motion = [0, 3, 6].map(|first| vector(&numbers, first));
            gathered.motion.put(node, motion);
        }
        for (element, numbers) in stresses.iter().flat_map(|bytes| read::<6>(bytes)) {
            gathered.stress.put(element, Stress(numbers));
        }
        let of_forces = |element: u32| 1 + 3 * node_count(mesh, element);
        for (element, numbers) in (forces.iter()).flat_map(|b| each_element(b, of_forces)) {
            let known = (numbers[0] != 0.0).then(|| vectors(&numbers[1..]));
            gathered.forces.put(element as usize, known);
        }
        let variables = gathered.variables.len();
        let of_states = move |_| 2 * variables;
        for (element, numbers) in (states.iter()).flat_map(|b| each_element(b, of_states)) {
            let values = numbers
                .chunks_exact(2)
                .map(|v| (v[0] != 0.0).then_some(v[1]));
            gathered.states.put(element as usize, values.collect());
        }
        Some(gathered)
    }

    /// What observers have read that is not gathered, if anything.
    pub(crate) fn missing(&self) -> Option<&'static str> {
        self.missing.get()
    }

    fn moved(&self, node: u32, which: usize) -> Vec3 {
        if let Some(motion) = self.motion.get(node) {
            return motion[which];
        }
        let undeclared = "an observer that reads nodes beyond those that it declares";
        self.missing.set(Some(undeclared));
        Vec3::zeros()
    }
}

/// Number of nodes of an element; none of one that does not exist.
fn node_count(mesh: &Mesh, element: u32) -> usize {
    if (element as usize) < mesh.element_count() {
        mesh.nodes_of(element).len()
    } else {
        0
    }
}

impl StepView for Gathered<'_> {
    fn number(&self) -> u64 {
        self.number
    }
    fn time(&self) -> f64 {
        self.time
    }
    fn step(&self) -> f64 {
        self.step
    }
    fn node_count(&self) -> usize {
        self.model.mesh.node_count()
    }
    fn displacement(&self, node: u32) -> Vec3 {
        self.moved(node, 0)
    }
    fn velocity(&self, node: u32) -> Vec3 {
        self.moved(node, 1)
    }
    fn acceleration(&self, node: u32) -> Vec3 {
        self.moved(node, 2)
    }
    fn stress(&self, element: u32) -> Stress {
        if let Some(stress) = self.stress.get(element) {
            return *stress;
        }
        let undeclared = "an observer that reads stresses and does not declare them";
        self.missing.set(Some(undeclared));
        Stress::default()
    }
    fn element_forces(&self, element: u32, out: &mut [Vec3]) -> bool {
        out.fill(Vec3::zeros());
        match self.forces.get(element) {
            Some(Some(forces)) => {
                out.iter_mut()
                    .zip(forces)
                    .for_each(|(out, force)| *out = *force);
                true
            }
            Some(None) => false,
            None => {
                let undeclared = "an observer that reads element forces and does not declare them";
                self.missing.set(Some(undeclared));
                false
            }
        }
    }
    fn energies(&self) -> &[(&'static str, f64)] {
        self.energies
    }
    fn history(&self, element: u32, variable: &str) -> Option<f64> {
        let variable = self.variables.iter().position(|name| name == variable);
        if let (Some(variable), Some(values)) = (variable, self.states.get(element)) {
            return values[variable];
        }
        let undeclared = "an observer that reads history variables and does not declare them";
        self.missing.set(Some(undeclared));
        None
    }
    fn embedded(&self, block: &str, variable: &str) -> Option<Vec<f64>> {
        let Some(embedded) = &self.embedded else {
            let undeclared = "an observer that reads embedded elements and does not declare them";
            self.missing.set(Some(undeclared));
            return None;
        };
        let name = format!("{block}/{variable}");
        let own = embedded.iter().filter(|(_, label, _)| label == block);
        let fields = own.flat_map(|(.., fields)| fields.iter().filter(|f| f.name == name));
        Some(by_element(fields.cloned().reduce(HistoryField::with)?).values)
    }
    fn joints(&self) -> Vec<JointView<'_>> {
        let Some(values) = &self.joints else {
            let undeclared = "an observer that reads joints and does not declare them";
            self.missing.set(Some(undeclared));
            return Vec::new();
        };
        let joints = self.model.ranks.joints.iter().zip(values);
        joints.map(|(joint, values)| joint.view(values)).collect()
    }
}
