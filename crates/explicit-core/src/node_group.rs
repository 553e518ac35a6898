//! A group of nodes with one common motion: its mass, impedance and conditions, and the matrices of its velocity update.

use powerhouse_model::{MassDampingRule, Mat3, Vec3};

use crate::condition::Condition;
use crate::effective_mass::inverse;

/// Pseudo-mass of an orphan node (one without active elements), over the least mass of a node of the model.
const ORPHAN_MASS: f64 = 1e-12;

/// A group of nodes with one common motion: mass, impedance and boundary conditions. Most groups have one member.
#[derive(Clone, Debug, Default)]
pub(crate) struct NodeGroup {
    /// Engine nodes; the first one is the lead, which carries the group's values in nodal vectors.
    pub(crate) members: Vec<u32>,
    /// Mass (kg).
    pub(crate) mass: f64,
    /// Mass damping (kg/s).
    pub(crate) mass_damping: f64,
    /// Dashpot to the ground (N s/m).
    pub(crate) dashpot: Mat3,
    /// Spring to the ground (N/m).
    pub(crate) spring: Mat3,
    /// Skew coupling of y with x and z at the faces of a delayed slice (N s/m).
    pub(crate) gyroscopic: Mat3,
    /// Fixed and prescribed directions.
    pub(crate) condition: Condition,
    /// Inertia that its fibre adds to its own motion, over the mass (1); zero without a fibre.
    pub(crate) added: f64,
    /// Added mass, as of water (kg), which differs by direction; not damped.
    pub(crate) directed_mass: Mat3,
}

/// Matrices of the velocity update in one step, with the effective mass `A = M + dt/2 C + dt^2/4 K`;
/// `M` has the added mass.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Coefficients {
    /// New velocity per old velocity: `P (M - dt/2 C + dt^2/4 K)`.
    pub(crate) carry: Mat3,
    /// `P`, the inverse of `A` in the free directions, zero in the fixed ones (1/kg).
    pub(crate) inverse: Mat3,
    /// Map from the prescribed velocities along the condition's directions to the velocity of the node.
    pub(crate) lift: Mat3,
}

pub(crate) fn is_diagonal(matrix: &Mat3) -> bool {
    *matrix == Mat3::from_diagonal(&matrix.diagonal())
}

/// The coordinate axis along which a unit vector lies; none for an oblique one.
fn axis_of(direction: &Vec3) -> Option<usize> {
    let axis = direction.iamax();
    (direction.abs().sum() == direction[axis].abs()).then_some(axis)
}

impl NodeGroup {
    /// Impulse (N s) of inertia, dashpot and spring in a step between two velocities (m/s),
    /// `A v+ - (M - dt/2 C + dt^2/4 K) v-`.
    pub(crate) fn impulse(
        &self,
        (rule, step): (MassDampingRule, f64),
        before: &Vec3,
        after: &Vec3,
    ) -> Vec3 {
        let (mass, old) = self.effective_mass(rule, step);
        let spring = self.spring * (after - before) * (0.25 * step * step);
        let dashpot = self.dashpot * (after + before) * (0.5 * step);
        let own = after * mass - before * old + dashpot + spring;
        if self.has_directed_mass() {
            own + self.directed_mass * (after - before)
        } else {
            own
        }
    }

    /// Whether the group has no dashpot, spring, mass damping or prescribed motion, whose forces do work.
    pub(crate) fn is_bare(&self) -> bool {
        let still = self.dashpot == Mat3::zeros() && self.spring == Mat3::zeros();
        still && self.mass_damping == 0.0 && self.condition.prescribed.is_empty()
    }

    /// Whether the group has an added mass that differs by direction.
    pub(crate) fn has_directed_mass(&self) -> bool {
        self.directed_mass != Mat3::zeros()
    }

    /// Whether the group has a mass only, without dashpot, spring or added mass.
    fn has_mass_only(&self) -> bool {
        let still = self.dashpot == Mat3::zeros() && self.spring == Mat3::zeros();
        still && !self.has_directed_mass()
    }

