//! Return to yield surfaces of planes in principal stresses.

use powerhouse_model::{ElasticDomain, Lane};

use crate::surface::{PrincipalReturn, YieldState, pick};

/// Shear plane `N s1 - s3 <= C` with flow along `m s1 - s3`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ShearPlane {
    /// Slope `N` of the yield function.
    pub(crate) friction: f64,
    /// Slope `m` of the flow.
    pub(crate) dilation: f64,
    /// Uniaxial compressive strength `C` (Pa).
    pub(crate) strength: f64,
    /// Norm of the deviatoric part of `(N, 0, -1)`, times `sqrt 2`.
    steepness: f64,
}

impl ShearPlane {
    /// Plane of `N`, `m` and `C` (Pa).
    pub(crate) fn new(friction: f64, dilation: f64, strength: f64) -> Self {
        let square = friction * friction + 1.0 - (friction - 1.0).powi(2) / 3.0;
        Self {
            friction,
            dilation,
            strength,
            steepness: (2.0 * square).sqrt(),
        }
    }

    /// Yield function of the greatest and the least stress (Pa).
    #[inline(always)]
    pub(crate) fn excess<L: Lane>(&self, greatest: L, least: L) -> L {
        greatest.constant(self.friction) * greatest - least - greatest.constant(self.strength)
    }

    /// Upper bound of the yield function from mean stress and `sqrt(J2)` (Pa): the greatest `a .
    /// d` over deviators `d` of one size is the size times the deviatoric norm of `a`.
    #[inline(always)]
    pub(crate) fn bound<L: Lane>(&self, mean: L, shear: L) -> L {
        let number = |value: f64| mean.constant(value);
        let sheared = number(self.steepness).mul_add(shear, number(-self.strength));
        number(self.friction - 1.0).mul_add(mean, sheared)
    }

    /// Part of a domain where the [`bound`](Self::bound) is not positive.
    pub(crate) fn part_of(&self, domain: ElasticDomain) -> ElasticDomain {
        domain.within(self.friction - 1.0, self.steepness, self.strength)
    }
}

/// Part of a domain where no principal stress can be above a cut-off (Pa): the greatest deviator
/// is `2 sqrt(J2 / 3)`.
pub(crate) fn below_cut_off(domain: ElasticDomain, tension: f64) -> ElasticDomain {
    domain.within(1.0, 2.0 / 3.0_f64.sqrt(), tension)
}

/// Return of a trial stress to a surface of planes: the candidate among faces, edges and corners that
/// violates the conditions least; the trial itself where it is inside.
///
/// Plastic strains are written as `x = 2G e` (Pa): `trial - returned = x + r (x1 + x2 + x3)` with
/// `r = lambda / 2G`. A point on a shear face or edge is determined by its greatest stress.
///
/// A candidate without violation is the solution: it is not replaced, and when all lanes have one no
/// further candidates are [needed](Self::is_open).
pub(crate) struct Nearest<L> {
    trial: [L; 3],
    /// Ratio `r`.
    volumetric: f64,
    /// Tension cut-off `T`, the greatest permitted principal stress (Pa).
    tension: f64,
    /// Trial stresses less `T` (Pa).
    over: [L; 3],
    violation: L,
    stress: [L; 3],
    loss: [L; 3],
    state: L,
}

impl<L: Lane> Nearest<L> {
    /// Starts with the trial itself, whose yield function is `excess` (Pa).
    #[inline(always)]
    pub(crate) fn new(trial: &[L; 3], excess: L, volumetric: f64, tension: f64) -> Self {
        let [s1, s2, s3] = *trial;
        let number = |value: f64| s1.constant(value);
        let (zero, limit) = (number(0.0), number(tension));
        let is_outside = zero.less(excess);
        Self {
            trial: *trial,
            volumetric,
            tension,
            over: [s1 - limit, s2 - limit, s3 - limit],
            violation: number(f64::INFINITY).select(is_outside, -number(f64::INFINITY)),
            stress: *trial,
            loss: [zero; 3],
            state: number(YieldState::Elastic.number()),
        }
    }

    /// Return of the best candidate.
    #[inline(always)]
    pub(crate) fn found(self) -> PrincipalReturn<L> {
        PrincipalReturn {
            stress: self.stress,
            loss: self.loss,
            state: self.state,
        }
    }

    /// Takes a candidate, with its `loss` against the trial, if it is better; its `conditions` are
    /// not positive where it is the solution (Pa).
    #[inline(always)]
    fn offer<const C: usize>(
        &mut self,
        state: YieldState,
        stress: [L; 3],
        loss: [L; 3],
        conditions: [L; C],
    ) {
        let state = self.state.constant(state.number());
        self.offer_in(state, stress, loss, conditions);
    }

