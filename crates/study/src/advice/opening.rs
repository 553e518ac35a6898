//! Substitute model of a scatterer: a circular opening in a plane-strain slice of ground.

use core::f64::consts::{FRAC_PI_2, PI, TAU};
use std::collections::BTreeMap;
use std::sync::Arc;

use powerhouse::boundary::{Spreading, ViscousSpring};
use powerhouse::engine::observe::{HistoryTable, Motion, ObservationPoint};
use powerhouse::engine::{FacePressure, Profile, Support};
use powerhouse::material::LinearElastic;
use powerhouse::model::{AbsorbingBoundary, Mesh, ModelError, Vec3};
use powerhouse::wavefield::{
    Complex, PlaneWave, PlaneWaveParameters, QuietStartLimits, Signal, Site, SmoothPulse, WaveKind,
};
use powerhouse::{
    Boundary, Error, InitialMotion, Material, OutputPlan, Part, ResidualLimit, RunHooks, Scene,
    TimeStep,
};

use super::band::Band;
use super::candidate::{BoundaryKind, Surroundings};
use super::setting::{ArrivingWave, BoundaryProblem};
use crate::{OpeningSlice, StudyError, grown, largest_error, probe_errors};

/// Elements per shear wavelength at the highest frequency.
const PER_WAVELENGTH: f64 = 10.0;
/// Least and greatest number of elements per radius of the opening.
const PER_RADIUS: [f64; 2] = [4.0, 16.0];
/// Greatest number of elements between opening and faces; waves that would need more are left out.
const MOST_BRICKS: f64 = 3.0e4;
/// Ratio of element lengths of consecutive rows.
const GROWTH: f64 = 1.1;
/// Return trips of shear waves between opening and faces that are computed.
const RETURNS: f64 = 2.0;
/// Time step over the stable step.
const STEP_SHARE: f64 = 0.95;
/// Recorded points on the wall (degrees from +x), and on the surface (x over the radius).
const WALL: [f64; 4] = [0.0, 90.0, 180.0, 270.0];
const SURFACE: [f64; 3] = [-1.5, 0.0, 1.5];

/// Excitation of the substitute model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Source {
    /// A plane wave whose pulse excites all frequencies of the band.
    Wave(ArrivingWave),
    /// A pressure step in the opening.
    Pressure,
}

/// The plane wave of a run, if there is one, with start and end of the run (s).
struct WaveWindow {
    wave: Option<PlaneWave>,
    window: [f64; 2],
}

/// A circular opening with the radius of the scatterer, in a plane-strain slice with the scene's distances to the
/// faces.
///
/// Waves in a slice spread cylindrically, with less decay than spherical ones, and no structure of this size
/// scatters more than an opening: the reflections from the faces exceed those in the scene.
pub(super) struct Opening {
    slice: OpeningSlice,
    surroundings: Surroundings,
    /// Whether the top absorbs: in a full space.
    absorbing_top: bool,
    band: Band,
    /// Greatest product of elements and steps of the reference.
    most_work: f64,
}

impl Opening {
    /// The substitute model of a scene with the distances of the faces multiplied by `farther`, for waves of a
    /// frequency band, with a greatest product of elements and steps of its reference.
    pub(super) fn of(
        problem: &BoundaryProblem,
        farther: f64,
        band: &Band,
        most_work: f64,
    ) -> Result<Self, StudyError> {
        let radius = problem.radius.ok_or(StudyError::NoBoundary)?;
        let half_width = problem.half_width().ok_or(StudyError::NoBoundary)? * farther;
        let below = problem.distances[2][0].map_or(half_width, |distance| farther * distance);
        let above = problem.distances[2][1].map_or(0.0, |distance| farther * distance);
        let depth = problem.depth.unwrap_or(above).max(1.05 * radius);
        let height = depth + below;
        // As few elements as waves and opening need, and at most MOST_BRICKS.
        let s_speed = problem.medium.s_speed();
        let wanted = s_speed / (PER_WAVELENGTH * band.highest);
        let brick = wanted.max((2.0 * half_width * height / MOST_BRICKS).sqrt());
        let fine = brick.clamp(radius / PER_RADIUS[1], radius / PER_RADIUS[0]);
        let brick = brick.max(fine);
        // The slice needs at least one element between the square around the opening and the faces.
        let square = if depth <= 2.5 * radius {
            depth
        } else {
            2.0 * radius
        };
        let (aside, under) = (half_width - square, below - square);
        if aside < fine || under < fine {
            return Err(StudyError::NearFace {
                distance: half_width.min(below),
                least: square + fine,
            });
        }
        let surroundings = Surroundings {
            medium: problem.medium,
            spreading: Spreading::Cylindrical,
            distances: [
                half_width,
                half_width,
                if above > 0.0 { below.min(above) } else { below },
            ],
        };
        let slice = OpeningSlice {
            radius,
            depth,
            half_width,
            height,
            fine,
            coarse: [brick.min(aside), brick.min(under)],
            growth: GROWTH,
        };
        Ok(Self {
            slice,
            surroundings,
            absorbing_top: above > 0.0,
            band: band.up_to(s_speed / (PER_WAVELENGTH * brick)),
            most_work,
        })
    }

