//! The stable step, and what must not lower it.

mod stable_step;
