//! The energy ledger: it closes, and it finds what does not.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::support::{Links, energy_of, hex_box, random_vectors};
use powerhouse_elements::NodalForce;
use powerhouse_explicit_core::{BuildModel, Leapfrog, Model, OneSided, run};
use powerhouse_model::{
    BlockContext, BlockEnergy, BlockFactory, BlockOptions, BlockOutput, BlockPart, BlockStiffness,
    BoundaryParts, Constant, Constraint, ConstraintWork, DampedBlock, ElementBlock, ElementFault,
    ElementKind, EnergyCheck, FrequencyBound, Mat3, Mesh, ModelError, ModelSpec, NodalImpedance,
    NodalLoad, NodalView, NodalViewMut, Precision, PredictedMotion, Prescribed, RunError,
    RunOptions, RunReport, StepChoice, Stress, Support, TimeFunction, TimeIntegrator, Vec3,
};

fn rock() -> Links {
    Links::new("rock", ElementKind::Hex8, 9.0e9, 0.3, 2700.0)
}

/// Dashpots and springs on five faces, oblique in part, and a pulse on the top.
fn box_with_input(mesh: &Mesh, links: Links) -> ModelSpec<'_> {
    let faces = ["x0", "x1", "y0", "y1", "z0"];
    let impedance = faces.iter().flat_map(|face| mesh.node_set(face).unwrap());
    let impedance = impedance.map(|&node| {
        NodalImpedance::new(
            node,
            Mat3::new(3e7, 1e6, 0.0, 1e6, 2e7, 0.0, 0.0, 0.0, 1e7),
            Mat3::new(5e5, 1e5, 0.0, 1e5, 4e5, 0.0, 0.0, 0.0, 3e5),
        )
    });
    let pulse = |t: f64| (200.0 * t).sin();
    let top = mesh.node_set("z1").unwrap().to_vec();
    Model::builder(mesh)
        .elements("rock", links.boxed())
        .load(Box::new(NodalForce::new(
            top,
            Vec3::new(1e4, 2e3, -3e4),
            Box::new(pulse),
        )))
        .boundary(BoundaryParts::default().with_impedance(impedance))
}

fn go(
    model: &mut Model,
    integrator: &dyn TimeIntegrator,
    options: &RunOptions,
) -> Result<RunReport, RunError> {
    run(model, integrator, options, &mut [], &mut |_| {})
}

/// Over 1e5 steps of a box with input, dashpots and springs the ledger closes to 1e-12 of the
/// input work, far below the required 1e-9.
#[test]
fn an_elastic_box_with_input_and_dashpots_closes() {
    let mesh = hex_box([2, 2, 2], 1.0, 0.2);
    let mut model = box_with_input(&mesh, rock()).build().unwrap();
    let options = RunOptions::steps(100_000).with_energy(EnergyCheck::every(5_000));
    let report = go(&mut model, &Leapfrog, &options).unwrap();
    let input = energy_of(&report, "loads");
    assert!(input > 0.0 && energy_of(&report, "dashpots") > 0.5 * input);
    assert!(energy_of(&report, "residual").abs() < 1e-12 * input);
}

