//! Building of the dynamic model of a scene.

use std::sync::Arc;

use powerhouse_boundary::DomainReduction;
use powerhouse_elements::BoltSet;
use powerhouse_model::{
    AbsorbingBoundary, BoundaryParts, BoundarySite, Constraint, Facet, IncidentField, Mat3,
    ModelError, ModelSpec, NodalImpedance, State, Vec3,
};

use crate::engine::Leapfrog;
use crate::joint::{Closing, NamedSurface, WaterInJoints};
use crate::output::{OutputSite, Recordings, StateVariables};
use crate::places::placed;
use crate::stage::{Staging, Timeline, last_renewal};
use crate::through::FieldInGround;
use crate::{
    Error, InitialMotion, Piece, Remark, ResidualLimit, Scene, Simulation, Subject, TimeStep,
    remark,
};

/// Tolerance of heights above a level, over the diagonal of the mesh.
const ROUNDING_OF_PLACE: f64 = 1e-9;
/// Error of the greatest force of bolts by the length of their segments from which a warning is given.
const COARSE_BOLTS: f64 = 0.05;
/// Instants of the run at which a prescribed displacement is evaluated, and the share of their interval over which it
/// begins.
const START_INSTANTS: usize = 2000;
const START_SHARE: f64 = 1e-3;
/// Displacement and velocity at the start, over the greatest of the run, above which a prescribed motion is sudden.
const SUDDEN_DISPLACEMENT: f64 = 1e-3;
const SUDDEN_VELOCITY: f64 = 0.1;

/// Specification of a model with all components, and the joint surfaces by name.
pub(crate) struct Moving<'a> {
    pub(crate) spec: ModelSpec<'a>,
    surfaces: Vec<NamedSurface>,
}

