//! Test of a cell: a model is built, set in motion, run and judged.

use powerhouse::Material;
use powerhouse::engine::{BuildModel, Leapfrog, Model, run_reporting};
use powerhouse_material_damage::LinearElastic;
use powerhouse_model::{
    ElasticMedium, EnergyCheck, Mat3, Mesh, Rayleigh, RunFailure, RunOptions, RunReport,
    StepChoice, Vec3,
};

use super::cell::{Cell, Found, Refusal};
use super::column::Column;
use crate::extremes::stable_step::scatter;

/// Greatest permitted growth of the elastic energy. A mode of a frequency w has at most `1 / (1 - (w dt /
/// 2)^2)` times its energy, 25.3 times at 0.98 of its limit.
const MOST_ELASTIC: f64 = 25.3;

/// A trial of a model in a column.
pub(super) struct Trial<'a> {
    column: &'a Column,
    steps: u64,
    /// Share of the stable step.
    share: f64,
    damping: Option<Rayleigh>,
    largest_displacement: f64,
}

impl<'a> Trial<'a> {
    /// A thousand steps at the stable step, with damping if the scheme needs it.
    pub(super) fn of(column: &'a Column) -> Self {
        Self {
            column,
            steps: 1_000,
            share: 1.0,
            damping: None,
            largest_displacement: f64::INFINITY,
        }
    }
    pub(super) fn steps(mut self, steps: u64) -> Self {
        self.steps = steps;
        self
    }
    /// Sets the step as a share of the stable step.
    pub(super) fn share(mut self, share: f64) -> Self {
        self.share = share;
        self
    }
    /// Sets the damping, in place of that which the scheme needs.
    pub(super) fn damped(mut self, damping: Rayleigh) -> Self {
        self.damping = Some(damping);
        self
    }
    /// Sets the greatest permitted displacement of a node (m).
    pub(super) fn within(mut self, displacement: f64) -> Self {
        self.largest_displacement = displacement;
        self
    }
    /// Builds a model with initial motion or loads, runs it and judges the result.
    pub(super) fn play(&self, make: impl Fn(Rayleigh) -> Result<Model, Refusal>) -> Found {
        match self.model(make) {
            Ok(mut model) => match (motion_energy(&model), self.run(&mut model)) {
                (initial, Ok(report)) => self.judge(&model, initial, &report),
                (_, Err(RunFailure { error, report })) => match report {
                    None => Ok(Cell::Refused(error.to_string())),
                    Some(report) => Err(format!("failed after {} steps: {error}", report.steps)),
                },
            },
            Err(refusal) => Ok(Cell::Refused(refusal.to_string())),
        }
    }

    /// The model with the damping of the trial.
    pub(super) fn model(
        &self,
        make: impl Fn(Rayleigh) -> Result<Model, Refusal>,
    ) -> Result<Model, Refusal> {
        let damping = match self.damping {
            Some(damping) => damping,
            None if self.column.one_sided => {
                // The coefficient with the longest step: that of critical damping at the limit.
                let stable = make(Rayleigh::default())?.stable_step(&Leapfrog)?;
                Rayleigh {
                    mass: 0.0,
                    stiffness: 0.5 * stable.assembled_limit,
                }
            }
            None => Rayleigh::default(),
        };
        make(damping)
    }

    fn run(&self, model: &mut Model) -> Result<RunReport, RunFailure> {
        let integrator = self.column.integrator();
        let refused = |error| RunFailure {
            error,
            report: None,
        };
        let stable = model.stable_step(integrator).map_err(refused)?;
        let options = RunOptions::steps(self.steps)
            .with_step(StepChoice::Fixed(self.share * stable.step))
            .with_energy(EnergyCheck::every(50));
        run_reporting(model, integrator, &options, &mut [], &mut |_| {})
    }

