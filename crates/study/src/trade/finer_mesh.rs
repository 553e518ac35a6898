//! What the mesh of a scene errs by.

use powerhouse::Scene;
use toml::Value;

use super::case::TradeRunner;
use super::misfit::misfit;
use super::{MeshError, Silent, Trade, TradeWatch, Unrepeated, factor};
use crate::StudyError;

/// Elements half the size: so many times as many, and as many times the steps.
pub(super) const OF_HALF_THE_SIZE: (u32, u32) = (8, 2);
/// Error of a mesh over the difference from one of half the size, of second order.
const SECOND_ORDER: f64 = 4.0 / 3.0;
/// The same of first order.
const FIRST_ORDER: f64 = 2.0;
/// The name of that run and of its folder.
pub(super) const REFINED: (&str, &str) = ("reference on elements half the size", "refined");

impl Trade {
    /// The file of the reference on elements half the size.
    ///
    /// # Errors
    /// One that cannot be read: it names elements by their numbers, or is cut too often;
    /// [`StudyError::MoreLoad`].
    pub(super) fn refined_text(&self) -> Result<String, StudyError> {
        let design = vec![0; self.factors.len()];
        let mut file = self.file_of(&design);
        if let Some(Value::Table(mesh)) = file.get_mut("mesh") {
            let own = mesh.get("refine").and_then(Value::as_integer);
            mesh.insert("refine".into(), (own.unwrap_or(0) + 1).into());
        }
        let text = self.written(&file)?;
        let fine = Scene::from_toml(text.as_str(), &self.path, &self.registry)?;
        let coarse = self.scene(&design)?;
        for set in factor::nodal_loads(&file) {
            let count = |scene: &Scene| {
                scene
                    .mesh()
                    .nodes_of_set(set)
                    .map_or(0, |nodes| nodes.len())
            };
            let (nodes, more) = (count(&coarse), count(&fine));
            if nodes != more {
                let set = set.to_owned();
                return Err(StudyError::MoreLoad { set, nodes, more });
            }
        }
        Ok(text)
    }

    /// What the scene's mesh errs by in all histories but some, from its file on smaller elements.
    pub(super) fn error_of_mesh(
        &self,
        (text, left_out): (&str, &[Unrepeated]),
        runner: &mut TradeRunner,
        watch: &mut dyn TradeWatch,
    ) -> Result<MeshError, StudyError> {
        let (name, folder) = REFINED;
        let design = vec![0; self.factors.len()];
        let coarse = self.finish(&design, runner, &mut Silent, name)?;
        let fine = self.finish_file(text, (folder, folder), runner, (watch, name))?;
        let compared = self.compared.among(fine.histories);
        let motions = self.compared.motions(&compared);
        let (truth, order) = match motions.len() {
            0 | 1 => (compared, FIRST_ORDER),
            _ => (motions, SECOND_ORDER),
        };
        let misfit = misfit(&truth, &coarse.histories, left_out);
        let mesh = MeshError {
            error: order * misfit.error,
            worst: misfit.name,
            cost: fine.cost,
        };
        watch.tells_mesh(&mesh);
        Ok(mesh)
    }
}
