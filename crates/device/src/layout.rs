//! Arrays of a model as kernels read them.

use powerhouse_model::{
    DeviceBlock, DeviceError, DeviceModel, ElementBlock, HistoryField, NodalView, NumberFormat,
    Program, Quad,
};

/// Most forks of a program: the first one separates elements that stay elastic, at which threads part company early.
const FORKS: usize = 1;

/// Place of an input of a program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum InputPlace {
    /// Component of the displacements of the element's nodes.
    Displacement(usize),
    /// Component of their velocities.
    Velocity(usize),
    /// The same number for all elements.
    Number(f64),
    /// Row of the numbers that differ between elements.
    Constant(usize),
    /// Row of the history variables.
    History(usize),
}

/// Field of a block with a history variable, and which of its values of an element.
struct HistoryPlace {
    field: String,
    value: usize,
}

/// Elements of all blocks that have one program.
pub(crate) struct ElementGroup {
    pub(crate) program: Program,
    /// Number of nodes of an element.
    pub(crate) corners: usize,
    /// Number of elements.
    pub(crate) elements: usize,
    /// Indices of the blocks, and the first element of each.
    blocks: Vec<(usize, usize)>,
    /// Nodes of the elements: those of the first corner of all elements, of the second, and so on, as in all arrays of elements.
    pub(crate) nodes: Vec<u32>,
    /// Place of the first force.
    pub(crate) base: usize,
    /// Places of the inputs of the program.
    pub(crate) inputs: Vec<InputPlace>,
    /// Numbers that differ between elements.
    pub(crate) constants: Vec<f64>,
    /// Negative reference displacement of the nodes of the elements; empty if there is none.
    pub(crate) reference: Vec<f64>,
    /// Coefficient of stiffness damping of a linear law (s).
    pub(crate) damping: f64,
    histories: Vec<HistoryPlace>,
}

impl ElementGroup {
    /// Whether numbers are in single precision.
    pub(crate) fn is_single(&self) -> bool {
        self.program.format() == NumberFormat::F32
    }
    /// Number of history variables of an element.
    pub(crate) fn history_count(&self) -> usize {
        self.histories.len()
    }

    /// Committed history variables of all elements, row by row.
    pub(crate) fn histories(
        &self,
        blocks: &[Box<dyn ElementBlock>],
    ) -> Result<Vec<f64>, DeviceError> {
        let mut rows = vec![0.0; self.histories.len() * self.elements];
        if rows.is_empty() {
            return Ok(rows);
        }
        for &(index, first) in &self.blocks {
            let fields = blocks[index].history();
            for (row, place) in self.histories.iter().enumerate() {
                let field = fields.iter().find(|field| field.name == place.field);
                let field = field.ok_or_else(|| {
                    let what = format!("the history of set '{}'", blocks[index].label());
                    DeviceError::refused(what, format!("it has no field '{}'", place.field))
                })?;
                let values = field.values.iter().skip(place.value).step_by(field.points);
                let to = &mut rows[row * self.elements + first..];
                for (to, value) in to.iter_mut().zip(values) {
                    *to = *value;
                }
            }
        }
        Ok(rows)
    }

    /// Sets the committed history variables of all elements.
    pub(crate) fn set_histories(&self, blocks: &mut [Box<dyn ElementBlock>], rows: &[f64]) {
        if self.histories.is_empty() {
            return;
        }
        for &(index, first) in &self.blocks {
            let mut fields = blocks[index].history();
            for (row, place) in self.histories.iter().enumerate() {
                let of_row = &rows[row * self.elements + first..];
                let fields = fields.iter_mut();
                for field in fields.filter(|field| field.name == place.field) {
                    put(field, place.value, of_row);
                }
            }
            blocks[index].set_history(&fields);
        }
    }
}

/// Sets one value of each element of a field.
fn put(field: &mut HistoryField, value: usize, numbers: &[f64]) {
    let values = field.values.iter_mut().skip(value).step_by(field.points);
    for (value, number) in values.zip(numbers) {
        *value = *number;
    }
}

/// Lists of variable length, one behind the other.
#[derive(Debug, Default)]
pub(crate) struct Lists {
    pub(crate) starts: Vec<u32>,
    pub(crate) items: Vec<u32>,
}

impl Lists {
    fn of<'a>(lists: impl Iterator<Item = &'a [u32]>) -> Self {
        let mut found = Self {
            starts: vec![0],
            items: Vec::new(),
        };
        for list in lists {
            found.items.extend_from_slice(list);
            found.starts.push(found.items.len() as u32);
        }
        found
    }
}

