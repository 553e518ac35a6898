//! Joints of a case, and how their failure goes with the damage of what they bind.

use std::collections::HashMap;

use powerhouse::Results;
use powerhouse::engine::observe::{JointOutcome, JointTable};
use powerhouse::model::{Bond, JointRecord, Mesh};
use serde::{Deserialize, Serialize};

use super::damage::{Damage, STRUCTURE};

/// A joint, or a part of one, at the end; shares are of its area.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct JointCase {
    /// Its name.
    pub name: String,
    /// Area (m2).
    pub area: f64,
    /// Ever slid.
    pub slipped: f64,
    /// Ever opened.
    pub opened: f64,
    /// Lost its bond.
    pub broken: f64,
    /// Largest accumulated slip (m).
    pub slip: f64,
    /// Largest opening (m).
    pub opening: f64,
}

impl JointCase {
    pub(super) fn of(joint: &JointOutcome) -> Self {
        Self {
            name: joint.name.clone(),
            area: joint.area,
            slipped: joint.slipped,
            opened: joint.opened,
            broken: joint.broken,
            slip: joint.slip.0,
            opening: joint.peak_opening.0,
        }
    }
}

/// How the failure of a joint goes with the damage of the structure beside it, element by element of the
/// structure that touches the joint.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct JointAndLining {
    /// The share of the joint's area that slid, opened or lost its bond.
    pub failed: f64,
    /// How many elements touch it.
    pub elements: usize,
    /// The mean damage of those at which at least half of the joint failed; none if there are none.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub damage_at_failed: Option<f64>,
    /// The mean damage of the others; none if there are none.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub damage_at_held: Option<f64>,
    /// The correlation of failed share and damage; none where either is the same everywhere.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub correlation: Option<f64>,
}

/// Whether a pair has failed in any way.
fn failed(record: &JointRecord) -> bool {
    let moved = record.first_slip.is_some() || record.first_crack.is_some();
    moved || record.state.bond == Bond::Broken
}

impl JointAndLining {
    /// Of all joints of a run that touch the structure; none if none does.
    pub(super) fn of(mesh: &Mesh, results: &Results, damage: Option<&Damage>) -> Option<Self> {
        // Area and failed area that the pairs give to each node.
        let mut at_node: HashMap<u32, [f64; 2]> = HashMap::new();
        let mut areas = [0.0; 2];
        for JointTable { pairs, records, .. } in &results.joints {
            for (pair, record) in pairs.iter().zip(records) {
                let own = [pair.area, if failed(record) { pair.area } else { 0.0 }];
                for node in pair.nodes {
                    let sum = at_node.entry(node).or_default();
                    *sum = [sum[0] + own[0], sum[1] + own[1]];
                }
                areas = [areas[0] + own[0], areas[1] + own[1]];
            }
        }
        if areas[0] == 0.0 {
            return None;
        }
        let share_of = |element: u32| {
            let nodes = mesh.nodes_of(element).iter();
            let found = nodes.filter_map(|node| at_node.get(node));
            let [all, failed] = found.fold([0.0; 2], |sum, own| [sum[0] + own[0], sum[1] + own[1]]);
            (all > 0.0).then(|| failed / all)
        };
        let structure = mesh.element_set(STRUCTURE).unwrap_or_default();
        let beside: Vec<(f64, f64)> = structure
            .iter()
            .filter_map(|&element| Some((share_of(element)?, damage?.whole[element as usize])))
            .collect();
        let mean = |side: &dyn Fn(f64) -> bool| {
            let of: Vec<f64> = (beside.iter().filter(|(share, _)| side(*share)))
                .map(|(_, damage)| *damage)
                .collect();
            (!of.is_empty()).then(|| of.iter().sum::<f64>() / of.len() as f64)
        };
        Some(Self {
            failed: areas[1] / areas[0],
            elements: beside.len(),
            damage_at_failed: mean(&|share| share >= 0.5),
            damage_at_held: mean(&|share| share < 0.5),
            correlation: correlation(&beside),
        })
    }
}

/// Pearson's correlation; none where either number is the same everywhere.
fn correlation(pairs: &[(f64, f64)]) -> Option<f64> {
    let count = pairs.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>() / count;
    let same = |of: fn(&(f64, f64)) -> f64| pairs.windows(2).all(|two| of(&two[0]) == of(&two[1]));
    if same(|pair| pair.0) || same(|pair| pair.1) {
        return None;
    }
    let (x, y) = (mean(|pair| pair.0), mean(|pair| pair.1));
    let sum = |of: &dyn Fn(f64, f64) -> f64| -> f64 {
        pairs.iter().map(|pair| of(pair.0 - x, pair.1 - y)).sum()
    };
    let spread = (sum(&|x, _| x * x) * sum(&|_, y| y * y)).sqrt();
    Some(sum(&|x, y| x * y) / spread)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points on a rising line have the correlation 1, on a falling one -1; of what never changes there
    /// is none.
    #[test]
    fn a_line_correlates_with_itself() {
        let line = |slope: f64| [0.0, 0.2, 0.7].map(|x| (x, 0.1 + slope * x));
        let near = |found: Option<f64>, wanted: f64| (found.unwrap() - wanted).abs() < 1e-12;
        assert!(near(correlation(&line(0.5)), 1.0));
        assert!(near(correlation(&line(-2.0)), -1.0));
        assert_eq!(correlation(&line(0.0)), None);
        assert_eq!(correlation(&[]), None);
    }
}
