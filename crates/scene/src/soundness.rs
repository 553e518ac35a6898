//! Checks of magnitudes, names and supports of a scene, from a file or composed.

use std::collections::BTreeSet;

use powerhouse_model::{BoundaryParts, DisjointSets, Mesh, Support, Vec3};

use crate::magnitude::{self, Magnitude, MagnitudeOf, rounded};
use crate::output::{NamedThing, check_names};
use crate::{Error, Remark, Scene, remark};

/// Least cosine between two directions for a support along one to restrain the other: that of 80 degrees.
const ALONG: f64 = 0.17;

impl Scene {
    /// Permits magnitudes beyond what is usual of ground and structures; each is a warning then.
    #[must_use]
    pub fn allow_magnitudes(mut self) -> Self {
        self.magnitudes_allowed = true;
        self
    }
    /// Whether magnitudes beyond what is usual are permitted.
    pub fn allows_magnitudes(&self) -> bool {
        self.magnitudes_allowed
    }

    /// Quantities of media, mesh, gravity, records and duration outside their usual ranges.
    pub fn unusual_magnitudes(&self) -> Vec<(Magnitude, MagnitudeOf)> {
        let mut found = Vec::new();
        let mut see = |checked: Result<(), Magnitude>, of: MagnitudeOf| {
            found.extend(checked.err().map(|magnitude| (magnitude, of)));
        };
        for part in &self.parts {
            let medium = part.material.law().skeleton();
            for (usual, name, value) in [
                (magnitude::YOUNG, "young", medium.young),
                (magnitude::POISSON, "poisson", medium.poisson),
                (magnitude::DENSITY, "density", medium.density),
                (magnitude::S_SPEED, "speed of S waves", medium.s_speed()),
                (magnitude::P_SPEED, "speed of P waves", medium.p_speed()),
            ] {
                let name = format!("part '{}': {name}", part.set);
                see(
                    usual.check(&name, value),
                    MagnitudeOf::Part(part.set.clone()),
                );
            }
        }
        let (low, high) = self.mesh.bounding_box();
        let diagonal = (high - low).norm();
        see(
            magnitude::BODY.check("diagonal of the body", rounded(diagonal)),
            MagnitudeOf::Mesh,
        );
        let edges = longest_edges(&self.mesh);
        let extremes = edges.fold((f64::INFINITY, 0.0_f64), |(least, most), edge| {
            (least.min(edge), most.max(edge))
        });
        for edge in [extremes.0, extremes.1] {
            if edge > 0.0 && edge.is_finite() {
                see(
                    magnitude::ELEMENT.check("longest edge of an element", rounded(edge)),
                    MagnitudeOf::Mesh,
                );
            }
        }
        let of_stages = self.stages.iter().flat_map(|stage| &stage.weights);
        for (acceleration, _) in self.weights.iter().chain(of_stages) {
            let value = acceleration.norm();
            if value > 0.0 {
                see(
                    magnitude::GRAVITY.check("gravity", value),
                    MagnitudeOf::Scene,
                );
            }
        }
        for (name, record) in &self.records {
            let samples = record.acceleration();
            let length = record.step() * samples.len() as f64;
            let peak = samples.iter().fold(0.0_f64, |most, a| most.max(a.abs()));
            for (usual, what, value) in [
                (magnitude::RECORD_STEP, "step", record.step()),
                (magnitude::RECORD_LENGTH, "length", length),
                (magnitude::RECORDED_PEAK, "peak", peak),
            ] {
                let title = format!("record '{name}': {what}");
                if value > 0.0 {
                    see(
                        usual.check(&title, value),
                        MagnitudeOf::Record(name.clone()),
                    );
                }
            }
        }
        see(
            magnitude::DURATION.check("duration", self.duration),
            MagnitudeOf::Scene,
        );
        found
    }

    /// Rejects quantities outside their usual ranges, or adds warnings about them if the scene allows them.
    pub fn check_magnitudes(&mut self) -> Result<(), Error> {
        for (magnitude, of) in self.unusual_magnitudes() {
            if !self.magnitudes_allowed {
                let magnitude = Box::new(magnitude);
                return Err(Error::Magnitude { magnitude, of });
            }
            self.remark_once(magnitude);
        }
        Ok(())
    }

    /// Adds a remark unless the scene has it already.
    pub fn remark_once(&mut self, remark: impl Into<Remark>) {
        let remark = remark.into();
        if !self.remarks.contains(&remark) {
            self.remarks.push(remark);
        }
    }

    /// Checks that names can be names of files, and that no two have the same file.
    pub fn check_names(&self) -> Result<(), Error> {
        check_names(self.named()).map_err(|(_, error)| error.into())
    }

