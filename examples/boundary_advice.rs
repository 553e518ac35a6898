//! Boundary advice for three scenes, with the predicted errors compared to measured ones.
//!
//! Builds on `boundary_price`. `powerhouse advise boundary SCENE` recommends the cheapest boundary whose predicted
//! error is within a permitted one. Here the error is measured: each scene runs with every boundary, and once with a mesh
//! extended so far that no reflection returns within the run.
//!
//! ```text
//!    ------------------      ------------------       z |--..__
//!   |       __         |    |                  |        |      `.  rock
//!   |      (  )        |    |       .--.       |        |-.  p   \
//!   |       ``         |    |       `--'       |        |  \     |
//!    ------------------      ------------------         +---|----|-- x
//!      slice, P wave,          block, SV wave           sphere, pressure step
//!      vertical                at 25 degrees
//! ```
//!
//! Errors are those of displacement and velocity (under the pressure step of displacement alone) over the run, at the worst
//! of several points on wall and surface. For the slice the substitute model of the prediction is equivalent. For the block
//! the prediction is conservative: it replaces the cavern, from which waves spread spherically, by a circular opening in
//! plane strain.
//!
//! Run: `cargo run --release --example boundary_advice`

use std::process::ExitCode;
use std::sync::Arc;

use powerhouse::engine::observe::{HistoryTable, Motion, ObservationPoint};
use powerhouse::engine::{FacePressure, Profile, Support};
use powerhouse::material::LinearElastic;
use powerhouse::model::{AbsorbingBoundary, ElasticMedium, Mesh, Vec3};
use powerhouse::wavefield::{
    Angle, PlaneWave, PlaneWaveParameters, Ricker, RickerQuantity, WaveKind,
};
use powerhouse::{
    Boundary, InitialMotion, Material, OutputPlan, Part, ResidualLimit, RunHooks, Scene, TimeStep,
};
use powerhouse_examples::{Figures, Outcome};
use powerhouse_study::advice::BoundaryKind;
use powerhouse_study::{
    OpeningSlice, ShellOctant, advise_boundary, grown, largest_error, probe_errors,
};

/// Elastic medium of all three scenes.
fn rock() -> Outcome<ElasticMedium> {
    Ok(ElasticMedium::new(9.0e9, 0.27, 2750.0)?)
}

/// Scene whose boundary is to be chosen.
trait Question {
    /// Name in the names of figures.
    fn name(&self) -> &'static str;
    /// Permitted relative error.
    fn stated(&self) -> f64;
    /// The mesh, and the same extended so far that no reflection returns within the run.
    fn meshes(&self) -> Outcome<[Mesh; 2]>;
    /// The scene on a mesh; waves enter through the faces, or around a region.
    fn scene(
        &self,
        mesh: Mesh,
        condition: Arc<dyn AbsorbingBoundary>,
        region: Option<Vec<u32>>,
    ) -> Outcome<Scene>;
}

fn boundary(
    condition: Arc<dyn AbsorbingBoundary>,
    faces: &[&str],
    centre: Vec3,
    region: Option<Vec<u32>>,
) -> Boundary {
    let mut boundary = Boundary::new(condition, faces.iter().copied());
    boundary.scatterer = Some(centre);
    boundary.region = region;
    boundary
}

/// Output of displacement and velocity of several points at every step.
const MOTION: Motion = Motion {
    acceleration: false,
    ..Motion::ALL
};

/// Output of the motion of several points at every step.
fn output(places: &[(&str, ObservationPoint)], wanted: Motion) -> OutputPlan {
    let every_step = OutputPlan::default().with_every(f64::MIN_POSITIVE);
    let places = places.iter().cloned();
    places.fold(every_step, |output, (name, spot)| {
        output.history(name, spot, wanted)
    })
}

/// A wave of a Ricker pulse that passes a point at time zero.
fn wave(
    kind: WaveKind,
    [incidence, azimuth]: [f64; 2],
    frequency: f64,
    reference: Vec3,
) -> Outcome<PlaneWave> {
    let mut parameters = PlaneWaveParameters::vertical(kind, rock()?, 0.0);
    parameters.incidence = Angle::from_degrees(incidence);
    parameters.azimuth = Angle::from_degrees(azimuth);
    parameters.reference = reference;
    let pulse = Ricker::new(RickerQuantity::Displacement, 1.0e-3, frequency, 0.0)?;
    Ok(PlaneWave::new(parameters, Arc::new(pulse))?)
}

