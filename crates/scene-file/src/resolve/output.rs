//! Output plan of a scene file.

use core::ops::Range;
use std::collections::BTreeMap;

use powerhouse_model::{MeshError, ModelError, Vec3};
use powerhouse_observe::{
    AccelerationRule, CrossSection, JointQuantities, Motion, ObservationPoint, Place,
    SectionReinforcement, SectionRing, SnapshotFields, StressPlace,
};

use super::{Names, check_reach, no_such_number, one_of, vector};
use crate::spec::{
    self, At, Finite, History, JointHistory, JointQuantity, NonNegative, Output, Positive,
    Quantity, Reinforcement, Ring, Section,
};
use powerhouse_scene::{
    EnvelopeRequest, Fault, HistoryRequest, JointRequest, JointZone, OutputPlan, Problem,
    RelativeRequest, SceneJoint, SectionRequest, SnapshotRequest, StressRequest,
};

/// Default number of samples of the energy balance in a run.
const ENERGY_SAMPLES: f64 = 100.0;

pub(super) fn plan(
    names: &Names,
    output: &Output,
    joints: &[SceneJoint],
    duration: f64,
) -> Result<OutputPlan, Fault> {
    let mut plan = OutputPlan::default();
    if let Some(every) = &output.every {
        plan.every = every.get();
    }
    let rule = output.acceleration;
    plan.accelerations = match rule {
        None | Some(spec::AccelerationRule::Mean) => AccelerationRule::Mean,
        Some(spec::AccelerationRule::Instant) => AccelerationRule::Instant,
    };
    if let Some(band) = &output.band {
        if plan.accelerations == AccelerationRule::Instant {
            return Err(Fault::new(
                band.span(),
                Problem::Value {
                    found: "a band of instants".into(),
                    expected: "`acceleration = \"mean\"`, or no band".into(),
                },
            ));
        }
        plan.band = Some(band.get());
    }
    // Every joint has results under its name.
    let mut used: Vec<&str> = joints.iter().map(|joint| joint.name.as_str()).collect();
    let all_names = (output.histories.iter().map(|history| &history.name))
        .chain(output.relative.iter().map(|relative| &relative.name))
        .chain(output.sections.iter().map(|section| &section.name))
        .chain(output.rings.iter().map(|ring| &ring.name))
        .chain(output.joints.iter().map(|joint| &joint.name))
        .chain(output.own.iter().map(|own| &own.name));
    for name in all_names {
        if used.contains(&name.as_str()) {
            return Err(name.duplicate("result"));
        }
        used.push(name);
    }
    for history in &output.histories {
        histories(names, history, &mut plan)?;
    }
    for request in &output.relative {
        let keys = (&request.at, &request.node, &request.set);
        let from = (&request.from, &request.from_node, &request.from_set);
        let site = Site {
            names,
            in_set: &None,
            within: &request.within,
        };
        let no_place = |keys, given: [bool; 3]| one_of(request.name.span(), keys, &given);
        let at = site
            .place(keys)?
            .map_err(|given| no_place(&["at", "node", "set"], given))?;
        let from = site
            .place(from)?
            .map_err(|given| no_place(&["from", "from_node", "from_set"], given))?;
        if ![&at, &from]
            .iter()
            .any(|place| matches!(place, Place::Point(_)))
        {
            site.without_point()?;
        }
        let name = request.name.to_string();
        plan.relative.push(RelativeRequest::new(name, at, from));
    }
    for section in &output.sections {
        plan.cuts.push(cut(names, section)?);
    }
    for request in &output.rings {
        plan = ring(names, request, plan)?;
    }
    for request in &output.joints {
        plan.joints.push(joint(names, request, joints)?);
    }
    plan.energies = Some(
        output
            .energies
            .as_ref()
            .map_or(duration / ENERGY_SAMPLES, |every| every.get()),
    );
    if let Some(envelope) = &output.envelope {
        let mut sets = Vec::new();
        for set in envelope.sets.iter().flatten() {
            names.elements(set)?;
            sets.push(set.to_string());
        }
        let quantities = quantities(&envelope.quantities, &MOTION)?;
        if quantities.contains(&Quantity::State) {
            plan.state.every = Some(envelope.every.as_ref().map_or(plan.every, |e| e.get()));
        }
        plan.envelope = Some(
            EnvelopeRequest::new(envelope.every.as_ref().map_or(plan.every, |e| e.get()))
                .with_motion(motion(&quantities))
                .with_stress(quantities.contains(&Quantity::Stress))
                .with_sets(sets),
        );
    }
    if let Some(snapshots) = &output.snapshots {
        let default = [Quantity::Displacement, Quantity::Velocity];
        let quantities = quantities(&snapshots.quantities, &default)?;
        plan.state.snapshots = quantities.contains(&Quantity::State);
        plan.snapshots = Some(SnapshotRequest::new(snapshots.every.get()).with_fields(
            SnapshotFields {
                motion: motion(&quantities),
                stress: quantities.contains(&Quantity::Stress),
            },
        ));
    }
    Ok(plan)
}

