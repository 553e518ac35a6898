//! Bodies whose joint slides: their highest frequency, and the growth of their oscillations.

use core::f64::consts::PI;

use nalgebra::{Complex, DMatrix, Schur};
use powerhouse_contact::{BondedCoulomb, Joint};
use powerhouse_model::{ContactState, JointPair, Vec3};

use super::Bodies;

/// Pressing force (N) on the joint.
const PRESSURE: f64 = 1e3;

/// Masses (kg) in the plane x z, the first of them on ground that moves along x beneath it.
struct Network {
    masses: Vec<f64>,
    /// Springs: mass, other mass or ground, angle from x (rad), stiffness (N/m).
    springs: Vec<(usize, Option<usize>, f64, f64)>,
    friction: f64,
    /// Direction along x in which the first mass slips over the ground: 1 or -1.
    slip: f64,
}

impl Network {
    /// One mass on a spring whose angle is that at which friction raises the frequency most.
    fn steepest(friction: f64) -> Self {
        let angle = 0.5 * friction.atan();
        Self {
            masses: vec![1.0],
            springs: vec![(0, None, angle, 1.0)],
            friction,
            slip: 1.0,
        }
    }
    /// Bar of four links, soft across, that leans by an angle (rad) from the normal of the joint.
    fn bar(friction: f64, lean: f64, slip: f64) -> Self {
        let axis = 0.5 * PI - lean;
        let mut springs = vec![(4, None, axis, 2.0)];
        springs.extend((0..4).map(|i| (i, Some(i + 1), axis, 1.0)));
        springs.extend((0..5).map(|i| (i, None, axis + 0.5 * PI, 0.2)));
        Self {
            masses: vec![0.5, 1.0, 1.0, 1.0, 1.0],
            springs,
            friction,
            slip,
        }
    }

    /// `M^-1/2 K M^-1/2` of the open body (1/s2), with x and z of each mass.
    fn operator(&self) -> DMatrix<f64> {
        let count = self.masses.len();
        let mut operator = DMatrix::zeros(2 * count, 2 * count);
        for &(mass, other, angle, stiffness) in &self.springs {
            let mut row = DMatrix::zeros(2 * count, 1);
            for (node, sign) in [(Some(mass), 1.0), (other, -1.0)] {
                if let Some(node) = node {
                    let scale = sign / self.masses[node].sqrt();
                    row[2 * node] = angle.cos() * scale;
                    row[2 * node + 1] = angle.sin() * scale;
                }
            }
            operator += &row * row.transpose() * stiffness;
        }
        operator
    }
    /// Highest angular frequency of the open body (rad/s).
    fn highest(&self) -> f64 {
        self.operator().symmetric_eigenvalues().max().sqrt()
    }
    /// Squared frequencies (1/s2) of the body that slides: the normal of the first mass is held, and `mu` times the change of
    /// pressure acts along x, against the slip.
    fn sliding(&self) -> Vec<Complex<f64>> {
        let mut operator = self.operator();
        // Pressure grows by as much as the springs pull the mass down.
        let normal = operator.row(1).into_owned();
        let mut first = operator.row_mut(0);
        first += normal * (self.friction * self.slip);
        let operator = operator.remove_row(1).remove_column(1);
        let schur = Schur::try_new(operator, 1e-14, 10_000).unwrap();
        schur.complex_eigenvalues().iter().copied().collect()
    }
    /// Growth rate (1/s) of central differences with a step (s) for the fastest eigenvector of the sliding body: of
    /// `z + 1/z = 2 - step^2 w^2`.
    fn growth(&self, step: f64) -> f64 {
        let of = |squared: Complex<f64>| {
            let half = Complex::from(1.0) - squared * (0.5 * step * step);
            let root = (half * half - 1.0).sqrt();
            (half + root).norm().max((half - root).norm()).ln() / step
        };
        self.sliding().into_iter().map(of).fold(0.0, f64::max)
    }

