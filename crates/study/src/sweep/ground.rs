//! What the ground alone would do where a scene records relative displacements.

use std::cell::RefCell;
use std::collections::BTreeMap;

use powerhouse::Scene;
use powerhouse::engine::observe::{History, Motion};
use powerhouse::model::{Cadence, FieldMotion, ModelError, Observer, StepView, Stress, Vec3};

use super::outcome::{Peak, displacement_peaks};
use crate::StudyError;

/// No more samples than this of a history, however closely a scene asks for them.
const MOST_SAMPLES: f64 = 1e5;

/// A step of ground that moves as the waves that come in; it takes down which nodes are asked for.
struct Ground {
    nodes: usize,
    time: f64,
    displacement: RefCell<BTreeMap<u32, Vec3>>,
}

impl StepView for Ground {
    fn number(&self) -> u64 {
        0
    }
    fn time(&self) -> f64 {
        self.time
    }
    fn step(&self) -> f64 {
        0.0
    }
    fn node_count(&self) -> usize {
        self.nodes
    }
    fn displacement(&self, node: u32) -> Vec3 {
        *self.displacement.borrow_mut().entry(node).or_default()
    }
    fn velocity(&self, _node: u32) -> Vec3 {
        Vec3::zeros()
    }
    fn acceleration(&self, _node: u32) -> Vec3 {
        Vec3::zeros()
    }
    fn stress(&self, _element: u32) -> Stress {
        Stress::default()
    }
    fn energies(&self) -> &[(&'static str, f64)] {
        &[]
    }
}

/// The greatest relative displacements (m) of ground without any structure, by the names under which the
/// scene records those of its own; none if no waves come in, or if their field does not reach all the
/// places.
pub(super) fn relative_peaks(scene: &Scene) -> Result<Vec<Peak>, StudyError> {
    let (plan, mesh) = (scene.output(), scene.mesh());
    let Some(field) = scene.field().filter(|_| !plan.relative.is_empty()) else {
        return Ok(Vec::new());
    };
    let every = plan.every.max(scene.duration() / MOST_SAMPLES);
    let history = || {
        let mut builder = History::builder(Cadence::Seconds(plan.every));
        for wish in &plan.relative {
            let (from, at) = (wish.from.clone(), wish.at.clone());
            builder = builder.relative(&wish.name, from, at, Motion::DISPLACEMENT);
        }
        builder.build(mesh).map_err(refused)
    };
    let mut ground = Ground {
        nodes: mesh.node_count(),
        time: scene.start_time(),
        displacement: RefCell::default(),
    };
    // Only to learn which nodes the places stand for.
    history()?.observe(&ground).map_err(refused)?;
    let asked = ground.displacement.get_mut().keys();
    let positions: Vec<Vec3> = asked.map(|&node| mesh.positions()[node as usize]).collect();
    let Ok(sampler) = field.prepare(&positions) else {
        return Ok(Vec::new());
    };
    let mut history = history()?;
    let recording = history.recording();
    let count = (scene.duration() / every).ceil() as u64;
    let mut motion = Vec::new();
    for sample in 0..=count {
        ground.time = scene.start_time() + sample as f64 * every;
        motion.clear();
        motion.resize(positions.len(), FieldMotion::default());
        sampler.add_motion(ground.time, &mut motion);
        let nodes = ground.displacement.get_mut().values_mut();
        for (node, motion) in nodes.zip(&motion) {
            *node = motion.displacement;
        }
        history.observe(&ground).map_err(refused)?;
    }
    Ok(recording.read(displacement_peaks))
}

fn refused(error: impl Into<ModelError>) -> StudyError {
    powerhouse::Error::Model(error.into()).into()
}
