//! Fixed and prescribed directions of nodes.

use powerhouse_model::{Mat3, Vec3};

/// Fixed and prescribed directions of one node.
#[derive(Clone, Debug, Default)]
pub(crate) struct Condition {
    /// Orthonormal directions, fixed or prescribed.
    basis: Vec<Vec3>,
    /// Velocity along each of them, as linear combination of the velocities of `prescribed`.
    targets: Vec<Vec<f64>>,
    /// Unit direction and index of the prescribed motion.
    pub(crate) prescribed: Vec<(Vec3, usize)>,
}

/// Sine of the angle below which two directions count as parallel.
const PARALLEL: f64 = 1e-8;

impl Condition {
    /// Fixes a unit direction.
    pub(crate) fn hold(&mut self, direction: Vec3) {
        let rest = self.rest(direction);
        if rest.norm() > PARALLEL {
            self.basis.push(rest.normalize());
            self.targets.push(vec![0.0; self.prescribed.len()]);
        }
    }

    /// Prescribes the motion along a unit direction; returns false if the direction is not free.
    pub(crate) fn prescribe(&mut self, direction: Vec3, motion: usize) -> bool {
        if self.prescribed.contains(&(direction, motion)) {
            return true;
        }
        let rest = self.rest(direction);
        if rest.norm() <= PARALLEL {
            return false;
        }
        // direction = rest + sum_i (direction . q_i) q_i, so the new q moves at
        // (v - sum_i (direction . q_i) v_i) / |rest|.
        let scale = rest.norm();
        let mut target = vec![0.0; self.prescribed.len() + 1];
        for (q, of_q) in self.basis.iter().zip(&self.targets) {
            for (sum, part) in target.iter_mut().zip(of_q) {
                *sum -= direction.dot(q) * part / scale;
            }
        }
        target[self.prescribed.len()] = 1.0 / scale;
        for of_q in &mut self.targets {
            of_q.push(0.0);
        }
        self.basis.push(rest / scale);
        self.targets.push(target);
        self.prescribed.push((direction, motion));
        true
    }

    fn rest(&self, direction: Vec3) -> Vec3 {
        let once = self.basis.iter().fold(direction, |r, q| r - q * q.dot(&r));
        self.basis.iter().fold(once, |r, q| r - q * q.dot(&r))
    }

    /// Removes the components along fixed directions, but not along prescribed ones, from a vector.
    pub(crate) fn released(&self, vector: Vec3) -> Vec3 {
        let held = self.basis.iter().zip(&self.targets);
        held.filter(|(_, target)| target.iter().all(|&weight| weight == 0.0))
            .fold(vector, |rest, (q, _)| rest - q * q.dot(&rest))
    }

    /// Removes the components along fixed and prescribed directions from a vector.
    pub(crate) fn free(&self, vector: Vec3) -> Vec3 {
        if self.basis.len() == 3 {
            Vec3::zeros()
        } else {
            self.rest(vector)
        }
    }

    /// The inverse of an effective mass in the free directions, `P = A^-1 - L N^T A^-1`, and
    /// `L = A^-1 N (N^T A^-1 N)^-1`, which gives a node its velocity along the directions `N`.
    pub(crate) fn project(&self, inverse: &Mat3) -> (Mat3, Mat3) {
        let directions = self.normals();
        match self.basis.len() {
            0 => (*inverse, Mat3::zeros()),
            3 => (Mat3::zeros(), directions),
            count => {
                let mut small = directions.transpose() * inverse * directions;
                for i in count..3 {
                    small[(i, i)] = 1.0;
                }
                let mut small = small.try_inverse().unwrap_or_else(Mat3::zeros);
                for i in count..3 {
                    small[(i, i)] = 0.0;
                }
                let lift = inverse * directions * small;
                let across = Mat3::identity() - directions * directions.transpose();
                let projected = inverse - lift * directions.transpose() * inverse;
                let projected = across * projected * across;
                ((projected + projected.transpose()) * 0.5, lift)
            }
        }
    }

    /// The fixed and prescribed directions as columns, zeros after them.
    fn normals(&self) -> Mat3 {
        let mut normals = Mat3::zeros();
        for (i, q) in self.basis.iter().enumerate() {
            normals.set_column(i, q);
        }
        normals
    }

    /// Projection `P A = I - L N^T` of a velocity, which removes its components along fixed and prescribed
    /// directions.
    pub(crate) fn kept(&self, lift: &Mat3) -> Mat3 {
        if self.prescribed.is_empty() || self.basis.len() == 3 {
            // A velocity has no components along fixed directions.
            return Mat3::from_columns(&[Vec3::x(), Vec3::y(), Vec3::z()].map(|e| self.free(e)));
        }
        Mat3::identity() - lift * self.normals().transpose()
    }

    /// The orthonormal fixed and prescribed directions.
    pub(crate) fn directions(&self) -> &[Vec3] {
        &self.basis
    }

    /// The vector along the basis from the values of the prescribed motions.
    pub(crate) fn along(&self, prescribed: &[f64]) -> Vec3 {
        let target = self.target(prescribed);
        let parts = self.basis.iter().enumerate();
        parts.map(|(i, q)| q * target[i]).sum()
    }

    /// Velocities along the basis (m/s) from those of the prescribed motions.
    pub(crate) fn target(&self, prescribed: &[f64]) -> Vec3 {
        let mut target = Vec3::zeros();
        for (i, weights) in self.targets.iter().enumerate() {
            target[i] = weights.iter().zip(prescribed).map(|(w, v)| w * v).sum();
        }
        target
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Velocities along two oblique prescribed directions come out as prescribed, whatever the
    /// effective mass.
    #[test]
    fn oblique_prescribed_directions_are_met_together() {
        let (a, b) = (Vec3::x(), Vec3::new(0.6, 0.8, 0.0));
        let mut condition = Condition::default();
        condition.hold(Vec3::z());
        assert!(condition.prescribe(a, 0));
        assert!(condition.prescribe(b, 1));
        assert!(!condition.prescribe(Vec3::y(), 2));
        let (inverse, lift) = condition.project(&Mat3::identity());
        assert_eq!(inverse, Mat3::zeros());
        let velocity = lift * condition.target(&[2.0, -3.0]);
        assert!((velocity.dot(&a) - 2.0).abs() < 1e-14);
        assert!((velocity.dot(&b) + 3.0).abs() < 1e-14);
        assert_eq!(velocity.z, 0.0);
    }

    /// A force on a roller leaves the held direction alone and obeys the projected mass.
    #[test]
    fn a_roller_takes_no_velocity_along_its_normal() {
        let mass = Mat3::new(3.0, 0.5, 0.2, 0.5, 2.0, 0.1, 0.2, 0.1, 1.0);
        let normal = Vec3::new(1.0, 2.0, -2.0) / 3.0;
        let mut condition = Condition::default();
        condition.hold(normal);
        let (projected, _) = condition.project(&mass.try_inverse().unwrap());
        let force = Vec3::new(0.3, -1.0, 0.7);
        let velocity = projected * force;
        assert!(velocity.dot(&normal).abs() < 1e-15);
        // The rest of the force after M v is a reaction along the normal.
        let reaction = force - mass * velocity;
        assert!(reaction.cross(&normal).norm() < 1e-14);
    }
}
