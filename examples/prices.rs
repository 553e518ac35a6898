//! Tables of what choices cost and err, as the documentation shows them.

use std::fmt::Write as _;
use std::path::Path;

use powerhouse_study::{ParetoPoint, draw_pareto_front, pareto_front};

use crate::Outcome;

/// What a run came to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Priced {
    /// Its relative error.
    pub error: f64,
    /// The wall time of its steps (s).
    pub seconds: f64,
}

/// A problem whose answer is known, solved in several ways.
#[derive(Clone, Debug)]
pub struct PriceTable {
    /// In names of figures and files.
    pub name: &'static str,
    /// The heading.
    pub title: &'static str,
    /// What is solved, and what the error is of.
    pub about: &'static str,
    /// The ways and what they came to; costs are told over that of the first one.
    pub rows: Vec<ParetoPoint>,
    /// The relative error of what errors are measured against; those below it are drawn there.
    pub uncertainty: f64,
}

impl PriceTable {
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

    /// Adds a way to solve it; prints it.
    pub fn put(&mut self, choice: impl Into<String>, priced: Priced) {
        let name = choice.into();
        let (error, cost) = (priced.error, priced.seconds);
        println!("{}: {name}: error {error:.2e} in {cost:.3} s", self.name);
        self.rows.push(ParetoPoint { name, cost, error });
    }

    /// The table in Markdown; rows on the front are bold.
    #[must_use]
    pub fn markdown(&self) -> String {
        let mut text = format!("\n## {}\n\n{}\n\n", self.title, self.about);
        if self.uncertainty > 0.0 {
            // Writing to a string does not fail.
            let _ = writeln!(
                text,
                "What errors are measured against errs by {:.1e} itself.\n",
                self.uncertainty
            );
        }
        text += "| choice | relative error | cost |\n|---|---|---|\n";
        let front = pareto_front(&self.rows);
        for (place, row) in self.relative().iter().enumerate() {
            let mark = if front.contains(&place) { "**" } else { "" };
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

    /// Draws errors against costs into a folder.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn draw(&self, folder: &Path) -> Outcome<()> {
        let file = folder.join(format!("{}.svg", self.name));
        let cost = ("wall time over that of the first choice", "1");
        let rows = self.relative();
        Ok(draw_pareto_front(
            &file,
            self.title,
            cost,
            &rows,
            self.uncertainty,
        )?)
    }

    /// The rows with their costs over that of the first one.
    fn relative(&self) -> Vec<ParetoPoint> {
        let unit = self.rows.first().map_or(1.0, |row| row.cost);
        let relative = |row: &ParetoPoint| ParetoPoint {
            cost: row.cost / unit,
            ..row.clone()
        };
        self.rows.iter().map(relative).collect()
    }
}
