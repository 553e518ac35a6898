//! Independence of the results from threads, lanes and the direction of the axes.

mod bits;
mod bonded_cavern;
mod books;
mod direction;
mod graded;
mod joints;
mod laws;
