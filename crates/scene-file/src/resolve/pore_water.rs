//! Water in the pores of materials: its pressure at rest, and what a check says of it.

use core::ops::Range;
use std::collections::BTreeMap;

use powerhouse_elements::WaterPressure;

use powerhouse_laws::Material;
use powerhouse_model::{Mesh, Vec3};
use powerhouse_scene::internal::fill_body;
use powerhouse_scene::{Fault, Problem, Remark, SaturatedMaterial, Seepage};

use crate::spec::{At, Finite, Positive, SceneSpec, water_weight};

/// Keys of a pressure at rest.
#[derive(Clone, Copy)]
pub(crate) struct PressureKeys<'a> {
    /// Height z of the level (m).
    pub(crate) level: Option<&'a At<Finite>>,
    /// Heights z (m) and pressures (Pa).
    pub(crate) pressures: Option<&'a At<Vec<[Finite; 2]>>>,
    /// Density of the water (kg/m3).
    pub(crate) density: Option<Positive>,
}

impl<'a> PressureKeys<'a> {
    /// The keys `level`, `pressures` and `density` of a table.
    pub(crate) fn new(
        level: &'a Option<At<Finite>>,
        pressures: &'a Option<At<Vec<[Finite; 2]>>>,
        density: Option<Positive>,
    ) -> Self {
        Self {
            level: level.as_ref(),
            pressures: pressures.as_ref(),
            density,
        }
    }
}

/// Pressure at rest of a table at a place in the text; none without level and pressures.
pub(crate) fn water_pressure(
    table: Range<usize>,
    keys: PressureKeys,
) -> Result<Option<WaterPressure>, Fault> {
    let (span, found) = match (keys.level, keys.pressures) {
        (None, None) => return Ok(None),
        (Some(level), None) => {
            let found = WaterPressure::hydrostatic(level.get(), water_weight(keys.density));
            (level.span(), found)
        }
        (None, Some(pressures)) => {
            let points: Vec<[f64; 2]> = pressures.iter().map(|row| row.map(Finite::get)).collect();
            (pressures.span(), WaterPressure::table(&points))
        }
        (Some(_), Some(_)) => {
            let problem = Problem::Value {
                found: "a level and a table of pressures".into(),
                expected: "one of `level` and `pressures`".into(),
            };
            return Err(Fault::new(table, problem));
        }
    };
    found.map(Some).map_err(|error| Fault::refused(span, error))
}

/// The same of a table that must have one of the two.
pub(super) fn given_pressure(
    table: Range<usize>,
    keys: PressureKeys,
) -> Result<WaterPressure, Fault> {
    let found = water_pressure(table.clone(), keys)?;
    found.ok_or_else(|| {
        let problem = Problem::Value {
            found: "neither a level nor a table of pressures".into(),
            expected: "one of `level` and `pressures`".into(),
        };
        Fault::new(table, problem)
    })
}

/// Checks that tables of pressures of materials reach over the centres of their elements.
pub(super) fn check_heights(
    mesh: &Mesh,
    file: &SceneSpec,
    materials: &BTreeMap<String, Material>,
) -> Result<(), Fault> {
    for part in &file.parts {
        let material = materials.get(part.material.as_str());
        let water = material.and_then(|material| material.pore_water()?.at_rest());
        let Some([low, high]) = water.map(WaterPressure::range) else {
            continue;
        };
        for &element in mesh.element_set(&part.set).unwrap_or_default() {
            let height = mesh.centroid(element).z;
            if !(low..=high).contains(&height) {
                let tag = mesh.element_tags()[element as usize];
                let problem = Problem::Value {
                    found: format!(
                        "element {tag} of '{}' with its centre at z = {height} m",
                        *part.set
                    ),
                    expected: format!(
                        "heights within the table of pressures of the material, {low} to {high} m"
                    ),
                };
                return Err(Fault::new(part.material.span(), problem));
            }
        }
    }
    Ok(())
}

/// Facts about materials with water in their pores, and warnings where it would flow during the run.
pub(super) fn waters(
    mesh: &Mesh,
    file: &SceneSpec,
    materials: &BTreeMap<String, Material>,
) -> Vec<Remark> {
    let wet = materials.iter().filter_map(|(name, material)| {
        let water = material.pore_water()?;
        Some(Remark::PoreWater(SaturatedMaterial {
            name: name.clone(),
            stiffness: water.stiffness(),
            speeds: [material.law().skeleton(), material.medium()].map(|medium| medium.p_speed()),
            at_rest: water.at_rest().cloned(),
            seepage: seepage(mesh, file, (name.as_str(), material)),
        }))
    });
    wet.collect()
}

/// Extents (m) of no point.
const NOTHING: (Vec3, Vec3) = (
    Vec3::new(f64::INFINITY, f64::INFINITY, f64::INFINITY),
    Vec3::new(f64::NEG_INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY),
);

/// Flow of the water of a material with a permeability.
fn seepage(mesh: &Mesh, file: &SceneSpec, (name, material): (&str, &Material)) -> Option<Seepage> {
    let table = file.materials.iter().find(|table| *table.name == *name)?;
    let water = table.pore_water.as_ref()?;
    let permeability = water.permeability?.get();
    let parts = file.parts.iter().filter(|part| *part.material == *name);
    let elements = parts.flat_map(|part| mesh.element_set(&part.set).unwrap_or_default());
    let elements: Vec<u32> = elements.copied().collect();
    let corners = mesh.nodes_of_elements(&elements).into_iter();
    let corners = corners.map(|node| mesh.positions()[node as usize]);
    let (low, high) = corners.fold(NOTHING, |(low, high), x| (low.inf(&x), high.sup(&x)));
    // Along an axis that single elements fill, as in a slice, nothing drains.
    let axes = [Vec3::x(), Vec3::y(), Vec3::z()].into_iter();
    let open = axes.filter(|axis| !fill_body(mesh, elements.iter().copied(), axis));
    let extent = open.map(|axis| (high - low).dot(&axis)).reduce(f64::min)?;
    let skeleton = material.law().skeleton();
    let modulus = skeleton.lambda() + 2.0 * skeleton.shear();
    Some(Seepage {
        permeability,
        consolidation: permeability * modulus / water_weight(water.density),
        duration: file.time.duration.get(),
        extent,
    })
}
