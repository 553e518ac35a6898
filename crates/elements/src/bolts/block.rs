//! The element block of some bolts of a set.

use core::ops::Range;
use std::sync::Arc;

use powerhouse_model::{
    AXIAL_FORCE, BlockContext, BlockEnergy, BlockOutput, BlockStiffness, ElementBlock,
    ElementFault, FrequencyBound, HistoryField, Mat3, NodalView, NodalViewMut, Operator, Quad,
    StatefulBlock, Stress, Vec3,
};

use super::bar::Bar;
use super::grouted::{BoltWorkspace, GroutedBar, NOT_FINITE, clear};
use super::interpolation::Interpolation;
use super::tied::TiedBars;
use super::{BoltSet, Embedded};

const PLASTIC: &str = "plastic_elongation";
const SLIP: &str = "grout_slip";
const REFERENCE: &str = "installed_at";
const GROUT: &str = "grout_force";
/// Energy dissipated by each bolt (J), stored at its first segment.
const DISSIPATED: &str = "dissipated_by_bolt";

/// The bars of a block; those of a set are all in grout, or none.
#[derive(Debug)]
enum Bars {
    Tied(Box<TiedBars>),
    Grouted(Vec<GroutedBar>),
}

/// Element block of some bolts of a set.
///
/// History fields have one entry per segment, by the number of the segment in the set.
pub(super) struct BoltBlock {
    name: Arc<str>,
    /// Mesh indices of the nodes of the host elements, in rising order.
    nodes: Vec<u32>,
    /// Index of each bolt in the set.
    bolts: Vec<usize>,
    /// Segments of each bolt, among those of the block.
    segments: Vec<Range<u32>>,
    /// Number of each segment in the set, and mesh index of its host element.
    numbers: Vec<u32>,
    hosts: Vec<u32>,
    interpolation: Interpolation,
    /// Axial displacements (m) of the segment ends at installation.
    reference: Vec<[f64; 2]>,
    bars: Bars,
    workspace: Workspace,
}

/// Reusable buffers.
#[derive(Debug, Default)]
struct Workspace {
    sums: Vec<Quad<f64>>,
    /// Axial nodal values.
    line: Vec<f64>,
    /// Axial nodal forces.
    axial: Vec<f64>,
    /// Elongations of the segments.
    elongations: Vec<f64>,
    bolt: BoltWorkspace,
}

impl BoltBlock {
    /// From a set and the indices of the bolts, in rising order.
    pub(super) fn new(set: &BoltSet, bolts: &[usize]) -> Self {
        let of_block = || bolts.iter().map(|&bolt| &set.bolts[bolt]);
        let points = of_block().flat_map(|bolt| &bolt.segments);
        let hosts = points.flat_map(|segment| &segment.ends);
        let mut nodes: Vec<u32> = hosts.flat_map(|end| end.nodes.iter().copied()).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let index = |node: u32| nodes.partition_point(|&other| other < node) as u32;
        let all = || of_block().flat_map(|bolt| &bolt.segments);
        let mut end = 0;
        let segments = of_block().map(|bolt| {
            end += bolt.segments.len() as u32;
            end - bolt.segments.len() as u32..end
        });
        let numbers = of_block().flat_map(|bolt| {
            let count = bolt.segments.len() as u32;
            bolt.first_segment..bolt.first_segment + count
        });
        let parameters = &set.parameters;
        let bars = match parameters.grout {
            None => {
                let lengths = all().map(|segment| segment.length);
                Bars::Tied(Box::new(TiedBars::new(parameters, lengths, bolts.len())))
            }
            Some(grout) => {
                let lengths = |bolt: &Embedded| bolt.segments.iter().map(|s| s.length).collect();
                let bars = of_block().map(|bolt| Bar::new(parameters, grout, lengths(bolt)));
                Bars::Grouted(bars.map(GroutedBar::new).collect())
            }
        };
        Self {
            name: set.name.clone(),
            bolts: bolts.to_vec(),
            segments: segments.collect(),
            numbers: numbers.collect(),
            hosts: all().map(|segment| segment.element).collect(),
            interpolation: Interpolation::new(of_block(), index),
            reference: vec![[0.0; 2]; all().count()],
            bars,
            nodes,
            workspace: Workspace::default(),
        }
    }

    /// The fault of a bolt at a segment of the block.
    fn fault(&self, segment: usize, failure: &str) -> ElementFault {
        let ends = |own: &Range<u32>| own.end as usize <= segment;
        let bolt = self.bolts[self.segments.partition_point(ends)];
        let reason = failure.replace("{}", &bolt.to_string());
        ElementFault::new(self.hosts[segment], reason)
    }

