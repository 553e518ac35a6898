//! A column of elements with transverse joints, for the examples of joints.

use std::error::Error;
use std::sync::{Arc, Mutex};

use powerhouse::contact::{JointSurface, SurfaceOptions};
use powerhouse::engine::{
    BlockOptions, EnergyCheck, Hex8OnePoint, Leapfrog, Model, ModelSpec, RunOptions, RunReport,
    SolidKernel, StepChoice, Support, run,
};
use powerhouse::material::LinearElastic;
use powerhouse::model::{
    Cadence, ElasticMedium, Fields, Flow, JointRecord, Mesh, ModelError, Observer, StepView, Vec3,
};

/// Column of elements of 1 m by 1 m from z = 0 upwards, split by joints between its parts.
pub struct Column {
    /// Split mesh.
    pub mesh: Mesh,
    /// Surfaces of the joints, from below.
    pub joints: Vec<JointSurface>,
    /// Element sets between the joints, with their media.
    pub parts: Vec<(String, ElasticMedium)>,
}

impl Column {
    /// Builds the column from its parts (number of elements and medium), from below, with elements of one height (m).
    ///
    /// # Errors
    /// Invalid numbers or heights of elements.
    pub fn new(parts: &[(usize, ElasticMedium)], brick: f64) -> Result<Self, Box<dyn Error>> {
        let count: usize = parts.iter().map(|(bricks, _)| bricks).sum();
        let size = Vec3::new(1.0, 1.0, brick * count as f64);
        let mut mesh = Mesh::box_of_hexes(Vec3::zeros(), size, [1, 1, count], "all")?;
        let (mut start, mut named) = (0, Vec::new());
        for (place, (bricks, medium)) in parts.iter().enumerate() {
            let name = format!("part {place}");
            mesh.set_element_set(&name, (start..start + *bricks as u32).collect())?;
            named.push((name, *medium));
            start += *bricks as u32;
        }
        let mut joints = Vec::new();
        let options = SurfaceOptions::within(1e-6)?;
        for pair in named.windows(2) {
            let [below, above] = [0, 1].map(|part| mesh.element_set(&pair[part].0));
            let split = mesh.split_between(below?, above?)?;
            mesh = split.mesh;
            joints.push(JointSurface::between(
                &mesh,
                &split.first,
                &split.second,
                &options,
            )?);
        }
        Ok(Self {
            mesh,
            joints,
            parts: named,
        })
    }

    /// The four nodes at a height (m), below the joint if there is one.
    pub fn level(&self, z: f64) -> Vec<u32> {
        let (low, high) = (
            Vec3::new(-1.0, -1.0, z - 1e-6),
            Vec3::new(2.0, 2.0, z + 1e-6),
        );
        let mut nodes = self.mesh.nodes_in_box(&low, &high);
        nodes.truncate(4);
        nodes
    }

    /// A model builder whose nodes move along one axis only.
    pub fn along(&self, axis: usize) -> ModelSpec<'_> {
        let kernel = SolidKernel::Hex8OnePoint(Hex8OnePoint::default());
        let mut builder = Model::builder(&self.mesh);
        for (name, medium) in &self.parts {
            let law = LinearElastic::new(*medium);
            let factory = kernel.factory(name, law, BlockOptions::default());
            builder = builder.elements(name.as_str(), factory);
        }
        for other in (0..3).filter(|&other| other != axis) {
            let all = (0..self.mesh.node_count() as u32).collect();
            builder = builder.support(Support::roller(all, Vec3::ith(other, 1.0)));
        }
        builder
    }
}

/// Samples of a run at every step.
#[derive(Clone, Debug, Default)]
pub struct Seen {
    /// Times (s).
    pub times: Vec<f64>,
    /// Velocity histories (m/s) of the recorded nodes.
    pub velocity: Vec<Vec<Vec3>>,
    /// Contact states of the node pairs of all joints, joint by joint.
    pub pairs: Vec<Vec<JointRecord>>,
}

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
        let seen = self.seen.lock();
        let mut seen = seen.map_err(|error| ModelError::refused("watch", error.to_string()))?;
        seen.times.push(view.time());
        seen.velocity.resize(self.nodes.len(), Vec::new());
        for (velocity, &node) in seen.velocity.iter_mut().zip(&self.nodes) {
            velocity.push(view.velocity(node));
        }
        let joints = view.joints();
        let pairs = joints.iter().flat_map(|joint| joint.records.to_vec());
        seen.pairs.push(pairs.collect());
        Ok(Flow::Continue)
    }
}

/// Runs a model for a duration (s) with a step (s), records several nodes and checks the energy balance.
///
/// # Errors
/// Any error of the run.
pub fn watch(
    model: &mut Model,
    nodes: &[u32],
    (duration, step): (f64, f64),
) -> Result<(Seen, RunReport), Box<dyn Error>> {
    let seen = Arc::new(Mutex::new(Seen::default()));
    let watch = Watch {
        nodes: nodes.to_vec(),
        seen: seen.clone(),
    };
    let options = RunOptions::seconds(duration)
        .with_step(StepChoice::Fixed(step))
        .with_energy(EnergyCheck::every(50));
    let report = run(
        model,
        &Leapfrog,
        &options,
        &mut [Box::new(watch)],
        &mut |_| {},
    )?;
    let seen = seen.lock().map_err(|error| error.to_string())?.clone();
    Ok((seen, report))
}

/// The largest stable step (s) that divides a duration (s) evenly.
///
/// # Errors
/// A model without a stable step.
pub fn even_step(model: &mut Model, time: f64) -> Result<f64, Box<dyn Error>> {
    let stable = model.stable_step(&Leapfrog)?.step;
    Ok(time / (time / stable).ceil())
}