/// Default quantities of histories and envelopes.
const MOTION: [Quantity; 3] = [
    Quantity::Displacement,
    Quantity::Velocity,
    Quantity::Acceleration,
];

type Quantities<Q = Quantity> = Option<At<Vec<At<Q>>>>;

/// Requested quantities, or the default.
fn quantities<Q: Copy>(requested: &Quantities<Q>, default: &[Q]) -> Result<Vec<Q>, Fault> {
    match requested {
        None => Ok(default.to_vec()),
        Some(requested) if requested.is_empty() => Err(Fault::new(
            requested.span(),
            Problem::Value {
                found: "an empty list".into(),
                expected: "one quantity or more".into(),
            },
        )),
        Some(requested) => Ok(requested.iter().map(|quantity| **quantity).collect()),
    }
}

/// Checks that none of the requested quantities is undefined at a location.
fn without(
    requested: &Quantities,
    lacking: impl Fn(Quantity) -> bool,
    found: &str,
    expected: &str,
) -> Result<(), Fault> {
    let mut requested = requested.iter().flat_map(|requested| requested.iter());
    match requested.find(|quantity| lacking(***quantity)) {
        None => Ok(()),
        Some(quantity) => Err(Fault::new(
            quantity.span(),
            Problem::Value {
                found: found.into(),
                expected: expected.into(),
            },
        )),
    }
}

fn histories(names: &Names, history: &History, plan: &mut OutputPlan) -> Result<(), Fault> {
    let name = history.name.to_string();
    let site = Site {
        names,
        in_set: &history.in_set,
        within: &history.within,
    };
    let of_element = |quantity| matches!(quantity, Quantity::Stress | Quantity::State);
    let at_point = history.stress_at_point.as_ref().filter(|at| ***at);
    let has_stress = (history.quantities.iter())
        .any(|quantities| quantities.iter().any(|q| **q == Quantity::Stress));
    if let Some(at) = at_point
        && !(history.at.is_some() && has_stress)
    {
        return Err(Fault::new(
            at.span(),
            Problem::Value {
                found: "stress at a point without a point, or without stress".into(),
                expected: "a point `at`, and \"stress\" among the `quantities`".into(),
            },
        ));
    }
    if let (Some(element), None, None, None) =
        (&history.element, &history.at, &history.node, &history.set)
    {
        if !names.mesh.element_tags().contains(element) {
            return Err(no_such_number("element", element));
        }
        let found = "motion of an element";
        without(
            &history.quantities,
            |quantity| !of_element(quantity),
            found,
            "stress or state, or a point, node or set",
        )?;
        let requested = quantities(&history.quantities, &[Quantity::Stress])?;
        site.without_point()?;
        in_element(
            plan,
            &requested,
            (&name, false),
            &StressPlace::Element(**element),
        );
        return Ok(());
    }
    let place = match site.place((&history.at, &history.node, &history.set))? {
        Ok(place) if history.element.is_none() => place,
        _ => {
            let keys: &[&str] = &["at", "node", "set", "element"];
            let (at, node) = (history.at.is_some(), history.node.is_some());
            let given = [at, node, history.set.is_some(), history.element.is_some()];
            return Err(one_of(history.name.span(), keys, &given));
        }
    };
    let requested = quantities(&history.quantities, &MOTION)?;
    match &place {
        Place::Point(spot) => {
            let name = (&*name, at_point.is_some());
            in_element(plan, &requested, name, &StressPlace::Point(spot.clone()));
        }
        _ => {
            let found = "stress or state at a node or set";
            site.without_point()?;
            without(
                &history.quantities,
                of_element,
                found,
                "motion, or a point or element",
            )?;
        }
    }
    let motion = motion(&requested);
    if motion != Motion::default() {
        plan.histories
            .push(HistoryRequest::new(name, place, motion));
    }
    Ok(())
}

