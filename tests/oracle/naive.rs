//! A naive engine: plain loops over nodes and elements in the mesh's numbering, dynamics alone.

use nalgebra::DMatrix;
use powerhouse_model::{
    BlockContext, BlockPart, Constraint, Dynamics, ElementBlock, Ended, Engine, EngineModel, Flow,
    ForceTerms, FrequencyLimits, HourglassShare, JointView, Length, MassDampingRule, Mat3, Mesh,
    ModelError, ModelFrequencies, ModelOutput, ModelSpec, NodalLoad, NodalView, NodalViewMut,
    Observer, PeriodicPairs, PredictedMotion, Progress, Quad, Renewal, RunError, RunFailure,
    RunOptions, RunReport, StableStep, State, StateError, StatefulModel, StepChoice, StepTime,
    StepView, Stress, TimeFunction, TimeIntegrator, Vec3,
};

/// The naive engine: one block for each element set, one node after another, no energy balance, no statics.
pub(crate) struct Naive;

impl Engine for Naive {
    fn name(&self) -> &str {
        "naive"
    }
    fn build(&self, spec: ModelSpec) -> Result<Box<dyn EngineModel>, ModelError> {
        Ok(Box::new(NaiveModel::of(spec)?))
    }
}

/// Conditions and impedance of a node, or of tied nodes at the first of them.
#[derive(Clone, Default)]
struct Node {
    mass: f64,
    mass_damping: f64,
    spring: Mat3,
    dashpot: Mat3,
    /// Unit directions with a given velocity: zero, or that of a prescribed motion.
    given: Vec<(Vec3, Option<usize>)>,
}

struct NaiveModel {
    mesh: Mesh,
    blocks: Vec<Box<dyn ElementBlock>>,
    /// First node of those tied to each node.
    lead: Vec<usize>,
    nodes: Vec<Node>,
    own_mass: Vec<f64>,
    displacement: Vec<Vec3>,
    velocity: Vec<Vec3>,
    next: Vec<Vec3>,
    force: Vec<Vec3>,
    loads: Vec<Box<dyn NodalLoad>>,
    weights: Vec<(Vec3, Box<dyn TimeFunction>)>,
    motions: Vec<Box<dyn TimeFunction>>,
    constraints: Vec<(Box<dyn Constraint>, Vec<Mat3>)>,
    rule: MassDampingRule,
    time: f64,
    number: u64,
}

impl NaiveModel {
    fn of(spec: ModelSpec) -> Result<Self, ModelError> {
        let refuse = |what: &str| Err(ModelError::refused("naive", what));
        if spec.start.is_some() || !spec.embedded.is_empty() {
            return refuse("no initial states, no embedded blocks");
        }
        let mesh = spec.mesh;
        let count = mesh.node_count();
        let mut blocks = Vec::new();
        for (choice, factory) in &spec.sets {
            let elements = match choice {
                powerhouse_model::ElementChoice::Set(name) => mesh.element_set(name)?,
                powerhouse_model::ElementChoice::Elements(elements) => elements,
            };
            let mut own: Vec<u32> = elements
                .iter()
                .flat_map(|&element| mesh.nodes_of(element).iter().copied())
                .collect();
            own.sort_unstable();
            own.dedup();
            blocks.push(factory.build(&BlockPart::new(mesh, elements, &own))?);
        }
        let leads = PeriodicPairs::leads(&spec.periodic);
        let lead_of = |node: u32| leads.get(&node).copied().unwrap_or(node) as usize;
        let lead: Vec<usize> = (0..count as u32).map(lead_of).collect();
        let mut nodes = vec![Node::default(); count];
        let mut own_mass = vec![0.0; count];
        for block in &blocks {
            let mut masses = vec![0.0; block.nodes().len()];
            block.add_mass(&mut masses);
            for (&node, mass) in block.nodes().iter().zip(masses) {
                own_mass[node as usize] += mass;
                let lead = &mut nodes[lead[node as usize]];
                lead.mass += mass;
                lead.mass_damping += mass * block.damping().mass;
            }
        }
        for support in &spec.supports {
            for direction in support.directions()? {
                for &node in support.nodes() {
                    nodes[lead_of(node)].given.push((direction, None));
                }
            }
        }
        let mut motions = Vec::new();
        for prescribed in spec.prescribed {
            for &node in &prescribed.nodes {
                let direction = prescribed.direction.normalize();
                nodes[lead_of(node)]
                    .given
                    .push((direction, Some(motions.len())));
            }
            motions.push(prescribed.displacement);
        }
        let mut loads = spec.loads;
        for boundary in spec.boundaries {
            if !boundary.blocks.is_empty() {
                return refuse("no boundaries with blocks");
            }
            for item in boundary.impedance {
                let node = &mut nodes[lead_of(item.node)];
                node.spring += item.spring;
                node.dashpot += item.dashpot;
            }
            loads.extend(boundary.loads);
        }
        Ok(Self {
            blocks,
            lead,
            nodes,
            own_mass,
            displacement: vec![Vec3::zeros(); count],
            velocity: vec![Vec3::zeros(); count],
            next: vec![Vec3::zeros(); count],
            force: vec![Vec3::zeros(); count],
            loads,
            weights: spec.weights,
            motions,
            constraints: spec
                .constraints
                .into_iter()
                .map(|c| (c, Vec::new()))
                .collect(),
            rule: MassDampingRule::Implicit,
            time: 0.0,
            number: 0,
            mesh: mesh.clone(),
        })
    }