    fn judge(&self, model: &Model, initial: f64, report: &RunReport) -> Found {
        for node in 0..model.mesh().node_count() as u32 {
            let (u, v) = (model.displacement(node), model.velocity(node));
            if !(u.norm().is_finite() && v.norm().is_finite()) {
                return Err(format!("node {node} moves by {u} at {v}"));
            }
            if u.norm() > self.largest_displacement {
                let limit = self.largest_displacement;
                return Err(format!(
                    "node {node} moves by {:e} of {limit:e} m",
                    u.norm()
                ));
            }
        }
        let energy = |name| {
            let found = report.energies.iter().find(|(column, _)| *column == name);
            found.map_or(f64::NAN, |(_, value)| *value)
        };
        let driven = self.largest_displacement.is_finite();
        let held = energy("elastic") + energy("hourglass");
        let grown = held > MOST_ELASTIC * initial || energy("kinetic") > 1.001 * initial;
        if !driven && (grown || held.is_nan()) {
            return Err(format!("began with {initial:e} J: {:?}", report.energies));
        }
        Ok(Cell::Stable)
    }
}

/// The energy of a body in motion (J).
fn motion_energy(model: &Model) -> f64 {
    let nodes = 0..model.mesh().node_count() as u32;
    nodes
        .map(|node| 0.5 * model.mass(node) * model.velocity(node).norm_squared())
        .sum()
}

/// An elastic material.
pub(super) fn elastic(medium: ElasticMedium) -> Material {
    Material::from(LinearElastic::new(medium))
}

/// A box of a few metres, of elements of different shapes.
pub(super) fn irregular(column: &Column) -> Result<Mesh, Refusal> {
    let mesh = column.boxed(Vec3::new(6.0, 4.0, 4.0), [3, 2, 2])?;
    let bend = |a: f64, b: f64| 0.3 * (1.3 * a + 0.7 * b).sin();
    Ok(mesh.map_positions(|p| {
        Vec3::new(
            p.x + bend(p.y, p.z),
            p.y + bend(p.z, p.x),
            p.z * (1.0 + 0.05 * p.x),
        )
    })?)
}

/// A random velocity of at most some speed (m/s) along each axis for every node.
pub(super) fn random_velocities(nodes: usize, speed: f64) -> Vec<Vec3> {
    let random = |i: usize| Vec3::new(scatter(3 * i), scatter(3 * i + 1), scatter(3 * i + 2));
    (0..nodes).map(|node| random(node) * speed).collect()
}

/// Sets a body in random motion, without rigid-body motion, since strains are small.
pub(super) fn shaken(mut model: Model, speed: f64) -> Result<Model, Refusal> {
    let positions = model.mesh().positions().to_vec();
    let mut velocity = random_velocities(positions.len(), speed);
    let masses: Vec<f64> = (0..positions.len() as u32)
        .map(|node| model.mass(node))
        .collect();
    let whole: f64 = masses.iter().sum();
    let mean = |of: &[Vec3]| -> Vec3 {
        let weighted = of.iter().zip(&masses).map(|(x, m)| x * *m);
        weighted.sum::<Vec3>() / whole
    };
    let (centre, drift) = (mean(&positions), mean(&velocity));
    let arms: Vec<Vec3> = positions.iter().map(|x| x - centre).collect();
    velocity.iter_mut().for_each(|v| *v -= drift);
    let (mut momentum, mut inertia) = (Vec3::zeros(), Mat3::zeros());
    for ((arm, v), mass) in arms.iter().zip(&velocity).zip(&masses) {
        momentum += arm.cross(v) * *mass;
        inertia += (Mat3::identity() * arm.norm_squared() - arm * arm.transpose()) * *mass;
    }
    let spin = inertia
        .try_inverse()
        .map_or(Vec3::zeros(), |inverse| inverse * momentum);
    for (arm, v) in arms.iter().zip(&mut velocity) {
        *v -= spin.cross(arm);
    }
    let rest = vec![Vec3::zeros(); positions.len()];
    model.set_initial(&rest, &velocity)?;
    Ok(model)
}

/// A body of one material in random motion.
pub(super) fn body(
    column: &Column,
    mesh: &Mesh,
    material: &Material,
    damping: Rayleigh,
) -> Result<Model, Refusal> {
    let all: Vec<u32> = (0..mesh.element_count() as u32).collect();
    let builder = Model::builder(mesh).elements(all, column.factory(material, damping));
    shaken(builder.threads(1).build()?, 1.0)
}
