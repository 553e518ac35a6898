//! Memory of a process, and execution of the program in a process of its own.

use std::process::Command;

use crate::Outcome;

/// Peak memory of this process (bytes), where the system reports it.
#[must_use]
pub fn most_memory() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kilobytes: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(1024.0 * kilobytes)
}

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
