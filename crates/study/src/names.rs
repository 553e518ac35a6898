//! What scenes can name beside what comes with the facade.

use std::path::Path;

use powerhouse::Registry;

use crate::bay::Bay;

/// The names that come with the software, and `bay`: the generator of meshes that makes a
/// [machine bay](crate::bay) from its file.
///
/// ```
/// let registry = powerhouse_study::registry();
/// assert!(registry.mesh_generator_names().any(|name| name == "bay"));
/// ```
pub fn registry() -> Registry {
    let mut registry = Registry::default();
    registry.add_mesh_generator("bay", |file: &Path| {
        let bay = Bay::from_file(file)?;
        bay.mesh().map(|bay| bay.mesh)
    });
    registry
}
