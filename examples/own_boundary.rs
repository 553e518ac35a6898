//! A user-defined absorbing boundary in a scene.
//!
//! Builds on `absorbing_box`. Dashpots with the impedances of P and S waves (Lysmer & Kuhlemeyer,
//! 1969), implemented with the public trait, with the input forces of the free field. The results must
//! equal those of the built-in boundary.
//!
//! ```text
//!        +-----------x-----------+   free surface, z = 100 m, monitoring point x
//!   |=   |                       |   =|
//!   |=   |      rock, 100 m      |   =|     |=  a dashpot per node and direction,
//!   |=   |                       |   =|         and the force of the free field
//!        +-----------------------+
//!          =   =   =   =   =   =     P wave in at 20 degrees
//! ```
//!
//! Run: `cargo run --release --example own_boundary`

use std::process::ExitCode;
use std::sync::Arc;

use powerhouse::boundary::Viscous;
use powerhouse::engine::observe::Motion;
use powerhouse::material::{LinearElastic, media};
use powerhouse::model::{
    AbsorbingBoundary, BoundaryParts, BoundarySite, FieldMotion, FieldSampler, Mat3, Mesh,
    ModelError, NodalImpedance, NodalLoad, SiteNode, Vec3,
};
use powerhouse::wavefield::{Angle, PlaneWave, PlaneWaveParameters, RaisedCosinePulse, WaveKind};
use powerhouse::{Boundary, Material, OutputPlan, Part, RunHooks, Scene};
use powerhouse_examples::Figures;

/// Viscous boundary: dashpots at every face, with the impedances of plane waves along its normal.
struct Dashpots;

/// Dashpot matrix of a node (N s/m), the sum over all faces at the node.
fn dashpot(node: &SiteNode) -> Mat3 {
    let of_face = |face: &powerhouse::model::SiteFace| {
        let medium = &face.medium;
        let along_normal = face.normal * face.normal.transpose();
        let in_plane = Mat3::identity() - along_normal;
        let (p, s) = (medium.p_speed(), medium.s_speed());
        (along_normal * p + in_plane * s) * (medium.density * face.area)
    };
    node.faces.iter().map(of_face).sum()
}

impl AbsorbingBoundary for Dashpots {
    fn name(&self) -> &str {
        "dashpots"
    }
    fn build(&self, site: &BoundarySite) -> Result<BoundaryParts, ModelError> {
        let mut parts = BoundaryParts::default();
        for node in &site.nodes {
            parts
                .impedance
                .push(NodalImpedance::new(node.node, Mat3::zeros(), dashpot(node)));
        }
        if let Some(field) = site.field {
            let points: Vec<Vec3> = site.nodes.iter().map(|node| node.position).collect();
            parts.loads.push(Box::new(GroundMotion {
                nodes: site.nodes.iter().map(|node| node.node).collect(),
                dashpots: site.nodes.iter().map(dashpot).collect(),
                areas: site.nodes.iter().map(vector_area).collect(),
                motion: vec![FieldMotion::default(); points.len()],
                sampler: field.prepare(&points)?,
            }));
        }
        Ok(parts)
    }
}

fn vector_area(node: &SiteNode) -> Vec3 {
    node.faces.iter().map(|face| face.normal * face.area).sum()
}

/// Equivalent nodal forces of the free field: `C v + sigma n A`.
struct GroundMotion {
    nodes: Vec<u32>,
    dashpots: Vec<Mat3>,
    areas: Vec<Vec3>,
    motion: Vec<FieldMotion>,
    sampler: Box<dyn FieldSampler>,
}

impl NodalLoad for GroundMotion {
    fn name(&self) -> &str {
        "ground motion"
    }
    fn nodes(&self) -> &[u32] {
        &self.nodes
    }
    fn add_forces(&mut self, time: f64, forces: &mut [Vec3]) {
        self.motion.fill(FieldMotion::default());
        self.sampler.add_motion(time, &mut self.motion);
        for (i, motion) in self.motion.iter().enumerate() {
            forces[i] +=
                self.dashpots[i] * motion.velocity + motion.stress.traction(&self.areas[i]);
        }
    }
}

/// The motion of the centre of the surface, component by component.
fn surface_motion(
    boundary: impl AbsorbingBoundary + 'static,
) -> Result<Vec<f64>, Box<dyn std::error::Error>> {
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(100.0), [10; 3], "rock")?;
    let mut parameters = PlaneWaveParameters::vertical(WaveKind::P, media::ROCK, 100.0);
    parameters.incidence = Angle::from_degrees(20.0);
    let pulse = RaisedCosinePulse::new(0.01, 0.2)?;
    let centre = Vec3::new(50.0, 50.0, 100.0);
    let results = Scene::new("own boundary", mesh)
        .part(Part::new(
            "rock",
            Material::from(LinearElastic::new(media::ROCK)),
        ))
        .with_field(PlaneWave::new(parameters, Arc::new(pulse))?)
        .with_boundary(Boundary::new(
            boundary,
            ["left", "right", "front", "back", "bottom"],
        ))
        .with_duration(0.6)
        .with_output(OutputPlan::default().history("centre", centre, Motion::DISPLACEMENT))
        .prepare()?
        .run(RunHooks::default())?;
    let columns = results.histories().columns.iter();
    Ok(columns.flat_map(|column| &column.values).copied().collect())
}

fn figures() -> Result<Figures, Box<dyn std::error::Error>> {
    let own = surface_motion(Dashpots)?;
    let built_in = surface_motion(Viscous::default())?;
    let peak = built_in.iter().fold(0.0_f64, |peak, u| peak.max(u.abs()));
    let pairs = own.iter().zip(&built_in);
    let largest = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    println!("peak of the surface motion: {peak:.3e} m");
    let mut figures = Figures::default();
    figures.at_most("own_boundary.difference", largest / peak, 1e-12);
    Ok(figures)
}

fn main() -> Result<ExitCode, Box<dyn std::error::Error>> {
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