    /// Computes the axial nodal forces (N) of all bolts, `axial` of the workspace, for displacements (m) of the block's nodes.
    #[inline(always)]
    fn resist(&mut self, displacement: impl Fn(u32) -> Vec3) -> Result<(), ElementFault> {
        let Workspace {
            line,
            axial,
            elongations,
            bolt,
            ..
        } = &mut self.workspace;
        let interpolation = &self.interpolation;
        interpolation.read(displacement, line);
        let found = match &mut self.bars {
            Bars::Tied(bars) => {
                interpolation.elongations(line, elongations);
                let found = bars.stretch(&self.segments, elongations);
                interpolation.tensions(bars.forces(), axial);
                found.map_err(|segment| (segment, NOT_FINITE))
            }
            Bars::Grouted(bars) => {
                clear(axial, line.len());
                let mut each = bars.iter_mut().zip(&self.segments);
                each.try_for_each(|(bar, own)| {
                    let own = own.start as usize..own.end as usize;
                    let reference = &self.reference[own.clone()];
                    let ends = |k| interpolation.ends(k, line);
                    bar.resist(own.clone().map(ends), reference, bolt)
                        .map_err(|(segment, failure)| (own.start + segment, failure))?;
                    for (segment, forces) in own.zip(&bolt.forces) {
                        interpolation.add_ends(segment, forces, axial);
                    }
                    Ok(())
                })
            }
        };
        found.map_err(|(segment, failure)| self.fault(segment, failure))
    }

    /// Calls `show` with each column of the elastic axial stiffness (N/m) of a bolt: the index among its nodal `values`, and
    /// the axial forces at all of these per unit axial displacement of that one.
    fn each_column(&self, bolt: usize, values: &[usize], mut show: impl FnMut(usize, &[f64])) {
        let mut unit = vec![0.0; self.interpolation.value_count()];
        let mut axial = unit.clone();
        let mut workspace = BoltWorkspace::default();
        for (own, &value) in values.iter().enumerate() {
            unit[value] = 1.0;
            self.add_elastic(bolt, &unit, &mut axial, &mut workspace);
            unit[value] = 0.0;
            let of_value = |&value: &usize| core::mem::take(&mut axial[value]);
            let column: Vec<f64> = values.iter().map(of_value).collect();
            show(own, &column);
        }
    }

    /// The nodal values of a bolt.
    fn values_of(&self, bolt: usize) -> Vec<usize> {
        let own = &self.segments[bolt];
        self.interpolation
            .values_of(own.start as usize..own.end as usize)
    }

    /// Adds the elastic axial nodal forces (N) of a bolt for axial nodal displacements (m).
    fn add_elastic(
        &self,
        bolt: usize,
        line: &[f64],
        axial: &mut [f64],
        workspace: &mut BoltWorkspace,
    ) {
        let own = &self.segments[bolt];
        let own = own.start as usize..own.end as usize;
        match &self.bars {
            Bars::Tied(bars) => {
                for segment in own {
                    let elongation = self.interpolation.elongation(segment, line);
                    let force = bars.elastic(segment, elongation);
                    self.interpolation.add_tension(segment, force, axial);
                }
            }
            Bars::Grouted(bars) => {
                let BoltWorkspace {
                    moved,
                    forces,
                    balance,
                } = workspace;
                moved.clear();
                moved.extend(own.clone().map(|k| self.interpolation.ends(k, line)));
                clear(forces, own.len());
                bars[bolt].bar.elastic(moved, forces, balance);
                for (segment, forces) in own.zip(forces) {
                    self.interpolation.add_ends(segment, forces, axial);
                }
            }
        }
    }

    /// A history field with `points` values per segment.
    fn field(&self, name: &str, points: usize, values: Vec<f64>) -> HistoryField {
        let name = format!("{}/{name}", self.name);
        HistoryField::new(name, self.numbers.clone(), points, values)
    }

    /// The values of a history field for the segments of this block, in its order, from those of the set; none if a
    /// segment is missing.
    fn found(&self, fields: &[HistoryField], name: &str, points: usize) -> Option<Vec<f64>> {
        let name = format!("{}/{name}", self.name);
        let field = fields.iter().find(|field| field.name == name)?;
        if field.points != points || field.values.len() != points * field.elements.len() {
            return None;
        }
        let mut values = Vec::with_capacity(points * self.numbers.len());
        for number in &self.numbers {
            let start = points * field.elements.binary_search(number).ok()?;
            values.extend_from_slice(&field.values[start..start + points]);
        }
        Some(values)
    }

    /// Installs the bolts at the reference displacement (m) of their segment ends.
    fn install(&mut self) {
        match &mut self.bars {
            Bars::Tied(bars) => bars.install(&self.reference),
            Bars::Grouted(bars) => {
                for bar in bars {
                    bar.committed = bar.bar.installed();
                    bar.pending = false;
                }
            }
        }
    }
}

