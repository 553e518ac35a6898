//! Water in the pores of the ground from stage to stage: its levels, and whether it flows.

use std::sync::Arc;

use powerhouse_elements::{Drainage, PoreWater, WaterPressure};
use powerhouse_laws::Material;
use powerhouse_model::{Mesh, State, Stress};

use super::{SceneStage, StagingError};

/// Pressure at rest of the water in the pores of ground from a construction stage on: dewatering, impounding.
///
/// ```
/// use powerhouse_elements::WaterPressure;
/// use powerhouse_scene::{SceneStage, StageWater};
/// let level = WaterPressure::hydrostatic(-8.0, 9810.0)?;
/// let stage = SceneStage::new("dewatering").water(StageWater::new(level).within("pit"));
/// assert_eq!(stage.name(), "dewatering");
/// # Ok::<(), powerhouse_model::ParameterError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct StageWater {
    /// Element set; none: all ground with water in its pores for which the stage has no other pressure.
    pub set: Option<String>,
    /// The pressure by height.
    pub pressure: WaterPressure,
}

impl StageWater {
    /// A pressure by height of all ground with water in its pores for which the stage has no other one.
    pub fn new(pressure: WaterPressure) -> Self {
        Self {
            set: None,
            pressure,
        }
    }
    /// The same pressure in an element set alone.
    #[must_use]
    pub fn within(self, set: impl Into<String>) -> Self {
        let set = Some(set.into());
        Self { set, ..self }
    }
}

/// Water in pores in static states: pressures (Pa) of the elements whose level is not that of their material, none if there are no
/// such elements, and whether it flows.
#[derive(Clone, Debug, Default)]
pub(crate) struct WaterAtRest {
    pressures: Option<Arc<[Option<f64>]>>,
    drainage: Drainage,
}

impl WaterAtRest {
    /// A material with this water in its pores, if it has any.
    pub(crate) fn of(&self, mut material: Material) -> Material {
        if material.pore_water().is_none() {
            return material;
        }
        if let Some(pressures) = &self.pressures {
            material = material.with_pore_pressures(pressures.clone());
        }
        match self.drainage {
            Drainage::Drained => material,
            Drainage::Undrained => material.with_drainage(Drainage::Undrained),
        }
    }
}

/// Change of the pressure of the water in an element, and of its slope with height (Pa, Pa/m).
pub(crate) struct PressureChange {
    element: u32,
    pressure: f64,
    slope: f64,
}

/// Water in the pores of all elements, up to the current stage.
#[derive(Default)]
pub(super) struct WaterSoFar {
    /// Water with another pressure than that of the material, by element; empty as long as there is none.
    renewed: Vec<Option<PoreWater>>,
}

/// What a stage knows of its elements: those that are present, those that it casts, and the water of their materials.
pub(super) struct WetElements<'a> {
    pub(super) mesh: &'a Mesh,
    pub(super) cast: &'a [u32],
    /// The water in each element that is present and has some.
    pub(super) water: Vec<Option<&'a PoreWater>>,
    /// Which levels of the stage are those of a joint.
    pub(super) in_joints: &'a [bool],
}

/// Elements of the set of a water level.
pub(crate) fn elements_of_level<'m>(mesh: &'m Mesh, set: &str) -> Result<&'m [u32], StagingError> {
    super::timeline::elements(mesh, set, "water")
}

impl WaterSoFar {
    /// Takes the levels of a stage and the elements that it casts, whose pores are without pressure until a later stage names a
    /// level for them. Returns the changes of pressure.
    pub(super) fn advance(
        &mut self,
        stage: &SceneStage,
        wet: &WetElements,
    ) -> Result<Vec<PressureChange>, StagingError> {
        let count = wet.mesh.element_count();
        let is_cast = |element: u32| wet.cast.binary_search(&element).is_ok();
        let mut levels: Vec<Option<&StageWater>> = vec![None; count];
        for (level, in_joints) in stage.water.iter().zip(wet.in_joints) {
            let Some(set) = &level.set else {
                continue;
            };
            let elements = elements_of_level(wet.mesh, set)?;
            let mut found = *in_joints;
            for &element in elements {
                let index = element as usize;
                if wet.water[index].is_none() {
                    continue;
                }
                found = true;
                let element_tag = wet.mesh.element_tags()[index];
                if is_cast(element) {
                    let (set, element) = (set.clone(), element_tag);
                    return Err(StagingError::LevelOfCast { set, element });
                }
                if levels[index].replace(level).is_some() {
                    let (set, element) = (set.clone(), element_tag);
                    return Err(StagingError::TwoLevels { set, element });
                }
            }
            if !found {
                return Err(StagingError::NoWater { set: set.clone() });
            }
        }
        let mut general = stage.water.iter().filter(|level| level.set.is_none());
        let everywhere = general.next();
        if general.next().is_some() {
            return Err(StagingError::TwoGeneralLevels);
        }
        let mut changes = Vec::new();
        for (element, water) in (0..).zip(wet.water.iter().copied()) {
            let Some(water) = water else {
                continue;
            };
            let index = element as usize;
            if is_cast(element) {
                self.renew(index, count, water.clone().without_pressure());
                continue;
            }
            let Some(level) = levels[index].or(everywhere) else {
                continue;
            };
            let height = wet.mesh.centroid(element).z;
            let [low, high] = level.pressure.range();
            if !(low..=high).contains(&height) {
                let element = wet.mesh.element_tags()[index];
                return Err(StagingError::BeyondTable {
                    set: level.set.clone().unwrap_or_default(),
                    element,
                    height,
                    range: [low, high],
                });
            }
            let renewed = self.renewed.get(index).and_then(Option::as_ref);
            let before = renewed.unwrap_or(water);
            let after = water.clone().with_pressure(level.pressure.clone());
            changes.push(PressureChange {
                element,
                pressure: after.pressure(height) - before.pressure(height),
                slope: after.slope(height) - before.slope(height),
            });
            self.renew(index, count, after);
        }
        Ok(changes)
    }

    fn renew(&mut self, element: usize, count: usize, water: PoreWater) {
        self.renewed.resize(count, None);
        self.renewed[element] = Some(water);
    }

    /// The water at rest after the stages so far, of which the last one flows or not.
    pub(super) fn at_rest(&self, mesh: &Mesh, drainage: Drainage) -> WaterAtRest {
        let of = |(element, water): (u32, &Option<PoreWater>)| {
            let height = || mesh.centroid(element).z;
            water.as_ref().map(|water| water.pressure(height()))
        };
        let pressures = if self.renewed.is_empty() {
            None
        } else {
            Some((0..).zip(&self.renewed).map(of).collect())
        };
        WaterAtRest {
            pressures,
            drainage,
        }
    }
}

/// Adds changes of pressure to the initial stress of a body: total stress, so that the effective one is as before.
pub(super) fn add_pressures(state: &mut State, changes: &[PressureChange], elements: usize) {
    if changes.is_empty() {
        return;
    }
    state.initial_stress.resize(elements, Stress::default());
    let sloped = changes.iter().any(|change| change.slope != 0.0);
    if sloped {
        state.initial_slope.resize(elements, Stress::default());
    }
    for change in changes {
        let index = change.element as usize;
        for axis in 0..3 {
            state.initial_stress[index].0[axis] -= change.pressure;
            if sloped {
                state.initial_slope[index].0[axis] -= change.slope;
            }
        }
    }
}
