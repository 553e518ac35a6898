//! The report of a check.

use powerhouse::merge_messages;
use powerhouse_study::{CheckReport, Warning};
use pyo3::prelude::*;

/// Set: name, kind of members, their number, lower and upper corner (m).
type SetBox = (String, String, usize, [f64; 3], [f64; 3]);

/// Report of a check: its text and its figures.
#[pyclass(frozen, get_all, module = "powerhouse_fe._core")]
pub(crate) struct Check {
    /// The text that the command prints.
    text: String,
    /// Title of the scene.
    title: String,
    /// Number of nodes.
    nodes: usize,
    /// Number of elements.
    elements: usize,
    /// Lower and upper corner of the box of the mesh (m).
    extent: ([f64; 3], [f64; 3]),
    /// Sets: name, kind of members, their number, lower and upper corner (m).
    sets: Vec<SetBox>,
    /// Parts: name of the set, highest resolved frequency (Hz), shear wave speed (m/s), longest edge (m).
    resolution: Vec<(String, f64, f64, f64)>,
    /// Length of the shortest edge (m).
    shortest_edge: f64,
    /// Length of the longest edge (m).
    longest_edge: f64,
    /// Largest aspect ratio of an element (1).
    largest_aspect: f64,
    /// Least scaled Jacobian of an element (1).
    least_scaled_jacobian: f64,
    /// Stable time step (s).
    stable_step: f64,
    /// Number of the element that limits the stable step, in the mesh file.
    limiting_element: u64,
    /// Name of the set of this element.
    limiting_set: String,
    /// Time step of the run (s).
    step: f64,
    /// Number of time steps.
    steps: u64,
    /// Predicted wall time of the dynamic run (s).
    wall_time: f64,
    /// Predicted peak memory (bytes).
    memory: u64,
    /// Upper bound of the size of the result files (bytes).
    output: u64,
    /// Changes that save most, as text.
    savings: Vec<String>,
    /// Facts about the composition of the scene.
    remarks: Vec<String>,
    /// Warnings about the accuracy of the results.
    warnings: Vec<String>,
}

impl Check {
    pub(crate) fn new(report: &CheckReport) -> Self {
        let corner = |at: &powerhouse::model::Vec3| [at.x, at.y, at.z];
        let sets = report.sets.iter().map(|set| {
            let of = set.of.to_owned();
            (
                set.set.clone(),
                of,
                set.count,
                corner(&set.low),
                corner(&set.high),
            )
        });
        let resolution = report.resolution.iter().map(|part| {
            (
                part.set.clone(),
                part.frequency,
                part.s_speed,
                part.longest_edge,
            )
        });
        let facts = report.remarks.iter().filter(|remark| !remark.is_warning());
        let warnings = merge_messages(report.warnings.iter().map(Warning::message));
        Self {
            text: report.to_string(),
            title: report.title.clone(),
            nodes: report.nodes,
            elements: report.elements,
            extent: (corner(&report.extent.0), corner(&report.extent.1)),
            sets: sets.collect(),
            resolution: resolution.collect(),
            shortest_edge: report.quality.shortest_edge,
            longest_edge: report.quality.longest_edge,
            largest_aspect: report.quality.largest_aspect,
            least_scaled_jacobian: report.quality.least_scaled_jacobian,
            stable_step: report.stable.step,
            limiting_element: report.stable.element,
            limiting_set: report.stable.set.clone(),
            step: report.cost.step,
            steps: report.cost.steps,
            wall_time: report.cost.wall_time.as_secs_f64(),
            memory: report.cost.memory,
            output: report.cost.output,
            savings: report.savings.iter().map(ToString::to_string).collect(),
            remarks: facts.map(ToString::to_string).collect(),
            warnings: warnings.into_iter().map(|warning| warning.text).collect(),
        }
    }
}
