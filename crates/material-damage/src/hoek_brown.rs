//! Hoek-Brown yield surface.

#[cfg(feature = "keys")]
use powerhouse_model::keys::*;
use powerhouse_model::{ElasticDomain, ElasticMedium, Lane, ParameterError, Scalar, Stress};

use crate::MaterialError;
use crate::exponential::power;
use crate::planes::ShearPlane;
use crate::root::{Function, zero_between};
use crate::surface::{PrincipalReturn, YieldState, YieldSurface, pick, stiffened};

/// Parameters of a [`HoekBrown`] surface of a rock mass (Hoek, Carranza-Torres & Corkum 2002).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "keys", derive(Deserialize, Serialize, JsonSchema))]
pub struct HoekBrownParameters {
    /// Elastic medium of the rock mass.
    #[cfg_attr(feature = "keys", serde(rename = "+"), schemars(flatten))]
    pub medium: ElasticMedium,
    /// Uniaxial compressive strength of the intact rock `s_ci` (Pa), above 0.
    #[cfg_attr(feature = "keys", serde(with = "Positive"))]
    pub intact_strength: f64,
    /// Material constant of the intact rock `m_i` (1), 1 to 50.
    #[cfg_attr(feature = "keys", serde(with = "Positive"))]
    pub intact_constant: f64,
    /// Geological strength index GSI (1), 5 to 100.
    #[cfg_attr(feature = "keys", serde(with = "Positive"))]
    pub strength_index: f64,
    /// Disturbance factor `D` of blast damage and stress relief (1), 0 (undisturbed) to 1; as key 0 by default.
    #[cfg_attr(feature = "keys", serde(with = "NonNegative", default))]
    pub disturbance: f64,
    /// Dilation as a share of that of associated flow (1), 0 to 1; as key 0 by default.
    #[cfg_attr(feature = "keys", serde(with = "NonNegative", default))]
    pub dilation_share: f64,
}

/// Hoek-Brown yield surface of rock masses, with non-associated flow.
///
/// With principal stresses `s1 >= s2 >= s3`, tension positive:
///
/// `F = s1 - s3 - s_ci (s - m s1 / s_ci)^a <= 0`
///
/// `m = m_i exp((GSI - 100) / (28 - 14 D))`, `s = exp((GSI - 100) / (9 - 3 D))`,
/// `a = 1/2 + (exp(-GSI / 15) - exp(-20 / 3)) / 6`
///
/// with flow along `(1 + x a m (s - m s1 / s_ci)^(a - 1)) s1 - s3` where `x` is the
/// [`dilation_share`](HoekBrownParameters::dilation_share). The surface ends in the apex `s1 = s2 =
/// s3 = s s_ci / m`, where any dilatant flow is possible.
///
/// # Return
/// The deviatoric flow keeps its axes, and on the face and on each edge the condition is one
/// equation in one unknown: `y = (s - m s1 / s_ci)^a`. Face, both edges and the apex are computed;
/// the solution is the one that violates sign of flow and order of stresses least. For associated
/// flow it is the closest point in the energy norm.
///
/// # Valid range
/// Perfectly plastic. The rock mass is isotropic; a single family of joints is not represented.
///
/// # Why so
/// *Dilation is relative to associated flow, not an angle*: the friction of this surface falls
/// with pressure, and a fixed angle would exceed it at depth and generate energy. With a ratio of at
/// most one, `stress : flow` is never negative.
///
/// Source: Hoek, Carranza-Torres & Corkum (2002), *Proc. NARMS-TAC*, Eqs. (1)-(5).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HoekBrown {
    parameters: HoekBrownParameters,
    /// Constant `m` of the rock mass (1).
    slope: f64,
    /// Constant `s` of the rock mass (1).
    integrity: f64,
    /// Exponent `a` of the rock mass (1).
    exponent: f64,
    /// Uniaxial tensile stress at yield (Pa).
    tension: f64,
    /// Ratio of the elastic constants, `lambda / 2G`.
    volumetric: f64,
}

/// Pressures over the intact strength at the ends of the chords of the elastic domain.
const CHORDS: [f64; 5] = [0.0, 0.02, 0.1, 0.4, 1.5];

