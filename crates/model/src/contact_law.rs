//! Contact laws: input, response and trait.

use std::sync::Arc;

use crate::{ElasticMedium, HistoryVariable, JointState, Vec3};

/// Input of a contact law at one node pair in one time step.
///
/// The *trial traction* is the one that ends the step without slip and with the pair closed, that is
/// with the opening equal to [`dilation`](Self::dilation) (zero for a joint that does not dilate). A law
/// that admits less leaves the pair with a relative velocity in proportion to what it takes away: after
/// the step the pair slips at `(trial - admitted) * compliance` along its tangents and opens at the same
/// expression along its normal, beyond what closes it. [`compliance`](Self::compliance) is
/// `step * (1/m1 + 1/m2) * area` with the effective masses of the two nodes, so that a law whose strength
/// depends on the slip rate of this very step can be solved in closed form or by a scalar root search,
/// stably for any step. Where node pairs share nodes, or masses differ between directions, it is the
/// compliance of the pair with its neighbours held.
///
/// ```
/// use powerhouse_model::{JointInput, JointState, Vec3};
/// let state = JointState::default();
/// let input = JointInput::new(Vec3::new(-2.0e6, 1.0e6, 0.0), &state)
///     .with_step(0.0, 1e-4, 2e-9)
///     .with_motion(0.0, [0.1, 0.0]);
/// // The slip rate after the step if the law admits 0.8 MPa of the shear traction.
/// let rate = input.slip_rate_after(&Vec3::new(-2.0e6, 0.8e6, 0.0));
/// assert!((rate[0] - 4e-4).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct JointInput<'a> {
    /// Trial traction on the first side (Pa): normal component, positive in tension, and two tangential
    /// components.
    pub trial: Vec3,
    /// Committed contact state, bond and accumulated slip.
    pub state: JointState,
    /// Committed history variables, in the order of [`ContactLaw::history`].
    pub history: &'a [f64],
    /// Relative tangential velocity of the second side in the last step (m/s), half a step before
    /// [`time`](Self::time), whatever the contact state.
    pub slip_rate: [f64; 2],
    /// Normal distance of the sides at the start of the step (m), negative where they overlap.
    pub opening: f64,
    /// Rate of the opening in the last step (m/s), half a step before [`time`](Self::time).
    pub opening_rate: f64,
    /// Tangential displacement of the second side relative to the first at the start of the step (m), from where the pair
    /// was built or closed anew.
    pub shear_displacement: [f64; 2],
    /// Committed opening at which the pair counts as closed (m), see [`JointResponse::dilation`].
    pub dilation: f64,
    /// Relative velocity per traction that is taken from the trial (m/s/Pa); zero where unknown.
    pub compliance: f64,
    /// Length of the step (s); zero in a static check.
    ///
    /// Static solutions by dynamic relaxation pass the length of their own, fictitious steps.
    pub step: f64,
    /// Time at the start of the step (s), on the clock of the run.
    pub time: f64,
    /// Tributary area over which tractions are forces (m2), [`JointPair::projected_area`].
    ///
    /// [`JointPair::projected_area`]: crate::JointPair::projected_area
    pub area: f64,
    /// Position of the pair in the undeformed mesh (m), [`JointPair::position`].
    ///
    /// [`JointPair::position`]: crate::JointPair::position
    pub position: Vec3,
    /// Distance to the farthest of the neighbouring pairs along the joint (m), [`JointPair::spacing`]; zero where unknown.
    ///
    /// [`JointPair::spacing`]: crate::JointPair::spacing
    pub spacing: f64,
}