    fn when(&self, step: f64) -> StepTime {
        StepTime {
            number: self.number,
            time: self.time,
            step,
        }
    }

    /// Effective masses (kg) of the new and of the old velocity, dashpots and springs included.
    fn matrices(&self, node: &Node, step: f64) -> (Mat3, Mat3) {
        let (new, old) = self
            .rule
            .effective_mass(node.mass, node.mass_damping * step);
        let dashpot = node.dashpot * (0.5 * step);
        let spring = node.spring * (0.25 * step * step);
        let identity = Mat3::identity();
        (
            identity * new + dashpot + spring,
            identity * old - dashpot + spring,
        )
    }
}

/// The velocity nearest to a free one, in the metric of the effective mass, with given components; and the inverse
/// of the effective mass (1/kg) in the free directions.
fn meet(effective: &Mat3, free: Vec3, given: &[(Vec3, f64)]) -> (Vec3, Mat3) {
    let inverse = effective.try_inverse().expect("every node has a mass");
    if given.is_empty() {
        return (free, inverse);
    }
    let normals = DMatrix::from_fn(3, given.len(), |i, j| given[j].0[i]);
    let inverse_of = DMatrix::from_fn(3, 3, |i, j| inverse[(i, j)] / inverse.amax());
    let small = normals.transpose() * &inverse_of * &normals;
    let solved = small.pseudo_inverse(1e-10).expect("a symmetric matrix");
    let lift = &inverse_of * &normals * solved;
    let missing = DMatrix::from_fn(given.len(), 1, |j, _| given[j].1 - given[j].0.dot(&free));
    let change = &lift * missing;
    let product = &lift * normals.transpose();
    let across = Mat3::from_fn(|i, j| product[(i, j)]);
    (
        free + Vec3::new(change[0], change[1], change[2]),
        inverse - across * inverse,
    )
}

/// The values of a block's nodes, in their order.
fn of_block(block: &dyn ElementBlock, values: &[Vec3]) -> Vec<Quad<f64>> {
    let nodes = block.nodes().iter();
    nodes
        .map(|&node| Quad::from_vector(&values[node as usize]))
        .collect()
}

