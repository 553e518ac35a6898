//! What is there, and of what, from stage to stage.

use std::collections::{BTreeMap, HashMap, HashSet};

use powerhouse_explicit_core::BoltSet;
use powerhouse_model::{Mesh, Renewal, State};

use super::list::renewal;
use super::{SceneStage, StagingError};
use crate::scene::InitialMotion;
use crate::{Error, Material, Scene};

/// What a stage changes, found in the mesh, and what is there then.
pub(crate) struct Moment {
    /// Mesh indices of what is taken out, each once.
    pub(crate) excavated: Vec<u32>,
    /// Mesh indices of what is put in, each once.
    pub(crate) cast: Vec<u32>,
    /// Which elements of the mesh are there afterwards.
    pub(crate) present: Vec<bool>,
    /// Parts, by their place, that have another material than their own.
    pub(crate) materials: BTreeMap<usize, Material>,
    /// Bolts that are installed.
    pub(crate) bolts: Vec<BoltSet>,
    /// Joints that start anew, and how.
    pub(crate) renewed: Vec<(String, Renewal)>,
}

/// The stages of a scene, one after the other.
pub(crate) struct Timeline {
    /// Mesh indices of elements that are not there before the first stage.
    pub(crate) absent: Vec<u32>,
    /// One for each stage.
    pub(crate) moments: Vec<Moment>,
}

impl Timeline {
    /// The stages of a scene; none if it has none.
    ///
    /// # Errors
    /// The first stage that cannot be as it is to.
    pub(crate) fn of(scene: &Scene) -> Result<Option<Self>, Error> {
        check(scene).map_err(|source| Error::staging(None, source))?;
        if scene.stages.is_empty() {
            return Ok(None);
        }
        let mesh = &*scene.mesh;
        let absent = absent_at_first(mesh, &scene.stages)?;
        let mut found = Found {
            scene,
            present: vec![true; mesh.element_count()],
            materials: BTreeMap::new(),
            installed: Vec::new(),
            bolted: HashMap::new(),
        };
        for &element in &absent {
            found.present[element as usize] = false;
        }
        let mut moments = Vec::with_capacity(scene.stages.len());
        for place in 0..scene.stages.len() {
            let refused = |source| Error::staging(Some(&scene.stages[place].name), source);
            moments.push(found.moment(place).map_err(|refusal| match refusal {
                Refusal::Stage(source) => refused(source),
                Refusal::Whole(error) => error,
            })?);
        }
        let idle = |bolts: &&crate::SceneBolts| !found.installed.contains(&bolts.name);
        if let Some(bolts) = scene.bolts.iter().find(idle) {
            let name = bolts.name.clone();
            return Err(Error::of_bolts(StagingError::IdleBolts { name }));
        }
        Ok(Some(Self { absent, moments }))
    }

    /// Which elements are there when the body moves.
    pub(crate) fn present(&self) -> Option<&[bool]> {
        self.moments.last().map(|moment| &moment.present[..])
    }

    /// All bolts, in the order in which they are installed, up to a stage.
    pub(crate) fn bolts(&self, stages: usize) -> impl Iterator<Item = &BoltSet> {
        self.moments[..stages]
            .iter()
            .flat_map(|moment| &moment.bolts)
    }

    /// A body of the elements that are there when it moves, of which nothing has moved yet.
    pub(crate) fn bare_state(&self, nodes: usize) -> State {
        let mut state = State::at_rest(nodes);
        state.absent.clone_from(&self.absent);
        for moment in &self.moments {
            if !moment.excavated.is_empty() {
                state.remove(&moment.excavated);
            }
            if !moment.cast.is_empty() {
                state.cast(&moment.cast);
            }
        }
        state
    }
}

/// Refuses a stage that is to take off what acts from the stage of a place on, if it does not come
/// after it.
pub(crate) fn check_removal(
    stages: &[SceneStage],
    first: usize,
    name: &str,
) -> Result<(), StagingError> {
    match stages.iter().position(|stage| stage.name == name) {
        None => Err(StagingError::NoSuchStage { name: name.into() }),
        Some(removal) if removal <= first => Err(StagingError::RemovedEarly {
            name: name.into(),
            first: stages[first].name.clone(),
        }),
        Some(_) => Ok(()),
    }
}