    /// As [`offer`](Self::offer), with the state by its number.
    #[inline(always)]
    fn offer_in<const C: usize>(
        &mut self,
        state: L,
        stress: [L; 3],
        loss: [L; 3],
        conditions: [L; C],
    ) {
        let mut violation = conditions[0];
        for condition in &conditions[1..] {
            violation = violation.max(*condition);
        }
        let better = violation.less(self.violation);
        self.violation = violation.select(better, self.violation);
        self.stress = pick(better, &stress, &self.stress);
        self.loss = pick(better, &loss, &self.loss);
        self.state = state.select(better, self.state);
    }

    /// Whether any lane has no solution yet; the others keep theirs.
    #[inline(always)]
    pub(crate) fn is_open(&mut self) -> bool {
        let zero = self.violation.constant(0.0);
        let open = zero.less(self.violation);
        let settled = zero.constant(-f64::INFINITY);
        self.violation = self.violation.select(open, settled);
        zero.any(open)
    }

    /// Plastic strain `x` of a return to the corner where all three stresses are at the cut-off.
    #[inline(always)]
    fn flow_to_corner(&self) -> [L; 3] {
        let r = self.volumetric;
        let [a, b, c] = self.over;
        let common = a.constant(r / (1.0 + 3.0 * r)) * (a + b + c);
        [a - common, b - common, c - common]
    }

    /// Offers the corner where all three stresses are at the cut-off.
    #[inline(always)]
    pub(crate) fn offer_corner(&mut self) {
        use YieldState::Tension;
        let limit = self.trial[0].constant(self.tension);
        let [_, _, least] = self.flow_to_corner();
        self.offer(Tension, [limit; 3], self.over, [-least]);
    }

    /// Offers the apex of a shear plane, if the cut-off is there: flow is any combination of the
    /// opening of single axes and of shear, so that `sum <x_i>` is at least `m sum <-x_i>`.
    #[inline(always)]
    pub(crate) fn offer_apex(&mut self, plane: &ShearPlane) {
        use YieldState::{Both, Tension};
        let number = |value: f64| self.trial[0].constant(value);
        let (zero, limit) = (number(0.0), number(self.tension));
        let [a, b, c] = self.flow_to_corner();
        let opening = a.max(zero) + b.max(zero) + c.max(zero);
        let closing = a.min(zero) + b.min(zero) + c.min(zero);
        let lacking = -(number(plane.dilation).mul_add(closing, opening));
        let [pulled, sheared] = [Tension, Both].map(YieldState::number);
        let state = number(sheared).select(c.less(zero), number(pulled));
        self.offer_in(state, [limit; 3], self.over, [lacking]);
    }

    /// Offers a shear plane and its edges, where the greatest stress is at least `from` (if given)
    /// and at most `to` (Pa).
    #[inline(always)]
    pub(crate) fn offer_shear(&mut self, plane: &ShearPlane, from: Option<f64>, to: f64) {
        use YieldState::Shear;
        let [s1, s2, s3] = self.trial;
        let number = |value: f64| s1.constant(value);
        let (n, m) = (plane.friction, plane.dilation);
        let strength = number(plane.strength);
        let friction = number(n);
        let dilation = number(m);
        let half = number(0.5);
        // Change of mean stress per unit of shear flow, x = (m, 0, -1).
        let dilated = self.volumetric * (m - 1.0);
        let dilatancy = number(dilated);
        // Face.
        let excess = friction * s1 - s3 - strength;
        let flow = excess * number(1.0 / ((n - 1.0) * dilated + n * m + 1.0));
        let dilated_by = dilatancy * flow;
        let loss = [(dilation + dilatancy) * flow, dilated_by, dilated_by - flow];
        let (greatest, middle) = (s1 - loss[0], s2 - loss[1]);
        let least = friction * greatest - strength;
        let below = least - middle;
        self.offer(
            Shear,
            [greatest, middle, least],
            loss,
            [
                -excess,
                middle - greatest,
                below,
                outside(greatest, from, to),
            ],
        );

        // Edge of equal greater stresses: x1 + x2 = m g, x1 - x2 = s1 - s2, x3 = -g.
        let apart = half * (s1 - s2);
        let mean = half * (s1 + s2);
        let excess = friction * mean - s3 - strength;
        let flow = excess * number(1.0 / ((n - 1.0) * dilated + 0.5 * n * m + 1.0));
        let lowered = (half * dilation + dilatancy) * flow;
        let greatest = mean - lowered;
        let least = friction * greatest - strength;
        self.offer(
            Shear,
            [greatest, greatest, least],
            [lowered + apart, lowered - apart, dilatancy * flow - flow],
            [s1 - s2 - dilation * flow, outside(greatest, from, to)],
        );

        // Edge of equal lesser stresses: x1 = m g, x2 + x3 = -g, x2 - x3 = s2 - s3.
        let apart = half * (s2 - s3);
        let mean = half * (s2 + s3);
        let excess = friction * s1 - mean - strength;
        let flow = excess * number(1.0 / ((n - 1.0) * dilated + n * m + 0.5));
        let lowered = (dilation + dilatancy) * flow;
        let raised = (dilatancy - half) * flow;
        let greatest = s1 - lowered;
        let least = friction * greatest - strength;
        self.offer(
            Shear,
            [greatest, least, least],
            [lowered, raised + apart, raised - apart],
            [s2 - s3 - flow, outside(greatest, from, to)],
        );
    }

