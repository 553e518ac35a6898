//! Construction stages of a scene.

use std::sync::Arc;

use powerhouse_model::{NodalLoad, Renewal, StaticOptions, Support, TimeFunction, Vec3};

use powerhouse_elements::Drainage;

use super::StageWater;
use crate::acting::{SharedFunction, StagedLoad};
use crate::joint::Closing;
use powerhouse_laws::Material;

/// Construction stage: changes of the model, followed by the computation of static equilibrium.
///
/// Excavated and cast sets, loads (except temporary ones) and bolts persist in later stages and in the dynamic run.
/// Materials and supports of a stage persist in later stages until the dynamic run starts: then parts have their own
/// material, and the reactions of the supports are kept as nodal forces; the absorbing boundary takes their place.
/// Supports, prescribed motions, loads and weights of the scene itself act in all stages, with their values at the start
/// of the run.
///
/// ```
/// use powerhouse_scene::SceneStage;
/// use powerhouse_model::{StaticOptions, Support};
/// use powerhouse_model::Vec3;
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
    #[doc(hidden)]
    pub loads: Vec<StagedLoad>,
    #[doc(hidden)]
    pub weights: Vec<(Vec3, SharedFunction)>,
    pub(crate) bolts: Vec<String>,
    pub(crate) tied: Vec<String>,
    pub(crate) bonded: Vec<String>,
    pub(crate) water: Vec<StageWater>,
    pub(crate) drainage: Drainage,
    pub(crate) options: StaticOptions,
}

impl SceneStage {
    /// Stage without changes: static equilibrium under the applied loads.
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
            water: Vec::new(),
            drainage: Drainage::Drained,
            options: StaticOptions::default(),
        }
    }
    /// Name of the stage.
    pub fn name(&self) -> &str {
        &self.name
    }
    /// Excavates (deactivates) an element set.
    #[must_use]
    pub fn excavate<N: Into<String>>(mut self, set: N) -> Self {
        self.excavated.push(set.into());
        self
    }
    /// Casts (activates) an element set without stress in the deformed body. A set that is cast without having been
    /// excavated before is inactive until this stage. A part that is cast as a whole has its own material from then on.
    #[must_use]
    pub fn cast<N: Into<String>>(mut self, set: N) -> Self {
        self.cast.push(set.into());
        self
    }
    /// Sets a temporary, undamped material of a part, until a later stage casts the part or sets another material, or
    /// the dynamic run starts.
    #[must_use]
    pub fn part(mut self, set: impl Into<String>, material: Material) -> Self {
        self.parts.push((set.into(), material));
        self
    }
    /// Adds a support that acts in this stage and later ones, until the dynamic run starts; then its reactions are kept as
    /// nodal forces.
    #[must_use]
    pub fn support(mut self, support: Support) -> Self {
        self.supports.push(support);
        self
    }
    /// Adds a permanent load: in this stage and later ones with its value at the start of the run, in the dynamic run as a
    /// function of time.
    #[must_use]
    pub fn load(mut self, load: impl NodalLoad + 'static) -> Self {
        self.loads.push(StagedLoad::new(Box::new(load), None));
        self
    }
    /// Adds a temporary load that acts from this stage on until a later stage, given by name, removes it. Its removal is
    /// applied in the increments of that stage, multiplied by the release factor. It does not act in the dynamic run.
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
    /// Adds gravity: an acceleration of all masses (m/s2), multiplied by a function of time; in this stage and later ones
    /// by its value at the start of the run, and in the dynamic run.
    #[must_use]
    pub fn gravity(mut self, acceleration: Vec3, history: impl TimeFunction + 'static) -> Self {
        self.weights.push((acceleration, Arc::new(history)));
        self
    }
    /// Installs a bolt group of the scene, by name, in the deformed body: it stays in later stages and in the dynamic run.
    #[must_use]
    pub fn install<N: Into<String>>(mut self, bolts: N) -> Self {
        self.bolts.push(bolts.into());
        self
    }
    /// Ties a joint, by name, in this stage alone: no relative displacement, whatever its law. In the next stage that
    /// does not tie it, or in the dynamic run, it is re-initialised in its current position: as defined, including its
    /// gap, or as grouted if an earlier stage grouted it.
    #[must_use]
    pub fn tie<N: Into<String>>(mut self, joint: N) -> Self {
        self.tied.push(joint.into());
        self
    }
    /// Grouts a joint, by name, at the start of the stage: gaps are filled in the current position, and the joint is
    /// re-initialised closed, with the bond of its law everywhere. Opening, slip and energies are counted from there.
    #[must_use]
    pub fn bond<N: Into<String>>(mut self, joint: N) -> Self {
        self.bonded.push(joint.into());
        self
    }
    /// Sets a water level of ground with water in its pores, in this stage, later ones and the dynamic run: the change of its
    /// pressure loads the ground.
    #[must_use]
    pub fn water(mut self, water: StageWater) -> Self {
        self.water.push(water);
        self
    }
    /// Keeps the water in pores from flowing in this stage: it takes part in what the stage changes, and its pressure rises with the
    /// decrease of volume since the last drained stage. In the next drained stage that pressure is gone.
    #[must_use]
    pub fn undrained(mut self) -> Self {
        self.drainage = Drainage::Undrained;
        self
    }
    /// Closing condition of a joint in this stage.
    pub(crate) fn closing(&self, joint: &str) -> Closing {
        if self.ties(joint) {
            Closing::Tied
        } else {
            Closing::Own
        }
    }
    /// Returns whether the stage ties a joint.
    fn ties(&self, joint: &str) -> bool {
        self.tied.iter().any(|name| name == joint)
    }
    /// Sets the options of the static analysis: method, tolerance, increments and release factor.
    #[must_use]
    pub fn with_options(mut self, options: StaticOptions) -> Self {
        self.options = options;
        self
    }
}

/// Last re-initialisation of a joint: name of the stage (`None` for the start of the dynamic run), and its type.
pub(crate) fn last_renewal<'s>(
    stages: &'s [SceneStage],
    joint: &str,
) -> Option<(Option<&'s str>, Renewal)> {
    let indices = (0..=stages.len()).rev();
    let mut found = indices.filter_map(|index| Some((index, renewal(stages, index, joint)?)));
    let (index, how) = found.next()?;
    Some((stages.get(index).map(SceneStage::name), how))
}

/// Re-initialisation of a joint in the stage of an index, or, for an index past the last stage, at the start of the
/// dynamic run; `None` if it continues.
pub(crate) fn renewal(stages: &[SceneStage], index: usize, joint: &str) -> Option<Renewal> {
    let (before, stage) = (&stages[..index], stages.get(index));
    let grouts = |stage: &SceneStage| stage.bonded.iter().any(|name| name == joint);
    let was_tied = before.last().is_some_and(|stage| stage.ties(joint));
    let is_tied = stage.is_some_and(|stage| stage.ties(joint));
    if stage.is_some_and(grouts) || (is_tied && !was_tied) {
        return Some(Renewal::Grouted);
    }
    (was_tied && !is_tied).then(|| {
        if before.iter().any(grouts) {
            Renewal::Grouted
        } else {
            Renewal::Released
        }
    })
}
