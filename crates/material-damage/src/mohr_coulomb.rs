//! Mohr-Coulomb yield surface with a tension cut-off.

#[cfg(feature = "keys")]
use powerhouse_model::keys::*;
use powerhouse_model::{ElasticDomain, ElasticMedium, Lane, ParameterError, Stress};

use crate::MaterialError;
use crate::planes::{Nearest, ShearPlane, below_cut_off};
use crate::surface::{PrincipalReturn, YieldSurface, check_frictional, stiffened};

/// Cut-off over cohesion of a surface without friction and without a given cut-off: it has no apex.
const FRICTIONLESS_CUT_OFF: f64 = 1.0e3;

/// Parameters of a [`MohrCoulomb`] surface.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "keys", derive(Deserialize, Serialize, JsonSchema))]
pub struct MohrCoulombParameters {
    /// Elastic medium.
    #[cfg_attr(feature = "keys", serde(rename = "+"), schemars(flatten))]
    pub medium: ElasticMedium,
    /// Friction angle phi (degrees), 0 to 75.
    #[cfg_attr(feature = "keys", serde(with = "NonNegative"))]
    pub friction: f64,
    /// Dilation angle psi (degrees), 0 to the friction angle; as key 0 by default.
    #[cfg_attr(feature = "keys", serde(with = "NonNegative", default))]
    pub dilation: f64,
    /// Cohesion c (Pa), 0 or above.
    #[cfg_attr(feature = "keys", serde(with = "NonNegative"))]
    pub cohesion: f64,
    /// Uniaxial tensile strength: tension cut-off of the greatest principal stress (Pa), 0 or above. Without one
    /// the surface ends at its apex `c cot(phi)` (without friction: at 1000 cohesions).
    #[cfg_attr(feature = "keys", serde(rename = "tensile_strength"))]
    #[cfg_attr(feature = "keys", serde(with = "NonNegative"))]
    #[cfg_attr(feature = "keys", serde(default))]
    #[cfg_attr(feature = "keys", serde(skip_serializing_if = "Option::is_none"))]
    pub tension_strength: Option<f64>,
}

impl MohrCoulombParameters {
    /// Parameters without dilation whose surface yields at the given uniaxial strengths (Pa, positive) in
    /// compression and tension.
    ///
    /// `N = f_c / f_t`, `sin phi = (N - 1) / (N + 1)`, `c = f_c / (2 sqrt N)`
    ///
    /// Friction and cohesion that are listed beside such strengths are not used: one plane is determined
    /// by two numbers.
    ///
    /// # Errors
    /// If a strength is not positive, or the compressive one is not 1 to 50 times the tensile one.
    pub fn through_strengths(
        medium: ElasticMedium,
        compression: f64,
        tension: f64,
    ) -> Result<Self, MaterialError> {
        ParameterError::check("tension", tension, f64::MIN_POSITIVE, 1.0e12)?;
        ParameterError::check("compression", compression, tension, 50.0 * tension)?;
        let ratio = compression / tension;
        Ok(Self {
            medium,
            friction: ((ratio - 1.0) / (ratio + 1.0)).asin().to_degrees(),
            dilation: 0.0,
            cohesion: 0.5 * compression / ratio.sqrt(),
            tension_strength: Some(tension),
        })
    }
}

/// Mohr-Coulomb yield surface with a tension cut-off and non-associated flow.
///
/// With principal stresses `s1 >= s2 >= s3`, `N = (1 + sin phi) / (1 - sin phi)`, `m` the same of
/// the dilation angle, and the cut-off `T` (at most the apex):
///
/// - shear: `F = N s1 - s3 - 2 c sqrt(N) <= 0`, flow along `m s1 - s3`;
/// - tension: `s1 <= T`, flow along `s1`;
/// - on edges and corners any positive combination of the flows of the faces that meet
///   (Koiter 1953).
///
/// The return is implicit and exact, without iteration: faces are planes in principal stresses,
/// so each of the nine faces, edges and corners to which a sorted trial can return gives its stress
/// in closed form, and the one that violates sign of flow and surface least (no more than by
/// rounding) is the solution. For associated flow this is the closest point in the energy norm
/// (Simo & Hughes, *Computational Inelasticity*, 1998, ch. 5). A cut-off above the apex is
/// without effect and is set to the apex, where flow is any combination of all faces; see
/// [`findings`](Self::findings).
///
/// Sources: Coulomb (1776), Mohr (1900); returns to plane, edges and apex in principal stresses:
/// Clausen, Damkilde & Andersen (2006), *Int. J. Numer. Meth. Engng* 66.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MohrCoulomb {
    parameters: MohrCoulombParameters,
    /// Shear plane of `N`, `m` and the uniaxial compressive strength `2 c sqrt(N)`.
    plane: ShearPlane,
    /// Effective tension cut-off `T` (Pa).
    tension: f64,
    /// Whether the cut-off is at the apex of the shear plane.
    ends_at_apex: bool,
    /// Ratio of the elastic constants, `lambda / 2G`.
    volumetric: f64,
}

