//! Which histories of a scene repeat: those that hardly change under waves that are hardly changed.

use powerhouse::io::TableColumn;
use toml::Value;

use super::case::TradeRunner;
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
/// Change that a history may show, over the error that is asked for; where none is; and over the nudge, which
/// what is linear shows at least.
const SHARE_OF_ERROR: f64 = 0.5;
const WITHOUT_ERROR: f64 = 0.01;
const LEAST_CHANGE: f64 = 10.0;

/// Run of the reference under waves that are hardly changed.
#[derive(Clone, Copy)]
pub(super) struct Perturbed<'a> {
    /// Its scene.
    text: &'a str,
    /// Histories of the reference.
    reference: &'a [TableColumn],
    /// Goal of the trade, which decides on the change that histories may show.
    goal: Goal,
}

impl<'a> Perturbed<'a> {
    pub(super) fn new(text: &'a str, reference: &'a [TableColumn], goal: Goal) -> Self {
        Self {
            text,
            reference,
            goal,
        }
    }
}

impl Trade {
    /// The file of the reference under waves that are hardly changed; none without history variables, no wave
    /// comes in, or all histories count.
    pub(super) fn nudged_text(&self) -> Result<Option<String>, StudyError> {
        let Some(nudge) = self.nudge else {
            return Ok(None);
        };
        if !self.path_dependent || self.reference != Reference::Finest {
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

    /// The histories of a reference that do not repeat, from its file under waves that are hardly changed.
    ///
    /// # Errors
    /// [`StudyError::NothingRepeats`]; what a run may fail with.
    pub(super) fn unrepeated(
        &self,
        perturbed: Perturbed,
        runner: &mut TradeRunner,
        watch: &mut dyn TradeWatch,
    ) -> Result<Vec<Unrepeated>, StudyError> {
        let Perturbed {
            text,
            reference,
            goal,
        } = perturbed;
        let design = vec![0; self.factors.len()];
        let folder = format!("{}-{FOLDER}", self.places(&design, |_| true));
        let body = self.body_of(&design);
        let nudged = self.finish_file(text, (&folder, &body), runner, (watch, NUDGED))?;
        let limit = match goal {
            Goal::Error(error) => SHARE_OF_ERROR * error,
            Goal::Budget(_) | Goal::Front => WITHOUT_ERROR,
        };
        let limit = limit.max(LEAST_CHANGE * NUDGE);
        let mut unrepeated: Vec<Unrepeated> = misfits(reference, &nudged.histories)
            .into_iter()
            .filter(|misfit| misfit.error > limit || misfit.error.is_nan())
            .map(|misfit| Unrepeated {
                history: misfit.name,
                change: misfit.error,
            })
            .collect();
        unrepeated.sort_by(|a, b| b.change.total_cmp(&a.change));
        some_is_left(reference, &unrepeated)?;
        watch.sets_aside(&unrepeated);
        Ok(unrepeated)
    }
}

/// Fails if nothing that moves is left of a table.
///
/// # Errors
/// [`StudyError::NothingRepeats`].
fn some_is_left(columns: &[TableColumn], unrepeated: &[Unrepeated]) -> Result<(), StudyError> {
    let Some(least) = unrepeated.last() else {
        return Ok(());
    };
    let mut moving = columns.iter().skip(1).filter(|column| {
        let name = history_of(column);
        unrepeated.iter().all(|other| other.history != name)
            && column.values.iter().any(|value| *value != 0.0)
    });
    match moving.next() {
        Some(_) => Ok(()),
        None => Err(StudyError::NothingRepeats {
            history: least.history.clone(),
            change: least.change,
        }),
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use powerhouse::io::write_gmsh;
    use powerhouse::model::{Mesh, Vec3};

    use super::*;
    use crate::trade::{Silent, TradeCase, TradeReport};

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

    /// Notes what is told.
    #[derive(Default)]
    struct Told(Vec<String>);

    impl TradeWatch for Told {
        fn begins(&mut self, name: &str, place: usize) {
            self.0.push(format!("{place} {name}"));
        }
        fn sets_aside(&mut self, unrepeated: &[Unrepeated]) {
            self.0.push(format!("{} left out", unrepeated.len()));
        }
        fn ends(&mut self, case: &TradeCase) {
            self.0.push(format!("end of {}", case.name));
        }
    }

    /// A history that hardly changed waves change much counts nowhere and is named; of the others the error
    /// is told. Waves larger by half change motions by about half and plastic strains by more.
    #[test]
    fn what_does_not_repeat_is_left_out_and_named() {
        let (_folder, mut trade) = trade("half", YIELDING, Some(0.5));
        let text = trade.nudged_text().unwrap().unwrap();
        assert!(text.contains("factor = 3.0"), "{text}");
        let mut told = Told::default();
        let report = trade.run(Goal::Error(1.6), None, &mut told).unwrap();
        let again = format!("2 {NUDGED}");
        let order = ["1 reference", "end of reference", &again, "2 left out"];
        assert_eq!(told.0[..4], order);
        assert_eq!(told.0[4], "3 precision mixed");
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

    /// Where the reference gets through and waves that differ do not, everything counts, and it is told.
    #[test]
    fn a_second_run_may_fail() {
        let (_folder, mut trade) = trade("failing", YIELDING, Some(1e9));
        let report = trade.run(Goal::Error(0.1), None, &mut Silent).unwrap();
        assert_eq!(names(&report), [""; 0]);
        assert_eq!(report.failed.len(), 1);
        assert_eq!(report.failed[0].0, NUDGED);
        assert!(report.chosen.is_some());
    }

    /// A table in which nothing that moves is left is none to choose by.
    #[test]
    fn something_that_moves_is_left() {
        let table = |still: f64| {
            let column = |name: &str, unit, value| TableColumn::new(name, unit, vec![0.0, value]);
            [
                column("time", "s", 1.0),
                column("a.ax", "m/s2", 1.0),
                column("b.damage", "1", still),
            ]
        };
        let ringing = [Unrepeated {
            history: "a [m/s2]".into(),
            change: 0.3,
        }];
        assert!(some_is_left(&table(0.0), &[]).is_ok());
        assert!(some_is_left(&table(0.1), &ringing).is_ok());
        let refused = some_is_left(&table(0.0), &ringing).unwrap_err();
        assert!(
            refused.to_string().contains("a [m/s2] by 3.0e1 %"),
            "{refused}"
        );
    }

    /// Without history variables all histories repeat: there is no such run, nor where all histories are to count.
    #[test]
    fn only_what_remembers_is_run_again() {
        let (_folder, trade) = trade("elastic", ELASTIC, None);
        assert_eq!(trade.nudged_text().unwrap(), None);
        let (_folder, trade) = self::trade("all", YIELDING, None);
        assert!(trade.nudged_text().unwrap().is_some());
        assert_eq!(trade.with_every_history().nudged_text().unwrap(), None);
    }
}
