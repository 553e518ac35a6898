//! Loads and functions of time that are shared by the static and dynamic models of a scene.

use std::sync::{Arc, Mutex, PoisonError};

use powerhouse_model::{NodalLoad, StateError, TimeFunction, Vec3};

/// Acceleration of gravity (m/s2) unless a scene gives another.
pub const GRAVITY: f64 = 9.81;

/// Function of time shared by several models.
pub type SharedFunction = Arc<dyn TimeFunction>;

/// Function of time for another model: unchanged, or constant with its value at a time (s).
pub(crate) fn function(shared: &SharedFunction, held_at: Option<f64>) -> Box<dyn TimeFunction> {
    Box::new(Shared {
        function: shared.clone(),
        held_at,
    })
}

struct Shared {
    function: SharedFunction,
    held_at: Option<f64>,
}

impl TimeFunction for Shared {
    fn value(&self, time: f64) -> f64 {
        self.function.value(self.held_at.unwrap_or(time))
    }
    fn is_constant(&self) -> bool {
        self.held_at.is_some() || self.function.is_constant()
    }
}

/// Load with the name of the stage that removes it, if any.
pub struct StagedLoad {
    /// The load.
    pub load: SharedLoad,
    /// Name of the stage that removes it; none for a load that stays.
    pub removed_in: Option<String>,
}

impl StagedLoad {
    /// Load that acts until a stage removes it.
    pub fn new(load: Box<dyn NodalLoad>, removed_in: Option<String>) -> Self {
        Self {
            load: SharedLoad::new(load),
            removed_in,
        }
    }
}

/// Load shared by several models.
#[derive(Clone)]
pub struct SharedLoad {
    name: Arc<str>,
    nodes: Arc<[u32]>,
    load: Arc<Mutex<Box<dyn NodalLoad>>>,
    constant: bool,
    held_at: Option<f64>,
}

impl SharedLoad {
    /// Load that acts until a stage removes it.
    pub fn new(load: Box<dyn NodalLoad>) -> Self {
        Self {
            name: load.name().into(),
            nodes: load.nodes().into(),
            constant: load.is_constant(),
            load: Arc::new(Mutex::new(load)),
            held_at: None,
        }
    }
    /// Load for another model: unchanged, or constant with its forces at a time (s).
    pub fn held(&self, at: Option<f64>) -> Box<dyn NodalLoad> {
        Box::new(Self {
            held_at: at,
            ..self.clone()
        })
    }
}

impl NodalLoad for SharedLoad {
    fn name(&self) -> &str {
        &self.name
    }
    fn nodes(&self) -> &[u32] {
        &self.nodes
    }
    fn add_forces(&mut self, time: f64, forces: &mut [Vec3]) {
        // A load that panicked in another run is used nevertheless: that run has ended.
        let mut load = self.load.lock().unwrap_or_else(PoisonError::into_inner);
        load.add_forces(self.held_at.unwrap_or(time), forces);
    }
    fn is_constant(&self) -> bool {
        self.constant || self.held_at.is_some()
    }
    fn save_state(&self) -> Result<Vec<u8>, StateError> {
        let load = self.load.lock().unwrap_or_else(PoisonError::into_inner);
        load.save_state()
    }
    fn restore_state(&mut self, saved: &[u8]) -> Result<(), StateError> {
        let mut load = self.load.lock().unwrap_or_else(PoisonError::into_inner);
        load.restore_state(saved)
    }
}
