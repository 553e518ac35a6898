//! Damage of the structure, part by part.

use powerhouse::engine::observe::StateTable;
use powerhouse::model::Mesh;
use serde::{Deserialize, Serialize};

/// The element set whose damage is looked at.
pub(super) const STRUCTURE: &str = "structure";
/// Damage from which on a place counts as damaged.
pub(super) const DAMAGED: f64 = 0.1;
/// Damage is severe from this share of the greatest in the structure.
const SEVERE: f64 = 0.5;

/// Damage of an element set of the structure; shares are of its volume.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PartDamage {
    /// The name of the set.
    pub name: String,
    /// Its volume (m3).
    pub volume: f64,
    /// The mean damage over the volume.
    pub mean: f64,
    /// The greatest damage.
    pub greatest: f64,
    /// Damaged by more than a tenth.
    pub damaged: f64,
    /// Damaged by tension alone.
    pub tension: f64,
    /// Damaged by compression or shear alone.
    pub compression: f64,
    /// Damaged by both.
    pub both: f64,
    /// Damaged by more than half the greatest of the structure.
    pub severe: f64,
    /// Of that, where tension does more than compression or shear.
    pub severe_tension: f64,
}

/// The damage of each element of a mesh, zero where the law knows none.
pub(super) struct Damage {
    /// The whole damage.
    pub(super) whole: Vec<f64>,
    tension: Vec<f64>,
    compression: Vec<f64>,
    /// 0 nothing, 1 tension, 2 compression or shear, 3 both.
    pub(super) kinds: Vec<f64>,
}

impl Damage {
    /// The greatest damage of a run; none if no law knows damage.
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

    /// The damage of the structure and of every set of which all elements belong to it; nothing if
    /// the mesh names no structure. Sets of bars alone are left out.
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
