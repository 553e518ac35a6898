//! Which histories of a scene repeat: those that hardly change under waves that are hardly changed.

use powerhouse::io::TableColumn;
use toml::Value;

use super::case::{Bench, Finished};
use super::factor::{number, tables};
use super::misfit::{history_of, misfits};
use super::{Goal, Reference, Trade, TradeWatch, Unrepeated};
use crate::StudyError;

/// Share by which waves are changed: records are known to a thousandth at best.
pub(super) const NUDGE: f64 = 1e-6;
/// The name of that run.
pub(super) const NUDGED: &str = "reference under waves larger by a millionth";
/// Its folder, after the name of the reference's.
const FOLDER: &str = "nudged";
/// Change that a history may show, over the error that is asked for; and where none is.
const SHARE_OF_ERROR: f64 = 0.5;
const WITHOUT_ERROR: f64 = 0.01;

impl Trade {
    /// The file of the reference under waves that are hardly changed; none where nothing remembers, no wave
    /// comes in, or all histories count.
    pub(super) fn nudged_text(&self) -> Result<Option<String>, StudyError> {
        let Some(nudge) = self.nudge else {
            return Ok(None);
        };
        if !self.remembers || self.reference != Reference::Finest {
            return Ok(None);
        }
        let mut file = self.file_of(&vec![0; self.factors.len()]);
        let mut waves = 0;
        for wave in tables(&mut file, "wave") {
            let own = wave.get("factor").and_then(number).unwrap_or(1.0);
            wave.insert("factor".into(), Value::Float(own * (1.0 + nudge)));
            waves += 1;
        }
        match waves {
            0 => Ok(None),
            _ => self.written(&file).map(Some),
        }
    }

    /// The histories of the reference that do not repeat, from its file under waves that are hardly changed.
    pub(super) fn unrepeated(
        &self,
        (text, reference, goal): (&str, &Finished, Goal),
        bench: &mut Bench,
        watch: &mut dyn TradeWatch,
    ) -> Result<Vec<Unrepeated>, StudyError> {
        let design = vec![0; self.factors.len()];
        let folder = format!("{}-{FOLDER}", self.places(&design, |_| true));
        let body = self.body_of(&design);
        let nudged = self.finish_file(text, (&folder, &body), bench, (watch, NUDGED))?;
        let limit = match goal {
            Goal::Error(error) => SHARE_OF_ERROR * error,
            Goal::Budget(_) | Goal::Front => WITHOUT_ERROR,
        };
        let reference = self.compared.among(reference.histories.clone());
        let mut unrepeated: Vec<Unrepeated> = misfits(&reference, &nudged.histories)
            .into_iter()
            .filter(|misfit| misfit.error > limit || misfit.error.is_nan())
            .map(|misfit| Unrepeated {
                history: misfit.name,
                change: misfit.error,
            })
            .collect();
        unrepeated.sort_by(|a, b| b.change.total_cmp(&a.change));
        watch.sets_aside(&unrepeated);
        Ok(unrepeated)
    }
}

