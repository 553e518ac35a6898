//! Active elements, materials, bolts and joints from stage to stage.

use std::collections::{BTreeMap, HashMap, HashSet};

use powerhouse_elements::{BoltSet, Drainage};
use powerhouse_model::{Mesh, Renewal, State};

use super::list::renewal;
use super::water::{PressureChange, WaterAtRest, WaterSoFar, WetElements};
use super::{SceneStage, StagingError};
use crate::joint::{JointWaterLoad, WaterInJoints};
use crate::{Error, InitialMotion, Scene};
use powerhouse_laws::Material;

/// Changes of one stage in terms of mesh indices, and the resulting configuration.
pub(crate) struct Configuration {
    /// Mesh indices of excavated elements, without repetitions.
    pub(crate) excavated: Vec<u32>,
    /// Mesh indices of cast elements, without repetitions.
    pub(crate) cast: Vec<u32>,
    /// Activity of every element of the mesh after the changes.
    pub(crate) present: Vec<bool>,
    /// Temporary materials, by index of the part.
    pub(crate) materials: BTreeMap<usize, Material>,
    /// Installed bolt groups.
    pub(crate) bolts: Vec<BoltSet>,
    /// Re-initialised joints, with the type of re-initialisation.
    pub(crate) renewed: Vec<(String, Renewal)>,
    /// Changes of the pressure of the water in pores.
    pub(crate) pressure_changes: Vec<PressureChange>,
    /// Water in pores after them.
    pub(crate) water: WaterAtRest,
    /// Water in joints after them, and its loads.
    pub(crate) in_joints: WaterInJoints,
    pub(crate) joint_loads: Vec<JointWaterLoad>,
}

/// Sequence of the configurations of all stages of a scene.
pub struct Timeline {
    /// Mesh indices of elements that are inactive before the first stage.
    pub(crate) absent: Vec<u32>,
    /// Configurations, one per stage.
    pub(crate) configurations: Vec<Configuration>,
}

impl Timeline {
    /// Sequence of the stages of a scene; `None` if it has none.
    ///
    /// # Errors
    /// Error of the first invalid stage.
    pub fn of(scene: &Scene) -> Result<Option<Self>, Error> {
        check(scene).map_err(|source| Error::staging(None, source))?;
        if scene.stages.is_empty() {
            return Ok(None);
        }
        let mesh = &*scene.mesh;
        let absent = absent_at_first(mesh, &scene.stages)?;
        let mut found = Progress {
            scene,
            present: vec![true; mesh.element_count()],
            materials: BTreeMap::new(),
            installed: Vec::new(),
            bolted: HashMap::new(),
            water: WaterSoFar::default(),
            in_joints: WaterInJoints::of(scene).map_err(|source| Error::staging(None, source))?,
        };
        for &element in &absent {
            found.present[element as usize] = false;
        }
        let mut configurations = Vec::with_capacity(scene.stages.len());
        for index in 0..scene.stages.len() {
            let refused = |source| Error::staging(Some(&scene.stages[index].name), source);
            configurations.push(
                found
                    .configuration(index)
                    .map_err(|refusal| match refusal {
                        StageFault::Stage(source) => refused(source),
                        StageFault::Whole(error) => error,
                    })?,
            );
        }
        let idle = |bolts: &&crate::SceneBolts| !found.installed.contains(&bolts.name);
        if let Some(bolts) = scene.bolts.iter().find(idle) {
            let name = bolts.name.clone();
            return Err(Error::of_bolts(StagingError::UnusedBolts { name }));
        }
        Ok(Some(Self {
            absent,
            configurations,
        }))
    }

    /// Activity of every element in the dynamic run.
    /// Which elements are present in a stage, one flag per element.
    pub fn present_in(&self, stage: usize) -> &[bool] {
        &self.configurations[stage].present
    }
    pub(crate) fn present(&self) -> Option<&[bool]> {
        self.configurations
            .last()
            .map(|configuration| &configuration.present[..])
    }

