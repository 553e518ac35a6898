//! Axial model of a bolt in grout: an elastoplastic bar in elastoplastic grout.

use super::{BoltEnd, BoltParameters, Grout};

/// The bar of one bolt in grout: consecutive segments, each with two end points in the rock.
#[derive(Clone, Debug)]
pub(super) struct Bar {
    /// Axial stiffness of each segment, `E A / l` (N/m).
    stiffness: Vec<f64>,
    lengths: Vec<f64>,
    yield_force: f64,
    pretension: f64,
    grout: Grout,
}

/// History variables of a bar, segment by segment.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct BarState {
    /// Plastic elongation (m) of each segment.
    pub(super) plastic: Vec<f64>,
    /// Plastic slip (m) of the grout at the two ends of each segment.
    pub(super) slip: Vec<[f64; 2]>,
    /// Axial force (N) of each segment.
    pub(super) force: Vec<f64>,
    /// Force (N) of the grout at the two ends of each segment.
    pub(super) grout: Vec<[f64; 2]>,
    /// Energy dissipated so far (J).
    pub(super) dissipated: f64,
}

/// Largest number of Newton corrections along a bolt.
const MOST_CORRECTIONS: usize = 500;
/// Largest number of bisections in the line search.
const MOST_HALVINGS: usize = 60;
/// Slope of the energy over that at the start of the line search which counts as zero.
const FLAT: f64 = 1.0e-3;
/// Tangent stiffness of a yielding bar or grout over the elastic one, in the corrections alone.
const LEAST_TANGENT: f64 = 1.0e-7;
/// Tolerance of unbalanced forces along the bolt over its largest force.
const BALANCED: f64 = 1.0e-12;
/// Tolerance where corrections do not reduce unbalanced forces any more.
const NEARLY_BALANCED: f64 = 1.0e-9;

impl Bar {
    pub(super) fn new(parameters: &BoltParameters, grout: Grout, lengths: Vec<f64>) -> Self {
        let axial = parameters.young * parameters.area;
        Self {
            stiffness: lengths.iter().map(|length| axial / length).collect(),
            lengths,
            yield_force: parameters.yield_force,
            pretension: parameters.pretension,
            grout,
        }
    }

    /// The state of a newly installed bar.
    pub(super) fn installed(&self) -> BarState {
        let count = self.lengths.len();
        BarState {
            plastic: vec![0.0; count],
            slip: vec![[0.0; 2]; count],
            force: vec![self.pretension; count],
            grout: vec![[0.0; 2]; count],
            dissipated: 0.0,
        }
    }

    /// Stored elastic energy (J) of a state.
    pub(super) fn stored(&self, state: &BarState) -> f64 {
        let bars = state.force.iter().zip(&self.stiffness);
        let mut energy: f64 = bars.map(|(force, k)| 0.5 * force * force / k).sum();
        for (pair, length) in state.grout.iter().zip(&self.lengths) {
            let stiffness = 0.5 * self.grout.stiffness * length;
            energy += 0.5 * (pair[0] * pair[0] + pair[1] * pair[1]) / stiffness;
        }
        energy
    }

    /// Number of segments.
    pub(super) fn segment_count(&self) -> usize {
        self.lengths.len()
    }

    /// Writes the new state of a segment and returns its axial force (N).
    fn pull(&self, k: usize, elongation: f64, old: &BarState, new: &mut BarState) -> f64 {
        let trial = self.pretension + self.stiffness[k] * (elongation - old.plastic[k]);
        let force = trial.clamp(-self.yield_force, self.yield_force);
        let flow = (trial - force) / self.stiffness[k];
        new.plastic[k] = old.plastic[k] + flow;
        new.dissipated += 0.5 * (old.force[k] + force) * flow;
        new.force[k] = force;
        force
    }

