//! The scene's box without the structure.

use std::time::Duration;

use powerhouse::engine::observe::{HistoryTable, Motion};
use powerhouse::engine::{Ended, Progress};
use powerhouse::material::LinearElastic;
use powerhouse::model::{
    ElasticMedium, ElementKind, FieldMotion, FieldSampler, Mesh, ModelError, Vec3,
};
use powerhouse::{
    Damping, Error, Kernel, Material, OutputPlan, Part, ProgressHook, RunHooks, Scene, Simulation,
    TimeStep,
};

use crate::StudyError;
use crate::cost::Clock;
use crate::resolution::longest_edge_of;
use crate::sides::bring_over;

/// How well the free field of a scene is reproduced.
#[derive(Clone, Debug, PartialEq)]
pub struct FreeFieldReport {
    /// Cells of the box along x, y and z.
    pub cells: [usize; 3],
    /// The step that was taken (s).
    pub step: f64,
    /// The time that was computed (s).
    pub window: f64,
    /// Errors at the points that were compared.
    pub points: Vec<PointError>,
    /// The same with the damping of the part behind the absorbing faces and its rim, if it is damped;
    /// no limit applies to them, since the free field has no damping.
    pub damped: Option<Vec<PointError>>,
}

impl FreeFieldReport {
    /// The largest relative error of velocity at any point: strain, which loads a structure, goes
    /// with velocity. Not a number if one of them is none.
    pub fn largest(&self) -> f64 {
        let errors = self.points.iter().map(|point| point.velocity);
        // What is not a number stands above all numbers in this order, whatever its sign.
        let errors = errors.map(f64::abs);
        errors.max_by(f64::total_cmp).unwrap_or(f64::NAN)
    }
    /// Accepts an error up to a limit, and none that is not a number.
    ///
    /// # Errors
    /// [`StudyError::TooCoarse`].
    pub fn require(&self, limit: f64) -> Result<(), StudyError> {
        match self.largest() {
            error if error <= limit => Ok(()),
            error => Err(StudyError::TooCoarse { error, limit }),
        }
    }
}

/// The error at one point, over the whole window: `sqrt(sum |u_h - u|^2 / sum |u|^2)`.
#[derive(Clone, Debug, PartialEq)]
pub struct PointError {
    /// What the point is.
    pub name: &'static str,
    /// Where it is (m).
    pub position: Vec3,
    /// Relative error of displacement.
    pub displacement: f64,
    /// Relative error of velocity, in which high frequencies weigh more.
    pub velocity: f64,
}

