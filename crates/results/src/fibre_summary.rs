//! Fibres of a run in its summary.

use serde::{Deserialize, Serialize};

use powerhouse_scene::Results;

/// Fibres of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct FibreSummary {
    /// Requested factor on the stable step.
    pub factor: f64,
    /// Stable step over that without fibres.
    pub gain: f64,
    /// Number of fibres.
    pub fibres: usize,
    /// Element sets with fibres.
    pub sets: Vec<String>,
    /// Largest added inertia over mass.
    pub most_added: f64,
    /// Decrease of a frequency as high as that of the input, as estimated before the run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub predicted: Option<f64>,
    /// Relative error of accelerations and shear forces, as estimated before the run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error_of_accelerations: Option<f64>,
    /// Relative error of axial forces and moments, as estimated before the run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error_of_forces: Option<f64>,
    /// Largest kinetic energy of the added inertia over that of the masses of the fibres: twice the decrease of the
    /// frequencies of their motion.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub share: Option<f64>,
}

impl FibreSummary {
    /// The fibres of a run; none of a run without.
    pub fn of(results: &Results) -> Option<Self> {
        let choice = results.fibres.as_ref()?;
        let of_input = choice.shift.and_then(|shift| shift.of_input);
        Some(Self {
            factor: choice.factor,
            gain: choice.gain(),
            fibres: choice.fibres.len(),
            sets: choice.sets.clone(),
            most_added: choice.most_added(),
            predicted: of_input.map(|input| input.shift),
            error_of_accelerations: of_input.map(|input| input.of_accelerations),
            error_of_forces: of_input.map(|input| input.of_forces),
            share: results.share_of_fibres(),
        })
    }

    /// What they do, to be shown beside accelerations and section forces.
    pub fn text(&self) -> String {
        let share = self.share.map_or_else(String::new, |share| {
            format!(
                "; their added inertia had at most {:.2} % of the kinetic energy of their masses",
                100.0 * share
            )
        });
        format!(
            "the step was {:.2} times as long by {} fibres in {}, in which the motion of nodes relative to each other is up to {:.1} times as heavy: accelerations, shear forces and floor spectra there feel it first{share}",
            self.gain,
            self.fibres,
            self.sets.join(", "),
            1.0 + self.most_added
        )
    }
}
