//! Node pairs of joints: geometry, state, and the views and histories by which they are exchanged.

use crate::{HistoryVariable, Vec3};

/// Contact state of a node pair: sticking, sliding or open.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ContactState {
    /// Stick: in contact without relative motion.
    #[default]
    Stick,
    /// Slide: in contact with slip in the step.
    Slide,
    /// Open: not in contact.
    Open,
}

/// Bond of a node pair: never there, intact or broken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Bond {
    /// There has never been a bond since the joint was made or last re-initialised.
    #[default]
    Never,
    /// The bond holds.
    Intact,
    /// The bond is damaged and bears less than its strength; it fails gradually.
    Softening,
    /// The bond broke; it stays broken unless the joint is re-initialised.
    Broken,
}

/// Contact state, bond and accumulated slip of a node pair: the part of its history that every contact
/// law has.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct JointState {
    /// Contact state in the last step; at the start that of the law, or open with an initial gap.
    pub contact: ContactState,
    /// Bond of the pair: never there, intact, or broken for good.
    pub bond: Bond,
    /// Accumulated slip (m). The joint sums it up; what a law returns here is not used.
    pub slip: f64,
}

impl JointState {
    /// State with a contact state and a bond, without slip.
    #[inline(always)]
    pub const fn new(contact: ContactState, bond: Bond) -> Self {
        Self {
            contact,
            bond,
            slip: 0.0,
        }
    }
    /// Sets the contact state: sticking, sliding or open.
    #[inline(always)]
    #[must_use]
    pub const fn with_contact(self, contact: ContactState) -> Self {
        Self { contact, ..self }
    }
    /// Sets the bond: never there, intact or broken.
    #[inline(always)]
    #[must_use]
    pub const fn with_bond(self, bond: Bond) -> Self {
        Self { bond, ..self }
    }
    /// Sets the accumulated slip (m).
    #[inline(always)]
    #[must_use]
    pub const fn with_slip(self, slip: f64) -> Self {
        Self { slip, ..self }
    }
}

/// Node pair of a joint: two nodes that face each other, with their local axes and tributary area.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct JointPair {
    /// Mesh indices of the two nodes, that of the first side first.
    pub nodes: [u32; 2],
    /// Unit normal, out of the first side and into the second.
    pub normal: Vec3,
    /// First unit tangent; the second is `normal x tangent`.
    pub tangent: Vec3,
    /// Tributary area: area of facets that belongs to the pair (m2).
    pub area: f64,
    /// Tributary area projected along the normal (m2): less than the area where the facets at the pair are
    /// at an angle to each other. Tractions are forces over it, so that a uniform pressure on such facets
    /// reads as itself, and strengths are compared so; a shear along the edge between them reads too large
    /// by the ratio of the areas.
    pub projected_area: f64,
    /// Position of the pair in the undeformed mesh (m), for laws that depend on it; the origin unless
    /// [`with_position`](Self::with_position) sets it, as pairs that are made of facets do.
    pub position: Vec3,
    /// Distance to the farthest of the neighbouring pairs along the joint (m), the size of the mesh there: the root of the
    /// area unless [`with_spacing`](Self::with_spacing) sets it, as pairs that are made of facets do.
    pub spacing: f64,
    /// Pressure of the water in the joint at the pair (Pa, compression positive), zero in a dry one. Tractions of the pair are effective
    /// ones, total traction plus this pressure along the normal; the pressure itself acts on both sides as a load of the model.
    pub water_pressure: f64,
}

impl JointPair {
    /// Pair with a normal of any length but zero, some tangent across it, and an area (m2).
    pub fn new(nodes: [u32; 2], normal: Vec3, area: f64) -> Self {
        let normal = normal.normalize();
        // Across the axis that is farthest from the normal.
        let tangent = normal.cross(&Vec3::ith(normal.iamin(), 1.0)).normalize();
        Self {
            nodes,
            normal,
            tangent,
            area,
            projected_area: area,
            position: Vec3::zeros(),
            spacing: area.abs().sqrt(),
            water_pressure: 0.0,
        }
    }
    /// Pair of several facets, given the sum of their vector areas (m2, along their outward normals) and
    /// the sum of their areas (m2): its normal is the direction of the summed vector area, its projected area the
    /// length of that sum.
    pub fn of_facets(nodes: [u32; 2], vector_area: Vec3, area: f64) -> Self {
        /// Relative loss of a sum of facets in one plane by rounding.
        const ROUNDING: f64 = 1e-9;
        let seen = vector_area.norm();
        let plane = seen >= area * (1.0 - ROUNDING);
        Self {
            projected_area: if plane { area } else { seen },
            ..Self::new(nodes, vector_area, area)
        }
    }
    /// The same pair at a position in the undeformed mesh (m).
    #[must_use]
    pub fn with_position(self, position: Vec3) -> Self {
        Self { position, ..self }
    }
    /// The same pair with the distance to the farthest of its neighbours along the joint (m).
    #[must_use]
    pub fn with_spacing(self, spacing: f64) -> Self {
        Self { spacing, ..self }
    }
    /// Sets the pressure of the water in the joint at the pair (Pa, compression positive).
    #[must_use]
    pub fn with_water_pressure(self, water_pressure: f64) -> Self {
        Self {
            water_pressure,
            ..self
        }
    }
    /// Sets the two nodes (mesh indices), that of the first side first; normal and areas are kept.
    #[must_use]
    pub fn with_nodes(self, nodes: [u32; 2]) -> Self {
        Self { nodes, ..self }
    }
    /// Components of a vector along normal, first and second tangent.
    #[inline(always)]
    pub fn to_local(&self, vector: &Vec3) -> Vec3 {
        let second = self.normal.cross(&self.tangent);
        Vec3::new(
            vector.dot(&self.normal),
            vector.dot(&self.tangent),
            vector.dot(&second),
        )
    }
    /// Vector with given components along normal, first and second tangent.
    #[inline(always)]
    pub fn to_global(&self, local: &Vec3) -> Vec3 {
        let second = self.normal.cross(&self.tangent);
        self.normal * local.x + self.tangent * local.y + second * local.z
    }
}

