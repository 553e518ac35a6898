//! Joints of a few masses, without an engine.

mod connected;
mod corners;
mod extremes;
mod friction;
mod history;
mod impact;
mod limit;
mod pairs;
mod repeated;
mod threads;

use powerhouse_model::{
    Constraint, ConstraintWork, Mat3, PredictedMotion, RunError, StepTime, Vec3,
};

/// Masses in leapfrog steps, each with a force of its own.
#[derive(Clone, Debug)]
pub(crate) struct Bodies {
    pub(crate) mass: Vec<f64>,
    /// Dashpots to the ground (N s/m).
    pub(crate) dashpot: Vec<Mat3>,
    /// Masses that do not obey forces.
    pub(crate) fixed: Vec<bool>,
    /// The part of a vector along which masses may move.
    pub(crate) free: Mat3,
    pub(crate) displacement: Vec<Vec3>,
    pub(crate) velocity: Vec<Vec3>,
    pub(crate) step: f64,
    pub(crate) number: u64,
    /// What the joint reported so far (J), and the work of forces and dashpots.
    pub(crate) work: ConstraintWork,
    pub(crate) input: f64,
}

impl Bodies {
    pub(crate) fn at_rest(mass: &[f64], step: f64) -> Self {
        let count = mass.len();
        Self {
            mass: mass.to_vec(),
            dashpot: vec![Mat3::zeros(); count],
            fixed: vec![false; count],
            free: Mat3::identity(),
            displacement: vec![Vec3::zeros(); count],
            velocity: vec![Vec3::zeros(); count],
            step,
            number: 0,
            work: ConstraintWork::default(),
            input: 0.0,
        }
    }
    pub(crate) fn time(&self) -> f64 {
        self.number as f64 * self.step
    }
    /// Effective mass (kg).
    pub(crate) fn effective(&self, body: usize) -> Mat3 {
        Mat3::identity() * self.mass[body] + self.dashpot[body] * (0.5 * self.step)
    }
    pub(crate) fn inverse_mass(&self) -> Vec<Mat3> {
        (0..self.mass.len())
            .map(|body| {
                if self.fixed[body] {
                    return Mat3::zeros();
                }
                self.free * self.effective(body).try_inverse().unwrap() * self.free
            })
            .collect()
    }
    pub(crate) fn kinetic(&self) -> f64 {
        let of = |(m, v): (&f64, &Vec3)| 0.5 * m * v.norm_squared();
        self.mass.iter().zip(&self.velocity).map(of).sum()
    }
    /// Velocities at the end of a step without the joint.
    pub(crate) fn predicted(&self, force: impl Fn(usize) -> Vec3) -> Vec<Vec3> {
        let inverse = self.inverse_mass();
        (0..self.mass.len())
            .map(|body| {
                if self.fixed[body] {
                    return force(body);
                }
                let old =
                    Mat3::identity() * self.mass[body] - self.dashpot[body] * (0.5 * self.step);
                inverse[body] * (old * self.velocity[body] + force(body) * self.step)
            })
            .collect()
    }
    /// One step under these forces (N); a fixed body takes its velocity (m/s) instead.
    pub(crate) fn step(
        &mut self,
        joint: &mut dyn Constraint,
        force: impl Fn(usize) -> Vec3,
    ) -> Result<ConstraintWork, RunError> {
        let inverse = self.inverse_mass();
        let predicted = self.predicted(&force);
        let of = |values: &[Vec3]| -> Vec<Vec3> {
            joint.nodes().iter().map(|&n| values[n as usize]).collect()
        };
        let (displacement, previous) = (of(&self.displacement), of(&self.velocity));
        let mut velocity = of(&predicted);
        let masses: Vec<Mat3> = joint.nodes().iter().map(|&n| inverse[n as usize]).collect();
        let work = joint.correct(PredictedMotion::new(
            StepTime {
                number: self.number,
                time: self.time(),
                step: self.step,
            },
            &displacement,
            &previous,
            &mut velocity,
            &masses,
        ))?;
        let mut next = predicted;
        for (&node, v) in joint.nodes().iter().zip(velocity) {
            next[node as usize] = v;
        }
        for body in 0..self.mass.len() {
            let mean = (self.velocity[body] + next[body]) * 0.5;
            if !self.fixed[body] {
                let dashpot = self.dashpot[body] * mean;
                self.input += (force(body) - dashpot).dot(&mean) * self.step;
            }
            self.velocity[body] = next[body];
            self.displacement[body] += next[body] * self.step;
        }
        self.number += 1;
        self.work += work;
        Ok(work)
    }
    /// Energy that is not accounted for (J), if no fixed body moves.
    pub(crate) fn residual(&self, initial: f64) -> f64 {
        let ConstraintWork {
            friction,
            bond,
            impact,
            external,
            ..
        } = self.work;
        self.kinetic() + friction + bond + impact + external - self.input - initial
    }
}

/// Reproducible numbers in [-1, 1].
pub(crate) struct Noise(pub(crate) u64);

impl Noise {
    pub(crate) fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
    pub(crate) fn vector(&mut self) -> Vec3 {
        Vec3::new(self.next(), self.next(), self.next())
    }
}

/// A dashpot (N s/m) along an oblique direction.
pub(crate) fn oblique(value: f64) -> Mat3 {
    let normal = Vec3::new(1.0, 2.0, -0.5).normalize();
    normal * normal.transpose() * value
}