/// Mass damping (implicit and lagged), stiffness damping, supports along an axis and oblique to it, a
/// tie-free prescribed motion and a load on plain nodes are all accounted for: the ledger closes under both
/// schemes.
#[test]
fn the_balance_has_every_nodal_term() {
    let mesh = hex_box([4, 3, 3], 1.0, 0.2);
    let step = 5e-5;
    for integrator in [&Leapfrog as &dyn TimeIntegrator, &OneSided] {
        let floor = mesh.node_set("z0").unwrap().to_vec();
        let side = mesh.node_set("x0").unwrap().to_vec();
        let top = mesh.node_set("z1").unwrap().to_vec();
        let mut model = box_with_input(&mesh, rock().damped(5.0, 2.0 * step))
            .gravity(
                Vec3::new(0.3, 0.2, -1.0),
                Box::new(|t: f64| (100.0 * t).sin()),
            )
            .support(Support::roller(side, Vec3::new(1.0, 0.2, 0.0)))
            .support(Support::roller(top, Vec3::y()))
            .prescribed(Prescribed {
                nodes: floor,
                direction: Vec3::new(0.3, 0.0, 1.0),
                displacement: Box::new(|t: f64| 1e-5 * (1.0 - (150.0 * t).cos())),
            })
            .build()
            .unwrap();
        let options = RunOptions::steps(4_000)
            .with_step(StepChoice::Unchecked(step))
            .with_energy(EnergyCheck::every(100));
        let report = go(&mut model, integrator, &options).unwrap();
        for name in [
            "mass damping",
            "stiffness damping",
            "dashpots",
            "loads",
            "prescribed motion",
        ] {
            assert!(
                energy_of(&report, name).abs() > 1e-3,
                "{name}: {}",
                energy_of(&report, name)
            );
        }
        assert!(report.energy_residual < 1e-12, "{}", report.energy_residual);
    }
}

/// Holds two nodes together, without loss but the impact of their velocities, or with friction
/// that is accounted for wrongly.
struct Glue {
    nodes: [u32; 2],
    wrong: f64,
}
impl Constraint for Glue {
    fn name(&self) -> &str {
        "glue"
    }
    fn nodes(&self) -> &[u32] {
        &self.nodes
    }
    fn correct(&mut self, motion: PredictedMotion) -> Result<ConstraintWork, RunError> {
        let compliance = motion.inverse_mass[0] + motion.inverse_mass[1];
        let gap = motion.velocity[1] - motion.velocity[0];
        let impulse = compliance.try_inverse().unwrap() * gap;
        motion.velocity[0] += motion.inverse_mass[0] * impulse;
        motion.velocity[1] -= motion.inverse_mass[1] * impulse;
        let before = motion.previous[1] - motion.previous[0];
        let after = motion.velocity[1] - motion.velocity[0];
        let impact = 0.5 * impulse.dot(&(before + after));
        Ok(ConstraintWork::default().with_impact(impact * self.wrong))
    }
}

/// Two bodies that meet and stay together lose what their constraint reports as impact; if it reports
/// a wrong loss, the run is stopped.
#[test]
fn the_balance_has_the_loss_of_an_impact() {
    let mesh = hex_box([3, 2, 2], 1.0, 0.2);
    let count = mesh.node_count();
    let glued = |wrong| {
        let mut model = Model::builder(&mesh)
            .elements("rock", rock().boxed())
            .constraint(Box::new(Glue {
                nodes: [0, 30],
                wrong,
            }))
            .build()
            .unwrap();
        let velocity = random_vectors(count, 1.0, 4);
        model
            .set_initial(&vec![Vec3::zeros(); count], &velocity)
            .unwrap();
        let check = EnergyCheck::every(1);
        go(
            &mut model,
            &Leapfrog,
            &RunOptions::steps(1000).with_energy(check),
        )
    };
    let report = glued(1.0).unwrap();
    assert!(energy_of(&report, "impact") > 0.0);
    assert!(report.energy_residual < 1e-13);
    assert!(matches!(glued(0.9), Err(RunError::EnergyResidual { .. })));
}

