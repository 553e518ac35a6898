//! Results of a run as files.
//!
//! A [`ResultFolder`] has tables, summary, VTU files, plots and pictures of a run, [`CheckpointFiles`] the states from which it
//! is resumed or from which variants of it start. What is written comes from a
//! [`Scene`](powerhouse_scene::Scene)'s [`Simulation`](powerhouse_scene::Simulation) and its
//! [`Results`](powerhouse_scene::Results).

mod checkpoint;
#[cfg(feature = "pictures")]
mod drawing;
mod fibre_summary;
mod folder;
mod joints;
mod lock;
mod names;
mod running;
mod stages;
pub mod summary;
mod vtu;

pub use checkpoint::{CheckpointFiles, CheckpointWriter, KeptState, ResumedRun, RunInputs};
pub use folder::ResultFolder;
pub use lock::FolderLock;
pub use names::result_files;
pub use running::RunningTables;
