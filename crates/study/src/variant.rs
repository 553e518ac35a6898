//! Variants of a scene, the runs of sweeps, convergence studies and trades.

use powerhouse::spec::Positive;
use powerhouse::{Error, FileScene, Registry, SceneSpec};

use crate::StudyError;
use crate::mark::{Fingerprint, inputs};

/// Variant of a scene: its specification, and the fingerprint by which its finished run is recognised.
pub(crate) struct Variant {
    spec: SceneSpec,
    fingerprint: Fingerprint,
}

impl Variant {
    /// A variant, with what a registry of a version has.
    ///
    /// # Errors
    /// A file of the scene that cannot be read; [`StudyError::Unwritable`].
    pub(crate) fn new(spec: SceneSpec, registered: &str) -> Result<Self, StudyError> {
        let files = inputs(&spec)?;
        Self::with_files(spec, &files, None, registered)
    }
    /// The same with the bytes of the files of the scene, which are then not read again, for runs of another duration (s) than
    /// the scene's, if one is given.
    ///
    /// # Errors
    /// [`StudyError::Unwritable`].
    pub(crate) fn with_files(
        spec: SceneSpec,
        files: &[Vec<u8>],
        duration: Option<f64>,
        registered: &str,
    ) -> Result<Self, StudyError> {
        let fingerprint = Fingerprint::of(&spec, files, duration, registered)?;
        Ok(Self { spec, fingerprint })
    }
    /// Name of the case; empty for a variant that is none.
    pub(crate) fn name(&self) -> &str {
        self.spec.case().unwrap_or_default()
    }
    pub(crate) fn fingerprint(&self) -> &Fingerprint {
        &self.fingerprint
    }
    /// The same with another duration (s) of the scene, above zero and finite.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub(crate) fn with_duration(
        &self,
        duration: f64,
        registered: &str,
    ) -> Result<Self, StudyError> {
        let mut spec = self.spec.clone();
        if let Some(duration) = Positive::new(duration) {
            spec.time.duration = duration;
        }
        Self::new(spec, registered)
    }
    /// The scene of the variant.
    ///
    /// # Errors
    /// A scene that is refused.
    pub(crate) fn scene(&self, registry: &Registry) -> Result<FileScene, Error> {
        FileScene::from_spec(self.spec.clone(), registry)
    }
}