/// Return to the face or to an edge.
struct Branch<L> {
    /// Greatest and least returned stress (Pa).
    greatest: L,
    least: L,
    /// Decrease of all stresses by the volumetric plastic strain (Pa).
    dilated: L,
    /// `2G`-scaled plastic flow along `-s3` and `s1` (Pa).
    flow: L,
    opening: L,
    /// Measure of how far such a return is from being possible (Pa).
    violation: L,
}

/// Yield condition of [`HoekBrown::branch`] as a function of its one unknown.
struct BranchCondition<'a, L> {
    surface: &'a HoekBrown,
    upper: L,
    apart: L,
    weights: [f64; 2],
}

impl<L: Lane> BranchCondition<'_, L> {
    /// Greatest stress (Pa), and the opening and the shear flow that lead to it.
    #[inline(always)]
    fn flows(&self, y: L) -> (L, L, L) {
        let number = |value: f64| y.constant(value);
        let surface = self.surface;
        let (k, r) = (surface.dilation(), surface.volumetric);
        let w1 = self.weights[0];
        let width = power(y, (1.0 - surface.exponent) / surface.exponent);
        let depth = width * y;
        let per_depth = number(surface.parameters.intact_strength / surface.slope);
        let greatest = number(surface.apex()) - per_depth * depth;
        let fall = self.upper - greatest;
        // Opening and shear flow per unit decrease of the greatest stress.
        let [opening, shear] = if k > 0.0 {
            let opened = number(w1) * (width + number(k));
            let whole = opened + number(r * k);
            [(width + number(k)) / whole, width / whole]
        } else {
            [number(1.0 / w1); 2]
        };
        (greatest, fall * opening, fall * shear)
    }
}

impl<L: Lane> Function<L> for BranchCondition<'_, L> {
    #[inline(always)]
    fn at(&self, y: L) -> L {
        let number = |value: f64| y.constant(value);
        let [w1, w3] = self.weights;
        let (_, opening, shear) = self.flows(y);
        let closed = number(w1) * opening + number(w3) * shear;
        self.apart - closed - number(self.surface.parameters.intact_strength) * y
    }
}

impl HoekBrown {
    /// Surface of the given parameters.
    ///
    /// # Errors
    /// If a parameter is outside its range.
    pub fn new(parameters: HoekBrownParameters) -> Result<Self, MaterialError> {
        let p = &parameters;
        let medium = p.medium.checked()?;
        for (name, value, from, to) in [
            (
                "intact_strength",
                p.intact_strength,
                f64::MIN_POSITIVE,
                1.0e12,
            ),
            ("intact_constant", p.intact_constant, 1.0, 50.0),
            ("strength_index", p.strength_index, 5.0, 100.0),
            ("disturbance", p.disturbance, 0.0, 1.0),
            ("dilation_share", p.dilation_share, 0.0, 1.0),
        ] {
            ParameterError::check(name, value, from, to)?;
        }
        let below = p.strength_index - 100.0;
        let slope = p.intact_constant * (below / (28.0 - 14.0 * p.disturbance)).exp();
        let integrity = (below / (9.0 - 3.0 * p.disturbance)).exp();
        let curved = (-p.strength_index / 15.0).exp() - (-20.0_f64 / 3.0).exp();
        let mut surface = Self {
            slope,
            integrity,
            exponent: 0.5 + curved / 6.0,
            tension: 0.0,
            volumetric: medium.poisson / (1.0 - 2.0 * medium.poisson),
            parameters,
        };
        let apex = surface.apex();
        let tolerance = 4.0 * f64::EPSILON * apex;
        let at = |stress: f64| surface.excess(&[stress, 0.0, 0.0]);
        surface.tension = zero_between([0.0, at(0.0)], [apex, at(apex)], tolerance, &at);
        Ok(surface)
    }

    /// Parameters of the surface.
    pub fn parameters(&self) -> &HoekBrownParameters {
        &self.parameters
    }

    /// Constants `m`, `s` and `a` of the rock mass (1).
    pub fn constants(&self) -> [f64; 3] {
        [self.slope, self.integrity, self.exponent]
    }

    /// Principal stress at the apex, `s s_ci / m` (Pa).
    pub fn apex(&self) -> f64 {
        self.integrity * self.parameters.intact_strength / self.slope
    }

