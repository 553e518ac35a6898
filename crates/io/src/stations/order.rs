//! Order of the components of stations, by comparison with a control point.

/// All orders of three components.
const ORDERS: [[usize; 3]; 6] = [
    [0, 1, 2],
    [0, 2, 1],
    [1, 0, 2],
    [1, 2, 0],
    [2, 0, 1],
    [2, 1, 0],
];
/// How much better another order must fit to be taken for theirs.
const CLEARLY: f64 = 1.2;

/// Order of the components of a station in which their energies resemble those of a control point, if it fits clearly better
/// than their own: component `i` of the control point is component `order[i]` of the station.
///
/// The measure is the sum of the products of their roots mean square, greatest where both have the same order of strength. It does
/// not depend on the time by which a wave passes one before the other; motions as strong in all directions have no other
/// order.
pub(super) fn other_order(control: [f64; 3], station: [f64; 3]) -> Option<[usize; 3]> {
    let fit = |order: &[usize; 3]| -> f64 { (0..3).map(|i| control[i] * station[order[i]]).sum() };
    let best = ORDERS.iter().max_by(|a, b| fit(a).total_cmp(&fit(b)))?;
    (fit(best) > CLEARLY * fit(&ORDERS[0])).then_some(*best)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An order is found where the strength of the components differs, and only there.
    #[test]
    fn an_order_is_found_by_the_strength_of_components() {
        assert_eq!(other_order([4.0, 0.0, 1.0], [3.9, 0.1, 1.1]), None);
        assert_eq!(
            other_order([4.0, 0.1, 1.0], [1.1, 3.9, 0.1]),
            Some([1, 2, 0])
        );
        assert_eq!(other_order([1.0, 0.9, 1.1], [0.9, 1.1, 1.0]), None);
        assert_eq!(other_order([0.0; 3], [0.0; 3]), None);
    }
}