/// Request for the histories of a joint.
fn joint(
    names: &Names,
    request: &JointHistory,
    joints: &[SceneJoint],
) -> Result<JointRequest, Fault> {
    let of_name = |joint: &&SceneJoint| joint.name == *request.joint;
    let Some(joint) = joints.iter().find(of_name) else {
        let available = joints.iter().map(|joint| joint.name.clone()).collect();
        let (what, name) = ("joint", request.joint.to_string());
        let problem = Problem::NoSuchName {
            what,
            name,
            available,
        };
        return Err(Fault::new(request.joint.span(), problem));
    };
    let span = request.name.span();
    let zone = match request.zone() {
        None => JointZone::All,
        Some(zone) => super::joints::zone(names, &zone, span.clone())?,
    };
    let pairs = zone.pairs(names.mesh, (&joint.name, &joint.surface));
    pairs.map_err(|error| Fault::refused(span, error))?;
    let quantities = match &request.quantities {
        None => JointQuantities::ALL,
        Some(_) => {
            let requested = quantities(&request.quantities, &[])?;
            let has = |quantity| requested.contains(&quantity);
            JointQuantities {
                state: has(JointQuantity::State),
                slip: has(JointQuantity::Slip),
                opening: has(JointQuantity::Opening),
                peak_opening: has(JointQuantity::PeakOpening),
                traction: has(JointQuantity::Traction),
                friction: has(JointQuantity::Friction),
                bond: has(JointQuantity::Bond),
                impact: has(JointQuantity::Impact),
                history: has(JointQuantity::History),
            }
        }
    };
    let name = request.name.to_string();
    Ok(JointRequest::new(
        name,
        joint.name.clone(),
        zone,
        quantities,
    ))
}

/// Adds requests for stress and state variables of an element.
fn in_element(
    plan: &mut OutputPlan,
    requested: &[Quantity],
    (name, at_point): (&str, bool),
    place: &StressPlace,
) {
    let request = || {
        let mut request = StressRequest::new(name, place.clone());
        request.at_point = at_point;
        request
    };
    if requested.contains(&Quantity::Stress) {
        plan.stresses.push(request());
    }
    if requested.contains(&Quantity::State) {
        plan.state.places.push(request());
    }
}

fn motion(quantities: &[Quantity]) -> Motion {
    Motion {
        displacement: quantities.contains(&Quantity::Displacement),
        velocity: quantities.contains(&Quantity::Velocity),
        acceleration: quantities.contains(&Quantity::Acceleration),
    }
}

/// Options common to the locations of a request.
struct Site<'s> {
    names: &'s Names<'s>,
    in_set: &'s Option<At<String>>,
    within: &'s Option<At<Positive>>,
}

type Keys<'s> = (
    &'s Option<At<[Finite; 3]>>,
    &'s Option<At<u64>>,
    &'s Option<At<String>>,
);

impl Site<'_> {
    /// Location given by exactly one of three keys; otherwise which of them are given.
    fn place(&self, keys: Keys) -> Result<Result<Place, [bool; 3]>, Fault> {
        Ok(Ok(match keys {
            (Some(at), None, None) => self.spot(at)?.into(),
            (None, Some(node), None) => {
                self.names.node(node)?;
                Place::Node(**node)
            }
            (None, None, Some(set)) => {
                self.names.nodes(set)?;
                Place::NodeSet(set.to_string())
            }
            (at, node, set) => return Ok(Err([at.is_some(), node.is_some(), set.is_some()])),
        }))
    }

    /// Point, checked to lie in the mesh.
    fn spot(&self, at: &At<[Finite; 3]>) -> Result<ObservationPoint, Fault> {
        let mesh = self.names.mesh;
        let mut spot = ObservationPoint::at(vector(at));
        if let Some(within) = self.within {
            check_reach(mesh, (within.get(), within.span()))?;
            spot = spot.within(within.get());
        }
        let located = match self.in_set {
            Some(set) => {
                spot = spot.among(set);
                let elements = self.names.elements(set)?;
                mesh.locate_among(elements, &[spot.position], spot.tolerance)
            }
            None => {
                let all: Vec<u32> = (0..mesh.element_count() as u32).collect();
                mesh.locate_among(&all, &[spot.position], spot.tolerance)
            }
        };
        located.map_err(|error| outside(self.names, at, error))?;
        Ok(spot)
    }

    /// Checks that options of a point are not given without a point.
    fn without_point(&self) -> Result<(), Fault> {
        let in_set = self.in_set.as_ref().map(At::span);
        match in_set.or(self.within.as_ref().map(At::span)) {
            Some(span) => {
                let key = "at".into();
                Err(Fault::new(span, Problem::MissingKey { key }))
            }
            None => Ok(()),
        }
    }
}

