//! Reflections of absorbing boundaries: a surface force in a box, compared with a box without reflections.
//!
//! Builds on `free_field`. There is no incident wave: the source is inside, like a scattering structure.
//!
//! ```text
//!                force(t), vertical
//!                     |
//!        +------------v------------+   free surface, z = 0
//!        |          ) | (          |
//!   =))  |        )   |   (        |  ((=    =))  absorbing faces
//!        |      )     |     (      |
//!        |    rock, 40 m across    |
//!        +-------------------------+   z = -20 m
//!             ^^^^^^^^^^^^^^^^^^
//! ```
//!
//! The motion next to the force is compared with that of a box so large that no reflection returns within the run.
//! Three boundaries are compared: fixed (total reflection), viscous, viscous-spring.
//!
//! Run: `cargo run --release --example absorbing_box`

use std::process::ExitCode;

use powerhouse::boundary::{InputMode, Viscous, ViscousSpring};
use powerhouse::engine::observe::Motion;
use powerhouse::engine::{NodalForce, Support};
use powerhouse::material::{LinearElastic, media};
use powerhouse::model::{AbsorbingBoundary, Mesh, Vec3};
use powerhouse::{Boundary, Material, OutputPlan, Part, RunHooks, Scene};
use powerhouse_examples::Figures;

type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

const FACES: [&str; 5] = ["left", "right", "front", "back", "bottom"];
/// Element edge (m); the S wave of the pulse is ten elements long.
const EDGE: f64 = 2.0;
/// Length of the pulse, and of the run (s).
const PULSE: f64 = 0.03;
const DURATION: f64 = 0.12;

/// Boundary condition on the five faces.
enum Faces {
    Held,
    Absorbing(Box<dyn AbsorbingBoundary>),
}

/// Displacement history next to the force, in a box of `cells` elements across.
fn surface_motion(cells: usize, faces: Faces) -> Outcome<Vec<f64>> {
    let half = EDGE * cells as f64 / 2.0;
    let (low, high) = (Vec3::new(-half, -half, -half), Vec3::new(half, half, 0.0));
    let mesh = Mesh::box_of_hexes(low, high, [cells, cells, cells / 2], "rock")?;
    let centre = mesh.nodes_in_box(&Vec3::repeat(-0.1), &Vec3::repeat(0.1));
    let beside = Vec3::new(4.0 * EDGE, 0.0, 0.0);
    let push = |time: f64| match time / PULSE {
        x if x < 1.0 => (std::f64::consts::PI * x).sin().powi(2),
        _ => 0.0,
    };
    let force = Vec3::new(0.0, 0.0, -1.0e6);
    let held: Vec<u32> = FACES
        .iter()
        .flat_map(|face| {
            mesh.facet_set(face)
                .map(|facets| mesh.nodes_of_facets(facets))
        })
        .flatten()
        .collect();
    let output = OutputPlan::default().with_every(1e-3);
    let scene = Scene::new("absorbing box", mesh)
        .part(Part::new(
            "rock",
            Material::from(LinearElastic::new(media::ROCK)),
        ))
        .load(NodalForce::new(centre, force, Box::new(push)))
        .with_duration(DURATION)
        .with_output(output.history("beside", beside, Motion::DISPLACEMENT));
    let scene = match faces {
        Faces::Held => scene.support(Support::fixed(held)),
        Faces::Absorbing(condition) => {
            scene.with_boundary(Boundary::new(condition, FACES).with_scatterer(Vec3::zeros()))
        }
    };
    let results = scene.prepare()?.run(RunHooks::default())?;
    let column = results.histories().column("beside.uz").ok_or("no column")?;
    Ok(column.values.clone())
}

fn figures() -> Outcome<Figures> {
    // The return travel time of P waves to the faces of this box is longer than the run.
    let large = (DURATION * media::ROCK.p_speed() / EDGE).ceil() as usize;
    let open = surface_motion(large + large % 2, Faces::Held)?;
    let peak = open.iter().fold(0.0_f64, |peak, u| peak.max(u.abs()));
    println!("{} m large box: peak {peak:.3e} m", EDGE * large as f64);

    let quiet = InputMode::Nothing;
    let viscous = Viscous {
        input: quiet.clone(),
    };
    let springs = ViscousSpring {
        input: quiet,
        ..ViscousSpring::default()
    };
    let mut figures = Figures::default();
    let nothing_holds = "nothing brings the box back";
    for (name, faces, limit, remark) in [
        ("held", Faces::Held, None, "everything comes back"),
        (
            "viscous",
            Faces::Absorbing(Box::new(viscous)),
            None,
            nothing_holds,
        ),
        (
            "viscous_spring",
            Faces::Absorbing(Box::new(springs)),
            Some(0.1),
            "",
        ),
    ] {
        let motion = surface_motion(20, faces)?;
        let rows = open.len().min(motion.len());
        let largest = (0..rows)
            .map(|row| (motion[row] - open[row]).abs())
            .fold(0.0, f64::max);
        let name = format!("absorbing_box.{name}.error");
        match limit {
            Some(limit) => figures.at_most(&name, largest / peak, limit),
            None => figures.report(&name, largest / peak, remark),
        }
    }
    Ok(figures)
}

fn main() -> Outcome<ExitCode> {
    Ok(figures()?.verdict())
}

#[cfg(test)]
mod tests {
    /// Every figure meets its limit.
    #[test]
    fn figures_meet_their_limits() {
        assert_eq!(super::figures().unwrap().missed(), 0);
    }
}
