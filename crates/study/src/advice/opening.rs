//! An opening in a slice of ground, in place of what scatters in a scene.

use core::f64::consts::{FRAC_PI_2, PI, TAU};
use std::collections::BTreeMap;
use std::sync::Arc;

use powerhouse::boundary::{Spreading, ViscousSpring};
use powerhouse::engine::observe::{HistoryTable, Motion, Spot};
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
use super::candidate::{BoundaryKind, Standing};
use super::setting::{ArrivingWave, Setting};
use crate::{OpeningSlice, StudyError, grown, largest_error, probe_errors};

/// Bricks per shear wavelength at the highest frequency.
const PER_WAVELENGTH: f64 = 10.0;
/// Bricks per radius of the opening, at least and at most.
const PER_RADIUS: [f64; 2] = [4.0, 16.0];
/// Bricks of the ground between opening and faces, at most: shorter waves are left out.
const MOST_BRICKS: f64 = 3.0e4;
/// Length of a row of bricks over that of the row before it.
const GROWTH: f64 = 1.1;
/// Both ways from opening to faces and back, by shear waves, that a run waits for.
const RETURNS: f64 = 2.0;
/// Share of the stable step.
const STEP_SHARE: f64 = 0.95;
/// Places on the wall (degrees from +x), and on the surface (radii from above the centre).
const WALL: [f64; 4] = [0.0, 90.0, 180.0, 270.0];
const SURFACE: [f64; 3] = [-1.5, 0.0, 1.5];

/// What moves the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Mover {
    /// A pulse that carries all frequencies of the band.
    Wave(ArrivingWave),
    /// A sudden, lasting pressure in the opening.
    Pressure,
}

/// What moves the ground, from when to when (s).
struct Motive {
    wave: Option<PlaneWave>,
    window: [f64; 2],
}

/// A circular opening as large as what scatters, in a slice with the faces of the scene.
///
/// Waves in a slice spread as cylinders, which decay more slowly than spheres, and no structure of its
/// size scatters more than an opening: what comes back from the faces is more than in the scene.
pub(super) struct Opening {
    slice: OpeningSlice,
    standing: Standing,
    /// The top of a full space absorbs.
    absorbing_top: bool,
    band: Band,
}

