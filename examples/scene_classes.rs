//! Cost of the components of a scene: memory and time per element for several classes of scenes.
//!
//! Builds on `cost_model`. A cube of ground, first elastic and alone, then with one additional component in each class: incident
//! waves through springs, an elastoplastic law without and with yielding, damping, a joint, output of all elements. Each
//! class runs in a process of its own with two sizes of the cube; the difference of their memories is the memory per
//! element, without that of the program. Memory is measured on Linux only.
//!
//! ```text
//!      class ---- 24^3 bricks ---- peak memory      --.
//!        |                                             >-- bytes per element
//!        '------- 40^3 bricks ---- peak memory      --'
//!                       '--------- wall time of steps ---- nanoseconds per element and step
//! ```
//!
//! Run from the top of the project: `cargo run --release --example scene_classes`

use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;

use powerhouse::boundary::ViscousSpring;
use powerhouse::contact::{BondedCoulomb, BondedCoulombParameters, JointSurface, SurfaceOptions};
use powerhouse::engine::observe::Motion;
use powerhouse::engine::{NodalForce, Precision, Rayleigh};
use powerhouse::io::peak_memory;
use powerhouse::material::{
    DampingBand, ElastoPlastic, LinearElastic, MohrCoulomb, MohrCoulombParameters,
    ReferenceFrequency, RelaxationSpectrum, media,
};
use powerhouse::model::{Mesh, Vec3};
use powerhouse::wavefield::{
    PlaneWave, PlaneWaveParameters, SmoothPulse, WaveKind, first_hit_corner,
};
use powerhouse::{
    Boundary, Damping, EnvelopeRequest, InitialMotion, Material, OutputPlan, Part, ResidualLimit,
    RunHooks, Scene, SceneJoint, TimeStep,
};
use powerhouse_examples::process::apart_from_this;
use powerhouse_examples::{Figures, Outcome};

/// Element edge (m).
const EDGE: f64 = 2.0;
/// Numbers of elements along an edge of the smaller and of the larger cube.
const SIZES: [usize; 2] = [24, 40];
/// Steps of a run, and length of a row of steps that is timed, since other load may slow down parts of the run.
const STEPS: u64 = 120;
const ROW: usize = 10;
/// A step (s), well below the limit of any class.
const STEP: f64 = 5e-4;
/// Greatest permitted additional cost of an elastoplastic law without yielding: its moduli, sizes and initial stresses, not
/// its history variables.
const UNASKED: f64 = 120.0;

/// Class of scenes by their components.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Class {
    Elastic,
    Single,
    Damped,
    Waves,
    Strong,
    Weak,
    Flat,
    Jointed,
    Watched,
}

impl Class {
    const ALL: [(Self, &'static str, &'static str); 9] = [
        (Self::Elastic, "elastic", "elastic, a force at one node"),
        (Self::Single, "single", "the same in single precision"),
        (
            Self::Damped,
            "rayleigh",
            "elastic with damping by mass and stiffness",
        ),
        (
            Self::Waves,
            "waves",
            "elastic, a wave comes in through springs on five faces",
        ),
        (
            Self::Strong,
            "strong",
            "the same with a law that nowhere yields",
        ),
        (
            Self::Weak,
            "weak",
            "the same with a law that yields everywhere",
        ),
        (
            Self::Flat,
            "flat",
            "as waves, damped alike at all frequencies of a band",
        ),
        (Self::Jointed, "jointed", "as waves, cut in half by a joint"),
        (
            Self::Watched,
            "watched",
            "as waves, the greatest motion and stress kept everywhere",
        ),
    ];

    fn material(self) -> Outcome<Material> {
        let cohesion = match self {
            Self::Strong => 1e12,
            Self::Weak => 1e3,
            _ => return Ok(Material::from(LinearElastic::new(media::ROCK))),
        };
        let surface = MohrCoulomb::new(MohrCoulombParameters {
            medium: media::ROCK,
            friction: 30.0,
            dilation: 0.0,
            cohesion,
            tension_strength: None,
        })?;
        Ok(Material::from(ElastoPlastic::new(surface)))
    }

    fn damping(self) -> Outcome<Damping> {
        Ok(match self {
            Self::Damped => Damping::from(Rayleigh {
                mass: 0.1,
                stiffness: 1e-5,
            }),
            Self::Flat => Damping::Flat {
                spectrum: RelaxationSpectrum::fit(DampingBand {
                    ratio: 0.05,
                    lowest: 0.5,
                    highest: 20.0,
                    mechanisms: 3,
                })?,
                reference: ReferenceFrequency::Centre,
            },
            _ => Damping::None,
        })
    }