/// Great forces that a constraint balances leave velocities of rounding: a body at rest between them is no fault of the
/// balance, whatever their size. A wrong loss is one, as soon as the body moves by more than that.
#[test]
fn a_body_at_rest_between_great_forces_is_no_fault() {
    let mesh = hex_box([3, 2, 2], 1.0, 0.2);
    let count = mesh.node_count();
    let limited = |force: f64, speed: f64, wrong: f64, limit: Option<f64>| {
        let push = Vec3::new(1.7, -0.31, 0.53) * force;
        let on = |node: u32, force: Vec3| {
            let load = NodalForce::new(vec![node], force, Box::new(Constant(1.0)));
            Box::new(load) as Box<dyn NodalLoad>
        };
        let mut model = Model::builder(&mesh)
            .elements("rock", rock().boxed())
            .load(on(0, push))
            .load(on(30, -push))
            .constraint(Box::new(Glue {
                nodes: [0, 30],
                wrong,
            }))
            .build()
            .unwrap();
        let velocity = random_vectors(count, speed, 4);
        let still = vec![Vec3::zeros(); count];
        model.set_initial(&still, &velocity).unwrap();
        let mut check = EnergyCheck::every(1);
        check.limit = limit;
        let options = RunOptions::steps(1000).with_energy(check);
        go(&mut model, &Leapfrog, &options)
    };
    let pressed = |force, speed, wrong| limited(force, speed, wrong, None);
    for force in [1.0e3, 1.0e7, 1.0e11] {
        let report = pressed(force, 0.0, 1.0).unwrap();
        assert!(report.energy_residual < 1e-7, "{force}: {report:?}");
        let rounding = energy_of(&report, "kinetic").sqrt();
        assert!(rounding > 0.0, "{force}: nothing moves");
        // A limit below rounding is taken at its word.
        let found = limited(force, 0.0, 1.0, Some(1e-30));
        assert!(matches!(found, Err(RunError::EnergyResidual { .. })));
        // A thousandth of the weight of the error is found from 1e5 roundings of the velocity on.
        let speed = 1.0e5 * rounding;
        pressed(force, speed, 1.0).unwrap();
        let found = pressed(force, speed, 0.9);
        assert!(
            matches!(found, Err(RunError::EnergyResidual { .. })),
            "{force}: {found:?}"
        );
    }
}

/// The ledger of nodes in single precision closes to the rounding of that precision.
#[test]
fn single_precision_closes_to_its_own_rounding() {
    let mesh = hex_box([3, 3, 3], 1.0, 0.2);
    let mut model = box_with_input(&mesh, rock().precision(Precision::F32))
        .build()
        .unwrap();
    let options = RunOptions::steps(2_000).with_energy(EnergyCheck::every(50));
    let report = go(&mut model, &Leapfrog, &options).unwrap();
    assert!(report.energy_residual < 1e-3, "{}", report.energy_residual);
}

/// The same pull on every node, and how often it was evaluated.
struct Pull {
    nodes: Vec<u32>,
    constant: bool,
    evaluated: Arc<AtomicUsize>,
}
impl NodalLoad for Pull {
    fn name(&self) -> &str {
        "pull"
    }
    fn nodes(&self) -> &[u32] {
        &self.nodes
    }
    fn add_forces(&mut self, _time: f64, forces: &mut [Vec3]) {
        self.evaluated.fetch_add(1, Ordering::Relaxed);
        for force in forces {
            *force += Vec3::new(40.0, -70.0, 11.0);
        }
    }
    fn is_constant(&self) -> bool {
        self.constant
    }
}

/// Constant loads are evaluated once, move the body as those that do not, and
/// their work is the same: of the displacement, not of the velocities step by step.
#[test]
fn the_work_of_constant_loads_is_that_of_their_displacement() {
    let mesh = hex_box([3, 3, 3], 1.0, 0.2);
    let moved = |precision: Precision, constant: bool| {
        let evaluated = Arc::new(AtomicUsize::new(0));
        let weight: Box<dyn TimeFunction> = if constant {
            Box::new(Constant(0.7))
        } else {
            Box::new(|_: f64| 0.7)
        };
        let mut model = box_with_input(&mesh, rock().precision(precision))
            .gravity(Vec3::new(0.0, 0.3, -9.81), weight)
            .load(Box::new(Pull {
                nodes: (10..40).collect(),
                constant,
                evaluated: evaluated.clone(),
            }))
            .build()
            .unwrap();
        let options = RunOptions::steps(600).with_energy(EnergyCheck::every(50));
        let report = go(&mut model, &Leapfrog, &options).unwrap();
        let evaluated = evaluated.load(Ordering::Relaxed);
        assert!(
            if constant {
                evaluated == 1
            } else {
                evaluated >= 600
            },
            "{evaluated}"
        );
        (model.state(), report)
    };
    for (precision, close, balance) in [
        (Precision::F64, 1e-13, 1e-13),
        (Precision::Mixed, 1e-13, 1e-5),
        (Precision::F32, 1e-3, 1e-3),
    ] {
        let ((once, own), (each, other)) = (moved(precision, true), moved(precision, false));
        assert_eq!(once.displacement, each.displacement);
        let (own_work, work) = (energy_of(&own, "loads"), energy_of(&other, "loads"));
        assert!(work.abs() > 1e-3);
        assert!(
            (own_work - work).abs() < close * work.abs(),
            "{own_work} {work}"
        );
        assert!(own.energy_residual < balance, "{}", own.energy_residual);
    }
}