/// Leaves histories out of a table.
///
/// # Errors
/// [`StudyError::NothingRepeats`] if no other is there.
pub(super) fn leave_out(
    columns: &mut Vec<TableColumn>,
    unrepeated: &[Unrepeated],
) -> Result<(), StudyError> {
    let mut place = 0;
    columns.retain(|column| {
        place += 1;
        let name = history_of(column);
        place == 1 || unrepeated.iter().all(|other| other.history != name)
    });
    match (columns.len(), unrepeated.last()) {
        (1, Some(least)) => Err(StudyError::NothingRepeats {
            history: least.history.clone(),
            change: least.change,
        }),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use powerhouse::io::write_gmsh;
    use powerhouse::model::{Mesh, Vec3};

    use super::*;
    use crate::trade::{Silent, TradeReport};

    /// A block that yields under a pulse.
    const SCENE: &str = r#"
        title = "block"
        [mesh]
        file = "mesh.msh"
        [[material]]
        name = "rock"
        LAW
        [[part]]
        set = "rock"
        material = "rock"
        rim = 0
        [[wave]]
        kind = "sv"
        incidence = 20
        factor = 2
        pulse = { kind = "smooth", displacement = 0.02, duration = 0.25 }
        [boundary]
        kind = "viscous-spring"
        faces = ["left", "right", "front", "back", "bottom"]
        scatterer = [60, 60, 120]
        [time]
        duration = 0.3
        [output]
        every = 0.01
        [[output.history]]
        name = "inside"
        at = [60, 60, 60]
        quantities = ["displacement", "stress", "state"]
    "#;

    const YIELDING: &str = "law = \"mohr-coulomb\"\npreset = \"paper-rock\"";
    const ELASTIC: &str = "law = \"elastic\"\nyoung = 9e9\npoisson = 0.27\ndensity = 2750";

    struct Folder(PathBuf);

    impl Drop for Folder {
        fn drop(&mut self) {
            let _ = std::fs::remove_dir_all(&self.0);
        }
    }

    /// A trade of number formats over the block, with waves changed by a share of their own.
    fn trade(name: &str, law: &str, nudge: Option<f64>) -> (Folder, Trade) {
        let name = format!("powerhouse-repeat-{name}-{}", std::process::id());
        let folder = Folder(std::env::temp_dir().join(name));
        std::fs::create_dir_all(&folder.0).unwrap();
        let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(120.0), [6; 3], "rock");
        write_gmsh(folder.0.join("mesh.msh"), &mesh.unwrap()).unwrap();
        let scene = folder.0.join("scene.toml");
        std::fs::write(&scene, SCENE.replace("LAW", law)).unwrap();
        let trade = Trade::of_file(&scene, Some(folder.0.join("out")))
            .unwrap()
            .only(&["precision"]);
        let mut trade = trade.unwrap();
        trade.nudge = nudge.or(trade.nudge);
        (folder, trade)
    }

    fn names(report: &TradeReport) -> Vec<&str> {
        let names = report.unrepeated.iter().map(|other| other.history.as_str());
        names.collect()
    }

    /// A history that hardly changed waves change much counts nowhere and is named; of the others the error
    /// is told. Waves larger by half change motions by about half and plastic strains by more.
    #[test]
    fn what_does_not_repeat_is_left_out_and_named() {
        let (_folder, mut trade) = trade("half", YIELDING, Some(0.5));
        let text = trade.nudged_text().unwrap().unwrap();
        assert!(text.contains("factor = 3.0"), "{text}");
        let report = trade.run(Goal::Error(1.6), None, &mut Silent).unwrap();
        let plastic = ["equivalent_plastic_strain", "plastic_strain"];
        assert_eq!(
            names(&report),
            plastic.map(|kind| format!("inside [{kind}]"))
        );
        assert!(report.unrepeated.iter().all(|other| other.change > 0.8));
        assert_eq!(report.cases[1].worst, "inside [Pa]", "{report:?}");
        let written = std::fs::read_to_string(&report.files[0]).unwrap();
        assert!(written.contains("No choice repeats inside ["), "{written}");
        // Half of two hundredths is less than any history changes by, stress, which strength limits, least of all.
        let refused = trade.run(Goal::Error(0.02), None, &mut Silent).unwrap_err();
        assert!(
            matches!(&refused, StudyError::NothingRepeats { history, change }
                if history == "inside [Pa]" && (0.3..0.5).contains(change)),
            "{refused:?}"
        );
    }

    /// Waves larger by a millionth change nothing of a block that yields by much more; all of it counts.
    #[test]
    fn what_yields_steadily_repeats() {
        let (_folder, mut trade) = trade("steady", YIELDING, None);
        let report = trade.run(Goal::Error(1e-4), None, &mut Silent).unwrap();
        assert_eq!(names(&report), [""; 0]);
        assert!(report.cases[1].error > 0.0);
    }

    /// What remembers nothing repeats: there is no such run, nor where all histories are to count.
    #[test]
    fn only_what_remembers_is_run_again() {
        let (_folder, trade) = trade("elastic", ELASTIC, None);
        assert_eq!(trade.nudged_text().unwrap(), None);
        let (_folder, trade) = self::trade("all", YIELDING, None);
        assert!(trade.nudged_text().unwrap().is_some());
        assert_eq!(trade.with_every_history().nudged_text().unwrap(), None);
    }
}