    /// Highest frequency that the mesh resolves (Hz).
    pub(super) fn highest(&self) -> f64 {
        self.band.highest
    }

    /// Duration of the pulse (s); the spectrum of this cubic spline falls to a sixth of its peak at the highest
    /// frequency.
    fn pulse(&self) -> f64 {
        2.0 / self.band.highest
    }

    /// Time (s) from the arrival of the pulse at the opening until its reflections from the faces have passed.
    fn duration(&self) -> f64 {
        let slice = &self.slice;
        let farthest = slice.half_width.max(slice.height - slice.depth);
        let way = 2.0 * farthest + slice.depth;
        self.pulse() + RETURNS * way / self.surroundings.medium.s_speed()
    }

    /// The wave and the time window of a run, which starts from rest before the wave arrives.
    fn motion(&self, source: Source) -> Result<WaveWindow, StudyError> {
        let Source::Wave(wave) = source else {
            return Ok(WaveWindow {
                wave: None,
                window: [0.0, self.duration()],
            });
        };
        let slice = &self.slice;
        let medium = self.surroundings.medium;
        let centre = Vec3::new(0.0, 0.0, -slice.depth);
        let mut parameters = PlaneWaveParameters::vertical(wave.kind, medium, 0.0);
        parameters.incidence = wave.incidence;
        parameters.reference = centre;
        if wave.full_space {
            parameters.site = Site::FullSpace;
        }
        let slowness = parameters.direction() / wave.kind.speed(&medium);
        let pulse = SmoothPulse::new(1.0, self.pulse())?;
        let wave = PlaneWave::new(parameters, Arc::new(pulse))?;
        let corners = [-1.0, 1.0]
            .map(|side| [-slice.height, 0.0].map(|z| Vec3::new(side * slice.half_width, 0.0, z)));
        let corners = corners.concat();
        let arrivals = corners
            .iter()
            .map(|corner| (corner - centre).dot(&slowness));
        let start = arrivals.fold(f64::INFINITY, f64::min);
        let end = self.duration();
        if wave.is_causal() {
            return Ok(WaveWindow {
                wave: Some(wave),
                window: [start, end],
            });
        }
        let limits = QuietStartLimits::default();
        let (wave, quiet) = wave.with_quiet_start(&corners, start, &limits)?;
        Ok(WaveWindow {
            wave: Some(wave),
            window: [start, end + quiet.padding],
        })
    }

    fn faces(&self) -> Vec<String> {
        let names: &[&str] = if self.absorbing_top {
            &["left", "right", "bottom", "top"]
        } else {
            &["left", "right", "bottom"]
        };
        names.iter().map(|&name| name.to_owned()).collect()
    }