impl Dynamics for NaiveModel {
    fn time(&self) -> f64 {
        self.time
    }
    fn forces(&mut self, terms: ForceTerms, step: f64) -> Result<(), RunError> {
        let when = self.when(step);
        self.force.fill(Vec3::zeros());
        for block in &mut self.blocks {
            let displacement = of_block(block.as_ref(), &self.displacement);
            let velocity = of_block(block.as_ref(), &self.velocity);
            let (u, v) = (NodalView::F64(&displacement), NodalView::F64(&velocity));
            let context = BlockContext::new(when, u, v).with_damping_shift(terms.damping_shift);
            let mut own = vec![Quad::default(); block.nodes().len()];
            let computed = block.forces(&context, NodalViewMut::F64(&mut own));
            computed.map_err(|fault| RunError::Element {
                element: self.mesh.element_tags()[fault.element as usize],
                set: block.label().into(),
                step: self.number,
                reason: fault.reason,
            })?;
            for (&node, force) in block.nodes().iter().zip(&own) {
                self.force[node as usize] -= force.to_vector();
            }
        }
        for load in &mut self.loads {
            let mut own = vec![Vec3::zeros(); load.nodes().len()];
            load.add_forces(self.time, &mut own);
            for (&node, force) in load.nodes().iter().zip(own) {
                self.force[node as usize] += force;
            }
        }
        for (acceleration, history) in &self.weights {
            let now = acceleration * history.value(self.time);
            for (force, mass) in self.force.iter_mut().zip(&self.own_mass) {
                *force += now * *mass;
            }
        }
        Ok(())
    }
    fn kick(&mut self, rule: MassDampingRule, step: f64) -> Result<(), RunError> {
        self.rule = rule;
        let mut sums = vec![Vec3::zeros(); self.nodes.len()];
        for (&lead, force) in self.lead.iter().zip(&self.force) {
            sums[lead] += force;
        }
        for lead in 0..self.nodes.len() {
            if self.lead[lead] != lead {
                continue;
            }
            let node = &self.nodes[lead];
            let (effective, old) = self.matrices(node, step);
            let impulse = (sums[lead] - node.spring * self.displacement[lead]) * step;
            let free = effective.try_inverse().expect("every node has a mass")
                * (old * self.velocity[lead] + impulse);
            let given: Vec<(Vec3, f64)> = (node.given.iter())
                .map(|&(direction, motion)| {
                    let target = motion.map_or(0.0, |motion| {
                        let end = self.motions[motion].value(self.time + step);
                        (end - direction.dot(&self.displacement[lead])) / step
                    });
                    (direction, target)
                })
                .collect();
            self.next[lead] = meet(&effective, free, &given).0;
        }
        for node in 0..self.nodes.len() {
            self.next[node] = self.next[self.lead[node]];
        }
        Ok(())
    }
    fn constrain(&mut self, step: f64) -> Result<(), RunError> {
        let when = self.when(step);
        let mut constraints = core::mem::take(&mut self.constraints);
        for (constraint, prepared) in &mut constraints {
            let nodes: Vec<usize> = constraint.nodes().iter().map(|&n| n as usize).collect();
            let inverse: Vec<Mat3> = (nodes.iter())
                .map(|&node| {
                    let node = &self.nodes[self.lead[node]];
                    let held: Vec<_> = node.given.iter().map(|&(d, _)| (d, 0.0)).collect();
                    meet(&self.matrices(node, step).0, Vec3::zeros(), &held).1
                })
                .collect();
            if *prepared != inverse {
                constraint.prepare(step, &inverse);
                prepared.clone_from(&inverse);
            }
            let of = |values: &[Vec3]| -> Vec<Vec3> { nodes.iter().map(|&n| values[n]).collect() };
            let (displacement, previous) = (of(&self.displacement), of(&self.velocity));
            let mut velocity = of(&self.next);
            constraint.correct(PredictedMotion::new(
                when,
                &displacement,
                &previous,
                &mut velocity,
                &inverse,
            ))?;
            for (node, velocity) in nodes.into_iter().zip(velocity) {
                self.next[node] = velocity;
            }
        }
        self.constraints = constraints;
        Ok(())
    }
    fn drift(&mut self, step: f64) {
        self.velocity.clone_from(&self.next);
        for (displacement, velocity) in self.displacement.iter_mut().zip(&self.velocity) {
            *displacement += velocity * step;
        }
        for block in &mut self.blocks {
            block.commit();
        }
        self.time += step;
        self.number += 1;
    }
}

/// The model in a step, for observers.
struct View<'a>(&'a NaiveModel, f64);

