//! Predicted cost of a run: wall time, memory, output.

use std::time::Duration;

use powerhouse::engine::Precision;
use powerhouse::model::{DeviceError, ElementKind, Mesh, RunError, StepProfile};
use powerhouse::wavefield::LayeredWave;
use powerhouse::{Error, OutputScale, Scene, Simulation};

use crate::{StaticCost, StudyError};

/// Predicted cost of a run: steps, wall time, memory and size of its files.
#[derive(Clone, Debug, PartialEq)]
pub struct Cost {
    /// Number of time steps of the dynamic run.
    pub steps: u64,
    /// Time step of the dynamic run (s).
    pub step: f64,
    /// Wall time of the dynamic run with its recording, extrapolated from some timed steps; stages, free-field check and
    /// writing of files excluded.
    pub wall_time: Duration,
    /// Wall time of the parts of some of the timed steps; `None` for a run that is too short for it.
    pub profile: Option<StepProfile>,
    /// Whether the number of iterations in a step grows as laws and joints change, as in bays of an endless row: the timed steps had one each, and the run
    /// takes up to [`LONGER`](Self::LONGER) times as long.
    pub iterates: bool,
    /// Predicted cost of the construction stages before the run; `None` without stages.
    pub stages: Option<StaticCost>,
    /// Predicted wall time of the free-field check before the run; `None` if the scene does not request one.
    pub self_check: Option<Duration>,
    /// Predicted peak memory of the dynamic run (bytes), within a third; tables of waves in layers included, those of waves past the
    /// critical angle of a half-space excluded.
    pub memory: u64,
    /// Memory of the mesh alone (bytes), part of it.
    pub memory_of_mesh: u64,
    /// Predicted memory before the run (bytes), while a second model in double precision measures the error of the number
    /// format; `None` where it is not measured. Without so much memory it is not measured, and the run goes on.
    pub memory_of_format: Option<u64>,
    /// Upper bound of the size of the result files (bytes).
    pub output: u64,
}

impl Cost {
    /// Wall time of the run of a bay that cracks and slips over that of as many steps before anything does (1).
    pub const LONGER: f64 = 3.0;
}

/// Steps before the timing, of which at least twice as many are timed; least timed duration, and share of the run
/// after which the timing ends anyway.
const WARM_UP: u64 = 5;
const CLOCK: Duration = Duration::from_millis(400);
const SHARE_OF_RUN: f64 = 0.05;
/// Alternations in which the steps of two simulations are timed, duration of one of them, and its greatest share
/// of the run, unless that is shorter than can be timed.
const TURNS: u64 = 7;
const TURN: Duration = Duration::from_millis(60);
const SHARE_OF_TURN: f64 = 0.01;
const SHORTEST_TURN: Duration = Duration::from_millis(40);
/// Least number of steps of a profile, its wall time, and its greatest share of the run.
const LEAST_PROFILE: u64 = 50;
const PROFILE: Duration = Duration::from_millis(300);
const SHARE_OF_PROFILE: f64 = 0.01;
/// Least number of steps of an alternation.
const LEAST_TURN: u64 = 4;

/// Timer of the steps of a simulation, up to the end of its run.
pub(crate) struct StepTimer<'a> {
    simulation: &'a mut Simulation,
    /// Steps of the run, and those that are left.
    steps: u64,
    left: u64,
}

impl<'a> StepTimer<'a> {
    /// The timer of a simulation before its first step.
    pub(crate) fn of(simulation: &'a mut Simulation) -> Result<Self, StudyError> {
        let steps = (simulation.duration() / simulation.step()?).ceil() as u64 + 1;
        Ok(Self {
            simulation,
            steps,
            left: steps,
        })
    }

    /// Steps that can still be timed in a row; one step before and one after them is not timed.
    fn possible(&self) -> u64 {
        self.left.saturating_sub(2)
    }

