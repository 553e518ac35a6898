//! A stage of a scene.

use std::sync::Arc;

use powerhouse_explicit_core::{StaticOptions, Support};
use powerhouse_model::{NodalLoad, TimeFunction, Vec3};

use crate::Material;
use crate::acting::{Lasting, SharedFunction};
use crate::joint::Closing;

/// What is done to a body before it moves, until it is at rest again.
///
/// A stage tells what changes. Sets that are taken out or put in, loads, bolts and materials stay
/// so in the stages after it and when the body moves, but for temporary loads; its supports hold
/// until the body moves, when their reactions stay on as forces and what absorbs takes their place.
/// Supports, loads and weights of the scene itself act in all stages, with their values at the start
/// of the run.
///
/// ```
/// use powerhouse::SceneStage;
/// use powerhouse::engine::{StaticOptions, Support};
/// use powerhouse::model::Vec3;
/// let bottom = vec![0, 1, 2, 3];
/// let stages = [
///     SceneStage::new("ground").support(Support::roller(bottom, Vec3::z())),
///     SceneStage::new("excavation")
///         .excavate("core")
///         .options(StaticOptions::default().with_increments(4).with_release(0.6)),
///     SceneStage::new("support").cast("lining").install("roof"),
/// ];
/// assert_eq!(stages[2].name(), "support");
/// ```
pub struct SceneStage {
    pub(crate) name: String,
    pub(crate) excavated: Vec<String>,
    pub(crate) cast: Vec<String>,
    pub(crate) parts: Vec<(String, Material)>,
    pub(crate) supports: Vec<Support>,
    pub(crate) loads: Vec<Lasting>,
    pub(crate) weights: Vec<(Vec3, SharedFunction)>,
    pub(crate) bolts: Vec<String>,
    pub(crate) tied: Vec<String>,
    pub(crate) bonded: Vec<String>,
    pub(crate) options: StaticOptions,
}

impl SceneStage {
    /// A stage that changes nothing yet: the body comes to rest under what acts on it.
    pub fn new(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            excavated: Vec::new(),
            cast: Vec::new(),
            parts: Vec::new(),
            supports: Vec::new(),
            loads: Vec::new(),
            weights: Vec::new(),
            bolts: Vec::new(),
            tied: Vec::new(),
            bonded: Vec::new(),
            options: StaticOptions::default(),
        }
    }
    /// The stage's name.
    pub fn name(&self) -> &str {
        &self.name
    }
    /// Takes an element set out.
    #[must_use]
    pub fn excavate(mut self, set: impl Into<String>) -> Self {
        self.excavated.push(set.into());
        self
    }
    /// Puts an element set in, free of stress in the deformed body. What is cast without having been
    /// taken out before is not there until then. A part that is cast as a whole has its own material
    /// from then on.
    #[must_use]
    pub fn cast(mut self, set: impl Into<String>) -> Self {
        self.cast.push(set.into());
        self
    }
    /// Gives a part another material than its own, undamped, until a later stage casts it or says
    /// otherwise, or the body moves.
    #[must_use]
    pub fn part(mut self, set: impl Into<String>, material: Material) -> Self {
        self.parts.push((set.into(), material));
        self
    }
    /// Adds nodes that are held until the body moves.
    #[must_use]
    pub fn support(mut self, support: Support) -> Self {
        self.supports.push(support);
        self
    }
    /// Adds a load that stays for good.
    #[must_use]
    pub fn load(mut self, load: impl NodalLoad + 'static) -> Self {
        self.loads.push(Lasting::new(Box::new(load), None));
        self
    }
    /// Adds a load that a later stage takes off again, by name: what it leaves out of balance comes on the
    /// body in the increments of that stage, and as far as its release says. It is not there when the body
    /// moves.
    #[must_use]
    pub fn temporary_load(
        mut self,
        load: impl NodalLoad + 'static,
        removed_in: impl Into<String>,
    ) -> Self {
        let removed_in = Some(removed_in.into());
        (self.loads).push(Lasting::new(Box::new(load), removed_in));
        self
    }
    /// Adds weight: an acceleration (m/s2) of all masses, times a function of time.
    #[must_use]
    pub fn gravity(mut self, acceleration: Vec3, history: impl TimeFunction + 'static) -> Self {
        self.weights.push((acceleration, Arc::new(history)));
        self
    }
    /// Installs bolts of the scene, by name.
    #[must_use]
    pub fn install(mut self, bolts: impl Into<String>) -> Self {
        self.bolts.push(bolts.into());
        self
    }
    /// Closes a joint, by name, in this stage alone: its sides are one body whatever its law admits.
    /// It starts anew in the next stage that does not.
    #[must_use]
    pub fn tie(mut self, joint: impl Into<String>) -> Self {
        self.tied.push(joint.into());
        self
    }
    /// Lets a joint, by name, start anew, closed and with the bond that its law gives it everywhere, as
    /// after grouting.
    #[must_use]
    pub fn bond(mut self, joint: impl Into<String>) -> Self {
        self.bonded.push(joint.into());
        self
    }
    /// How it closes a joint.
    pub(crate) fn closing(&self, joint: &str) -> Closing {
        let names = |joints: &[String]| joints.iter().any(|name| name == joint);
        if names(&self.tied) {
            Closing::Tied
        } else if names(&self.bonded) {
            Closing::Bonded
        } else {
            Closing::Own
        }
    }
    /// Sets how the body is brought to rest: gate, increments, and the share of what is out of
    /// balance that comes.
    #[must_use]
    pub fn options(mut self, options: StaticOptions) -> Self {
        self.options = options;
        self
    }
}