/// The box of a scene without the structure, ready to be compared with the field that comes in.
///
/// The box is that of the scene's mesh, of the medium behind its absorbing faces, cut into equal
/// bricks as long as the longest edge of the parts there. It has the scene's boundary, field and
/// kernel, a region around which the field enters within the box around the scene's, no damping and no structure; supports and periodic pairs that hold the whole of a side
/// hold it here too. It is compared at the middle of its top and at the scatterer.
pub struct FreeFieldCheck {
    elastic: Scene,
    damped: Option<Scene>,
    cells: [usize; 3],
    sampler: Box<dyn FieldSampler>,
    points: [(&'static str, Vec3); 2],
    start: f64,
    window: f64,
}

/// The window ends when this share of the motion at the surface is over.
const SHARE_OF_MOTION: f64 = 0.9;
/// Instants at which the field is looked at to find the window.
const INSTANTS: usize = 4000;
/// The least share of the box's own stable step. A scene whose small elements force a smaller step
/// has the same error within a few per cent, since that of the step falls with its square.
const LEAST_SHARE_OF_STEP: f64 = 0.25;

impl FreeFieldCheck {
    /// The box of a scene.
    ///
    /// # Errors
    /// A scene without a field, one whose field does not move the points, or one with a side of its
    /// box, but the top, that neither absorbs nor is held.
    pub fn of(scene: &Scene) -> Result<Self, StudyError> {
        let (Some(field), Some(boundary)) = (scene.field(), scene.boundary()) else {
            return Err(StudyError::NoField);
        };
        let (low, high) = scene.mesh().bounding_box();
        let cells = cells(scene)?;
        let mut mesh = Mesh::box_of_hexes(low, high, cells, "ground").map_err(Error::from)?;
        let held = bring_over(scene, &mut mesh)?;
        let centre = scene.scatterer()?;
        let middle = (low + high) / 2.0;
        let points = [
            ("surface", Vec3::new(middle.x, middle.y, high.z)),
            ("structure", centre.sup(&low).inf(&high)),
        ];
        let sampler = field
            .prepare(&points.map(|(_, point)| point))
            .map_err(Error::from)?;
        let (start, duration) = (scene.start_time(), scene.duration());
        let window =
            window(sampler.as_ref(), start, duration).ok_or(StudyError::StillField { duration })?;
        // At every step.
        let mut output = OutputPlan::default().with_every(f64::MIN_POSITIVE);
        let wanted = Motion {
            acceleration: false,
            ..Motion::ALL
        };
        for (name, point) in points {
            output = output.history(name, point, wanted);
        }
        let mut boundary = boundary.clone();
        boundary.scatterer = Some(centre);
        let region = boundary.region.take();
        let region = region.and_then(|region| region_in(scene.mesh(), &region, &mesh));
        let compose = |part: Part, region: Option<Vec<u32>>| {
            let mut boundary = boundary.clone();
            boundary.region = region;
            let mut composed = Scene::new(format!("{}: free field", scene.title()), mesh.clone())
                .part(part)
                .with_shared_field(field.clone())
                .with_boundary(boundary)
                .with_start_time(start)
                .with_initial_motion(scene.initial_motion())
                .with_duration(window)
                .with_output(output.clone())
                .allow_magnitudes();
            for support in &held.supports {
                composed = composed.support(support.clone());
            }
            for pairs in &held.periodic {
                composed = composed.with_periodic_pairs(pairs.clone());
            }
            if let Some(threads) = scene.threads() {
                composed = composed.with_threads(threads);
            }
            composed
        };
        let (part, damped) = ground(scene, field.medium())?;
        Ok(Self {
            // Damped ground is no layer for an elastic field.
            damped: damped.map(|part| compose(part, None)),
            elastic: compose(part, region),
            cells,
            sampler,
            points,
            start,
            window,
        })
    }

    /// Computes the box with the step of the scene (s), as far as that is between a quarter of
    /// the box's own stable step and the whole of it.
    ///
    /// # Errors
    /// What ended the run before its time, [`StudyError::Interrupted`] among it.
    pub fn run(self, scene_step: f64, hooks: RunHooks) -> Result<FreeFieldReport, StudyError> {
        let Self {
            elastic, damped, ..
        } = self;
        let compare = Comparison {
            sampler: self.sampler,
            points: self.points,
        };
        let (stop, mut progress) = (hooks.stop.clone(), hooks.progress);
        let mut first = RunHooks::default();
        first.progress = progress
            .as_mut()
            .map(|tell| -> ProgressHook { Box::new(|now: Progress| tell(now)) });
        (first.stop, first.snapshots) = (hooks.stop, hooks.snapshots);
        (first.stages, first.observers) = (hooks.stages, hooks.observers);
        let (points, step, time) = compare.run(elastic, scene_step, first)?;
        let damped = match damped {
            None => None,
            Some(damped) => {
                let mut hooks = RunHooks::default();
                (hooks.progress, hooks.stop) = (progress, stop);
                Some(compare.run(damped, scene_step, hooks)?.0)
            }
        };
        Ok(FreeFieldReport {
            cells: self.cells,
            step,
            window: time - self.start,
            points,
            damped,
        })
    }

    /// The time that will be computed (s).
    pub fn window(&self) -> f64 {
        self.window
    }

    /// The wall time that [`run`](Self::run) would take, from some steps that are computed.
    ///
    /// # Errors
    /// What would keep it from running.
    pub fn wall_time(self, scene_step: f64) -> Result<Duration, StudyError> {
        let mut sum = Duration::ZERO;
        for scene in [Some(self.elastic), self.damped].into_iter().flatten() {
            let (mut simulation, step) = prepare(scene, scene_step)?;
            let of_step = Clock::of(&mut simulation)?.time_of_step()?;
            sum += of_step.mul_f64(self.window / step);
        }
        Ok(sum)
    }
}

/// A box with the step that it takes for one of the scene (s).
fn prepare(scene: Scene, scene_step: f64) -> Result<(Simulation, f64), StudyError> {
    let mut simulation = scene.prepare()?;
    let own = simulation.stable_step()?.step;
    let step = scene_step.clamp(LEAST_SHARE_OF_STEP * own, own);
    simulation.set_step(TimeStep::Seconds(step));
    Ok((simulation, step))
}

/// Runs boxes and compares them with the field.
struct Comparison {
    sampler: Box<dyn FieldSampler>,
    points: [(&'static str, Vec3); 2],
}

impl Comparison {
    /// The errors of a box, its step and the time of its end (s).
    fn run(
        &self,
        scene: Scene,
        scene_step: f64,
        hooks: RunHooks,
    ) -> Result<(Vec<PointError>, f64, f64), StudyError> {
        let (simulation, step) = prepare(scene, scene_step)?;
        let results = simulation.run(hooks)?;
        if results.run.ended == Ended::Stopped {
            return Err(StudyError::Interrupted);
        }
        let mut sums = [[0.0_f64; 4]; 2];
        for (row, &time) in results.histories.times.iter().enumerate() {
            let mut exact = [FieldMotion::default(); 2];
            self.sampler.add_motion(time, &mut exact);
            for (point, exact) in exact.iter().enumerate() {
                let name = self.points[point].0;
                let add = |sums: &mut [f64], letter: char, exact: &Vec3| {
                    let found = vector(&results.histories, name, letter, row);
                    sums[0] += (found - exact).norm_squared();
                    sums[1] += exact.norm_squared();
                };
                let (displacement, velocity) = sums[point].split_at_mut(2);
                add(displacement, 'u', &exact.displacement);
                add(velocity, 'v', &exact.velocity);
            }
        }
        let errors = self.points.iter().zip(sums);
        let errors = errors.map(|(&(name, position), [d, d_exact, v, v_exact])| PointError {
            name,
            position,
            displacement: (d / d_exact).sqrt(),
            velocity: (v / v_exact).sqrt(),
        });
        Ok((errors.collect(), step, results.run.time))
    }
}

/// A vector of a history at a row, without numbers if it was not recorded.
fn vector(table: &HistoryTable, name: &str, letter: char, row: usize) -> Vec3 {
    let component = |axis: char| {
        let column = table.column(&format!("{name}.{letter}{axis}"));
        column.map_or(f64::NAN, |column| column.values[row])
    };
    Vec3::new(component('x'), component('y'), component('z'))
}

/// Nearly cubic cells as long as the longest edge of the parts behind the absorbing faces.
fn cells(scene: &Scene) -> Result<[usize; 3], StudyError> {
    let mut longest = 0.0_f64;
    for part in scene.parts_behind_boundary()? {
        longest = longest.max(longest_edge_of(scene.mesh(), &scene.parts()[part].set)?);
    }
    let (low, high) = scene.mesh().bounding_box();
    let extent = high - low;
    // No shorter than that, but for rounding and what is thinner than one cell.
    Ok(core::array::from_fn(|axis| {
        ((extent[axis] / longest + 1e-6).floor() as usize).max(1)
    }))
}

/// The bricks of a box within that of a region of another mesh, but for those that touch its sides and
/// bottom; nothing if there are none.
fn region_in(mesh: &Mesh, region: &[u32], ground: &Mesh) -> Option<Vec<u32>> {
    let positions = |nodes: Vec<u32>| {
        nodes
            .into_iter()
            .map(|node| mesh.positions()[node as usize])
    };
    let infinite = Vec3::repeat(f64::INFINITY);
    let nodes = positions(mesh.nodes_of_elements(region));
    let (low, high) = nodes.fold((infinite, -infinite), |(low, high), x| {
        (low.inf(&x), high.sup(&x))
    });
    let faces = ["left", "right", "front", "back", "bottom"];
    let sides = faces.iter().filter_map(|face| ground.facet_set(face).ok());
    let on_sides = ground.nodes_of_facets(&sides.flatten().copied().collect::<Vec<_>>());
    let touches = |node: &u32| on_sides.binary_search(node).is_ok();
    let mut within = ground.elements_in_box(&low, &high);
    within.retain(|&element| !ground.nodes_of(element).iter().any(touches));
    (!within.is_empty()).then_some(within)
}

/// The part behind the absorbing faces, elastic and undamped, with its kernel if that takes bricks;
/// and the same with its damping and rim, if it is damped.
fn ground(scene: &Scene, medium: ElasticMedium) -> Result<(Part, Option<Part>), StudyError> {
    let part = Part::new("ground", Material::from(LinearElastic::new(medium)));
    let behind: Vec<&Part> = scene
        .parts_behind_boundary()?
        .iter()
        .map(|&index| &scene.parts()[index])
        .collect();
    let kernel = behind.first().and_then(|part| part.kernel.clone());
    let part = match kernel.filter(|kernel: &Kernel| kernel.kind() == ElementKind::Hex8) {
        Some(kernel) => part.with_kernel(kernel),
        None => part,
    };
    let damped = behind.iter().find(|part| part.damping != Damping::None);
    let damped = damped.map(|of| {
        let damped = part.clone().with_damping(of.damping.clone());
        match of.rim {
            Some(width) => damped.with_rim(width),
            None => damped,
        }
    });
    Ok((part, damped))
}

/// The time in which most of the motion at the first point is over (s); nothing if a point does
/// not move in it.
fn window(sampler: &dyn FieldSampler, start: f64, duration: f64) -> Option<f64> {
    let interval = duration / INSTANTS as f64;
    let mut sums = vec![0.0; sampler.len()];
    let mut history = Vec::with_capacity(INSTANTS);
    for instant in 1..=INSTANTS {
        let mut motion = vec![FieldMotion::default(); sampler.len()];
        sampler.add_motion(start + instant as f64 * interval, &mut motion);
        for (sum, motion) in sums.iter_mut().zip(&motion) {
            *sum += motion.velocity.norm_squared();
        }
        history.push(sums.clone());
    }
    let reached = |sums: &Vec<f64>| sums[0] >= SHARE_OF_MOTION * history[INSTANTS - 1][0];
    let reached = history.iter().position(reached)?;
    let moves = history[reached].iter().all(|sum| *sum > 0.0);
    moves.then_some((reached + 1) as f64 * interval)
}

impl From<ModelError> for StudyError {
    fn from(error: ModelError) -> Self {
        Self::Scene(error.into())
    }
}
