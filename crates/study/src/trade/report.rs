//! What is wanted of a trade, what it tells on its way and what it finds.

use std::path::PathBuf;
use std::time::Duration;

use powerhouse::ProgressHook;

use super::{CaseCost, Factor};
use crate::StudyError;
use crate::price::Price;

/// What is wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Goal {
    /// The front alone.
    Front,
    /// The cheapest run whose error, with that of the reference, is at most this.
    Error(f64),
    /// The most accurate run that takes at most this wall time (s).
    Budget(f64),
}

/// What errors are measured against.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reference {
    /// The run in which every factor that is left to choose is at its most accurate level.
    #[default]
    Finest,
    /// The field that comes in, for ground without a structure.
    ClosedForm,
}

/// Is told how a trade goes.
pub trait TradeWatch {
    /// Before anything runs: how many runs there will be at most, of how many seconds of the scene, and
    /// how long all of them will take.
    fn before(&mut self, _runs: usize, _window: f64, _at_most: Duration) {}
    /// A run begins: its name and its place from 1.
    fn begins(&mut self, _name: &str, _place: usize) {}
    /// It was finished before.
    fn kept(&mut self, _name: &str) {}
    /// The hook for its steps.
    fn progress(&mut self) -> Option<ProgressHook<'static>> {
        None
    }
    /// The histories that do not repeat are known, those that change most first.
    fn sets_aside(&mut self, _unrepeated: &[Unrepeated]) {}
    /// It failed; the others go on.
    fn fails(&mut self, _name: &str, _error: &StudyError) {}
    /// It is finished.
    fn ends(&mut self, _case: &TradeCase) {}
    /// The run on smaller elements is finished.
    fn tells_mesh(&mut self, _mesh: &MeshError) {}
}

/// Hears nothing.
pub struct Silent;

impl TradeWatch for Silent {}

/// A run of a trade.
#[derive(Clone, Debug, PartialEq)]
pub struct TradeCase {
    /// The levels in which it differs from the reference, or `reference`.
    pub name: String,
    /// The level of each factor.
    pub levels: Vec<usize>,
    /// What it costs.
    pub cost: CaseCost,
    /// Its relative error, that of the reference aside.
    pub error: f64,
    /// The history that has this error.
    pub worst: String,
}

impl TradeCase {
    /// The wall time of the whole run (s) and the error.
    pub fn price(&self) -> Price {
        Price {
            name: self.name.clone(),
            cost: self.cost.wall_time(),
            error: self.error,
        }
    }
}

/// A history that no choice repeats.
#[derive(Clone, Debug, PartialEq)]
pub struct Unrepeated {
    /// The history, such as `crown [m/s2]`.
    pub history: String,
    /// The relative L2 change of it in the reference, under waves that are larger by a millionth.
    pub change: f64,
}

/// What a mesh errs by, as a run of the reference on elements half the size tells it.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshError {
    /// The relative error of the scene's mesh, about.
    pub error: f64,
    /// The history that has it.
    pub worst: String,
    /// What the run on smaller elements costs.
    pub cost: CaseCost,
}

/// What a trade found.
#[derive(Clone, Debug, PartialEq)]
pub struct TradeReport {
    /// The scene's title.
    pub title: String,
    /// The factors.
    pub factors: Vec<Factor>,
    /// All runs.
    pub cases: Vec<TradeCase>,
    /// Histories that no choice repeats, which count nowhere; those that change most first.
    pub unrepeated: Vec<Unrepeated>,
    /// Levels with which a run was refused or failed, and why.
    pub failed: Vec<(String, String)>,
    /// The estimated error of the reference itself, that of the mesh aside; none if no other step was run.
    pub reference_error: Option<f64>,
    /// The error of the mesh, if that was [asked for](super::Trade::with_mesh_error).
    pub mesh: Option<MeshError>,
    /// How much was run (s), if it was not all and the scene has laws or joints with history variables: what yields,
    /// cracks or slips after it may err by more. Of the bay of the paper 4 % in 1.5 s were 35 % in 20 s.
    pub foreseen: Option<f64>,
    /// The places of the runs that no other betters in cost and error, the cheapest first.
    pub front: Vec<usize>,
    /// The place of the run that meets the goal, if one does.
    pub chosen: Option<usize>,
    /// Files that were written, the chosen scene first if there is one.
    pub files: Vec<PathBuf>,
}

impl TradeReport {
    /// What the runs cost, as wall times of the whole run (s), and err.
    pub fn prices(&self) -> Vec<Price> {
        self.cases.iter().map(TradeCase::price).collect()
    }
}
