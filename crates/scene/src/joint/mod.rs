//! Joints of a scene: sides, contact law and initial conditions.

mod preload;
mod water;
mod wet;
mod zone;

pub use preload::{GroundStress, Preload};
pub use water::JointWater;
pub(crate) use water::{JointWaterLoad, WaterInJoints};
pub use wet::WetJoint;
pub use zone::JointZone;

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use powerhouse_contact::{ContactError, Joint, JointSurface, Tied};
use powerhouse_model::{ContactLaw, JointPair, Mesh, ModelError};

use crate::Error;

/// Joint whose contact law was chosen by name.
pub(crate) type NamedJoint = Joint<Arc<dyn ContactLaw>>;

/// Name and sides of a joint.
pub(crate) type NamedSurface = (String, JointSurface);

/// Initial gap of a joint: distance of its sides in the state from which displacements count.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum InitialGap {
    /// No gap: a small distance of the nodes in the mesh is ignored.
    #[default]
    Closed,
    /// The same gap at all pairs (m).
    Distance(f64),
    /// Distance of the nodes of a pair in the mesh, along the normal.
    Meshed,
}

/// Joint of a scene: sides that are meshed apart or were cut open, contact law and initial conditions.
///
/// ```
/// use powerhouse_contact::{BondedCoulomb, BondedCoulombParameters, JointSurface, SurfaceOptions};
/// use powerhouse_model::{Mesh, Vec3};
/// use powerhouse_scene::{JointZone, Preload, SceneJoint};
/// let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::new(4.0, 4.0, 2.0), [4, 4, 2], "rock")?;
/// let (lower, upper): (Vec<u32>, Vec<u32>) = (0..32).partition(|&e| mesh.centroid(e).z < 1.0);
/// let split = mesh.split_between(&lower, &upper)?;
/// let options = SurfaceOptions::within(1e-6)?;
/// let surface = JointSurface::between(&split.mesh, &split.first, &split.second, &options)?;
/// let law = BondedCoulomb::new(BondedCoulombParameters {
///     cohesion: 1.0e6,
///     tensile_strength: 0.5e6,
///     static_friction: 0.8,
///     dynamic_friction: 0.6,
///     cohesion_loss: true,
/// })?;
/// // Pressed together by 0.2 MPa, and cracked already where x < 1 m.
/// let cracked = JointZone::Box { low: Vec3::zeros(), high: Vec3::new(1.0, 4.0, 2.0) };
/// let joint = SceneJoint::new("bedding", surface, law)
///     .with_preload(Preload::Pressure(0.2e6))
///     .with_unbonded(cracked);
/// # assert_eq!(joint.surface.pairs.len(), 25);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct SceneJoint {
    /// Name of the joint, by which stages refer to it and its results are called.
    pub name: String,
    /// Node pairs and facets of the two sides.
    pub surface: JointSurface,
    /// Contact law, which decides on the traction that each pair admits.
    pub law: Arc<dyn ContactLaw>,
    /// Traction in the static state from which displacements count, if any; not permitted in a scene with stages, which
    /// compute it. It is the total traction, also of a joint with water.
    pub preload: Option<Preload>,
    /// Water in the joint, if any.
    pub water: Option<JointWater>,
    /// Initial gap between the sides along the normal: closed, uniform, or as meshed.
    pub gap: InitialGap,
    /// Zones of the joint whose pairs start without a bond, such as an existing crack.
    pub unbonded: Vec<JointZone>,
}

impl SceneJoint {
    /// Closed joint without preload, in the initial state of its law.
    pub fn new(
        name: impl Into<String>,
        surface: JointSurface,
        law: impl ContactLaw + 'static,
    ) -> Self {
        Self {
            name: name.into(),
            surface,
            law: Arc::new(law),
            preload: None,
            water: None,
            gap: InitialGap::Closed,
            unbonded: Vec::new(),
        }
    }
    /// Puts water into the joint.
    #[must_use]
    pub fn with_water(mut self, water: JointWater) -> Self {
        self.water = Some(water);
        self
    }
    /// Sets the traction in the static state from which displacements count. The traction by motion adds to
    /// it.
    #[must_use]
    pub fn with_preload(mut self, preload: Preload) -> Self {
        self.preload = Some(preload);
        self
    }
    /// Sets the initial gap (m), in place of none. A pair with a gap has neither bond nor preload.
    #[must_use]
    pub fn with_gap(mut self, gap: InitialGap) -> Self {
        self.gap = gap;
        self
    }
    /// Adds a zone without a bond at the start, as where a joint was cracked before.
    #[must_use]
    pub fn with_unbonded(mut self, zone: JointZone) -> Self {
        self.unbonded.push(zone);
        self
    }

