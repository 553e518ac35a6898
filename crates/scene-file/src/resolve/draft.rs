//! A scene while it is composed from its file.

use core::ops::{Deref, DerefMut};

use powerhouse_scene::Scene;

use crate::CheckpointPlan;
use crate::spans::SceneSpans;

/// A scene while it is composed, with the byte ranges of its values and what its file asks of a run.
pub(crate) struct Draft {
    pub(crate) scene: Scene,
    pub(crate) places: SceneSpans,
    pub(crate) self_check: Option<f64>,
    pub(crate) checkpoints: CheckpointPlan,
}

impl Draft {
    pub(crate) fn new(scene: Scene) -> Self {
        Self {
            scene,
            places: SceneSpans::default(),
            self_check: None,
            checkpoints: CheckpointPlan::default(),
        }
    }
    /// The draft with another scene, made of its own.
    pub(crate) fn change<E>(
        self,
        change: impl FnOnce(Scene) -> Result<Scene, E>,
    ) -> Result<Self, E> {
        let Self {
            scene,
            places,
            self_check,
            checkpoints,
        } = self;
        Ok(Self {
            scene: change(scene)?,
            places,
            self_check,
            checkpoints,
        })
    }
}

impl Deref for Draft {
    type Target = Scene;
    fn deref(&self) -> &Scene {
        &self.scene
    }
}

impl DerefMut for Draft {
    fn deref_mut(&mut self) -> &mut Scene {
        &mut self.scene
    }
}