impl Opening {
    /// The opening of a setting, with its faces so many times as far, for waves of a band.
    pub(super) fn of(setting: &Setting, farther: f64, band: &Band) -> Result<Self, StudyError> {
        let radius = setting.radius.ok_or(StudyError::NoBoundary)?;
        let half_width = setting.half_width().ok_or(StudyError::NoBoundary)? * farther;
        let below = setting.distances[2][0].map_or(half_width, |distance| farther * distance);
        let above = setting.distances[2][1].map_or(0.0, |distance| farther * distance);
        let depth = setting.depth.unwrap_or(above).max(1.05 * radius);
        let height = depth + below;
        // As few bricks as waves and opening need, and no more than can be computed in no time.
        let s_speed = setting.medium.s_speed();
        let wanted = s_speed / (PER_WAVELENGTH * band.highest);
        let brick = wanted.max((2.0 * half_width * height / MOST_BRICKS).sqrt());
        let fine = brick.clamp(radius / PER_RADIUS[1], radius / PER_RADIUS[0]);
        let brick = brick.max(fine);
        // What the slice needs between opening and faces.
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
        let standing = Standing {
            medium: setting.medium,
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
            standing,
            absorbing_top: above > 0.0,
            band: band.up_to(s_speed / (PER_WAVELENGTH * brick)),
        })
    }

    /// The highest frequency that it carries (Hz).
    pub(super) fn highest(&self) -> f64 {
        self.band.highest
    }

    /// Duration of the pulse (s): its spectrum, that of a cubic spline, falls to a sixth of its peak at
    /// the highest frequency.
    fn pulse(&self) -> f64 {
        2.0 / self.band.highest
    }

    /// How long a pulse lasts and comes back from the faces, once it has reached the opening (s).
    fn lasting(&self) -> f64 {
        let slice = &self.slice;
        let farthest = slice.half_width.max(slice.height - slice.depth);
        let way = 2.0 * farthest + slice.depth;
        self.pulse() + RETURNS * way / self.standing.medium.s_speed()
    }

    /// What moves the ground, with the start and end of the run (s): waves come to a body at rest.
    fn motion(&self, mover: Mover) -> Result<Motive, StudyError> {
        let Mover::Wave(wave) = mover else {
            return Ok(Motive {
                wave: None,
                window: [0.0, self.lasting()],
            });
        };
        let slice = &self.slice;
        let medium = self.standing.medium;
        let centre = Vec3::new(0.0, 0.0, -slice.depth);
        let mut parameters = PlaneWaveParameters::vertical(wave.kind, medium, 0.0);
        parameters.incidence = wave.incidence;
        parameters.reference = centre;
        if wave.full_space {
            parameters.site = Site::FullSpace;
        }
        let slowness = parameters.direction() / wave.kind.speed(&medium);
        let pulse = SmoothPulse::new(1.0, self.pulse()).map_err(of_wave)?;
        let wave = PlaneWave::new(parameters, Arc::new(pulse)).map_err(of_wave)?;
        let corners = [-1.0, 1.0]
            .map(|side| [-slice.height, 0.0].map(|z| Vec3::new(side * slice.half_width, 0.0, z)));
        let corners = corners.concat();
        let arrivals = corners
            .iter()
            .map(|corner| (corner - centre).dot(&slowness));
        let start = arrivals.fold(f64::INFINITY, f64::min);
        let end = self.lasting();
        if wave.is_causal() {
            return Ok(Motive {
                wave: Some(wave),
                window: [start, end],
            });
        }
        let limits = QuietStartLimits::default();
        let (wave, quiet) = wave.with_quiet_start(&corners, start, &limits)?;
        Ok(Motive {
            wave: Some(wave),
            window: [start, end + quiet.padding],
        })
    }

    fn faces(&self) -> Vec<String> {
        let names: &[&str] = match self.absorbing_top {
            false => &["left", "right", "bottom"],
            true => &["left", "right", "bottom", "top"],
        };
        names.iter().map(|&name| name.to_owned()).collect()
    }

    /// The slice, and the same with so much more ground around that nothing comes back in time.
    fn meshes(&self) -> Result<[Mesh; 2], StudyError> {
        let mesh = self.slice.mesh()?;
        let beyond = 0.5 * self.standing.medium.p_speed() * self.lasting();
        let longest = self.standing.medium.s_speed() / (PER_WAVELENGTH * self.band.highest);
        let mut wide = mesh.clone();
        for face in self.faces() {
            let first = match face.as_str() {
                "left" | "right" => self.slice.coarse[0],
                "bottom" => self.slice.coarse[1],
                _ => self.slice.fine,
            };
            wide = grown(&wide, &face, &layers(first, longest.max(first), beyond))?;
        }
        Ok([mesh, wide])
    }

    /// Each boundary's error at the worst place: the larger of displacement's and velocity's under waves,
    /// that of displacement under a pressure.
    pub(super) fn errors(
        &self,
        mover: Mover,
        kinds: &[BoundaryKind],
    ) -> Result<(Vec<f64>, [usize; 2]), StudyError> {
        let [mesh, wide] = self.meshes()?;
        let counts = [mesh.element_count(), wide.element_count()];
        let motive = self.motion(mover)?;
        let duration = motive.window[1] - motive.window[0];
        let default = Arc::new(ViscousSpring {
            spreading: Spreading::Cylindrical,
            ..ViscousSpring::default()
        });
        let boundary = |condition: Arc<dyn AbsorbingBoundary>| {
            let mut boundary = Boundary::new(condition, self.faces());
            boundary.scatterer = Some(Vec3::new(0.0, 0.0, -self.slice.depth));
            boundary
        };
        let small = self.scene(mesh.clone(), boundary(default.clone()), &motive)?;
        let stable = STEP_SHARE * small.prepare()?.stable_step()?.step;
        let step = duration / (duration / stable).ceil();
        let run = |mesh: Mesh, boundary: Boundary| {
            let scene = self.scene(mesh, boundary, &motive)?;
            let results = scene.with_step(TimeStep::Seconds(step)).prepare()?;
            Ok::<_, StudyError>(results.run(RunHooks::default())?.histories)
        };
        // The field enters both meshes at the same places: through the faces of the small one, and
        // through the elements behind them.
        let mut around = boundary(default);
        if motive.wave.is_some() {
            around = around.with_region((0..counts[0] as u32).collect());
        }
        let reference = run(wide, around)?;
        let of_kind = |kind: &BoundaryKind| {
            let condition = kind
                .condition(&self.standing, &["bottom".into()])
                .map_err(Error::from)?;
            let found = run(mesh.clone(), boundary(condition))?;
            match mover {
                Mover::Pressure => Ok(largest_error(&probe_errors(&found, &reference)?)),
                Mover::Wave(_) => self.weighted_error(&found, &reference),
            }
        };
        let errors = kinds
            .iter()
            .map(of_kind)
            .collect::<Result<_, StudyError>>()?;
        Ok((errors, counts))
    }

    fn scene(&self, mesh: Mesh, boundary: Boundary, motive: &Motive) -> Result<Scene, StudyError> {
        let slice = &self.slice;
        let facets =
            |face: &str| -> Result<Vec<_>, StudyError> { Ok(mesh.facet_set(face)?.to_vec()) };
        let cuts = mesh.nodes_of_facets(&[facets("front")?, facets("back")?].concat());
        let opening = facets("opening")?;
        // At every step.
        let mut output = OutputPlan::default().with_every(f64::MIN_POSITIVE);
        let wanted = Motion {
            displacement: true,
            velocity: motive.wave.is_some(),
            acceleration: false,
        };
        for degrees in WALL {
            let (sine, cosine) = degrees.to_radians().sin_cos();
            let place = Vec3::new(cosine, 0.0, sine) * slice.radius - Vec3::z() * slice.depth;
            let spot = Spot::at(place).within(0.1 * slice.radius);
            output = output.history(&format!("wall {degrees}"), spot, wanted);
        }
        if !self.absorbing_top {
            for radii in SURFACE {
                let place = Vec3::new(radii * slice.radius, 0.0, 0.0);
                output = output.history(&format!("surface {radii}"), place, wanted);
            }
        }
        let rock = Material::from(LinearElastic::new(self.standing.medium));
        let [start, end] = motive.window;
        let mut scene = Scene::new("opening", mesh)
            .part(Part::new("rock", rock))
            .with_boundary(boundary)
            .with_energy_residual(ResidualLimit::Unchecked)
            .with_duration(end - start)
            .with_output(output)
            .allow_magnitudes();
        let is_antiplane = |wave: &PlaneWave| wave.parameters().kind == WaveKind::SH;
        if motive.wave.as_ref().is_some_and(is_antiplane) {
            let all: Vec<u32> = (0..scene.mesh().node_count() as u32).collect();
            scene = scene
                .support(Support::roller(all.clone(), Vec3::x()))
                .support(Support::roller(all, Vec3::z()));
        } else {
            scene = scene.support(Support::roller(cuts, Vec3::y()));
        }
        if let Some(wave) = &motive.wave {
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

    /// The error under the motion of the band: spectra of both runs over that of the pulse, times that
    /// of the band; the larger of displacement's and velocity's at the worst place.
    fn weighted_error(
        &self,
        found: &HistoryTable,
        reference: &HistoryTable,
    ) -> Result<f64, StudyError> {
        let pulse = SmoothPulse::new(1.0, self.pulse()).map_err(of_wave)?;
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
                // Per energy of the pulse's velocity, and then of displacement.
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

/// The spectrum of a cubic spline of a duration at a frequency (Hz), over its value at zero:
/// `(sin x / x)^4`, `x = pi f T / 4`.
fn spectrum(pulse: &SmoothPulse, frequency: f64) -> f64 {
    match 0.25 * PI * frequency * pulse.support().end {
        x if x > 0.0 => (x.sin() / x).powi(4),
        _ => 1.0,
    }
}

/// Thicknesses that grow from one to a longest one (m) and reach a distance (m).
fn layers(first: f64, longest: f64, beyond: f64) -> Vec<f64> {
    let (mut thicknesses, mut reached, mut thickness) = (Vec::new(), 0.0, first);
    while reached < beyond {
        thicknesses.push(thickness);
        reached += thickness;
        thickness = (GROWTH * thickness).min(longest);
    }
    thicknesses
}

fn of_wave(error: powerhouse::wavefield::WaveError) -> StudyError {
    Error::from(ModelError::from(error)).into()
}
