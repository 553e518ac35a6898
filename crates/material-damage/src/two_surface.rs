//! Yield surface with given uniaxial strengths.

#[cfg(feature = "keys")]
use powerhouse_model::keys::*;
use powerhouse_model::{ElasticDomain, ElasticMedium, Lane, ParameterError, Stress};

use crate::MaterialError;
use crate::mohr_coulomb::passive_ratio;
use crate::planes::{Nearest, ShearPlane, below_cut_off};
use crate::surface::{PrincipalReturn, YieldSurface, check_frictional, stiffened};

/// Parameters of a [`TwoSurface`] surface: yield surfaces through the given uniaxial strengths, with the friction of
/// Mohr-Coulomb under confinement.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "keys", derive(Deserialize, Serialize, JsonSchema))]
pub struct TwoSurfaceParameters {
    /// Elastic medium.
    #[cfg_attr(feature = "keys", serde(rename = "+"), schemars(flatten))]
    pub medium: ElasticMedium,
    /// Friction angle phi under confinement (degrees), 0 to 75.
    #[cfg_attr(feature = "keys", serde(with = "NonNegative"))]
    pub friction: f64,
    /// Dilation angle psi (degrees), 0 to the friction angle; as key 0 by default.
    #[cfg_attr(feature = "keys", serde(with = "NonNegative", default))]
    pub dilation: f64,
    /// Cohesion c under confinement (Pa), at least 0; `f_c / (2 sqrt N)` is used if it is less.
    #[cfg_attr(feature = "keys", serde(with = "NonNegative"))]
    pub cohesion: f64,
    /// Uniaxial tensile strength `f_t` (Pa), above 0.
    #[cfg_attr(feature = "keys", serde(rename = "tensile_strength"))]
    #[cfg_attr(feature = "keys", serde(with = "NonNegative"))]
    pub tension_strength: f64,
    /// Uniaxial compressive strength `f_c` (Pa), above `N f_t`.
    #[cfg_attr(feature = "keys", serde(rename = "compressive_strength"))]
    #[cfg_attr(feature = "keys", serde(with = "Positive"))]
    pub compression_strength: f64,
}

/// Yield surface with given strengths in uniaxial tension and compression, and Mohr-Coulomb friction
/// under confinement.
///
/// With principal stresses `s1 >= s2 >= s3`, `N = (1 + sin phi) / (1 - sin phi)`, and `m` the same
/// of the dilation angle:
///
/// - strengths: `(f_c / f_t) s1 - s3 <= f_c`, through `(f_t, 0, 0)` and `(0, 0, -f_c)`;
/// - friction: `N s1 - s3 <= C`, `C = max(2 c sqrt(N), f_c)`, which governs where `s1 <= (f_c - C) /
///   (f_c / f_t - N)`, which is never tensile;
/// - tension: `s1 <= f_t`.
///
/// Both planes flow along `m s1 - s3`, the cut-off along `s1`. The return is the exact
/// one of [`MohrCoulomb`](crate::MohrCoulomb). As both shear planes have the same flow, no trial returns
/// to the line between them.
///
/// # Valid range
/// A cohesion below `f_c / (2 sqrt N)` is inconsistent with `f_c`: a convex surface with friction
/// `phi` has no less strength under confinement than without, so the friction plane then passes through
/// `(0, 0, -f_c)`; see [`cohesion`](Self::cohesion). Perfectly plastic.
///
/// # Why so
/// *A plane, and not the cut-off alone, joins the uniaxial strengths*: with the friction plane and
/// a cut-off, concrete under lateral tension of `0.9 f_t` would still have more than half of `f_c`; tests
/// of plates in tension and compression (Kupfer, Hilsdorf & Rusch 1969) are near the straight line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoSurface {
    parameters: TwoSurfaceParameters,
    strengths: ShearPlane,
    friction: ShearPlane,
    /// Greatest stress on the line where the shear planes meet (Pa), not positive.
    crossing: f64,
    /// Ratio of the elastic constants, `lambda / 2G`.
    volumetric: f64,
}

