//! Common code of the test groups: bodies of elastic ground, incident waves, and errors against exact fields.
//!
//! The test groups, modules of one program (`cargo test --test shelves oracle`):
//! * `analytic`: closed forms; the tolerance follows from the mesh.
//! * `convergence`: the slope of the error against the element size.
//! * `invariance`: independence of the results from threads, lanes and the direction of the axes.
//! * `oracle`: the engine against a naive one that shares no code with it.
//! * `extremes`: the stable step, and components that must not reduce it.
//! * `regression`: stored results, with a log of the reasons of their changes.
//! * `published`: what others measured and published, against `docs/validated.md`.
//! * `architecture`: the shape of the workspace.
//!
//! All tests use the public interfaces of the crates. A test whose set-up fails panics with the reason.

mod ground;
mod misfit;
mod waves;

pub use ground::{Ground, elastic};
pub use misfit::{field_misfit, motion_at};
pub use waves::oblique_waves;
