//! Meshes, and elements made of axial links between all their nodes: simple enough to be trusted,
//! rich enough to exercise the engine without any of its own kernels.

use std::sync::{Arc, Mutex};

use nalgebra::DMatrix;
use powerhouse_explicit_core::{Leapfrog, Model, run};
use powerhouse_model::{
    BlockContext, BlockEnergy, BlockFactory, BlockOptions, BlockOutput, BlockPart, BlockStiffness,
    CheckpointSink, DampedBlock, ElementBlock, ElementFault, ElementKind, EnergyCheck, Fibre,
    FrequencyBound, Mat3, Mesh, ModelError, NodalView, NodalViewMut, Operator, Precision, Progress,
    Quad, Rayleigh, RunOptions, RunReport, SavedRun, State, StepChoice, Stress, Vec3,
};

/// Elements whose nodes are joined by links of stiffness `young * area / length`.
#[derive(Clone, Debug)]
pub(crate) struct Links {
    pub(crate) label: String,
    pub(crate) kind: ElementKind,
    pub(crate) young: f64,
    pub(crate) area: f64,
    /// kg/m3; the volume is that of the box around the element, for a bar area times length.
    pub(crate) density: f64,
    pub(crate) options: BlockOptions,
}

impl Links {
    pub(crate) fn new(label: &str, kind: ElementKind, young: f64, area: f64, density: f64) -> Self {
        Self {
            label: label.into(),
            kind,
            young,
            area,
            density,
            options: BlockOptions::default(),
        }
    }
    pub(crate) fn damped(mut self, mass: f64, stiffness: f64) -> Self {
        self.options.damping = Rayleigh { mass, stiffness };
        self
    }
    pub(crate) fn precision(mut self, precision: Precision) -> Self {
        self.options.precision = precision;
        self
    }
    pub(crate) fn boxed(self) -> Box<dyn BlockFactory> {
        Box::new(self)
    }
}

impl BlockFactory for Links {
    fn label(&self) -> &str {
        &self.label
    }
    fn kind(&self) -> ElementKind {
        self.kind
    }
    fn options(&self) -> BlockOptions {
        self.options
    }
    fn build(&self, part: &BlockPart) -> Result<Box<dyn ElementBlock>, ModelError> {
        let mut block = LinkBlock {
            factory: self.clone(),
            elements: part.elements.to_vec(),
            nodes: part.nodes.to_vec(),
            links: Vec::new(),
            mass: vec![0.0; part.nodes.len()],
            bounds: Vec::new(),
            viscous: Vec::new(),
            dissipated: 0.0,
        };
        let local = |mesh_node: u32| part.nodes.iter().position(|&n| n == mesh_node).unwrap();
        for &element in part.elements {
            let nodes = part.mesh.nodes_of(element);
            let x: Vec<Vec3> = nodes
                .iter()
                .map(|&n| part.mesh.positions()[n as usize])
                .collect();
            let volume = match self.kind {
                ElementKind::Bar2 => self.area * (x[1] - x[0]).norm(),
                _ => {
                    let low = x.iter().fold(x[0], |a, b| a.inf(b));
                    let high = x.iter().fold(x[0], |a, b| a.sup(b));
                    (high - low).product()
                }
            };
            let mass = self.density * volume / nodes.len() as f64;
            let mut stiffness = DMatrix::<f64>::zeros(3 * nodes.len(), 3 * nodes.len());
            for i in 0..nodes.len() {
                block.mass[local(nodes[i])] += mass;
                for j in i + 1..nodes.len() {
                    let along = x[j] - x[i];
                    let k = self.young * self.area / along.norm();
                    let direction = along.normalize();
                    block.links.push(Link {
                        ends: [local(nodes[i]), local(nodes[j])],
                        direction,
                        stiffness: k,
                    });
                    let kk = direction * direction.transpose() * k;
                    for (a, b, sign) in [(i, i, 1.0), (j, j, 1.0), (i, j, -1.0), (j, i, -1.0)] {
                        let mut view = stiffness.fixed_view_mut::<3, 3>(3 * a, 3 * b);
                        view += kk * sign;
                    }
                }
            }
            let highest = (stiffness / mass).symmetric_eigenvalues().max();
            let bound = FrequencyBound::new(element, highest.sqrt());
            (block.bounds).push(bound.with_stiffness_damping(self.options.damping.stiffness));
        }
        Ok(Box::new(block))
    }
}

struct Link {
    ends: [usize; 2],
    direction: Vec3,
    stiffness: f64,
}