    /// The wall time of `count` steps, or of as many as are left.
    fn time(&mut self, count: u64) -> Result<Duration, StudyError> {
        let count = count.min(self.possible());
        if count == 0 {
            return Ok(Duration::ZERO);
        }
        self.left -= count + 2;
        Ok(self.simulation.time_steps(count)?)
    }

    /// The mean wall time of a step, from some computed steps; zero for a run of fewer than three steps.
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

    /// The wall time of the parts of steps, one of which takes about `of_step`; `None` for a run of which they would be
    /// more than a hundredth, and of engines that do not measure it.
    pub(crate) fn profile(&mut self, of_step: Duration) -> Result<Option<StepProfile>, StudyError> {
        let wanted = PROFILE.as_secs_f64() / of_step.as_secs_f64().max(1e-9);
        let most = (SHARE_OF_PROFILE * self.steps as f64) as u64;
        let count = (wanted as u64).max(LEAST_PROFILE).min(most).min(self.left);
        if count < LEAST_PROFILE {
            return Ok(None);
        }
        match self.simulation.profile_steps(count) {
            Ok(profile) => {
                self.left -= count;
                Ok(Some(profile))
            }
            // An engine that measures no parts of steps refuses before the first one.
            Err(Error::Run(RunError::Device(DeviceError::Refused { .. }))) => Ok(None),
            Err(error) => Err(error.into()),
        }
    }

