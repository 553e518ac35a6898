//! Texts of remarks about motions at stations.

use core::fmt::{Formatter, Result};

use powerhouse_wavefield::{StationInterpolation, StationReport};

/// What was taken from a file of stations, and how its motions are sampled.
pub(super) fn stations(
    f: &mut Formatter,
    (file, scale): (&str, f64),
    (axes, rows): (&[&str; 3], &[&str; 3]),
    report: &StationReport,
) -> Result {
    let interpolation = match report.interpolation {
        StationInterpolation::Hermite => "a cubic through displacements and velocities",
        StationInterpolation::Linear => "a straight line",
    };
    write!(
        f,
        "the motions at the {} stations of '{file}' enter around the region: coordinates along {} times {scale} m, motions along {}, {} samples from {} to {:.6} s by {} s, between them {interpolation}, wrong by about {:.1e} of the peak; peak displacement {:.4} m, peak acceleration {:.4} m/s2; {:.1} MB of memory",
        report.stations,
        axes.join(", "),
        rows.join(", "),
        report.samples,
        report.start,
        report.end,
        report.step,
        report.error,
        report.peak_displacement,
        report.peak_acceleration,
        report.bytes as f64 * 1e-6,
    )
}

/// What moves outside of the time of the motions.
pub(super) fn station_window(
    f: &mut Formatter,
    file: &str,
    [start, end]: [f64; 2],
    report: &StationReport,
) -> Result {
    write!(
        f,
        "the run is from {start} to {end} s, the motions of '{file}' are from {} to {:.6} s",
        report.start, report.end
    )?;
    if start < report.start {
        write!(
            f,
            "; before them the displacements are those of the first sample"
        )?;
    }
    if end > report.end {
        write!(
            f,
            "; after them the displacements of the last sample are held, of {:.1e} m at most, where the stations still move with {:.1e} m/s at most",
            report.end_displacement, report.end_velocity
        )?;
    }
    Ok(())
}
