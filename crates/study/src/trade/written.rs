//! Files of a trade study: the chosen scene, a table and a plot.

use super::plan::Design;
use super::{Trade, TradeReport};
use crate::StudyError;
use crate::mark::text_of;
use crate::price::draw_pareto_front;
use crate::sweep::write_text;

/// Name of the plot in the folder of the study.
const PLOT: &str = "trade.svg";
/// Name of the table in the folder of the study.
const TABLE: &str = "trade.csv";

impl Trade {
    /// Writes the files and lists them in the report.
    pub(super) fn write(&self, report: &mut TradeReport) -> Result<(), StudyError> {
        let mut files = Vec::new();
        if let Some(case) = report.chosen.map(|index| &report.cases[index]) {
            let stem = self.path.file_stem().unwrap_or_default().to_string_lossy();
            let file = self.path.with_file_name(format!("{stem}_trade.toml"));
            let of_reference = report.reference_error;
            let of_reference =
                of_reference.map(|error| format!("; error of the reference {error:.1e}"));
            let of_mesh = report.mesh.as_ref();
            let of_mesh =
                of_mesh.map(|mesh| format!("; estimated error of the mesh {:.1e}", mesh.error));
            let excluded = match &report.sensitive[..] {
                [] => String::new(),
                several => {
                    let names: Vec<&str> = several.iter().map(|h| h.history.as_str()).collect();
                    format!(
                        "# Excluded for sensitive dependence on the input: {}.\n",
                        names.join(", ")
                    )
                }
            };
            let text = format!(
                "# {}: {}.\n# Relative error over the first {} s: {:.2e} ({}){}{}; predicted wall time of the whole run {:.0} s.\n{excluded}\n{}",
                self.path.file_name().unwrap_or_default().to_string_lossy(),
                case.name,
                self.window,
                case.error,
                case.worst,
                of_reference.unwrap_or_default(),
                of_mesh.unwrap_or_default(),
                case.cost.wall_time(),
                self.text_beside(&case.levels)?
            );
            write_text(&file, &text)?;
            files.push(file);
        }
        let mut text = String::from(
            "levels,error [1],wall time [s],step [s],time of a step [s],memory [bytes],on the front\n",
        );
        for (index, case) in report.cases.iter().enumerate() {
            let cost = &case.cost;
            text += &format!(
                "\"{}\",{:e},{:e},{:e},{:e},{},{}\n",
                case.name,
                case.error,
                cost.wall_time(),
                cost.step,
                cost.time_of_step,
                cost.memory,
                report.front.contains(&index)
            );
        }
        let (table, plot) = (self.folder.join(TABLE), self.folder.join(PLOT));
        write_text(&table, &text)?;
        let cost = ("wall time of the whole run", "s");
        let uncertainty = report.reference_error.unwrap_or(0.0);
        draw_pareto_front(
            &plot,
            &report.title,
            cost,
            &report.pareto_points(),
            uncertainty,
        )?;
        files.extend([table, plot]);
        report.files = files;
        Ok(())
    }

    /// The scene of a design as text, with a result folder of its own, to be written beside the original.
    fn text_beside(&self, design: &Design) -> Result<String, StudyError> {
        let mut spec = self.spec_of(design);
        if let Some(directory) = &mut spec.output.directory {
            let own = directory.to_string_lossy();
            *directory = format!("{}_trade", own.trim_end_matches('/')).into();
        }
        text_of(&spec)
    }
}
