//! Scenes: the complete input of an analysis, composed in Rust, and its run.
//!
//! A [`Scene`] is a mesh with parts, joints, ground motion, boundary, construction stages and output requests.
//! [`Scene::prepare`] checks it and gives a [`Simulation`], whose run gives [`Results`] in memory. Files of results are those
//! of `powerhouse-results`, scenes in files those of `powerhouse-scene-file`; a program depends on `powerhouse`, which has all of
//! them.
//!
//! # Why so
//! *The surroundings of a body are checked when a scene is prepared*, by sampling the incident field at the nodes
//! through which it enters: the body must start with the field's motion, the ground must be of one medium, free
//! surfaces must be without traction. So scenes from files and from programs, and fields of a user's own, are
//! checked alike.
//!
//! *Construction stages are checked when a scene is prepared and computed when it is run.* A check needs no
//! static solution: masses, stiffness and the stable step are those of the elements that are present in the
//! motion, wherever they have moved until then.
//!
//! *What made a scene knows its places.* [`Places`] gives an error of a scene its line and column in a file;
//! nothing else of a file is known here.

mod acting;
mod bay_times;
mod body;
mod boundary;
mod check_heights;
mod delayed;
mod delayed_error;
mod engine;
mod error;
mod fault;
mod fibre_choice;
mod fibre_price;
mod fibres;
mod field;
mod first_of_set;
mod held_field;
mod high_damping;
mod in_use;
mod input_spectrum;
mod joint;
mod joints;
mod layers;
#[doc(hidden)]
pub mod magnitude;
mod medium;
mod memory;
mod message;
mod mirror;
mod output;
mod part;
mod places;
mod prepare;
mod program_sources;
mod reduction;
mod region;
mod relief;
pub mod remark;
mod resolution;
mod rim;
mod scene;
mod simulation;
mod soundness;
mod stage;
mod surroundings;
mod threads;
mod through;
mod timing;
mod water_mass;

pub use bay_times::BayTimes;
pub(crate) use body::Piece;
pub use boundary::Boundary;
pub use delayed::StiffPart;
pub use delayed_error::DelayedError;
pub use error::{CheckpointError, Error, FolderError, KeyChangeError};
pub use fault::{Fault, Problem, SceneFault, SceneText};
pub use fibre_choice::{FibreChoice, FibreOptions};
pub use fibre_price::{FibreShift, InputShift, OF_FIBRES_ALONE};
pub use field::SceneField;
pub use first_of_set::FirstOfSet;
pub use high_damping::HighDamping;
pub use input_spectrum::EnergySpectrum;
pub use joint::{GroundStress, InitialGap, JointWater, JointZone, Preload, SceneJoint, WetJoint};
pub use layers::LayerError;
pub use magnitude::{Magnitude, MagnitudeOf, ProbableUnit};
pub use memory::LawMemory;
pub use message::{Message, RunNotes, Topic, merge_messages};
pub use mirror::{Mirror, MirrorError, Parity};
pub use output::{
    BendingError, BoltForces, ColumnPlot, EnergyResidual, EnvelopeRequest, HistoryRequest,
    JointRequest, ListContent, NameError, OutputItem, OutputPlan, OutputPrice, OutputScale,
    OutputSite, PlottedCurve, Recorder, RelativeRequest, ResultList, ResultTable, Results,
    RingRequest, SampledRequest, SectionRequest, SectionUse, SnapshotRequest, StateRequest,
    StressRequest, TableForm, TablePeaks, TablePlot, TablePlots, TableSink, file_name,
};
pub use part::{Kernel, Part};
pub use places::{Places, Subject};
pub(crate) use prepare::field_motion;
pub use program_sources::{ProgramSource, ProgramSources};
pub use reduction::reduction_layer;
pub use region::RegionError;
pub use remark::{
    EquivalentLayer, RecordSpectrumReport, Remark, SaturatedMaterial, Seepage, WaterReason,
    WaterWarning,
};
pub use resolution::Resolution;
pub use scene::{InitialMotion, ResidualLimit, Scene, TimeStep};
pub use simulation::{ProgressHook, RunHooks, Simulation};
pub use stage::{
    BoltLayout, CompletedStage, EquilibratedBody, InSituError, InSituStress, SceneBolts,
    SceneStage, StageCheckpointSink, StageHook, StageOverview, StageSink, StageSolution,
    StageWater, StagingError, WeightLayer,
};
pub use through::ThroughError;
pub use water_mass::{AddedWater, WaterBeside, WaterError};

/// Parts of scenes that crates of files and results need, and programs do not.
#[doc(hidden)]
pub mod internal {
    pub use crate::acting::{GRAVITY, SharedFunction, SharedLoad, StagedLoad};
    pub use crate::check_heights::CheckHeights;
    pub use crate::engine::{ExplicitOnDevice, Leapfrog, OneSided, standard_engine};
    pub use crate::in_use::InUse;
    pub use crate::layers::damping_of_layer;
    pub use crate::medium::sets_with;
    pub use crate::output::{NamedThing, check_names};
    pub use crate::scene::PrescribedMotion;
    pub use crate::stage::{Timeline, check_removal, surface_of};
    pub use crate::surroundings::{box_corners, fill_body};
}