    /// The mesh of the slice, and the same extended so far that no reflection returns within the run.
    fn meshes(&self) -> Result<[Mesh; 2], StudyError> {
        let mesh = self.slice.mesh()?;
        let beyond = 0.5 * self.surroundings.medium.p_speed() * self.duration();
        let longest = self.surroundings.medium.s_speed() / (PER_WAVELENGTH * self.band.highest);
        let added = self.faces().into_iter().map(|face| {
            let first = match face.as_str() {
                "left" | "right" => self.slice.coarse[0],
                "bottom" => self.slice.coarse[1],
                _ => self.slice.fine,
            };
            (face, layers(first, longest.max(first), beyond))
        });
        let added: Vec<(String, Vec<f64>)> = added.collect();
        let is_side = |face: &str| face == "left" || face == "right";
        let rows = |sides: bool| -> usize {
            let of = added.iter().filter(|(face, _)| is_side(face) == sides);
            of.map(|(_, layers)| layers.len()).sum()
        };
        let side = (mesh.element_count() as f64).sqrt();
        let elements = (side + rows(true) as f64) * (side + rows(false) as f64);
        let medium = self.surroundings.medium;
        let steps = self.duration() * medium.p_speed() / (STEP_SHARE * self.slice.fine);
        if elements * steps > self.most_work {
            return Err(StudyError::CostlyPrediction {
                elements,
                steps,
                ratio: medium.p_speed() / medium.s_speed(),
            });
        }
        let mut wide = mesh.clone();
        for (face, layers) in &added {
            wide = grown(&wide, face, layers)?;
        }
        Ok([mesh, wide])
    }

    /// The error of each boundary at the worst recorded point: under waves the larger of those of displacement and
    /// velocity, under a pressure that of displacement; with the numbers of elements of both meshes.
    pub(super) fn errors(
        &self,
        source: Source,
        kinds: &[BoundaryKind],
    ) -> Result<(Vec<f64>, [usize; 2]), StudyError> {
        let [mesh, wide] = self.meshes()?;
        let counts = [mesh.element_count(), wide.element_count()];
        let input = self.motion(source)?;
        let duration = input.window[1] - input.window[0];
        let default = Arc::new(ViscousSpring {
            spreading: Spreading::Cylindrical,
            ..ViscousSpring::default()
        });
        let boundary = |condition: Arc<dyn AbsorbingBoundary>| {
            let mut boundary = Boundary::new(condition, self.faces());
            boundary.scatterer = Some(Vec3::new(0.0, 0.0, -self.slice.depth));
            boundary
        };
        let small = self.scene(mesh.clone(), boundary(default.clone()), &input)?;
        let stable = STEP_SHARE * small.prepare()?.stable_step()?.step;
        let step = duration / (duration / stable).ceil();
        let run = |mesh: Mesh, boundary: Boundary| {
            let scene = self.scene(mesh, boundary, &input)?;
            let results = scene.with_step(TimeStep::Seconds(step)).prepare()?;
            Ok::<_, StudyError>(results.run(RunHooks::default())?.histories().clone())
        };
        // The field enters both meshes at the same location: through the faces of the small one, and through the
        // elements behind them.
        let mut around = boundary(default);
        if input.wave.is_some() {
            around = around.with_region((0..counts[0] as u32).collect());
        }
        let reference = run(wide, around)?;
        let of_kind = |kind: &BoundaryKind| {
            let condition = kind
                .condition(&self.surroundings, &["bottom".into()])
                .map_err(Error::from)?;
            let found = run(mesh.clone(), boundary(condition))?;
            match source {
                Source::Pressure => Ok(largest_error(&probe_errors(&found, &reference)?)),
                Source::Wave(_) => self.weighted_error(&found, &reference),
            }
        };
        let errors = kinds
            .iter()
            .map(of_kind)
            .collect::<Result<_, StudyError>>()?;
        Ok((errors, counts))
    }

