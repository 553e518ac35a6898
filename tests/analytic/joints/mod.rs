//! Joints in columns of bricks, against closed forms.

mod at_rest;
mod bars;
mod block;
mod bonded;
mod crack;
mod delamination;
mod dilatant;
mod friction;
mod rate_and_state;

use std::sync::{Arc, Mutex};

use powerhouse::engine::{Leapfrog, Model, run};
use powerhouse_contact::{JointSurface, SurfaceOptions};
use powerhouse_elements::{NodalForce, SolidKernel};
use powerhouse_model::{
    BoundaryParts, Cadence, ElasticMedium, Fields, Flow, JointRecord, Mat3, Mesh, ModelError,
    ModelSpec, NodalImpedance, Observer, RunOptions, RunReport, StepChoice, StepView, Support,
    Vec3,
};
use powerhouse_tests::elastic;

/// A column of bricks, one metre square, from z = 0 up; it is cut open at some of its levels.
pub(crate) struct Column {
    pub(crate) mesh: Mesh,
    /// The cuts, upwards.
    pub(crate) surfaces: Vec<JointSurface>,
    /// The sets between the cuts and what they are made of.
    parts: Vec<(String, ElasticMedium)>,
    height: f64,
}

impl Column {
    /// A column of parts (number of bricks and medium), from below, of bricks of a given height
    /// (m); every part is cut from the next one.
    pub(crate) fn new(parts: &[(usize, ElasticMedium)], brick: f64) -> Self {
        let count: usize = parts.iter().map(|(bricks, _)| bricks).sum();
        let size = Vec3::new(1.0, 1.0, brick * count as f64);
        let mut mesh = Mesh::box_of_hexes(Vec3::zeros(), size, [1, 1, count], "all").unwrap();
        let (mut start, mut named) = (0, Vec::new());
        for (place, (bricks, medium)) in parts.iter().enumerate() {
            let name = format!("part {place}");
            let elements = (start..start + *bricks as u32).collect();
            mesh.set_element_set(&name, elements).unwrap();
            named.push((name, *medium));
            start += *bricks as u32;
        }
        let options = SurfaceOptions::within(1e-6).unwrap();
        let mut cuts = Vec::new();
        for pair in named.windows(2) {
            let set = |part: usize| mesh.element_set(&pair[part].0).unwrap().to_vec();
            let split = mesh.split_between(&set(0), &set(1)).unwrap();
            mesh = split.mesh;
            cuts.push((split.first, split.second));
        }
        let surface = |(a, b): &(Vec<_>, Vec<_>)| JointSurface::between(&mesh, a, b, &options);
        Self {
            surfaces: cuts.iter().map(|cut| surface(cut).unwrap()).collect(),
            mesh,
            parts: named,
            height: size.z,
        }
    }

    /// Nodes at a level (m), those of the lower side of a cut only.
    pub(crate) fn level(&self, z: f64) -> Vec<u32> {
        let tolerance = 1e-6;
        let low = Vec3::new(-1.0, -1.0, z - tolerance);
        let mut nodes = self
            .mesh
            .nodes_in_box(&low, &Vec3::new(2.0, 2.0, z + tolerance));
        nodes.truncate(4);
        nodes
    }

    /// A model in the making whose nodes move along one axis alone.
    pub(crate) fn along(&self, axis: usize) -> ModelSpec<'_> {
        let kernel = SolidKernel::Hex8OnePoint(Default::default());
        let mut builder = Model::builder(&self.mesh).threads(1);
        for (name, medium) in &self.parts {
            let factory = elastic(name, kernel, *medium, Default::default());
            builder = builder.elements(name.as_str(), factory);
        }
        for other in (0..3).filter(|&other| other != axis) {
            let all = (0..self.mesh.node_count() as u32).collect();
            builder = builder.support(Support::roller(all, Vec3::ith(other, 1.0)));
        }
        builder
    }

    /// Dashpots of an impedance (Pa s/m) at both ends, and a wave of particle velocity `wave` (m/s,
    /// by time in s) along an axis that enters at the foot; the media are those of the ends.
    pub(crate) fn open<'a>(
        &self,
        builder: ModelSpec<'a>,
        axis: usize,
        impedance: [f64; 2],
        wave: impl Fn(f64) -> f64 + Send + Sync + 'static,
    ) -> ModelSpec<'a> {
        let mut parts = BoundaryParts::default();
        for (level, impedance) in [0.0, self.height].into_iter().zip(impedance) {
            let dashpot = Mat3::identity() * (impedance / 4.0);
            parts.impedance.extend(
                self.level(level)
                    .into_iter()
                    .map(|node| NodalImpedance::new(node, Mat3::zeros(), dashpot)),
            );
        }
        let force = Vec3::ith(axis, 2.0 * impedance[0] / 4.0);
        let input = NodalForce::new(self.level(0.0), force, Box::new(wave));
        builder.boundary(parts).load(Box::new(input))
    }
}

/// What was seen at every step.
#[derive(Clone, Debug, Default)]
pub(crate) struct Seen {
    pub(crate) times: Vec<f64>,
    /// Velocity (m/s) of each node watched, step by step.
    pub(crate) velocity: Vec<Vec<Vec3>>,
    /// Records of all joints in a row, step by step.
    pub(crate) records: Vec<Vec<JointRecord>>,
}

/// Watches some nodes and all joints.
struct Watch {
    nodes: Vec<u32>,
    seen: Arc<Mutex<Seen>>,
}

impl Observer for Watch {
    fn name(&self) -> &str {
        "watch"
    }
    fn fields(&self) -> Fields {
        Fields::default()
    }
    fn cadence(&self) -> Cadence {
        Cadence::Steps(1)
    }
    fn observe(&mut self, view: &dyn StepView) -> Result<Flow, ModelError> {
        let mut seen = self.seen.lock().expect("one thread");
        seen.times.push(view.time());
        seen.velocity.resize(self.nodes.len(), Vec::new());
        for (of_node, &node) in seen.velocity.iter_mut().zip(&self.nodes) {
            of_node.push(view.velocity(node));
        }
        let joints = view.joints();
        seen.records.push(
            joints
                .iter()
                .flat_map(|joint| joint.records.to_vec())
                .collect(),
        );
        Ok(Flow::Continue)
    }
}

/// Runs a model for some time (s) at a step (s), watching nodes.
pub(crate) fn watched(
    model: &mut Model,
    nodes: &[u32],
    (duration, step): (f64, f64),
) -> (Seen, RunReport) {
    let seen = Arc::new(Mutex::new(Seen::default()));
    let watch = Watch {
        nodes: nodes.to_vec(),
        seen: seen.clone(),
    };
    let options = RunOptions::seconds(duration)
        .with_step(StepChoice::Fixed(step))
        .with_energy(powerhouse_model::EnergyCheck::every(50));
    let report = run(
        model,
        &Leapfrog,
        &options,
        &mut [Box::new(watch)],
        &mut |_| {},
    )
    .unwrap();
    let seen = seen.lock().expect("one thread").clone();
    (seen, report)
}

/// The part of the stable step (s) that divides a time (s) evenly.
pub(crate) fn even_step(model: &mut Model, time: f64) -> f64 {
    let stable = model.stable_step(&Leapfrog).unwrap().step;
    time / (time / stable).ceil()
}