impl TwoSurface {
    /// Surface of the given parameters.
    ///
    /// # Errors
    /// If a parameter is outside its range, the dilation is above the friction, or the ratio of the
    /// strengths is not above `N` ([`MaterialError::StrengthRatio`]).
    pub fn new(parameters: TwoSurfaceParameters) -> Result<Self, MaterialError> {
        let TwoSurfaceParameters {
            medium,
            friction,
            dilation,
            cohesion,
            tension_strength,
            compression_strength,
        } = parameters;
        check_frictional(&medium, friction, dilation, cohesion)?;
        for (name, strength) in [
            ("tension_strength", tension_strength),
            ("compression_strength", compression_strength),
        ] {
            ParameterError::check(name, strength, f64::MIN_POSITIVE, 1.0e12)?;
        }
        let least = passive_ratio(friction);
        let ratio = compression_strength / tension_strength;
        if !(ratio > least && ratio <= 1.0e6) {
            return Err(MaterialError::StrengthRatio { ratio, least });
        }
        let dilation = passive_ratio(dilation);
        let strength = (2.0 * cohesion * least.sqrt()).max(compression_strength);
        Ok(Self {
            parameters,
            strengths: ShearPlane::new(ratio, dilation, compression_strength),
            friction: ShearPlane::new(least, dilation, strength),
            crossing: (compression_strength - strength) / (ratio - least),
            volumetric: medium.poisson / (1.0 - 2.0 * medium.poisson),
        })
    }

    /// Parameters of the surface.
    pub fn parameters(&self) -> &TwoSurfaceParameters {
        &self.parameters
    }

    /// Cohesion under confinement (Pa): the given one, at least `f_c / (2 sqrt N)`.
    pub fn cohesion(&self) -> f64 {
        0.5 * self.friction.strength / self.friction.friction.sqrt()
    }
}

impl YieldSurface for TwoSurface {
    fn name(&self) -> &str {
        "two-surface"
    }
    fn medium(&self) -> ElasticMedium {
        self.parameters.medium
    }
    fn with_stiffness(&self, factor: f64) -> Self {
        let mut surface = *self;
        surface.parameters.medium = stiffened(&self.parameters.medium, factor);
        surface
    }
    #[inline(always)]
    fn bound<L: Lane>(&self, stress: &Stress<L>) -> L {
        let (mean, shear) = stress.mean_and_shear();
        let number = |value: f64| mean.constant(value);
        let reach = number(2.0 / 3.0_f64.sqrt());
        let in_tension = reach.mul_add(shear, mean - number(self.parameters.tension_strength));
        let in_shear = self.strengths.bound(mean, shear);
        in_tension.max(in_shear.max(self.friction.bound(mean, shear)))
    }
    fn elastic_domain(&self) -> Option<ElasticDomain> {
        let domain = self.strengths.part_of(ElasticDomain::EVERYTHING);
        let domain = self.friction.part_of(domain);
        Some(below_cut_off(domain, self.parameters.tension_strength))
    }
    #[inline(always)]
    fn excess<L: Lane>(&self, &[s1, _, s3]: &[L; 3]) -> L {
        let shear = self.strengths.excess(s1, s3);
        let shear = shear.max(self.friction.excess(s1, s3));
        shear.max(s1 - s1.constant(self.parameters.tension_strength))
    }
    #[inline(always)]
    fn return_principal<L: Lane>(&self, trial: &[L; 3]) -> PrincipalReturn<L> {
        let tension = self.parameters.tension_strength;
        let excess = self.excess(trial);
        let mut nearest = Nearest::new(trial, excess, self.volumetric, tension);
        nearest.offer_shear(&self.strengths, Some(self.crossing), tension);
        if nearest.is_open() {
            nearest.offer_shear(&self.friction, None, self.crossing);
        }
        if nearest.is_open() {
            nearest.offer_corner();
            nearest.offer_cut_off(&self.strengths);
            nearest.offer_meeting(&self.strengths);
        }
        nearest.found()
    }
    fn uniaxial_tension(&self) -> f64 {
        self.parameters.tension_strength
    }
    fn uniaxial_compression(&self) -> f64 {
        self.parameters.compression_strength
    }
    fn flow_in_uniaxial_tension(&self) -> [f64; 3] {
        [1.0, 0.0, 0.0]
    }
    fn flow_in_uniaxial_compression(&self) -> [f64; 3] {
        let lateral = 0.5 * self.strengths.dilation;
        [lateral, lateral, -1.0]
    }
}
