//! Long runs: the stable step, components that must not reduce it, the energy balance, and the atlas of
//! extremes; scenes with mistakes.

mod atlas;
mod energy;
mod joints;
mod mutations;
mod ringing;
mod stable_step;
mod true_step;
