//! The compiled part of the Python package `powerhouse_fe`: scenes, checks and runs, with results as NumPy arrays.
//!
//! Classes here are private to the package; the modules beside it in Python are its interface.
//!
//! # Why so
//! *A scene is a text and what its names mean.* Preparing a scene consumes it; a Python object is used many times.
//! So [`scene::Source`] keeps the text, the registry and what Python adds, and composes a new scene for every check and
//! run.
//!
//! *A run has a thread of its own.* The calling thread waits without the interpreter's lock and looks for signals in
//! between, so that Ctrl-C stops a run in order, other threads of Python go on, and functions in Python that a run calls
//! can have the lock.

mod alarm;
mod arrays;
mod check;
mod fault;
mod functions;
mod keys;
mod laws;
mod mesh;
mod results;
mod run;
mod scene;
mod steps;
mod studies;
mod table;
mod turns;
mod waiting;

use pyo3::prelude::*;

/// The compiled part of `powerhouse_fe`.
#[pymodule]
fn _core(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("version", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<scene::Scene>()?;
    module.add_class::<mesh::Mesh>()?;
    module.add_class::<check::Check>()?;
    module.add_class::<results::Results>()?;
    module.add_class::<results::KeptSnapshot>()?;
    module.add_class::<steps::Steps>()?;
    module.add_class::<studies::Trade>()?;
    module.add_class::<laws::LawPoints>()?;
    module.add_class::<table::Table>()?;
    module.add_function(wrap_pyfunction!(scene::toml_of, module)?)?;
    module.add_function(wrap_pyfunction!(studies::write_report, module)?)?;
    Ok(())
}
