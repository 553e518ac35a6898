//! Free-field check: the scene's box without the structure.

use std::time::Duration;

use powerhouse::engine::observe::{HistoryTable, Motion};
use powerhouse::engine::{Ended, Progress};
use powerhouse::material::LinearElastic;
use powerhouse::model::{
    ElasticMedium, ElementKind, FieldMotion, FieldSampler, IncidentField, Mesh, ModelError, Vec3,
};
use powerhouse::wavefield::LayerDamping;
use powerhouse::{
    Damping, Error, Kernel, Material, OutputPlan, Part, ProgressHook, RunHooks, Scene, Simulation,
    TimeStep,
};

use crate::StudyError;
use crate::cost::StepTimer;
use crate::sides::transfer_supports;

/// Errors of the computed free field of a scene: box without structure against the incident field.
#[derive(Clone, Debug, PartialEq)]
pub struct FreeFieldReport {
    /// Numbers of elements of the box along x, y and z.
    pub cells: [usize; 3],
    /// Time step of the check (s).
    pub step: f64,
    /// Computed duration (s): from the start of the run until 90 % of the squared velocity of the run at the surface have
    /// passed.
    pub window: f64,
    /// Errors at the compared points in the box without damping.
    pub points: Vec<PointError>,
    /// Errors with the damping and the rim of the part behind the absorbing faces; `None` if it is undamped. No limit
    /// applies to them, since the free field has no damping.
    pub damped: Option<Vec<PointError>>,
}

