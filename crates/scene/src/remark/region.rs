//! Remarks about the region of domain reduction and motions at its stations.

use powerhouse_wavefield::{StationInterpolation, StationReport};

use super::{Item, Kind, LARGE_MISFIT};
use crate::Topic;

remark! {
    /// Fact: the free field enters through the layer around a domain reduction region.
    pub struct Region {
        /// Number of elements of the region.
        pub inside: usize,
        /// Number of elements of the layer.
        pub layer: usize,
    }
    Fact(Run),
    "the waves enter through {layer} elements around a region of {inside} elements; outside of them results are the scattered motion alone"
}

/// Fact: motions at the stations of a file enter around the region.
#[derive(Clone, Debug, PartialEq)]
pub struct Stations {
    /// Path of the file.
    pub file: String,
    /// Metres in a unit of its coordinates.
    pub scale: f64,
    /// Directions of its coordinates in the mesh.
    pub axes: [&'static str; 3],
    /// Directions of the rows of its motions.
    pub rows: [&'static str; 3],
    /// Sampling.
    pub report: StationReport,
}

impl Item for Stations {
    fn kind(&self) -> Kind {
        Kind::warning_if(self.report.error > LARGE_MISFIT, Topic::Input)
    }
    fn text(&self) -> String {
        let (file, scale, report) = (&self.file, self.scale, &self.report);
        let interpolation = match report.interpolation {
            StationInterpolation::Hermite => "a cubic through displacements and velocities",
            StationInterpolation::Linear => "a straight line",
        };
        format!(
            "the motions at the {} stations of '{file}' enter around the region: coordinates along {} times {scale} m, motions along {}, {} samples from {} to {:.6} s by {} s, between them {interpolation}, wrong by about {:.1e} of the peak; peak displacement {:.4} m, peak acceleration {:.4} m/s2; {:.1} MB of memory",
            report.stations,
            self.axes.join(", "),
            self.rows.join(", "),
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
}

/// Warning: the run goes on after the motions of a file of stations, or, a fact, begins before them.
#[derive(Clone, Debug, PartialEq)]
pub struct StationWindow {
    /// Path of the file.
    pub file: String,
    /// Start and end of the run (s).
    pub run: [f64; 2],
    /// Sampling.
    pub report: StationReport,
}

impl Item for StationWindow {
    fn kind(&self) -> Kind {
        Kind::warning_if(self.run[1] > self.report.end, Topic::Input)
    }
    fn text(&self) -> String {
        let Self { file, run, report } = self;
        let [start, end] = *run;
        let mut text = format!(
            "the run is from {start} to {end} s, the motions of '{file}' are from {} to {:.6} s",
            report.start, report.end
        );
        if start < report.start {
            text += "; before them the displacements are those of the first sample";
        }
        if end > report.end {
            text += &format!(
                "; after them the displacements of the last sample are held, of {:.1e} m at most, where the stations still move with {:.1e} m/s at most",
                report.end_displacement, report.end_velocity
            );
        }
        text
    }
}
