//! What a run will cost.

use std::sync::Arc;
use std::time::Duration;

use powerhouse::engine::Precision;
use powerhouse::engine::observe::Motion;
use powerhouse::model::{HistoryKind, Mesh};
use powerhouse::{Error, LawMemory, OutputPlan, Scene, Simulation};

use crate::{StaticCost, StudyError};

/// What a run will cost.
#[derive(Clone, Debug, PartialEq)]
pub struct Cost {
    /// Steps.
    pub steps: u64,
    /// Length of a step (s).
    pub step: f64,
    /// Wall time of the steps and of what is recorded, from some steps that were timed; the writing
    /// of files aside.
    pub wall_time: Duration,
    /// What the stages before the run cost, if there are any.
    pub stages: Option<StaticCost>,
    /// Wall time of the free-field check before the run, if the scene asks for one.
    pub self_check: Option<Duration>,
    /// Memory (bytes), within a third; tables of waves past the critical angle aside.
    pub memory: u64,
    /// Files (bytes), at most.
    pub output: u64,
}

/// Steps taken before the clock starts, and twice as many are timed at least; more until the clock is
/// sure, or this share of the run is through.
const WARM_UP: u64 = 5;
const CLOCK: Duration = Duration::from_millis(400);
const SHARE_OF_RUN: f64 = 0.05;
/// Turns in which the steps of two simulations are timed, the time that one of them lasts, and the share of
/// the run that it takes at most, unless that is too short for a clock.
const TURNS: u64 = 7;
const TURN: Duration = Duration::from_millis(60);
const SHARE_OF_TURN: f64 = 0.01;
const SHORTEST_TURN: Duration = Duration::from_millis(40);
/// A turn of fewer steps tells nothing.
const LEAST_TURN: u64 = 4;

/// A simulation whose steps are timed, none of them after the end of its run.
pub(crate) struct Clock<'a> {
    simulation: &'a mut Simulation,
    /// Steps of the run, and those that are left.
    steps: u64,
    left: u64,
}

impl<'a> Clock<'a> {
    /// The clock of a simulation that has not moved yet.
    pub(crate) fn of(simulation: &'a mut Simulation) -> Result<Self, StudyError> {
        let steps = (simulation.duration() / simulation.step()?).ceil() as u64 + 1;
        Ok(Self {
            simulation,
            steps,
            left: steps,
        })
    }

    /// Steps that can still be timed at once: the first and the last of some are taken beside.
    fn possible(&self) -> u64 {
        self.left.saturating_sub(2)
    }

    /// The time of some steps, as many as are left.
    fn time(&mut self, count: u64) -> Result<Duration, StudyError> {
        let count = count.min(self.possible());
        if count == 0 {
            return Ok(Duration::ZERO);
        }
        self.left -= count + 2;
        Ok(self.simulation.time_steps(count)?)
    }

    /// The time of one step, from some that are computed; zero for a run of fewer than three steps.
    pub(crate) fn time_of_step(&mut self) -> Result<Duration, StudyError> {
        if self.possible() > 4 * WARM_UP {
            self.time(WARM_UP)?;
        }
        let (mut count, mut of_step) = (2 * WARM_UP, Duration::ZERO);
        while self.possible() > 0 {
            let timed = count.min(self.possible());
            let taken = self.time(timed)?;
            of_step = taken.div_f64(timed as f64);
            let through = (self.steps - self.left) as f64;
            if taken >= CLOCK || through >= SHARE_OF_RUN * self.steps as f64 {
                break;
            }
            count *= 2;
        }
        Ok(of_step)
    }

