//! The free field and the boundary of this project in the loop of another finite element code.
//!
//! Builds on `free_field`. The loop, `fe_loop.rs`, a hundred lines, has its own elements, masses and time integration. It
//! takes the crates `powerhouse-wavefield` and `powerhouse-boundary`, with `powerhouse-model` for the mesh, alone.
//!
//! ```text
//!            free surface, z = 120 m
//!        +-----------x-----------+      x  monitoring point
//!   =))  |     8 x 6 x 4 bricks  |  ((=     =))  springs, dashpots and input forces
//!   =))  |     of some 30 m      |  ((=
//!        +-----------------------+
//!      ^    ^  ^^   ^^   ^^   ^^        SV and P waves at 20 degrees, azimuth 30
//! ```
//!
//! The same ground in a scene must move alike: the two codes differ by rounding.
//!
//! Run: `cargo run --release --example own_loop`

use std::process::ExitCode;
use std::sync::Arc;

use powerhouse::boundary::ViscousSpring;
use powerhouse::engine::SolidKernel;
use powerhouse::engine::observe::Motion;
use powerhouse::material::LinearElastic;
use powerhouse::model::{ElasticMedium, Mesh, Vec3};
use powerhouse::{Boundary, Material, OutputPlan, Part, RunHooks, Scene, TimeStep};
use powerhouse_examples::fe_loop::Ground;
use powerhouse_examples::{Figures, Outcome};
use powerhouse_wavefield::{
    Angle, PlaneWave, PlaneWaveParameters, RaisedCosinePulse, WaveKind, first_hit_corner,
};

const EDGE: f64 = 30.0;
const CELLS: [usize; 3] = [8, 6, 4];
/// Step and duration (s).
const STEP: f64 = 3e-3;
const STEPS: usize = 400;

fn high() -> Vec3 {
    Vec3::new(CELLS[0] as f64, CELLS[1] as f64, CELLS[2] as f64) * EDGE
}

/// Bricks whose corners within the ground are shifted by a few metres.
fn mesh() -> Outcome<Mesh> {
    let straight = Mesh::box_of_hexes(Vec3::zeros(), high(), CELLS, "rock")?;
    let inside = |at: &Vec3| {
        let bumps = [0, 1, 2].map(|c| (std::f64::consts::PI * at[c] / high()[c]).sin());
        bumps.iter().product::<f64>()
    };
    Ok(straight.map_positions(|at| at + Vec3::new(4.0, -3.0, 2.0) * inside(&at))?)
}

fn field(kind: WaveKind, rock: ElasticMedium) -> Outcome<PlaneWave> {
    let mut parameters = PlaneWaveParameters::vertical(kind, rock, high().z);
    parameters.incidence = Angle::from_degrees(20.0);
    parameters.azimuth = Angle::from_degrees(30.0);
    parameters.reference = first_hit_corner(&Vec3::zeros(), &high(), &parameters.direction());
    let pulse = RaisedCosinePulse::new(0.02, 0.25)?;
    Ok(PlaneWave::new(parameters, Arc::new(pulse))?)
}

/// Largest difference of the motions of both codes over the largest motion, and the latter (m).
fn difference(kind: WaveKind) -> Outcome<(f64, f64)> {
    let rock = ElasticMedium::new(9.0e9, 0.27, 2750.0)?;
    let faces = ["left", "right", "front", "back", "bottom"];
    let scatterer = Vec3::new(0.5 * high().x, 0.5 * high().y, high().z);
    let ground = Ground {
        mesh: mesh()?,
        medium: rock,
        absorbing: faces.map(String::from).to_vec(),
        scatterer,
    };
    let point = Vec3::new(5.0, 3.0, CELLS[2] as f64) * EDGE;
    let near = ground.mesh.nodes_in_box(&point, &point);
    let probe = *near.first().ok_or("there is no node at the point")?;
    let own = ground.run(&field(kind, rock)?, (STEPS, STEP), probe)?;

    let mut part = Part::new("rock", Material::from(LinearElastic::new(rock)));
    part.kernel = Some(SolidKernel::Hex8Full.into());
    let boundary = Boundary::new(ViscousSpring::default(), faces).with_scatterer(scatterer);
    let results = Scene::new("own loop", ground.mesh)
        .part(part)
        .with_boundary(boundary)
        .with_field(field(kind, rock)?)
        .with_step(TimeStep::Seconds(STEP))
        .with_duration(STEPS as f64 * STEP)
        .with_output(
            // A row of every step, as the other code has them.
            OutputPlan::default()
                .with_every(STEP)
                .history("probe", point, Motion::DISPLACEMENT),
        )
        .prepare()?
        .run(RunHooks::default())?;

    let (mut largest, mut peak) = (0.0_f64, 0.0_f64);
    for (row, &time) in results.histories().times.iter().enumerate() {
        let own = own[(time / STEP).round() as usize];
        for (axis, column) in results.histories().columns.iter().enumerate() {
            largest = largest.max((own[axis] - column.values[row]).abs());
            peak = peak.max(column.values[row].abs());
        }
    }
    Ok((largest / peak, peak))
}

fn figures() -> Outcome<Figures> {
    let mut figures = Figures::default();
    for (name, kind) in [("sv", WaveKind::SV), ("p", WaveKind::P)] {
        let (difference, peak) = difference(kind)?;
        println!("peak of the motion: {peak:.3e} m");
        figures.at_most(&format!("own_loop.difference.{name}"), difference, 1e-10);
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
