//! Warnings about water in the pores of materials.

use std::collections::{BTreeMap, BTreeSet};

use powerhouse_elements::WaterPressure;
use powerhouse_laws::Material;
use powerhouse_model::{ElementKind, Mesh};
use powerhouse_scene::{Fault, Part, Remark, WaterReason, WaterWarning};

use super::stages;
use crate::spec::{self, Load, SceneSpec};

/// Porosity above which next to no room is left for grains.
const MOST_PORES: f64 = 0.95;
/// Share of an isotropic stress below which water takes no part.
const LEAST_SHARE: f64 = 0.01;
/// Poisson's ratio above which elements that lock err by more than a tenth in bending, about.
const LOCKING: f64 = 0.45;
/// Difference of two pressures, over the larger one, above which they are not the same.
const SAME_PRESSURE: f64 = 0.01;

/// Warnings about water in the pores of materials that is not what is meant.
pub(super) fn warnings(
    mesh: &Mesh,
    file: &SceneSpec,
    materials: &BTreeMap<String, Material>,
    parts: &[Part],
) -> Result<Vec<Remark>, Fault> {
    let in_situ = InSitu::of(file)?;
    let mut warnings = Vec::new();
    for (name, material) in materials {
        let own = Ground {
            mesh,
            file,
            name,
            material,
        };
        let mut reasons = own.of_values();
        reasons.extend(own.locking(parts));
        reasons.extend(own.other_pressure(&in_situ));
        reasons.extend(own.above(&in_situ));
        warnings.extend(reasons.into_iter().map(|reason| {
            Remark::WaterWarning(WaterWarning {
                material: name.clone(),
                reason,
            })
        }));
    }
    Ok(warnings)
}

/// Water of the in-situ stress.
struct InSitu {
    /// Whether the stress follows from the weight of ground, with or without water.
    is_of_weight: bool,
    /// Height z of the ground (m), if it is known.
    ground: Option<f64>,
    water: Option<WaterPressure>,
}

impl InSitu {
    fn of(file: &SceneSpec) -> Result<Self, Fault> {
        let none = Self {
            is_of_weight: false,
            ground: None,
            water: None,
        };
        let Some(stress) = &file.in_situ_stress else {
            return Ok(none);
        };
        let (level, water) = match &**stress {
            spec::InSituStress::Ground { level, water, .. }
            | spec::InSituStress::Layers { level, water, .. } => (level, water),
            spec::InSituStress::Linear { .. } | spec::InSituStress::Elements { .. } => {
                return Ok(none);
            }
        };
        let water = water.as_ref();
        Ok(Self {
            is_of_weight: true,
            ground: Some(level.get()),
            water: water
                .map(|water| stages::ground_water(stress, water))
                .transpose()?,
        })
    }
}

/// A material of a scene.
struct Ground<'a> {
    mesh: &'a Mesh,
    file: &'a SceneSpec,
    name: &'a str,
    material: &'a Material,
}

impl Ground<'_> {
    /// Warnings about the values of the material.
    fn of_values(&self) -> Vec<WaterReason> {
        let mut reasons = Vec::new();
        let table = (self.file.materials.iter()).find(|table| *table.name == *self.name);
        let keys = table.and_then(|table| table.pore_water.as_ref());
        let (Some(keys), Some(water)) = (keys, self.material.pore_water()) else {
            return reasons;
        };
        let skeleton = self.material.law().skeleton();
        let of_water = spec::water_density(keys.density);
        if skeleton.density < of_water {
            reasons.push(WaterReason::Light {
                density: skeleton.density,
                water: of_water,
            });
        }
        let porosity = keys.porosity.get();
        if porosity > MOST_PORES {
            reasons.push(WaterReason::Porous { porosity });
        }
        let share = water.stiffness() / (water.stiffness() + skeleton.bulk());
        if share < LEAST_SHARE {
            reasons.push(WaterReason::Soft { share });
        }
        reasons
    }

    /// Parts of the material whose elements lock.
    fn locking(&self, parts: &[Part]) -> Vec<WaterReason> {
        let poisson = self.material.medium().poisson;
        if self.material.pore_water().is_none() || poisson < LOCKING {
            return Vec::new();
        }
        let names = self.sets();
        let of_material = parts
            .iter()
            .filter(|part| names.contains(part.set.as_str()));
        let locks = of_material.filter_map(|part| {
            let elements = self.mesh.element_set(&part.set).unwrap_or_default();
            let has = |kind| elements.iter().any(|&e| self.mesh.kind(e) == kind);
            let own = part.kernel.as_ref().map(|kernel| kernel.name());
            let kernel = if own == Some("hex8-full") && has(ElementKind::Hex8) {
                "hex8-full"
            } else if has(ElementKind::Tet4) {
                "tet4"
            } else if has(ElementKind::Wedge6) {
                "wedge6"
            } else {
                return None;
            };
            Some(WaterReason::Locks {
                set: part.set.clone(),
                kernel,
                poisson,
            })
        });
        locks.collect()
    }

    /// Sets of the parts of the material.
    fn sets(&self) -> BTreeSet<&str> {
        let parts = self.file.parts.iter();
        let own = parts.filter(|part| *part.material == *self.name);
        own.map(|part| part.set.as_str()).collect()
    }

    /// The greatest difference between the pressures of the material and of the in-situ stress where there is ground from the start:
    /// of a material without water, where its law is not linear.
    fn other_pressure(&self, in_situ: &InSitu) -> Option<WaterReason> {
        if !in_situ.is_of_weight {
            return None;
        }
        let own = self.material.pore_water().map(|water| water.at_rest());
        if own.is_none() && self.material.law().is_linear() {
            return None;
        }
        let own = own.flatten();
        let later: BTreeSet<&str> = (self.file.stages.iter())
            .flat_map(|stage| stage.cast.iter().chain(&stage.excavate))
            .map(|set| set.as_str())
            .collect();
        let sets = self.sets().into_iter().filter(|set| !later.contains(set));
        let elements = sets.flat_map(|set| self.mesh.element_set(set).unwrap_or_default());
        let at = |water: Option<&WaterPressure>, z: f64| water.map(|water| water.pressure(z));
        let differences = elements.filter_map(|&element| {
            let z = self.mesh.centroid(element).z;
            let pressures = [at(own, z), at(in_situ.water.as_ref(), z)];
            let [a, b] = pressures.map(|pressure| pressure.unwrap_or(0.0));
            let differs = (a - b).abs() > SAME_PRESSURE * a.max(b);
            differs.then_some(((a - b).abs(), element, pressures))
        });
        let (_, element, pressures) = differences.max_by(|a, b| a.0.total_cmp(&b.0))?;
        Some(WaterReason::OtherPressure {
            element: self.mesh.element_tags()[element as usize],
            pressures,
        })
    }

    /// A level above the ground, which no water loads.
    fn above(&self, in_situ: &InSitu) -> Option<WaterReason> {
        let level = self.material.pore_water()?.at_rest()?.level()?;
        let (low, high) = self.mesh.bounding_box();
        let top = in_situ.ground.unwrap_or(high.z).min(high.z);
        let all =
            (self.file.loads.iter()).chain(self.file.stages.iter().flat_map(|stage| &stage.loads));
        let mut loads = all.filter(|load| matches!(***load, Load::Water { .. }));
        let is_above = level - top > 1e-6 * (high - low).norm();
        (is_above && loads.next().is_none()).then_some(WaterReason::Above { level, top })
    }
}