impl<'a> JointInput<'a> {
    /// Input with a trial traction (Pa) and a committed state, without history, closed, without motion,
    /// of unit area at the origin, and of zero step, time and compliance.
    #[inline(always)]
    pub fn new(trial: Vec3, state: &JointState) -> Self {
        Self {
            trial,
            state: *state,
            history: &[],
            slip_rate: [0.0; 2],
            opening: 0.0,
            opening_rate: 0.0,
            shear_displacement: [0.0; 2],
            dilation: 0.0,
            compliance: 0.0,
            step: 0.0,
            time: 0.0,
            area: 1.0,
            position: Vec3::zeros(),
            spacing: 0.0,
        }
    }
    /// Sets the committed history variables: those at the end of the last step, in the order of
    /// [`ContactLaw::history`].
    #[inline(always)]
    #[must_use]
    pub fn with_history(self, history: &'a [f64]) -> Self {
        Self { history, ..self }
    }
    /// Sets the opening at the start of the step (m) and the slip rate of the last step along both tangents (m/s).
    #[inline(always)]
    #[must_use]
    pub fn with_motion(self, opening: f64, slip_rate: [f64; 2]) -> Self {
        Self {
            opening,
            slip_rate,
            ..self
        }
    }
    /// Sets the tangential displacement at the start of the step (m) and the rate of the opening in the last step (m/s).
    #[inline(always)]
    #[must_use]
    pub fn with_shear_displacement(self, shear_displacement: [f64; 2], opening_rate: f64) -> Self {
        Self {
            shear_displacement,
            opening_rate,
            ..self
        }
    }
    /// Sets the distance to the farthest of the neighbouring pairs along the joint (m).
    #[inline(always)]
    #[must_use]
    pub fn with_spacing(self, spacing: f64) -> Self {
        Self { spacing, ..self }
    }
    /// Sets the committed dilation (m): the opening, at the end of the last step, at which the pair counts as closed.
    #[inline(always)]
    #[must_use]
    pub fn with_dilation(self, dilation: f64) -> Self {
        Self { dilation, ..self }
    }
    /// Sets start time (s) and length (s) of the step, and the compliance: relative velocity per traction (m/s/Pa).
    #[inline(always)]
    #[must_use]
    pub fn with_step(self, time: f64, step: f64, compliance: f64) -> Self {
        Self {
            time,
            step,
            compliance,
            ..self
        }
    }
    /// Sets the position of the pair in the undeformed mesh (m) and its tributary area (m2).
    #[inline(always)]
    #[must_use]
    pub fn with_site(self, position: Vec3, area: f64) -> Self {
        Self {
            position,
            area,
            ..self
        }
    }
    /// Size of the tangential part of the trial traction (Pa).
    #[inline(always)]
    pub fn trial_shear(&self) -> f64 {
        (self.trial.y * self.trial.y + self.trial.z * self.trial.z).sqrt()
    }
    /// Slip rate after the step (m/s, two tangential components) if a traction (Pa) is admitted.
    #[inline(always)]
    pub fn slip_rate_after(&self, admitted: &Vec3) -> [f64; 2] {
        [1, 2].map(|c| (self.trial[c] - admitted[c]) * self.compliance)
    }
    /// Normal traction (Pa) that ends the step opened by a distance (m) more than the trial: the pressure
    /// of a joint that dilates by that distance within the step.
    ///
    /// `trial.x - distance / (step * compliance)`; the trial itself without step or compliance.
    #[inline(always)]
    pub fn normal_opened_by(&self, distance: f64) -> f64 {
        let per_traction = self.step * self.compliance;
        if per_traction > 0.0 {
            self.trial.x - distance / per_traction
        } else {
            self.trial.x
        }
    }
}

/// Response of a contact law at one node pair: admitted traction and new state.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct JointResponse {
    /// Traction that the joint admits in place of the trial one (Pa). A pair sticks where the trial is
    /// admitted as it is, to the bit.
    pub traction: Vec3,
    /// Contact state and bond after the step. The joint accumulates the slip itself: the one returned
    /// here is not used.
    pub state: JointState,
    /// Opening (m) at which the pair counts as closed from the next step on, as asperities ride up on
    /// each other: the trial traction then closes the pair to this opening instead of zero.
    ///
    /// Zero for joints that do not dilate. Used of laws with [history variables](ContactLaw::history)
    /// only: the opening is history, and belongs among them to be seen in results.
    pub dilation: f64,
}

impl JointResponse {
    /// Response without dilation: an admitted traction (Pa) and a state.
    #[inline(always)]
    pub fn new(traction: Vec3, state: JointState) -> Self {
        Self {
            traction,
            state,
            dilation: 0.0,
        }
    }
    /// Sets the dilation (m): the opening at which the pair counts as closed.
    #[inline(always)]
    #[must_use]
    pub fn with_dilation(self, dilation: f64) -> Self {
        Self { dilation, ..self }
    }
}

/// Energies per area of a bond that fails gradually, since its pair was built or closed anew (J/m2).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct BondEnergies {
    /// Energy that the bond stores, which it returns when it is unloaded.
    pub stored: f64,
    /// Energy dissipated by the failure of the bond: it does not fall, and is the fracture energy when the bond has failed.
    pub dissipated: f64,
    /// Energy dissipated by friction beside the bond.
    pub friction: f64,
}

impl BondEnergies {
    /// Stored energy, and energies dissipated by the bond and by friction (J/m2).
    #[inline(always)]
    pub const fn new(stored: f64, dissipated: f64, friction: f64) -> Self {
        Self {
            stored,
            dissipated,
            friction,
        }
    }
}