/// The tail of a pulse, far below what numbers of single precision hold, is no fault of the balance.
#[test]
fn motions_below_single_precision_are_no_fault() {
    let mesh = hex_box([3, 3, 3], 1.0, 0.2);
    let report = |precision: Precision| {
        let mut model = Model::builder(&mesh)
            .elements("rock", rock().precision(precision).boxed())
            .gravity(Vec3::new(0.3, 0.2, -1.0) * 2e-40, Box::new(|_: f64| 1.0))
            .support(Support::fixed(mesh.node_set("z0").unwrap().to_vec()))
            .build()
            .unwrap();
        let options = RunOptions::steps(200)
            .with_step(StepChoice::Unchecked(1e-5))
            .with_energy(EnergyCheck::every(10));
        go(&mut model, &Leapfrog, &options).unwrap()
    };
    let (double, single) = (report(Precision::F64), report(Precision::F32));
    let lost = energy_of(&single, "residual").abs() / energy_of(&double, "loads");
    assert!(lost > 1e-2, "{lost}: single precision holds this motion");
}

/// A set whose elements say that they hold less energy than their forces take is found and named.
#[test]
fn a_set_that_cheats_is_named() {
    let mesh = hex_box([4, 2, 2], 1.0, 0.0);
    let (left, right): (Vec<u32>, Vec<u32>) = (0..16).partition(|&e| mesh.centroid(e).x < 2.0);
    let mut model = Model::builder(&mesh)
        .elements(
            left,
            Box::new(Cheat(Links {
                label: "concrete".into(),
                ..rock()
            })),
        )
        .elements(right, rock().boxed())
        .gravity(Vec3::new(1.0, 0.0, 0.0), Box::new(|_: f64| 1.0))
        .support(Support::fixed(mesh.node_set("x0").unwrap().to_vec()))
        .build()
        .unwrap();
    let options = RunOptions::steps(1_000).with_energy(EnergyCheck::every(10));
    match go(&mut model, &Leapfrog, &options) {
        Err(RunError::EnergyResidual { set, step, .. }) => {
            assert_eq!(set, "concrete");
            assert_eq!(step % 10, 0);
        }
        other => panic!("{other:?}"),
    }
}

/// Links that hide a thousandth of their energy.
struct Cheat(Links);
impl BlockFactory for Cheat {
    fn label(&self) -> &str {
        self.0.label()
    }
    fn kind(&self) -> ElementKind {
        self.0.kind()
    }
    fn options(&self) -> BlockOptions {
        self.0.options()
    }
    fn build(&self, part: &BlockPart) -> Result<Box<dyn ElementBlock>, ModelError> {
        Ok(Box::new(CheatBlock(self.0.build(part)?)))
    }
}
struct CheatBlock(Box<dyn ElementBlock>);
impl ElementBlock for CheatBlock {
    fn label(&self) -> &str {
        self.0.label()
    }
    fn elements(&self) -> &[u32] {
        self.0.elements()
    }
    fn nodes(&self) -> &[u32] {
        self.0.nodes()
    }
    fn forces(&mut self, context: &BlockContext, out: NodalViewMut) -> Result<(), ElementFault> {
        self.0.forces(context, out)
    }
    fn add_mass(&self, out: &mut [f64]) {
        self.0.add_mass(out);
    }
    fn frequency_bounds(&self) -> Vec<FrequencyBound> {
        self.0.frequency_bounds()
    }
    fn damped(&self) -> Option<&dyn DampedBlock> {
        self.0.damped()
    }
    fn stiffness(&self) -> Option<&dyn BlockStiffness> {
        self.0.stiffness()
    }
    fn output(&self) -> Option<&dyn BlockOutput> {
        Some(self)
    }
}
impl BlockOutput for CheatBlock {
    fn energy(&self, context: &BlockContext) -> BlockEnergy {
        let mut energy = self.0.energy(context);
        energy.elastic *= 0.999;
        energy
    }
    fn add_stress(&self, displacement: NodalView, out: &mut [Stress]) {
        self.0.add_stress(displacement, out);
    }
}