    /// Forces of the springs (N).
    fn forces(&self, displacement: &[Vec3]) -> Vec<Vec3> {
        let mut forces = vec![Vec3::zeros(); displacement.len()];
        for &(mass, other, angle, stiffness) in &self.springs {
            let axis = Vec3::new(angle.cos(), 0.0, angle.sin());
            let far = other.map_or(Vec3::zeros(), |other| displacement[other + 1]);
            let force = axis * (stiffness * axis.dot(&(displacement[mass + 1] - far)));
            forces[mass + 1] -= force;
            if let Some(other) = other {
                forces[other + 1] += force;
            }
        }
        forces
    }
    /// Largest displacements (m) from equilibrium in each of ten equal parts of so many steps, from a displacement of 1e-9 m;
    /// the ground slips with 1 m/s beneath the body. Ends early when a displacement exceeds 1e-4 m.
    fn run(&self, step: f64, steps: u32) -> Vec<f64> {
        let law = BondedCoulomb::unbonded(self.friction, self.friction).unwrap();
        let pair = JointPair::new([0, 1], Vec3::z(), 1.0);
        let mut joint = Joint::new("ground", vec![pair], law).unwrap();
        let mut masses = vec![1.0];
        masses.extend(&self.masses);
        let mut bodies = Bodies::at_rest(&masses, step);
        bodies.fixed[0] = true;
        bodies.velocity[0].x = -self.slip;
        for body in 1..masses.len() {
            bodies.displacement[body].x = 1e-9 * if body % 2 == 1 { 1.0 } else { -0.7 };
        }
        let push = Vec3::new(self.slip * self.friction, 0.0, -1.0) * PRESSURE;
        let (mut largest, mut parts) = (0.0_f64, Vec::new());
        for number in 1..=steps {
            let mut forces = self.forces(&bodies.displacement);
            forces[1] += push;
            let ground = Vec3::x() * -self.slip;
            bodies
                .step(
                    &mut joint,
                    |body| if body == 0 { ground } else { forces[body] },
                )
                .unwrap();
            assert_eq!(joint.records()[0].state.contact, ContactState::Slide);
            for displacement in &bodies.displacement[1..] {
                largest = largest.max(displacement.norm());
            }
            if number % (steps / 10) == 0 || largest > 1e-4 {
                parts.push(core::mem::take(&mut largest));
                if parts[parts.len() - 1] > 1e-4 {
                    break;
                }
            }
        }
        parts
    }
}

/// Factor on the stable step of the open body that suffices while its joint slides with a coefficient of friction.
fn factor(friction: f64) -> f64 {
    (2.0 / (1.0 + friction.hypot(1.0))).sqrt()
}

/// A joint that slides raises the highest squared frequency by at most `(1 + sqrt(1 + mu^2)) / 2`, whatever the spring and
/// the direction of slip: central differences at 0.98 of the step of that are stable for 50,000 steps; the bound is reached,
/// so that a step 2 % above it is not.
#[test]
fn friction_raises_the_highest_frequency_to_its_bound_and_no_further() {
    for friction in [0.0, 0.1, 0.3, 0.6, 0.839, 1.0, 1.5, 2.0] {
        let body = Network::steepest(friction);
        let limit = 2.0 / body.highest() * factor(friction);
        let stable = body.run(0.98 * limit, 50_000);
        assert!(
            stable.len() == 10 && stable[9] < 1.1 * stable[0],
            "{friction}: {stable:?}"
        );
        let beyond = body.run(1.02 * limit, 2_000);
        assert!(beyond[beyond.len() - 1] > 1e-4, "{friction}: {beyond:?}");
        for lean in [0.05, 0.17, 0.4, 0.8, 1.2] {
            for slip in [1.0, -1.0] {
                let bar = Network::bar(friction, lean, slip);
                let most = bar.sliding().iter().map(|w| w.norm()).fold(0.0, f64::max);
                let bound = (bar.highest() / factor(friction)).powi(2);
                assert!(
                    most <= bound * (1.0 + 1e-12),
                    "{friction} {lean} {slip}: {most} {bound}"
                );
            }
        }
    }
}

/// The growth rate of a bar that slides undamped is that of its complex frequencies, to 15 %, at a step near the limit as at
/// a quarter of it; where they are real nothing grows in 50,000 steps near the limit.
#[test]
fn the_growth_of_a_sliding_bar_is_that_of_its_complex_frequencies_at_any_step() {
    let mut grew = 0;
    for friction in [0.0, 0.1, 0.3, 0.6, 1.0, 2.0] {
        for (lean, slip) in [(0.17, 1.0), (0.17, -1.0)] {
            let bar = Network::bar(friction, lean, slip);
            let limit = 2.0 / bar.highest() * factor(friction);
            for share in [0.98, 0.5, 0.25] {
                let step = share * limit;
                let expected = bar.growth(step);
                if expected * step < 1e-9 {
                    let still = bar.run(step, if share > 0.9 { 50_000 } else { 5_000 });
                    assert!(still[9] < 3e-8, "{friction} {lean} {share}: {still:?}");
                    continue;
                }
                // Nine e-folds, the first third of which is left to the other eigenvectors.
                let part = 0.9 / (expected * step);
                let grown = bar.run(step, 10 * part.ceil() as u32);
                let rate = (grown[9] / grown[3]).ln() / (6.0 * part.ceil() * step);
                let at_no_step = bar.growth(1e-3 * limit);
                assert!(
                    (rate / expected - 1.0).abs() < 0.15,
                    "{friction} {lean} {share}: {rate} {expected}"
                );
                assert!(
                    expected > 0.7 * at_no_step,
                    "{friction} {lean} {share}: {expected} {at_no_step}"
                );
                grew += 1;
            }
        }
    }
    // Four coefficients, in one of the two directions, at three steps.
    assert_eq!(grew, 12);
}
