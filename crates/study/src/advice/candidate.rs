//! The boundaries among which advice chooses.

use core::fmt;
use std::sync::Arc;

use powerhouse::boundary::reflection::{PlaneWave, reflection};
use powerhouse::boundary::{
    AxisParameters, FaceCoefficients, InputMode, Spreading, Viscous, ViscousSpring,
};
use powerhouse::keys;
use powerhouse::model::{
    AbsorbingBoundary, BoundarySite, ElasticMedium, ModelError, ParameterError, SiteFace, SiteNode,
    Vec3,
};

/// The name of boundaries of springs and dashpots.
const SPRINGS: &str = keys::VISCOUS_SPRING;
/// A of all springs.
const AMPLITUDE_RATIO: f64 = 0.8;

/// A boundary of a program's registry, without keys of its own.
#[derive(Clone)]
pub struct RegisteredBoundary {
    name: String,
    condition: Arc<dyn AbsorbingBoundary>,
    holds: bool,
}

impl RegisteredBoundary {
    /// The boundary that a registry has under a name, on faces of a setting.
    ///
    /// # Errors
    /// A boundary that cannot stand on a plane face there, or that brings elements of its own.
    pub(super) fn new(
        name: &str,
        condition: Arc<dyn AbsorbingBoundary>,
        standing: &Standing,
    ) -> Result<Self, ModelError> {
        let distance = standing.distances.into_iter().fold(f64::INFINITY, f64::min);
        let mut boundary = Self {
            name: name.to_owned(),
            condition,
            holds: false,
        };
        let face = boundary.face(&standing.medium, distance)?;
        boundary.holds = face.normal_spring > 0.0 && face.tangential_spring > 0.0;
        Ok(boundary)
    }
    /// The name in the registry.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Springs and dashpots that it puts on a square metre of a plane face at a distance (m).
    fn face(&self, medium: &ElasticMedium, distance: f64) -> Result<FaceCoefficients, ModelError> {
        let share = SiteFace {
            face: 0,
            medium: *medium,
            normal: Vec3::x(),
            area: 1.0,
        };
        let node = SiteNode {
            node: 0,
            position: Vec3::x() * distance,
            faces: vec![share],
        };
        let site = BoundarySite::new(vec!["right".into()], vec![node], Vec3::zeros(), None);
        let parts = self.condition.build(&site)?;
        if !parts.blocks.is_empty() {
            let reason = "it has elements of its own, which predictions do not know";
            return Err(ModelError::refused(self.name.as_str(), reason));
        }
        let sum = |of: fn(&powerhouse::model::NodalImpedance) -> f64| -> f64 {
            parts.impedance.iter().map(of).sum()
        };
        Ok(FaceCoefficients {
            normal_spring: sum(|node| node.spring[(0, 0)]),
            tangential_spring: sum(|node| node.spring[(1, 1)]),
            normal_dashpot: sum(|node| node.dashpot[(0, 0)]),
            tangential_dashpot: sum(|node| node.dashpot[(1, 1)]),
        })
    }
}

impl PartialEq for RegisteredBoundary {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl fmt::Debug for RegisteredBoundary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "RegisteredBoundary({})", self.name)
    }
}

/// A boundary that a scene can name.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum BoundaryKind {
    /// Dashpots alone.
    Viscous,
    /// Springs and dashpots with a B of their own.
    Springs {
        /// B, the ratio of physical to apparent wave speed.
        speed_ratio: f64,
    },
    /// Springs of the ground that is left out, for what lasts, and dashpots with B = 1.
    StaticSprings,
    /// Springs and dashpots with B = 1.1, and the incident wave alone on the bottom, as in the paper.
    IncidentOnly,
    /// A boundary that a program has registered.
    Registered(RegisteredBoundary),
}

/// What a boundary stands on: the ground, how waves spread, and distances to the faces across x, y and
/// z (m).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Standing {
    /// The ground.
    pub medium: ElasticMedium,
    /// How waves spread.
    pub spreading: Spreading,
    /// From what scatters to the faces across each axis (m).
    pub distances: [f64; 3],
}

impl BoundaryKind {
    /// Those that come with the software, simple ones first.
    pub const BUILT_IN: [Self; 5] = [
        Self::Viscous,
        Self::Springs { speed_ratio: 1.1 },
        Self::Springs { speed_ratio: 1.0 },
        Self::StaticSprings,
        Self::IncidentOnly,
    ];

    /// A name in reports.
    #[must_use]
    pub fn name(&self) -> String {
        match self {
            Self::Viscous => keys::VISCOUS.into(),
            Self::Springs { speed_ratio } => format!("{SPRINGS}, B = {speed_ratio}"),
            Self::StaticSprings => format!("{SPRINGS}, static"),
            Self::IncidentOnly => format!("{SPRINGS}, B = 1.1, incident at the bottom"),
            Self::Registered(boundary) => boundary.name.clone(),
        }
    }

    fn speed_ratio(&self) -> f64 {
        match self {
            Self::Viscous | Self::StaticSprings | Self::Registered(_) => 1.0,
            Self::Springs { speed_ratio } => *speed_ratio,
            Self::IncidentOnly => 1.1,
        }
    }