/// Inputs of a contact law at several node pairs in one time step, but for what the law changes.
///
/// Each slice has one value per pair; [`history`](Self::history) has the variables of a pair side by
/// side. A slice that is empty reads as zeros (areas as one).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct JointInputs<'a> {
    /// Number of history variables of the law for each pair; 0 for a law without any.
    pub variables: usize,
    /// Committed history variables, `variables` consecutive ones for each pair.
    pub history: &'a [f64],
    /// Slip rates of the last step (m/s), see [`JointInput::slip_rate`].
    pub slip_rate: [&'a [f64]; 2],
    /// Normal distances of the sides at the start of the step (m), negative where they overlap.
    pub opening: &'a [f64],
    /// Rates of the openings in the last step (m/s).
    pub opening_rate: &'a [f64],
    /// Tangential displacements at the start of the step (m), see [`JointInput::shear_displacement`].
    pub shear_displacement: [&'a [f64]; 2],
    /// Relative velocities per traction (m/s/Pa), see [`JointInput::compliance`].
    pub compliance: &'a [f64],
    /// Tributary areas over which tractions are forces (m2); ones if the slice is empty.
    pub area: &'a [f64],
    /// Positions of the pairs in the undeformed mesh (m): one slice each for x, y and z.
    pub position: [&'a [f64]; 3],
    /// Distances to the farthest of the neighbouring pairs along the joint (m).
    pub spacing: &'a [f64],
    /// Length of the step (s).
    pub step: f64,
    /// Time at the start of the step (s), on the clock of the run.
    pub time: f64,
}

impl<'a> JointInputs<'a> {
    /// Input of one pair, with its trial traction (Pa), committed state and dilation (m).
    #[inline(always)]
    pub fn of_pair(
        &self,
        pair: usize,
        trial: Vec3,
        state: &JointState,
        dilation: f64,
    ) -> JointInput<'a> {
        let of = |values: &[f64]| values.get(pair).copied().unwrap_or(0.0);
        let own = pair * self.variables..(pair + 1) * self.variables;
        JointInput {
            trial,
            state: *state,
            history: self.history.get(own).unwrap_or_default(),
            slip_rate: self.slip_rate.map(of),
            opening: of(self.opening),
            opening_rate: of(self.opening_rate),
            shear_displacement: self.shear_displacement.map(of),
            dilation,
            compliance: of(self.compliance),
            step: self.step,
            time: self.time,
            area: self.area.get(pair).copied().unwrap_or(1.0),
            position: Vec3::from(self.position.map(of)),
            spacing: of(self.spacing),
        }
    }
}

/// Tractions, states and history variables of several node pairs: trial and committed values on entry,
/// admitted and new values on return.
#[derive(Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct JointResponses<'a> {
    /// Trial tractions (Pa), replaced by those admitted.
    pub tractions: &'a mut [Vec3],
    /// Committed states, replaced by the new ones.
    pub states: &'a mut [JointState],
    /// Committed history variables, replaced by the new ones, the variables of a pair side by side;
    /// empty for a law without.
    pub history: &'a mut [f64],
    /// Committed dilations (m), replaced by the new ones; empty for a law without history.
    pub dilations: &'a mut [f64],
}

impl<'a> JointResponses<'a> {
    /// Pairs of a law without history, with trial tractions (Pa) and committed states.
    #[inline(always)]
    pub fn new(tractions: &'a mut [Vec3], states: &'a mut [JointState]) -> Self {
        Self {
            tractions,
            states,
            history: &mut [],
            dilations: &mut [],
        }
    }
    /// Sets the slices for new history variables, those of a pair side by side, and for new dilations (m).
    #[inline(always)]
    #[must_use]
    pub fn with_history(self, history: &'a mut [f64], dilations: &'a mut [f64]) -> Self {
        Self {
            history,
            dilations,
            ..self
        }
    }
}

