//! Perturbation test: histories with sensitive dependence on the input, found by a run under slightly larger waves.

use powerhouse::SceneSpec;
use powerhouse::io::TableColumn;

use super::case::TradeRunner;
use super::misfit::{history_of, misfits};
use super::{Goal, Reference, SensitiveHistory, Trade, TradeWatch};
use crate::StudyError;
use crate::perturbation::{PERTURBATION, enlarge_waves};

/// Name of the run of the perturbation test.
pub(super) const PERTURBED: &str = "reference under waves of 1 + 1e-6 times the amplitude";
/// Suffix of its folder, after the name of that of the reference.
const FOLDER: &str = "nudged";
/// Greatest change of a history: over the permitted error, without a permitted error, and, as a lower limit, over the
/// perturbation, by which linear histories change.
const SHARE_OF_ERROR: f64 = 0.5;
const WITHOUT_ERROR: f64 = 0.01;
const LEAST_CHANGE: f64 = 10.0;

/// Run of the reference under waves that are hardly changed.
pub(super) struct Perturbed<'a> {
    /// Its scene.
    spec: SceneSpec,
    /// Histories of the reference.
    reference: &'a [TableColumn],
    /// Goal of the trade, which decides on the change that histories may show.
    goal: Goal,
}

impl<'a> Perturbed<'a> {
    pub(super) fn new(spec: SceneSpec, reference: &'a [TableColumn], goal: Goal) -> Self {
        Self {
            spec,
            reference,
            goal,
        }
    }
}

impl Trade {
    /// The scene of the reference under perturbed waves; `None` without history variables, without waves, or if
    /// all histories count.
    pub(super) fn perturbed(&self) -> Option<SceneSpec> {
        let perturbation = self.perturbation?;
        if !self.path_dependent || self.reference != Reference::Finest {
            return None;
        }
        let mut spec = self.spec_of(&vec![0; self.factors.len()]);
        let waves = enlarge_waves(&mut spec, perturbation);
        (waves > 0).then_some(spec)
    }

    /// Runs the perturbed reference and returns the histories with sensitive dependence on the input.
    ///
    /// # Errors
    /// [`StudyError::AllHistoriesSensitive`]; any error of the run.
    pub(super) fn sensitive_histories(
        &self,
        perturbed: Perturbed,
        runner: &mut TradeRunner,
        watch: &mut dyn TradeWatch,
    ) -> Result<Vec<SensitiveHistory>, StudyError> {
        let Perturbed {
            spec,
            reference,
            goal,
        } = perturbed;
        let design = vec![0; self.factors.len()];
        let folder = format!("{}-{FOLDER}", self.level_indices(&design, |_| true));
        let body = self.body_of(&design);
        let perturbed = self.finish_spec(spec, (&folder, &body), runner, (watch, PERTURBED))?;
        let limit = match goal {
            Goal::Error(error) => SHARE_OF_ERROR * error,
            Goal::Budget(_) | Goal::Front => WITHOUT_ERROR,
        };
        let limit = limit.max(LEAST_CHANGE * PERTURBATION);
        let mut sensitive: Vec<SensitiveHistory> = misfits(reference, &perturbed.histories)
            .into_iter()
            .filter(|misfit| misfit.error > limit || misfit.error.is_nan())
            .map(|misfit| SensitiveHistory {
                history: misfit.name,
                change: misfit.error,
            })
            .collect();
        sensitive.sort_by(|a, b| b.change.total_cmp(&a.change));
        check_remaining(reference, &sensitive)?;
        watch.sensitive_histories(&sensitive);
        Ok(sensitive)
    }
}

/// Checks that a history that is not zero remains beside the sensitive ones.
///
/// # Errors
/// [`StudyError::AllHistoriesSensitive`].
fn check_remaining(
    columns: &[TableColumn],
    sensitive: &[SensitiveHistory],
) -> Result<(), StudyError> {
    let Some(least) = sensitive.last() else {
        return Ok(());
    };
    let mut moving = columns.iter().skip(1).filter(|column| {
        let name = history_of(column);
        sensitive.iter().all(|other| other.history != name)
            && column.values.iter().any(|value| *value != 0.0)
    });
    match moving.next() {
        Some(_) => Ok(()),
        None => Err(StudyError::AllHistoriesSensitive {
            history: least.history.clone(),
            change: least.change,
        }),
    }
}

#[cfg(test)]
mod tests {
    use powerhouse::io::write_gmsh;
    use powerhouse::model::{Mesh, Vec3};
    use powerhouse_test_support::TestFolder;

    use super::*;
    use crate::trade::{NoProgress, TradeCase, TradeReport};

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
        damping = "none"
        elastic_rim = 0
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

