//! Output of the figures of the examples: one per line, `figure NAME VALUE`, with the expected value.

pub mod block;
pub mod cavity;
pub mod column;
pub mod fe_loop;
pub mod interface;
pub mod prices;
pub mod process;
pub mod reference;
pub mod softening;
pub mod strip;

use std::process::ExitCode;

/// Result of an example.
pub type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

/// Figures of an example, with the number of missed limits.
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
        // NaN misses its limit, too.
        let met = value <= limit;
        self.missed += usize::from(!met);
        println!(
            "    limit {limit:e}: {}",
            if met { "met" } else { "MISSED" }
        );
    }

    /// Number of figures that missed their limit.
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
