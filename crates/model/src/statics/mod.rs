//! Options, reports and errors of static solutions.

mod error;
mod options;
mod report;

pub use error::StaticError;
pub use options::{Linearisation, StaticMethod, StaticOptions};
pub use report::{HandOverReport, StaticProgress, StaticReport};
