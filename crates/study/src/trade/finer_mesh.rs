//! Discretisation error of a scene's mesh, from a run on a refined mesh.

use powerhouse::{FileScene, Scene, SceneSpec};

use super::case::TradeRunner;
use super::misfit::misfit;
use super::{MeshError, NoProgress, SensitiveHistory, Trade, TradeWatch, factor};
use crate::StudyError;

/// Factors on the numbers of elements and steps for elements of half the size.
pub(super) const OF_HALF_THE_SIZE: (u32, u32) = (8, 2);
/// Error of a mesh over its difference from one of half the element size, for second-order convergence.
const SECOND_ORDER: f64 = 4.0 / 3.0;
/// The same for first-order convergence.
const FIRST_ORDER: f64 = 2.0;
/// Name of the run on the refined mesh, and of its folder.
pub(super) const REFINED: (&str, &str) = ("reference on elements half the size", "refined");

/// Checks that the nodal loads of a scene act on as many nodes of a finer mesh.
///
/// # Errors
/// [`StudyError::MoreLoad`].
pub(crate) fn check_same_loads(
    spec: &SceneSpec,
    coarse: &Scene,
    fine: &Scene,
) -> Result<(), StudyError> {
    for set in factor::nodal_loads(spec) {
        let count = |scene: &Scene| {
            let nodes = scene.mesh().nodes_of_set(set);
            nodes.map_or(0, |nodes| nodes.len())
        };
        let (nodes, more) = (count(coarse), count(fine));
        if nodes != more {
            let set = set.to_owned();
            return Err(StudyError::MoreLoad { set, nodes, more });
        }
    }
    Ok(())
}

impl Trade {
    /// The scene of the reference with elements of half the size.
    ///
    /// # Errors
    /// A scene that cannot be refined, since it names elements by their numbers or is refined too often;
    /// [`StudyError::MoreLoad`].
    pub(super) fn refined(&self) -> Result<SceneSpec, StudyError> {
        let design = vec![0; self.factors.len()];
        let mut spec = self.spec_of(&design);
        **spec.mesh.refine.get_or_insert_default() += 1;
        let fine = FileScene::from_spec(spec.clone(), &self.registry)?;
        let coarse = self.scene(&design)?;
        check_same_loads(&spec, &coarse, &fine)?;
        Ok(spec)
    }

    /// Runs the refined scene and estimates the error of the scene's mesh in all histories but the excluded ones.
    pub(super) fn error_of_mesh(
        &self,
        (spec, excluded): (SceneSpec, &[SensitiveHistory]),
        runner: &mut TradeRunner,
        watch: &mut dyn TradeWatch,
    ) -> Result<MeshError, StudyError> {
        let (name, folder) = REFINED;
        let design = vec![0; self.factors.len()];
        let coarse = self.finish(&design, runner, &mut NoProgress, name)?;
        let fine = self.finish_spec(spec, (folder, folder), runner, (watch, name))?;
        let compared = self.compared.among(fine.histories);
        let motions = self.compared.motions(&compared);
        let (truth, order) = match motions.len() {
            0 | 1 => (compared, FIRST_ORDER),
            _ => (motions, SECOND_ORDER),
        };
        let misfit = misfit(&truth, &coarse.histories, excluded);
        let mesh = MeshError {
            error: order * misfit.error,
            worst: misfit.name,
            cost: fine.cost,
        };
        watch.mesh_error(&mesh);
        Ok(mesh)
    }
}
