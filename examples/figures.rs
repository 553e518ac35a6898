//! How the examples print their figures: one per line, `figure NAME VALUE`, beside what is
//! expected of it.

pub mod block;
pub mod cavity;
pub mod column;
pub mod interface;
pub mod prices;
pub mod process;
pub mod reference;
pub mod softening;
pub mod strip;

use std::process::ExitCode;

/// What an example gives, or why it cannot.
pub type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

/// The figures of one example.
#[derive(Debug, Default)]
pub struct Figures {
    missed: usize,
}

impl Figures {
    /// Prints a figure that has no limit, with a remark.
    pub fn report(&self, name: &str, value: f64, remark: &str) {
        println!("figure {name} {value:.6e}");
        println!("    {remark}");
    }

    /// Prints a figure that must not exceed a limit.
    pub fn at_most(&mut self, name: &str, value: f64, limit: f64) {
        println!("figure {name} {value:.6e}");
        // A value that is not a number misses its limit too.
        let met = value <= limit;
        self.missed += usize::from(!met);
        println!(
            "    limit {limit:e}: {}",
            if met { "met" } else { "MISSED" }
        );
    }

    /// How many figures missed their limit.
    #[must_use]
    pub fn missed(&self) -> usize {
        self.missed
    }

    /// Success if every limit was met.
    #[must_use]
    pub fn verdict(self) -> ExitCode {
        match self.missed {
            0 => ExitCode::SUCCESS,
            missed => {
                println!("{missed} figures miss their limit");
                ExitCode::FAILURE
            }
        }
    }
}