    /// Least stress on the line where a shear plane meets the cut-off (Pa).
    #[inline(always)]
    fn least_at_cut_off(&self, plane: &ShearPlane) -> L {
        let least = plane.friction * self.tension - plane.strength;
        self.trial[0].constant(least)
    }

    /// Offers the face and the edge of the cut-off, down to the line where they meet a shear plane.
    #[inline(always)]
    pub(crate) fn offer_cut_off(&mut self, plane: &ShearPlane) {
        use YieldState::Tension;
        let ([s1, s2, s3], over, r) = (self.trial, self.over, self.volumetric);
        let number = |value: f64| s1.constant(value);
        let tension = number(self.tension);
        let meeting = self.least_at_cut_off(plane);

        // Face: x2 = x3 = 0.
        let common = over[0] * number(r / (1.0 + r));
        let (middle, least) = (s2 - common, s3 - common);
        self.offer(
            Tension,
            [tension, middle, least],
            [over[0], common, common],
            [-over[0], middle - tension, meeting - least],
        );

        // Edge: x3 = 0.
        let common = number(r / (1.0 + 2.0 * r)) * (over[0] + over[1]);
        let least = s3 - common;
        self.offer(
            Tension,
            [tension, tension, least],
            [over[0], over[1], common],
            [common - over[1], least - tension, meeting - least],
        );
    }

    /// Offers the line where a shear plane meets the cut-off, and its two ends.
    #[inline(always)]
    pub(crate) fn offer_meeting(&mut self, plane: &ShearPlane) {
        use YieldState::Both;
        let ([s1, s2, s3], over, r) = (self.trial, self.over, self.volumetric);
        let number = |value: f64| s1.constant(value);
        let dilation = number(plane.dilation);
        let tension = number(self.tension);
        let meeting = self.least_at_cut_off(plane);
        let below = [s2 - meeting, s3 - meeting];
        let all = number(r) * number(1.0 / (1.0 + 3.0 * r));

        // The line: x2 = 0.
        let common = number(r / (1.0 + 2.0 * r)) * (over[0] + below[1]);
        let (x1, x3) = (over[0] - common, below[1] - common);
        let middle = s2 - common;
        let too_low = meeting - middle;
        self.offer(
            Both,
            [tension, middle, meeting],
            [over[0], common, below[1]],
            [x3, -(x1 + dilation * x3), middle - tension, too_low],
        );

        // End of the line with equal greater stresses.
        let common = all * (over[0] + over[1] + below[1]);
        let (x1, x2, x3) = (over[0] - common, over[1] - common, below[1] - common);
        self.offer(
            Both,
            [tension, tension, meeting],
            [over[0], over[1], below[1]],
            [x3, -x2, -(x1 + x2 + dilation * x3)],
        );

        // End of the line with equal lesser stresses.
        let common = all * (over[0] + below[0] + below[1]);
        let (x1, x2, x3) = (over[0] - common, below[0] - common, below[1] - common);
        self.offer(
            Both,
            [tension, meeting, meeting],
            [over[0], below[0], below[1]],
            [x2, -(x1 + dilation * (x2 + x3))],
        );
    }
}

/// Distance of a stress from a range (Pa), not positive within it.
#[inline(always)]
fn outside<L: Lane>(stress: L, from: Option<f64>, to: f64) -> L {
    let above = stress - stress.constant(to);
    match from {
        Some(from) => above.max(stress.constant(from) - stress),
        None => above,
    }
}