fn put(sums: &[Quad<f64>], out: &mut [Quad<f32>]) {
    for (out, sum) in out.iter_mut().zip(sums) {
        *out = Quad::from_vector(&sum.to_vector());
    }
}

impl ElementBlock for BoltBlock {
    fn label(&self) -> &str {
        &self.name
    }
    fn elements(&self) -> &[u32] {
        &[]
    }
    fn nodes(&self) -> &[u32] {
        &self.nodes
    }
    fn forces(&mut self, context: &BlockContext, out: NodalViewMut) -> Result<(), ElementFault> {
        // Wider instructions where the processor has them; they change no bit.
        pulp::Arch::new().dispatch(Pass {
            block: self,
            displacement: context.displacement,
            out,
        })
    }
    fn add_mass(&self, _out: &mut [f64]) {}
    fn frequency_bounds(&self) -> Vec<FrequencyBound> {
        Vec::new()
    }
    fn stiffness(&self) -> Option<&dyn BlockStiffness> {
        Some(self)
    }
    fn output(&self) -> Option<&dyn BlockOutput> {
        Some(self)
    }
    fn stateful(&self) -> Option<&dyn StatefulBlock> {
        Some(self)
    }
    fn stateful_mut(&mut self) -> Option<&mut dyn StatefulBlock> {
        Some(self)
    }
}

impl BlockStiffness for BoltBlock {
    fn apply(&self, _operator: Operator, x: NodalView, out: NodalViewMut) {
        let mut workspace = Workspace::default();
        let Workspace {
            sums,
            line,
            axial,
            elongations,
            bolt,
        } = &mut workspace;
        let interpolation = &self.interpolation;
        interpolation.read(|index| x.vector(index as usize), line);
        if let Bars::Tied(bars) = &self.bars {
            interpolation.elongations(line, elongations);
            for (segment, value) in elongations.iter_mut().take(self.numbers.len()).enumerate() {
                *value = bars.elastic(segment, *value);
            }
            interpolation.tensions(elongations, axial);
        } else {
            clear(axial, line.len());
            for index in 0..self.bolts.len() {
                self.add_elastic(index, line, axial, bolt);
            }
        }
        match out {
            NodalViewMut::F64(out) => interpolation.write(axial, out),
            NodalViewMut::F32(out) => {
                clear(sums, self.nodes.len());
                interpolation.write(axial, sums);
                put(sums, out);
            }
        }
    }
    fn diagonal(&self, _operator: Operator, out: &mut [Mat3]) {
        for bolt in 0..self.bolts.len() {
            let direction = self.interpolation.direction(bolt);
            let across = direction * direction.transpose();
            let values = self.values_of(bolt);
            self.each_column(bolt, &values, |own, forces| {
                let node = self.interpolation.node(values[own]);
                out[node as usize] += across * forces[own];
            });
        }
    }
    fn each_matrix(&self, _operator: Operator, show: &mut dyn FnMut(&[u32], &[f64])) {
        for bolt in 0..self.bolts.len() {
            let values = self.values_of(bolt);
            let indices = values.iter().map(|&value| self.interpolation.node(value));
            let indices: Vec<u32> = indices.collect();
            let size = 3 * indices.len();
            let mut matrix = vec![0.0; size * size];
            let direction = self.interpolation.direction(bolt);
            let across = direction * direction.transpose();
            self.each_column(bolt, &values, |own, forces| {
                let first = 3 * own;
                for (row, force) in forces.iter().enumerate() {
                    for i in 0..3 {
                        for j in 0..3 {
                            matrix[(3 * row + i) * size + first + j] = across[(i, j)] * force;
                        }
                    }
                }
            });
            show(&indices, &matrix);
        }
    }
}

impl BlockOutput for BoltBlock {
    fn energy(&self, _context: &BlockContext) -> BlockEnergy {
        let mut energy = BlockEnergy::default();
        match &self.bars {
            Bars::Tied(bars) => {
                for (own, dissipated) in self.segments.iter().zip(&bars.present().dissipated) {
                    energy.elastic += bars.stored(own.start as usize..own.end as usize);
                    energy.plastic += dissipated;
                }
            }
            Bars::Grouted(bars) => {
                for bar in bars {
                    energy.elastic += bar.bar.stored(bar.present());
                    energy.plastic += bar.present().dissipated;
                }
            }
        }
        energy
    }
}

