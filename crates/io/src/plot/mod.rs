//! Line plots as SVG.

mod curve;
mod document;

use std::path::Path;

use crate::{IoError, TableColumn, write_whole};

/// Curve of a plot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlotCurve<'a> {
    /// Name in the legend; empty for a faint grey curve without an entry, as one of many.
    pub name: &'a str,
    /// Positions along the horizontal axis.
    pub x: &'a [f64],
    /// Values, one per position.
    pub y: &'a [f64],
}

/// Panel of a plot: curves with one vertical axis.
#[derive(Clone, Debug, PartialEq)]
pub struct PlotPanel<'a> {
    /// Name of the quantity on the vertical axis; empty for the unit alone.
    pub label: String,
    /// Unit of the vertical axis.
    pub unit: String,
    /// Curves of the panel.
    pub curves: Vec<PlotCurve<'a>>,
}

/// Line plot: panels one above the other with a common horizontal axis.
///
/// The file has colours for light and dark pages, of which a browser selects. Curves with more points
/// than pixels are drawn by the least and greatest value of each pixel, so that peaks are preserved.
#[derive(Clone, Debug, PartialEq)]
pub struct Plot<'a> {
    /// Title at the top; empty for none.
    pub title: String,
    /// Name of the quantity on the horizontal axis.
    pub label: String,
    /// Unit of the horizontal axis.
    pub unit: String,
    /// Panels from the top.
    pub panels: Vec<PlotPanel<'a>>,
    /// Indices of points, in rising order, to which no line is drawn from the point before; empty for unbroken curves.
    pub gaps: Vec<usize>,
}

impl<'a> Plot<'a> {
    /// Plot of a table: the first column is the horizontal axis, the others are curves, with one
    /// panel for each unit in the order in which units appear.
    ///
    /// ```
    /// use powerhouse_io::{Plot, TableColumn};
    /// let table = [
    ///     TableColumn::new("time", "s", vec![0.0, 0.1, 0.2]),
    ///     TableColumn::new("crown ux", "m", vec![0.0, 1e-3, -2e-3]),
    ///     TableColumn::new("crown vx", "m/s", vec![0.0, 0.01, -0.03]),
    ///     TableColumn::new("floor ux", "m", vec![0.0, 2e-3, -1e-3]),
    /// ];
    /// let plot = Plot::of_table("cavern", &table);
    /// assert_eq!(plot.panels.len(), 2);
    /// assert_eq!(plot.panels[0].curves.len(), 2);
    /// ```
    pub fn of_table(title: impl Into<String>, columns: &'a [TableColumn]) -> Self {
        let mut panels: Vec<PlotPanel> = Vec::new();
        let Some((x, others)) = columns.split_first() else {
            return Self {
                title: title.into(),
                label: String::new(),
                unit: String::new(),
                panels,
                gaps: Vec::new(),
            };
        };
        for column in others {
            let curve = PlotCurve {
                name: &column.name,
                x: &x.values,
                y: &column.values,
            };
            match panels.iter_mut().find(|panel| panel.unit == column.unit) {
                Some(panel) => panel.curves.push(curve),
                None => panels.push(PlotPanel {
                    label: String::new(),
                    unit: column.unit.clone(),
                    curves: vec![curve],
                }),
            }
        }
        Self {
            title: title.into(),
            label: x.name.clone(),
            unit: x.unit.clone(),
            panels,
            gaps: Vec::new(),
        }
    }

    /// Sets the points to which no line is drawn from the point before, in any order.
    #[must_use]
    pub fn with_gaps(self, mut gaps: Vec<usize>) -> Self {
        gaps.sort_unstable();
        Self { gaps, ..self }
    }
}

/// Writes a plot as an SVG file.
///
/// # Errors
/// If the plot has no curves or points, a curve has unequal numbers of positions and values, a number
/// is not finite, or the file cannot be written.
pub fn write_plot(file: &Path, plot: &Plot) -> Result<(), IoError> {
    let curves = || plot.panels.iter().flat_map(|panel| &panel.curves);
    for curve in curves() {
        if curve.x.len() != curve.y.len() {
            return Err(IoError::Length {
                file: file.into(),
                what: curve.name.into(),
                found: curve.y.len(),
                expected: curve.x.len(),
            });
        }
        for values in [curve.x, curve.y] {
            if let Some(index) = values.iter().position(|value| !value.is_finite()) {
                return Err(IoError::NotFinite {
                    file: file.into(),
                    what: curve.name.into(),
                    index,
                    value: values[index],
                });
            }
        }
    }
    if curves().all(|curve| curve.x.is_empty()) {
        return Err(IoError::NothingToDraw { file: file.into() });
    }
    write_whole(file, document::svg(plot).as_bytes())
}