/// Arrays of a model.
pub(crate) struct Layout {
    pub(crate) groups: Vec<ElementGroup>,
    /// Number of places of element forces, each of which has three numbers.
    pub(crate) places: usize,
    /// Places of the forces of each slot, in the order of summation.
    pub(crate) of_slots: Lists,
    /// Slots of each node, in the order of summation.
    pub(crate) of_nodes: Lists,
    /// Members of each group of nodes.
    pub(crate) members: Lists,
    /// Group of each node, or `u32::MAX`.
    pub(crate) group_of: Vec<u32>,
    /// Axes along which each node is held, as bits.
    pub(crate) held: Vec<u32>,
    /// Of each group of nodes: carry, inverse and spring by rows, origin, and whether it is diagonal, row by row.
    pub(crate) matrices: Vec<f64>,
}

/// Numbers of a group of nodes.
const GROUP_NUMBERS: usize = 31;

impl Layout {
    pub(crate) fn new(model: &DeviceModel) -> Result<Self, DeviceError> {
        let mut groups: Vec<ElementGroup> = Vec::new();
        let mut of_group: Vec<Vec<usize>> = Vec::new();
        for (index, block) in model.blocks.iter().enumerate() {
            let program = block.block.program(model.step, FORKS).map_err(|reason| {
                let part = format!("set '{}'", block.block.label());
                DeviceError::refused(part, reason.to_string())
            })?;
            let damping = block.block.damping().stiffness;
            let known = groups
                .iter()
                .position(|group| group.program == program && group.damping == damping);
            match known {
                Some(known) => of_group[known].push(index),
                None => {
                    groups.push(empty_group(program, damping));
                    of_group.push(vec![index]);
                }
            }
        }
        if model.single && groups.iter().any(|group| !group.is_single()) {
            let part = "small or stiff elements in double precision at nodes in single precision";
            let reason =
                "their forces are summed in double precision; `precision = \"mixed\"` avoids this";
            return Err(DeviceError::refused(part, reason));
        }
        let mut places = 0;
        let mut of_slots: Vec<Vec<u32>> = vec![Vec::new(); model.slot_nodes.len()];
        for (group, blocks) in groups.iter_mut().zip(of_group) {
            group.base = places;
            fill(group, model, &blocks)?;
            places += group.corners * group.elements;
            for &(index, first) in &group.blocks {
                let corners = model.blocks[index].corners.chunks_exact(group.corners);
                for (element, corners) in corners.enumerate() {
                    for (corner, &slot) in corners.iter().enumerate() {
                        let place = group.base + corner * group.elements + first + element;
                        of_slots[slot as usize].push(place as u32);
                    }
                }
            }
        }
        if u32::try_from(3 * places).is_err() {
            let reason = format!("{places} of them are too many for one card");
            return Err(DeviceError::refused("the nodes of all elements", reason));
        }
        let nodes = model.slots_of_nodes.len();
        let mut group_of = vec![u32::MAX; nodes];
        for (group, index) in model.groups.iter().zip(0..) {
            for &member in &group.members {
                group_of[member as usize] = index;
            }
        }
        let mut held = vec![0; nodes];
        for &(node, axes) in &model.held {
            held[node as usize] = (0..3).map(|axis| u32::from(axes[axis]) << axis).sum();
        }
        Ok(Self {
            groups,
            places,
            of_slots: Lists::of(of_slots.iter().map(|list| &**list)),
            of_nodes: Lists::of(model.slots_of_nodes.iter().copied()),
            members: Lists::of(model.groups.iter().map(|group| &*group.members)),
            group_of,
            held,
            matrices: matrices(model),
        })
    }
}

/// Numbers of the groups of nodes, row by row.
fn matrices(model: &DeviceModel) -> Vec<f64> {
    let count = model.groups.len();
    let mut rows = vec![0.0; GROUP_NUMBERS * count];
    for (index, group) in model.groups.iter().enumerate() {
        let of_matrices = [&group.carry, &group.inverse, &group.spring];
        let entries = of_matrices.into_iter().flat_map(|matrix| {
            let matrix = *matrix;
            (0..9).map(move |entry| matrix[(entry / 3, entry % 3)])
        });
        let origin = group.origin.iter().copied();
        let flag = f64::from(u8::from(group.is_diagonal));
        for (row, number) in entries.chain(origin).chain([flag]).enumerate() {
            rows[row * count + index] = number;
        }
    }
    rows
}

fn empty_group(program: Program, damping: f64) -> ElementGroup {
    ElementGroup {
        program,
        corners: 0,
        elements: 0,
        blocks: Vec::new(),
        nodes: Vec::new(),
        base: 0,
        inputs: Vec::new(),
        constants: Vec::new(),
        reference: Vec::new(),
        damping,
        histories: Vec::new(),
    }
}

