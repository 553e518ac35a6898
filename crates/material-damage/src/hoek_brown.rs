//! The surface of Hoek and Brown.

use powerhouse_model::{ElasticDomain, ElasticMedium, Lane, ParameterError, Scalar, Stress};

use crate::MaterialError;
use crate::exponential::power;
use crate::planes::ShearPlane;
use crate::root::{Function, zero_between};
use crate::surface::{PrincipalReturn, YieldState, YieldSurface, pick, stiffened};

/// What a [`HoekBrown`] surface is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HoekBrownParameters {
    /// The elastic medium of the rock mass.
    pub medium: ElasticMedium,
    /// Uniaxial compressive strength of the intact rock `s_ci` (Pa).
    pub intact_strength: f64,
    /// Constant of the intact rock `m_i`, 1 to 50.
    pub intact_constant: f64,
    /// Geological strength index, 5 to 100.
    pub strength_index: f64,
    /// Disturbance factor `D`, 0 (undisturbed) to 1.
    pub disturbance: f64,
    /// Dilation as a share of that of associated flow, 0 to 1.
    pub dilation_share: f64,
}

/// The yield surface of Hoek and Brown for rock masses.
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
/// s3 = s s_ci / m`, where any flow is possible that opens.
///
/// # Return
/// The deviatoric flow keeps its axes, and on the face and on each edge the condition is one
/// equation in one unknown: `y = (s - m s1 / s_ci)^a`. Face, both edges and the apex are computed;
/// the one that violates sign of flow and order of stresses least is the solution. For associated
/// flow it is the closest point in the energy norm.
///
/// # Valid range
/// Perfectly plastic. The rock mass is isotropic; one family of joints is not.
///
/// # Why so
/// *Dilation is a share of the associated one, not an angle*: the friction of this surface falls
/// with pressure, and a fixed angle would exceed it at depth and gain energy. With a share of at
/// most one, `stress : flow` is never negative.
///
/// Source: Hoek, Carranza-Torres & Corkum (2002), *Proc. NARMS-TAC*, Eqs. (1)-(5).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HoekBrown {
    parameters: HoekBrownParameters,
    /// `m`.
    slope: f64,
    /// `s`.
    integrity: f64,
    /// `a`.
    exponent: f64,
    /// Stress of uniaxial tension at yield (Pa).
    tension: f64,
    /// `lambda / 2G`.
    volumetric: f64,
}

/// Pressures over the intact strength where the chords of the elastic domain end.
const CHORDS: [f64; 5] = [0.0, 0.02, 0.1, 0.4, 1.5];

/// The return to the face or to an edge.
struct Branch<L> {
    /// Greatest and least stress (Pa).
    greatest: L,
    least: L,
    /// Common fall of all stresses (Pa).
    swollen: L,
    /// `2G`-scaled flow along `-s3` and `s1` (Pa).
    flow: L,
    opening: L,
    /// By how much no such return exists (Pa).
    missed: L,
}

/// Flow of two trial stresses, as [`HoekBrown::branch`] has it.
struct Along<'a, L> {
    surface: &'a HoekBrown,
    upper: L,
    apart: L,
    weights: [f64; 2],
}

impl<L: Lane> Along<'_, L> {
    /// The greatest stress (Pa), and the opening and the shear flow that lead to it.
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
        // Of the opening and of the shear flow, for a unit of fall.
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