/// What concerns the scene as a whole.
fn check(scene: &Scene) -> Result<(), StagingError> {
    for name in scene
        .loads
        .iter()
        .filter_map(|load| load.removed_in.as_ref())
    {
        check_removal(&scene.stages, 0, name)?;
    }
    if scene.stages.is_empty() {
        let what = match (&scene.in_situ_stress, &scene.bolts[..]) {
            (Some(_), _) => "an in-situ stress",
            (None, [_, ..]) => "bolts",
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
    for (place, bolts) in scene.bolts.iter().enumerate() {
        if scene.bolts[..place]
            .iter()
            .any(|other| other.name == bolts.name)
        {
            let name = bolts.name.clone();
            return Err(StagingError::SameBolts { name });
        }
    }
    Ok(())
}

/// Elements of sets that are cast without having been there before.
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

fn elements<'m>(mesh: &'m Mesh, set: &str, what: &'static str) -> Result<&'m [u32], StagingError> {
    mesh.element_set(set).map_err(|_| {
        let set = set.into();
        StagingError::NoSuchSet { set, what }
    })
}

/// Why a stage is refused: for what it says, or for what stands elsewhere in the scene.
enum Refusal {
    Stage(StagingError),
    Whole(Error),
}

impl From<StagingError> for Refusal {
    fn from(source: StagingError) -> Self {
        Self::Stage(source)
    }
}

/// What has been found so far.
struct Found<'s> {
    scene: &'s Scene,
    present: Vec<bool>,
    materials: BTreeMap<usize, Material>,
    /// The names of bolts that are installed.
    installed: Vec<String>,
    /// The bolts that cross an element.
    bolted: HashMap<u32, String>,
}

impl Found<'_> {
    fn moment(&mut self, place: usize) -> Result<Moment, Refusal> {
        let scene = self.scene;
        let stages = &scene.stages[..];
        let stage = &stages[place];
        if stages[..place].iter().any(|other| other.name == stage.name) {
            return Err(StagingError::SameName.into());
        }
        stage.options.check().map_err(StagingError::from)?;
        for name in stage
            .loads
            .iter()
            .filter_map(|load| load.removed_in.as_ref())
        {
            check_removal(stages, place, name)?;
        }
        let excavated = self.excavate(stage)?;
        let cast = self.cast(stage)?;
        self.change_materials(stage, &cast)?;
        let bolts = self.install(stage)?;
        for name in stage.tied.iter().chain(&stage.bonded) {
            if scene.joints.iter().all(|joint| joint.name != *name) {
                let name = name.clone();
                return Err(StagingError::NoSuchJoint { name }.into());
            }
        }
        let names = scene.joints.iter().map(|joint| &joint.name);
        let renewed = names.filter_map(|name| Some((name.clone(), renewal(stages, place, name)?)));
        Ok(Moment {
            excavated,
            cast,
            present: self.present.clone(),
            materials: self.materials.clone(),
            bolts,
            renewed: renewed.collect(),
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
                    return Err(StagingError::NotThere { set, element });
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
                    return Err(StagingError::AlreadyThere { set, element });
                }
                cast.push(element);
            }
        }
        for &element in &cast {
            self.present[element as usize] = true;
        }
        Ok(each_once(cast))
    }

    /// What is cast as a whole has its own material again; then what the stage says.
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
                return Err(StagingError::AbsentPart { set: set.clone() });
            }
            self.materials.insert(part, material.clone());
        }
        Ok(())
    }

    fn install(&mut self, stage: &SceneStage) -> Result<Vec<BoltSet>, Refusal> {
        let mesh = &*self.scene.mesh;
        let mut sets = Vec::with_capacity(stage.bolts.len());
        for name in &stage.bolts {
            let of_name = self.scene.bolts.iter().find(|bolts| bolts.name == *name);
            let Some(bolts) = of_name else {
                let name = name.clone();
                return Err(StagingError::NoSuchBolts { name }.into());
            };
            if self.installed.contains(name) {
                let name = name.clone();
                return Err(StagingError::BoltsTwice { name }.into());
            }
            let set = bolts.embed(mesh, &self.present).map_err(Refusal::Whole)?;
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