fn cut(names: &Names, section: &Section) -> Result<SectionRequest, Fault> {
    names.elements(&section.set)?;
    let point = vector(&section.at);
    let cut = CrossSection {
        name: section.name.to_string(),
        point,
        normal: vector(&section.normal),
        along: vector(&section.along),
        within: section.half_extent.map(|half| {
            let half = Vec3::repeat(half.get());
            (point - half, point + half)
        }),
    };
    let mut request = SectionRequest::new(section.set.to_string(), cut);
    request.reinforcement = section.reinforcement.as_deref().map(reinforcement);
    Ok(request)
}

/// Byte ranges of the points of sections, and of the reinforcements of sections and rings, by name.
pub(super) fn places(output: &Output) -> [BTreeMap<String, Range<usize>>; 2] {
    let sections = || output.sections.iter();
    let points = sections().map(|section| (section.name.to_string(), section.at.span()));
    let rings = output.rings.iter();
    let rings = rings.map(|ring| (&ring.name, &ring.reinforcement));
    let bars = sections()
        .map(|section| (&section.name, &section.reinforcement))
        .chain(rings)
        .filter_map(|(name, bars)| Some((name.to_string(), bars.as_ref()?.span())));
    [points.collect(), bars.collect()]
}

fn reinforcement(bars: &Reinforcement) -> SectionReinforcement {
    SectionReinforcement {
        concrete_strength: bars.concrete_strength.get(),
        bars: bars.bars.map(NonNegative::get),
        cover: bars.cover.get(),
        yield_stress: bars.yield_stress.get(),
    }
}

/// Default number of rays of a ring of sections.
const RAYS: usize = 24;

fn ring(names: &Names, request: &Ring, plan: OutputPlan) -> Result<OutputPlan, Fault> {
    names.elements(&request.set)?;
    let rays = request.rays.as_deref().copied().unwrap_or(RAYS);
    let [least, most] = SectionRing::RAYS;
    if let (Some(given), false) = (&request.rays, (least..=most).contains(&rays)) {
        let (found, expected) = (rays.to_string(), format!("{least} to {most} rays"));
        return Err(Fault::new(given.span(), Problem::Value { found, expected }));
    }
    if vector(&request.axis).norm() == 0.0 {
        let (found, expected) = ("an axis of zero".into(), "a direction".into());
        return Err(Fault::new(
            request.axis.span(),
            Problem::Value { found, expected },
        ));
    }
    let ring = SectionRing::new(
        request.name.as_str(),
        vector(&request.centre),
        vector(&request.axis),
        rays,
    );
    let bars = request.reinforcement.as_deref().map(reinforcement);
    plan.ring(names.mesh, &request.set, &ring, bars)
        .map_err(|error| {
            let problem = match error {
                ModelError::Refused { source, .. } => Problem::Refused(source),
                other => Problem::Refused(other.into()),
            };
            Fault::new(request.centre.span(), problem)
        })
}

/// A point outside of the layer of elements that a scene takes from its mesh.
#[derive(Debug, thiserror::Error)]
#[error("{point}; `slice` in [mesh] takes the layer of elements from {axis} = {low} to {high} m")]
struct OutsideLayer {
    point: MeshError,
    axis: char,
    low: f64,
    high: f64,
}

/// Fault of a point that lies in no element.
fn outside(names: &Names, at: &At<[Finite; 3]>, point: MeshError) -> Fault {
    let Some(axis) = names.layer else {
        return Fault::refused(at.span(), point);
    };
    let (low, high) = names.mesh.bounding_box();
    let error = OutsideLayer {
        point,
        axis: axis.name(),
        low: low[axis.index()],
        high: high[axis.index()],
    };
    Fault::refused(at.span(), error)
}