    fn scene(
        &self,
        mesh: Mesh,
        boundary: Boundary,
        input: &WaveWindow,
    ) -> Result<Scene, StudyError> {
        let slice = &self.slice;
        let facets =
            |face: &str| -> Result<Vec<_>, StudyError> { Ok(mesh.facet_set(face)?.to_vec()) };
        let cuts = mesh.nodes_of_facets(&[facets("front")?, facets("back")?].concat());
        let opening = facets("opening")?;
        // At every step.
        let mut output = OutputPlan::default().with_every(f64::MIN_POSITIVE);
        let wanted = Motion {
            displacement: true,
            velocity: input.wave.is_some(),
            acceleration: false,
        };
        for degrees in WALL {
            let (sine, cosine) = degrees.to_radians().sin_cos();
            let point = Vec3::new(cosine, 0.0, sine) * slice.radius - Vec3::z() * slice.depth;
            let spot = ObservationPoint::at(point).within(0.1 * slice.radius);
            output = output.history(&format!("wall {degrees}"), spot, wanted);
        }
        if !self.absorbing_top {
            for radii in SURFACE {
                let point = Vec3::new(radii * slice.radius, 0.0, 0.0);
                output = output.history(&format!("surface {radii}"), point, wanted);
            }
        }
        let rock = Material::from(LinearElastic::new(self.surroundings.medium));
        let [start, end] = input.window;
        let mut scene = Scene::new("opening", mesh)
            .part(Part::new("rock", rock))
            .with_boundary(boundary)
            .with_energy_residual(ResidualLimit::Unchecked)
            .with_duration(end - start)
            .with_output(output)
            .allow_magnitudes();
        let is_antiplane = |wave: &PlaneWave| wave.parameters().kind == WaveKind::SH;
        if input.wave.as_ref().is_some_and(is_antiplane) {
            let all: Vec<u32> = (0..scene.mesh().node_count() as u32).collect();
            scene = scene
                .support(Support::roller(all.clone(), Vec3::x()))
                .support(Support::roller(all, Vec3::z()));
        } else {
            scene = scene.support(Support::roller(cuts, Vec3::y()));
        }
        if let Some(wave) = &input.wave {
            return Ok(scene
                .with_field(wave.clone())
                .with_start_time(start)
                .with_initial_motion(InitialMotion::Rest));
        }
        let rise = 0.5 * self.pulse();
        let history = move |time: f64| match time / rise {
            x if x < 1.0 => (FRAC_PI_2 * x).sin().powi(2),
            _ => 1.0,
        };
        let pressure =
            FacePressure::new(scene.mesh(), &opening, Profile::Uniform, Box::new(history));
        let pressure = pressure.map_err(|error| Error::from(ModelError::from(error)))?;
        Ok(scene.load(pressure))
    }

    /// The error under the motion of the band, from the spectra of both runs divided by that of the pulse and
    /// multiplied by that of the band; the larger of those of displacement and velocity at the worst point.
    fn weighted_error(
        &self,
        found: &HistoryTable,
        reference: &HistoryTable,
    ) -> Result<f64, StudyError> {
        let pulse = SmoothPulse::new(1.0, self.pulse())?;
        let mut sums: BTreeMap<&str, [[f64; 2]; 2]> = BTreeMap::new();
        for expected in &reference.columns {
            let is_velocity = expected.name.contains(".v");
            let Some(column) = found.column(&expected.name).filter(|_| is_velocity) else {
                continue;
            };
            let probe = expected
                .name
                .rsplit_once('.')
                .map_or("", |(probe, _)| probe);
            let sums = sums.entry(probe).or_default();
            for &(frequency, energy) in &self.band.lines {
                let rate = TAU * frequency;
                let [mut difference, mut whole] = [Complex::new(0.0, 0.0); 2];
                let values = column.values.iter().zip(&expected.values);
                for ((value, expected), time) in values.zip(&reference.times) {
                    let turn = Complex::from_polar(1.0, -rate * time);
                    difference += turn * (value - expected);
                    whole += turn * *expected;
                }
                // Weights of velocity and of displacement, per energy of the pulse.
                let weight = energy / (rate * spectrum(&pulse, frequency)).powi(2);
                for (sums, weight) in sums.iter_mut().zip([weight, weight / (rate * rate)]) {
                    sums[0] += weight * difference.norm_sqr();
                    sums[1] += weight * whole.norm_sqr();
                }
            }
        }
        let errors = sums.values().flatten();
        let errors = errors.map(|[difference, whole]| (difference / whole).sqrt());
        Ok(errors.max_by(f64::total_cmp).unwrap_or(f64::NAN))
    }
}

/// Spectrum of the pulse at a frequency (Hz) over its value at zero frequency:
/// `(sin x / x)^4`, `x = pi f T / 4`.
fn spectrum(pulse: &SmoothPulse, frequency: f64) -> f64 {
    match 0.25 * PI * frequency * pulse.support().end {
        x if x > 0.0 => (x.sin() / x).powi(4),
        _ => 1.0,
    }
}

/// Layer thicknesses (m) that grow geometrically from `first` up to `longest` and add up to at least `beyond`.
fn layers(first: f64, longest: f64, beyond: f64) -> Vec<f64> {
    let (mut thicknesses, mut reached, mut thickness) = (Vec::new(), 0.0, first);
    while reached < beyond {
        thicknesses.push(thickness);
        reached += thickness;
        thickness = (GROWTH * thickness).min(longest);
    }
    thicknesses
}
