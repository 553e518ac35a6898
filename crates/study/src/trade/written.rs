//! The files of a trade: the scene that it chose, a table and a picture.

use toml::Value;

use super::plan::Design;
use super::{Trade, TradeReport};
use crate::StudyError;
use crate::price::draw_prices;
use crate::sweep::write_text;

/// The picture in the folder of a trade.
const PICTURE: &str = "trade.svg";
/// The table.
const TABLE: &str = "trade.csv";

impl Trade {
    /// Writes the files and names them in the report.
    pub(super) fn write(&self, report: &mut TradeReport) -> Result<(), StudyError> {
        let mut files = Vec::new();
        if let Some(case) = report.chosen.map(|place| &report.cases[place]) {
            let stem = self.path.file_stem().unwrap_or_default().to_string_lossy();
            let file = self.path.with_file_name(format!("{stem}_trade.toml"));
            let of_reference = report.reference_error;
            let of_reference = of_reference.map(|error| format!(", the reference by {error:.1e}"));
            let of_mesh = report.mesh.as_ref();
            let of_mesh = of_mesh.map(|mesh| format!(", the mesh by about {:.1e}", mesh.error));
            let aside = match &report.unrepeated[..] {
                [] => String::new(),
                several => {
                    let names: Vec<&str> = several.iter().map(|h| h.history.as_str()).collect();
                    format!("# No choice repeats {}.\n", names.join(", "))
                }
            };
            let text = format!(
                "# {}: {}.\n# Over the first {} s it errs by {:.2e} ({}){}{}; the whole run takes {:.0} s.\n{aside}\n{}",
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
        for (place, case) in report.cases.iter().enumerate() {
            let cost = &case.cost;
            text += &format!(
                "\"{}\",{:e},{:e},{:e},{:e},{},{}\n",
                case.name,
                case.error,
                cost.wall_time(),
                cost.step,
                cost.time_of_step,
                cost.memory,
                report.front.contains(&place)
            );
        }
        let (table, picture) = (self.folder.join(TABLE), self.folder.join(PICTURE));
        write_text(&table, &text)?;
        let cost = ("wall time of the whole run", "s");
        let uncertainty = report.reference_error.unwrap_or(0.0);
        draw_prices(&picture, &report.title, cost, &report.prices(), uncertainty)?;
        files.extend([table, picture]);
        report.files = files;
        Ok(())
    }

    /// The file of a choice that stands beside the scene: its results have a folder of their own.
    fn text_beside(&self, design: &Design) -> Result<String, StudyError> {
        let mut file = self.file_of(design);
        let output = file.get_mut("output").and_then(Value::as_table_mut);
        let directory = output.and_then(|output| output.get_mut("directory"));
        if let Some(Value::String(directory)) = directory {
            *directory = format!("{}_trade", directory.trim_end_matches('/'));
        }
        self.written(&file)
    }
}