    /// Contributions (kg) of mass and mass damping to `A` and to the factor of the old velocity; of a group in a
    /// fibre, those by itself.
    pub(crate) fn effective_mass(&self, rule: MassDampingRule, step: f64) -> (f64, f64) {
        let damping = self.mass_damping * step;
        rule.effective_mass(self.mass * (1.0 + self.added), damping)
    }

    /// Inverse pseudo-mass (1/kg) of a group of orphan nodes, which constraints use in place of
    /// [`Coefficients::inverse`]; none for a group with mass. The pseudo-mass is negligible beside `least` (kg), the
    /// least mass of a node of the model, so that the node follows its partner and carries no force.
    pub(crate) fn orphan_inverse(&self, least: f64) -> Option<Mat3> {
        let nothing = || Mat3::identity() / (ORPHAN_MASS * least);
        (self.mass <= 0.0).then(|| self.condition.project(&nothing()).0)
    }

    /// Whether the group is one node with a positive mass and no fixed direction, dashpot, spring or added mass.
    pub(crate) fn has_scalar_mass(&self) -> bool {
        let free = self.condition.directions().is_empty();
        let alone = self.members.len() == 1 && self.mass > 0.0;
        alone && free && self.has_mass_only()
    }

    /// The coordinate axes along which the group is fixed, if it is one node with a mass only that is fixed along
    /// coordinate axes or not at all, and has no fibre; none for any other group.
    pub(crate) fn held_axes(&self) -> Option<[bool; 3]> {
        self.axes().filter(|_| self.added == 0.0)
    }

    /// Whether the group is a node of a fibre that would be a roller node or a plain one without.
    pub(crate) fn is_fibre_node(&self) -> bool {
        self.added > 0.0 && self.mass > 0.0 && self.axes().is_some()
    }

    /// The same axes with a fibre or without.
    fn axes(&self) -> Option<[bool; 3]> {
        let alone = self.members.len() == 1 && self.condition.prescribed.is_empty();
        if !alone || !self.has_mass_only() {
            return None;
        }
        let mut held = [false; 3];
        for direction in self.condition.directions() {
            held[axis_of(direction)?] = true;
        }
        Some(held)
    }

    /// Whether all its matrices are diagonal: dashpot, spring and added mass are, and fixed and prescribed directions are coordinate
    /// axes.
    pub(crate) fn is_diagonal(&self) -> bool {
        let along_axes = |direction| axis_of(direction).is_some();
        let matrices = [&self.dashpot, &self.spring, &self.directed_mass];
        matrices.into_iter().all(is_diagonal) && self.condition.directions().iter().all(along_axes)
    }

