//! Time steps on a device beside the host, such as a graphics processor.
//!
//! # Why so
//! *The device takes the steps that nobody observes, the host those between them.* Both have the same bits, so that the host
//! needs no second form of observers, checkpoints and errors: it takes the steps in which something is shown, the first and the last one,
//! and repeats those in which the device found the motion diverged, to name the element.
//!
//! *Applied forces are evaluated on the host, some hundred steps ahead.* They depend on time alone, and their code is open to users.

use std::sync::Arc;

use powerhouse_model::{
    DeviceBlock, DeviceError, DeviceLoads, DeviceModel, DeviceMotion, DeviceShare, Dynamics,
    ElementBlock, Engine, EngineModel, ForceTerms, MassDampingRule, ModelError, ModelSpec,
    Precision, RunError, StepDevice, StepDevices, TimeIntegrator,
};

use crate::model::Model;
use crate::nodes::{Storage, with_nodes};
use crate::{BuildModel, NAME};

/// Most steps that a device takes at once.
const MOST_STEPS: u64 = 500;
/// Most vectors of applied forces that are evaluated ahead (24 bytes each).
const MOST_FORCES: usize = 8_000_000;

/// The explicit engine with a device beside the host, such as a graphics processor, that takes the time steps which
/// nobody observes; results have the bits of [`Explicit`](crate::Explicit).
///
/// Joints and other constraints, embedded elements such as bolts, prescribed motions, slices under waves along y, laws
/// without a [program](powerhouse_model::ProgrammedBlock::program), the energy balance and the profile of steps are refused by name.
pub struct ExplicitOnDevice {
    devices: Arc<dyn StepDevices>,
    name: String,
}

impl ExplicitOnDevice {
    /// The engine with devices of a kind.
    pub fn new(devices: Arc<dyn StepDevices>) -> Self {
        Self {
            name: format!("{NAME} on {}", devices.name()),
            devices,
        }
    }
}

impl Engine for ExplicitOnDevice {
    fn name(&self) -> &str {
        &self.name
    }
    fn build(&self, spec: ModelSpec) -> Result<Box<dyn EngineModel>, ModelError> {
        let refused = |error: DeviceError| ModelError::refused(self.devices.name(), error);
        check_spec(&spec).map_err(refused)?;
        let device = self.devices.device().map_err(refused)?;
        let mut model = spec.build()?;
        check_programs(&model).map_err(refused)?;
        let device = Some(device);
        model.device = Some(DeviceSteps { device, taken: 0 });
        Ok(Box::new(model))
    }
    fn balances_energy(&self) -> bool {
        false
    }
    fn takes_every_step(&self) -> bool {
        false
    }
}

/// Refuses parts of a model that no device computes.
fn check_spec(spec: &ModelSpec) -> Result<(), DeviceError> {
    let only_on_host = "it is computed on the host alone";
    if let Some(constraint) = spec.constraints.first() {
        let part = format!("the constraint '{}'", constraint.name());
        return Err(DeviceError::refused(part, only_on_host));
    }
    if !spec.embedded.is_empty() {
        let part = "embedded elements, such as bolts,";
        return Err(DeviceError::refused(
            part,
            "they are computed on the host alone",
        ));
    }
    if !spec.prescribed.is_empty() {
        return Err(DeviceError::refused("a prescribed motion", only_on_host));
    }
    if (spec.delayed.as_ref()).is_some_and(|pairs| pairs.slowness != 0.0) {
        let part = "a slice under waves along y";
        return Err(DeviceError::refused(part, only_on_host));
    }
    Ok(())
}

/// Refuses blocks without a program, before the length of the step is known, and elements of boundaries.
fn check_programs(model: &Model) -> Result<(), DeviceError> {
    let mut checked: Vec<&str> = Vec::new();
    for (index, block) in model.blocks.iter().enumerate() {
        let part = || format!("set '{}'", block.label());
        if index >= model.partition().blocks.len() {
            let reason = "elements of boundaries are computed on the host alone";
            return Err(DeviceError::refused(part(), reason));
        }
        if !checked.contains(&block.label()) {
            checked.push(block.label());
            let program = block.program(1e-4, 0);
            program.map_err(|reason| DeviceError::refused(part(), reason.to_string()))?;
        }
    }
    if model.precision != Precision::F64 && !model.casts.is_empty() {
        let reason = "they were cast in a deformed body; `precision = \"f64\"` avoids this";
        return Err(DeviceError::refused("elements in single precision", reason));
    }
    Ok(())
}

