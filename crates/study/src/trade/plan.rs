//! Order of the runs of a trade study.
//!
//! First the reference is run, with each factor at its most accurate level; then each other level of each factor alone.
//! From these the combinations are predicted: squared errors add up, as of independent errors, and cost ratios multiply.
//! Only the most promising combinations are run.

use super::{Factor, Goal};

/// Design of a run: the index of the level of each factor.
pub(super) type Design = Vec<usize>;

/// Measured or predicted error and cost of a design.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ErrorAndCost {
    /// Relative error, without that of the reference.
    pub(super) error: f64,
    /// Wall time (s).
    pub(super) cost: f64,
}

impl ErrorAndCost {
    /// Whether a goal is met, with the error of the reference added.
    pub(super) fn meets(&self, goal: Goal, of_reference: f64) -> bool {
        match goal {
            Goal::Error(limit) => self.error + of_reference <= limit,
            Goal::Budget(limit) => self.cost <= limit,
            Goal::Front => true,
        }
    }
}

/// The reference and all designs with one other level.
pub(super) fn alone(factors: &[Factor]) -> Vec<Design> {
    let reference = vec![0; factors.len()];
    let mut designs = vec![reference.clone()];
    for (index, factor) in factors.iter().enumerate() {
        for level in 1..factor.levels.len() {
            let mut design = reference.clone();
            design[index] = level;
            designs.push(design);
        }
    }
    designs
}

/// All designs.
pub(super) fn all(factors: &[Factor]) -> Vec<Design> {
    let mut designs = vec![Vec::new()];
    for factor in factors {
        let with = |design: &Design| {
            let levels = 0..factor.levels.len();
            let extended = levels.map(|level| [design.as_slice(), &[level]].concat());
            extended.collect::<Vec<_>>()
        };
        designs = designs.iter().flat_map(with).collect();
    }
    designs
}

/// Predicts error and cost of a design from the runs with one changed level; `None` if one of those is missing.
fn predicted(design: &Design, known: &[(Design, ErrorAndCost)]) -> Option<ErrorAndCost> {
    let of = |design: &Design| known.iter().find(|(other, _)| other == design);
    let reference = of(&vec![0; design.len()])?.1;
    let (mut squares, mut cost) = (0.0, reference.cost);
    for (index, &level) in design.iter().enumerate().filter(|(_, level)| **level > 0) {
        let mut single = vec![0; design.len()];
        single[index] = level;
        let known = of(&single)?.1;
        squares += known.error.powi(2);
        cost *= known.cost / reference.cost;
    }
    let error = f64::sqrt(squares);
    Some(ErrorAndCost { error, cost })
}

/// The designs that have not been run.
pub(super) fn unknown(
    factors: &[Factor],
    known: &[(Design, ErrorAndCost)],
    failed: &[Design],
) -> impl Iterator<Item = Design> {
    all(factors)
        .into_iter()
        .filter(|design| !failed.contains(design) && known.iter().all(|(other, _)| other != design))
}

/// The most promising design that has not been run, once each level was run alone; `None` if no design is predicted to
/// be better than the best known one.
pub(super) fn next(
    factors: &[Factor],
    (known, failed): (&[(Design, ErrorAndCost)], &[Design]),
    (goal, of_reference): (Goal, f64),
) -> Option<Design> {
    let best = best(known, (goal, of_reference));
    let mut promising: Vec<(Design, ErrorAndCost)> = unknown(factors, known, failed)
        .filter_map(|design| predicted(&design, known).map(|found| (design, found)))
        .filter(|(_, found)| found.meets(goal, of_reference))
        .filter(
            |(_, found)| match (goal, best.map(|index| known[index].1)) {
                (Goal::Error(_), Some(best)) => found.cost < best.cost,
                (Goal::Budget(_), Some(best)) => found.error < best.error,
                (Goal::Front, _) => !known.iter().any(|(_, other)| dominates(other, found)),
                (_, None) => true,
            },
        )
        .collect();
    let rank = |found: &ErrorAndCost| match goal {
        Goal::Error(_) => found.cost,
        Goal::Budget(_) => found.error,
        // Near the corner of the front: much less cost for little more error.
        Goal::Front => found.cost * found.error,
    };
    promising.sort_by(|a, b| rank(&a.1).total_cmp(&rank(&b.1)));
    promising.into_iter().next().map(|(design, _)| design)
}

/// Whether one design has at most the error and at most the cost of another.
fn dominates(one: &ErrorAndCost, other: &ErrorAndCost) -> bool {
    one.error <= other.error && one.cost <= other.cost
}

/// The index of the best run for a goal: the cheapest within an error, the most accurate within a budget; `None` for
/// the front alone or if no run meets the goal.
pub(super) fn best(
    known: &[(Design, ErrorAndCost)],
    (goal, of_reference): (Goal, f64),
) -> Option<usize> {
    let meets = |index: &usize| known[*index].1.meets(goal, of_reference);
    let indices = (0..known.len()).filter(meets);
    let rank = |index: &usize| match goal {
        Goal::Error(_) => known[*index].1.cost,
        Goal::Budget(_) => known[*index].1.error,
        Goal::Front => f64::INFINITY,
    };
    match goal {
        Goal::Front => None,
        _ => indices.min_by(|a, b| rank(a).total_cmp(&rank(b))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trade::factor::test_factors;

    /// Artificial errors that add up as independent ones, with cost ratios.
    fn truth(design: &Design) -> ErrorAndCost {
        let errors = [[0.0, 0.01, 0.05], [0.0, 0.004, 0.3]];
        let costs = [[1.0, 0.5, 0.2], [1.0, 0.6, 0.5]];
        let squares: f64 = (0..2).map(|f| f64::powi(errors[f][design[f]], 2)).sum();
        ErrorAndCost {
            error: squares.sqrt(),
            cost: 100.0 * costs[0][design[0]] * costs[1][design[1]],
        }
    }

    /// The proposed runs, until no further design is predicted to be better.
    fn sampled(goal: Goal) -> Vec<(Design, ErrorAndCost)> {
        let factors = test_factors(&[3, 3]);
        let mut known: Vec<(Design, ErrorAndCost)> = alone(&factors)
            .into_iter()
            .map(|d| (d.clone(), truth(&d)))
            .collect();
        assert_eq!(known.len(), 5);
        while let Some(design) = next(&factors, (&known, &[]), (goal, 0.0)) {
            known.push((design.clone(), truth(&design)));
        }
        known
    }

    /// Of nine designs one more than those of single levels is run before the cheapest of sufficient
    /// accuracy is found; the same for the most accurate within a budget.
    #[test]
    fn the_best_design_is_found_with_few_runs() {
        let goal = Goal::Error(0.02);
        let known = sampled(goal);
        assert_eq!(known.len(), 6);
        let index = best(&known, (goal, 0.0)).unwrap();
        assert_eq!(known[index].0, [1, 1]);
        let goal = Goal::Budget(15.0);
        let known = sampled(goal);
        let index = best(&known, (goal, 0.0)).unwrap();
        assert_eq!(known[index].0, [2, 1]);
    }

    /// The error of the reference counts against the goal.
    #[test]
    fn the_error_of_the_reference_counts() {
        let found = ErrorAndCost {
            error: 0.018,
            cost: 1.0,
        };
        assert!(found.meets(Goal::Error(0.02), 0.001));
        assert!(!found.meets(Goal::Error(0.02), 0.003));
    }
}
