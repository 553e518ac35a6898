//! A stage of a scene.

use std::sync::Arc;

use powerhouse_explicit_core::{StaticOptions, Support};
use powerhouse_model::{NodalLoad, Renewal, TimeFunction, Vec3};

use crate::Material;
use crate::acting::{SharedFunction, StagedLoad};
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
///         .with_options(StaticOptions::default().with_increments(4).with_release(0.6)),
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
    pub(crate) loads: Vec<StagedLoad>,
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
        self.loads.push(StagedLoad::new(Box::new(load), None));
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
        (self.loads).push(StagedLoad::new(Box::new(load), removed_in));
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
    /// In the next stage that does not, or when the body moves, it starts anew from where it stands then:
    /// as it was given, its gap included, or as after grouting if an earlier stage grouted it.
    #[must_use]
    pub fn tie(mut self, joint: impl Into<String>) -> Self {
        self.tied.push(joint.into());
        self
    }
    /// Grouts a joint, by name, before the stage comes to rest: whatever gap it has is filled and where it
    /// slid it stays; it starts anew from there, closed and with the bond that its law gives it
    /// everywhere. Its opening, slip and energies count from there.
    #[must_use]
    pub fn bond(mut self, joint: impl Into<String>) -> Self {
        self.bonded.push(joint.into());
        self
    }
    /// How it closes a joint.
    pub(crate) fn closing(&self, joint: &str) -> Closing {
        match self.ties(joint) {
            true => Closing::Tied,
            false => Closing::Own,
        }
    }
    /// Whether it ties a joint.
    fn ties(&self, joint: &str) -> bool {
        self.tied.iter().any(|name| name == joint)
    }
    /// Sets how the body is brought to rest: gate, increments, and the share of what is out of
    /// balance that comes.
    #[must_use]
    pub fn with_options(mut self, options: StaticOptions) -> Self {
        self.options = options;
        self
    }
}

/// The last time that a joint of a scene starts anew: the name of the stage, none when the body starts to
/// move, and how.
pub(crate) fn last_renewal<'s>(
    stages: &'s [SceneStage],
    joint: &str,
) -> Option<(Option<&'s str>, Renewal)> {
    let places = (0..=stages.len()).rev();
    let mut found = places.filter_map(|place| Some((place, renewal(stages, place, joint)?)));
    let (place, how) = found.next()?;
    Some((stages.get(place).map(SceneStage::name), how))
}

/// How a joint starts anew, if it does, in the stage of a place, or when the body moves after all of
/// them.
pub(crate) fn renewal(stages: &[SceneStage], place: usize, joint: &str) -> Option<Renewal> {
    let (before, stage) = (&stages[..place], stages.get(place));
    let grouts = |stage: &SceneStage| stage.bonded.iter().any(|name| name == joint);
    let was_tied = before.last().is_some_and(|stage| stage.ties(joint));
    let is_tied = stage.is_some_and(|stage| stage.ties(joint));
    if stage.is_some_and(grouts) || (is_tied && !was_tied) {
        return Some(Renewal::Grouted);
    }
    (was_tied && !is_tied).then(|| match before.iter().any(grouts) {
        true => Renewal::Grouted,
        false => Renewal::Released,
    })
}
