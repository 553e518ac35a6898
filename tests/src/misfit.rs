//! Error of a run against an exact field.

use std::sync::{Arc, Mutex};

use powerhouse::engine::{Leapfrog, Model, run};
use powerhouse_model::{
    Cadence, FieldMotion, FieldSampler, Fields, Flow, IncidentField, ModelError, Observer,
    RunOptions, StepView, Vec3,
};

/// Sums of the squared difference and of the squared field over nodes and steps.
#[derive(Clone, Copy, Default)]
struct Sums {
    difference: f64,
    field: f64,
}

/// Observer that compares the displacement of all nodes with a field.
struct Comparison {
    sampler: Box<dyn FieldSampler>,
    motion: Vec<FieldMotion>,
    sums: Arc<Mutex<Sums>>,
}

impl Observer for Comparison {
    fn name(&self) -> &str {
        "comparison"
    }
    fn fields(&self) -> Fields {
        Fields::default()
    }
    fn cadence(&self) -> Cadence {
        Cadence::Steps(4)
    }
    fn observe(&mut self, view: &dyn StepView) -> Result<Flow, ModelError> {
        self.motion.fill(FieldMotion::default());
        self.sampler.add_motion(view.time(), &mut self.motion);
        let mut sums = self
            .sums
            .lock()
            .map_err(|e| ModelError::refused("comparison", e.to_string()))?;
        for (node, motion) in self.motion.iter().enumerate() {
            let found = view.displacement(node as u32);
            sums.difference += (found - motion.displacement).norm_squared();
            sums.field += motion.displacement.norm_squared();
        }
        Ok(Flow::Continue)
    }
}

/// Runs a model for a duration (s) with its stable step; returns the relative L2 error of the displacement of
/// all nodes against a field.
///
/// # Panics
/// If the run fails.
pub fn field_misfit(model: &mut Model, field: &dyn IncidentField, duration: f64) -> f64 {
    let positions = model.mesh().positions().to_vec();
    let sums = Arc::new(Mutex::new(Sums::default()));
    let comparison = Comparison {
        sampler: field.prepare(&positions).expect("points in the field"),
        motion: vec![FieldMotion::default(); positions.len()],
        sums: sums.clone(),
    };
    let options = RunOptions::seconds(duration);
    run(
        model,
        &Leapfrog,
        &options,
        &mut [Box::new(comparison)],
        &mut |_| {},
    )
    .expect("a run");
    let sums = *sums.lock().expect("the sums of the run");
    (sums.difference / sums.field).sqrt()
}

/// Time (s) and displacement (m) of a node.
type Motion = Vec<(f64, Vec3)>;

/// Observer that records the displacement of one node at every step.
struct Probe {
    node: u32,
    motion: Arc<Mutex<Motion>>,
}

impl Observer for Probe {
    fn name(&self) -> &str {
        "probe"
    }
    fn fields(&self) -> Fields {
        Fields::default()
    }
    fn cadence(&self) -> Cadence {
        Cadence::Steps(1)
    }
    fn observe(&mut self, view: &dyn StepView) -> Result<Flow, ModelError> {
        let mut motion = self
            .motion
            .lock()
            .map_err(|e| ModelError::refused("probe", e.to_string()))?;
        motion.push((view.time(), view.displacement(self.node)));
        Ok(Flow::Continue)
    }
}

/// Runs a model for a duration (s) with its stable step; returns time (s) and displacement (m) of a node at
/// every step.
///
/// # Panics
/// If the run fails.
pub fn motion_at(model: &mut Model, node: u32, duration: f64) -> Vec<(f64, Vec3)> {
    let motion = Arc::new(Mutex::new(Vec::new()));
    let probe = Probe {
        node,
        motion: motion.clone(),
    };
    let options = RunOptions::seconds(duration);
    run(
        model,
        &Leapfrog,
        &options,
        &mut [Box::new(probe)],
        &mut |_| {},
    )
    .expect("a run");
    let motion = motion.lock().expect("the motion of the run");
    motion.clone()
}