    /// Depth below the apex in the units of the formula, `s - m s1 / s_ci` (1).
    #[inline(always)]
    fn depth<L: Lane>(&self, greatest: L) -> L {
        let number = |value: f64| greatest.constant(value);
        number(self.integrity) - number(self.slope / self.parameters.intact_strength) * greatest
    }

    /// Opening flow at unit depth less one, `x a m`.
    fn dilation(&self) -> f64 {
        self.parameters.dilation_share * self.exponent * self.slope
    }

    /// Return of two trial stresses of which the first falls by `w1 M g` and the second rises
    /// by `w3 g`, in addition to the common decrease `r (M - 1) g`, with the opening flow `M` of the surface.
    ///
    /// With `u` the depth, `y = u^a`, `w = u / y` and `k = x a m`, `M = 1 + k / w`, so `g = w q` with
    /// `q (w1 (w + k) + r k) = upper - s1`, and the yield condition is `upper - lower - q (w1 (w + k)
    /// + w3 w) = s_ci y`.
    #[inline(always)]
    fn branch<L: Lane>(&self, [upper, lower]: [L; 2], [w1, w3]: [f64; 2]) -> Branch<L> {
        let number = |value: f64| upper.constant(value);
        let zero = number(0.0);
        let r = self.volumetric;
        let intact = self.parameters.intact_strength;
        let condition = BranchCondition {
            surface: self,
            upper,
            apart: upper - lower,
            weights: [w1, w3],
        };
        // Bracket: no flow yet, and the flow that makes both stresses equal.
        let depth = self.depth(upper);
        let first = power(depth.max(zero), self.exponent);
        let most = condition.apart * number(self.slope / intact * (1.0 + r / w1));
        let last = power((depth + most).max(zero), self.exponent).max(first);
        let at_first = condition.at(first);
        let violation = (-at_first).max(zero);
        let at_first = at_first.max(zero);
        let at_last = condition.at(last).min(zero);
        let size = upper.abs() + lower.abs() + number(self.apex());
        let tolerance = size * number(L::Scalar::EPSILON);
        let y = zero_between([first, at_first], [last, at_last], tolerance, &condition);
        let (greatest, opening, flow) = condition.flows(y);
        Branch {
            greatest,
            least: greatest - number(intact) * y,
            dilated: number(r) * (opening - flow),
            flow,
            opening,
            violation,
        }
    }
}

/// Candidate among face, edges and apex with the least violation of the conditions so far.
struct Best<L> {
    violation: L,
    stress: [L; 3],
    loss: [L; 3],
    state: L,
}

impl<L: Lane> Best<L> {
    #[inline(always)]
    fn offer(&mut self, stress: [L; 3], loss: [L; 3], violation: L) {
        let better = violation.less(self.violation);
        self.violation = violation.select(better, self.violation);
        self.stress = pick(better, &stress, &self.stress);
        self.loss = pick(better, &loss, &self.loss);
        let number = self.state.constant(YieldState::Shear.number());
        self.state = number.select(better, self.state);
    }
}

impl YieldSurface for HoekBrown {
    fn name(&self) -> &str {
        "hoek-brown"
    }
    fn medium(&self) -> ElasticMedium {
        self.parameters.medium
    }
    fn with_stiffness(&self, factor: f64) -> Self {
        let mut surface = *self;
        surface.parameters.medium = stiffened(&self.parameters.medium, factor);
        surface
    }

    /// In terms of `z = (s1 - s3) / s_ci`, elastic is `z^(1/a) <= s - m s1 / s_ci`; the stresses
    /// differ by at most `2 sqrt(J2)`, and `z^(1/a)` is at most the mean of `z^1.5` and `z^2` with the
    /// weights that give the exponent.
    #[inline(always)]
    fn bound<L: Lane>(&self, stress: &Stress<L>) -> L {
        let (mean, shear) = stress.mean_and_shear();
        let number = |value: f64| mean.constant(value);
        let intact = self.parameters.intact_strength;
        let apart = shear * number(2.0 / intact);
        let share = 2.0 * (1.0 / self.exponent - 1.5);
        // Not zero, so that its product with infinity is not NaN.
        let rest = (1.0 - share).max(f64::EPSILON);
        let curved = number(rest).mul_add(apart.sqrt(), number(share) * apart);
        let greatest = number(2.0 / 3.0_f64.sqrt()).mul_add(shear, mean);
        number(intact) * apart.mul_add(curved, -self.depth(greatest))
    }

