//! Overview of construction stages.

use super::{StageWater, Timeline};
use crate::{Error, Scene};
use powerhouse_elements::Drainage;
use powerhouse_model::StaticOptions;

/// Overview of a construction stage: numbers of changed elements, bolts, supports and loads.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct StageOverview {
    /// Name of the stage.
    pub name: String,
    /// Number of elements that this stage excavates.
    pub excavated: usize,
    /// Number of elements that this stage casts.
    pub cast: usize,
    /// Number of active elements of the whole body after the stage's changes.
    pub present: usize,
    /// Bolt groups that this stage installs: name and number of bolts.
    pub bolts: Vec<(String, usize)>,
    /// Parts with temporary materials in this stage, those that earlier stages set and are still in force included: element
    /// set and name of the law.
    pub materials: Vec<(String, String)>,
    /// Names of the joints that are tied in this stage.
    pub tied: Vec<String>,
    /// Names of the joints that this stage grouts.
    pub bonded: Vec<String>,
    /// Water levels of ground with water in its pores that this stage sets.
    pub water: Vec<StageWater>,
    /// Whether that water flows in this stage.
    pub drainage: Drainage,
    /// Number of supports that this stage adds.
    pub supports: usize,
    /// Number of loads and weights that this stage adds.
    pub loads: usize,
    /// Number of loads of the scene and of earlier stages that this stage removes.
    pub removed_loads: usize,
    /// Options of the static analysis.
    pub options: StaticOptions,
}

impl Scene {
    /// Overviews of the construction stages, in order.
    ///
    /// # Errors
    /// Error of the first invalid stage.
    pub fn stage_overviews(&self) -> Result<Vec<StageOverview>, Error> {
        let Some(timeline) = Timeline::of(self)? else {
            return Ok(Vec::new());
        };
        let stages = self.stages.iter().zip(&timeline.configurations);
        let overviews = stages.map(|(stage, configuration)| StageOverview {
            name: stage.name.clone(),
            excavated: configuration.excavated.len(),
            cast: configuration.cast.len(),
            present: configuration.present.iter().filter(|there| **there).count(),
            bolts: (configuration.bolts.iter())
                .map(|bolts| (bolts.name().into(), bolts.len()))
                .collect(),
            materials: (configuration.materials.iter())
                .map(|(&part, material)| (self.parts[part].set.clone(), material.name().into()))
                .collect(),
            tied: stage.tied.clone(),
            bonded: stage.bonded.clone(),
            water: stage.water.clone(),
            drainage: stage.drainage,
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
