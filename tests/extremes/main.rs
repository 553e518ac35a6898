//! Long runs: the stable step, what must not lower it, and the account of energies.

mod energy;
mod joints;
mod stable_step;
