//! Drucker-Prager yield surface.

#[cfg(feature = "keys")]
use powerhouse_model::keys::*;
use powerhouse_model::{ElasticDomain, ElasticMedium, Lane, Stress, each};

use crate::MaterialError;
use crate::surface::{
    PrincipalReturn, StressReturn, YieldState, YieldSurface, check_frictional, far_lanes, stiffened,
};

/// Fit of a Drucker-Prager cone to a Mohr-Coulomb surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "keys", derive(Deserialize, JsonSchema))]
#[cfg_attr(feature = "keys", serde(rename_all = "kebab-case"))]
pub enum ConeFit {
    /// Touches all six faces from inside: `a = sin / sqrt(9 + 3 sin^2)`, `k = 3 c cos / sqrt(9 +
    /// 3 sin^2)`.
    #[default]
    Inscribed,
    /// Through the edges of triaxial compression: `a = 2 sin / (sqrt 3 (3 - sin))`, `k = 6 c cos /
    /// (sqrt 3 (3 - sin))`. It overestimates the strength elsewhere, in extension most of all.
    Circumscribed,
    /// Fails in plane strain where Mohr-Coulomb does, whatever the dilation: with `b` of the flow,
    /// `a = (sin / 3) / w`, `k = c cos / w`, `w = sqrt(1 - 3 b^2) + b sin`. Associated, it is the
    /// inscribed cone.
    PlaneStrain,
}

/// Parameters of a [`DruckerPrager`] surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DruckerPragerParameters {
    /// Elastic medium.
    pub medium: ElasticMedium,
    /// Mohr-Coulomb friction angle phi (degrees), 0 to 75.
    pub friction: f64,
    /// Dilation angle psi (degrees), 0 to the friction angle.
    pub dilation: f64,
    /// Cohesion c (Pa), at least 0.
    pub cohesion: f64,
    /// Fit of the cone and of the flow to Mohr-Coulomb.
    pub fit: ConeFit,
}

/// Drucker-Prager yield surface with non-associated flow, a cone in stress space.
///
/// `F = sqrt(J2) + a I1 - k <= 0`, flow along `sqrt(J2) + b I1`
///
/// The return is exact: `2G`-scaled flow `g = F / (1 + 9 (K / G) a b)` lowers `sqrt(J2)` by `g`
/// and the mean stress by `3 (K / G) b g`; where the deviator would change sign the stress is returned
/// to the apex `k / 3a`. Without friction it is the cylinder of von Mises. The coefficient `b` of
/// the flow is the same function of the dilation as `a` of the friction (in plane strain: as in
/// the inscribed cone, so that the dilation angle is that of plane strain).
///
/// Source: Drucker & Prager (1952), *Quarterly of Applied Mathematics* 10; fits: Chen & Mizuno,
/// *Nonlinear Analysis in Soil Mechanics* (1990).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DruckerPrager {
    parameters: DruckerPragerParameters,
    /// Coefficient `a` of the yield function.
    friction: f64,
    /// Coefficient `b` of the flow rule.
    dilation: f64,
    /// Strength `k` (Pa).
    strength: f64,
    /// Ratio of bulk to shear modulus, `K / G`.
    stiffness_ratio: f64,
}

const ROOT_3: f64 = 1.732_050_807_568_877_2;

/// Coefficient of the mean stress, and of `c cos phi`, of a cone fitted to edges or faces.
fn cone(fit: ConeFit, sine: f64) -> (f64, f64) {
    match fit {
        ConeFit::Inscribed | ConeFit::PlaneStrain => {
            let root = (9.0 + 3.0 * sine * sine).sqrt();
            (sine / root, 3.0 / root)
        }
        ConeFit::Circumscribed => {
            let divisor = ROOT_3 * (3.0 - sine);
            (2.0 * sine / divisor, 6.0 / divisor)
        }
    }
}

impl DruckerPrager {
    /// Surface of the given parameters.
    ///
    /// # Errors
    /// If a parameter is outside its range, or the dilation is above the friction.
    pub fn new(parameters: DruckerPragerParameters) -> Result<Self, MaterialError> {
        let DruckerPragerParameters {
            medium,
            friction,
            dilation,
            cohesion,
            fit,
        } = parameters;
        check_frictional(&medium, friction, dilation, cohesion)?;
        let (sine, cosine) = friction.to_radians().sin_cos();
        let (flow, _) = cone(fit, dilation.to_radians().sin());
        let (slope, share) = match fit {
            ConeFit::PlaneStrain => {
                let width = (1.0 - 3.0 * flow * flow).sqrt() + flow * sine;
                (sine / (3.0 * width), 1.0 / width)
            }
            _ => cone(fit, sine),
        };
        Ok(Self {
            parameters,
            friction: slope,
            dilation: flow,
            strength: share * cohesion * cosine,
            stiffness_ratio: medium.bulk() / medium.shear(),
        })
    }

    /// Parameters of the surface.
    pub fn parameters(&self) -> &DruckerPragerParameters {
        &self.parameters
    }

    /// Coefficients `a` and `b` (1) and `k` (Pa) of yield function and flow rule.
    pub fn coefficients(&self) -> [f64; 3] {
        [self.friction, self.dilation, self.strength]
    }

    /// Mean stress at the apex, `k / 3a` (Pa); infinite without friction.
    pub fn apex(&self) -> f64 {
        self.strength / (3.0 * self.friction)
    }

