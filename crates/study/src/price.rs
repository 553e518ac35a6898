//! What choices cost and err: those that no other betters, and their picture.

use std::path::Path;

use powerhouse::io::{Plot, PlotCurve, PlotPanel, write_plot};

use crate::StudyError;

/// Half the size of a cross, over width and height of the picture, which is four times as wide as high.
const CROSS: [f64; 2] = [0.006, 0.024];
/// Errors below this are drawn here: zero has no place among decades.
const LEAST: f64 = 1e-9;

/// A choice with its cost and its error.
#[derive(Clone, Debug, PartialEq)]
pub struct Price {
    /// What was chosen.
    pub name: String,
    /// What it costs, in any unit.
    pub cost: f64,
    /// By how much it errs, in any unit.
    pub error: f64,
}

/// The places of those that no other one betters in both cost and error, the cheapest first.
pub fn price_front(prices: &[Price]) -> Vec<usize> {
    let mut places: Vec<usize> = (0..prices.len()).collect();
    places.sort_by(|&a, &b| {
        let (a, b) = (&prices[a], &prices[b]);
        a.cost.total_cmp(&b.cost).then(a.error.total_cmp(&b.error))
    });
    let mut least = f64::INFINITY;
    places.retain(|&place| {
        let better = prices[place].error < least;
        least = least.min(prices[place].error);
        better
    });
    places
}

/// Draws choices as crosses and their front as a line, decades of cost along and of error up.
///
/// `cost` says what the cost is and in which unit. An error below `uncertainty`, that of what errors are
/// measured against, or below 1e-9, is drawn there.
///
/// # Errors
/// A file that cannot be written.
pub fn draw_prices(
    file: &Path,
    title: &str,
    (label, unit): (&str, &str),
    prices: &[Price],
    uncertainty: f64,
) -> Result<(), StudyError> {
    let least = uncertainty.max(LEAST);
    let at = |price: &Price| {
        let cost = price.cost.max(f64::MIN_POSITIVE);
        [cost.log10(), price.error.max(least).log10()]
    };
    let points: Vec<[f64; 2]> = prices.iter().map(at).collect();
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
    let front = price_front(prices);
    let front: [Vec<f64>; 2] =
        [0, 1].map(|axis| front.iter().map(|&place| points[place][axis]).collect());
    let mut curves = vec![PlotCurve {
        name: "front",
        x: &front[0],
        y: &front[1],
    }];
    let named = crosses.iter().zip(prices);
    curves.extend(named.map(|([x, y], price)| PlotCurve {
        name: &price.name,
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
    };
    Ok(write_plot(file, &plot).map_err(powerhouse::Error::from)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The front holds what nothing betters in both respects, equal ones once, in rising cost.
    #[test]
    fn the_front_holds_what_nothing_betters() {
        let prices: Vec<Price> = [(3.0, 0.1), (1.0, 0.5), (2.0, 0.5), (2.0, 0.3), (9.0, 0.2)]
            .map(|(cost, error)| Price {
                name: String::new(),
                cost,
                error,
            })
            .into();
        assert_eq!(price_front(&prices), [1, 3, 0]);
    }
}