    /// The time of a step over that of another simulation, one of whose steps takes `of_step`: both take
    /// their turns, and the middle one of the ratios of neighbouring turns counts, so that what else the
    /// machine does falls on both alike or on neither. Nothing if their runs have too few steps.
    pub(crate) fn ratio_to(
        &mut self,
        other: &mut Clock<'_>,
        of_step: Duration,
    ) -> Result<Option<f64>, StudyError> {
        let of_step = of_step.as_secs_f64().max(1e-9);
        let wanted = TURN.as_secs_f64() / of_step;
        let most = SHARE_OF_TURN * self.steps.min(other.steps) as f64;
        let most = most.max(SHORTEST_TURN.as_secs_f64() / of_step);
        let room = self.left.min(other.left) / (TURNS + 1);
        let count = wanted.min(most.max(LEAST_TURN as f64)).ceil() as u64;
        let count = count.min(room.saturating_sub(2));
        if count < LEAST_TURN {
            return Ok(None);
        }
        let warm = count.min(WARM_UP);
        self.time(warm)?;
        other.time(warm)?;
        let mut ratios = Vec::new();
        for _ in 0..TURNS {
            let own = self.time(count)?.as_secs_f64();
            let others = other.time(count)?.as_secs_f64();
            ratios.push(own / others);
        }
        ratios.sort_by(f64::total_cmp);
        let middle = ratios[ratios.len() / 2];
        Ok(middle.is_finite().then_some(middle))
    }
}

/// Bytes per node: position, displacement, velocity and forces (32 each), mass, numbers.
const NODE_BYTES: f64 = 260.0;
/// Bytes per element: geometry, connectivity, masses, tags and sets.
const ELEMENT_BYTES: [(Precision, f64); 3] = [
    (Precision::F64, 700.0),
    (Precision::Mixed, 450.0),
    (Precision::F32, 350.0),
];
/// Bytes of a history variable of a law: the committed one, and that of the last forces.
const KEPT_CORRECTIONS_BYTES: [(Precision, f64); 3] = [
    (Precision::F64, 16.0),
    (Precision::Mixed, 8.0),
    (Precision::F32, 8.0),
];
/// Bytes per element for the greatest of an amount and its time, and for flags: they are copied while
/// they are written and drawn.
const AMOUNT_BYTES: f64 = 32.0;
const FLAGS_BYTES: f64 = 16.0;
/// Bytes per node, element and history variable of a model that comes to rest: beside nodes and elements
/// as they are stepped, vectors of the solver and of eight earlier corrections, diagonals, the state from
/// stage to stage, and what building the next model takes; fitted to the example `cost_model`.
const STATIC_NODE_BYTES: f64 = 2500.0;
const STATIC_ELEMENT_BYTES: f64 = 600.0;
const STATIC_KEPT_CORRECTIONS_BYTES: f64 = 24.0;
/// Bytes per absorbing node: its matrices, and its constants of three waves.
const BOUNDARY_NODE_BYTES: f64 = 600.0;
/// Bytes per pair of a joint: geometry, record, matrices, and two copies of what is recorded.
const PAIR_BYTES: f64 = 1500.0;
/// Columns against time of every joint, and at most of a part of one.
const OF_EVERY_JOINT: f64 = 8.0;
const OF_A_JOINT: f64 = 11.0;
/// Bytes per corner of a facet for its place and its cell, and fields there: in a snapshot, at the end.
const FACET_BYTES: f64 = 40.0;
const JOINT_FIELDS: [f64; 2] = [12.0, 18.0];
/// Bytes per number recorded: it is copied while it is written and drawn.
const RECORDED_BYTES: f64 = 32.0;
/// Bytes of the canvas on which a picture is drawn.
const CANVAS_BYTES: f64 = 32e6;
/// Bytes of a program that does nothing yet.
const BASE_BYTES: f64 = 12e6;

/// What the costs of a scene depend on, taken from it before it is consumed.
pub(crate) struct Account {
    mesh: Arc<Mesh>,
    plan: OutputPlan,
    duration: f64,
    precision: Precision,
    absorbing_nodes: usize,
    joints: Joints,
    laws: Laws,
}

/// The size of the files of a scene's run, once its step is known.
pub struct OutputSize(Account);

