//! Joints: what a law admits, what becomes of a pair, and how others see it.

use crate::Vec3;

/// How the two sides of a pair move against each other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ContactState {
    /// Together.
    #[default]
    Stick,
    /// Along each other.
    Slide,
    /// Apart.
    Open,
}

/// Whether something holds the two sides of a pair together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Bond {
    /// There has never been a bond.
    #[default]
    Never,
    /// The bond holds.
    Intact,
    /// It broke, for good.
    Broken,
}

/// What a law reads of a pair, and what it decides.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JointState {
    /// How the sides moved in the last step.
    pub contact: ContactState,
    /// Whether a bond holds them.
    pub bond: Bond,
    /// Accumulated slip (m). The joint keeps it; what a law returns here is not used.
    pub slip: f64,
}

/// Which tractions a joint admits.
///
/// A pure function of the trial traction and the pair's state: it runs without a mesh. Tractions
/// are those on the first side (Pa): the component along its outward normal, positive in tension,
/// and two along tangents. The law must not prefer a direction in the plane of the tangents.
/// ```
/// use powerhouse_model::{Bond, ContactLaw, ContactState, JointState, Vec3};
/// /// Presses, never pulls, never rubs.
/// struct Smooth;
/// impl ContactLaw for Smooth {
///     fn name(&self) -> &str { "smooth" }
///     fn initial(&self) -> JointState { JointState::default() }
///     fn admissible(&self, trial: Vec3, state: &JointState) -> (Vec3, JointState) {
///         let contact = if trial.x > 0.0 { ContactState::Open } else { ContactState::Slide };
///         (Vec3::new(trial.x.min(0.0), 0.0, 0.0), JointState { contact, ..*state })
///     }
///     fn sliding_strength(&self, _normal: f64, _state: &JointState) -> f64 { 0.0 }
/// }
/// let (traction, _) = Smooth.admissible(Vec3::new(2.0, 1.0, 0.0), &JointState::default());
/// assert_eq!(traction, Vec3::zeros());
/// ```
pub trait ContactLaw: Send + Sync {
    /// The law's name in reports.
    fn name(&self) -> &str;
    /// The state of a pair that has not moved yet.
    fn initial(&self) -> JointState;
    /// The traction that the joint admits in place of the trial one, which would close the gap
    /// and stop the slip, and the new state. A pair sticks where the trial is admitted as it is,
    /// to the bit.
    fn admissible(&self, trial: Vec3, state: &JointState) -> (Vec3, JointState);
    /// [`admissible`](Self::admissible) for many pairs at once, in place: trial tractions become those
    /// admitted, states new ones. A law that stands behind a pointer is called once for all of them.
    #[inline(always)]
    fn admit(&self, tractions: &mut [Vec3], states: &mut [JointState]) {
        for (traction, state) in tractions.iter_mut().zip(states) {
            (*traction, *state) = self.admissible(*traction, state);
        }
    }
    /// The shear traction (Pa, not negative) of a pair that slides under a normal traction (Pa,
    /// positive in tension).
    fn sliding_strength(&self, normal: f64, state: &JointState) -> f64;
    /// The greatest normal traction (Pa) of a pair in this state that no bond holds together; none by
    /// default.
    fn unbonded_tension(&self, _state: &JointState) -> f64 {
        0.0
    }
}

/// A law behind a pointer is the law: every question goes on, that for many pairs as one call.
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
                fn admissible(&self, trial: Vec3, state: &JointState) -> (Vec3, JointState) {
                    (**self).admissible(trial, state)
                }
                #[inline(always)]
                fn admit(&self, tractions: &mut [Vec3], states: &mut [JointState]) {
                    (**self).admit(tractions, states)
                }
                fn sliding_strength(&self, normal: f64, state: &JointState) -> f64 {
                    (**self).sliding_strength(normal, state)
                }
                fn unbonded_tension(&self, state: &JointState) -> f64 {
                    (**self).unbonded_tension(state)
                }
            }
        )+
    };
}

law_behind!(Box<L>, std::sync::Arc<L>, &L);

/// Two nodes that face each other across a joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointPair {
    /// Mesh indices, the first side's node first.
    pub nodes: [u32; 2],
    /// Unit normal, out of the first side and into the second.
    pub normal: Vec3,
    /// First unit tangent; the second is `normal x tangent`.
    pub tangent: Vec3,
    /// Area of the joint that belongs to the pair (m2).
    pub area: f64,
    /// Of it what is seen along the normal (m2): less than the area where the facets at the pair are at an
    /// angle to each other. Tractions are forces over it, so that a uniform pressure on such facets reads as
    /// itself, and strengths see it so; a shear along the edge between them reads too large by the
    /// ratio of the areas.
    pub projected_area: f64,
}

impl JointPair {
    /// A pair with a normal of any length but zero, a tangent of its own choice and an area (m2).
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
        }
    }
    /// The pair of facets whose vector areas (m2, along their outward normals) add up to a sum, and whose
    /// areas to an area: its normal is the direction of that sum.
    pub fn of_facets(nodes: [u32; 2], vector_area: Vec3, area: f64) -> Self {
        /// What rounding may take from the sum of facets in one plane.
        const ROUNDING: f64 = 1e-9;
        let seen = vector_area.norm();
        let plane = seen >= area * (1.0 - ROUNDING);
        Self {
            projected_area: if plane { area } else { seen },
            ..Self::new(nodes, vector_area, area)
        }
    }
    /// Components along normal, first and second tangent.
    #[inline(always)]
    pub fn to_local(&self, vector: &Vec3) -> Vec3 {
        let second = self.normal.cross(&self.tangent);
        Vec3::new(
            vector.dot(&self.normal),
            vector.dot(&self.tangent),
            vector.dot(&second),
        )
    }
    /// The vector with these components along normal, first and second tangent.
    #[inline(always)]
    pub fn to_global(&self, local: &Vec3) -> Vec3 {
        let second = self.normal.cross(&self.tangent);
        self.normal * local.x + self.tangent * local.y + second * local.z
    }
}