    /// Water in pores at the start of the dynamic run.
    pub(crate) fn water(&self) -> Option<&WaterAtRest> {
        self.configurations
            .last()
            .map(|configuration| &configuration.water)
    }

    /// Configuration after the last stage, that of the dynamic run.
    pub(crate) fn last(&self) -> Option<&Configuration> {
        self.configurations.last()
    }

    /// Bolt groups of the given number of stages, in order of installation.
    pub(crate) fn bolts(&self, stages: usize) -> impl Iterator<Item = &BoltSet> {
        self.configurations[..stages]
            .iter()
            .flat_map(|configuration| &configuration.bolts)
    }

    /// State without displacement, with the elements that are active in the dynamic run.
    pub(crate) fn bare_state(&self, nodes: usize) -> State {
        let mut state = State::at_rest(nodes);
        state.absent.clone_from(&self.absent);
        for configuration in &self.configurations {
            if !configuration.excavated.is_empty() {
                state.remove(&configuration.excavated);
            }
            if !configuration.cast.is_empty() {
                state.cast(&configuration.cast);
            }
        }
        state
    }
}

/// Checks that the stage that removes a load comes after the first stage in which the load acts (by index).
pub fn check_removal(stages: &[SceneStage], first: usize, name: &str) -> Result<(), StagingError> {
    match stages.iter().position(|stage| stage.name == name) {
        None => Err(StagingError::NoSuchStage { name: name.into() }),
        Some(removal) if removal <= first => Err(StagingError::RemovedEarly {
            name: name.into(),
            first: stages[first].name.clone(),
        }),
        Some(_) => Ok(()),
    }
}

/// Checks that concern the scene as a whole.
fn check(scene: &Scene) -> Result<(), StagingError> {
    for name in scene
        .loads
        .iter()
        .filter_map(|load| load.removed_in.as_ref())
    {
        check_removal(&scene.stages, 0, name)?;
    }
    if scene.stages.is_empty() {
        let water = WaterInJoints::of(scene)?;
        let what = match (&scene.in_situ_stress, &scene.bolts[..]) {
            (Some(_), _) => "an in-situ stress",
            (None, [_, ..]) => "bolts",
            (None, []) if water.unloaded(scene).is_some() => {
                "a joint with water and without a preload"
            }
            (None, []) => return Ok(()),
        };
        return Err(StagingError::NoStage { what });
    }
    if scene.initial == InitialMotion::Field {
        return Err(StagingError::InMotion);
    }
    if let Some(constraint) = scene.constraints.first() {
        let name = constraint.name().into();
        return Err(StagingError::Constraint { name });
    }
    if let Some(joint) = scene.joints.iter().find(|joint| joint.preload.is_some()) {
        let joint = joint.name.clone();
        return Err(StagingError::Preload { joint });
    }
    if let Some(super::InSituStress::Elements(stresses)) = &scene.in_situ_stress {
        let (found, expected) = (stresses.len(), scene.mesh.element_count());
        if found != expected {
            return Err(StagingError::StressCount { found, expected });
        }
    }
    for (index, bolts) in scene.bolts.iter().enumerate() {
        if scene.bolts[..index]
            .iter()
            .any(|other| other.name == bolts.name)
        {
            let name = bolts.name.clone();
            return Err(StagingError::SameBolts { name });
        }
    }
    Ok(())
}

/// Elements of sets that are cast without having been active before.
fn absent_at_first(mesh: &Mesh, stages: &[SceneStage]) -> Result<Vec<u32>, Error> {
    let mut known = HashSet::new();
    let mut absent = Vec::new();
    for stage in stages {
        let refused = |source| Error::staging(Some(&stage.name), source);
        for set in &stage.excavated {
            known.extend(elements(mesh, set, "excavate").map_err(refused)?);
        }
        for set in &stage.cast {
            let cast = elements(mesh, set, "cast").map_err(refused)?;
            absent.extend(
                cast.iter()
                    .copied()
                    .filter(|&element| known.insert(element)),
            );
        }
    }
    absent.sort_unstable();
    Ok(absent)
}

