//! Registry of the names that scenes can use.

use std::path::Path;

use powerhouse::Registry;

use crate::bay::Bay;

/// Registry with all built-in names and the mesh generator `bay`, which generates a [machine bay](crate::bay) from
/// its file.
///
/// ```
/// let registry = powerhouse_wang_2019::registry();
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
