//! Time steps of a model on a device.

use powerhouse_model::{
    DeviceError, DeviceLoads, DeviceModel, DeviceMotion, ElementBlock, NodalScalar, NodalViewMut,
    Quad, StepDevice, Vec3,
};

use crate::device::{Argument, Device, Memory};
use crate::layout::Layout;
use crate::source::{KICK, LOAD_GROUPS, LOAD_NODES, MOVE, NodeOptions, element_kernel, source};

/// Most steps whose applied forces are on the device at once.
const STEPS_AT_ONCE: usize = 64;

/// Time steps of a model on a [`Device`].
pub struct DeviceSteps {
    device: Box<dyn Device>,
    /// Source of the kernels in use.
    compiled: Option<String>,
    loaded: Option<Loaded>,
}

/// Memory of a group of elements.
struct GroupMemory {
    kernel: String,
    nodes: Memory,
    constants: Memory,
    history: Memory,
    reference: Memory,
}

/// Memory of nodes.
struct NodeMemory {
    displacement: Memory,
    velocity: Memory,
    force: Memory,
    external: Memory,
    gain: Memory,
    decay: Memory,
    held: Memory,
    group_of: Memory,
    /// Starts and slots of nodes, starts and places of slots.
    sums: [Memory; 4],
    fault: Memory,
}

/// Memory of groups of nodes and of applied forces.
struct GroupedMemory {
    /// Starts and members.
    members: [Memory; 2],
    matrices: Memory,
    applied: Memory,
    next: Memory,
    loaded_nodes: Memory,
    loaded_groups: Memory,
    of_nodes: Memory,
    of_groups: Memory,
}

/// A model on the device.
struct Loaded {
    layout: Layout,
    elements: Vec<GroupMemory>,
    nodes: NodeMemory,
    grouped: GroupedMemory,
    single: bool,
    step: f64,
    limit: f64,
    node_count: usize,
    group_count: usize,
    /// Numbers of nodes and of groups with applied forces that change in time.
    loaded: [usize; 2],
}

/// Writes numbers to the device, in single precision if so asked.
fn write(
    device: &mut dyn Device,
    memory: Memory,
    single: bool,
    numbers: impl Iterator<Item = f64>,
) -> Result<(), DeviceError> {
    if single {
        let numbers: Vec<f32> = numbers.map(|number| number as f32).collect();
        device.write(memory, bytemuck::cast_slice(&numbers))
    } else {
        let numbers: Vec<f64> = numbers.collect();
        device.write(memory, bytemuck::cast_slice(&numbers))
    }
}

/// Numbers of bytes.
fn numbers(single: bool, bytes: &[u8]) -> Vec<f64> {
    if single {
        let numbers = bytes.as_chunks().0.iter();
        numbers
            .map(|&bytes| f32::from_ne_bytes(bytes).into())
            .collect()
    } else {
        let numbers = bytes.as_chunks().0.iter();
        numbers.map(|&bytes| f64::from_ne_bytes(bytes)).collect()
    }
}

fn size_of_number(single: bool) -> usize {
    if single { 4 } else { 8 }
}

/// Numbers of nodal vectors.
fn flat<S: NodalScalar>(vectors: &[Quad<S>]) -> impl Iterator<Item = f64> {
    let values = vectors.iter().flat_map(|vector| vector.values);
    values.map(|number| number.to_f64())
}

fn components(vectors: &[Vec3]) -> impl Iterator<Item = f64> {
    vectors
        .iter()
        .flat_map(|vector| [vector.x, vector.y, vector.z])
}

impl DeviceSteps {
    /// Steps on a device, without a model yet.
    pub fn new(device: Box<dyn Device>) -> Self {
        Self {
            device,
            compiled: None,
            loaded: None,
        }
    }

    /// Memory with bytes.
    fn memory(&mut self, bytes: &[u8]) -> Result<Memory, DeviceError> {
        let memory = self.device.allocate(bytes.len())?;
        self.device.write(memory, bytes)?;
        Ok(memory)
    }
    fn integers(&mut self, numbers: &[u32]) -> Result<Memory, DeviceError> {
        self.memory(bytemuck::cast_slice(numbers))
    }
    fn numbers(&mut self, single: bool, values: &[f64]) -> Result<Memory, DeviceError> {
        let memory = self
            .device
            .allocate(values.len() * size_of_number(single))?;
        write(self.device.as_mut(), memory, single, values.iter().copied())?;
        Ok(memory)
    }

    fn elements(&mut self, layout: &Layout) -> Result<Vec<GroupMemory>, DeviceError> {
        let mut elements = Vec::new();
        for (index, group) in layout.groups.iter().enumerate() {
            let single = group.is_single();
            let history = group.history_count() * group.elements * size_of_number(single);
            elements.push(GroupMemory {
                kernel: element_kernel(index),
                nodes: self.integers(&group.nodes)?,
                constants: self.numbers(single, &group.constants)?,
                history: self.device.allocate(history)?,
                reference: self.numbers(false, &group.reference)?,
            });
        }
        Ok(elements)
    }