/// Fills a group with the elements of blocks.
fn fill(
    group: &mut ElementGroup,
    model: &DeviceModel,
    blocks: &[usize],
) -> Result<(), DeviceError> {
    let names = group.program.inputs();
    let with = |prefix: &str| names.iter().filter(|name| name.starts_with(prefix)).count();
    let motion = with("displacement.");
    group.corners = motion / 3;
    let empty = |&index: &usize| model.blocks[index].corners.is_empty();
    if group.corners == 0 || blocks.iter().any(empty) {
        let part = format!("set '{}'", group.program.name());
        return Err(DeviceError::refused(
            part,
            "it has a block without elements or nodes",
        ));
    }
    // The displacement of a linear law has the damping added; other laws have velocities of their own.
    if with("initial.") > 0 {
        group.damping = 0.0;
    }
    let velocity = with("velocity.");
    let histories = with("history.") + with("element_history.");
    let fixed = motion + velocity..names.len() - histories;
    group.histories = names[fixed.end..]
        .iter()
        .map(|name| place_of(name))
        .collect();
    for &index in blocks {
        group.blocks.push((index, group.elements));
        group.elements += model.blocks[index].corners.len() / group.corners;
    }
    let elements = group.elements;
    group.nodes = vec![0; group.corners * elements];
    let mut numbers = vec![0.0; fixed.len() * elements];
    let mut reference = vec![0.0; motion * elements];
    for &(index, first) in &group.blocks {
        let DeviceBlock { block, corners, .. } = &model.blocks[index];
        let at_rest = Rest::new(block.nodes().len(), model.single);
        for (element, corners) in corners.chunks_exact(group.corners).enumerate() {
            for (corner, &slot) in corners.iter().enumerate() {
                let node = model.slot_nodes[slot as usize];
                group.nodes[corner * elements + first + element] = node;
            }
            let inputs = block.programmed().map_or_else(Vec::new, |programmed| {
                programmed.program_inputs(element, at_rest.displacement(), at_rest.velocity())
            });
            let put = |rows: &mut [f64], from: &[f64]| {
                for (row, number) in from.iter().enumerate() {
                    rows[row * elements + first + element] = *number;
                }
            };
            put(&mut reference, &inputs[..motion]);
            put(&mut numbers, &inputs[fixed.clone()]);
        }
    }
    if reference.iter().any(|&number| number != 0.0) {
        if group.is_single() {
            let part = format!("set '{}' in single precision", group.program.name());
            let reason =
                "its elements were cast in a deformed body; `precision = \"f64\"` avoids this";
            return Err(DeviceError::refused(part, reason));
        }
        group.reference = reference;
    }
    let mut inputs: Vec<InputPlace> = (0..motion).map(InputPlace::Displacement).collect();
    inputs.extend((0..velocity).map(InputPlace::Velocity));
    for row in numbers.chunks_exact(elements) {
        let bits = row[0].to_bits();
        inputs.push(if row.iter().all(|number| number.to_bits() == bits) {
            InputPlace::Number(row[0])
        } else {
            group.constants.extend_from_slice(row);
            InputPlace::Constant(group.constants.len() / elements - 1)
        });
    }
    inputs.extend((0..histories).map(InputPlace::History));
    group.inputs = inputs;
    Ok(())
}

/// Place of a history variable by the name of its input, `history.POINT.NAME` or `element_history.NUMBER`.
fn place_of(name: &str) -> HistoryPlace {
    let (first, rest) = name.split_once('.').unwrap_or((name, "0"));
    let (value, field) = match first {
        "history" => rest.split_once('.').unwrap_or((rest, "")),
        _ => (rest, first),
    };
    HistoryPlace {
        field: field.to_owned(),
        value: value.parse().unwrap_or(usize::MAX),
    }
}

/// Nodal vectors of a block at rest.
struct Rest {
    double: Vec<Quad<f64>>,
    single: Vec<Quad<f32>>,
    is_single: bool,
}

impl Rest {
    fn new(nodes: usize, is_single: bool) -> Self {
        Self {
            double: vec![Quad::default(); nodes],
            single: vec![Quad::default(); nodes],
            is_single,
        }
    }
    fn displacement(&self) -> NodalView<'_> {
        NodalView::F64(&self.double)
    }
    fn velocity(&self) -> NodalView<'_> {
        if self.is_single {
            NodalView::F32(&self.single)
        } else {
            NodalView::F64(&self.double)
        }
    }
}