/// Contact state, traction, opening, peak values and energies of a node pair.
///
/// Traction and opening are those at the time of the displacement; slip and energies include the step
/// that begins there. The history variables of its law are beside it, see [`JointView::history`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct JointRecord {
    /// Contact state, bond and accumulated slip.
    pub state: JointState,
    /// Traction on the first side (Pa): normal component, positive in tension, and two tangential ones; the effective one of a pair with
    /// [water](JointPair::water_pressure).
    pub traction: Vec3,
    /// Distance of the sides along the normal (m), negative where they overlap; from where the pair was
    /// [closed anew](Self::closed_at), if it was.
    pub opening: f64,
    /// Largest opening of the pair at any step so far (m), counted as [`opening`](Self::opening) is.
    pub peak_opening: f64,
    /// Tangential displacement of the second side at which the pair sticks (m, along both tangents); none
    /// before its first step.
    pub anchor: Option<[f64; 2]>,
    /// Slip of the step that begins at the time of the displacement (m), which the [state](Self::state) includes.
    pub coming_slip: f64,
    /// Work in the last step (J) on a bond that fails gradually, from the time of the displacement on; the energies of the
    /// bond, which are those at that time, include it from the next step on.
    pub late_work: f64,
    /// Time at the start of the first step in which the pair slipped (s); `None` if it never did. In a run after
    /// construction stages the time at which the run starts, if the pair slipped in a stage.
    pub first_slip: Option<f64>,
    /// Time at the start of the first step in which the pair was open (s), as from the start with an initial gap; `None`
    /// if it never was. In a run after construction stages the time at which the run starts, if the pair opened in a stage.
    pub first_crack: Option<f64>,
    /// Energy dissipated by friction so far (J), less the work of dilation against the pressure.
    pub friction: f64,
    /// Energy dissipated by the failure of the bond so far (J); zero while it holds.
    pub bond_energy: f64,
    /// Kinetic energy lost so far by impact of the sides (J).
    pub impact: f64,
    /// Displacement of the second side relative to the first (m: along the normal, with the initial gap
    /// if that was filled, and along two tangents) at which the pair was closed anew, as by grouting:
    /// opening, slip, anchor and energies count from there. None if it never was.
    pub closed_at: Option<[f64; 3]>,
    /// Opening at which the pair counts as closed (m): what its law returned as
    /// [`JointResponse::dilation`](crate::JointResponse::dilation); zero for laws that do not dilate.
    pub dilation: f64,
    /// Traction (Pa, along normal and tangents) by the stress of the elements beside the pair in the last static
    /// equilibrium, in addition to one that the joint has from the start. Where equilibrium alone does not determine the tractions, as of the pairs of two facets at one edge or
    /// along a direction in which supports hold both nodes, those nearest to it are taken. None if unknown.
    pub reference: Option<[f64; 3]>,
}

impl JointRecord {
    /// Record of a pair in a state that has not moved yet.
    pub fn new(state: JointState) -> Self {
        Self {
            state,
            ..Self::default()
        }
    }
    /// Sets the traction on the first side (Pa): normal component, positive in tension, and two tangential ones.
    #[must_use]
    pub fn with_traction(self, traction: Vec3) -> Self {
        Self { traction, ..self }
    }
    /// Sets the tangential displacement of the second side at which the pair sticks (m, along both tangents).
    #[must_use]
    pub fn with_anchor(self, anchor: [f64; 2]) -> Self {
        Self {
            anchor: Some(anchor),
            ..self
        }
    }
    /// Accumulated slip at the time of the displacement (m).
    pub fn slip(&self) -> f64 {
        self.state.slip - self.coming_slip
    }
    /// Relative displacement (m: normal and two tangents) from which opening and slip count: that at which
    /// the pair was [closed anew](Self::closed_at), else zero.
    pub fn origin(&self) -> Vec3 {
        self.closed_at.map_or_else(Vec3::zeros, Vec3::from)
    }
}

