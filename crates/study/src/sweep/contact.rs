//! Results of the joints of a case, and their correlation with the damage of the lining.

use std::collections::HashMap;

use powerhouse::Results;
use powerhouse::engine::observe::{JointOutcome, JointTable};
use powerhouse::model::{Bond, JointRecord, Mesh};
use serde::{Deserialize, Serialize};

use super::damage::{Damage, STRUCTURE};

/// Results of a joint, or of a part of one, at the end of a case; shares refer to its area. What construction stages left
/// counts, from the last re-initialisation of the joint on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct JointCase {
    /// Name of the joint or part.
    pub name: String,
    /// Area of the joint, or of the part of it (m2), to which shares refer.
    pub area: f64,
    /// Share of the area that slipped at any time, from 0 to 1.
    pub slipped: f64,
    /// Share of the area that was open at any time, from 0 to 1; pairs with an initial gap count.
    pub opened: f64,
    /// Share of the area whose bond is broken, from 0 to 1.
    pub broken: f64,
    /// Largest accumulated slip of a pair (m).
    pub slip: f64,
    /// Largest opening of a pair at any time (m).
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

/// Relation between joint failure and damage of the structure, over the elements of the structure that touch joints.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct JointAndLining {
    /// Share of the area of all joints that slipped, opened or lost its bond, from 0 to 1.
    pub failed: f64,
    /// Number of elements of the set `structure` with a node of a joint; 0 without damage variables.
    pub elements: usize,
    /// Mean of the greatest damage of the elements at whose nodes at least half of the joint area failed (slipped, opened
    /// or lost its bond); `None` if there are none.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub damage_at_failed: Option<f64>,
    /// Mean of the greatest damage of the other elements; `None` if there are none.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub damage_at_held: Option<f64>,
    /// Correlation coefficient of failed share and damage over the elements; `None` if either is constant.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub correlation: Option<f64>,
}

/// Whether a node pair slipped, opened or lost its bond.
fn failed(record: &JointRecord) -> bool {
    let moved = record.first_slip.is_some() || record.first_crack.is_some();
    moved || record.state.bond == Bond::Broken
}

impl JointAndLining {
    /// Evaluates all joints of a run; `None` without joints.
    pub(super) fn of(mesh: &Mesh, results: &Results, damage: Option<&Damage>) -> Option<Self> {
        // Area and failed area of the pairs at each node.
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

/// Pearson's correlation coefficient; `None` if either variable is constant.
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

    /// Points on a rising line have the correlation 1, on a falling one -1; a constant variable has none.
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