    pub(crate) fn coefficients(&self, rule: MassDampingRule, step: f64) -> Coefficients {
        if self.mass <= 0.0 {
            // An orphan node: dashpots and springs that it may have are ignored.
            let zeros = Mat3::zeros();
            let (carry, inverse) = (zeros, zeros);
            let lift = self.condition.project(&inverse).1;
            return Coefficients {
                carry,
                inverse,
                lift,
            };
        }
        let (mass, old) = self.effective_mass(rule, step);
        if let (true, Some(held)) = (self.is_fibre_node(), self.axes()) {
            let free = Vec3::from(held.map(|held| if held { 0.0 } else { 1.0 }));
            return Coefficients {
                carry: Mat3::from_diagonal(&(free * (old / mass))),
                inverse: Mat3::from_diagonal(&(free / mass)),
                lift: Mat3::zeros(),
            };
        }
        let spring = self.spring * (0.25 * step * step);
        let mut added = self.dashpot * (0.5 * step) + spring;
        // The factor of the old velocity is `mass + old + 2 (spring + added mass) - A`, and `P A` is known: nothing
        // cancels where a dashpot far outweighs the mass.
        let mut kept = Mat3::identity() * (mass + old) + spring * 2.0;
        if self.has_directed_mass() {
            added += self.directed_mass;
            kept += self.directed_mass * 2.0;
        }
        let (inverse, lift) = self.condition.project(&inverse(mass, &added));
        Coefficients {
            carry: inverse * kept - self.condition.kept(&lift),
            inverse,
            lift,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Where a dashpot at an angle outweighs the mass by up to 1e12 a node still moves across it as
    /// its mass demands, and along it as the dashpot lets it, neither faster nor slower; with a
    /// roller at another angle it keeps to its plane.
    #[test]
    fn a_dashpot_that_outweighs_the_mass_leaves_it_its_digits() {
        let normal = Vec3::new(1.0, 2.0, -0.5).normalize();
        let along = normal * normal.transpose();
        let across = Mat3::identity() - along;
        let (mass, step) = (3.0, 1e-3);
        let rule = MassDampingRule::Implicit;
        for ratio in [1e-3, 1.0, 1e4, 1e8, 1e12] {
            let group = NodeGroup {
                members: vec![0],
                mass,
                dashpot: along * (2.0 * ratio * mass / step),
                ..NodeGroup::default()
            };
            let found = group.coefficients(rule, step);
            let inverse = (across + along / (1.0 + ratio)) / mass;
            let error = (found.inverse - inverse).amax() * mass;
            assert!(error < 1e-14, "{ratio:e}: {error:e}");
            let carry = across + along * ((1.0 - ratio) / (1.0 + ratio));
            let error = (found.carry - carry).amax();
            assert!(error < 1e-14, "{ratio:e}: {error:e}");

            let roller = Vec3::new(0.3, 0.1, 1.0).normalize();
            let mut held = group.clone();
            held.condition.hold(roller);
            let found = held.coefficients(rule, step);
            let free = roller.cross(&normal).normalize();
            let error = (found.carry * free - free).norm();
            assert!(error < 1e-13, "{ratio:e}: {error:e}");
            let error = (found.inverse * free - free / mass).norm();
            assert!(error < 1e-13, "{ratio:e}: {error:e}");
            let velocity = (Mat3::identity() - roller * roller.transpose()) * normal;
            let carried = found.carry * velocity;
            assert!(
                carried.norm() <= velocity.norm() * (1.0 + 1e-13),
                "{ratio:e}"
            );
            assert!(carried.dot(&roller).abs() < 1e-15, "{ratio:e}");
        }
    }

    /// Springs, dashpots and mass damping at angles, a roller and a prescribed motion: the kick obeys
    /// the equation of motion in the free directions, and the impulse of the step says so.
    #[test]
    fn a_kick_obeys_the_equation_of_motion() {
        let axis = |x: f64, y: f64, z: f64| {
            let normal = Vec3::new(x, y, z).normalize();
            normal * normal.transpose()
        };
        let mut group = NodeGroup {
            members: vec![0],
            mass: 2.0,
            mass_damping: 7.0,
            dashpot: axis(1.0, 2.0, -0.5) * 300.0 + axis(0.3, -0.2, 1.0) * 90.0,
            spring: axis(0.2, 1.0, 0.7) * 4e4,
            ..NodeGroup::default()
        };
        let (held, prescribed) = (
            Vec3::new(0.6, 0.0, 0.8),
            Vec3::new(1.0, 1.0, -1.0).normalize(),
        );
        group.condition.hold(held);
        assert!(group.condition.prescribe(prescribed, 0));
        let step = 1e-2;
        let before = held.cross(&prescribed) * 0.7 + group.condition.along(&[0.3]);
        let force = Vec3::new(5.0, -11.0, 3.0);
        for rule in [MassDampingRule::Implicit, MassDampingRule::Lagged] {
            let found = group.coefficients(rule, step);
            let target = found.lift * group.condition.target(&[-0.4]);
            let after = found.carry * before + found.inverse * force * step + target;
            assert!(after.dot(&held).abs() < 1e-15);
            assert!((after.dot(&prescribed) + 0.4).abs() < 1e-15);
            let residual = group.impulse((rule, step), &before, &after) - force * step;
            assert!(group.condition.free(residual).norm() < 1e-14, "{residual}");
        }
    }
}