struct LinkBlock {
    factory: Links,
    elements: Vec<u32>,
    nodes: Vec<u32>,
    links: Vec<Link>,
    mass: Vec<f64>,
    bounds: Vec<FrequencyBound>,
    /// Viscous force of each link at the last accounted step.
    viscous: Vec<f64>,
    dissipated: f64,
}

impl LinkBlock {
    fn stretch(&self, link: &Link, x: &NodalView) -> f64 {
        let [a, b] = link.ends.map(|end| x.vector(end));
        link.direction.dot(&(b - a))
    }
    fn write(&self, tensions: &[f64], out: NodalViewMut) {
        let mut forces = vec![Vec3::zeros(); self.nodes.len()];
        for (link, tension) in self.links.iter().zip(tensions) {
            forces[link.ends[0]] -= link.direction * *tension;
            forces[link.ends[1]] += link.direction * *tension;
        }
        match out {
            NodalViewMut::F64(out) => {
                for (o, f) in out.iter_mut().zip(&forces) {
                    *o = Quad::from_vector(f);
                }
            }
            NodalViewMut::F32(out) => {
                for (o, f) in out.iter_mut().zip(&forces) {
                    *o = Quad::from_vector(f);
                }
            }
        }
    }
}

impl ElementBlock for LinkBlock {
    fn label(&self) -> &str {
        &self.factory.label
    }
    fn elements(&self) -> &[u32] {
        &self.elements
    }
    fn nodes(&self) -> &[u32] {
        &self.nodes
    }
    fn forces(&mut self, context: &BlockContext, out: NodalViewMut) -> Result<(), ElementFault> {
        let damping = self.factory.options.damping.stiffness + context.damping_shift;
        let mut tensions = Vec::new();
        let mut viscous = Vec::new();
        for link in &self.links {
            let rate = self.stretch(link, &context.velocity);
            let force = link.stiffness * damping * rate;
            if context.ledger {
                if let Some(old) = self.viscous.get(viscous.len()) {
                    self.dissipated += 0.5 * (old + force) * rate * context.step;
                }
                viscous.push(force);
            }
            tensions.push(link.stiffness * self.stretch(link, &context.displacement) + force);
        }
        self.viscous = viscous;
        self.write(&tensions, out);
        Ok(())
    }
    fn add_mass(&self, out: &mut [f64]) {
        for (o, m) in out.iter_mut().zip(&self.mass) {
            *o += m;
        }
    }
    fn frequency_bounds(&self) -> Vec<FrequencyBound> {
        self.bounds.clone()
    }
    fn damped(&self) -> Option<&dyn DampedBlock> {
        Some(self)
    }
    fn stiffness(&self) -> Option<&dyn BlockStiffness> {
        Some(self)
    }
    fn output(&self) -> Option<&dyn BlockOutput> {
        Some(self)
    }
}

impl DampedBlock for LinkBlock {
    fn damping(&self) -> Rayleigh {
        self.factory.options.damping
    }
}

impl BlockStiffness for LinkBlock {
    fn apply(&self, _operator: Operator, x: NodalView, out: NodalViewMut) {
        let tensions: Vec<f64> = self
            .links
            .iter()
            .map(|link| link.stiffness * self.stretch(link, &x))
            .collect();
        self.write(&tensions, out);
    }
    fn diagonal(&self, _operator: Operator, out: &mut [Mat3]) {
        for link in &self.links {
            for end in link.ends {
                out[end] += link.direction * link.direction.transpose() * link.stiffness;
            }
        }
    }
}

impl BlockOutput for LinkBlock {
    fn energy(&self, context: &BlockContext) -> BlockEnergy {
        let elastic = self
            .links
            .iter()
            .map(|link| 0.5 * link.stiffness * self.stretch(link, &context.displacement).powi(2))
            .sum();
        let mut energy = BlockEnergy::elastic(elastic);
        energy.damping = self.dissipated;
        energy
    }
    fn add_stress(&self, displacement: NodalView, out: &mut [Stress]) {
        // Bars along x only: the axial stress.
        for (stress, link) in out.iter_mut().zip(&self.links) {
            stress.0[0] += link.stiffness * self.stretch(link, &displacement) / self.factory.area;
        }
    }
}