impl<L: Lane> Function<L> for Along<'_, L> {
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
    /// The surface of the parameters.
    ///
    /// # Errors
    /// A parameter outside its range.
    pub fn new(parameters: HoekBrownParameters) -> Result<Self, MaterialError> {
        let p = &parameters;
        let medium = ElasticMedium::new(p.medium.young, p.medium.poisson, p.medium.density)?;
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

    /// What the surface was made of.
    pub fn parameters(&self) -> &HoekBrownParameters {
        &self.parameters
    }

    /// The constants `m`, `s` and `a` of the rock mass.
    pub fn constants(&self) -> [f64; 3] {
        [self.slope, self.integrity, self.exponent]
    }

    /// The stress at the apex, `s s_ci / m` (Pa).
    pub fn apex(&self) -> f64 {
        self.integrity * self.parameters.intact_strength / self.slope
    }

    /// `s - m s1 / s_ci`.
    #[inline(always)]
    fn depth<L: Lane>(&self, greatest: L) -> L {
        let number = |value: f64| greatest.constant(value);
        number(self.integrity) - number(self.slope / self.parameters.intact_strength) * greatest
    }

    /// `x a m`, the opening flow at unit depth less one.
    fn dilation(&self) -> f64 {
        self.parameters.dilation_share * self.exponent * self.slope
    }

    /// The return of two trial stresses of which the first falls by `w1 M g` and the second rises
    /// by `w3 g`, beside the common fall by `r (M - 1) g`, with the opening flow `M` of the surface.
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
        let along = Along {
            surface: self,
            upper,
            apart: upper - lower,
            weights: [w1, w3],
        };
        // No flow yet; and flow that brings the two together, whatever it opens.
        let depth = self.depth(upper);
        let first = power(depth.max(zero), self.exponent);
        let most = along.apart * number(self.slope / intact * (1.0 + r / w1));
        let last = power((depth + most).max(zero), self.exponent).max(first);
        let at_first = along.at(first);
        let missed = (-at_first).max(zero);
        let at_first = at_first.max(zero);
        let at_last = along.at(last).min(zero);
        let size = upper.abs() + lower.abs() + number(self.apex());
        let tolerance = size * number(L::Scalar::EPSILON);
        let y = zero_between([first, at_first], [last, at_last], tolerance, &along);
        let (greatest, opening, flow) = along.flows(y);
        Branch {
            greatest,
            least: greatest - number(intact) * y,
            swollen: number(r) * (opening - flow),
            flow,
            opening,
            missed,
        }
    }
}

/// The face, edge or corner that violates the conditions least so far.
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
        // Not zero, so that no product with infinity is none.
        let rest = (1.0 - share).max(f64::EPSILON);
        let curved = number(rest).mul_add(apart.sqrt(), number(share) * apart);
        let greatest = number(2.0 / 3.0_f64.sqrt()).mul_add(shear, mean);
        number(intact) * apart.mul_add(curved, -self.depth(greatest))
    }

    /// Chords of the curved envelope lie inside it; beyond the last one strength no longer grows.
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
        // At the apex flow must open along all axes, or, without dilation, as a whole.
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
        let middle = s2 - face.swollen;
        let violation = (middle - face.greatest).max(face.least - middle);
        best.offer(
            [face.greatest, middle, face.least],
            [
                face.opening + face.swollen,
                face.swollen,
                face.swollen - face.flow,
            ],
            violation.max(-face.flow).max(face.missed),
        );

        // Edge of equal greater stresses: x1 + x2 = M g, x1 - x2 = s1 - s2.
        let apart = half * (s1 - s2);
        let edge = self.branch([half * (s1 + s2), s3], [0.5, 1.0]);
        let fallen = half * edge.opening + edge.swollen;
        best.offer(
            [edge.greatest, edge.greatest, edge.least],
            [fallen + apart, fallen - apart, edge.swollen - edge.flow],
            (s1 - s2 - edge.opening).max(edge.missed),
        );

        // Edge of equal lesser stresses: x2 + x3 = -g, x2 - x3 = s2 - s3.
        let apart = half * (s2 - s3);
        let edge = self.branch([s1, half * (s2 + s3)], [1.0, 0.5]);
        let raised = edge.swollen - half * edge.flow;
        best.offer(
            [edge.greatest, edge.least, edge.least],
            [edge.opening + edge.swollen, raised + apart, raised - apart],
            (s2 - s3 - edge.flow).max(edge.missed),
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