/// Kinetic energy is never negative, at whatever step a run ends and near the limit of stability too, where
/// the product of the velocities before and after a turning point is; the balance closes all the same.
#[test]
fn kinetic_energy_is_never_negative() {
    let mesh = hex_box([2, 2, 2], 1.0, 0.2);
    let mut turned = 0;
    for steps in 1..60 {
        let mut model = box_with_input(&mesh, rock()).build().unwrap();
        let options = RunOptions::steps(steps).with_energy(EnergyCheck::every(1));
        let report = go(&mut model, &Leapfrog, &options).unwrap();
        let [kinetic, rest] = ["kinetic", "time step"].map(|name| energy_of(&report, name));
        assert!(kinetic >= 0.0 && rest <= 0.0, "{steps}: {kinetic} {rest}");
        assert!(report.energy_residual < 1e-11);
        turned += usize::from(kinetic + rest < 0.0);
    }
    // A single brick that rings at its highest frequency turns at almost every step.
    let mesh = hex_box([1, 1, 1], 1.0, 0.0);
    let held = mesh.node_set("z0").unwrap().to_vec();
    for steps in 1..40 {
        let mut model = Model::builder(&mesh)
            .elements("rock", rock().boxed())
            .support(Support::fixed(held.clone()))
            .build()
            .unwrap();
        let noise = random_vectors(mesh.node_count(), 1.0, 3);
        let still = vec![Vec3::zeros(); mesh.node_count()];
        model.set_initial(&still, &noise).unwrap();
        let options = RunOptions::steps(steps).with_energy(EnergyCheck::every(1));
        let report = go(&mut model, &Leapfrog, &options).unwrap();
        let [kinetic, rest] = ["kinetic", "time step"].map(|name| energy_of(&report, name));
        assert!(kinetic >= 0.0 && rest <= 0.0, "{steps}: {kinetic} {rest}");
        turned += usize::from(kinetic + rest < 0.0);
    }
    assert!(turned > 0, "the scheme's own form is never negative here");
}

/// A measurement of the parts of a step changes no bit of the motion and of the energies, and names elements, boundaries
/// and the energy balance.
#[test]
fn a_profile_changes_no_bit() {
    let mesh = hex_box([3, 3, 3], 1.0, 0.2);
    let options = RunOptions::steps(130).with_energy(EnergyCheck::every(7));
    let measured = |profile: bool| {
        let mut model = box_with_input(&mesh, rock()).build().unwrap();
        let options = options.clone().with_profile(profile);
        let report = go(&mut model, &Leapfrog, &options).unwrap();
        (model.state(), report)
    };
    let (plain, profiled) = (measured(false), measured(true));
    assert_eq!(plain.0, profiled.0);
    assert_eq!(plain.1.energies, profiled.1.energies);
    assert_eq!(plain.1.profile, None);
    let profile = profiled.1.profile.unwrap();
    assert_eq!(profile.steps, 130);
    for part in [
        "elements of 'rock'",
        "boundaries",
        "energy balance",
        "update of all nodes",
    ] {
        let mut rows = profile.rows.iter();
        assert!(
            rows.any(|row| row.part.starts_with(part)),
            "{part}: {profile:?}"
        );
    }
    let falling = profile
        .rows
        .windows(2)
        .all(|pair| pair[0].seconds >= pair[1].seconds);
    assert!(falling && profile.covered() > 0.0);
}
