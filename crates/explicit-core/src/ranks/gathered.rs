//! State of the body for observers, gathered on rank 0.

use std::cell::Cell;

use powerhouse_model::{Fields, JointView, StepView, Stress, Vec3};

use crate::Model;
use crate::view::View;

/// State of the body at a step, from the nodes and elements of all ranks.
pub(crate) struct Gathered<'a> {
    number: u64,
    time: f64,
    step: f64,
    /// Displacement since the start of the stage (m), velocity (m/s) and acceleration (m/s2) of each mesh node.
    motion: Vec<[Vec3; 3]>,
    /// Mean stress (Pa) of each mesh element, if an observer reads stresses.
    stress: Option<Vec<Stress>>,
    energies: &'a [(&'static str, f64)],
    /// What an observer has read that is not gathered.
    missing: Cell<Option<&'static str>>,
}

/// Bytes of a node or element: its mesh index and numbers.
fn write(index: u32, numbers: &[f64], bytes: &mut Vec<u8>) {
    bytes.extend_from_slice(&index.to_le_bytes());
    for number in numbers {
        bytes.extend_from_slice(&number.to_le_bytes());
    }
}

/// The index and numbers of a node or element that [`write`] wrote.
fn read<const N: usize>(bytes: &[u8]) -> Option<(usize, [f64; N])> {
    let (index, numbers) = bytes.split_first_chunk::<4>()?;
    let (numbers, _) = numbers.as_chunks::<8>();
    let number = |i: usize| numbers.get(i).copied().map(f64::from_le_bytes);
    let all = core::array::from_fn(|i| number(i).unwrap_or_default());
    Some((u32::from_le_bytes(*index) as usize, all))
}

/// Length of the bytes of a node or element with some numbers.
const fn length(numbers: usize) -> usize {
    size_of::<u32>() + numbers * size_of::<f64>()
}

impl<'a> Gathered<'a> {
    /// Gathers the state between kick and drift; none on other ranks than rank 0.
    pub(crate) fn of(
        model: &Model,
        step: f64,
        fields: Fields,
        energies: &'a [(&'static str, f64)],
    ) -> Option<Self> {
        let view = View::new(model, step, energies);
        let (subdomain, mesh) = (&model.subdomain, &model.mesh);
        let (nodes, elements) = (mesh.node_count(), mesh.element_count());
        let mut of_nodes = Vec::new();
        for local in subdomain.node_ranges.ranges().iter().cloned().flatten() {
            let node = subdomain.numbering.mesh_of[local];
            if node as usize >= nodes {
                continue;
            }
            let vectors = [
                view.displacement(node),
                view.velocity(node),
                view.acceleration(node),
            ];
            let numbers: Vec<f64> = vectors.iter().flat_map(|v| [v.x, v.y, v.z]).collect();
            write(node, &numbers, &mut of_nodes);
        }
        let mut of_elements = Vec::new();
        if fields.stress {
            let blocks = model.blocks.len();
            for (element, &(block, _)) in (0..).zip(&subdomain.block_of_element) {
                if (block as usize) < blocks {
                    write(element, &view.stress(element).0, &mut of_elements);
                }
            }
        }
        let team = &model.ranks.team;
        let (of_nodes, of_elements) = (team.at_first(&of_nodes), team.at_first(&of_elements));
        if team.rank() != 0 {
            return None;
        }
        let mut gathered = Self {
            number: view.number(),
            time: view.time(),
            step,
            motion: vec![[Vec3::zeros(); 3]; nodes],
            stress: fields.stress.then(|| vec![Stress::default(); elements]),
            energies,
            missing: Cell::new(None),
        };
        for bytes in of_nodes
            .iter()
            .flat_map(|bytes| bytes.chunks_exact(length(9)))
        {
            if let Some((node, numbers)) = read::<9>(bytes)
                && let Some(motion) = gathered.motion.get_mut(node)
            {
                let vector = |i: usize| Vec3::from_column_slice(&numbers[3 * i..3 * i + 3]);
                *motion = [vector(0), vector(1), vector(2)];
            }
        }
        for bytes in of_elements
            .iter()
            .flat_map(|bytes| bytes.chunks_exact(length(6)))
        {
            if let Some((element, numbers)) = read::<6>(bytes)
                && let Some(stress) = gathered.stress.as_mut().and_then(|s| s.get_mut(element))
            {
                *stress = Stress(numbers);
            }
        }
        Some(gathered)
    }

    /// What observers have read that is not gathered, if anything.
    pub(crate) fn missing(&self) -> Option<&'static str> {
        self.missing.get()
    }
}

impl StepView for Gathered<'_> {
    fn number(&self) -> u64 {
        self.number
    }
    fn time(&self) -> f64 {
        self.time
    }
    fn step(&self) -> f64 {
        self.step
    }
    fn node_count(&self) -> usize {
        self.motion.len()
    }
    fn displacement(&self, node: u32) -> Vec3 {
        self.motion[node as usize][0]
    }
    fn velocity(&self, node: u32) -> Vec3 {
        self.motion[node as usize][1]
    }
    fn acceleration(&self, node: u32) -> Vec3 {
        self.motion[node as usize][2]
    }
    fn stress(&self, element: u32) -> Stress {
        if let Some(stress) = &self.stress {
            return stress.get(element as usize).copied().unwrap_or_default();
        }
        let undeclared = "an observer that reads stresses and does not declare them";
        self.missing.set(Some(undeclared));
        Stress::default()
    }
    fn element_forces(&self, _element: u32, _out: &mut [Vec3]) -> bool {
        self.missing.set(Some("an observer of element forces"));
        false
    }
    fn energies(&self) -> &[(&'static str, f64)] {
        self.energies
    }
    fn history(&self, _element: u32, _variable: &str) -> Option<f64> {
        self.missing.set(Some("an observer of history variables"));
        None
    }
    fn embedded(&self, _block: &str, _variable: &str) -> Option<Vec<f64>> {
        self.missing.set(Some("an observer of embedded elements"));
        None
    }
    fn joints(&self) -> Vec<JointView<'_>> {
        self.missing.set(Some("an observer of joints"));
        Vec::new()
    }
}
