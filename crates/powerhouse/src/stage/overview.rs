//! What stages do, in numbers.

use powerhouse_explicit_core::StaticOptions;

use super::Timeline;
use crate::{Error, Scene};

/// What a stage does.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct StageOverview {
    /// Its name.
    pub name: String,
    /// Elements that it takes out.
    pub excavated: usize,
    /// Elements that it puts in.
    pub cast: usize,
    /// Elements that are there afterwards.
    pub present: usize,
    /// Bolts that it installs: name and number.
    pub bolts: Vec<(String, usize)>,
    /// Parts that have another material then: set and law.
    pub materials: Vec<(String, String)>,
    /// Joints that it ties.
    pub tied: Vec<String>,
    /// Joints to which it gives their bond anew.
    pub bonded: Vec<String>,
    /// Supports that it adds.
    pub supports: usize,
    /// Loads and weights that it adds.
    pub loads: usize,
    /// Loads that it takes off.
    pub removed_loads: usize,
    /// How it comes to rest.
    pub options: StaticOptions,
}

impl Scene {
    /// What the stages do, one after the other.
    ///
    /// # Errors
    /// The first stage that cannot be as it is to.
    pub fn stage_overviews(&self) -> Result<Vec<StageOverview>, Error> {
        let Some(timeline) = Timeline::of(self)? else {
            return Ok(Vec::new());
        };
        let stages = self.stages.iter().zip(&timeline.moments);
        let overviews = stages.map(|(stage, moment)| StageOverview {
            name: stage.name.clone(),
            excavated: moment.excavated.len(),
            cast: moment.cast.len(),
            present: moment.present.iter().filter(|there| **there).count(),
            bolts: (moment.bolts.iter())
                .map(|bolts| (bolts.name().into(), bolts.len()))
                .collect(),
            materials: (moment.materials.iter())
                .map(|(&part, material)| (self.parts[part].set.clone(), material.name().into()))
                .collect(),
            tied: stage.tied.clone(),
            bonded: stage.bonded.clone(),
            supports: stage.supports.len(),
            loads: stage.loads.len() + stage.weights.len(),
            removed_loads: (self.loads.iter())
                .chain(self.stages.iter().flat_map(|other| &other.loads))
                .filter(|load| load.removed_in.as_ref() == Some(&stage.name))
                .count(),
            options: stage.options,
        });
        Ok(overviews.collect())
    }
}
