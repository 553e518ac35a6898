//! The absorbing boundaries that are compared.

use std::sync::Arc;

use powerhouse::boundary::reflection::{BodyWave, reflection};
use powerhouse::boundary::{
    AxisParameters, FaceCoefficients, InputMode, Spreading, Viscous, ViscousSpring,
};
use powerhouse::model::{AbsorbingBoundary, ElasticMedium, ParameterError};

/// Coefficient A of all viscous-spring boundaries.
const AMPLITUDE_RATIO: f64 = 0.8;

/// Kind of absorbing boundary, as a scene's `[boundary]` table describes it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BoundaryKind {
    /// Viscous boundary: dashpots without springs.
    Viscous,
    /// Viscous-spring boundary with A = 0.8 and a given coefficient B.
    Springs {
        /// Coefficient B: ratio of physical to apparent wave speed.
        speed_ratio: f64,
    },
    /// Viscous-spring boundary with the static stiffness of the ground outside the mesh, and dashpots with B = 1.
    StaticSprings,
    /// Viscous-spring boundary with B = 1.1 that applies only the incident wave at the bottom, as in Wang, Chen &
    /// Xiao (2019).
    IncidentOnly,
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
    /// All compared boundaries, in order of increasing complexity.
    pub const ALL: [Self; 5] = [
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

    /// Spring and dashpot coefficients per area of a face at a distance (m) from the scatterer.
    #[must_use]
    pub fn face(&self, surroundings: &Surroundings, distance: f64) -> FaceCoefficients {
        let medium = &surroundings.medium;
        if *self == Self::Viscous {
            return FaceCoefficients::viscous(medium);
        }
        let distance = self.distance(medium, distance);
        let face =
            FaceCoefficients::viscous_spring(medium, AMPLITUDE_RATIO, self.speed_ratio(), distance);
        match surroundings.spreading {
            Spreading::Spherical => face,
            Spreading::Cylindrical => face.with_springs_scaled(0.5),
        }
    }

    /// Amplitude reflection coefficients of P and SV waves at normal incidence, of a face at a distance (m) and at
    /// a frequency (Hz).
    ///
    /// # Errors
    /// A frequency that is not positive.
    pub fn reflected(
        &self,
        surroundings: &Surroundings,
        distance: f64,
        frequency: f64,
    ) -> Result<[f64; 2], ParameterError> {
        let face = self.face(surroundings, distance);
        let rate = core::f64::consts::TAU * frequency;
        let of = |wave| reflection(&surroundings.medium, &face, wave, 0.0, rate);
        let (p, sv) = (of(BodyWave::P)?, of(BodyWave::Sv)?);
        Ok([p.p.norm(), sv.sv.norm()])
    }

    /// Whether the boundary resists static loads: every kind but dashpots alone.
    #[must_use]
    pub fn resists_static_loads(&self) -> bool {
        *self != Self::Viscous
    }

    /// The lines of a scene's `[boundary]` table for this boundary, without `faces` and `scatterer`.
    #[must_use]
    pub fn keys(&self, surroundings: &Surroundings, bottom: &[String]) -> String {
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
        if surroundings.spreading == Spreading::Cylindrical {
            key("spreading = \"cylindrical\"".into());
        }
        if *self == Self::StaticSprings {
            for (axis, distance) in ['x', 'y', 'z'].into_iter().zip(surroundings.distances) {
                let distance = self.distance(&surroundings.medium, distance);
                key(format!("{axis} = {{ distance = {distance:.6e} }}"));
            }
        }
        if *self == Self::IncidentOnly {
            key(format!("input = {{ incident-only = {bottom:?} }}"));
        }
        keys
    }
}
