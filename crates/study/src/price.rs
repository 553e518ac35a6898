//! Pareto front of cost and error, and its plot.

use std::path::Path;

use powerhouse::io::{Plot, PlotCurve, PlotPanel, write_plot};

use crate::StudyError;

/// Half the size of a cross, over width and height of the plot, which is four times as wide as high.
const CROSS: [f64; 2] = [0.006, 0.024];
/// Least error that is drawn on the logarithmic axis; smaller ones are drawn there.
const LEAST: f64 = 1e-9;

/// Point of a cost-error diagram: an alternative with its cost and its error.
#[derive(Clone, Debug, PartialEq)]
pub struct ParetoPoint {
    /// Name of the alternative.
    pub name: String,
    /// Cost of the alternative, in one unit for all points, such as seconds of wall time.
    pub cost: f64,
    /// Error of the alternative, in one unit for all points, such as a relative one.
    pub error: f64,
}

/// Indices of the points on the Pareto front: those for which no other has both less cost and less error; the
/// cheapest first.
pub fn pareto_front(alternatives: &[ParetoPoint]) -> Vec<usize> {
    let mut front: Vec<usize> = (0..alternatives.len()).collect();
    front.sort_by(|&a, &b| {
        let (a, b) = (&alternatives[a], &alternatives[b]);
        a.cost.total_cmp(&b.cost).then(a.error.total_cmp(&b.error))
    });
    let mut least = f64::INFINITY;
    front.retain(|&index| {
        let better = alternatives[index].error < least;
        least = least.min(alternatives[index].error);
        better
    });
    front
}

/// Draws points as crosses and their Pareto front as a line, with logarithmic axes of cost (x) and error (y), into an
/// SVG file.
///
/// The label and the unit are those of the cost. An error below `uncertainty`, the error of the reference, or below
/// 1e-9, is drawn at that value.
///
/// # Errors
/// A file that cannot be written.
pub fn draw_pareto_front(
    file: &Path,
    title: &str,
    (label, unit): (&str, &str),
    alternatives: &[ParetoPoint],
    uncertainty: f64,
) -> Result<(), StudyError> {
    let least = uncertainty.max(LEAST);
    let at = |alternative: &ParetoPoint| {
        let cost = alternative.cost.max(f64::MIN_POSITIVE);
        [cost.log10(), alternative.error.max(least).log10()]
    };
    let points: Vec<[f64; 2]> = alternatives.iter().map(at).collect();
    let range = |axis: usize| {
        let values = points.iter().map(|point| point[axis]);
        let least = values.clone().fold(f64::INFINITY, f64::min);
        (values.fold(f64::NEG_INFINITY, f64::max) - least).max(1.0)
    };
    let [width, height] = [0, 1].map(|axis| CROSS[axis] * range(axis));
    let crosses: Vec<[Vec<f64>; 2]> = (points.iter())
        .map(|[x, y]| {
            [
                vec![x - width, x + width, *x, *x, *x],
                vec![*y, *y, *y, y - height, y + height],
            ]
        })
        .collect();
    let front = pareto_front(alternatives);
    let front: [Vec<f64>; 2] =
        [0, 1].map(|axis| front.iter().map(|&index| points[index][axis]).collect());
    let mut curves = vec![PlotCurve {
        name: "front",
        x: &front[0],
        y: &front[1],
    }];
    let named = crosses.iter().zip(alternatives);
    curves.extend(named.map(|([x, y], alternative)| PlotCurve {
        name: &alternative.name,
        x,
        y,
    }));
    let plot = Plot {
        title: title.into(),
        label: format!("decades of {label}"),
        unit: format!("log10 {unit}"),
        panels: vec![PlotPanel {
            label: "decades of relative error".into(),
            unit: "log10".into(),
            curves,
        }],
        gaps: Vec::new(),
    };
    Ok(write_plot(file, &plot).map_err(powerhouse::Error::from)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The front contains the points that no other dominates, equal ones once, by rising cost.
    #[test]
    fn the_front_contains_the_points_that_none_dominates() {
        let alternatives: Vec<ParetoPoint> =
            [(3.0, 0.1), (1.0, 0.5), (2.0, 0.5), (2.0, 0.3), (9.0, 0.2)]
                .map(|(cost, error)| ParetoPoint {
                    name: String::new(),
                    cost,
                    error,
                })
                .into();
        assert_eq!(pareto_front(&alternatives), [1, 3, 0]);
    }
}
