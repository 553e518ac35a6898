//! Incident field of a scene, with the waves of which it is the sum.

use std::sync::Arc;

use powerhouse_model::{IncidentField, ModelError};
use powerhouse_wavefield::{LayeredWave, PlaneWave, Superposition};

use crate::{Error, Scene};

/// Incident field of a scene: the motion of the site without the structure.
#[derive(Clone)]
pub struct SceneField {
    motion: Arc<dyn IncidentField>,
    waves: Waves,
}

/// Waves of which a field is the sum, as far as they are known one by one.
#[derive(Clone)]
enum Waves {
    Unknown,
    Plane(Vec<PlaneWave>),
    Layered(Vec<LayeredWave>),
}

impl SceneField {
    fn sum<W: IncidentField + Clone + 'static>(
        waves: Vec<W>,
        kind: fn(Vec<W>) -> Waves,
    ) -> Result<Self, Error> {
        let fields = waves.iter().cloned();
        let fields = fields.map(|wave| Box::new(wave) as Box<dyn IncidentField>);
        let motion = Superposition::new(fields.collect()).map_err(ModelError::from)?;
        Ok(Self {
            motion: Arc::new(motion),
            waves: kind(waves),
        })
    }
}

impl Scene {
    /// Sets the incident field, the motion of the site without the structure, in place of an earlier one and its plane
    /// waves.
    #[must_use]
    pub fn with_field(self, field: impl IncidentField + 'static) -> Self {
        self.with_shared_field(Arc::new(field))
    }

    /// Sets the incident field to one that another scene has too, as [`with_field`](Self::with_field).
    #[must_use]
    pub fn with_shared_field(mut self, field: Arc<dyn IncidentField>) -> Self {
        self.field = Some(SceneField {
            motion: field,
            waves: Waves::Unknown,
        });
        self
    }

    /// Sets the incident field to a sum of plane waves, which studies of the scene then know one by one.
    ///
    /// # Errors
    /// No wave, or waves in different media.
    pub fn with_plane_waves(mut self, waves: Vec<PlaneWave>) -> Result<Self, Error> {
        self.field = Some(SceneField::sum(waves, Waves::Plane)?);
        Ok(self)
    }

    /// Sets the incident field to a sum of plane waves in layered ground.
    ///
    /// # Errors
    /// No wave, or waves in different ground.
    pub fn with_layered_waves(mut self, waves: Vec<LayeredWave>) -> Result<Self, Error> {
        self.field = Some(SceneField::sum(waves, Waves::Layered)?);
        Ok(self)
    }

    /// The incident field: the motion of the site without the structure.
    pub fn field(&self) -> Option<&Arc<dyn IncidentField>> {
        self.field.as_ref().map(|field| &field.motion)
    }

    /// The plane waves of which the incident field is the sum; none if the field is given otherwise.
    pub fn plane_waves(&self) -> &[PlaneWave] {
        match self.field.as_ref().map(|field| &field.waves) {
            Some(Waves::Plane(waves)) => &waves[..],
            _ => &[],
        }
    }

    /// The waves in layered ground of which the incident field is the sum; none if the field is given otherwise.
    pub fn layered_waves(&self) -> &[LayeredWave] {
        match self.field.as_ref().map(|field| &field.waves) {
            Some(Waves::Layered(waves)) => &waves[..],
            _ => &[],
        }
    }
}
