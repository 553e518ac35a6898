//! Independence of the results from threads, lanes and the direction of the axes.

mod at_once;
mod bits;
mod blocks;
mod bonded_cavern;
mod device;
mod direction;
mod energy_balance;
mod graded;
mod joints;
mod laws;
mod rank_scenes;
mod ranks;
mod resume;
mod resume_stages;