    /// Chords of the curved envelope are inside it; beyond the last one strength no longer grows.
    fn elastic_domain(&self) -> Option<ElasticDomain> {
        let intact = self.parameters.intact_strength;
        let mut domain = ElasticDomain::EVERYTHING;
        let [mut greatest, mut apart] = [self.apex(), 0.0];
        for pressure in CHORDS {
            let next = -pressure * intact;
            let strength = intact * self.depth(next).powf(self.exponent);
            let slope = (strength - apart) / (next - greatest);
            let chord = ShearPlane::new(1.0 - slope, 1.0, strength - slope * next);
            domain = chord.part_of(domain);
            [greatest, apart] = [next, strength];
        }
        Some(ShearPlane::new(1.0, 1.0, apart).part_of(domain))
    }

    #[inline(always)]
    fn excess<L: Lane>(&self, &[s1, _, s3]: &[L; 3]) -> L {
        let number = |value: f64| s1.constant(value);
        let depth = self.depth(s1).max(number(0.0));
        let strength = number(self.parameters.intact_strength) * power(depth, self.exponent);
        (s1 - s3 - strength).max(s1 - number(self.apex()))
    }

    #[inline(always)]
    fn return_principal<L: Lane>(&self, &[s1, s2, s3]: &[L; 3]) -> PrincipalReturn<L> {
        let number = |value: f64| s1.constant(value);
        let half = number(0.5);
        let apex = number(self.apex());
        let over = [s1 - apex, s2 - apex, s3 - apex];
        let r = self.volumetric;
        let common = number(r / (1.0 + 3.0 * r)) * (over[0] + over[1] + over[2]);
        // At the apex the flow must be an opening along all axes or, without dilation, of the volume.
        let closing = if self.parameters.dilation_share > 0.0 {
            common - over[2]
        } else {
            -common
        };
        let mut best = Best {
            violation: closing,
            stress: [apex; 3],
            loss: over,
            state: number(YieldState::Tension.number()),
        };

        let face = self.branch([s1, s3], [1.0, 1.0]);
        let middle = s2 - face.dilated;
        let violation = (middle - face.greatest).max(face.least - middle);
        best.offer(
            [face.greatest, middle, face.least],
            [
                face.opening + face.dilated,
                face.dilated,
                face.dilated - face.flow,
            ],
            violation.max(-face.flow).max(face.violation),
        );

        // Edge of equal greater stresses: x1 + x2 = M g, x1 - x2 = s1 - s2.
        let apart = half * (s1 - s2);
        let edge = self.branch([half * (s1 + s2), s3], [0.5, 1.0]);
        let fallen = half * edge.opening + edge.dilated;
        best.offer(
            [edge.greatest, edge.greatest, edge.least],
            [fallen + apart, fallen - apart, edge.dilated - edge.flow],
            (s1 - s2 - edge.opening).max(edge.violation),
        );

        // Edge of equal lesser stresses: x2 + x3 = -g, x2 - x3 = s2 - s3.
        let apart = half * (s2 - s3);
        let edge = self.branch([s1, half * (s2 + s3)], [1.0, 0.5]);
        let raised = edge.dilated - half * edge.flow;
        best.offer(
            [edge.greatest, edge.least, edge.least],
            [edge.opening + edge.dilated, raised + apart, raised - apart],
            (s2 - s3 - edge.flow).max(edge.violation),
        );

        PrincipalReturn {
            stress: best.stress,
            loss: best.loss,
            state: best.state,
        }
    }

    fn uniaxial_tension(&self) -> f64 {
        self.tension
    }
    fn uniaxial_compression(&self) -> f64 {
        self.parameters.intact_strength * self.integrity.powf(self.exponent)
    }
    fn flow_in_uniaxial_tension(&self) -> [f64; 3] {
        let depth = self.depth(self.tension);
        let opening = 1.0 + self.dilation() * depth.powf(self.exponent - 1.0);
        [1.0, -0.5 / opening, -0.5 / opening]
    }
    fn flow_in_uniaxial_compression(&self) -> [f64; 3] {
        let opening = 1.0 + self.dilation() * self.integrity.powf(self.exponent - 1.0);
        [0.5 * opening, 0.5 * opening, -1.0]
    }
}