    fn nodes(&mut self, model: &DeviceModel, layout: &Layout) -> Result<NodeMemory, DeviceError> {
        let count = model.slots_of_nodes.len();
        let size = size_of_number(model.single);
        Ok(NodeMemory {
            displacement: self.device.allocate(4 * count * 8)?,
            velocity: self.device.allocate(4 * count * size)?,
            force: self.device.allocate(3 * layout.places * size)?,
            external: self.device.allocate(3 * count * size)?,
            gain: self.numbers(model.single, &model.gain)?,
            decay: self.numbers(model.single, &model.decay)?,
            held: self.integers(&layout.held)?,
            group_of: self.integers(&layout.group_of)?,
            sums: [
                self.integers(&layout.of_nodes.starts)?,
                self.integers(&layout.of_nodes.items)?,
                self.integers(&layout.of_slots.starts)?,
                self.integers(&layout.of_slots.items)?,
            ],
            fault: self.device.allocate(4)?,
        })
    }

    fn grouped(
        &mut self,
        model: &DeviceModel,
        layout: &Layout,
    ) -> Result<GroupedMemory, DeviceError> {
        let vectors = |count: usize| 3 * count * 8;
        let count = model.groups.len();
        let [nodes, groups] = [&model.loaded_nodes, &model.loaded_groups];
        Ok(GroupedMemory {
            members: [
                self.integers(&layout.members.starts)?,
                self.integers(&layout.members.items)?,
            ],
            matrices: self.numbers(false, &layout.matrices)?,
            applied: self.device.allocate(vectors(count))?,
            next: self.device.allocate(vectors(count))?,
            loaded_nodes: self.integers(nodes)?,
            loaded_groups: self.integers(groups)?,
            of_nodes: self.device.allocate(vectors(STEPS_AT_ONCE * nodes.len()))?,
            of_groups: self
                .device
                .allocate(vectors(STEPS_AT_ONCE * groups.len()))?,
        })
    }
}

impl Loaded {
    /// Writes motion, applied forces and history variables to the device.
    fn write(
        &self,
        device: &mut dyn Device,
        blocks: &[Box<dyn ElementBlock>],
        motion: &DeviceMotion,
        loads: &DeviceLoads,
    ) -> Result<(), DeviceError> {
        let nodes = &self.nodes;
        write(device, nodes.displacement, false, flat(motion.displacement))?;
        match &motion.velocity {
            NodalViewMut::F64(velocity) => write(device, nodes.velocity, false, flat(velocity))?,
            NodalViewMut::F32(velocity) => write(device, nodes.velocity, true, flat(velocity))?,
        }
        let external = components(&loads.at_nodes);
        write(device, nodes.external, self.single, external)?;
        let applied = components(&loads.on_groups);
        write(device, self.grouped.applied, false, applied)?;
        for (group, memory) in self.layout.groups.iter().zip(&self.elements) {
            let histories = group.histories(blocks)?.into_iter();
            write(device, memory.history, group.is_single(), histories)?;
        }
        device.write(self.nodes.fault, &[0; 4])
    }

    /// Launches the kernels of all steps.
    fn launch(&self, device: &mut dyn Device, loads: &DeviceLoads) -> Result<(), DeviceError> {
        let [nodes, groups] = self.loaded;
        for first in (0..loads.steps).step_by(STEPS_AT_ONCE) {
            let count = STEPS_AT_ONCE.min(loads.steps - first);
            for (memory, forces, loaded) in [
                (self.grouped.of_nodes, &loads.of_nodes, nodes),
                (self.grouped.of_groups, &loads.of_groups, groups),
            ] {
                let rows = &forces[first * loaded..(first + count) * loaded];
                write(device, memory, false, components(rows))?;
            }
            for row in 0..count {
                self.step(device, row as u64)?;
            }
        }
        Ok(())
    }

