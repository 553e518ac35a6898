//! Long runs: the stable step, what must not lower it, the account of energies, and the atlas of
//! extremes; scenes with mistakes.

mod atlas;
mod energy;
mod joints;
mod mutations;
mod stable_step;
mod true_step;
