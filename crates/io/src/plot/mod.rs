//! Line plots as SVG.

mod curve;
mod document;

use std::path::Path;

use crate::{IoError, TableColumn, write_whole};

/// A line of a plot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlotCurve<'a> {
    /// Its name in the legend.
    pub name: &'a str,
    /// Positions along the horizontal axis.
    pub x: &'a [f64],
    /// Values, one per position.
    pub y: &'a [f64],
}

/// Curves over one vertical axis.
#[derive(Clone, Debug, PartialEq)]
pub struct PlotPanel<'a> {
    /// What the vertical axis shows; empty for nothing but the unit.
    pub label: String,
    /// Its unit.
    pub unit: String,
    /// The curves.
    pub curves: Vec<PlotCurve<'a>>,
}

/// Panels one above the other, which share the horizontal axis.
///
/// The file carries colours for light and dark pages; a browser chooses. Curves with more points
/// than the page can show are drawn by the least and greatest value of each pixel, so peaks stay.
#[derive(Clone, Debug, PartialEq)]
pub struct Plot<'a> {
    /// Stands on top; empty for none.
    pub title: String,
    /// What the horizontal axis shows.
    pub label: String,
    /// Its unit.
    pub unit: String,
    /// The panels, from the top.
    pub panels: Vec<PlotPanel<'a>>,
}

impl<'a> Plot<'a> {
    /// A plot of a table: the first column along the horizontal axis, the others above it, one
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
        }
    }
}

/// Writes a plot.
///
/// # Errors
/// A plot without curves or points, a curve with unequal numbers of positions and values, a number
/// that is not finite, or the operating system's error.
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
            if let Some(place) = values.iter().position(|value| !value.is_finite()) {
                return Err(IoError::NotFinite {
                    file: file.into(),
                    what: curve.name.into(),
                    place,
                    value: values[place],
                });
            }
        }
    }
    if curves().all(|curve| curve.x.is_empty()) {
        return Err(IoError::NothingToDraw { file: file.into() });
    }
    write_whole(file, document::svg(plot).as_bytes())
}