    /// Checks that its pairs permit the initial conditions.
    pub fn check(&self, mesh: &Mesh) -> Result<(), Error> {
        let pressures = self.pressures_at_start(mesh);
        let pressures = pressures.map_err(|source| Error::staging(None, source))?;
        let surface = self.wet_surface(&pressures);
        let start = self.start(mesh, &surface)?;
        start.joint(mesh, (&self.name, &surface), self.law.as_ref())?;
        Ok(())
    }

    /// Its sides with pressures of the water (Pa) at the pairs; none in a dry joint.
    fn wet_surface(&self, pressures: &[f64]) -> JointSurface {
        let mut surface = self.surface.clone();
        for (pair, pressure) in surface.pairs.iter_mut().zip(pressures) {
            pair.water_pressure = *pressure;
        }
        surface
    }

    /// Builds the joint in its initial state by a law, and its sides, with pressures of the water at the pairs, in a body some nodes of
    /// which share the motion of others, their leads.
    pub(crate) fn build(
        &self,
        mesh: &Mesh,
        leads: &HashMap<u32, u32>,
        (closing, law): (Closing, Arc<dyn ContactLaw>),
        pressures: &[f64],
    ) -> Result<(NamedJoint, NamedSurface), Error> {
        let mut surface = self.wet_surface(pressures);
        if !leads.is_empty() {
            let lead = |node: u32| leads.get(&node).copied().unwrap_or(node);
            surface = surface.united(lead);
        }
        let (start, law) = match closing {
            Closing::Own => (self.start(mesh, &surface)?, law),
            Closing::Tied => (Start::default(), Arc::new(Tied) as Arc<dyn ContactLaw>),
        };
        let joint = start.joint(mesh, (&self.name, &surface), law)?;
        Ok((joint, (self.name.clone(), surface)))
    }

    fn start(&self, mesh: &Mesh, surface: &JointSurface) -> Result<Start, Error> {
        if let Some(preload) = &self.preload {
            preload.check()?;
        }
        let mut unbonded = HashSet::new();
        for zone in &self.unbonded {
            let pairs = zone.pairs(mesh, (&self.name, surface))?;
            unbonded.extend(pairs.iter().map(|&pair| surface.pairs[pair].nodes));
        }
        Ok(Start {
            preload: self.preload,
            gap: self.gap,
            unbonded,
        })
    }
}

/// Law of a joint in a stage: its own, or a tie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Closing {
    /// Its own law.
    Own,
    /// A tie, whatever its own law admits.
    Tied,
}

/// Initial conditions of the pairs of a joint.
#[derive(Default)]
struct Start {
    preload: Option<Preload>,
    gap: InitialGap,
    /// Nodes of the pairs without a bond.
    unbonded: HashSet<[u32; 2]>,
}

impl Start {
    fn joint<L: ContactLaw>(
        &self,
        mesh: &Mesh,
        (name, surface): (&str, &JointSurface),
        law: L,
    ) -> Result<Joint<L>, Error> {
        let positions = mesh.positions();
        let gap = |pair: &JointPair| match self.gap {
            InitialGap::Closed => 0.0,
            InitialGap::Distance(distance) => distance,
            InitialGap::Meshed => {
                let [first, second] = pair.nodes.map(|node| positions[node as usize]);
                (second - first).dot(&pair.normal)
            }
        };
        let build = || -> Result<Joint<L>, ModelError> {
            let joint = Joint::new(name, surface.pairs.clone(), law)?
                .with_gaps(gap)?
                .without_bond(|pair| self.unbonded.contains(&pair.nodes))?;
            let Some(preload) = &self.preload else {
                return Ok(joint);
            };
            joint.with_preload(|pair| {
                let position = positions[pair.nodes[0] as usize];
                let total = preload.traction(&position, &pair.normal);
                total + pair.normal * pair.water_pressure
            })
        };
        build().map_err(|error| of_joint(mesh, name, error))
    }
}

/// Error with the name of the joint and the numbers of the nodes of its pair in the mesh file.
fn of_joint(mesh: &Mesh, name: &str, error: ModelError) -> Error {
    let source = match &error {
        ModelError::Refused { source, .. } => source.downcast_ref::<ContactError>().cloned(),
        _ => None,
    };
    let nodes = source.as_ref().and_then(ContactError::pair);
    let (Some(source), Some(nodes)) = (source, nodes) else {
        return error.into();
    };
    let [first, second] = nodes.map(|node| mesh.node_tags()[node as usize]);
    let joint = name.into();
    Error::Joint {
        joint,
        first,
        second,
        source,
    }
}