impl Scene {
    /// Simulation of the scene: model built and checked, nodes renumbered, elements packed, boundary prepared.
    /// Construction stages are checked here and computed by the run.
    ///
    /// # Errors
    /// The first thing that does not fit, named by the user's sets and numbers.
    pub fn prepare(self) -> Result<Simulation, Error> {
        let places = self.places.clone();
        self.build()
            .map_err(|error| placed(places.as_ref(), Subject::OfError, error))
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
        self.check_magnitudes()?;
        self.check_names()?;
        self.check_threads();
        self.part_of_elements()?;
        self.check_mirrors()?;
        self.check_delayed()?;
        self.scatterer()?;
        let rims = self.rims()?;
        let (pieces, mut remarks) = self.pieces(&rims)?;
        let stiff = self.stiff_parts().into_iter();
        remarks.extend(stiff.map(Remark::StiffPart));
        remarks.extend(self.bay_times().map(Remark::BayTimes));
        remarks.extend(self.relative_in_bay());
        let timeline = Timeline::of(&self)?;
        remarks.extend(self.above_ground(timeline.as_ref()));
        remarks.extend(self.sudden_motions());
        remarks.extend(self.joints.iter().filter_map(|joint| {
            let (stage, renewal) = last_renewal(&self.stages, &joint.name)?;
            Some(Remark::from(remark::JointRenewed {
                joint: joint.name.clone(),
                stage: stage.map(str::to_owned),
                renewal,
            }))
        }));
        remarks.extend(self.reduced_joints()?);
        remarks.extend(self.undamped_friction()?);
        let state_variables = StateVariables::of(&self, &rims)?;
        let present = timeline.as_ref().and_then(Timeline::present);
        // Remarks about output come before those about the model.
        let before = remarks.len();
        let fibre_site = self.fibre_site(&pieces, present)?;
        let own = core::mem::take(&mut self.constraints);
        let (mut model, mut recordings, observers) = {
            let mut spec = ModelSpec::new(&self.mesh);
            if let Some(timeline) = &timeline {
                spec = spec.start(timeline.bare_state(self.mesh.node_count()));
            }
            for constraint in own {
                spec = spec.constraint(constraint);
            }
            let Moving { spec, surfaces } =
                self.moving(spec, &pieces, timeline.as_ref(), &mut remarks)?;
            let bolts = timeline.iter();
            let bolts = bolts.flat_map(|timeline| timeline.bolts(self.stages.len()));
            let bolts: Vec<&BoltSet> = bolts.collect();
            remarks.extend(bolts.iter().filter_map(|set| {
                let (bolts, error) = (set.name().to_owned(), set.segment_error());
                (error > COARSE_BOLTS).then_some(Remark::from(remark::CoarseBolts { bolts, error }))
            }));
            for set in &bolts {
                remarks.extend(self.cut_bolts(set));
            }
            let pairs: Vec<(u32, u32)> = self.all_pairs().collect();
            let site = OutputSite {
                mesh: &self.mesh,
                plan: &self.output,
                present,
                band: self.output.band_on(self.engine.takes_every_step()),
                state_variables: &state_variables,
                parts: &self.parts,
                joints: &surfaces,
                bolts: &bolts,
                pairs: &pairs,
            };
            let mut of_output = Vec::new();
            let (recordings, observers) = Recordings::of(&site, &mut of_output)?;
            remarks.splice(before..before, of_output);
            (self.engine.build(spec)?, recordings, observers)
        };
        recordings.resolution = self.resolution()?;
        if self.boundary.is_some() {
            recordings.structure = self.structure()?;
        }
        self.remarks.append(&mut remarks);
        self.tables_made();
        if timeline.is_none() && self.start != 0.0 {
            let mut state = State::at_rest(self.mesh.node_count());
            state.time = self.start;
            let stateful = model.stateful();
            let stateful = stateful.ok_or_else(|| ModelError::lacking("states"))?;
            stateful.set_state(&state)?;
        }
        let initial = match (self.initial, self.field()) {
            (InitialMotion::Rest, _) => None,
            (InitialMotion::Field, Some(field)) => Some(field.clone()),
            (InitialMotion::Field, None) => return Err(Error::NoField),
        };
        let integrator = core::mem::replace(&mut self.integrator, Box::new(Leapfrog));
        let fibres = match &self.fibres {
            Some(options) => {
                let choice = fibre_site.choose(options, model.as_mut(), integrator.as_ref())?;
                choice.check(options)?;
                self.remarks.push(Remark::Fibres(Box::new(choice.clone())));
                Some(choice)
            }
            None => None,
        };
        Ok(Simulation {
            title: self.title.clone(),
            mesh: self.mesh.clone(),
            model,
            integrator,
            step,
            duration: self.duration,
            residual: self.residual,
            places: self.places.clone(),
            initial,
            fibre_site,
            fibres,
            plan: self.output.clone(),
            recordings,
            observers,
            variables: state_variables.variables.clone(),
            remarks: core::mem::take(&mut self.remarks),
            in_use: self.in_use.clone(),
            engine: self.engine.clone(),
            staging: timeline.map(|timeline| Staging {
                scene: self,
                pieces,
                timeline,
                variables: state_variables.of_laws,
            }),
        })
    }

    /// Gives the remarks about waves in layers the memory and accuracy of their tables, which all exist now.
    fn tables_made(&mut self) {
        let mut remarks = core::mem::take(&mut self.remarks);
        let of_layers = remarks.iter_mut().filter_map(|remark| match remark {
            Remark::Layered(remark::Layered { report, bytes, .. }) => Some((report, bytes)),
            _ => None,
        });
        for (wave, (report, bytes)) in self.layered_waves().iter().zip(of_layers) {
            *report = wave.report();
            *bytes = report.bytes;
        }
        self.remarks = remarks;
    }

    /// Warning about an in-situ stress that ends below the top of the body after the excavations of the first stage.
    fn above_ground(&self, timeline: Option<&Timeline>) -> Option<Remark> {
        let level = self.in_situ_stress.as_ref()?.level()?;
        let timeline = timeline?;
        let first = timeline.configurations.first()?;
        let there = |element: &u32| {
            timeline.absent.binary_search(element).is_err() && first.present[*element as usize]
        };
        let elements = (0..self.mesh.element_count() as u32).filter(there);
        let nodes = elements.flat_map(|element| self.mesh.nodes_of(element).iter());
        let heights = nodes.map(|&node| self.mesh.positions()[node as usize].z);
        let top = heights.fold(f64::NEG_INFINITY, f64::max);
        let (low, high) = self.mesh.bounding_box();
        let above = top - level > ROUNDING_OF_PLACE * (high - low).norm();
        above.then_some(Remark::from(remark::AboveGround { level, top }))
    }