/// Contact state, history variables and peak values of a node pair.
///
/// Traction and gap are those at the time of the displacement; slip and energies include the step
/// that begins there.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JointRecord {
    /// What its law reads.
    pub state: JointState,
    /// Traction on the first side (Pa): normal, positive in tension, and two tangents.
    pub traction: Vec3,
    /// Distance of the sides along the normal (m), negative where they overlap; from where the pair was
    /// [closed anew](Self::closed_at), if it was.
    pub opening: f64,
    /// The largest opening so far (m).
    pub peak_opening: f64,
    /// Where it sticks: displacement of the second side along the tangents (m); none before its
    /// first step.
    pub anchor: Option<[f64; 2]>,
    /// When it first slid (s).
    pub first_slip: Option<f64>,
    /// When it first opened (s).
    pub first_crack: Option<f64>,
    /// Dissipated by friction so far (J).
    pub friction: f64,
    /// Dissipated in the step in which its bond broke (J).
    pub bond_energy: f64,
    /// Lost so far where the sides met (J).
    pub impact: f64,
    /// Displacement of the second side relative to the first (m: along the normal, with the initial gap
    /// if that was filled, and along two tangents) at which the pair was closed anew, as by grouting:
    /// opening, slip, anchor and energies count from there. None if it never was.
    pub closed_at: Option<[f64; 3]>,
}

impl JointRecord {
    /// The relative displacement (m: normal and two tangents) that counts as none: that at which the
    /// pair was [closed anew](Self::closed_at), else zero.
    pub fn origin(&self) -> Vec3 {
        self.closed_at.map_or_else(Vec3::zeros, Vec3::from)
    }
}

/// How a joint starts anew at the displacement that it has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Renewal {
    /// Closed, initial gaps filled, every pair in the initial state of its law: grouting.
    Grouted,
    /// As it was built, with initial gaps, and without a bond where it had none: a tie is taken off.
    Released,
}

/// A joint as others see it; pair by pair in the same order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointView<'a> {
    /// The joint's name.
    pub name: &'a str,
    /// The name of its law.
    pub law: &'a str,
    /// Nodes, directions and areas.
    pub pairs: &'a [JointPair],
    /// Contact states and history variables of its pairs.
    pub records: &'a [JointRecord],
    /// The most sweeps that connected pairs took in a step so far; zero where one pass did.
    pub most_sweeps: u32,
    /// The largest relative change of motion that such a solution left.
    pub worst_residual: f64,
}

/// What a stage or checkpoint keeps of a joint.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JointHistory {
    /// The joint's name.
    pub name: String,
    /// Mesh indices of the nodes of its pairs, as in [`JointPair`]. Pairs of the same nodes, of the
    /// patches at an edge, stand in the order of the joint.
    pub nodes: Vec<[u32; 2]>,
    /// Contact states and history variables of its pairs.
    pub records: Vec<JointRecord>,
}

impl From<&JointView<'_>> for JointHistory {
    fn from(joint: &JointView) -> Self {
        Self {
            name: joint.name.into(),
            nodes: joint.pairs.iter().map(|pair| pair.nodes).collect(),
            records: joint.records.to_vec(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::sync::atomic::{AtomicUsize, Ordering};
    use std::sync::Arc;

    /// Lets everything through and counts how it is asked.
    #[derive(Default)]
    struct Counting {
        alone: AtomicUsize,
        together: AtomicUsize,
    }

    impl ContactLaw for Counting {
        fn name(&self) -> &str {
            "counting"
        }
        fn initial(&self) -> JointState {
            JointState::default()
        }
        fn admissible(&self, trial: Vec3, state: &JointState) -> (Vec3, JointState) {
            self.alone.fetch_add(1, Ordering::Relaxed);
            (trial, *state)
        }
        fn admit(&self, _tractions: &mut [Vec3], _states: &mut [JointState]) {
            self.together.fetch_add(1, Ordering::Relaxed);
        }
        fn sliding_strength(&self, _normal: f64, _state: &JointState) -> f64 {
            0.0
        }
    }

    /// Behind every pointer a law is asked once for many pairs, and not pair by pair.
    #[test]
    fn a_law_behind_a_pointer_is_asked_once_for_many_pairs() {
        fn ask(law: impl ContactLaw) {
            law.admit(&mut [Vec3::zeros(); 3], &mut [JointState::default(); 3]);
        }
        let law = Arc::new(Counting::default());
        ask(law.as_ref() as &dyn ContactLaw);
        ask(law.clone() as Arc<dyn ContactLaw>);
        ask(Box::new(law.clone()) as Box<dyn ContactLaw>);
        let counts = [&law.alone, &law.together].map(|count| count.load(Ordering::Relaxed));
        assert_eq!(counts, [0, 3]);
    }

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