    /// A trade study of number formats for the block, with a given perturbation of the waves.
    fn trade(name: &str, law: &str, perturbation: Option<f64>) -> (TestFolder, Trade) {
        let folder = TestFolder::new(&format!("repeat-{name}"));
        let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(120.0), [6; 3], "rock");
        write_gmsh(folder.join("mesh.msh"), &mesh.unwrap()).unwrap();
        let scene = folder.join("scene.toml");
        std::fs::write(&scene, SCENE.replace("LAW", law)).unwrap();
        let trade = Trade::of_file(&scene, Some(folder.join("out")))
            .unwrap()
            .only(&["precision"]);
        let mut trade = trade.unwrap();
        trade.perturbation = perturbation.or(trade.perturbation);
        (folder, trade)
    }

    fn names(report: &TradeReport) -> Vec<&str> {
        let names = report.sensitive.iter().map(|other| other.history.as_str());
        names.collect()
    }

    /// Log of the progress callbacks.
    #[derive(Default)]
    struct Log(Vec<String>);

    impl TradeWatch for Log {
        fn begins(&mut self, name: &str, number: usize) {
            self.0.push(format!("{number} {name}"));
        }
        fn sensitive_histories(&mut self, sensitive: &[SensitiveHistory]) {
            self.0.push(format!("{} excluded", sensitive.len()));
        }
        fn ends(&mut self, case: &TradeCase) {
            self.0.push(format!("end of {}", case.name));
        }
    }

    /// A history with sensitive dependence on the input is excluded and named, and errors are those of the others. Waves
    /// larger by half change motions by about half and plastic strains by more.
    #[test]
    fn sensitive_histories_are_excluded_and_named() {
        let (_folder, mut trade) = trade("half", YIELDING, Some(0.5));
        let spec = trade.perturbed().unwrap();
        assert_eq!(spec.waves[0].factor.unwrap().get(), 3.0);
        let mut log = Log::default();
        let report = trade.run(Goal::Error(1.6), None, &mut log).unwrap();
        let again = format!("2 {PERTURBED}");
        let order = ["1 reference", "end of reference", &again, "2 excluded"];
        assert_eq!(log.0[..4], order);
        assert_eq!(log.0[4], "3 precision mixed");
        let plastic = ["equivalent_plastic_strain", "plastic_strain"];
        let mut sensitive = names(&report);
        sensitive.sort_unstable();
        assert_eq!(sensitive, plastic.map(|kind| format!("inside [{kind}]")));
        assert!(report.sensitive.iter().all(|other| other.change > 0.8));
        assert_eq!(report.cases[1].worst, "inside [Pa]", "{report:?}");
        let written = std::fs::read_to_string(&report.files[0]).unwrap();
        assert!(
            written.contains("Excluded for sensitive dependence on the input: inside ["),
            "{written}"
        );
        // Every history changes by more than half of two hundredths; stress, which the strength limits, by about half as the waves do.
        let error = trade
            .run(Goal::Error(0.02), None, &mut NoProgress)
            .unwrap_err();
        assert!(
            matches!(&error, StudyError::AllHistoriesSensitive { history, change }
                if history == "inside [Pa]" && (0.3..0.6).contains(change)),
            "{error:?}"
        );
    }

    /// Under waves of 1 + 1e-6 times the amplitude a steadily yielding block hardly changes; all of its histories count.
    #[test]
    fn steady_yielding_is_not_sensitive() {
        let (_folder, mut trade) = trade("steady", YIELDING, None);
        let report = trade.run(Goal::Error(1e-4), None, &mut NoProgress).unwrap();
        assert_eq!(names(&report), [""; 0]);
        assert!(report.cases[1].error > 0.0);
    }

    /// If the reference succeeds and its perturbed run fails, all histories count, and the failure is reported.
    #[test]
    fn the_perturbed_run_may_fail() {
        let (_folder, mut trade) = trade("failing", YIELDING, Some(1e9));
        let report = trade.run(Goal::Error(0.1), None, &mut NoProgress).unwrap();
        assert_eq!(names(&report), [""; 0]);
        assert_eq!(report.failed.len(), 1);
        assert_eq!(report.failed[0].0, PERTURBED);
        assert!(report.chosen.is_some());
    }

    /// It is an error if no history other than zero remains.
    #[test]
    fn a_moving_history_must_remain() {
        let table = |damage: f64| {
            let column = |name: &str, unit, value| TableColumn::new(name, unit, vec![0.0, value]);
            [
                column("time", "s", 1.0),
                column("a.ax", "m/s2", 1.0),
                column("b.damage", "1", damage),
            ]
        };
        let ringing = [SensitiveHistory {
            history: "a [m/s2]".into(),
            change: 0.3,
        }];
        assert!(check_remaining(&table(0.0), &[]).is_ok());
        assert!(check_remaining(&table(0.1), &ringing).is_ok());
        let error = check_remaining(&table(0.0), &ringing).unwrap_err();
        assert!(error.to_string().contains("a [m/s2] by 3.0e1 %"), "{error}");
    }

    /// There is no perturbation test without history variables, nor if all histories are to count.
    #[test]
    fn only_scenes_with_history_variables_are_perturbed() {
        let (_folder, trade) = trade("elastic", ELASTIC, None);
        assert!(trade.perturbed().is_none());
        let (_folder, trade) = self::trade("all", YIELDING, None);
        assert!(trade.perturbed().is_some());
        assert!(trade.with_every_history().perturbed().is_none());
    }
}