    /// Warnings about prescribed motions that do not begin at rest, where the body does.
    fn sudden_motions(&self) -> Vec<Remark> {
        let mut remarks = Vec::new();
        if self.initial != InitialMotion::Rest {
            return Vec::new();
        }
        let interval = self.duration / START_INSTANTS as f64;
        for driven in self
            .prescribed
            .iter()
            .filter(|driven| !driven.nodes.is_empty())
        {
            let at = |time: f64| driven.displacement.value(self.start + time);
            let values: Vec<f64> = (0..=START_INSTANTS)
                .map(|i| at(i as f64 * interval))
                .collect();
            let farthest = values
                .iter()
                .fold(0.0_f64, |most, value| most.max(value.abs()));
            let changes = values
                .windows(2)
                .map(|pair| (pair[1] - pair[0]).abs() / interval);
            let [nodes, first] = [driven.nodes.len(), driven.nodes[0] as usize];
            let node = self.mesh.node_tags()[first];
            // Stages hold their value at the start.
            let displacement = if self.stages.is_empty() {
                values[0]
            } else {
                0.0
            };
            if displacement.abs() > SUDDEN_DISPLACEMENT * farthest {
                remarks.push(Remark::from(remark::PrescribedJump {
                    nodes,
                    node,
                    displacement,
                }));
            }
            let velocity = (at(START_SHARE * interval) - values[0]) / (START_SHARE * interval);
            let share = velocity.abs() / changes.fold(velocity.abs(), f64::max);
            if share > SUDDEN_VELOCITY {
                remarks.push(Remark::from(remark::PrescribedVelocity {
                    nodes,
                    node,
                    velocity,
                    share,
                }));
            }
        }
        remarks
    }