    /// Return of a trial of mean stress and `sqrt(J2)` (Pa) outside the surface.
    #[inline(always)]
    fn cone_return<L: Lane>(&self, mean: L, shear: L) -> ConeReturn<L> {
        let number = |value: f64| mean.constant(value);
        let (zero, one) = (number(0.0), number(1.0));
        let ratio = self.stiffness_ratio;
        let hardness = 1.0 + 9.0 * ratio * self.friction * self.dilation;
        let flow = self.yield_function(mean, shear) * number(1.0 / hardness);
        let lowered = number(3.0 * ratio * self.dilation) * flow;
        let returned = mean - lowered;
        // Exactly on the cone, whatever the rounding of the mean.
        let radius = number(self.strength) - number(3.0 * self.friction) * returned;
        let divisor = shear.select(zero.less(shear), one);
        let left = radius.max(zero) / divisor;
        let lost = flow / divisor;
        let apex = if self.friction > 0.0 {
            number(self.apex())
        } else {
            zero
        };
        let to_apex = shear.less(flow);
        let [tension, sheared] = [YieldState::Tension, YieldState::Shear].map(YieldState::number);
        ConeReturn {
            mean: [
                apex.select(to_apex, returned),
                (mean - apex).select(to_apex, lowered),
            ],
            deviator: [zero.select(to_apex, left), one.select(to_apex, lost)],
            state: number(tension).select(to_apex, number(sheared)),
        }
    }

    /// Yield function of mean stress and `sqrt(J2)` (Pa).
    #[inline(always)]
    fn yield_function<L: Lane>(&self, mean: L, shear: L) -> L {
        let slope = mean.constant(3.0 * self.friction);
        slope.mul_add(mean, shear - mean.constant(self.strength))
    }
}

/// Stress of a scaled deviator (Pa) and a mean stress (Pa).
#[inline(always)]
fn stress_of<L: Lane>(deviator: &[L; 6], share: L, mean: L) -> Stress<L> {
    let [xx, yy, zz, xy, yz, zx] = each(deviator, |s| s * share);
    Stress([xx + mean, yy + mean, zz + mean, xy, yz, zx])
}

/// Mean stress and `sqrt(J2)` of principal stresses (Pa).
#[inline(always)]
fn invariants<L: Lane>(&[s1, s2, s3]: &[L; 3]) -> (L, L) {
    let zero = s1.constant(0.0);
    Stress([s1, s2, s3, zero, zero, zero]).mean_and_shear()
}

/// Return to the cone or to its apex, in the direction of the trial's deviator.
struct ConeReturn<L> {
    /// Mean stress after the return, and its decrease (Pa).
    mean: [L; 2],
    /// Shares of the trial's deviator that remain and that are removed.
    deviator: [L; 2],
    /// Number of the [`YieldState`] as stored in the history.
    state: L,
}

impl YieldSurface for DruckerPrager {
    fn name(&self) -> &str {
        "drucker-prager"
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
        self.yield_function(mean, shear)
    }
    fn elastic_domain(&self) -> Option<ElasticDomain> {
        let slope = 3.0 * self.friction;
        Some(ElasticDomain::EVERYTHING.within(slope, 1.0, self.strength))
    }
    #[inline(always)]
    fn excess<L: Lane>(&self, principal: &[L; 3]) -> L {
        let (mean, shear) = invariants(principal);
        self.yield_function(mean, shear)
    }
    #[inline(always)]
    fn return_principal<L: Lane>(&self, trial: &[L; 3]) -> PrincipalReturn<L> {
        let (mean, shear) = invariants(trial);
        let ConeReturn {
            mean: [returned, lowered],
            deviator: [left, lost],
            state,
        } = self.cone_return(mean, shear);
        PrincipalReturn {
            stress: each(trial, |s| (s - mean).mul_add(left, returned)),
            loss: each(trial, |s| (s - mean).mul_add(lost, lowered)),
            state,
        }
    }
    /// The return is along the deviator of the trial, so that no principal values are needed.
    #[inline(always)]
    fn return_stress<L: Lane>(&self, trial: &Stress<L>) -> Option<StressReturn<L>> {
        let (mean, shear) = trial.mean_and_shear();
        let zero = mean.constant(0.0);
        let outside = zero.less(self.yield_function(mean, shear));
        if !mean.any(outside) {
            return None;
        }
        let ConeReturn {
            mean: [returned, lowered],
            deviator: [left, lost],
            state,
        } = self.cone_return(mean, shear);
        let [xx, yy, zz, xy, yz, zx] = trial.0;
        let deviator = [xx - mean, yy - mean, zz - mean, xy, yz, zx];
        let trial_size = mean.abs().max(shear);
        let far = far_lanes(returned.abs().max(left * shear), trial_size);
        Some(StressReturn {
            outside,
            loss: stress_of(&deviator, lost, lowered),
            far: match far {
                Some(far) => Some((far, stress_of(&deviator, left, returned))),
                None => None,
            },
            state,
        })
    }
    fn uniaxial_tension(&self) -> f64 {
        self.strength / (self.friction + 1.0 / ROOT_3)
    }
    fn uniaxial_compression(&self) -> f64 {
        self.strength / (1.0 / ROOT_3 - self.friction)
    }
    fn flow_in_uniaxial_tension(&self) -> [f64; 3] {
        let lateral = (self.dilation - 0.5 / ROOT_3) / (self.dilation + 1.0 / ROOT_3);
        [1.0, lateral, lateral]
    }
    fn flow_in_uniaxial_compression(&self) -> [f64; 3] {
        let lateral = (self.dilation + 0.5 / ROOT_3) / (1.0 / ROOT_3 - self.dilation);
        [lateral, lateral, -1.0]
    }
}
