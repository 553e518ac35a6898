//! From a scene to a model that can be stepped.

use core::ops::Range;
use std::sync::Arc;

use powerhouse_explicit_core::observe::CutSource;
use powerhouse_explicit_core::{BlockOptions, Model};
use powerhouse_model::{BoundarySite, ElementKind, IncidentField, State, Vec3};

use super::{InitialMotion, Scene, TimeStep};
use crate::output::Recordings;
use crate::{Error, Fault, Part, SceneFault, SceneText, Simulation};

impl Scene {
    /// Builds the model: checks everything, renumbers, packs elements, prepares the boundary.
    ///
    /// # Errors
    /// The first thing that does not fit, named by the user's sets and numbers.
    pub fn prepare(self) -> Result<Simulation, Error> {
        let step = match self.step {
            TimeStep::OfStable(share) => {
                powerhouse_model::ParameterError::check("share", share, f64::MIN_POSITIVE, 1.0)?;
                self.step
            }
            fixed => fixed,
        };
        let owner = self.part_of_elements()?;
        let scatterer = self.scatterer()?;
        let mut builder = Model::builder(&self.mesh);
        let mut blocks = Vec::new();
        for part in &self.parts {
            for (kind, elements) in by_kind(&self, part)? {
                let kernel = part.kernel_for(kind).ok_or_else(|| Error::NoKernel {
                    element: self.mesh.element_tags()[elements[0] as usize],
                    set: part.set.clone(),
                    kind: kind.name(),
                })?;
                let mut options = BlockOptions::default();
                options.precision = self.precision;
                options.damping = part.damping;
                let factory = || kernel.blocks(&part.set, &part.material, options);
                builder = builder.elements(elements.clone(), factory());
                blocks.push((elements, factory(), part.material.medium()));
            }
        }
        let sources: Vec<CutSource> = blocks
            .iter()
            .map(|(elements, factory, medium)| CutSource {
                elements,
                factory: factory.as_ref(),
                medium: *medium,
            })
            .collect();
        let observed = Recordings::observe(&self.output, &self.mesh, &sources)?;
        if let Some(boundary) = &self.boundary {
            let facets = self.absorbing_facets()?;
            let medium = |element: u32| {
                let part = owner[element as usize];
                let part = part.expect("facets belong to solids, and every solid to a part");
                self.parts[part].material.medium()
            };
            let field = self.field.as_deref();
            let site = BoundarySite::from_mesh(&self.mesh, &facets, medium, scatterer, field);
            let parts = boundary.condition.build(&site);
            let place = self.places.boundary.clone();
            builder = builder.boundary(parts.map_err(|e| placed(&self.source, place, e))?);
        }
        for support in self.supports {
            builder = builder.support(support);
        }
        for pairs in self.periodic {
            builder = builder.periodic(pairs);
        }
        for prescribed in self.prescribed {
            builder = builder.prescribed(prescribed);
        }
        for load in self.loads {
            builder = builder.load(load);
        }
        for (acceleration, history) in self.weights {
            builder = builder.gravity(acceleration, history);
        }
        for constraint in self.constraints {
            builder = builder.constraint(constraint);
        }
        if let Some(threads) = self.threads {
            builder = builder.threads(threads);
        }
        let mut model = builder.build()?;
        let mut state = State::at_rest(self.mesh.node_count());
        state.time = self.start;
        model.set_state(&state)?;
        let field = match (self.initial, self.field) {
            (InitialMotion::Rest, _) => None,
            (InitialMotion::Field, Some(field)) => Some(field),
            (InitialMotion::Field, None) => return Err(Error::NoField),
        };
        Ok(Simulation::new(
            (self.title, self.mesh, model),
            (self.integrator, step, self.duration),
            (self.source, self.places.step),
            field,
            (self.output, observed),
            self.remarks,
        ))
    }
}

/// An error where it stands in the scene's file, if the scene has one.
pub(crate) fn placed(
    source: &Option<Arc<SceneText>>,
    place: Range<usize>,
    error: impl Into<Error> + core::error::Error + Send + Sync + 'static,
) -> Error {
    match source {
        Some(text) => SceneFault::new(text.clone(), Fault::refused(place, error)).into(),
        None => error.into(),
    }
}

/// The elements of a part, kind by kind.
fn by_kind(scene: &Scene, part: &Part) -> Result<Vec<(ElementKind, Vec<u32>)>, Error> {
    let mut kinds: Vec<(ElementKind, Vec<u32>)> = Vec::new();
    for &element in scene.mesh.element_set(&part.set)? {
        let kind = scene.mesh.kind(element);
        match kinds.iter_mut().find(|(known, _)| *known == kind) {
            Some((_, elements)) => elements.push(element),
            None => kinds.push((kind, vec![element])),
        }
    }
    Ok(kinds)
}

/// The motion of a field at the nodes: displacement (m) at `time` and velocity (m/s) half a step
/// before it.
pub(crate) fn field_motion(
    field: &dyn IncidentField,
    points: &[Vec3],
    (time, step): (f64, f64),
) -> Result<(Vec<Vec3>, Vec<Vec3>), Error> {
    let sampler = field.prepare(points)?;
    let mut motion = vec![powerhouse_model::FieldMotion::default(); points.len()];
    sampler.add_motion(time, &mut motion);
    let displacement = motion.iter().map(|m| m.displacement).collect();
    motion.fill(powerhouse_model::FieldMotion::default());
    sampler.add_motion(time - 0.5 * step, &mut motion);
    Ok((displacement, motion.iter().map(|m| m.velocity).collect()))
}
