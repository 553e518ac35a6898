//! Scenes from files and from Rust: accepted input, errors, and results of runs.

mod base_motion;
mod crack_bands;
mod damping;
mod grouting;
mod hourglass;
mod joint_history;
mod joint_output;
mod joint_starts;
mod joints;
mod keys_of_ground;
mod keys_of_model;
mod keys_of_output;
mod law_points;
mod law_results;
mod laws;
mod lost_sides;
mod nonsense;
mod region;
mod runs;
mod smaller;
mod stage_loads;
mod stage_warnings;
mod stages;
mod stages_at_rest;
mod support;
mod surroundings;
