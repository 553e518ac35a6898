//! The engine: element kernels, blocks of lanes, explicit integrators, stable step, energy ledger.
//!
//! A [`Model`] is built from a mesh, from factories that make blocks of its element sets
//! ([`solid`] makes one from any kernel and law), and from what acts on it: supports, periodic
//! pairs, prescribed motion, loads, boundaries, constraints. [`run`] steps it by a
//! [`TimeIntegrator`](powerhouse_model::TimeIntegrator), [`Leapfrog`] or [`OneSided`], and shows
//! each step to observers (see [`observe`]).
//!
//! What happened before is a list of [`Stage`]s, brought to rest one after another by
//! [`run_stages`]: an initial stress ([`StressField`]), elements that go and come, [bolts](BoltSet).
//! A dynamic model starts from their last state ([`ModelBuilder::start`]) and is handed over
//! ([`Model::hand_over`]): without input it stays still.
//!
//! A block of rock falls on rollers for a while:
//! ```
//! use powerhouse_explicit_core::*;
//! use powerhouse_model::*;
//! # #[derive(Clone)]
//! # struct Linear(ElasticMedium);
//! # impl ConstitutiveLaw for Linear {
//! #     const LINEAR: bool = true;
//! #     fn name(&self) -> &str { "linear" }
//! #     fn medium(&self) -> ElasticMedium { self.0 }
//! #     fn history(&self) -> &'static [HistoryVariable] { &[] }
//! #     fn stress_change<L: Lane>(&self, input: &LawInput<L>, _new_history: &mut [L]) -> Stress<L> {
//! #         let one = input.strain.0[0].constant(1.0);
//! #         Stress::elastic(one.constant(self.0.lambda()), one.constant(self.0.shear()), &input.strain)
//! #     }
//! # }
//! let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::new(4.0, 2.0, 2.0), [4, 2, 2], "rock")?;
//! let law = Linear(ElasticMedium::new(9.0e9, 0.27, 2750.0)?);
//! let wall = mesh.nodes_of_facets(mesh.facet_set("left")?);
//! let mut model = Model::builder(&mesh)
//!     .elements("rock", solid("rock", Hex8OnePoint::default(), law, BlockOptions::default()))
//!     .support(Support::roller(wall, Vec3::x()))
//!     .gravity(Vec3::new(0.0, 0.0, -9.81), Box::new(|_: f64| 1.0))
//!     .build()?;
//! let options = RunOptions::seconds(0.1).with_energy(EnergyCheck::every(100));
//! let report = run(&mut model, &Leapfrog, &options, &mut [], &mut |_| {})?;
//! assert!((model.displacement(0).z + 0.5 * 9.81 * 0.1 * 0.1).abs() < 1e-3);
//! assert!(report.energy_residual < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! What the engine cannot do it refuses before the run, as an [`EngineError`] that names the node,
//! element or set: a node without mass, an element that no set computes or that two claim, a load
//! on a node that does not exist, a dashpot that would feed energy in. What goes wrong on the way
//! is a [`RunError`](powerhouse_model::RunError) with step, time, element and set.
//!
//! # Why so
//! *Bits do not depend on threads.* A block writes the forces of its nodes to a buffer of its own,
//! and each node sums its slots in a fixed order. No atomics (54 ns per element where this costs
//! nothing), no colours (they lose the cache on large meshes). Blocks are cut by size, never by the
//! number of threads.
//!
//! *Blocks are compact, their inside is banded.* Sets are bisected into compact blocks, because
//! every node between blocks costs a slot: 1.2 slots per node at 2048 elements, where cutting along
//! the reverse Cuthill-McKee order costs 2.0. Larger meshes get larger blocks. Inside a block elements and nodes keep that order, so
//! that the elements of one batch of lanes read neighbouring nodes.
//!
//! *Kick and drift share a pass.* The kick of the nodes that have nothing but a mass waits for the
//! drift: forces, velocity and displacement go through the cache once. Whoever looks between the
//! two (observers, the ledger) gets what the pass is going to compute, from the same function.
//!
//! *Nodes that need more form groups.* Impedances, supports, prescribed motion, ties and
//! constraints act in short lists on `A = M + dt/2 C + dt^2/4 K`, a 3 x 3 matrix where it must be
//! one. The pass over all nodes knows none of this. Dashpots and springs in `A` cost no time step;
//! lagged dashpots would halve it (a box of cubes with dashpots on five faces: `dt c_p / h` of 0.42
//! instead of 0.95).
//!
//! *The state shown lies between kick and drift*, where displacement, mean velocity, acceleration
//! and stress belong to one time. A run of `n` steps shows `n` states; one that goes on shows
//! each once.
//!
//! *The stable step is that of the assembled model* (Lanczos), 1.2 to 1.7 times that of its
//! worst element. It is found once, from some tens of force evaluations; the bounds of the elements
//! name the culprit. Impedances are left out because they are implicit, joints because bonding
//! never raises a frequency.
//!
//! *The ledger asks the elements what they hold*, instead of summing the work of nodal forces: such
//! a sum balances whatever the elements do. Nodal work is booked in halves, before and after the
//! time of the force, with `1/2 v- . M v+`; everything else closes to the order of the step only.
//!
//! *A body comes to rest by its elastic operator* ([`Model::equilibrate`]): conjugate gradients need
//! nothing but the blocks' products, no matrix is ever assembled. Laws that yield take more
//! corrections of the same kind, each combined with the last ones, instead of tangents that few laws
//! have and that need not be symmetric. The feature `direct` adds a Cholesky factor of the assembled
//! operator for those who solve often and have the memory; Cholesky, not an `LU`, because the elastic
//! operator is symmetric and its factor serves all corrections, so that tangents are worth it only
//! where they are symmetric too.
//!
//! *The direct solver cuts space, not the graph*: elements are compact and meshes fill space, so that
//! a plane through the middle is a separator as good as a partitioner's, found by sorting.
//!
//! *Joints relax in steps, laws in one*: which pairs slide or open first decides what the others
//! bear, so they are asked step by step, by the very corrections that they make in a dynamic run.
//! Elements answer for an increment as a whole, as in the other methods, and come to the same rest;
//! if their history went along with the steps, swings that no load made would leave their traces.
//!
//! *A stage is a new model of the same mesh and state*, not a list of switches: whatever changes
//! between stages, numbering and blocks are made for what is there. Nothing is lost on the way,
//! because what holds a body at rest is computed anew by the model that goes on, its kernels,
//! lanes and digits, and stays on as standing forces. They are compared with those of the stage
//! before, so that a load that was forgotten is an error and not a hidden force.
//!
//! *Displacements go on, and so do the references of strain.* The static strain stays in the
//! strain; observers and springs see what was added since the stage began. Elements that are cast
//! later count their strain from where they were cast.
//!
//! *The paper's scheme is a leapfrog* with less damping, see [`OneSided`]; it is computed as such,
//! and refused where it would grow.