    /// Axial forces (N) at the two ends of each segment that resist their axial
    /// displacements `moved` (m) since installation; writes the new state. None if the equilibrium of bar and grout does
    /// not converge.
    pub(super) fn forces(
        &self,
        moved: &[[f64; 2]],
        old: &BarState,
        new: &mut BarState,
        out: &mut [[f64; 2]],
        balance: &mut Balance,
    ) -> Option<()> {
        self.balance(moved, old, balance)?;
        let (grout, w) = (&self.grout, &balance.w);
        new.dissipated = old.dissipated;
        for k in 0..self.lengths.len() {
            self.pull(k, w[k + 1] - w[k], old, new);
            for end in 0..2 {
                let (trial, force, stiffness) = self.grout_force((k, end), w, moved, old);
                let flow = (trial - force) / stiffness;
                new.slip[k][end] = old.slip[k][end] + flow;
                new.dissipated += 0.5 * (old.grout[k][end] + force) * flow;
                new.grout[k][end] = force;
                out[k][end] = -force;
            }
        }
        let last = self.lengths.len() - 1;
        if grout.head == BoltEnd::Anchored {
            out[0][0] = -new.force[0];
        }
        if grout.toe == BoltEnd::Anchored {
            out[last][1] = new.force[last];
        }
        Some(())
    }

    /// Elastic trial force and force (N) of the grout at an end of a segment, and its elastic stiffness (N/m).
    fn grout_force(
        &self,
        (k, end): (usize, usize),
        w: &[f64],
        moved: &[[f64; 2]],
        old: &BarState,
    ) -> (f64, f64, f64) {
        let grout = &self.grout;
        let half = 0.5 * self.lengths[k];
        let stiffness = grout.stiffness * half;
        let trial = stiffness * (w[k + end] - moved[k][end] - old.slip[k][end]);
        let strength = grout.strength * half;
        (trial, trial.clamp(-strength, strength), stiffness)
    }

    /// Computes the axial displacement `w` (m) of the bar at the ends of its segments, in equilibrium with the grout.
    ///
    /// Newton's method with line search on a convex, piecewise quadratic energy.
    fn balance(&self, moved: &[[f64; 2]], old: &BarState, balance: &mut Balance) -> Option<()> {
        let count = self.lengths.len();
        let Balance {
            w,
            step,
            tried,
            system,
        } = balance;
        w.clear();
        w.extend((0..=count).map(|i| {
            let before = i.checked_sub(1).map(|k| moved[k][1]);
            let after = moved.get(i).map(|ends| ends[0]);
            match (before, after) {
                (Some(a), Some(b)) => 0.5 * (a + b),
                (a, b) => a.or(b).unwrap_or(0.0),
            }
        }));
        system.reset(count + 1);
        system.held = [
            self.grout.head == BoltEnd::Anchored,
            self.grout.toe == BoltEnd::Anchored,
        ];
        let mut best = f64::INFINITY;
        for _ in 0..MOST_CORRECTIONS {
            let scale = self.assemble(w, moved, old, system);
            let size = system.size();
            let nearly = size <= NEARLY_BALANCED * scale && size >= 0.5 * best;
            if size <= BALANCED * scale || nearly {
                return Some(());
            }
            best = best.min(size);
            system.solve(step);
            let mut power = |share: f64, tried: &mut Vec<f64>| {
                tried.clear();
                tried.extend(w.iter().zip(&*step).map(|(w, s)| w + share * s));
                self.assemble(tried, moved, old, system);
                system.power(step)
            };
            let first = power(0.0, tried);
            let (mut low, mut high) = (0.0, 1.0);
            let mut share = 1.0;
            for _ in 0..MOST_HALVINGS {
                let now = power(share, tried);
                if now >= 0.0 {
                    low = share;
                } else {
                    high = share;
                }
                if share == 1.0 && now >= 0.0 || now.abs() <= FLAT * first {
                    break;
                }
                share = 0.5 * (low + high);
            }
            for (w, step) in w.iter_mut().zip(&*step) {
                *w += share * step;
            }
        }
        None
    }