/// Layer thicknesses (m) that grow from a first to a longest one and add up to a distance.
fn layers(first: f64, longest: f64, distance: f64) -> Vec<f64> {
    let (mut layers, mut reached, mut next) = (Vec::new(), 0.0, first);
    while reached < distance {
        layers.push(next);
        reached += next;
        next = (1.15 * next).min(longest);
    }
    layers
}

/// A shallow round opening in a slice, under a vertically incident P wave.
struct Slice {
    half_width: f64,
    height: f64,
    brick: f64,
}

const RADIUS: f64 = 2.0;
const DEPTH: f64 = 4.0;

impl Slice {
    const FACES: [&'static str; 3] = ["left", "right", "bottom"];

    /// Peak frequency: waves of S four times as long as the opening's diameter (Hz).
    fn frequency() -> Outcome<f64> {
        Ok(rock()?.s_speed() / (16.0 * RADIUS))
    }

    /// Start and end of the run (s): before the pulse reaches the bottom, and after the return travel time to
    /// the faces.
    fn window(&self) -> Outcome<[f64; 2]> {
        let pulse = 1.3 / Self::frequency()?;
        let way = self.height / rock()?.p_speed();
        Ok([
            -pulse - way,
            pulse + 3.0 * self.half_width / rock()?.s_speed(),
        ])
    }
}

impl Question for Slice {
    fn name(&self) -> &'static str {
        "slice_p"
    }
    fn stated(&self) -> f64 {
        0.05
    }
    fn meshes(&self) -> Outcome<[Mesh; 2]> {
        let slice = OpeningSlice {
            radius: RADIUS,
            depth: DEPTH,
            half_width: self.half_width,
            height: self.height,
            fine: self.brick,
            coarse: [2.0 * self.brick; 2],
            growth: 1.1,
        };
        let mesh = slice.mesh()?;
        let beyond = 0.5 * rock()?.p_speed() * self.window()?[1];
        let mut wide = mesh.clone();
        for face in Self::FACES {
            let layers = layers(2.0 * self.brick, 4.0 * self.brick, beyond);
            wide = grown(&wide, face, &layers)?;
        }
        Ok([mesh, wide])
    }
    fn scene(
        &self,
        mesh: Mesh,
        condition: Arc<dyn AbsorbingBoundary>,
        region: Option<Vec<u32>>,
    ) -> Outcome<Scene> {
        let cuts = [mesh.facet_set("front")?, mesh.facet_set("back")?].concat();
        let cuts = mesh.nodes_of_facets(&cuts);
        let centre = Vec3::new(0.0, 0.0, -DEPTH);
        let on_wall = |x: f64, z: f64| {
            ObservationPoint::at(centre + RADIUS * Vec3::new(x, 0.0, z)).within(0.1 * RADIUS)
        };
        let places = [
            ("crown", on_wall(0.0, 1.0)),
            ("floor", on_wall(0.0, -1.0)),
            ("spring", on_wall(1.0, 0.0)),
            ("surface", ObservationPoint::at(Vec3::zeros())),
            (
                "aside",
                ObservationPoint::at(Vec3::new(-2.0 * RADIUS, 0.0, 0.0)),
            ),
        ];
        let [start, end] = self.window()?;
        let wave = wave(WaveKind::P, [0.0; 2], Self::frequency()?, centre)?;
        Ok(Scene::new("slice", mesh)
            .part(Part::new(
                "rock",
                Material::from(LinearElastic::new(rock()?)),
            ))
            .support(Support::roller(cuts, Vec3::y()))
            .with_plane_waves(vec![wave])?
            .with_boundary(boundary(condition, &Self::FACES, centre, region))
            .with_start_time(start)
            .with_initial_motion(InitialMotion::Rest)
            .with_duration(end - start)
            .with_energy_residual(ResidualLimit::Unchecked)
            .with_output(output(&places, MOTION)))
    }
}

/// A block with a cavern, under an SV wave at 25 degrees with an azimuth of 30 degrees.
struct Block {
    /// Numbers of elements from the centre to the sides and to the bottom; the cavern is four wide and high.
    cells: [usize; 2],
    /// Element edge (m).
    brick: f64,
}

