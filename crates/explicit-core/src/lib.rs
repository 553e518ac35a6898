//! Explicit finite element engine: time integrators, stable time step, energy balance, static equilibrium and
//! construction stages.
//!
//! A [`Model`] is built from a mesh, from [factories](powerhouse_model::BlockFactory) that make blocks of its
//! element sets, and from its boundary conditions: supports, periodic
//! pairs, prescribed motion, loads, absorbing boundaries, constraints. [`run`] integrates it in time by a
//! [`TimeIntegrator`](powerhouse_model::TimeIntegrator), [`Leapfrog`] or [`OneSided`], and calls
//! [observers](powerhouse_model::Observer) in each step. Kernels, blocks and observers are in other crates, of
//! which this one knows the traits alone.
//!
//! The static history before the dynamic run is a list of construction [stages](powerhouse_model::Stage), each
//! brought into static equilibrium by [`run_stages`]: an initial stress, death and birth of elements,
//! bolts. A dynamic model starts from their last state ([`ModelSpec::start`](powerhouse_model::ModelSpec::start),
//! [`Model::hand_over`]): without input it stays at rest.
//!
//! Programs that may run on another engine hold [`Explicit`] as an [`Engine`](powerhouse_model::Engine).
//!
//! A block of rock guided by rollers falls under its weight:
//! ```
//! use powerhouse_elements::SolidKernel;
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
//!     .elements("rock", SolidKernel::ONE_POINT.factory("rock", law, BlockOptions::default()))
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
//! A model that cannot be computed is refused before the run by an [`EngineError`](powerhouse_model::EngineError) that names the node,
//! element or set: a node without mass, an element that belongs to no set or to two, a load
//! on a node that does not exist, a dashpot that would add energy. A failure during the run
//! is a [`RunError`](powerhouse_model::RunError) with step, time, element and set.
//!
//! # Why so
//! *Results are bitwise independent of the number of threads.* A block writes its nodal forces to a buffer
//! of its own, and the entries (slots) of each node are summed in a fixed order. Atomic additions cost 54 ns
//! per element where this costs nothing, and colouring loses cache locality on large meshes. The partition
//! depends on the block size, never on the number of threads.
//!
//! *Blocks are compact in space and banded inside.* Sets are bisected into compact blocks, because
//! every node between blocks costs a slot: 1.2 slots per node at 2048 elements, where cutting along
//! the reverse Cuthill-McKee order costs 2.0. Larger meshes get larger blocks. Inside a block elements and
//! nodes keep that order, so that the elements of one SIMD batch read neighbouring nodes.
//!
//! *Bolts are in a block for each block of their hosts*, by the host element at the head: their forces are computed beside those
//! of other blocks, and each of these blocks needs little more than the nodes of its host.
//!
//! *Constraints have parts* ([`Model::constraint_parts`]): nodes whose motion must be computed together, such as those of node pairs
//! that share nodes. Whoever divides a body among processes places each part where all its nodes are.
//!
//! *Velocity update (kick) and displacement update (drift) share a pass over the nodes.* The kick of nodes
//! with a mass only is deferred to the drift, so that forces, velocity and displacement go through the cache
//! once. Observers and the energy balance, which are evaluated between the two, take the new velocity from the
//! same function as the pass.
//!
//! *Constrained nodes form groups.* Impedances, supports, prescribed motion, ties and
//! constraints act on the effective mass `A = M + dt/2 C + dt^2/4 K` of a few nodes, a 3 x 3 matrix where
//! directions are coupled; the pass over all nodes does not involve them. Dashpots and springs in `A` do not
//! reduce the stable step; lagged dashpots would halve it (a box of cubes with dashpots on five faces:
//! `dt c_p / h` of 0.42 instead of 0.95).
//!
//! *Output is taken between kick and drift*, where displacement, mean velocity, acceleration
//! and stress belong to one time. A run of `n` steps has `n` output states; a continued run repeats none.
//!
//! *The stable step is that of the assembled model* (Lanczos), 1.2 to 1.7 times that of its
//! worst element. It is found once, from some tens of force evaluations; the element bounds
//! identify the limiting element. Impedances are left out because they are implicit, joints because a tie
//! never raises the highest frequency, and pairs that slide raise its square by `(1 + sqrt(1 + mu^2)) / 2` at most; in
//! bodies of bricks the factor 0.98 covered what they did up to a friction coefficient of 0.84.
//!
//! *The energy balance takes internal energy from stresses and strains of the elements*, instead of the work of
//! nodal forces: such a sum balances identically and detects no error. The work of a nodal force is accounted
//! for in two halves, with the velocities before and after its time, and kinetic energy as `1/2 v- . M v+`; any
//! other form closes to the order of the step only.
//!
//! *Static equilibrium is found with the elastic operator* ([`Model::equilibrate`]): conjugate gradients need
//! matrix-vector products of the blocks alone, and no matrix is assembled. Nonlinear laws take more
//! corrections of the same kind, accelerated by Anderson mixing, instead of consistent tangents, which few laws
//! have and which need not be symmetric. The feature `direct` adds a Cholesky factor of the assembled
//! operator, for repeated solutions where memory permits; Cholesky, not an `LU`, because the elastic
//! operator is symmetric and its factor serves all corrections, so that tangents are worth it only
//! where they are symmetric too.
//!
//! *Nested dissection of the direct solver bisects space, not the graph*: elements are compact and meshes fill
//! space, so that a plane through the middle is a separator as good as a graph partitioner's, found by sorting.
//!
//! *In dynamic relaxation joints are evaluated in every step, constitutive laws once per increment*: which pairs
//! slide or open first determines the load of the others, so joint laws are evaluated step by step, as
//! in a dynamic run. Constitutive laws return the stress of the whole increment from the last committed history, as
//! in the other methods, and reach the same equilibrium; a history committed in every step would contain
//! oscillations that no load caused.
//!
//! *A stage is a new model of the same mesh and state*, not a list of switches: numbering and blocks are made
//! for the active elements. The forces that hold a body in static equilibrium are recomputed by the model of the
//! next stage, with its kernels, lanes and precision, and are kept as carried forces. They are compared with
//! those of the stage before, so that an omitted load is an error and not a hidden force.
//!
//! *Displacements and reference configurations continue through the stages.* The static strain is part of the
//! strain; observers and boundary springs take the displacement since the start of the stage. Elements that are
//! cast later have their own stress-free reference configuration.
//!
//! *The one-sided scheme of Wang, Chen & Xiao (2019) is a leapfrog* with less damping, see [`OneSided`]; it is
//! computed as such, and refused where it is unstable.

mod applied;
mod bay;
mod condition;
mod constrained;
mod delayed;
mod device;
mod diagonal_group;
mod effective_mass;
mod engine;
mod exact;
mod fibre_nodes;
mod fibres;
mod gather;
mod groups;
mod hourglass;
mod integrator;
mod inverse_root;
mod ledger;
mod model;
mod node_group;
mod node_ranges;
mod nodes;
mod numbering;
mod partition;
mod profile;
mod ranks;
mod roller_nodes;
mod run;
mod saved;
mod spectrum;
mod stable_step;
mod stage;
mod statics;
mod subdomain;
mod tiled;
mod view;
mod weight;

pub use device::ExplicitOnDevice;
pub use engine::Explicit;
pub(crate) use engine::NAME;
pub use exact::ExactSum;
pub use integrator::{Leapfrog, OneSided};
pub use model::{BuildModel, Model};
pub use partition::{Partition, PartitionBlock};
pub use ranks::{Distribution, ExplicitOnRanks, RankModel, Traffic};
pub use run::{run, run_reporting};
pub use stage::run_stages;
