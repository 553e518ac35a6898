//! A scene while it is composed from its file.

use core::ops::{Deref, DerefMut};

use powerhouse_scene::Scene;
use powerhouse_wavefield::KnownLayeredWaves;

use crate::CheckpointPlan;
use crate::spans::SceneSpans;

/// A scene while it is composed, with the byte ranges of its values and what its file asks of a run.
pub(crate) struct Draft {
    pub(crate) scene: Scene,
    pub(crate) places: SceneSpans,
    pub(crate) self_check: Option<f64>,
    pub(crate) checkpoints: CheckpointPlan,
    /// Waves of other scenes, whose tables waves in layered ground share.
    pub(crate) known_waves: KnownLayeredWaves,
}

impl Draft {
    pub(crate) fn new(scene: Scene, known_waves: KnownLayeredWaves) -> Self {
        Self {
            scene,
            places: SceneSpans::default(),
            self_check: None,
            checkpoints: CheckpointPlan::default(),
            known_waves,
        }
    }
    /// The draft with another scene, made of its own.
    pub(crate) fn change<E>(
        self,
        change: impl FnOnce(Scene) -> Result<Scene, E>,
    ) -> Result<Self, E> {
        let scene = change(self.scene)?;
        Ok(Self { scene, ..self })
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
