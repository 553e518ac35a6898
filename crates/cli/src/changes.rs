//! Options that change keys of a scene file.

use clap::Args;
use powerhouse::{KeyChange, SceneChoice};

/// Changed keys of a scene file.
#[derive(Args)]
pub(crate) struct Changes {
    /// Change of a key of the scene file, such as time.safety=0.5 or part.lining.kernel=hex8-eas; may be repeated. Of
    /// several tables of one kind its name, element set or position (from 1) says which is meant: wave.1.incidence=30.
    /// Results tell what was changed.
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<KeyChange>,
    /// Duration of the run (s), in place of the scene's.
    #[arg(long, value_name = "SECONDS", value_parser = crate::seconds)]
    duration: Option<f64>,
}

impl Changes {
    /// The scene of a file, or a case of it, with these changes, the duration last.
    pub(crate) fn of(self, case: Option<String>) -> SceneChoice {
        let mut changes = self.set;
        changes.extend(self.duration.map(KeyChange::duration));
        SceneChoice { case, changes }
    }
}
