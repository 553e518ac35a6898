//! Substitute model of loads: a spherical cavity under a pressure step.

use core::f64::consts::FRAC_PI_2;
use std::sync::Arc;

use powerhouse::boundary::{Spreading, ViscousSpring};
use powerhouse::engine::observe::Motion;
use powerhouse::engine::{FacePressure, Profile, Support};
use powerhouse::material::LinearElastic;
use powerhouse::model::{AbsorbingBoundary, Mesh, ModelError, Vec3};
use powerhouse::{
    Boundary, Error, Material, OutputPlan, Part, ResidualLimit, RunHooks, Scene, TimeStep,
};

use super::candidate::{BoundaryKind, Surroundings};
use super::setting::BoundaryProblem;
use crate::{ShellOctant, StudyError, largest_error, probe_errors};

/// Elements along a side of a patch.
const AROUND: usize = 4;
/// Elements along the radius, per radius of the cavity at its wall.
const ALONG: f64 = 20.0;
/// Travel times of P waves to the boundary after which the motion has ended.
const WAYS: f64 = 50.0;
/// Rise time of the pressure over the travel time of a P wave along the radius.
const RISE: f64 = 0.5;
/// Time step over the stable step.
const STEP_SHARE: f64 = 0.95;

/// A spherical cavity with the radius of the loaded structure, in a shell of ground up to the nearest face.
pub(super) struct Shell {
    inner: f64,
    outer: f64,
    surroundings: Surroundings,
    duration: f64,
}

impl Shell {
    /// The substitute model of a scene with the distances of the faces multiplied by `farther`, for a duration (s).
    pub(super) fn of(
        problem: &BoundaryProblem,
        farther: f64,
        duration: f64,
    ) -> Result<Self, StudyError> {
        let inner = problem.radius.ok_or(StudyError::NoBoundary)?;
        let distances = problem.least_distances();
        let outer = farther * distances.into_iter().fold(f64::INFINITY, f64::min);
        if outer < 1.2 * inner {
            return Err(StudyError::NearFace {
                distance: outer,
                least: 1.2 * inner,
            });
        }
        let surroundings = Surroundings {
            medium: problem.medium,
            spreading: Spreading::Spherical,
            distances: [outer; 3],
        };
        let longest = WAYS * outer / problem.medium.p_speed();
        Ok(Self {
            inner,
            outer,
            surroundings,
            duration: duration.min(longest),
        })
    }

    fn rings(&self) -> usize {
        (ALONG * (self.outer / self.inner).ln()).ceil().max(2.0) as usize
    }

    fn octant(&self, rings: usize) -> ShellOctant {
        // Rings beyond the outer face continue the geometric growth.
        let ratio = (self.outer / self.inner).ln() / self.rings() as f64;
        ShellOctant {
            inner: self.inner,
            outer: self.inner * (ratio * rings as f64).exp(),
            around: AROUND,
            rings,
        }
    }

    /// The error of displacement at the wall for each boundary, with the numbers of elements of both meshes.
    pub(super) fn errors(
        &self,
        kinds: &[BoundaryKind],
    ) -> Result<(Vec<f64>, [usize; 2]), StudyError> {
        let mesh = self.octant(self.rings()).mesh()?;
        let beyond = self.outer + 0.5 * self.surroundings.medium.p_speed() * self.duration;
        let share = (beyond / self.inner).ln() / (self.outer / self.inner).ln();
        let wide = self
            .octant((share * self.rings() as f64).ceil() as usize)
            .mesh()?;
        let counts = [mesh.element_count(), wide.element_count()];
        let default = Arc::new(ViscousSpring::default());
        let mut simulation = self.scene(mesh.clone(), default.clone())?.prepare()?;
        let stable = STEP_SHARE * simulation.stable_step()?.step;
        let step = self.duration / (self.duration / stable).ceil();
        let run = |mesh: Mesh, condition: Arc<dyn AbsorbingBoundary>| {
            let scene = self
                .scene(mesh, condition)?
                .with_step(TimeStep::Seconds(step));
            let results = scene.prepare()?.run(RunHooks::default())?;
            Ok::<_, StudyError>(results.histories().clone())
        };
        let reference = run(wide, default)?;
        let of_kind = |kind: &BoundaryKind| {
            let condition = kind
                .condition(&self.surroundings, &[])
                .map_err(Error::from)?;
            let found = run(mesh.clone(), condition)?;
            Ok(largest_error(&probe_errors(&found, &reference)?))
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
        condition: Arc<dyn AbsorbingBoundary>,
    ) -> Result<Scene, StudyError> {
        let mut supports = Vec::new();
        for (cut, normal) in [
            ("left", Vec3::x()),
            ("front", Vec3::y()),
            ("bottom", Vec3::z()),
        ] {
            let nodes = mesh.nodes_of_facets(mesh.facet_set(cut)?);
            supports.push(Support::roller(nodes, normal));
        }
        let rise = RISE * self.inner / self.surroundings.medium.p_speed();
        let history = move |time: f64| match time / rise {
            x if x < 1.0 => (FRAC_PI_2 * x).sin().powi(2),
            _ => 1.0,
        };
        let wall = mesh.facet_set("wall")?.to_vec();
        let pressure = FacePressure::new(&mesh, &wall, Profile::Uniform, Box::new(history));
        let pressure = pressure.map_err(|error| Error::from(ModelError::from(error)))?;
        let output = OutputPlan::default().with_every(f64::MIN_POSITIVE);
        let output = output.history(
            "wall",
            Vec3::new(self.inner, 0.0, 0.0),
            Motion::DISPLACEMENT,
        );
        let rock = Material::from(LinearElastic::new(self.surroundings.medium));
        let scene = Scene::new("cavity", mesh)
            .part(Part::new("rock", rock))
            .with_boundary(Boundary::new(condition, ["outside"]).with_scatterer(Vec3::zeros()))
            .load(pressure)
            .with_energy_residual(ResidualLimit::Unchecked)
            .with_duration(self.duration)
            .with_output(output)
            .allow_magnitudes();
        Ok(supports.into_iter().fold(scene, Scene::support))
    }
}
