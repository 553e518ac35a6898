//! Scenes, from files and from Rust, and the results of their runs.

mod capacity;
mod checkpoints;
mod layers;
#[cfg(feature = "pictures")]
mod run_results;
#[cfg(feature = "scene-files")]
mod scene_faults;
#[cfg(all(feature = "scene-files", feature = "pictures"))]
mod scenes;
#[cfg(feature = "scene-files")]
mod schema;
#[cfg(feature = "scene-files")]
mod stations;
#[cfg(feature = "scene-files")]
mod through;
#[cfg(feature = "scene-files")]
mod topography;
