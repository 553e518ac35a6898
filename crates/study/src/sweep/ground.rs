//! Relative displacements of the free field, for comparison with those of a scene.

use std::cell::RefCell;
use std::collections::BTreeMap;

use powerhouse::Scene;
use powerhouse::engine::observe::{History, Motion};
use powerhouse::model::{Cadence, FieldMotion, ModelError, Observer, StepView, Stress, Vec3};

use super::outcome::{Peak, displacement_peaks};
use crate::StudyError;

/// Greatest number of samples of a history.
const MOST_SAMPLES: f64 = 1e5;

/// View of a step of the free field; it records which nodes an observer reads.
struct FreeFieldStep {
    nodes: usize,
    time: f64,
    displacement: RefCell<BTreeMap<u32, Vec3>>,
}

impl StepView for FreeFieldStep {
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

/// The greatest relative displacements (m) of the free field at the points of the scene's own requests; empty without
/// an incident field, or if the field is not defined at all points.
pub(super) fn relative_peaks(scene: &Scene) -> Result<Vec<Peak>, StudyError> {
    let (plan, mesh) = (scene.output(), scene.mesh());
    let Some(field) = scene.field().filter(|_| !plan.relative.is_empty()) else {
        return Ok(Vec::new());
    };
    let every = plan.every.max(scene.duration() / MOST_SAMPLES);
    let history = || {
        let mut builder = History::builder(Cadence::Steps(1));
        for request in &plan.relative {
            let (from, at) = (request.from.clone(), request.at.clone());
            builder = builder.relative(&request.name, from, at, Motion::DISPLACEMENT);
        }
        builder.build(mesh).map_err(model_error)
    };
    let mut ground = FreeFieldStep {
        nodes: mesh.node_count(),
        time: scene.start_time(),
        displacement: RefCell::default(),
    };
    // A first step only records which nodes are read.
    history()?.observe(&ground).map_err(model_error)?;
    let read = ground.displacement.get_mut().keys();
    let positions: Vec<Vec3> = read.map(|&node| mesh.positions()[node as usize]).collect();
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
        history.observe(&ground).map_err(model_error)?;
    }
    Ok(recording.read(displacement_peaks))
}

fn model_error(error: impl Into<ModelError>) -> StudyError {
    powerhouse::Error::Model(error.into()).into()
}