pub(super) fn elements<'m>(
    mesh: &'m Mesh,
    set: &str,
    what: &'static str,
) -> Result<&'m [u32], StagingError> {
    mesh.element_set(set).map_err(|_| {
        let set = set.into();
        StagingError::NoSuchSet { set, what }
    })
}

/// Cause of an invalid stage: an error of the stage itself, or of another item of the scene.
enum StageFault {
    Stage(StagingError),
    Whole(Error),
}

impl From<StagingError> for StageFault {
    fn from(source: StagingError) -> Self {
        Self::Stage(source)
    }
}

/// Configuration up to the current stage.
struct Progress<'s> {
    scene: &'s Scene,
    present: Vec<bool>,
    materials: BTreeMap<usize, Material>,
    /// Names of installed bolt groups.
    installed: Vec<String>,
    /// Name of the bolt group that crosses an element.
    bolted: HashMap<u32, String>,
    water: WaterSoFar,
    in_joints: WaterInJoints,
}

impl Progress<'_> {
    fn configuration(&mut self, index: usize) -> Result<Configuration, StageFault> {
        let scene = self.scene;
        let stages = &scene.stages[..];
        let stage = &stages[index];
        if stages[..index].iter().any(|other| other.name == stage.name) {
            return Err(StagingError::SameName.into());
        }
        stage.options.check().map_err(StagingError::from)?;
        for name in stage
            .loads
            .iter()
            .filter_map(|load| load.removed_in.as_ref())
        {
            check_removal(stages, index, name)?;
        }
        let excavated = self.excavate(stage)?;
        let cast = self.cast(stage)?;
        self.change_materials(stage, &cast)?;
        let pressure_changes = self.change_water(stage, &cast)?;
        let bolts = self.install(stage)?;
        for name in stage.tied.iter().chain(&stage.bonded) {
            if scene.joints.iter().all(|joint| joint.name != *name) {
                let name = name.clone();
                return Err(StagingError::NoSuchJoint { name }.into());
            }
        }
        let names = scene.joints.iter().map(|joint| &joint.name);
        let renewed = names.filter_map(|name| Some((name.clone(), renewal(stages, index, name)?)));
        Ok(Configuration {
            excavated,
            cast,
            present: self.present.clone(),
            materials: self.materials.clone(),
            bolts,
            renewed: renewed.collect(),
            pressure_changes,
            water: self.water.at_rest(&scene.mesh, stage.drainage),
            in_joints: self.in_joints.clone(),
            joint_loads: self.in_joints.loads(scene, &self.present),
        })
    }

    fn excavate(&mut self, stage: &SceneStage) -> Result<Vec<u32>, StagingError> {
        let mesh = &*self.scene.mesh;
        let mut excavated = Vec::new();
        for set in &stage.excavated {
            for &element in elements(mesh, set, "excavate")? {
                let (set, tag) = (set.clone(), mesh.element_tags()[element as usize]);
                if !self.present[element as usize] {
                    let element = tag;
                    return Err(StagingError::NotActive { set, element });
                }
                if let Some(name) = self.bolted.get(&element) {
                    let (element, name) = (tag, name.clone());
                    return Err(StagingError::Bolted { set, element, name });
                }
                excavated.push(element);
            }
        }
        for &element in &excavated {
            self.present[element as usize] = false;
        }
        Ok(each_once(excavated))
    }

    fn cast(&mut self, stage: &SceneStage) -> Result<Vec<u32>, StagingError> {
        let mesh = &*self.scene.mesh;
        let mut cast = Vec::new();
        for set in &stage.cast {
            for &element in elements(mesh, set, "cast")? {
                if self.present[element as usize] {
                    let (set, element) = (set.clone(), mesh.element_tags()[element as usize]);
                    return Err(StagingError::AlreadyActive { set, element });
                }
                cast.push(element);
            }
        }
        for &element in &cast {
            self.present[element as usize] = true;
        }
        Ok(each_once(cast))
    }

    /// Restores the material of parts that are cast as a whole, then sets the temporary materials of the stage.
    fn change_materials(&mut self, stage: &SceneStage, cast: &[u32]) -> Result<(), StagingError> {
        let (mesh, parts) = (&self.scene.mesh, &self.scene.parts);
        self.materials.retain(|&part, _| {
            let whole = mesh.element_set(&parts[part].set).unwrap_or_default();
            !whole
                .iter()
                .all(|element| cast.binary_search(element).is_ok())
        });
        for (set, material) in &stage.parts {
            let part = parts.iter().position(|part| part.set == *set);
            let part = part.ok_or_else(|| StagingError::NoSuchPart { set: set.clone() })?;
            let elements = mesh.element_set(set).unwrap_or_default();
            if !elements.iter().any(|&e| self.present[e as usize]) {
                return Err(StagingError::InactivePart { set: set.clone() });
            }
            self.materials.insert(part, material.clone());
        }
        Ok(())
    }

    /// Takes the water levels of the stage.
    fn change_water(
        &mut self,
        stage: &SceneStage,
        cast: &[u32],
    ) -> Result<Vec<PressureChange>, StagingError> {
        let is_undrained = stage.drainage == Drainage::Undrained;
        if is_undrained && !stage.water.is_empty() {
            return Err(StagingError::UndrainedLevel);
        }
        if stage.water.is_empty() && cast.is_empty() && !is_undrained {
            return Ok(Vec::new());
        }
        let in_joints = self.in_joints.advance(self.scene, stage)?;
        let mesh = &*self.scene.mesh;
        let mut water = vec![None; mesh.element_count()];
        let mut is_dry = true;
        for (index, part) in self.scene.parts.iter().enumerate() {
            let of_stage = self.materials.get(&index);
            let material = of_stage.or(part.static_material.as_ref());
            let Some(own) = material.unwrap_or(&part.material).pore_water() else {
                continue;
            };
            let of_part = mesh.element_set(&part.set).unwrap_or_default().iter();
            for &element in of_part.filter(|element| self.present[**element as usize]) {
                (water[element as usize], is_dry) = (Some(own), false);
            }
        }
        let levels = stage.water.iter().zip(&in_joints);
        let mut of_ground = levels.filter(|(_, in_joints)| !**in_joints);
        let general = of_ground.any(|(level, _)| level.set.is_none());
        if is_dry && (is_undrained || general) {
            let (key, what) = if is_undrained {
                ("undrained", "an undrained stage")
            } else {
                ("water", "a water level")
            };
            return Err(StagingError::Dry { key, what });
        }
        self.water.advance(
            stage,
            &WetElements {
                mesh,
                cast,
                water,
                in_joints: &in_joints,
            },
        )
    }

    fn install(&mut self, stage: &SceneStage) -> Result<Vec<BoltSet>, StageFault> {
        let mut sets = Vec::with_capacity(stage.bolts.len());
        for name in &stage.bolts {
            let of_name = self.scene.bolts.iter().find(|bolts| bolts.name == *name);
            let Some(bolts) = of_name else {
                let name = name.clone();
                return Err(StagingError::NoSuchBolts { name }.into());
            };
            if self.installed.contains(name) {
                let name = name.clone();
                return Err(StagingError::AlreadyInstalled { name }.into());
            }
            let set = bolts
                .embed(self.scene, &self.present)
                .map_err(StageFault::Whole)?;
            for bolt in 0..set.len() {
                let crossed = set.segments(bolt).map(|segment| segment.element);
                self.bolted
                    .extend(crossed.map(|element| (element, name.clone())));
            }
            self.installed.push(name.clone());
            sets.push(set);
        }
        Ok(sets)
    }
}

fn each_once(mut elements: Vec<u32>) -> Vec<u32> {
    elements.sort_unstable();
    elements.dedup();
    elements
}
