//! The surface of Mohr and Coulomb with a tension cut-off.

use powerhouse_model::{ElasticMedium, Lane, ParameterError, Stress};

use crate::MaterialError;
use crate::surface::{
    PrincipalReturn, YieldState, YieldSurface, check_frictional, mean_and_shear, pick,
};

/// Without friction there is no apex: a surface without a cut-off ends at this many cohesions.
const FRICTIONLESS_CUT_OFF: f64 = 1.0e3;

/// What a [`MohrCoulomb`] surface is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MohrCoulombParameters {
    /// The elastic medium.
    pub medium: ElasticMedium,
    /// Friction angle (degrees), 0 to 75.
    pub friction: f64,
    /// Dilation angle (degrees), 0 to the friction angle.
    pub dilation: f64,
    /// Cohesion (Pa), at least 0.
    pub cohesion: f64,
    /// The greatest principal stress that the material bears (Pa), at least 0; none: the apex
    /// `c cot(phi)` alone ends the surface (without friction: 1000 cohesions).
    pub tension_strength: Option<f64>,
}

impl MohrCoulombParameters {
    /// The parameters whose surface yields at given strengths (Pa, positive) in uniaxial
    /// compression and tension, without dilation.
    ///
    /// `N = f_c / f_t`, `sin phi = (N - 1) / (N + 1)`, `c = f_c / (2 sqrt N)`
    ///
    /// Friction and cohesion listed beside such strengths are not kept: one plane honours two
    /// numbers.
    ///
    /// # Errors
    /// Strengths that are not positive; a compressive one that is not 1 to 50 times the tensile.
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

/// The yield surface of Mohr and Coulomb with a tension cut-off and dilation.
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
/// so each of the nine faces, edges and corners that a sorted trial can come to gives its stress
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
    /// `N`.
    friction: f64,
    /// `m`.
    dilation: f64,
    /// `2 c sqrt(N)`, the uniaxial compressive strength (Pa).
    strength: f64,
    /// The cut-off in force, `T` (Pa).
    tension: f64,
    /// Norm of the deviatoric part of `(N, 0, -1)`.
    steepness: f64,
    /// `lambda / 2G`.
    volumetric: f64,
}

/// `(1 + sin x) / (1 - sin x)` of an angle in degrees.
fn passive_ratio(angle: f64) -> f64 {
    let sine = angle.to_radians().sin();
    (1.0 + sine) / (1.0 - sine)
}

impl MohrCoulomb {
    /// The surface of the parameters.
    ///
    /// # Errors
    /// A parameter outside its range; a dilation above the friction.
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
        let apex = (strength / (ratio - 1.0)).min(FRICTIONLESS_CUT_OFF * cohesion);
        let tension = match tension_strength {
            Some(listed) => {
                ParameterError::check("tension_strength", listed, 0.0, 1.0e12)?;
                listed.min(apex)
            }
            None => apex,
        };
        Ok(Self {
            parameters,
            friction: ratio,
            dilation: passive_ratio(dilation),
            strength,
            tension,
            steepness: (ratio * ratio + 1.0 - (ratio - 1.0).powi(2) / 3.0).sqrt(),
            volumetric: medium.poisson / (1.0 - 2.0 * medium.poisson),
        })
    }

    /// What the surface was made of.
    pub fn parameters(&self) -> &MohrCoulombParameters {
        &self.parameters
    }

    /// The mean stress at which shear strength ends, `c cot(phi)` (Pa); infinite without friction.
    pub fn apex(&self) -> f64 {
        self.parameters.cohesion / self.parameters.friction.to_radians().tan()
    }

    /// The greatest principal stress in force (Pa).
    pub fn cut_off(&self) -> f64 {
        self.tension
    }
}

/// The face, edge or corner that violates the conditions of a return least.
struct Best<L> {
    violation: L,
    stress: [L; 3],
    loss: [L; 3],
    state: L,
}