impl OutputSize {
    /// Takes from a scene what it depends on.
    ///
    /// # Errors
    /// A set or a face of the scene that is at fault.
    pub fn of(scene: &Scene) -> Result<Self, StudyError> {
        Account::of(scene).map(Self)
    }
    /// Bytes, at most, of a run in steps of a length (s).
    pub fn bytes(&self, step: f64) -> u64 {
        self.0.output((self.0.duration / step).ceil() as u64 + 1)
    }
}

/// History variables of the laws of a scene.
#[derive(Clone, Copy, Debug, Default)]
struct Laws {
    /// Numbers at points.
    numbers: f64,
    /// Elements that show something of it.
    elements: f64,
    /// Variables that are shown: all, amounts and flags.
    variables: f64,
    amounts: f64,
    flags: f64,
}

impl Laws {
    fn of(memory: &LawMemory) -> Self {
        let of_kind = |kind| {
            let variables = memory.variables.iter();
            variables.filter(|v| v.kind == kind).count() as f64
        };
        Self {
            numbers: memory.numbers as f64,
            elements: memory.elements as f64,
            variables: memory.variables.len() as f64,
            amounts: of_kind(HistoryKind::Amount),
            flags: of_kind(HistoryKind::Flags),
        }
    }
}

/// Sizes of all joints of a scene together.
#[derive(Clone, Copy, Debug, Default)]
struct Joints {
    joints: f64,
    pairs: f64,
    /// Corners of facets, each a point in files.
    corners: f64,
}

impl Joints {
    fn of(scene: &Scene) -> Self {
        let mut sum = Self::default();
        for (_, surface, _) in scene.joints() {
            sum.joints += 1.0;
            sum.pairs += surface.pairs.len() as f64;
            let corners: usize = surface.facets.iter().map(|facet| facet.nodes.len()).sum();
            sum.corners += corners as f64;
        }
        sum
    }
}

impl Account {
    pub(crate) fn of(scene: &Scene) -> Result<Self, StudyError> {
        let mesh = scene.mesh().clone();
        let mut absorbing = Vec::new();
        for (_, facets) in scene.absorbing_facets().map_err(Error::from)? {
            absorbing.extend(mesh.nodes_of_facets(facets));
        }
        absorbing.sort_unstable();
        absorbing.dedup();
        Ok(Self {
            mesh,
            plan: scene.output().clone(),
            duration: scene.duration(),
            precision: scene.precision(),
            absorbing_nodes: absorbing.len(),
            joints: Joints::of(scene),
            laws: Laws::of(&scene.law_memory()?),
        })
    }

    fn rows(&self, steps: u64) -> Rows {
        Rows {
            duration: self.duration,
            steps: steps as f64,
        }
    }

    /// The program, the mesh and the model that moves (bytes).
    fn bytes_of_model(&self) -> f64 {
        let (nodes, elements) = self.counts();
        let of_precision = |table: [(Precision, f64); 3]| {
            let known = table.iter().find(|(p, _)| *p == self.precision);
            known.map_or(table[0].1, |(_, bytes)| *bytes)
        };
        let element = of_precision(ELEMENT_BYTES);
        let Laws {
            numbers,
            elements: remembering,
            amounts,
            flags,
            ..
        } = self.laws;
        BASE_BYTES
            + NODE_BYTES * nodes
            + element * elements
            + of_precision(KEPT_CORRECTIONS_BYTES) * numbers
            + (AMOUNT_BYTES * amounts + FLAGS_BYTES * flags) * remembering
            + BOUNDARY_NODE_BYTES * self.absorbing_nodes as f64
            + PAIR_BYTES * self.joints.pairs
    }

    /// Memory of a run of so many steps (bytes).
    pub(crate) fn memory(&self, steps: u64) -> u64 {
        let (nodes, elements) = self.counts();
        let mut bytes = self.bytes_of_model() + RECORDED_BYTES * self.numbers(steps);
        if let Some(envelope) = &self.plan.envelope {
            // A peak and its time, for each quantity; two quantities of stress.
            let stress = if envelope.stress { 32.0 } else { 0.0 };
            bytes += 16.0 * vectors(envelope.motion) * nodes + stress * elements + CANVAS_BYTES;
        }
        bytes as u64
    }