impl StepView for View<'_> {
    fn number(&self) -> u64 {
        self.0.number
    }
    fn time(&self) -> f64 {
        self.0.time
    }
    fn step(&self) -> f64 {
        self.1
    }
    fn node_count(&self) -> usize {
        self.0.nodes.len()
    }
    fn displacement(&self, node: u32) -> Vec3 {
        self.0.displacement[node as usize]
    }
    fn velocity(&self, node: u32) -> Vec3 {
        (self.0.velocity[node as usize] + self.0.next[node as usize]) * 0.5
    }
    fn acceleration(&self, node: u32) -> Vec3 {
        (self.0.next[node as usize] - self.0.velocity[node as usize]) / self.1
    }
    fn stress(&self, element: u32) -> Stress {
        self.0.stress_changes()[element as usize]
    }
    fn energies(&self) -> &[(&'static str, f64)] {
        &[]
    }
    fn joints(&self) -> Vec<JointView<'_>> {
        ModelOutput::joints(self.0)
    }
}

/// A model that calls observers between kick and drift.
struct Watched<'a> {
    model: &'a mut NaiveModel,
    observers: &'a mut [Box<dyn Observer>],
    last: bool,
    ended: Option<Ended>,
    failure: Option<RunError>,
}

impl Dynamics for Watched<'_> {
    fn time(&self) -> f64 {
        Dynamics::time(&*self.model)
    }
    fn forces(&mut self, terms: ForceTerms, step: f64) -> Result<(), RunError> {
        self.model.forces(terms, step)
    }
    fn kick(&mut self, rule: MassDampingRule, step: f64) -> Result<(), RunError> {
        self.model.kick(rule, step)
    }
    fn constrain(&mut self, step: f64) -> Result<(), RunError> {
        self.model.constrain(step)
    }
    fn drift(&mut self, step: f64) {
        let (number, time) = (self.model.number, self.model.time);
        for observer in self.observers.iter_mut() {
            if !(self.last || observer.cadence().is_due(number, time, step)) {
                continue;
            }
            match observer.observe(&View(self.model, step)) {
                Ok(Flow::Continue) => {}
                Ok(Flow::Stop) => self.ended = Some(Ended::Observer(observer.name().into())),
                Err(source) => {
                    self.failure = Some(RunError::Observer {
                        name: observer.name().into(),
                        step: number,
                        source: Box::new(source),
                    });
                }
            }
        }
        self.model.drift(step);
    }
}

impl EngineModel for NaiveModel {
    fn mesh(&self) -> &Mesh {
        &self.mesh
    }
    fn time(&self) -> f64 {
        self.time
    }
    fn displacement(&self, node: u32) -> Vec3 {
        self.displacement[node as usize]
    }
    fn velocity(&self, node: u32) -> Vec3 {
        self.velocity[node as usize]
    }
    fn set_initial(&mut self, displacement: &[Vec3], velocity: &[Vec3]) -> Result<(), ModelError> {
        self.displacement.copy_from_slice(displacement);
        for (index, velocity) in velocity.iter().enumerate() {
            let node = &self.nodes[self.lead[index]];
            let fixed = node.given.iter().filter(|(_, motion)| motion.is_none());
            let given: Vec<_> = fixed.map(|&(direction, _)| (direction, 0.0)).collect();
            self.velocity[index] = meet(&Mat3::identity(), *velocity, &given).0;
        }
        Ok(())
    }
    fn stable_step(&mut self, integrator: &dyn TimeIntegrator) -> Result<StableStep, RunError> {
        let limits = self.frequency_limits();
        let step = integrator.stable_step(&limits)?;
        Ok(StableStep::new(step, 2.0 / limits.highest))
    }
    fn run(
        &mut self,
        integrator: &dyn TimeIntegrator,
        options: &RunOptions,
        observers: &mut [Box<dyn Observer>],
        progress: &mut (dyn FnMut(Progress) + Send),
    ) -> Result<RunReport, RunFailure> {
        let fail = |error| RunFailure {
            error,
            report: None,
        };
        if options.resume.is_some() {
            return Err(fail(RunError::State {
                part: "the run".into(),
                source: StateError::Refused {
                    reason: "this engine cannot resume runs".into(),
                },
            }));
        }
        let step = match options.step {
            StepChoice::Stable => self.stable_step(integrator).map_err(fail)?.step,
            StepChoice::Fixed(step) | StepChoice::Unchecked(step) => step,
        };
        let planned = match options.length {
            Length::Steps(count) => count,
            Length::Seconds(duration) => (duration / step - 1e-6).ceil().max(0.0) as u64 + 1,
        };
        let mut ended = Ended::Completed;
        let mut done = 0;
        while done < planned && ended == Ended::Completed {
            done += 1;
            let mut watched = Watched {
                model: &mut *self,
                observers: &mut *observers,
                last: done == planned,
                ended: None,
                failure: None,
            };
            integrator.step(&mut watched, step).map_err(fail)?;
            if let Some(failure) = watched.failure {
                return Err(fail(failure));
            }
            ended = watched.ended.unwrap_or(Ended::Completed);
            progress(Progress::new(done, planned, self.time));
        }
        for observer in observers.iter_mut() {
            observer.finish().map_err(|source| {
                fail(RunError::Observer {
                    name: observer.name().into(),
                    step: self.number,
                    source: Box::new(source),
                })
            })?;
        }
        let mut report = RunReport::new(done, step, self.time);
        report.ended = ended;
        Ok(report)
    }
    fn output(&self) -> Option<&dyn ModelOutput> {
        Some(self)
    }
    fn stateful(&mut self) -> Option<&mut dyn StatefulModel> {
        Some(self)
    }
    fn frequencies(&mut self) -> Option<&mut dyn ModelFrequencies> {
        Some(self)
    }
}

