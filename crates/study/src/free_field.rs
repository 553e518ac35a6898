//! The scene's box without the structure.

use powerhouse::engine::Ended;
use powerhouse::engine::observe::{HistoryTable, Motion};
use powerhouse::material::LinearElastic;
use powerhouse::model::{
    ElementKind, FieldMotion, FieldSampler, IncidentField, Mesh, ModelError, Vec3,
};
use powerhouse::{Error, Kernel, Material, OutputPlan, Part, RunHooks, Scene, TimeStep};

use crate::StudyError;

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
}

impl FreeFieldReport {
    /// The largest relative error of velocity at any point: strain, which loads a structure, goes
    /// with velocity.
    pub fn largest(&self) -> f64 {
        let errors = self.points.iter().map(|point| point.velocity);
        errors.fold(0.0, f64::max)
    }
    /// Accepts an error up to a limit.
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
/// bricks: as many as the mesh has elements. It has the scene's boundary, field and kernel, no
/// damping and no structure. It is compared at the middle of its top and at the scatterer.
pub struct FreeFieldCheck {
    scene: Scene,
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
    /// A scene without a field, or without absorbing faces on all sides of a box but its top.
    pub fn of(scene: &Scene) -> Result<Self, StudyError> {
        let (Some(field), Some(boundary)) = (scene.incident_field(), scene.absorbing_boundary())
        else {
            return Err(StudyError::NoField);
        };
        let (low, high) = scene.mesh().bounding_box();
        let cells = cells(scene.mesh());
        let mut mesh = Mesh::box_of_hexes(low, high, cells, "ground").map_err(Error::from)?;
        name_faces(scene, &mut mesh)?;
        let centre = scene.scatterer()?;
        let middle = (low + high) / 2.0;
        let points = [
            ("surface", Vec3::new(middle.x, middle.y, high.z)),
            ("structure", centre.sup(&low).inf(&high)),
        ];
        let sampler = field
            .prepare(&points.map(|(_, point)| point))
            .map_err(Error::from)?;
        let (start, duration) = (scene.start_time(), scene.run_duration());
        let window =
            window(sampler.as_ref(), start, duration).ok_or(StudyError::StillField { duration })?;
        let mut output = OutputPlan {
            // At every step.
            every: f64::MIN_POSITIVE,
            ..OutputPlan::default()
        };
        let wanted = Motion {
            acceleration: false,
            ..Motion::ALL
        };
        for (name, point) in points {
            output = output.history(name, point, wanted);
        }
        let mut boundary = boundary.clone();
        boundary.scatterer = Some(centre);
        let box_scene = Scene::new(format!("{}: free field", scene.title()), mesh)
            .part(ground(scene, field.as_ref())?)
            .shared_field(field.clone())
            .boundary(boundary)
            .start(start, scene.initial_motion())
            .duration(window)
            .output(output);
        Ok(Self {
            scene: box_scene,
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
        let mut simulation = self.scene.prepare()?;
        let own = simulation.stable_step()?.step;
        let step = scene_step.clamp(LEAST_SHARE_OF_STEP * own, own);
        simulation.set_step(TimeStep::Seconds(step));
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
        Ok(FreeFieldReport {
            cells: self.cells,
            step,
            window: results.run.time - self.start,
            points: self
                .points
                .iter()
                .zip(sums)
                .map(|(&(name, position), [d, d_exact, v, v_exact])| PointError {
                    name,
                    position,
                    displacement: (d / d_exact).sqrt(),
                    velocity: (v / v_exact).sqrt(),
                })
                .collect(),
        })
    }

    /// The time that will be computed (s).
    pub fn window(&self) -> f64 {
        self.window
    }
}

/// A vector of a history at a row; zero if there is none.
fn vector(table: &HistoryTable, name: &str, letter: char, row: usize) -> Vec3 {
    let component = |axis: char| {
        let column = table.column(&format!("{name}.{letter}{axis}"));
        column.map_or(0.0, |column| column.values[row])
    };
    Vec3::new(component('x'), component('y'), component('z'))
}

/// As many equal, nearly cubic cells as the mesh has elements.
fn cells(mesh: &Mesh) -> [usize; 3] {
    let (low, high) = mesh.bounding_box();
    let extent = high - low;
    let size = (extent.product() / mesh.element_count() as f64).cbrt();
    core::array::from_fn(|axis| ((extent[axis] / size).round() as usize).max(2))
}

/// The part behind the absorbing faces, elastic and undamped, with its kernel if that takes bricks.
fn ground(scene: &Scene, field: &dyn IncidentField) -> Result<Part, StudyError> {
    let part = Part::new("ground", Material::new(LinearElastic::new(field.medium())));
    let behind = scene.parts_behind_boundary()?;
    let kernel = behind
        .first()
        .and_then(|&index| scene.parts()[index].kernel.clone());
    Ok(
        match kernel.filter(|kernel: &Kernel| kernel.kind() == ElementKind::Hex8) {
            Some(kernel) => part.kernel(kernel),
            None => part,
        },
    )
}

/// The sides of a box as its mesh names them, with axis and whether they are the upper one.
const SIDES: [(&str, usize, bool); 6] = [
    ("left", 0, false),
    ("right", 0, true),
    ("front", 1, false),
    ("back", 1, true),
    ("bottom", 2, false),
    ("top", 2, true),
];

/// Gives the sides of a box the names of the scene's absorbing faces that lie on them.
fn name_faces(scene: &Scene, ground: &mut Mesh) -> Result<(), StudyError> {
    let mesh = scene.mesh();
    let (low, high) = mesh.bounding_box();
    let tolerance = 1e-6 * (high - low).norm();
    let original = ground.clone();
    let mut covered = [false; SIDES.len()];
    for (face, facets) in scene.absorbing_facets().map_err(Error::from)? {
        let mut sides = [false; SIDES.len()];
        for &facet in facets {
            let centre = mesh.facet_geometry(facet).centroid;
            let side = SIDES.iter().position(|&(_, axis, upper)| {
                let plane = if upper { high[axis] } else { low[axis] };
                (centre[axis] - plane).abs() <= tolerance
            });
            let side = side.ok_or_else(|| StudyError::ObliqueFace { face: face.into() })?;
            (sides[side], covered[side]) = (true, true);
        }
        let mut of_face = Vec::new();
        for ((name, ..), _) in SIDES.iter().zip(sides).filter(|(_, on)| *on) {
            of_face.extend_from_slice(original.facet_set(name).map_err(Error::from)?);
        }
        ground.set_facet_set(face, of_face).map_err(Error::from)?;
    }
    match SIDES[..5].iter().zip(covered).find(|(_, covered)| !covered) {
        Some(((face, ..), _)) => Err(StudyError::OpenFace { face }),
        None => Ok(()),
    }
}

/// The time in which most of the motion at the first point is over (s).
fn window(sampler: &dyn FieldSampler, start: f64, duration: f64) -> Option<f64> {
    let interval = duration / INSTANTS as f64;
    let mut sums = Vec::with_capacity(INSTANTS);
    let mut sum = 0.0;
    for instant in 1..=INSTANTS {
        let mut motion = vec![FieldMotion::default(); sampler.len()];
        sampler.add_motion(start + instant as f64 * interval, &mut motion);
        sum += motion[0].velocity.norm_squared();
        sums.push(sum);
    }
    let reached = sums
        .iter()
        .position(|&s| s >= SHARE_OF_MOTION * sum && s > 0.0)?;
    Some((reached + 1) as f64 * interval)
}

impl From<ModelError> for StudyError {
    fn from(error: ModelError) -> Self {
        Self::Scene(error.into())
    }
}
