//! Execution of a program in a process of its own, so that its memory can be measured.

use std::process::Command;

use crate::Outcome;

/// The two numbers that this program prints with other arguments, in a process of its own.
///
/// # Errors
/// The output of the program, if it is not two numbers.
pub fn apart_from_this(arguments: &[&str]) -> Outcome<[f64; 2]> {
    let output = Command::new(std::env::current_exe()?)
        .args(arguments)
        .output()?;
    let text = String::from_utf8(output.stdout)?;
    let numbers: Vec<f64> = text
        .split_whitespace()
        .filter_map(|x| x.parse().ok())
        .collect();
    <[f64; 2]>::try_from(numbers).map_err(|_| String::from_utf8_lossy(&output.stderr).into())
}