    /// Assembles tangent and unbalanced forces; returns the largest force of bar and grout (N).
    fn assemble(
        &self,
        w: &[f64],
        moved: &[[f64; 2]],
        old: &BarState,
        system: &mut Tridiagonal,
    ) -> f64 {
        system.clear();
        let mut scale = f64::MIN_POSITIVE;
        for k in 0..self.lengths.len() {
            let stiffness = self.stiffness[k];
            let trial = self.pretension + stiffness * (w[k + 1] - w[k] - old.plastic[k]);
            let force = trial.clamp(-self.yield_force, self.yield_force);
            let tangent = if force == trial {
                stiffness
            } else {
                stiffness * LEAST_TANGENT
            };
            scale = scale.max(force.abs());
            system.rest[k] += force;
            system.rest[k + 1] -= force;
            system.diagonal[k] += tangent;
            system.diagonal[k + 1] += tangent;
            system.beside[k] -= tangent;
            for end in 0..2 {
                let (trial, force, stiffness) = self.grout_force((k, end), w, moved, old);
                scale = scale.max(force.abs());
                system.rest[k + end] -= force;
                system.diagonal[k + end] += if force == trial {
                    stiffness
                } else {
                    stiffness * LEAST_TANGENT
                };
            }
        }
        system.hold_ends();
        scale
    }

    /// Greatest axial force of the elastic bar in ground that is stretched uniformly, over that of a bar tied to the ground:
    /// that of its segments, and the exact one with the same ends.
    ///
    /// With `alpha^2 = k / (E A)` and the length `l` the exact force over the tied one is `1 - cosh(alpha x) / cosh(alpha l / 2)`
    /// at a distance `x` from the middle between free ends, `1 - cosh(alpha x) / cosh(alpha l)` at a distance `x` from an
    /// anchored head or toe, and one with both anchored (Cox 1952, British Journal of Applied Physics 3, for fibres).
    pub(super) fn stretched_force(&self) -> [f64; 2] {
        let free = self.unlimited();
        let mut moved = Vec::with_capacity(self.lengths.len());
        let mut length = 0.0;
        for segment in &self.lengths {
            moved.push([length, length + segment]);
            length += segment;
        }
        let (old, mut new) = (free.installed(), free.installed());
        let mut out = vec![[0.0; 2]; moved.len()];
        let axial = self.stiffness[0] * self.lengths[0];
        let found = free.forces(&moved, &old, &mut new, &mut out, &mut Balance::default());
        let greatest = new
            .force
            .iter()
            .fold(0.0_f64, |most, force| most.max(force.abs()));
        let share = length * (self.grout.stiffness / axial).sqrt();
        let exact = |share: f64| 1.0 - 1.0 / share.cosh();
        let right = match [self.grout.head, self.grout.toe] {
            [BoltEnd::Free, BoltEnd::Free] => exact(0.5 * share),
            [BoltEnd::Anchored, BoltEnd::Anchored] => 1.0,
            _ => exact(share),
        };
        [
            if found.is_some() {
                greatest / axial
            } else {
                right
            },
            right,
        ]
    }

    /// Elastic axial forces (N) at the two ends of each segment.
    pub(super) fn elastic(&self, moved: &[[f64; 2]], out: &mut [[f64; 2]], balance: &mut Balance) {
        let free = self.unlimited();
        let (old, mut new) = (free.installed(), free.installed());
        let found = free.forces(moved, &old, &mut new, out, balance);
        if found.is_none() {
            out.fill([0.0; 2]);
        }
    }

    /// The same bar without pretension that never yields, in grout that never slips.
    fn unlimited(&self) -> Self {
        Self {
            yield_force: f64::INFINITY,
            pretension: 0.0,
            grout: Grout {
                strength: f64::INFINITY,
                ..self.grout
            },
            stiffness: self.stiffness.clone(),
            lengths: self.lengths.clone(),
        }
    }
}

/// Working arrays of the equilibrium of a bar with its grout.
#[derive(Debug, Default)]
pub(super) struct Balance {
    /// Axial displacement (m) of the bar at the ends of its segments.
    w: Vec<f64>,
    step: Vec<f64>,
    tried: Vec<f64>,
    system: Tridiagonal,
}

/// A symmetric tridiagonal system of equations.
#[derive(Debug, Default)]
struct Tridiagonal {
    diagonal: Vec<f64>,
    /// Off-diagonal entries.
    beside: Vec<f64>,
    /// Right-hand side: unbalanced forces (N).
    rest: Vec<f64>,
    /// Whether the first and the last unknown are fixed.
    held: [bool; 2],
    /// The diagonal in the course of the elimination.
    pivots: Vec<f64>,
}