mod applied;
mod assembly;
mod block;
mod bolts;
mod constrained;
mod damping;
mod effective_mass;
mod error;
mod gather;
mod groups;
mod hourglass;
mod integrator;
mod kernels;
mod lanes;
mod ledger;
mod loads;
mod model;
mod nodes;
mod numbering;
pub mod observe;
mod partition;
mod periodic;
mod roller_nodes;
mod run;
mod spectrum;
mod stable_step;
mod stage;
mod statics;
mod support;
mod view;

pub use assembly::{BlockFactory, BlockOptions, BlockPart, LaneWidth, Precision, Rayleigh};
pub use block::{AnyLaw, solid};
pub use bolts::{BoltEnd, BoltLine, BoltParameters, BoltPattern, BoltSegment, BoltSet, Grout};
pub use error::{ElementExtent, EngineError};
pub use hourglass::HourglassShare;
pub use integrator::{Leapfrog, OneSided};
pub use kernels::{Hex8BBar, Hex8Full, Hex8OnePoint, SolidKernel, Tet4, Wedge6};
pub use loads::{FacePressure, FaceTraction, NodalForce, Profile};
pub use model::{ElementChoice, Model, ModelBuilder};
pub use periodic::PeriodicPairs;
pub use run::{
    Ended, EnergyCheck, Length, Progress, RunFailure, RunOptions, RunReport, StepChoice, run,
    run_reporting,
};
pub use stable_step::StableStep;
pub use stage::{Stage, StageError, StageEvent, StageModel, StageReport, StressField, run_stages};
#[cfg(feature = "direct")]
pub use statics::Linearisation;
pub use statics::{
    HandOverReport, StaticError, StaticMethod, StaticOptions, StaticProgress, StaticReport,
};
pub use support::{Prescribed, Support};
