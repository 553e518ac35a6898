//! The boundaries among which advice chooses.

use std::sync::Arc;

use powerhouse::boundary::reflection::{BodyWave, reflection};
use powerhouse::boundary::{
    AxisParameters, FaceCoefficients, InputMode, Spreading, Viscous, ViscousSpring,
};
use powerhouse::model::{AbsorbingBoundary, ElasticMedium, ParameterError};

/// A of all springs.
const AMPLITUDE_RATIO: f64 = 0.8;

/// A boundary that a scene can name.
#[derive(Clone, Copy, Debug, PartialEq)]
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
    /// All, simple ones first.
    pub const ALL: [Self; 5] = [
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
            Self::Viscous => "viscous".into(),
            Self::Springs { speed_ratio } => format!("viscous-spring, B = {speed_ratio}"),
            Self::StaticSprings => "viscous-spring, static".into(),
            Self::IncidentOnly => "viscous-spring, B = 1.1, incident at the bottom".into(),
        }
    }

    fn speed_ratio(&self) -> f64 {
        match self {
            Self::Viscous | Self::StaticSprings => 1.0,
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
    #[must_use]
    pub fn face(&self, standing: &Standing, distance: f64) -> FaceCoefficients {
        let medium = &standing.medium;
        if *self == Self::Viscous {
            return FaceCoefficients::viscous(medium);
        }
        let distance = self.distance(medium, distance);
        let face =
            FaceCoefficients::viscous_spring(medium, AMPLITUDE_RATIO, self.speed_ratio(), distance);
        match standing.spreading {
            Spreading::Spherical => face,
            Spreading::Cylindrical => face.with_springs_scaled(0.5),
        }
    }

    /// Shares of P and SV waves that a face at a distance (m) returns straight on, at a frequency (Hz).
    ///
    /// # Errors
    /// A frequency that is not positive.
    pub fn returned(
        &self,
        standing: &Standing,
        distance: f64,
        frequency: f64,
    ) -> Result<[f64; 2], ParameterError> {
        let face = self.face(standing, distance);
        let rate = core::f64::consts::TAU * frequency;
        let of = |wave| reflection(&standing.medium, &face, wave, 0.0, rate);
        let (p, sv) = (of(BodyWave::P)?, of(BodyWave::Sv)?);
        Ok([p.p.norm(), sv.sv.norm()])
    }

    /// Whether it holds the body against lasting forces.
    #[must_use]
    pub fn holds(&self) -> bool {
        *self != Self::Viscous
    }

    /// The keys of a scene's `[boundary]` table, faces and scatterer aside.
    #[must_use]
    pub fn keys(&self, standing: &Standing, bottom: &[String]) -> String {
        let mut keys = String::new();
        let mut key = |line: String| {
            keys.push_str(&line);
            keys.push('\n');
        };
        if *self == Self::Viscous {
            key("kind = \"viscous\"".into());
            return keys;
        }
        key("kind = \"viscous-spring\"".into());
        key(format!("b = {:?}", self.speed_ratio()));
        if standing.spreading == Spreading::Cylindrical {
            key("spreading = \"cylindrical\"".into());
        }
        if *self == Self::StaticSprings {
            for (axis, distance) in ['x', 'y', 'z'].into_iter().zip(standing.distances) {
                let distance = self.distance(&standing.medium, distance);
                key(format!("{axis} = {{ distance = {distance:.6e} }}"));
            }
        }
        if *self == Self::IncidentOnly {
            key(format!("input = {{ incident-only = {bottom:?} }}"));
        }
        keys
    }
}