    /// The wall time of a step over that of another simulation, one of whose steps takes about `of_step`; `None` if
    /// the runs have too few steps.
    ///
    /// Both are timed alternately and the median of the ratios is taken, so that other load of the machine affects
    /// both equally.
    pub(crate) fn ratio_to(
        &mut self,
        other: &mut StepTimer<'_>,
        of_step: Duration,
    ) -> Result<Option<f64>, StudyError> {
        let of_step = of_step.as_secs_f64().max(1e-9);
        let wanted = TURN.as_secs_f64() / of_step;
        let most = SHARE_OF_TURN * self.steps.min(other.steps) as f64;
        let most = most.max(SHORTEST_TURN.as_secs_f64() / of_step);
        let available = self.left.min(other.left) / (TURNS + 1);
        let count = wanted.min(most.max(LEAST_TURN as f64)).ceil() as u64;
        let count = count.min(available.saturating_sub(2));
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
/// Bytes of a mesh per node, element, and node of an element.
const MESH_BYTES: [f64; 3] = [32.0, 17.0, 4.0];
/// Bytes per node of a brick, and of another element: geometry, connectivity, masses, tags and sets. Bricks that are
/// parallelepipeds take two thirds, others a sixth more; fitted to the example `cost_model`.
const ELEMENT_NODE_BYTES: [(Precision, [f64; 2]); 3] = [
    (Precision::F64, [60.0, 85.0]),
    (Precision::Mixed, [52.0, 78.0]),
    (Precision::F32, [43.0, 78.0]),
];
/// Bytes per history variable of a law and integration point: committed and trial value.
const HISTORY_BYTES: [(Precision, f64); 3] = [
    (Precision::F64, 16.0),
    (Precision::Mixed, 8.0),
    (Precision::F32, 8.0),
];
/// Bytes per element of a law with history variables in steps that are shown: its stress and energies, and the displacement of a node.
const SHOWN_BYTES: f64 = 96.0;
/// Bytes per node, element and history variable of a static solution: beside those of a dynamic model the vectors of
/// the solver and of eight earlier corrections, diagonals, the state between stages, and the assembly of the next
/// model; fitted to the example `cost_model`.
const STATIC_NODE_BYTES: f64 = 2500.0;
const STATIC_ELEMENT_BYTES: f64 = 600.0;
const STATIC_HISTORY_BYTES: f64 = 24.0;
/// Bytes per node of an element of a bay, each of which has nodes of its own, of linear bodies and of others: their motion, places and forces in each iteration,
/// and their share of the skew matrix. Measured on boxes of 8,000 and 26,000 bricks: 646 to 654, and 922 to 1,020 with yield or flat damping.
const BAY_NODE_BYTES: [f64; 2] = [650.0, 950.0];
/// Bytes per absorbing node: its matrices, and the constants of three waves.
const BOUNDARY_NODE_BYTES: f64 = 600.0;
/// Bytes per node pair of a joint: geometry, state, matrices, and two copies of the recorded values.
const PAIR_BYTES: f64 = 1500.0;
/// Bytes of the summary with the scene.
const SUMMARY_BYTES: f64 = 4e4;
/// Bytes of the program without a model.
const BASE_BYTES: f64 = 16e6;

/// Model of the memory and output size of a scene's run, taken from the scene before it is consumed.
pub(crate) struct CostModel {
    scale: OutputScale,
    precision: Precision,
    absorbing_nodes: usize,
    /// Whether the body is a bay of an endless row.
    is_bay: bool,
    /// Node pairs of all joints.
    pairs: usize,
    /// Waves in layered ground, whose tables grow while the scene is prepared.
    layered: Vec<LayeredWave>,
}

/// Estimate of the size of the result files of a scene's run as a function of the time step.
pub struct OutputSize(CostModel);

impl OutputSize {
    /// Prepares the estimate for a scene.
    ///
    /// # Errors
    /// An invalid set or face of the scene.
    pub fn of(scene: &Scene) -> Result<Self, StudyError> {
        CostModel::of(scene).map(Self)
    }
    /// Upper bound of the size (bytes) of the result files for a time step (s).
    pub fn bytes(&self, step: f64) -> u64 {
        self.0
            .output((self.0.scale.duration / step).ceil() as u64 + 1)
    }
}

impl CostModel {
    pub(crate) fn of(scene: &Scene) -> Result<Self, StudyError> {
        let mesh = scene.mesh();
        let mut absorbing = Vec::new();
        for (_, facets) in scene.absorbing_facets().map_err(Error::from)? {
            absorbing.extend(mesh.nodes_of_facets(facets));
        }
        absorbing.sort_unstable();
        absorbing.dedup();
        let joints = scene.joints();
        Ok(Self {
            scale: scene.output_scale()?,
            precision: scene.precision(),
            absorbing_nodes: absorbing.len(),
            is_bay: scene.is_bay(),
            pairs: joints.map(|(_, surface, _)| surface.pairs.len()).sum(),
            layered: scene.layered_waves().to_vec(),
        })
    }

    /// Memory of program, mesh and dynamic model in a number format (bytes).
    fn bytes_of_model(&self, precision: Precision) -> f64 {
        let [nodes, _] = self.scale.counts();
        let mesh = &self.scale.mesh;
        let [of_brick, of_other] = of_precision(ELEMENT_NODE_BYTES, precision);
        let all = element_nodes(mesh);
        let elements = 0..mesh.element_count() as u32;
        let is_brick = |&element: &u32| mesh.kind(element) == ElementKind::Hex8;
        let of_bay = if self.is_bay {
            BAY_NODE_BYTES[usize::from(self.scale.laws.with_history > 0)]
        } else {
            0.0
        };
        let of_bricks = 8 * elements.filter(is_brick).count();
        BASE_BYTES
            + NODE_BYTES * nodes
            + of_brick * of_bricks as f64
            + of_other * (all - of_bricks) as f64
            + of_precision(HISTORY_BYTES, precision) * self.scale.laws.numbers as f64
            + SHOWN_BYTES * self.scale.laws.with_history as f64
            + BOUNDARY_NODE_BYTES * self.absorbing_nodes as f64
            + of_bay * all as f64
            + PAIR_BYTES * self.pairs as f64
    }

    /// Whether steps are solved by iterations whose number depends on what laws and joints do.
    pub(crate) fn iterates(&self) -> bool {
        self.is_bay && (self.pairs > 0 || self.scale.laws.with_history > 0)
    }

    /// Memory of the waves in layered ground with the tables that they have now (bytes).
    fn bytes_of_layered(&self) -> f64 {
        let bytes = self.layered.iter().map(|wave| wave.report().bytes as f64);
        bytes.sum()
    }

    /// Memory of a second model in double precision, with a mesh of its own (bytes).
    pub(crate) fn memory_in_double(&self) -> u64 {
        self.bytes_of_model(Precision::F64) as u64
    }

    /// Memory of a second model in double precision beside the mesh of the first (bytes).
    pub(crate) fn memory_beside_mesh(&self) -> u64 {
        self.memory_in_double() + self.memory_of_mesh()
    }

    /// Memory of a mesh (bytes).
    pub(crate) fn memory_of_mesh(&self) -> u64 {
        let [nodes, elements] = self.scale.counts();
        let counts = [nodes, elements, element_nodes(&self.scale.mesh) as f64];
        let of_mesh: f64 = (MESH_BYTES.iter().zip(counts))
            .map(|(bytes, count)| bytes * count)
            .sum();
        of_mesh as u64
    }

    /// Memory of a run with a number of steps (bytes).
    pub(crate) fn memory(&self, steps: u64) -> u64 {
        let of_output = self.scale.price(steps).memory;
        (self.bytes_of_model(self.precision) + self.bytes_of_layered() + of_output) as u64
    }

    /// Memory during the construction stages (bytes): that of the dynamic and of a static model.
    pub(crate) fn memory_of_stages(&self) -> u64 {
        let [nodes, elements] = self.scale.counts();
        let of_statics = STATIC_NODE_BYTES * nodes
            + STATIC_ELEMENT_BYTES * elements
            + STATIC_HISTORY_BYTES * self.scale.laws.numbers as f64
            + PAIR_BYTES * self.pairs as f64;
        (self.bytes_of_model(self.precision) + self.bytes_of_layered() + of_statics) as u64
    }

    /// Size of the files of a run with a number of steps (bytes).
    pub(crate) fn output(&self, steps: u64) -> u64 {
        // The conversion saturates at the largest number.
        (SUMMARY_BYTES + self.scale.price(steps).files) as u64
    }
}

/// Entry of a table for a number format.
fn of_precision<T: Copy>(table: [(Precision, T); 3], precision: Precision) -> T {
    let known = table.iter().find(|(other, _)| *other == precision);
    known.map_or(table[0].1, |(_, entry)| *entry)
}

/// Length of the list of nodes of all elements.
pub(crate) fn element_nodes(mesh: &Mesh) -> usize {
    let elements = 0..mesh.element_count() as u32;
    elements.map(|element| mesh.nodes_of(element).len()).sum()
}

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

    /// The memory of history variables is two copies of each at every integration point, relaxation mechanisms
    /// included, and none in rims; single precision halves it.
    #[test]
    fn costs_include_the_history_variables_of_laws() {
        let memory = |part: Part, precision| {
            let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(1.0), [4; 3], "rock");
            let faces = ["left", "right", "front", "back", "bottom"];
            let scene = Scene::new("cube", mesh.unwrap())
                .part(part.with_kernel(SolidKernel::Hex8Full))
                .with_boundary(Boundary::new(ViscousSpring::default(), faces))
                .with_precision(precision);
            CostModel::of(&scene).unwrap().memory(100) as f64
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
        // The envelope of one amount with its time, and one value of flags, in each element; stress, energies and displacement
        // of steps that are shown.
        let shown = (32.0 + 16.0 + SHOWN_BYTES) * 64.0;
        let of_steps = SHOWN_BYTES * 64.0;
        for (part, numbers, shown) in [
            (yields(), 8.0 * points, shown),
            (
                elastic().with_damping(flat.clone()),
                12.0 * points,
                of_steps,
            ),
            (yields().with_damping(flat.clone()), 20.0 * points, shown),
            // Two of four layers along three axes touch the faces, one along the vertical.
            (
                yields().with_damping(flat).with_rim(0.0),
                20.0 * 8.0 * 12.0,
                (48.0 + SHOWN_BYTES) * 12.0,
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
