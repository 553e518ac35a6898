//! The trade as a picture.

use std::path::Path;

use powerhouse::io::{Plot, PlotCurve, PlotPanel, write_plot};

use super::TradeReport;
use crate::StudyError;

/// Half the size of a cross, over the width or height of the picture.
const CROSS: f64 = 0.008;

/// Draws all runs as crosses and their front as a line, decades of cost along and of error up.
pub(super) fn draw(file: &Path, report: &TradeReport) -> Result<(), StudyError> {
    // An error of zero has no place among decades: it stands at that of the reference.
    let least = report.reference_error.max(1e-9);
    let at = |place: &usize| {
        let case = &report.cases[*place];
        let cost = case.cost.wall_time().max(f64::MIN_POSITIVE);
        [cost.log10(), case.error.max(least).log10()]
    };
    let all: Vec<usize> = (0..report.cases.len()).collect();
    let points: Vec<[f64; 2]> = all.iter().map(at).collect();
    let range = |axis: usize| {
        let values = points.iter().map(|point| point[axis]);
        let least = values.clone().fold(f64::INFINITY, f64::min);
        (values.fold(f64::NEG_INFINITY, f64::max) - least).max(1.0)
    };
    let (width, height) = (CROSS * range(0), CROSS * range(1));
    let crosses: Vec<[Vec<f64>; 2]> = (points.iter())
        .map(|[x, y]| {
            [
                vec![x - width, x + width, *x, *x, *x],
                vec![*y, *y, *y, y - height, y + height],
            ]
        })
        .collect();
    let names: Vec<String> = report.cases.iter().map(|case| case.name.clone()).collect();
    let front: Vec<[f64; 2]> = report.front.iter().map(at).collect();
    let front: [Vec<f64>; 2] = [0, 1].map(|axis| front.iter().map(|p| p[axis]).collect());
    let mut curves = vec![PlotCurve {
        name: "front",
        x: &front[0],
        y: &front[1],
    }];
    curves.extend(
        crosses
            .iter()
            .zip(&names)
            .map(|([x, y], name)| PlotCurve { name, x, y }),
    );
    let plot = Plot {
        title: report.title.clone(),
        label: "decades of wall time of the whole run".into(),
        unit: "log10 s".into(),
        panels: vec![PlotPanel {
            label: "decades of relative error".into(),
            unit: "log10".into(),
            curves,
        }],
    };
    Ok(write_plot(file, &plot).map_err(powerhouse::Error::from)?)
}
