//! Which run comes next.
//!
//! First the reference, each factor at its most accurate level; then each other level of each factor
//! alone. What the combinations would come to is predicted from these: errors of different origin add
//! up like independent ones, costs by their ratios. Only the most promising combinations are run.

use super::{Factor, Goal};

/// The level of each factor.
pub(super) type Design = Vec<usize>;

/// What a design is known or expected to come to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ErrorAndCost {
    /// Relative error, without that of the reference.
    pub(super) error: f64,
    /// Wall time (s).
    pub(super) cost: f64,
}

impl ErrorAndCost {
    /// Whether it meets a goal, the reference's own error counted in.
    pub(super) fn meets(&self, goal: Goal, of_reference: f64) -> bool {
        match goal {
            Goal::Error(limit) => self.error + of_reference <= limit,
            Goal::Budget(limit) => self.cost <= limit,
            Goal::Front => true,
        }
    }
}

/// The reference, and each other level of each factor alone.
pub(super) fn alone(factors: &[Factor]) -> Vec<Design> {
    let reference = vec![0; factors.len()];
    let mut designs = vec![reference.clone()];
    for (place, factor) in factors.iter().enumerate() {
        for level in 1..factor.levels.len() {
            let mut design = reference.clone();
            design[place] = level;
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

/// What a design is expected to come to, from runs that differ from the reference in one factor;
/// none before those are there.
fn expected(design: &Design, known: &[(Design, ErrorAndCost)]) -> Option<ErrorAndCost> {
    let of = |design: &Design| known.iter().find(|(other, _)| other == design);
    let reference = of(&vec![0; design.len()])?.1;
    let (mut squares, mut cost) = (0.0, reference.cost);
    for (place, &level) in design.iter().enumerate().filter(|(_, level)| **level > 0) {
        let mut single = vec![0; design.len()];
        single[place] = level;
        let outlook = of(&single)?.1;
        squares += outlook.error.powi(2);
        cost *= outlook.cost / reference.cost;
    }
    let error = f64::sqrt(squares);
    Some(ErrorAndCost { error, cost })
}

/// The designs that were not run.
pub(super) fn unknown(
    factors: &[Factor],
    known: &[(Design, ErrorAndCost)],
    failed: &[Design],
) -> impl Iterator<Item = Design> {
    all(factors)
        .into_iter()
        .filter(|design| !failed.contains(design) && known.iter().all(|(other, _)| other != design))
}

/// The next design worth a run, once each level is known alone; none if no other promises more than
/// what was found.
pub(super) fn next(
    factors: &[Factor],
    (known, failed): (&[(Design, ErrorAndCost)], &[Design]),
    (goal, of_reference): (Goal, f64),
) -> Option<Design> {
    let best = best(known, (goal, of_reference));
    let mut promising: Vec<(Design, ErrorAndCost)> = unknown(factors, known, failed)
        .filter_map(|design| expected(&design, known).map(|outlook| (design, outlook)))
        .filter(|(_, outlook)| outlook.meets(goal, of_reference))
        .filter(
            |(_, outlook)| match (goal, best.map(|place| known[place].1)) {
                (Goal::Error(_), Some(best)) => outlook.cost < best.cost,
                (Goal::Budget(_), Some(best)) => outlook.error < best.error,
                (Goal::Front, _) => !known.iter().any(|(_, other)| dominates(other, outlook)),
                (_, None) => true,
            },
        )
        .collect();
    let rank = |outlook: &ErrorAndCost| match goal {
        Goal::Error(_) => outlook.cost,
        Goal::Budget(_) => outlook.error,
        // The corner of the front: much less cost for little more error.
        Goal::Front => outlook.cost * outlook.error,
    };
    promising.sort_by(|a, b| rank(&a.1).total_cmp(&rank(&b.1)));
    promising.into_iter().next().map(|(design, _)| design)
}

/// Whether one outlook is at least as good as another in both respects.
fn dominates(one: &ErrorAndCost, other: &ErrorAndCost) -> bool {
    one.error <= other.error && one.cost <= other.cost
}

/// The place of the best run for a goal: the cheapest of sufficient accuracy, the most accurate of
/// sufficient cheapness; without either, none.
pub(super) fn best(
    known: &[(Design, ErrorAndCost)],
    (goal, of_reference): (Goal, f64),
) -> Option<usize> {
    let meets = |place: &usize| known[*place].1.meets(goal, of_reference);
    let places = (0..known.len()).filter(meets);
    let rank = |place: &usize| match goal {
        Goal::Error(_) => known[*place].1.cost,
        Goal::Budget(_) => known[*place].1.error,
        Goal::Front => f64::INFINITY,
    };
    match goal {
        Goal::Front => None,
        _ => places.min_by(|a, b| rank(a).total_cmp(&rank(b))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trade::factor::test_factors;

    /// A made-up trade: errors that add up like independent ones, and cost ratios.
    fn truth(design: &Design) -> ErrorAndCost {
        let errors = [[0.0, 0.01, 0.05], [0.0, 0.004, 0.3]];
        let costs = [[1.0, 0.5, 0.2], [1.0, 0.6, 0.5]];
        let squares: f64 = (0..2).map(|f| f64::powi(errors[f][design[f]], 2)).sum();
        ErrorAndCost {
            error: squares.sqrt(),
            cost: 100.0 * costs[0][design[0]] * costs[1][design[1]],
        }
    }

    /// Runs as they are proposed, until no other promises more.
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
        let place = best(&known, (goal, 0.0)).unwrap();
        assert_eq!(known[place].0, [1, 1]);
        let goal = Goal::Budget(15.0);
        let known = sampled(goal);
        let place = best(&known, (goal, 0.0)).unwrap();
        assert_eq!(known[place].0, [2, 1]);
    }

    /// The error of the reference counts against the goal.
    #[test]
    fn the_error_of_the_reference_counts() {
        let outlook = ErrorAndCost {
            error: 0.018,
            cost: 1.0,
        };
        assert!(outlook.meets(Goal::Error(0.02), 0.001));
        assert!(!outlook.meets(Goal::Error(0.02), 0.003));
    }
}
