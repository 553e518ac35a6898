//! The engine: integrators, the stable step, equilibrium, stages, ranks.

mod added_mass;
mod bays;
mod energy;
mod exact;
mod fibres;
mod fibres_at_joints;
mod loads;
mod motion;
mod ranks;
mod refusals;
mod resume;
mod runs;
mod slices;
mod solids;
mod stability;
mod stages;
mod support;