/// Contact law of a joint: which tractions it admits, given a trial traction and the pair's state.
///
/// A law is a pure function of its input, evaluated for every pair at least once in each step, for pairs that are solved
/// together many times: it runs without a mesh, and the caller decides whether the new
/// state and history become the committed ones. Tractions are those on the first side (Pa): the
/// component along its outward normal, positive in tension, and two along tangents. The law must not
/// prefer a direction in the plane of the tangents.
///
/// A law without history:
/// ```
/// use powerhouse_model::{ContactLaw, ContactState, JointInput, JointResponse, JointState, Vec3};
/// /// Unilateral contact without friction.
/// struct Smooth;
/// impl ContactLaw for Smooth {
///     fn name(&self) -> &str { "smooth" }
///     fn initial(&self) -> JointState { JointState::default() }
///     fn admissible(&self, input: &JointInput, _new_history: &mut [f64]) -> JointResponse {
///         let normal = input.trial.x;
///         let contact = if normal > 0.0 { ContactState::Open } else { ContactState::Slide };
///         let traction = Vec3::new(normal.min(0.0), 0.0, 0.0);
///         JointResponse::new(traction, input.state.with_contact(contact))
///     }
///     fn sliding_strength(&self, _normal: f64, _input: &JointInput) -> f64 { 0.0 }
/// }
/// let input = JointInput::new(Vec3::new(2.0, 1.0, 0.0), &JointState::default());
/// assert_eq!(Smooth.admissible(&input, &mut []).traction, Vec3::zeros());
/// ```
///
/// # Dilation
/// A joint that dilates returns the opening at which its faces are in contact with
/// [`JointResponse::with_dilation`]. The trial traction keeps its meaning: it closes the pair, now to
/// that opening. The law may leave the normal traction of the trial as it is, and the pair opens one
/// step later; or admit [`JointInput::normal_opened_by`] the increment of the opening, and it opens
/// within the step. The first is stable while `mu tan(psi) < 1` for a friction coefficient `mu` and a
/// dilation angle `psi`; the second always, where pairs share no nodes. Work of the opening against the
/// pressure counts into friction, which is then the net dissipation `tau v - sigma_n v tan(psi)`.
///
/// # History
/// History variables are committed with the pair's record once per step, and kept by stages and checkpoints.
/// A stage in which the joint is tied, or has another law, does not keep them: they are initial after it.
/// Results show them beside the joint's own quantities; their names must not be `state`, `bond`, `opening` or
/// `slip`.
pub trait ContactLaw: Send + Sync {
    /// Name of the law in reports.
    fn name(&self) -> &str;
    /// State of a pair before its first step.
    fn initial(&self) -> JointState;
    /// History variables of a pair; none by default.
    fn history(&self) -> &[HistoryVariable] {
        &[]
    }
    /// Writes the history variables of a pair before its first step, in the order of
    /// [`history`](Self::history); zeros by default.
    fn initial_history(&self, history: &mut [f64]) {
        history.fill(0.0);
    }
    /// Admitted traction and new state for the trial traction of the input.
    ///
    /// Writes the new history variables. On entry `new_history` holds the committed ones, so that a law
    /// writes only what changes; it is empty for a law without history.
    fn admissible(&self, input: &JointInput, new_history: &mut [f64]) -> JointResponse;
    /// [`admissible`](Self::admissible) of many pairs at once, in place. A law behind a pointer is called
    /// once for all of them.
    #[inline(always)]
    fn admit(&self, inputs: &JointInputs, responses: &mut JointResponses) {
        let variables = inputs.variables;
        let pairs = (responses.tractions.iter_mut()).zip(responses.states.iter_mut());
        if variables == 0 {
            // A loop of its own: laws without history take no time for it.
            for (pair, (traction, state)) in pairs.enumerate() {
                let input = inputs.of_pair(pair, *traction, state, 0.0);
                let response = self.admissible(&input, &mut []);
                debug_assert!(
                    response.dilation == 0.0,
                    "a law that dilates has a history variable"
                );
                (*traction, *state) = (response.traction, response.state);
            }
            return;
        }
        let rows = (responses.history.chunks_exact_mut(variables)).zip(&mut *responses.dilations);
        for (pair, ((traction, state), (new_history, dilation))) in pairs.zip(rows).enumerate() {
            let input = inputs.of_pair(pair, *traction, state, *dilation);
            let response = self.admissible(&input, new_history);
            (*traction, *state) = (response.traction, response.state);
            *dilation = response.dilation;
        }
    }
    /// Shear strength (Pa, not negative) of a pair that slides under a normal traction (Pa, positive in
    /// tension).
    ///
    /// The input is that of [`admissible`](Self::admissible); the normal part of its trial traction is
    /// not meant to be read. Its tangential part and its compliance give the slip rate `v = (trial -
    /// strength) * compliance` that belongs to a strength, for laws whose strength depends on it.
    fn sliding_strength(&self, normal: f64, input: &JointInput) -> f64;
    /// Greatest normal traction (Pa) of a pair in this state whose bond is not intact; zero by default.
    ///
    /// For an open pair it is the traction of a cohesive zone at the input's opening.
    fn unbonded_tension(&self, _input: &JointInput) -> f64 {
        0.0
    }
    /// The law between sides of two media, where it depends on them; none by default, for a law that does not.
    fn between(&self, _media: [&ElasticMedium; 2]) -> Option<Arc<dyn ContactLaw>> {
        None
    }
    /// Least factor (1) by which the law reduces its strengths where pairs have a [spacing](JointInput::spacing) (m), since the
    /// mesh does not resolve the failure of the bond; 1 by default.
    fn strength_factor(&self, _spacing: f64) -> f64 {
        1.0
    }
    /// Share of the decline of traction by separation that a step resolves (1), for its length times compliance (m/Pa) and
    /// the spacing of the pairs (m): at 4 and above the traction of a step is not unique, and a joint refuses 3 and above. Zero
    /// by default, for laws whose traction does not decline by separation.
    fn softening_ratio(&self, _compliance: f64, _spacing: f64) -> f64 {
        0.0
    }
    /// Energies of the bond per area (J/m2) by the history variables of a pair, for laws whose bond fails gradually; none by
    /// default, for laws whose bond breaks in one step.
    fn bond_energies(&self, _history: &[f64]) -> Option<BondEnergies> {
        None
    }
    /// Takes back a share (1) of what a bond that fails gradually has lost since a former state and its history variables, in the
    /// present ones; by default nothing. A dynamic relaxation calls it before every step with the state at the start of its
    /// increment, in the end with a share of one, so that the damage of a static equilibrium is that of its displacement, whatever the
    /// pseudo-motion on the way. A bond that is back where it was intact is intact again.
    fn undo_damage(
        &self,
        _former: (&JointState, &[f64]),
        _share: f64,
        _state: &mut JointState,
        _history: &mut [f64],
    ) {
    }
    /// Whether the tractions of a pair in a state follow from its displacement while it slides or opens, so that
    /// [`sliding_strength`](Self::sliding_strength) does not give them, as with a bond that fails gradually; false by
    /// default. Pairs that are solved together then evaluate [`admissible`](Self::admissible) in every sweep.
    fn follows_displacement(&self, _state: &JointState) -> bool {
        false
    }
    /// Whether the law has no shear strength in any state, so that the sides of a closed pair slide on each other freely; false by
    /// default. Static solutions connect the nodes of such pairs along their normals alone.
    fn is_smooth(&self) -> bool {
        false
    }
    /// Whether the law admits tension in every state, across an open pair without a bond too, as a tie
    /// does; false by default. Pairs of such a law have no initial gap and cannot be without a bond.
    fn bears_tension(&self) -> bool {
        false
    }
}