/// A box of hexahedra of size `h`, interior nodes shifted by up to `jitter * h`; node sets `x0`,
/// `x1`, ... `z1`, facet sets of the same names, one element set `rock`. Tags start at 1.
pub(crate) fn hex_box(counts: [usize; 3], h: f64, jitter: f64) -> Mesh {
    let [nx, ny, nz] = counts;
    let mut builder = Mesh::builder();
    let tag = |i: usize, j: usize, k: usize| (i + (nx + 1) * (j + (ny + 1) * k)) as u64 + 1;
    for k in 0..=nz {
        for j in 0..=ny {
            for i in 0..=nx {
                let inside = |a: usize, n: usize| a > 0 && a < n;
                let interior = inside(i, nx) && inside(j, ny) && inside(k, nz);
                let place = Vec3::new(i as f64, j as f64, k as f64);
                let shift = if interior {
                    Vec3::from_fn(|c, _| jitter * noise(3 * tag(i, j, k) + c as u64))
                } else {
                    Vec3::zeros()
                };
                builder.node(tag(i, j, k), (place + shift) * h);
                let sets = [
                    (i == 0, "x0"),
                    (i == nx, "x1"),
                    (j == 0, "y0"),
                    (j == ny, "y1"),
                    (k == 0, "z0"),
                    (k == nz, "z1"),
                ];
                for (_, set) in sets.iter().filter(|(on, _)| *on) {
                    builder.node_set(set, &[tag(i, j, k)]);
                }
            }
        }
    }
    let mut element = 0;
    for k in 0..nz {
        for j in 0..ny {
            for i in 0..nx {
                element += 1;
                let c = [
                    tag(i, j, k),
                    tag(i + 1, j, k),
                    tag(i + 1, j + 1, k),
                    tag(i, j + 1, k),
                    tag(i, j, k + 1),
                    tag(i + 1, j, k + 1),
                    tag(i + 1, j + 1, k + 1),
                    tag(i, j + 1, k + 1),
                ];
                builder.element(element, ElementKind::Hex8, &c, &["rock"]);
                let sides = [
                    (i == 0, "x0", [c[0], c[3], c[7], c[4]]),
                    (i + 1 == nx, "x1", [c[1], c[2], c[6], c[5]]),
                    (j == 0, "y0", [c[0], c[1], c[5], c[4]]),
                    (j + 1 == ny, "y1", [c[3], c[2], c[6], c[7]]),
                    (k == 0, "z0", [c[0], c[1], c[2], c[3]]),
                    (k + 1 == nz, "z1", [c[4], c[5], c[6], c[7]]),
                ];
                for (_, set, nodes) in sides.iter().filter(|(on, _, _)| *on) {
                    builder.facet(set, nodes);
                }
            }
        }
    }
    builder.build().unwrap()
}

/// A chain of bars along x, nodes tagged from 1; sets `bar`, `left`, `right`.
pub(crate) fn chain(count: usize, h: f64) -> Mesh {
    let mut builder = Mesh::builder();
    for i in 0..=count as u64 {
        builder.node(i + 1, Vec3::new(i as f64 * h, 0.0, 0.0));
    }
    for i in 1..=count as u64 {
        builder.element(i, ElementKind::Bar2, &[i, i + 1], &["bar"]);
    }
    builder.node_set("left", &[1]);
    builder.node_set("right", &[count as u64 + 1]);
    builder.build().unwrap()
}