/// A device with the number of steps that it took in the present run.
pub(crate) struct DeviceSteps {
    /// The device; none while it takes steps, and after a panic in them.
    device: Option<Box<dyn StepDevice>>,
    taken: u64,
}

/// Steps of a run that a device takes.
pub(crate) struct DeviceRun {
    /// Most steps at once.
    pub(crate) most: u64,
    /// Number of the run's steps until which the host takes all, because the device found the motion diverged.
    pub(crate) host_until: u64,
}

/// Operations of a step of an integrator, in place of the model that it would advance.
#[derive(Default)]
struct StepForm {
    forces: Vec<ForceTerms>,
    rules: Vec<MassDampingRule>,
    order: Vec<char>,
}

impl Dynamics for StepForm {
    fn time(&self) -> f64 {
        0.0
    }
    fn forces(&mut self, terms: ForceTerms, _step: f64) -> Result<(), RunError> {
        self.forces.push(terms);
        self.order.push('f');
        Ok(())
    }
    fn kick(&mut self, mass_damping: MassDampingRule, _step: f64) -> Result<(), RunError> {
        self.rules.push(mass_damping);
        self.order.push('k');
        Ok(())
    }
    fn constrain(&mut self, _step: f64) -> Result<(), RunError> {
        self.order.push('c');
        Ok(())
    }
    fn drift(&mut self, _step: f64) {
        self.order.push('d');
    }
}

/// The error of a device that a panic took away.
fn lost() -> DeviceError {
    DeviceError::failed("an earlier step", "it panicked, and the device is lost")
}

/// Rule of mass damping of an integrator whose step is forces, kick, constraints and drift.
fn rule_of(integrator: &dyn TimeIntegrator, step: f64) -> Result<MassDampingRule, RunError> {
    let mut form = StepForm::default();
    integrator.step(&mut form, step)?;
    match (&form.order[..], &form.forces[..], &form.rules[..]) {
        (['f', 'k', 'c', 'd'], [terms], [rule]) if terms.damping_shift == 0.0 => Ok(*rule),
        _ => {
            let part = format!("the integration scheme '{}'", integrator.name());
            let reason = "a step on a device is forces, kick and drift without changed damping";
            Err(DeviceError::refused(part, reason).into())
        }
    }
}

impl Model {
    /// Passes the model to its device, if it has one, for a run with a step (s).
    pub(crate) fn load_device(
        &mut self,
        integrator: &dyn TimeIntegrator,
        step: f64,
        profile: bool,
    ) -> Result<Option<DeviceRun>, RunError> {
        let Some(steps) = &mut self.device else {
            return Ok(None);
        };
        steps.taken = 0;
        let mut device = steps.device.take().ok_or_else(lost)?;
        let loaded = self.load(device.as_mut(), integrator, step, profile);
        self.put_back(device);
        loaded.map(Some)
    }

    /// Puts the device back after its work.
    fn put_back(&mut self, device: Box<dyn StepDevice>) {
        if let Some(steps) = &mut self.device {
            steps.device = Some(device);
        }
    }

    fn load(
        &mut self,
        device: &mut dyn StepDevice,
        integrator: &dyn TimeIntegrator,
        step: f64,
        profile: bool,
    ) -> Result<DeviceRun, RunError> {
        let refused = |part: &str| {
            let reason = "it is computed on the host alone, in every step";
            Err(RunError::from(DeviceError::refused(part, reason)))
        };
        if self.ledger.is_some() {
            return refused("the energy balance");
        }
        if profile {
            return refused("the profile of the steps");
        }
        for load in self.loads.all() {
            let has_state = load.save_state().map_or(true, |state| !state.is_empty());
            if has_state {
                let part = format!("the load '{}'", load.name());
                let reason = "its forces depend on more than the time";
                return Err(DeviceError::refused(part, reason).into());
            }
        }
        let rule = rule_of(integrator, step)?;
        self.prepare(rule, step);
        let model = self.for_device(step);
        let forces = model.loaded_nodes.len() + model.loaded_groups.len();
        device.load(&model)?;
        let most = (MOST_FORCES / forces.max(1)) as u64;
        Ok(DeviceRun {
            most: most.clamp(1, MOST_STEPS),
            host_until: 0,
        })
    }

