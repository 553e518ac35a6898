//! From a scene to a model that can be stepped.

use std::collections::HashSet;

use powerhouse_explicit_core::observe::CutSource;
use powerhouse_explicit_core::{BlockOptions, Model, Rayleigh};
use powerhouse_model::{
    BoundarySite, ElementKind, IncidentField, Mat3, NodalImpedance, State, Vec3,
};

use super::joints::constraints;
use super::{InitialMotion, Places, ResidualLimit, Scene, TimeStep};
use crate::output::{Recordings, Remembered};
use crate::{Damping, DampingCost, Error, Material, Part, Remark, Simulation};

impl Scene {
    /// Builds the model: checks everything, renumbers, packs elements, prepares the boundary.
    ///
    /// # Errors
    /// The first thing that does not fit, named by the user's sets and numbers.
    pub fn prepare(self) -> Result<Simulation, Error> {
        let (source, places) = (self.source.clone(), self.places.clone());
        self.build().map_err(|error| places.put(&source, error))
    }

    fn build(mut self) -> Result<Simulation, Error> {
        let step = match self.step {
            TimeStep::OfStable(share) => {
                powerhouse_model::ParameterError::check("share", share, f64::MIN_POSITIVE, 1.0)?;
                self.step
            }
            fixed => fixed,
        };
        if let ResidualLimit::Share(limit) = self.residual {
            powerhouse_model::ParameterError::check(
                "energy_residual",
                limit,
                f64::MIN_POSITIVE,
                1.0,
            )?;
        }
        self.mesh.check()?;
        let owner = self.part_of_elements()?;
        let scatterer = self.scatterer()?;
        let rims = self.rims()?;
        let mut builder = Model::builder(&self.mesh);
        let mut blocks = Vec::new();
        let mut remarks = Vec::new();
        for (part, rim) in self.parts.iter().zip(&rims) {
            let doubts = part.material.doubts().iter();
            remarks.extend(doubts.map(|doubt| Remark::Material {
                set: part.set.clone(),
                doubt: doubt.clone(),
            }));
            let kinds = by_kind(&self, part)?;
            if let Some(kernel) = part.idle_kernel(kinds.iter().map(|(kind, _)| *kind)) {
                return Err(Error::IdleKernel {
                    set: part.set.clone(),
                    kernel: kernel.name().into(),
                });
            }
            let moving = part.moving_material()?;
            remarks.extend(facts(&self, part, &moving, rim)?);
            for (kind, elements) in kinds {
                let kernel = part.kernel_for(kind).ok_or_else(|| Error::NoKernel {
                    element: self.mesh.element_tags()[elements[0] as usize],
                    set: part.set.clone(),
                    kind: kind.name(),
                })?;
                let (at_rim, inner): (Vec<u32>, Vec<u32>) =
                    elements.iter().partition(|element| rim.contains(element));
                for (elements, material, damping) in [
                    (inner, moving.clone(), part.damping.rayleigh()),
                    (at_rim, part.rim_material(), Rayleigh::default()),
                ] {
                    if elements.is_empty() {
                        continue;
                    }
                    let mut options = BlockOptions::default();
                    options.precision = self.precision;
                    options.damping = damping;
                    let factory = || kernel.blocks(&part.set, &material, options);
                    builder = builder.elements(elements.clone(), factory());
                    blocks.push((elements, factory(), material.medium()));
                }
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
        let remembered = Remembered::of(&self, &rims)?;
        let mut observed = Recordings::observe(&self.output, &self.mesh, &sources, &remembered)?;
        if let Some(boundary) = &self.boundary {
            let facets = self.absorbing_facets()?;
            self.check_faces(&facets)?;
            let medium = |element: u32| {
                let part = owner[element as usize];
                let part = part.expect("facets belong to solids, and every solid to a part");
                self.parts[part].material.medium()
            };
            let field = self.field.as_deref();
            let site = BoundarySite::from_mesh(&self.mesh, &facets, medium, scatterer, field);
            if let Some(field) = field {
                self.check_field(field, &site)?;
            }
            remarks.extend(self.doubts_around(&facets, &site)?);
            let parts = boundary.condition.build(&site).map_err(|error| {
                Places::put_at(&self.source, self.places.boundary.clone(), error.into())
            })?;
            let springs = |node: &NodalImpedance| node.spring != Mat3::zeros();
            if boundary.scatterer.is_none() && parts.impedance.iter().any(springs) {
                let position = scatterer;
                remarks.push(Remark::Scatterer { position });
            }
            if let (Some(field), []) = (field, &parts.loads[..]) {
                return Err(Error::UnusedField {
                    field: field.name().into(),
                    reason: "the boundary lets no motion in",
                });
            }
            builder = builder.boundary(parts);
        } else if let (Some(field), InitialMotion::Rest) = (&self.field, self.initial) {
            return Err(Error::UnusedField {
                field: field.name().into(),
                reason: "there is no boundary through which it comes in",
            });
        }
        self.remarks.append(&mut remarks);
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
        let (joints, surfaces) = constraints(&self.mesh, self.joints)?;
        observed
            .0
            .watch_joints(&self.output, &self.mesh, surfaces, &mut observed.1)?;
        for joint in joints {
            builder = builder.constraint(Box::new(joint));
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
            (self.integrator, step),
            (self.duration, self.residual),
            (self.source, self.places),
            field,
            (self.output, observed),
            remembered.variables,
            self.remarks,
        ))
    }
}

/// What damping in series costs a part, and where it is elastic.
fn facts(
    scene: &Scene,
    part: &Part,
    moving: &Material,
    rim: &HashSet<u32>,
) -> Result<Vec<Remark>, Error> {
    let mut facts = Vec::new();
    let set = || part.set.clone();
    if let Damping::Flat {
        spectrum,
        reference,
    } = &part.damping
    {
        facts.push(Remark::FlatDamping {
            set: set(),
            cost: DampingCost::of(&part.material, moving, (spectrum, *reference))?,
        });
    }
    if let Some(width) = part.rim {
        facts.push(Remark::Rim {
            set: set(),
            width,
            elements: rim.len(),
            of: scene.mesh.element_set(&part.set)?.len(),
        });
    }
    Ok(facts)
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