impl<L: Lane> Best<L> {
    /// Takes a candidate, with its `loss` against the trial, if it is better; `conditions` are
    /// not positive where it is right (Pa).
    #[inline(always)]
    fn offer<const C: usize>(
        &mut self,
        state: YieldState,
        stress: [L; 3],
        loss: [L; 3],
        conditions: [L; C],
    ) {
        let violation = conditions
            .into_iter()
            .reduce(Lane::max)
            .unwrap_or(self.violation);
        let better = violation.less(self.violation);
        self.violation = violation.select(better, self.violation);
        self.stress = pick(better, &stress, &self.stress);
        self.loss = pick(better, &loss, &self.loss);
        let number = self.state.constant(state.number());
        self.state = number.select(better, self.state);
    }
}

impl YieldSurface for MohrCoulomb {
    fn name(&self) -> &str {
        "mohr-coulomb"
    }
    fn medium(&self) -> ElasticMedium {
        self.parameters.medium
    }

    /// The greatest `a . d` over deviators `d` of one size is the size times the deviatoric norm
    /// of `a`; the greatest principal deviator is `2 sqrt(J2 / 3)`.
    #[inline(always)]
    fn bound<L: Lane>(&self, stress: &Stress<L>) -> L {
        let (mean, shear) = mean_and_shear(stress);
        let number = |value: f64| mean.constant(value);
        let steepness = number(self.steepness * core::f64::consts::SQRT_2);
        let slope = number(self.friction - 1.0);
        let in_shear = slope.mul_add(mean, steepness.mul_add(shear, number(-self.strength)));
        let reach = number(2.0 / 3.0_f64.sqrt());
        let in_tension = reach.mul_add(shear, mean - number(self.tension));
        in_shear.max(in_tension)
    }

    #[inline(always)]
    fn excess<L: Lane>(&self, &[s1, _, s3]: &[L; 3]) -> L {
        let shear = s1.constant(self.friction) * s1 - s3 - s1.constant(self.strength);
        shear.max(s1 - s1.constant(self.tension))
    }

