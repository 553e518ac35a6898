//! Files in whose memory the mesh of a run is.

use std::sync::Arc;

use powerhouse_model::Engine;

use crate::Error;

/// Check of a file in whose memory a mesh is.
pub type InUse = Arc<dyn Fn() -> Result<(), Error> + Send + Sync>;

/// Checks that the file in whose memory a mesh is has not been changed, in any process that computes with an engine.
pub(crate) fn check_in_use(in_use: Option<&InUse>, engine: &dyn Engine) -> Result<(), Error> {
    let Some(check) = in_use else {
        return Ok(());
    };
    let own = check();
    let is_same = engine.is_on_all(own.is_ok())?;
    own?;
    if is_same {
        Ok(())
    } else {
        Err(Error::MeshInUse(
            "the packed mesh was changed, as another rank found".into(),
        ))
    }
}