    /// Launches the kernels of a step, whose applied forces are in a row.
    fn step(&self, device: &mut dyn Device, row: u64) -> Result<(), DeviceError> {
        use Argument::{Count, Memory as At, Number};
        let (nodes, grouped) = (&self.nodes, &self.grouped);
        let places = Count(self.layout.places as u64);
        for (group, memory) in self.layout.groups.iter().zip(&self.elements) {
            let arguments = [
                At(nodes.displacement),
                At(nodes.velocity),
                At(nodes.force),
                places,
                Count(group.base as u64),
                At(memory.nodes),
                At(memory.constants),
                At(memory.history),
                At(memory.reference),
            ];
            device.launch(&memory.kernel, group.elements, &arguments)?;
        }
        let of_nodes = [grouped.of_nodes, grouped.loaded_nodes, nodes.external];
        let of_groups = [grouped.of_groups, grouped.loaded_groups, grouped.applied];
        let loads = [(LOAD_NODES, of_nodes), (LOAD_GROUPS, of_groups)];
        for ((kernel, memory), count) in loads.into_iter().zip(self.loaded) {
            if count > 0 {
                let [forces, loaded, applied] = memory.map(At);
                device.launch(kernel, count, &[forces, Count(row), loaded, applied])?;
            }
        }
        let [a, b, c, d] = nodes.sums.map(At);
        if self.group_count > 0 {
            let arguments = [
                At(nodes.displacement),
                At(nodes.velocity),
                At(nodes.force),
                places,
                a,
                b,
                c,
                d,
                At(grouped.members[0]),
                At(grouped.members[1]),
                At(grouped.matrices),
                At(grouped.applied),
                At(grouped.next),
                Number(self.step),
            ];
            device.launch(KICK, self.group_count, &arguments)?;
        }
        let arguments = [
            At(nodes.displacement),
            At(nodes.velocity),
            At(nodes.force),
            places,
            a,
            b,
            c,
            d,
            At(nodes.external),
            At(nodes.gain),
            At(nodes.decay),
            At(nodes.held),
            At(nodes.group_of),
            At(grouped.next),
            Number(self.step),
            Number(self.limit),
            At(nodes.fault),
        ];
        device.launch(MOVE, self.node_count, &arguments)
    }

    /// Reads motion and history variables from the device, all of them before the first is replaced.
    fn read(
        &self,
        device: &mut dyn Device,
        blocks: &mut [Box<dyn ElementBlock>],
        motion: DeviceMotion,
    ) -> Result<(), DeviceError> {
        let mut read = |memory: Memory, single: bool, count: usize| {
            let mut bytes = vec![0; count * size_of_number(single)];
            device.read(memory, &mut bytes)?;
            Ok::<_, DeviceError>(numbers(single, &bytes))
        };
        let displacement = read(self.nodes.displacement, false, 4 * self.node_count)?;
        let velocity = read(self.nodes.velocity, self.single, 4 * self.node_count)?;
        let mut histories = Vec::new();
        for (group, memory) in self.layout.groups.iter().zip(&self.elements) {
            let count = group.history_count() * group.elements;
            histories.push(read(memory.history, group.is_single(), count)?);
        }
        set(motion.displacement, &displacement);
        match motion.velocity {
            NodalViewMut::F64(to) => set(to, &velocity),
            NodalViewMut::F32(to) => set(to, &velocity),
        }
        for (group, rows) in self.layout.groups.iter().zip(&histories) {
            group.set_histories(blocks, rows);
        }
        Ok(())
    }
}

/// Sets nodal vectors from numbers.
fn set<S: NodalScalar>(vectors: &mut [Quad<S>], numbers: &[f64]) {
    for (vector, numbers) in vectors.iter_mut().zip(numbers.as_chunks::<4>().0) {
        vector.values = numbers.map(S::from_f64);
    }
}

impl StepDevice for DeviceSteps {
    fn name(&self) -> &str {
        self.device.name()
    }

    fn load(&mut self, model: &DeviceModel) -> Result<(), DeviceError> {
        self.loaded = None;
        self.device.free_all();
        let layout = Layout::new(model)?;
        let options = NodeOptions {
            single: model.single,
            external: model.has_external,
            decay: !model.decay.is_empty(),
        };
        let text = source(&layout.groups, options);
        let of_elements = (0..layout.groups.len()).map(element_kernel);
        let around = [LOAD_NODES, LOAD_GROUPS, KICK, MOVE].map(str::to_owned);
        let kernels: Vec<String> = of_elements.chain(around).collect();
        if self.compiled.as_ref() != Some(&text) {
            self.compiled = None;
            self.device.compile(&text, &kernels)?;
            self.compiled = Some(text);
        }
        let largest = if model.single {
            f64::from(f32::MAX)
        } else {
            f64::MAX
        };
        self.loaded = Some(Loaded {
            elements: self.elements(&layout)?,
            nodes: self.nodes(model, &layout)?,
            grouped: self.grouped(model, &layout)?,
            layout,
            single: model.single,
            step: model.step,
            limit: model.speed_limit.min(largest),
            node_count: model.slots_of_nodes.len(),
            group_count: model.groups.len(),
            loaded: [model.loaded_nodes.len(), model.loaded_groups.len()],
        });
        Ok(())
    }

    fn advance(
        &mut self,
        blocks: &mut [Box<dyn ElementBlock>],
        motion: DeviceMotion,
        loads: &DeviceLoads,
    ) -> Result<bool, DeviceError> {
        let device = self.device.as_mut();
        let Some(loaded) = &self.loaded else {
            return Err(DeviceError::failed("a step", "the device has no model"));
        };
        loaded.write(device, blocks, &motion, loads)?;
        loaded.launch(device, loads)?;
        let mut fault = [0; 4];
        device.read(loaded.nodes.fault, &mut fault)?;
        if fault != [0; 4] {
            return Ok(false);
        }
        loaded.read(device, blocks, motion)?;
        Ok(true)
    }
}
