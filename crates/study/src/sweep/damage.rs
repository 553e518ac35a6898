//! Damage of the structure and its parts.

use powerhouse::engine::observe::StateTable;
use powerhouse::model::Mesh;
use serde::{Deserialize, Serialize};

/// Name of the element set whose damage is evaluated.
pub(super) const STRUCTURE: &str = "structure";
/// Damage above which an element counts as damaged.
pub(super) const DAMAGED: f64 = 0.1;
/// Damage above which an element is severely damaged, over the greatest damage of the structure.
const SEVERE: f64 = 0.5;

/// Greatest damage over the dynamic run of the elements of a set of the structure, where construction stages have left
/// damage included; shares refer to the volume of the set.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PartDamage {
    /// Name of the element set.
    pub name: String,
    /// Volume of the set (m3).
    pub volume: f64,
    /// Mean over the volume of the greatest damage, from 0 to 1.
    pub mean: f64,
    /// Greatest damage of an element, from 0 to 1.
    pub greatest: f64,
    /// Share of the volume with a damage above 0.1.
    pub damaged: f64,
    /// Share of the volume damaged by tension alone.
    pub tension: f64,
    /// Share of the volume damaged by compression or shear alone.
    pub compression: f64,
    /// Share of the volume damaged by both tension and compression or shear.
    pub both: f64,
    /// Share of the volume with more than half of the greatest damage of the set `structure`.
    pub severe: f64,
    /// Share of that severely damaged volume in which tensile damage exceeds compressive damage.
    pub severe_tension: f64,
}

/// Damage of each element of a mesh; zero where the law has no damage variable.
pub(super) struct Damage {
    /// Total damage.
    pub(super) whole: Vec<f64>,
    tension: Vec<f64>,
    compression: Vec<f64>,
    /// Cause of damage: 0 none, 1 tension, 2 compression or shear, 3 both.
    pub(super) kinds: Vec<f64>,
}

impl Damage {
    /// The greatest damage of each element over a run; `None` if no law has a damage variable.
    pub(super) fn of(mesh: &Mesh, state: &StateTable) -> Option<Self> {
        let over_mesh = |values: &[f64]| {
            let mut all = vec![0.0; mesh.element_count()];
            for (&element, &value) in state.elements.iter().zip(values) {
                all[element as usize] = value;
            }
            all
        };
        let amount = |name: &str| {
            let found = state
                .peaks
                .iter()
                .find(|(variable, _)| variable.name == name);
            Some(over_mesh(&found?.1.values))
        };
        let whole = amount("damage")?;
        let none = || vec![0.0; whole.len()];
        let tension = amount("damage_tension").unwrap_or_else(none);
        let compression = amount("damage_compression").unwrap_or_else(none);
        let flags = state.flags.iter();
        let mut flags = flags.filter(|(variable, _)| variable.name == "damage_type");
        let kinds = match flags.next() {
            Some((_, kinds)) => over_mesh(kinds),
            None => (tension.iter().zip(&compression))
                .map(|(&t, &c)| f64::from(u8::from(t > 0.0) + 2 * u8::from(c > 0.0)))
                .collect(),
        };
        Some(Self {
            whole,
            tension,
            compression,
            kinds,
        })
    }

    /// The damage of the set `structure` and of all element sets within it; empty without such a set. Sets without
    /// volume, of bars, are left out.
    pub(super) fn parts(&self, mesh: &Mesh) -> Vec<PartDamage> {
        let Ok(structure) = mesh.element_set(STRUCTURE) else {
            return Vec::new();
        };
        let greatest = |elements: &[u32]| -> f64 {
            let of = elements.iter().map(|&element| self.whole[element as usize]);
            of.fold(0.0, f64::max)
        };
        let severe = SEVERE * greatest(structure);
        let within = |elements: &[u32]| elements.iter().all(|e| structure.binary_search(e).is_ok());
        let sets = mesh.element_sets().iter();
        let sets = sets.filter(|(_, elements)| !elements.is_empty() && within(elements));
        let parts = sets.filter_map(|(name, elements)| {
            let volumes: Vec<(usize, f64)> = (elements.iter())
                .map(|&element| (element as usize, mesh.volume(element)))
                .collect();
            let sum = |value: &dyn Fn(usize) -> f64| -> f64 {
                volumes.iter().map(|&(e, volume)| volume * value(e)).sum()
            };
            let share = |of: f64, value: &dyn Fn(usize) -> bool| match of {
                0.0 => 0.0,
                of => sum(&|element| f64::from(u8::from(value(element)))) / of,
            };
            let whole = sum(&|_| 1.0);
            if whole <= 0.0 {
                return None;
            }
            let is_severe = |e: usize| severe > 0.0 && self.whole[e] > severe;
            let severely = sum(&|element| f64::from(u8::from(is_severe(element))));
            Some(PartDamage {
                name: name.clone(),
                volume: whole,
                mean: sum(&|e| self.whole[e]) / whole,
                greatest: greatest(elements),
                damaged: share(whole, &|e| self.whole[e] > DAMAGED),
                tension: share(whole, &|e| self.kinds[e] == 1.0),
                compression: share(whole, &|e| self.kinds[e] == 2.0),
                both: share(whole, &|e| self.kinds[e] == 3.0),
                severe: share(whole, &is_severe),
                severe_tension: share(severely, &|e| {
                    is_severe(e) && self.tension[e] > self.compression[e]
                }),
            })
        });
        parts.collect()
    }
}

#[cfg(test)]
mod tests {
    use powerhouse::model::Vec3;

    use super::*;

    /// Shares of damage are those of the volume: of the whole set, and of its severely damaged part that which tension has damaged
    /// most, to which elements with less damage do not belong.
    #[test]
    fn shares_refer_to_the_volume() {
        let size = Vec3::new(4.0, 1.0, 1.0);
        let mesh = Mesh::box_of_hexes(Vec3::zeros(), size, [4, 1, 1], STRUCTURE).unwrap();
        // Volumes of 1, 3, 5 and 7 m3.
        let mesh = mesh.map_positions(|at| Vec3::new(at.x * at.x, at.y, at.z));
        let damage = Damage {
            whole: vec![0.9, 0.8, 0.3, 0.0],
            tension: vec![0.9, 0.1, 0.3, 0.0],
            compression: vec![0.1, 0.8, 0.0, 0.0],
            kinds: vec![3.0, 2.0, 1.0, 0.0],
        };
        let parts = damage.parts(&mesh.unwrap());
        let part = &parts[0];
        for (found, expected) in [
            (part.volume, 16.0),
            (part.mean, (0.9 + 3.0 * 0.8 + 5.0 * 0.3) / 16.0),
            (part.greatest, 0.9),
            (part.damaged, 9.0 / 16.0),
            (part.tension, 5.0 / 16.0),
            (part.compression, 3.0 / 16.0),
            (part.both, 1.0 / 16.0),
            (part.severe, 4.0 / 16.0),
            (part.severe_tension, 1.0 / 4.0),
        ] {
            assert!((found - expected).abs() < 1e-12, "{part:?}");
        }
        assert_eq!((parts.len(), part.name.as_str()), (1, STRUCTURE));
    }
}