    /// The share of the device in the run; none without a device.
    pub(crate) fn device_share(&self) -> Option<DeviceShare> {
        let steps = self.device.as_ref()?;
        let device = steps.device.as_ref()?;
        Some(DeviceShare::new(device.name(), steps.taken))
    }

    /// The model as devices take it over, with the coefficients of the prepared step (s).
    fn for_device(&self, step: f64) -> DeviceModel<'_> {
        let subdomain = &self.subdomain;
        let mut end = 0;
        let blocks = self
            .blocks
            .iter()
            .zip(&subdomain.lengths)
            .map(|(block, &length)| {
                let slots = end..end + length;
                end = slots.end;
                DeviceBlock {
                    block: block.as_ref(),
                    corners: self.corners(block.as_ref(), slots.start as u32),
                    slots,
                }
            });
        let (gain, decay) = with_nodes!(&self.nodes, arrays => arrays.coefficients());
        let held = self.groups.motion.roller_nodes.all().iter();
        DeviceModel {
            step,
            speed_limit: self.speed_limit,
            single: matches!(self.nodes, crate::nodes::Nodes::F32(_)),
            blocks: blocks.collect(),
            slot_nodes: subdomain.slot_nodes(),
            slots_of_nodes: (0..subdomain.node_count())
                .map(|node| subdomain.slots.of(node))
                .collect(),
            gain,
            decay,
            held: held.map(|roller| (roller.node, roller.held)).collect(),
            groups: self.groups.for_device(),
            has_external: self.loads.sums.on_plain_nodes(),
            loaded_nodes: self.loads.sums.changing_nodes(),
            loaded_groups: self.loads.sums.changing_groups(),
        }
    }

    /// Slots of the nodes of every element of a block whose first slot is given.
    fn corners(&self, block: &dyn ElementBlock, first: u32) -> Vec<u32> {
        let mut places: Vec<(u32, u32)> = block.nodes().iter().copied().zip(first..).collect();
        places.sort_unstable();
        let slot_of = |node: &u32| {
            let place = places.binary_search_by_key(node, |&(node, _)| node);
            place.map_or(u32::MAX, |place| places[place].1)
        };
        let elements = block.elements().iter();
        elements
            .flat_map(|&element| self.mesh.nodes_of(element).iter().map(slot_of))
            .collect()
    }

    /// Applied forces of steps (s) from the present one on.
    fn loads_ahead(&mut self, count: u64, step: f64) -> DeviceLoads {
        let mut time = self.time;
        let mut ahead = DeviceLoads {
            steps: count as usize,
            ..DeviceLoads::default()
        };
        let groups = self.loads.sums.changing_groups();
        for number in 0..count {
            self.loads.evaluate(time, None);
            let sums = &self.loads.sums;
            if number == 0 {
                ahead.at_nodes = sums.at_plain_nodes(self.mass.len());
                ahead.on_groups = (0..self.groups.kicked())
                    .map(|g| sums.on_group(g))
                    .collect();
            }
            sums.append_changing(&mut ahead.of_nodes);
            let of_groups = groups.iter().map(|&group| sums.on_group(group as usize));
            ahead.of_groups.extend(of_groups);
            time += step;
        }
        ahead
    }

    /// Lets the device take a number of steps (s); returns whether it did, or found the motion diverged and left it.
    pub(crate) fn advance_on_device(&mut self, count: u64, step: f64) -> Result<bool, RunError> {
        let Some(steps) = &mut self.device else {
            return Ok(false);
        };
        let mut device = steps.device.take().ok_or_else(lost)?;
        let advanced = self.in_pool(|model| {
            model.complete_kick();
            model.commit();
            let loads = model.loads_ahead(count, step);
            let blocks = &mut model.blocks;
            with_nodes!(&mut model.nodes, arrays => {
                let motion = DeviceMotion {
                    displacement: &mut arrays.displacement,
                    velocity: Storage::view_mut(&mut arrays.velocity),
                };
                device.advance(blocks, motion, &loads)
            })
        });
        self.put_back(device);
        if matches!(advanced, Ok(true)) {
            if let Some(steps) = &mut self.device {
                steps.taken += count;
            }
            self.groups.motion.invalidate();
            for _ in 0..count {
                self.time += step;
            }
            self.number += count;
        }
        Ok(advanced?)
    }
}
