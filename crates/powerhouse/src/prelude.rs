//! Types of a program that composes and runs a scene, for one `use` line.
//!
//! ```
//! use powerhouse::prelude::*;
//! use std::sync::Arc;
//!
//! // A cube of rock under a free surface, struck by an SV wave straight up.
//! let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(400.0), [4, 4, 4], "rock")?;
//! let top = Vec3::new(200.0, 200.0, 400.0);
//! let parameters = PlaneWaveParameters::vertical(WaveKind::SV, media::ROCK, 400.0);
//! let wave = PlaneWave::new(parameters, Arc::new(SmoothPulse::new(0.01, 0.4)?))?;
//! let faces = ["left", "right", "front", "back", "bottom"];
//! let results = Scene::new("box", mesh)
//!     .part(Part::new("rock", Material::from(LinearElastic::new(media::ROCK))))
//!     .with_field(wave)
//!     .with_boundary(Boundary::new(ViscousSpring::default(), faces).with_scatterer(top))
//!     .with_duration(0.5)
//!     .with_output(OutputPlan::default().history("top", top, Motion::DISPLACEMENT))
//!     .prepare()?
//!     .run(RunHooks::default())?;
//! assert!(results.histories().column("top.ux").is_some());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub use powerhouse_boundary::{Viscous, ViscousSpring};
pub use powerhouse_elements::SolidKernel;
pub use powerhouse_material_damage::{LinearElastic, media};
pub use powerhouse_model::{
    ElasticMedium, Mesh, Precision, Prescribed, StaticOptions, Support, Vec3,
};
pub use powerhouse_observe::{Motion, Place};
pub use powerhouse_wavefield::{
    Angle, PlaneWave, PlaneWaveParameters, SmoothPulse, TimeHistory, WaveKind,
};

pub use crate::{
    Boundary, Damping, Material, OutputPlan, Part, Results, RunHooks, Scene, SceneJoint,
    SceneStage, Simulation, TimeStep,
};

#[cfg(feature = "scene-files")]
pub use crate::{FileScene, Registry};