/// Way in which a joint starts anew at its present displacement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Renewal {
    /// Grouting: closed, initial gaps filled, every pair in the initial state of its law.
    Grouted,
    /// Removal of a tie: as the joint was built, with initial gaps, and without a bond where it had none.
    Released,
}

/// View of a joint for observers; lists have one entry per pair, in the same order.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct JointView<'a> {
    /// Name of the joint.
    pub name: &'a str,
    /// Name of its contact law, such as `bonded-coulomb`.
    pub law: &'a str,
    /// Whether the law has [no shear strength](crate::ContactLaw::is_smooth).
    pub smooth: bool,
    /// Nodes, local axes and areas of the pairs.
    pub pairs: &'a [JointPair],
    /// Contact states, tractions, peak values and energies of the pairs.
    pub records: &'a [JointRecord],
    /// Names, units and kinds of the history variables of the law; empty for a law without any.
    pub variables: &'a [HistoryVariable],
    /// Values of the history variables, those of a pair side by side.
    pub history: &'a [f64],
    /// Greatest number of sweeps in a step so far that connected pairs took; zero where one pass did.
    pub most_sweeps: u32,
    /// Largest relative change of motion in the last sweep over connected pairs, of all steps so far (1).
    pub worst_residual: f64,
}

impl<'a> JointView<'a> {
    /// View of a joint by name and law, without history variables, solved in one pass.
    pub fn new(
        name: &'a str,
        law: &'a str,
        pairs: &'a [JointPair],
        records: &'a [JointRecord],
    ) -> Self {
        Self {
            name,
            law,
            smooth: false,
            pairs,
            records,
            variables: &[],
            history: &[],
            most_sweeps: 0,
            worst_residual: 0.0,
        }
    }
    /// Sets whether the law has no shear strength.
    #[must_use]
    pub fn with_smooth(self, smooth: bool) -> Self {
        Self { smooth, ..self }
    }
    /// Sets the history variables of the law and their values, those of a pair side by side.
    #[must_use]
    pub fn with_history(self, variables: &'a [HistoryVariable], history: &'a [f64]) -> Self {
        Self {
            variables,
            history,
            ..self
        }
    }
    /// The same view with the [greatest number of sweeps](Self::most_sweeps) and the
    /// [largest residual](Self::worst_residual) of connected pairs.
    #[must_use]
    pub fn with_effort(self, most_sweeps: u32, worst_residual: f64) -> Self {
        Self {
            most_sweeps,
            worst_residual,
            ..self
        }
    }
}

/// State of a joint as stages and checkpoints keep it.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct JointHistory {
    /// Name of the joint.
    pub name: String,
    /// Mesh indices of the nodes of the pairs, as in [`JointPair`]. Pairs of the same nodes, of the
    /// patches at an edge, are in the order of the joint.
    pub nodes: Vec<[u32; 2]>,
    /// Contact states, tractions, peak values and energies of the pairs.
    pub records: Vec<JointRecord>,
    /// Names of the history variables of the law.
    pub variables: Vec<String>,
    /// Values of the history variables, those of a pair side by side.
    pub history: Vec<f64>,
}

impl JointHistory {
    /// History of a joint by name, the nodes of its pairs (mesh indices) and their records, without
    /// history variables of a law.
    pub fn new(name: impl Into<String>, nodes: Vec<[u32; 2]>, records: Vec<JointRecord>) -> Self {
        Self {
            name: name.into(),
            nodes,
            records,
            ..Self::default()
        }
    }
    /// Sets the names of the history variables of the law and their values, those of a pair side by side.
    #[must_use]
    pub fn with_history(self, variables: Vec<String>, history: Vec<f64>) -> Self {
        Self {
            variables,
            history,
            ..self
        }
    }
}

impl From<&JointView<'_>> for JointHistory {
    fn from(joint: &JointView) -> Self {
        let nodes = joint.pairs.iter().map(|pair| pair.nodes);
        let variables = joint.variables.iter().map(|variable| variable.name.into());
        Self::new(joint.name, nodes.collect(), joint.records.to_vec())
            .with_history(variables.collect(), joint.history.to_vec())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Components along normal and tangents give the vector back, for normals in any direction.
    #[test]
    fn local_components_give_the_vector_back() {
        let vector = Vec3::new(0.3, -1.2, 2.1);
        for normal in [
            Vec3::x(),
            -Vec3::y(),
            Vec3::z() * 4.0,
            Vec3::new(1.0, 1.0, 1.0),
            Vec3::new(-0.1, 3.0, 1e-9),
        ] {
            let pair = JointPair::new([0, 1], normal, 1.0);
            let local = pair.to_local(&vector);
            assert!((pair.to_global(&local) - vector).norm() < 1e-15 * 8.0);
            assert!((local.x - vector.dot(&normal) / normal.norm()).abs() < 1e-15 * 8.0);
        }
    }
}