    /// Specification of the dynamic model without initial motion; warnings about its surroundings are added to the remarks.
    pub(crate) fn moving<'a>(
        &self,
        mut spec: ModelSpec<'a>,
        pieces: &[Piece],
        timeline: Option<&Timeline>,
        remarks: &mut Vec<Remark>,
    ) -> Result<Moving<'a>, Error> {
        let water = timeline
            .and_then(Timeline::water)
            .cloned()
            .unwrap_or_default();
        for piece in pieces {
            let factory = piece.moving(&self.parts[piece.part], self.precision, &water);
            spec = spec.elements(piece.elements.clone(), factory);
        }
        let present = timeline.and_then(Timeline::present);
        let parts = self.boundary_parts(present, remarks)?;
        let warnings = self.gravity_warnings(parts.as_ref());
        remarks.extend(warnings);
        if let Some(parts) = parts {
            spec = spec.boundary(parts);
        }
        spec = self.acted_on(spec, None);
        for (mass, report) in self.added_masses(present)? {
            spec = spec.added_masses(mass.masses().iter().copied());
            remarks.push(Remark::AddedWater(report));
        }
        let last = timeline.and_then(Timeline::last);
        for load in last.iter().flat_map(|last| &last.joint_loads) {
            spec = spec.load(Box::new(load.clone()));
        }
        let in_joints = match last {
            Some(last) => last.in_joints.clone(),
            None => WaterInJoints::of(self).map_err(|source| Error::staging(None, source))?,
        };
        let wet = self.wet_joints(&in_joints, timeline.and_then(Timeline::water))?;
        remarks.extend(wet.into_iter().map(Remark::WetJoint));
        let (joints, surfaces) = self.constraints_of_joints(|_| Closing::Own, &in_joints)?;
        for joint in joints {
            spec = spec.constraint(Box::new(joint) as Box<dyn Constraint>);
        }
        if let Some(timeline) = timeline {
            for bolts in timeline.bolts(self.stages.len()) {
                spec = spec.embed(Box::new(bolts.clone()));
            }
        }
        if let Some(threads) = self.threads_taken() {
            spec = spec.threads(threads);
        }
        Ok(Moving { spec, surfaces })
    }

    /// Springs and dashpots of the absorbing boundary; `None` without a boundary. Faces of elements that are inactive in
    /// the run do not absorb.
    fn boundary_parts(
        &self,
        present: Option<&[bool]>,
        remarks: &mut Vec<Remark>,
    ) -> Result<Option<BoundaryParts>, Error> {
        let Some(boundary) = &self.boundary else {
            if let (Some(field), InitialMotion::Rest) = (self.field(), self.initial) {
                return Err(Error::UnusedField {
                    field: field.name().into(),
                    reason: "there is no boundary through which it comes in",
                });
            }
            return Ok(None);
        };
        let scatterer = self.scatterer()?;
        let all = self.absorbing_facets()?;
        self.check_faces(&all)?;
        let there = |facet: &Facet| present.is_none_or(|present| present[facet.element as usize]);
        let facets = all.iter().map(|(face, facets)| {
            let facets = facets.iter().copied().filter(there);
            (*face, facets.collect())
        });
        let facets: Vec<(&str, Vec<Facet>)> = facets.collect();
        let facets = facets.iter().map(|(face, facets)| (*face, &facets[..]));
        let facets: Vec<(&str, &[Facet])> = facets.collect();
        let medium = self.medium_of_elements()?;
        let field = self.field().map(|field| &**field);
        self.check_through()?;
        let in_ground = field.map(FieldInGround);
        let field = match (&in_ground, &boundary.through[..]) {
            (Some(in_ground), [_, ..]) => Some(in_ground as &dyn IncidentField),
            _ => field,
        };
        let site = BoundarySite::from_mesh(&self.mesh, &facets, medium, scatterer, field);
        let site = site.with_slowness(self.slowness_along_y());
        if let Some(field) = field {
            self.check_field(field, (&facets, &site))?;
        }
        remarks.extend(self.boundary_remarks(&facets, &site)?);
        let layer = self.region_layer(&site, present);
        let layer = layer.map_err(|error| match error {
            Error::Region(_) => self.placed(Subject::Region, error),
            other => other,
        })?;
        let condition: Arc<dyn AbsorbingBoundary> = match layer {
            None => boundary.condition.clone(),
            Some((layer, remark)) => {
                remarks.push(remark);
                Arc::new(DomainReduction::new(layer, boundary.condition.clone()))
            }
        };
        let parts = condition.build(&site);
        let parts = parts.map_err(|error| self.placed(Subject::Boundary, error.into()))?;
        let springs = |node: &NodalImpedance| node.spring != Mat3::zeros();
        if boundary.scatterer.is_none() && parts.impedance.iter().any(springs) {
            let position = scatterer;
            remarks.push(remark::Scatterer { position }.into());
        }
        if let (Some(field), []) = (field, &parts.loads[..]) {
            return Err(Error::UnusedField {
                field: field.name().into(),
                reason: "the boundary lets no motion in",
            });
        }
        Ok(Some(parts))
    }
}

/// Motion of a field at the nodes: displacement at `time` (m) and velocity half a step before (m/s).
pub(crate) fn field_motion(
    field: &dyn IncidentField,
    points: &[Vec3],
    time: f64,
    step: f64,
) -> Result<(Vec<Vec3>, Vec<Vec3>), Error> {
    let sampler = field.prepare(points)?;
    let mut motion = vec![powerhouse_model::FieldMotion::default(); points.len()];
    sampler.add_motion(time, &mut motion);
    let displacement = motion.iter().map(|m| m.displacement).collect();
    motion.fill(powerhouse_model::FieldMotion::default());
    sampler.add_motion(time - 0.5 * step, &mut motion);
    Ok((displacement, motion.iter().map(|m| m.velocity).collect()))
}