impl ModelOutput for NaiveModel {
    fn mass(&self, node: u32) -> f64 {
        self.own_mass[node as usize]
    }
    fn joints(&self) -> Vec<JointView<'_>> {
        let all = self.constraints.iter();
        let jointed = all.filter_map(|(constraint, _)| constraint.jointed());
        jointed.flat_map(|jointed| jointed.joints()).collect()
    }
    fn stress_changes(&self) -> Vec<Stress> {
        let mut all = vec![Stress::default(); self.mesh.element_count()];
        for block in &self.blocks {
            let mut own = vec![Stress::default(); block.elements().len()];
            let displacement = of_block(block.as_ref(), &self.displacement);
            block.add_stress(NodalView::F64(&displacement), &mut own);
            for (&element, stress) in block.elements().iter().zip(own) {
                all[element as usize] = stress;
            }
        }
        all
    }
    fn hourglass_shares(&self) -> Vec<HourglassShare> {
        Vec::new()
    }
}

impl StatefulModel for NaiveModel {
    fn steps_taken(&self) -> u64 {
        self.number
    }
    fn state(&mut self) -> State {
        let mut state = State::at_rest(self.nodes.len());
        (state.time, state.step) = (self.time, self.number);
        state.displacement.clone_from(&self.displacement);
        state.velocity.clone_from(&self.velocity);
        state
    }
    fn set_state(&mut self, state: &State) -> Result<(), ModelError> {
        if !(state.history.is_empty() && state.joints.is_empty() && state.initial_stress.is_empty())
        {
            return Err(ModelError::refused(
                "naive",
                "no states with stresses or joints",
            ));
        }
        (self.time, self.number) = (state.time, state.step);
        self.displacement.clone_from(&state.displacement);
        self.velocity.clone_from(&state.velocity);
        Ok(())
    }
    fn renew_joint(&mut self, joint: &str, renewal: Renewal) -> bool {
        let displacement = &self.displacement;
        self.constraints.iter_mut().any(|(constraint, _)| {
            let nodes = constraint.nodes().iter();
            let own: Vec<Vec3> = nodes.map(|&n| displacement[n as usize]).collect();
            let jointed = constraint.jointed_mut();
            jointed.is_some_and(|jointed| jointed.renew(joint, renewal, &own))
        })
    }
}

impl ModelFrequencies for NaiveModel {
    fn frequency_limits(&mut self) -> FrequencyLimits {
        let bounds = self
            .blocks
            .iter()
            .flat_map(|block| block.frequency_bounds());
        FrequencyLimits::undamped(bounds.map(|bound| bound.frequency).fold(0.0, f64::max))
    }
}