impl Block {
    const FACES: [&'static str; 5] = ["left", "right", "front", "back", "bottom"];

    fn centre(&self) -> Vec3 {
        Vec3::new(0.0, 0.0, -6.0 * self.brick)
    }
    /// Peak frequency: waves of S 16 bricks long (Hz).
    fn frequency(&self) -> Outcome<f64> {
        Ok(rock()?.s_speed() / (16.0 * self.brick))
    }
    fn window(&self) -> Outcome<[f64; 2]> {
        let pulse = 1.3 / self.frequency()?;
        let (side, s_speed) = (self.cells[0] as f64 * self.brick, rock()?.s_speed());
        let below = self.cells[1] as f64 * self.brick;
        // The wave arrives at a lower edge.
        let way = below + 2.0 * side * 25.0_f64.to_radians().sin();
        Ok([-pulse - way / s_speed, pulse + 3.0 * side / s_speed])
    }
}

impl Question for Block {
    fn name(&self) -> &'static str {
        "block_sv25"
    }
    /// The faces are three radii from the centre of the cavern, and the shortest waves are twice its width.
    fn stated(&self) -> f64 {
        0.3
    }
    fn meshes(&self) -> Outcome<[Mesh; 2]> {
        let [aside, below] = self.cells;
        let (width, height) = (aside as f64 * self.brick, (6 + below) as f64 * self.brick);
        let (low, high) = (
            Vec3::new(-width, -width, -height),
            Vec3::new(width, width, 0.0),
        );
        let cells = [2 * aside, 2 * aside, 6 + below];
        let block = Mesh::box_of_hexes(low, high, cells, "rock")?;
        let half = Vec3::repeat(2.0 * self.brick);
        let cavern = block.elements_in_box(&(self.centre() - half), &(self.centre() + half));
        let mesh = without(&block, &cavern)?;
        let beyond = 0.5 * rock()?.p_speed() * self.window()?[1];
        let mut wide = mesh.clone();
        for face in Self::FACES {
            wide = grown(&wide, face, &layers(self.brick, 3.0 * self.brick, beyond))?;
        }
        Ok([mesh, wide])
    }
    fn scene(
        &self,
        mesh: Mesh,
        condition: Arc<dyn AbsorbingBoundary>,
        region: Option<Vec<u32>>,
    ) -> Outcome<Scene> {
        let half = 2.0 * self.brick;
        let on_wall =
            |x: f64, z: f64| ObservationPoint::at(self.centre() + half * Vec3::new(x, 0.0, z));
        let places = [
            ("crown", on_wall(0.0, 1.0)),
            ("floor", on_wall(0.0, -1.0)),
            ("wall", on_wall(1.0, 0.0)),
            ("surface", ObservationPoint::at(Vec3::zeros())),
        ];
        let [start, end] = self.window()?;
        let wave = wave(WaveKind::SV, [25.0, 30.0], self.frequency()?, self.centre())?;
        Ok(Scene::new("block", mesh)
            .part(Part::new(
                "rock",
                Material::from(LinearElastic::new(rock()?)),
            ))
            .with_plane_waves(vec![wave])?
            .with_boundary(boundary(condition, &Self::FACES, self.centre(), region))
            .with_start_time(start)
            .with_initial_motion(InitialMotion::Rest)
            .with_duration(end - start)
            .with_energy_residual(ResidualLimit::Unchecked)
            .with_output(output(&places, MOTION)))
    }
}

/// The mesh without some elements and their orphan nodes.
fn without(mesh: &Mesh, elements: &[u32]) -> Outcome<Mesh> {
    let kept = (0..mesh.element_count() as u32).filter(|e| elements.binary_search(e).is_err());
    Ok(mesh.of_elements(&kept.collect::<Vec<u32>>())?)
}

/// One octant of a spherical cavity under a pressure step.
struct Sphere {
    /// Outer radius over the radius of the cavity.
    far: f64,
    /// Elements along a side of a patch.
    around: usize,
    /// End of the run (s).
    duration: f64,
}

const CAVITY: f64 = 10.0;
/// Rise time of the pressure (s).
const RISE: f64 = 2.0e-3;