impl StatefulBlock for BoltBlock {
    fn commit(&mut self) {
        match &mut self.bars {
            Bars::Tied(bars) => bars.commit(),
            Bars::Grouted(bars) => {
                for bar in bars.iter_mut().filter(|bar| bar.pending) {
                    core::mem::swap(&mut bar.committed, &mut bar.trial);
                    bar.pending = false;
                }
            }
        }
    }
    fn history(&self) -> Vec<HistoryField> {
        let count = self.numbers.len();
        let (mut force, mut plastic) = (Vec::with_capacity(count), Vec::with_capacity(count));
        let (mut slip, mut grout) = (vec![0.0; 2 * count], vec![0.0; 2 * count]);
        let mut dissipated = vec![0.0; count];
        let firsts = self.segments.iter().map(|own| own.start as usize);
        match &self.bars {
            Bars::Tied(bars) => {
                force.extend(&bars.committed.force);
                plastic.extend(&bars.committed.plastic);
                for (first, spent) in firsts.zip(&bars.committed.dissipated) {
                    dissipated[first] = *spent;
                }
            }
            Bars::Grouted(bars) => {
                (slip, grout) = (Vec::new(), Vec::new());
                for (first, bar) in firsts.zip(bars) {
                    force.extend(&bar.committed.force);
                    plastic.extend(&bar.committed.plastic);
                    slip.extend(bar.committed.slip.iter().flatten());
                    grout.extend(bar.committed.grout.iter().flatten());
                    dissipated[first] = bar.committed.dissipated;
                }
            }
        }
        let reference = self.reference.iter().flatten().copied().collect();
        vec![
            self.field(AXIAL_FORCE, 1, force),
            self.field(PLASTIC, 1, plastic),
            self.field(SLIP, 2, slip),
            self.field(REFERENCE, 2, reference),
            self.field(GROUT, 2, grout),
            self.field(DISSIPATED, 1, dissipated),
        ]
    }
    fn set_history(&mut self, fields: &[HistoryField]) {
        let one = |name| self.found(fields, name, 1);
        let two = |name| Some(pairs(&self.found(fields, name, 2)?));
        let (Some(force), Some(plastic), Some(slip), Some(reference)) =
            (one(AXIAL_FORCE), one(PLASTIC), two(SLIP), two(REFERENCE))
        else {
            return;
        };
        let (Some(grout), Some(dissipated)) = (two(GROUT), one(DISSIPATED)) else {
            return;
        };
        self.reference = reference;
        self.install();
        let segments = self.segments.iter();
        let segments = segments.map(|own| own.start as usize..own.end as usize);
        match &mut self.bars {
            Bars::Tied(bars) => {
                let spent = segments.map(|own| dissipated[own.start]);
                bars.committed.dissipated = spent.collect();
                (bars.committed.force, bars.committed.plastic) = (force, plastic);
            }
            Bars::Grouted(bars) => {
                for (bar, own) in bars.iter_mut().zip(segments) {
                    bar.committed.force.copy_from_slice(&force[own.clone()]);
                    bar.committed.plastic.copy_from_slice(&plastic[own.clone()]);
                    bar.committed.slip.copy_from_slice(&slip[own.clone()]);
                    bar.committed.grout.copy_from_slice(&grout[own.clone()]);
                    bar.committed.dissipated = dissipated[own.start];
                }
            }
        }
    }
    fn set_active(&mut self, _active: &[bool]) {}
    fn set_reference_displacement(&mut self, displacement: NodalView) {
        let mut line = Vec::new();
        let value = |index: u32| displacement.vector(index as usize);
        self.interpolation.read(value, &mut line);
        for (segment, reference) in self.reference.iter_mut().enumerate() {
            *reference = self.interpolation.ends(segment, &line);
        }
        self.install();
    }
    fn set_initial_stress(&mut self, _stress: &[Stress]) {}
}

/// Two values of each segment.
fn pairs(values: &[f64]) -> Vec<[f64; 2]> {
    let values = values.chunks_exact(2);
    values.map(|pair| [pair[0], pair[1]]).collect()
}

/// Evaluation of the forces of a block. A type of its own, since a closure passed to the dispatch may end up in a
/// function that is not compiled for the processor at hand.
struct Pass<'a> {
    block: &'a mut BoltBlock,
    displacement: NodalView<'a>,
    out: NodalViewMut<'a>,
}

impl pulp::NullaryFnOnce for Pass<'_> {
    type Output = Result<(), ElementFault>;
    #[inline(always)]
    fn call(self) -> Self::Output {
        let Self {
            block,
            displacement,
            out,
        } = self;
        match displacement {
            NodalView::F64(u) => block.resist(
                #[inline(always)]
                |node| u[node as usize].to_vector(),
            ),
            NodalView::F32(u) => block.resist(
                #[inline(always)]
                |node| u[node as usize].to_vector(),
            ),
        }?;
        let axial = &block.workspace.axial;
        match out {
            NodalViewMut::F64(out) => block.interpolation.write(axial, out),
            NodalViewMut::F32(out) => {
                let sums = &mut block.workspace.sums;
                clear(sums, block.nodes.len());
                block.interpolation.write(axial, sums);
                put(sums, out);
            }
        }
        Ok(())
    }
}