    /// Memory while stages are gone through (bytes): the model that will move, and one that rests.
    pub(crate) fn memory_of_stages(&self) -> u64 {
        let (nodes, elements) = self.counts();
        let resting = STATIC_NODE_BYTES * nodes
            + STATIC_ELEMENT_BYTES * elements
            + STATIC_KEPT_CORRECTIONS_BYTES * self.laws.numbers
            + PAIR_BYTES * self.joints.pairs;
        (self.bytes_of_model() + resting) as u64
    }

    /// Size of the files of a run of so many steps (bytes).
    pub(crate) fn output(&self, steps: u64) -> u64 {
        let (nodes, elements) = self.counts();
        let rows = self.rows(steps);
        let mut bytes = SUMMARY_BYTES + (CSV_BYTES + PLOT_BYTES) * self.numbers(steps);
        // The facets of joints at the end.
        bytes += (FACET_BYTES + 4.0 * JOINT_FIELDS[1]) * self.joints.corners;
        // What does not change is in every file too: positions, numbers, connectivity, sets.
        let sets = self.mesh.element_sets().len() as f64;
        let fixed = 16.0 * nodes + elements * (20.0 + sets / 8.0);
        if self.laws.variables > 0.0 {
            bytes += fixed + (8.0 * self.laws.amounts + 4.0 * self.laws.flags) * elements;
            bytes += PICTURE_BYTES * self.laws.amounts;
        }
        if let Some(snapshots) = &self.plan.snapshots {
            let state = if self.plan.state.snapshots {
                4.0 * self.laws.variables
            } else {
                0.0
            };
            let stress = if snapshots.fields.stress { 24.0 } else { 0.0 };
            let motion = 12.0 * vectors(snapshots.fields.motion);
            let facets = (FACET_BYTES + 4.0 * JOINT_FIELDS[0]) * self.joints.corners;
            bytes += (fixed + motion * nodes + (stress + state) * elements + facets)
                * rows.at(snapshots.every);
        }
        if let Some(envelope) = &self.plan.envelope {
            let (stress, pictures) = if envelope.stress {
                (16.0, 2.0)
            } else {
                (0.0, 0.0)
            };
            bytes += fixed + 8.0 * vectors(envelope.motion) * nodes + stress * elements;
            bytes += PICTURE_BYTES * (vectors(envelope.motion) + pictures);
        }
        // What is beyond all bounds becomes the largest number.
        bytes as u64
    }

    /// Numbers in tables against time, times among them.
    fn numbers(&self, steps: u64) -> f64 {
        let rows = self.rows(steps);
        let watched =
            OF_EVERY_JOINT * self.joints.joints + OF_A_JOINT * self.plan.joints.len() as f64;
        let state = self.laws.variables * self.plan.state.places.len() as f64;
        let times = if watched + state > 0.0 { 1.0 } else { 0.0 };
        numbers(&self.plan, &rows) + (watched + state + times) * rows.at(self.plan.every)
    }

    /// Nodes and elements.
    fn counts(&self) -> (f64, f64) {
        let mesh = &self.mesh;
        (mesh.node_count() as f64, mesh.element_count() as f64)
    }
}

/// How often something is looked at that has a cadence.
struct Rows {
    duration: f64,
    steps: f64,
}

impl Rows {
    /// At most once a step, and at the first and last one.
    fn at(&self, every: f64) -> f64 {
        ((self.duration / every).ceil() + 2.0).min(self.steps)
    }
}

fn vectors(motion: Motion) -> f64 {
    let wanted = [motion.displacement, motion.velocity, motion.acceleration];
    wanted.iter().filter(|wanted| **wanted).count() as f64
}