impl Question for Sphere {
    fn name(&self) -> &'static str {
        "sphere_pressure"
    }
    fn stated(&self) -> f64 {
        0.05
    }
    fn meshes(&self) -> Outcome<[Mesh; 2]> {
        let rings = 8 * self.around;
        let octant = |rings_beyond: usize| {
            let ratio = self.far.powf((rings + rings_beyond) as f64 / rings as f64);
            ShellOctant {
                inner: CAVITY,
                outer: CAVITY * ratio,
                around: self.around,
                rings: rings + rings_beyond,
            }
            .mesh()
        };
        let beyond = self.far + 0.5 * rock()?.p_speed() * self.duration / CAVITY;
        let more = rings as f64 * (beyond.ln() / self.far.ln() - 1.0);
        Ok([octant(0)?, octant(more.ceil() as usize)?])
    }
    fn scene(
        &self,
        mesh: Mesh,
        condition: Arc<dyn AbsorbingBoundary>,
        _: Option<Vec<u32>>,
    ) -> Outcome<Scene> {
        let mut supports = Vec::new();
        for (cut, normal) in [
            ("left", Vec3::x()),
            ("front", Vec3::y()),
            ("bottom", Vec3::z()),
        ] {
            let nodes = mesh.nodes_of_facets(mesh.facet_set(cut)?);
            supports.push(Support::roller(nodes, normal));
        }
        let history = Box::new(|time: f64| 1.0e6 * (time / RISE).min(1.0));
        let wall = mesh.facet_set("wall")?;
        let pressure = FacePressure::new(&mesh, wall, Profile::Uniform, history)?;
        let places = [("wall", ObservationPoint::at(Vec3::new(CAVITY, 0.0, 0.0)))];
        let scene = Scene::new("sphere", mesh)
            .part(Part::new(
                "rock",
                Material::from(LinearElastic::new(rock()?)),
            ))
            .with_boundary(boundary(condition, &["outside"], Vec3::zeros(), None))
            .load(pressure)
            .with_duration(self.duration)
            .with_energy_residual(ResidualLimit::Unchecked)
            .with_output(output(&places, Motion::DISPLACEMENT));
        Ok(supports.into_iter().fold(scene, Scene::support))
    }
}

/// Computes the advice for a scene, and measures the errors of all boundaries.
fn ask(question: &dyn Question, figures: &mut Figures) -> Outcome<()> {
    let figure = |of: &str| format!("boundary_advice.{}.{of}", question.name());
    let default = Arc::new(powerhouse::boundary::ViscousSpring::default());
    let [mesh, wide] = question.meshes()?;
    let scene = question.scene(mesh.clone(), default, None)?.into();
    let advice = advise_boundary(&scene, question.stated())?;
    println!("{advice}");

    // Both meshes have the same time step.
    let step = 0.95 * scene.prepare()?.stable_step()?.step;
    let run =
        |mesh: Mesh, kind: &BoundaryKind, region: Option<Vec<u32>>| -> Outcome<HistoryTable> {
            let scene = question.scene(mesh, advice.condition(kind)?, region)?;
            let scene = scene.with_step(TimeStep::Seconds(step));
            Ok(scene
                .prepare()?
                .run(RunHooks::default())?
                .histories()
                .clone())
        };
    let best = &advice.candidates.first().ok_or("no candidate")?.kind;
    // Waves enter through the elements behind the small mesh's faces, so that both meshes have the same dispersion.
    let inside = (0..mesh.element_count() as u32).collect();
    let reference = run(wide, best, Some(inside))?;
    figures.report(&figure("stated"), question.stated(), "the stated error");
    for (place, candidate) in advice.candidates.iter().enumerate() {
        let found = run(mesh.clone(), &candidate.kind, None)?;
        let measured = largest_error(&probe_errors(&found, &reference)?);
        let (predicted, name) = (candidate.predicted, candidate.kind.name());
        println!("{name}: predicted {predicted:.4}, measured {measured:.4}");
        let is_recommended = advice.recommended().is_some_and(|named| named == candidate);
        let remark = if is_recommended {
            "of the boundary that is named"
        } else {
            "of another boundary"
        };
        let of = |what: &str| {
            if is_recommended {
                figure(what)
            } else {
                figure(&format!("other{place}.{what}"))
            }
        };
        figures.report(&of("predicted"), predicted, remark);
        if is_recommended {
            figures.at_most(&of("measured"), measured, question.stated());
        } else {
            figures.report(&of("measured"), measured, remark);
        }
    }
    // Without a recommended boundary nothing is shown.
    let unnamed = f64::from(u8::from(advice.recommended().is_none()));
    figures.at_most(&figure("unnamed"), unnamed, 0.0);
    Ok(())
}

fn figures(questions: &[&dyn Question]) -> Outcome<Figures> {
    let mut figures = Figures::default();
    for question in questions {
        ask(*question, &mut figures)?;
    }
    Ok(figures)
}

fn main() -> Outcome<ExitCode> {
    let slice = Slice {
        half_width: 40.0,
        height: 30.0,
        brick: 0.4,
    };
    let block = Block {
        cells: [10, 8],
        brick: 5.0,
    };
    let sphere = Sphere {
        far: 4.0,
        around: 8,
        duration: 0.3,
    };
    Ok(figures(&[&slice, &block, &sphere])?.verdict())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// On a small version of the slice the recommended boundary meets the permitted error.
    #[test]
    fn the_named_boundary_meets_the_stated_error() {
        let slice = Slice {
            half_width: 40.0,
            height: 30.0,
            brick: 0.8,
        };
        assert_eq!(figures(&[&slice]).unwrap().missed(), 0);
    }
}