    fn named(&self) -> Vec<(NamedThing, &str)> {
        let output = &self.output;
        // Motion, stress and state variables at one location have one name and one plot.
        let mut results: BTreeSet<&str> = output.histories.iter().map(|h| &*h.name).collect();
        results.extend(output.stresses.iter().map(|request| &*request.name));
        results.extend(output.state.places.iter().map(|request| &*request.name));
        let relative = output.relative.iter().map(|request| &*request.name);
        let sampled = output.sampled.iter().map(|request| &*request.name);
        let cuts = output.cuts.iter().map(|request| &*request.cut.name);
        let results = results.into_iter().chain(relative).chain(sampled);
        let mut named: Vec<(NamedThing, &str)> = (results.chain(cuts))
            .map(|name| (NamedThing::Result, name))
            .collect();
        named.extend(self.joints.iter().map(|j| (NamedThing::Joint, &*j.name)));
        named.extend(
            output
                .joints
                .iter()
                .map(|w| (NamedThing::JointZone, &*w.name)),
        );
        named.extend(self.bolts.iter().map(|b| (NamedThing::Bolts, &*b.name)));
        named.extend(self.stages.iter().map(|s| (NamedThing::Stage, s.name())));
        named
    }

    /// Warnings about gravity in a scene without stages: unsupported bodies, and gravity applied suddenly.
    pub(super) fn gravity_warnings(&self, boundary: Option<&BoundaryParts>) -> Vec<Remark> {
        let acts = |(acceleration, history): &&(Vec3, crate::acting::SharedFunction)| {
            acceleration.norm() * history.value(self.start).abs() > 0.0
                || (acceleration.norm() > 0.0 && history.value(self.start + self.duration) != 0.0)
        };
        let Some((acceleration, _)) = self.weights.iter().find(acts) else {
            return Vec::new();
        };
        if !self.stages.is_empty() {
            return Vec::new();
        }
        let mut warnings = Vec::new();
        let held = self.held_along(acceleration.normalize(), boundary);
        let mut bodies = bodies(&self.mesh);
        for joint in &self.joints {
            for pair in &joint.surface.pairs {
                bodies.join(pair.nodes[0], pair.nodes[1]);
            }
        }
        for (from, to) in self.all_pairs() {
            bodies.join(from, to);
        }
        let resting: BTreeSet<u32> = held.into_iter().map(|node| bodies.root(node)).collect();
        let mut falling: BTreeSet<&str> = BTreeSet::new();
        for part in &self.parts {
            let elements = self.mesh.element_set(&part.set).unwrap_or_default();
            let falls = elements.iter().any(|&element| {
                let node = self.mesh.nodes_of(element)[0];
                !resting.contains(&bodies.root(node))
            });
            if falls {
                falling.insert(&part.set);
            }
        }
        let alone =
            self.constraints.is_empty() && boundary.is_none_or(|parts| parts.blocks.is_empty());
        if !falling.is_empty() && alone {
            let sets = falling.into_iter().map(str::to_owned).collect();
            warnings.push(remark::UnsupportedBody { sets }.into());
        } else if self.is_sudden() {
            warnings.push(remark::SuddenGravity {}.into());
        }
        warnings
    }

    /// Returns whether gravity acts fully from the first step on.
    fn is_sudden(&self) -> bool {
        let weights = self.weights.iter();
        let mut acting = weights.filter(|(acceleration, _)| acceleration.norm() > 0.0);
        acting.any(|(_, history)| history.value(self.start) != 0.0)
    }

    /// Nodes that are restrained along a direction.
    fn held_along(&self, direction: Vec3, boundary: Option<&BoundaryParts>) -> Vec<u32> {
        let mut held = Vec::new();
        for support in &self.supports {
            if holds_along(support, &direction) {
                held.extend_from_slice(support.nodes());
            }
        }
        for driven in &self.prescribed {
            let along = driven.direction.normalize().dot(&direction).abs();
            if along > ALONG {
                held.extend_from_slice(&driven.nodes);
            }
        }
        let impedance = boundary.iter().flat_map(|parts| &parts.impedance);
        for node in impedance {
            if direction.dot(&(node.spring * direction)) > 0.0 {
                held.push(node.node);
            }
        }
        held
    }
}

/// Returns whether a support restrains its nodes nearly along a direction.
pub(super) fn holds_along(support: &Support, direction: &Vec3) -> bool {
    match support.held_direction() {
        None => true,
        Some(held) => held.normalize().dot(direction).abs() > ALONG,
    }
}

/// Largest extent of the nodes of each solid along an axis.
fn longest_edges(mesh: &Mesh) -> impl Iterator<Item = f64> {
    let solids = (0..mesh.element_count() as u32).filter(|&e| mesh.kind(e).is_solid());
    solids.map(|element| {
        let positions = mesh.nodes_of(element).iter();
        let positions = positions.map(|&node| mesh.positions()[node as usize]);
        let infinite = Vec3::repeat(f64::INFINITY);
        let (low, high) = positions.fold((infinite, -infinite), |(low, high), x| {
            (low.inf(&x), high.sup(&x))
        });
        (high - low).max()
    })
}

/// Bodies of connected nodes.
fn bodies(mesh: &Mesh) -> DisjointSets {
    let mut bodies = DisjointSets::new(mesh.node_count());
    for element in 0..mesh.element_count() as u32 {
        let nodes = mesh.nodes_of(element);
        for node in &nodes[1..] {
            bodies.join(nodes[0], *node);
        }
    }
    bodies
}
