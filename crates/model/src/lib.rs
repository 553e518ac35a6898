//! Common data types and interfaces of the finite element libraries.
//!
//! This crate defines the data that the engine reads or two of the other crates exchange: the
//! [mesh](Mesh) with its named sets, [tensors](Stress), [elastic media](ElasticMedium), the
//! [state](State) of a body, and the traits of element kernels, constitutive laws,
//! incident fields, absorbing boundaries, joints, time integrators, observers and engines, with what an [`Engine`]
//! builds a model from ([`ModelSpec`]) and what its runs and static solutions report. It computes nothing
//! beyond geometry and tensor algebra.
//!
//! # Conventions
//! SI units. Tension is positive. `z` points up; a free surface is horizontal. Symmetric tensors
//! are stored in the order `xx yy zz xy yz zx`, strains with engineering shear components.
//! Stresses are total stresses; laws of material with water in its pores see effective ones. Strains and slips are small.
//!
//! # Why so
//! *The state is separate from the model.* States, results and stages use mesh indices and the user's node
//! and element numbers ([`State`]); an engine may renumber nodes and elements internally.
//! *Contexts are structs*, so that a field added later breaks no implementation.
//! *Dispatch is dynamic once per block and step*, static inside: see [`ElementBlock`] and
//! [`ConstitutiveLaw`].

mod added_mass;
mod assembly;
mod block_law;
mod block_parts;
mod boundary;
mod checksum;
mod constraint;
mod constraint_parts;
mod contact_law;
mod delayed;
mod disjoint_sets;
mod elastic_domain;
mod element;
mod embedded_bars;
mod engine;
mod engine_error;
mod engine_model;
mod error;
mod extents;
mod fibre;
mod field;
mod hourglass;
mod joint;
mod kernel;
mod kernel_parts;
#[cfg(feature = "keys")]
pub mod keys;
mod lane;
mod law;
mod law_input;
mod load;
mod medium;
mod mesh;
mod nodal;
mod periodic;
mod point_law;
mod pore_water;
mod program;
mod ranks;
mod rayleigh;
mod reach;
mod run;
mod saved_run;
mod saved_state;
mod spec;
mod stable_step;
mod stage;
mod state;
mod state_error;
mod statics;
mod step_device;
mod step_profile;
mod step_time;
mod stress_field;
mod support;
mod tensor;

pub use added_mass::AddedMass;
pub use assembly::{BlockFactory, BlockOptions, BlockPart, LaneWidth, Precision, Rayleigh};
pub use block_law::{BlockLaw, BlockLawInput};
pub use block_parts::{
    BlockOutput, BlockStiffness, DampedBlock, ElementForces, ProgrammedBlock, StatefulBlock,
};
pub use boundary::{
    AbsorbingBoundary, BoundaryParts, BoundarySite, ExtraBlock, NodalImpedance, SiteFace, SiteNode,
};
pub use checksum::Checksum;
pub use constraint::{
    Constraint, ConstraintWork, CoupledConstraint, DividedConstraint, DividedWork, JointConstraint,
    NodeCoupling, PredictedMotion, RestrictedConstraint,
};
pub use constraint_parts::ConstraintParts;
pub use contact_law::{
    BondEnergies, ContactLaw, JointInput, JointInputs, JointResponse, JointResponses,
};
pub use delayed::{DelayedPairs, StiffElements};
pub use disjoint_sets::DisjointSets;
pub use elastic_domain::ElasticDomain;
pub use element::{
    BlockContext, BlockEnergy, ElementBlock, ElementFault, FrequencyBound, LimitingTerm, Operator,
};
pub use embedded_bars::{AXIAL_FORCE, EmbeddedBars, EmbeddedElements};
pub use engine::{
    Cadence, Dynamics, Fields, Flow, ForceTerms, FrequencyLimits, MassDampingRule, Observer,
    StepView, TimeIntegrator,
};
pub use engine_error::{ElementExtent, EngineError};
pub use engine_model::{
    DistributedModel, Engine, EngineModel, FibreModel, ModelFrequencies, ModelOutput,
    StatefulModel, StaticModel,
};
pub use error::{ModelError, ParameterError, RunError};
pub use extents::Extents;
pub use fibre::Fibre;
pub use field::{FieldMotion, FieldSampler, IncidentField};
pub use hourglass::HourglassShare;
pub use joint::{
    Bond, ContactState, JointHistory, JointPair, JointRecord, JointState, JointView, Renewal,
};
pub use kernel::{ElementKernel, Geometry, Hourglass, OwnStep};
pub use kernel_parts::{Absent, HistoryKernel, HourglassKernel, KernelArithmetic, ModalKernel};
pub use lane::{Lane, Repeated, Scalar, array, each};
pub use law::{
    ConstitutiveLaw, HistoryKind, HistoryVariable, LawEnergy, RemainingStiffness, point_energy,
    point_stress_change,
};
pub use law_input::{LawInput, PointLocation};
pub use load::{Constant, NodalLoad, Table, TimeFunction};
pub use medium::ElasticMedium;
pub use mesh::{
    Axis, ElementKind, Facet, FacetGeometry, Located, Mesh, MeshArrays, MeshBuilder, MeshError,
    NodeTributary, QualityReport, SharedArray, Split,
};
pub use nodal::{NodalScalar, NodalView, NodalViewMut, Quad};
pub use periodic::PeriodicPairs;
pub use point_law::{PointAdapter, PointLaw};
pub use pore_water::{
    EFFECTIVE_STRESS, EXCESS_PORE_PRESSURE, PORE_PRESSURE, PORE_PRESSURE_RATIO, effective_stress,
};
pub use program::{
    NumberFormat, Program, ProgramBranch, ProgramError, ProgramLoop, ProgramOperation, ProgramParts,
};
pub use ranks::{Message, RankError, RankForecast, Ranks, SingleRank, ThreadRanks};
pub use reach::{Reach, Selection};
pub use run::{
    DeviceShare, Ended, EnergyCheck, Length, Progress, RunFailure, RunOptions, RunReport,
    StepChoice, UnsolvedSteps,
};
pub use saved_run::{CheckpointSink, SavedRun, SavedSection};
#[cfg(feature = "serde")]
pub use saved_run::{decode, encode, interned};
pub use saved_state::SavedState;
pub use spec::{ElementChoice, ModelSpec};
pub use stable_step::StableStep;
pub use stage::{Stage, StageError, StageEvent, StageModel, StageReport};
pub use state::{Cast, HistoryField, State};
pub use state_error::StateError;
pub use statics::{
    HandOverReport, Linearisation, StaticError, StaticMethod, StaticOptions, StaticProgress,
    StaticReport,
};
pub use step_device::{
    DeviceBlock, DeviceError, DeviceGroup, DeviceLoads, DeviceModel, DeviceMotion, StepDevice,
    StepDevices,
};
pub use step_profile::{ProfileRow, StepProfile};
pub use step_time::StepTime;
pub use stress_field::StressField;
pub use support::{Prescribed, Support};
pub use tensor::{Principal, Strain, Stress};

/// The crate of linear algebra whose vectors and matrices stand in public signatures, in the version in use.
pub use nalgebra;

/// A vector in space: position (m), displacement (m), velocity (m/s) or force (N).
pub type Vec3 = nalgebra::Vector3<f64>;
/// A 3 x 3 matrix, such as a nodal spring (N/m) or dashpot (N s/m).
pub type Mat3 = nalgebra::Matrix3<f64>;
