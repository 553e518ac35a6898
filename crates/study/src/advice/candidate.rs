//! The absorbing boundaries that are compared.

use core::fmt;
use std::sync::Arc;

use powerhouse::boundary::reflection::{BodyWave, reflection};
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
/// Coefficient A of all viscous-spring boundaries.
const AMPLITUDE_RATIO: f64 = 0.8;

/// A boundary that a program has registered and that can be built without keys of its own, as a candidate of advice.
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
        surroundings: &Surroundings,
    ) -> Result<Self, ModelError> {
        let distance = surroundings
            .distances
            .into_iter()
            .fold(f64::INFINITY, f64::min);
        let mut boundary = Self {
            name: name.to_owned(),
            condition,
            holds: false,
        };
        let face = boundary.face(&surroundings.medium, distance)?;
        boundary.holds = face.normal_spring > 0.0 && face.tangential_spring > 0.0;
        Ok(boundary)
    }
    /// Name of the boundary in the registry.
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
            axial_dashpot: sum(|node| node.dashpot[(1, 1)]),
            coupling: 0.0,
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

/// Kind of absorbing boundary, as a scene's `[boundary]` table describes it.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum BoundaryKind {
    /// Viscous boundary: dashpots without springs.
    Viscous,
    /// Viscous-spring boundary with A = 0.8 and a given coefficient B, full free field on every face.
    Springs {
        /// Coefficient B: ratio of physical to apparent wave speed.
        speed_ratio: f64,
    },
    /// Viscous-spring boundary with the static stiffness of infinite ground around a cavity under pressure, and dashpots
    /// with B = 1.
    StaticSprings,
    /// Viscous-spring boundary with A = 0.8 and B = 1.1 that applies only the incident wave at the bottom, as in Wang,
    /// Chen & Xiao (2019).
    IncidentOnly,
    /// A boundary that a program has registered.
    Registered(RegisteredBoundary),
}

/// Ground at an absorbing boundary: medium, geometrical spreading and distances to the scatterer, from which
/// the spring and dashpot coefficients follow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surroundings {
    /// Elastic medium behind the faces.
    pub medium: ElasticMedium,
    /// Geometrical spreading of the scattered waves: cylindrical or spherical.
    pub spreading: Spreading,
    /// Distances (m) from the scatterer to the nearest faces normal to x, y and z.
    pub distances: [f64; 3],
}

impl BoundaryKind {
    /// Compared boundaries that come with the software, in order of increasing complexity.
    pub const BUILT_IN: [Self; 5] = [
        Self::Viscous,
        Self::Springs { speed_ratio: 1.1 },
        Self::Springs { speed_ratio: 1.0 },
        Self::StaticSprings,
        Self::IncidentOnly,
    ];

    /// The name of the boundary in reports.
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

    /// Distance (m) that is used in the spring coefficients in place of the geometrical one.
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

    /// Builds the absorbing boundary; `bottom` are the names of the bottom faces, for boundaries that apply another
    /// input there.
    ///
    /// # Errors
    /// A distance that is not a positive number.
    pub fn condition(
        &self,
        surroundings: &Surroundings,
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
        for (axis, distance) in axes.iter_mut().zip(surroundings.distances) {
            // Other kinds take the distance of each node from the scene's geometry.
            let given = matches!(self, Self::StaticSprings)
                .then(|| self.distance(&surroundings.medium, distance));
            *axis = AxisParameters::new(AMPLITUDE_RATIO, self.speed_ratio(), given)?;
        }
        Ok(Arc::new(ViscousSpring {
            axes,
            spreading: surroundings.spreading,
            input,
        }))
    }

    /// Spring (N/m3) and dashpot (N s/m3) coefficients per area of a face at a distance (m) from the scatterer.
    ///
    /// # Errors
    /// A registered boundary that cannot be built on such a face, or that has elements of its own; others have no error.
    pub fn face(
        &self,
        surroundings: &Surroundings,
        distance: f64,
    ) -> Result<FaceCoefficients, ModelError> {
        let medium = &surroundings.medium;
        match self {
            Self::Viscous => return Ok(FaceCoefficients::viscous(medium)),
            Self::Registered(boundary) => return boundary.face(medium, distance),
            _ => {}
        }
        let distance = self.distance(medium, distance);
        let face =
            FaceCoefficients::viscous_spring(medium, AMPLITUDE_RATIO, self.speed_ratio(), distance);
        Ok(match surroundings.spreading {
            Spreading::Spherical => face,
            Spreading::Cylindrical => face.with_springs_scaled(0.5),
        })
    }

    /// Amplitude reflection coefficients of P and SV waves at normal incidence, of a face at a distance (m) and at
    /// a frequency (Hz).
    ///
    /// # Errors
    /// A frequency that is not positive; as [`face`](Self::face).
    pub fn reflected(
        &self,
        surroundings: &Surroundings,
        distance: f64,
        frequency: f64,
    ) -> Result<[f64; 2], ModelError> {
        let face = self.face(surroundings, distance)?;
        let rate = core::f64::consts::TAU * frequency;
        let of = |wave| reflection(&surroundings.medium, &face, wave, 0.0, rate);
        let (p, sv) = (of(BodyWave::P)?, of(BodyWave::Sv)?);
        Ok([p.p.norm(), sv.sv.norm()])
    }

    /// Whether the boundary resists static loads: every built-in kind but dashpots alone, a registered one with springs
    /// along the normal and along the face.
    #[must_use]
    pub fn resists_static_loads(&self) -> bool {
        match self {
            Self::Viscous => false,
            Self::Registered(boundary) => boundary.holds,
            _ => true,
        }
    }

    /// The lines of a scene's `[boundary]` table for this boundary, without `faces` and `scatterer`.
    #[must_use]
    pub fn keys(&self, surroundings: &Surroundings, bottom: &[String]) -> String {
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
        if surroundings.spreading == Spreading::Cylindrical {
            key(format!("{} = {:?}", keys::SPREADING, keys::CYLINDRICAL));
        }
        if *self == Self::StaticSprings {
            for (axis, distance) in keys::AXES.into_iter().zip(surroundings.distances) {
                let distance = self.distance(&surroundings.medium, distance);
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