/// A number in [-1, 1) from an integer.
pub(crate) fn noise(index: u64) -> f64 {
    let mut z = index.wrapping_add(77).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

/// Vectors without structure, one per node.
pub(crate) fn random_vectors(count: usize, size: f64, seed: u64) -> Vec<Vec3> {
    (0..count as u64)
        .map(|i| Vec3::from_fn(|c, _| size * noise(seed * 1_000_003 + 3 * i + c as u64)))
        .collect()
}

/// Dense elastic stiffness of elements, column by column, and the masses of the nodes of the mesh.
pub(crate) fn dense(
    mesh: &Mesh,
    factory: &dyn BlockFactory,
    elements: &[u32],
) -> (DMatrix<f64>, Vec<f64>) {
    let count = mesh.node_count();
    let nodes: Vec<u32> = (0..count as u32).collect();
    let part = BlockPart::new(mesh, elements, &nodes);
    let block = factory.build(&part).unwrap();
    let mut mass = vec![0.0; count];
    block.add_mass(&mut mass);
    let size = 3 * count;
    let mut stiffness = DMatrix::<f64>::zeros(size, size);
    for dof in 0..size {
        let mut unit = vec![Quad::<f64>::default(); count];
        unit[dof / 3].values[dof % 3] = 1.0;
        let mut out = vec![Quad::<f64>::default(); count];
        let view = NodalView::F64(&unit);
        block.apply(Operator::Elastic, view, NodalViewMut::F64(&mut out));
        for row in 0..size {
            stiffness[(row, dof)] = out[row / 3].values[row % 3];
        }
    }
    (stiffness, mass)
}

/// The stable limit `2 / w` of an undamped model from its dense stiffness, with the nodes of
/// `fixed` (mesh indices) held.
pub(crate) fn dense_limit(
    mesh: &Mesh,
    factory: &dyn BlockFactory,
    elements: &[u32],
    fixed: &[u32],
) -> f64 {
    let (stiffness, mass) = dense(mesh, factory, elements);
    let free: Vec<usize> = (0..stiffness.nrows())
        .filter(|dof| !fixed.contains(&((dof / 3) as u32)))
        .collect();
    let matrix = DMatrix::from_fn(free.len(), free.len(), |row, column| {
        let (row, dof) = (free[row], free[column]);
        stiffness[(row, dof)] / (mass[row / 3] * mass[dof / 3]).sqrt()
    });
    2.0 / matrix.symmetric_eigenvalues().max().sqrt()
}

/// Checks that a run, given its number of threads and its number format, ends with the same bits for 1, 2 and 4
/// threads, in double and in single precision.
pub(crate) fn same_bits_over_threads(end: impl Fn(usize, Precision) -> State) {
    for precision in [Precision::F64, Precision::F32] {
        let reference = end(1, precision);
        for threads in [2, 4] {
            assert_eq!(reference, end(threads, precision), "{threads} threads");
        }
    }
}

/// Keeps the state after a step, and ends the run there.
#[derive(Debug)]
pub(crate) struct StopAfter(u64, Mutex<Option<SavedRun>>);
impl StopAfter {
    pub(crate) fn new(step: u64) -> Arc<Self> {
        Arc::new(Self(step, Mutex::new(None)))
    }
    /// The state that was kept.
    pub(crate) fn saved(&self) -> SavedRun {
        self.1.lock().unwrap().take().unwrap()
    }
}
impl CheckpointSink for StopAfter {
    fn is_due(&self, progress: &Progress) -> bool {
        progress.done == self.0
    }
    fn take(&self, saved: SavedRun) -> Result<(), ModelError> {
        *self.1.lock().unwrap() = Some(saved);
        Err(ModelError::refused("test", "stopped"))
    }
}

/// Keeps the state after a step; the run goes on.
#[derive(Debug)]
pub(crate) struct KeepAfter(u64, Mutex<Option<SavedRun>>);
impl KeepAfter {
    pub(crate) fn new(step: u64) -> Arc<Self> {
        Arc::new(Self(step, Mutex::new(None)))
    }
    /// The state that was kept.
    pub(crate) fn saved(&self) -> SavedRun {
        self.1.lock().unwrap().take().unwrap()
    }
}
impl CheckpointSink for KeepAfter {
    fn is_due(&self, progress: &Progress) -> bool {
        progress.done == self.0
    }
    fn take(&self, saved: SavedRun) -> Result<(), ModelError> {
        *self.1.lock().unwrap() = Some(saved);
        Ok(())
    }
}

/// Bits of displacement and velocity of all nodes.
pub(crate) fn bits_of_motion(model: &Model) -> Vec<[u64; 6]> {
    let nodes = 0..model.mesh().node_count() as u32;
    let of = |node: u32| {
        let (u, v) = (model.displacement(node), model.velocity(node));
        [u.x, u.y, u.z, v.x, v.y, v.z].map(f64::to_bits)
    };
    nodes.map(of).collect()
}

/// Norm of the difference of two motions of as many nodes and times, over that of the second.
pub(crate) fn apart(a: &[Vec3], b: &[Vec3]) -> f64 {
    assert_eq!(a.len(), b.len());
    let missed: f64 = a.iter().zip(b).map(|(a, b)| (a - b).norm_squared()).sum();
    (missed / b.iter().map(|b| b.norm_squared()).sum::<f64>()).sqrt()
}

/// A fibre of nodes with an added inertia over mass (1).
pub(crate) fn fibre_of(nodes: &[u32], added: f64) -> Fibre {
    Fibre {
        nodes: nodes.to_vec(),
        added,
    }
}

/// Runs so many steps of a length (s), each with its balance of energy.
pub(crate) fn balanced_steps(model: &mut Model, count: u64, step: StepChoice) -> RunReport {
    let options = RunOptions::steps(count)
        .with_step(step)
        .with_energy(EnergyCheck::every(1));
    run(model, &Leapfrog, &options, &mut [], &mut |_| {}).unwrap()
}

/// A term of the balance of energy (J).
pub(crate) fn energy_of(report: &RunReport, name: &str) -> f64 {
    let mut terms = report.energies.iter();
    terms.find(|(term, _)| *term == name).unwrap().1
}
