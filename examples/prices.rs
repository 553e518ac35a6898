//! Tables of cost and error of numerical options for the documentation.

use std::fmt::Write as _;
use std::path::Path;

use powerhouse_study::{ParetoPoint, draw_pareto_front, pareto_front};

use crate::Outcome;

/// Error and cost of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Relative error.
    pub error: f64,
    /// Wall time of the steps (s).
    pub seconds: f64,
}

/// Table of cost and error of several numerical options for a problem with a known solution.
#[derive(Clone, Debug)]
pub struct CostErrorTable {
    /// Name in the names of figures and files.
    pub name: &'static str,
    /// Heading of the table.
    pub title: &'static str,
    /// Description of the problem and of the error.
    pub about: &'static str,
    /// Options with cost (s) and error; printed costs are relative to the first.
    pub rows: Vec<ParetoPoint>,
    /// Relative error of the reference; smaller errors are drawn at this value.
    pub uncertainty: f64,
}

impl CostErrorTable {
    /// A table without rows.
    #[must_use]
    pub fn new(name: &'static str, title: &'static str, about: &'static str) -> Self {
        Self {
            name,
            title,
            about,
            rows: Vec::new(),
            uncertainty: 0.0,
        }
    }

    /// Adds an option and prints it.
    pub fn put(&mut self, choice: impl Into<String>, measured: Measured) {
        let name = choice.into();
        let (error, cost) = (measured.error, measured.seconds);
        println!("{}: {name}: error {error:.2e} in {cost:.3} s", self.name);
        self.rows.push(ParetoPoint { name, cost, error });
    }

    /// The table in Markdown; rows on the Pareto front are bold.
    #[must_use]
    pub fn markdown(&self) -> String {
        let mut text = format!("\n## {}\n\n{}\n\n", self.title, self.about);
        if self.uncertainty > 0.0 {
            // Writing to a string does not fail.
            let _ = writeln!(
                text,
                "The relative error of the reference itself is {:.1e}.\n",
                self.uncertainty
            );
        }
        text += "| option | relative error | cost |\n|---|---|---|\n";
        let front = pareto_front(&self.rows);
        for (index, row) in self.relative().iter().enumerate() {
            let mark = if front.contains(&index) { "**" } else { "" };
            let _ = writeln!(
                text,
                "| {mark}{}{mark} | {:.2e} | {:.2} |",
                row.name, row.error, row.cost
            );
        }
        let _ = writeln!(
            text,
            "\n![error against cost](verification/{}.svg)",
            self.name
        );
        text
    }

    /// Draws the diagram of error and cost into a folder.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn draw(&self, folder: &Path) -> Outcome<()> {
        let file = folder.join(format!("{}.svg", self.name));
        let cost = ("wall time over that of the first option", "1");
        let rows = self.relative();
        Ok(draw_pareto_front(
            &file,
            self.title,
            cost,
            &rows,
            self.uncertainty,
        )?)
    }

    /// The rows with costs relative to the first.
    fn relative(&self) -> Vec<ParetoPoint> {
        let unit = self.rows.first().map_or(1.0, |row| row.cost);
        let relative = |row: &ParetoPoint| ParetoPoint {
            cost: row.cost / unit,
            ..row.clone()
        };
        self.rows.iter().map(relative).collect()
    }
}