    /// The distance that springs take in place of a true one (m).
    ///
    /// With `(lambda + 2 G) r/(4 G (1 + A))` the normal spring `(lambda + 2 G)/((1 + A) r')` is `4 G/r`,
    /// that of infinite ground around a spherical cavity under pressure; half of it, `2 G/r`, is that
    /// around a cylindrical one.
    fn distance(&self, medium: &ElasticMedium, distance: f64) -> f64 {
        match self {
            Self::StaticSprings => {
                medium.constrained() * distance / (4.0 * medium.shear() * (1.0 + AMPLITUDE_RATIO))
            }
            _ => distance,
        }
    }

    /// The boundary, with the names of the faces of the bottom.
    ///
    /// # Errors
    /// None but for distances that are not positive numbers.
    pub fn condition(
        &self,
        standing: &Standing,
        bottom: &[String],
    ) -> Result<Arc<dyn AbsorbingBoundary>, ParameterError> {
        let input = match self {
            Self::Registered(boundary) => return Ok(boundary.condition.clone()),
            Self::IncidentOnly => InputMode::IncidentOnly {
                faces: bottom.to_vec(),
            },
            _ => InputMode::FullField,
        };
        if *self == Self::Viscous {
            return Ok(Arc::new(Viscous { input }));
        }
        let mut axes = [AxisParameters::PAPER; 3];
        for (axis, distance) in axes.iter_mut().zip(standing.distances) {
            // Others take the distance of each node, from the scene's geometry.
            let given = matches!(self, Self::StaticSprings)
                .then(|| self.distance(&standing.medium, distance));
            *axis = AxisParameters::new(AMPLITUDE_RATIO, self.speed_ratio(), given)?;
        }
        Ok(Arc::new(ViscousSpring {
            axes,
            spreading: standing.spreading,
            input,
        }))
    }

    /// Springs and dashpots of a face at a distance (m).
    ///
    /// # Errors
    /// None but for a registered boundary that cannot stand there.
    pub fn face(&self, standing: &Standing, distance: f64) -> Result<FaceCoefficients, ModelError> {
        let medium = &standing.medium;
        match self {
            Self::Viscous => return Ok(FaceCoefficients::viscous(medium)),
            Self::Registered(boundary) => return boundary.face(medium, distance),
            _ => {}
        }
        let distance = self.distance(medium, distance);
        let face =
            FaceCoefficients::viscous_spring(medium, AMPLITUDE_RATIO, self.speed_ratio(), distance);
        Ok(match standing.spreading {
            Spreading::Spherical => face,
            Spreading::Cylindrical => face.with_springs_scaled(0.5),
        })
    }

    /// Shares of P and SV waves that a face at a distance (m) returns straight on, at a frequency (Hz).
    ///
    /// # Errors
    /// A frequency that is not positive; as [`face`](Self::face).
    pub fn returned(
        &self,
        standing: &Standing,
        distance: f64,
        frequency: f64,
    ) -> Result<[f64; 2], ModelError> {
        let face = self.face(standing, distance)?;
        let rate = core::f64::consts::TAU * frequency;
        let of = |wave| reflection(&standing.medium, &face, wave, 0.0, rate);
        let (p, sv) = (of(PlaneWave::P)?, of(PlaneWave::Sv)?);
        Ok([p.p.norm(), sv.sv.norm()])
    }

    /// Whether it holds the body against lasting forces.
    #[must_use]
    pub fn holds(&self) -> bool {
        match self {
            Self::Viscous => false,
            Self::Registered(boundary) => boundary.holds,
            _ => true,
        }
    }

    /// The keys of a scene's `[boundary]` table, faces and scatterer aside.
    #[must_use]
    pub fn keys(&self, standing: &Standing, bottom: &[String]) -> String {
        let mut lines = String::new();
        let mut key = |line: String| {
            lines.push_str(&line);
            lines.push('\n');
        };
        let kind = match self {
            Self::Viscous => keys::VISCOUS,
            Self::Registered(boundary) => &boundary.name,
            _ => SPRINGS,
        };
        key(format!("{} = {kind:?}", keys::KIND));
        if matches!(self, Self::Viscous | Self::Registered(_)) {
            return lines;
        }
        key(format!("{} = {:?}", keys::SPEED_RATIO, self.speed_ratio()));
        if standing.spreading == Spreading::Cylindrical {
            key(format!("{} = {:?}", keys::SPREADING, keys::CYLINDRICAL));
        }
        if *self == Self::StaticSprings {
            for (axis, distance) in keys::AXES.into_iter().zip(standing.distances) {
                let distance = self.distance(&standing.medium, distance);
                key(format!(
                    "{axis} = {{ {} = {distance:.6e} }}",
                    keys::DISTANCE
                ));
            }
        }
        if *self == Self::IncidentOnly {
            let (input, incident) = (keys::INPUT, keys::INCIDENT_ONLY);
            key(format!("{input} = {{ {incident} = {bottom:?} }}"));
        }
        lines
    }
}