    /// Plastic strains are written as `x = 2G e` (Pa): `trial - returned = x + r (x1 + x2 + x3)`
    /// with `r = lambda / 2G`. A point on a shear face or edge is placed by its greatest stress.
    #[inline(always)]
    fn return_principal<L: Lane>(&self, &[s1, s2, s3]: &[L; 3]) -> PrincipalReturn<L> {
        use YieldState::{Both, Shear, Tension};
        let number = |value: f64| s1.constant(value);
        let (n, m, r) = (self.friction, self.dilation, self.volumetric);
        let strength = number(self.strength);
        let friction = number(n);
        let dilation = number(m);
        let tension = number(self.tension);
        let half = number(0.5);
        // The least stress where shear face and cut-off meet.
        let meeting = number(n * self.tension - self.strength);
        // Change of mean stress for a unit of shear flow, x = (m, 0, -1).
        let dilated = r * (m - 1.0);
        let swelling = number(dilated);
        let volumetric = number(r);

        // Tension corner: all three at the cut-off.
        let over = [s1 - tension, s2 - tension, s3 - tension];
        let all = number(1.0 / (1.0 + 3.0 * r));
        let common = volumetric * all * (over[0] + over[1] + over[2]);
        let mut best = Best {
            violation: number(f64::INFINITY),
            stress: [tension; 3],
            loss: over,
            state: number(Tension.number()),
        };
        best.offer(Tension, [tension; 3], over, [common - over[2]]);

        // Shear face.
        let excess = friction * s1 - s3 - strength;
        let flow = excess * number(1.0 / ((n - 1.0) * dilated + n * m + 1.0));
        let swollen = swelling * flow;
        let loss = [(dilation + swelling) * flow, swollen, swollen - flow];
        let (greatest, middle) = (s1 - loss[0], s2 - loss[1]);
        let least = friction * greatest - strength;
        let below = least - middle;
        best.offer(
            Shear,
            [greatest, middle, least],
            loss,
            [-excess, middle - greatest, below, greatest - tension],
        );

        // Edge of equal greater stresses: x1 + x2 = m g, x1 - x2 = s1 - s2, x3 = -g.
        let apart = half * (s1 - s2);
        let mean = half * (s1 + s2);
        let excess = friction * mean - s3 - strength;
        let flow = excess * number(1.0 / ((n - 1.0) * dilated + 0.5 * n * m + 1.0));
        let lowered = (half * dilation + swelling) * flow;
        let greatest = mean - lowered;
        let least = friction * greatest - strength;
        best.offer(
            Shear,
            [greatest, greatest, least],
            [lowered + apart, lowered - apart, swelling * flow - flow],
            [s1 - s2 - dilation * flow, greatest - tension],
        );

        // Edge of equal lesser stresses: x1 = m g, x2 + x3 = -g, x2 - x3 = s2 - s3.
        let apart = half * (s2 - s3);
        let mean = half * (s2 + s3);
        let excess = friction * s1 - mean - strength;
        let flow = excess * number(1.0 / ((n - 1.0) * dilated + n * m + 0.5));
        let lowered = (dilation + swelling) * flow;
        let raised = (swelling - half) * flow;
        let greatest = s1 - lowered;
        let least = friction * greatest - strength;
        best.offer(
            Shear,
            [greatest, least, least],
            [lowered, raised + apart, raised - apart],
            [s2 - s3 - flow, greatest - tension],
        );

        // Tension face: x2 = x3 = 0.
        let common = over[0] * number(r / (1.0 + r));
        let (middle, least) = (s2 - common, s3 - common);
        best.offer(
            Tension,
            [tension, middle, least],
            [over[0], common, common],
            [-over[0], middle - tension, meeting - least],
        );

        // Tension edge: x3 = 0.
        let pair = number(r / (1.0 + 2.0 * r));
        let common = pair * (over[0] + over[1]);
        let least = s3 - common;
        best.offer(
            Tension,
            [tension, tension, least],
            [over[0], over[1], common],
            [common - over[1], least - tension, meeting - least],
        );

        // Where the shear face meets the cut-off: x2 = 0.
        let below = [s2 - meeting, s3 - meeting];
        let common = pair * (over[0] + below[1]);
        let (x1, x3) = (over[0] - common, below[1] - common);
        let middle = s2 - common;
        let too_low = meeting - middle;
        best.offer(
            Both,
            [tension, middle, meeting],
            [over[0], common, below[1]],
            [x3, -(x1 + dilation * x3), middle - tension, too_low],
        );

        // Its end with equal greater stresses.
        let common = volumetric * all * (over[0] + over[1] + below[1]);
        let (x1, x2, x3) = (over[0] - common, over[1] - common, below[1] - common);
        best.offer(
            Both,
            [tension, tension, meeting],
            [over[0], over[1], below[1]],
            [x3, -x2, -(x1 + x2 + dilation * x3)],
        );

        // Its end with equal lesser stresses.
        let common = volumetric * all * (over[0] + below[0] + below[1]);
        let (x1, x2, x3) = (over[0] - common, below[0] - common, below[1] - common);
        best.offer(
            Both,
            [tension, meeting, meeting],
            [over[0], below[0], below[1]],
            [x2, -(x1 + dilation * (x2 + x3))],
        );

        PrincipalReturn {
            stress: best.stress,
            loss: best.loss,
            state: best.state,
        }
    }

    fn uniaxial_tension(&self) -> f64 {
        self.tension.min(self.strength / self.friction)
    }
    fn uniaxial_compression(&self) -> f64 {
        self.strength
    }
    fn flow_in_uniaxial_tension(&self) -> [f64; 3] {
        if self.tension <= self.strength / self.friction {
            return [1.0, 0.0, 0.0];
        }
        let lateral = -0.5 / self.dilation;
        [1.0, lateral, lateral]
    }
    fn flow_in_uniaxial_compression(&self) -> [f64; 3] {
        let lateral = 0.5 * self.dilation;
        [lateral, lateral, -1.0]
    }
}
