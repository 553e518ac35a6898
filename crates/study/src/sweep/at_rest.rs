//! Store of bodies in static equilibrium after the construction stages, in memory and in files.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use powerhouse::model::Checksum;
use powerhouse::spec::InSituStress;
use powerhouse::{Damping, EquilibratedBody, FileScene, Registry};

use super::locked;
use super::processes::{SharedFolder, WorkLock};
use crate::StudyError;
use crate::mark::REVISION;

/// Name of the folder of body files within the folder of a sweep.
const FOLDER: &str = "at-rest";

/// Sections of a scene on which the equilibrium after the stages depends, beside mesh, joints and absorbing faces.
const SECTIONS: [&str; 9] = [
    "material",
    "part",
    "joint",
    "support",
    "load",
    "in_situ_stress",
    "bolt",
    "stage",
    "precision",
];

/// Equilibrated bodies of a sweep by their keys.
pub(super) struct BodyStore<'s> {
    folder: PathBuf,
    shared: &'s SharedFolder,
    slots: Mutex<BTreeMap<String, Slot>>,
}

/// Slot of the body of a key; its lock is held while the body is computed.
pub(super) type Slot = Arc<Mutex<Option<EquilibratedBody>>>;

impl<'s> BodyStore<'s> {
    /// The store in the folder of a sweep, with the files of earlier sweeps and of other processes.
    pub(super) fn in_folder(folder: &Path, shared: &'s SharedFolder) -> Self {
        Self {
            folder: folder.join(FOLDER),
            shared,
            slots: Mutex::default(),
        }
    }

    /// The slot of a key.
    pub(super) fn slot(&self, key: &str) -> Slot {
        let mut slots = locked(&self.slots);
        slots.entry(key.to_owned()).or_default().clone()
    }

    /// Waits for the lock under which the body of a key is computed; `waits` is called while another process holds it, and
    /// takes some time.
    ///
    /// # Errors
    /// A lock file that cannot be created; an error of `waits`.
    pub(super) fn lock(
        &self,
        key: &str,
        waits: impl FnMut() -> Result<(), StudyError>,
    ) -> Result<WorkLock, StudyError> {
        self.shared.work(&format!("{key}.body"), waits)
    }

    /// Reads the body of a key from its file; `None` for an incomplete file or one of another version.
    pub(super) fn read(&self, key: &str) -> Option<EquilibratedBody> {
        EquilibratedBody::read(&self.file(key)).ok()
    }

    /// Writes a body to its file.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub(super) fn write(&self, key: &str, body: &EquilibratedBody) -> Result<(), StudyError> {
        Ok(body.write(&self.file(key))?)
    }

    fn file(&self, key: &str) -> PathBuf {
        self.folder.join(format!("{key}.body"))
    }
}

/// Key of the equilibrated body of a case; cases with the same key share the body.
///
/// It is the checksum of the software revision, the mesh, the supports, the joints, the start time, at which static
/// loads are evaluated, the absorbing faces, along which rock is elastic, media and damping of the parts at rest, and all
/// sections of the scene on which the stages depend.
pub(super) fn key(scene: &FileScene) -> String {
    let mut sum = Checksum::default();
    sum.add_whole(REVISION.as_bytes());
    let version = scene.registry().map_or("", Registry::version);
    if !version.is_empty() {
        sum.add_whole(version.as_bytes());
    }
    sum.add_mesh(scene.mesh());
    // The debug format contains nodes and directions.
    let pairs: Vec<_> = scene
        .periodic_pairs()
        .iter()
        .chain(scene.delayed_sides())
        .collect();
    let supports = format!("{:?} {pairs:?}", scene.supports());
    let joints: Vec<&str> = scene.joints().map(|(name, ..)| name).collect();
    let boundary = scene.boundary();
    let faces = boundary.map_or(&[][..], |boundary| &boundary.faces);
    let start = scene.start_time();
    sum.add_whole(format!("{supports} {joints:?} {faces:?} {start:?}").as_bytes());
    // Layers that soften with strain have other moduli and damping in the motion.
    for part in scene.parts() {
        let (material, damping) = match &part.static_material {
            Some(material) => (material, &Damping::None),
            None => (&part.material, &part.damping),
        };
        let medium = material.medium();
        sum.add_whole(format!("{} {medium:?} {damping:?}", part.set).as_bytes());
    }
    if let Some(spec) = scene.spec() {
        // A number that TOML does not have is refused before.
        let table = spec.to_table().unwrap_or_default();
        for section in SECTIONS {
            let text = table
                .get(section)
                .map_or(String::new(), toml::Value::to_string);
            sum.add_whole(text.as_bytes());
        }
        if let Some(InSituStress::Elements { file, .. }) = spec.in_situ_stress.as_deref() {
            let path = spec.file().text().folder().join(&**file);
            sum.add_whole(&std::fs::read(path).unwrap_or_default());
        }
    }
    sum.to_string()
}