impl FreeFieldReport {
    /// Largest relative error of velocity among the points; NaN if one of them is NaN. Velocity is proportional to
    /// strain, which loads a structure.
    pub fn largest(&self) -> f64 {
        let errors = self.points.iter().map(|point| point.velocity);
        // `total_cmp` orders NaN above all numbers, whatever its sign.
        let errors = errors.map(f64::abs);
        errors.max_by(f64::total_cmp).unwrap_or(f64::NAN)
    }
    /// Checks that the largest error is at most a limit; NaN fails.
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

/// Relative L2 errors `sqrt(sum |u_h - u|^2 / sum |u|^2)` of the motion at one point over the computed duration.
#[derive(Clone, Debug, PartialEq)]
pub struct PointError {
    /// Name of the point: `surface` or `structure`.
    pub name: &'static str,
    /// Position of the point in the undeformed mesh (m).
    pub position: Vec3,
    /// Relative error of displacement (1).
    pub displacement: f64,
    /// Relative error of velocity (1), in which high frequencies have more weight.
    pub velocity: f64,
}

/// Free-field check of a scene: a run of its box without the structure, compared with the incident field.
///
/// The box has the extent of the scene's mesh and the medium behind its absorbing faces, with equal hexahedra as long
/// as the longest edge of the parts there; of layered ground every layer has its medium and its own rows of elements. It has the scene's boundary, field and kernel, the region around which the
/// field enters, and neither damping nor structure. Supports and periodic pairs of whole sides are applied to it, too.
/// The motion is compared at the middle of the top and at the scatterer.
pub struct FreeFieldCheck {
    elastic: Scene,
    damped: Option<Scene>,
    cells: [usize; 3],
    sampler: Box<dyn FieldSampler>,
    points: [(&'static str, Vec3); 2],
    start: f64,
    window: f64,
}

/// Share of the squared velocity at the surface that the computed duration contains.
const SHARE_OF_MOTION: f64 = 0.9;
/// Instants at which the field is sampled to find that duration.
const INSTANTS: usize = 4000;
/// Least time step over the box's own stable step. With a smaller step, forced by small elements of the scene, the
/// error is the same within a few per cent, since that of the step falls with its square.
const LEAST_SHARE_OF_STEP: f64 = 0.25;

impl FreeFieldCheck {
    /// Builds the free-field box of a scene.
    ///
    /// # Errors
    /// A scene without an incident field, with a field without stress, with a field that does not move the points, or with a side of its box, other
    /// than the top, that neither absorbs nor is supported.
    pub fn of(scene: &Scene) -> Result<Self, StudyError> {
        let (Some(field), Some(boundary)) = (scene.field(), scene.boundary()) else {
            return Err(StudyError::NoField);
        };
        if !field.carries_stress() {
            let field = field.name().into();
            return Err(StudyError::FieldWithoutStress { field });
        }
        let (low, high) = extent(scene);
        let strata = strata(scene, &**field)?;
        let (cells, mut mesh) = ground_box(scene, &strata)?;
        let held = transfer_supports(scene, &mut mesh)?;
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
        boundary.through.clear();
        let region = boundary.region.take();
        let region = region.and_then(|region| region_in(scene.mesh(), &region, &mesh));
        let compose = |parts: Vec<Part>, region: Option<Vec<u32>>| {
            let mut boundary = boundary.clone();
            boundary.region = region;
            let mut composed = Scene::new(format!("{}: free field", scene.title()), mesh.clone())
                .with_engine(scene.engine().clone())
                .with_shared_field(field.clone())
                .with_boundary(boundary)
                .with_start_time(start)
                .with_initial_motion(scene.initial_motion())
                .with_duration(window)
                .with_output(output.clone())
                .allow_magnitudes();
            for part in parts {
                composed = composed.part(part);
            }
            for support in &held.supports {
                composed = composed.support(support.clone());
            }
            for pairs in &held.periodic {
                composed = composed.with_periodic_pairs(pairs.clone());
            }
            if let Some(pairs) = &held.delayed {
                composed = composed.with_delayed_sides(pairs.clone());
                // Their slowness is that of the waves of which the field is the sum.
                composed.field.clone_from(&scene.field);
            }
            if let Some(threads) = scene.threads() {
                composed = composed.with_threads(threads);
            }
            composed
        };
        let (parts, damped) = ground(scene, &strata)?;
        Ok(Self {
            // An elastic field cannot enter through a layer of damped ground.
            damped: damped.map(|parts| compose(parts, None)),
            elastic: compose(parts, region),
            cells,
            sampler,
            points,
            start,
            window,
        })
    }

    /// Runs the box with the time step of the scene (s), limited to between a quarter and the whole of the box's own
    /// stable step.
    ///
    /// # Errors
    /// Any error of the run; [`StudyError::Interrupted`] if it was cancelled.
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
            .map(|hook| -> ProgressHook { Box::new(|now: Progress| hook(now)) });
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

    /// Duration (s) that [`run`](Self::run) computes, at most that of the scene.
    pub fn window(&self) -> f64 {
        self.window
    }

    /// Predicts the wall time of [`run`](Self::run) from some computed steps, for the time step of the scene (s).
    ///
    /// # Errors
    /// Any error that would prevent the run.
    pub fn wall_time(self, scene_step: f64) -> Result<Duration, StudyError> {
        let mut sum = Duration::ZERO;
        for scene in [Some(self.elastic), self.damped].into_iter().flatten() {
            let (mut simulation, step) = prepare(scene, scene_step)?;
            let of_step = StepTimer::of(&mut simulation)?.time_of_step()?;
            sum += of_step.mul_f64(self.window / step);
        }
        Ok(sum)
    }
}

/// Prepares a box, with its time step (s) for that of the scene.
fn prepare(scene: Scene, scene_step: f64) -> Result<(Simulation, f64), StudyError> {
    let mut simulation = scene.prepare()?;
    let own = simulation.stable_step()?.step;
    let step = scene_step.clamp(LEAST_SHARE_OF_STEP * own, own);
    simulation.set_step(TimeStep::Seconds(step));
    Ok((simulation, step))
}

/// Comparison of boxes with the incident field.
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
        for (row, &time) in results.histories().times.iter().enumerate() {
            let mut exact = [FieldMotion::default(); 2];
            self.sampler.add_motion(time, &mut exact);
            for (point, exact) in exact.iter().enumerate() {
                let name = self.points[point].0;
                let add = |sums: &mut [f64], letter: char, exact: &Vec3| {
                    let found = vector(results.histories(), name, letter, row);
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

/// A vector of a history at a row; NaN if it was not recorded.
fn vector(table: &HistoryTable, name: &str, letter: char, row: usize) -> Vec3 {
    let component = |axis: char| {
        let column = table.column(&format!("{name}.{letter}{axis}"));
        column.map_or(f64::NAN, |column| column.values[row])
    };
    Vec3::new(component('x'), component('y'), component('z'))
}

/// Layer of the ground within the box of a scene, with the parts behind the absorbing faces in its medium.
struct Stratum {
    /// Element set of the box.
    set: String,
    medium: ElasticMedium,
    /// Lowest and highest z (m).
    heights: [f64; 2],
    /// Indices of the parts; of ground of one medium all parts behind the absorbing faces.
    parts: Vec<usize>,
}

/// Lowest and highest corner of a scene's mesh without what rises above the surface of the ground around it.
fn extent(scene: &Scene) -> (Vec3, Vec3) {
    let (low, high) = scene.mesh().bounding_box();
    let top = scene
        .surface()
        .map_or(high.z, |surface| high.z.min(surface));
    (low, Vec3::new(high.x, high.y, top))
}

/// Layers of the field from the bottom of the scene's mesh up to its top.
fn strata(scene: &Scene, field: &dyn IncidentField) -> Result<Vec<Stratum>, StudyError> {
    let (low, high) = extent(scene);
    let behind = scene.parts_behind_boundary()?;
    let mut ends = vec![low.z];
    let within = |z: &&f64| **z > low.z && **z < high.z;
    ends.extend(field.interfaces().iter().rev().filter(within));
    ends.push(high.z);
    if ends.len() == 2 && field.interfaces().is_empty() {
        return Ok(vec![Stratum {
            set: GROUND.into(),
            medium: field.medium(),
            heights: [low.z, high.z],
            parts: behind,
        }]);
    }
    let ends_count = ends.len();
    let layers = ends.windows(2).enumerate().map(|(index, ends)| {
        let middle = Vec3::new(low.x, low.y, (ends[0] + ends[1]) / 2.0);
        let medium = field.medium_at(&middle);
        let is_of = |part: &&usize| scene.parts()[**part].material.medium() == medium;
        Stratum {
            set: match ends_count {
                2 => GROUND.into(),
                _ => format!("{GROUND} {}", index + 1),
            },
            medium,
            heights: [ends[0], ends[1]],
            parts: behind.iter().filter(is_of).copied().collect(),
        }
    });
    Ok(layers.collect())
}

/// Element set of the box, and beginning of those of its layers.
const GROUND: &str = "ground";

/// Box of hexahedra of a scene's extent, and its numbers of elements: in every layer nearly as long as the longest edge
/// of the parts there, across the layers as long as the shortest of these.
fn ground_box(scene: &Scene, strata: &[Stratum]) -> Result<([usize; 3], Mesh), StudyError> {
    let resolution = scene.resolution()?;
    let longest = strata.iter().map(|stratum| {
        let edges = stratum.parts.iter();
        let edges = edges.map(|&part| resolution[part].longest_edge);
        edges.fold(0.0, f64::max)
    });
    let longest: Vec<f64> = longest.collect();
    // A layer of which no part is behind the faces lies between two planes of the mesh.
    let known = longest.iter().copied().filter(|edge| *edge > 0.0);
    let shortest = known.fold(f64::INFINITY, f64::min);
    let (low, high) = extent(scene);
    let extent = high - low;
    // Never shorter than that edge, except for rounding and boxes thinner than one element.
    let count = |length: f64, edge: f64| ((length / edge + 1e-6).floor() as usize).max(1);
    let heights = strata
        .iter()
        .map(|stratum| stratum.heights[1] - stratum.heights[0]);
    let of_layers = heights.zip(&longest).map(|(height, edge)| {
        if *edge > 0.0 {
            count(height, *edge)
        } else {
            count(height, shortest)
        }
    });
    let of_layers: Vec<usize> = of_layers.collect();
    let cells = [
        count(extent.x, shortest),
        count(extent.y, shortest),
        of_layers.iter().sum(),
    ];
    let mut mesh = Mesh::box_of_hexes(low, high, cells, GROUND).map_err(Error::from)?;
    if strata.len() > 1 {
        let row = extent.z / cells[2] as f64;
        let height = |z: f64| {
            let mut from = (z - low.z) / row;
            for (stratum, rows) in strata.iter().zip(&of_layers) {
                let rows = *rows as f64;
                let [bottom, top] = stratum.heights;
                if from <= rows + 0.5 {
                    // Planes of rows have whole numbers, and interfaces keep their heights.
                    let share = (from.round() / rows).min(1.0);
                    return bottom + share * (top - bottom);
                }
                from -= rows;
            }
            high.z
        };
        mesh = mesh
            .map_positions(|point| Vec3::new(point.x, point.y, height(point.z)))
            .map_err(Error::from)?;
        for stratum in strata {
            let [bottom, top] = stratum.heights;
            let lies_in = |element: &u32| (bottom..top).contains(&mesh.centroid(*element).z);
            let elements = (0..mesh.element_count() as u32).filter(lies_in).collect();
            mesh.set_element_set(&stratum.set, elements)
                .map_err(Error::from)?;
        }
    }
    Ok((cells, mesh))
}

/// The elements of a box within the bounding box of a region of another mesh, except those at its sides and bottom;
/// `None` if there are none.
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

/// Parts of the box, elastic and undamped, with the kernels of the parts behind the absorbing faces if these are of
/// hexahedra; and the same with damping and rims, if any of these is damped. Where the field is damped like its layers
/// the first are damped, too.
fn ground(scene: &Scene, strata: &[Stratum]) -> Result<(Vec<Part>, Option<Vec<Part>>), StudyError> {
    let waves = scene.layered_waves().iter();
    let mut layers = waves.flat_map(|wave| wave.parameters().ground.layers());
    let is_field_damped = layers.any(|layer| layer.damping != LayerDamping::None);
    let (mut parts, mut damped) = (Vec::new(), Vec::new());
    let mut is_any_damped = false;
    for stratum in strata {
        let part = Part::new(
            stratum.set.clone(),
            Material::from(LinearElastic::new(stratum.medium)),
        );
        let behind = stratum.parts.iter().map(|&index| &scene.parts()[index]);
        let kernel = behind.clone().next().and_then(|part| part.kernel.clone());
        let part = match kernel.filter(|kernel: &Kernel| kernel.kind() == ElementKind::Hex8) {
            Some(kernel) => part.with_kernel(kernel),
            None => part,
        };
        let of = behind.clone().find(|part| part.damping != Damping::None);
        let Some(of) = of else {
            parts.push(part.clone());
            damped.push(part);
            continue;
        };
        is_any_damped = true;
        let with_damping = part.clone().with_damping(of.damping.clone());
        parts.push(if is_field_damped {
            with_damping.clone()
        } else {
            part
        });
        damped.push(match of.rim {
            Some(width) => with_damping.with_rim(width),
            None => with_damping,
        });
    }
    let damped = (is_any_damped && !is_field_damped).then_some(damped);
    Ok((parts, damped))
}

/// Duration (s) that contains most of the motion at the first point; `None` if a point does not move in it.
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