/// Columns of the energy ledger, of a relative displacement, of a cut and of a stress.
const ENERGY_COLUMNS: f64 = 19.0;
const RELATIVE_COLUMNS: f64 = 4.0;
const CUT_COLUMNS: f64 = 9.0;
const STRESS_COLUMNS: f64 = 9.0;

/// Numbers in tables against time, times among them.
fn numbers(plan: &OutputPlan, rows: &Rows) -> f64 {
    let histories = plan.histories.iter().map(|wish| 3.0 * vectors(wish.motion));
    let columns = histories.sum::<f64>()
        + STRESS_COLUMNS * plan.stresses.len() as f64
        + RELATIVE_COLUMNS * plan.relative.len() as f64
        + CUT_COLUMNS * plan.cuts.len() as f64;
    let energies = plan
        .energies
        .map_or(0.0, |every| (1.0 + ENERGY_COLUMNS) * rows.at(every));
    let tables = if columns > 0.0 { columns + 2.0 } else { 0.0 };
    tables * rows.at(plan.every) + energies
}

/// Bytes of a number in a CSV file, and as a point of a plot.
const CSV_BYTES: f64 = 23.0;
const PLOT_BYTES: f64 = 16.0;
/// Bytes of a picture, and of the summary with the scene.
const PICTURE_BYTES: f64 = 4e5;
const SUMMARY_BYTES: f64 = 4e4;

#[cfg(test)]
mod tests {
    use powerhouse::boundary::ViscousSpring;
    use powerhouse::engine::SolidKernel;
    use powerhouse::material::{
        DampingBand, ElastoPlastic, LinearElastic, MohrCoulomb, ReferenceFrequency,
        RelaxationSpectrum, media, presets,
    };
    use powerhouse::model::Vec3;
    use powerhouse::{Boundary, Damping, Material, Part};

    use super::*;

    /// The memory of a law is counted as it is held: two copies of every number at every point, relaxation
    /// mechanisms among them, none in rims; a single number format halves it.
    #[test]
    fn costs_count_what_laws_remember() {
        let memory = |part: Part, precision| {
            let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(1.0), [4; 3], "rock");
            let faces = ["left", "right", "front", "back", "bottom"];
            let scene = Scene::new("cube", mesh.unwrap())
                .part(part.with_kernel(SolidKernel::Hex8Full))
                .with_boundary(Boundary::new(ViscousSpring::default(), faces))
                .with_precision(precision);
            Account::of(&scene).unwrap().memory(100) as f64
        };
        let medium = media::ROCK;
        let elastic = || Part::new("rock", Material::from(LinearElastic::new(medium)));
        let rock = ElastoPlastic::new(MohrCoulomb::new(presets::PAPER_ROCK).unwrap());
        let yields = || Part::new("rock", Material::from(rock));
        let band = DampingBand {
            ratio: 0.02,
            lowest: 1.0,
            highest: 10.0,
            mechanisms: 2,
        };
        let flat = Damping::Flat {
            spectrum: RelaxationSpectrum::fit(band).unwrap(),
            reference: ReferenceFrequency::Centre,
        };
        let points = 8.0 * 64.0;
        // The greatest of one amount with its time, and one number of flags, in each element.
        let shown = (32.0 + 16.0) * 64.0;
        for (part, numbers, shown) in [
            (yields(), 8.0 * points, shown),
            (elastic().with_damping(flat.clone()), 12.0 * points, 0.0),
            (yields().with_damping(flat.clone()), 20.0 * points, shown),
            // Two of four layers along three axes touch the faces, one along the vertical.
            (
                yields().with_damping(flat).with_rim(0.0),
                20.0 * 8.0 * 12.0,
                48.0 * 12.0,
            ),
        ] {
            for (precision, bytes) in [(Precision::F64, 8.0), (Precision::Mixed, 4.0)] {
                let held = memory(part.clone(), precision) - memory(elastic(), precision);
                let expected = 2.0 * bytes * numbers + shown;
                assert!(
                    (held - expected).abs() < 2.0,
                    "{held} instead of {expected}"
                );
            }
        }
    }
}