/// Passive pressure coefficient `(1 + sin x) / (1 - sin x)` of an angle in degrees.
pub(crate) fn passive_ratio(angle: f64) -> f64 {
    let sine = angle.to_radians().sin();
    (1.0 + sine) / (1.0 - sine)
}

impl MohrCoulomb {
    /// Surface of the given parameters.
    ///
    /// # Errors
    /// If a parameter is outside its range, or the dilation is above the friction.
    pub fn new(parameters: MohrCoulombParameters) -> Result<Self, MaterialError> {
        let MohrCoulombParameters {
            medium,
            friction,
            dilation,
            cohesion,
            tension_strength,
        } = parameters;
        check_frictional(&medium, friction, dilation, cohesion)?;
        let ratio = passive_ratio(friction);
        let strength = 2.0 * cohesion * ratio.sqrt();
        let tip = strength / (ratio - 1.0);
        let apex = tip.min(FRICTIONLESS_CUT_OFF * cohesion);
        let tension = match tension_strength {
            Some(listed) => {
                ParameterError::check("tension_strength", listed, 0.0, 1.0e12)?;
                listed.min(apex)
            }
            None => apex,
        };
        Ok(Self {
            parameters,
            plane: ShearPlane::new(ratio, passive_ratio(dilation), strength),
            tension,
            ends_at_apex: tension == tip,
            volumetric: medium.poisson / (1.0 - 2.0 * medium.poisson),
        })
    }

    /// Parameters of the surface.
    pub fn parameters(&self) -> &MohrCoulombParameters {
        &self.parameters
    }

    /// Mean stress at the apex of the shear plane, `c cot(phi)` (Pa); infinite without friction.
    pub fn apex(&self) -> f64 {
        self.parameters.cohesion / self.parameters.friction.to_radians().tan()
    }

    /// Effective tension cut-off: the given one, or that of the apex if this is less (Pa).
    pub fn cut_off(&self) -> f64 {
        self.tension
    }
}

impl YieldSurface for MohrCoulomb {
    fn name(&self) -> &str {
        "mohr-coulomb"
    }
    fn medium(&self) -> ElasticMedium {
        self.parameters.medium
    }
    fn with_stiffness(&self, factor: f64) -> Self {
        let mut surface = *self;
        surface.parameters.medium = stiffened(&self.parameters.medium, factor);
        surface
    }

    /// Uses that the greatest principal deviator is at most `2 sqrt(J2 / 3)`.
    #[inline(always)]
    fn bound<L: Lane>(&self, stress: &Stress<L>) -> L {
        let (mean, shear) = stress.mean_and_shear();
        let number = |value: f64| mean.constant(value);
        let reach = number(2.0 / 3.0_f64.sqrt());
        let in_tension = reach.mul_add(shear, mean - number(self.tension));
        self.plane.bound(mean, shear).max(in_tension)
    }

    fn elastic_domain(&self) -> Option<ElasticDomain> {
        let domain = self.plane.part_of(ElasticDomain::EVERYTHING);
        Some(below_cut_off(domain, self.tension))
    }

    #[inline(always)]
    fn excess<L: Lane>(&self, &[s1, _, s3]: &[L; 3]) -> L {
        let tension = s1 - s1.constant(self.tension);
        self.plane.excess(s1, s3).max(tension)
    }

    #[inline(always)]
    fn return_principal<L: Lane>(&self, trial: &[L; 3]) -> PrincipalReturn<L> {
        let excess = self.excess(trial);
        let mut nearest = Nearest::new(trial, excess, self.volumetric, self.tension);
        nearest.offer_shear(&self.plane, None, self.tension);
        if nearest.is_open() {
            if self.ends_at_apex {
                nearest.offer_apex(&self.plane);
            } else {
                nearest.offer_corner();
                nearest.offer_cut_off(&self.plane);
                nearest.offer_meeting(&self.plane);
            }
        }
        nearest.found()
    }

    fn uniaxial_tension(&self) -> f64 {
        self.tension.min(self.plane.strength / self.plane.friction)
    }
    fn uniaxial_compression(&self) -> f64 {
        self.plane.strength
    }
    fn flow_in_uniaxial_tension(&self) -> [f64; 3] {
        if self.tension <= self.plane.strength / self.plane.friction {
            return [1.0, 0.0, 0.0];
        }
        let lateral = -0.5 / self.plane.dilation;
        [1.0, lateral, lateral]
    }
    fn flow_in_uniaxial_compression(&self) -> [f64; 3] {
        let lateral = 0.5 * self.plane.dilation;
        [lateral, lateral, -1.0]
    }
}