/// A law behind a pointer is the law: every method is forwarded, that for many pairs as one call.
macro_rules! law_behind {
    ($($pointer:ty),+) => {
        $(
            impl<L: ContactLaw + ?Sized> ContactLaw for $pointer {
                fn name(&self) -> &str {
                    (**self).name()
                }
                fn initial(&self) -> JointState {
                    (**self).initial()
                }
                fn history(&self) -> &[HistoryVariable] {
                    (**self).history()
                }
                fn initial_history(&self, history: &mut [f64]) {
                    (**self).initial_history(history)
                }
                fn admissible(&self, input: &JointInput, new_history: &mut [f64]) -> JointResponse {
                    (**self).admissible(input, new_history)
                }
                #[inline(always)]
                fn admit(&self, inputs: &JointInputs, responses: &mut JointResponses) {
                    (**self).admit(inputs, responses)
                }
                fn sliding_strength(&self, normal: f64, input: &JointInput) -> f64 {
                    (**self).sliding_strength(normal, input)
                }
                fn unbonded_tension(&self, input: &JointInput) -> f64 {
                    (**self).unbonded_tension(input)
                }
                fn between(&self, media: [&ElasticMedium; 2]) -> Option<Arc<dyn ContactLaw>> {
                    (**self).between(media)
                }
                fn strength_factor(&self, spacing: f64) -> f64 {
                    (**self).strength_factor(spacing)
                }
                fn softening_ratio(&self, compliance: f64, spacing: f64) -> f64 {
                    (**self).softening_ratio(compliance, spacing)
                }
                fn bond_energies(&self, history: &[f64]) -> Option<BondEnergies> {
                    (**self).bond_energies(history)
                }
                fn undo_damage(
                    &self,
                    former: (&JointState, &[f64]),
                    share: f64,
                    state: &mut JointState,
                    history: &mut [f64],
                ) {
                    (**self).undo_damage(former, share, state, history)
                }
                fn follows_displacement(&self, state: &JointState) -> bool {
                    (**self).follows_displacement(state)
                }
                fn is_smooth(&self) -> bool {
                    (**self).is_smooth()
                }
                fn bears_tension(&self) -> bool {
                    (**self).bears_tension()
                }
            }
        )+
    };
}

law_behind!(Box<L>, Arc<L>, &L);

#[cfg(test)]
mod tests;