    /// The scene of a cube with a number of elements along an edge.
    fn scene(self, cells: usize) -> Outcome<Scene> {
        let size = Vec3::repeat(EDGE * cells as f64);
        let mut mesh = Mesh::box_of_hexes(Vec3::zeros(), size, [cells; 3], "rock")?;
        let mut joint = None;
        if self == Self::Jointed {
            let all = 0..mesh.element_count() as u32;
            let (lower, upper): (Vec<u32>, Vec<u32>) =
                all.partition(|&e| mesh.centroid(e).z < 0.5 * size.z);
            let split = mesh.split_between(&lower, &upper)?;
            let options = SurfaceOptions::within(1e-6)?;
            let surface =
                JointSurface::between(&split.mesh, &split.first, &split.second, &options)?;
            let law = BondedCoulomb::new(BondedCoulombParameters {
                cohesion: 1e9,
                tensile_strength: 1e9,
                static_friction: 0.8,
                dynamic_friction: 0.6,
                cohesion_loss: true,
            })?;
            joint = Some(SceneJoint::new("bedding", surface, law));
            mesh = split.mesh;
        }
        let centre = Vec3::new(0.5 * size.x, 0.5 * size.y, size.z);
        let top = mesh.nodes_in_box(&centre, &centre);
        let mut output = OutputPlan::default().history("surface", centre, Motion::DISPLACEMENT);
        if self == Self::Watched {
            output.envelope = Some(EnvelopeRequest::new(STEP).with_stress(true));
        }
        let mut scene = Scene::new("class", mesh)
            .part(Part::new("rock", self.material()?).with_damping(self.damping()?))
            .with_step(TimeStep::Seconds(STEP))
            .with_duration(STEPS as f64 * STEP)
            .with_energy_residual(ResidualLimit::Unchecked)
            .with_threads(1)
            .with_output(output);
        if self == Self::Single {
            scene = scene.with_precision(Precision::F32);
        }
        if let Some(joint) = joint {
            scene = scene.joint(joint);
        }
        if matches!(self, Self::Elastic | Self::Single | Self::Damped) {
            let force = NodalForce::new(top, 1e6 * Vec3::x(), Box::new(|t: f64| (50.0 * t).sin()));
            return Ok(scene.load(force));
        }
        let mut parameters = PlaneWaveParameters::vertical(WaveKind::SV, media::ROCK, size.z);
        parameters.reference = first_hit_corner(&Vec3::zeros(), &size, &parameters.direction());
        // So long that the whole cube is strained from the first step on.
        let pulse = Arc::new(SmoothPulse::new(0.05, 0.6)?);
        let faces = ["left", "right", "front", "back", "bottom"];
        let boundary = Boundary::new(ViscousSpring::default(), faces).with_scatterer(centre);
        Ok(scene
            .with_plane_waves(vec![PlaneWave::new(parameters, pulse)?])?
            .with_boundary(boundary)
            .with_start_time(0.2)
            .with_initial_motion(InitialMotion::Field))
    }

    /// Mean wall time of a step (s) over the fastest row of steps, and peak memory of this process (bytes).
    fn run(self, cells: usize) -> Outcome<[f64; 2]> {
        let (told, times) = std::sync::mpsc::channel();
        // A closed receiver means that the run has failed with its own error.
        let hooks = RunHooks::default().with_progress(move |_| {
            let _ = told.send(Instant::now());
        });
        self.scene(cells)?.prepare()?.run(hooks)?;
        let times: Vec<Instant> = times.iter().collect();
        let rows = times.windows(ROW + 1);
        let least = rows.map(|row| row[ROW].duration_since(row[0])).min();
        let time = least.ok_or("too few steps to time")?.as_secs_f64() / ROW as f64;
        Ok([time, peak_memory().map_or(f64::NAN, |bytes| bytes as f64)])
    }
}

fn main() -> Outcome<ExitCode> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let [name, cells] = &arguments[..] {
        let class = Class::ALL.iter().find(|(_, other, _)| other == name);
        let (class, ..) = class.ok_or("no such class")?;
        let [time, memory] = class.run(cells.parse()?)?;
        println!("{time:e} {memory:e}");
        return Ok(ExitCode::SUCCESS);
    }
    let mut figures = Figures::default();
    let elements = SIZES.map(|cells| (cells * cells * cells) as f64);
    let mut bytes_of = Vec::new();
    for (class, name, remark) in Class::ALL {
        let [small, large] = SIZES.map(|cells| apart_from_this(&[name, &cells.to_string()]));
        let ([_, less], [time, more]) = (small?, large?);
        let bytes = (more - less) / (elements[1] - elements[0]);
        let label = |what: &str| format!("scene_classes.{name}.{what}");
        figures.report(&label("nanoseconds"), 1e9 * time / elements[1], remark);
        if bytes.is_finite() {
            figures.report(&label("bytes"), bytes, remark);
            bytes_of.push((class, bytes));
        }
    }
    let bytes = |wanted: Class| {
        let found = bytes_of.iter().find(|(class, _)| *class == wanted);
        found.map(|(_, bytes)| *bytes)
    };
    if let (Some(strong), Some(waves)) = (bytes(Class::Strong), bytes(Class::Waves)) {
        figures.at_most("scene_classes.unasked_law.bytes", strong - waves, UNASKED);
    }
    Ok(figures.verdict())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every class is a valid scene with the component of its name, and yields only where it should.
    #[test]
    fn classes_are_what_they_are_called() {
        for (class, name, _) in Class::ALL {
            let results = class.scene(6).unwrap().prepare().unwrap();
            let results = results.run(RunHooks::default()).unwrap();
            let steps = results.run.steps;
            // The last step ends at the duration or just past it.
            assert!((STEPS..=STEPS + 1).contains(&steps), "{name} {steps}");
            assert_eq!(
                results.joint_outcomes.len(),
                usize::from(class == Class::Jointed)
            );
            assert_eq!(results.envelope.is_some(), class == Class::Watched);
            let plastic = results.state.iter().flat_map(|state| &state.peaks);
            let most = plastic
                .filter(|(variable, _)| variable.name == "equivalent_plastic_strain")
                .flat_map(|(_, peaks)| &peaks.values)
                .fold(0.0_f64, |most, &value| most.max(value));
            assert_eq!(most > 0.0, class == Class::Weak, "{name} {most}");
        }
    }
}
