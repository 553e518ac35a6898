//! A constitutive law of one's own, in thirty lines, in a scene like any other.
//!
//! Builds on `free_field`. Soil that softens in shear: the modulus falls with the shear strain
//! `gamma` as `G / (1 + gamma / gamma_ref)` (the hyperbola of Hardin & Drnevich, 1972), without
//! hysteresis.
//!
//! ```text
//!      z = 0   +---+  free surface           a column of soil, 40 m, one element across,
//!              |   |                         held in z and y: an SV wave straight up moves
//!              | : |                         it along x
//!              |   |
//!     z = -40  +---+  absorbing, SV wave in
//! ```
//!
//! A wave of small strain must not notice the softening; a strong one is slowed down.
//!
//! Run: `cargo run --release --example own_law`

use std::process::ExitCode;
use std::sync::Arc;

use powerhouse::boundary::Viscous;
use powerhouse::engine::Support;
use powerhouse::engine::observe::Motion;
use powerhouse::material::LinearElastic;
use powerhouse::model::{ElasticMedium, HistoryVariable, LawInput, Mesh, PointLaw, Stress, Vec3};
use powerhouse::wavefield::{PlaneWave, PlaneWaveParameters, RaisedCosinePulse, WaveKind};
use powerhouse::{Boundary, Material, OutputPlan, Part, RunHooks, Scene};
use powerhouse_examples::Figures;

/// Soil whose shear modulus falls with the shear strain.
struct Hyperbolic {
    medium: ElasticMedium,
    /// The shear strain at which half the modulus is left.
    reference_strain: f64,
}

impl PointLaw for Hyperbolic {
    fn name(&self) -> &str {
        "hyperbolic"
    }
    fn medium(&self) -> ElasticMedium {
        self.medium
    }
    fn history(&self) -> &'static [HistoryVariable] {
        &[]
    }
    fn stress_change(&self, input: &LawInput<f64>, _new_history: &mut [f64]) -> Stress {
        let [.., xy, yz, zx] = input.strain.0;
        let shear_strain = (xy * xy + yz * yz + zx * zx).sqrt();
        let softening = 1.0 / (1.0 + shear_strain / self.reference_strain);
        let mut stress = Stress::elastic(self.medium.lambda(), self.medium.shear(), &input.strain);
        for shear in &mut stress.0[3..] {
            *shear *= softening;
        }
        stress
    }
}

type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

const DEPTH: f64 = 40.0;

/// The horizontal displacement of the surface over time, for an incident amplitude (m).
fn surface_motion(material: Material, amplitude: f64) -> Outcome<Vec<f64>> {
    let medium = material.medium();
    let low = Vec3::new(0.0, 0.0, -DEPTH);
    let mesh = Mesh::box_of_hexes(low, Vec3::new(1.0, 1.0, 0.0), [1, 1, 40], "soil")?;
    let all: Vec<u32> = (0..mesh.node_count() as u32).collect();
    let mut parameters = PlaneWaveParameters::vertical(WaveKind::SV, medium, 0.0);
    parameters.reference = low;
    let pulse = RaisedCosinePulse::new(amplitude, 0.4)?;
    let results = Scene::new("soil column", mesh)
        .part(Part::new("soil", material))
        .support(Support::roller(all.clone(), Vec3::y()))
        .support(Support::roller(all, Vec3::z()))
        .field(PlaneWave::new(parameters, Arc::new(pulse))?)
        .boundary(Boundary::new(Viscous::default(), ["bottom"]))
        .duration(1.5)
        .output(OutputPlan::default().history(
            "top",
            Vec3::new(0.5, 0.5, 0.0),
            Motion::DISPLACEMENT,
        ))
        .prepare()?
        .run(RunHooks::default())?;
    Ok(results
        .histories
        .column("top.ux")
        .ok_or("no column")?
        .values
        .clone())
}

/// Largest difference of two motions over the peak of the first.
fn difference(first: &[f64], second: &[f64]) -> f64 {
    let peak = first.iter().fold(0.0_f64, |peak, u| peak.max(u.abs()));
    let pairs = first.iter().zip(second);
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / peak
}

fn figures() -> Outcome<Figures> {
    let soil = ElasticMedium::new(100.0e6, 0.3, 1900.0)?;
    let elastic = || Material::new(LinearElastic::new(soil));
    let softening = || {
        Material::from_point_law(Hyperbolic {
            medium: soil,
            reference_strain: 1e-3,
        })
    };
    let mut figures = Figures::default();

    // Strains of about 1e-8 lie 1e-5 below the reference strain.
    let weak = difference(
        &surface_motion(elastic(), 1e-7)?,
        &surface_motion(softening(), 1e-7)?,
    );
    figures.at_most("own_law.weak.difference", weak, 1e-3);

    let strong = difference(
        &surface_motion(elastic(), 0.05)?,
        &surface_motion(softening(), 0.05)?,
    );
    figures.report(
        "own_law.strong.difference",
        strong,
        "a strong wave arrives late and changed",
    );
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
