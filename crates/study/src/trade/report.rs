//! Goal, progress callbacks and results of a trade study.

use std::path::PathBuf;
use std::time::Duration;

use powerhouse::ProgressHook;

use super::{CaseCost, Factor};
use crate::price::ParetoPoint;
use crate::{CheckpointEvent, StudyError};

/// Goal of a trade study.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Goal {
    /// The Pareto front of cost and error; no run is chosen.
    Front,
    /// The cheapest run whose relative error, with that of the reference added, is at most this.
    Error(f64),
    /// The most accurate run whose wall time for the whole scene is at most this (s).
    Budget(f64),
}

/// Reference of the errors of a trade study.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reference {
    /// The run with every factor at its most accurate level.
    #[default]
    Finest,
    /// The incident field, for ground without a structure.
    ClosedForm,
}

/// Progress callbacks of a trade study, called one after the other by the thread that runs the study; it waits for their
/// return. They do nothing by default.
pub trait TradeWatch {
    /// Called before the first run, with the greatest number of runs, their duration (s of the scene), and the predicted
    /// upper bound of the wall time of all.
    fn before(&mut self, _runs: usize, _window: f64, _at_most: Duration) {}
    /// Called when a run begins, with its name and its number from 1.
    fn begins(&mut self, _name: &str, _number: usize) {}
    /// Called after [`begins`](Self::begins) when the results of an earlier run are reused, with the name of the run.
    fn reused(&mut self, _name: &str) {}
    /// Called when a run, given by its name, goes on from a checkpoint, or one cannot be used or written.
    fn checkpoint(&mut self, _name: &str, _event: CheckpointEvent) {}
    /// Returns the progress hook for the time steps of a run, which a thread of the run calls; `None` for no progress.
    fn progress(&mut self) -> Option<ProgressHook<'static>> {
        None
    }
    /// Called after the perturbation test, with the excluded histories, those that change most first.
    fn sensitive_histories(&mut self, _sensitive: &[SensitiveHistory]) {}
    /// Called when a run is invalid or fails and the study continues without it. A failure of the reference ends the study
    /// without this call, unless a finer tolerance of the stages is given up.
    fn fails(&mut self, _name: &str, _error: &StudyError) {}
    /// Called when a combination of levels is finished or reused, with its cost and error.
    fn ends(&mut self, _case: &TradeCase) {}
    /// Called after the run on the refined mesh, with the estimated error of the mesh.
    fn mesh_error(&mut self, _mesh: &MeshError) {}
}

/// Progress callbacks that do nothing.
pub struct NoProgress;

impl TradeWatch for NoProgress {}

/// Cost and error of one run of a trade study.
#[derive(Clone, Debug, PartialEq)]
pub struct TradeCase {
    /// Name of the run: the levels in which it differs from the most accurate levels, or `reference` for these.
    pub name: String,
    /// Index of the level of each factor, in the order of [`TradeReport::factors`].
    pub levels: Vec<usize>,
    /// Cost of a run over the whole duration of the scene, from that over the window.
    pub cost: CaseCost,
    /// Largest relative L2 error over the window (1) among the compared histories, without the error of the reference.
    pub error: f64,
    /// Name of the history with this error, such as `crown [m/s2]`.
    pub worst: String,
}

impl TradeCase {
    /// The run as a point of the cost-error diagram: wall time of the whole run (s) and relative error.
    pub fn pareto_point(&self) -> ParetoPoint {
        ParetoPoint {
            name: self.name.clone(),
            cost: self.cost.wall_time(),
            error: self.error,
        }
    }
}

/// History with sensitive dependence on the input, found by the perturbation test and excluded from errors.
#[derive(Clone, Debug, PartialEq)]
pub struct SensitiveHistory {
    /// Name of the history, such as `crown [m/s2]`.
    pub history: String,
    /// Relative L2 change (1) of the history in the reference under waves of 1 + 1e-6 times the amplitude.
    pub change: f64,
}

/// Discretisation error of a mesh, estimated by a run of the reference with elements of half the size.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshError {
    /// Estimated relative L2 error of the scene's mesh (1), the largest among the compared histories.
    pub error: f64,
    /// Name of the history with the largest error.
    pub worst: String,
    /// Cost of the run on the refined mesh.
    pub cost: CaseCost,
}

/// Results of a trade study.
#[derive(Clone, Debug, PartialEq)]
pub struct TradeReport {
    /// Title of the scene.
    pub title: String,
    /// Factors with their levels.
    pub factors: Vec<Factor>,
    /// All finished combinations of levels, the reference first; neither the perturbed nor the refined run is among them.
    pub cases: Vec<TradeCase>,
    /// Excluded histories with sensitive dependence on the input, those that change most first.
    pub sensitive: Vec<SensitiveHistory>,
    /// Names of the runs that were invalid or failed, with the messages of their errors.
    pub failed: Vec<(String, String)>,
    /// Estimated relative error of the reference, without that of the mesh; `None` if no other time step was run.
    pub reference_error: Option<f64>,
    /// Error of the mesh, if it was [requested](super::Trade::with_mesh_error).
    pub mesh: Option<MeshError>,
    /// Duration of the runs (s), if it is shorter than that of the scene and laws or joints have history variables.
    ///
    /// Later yielding, cracking or slip may increase the errors: for the bay of the paper from 4 % in 1.5 s to 35 % in
    /// 20 s.
    pub partial_window: Option<f64>,
    /// Indices in [`cases`](Self::cases) of the runs on the Pareto front of cost and error, the cheapest first.
    pub front: Vec<usize>,
    /// Index in [`cases`](Self::cases) of the best run that meets the goal; `None` for [`Goal::Front`] or if none does.
    pub chosen: Option<usize>,
    /// Written files, the scene of the chosen run first if there is one.
    pub files: Vec<PathBuf>,
}

impl TradeReport {
    /// All runs as points of the cost-error diagram: wall time of the whole run (s) and relative error.
    pub fn pareto_points(&self) -> Vec<ParetoPoint> {
        self.cases.iter().map(TradeCase::pareto_point).collect()
    }
}