impl Tridiagonal {
    /// Sets the number of unknowns.
    fn reset(&mut self, count: usize) {
        self.diagonal.resize(count, 0.0);
        self.beside.resize(count - 1, 0.0);
        self.rest.resize(count, 0.0);
    }
    fn clear(&mut self) {
        self.diagonal.fill(0.0);
        self.beside.fill(0.0);
        self.rest.fill(0.0);
    }
    /// Removes fixed unknowns from the equations.
    fn hold_ends(&mut self) {
        let last = self.diagonal.len() - 1;
        for (index, beside) in [(0, 0), (last, last - 1)] {
            if self.held[usize::from(index > 0)] {
                self.diagonal[index] = 1.0;
                self.rest[index] = 0.0;
                self.beside[beside] = 0.0;
            }
        }
    }
    /// Norm of the unbalanced forces (N).
    fn size(&self) -> f64 {
        self.rest.iter().map(|rest| rest * rest).sum::<f64>().sqrt()
    }
    /// Product of the unbalanced forces with a step: the decrease of energy along it.
    fn power(&self, step: &[f64]) -> f64 {
        self.rest.iter().zip(step).map(|(r, s)| r * s).sum()
    }
    /// Computes the solution, by elimination without pivoting: the matrix is positive definite.
    fn solve(&mut self, solution: &mut Vec<f64>) {
        let count = self.diagonal.len();
        let pivots = &mut self.pivots;
        pivots.clone_from(&self.diagonal);
        solution.clone_from(&self.rest);
        for i in 1..count {
            let factor = self.beside[i - 1] / pivots[i - 1];
            pivots[i] -= factor * self.beside[i - 1];
            solution[i] -= factor * solution[i - 1];
        }
        solution[count - 1] /= pivots[count - 1];
        for i in (0..count - 1).rev() {
            solution[i] = (solution[i] - self.beside[i] * solution[i + 1]) / pivots[i];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grouted(lengths: Vec<f64>, ends: BoltEnd) -> Bar {
        let grout = Grout {
            stiffness: 1.0e9,
            strength: 4.0e5,
            head: ends,
            toe: ends,
        };
        let parameters = BoltParameters {
            yield_force: 200.0e3,
            grout: Some(grout),
            ..BoltParameters::steel(0.025).unwrap()
        };
        Bar::new(&parameters, grout, lengths)
    }

    /// The dissipated and the stored energy of a bar that is drawn through its grout are the work
    /// of its forces, to rounding, step by step, whether the bar or the grout yields, and wherever a joint opens.
    #[test]
    fn energies_of_a_bar_are_its_work() {
        for (ends, joint) in [
            (BoltEnd::Free, 6),
            (BoltEnd::Free, 4),
            (BoltEnd::Anchored, 6),
            (BoltEnd::Anchored, 3),
            (BoltEnd::Anchored, 10),
        ] {
            let bar = grouted(vec![0.25; 12], ends);
            let (mut old, mut balance) = (bar.installed(), Balance::default());
            let (mut before, mut moved) = (vec![[0.0; 2]; 12], vec![[0.0; 2]; 12]);
            let mut work = 0.0;
            for step in 1..60 {
                let opened = 2.0e-2 * (0.2 * f64::from(step)).sin();
                let last = moved.clone();
                for (k, ends) in moved.iter_mut().enumerate() {
                    *ends = if k < joint { [0.0; 2] } else { [opened; 2] };
                }
                let (mut new, mut out) = (old.clone(), vec![[0.0; 2]; 12]);
                bar.forces(&moved, &old, &mut new, &mut out, &mut balance)
                    .unwrap();
                for k in 0..12 {
                    for end in 0..2 {
                        let mean = 0.5 * (out[k][end] + before[k][end]);
                        work += mean * (moved[k][end] - last[k][end]);
                    }
                }
                let energy = bar.stored(&new) + new.dissipated;
                assert!(
                    (energy - work).abs() < 1e-9 * new.dissipated.max(1.0),
                    "{energy} {work}"
                );
                (old, before) = (new, out);
            }
            assert!(old.dissipated > 100.0);
        }
    }
}
