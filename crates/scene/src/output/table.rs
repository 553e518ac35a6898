//! Tables of a run and their plots.

use powerhouse_io::TableColumn;
use powerhouse_observe::{Column, HistoryTable, PeakTable};

use super::file_name;
use crate::Topic;

/// Receiver of the tables of a run while it goes on, such as a writer of files that grow.
pub trait TableSink: Send {
    /// Whether the tables are to be given after this step.
    fn is_due(&mut self) -> bool;
    /// Takes a table with all its rows until now.
    fn take(&mut self, form: &TableForm, rows: &HistoryTable);
}

/// Name of a table of time histories, and what is made of it.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct TableForm {
    /// Path of its file in a results folder, without its ending, such as `histories`.
    pub name: String,
    /// Topic whose warnings are at its head, because they concern its numbers; those about the whole run are in its summary.
    pub topic: Option<Topic>,
    /// Its plots.
    pub plots: TablePlots,
    /// The peaks of its columns in the summary of a run.
    pub peaks: TablePeaks,
}

impl TableForm {
    /// A table of a name without warnings, with plots and peaks.
    pub fn new(name: impl Into<String>, plots: TablePlots, peaks: TablePeaks) -> Self {
        Self {
            name: name.into(),
            topic: None,
            plots,
            peaks,
        }
    }
    /// Path of its file.
    pub fn file(&self) -> String {
        format!("{}.csv", self.name)
    }
    /// Its plots of some rows.
    pub fn plots<'r>(&self, rows: &'r HistoryTable) -> Vec<ColumnPlot<'r>> {
        let plot = |prefix: &str, title: &str| ColumnPlot {
            file: plot_file(prefix, title),
            title: title.into(),
            columns: Vec::new(),
        };
        let (prefix, except) = match &self.plots {
            TablePlots::None => return Vec::new(),
            TablePlots::One => {
                let mut one = plot("", &self.name);
                let columns = rows.columns.iter();
                one.columns = columns.map(|column| (&*column.name, column)).collect();
                return vec![one];
            }
            TablePlots::OfNames { prefix, except } => (prefix, except),
        };
        let mut plots: Vec<ColumnPlot> = Vec::new();
        for column in &rows.columns {
            let (name, component) = column.name.rsplit_once('.').unwrap_or((&column.name, ""));
            if except.iter().any(|other| other == name) {
                continue;
            }
            let known = plots.iter().position(|plot| plot.title == name);
            let index = known.unwrap_or(plots.len());
            if known.is_none() {
                plots.push(plot(prefix, name));
            }
            plots[index].columns.push((component, column));
        }
        plots
    }
}

/// Plot of some columns of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct ColumnPlot<'r> {
    /// Path of its file.
    pub file: String,
    /// Title.
    pub title: String,
    /// Columns, and their names without what the title says.
    pub columns: Vec<(&'r str, &'r Column)>,
}

/// Path of a plot.
pub(super) fn plot_file(prefix: &str, name: &str) -> String {
    format!("plots/{prefix}{}.svg", file_name(name))
}

/// Plots of a table.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum TablePlots {
    /// None.
    None,
    /// One of all columns, with the name of the table.
    One,
    /// One for each name before the last dot of a column.
    OfNames {
        /// What their files begin with.
        prefix: &'static str,
        /// Names without a plot of their own.
        except: Vec<String>,
    },
}

impl TablePlots {
    /// One for each name, whose file begins with a prefix.
    pub fn of_names(prefix: &'static str) -> Self {
        let except = Vec::new();
        Self::OfNames { prefix, except }
    }
}

/// Peaks of the columns of a table in the summary of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum TablePeaks {
    /// None.
    None,
    /// Those of all columns.
    All,
    /// Those of columns that were ever other than zero.
    NotZero,
    /// Those of all columns, in place of the peaks of columns of the same names in other tables.
    InPlace,
}

/// A table of the time histories of a run.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ResultTable {
    /// Its name and what is made of it.
    pub form: TableForm,
    /// Its rows.
    pub rows: HistoryTable,
}

impl ResultTable {
    /// Adds its peaks to those of other tables.
    pub(super) fn add_peaks(&self, peaks: &mut PeakTable) {
        let mut own = PeakTable::default();
        own.add_history(&self.rows);
        match self.form.peaks {
            TablePeaks::None => {}
            TablePeaks::All => {
                peaks.rows.append(&mut own.rows);
                peaks.add_instants(&self.rows);
            }
            TablePeaks::NotZero => peaks
                .rows
                .extend(own.rows.into_iter().filter(|row| row.value != 0.0)),
            TablePeaks::InPlace => {
                for row in own.rows {
                    if let Some(known) = peaks.rows.iter_mut().find(|known| known.name == row.name)
                    {
                        *known = row;
                    }
                }
            }
        }
    }
}

/// A table of the results of a run that is not against time.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ResultList {
    /// Path of its file in a results folder, without its ending, such as `rings/lining`.
    pub name: String,
    /// Its columns.
    pub columns: Vec<TableColumn>,
    /// Its plot with the path of the file; none without one.
    pub plot: Option<(String, TablePlot)>,
}

/// Plot of a table: panels one above the other with a common horizontal axis.
#[derive(Clone, Debug, PartialEq)]
pub struct TablePlot {
    /// Title.
    pub title: String,
    /// Name and unit of the quantity on the horizontal axis.
    pub axis: [&'static str; 2],
    /// Name and unit of the quantity on the vertical axis of each panel, with its curves.
    pub panels: Vec<([String; 2], Vec<PlottedCurve>)>,
}

/// Curve of a plot: name, positions along the horizontal axis and values.
#[derive(Clone, Debug, PartialEq)]
pub struct PlottedCurve {
    /// Name in the legend.
    pub name: &'static str,
    /// Positions along the horizontal axis.
    pub x: Vec<f64>,
    /// Values, one per position.
    pub y: Vec<f64>,
}
