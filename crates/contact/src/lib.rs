//! Joints: node pairs that are bonded, crack, slide, open and close.
//!
//! A [`Joint`] has node pairs, a contact law and the state of each pair. A contact law
//! ([`ContactLaw`](powerhouse_model::ContactLaw)) returns the traction that a joint admits in place of a trial
//! traction; it may have history variables of its own, and let the joint dilate. Built-in laws:
//!
//! | law | bond | friction |
//! |---|---|---|
//! | [`Tied`] | never breaks | |
//! | [`BondedCoulomb`] | shear and tension up to an envelope, then none for good | static, dynamic |
//! | [`Cohesive`] | fails gradually, with fracture energies in opening and shear | beside the bond, static, dynamic |
//! | [`Paper`] | Eqs. (22) to (24) of Wang, Chen & Xiao (2019) as printed | static, dynamic |
//! | [`SlipWeakening`] | none | falls with slip |
//! | [`Frictionless`] | none | none |
//!
//! [`JointSurface`] makes node pairs of the facets of two sides: of a mesh that is meshed apart there, or
//! that [`Mesh::split_between`](powerhouse_model::Mesh::split_between) has cut open.
//!
//! [`TiedPairs`] ties nodes without area or traction; [`pair_nodes`] pairs the nodes of two sides.
//!
//! Slip and opening are small: pairs keep their nodes, normals and areas.
//!
//! # Why so
//! *Predict and correct, no penalty.* The engine predicts velocities without the joint; the joint
//! adds the impulses that close it, computed with the effective inverse masses
//! `A^-1 = (M + dt/2 C + dt^2/4 K)^-1` of its nodes. There is no parameter to tune, the stable step does
//! not fall (bonding only lowers frequencies), and the gap closes to round-off for any ratio of
//! masses. With the bare masses in place of `A` about half of the gap stays wherever a boundary's
//! dashpots act on a pair.
//!
//! *One pass where that is exact.* If no other pair shares the nodes and their effective masses are
//! the same in all directions, normal and tangential parts decouple, slip has the direction of the
//! stick trial, and one evaluation of the law solves the pair. Everything else (dashpots at an
//! angle, rollers, lines where joints meet, corners) is solved by sweeps over the few pairs
//! concerned, which end in an error rather than in a wrong force.
//!
//! *Threads share strips of pairs.* Isolated pairs do not depend on each other; strips of 256 of them are computed side by side,
//! and their work is summed strip by strip, so that the number of threads changes no bit.
//!
//! *Connected pairs are solved together.* Where several pairs share a node (three bodies along one line) one
//! pass over the pairs leaves gaps: each correction opens what the last one closed, and with a light
//! node between heavy ones even a hundred thousand sweeps do not converge. Pairs that hold are therefore
//! eliminated by a direct solution. Tractions around a closed ring of bonded pairs are not unique;
//! those with the least sum of squares, weighted by compliance, are taken.
//!
//! *Sticking has a position.* A pair that sticks is held at the displacement at which it began to, not merely
//! at zero slip rate, so that rounding does not add up; nodes that never moved against each other get the
//! same velocity to the last bit.
//!
//! *No restitution.* Where sides meet, the kinetic energy of the relative motion of the pair's masses is lost.
//! The loss is reported as impact; it falls with the size of the elements (for two bars that meet, to `h / (4 L)`
//! of their energy). Reversing the velocity instead triples the peak stress, chatters, and can add
//! energy.

mod connected;
mod error;
mod joint;
mod laws;
mod pairing;
mod present;
mod surface;
mod tied;

pub use error::ContactError;
pub use joint::Joint;
pub use laws::{
    BondedCoulomb, BondedCoulombParameters, Cohesive, CohesiveParameters, Frictionless, Paper,
    PaperParameters, SlipWeakening, SlipWeakeningParameters, StrengthReduction, Tied,
};
pub use pairing::{Pairing, pair_nodes};
pub use surface::{JointFacet, JointSurface, SurfaceOptions};
pub use tied::TiedPairs;
