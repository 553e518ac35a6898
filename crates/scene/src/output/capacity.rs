//! Section forces beside what the sections bear.

use powerhouse_io::TableColumn;
use powerhouse_observe::{HistoryTable, ObserveError, SectionCapacity, SectionGeometry};

use super::table::plot_file;
use super::{PlottedCurve, Recorder, SectionRequest, TablePlot, file_name};
use crate::{Remark, remark};

/// Greatest utilisation of a reinforced section over a run.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct SectionUse {
    /// Name of the section.
    pub section: String,
    /// What the section bears.
    pub capacity: SectionCapacity,
    /// Greatest [utilisation](SectionCapacity::utilisation) (1); infinite where no moment is borne.
    pub utilisation: f64,
    /// Time of the greatest utilisation (s).
    pub time: f64,
    /// Normal force at that time (N/m), tension positive.
    pub axial: f64,
    /// Moment at that time (N m/m).
    pub moment: f64,
    /// First time at which the utilisation is above one (s); none if it never is.
    pub beyond_from: Option<f64>,
}

/// Capacity of a requested section of a geometry; none without a reinforcement.
///
/// # Errors
/// Reinforcement outside its ranges, or of a section in several pieces.
pub(super) fn of_section(
    request: &SectionRequest,
    geometry: &SectionGeometry,
) -> Result<Option<SectionCapacity>, ObserveError> {
    let Some(reinforcement) = request.reinforcement else {
        return Ok(None);
    };
    let refused = |reason: String| ObserveError::Reinforcement {
        section: request.cut.name.clone(),
        reason,
    };
    let pieces = geometry.pieces.len();
    if pieces > 1 || super::sections::hollow(request, geometry).is_some() {
        let way_out = match request.elements {
            Some(_) => "another axis, or a centre further along it, cuts the wall alone",
            None => "a `half_extent` that takes one side gives its thickness",
        };
        return Err(refused(format!(
            "the plane cuts {pieces} piece(s) that are no single wall; {way_out}"
        )));
    }
    let capacity = SectionCapacity::new(geometry.depth, reinforcement);
    capacity
        .map(Some)
        .map_err(|error| refused(error.to_string()))
}

/// Normal forces (N/m) and moments (N m/m) of a section against time, from the table of section forces.
fn forces<'t>(table: &'t HistoryTable, section: &str) -> Option<[&'t [f64]; 2]> {
    let column = |name: &str| {
        let column = table.column(&format!("{section}.{name}"))?;
        Some(column.values.as_slice())
    };
    Some([column("axial_per_metre")?, column("moment_per_metre")?])
}

/// Points of half an interaction diagram.
const DIAGRAM: usize = 60;

/// Adds the list of the interaction diagram of a section, whose plot has the forces of the run in it.
pub(super) fn list(into: &mut Recorder, section: String, bears: SectionCapacity) {
    let name = format!("capacity/{}", file_name(&section));
    let plot = plot_file("capacity-", &section);
    into.list(name, Some(plot), move |results| {
        let line = bears.interaction(DIAGRAM);
        let borne = |axis: usize| -> Vec<f64> { line.iter().map(|point| point[axis]).collect() };
        let column = |name: &str, unit: &str, axis: usize| {
            TableColumn::new(format!("{section}.{name}"), unit, borne(axis))
        };
        let columns = vec![
            column("axial_per_metre", "N/m", 0),
            column("moment_per_metre", "N m/m", 1),
        ];
        let thousands = |values: &[f64]| -> Vec<f64> { values.iter().map(|v| 1e-3 * v).collect() };
        let curve = |name, [x, y]: [&[f64]; 2]| {
            let [x, y] = [x, y].map(thousands);
            PlottedCurve { name, x, y }
        };
        let plot = forces(results.sections(), &section).map(|of_run| TablePlot {
            title: section.clone(),
            axis: ["N, tension positive", "kN/m"],
            panels: vec![(
                ["M", "kN m/m"].map(String::from),
                vec![
                    curve("borne", [&borne(0), &borne(1)]),
                    curve("of the run", of_run),
                ],
            )],
        });
        Some((columns, plot))
    });
}

/// Greatest utilisation of each section with a capacity, by name.
pub(super) fn uses(
    table: &HistoryTable,
    capacities: &[(String, SectionCapacity)],
) -> Vec<SectionUse> {
    let use_of = |(section, capacity): &(String, SectionCapacity)| {
        let [axial, moments] = forces(table, section)?;
        let mut found: Option<SectionUse> = None;
        let mut beyond_from = None;
        for ((&axial, &moment), &time) in axial.iter().zip(moments).zip(&table.times) {
            let utilisation = capacity.utilisation(axial, moment);
            if utilisation > 1.0 {
                beyond_from.get_or_insert(time);
            }
            if found
                .as_ref()
                .is_none_or(|known| utilisation > known.utilisation)
            {
                found = Some(SectionUse {
                    section: section.clone(),
                    capacity: *capacity,
                    utilisation,
                    time,
                    axial,
                    moment,
                    beyond_from: None,
                });
            }
        }
        found.map(|found| SectionUse {
            beyond_from,
            ..found
        })
    };
    capacities.iter().filter_map(use_of).collect()
}

/// Warning about a section whose forces are beyond what it bears.
pub(super) fn beyond(of: &SectionUse) -> Option<Remark> {
    let from = of.beyond_from?;
    Some(Remark::from(remark::BeyondCapacity {
        section: of.section.clone(),
        utilisation: of.utilisation,
        from,
        time: of.time,
        axial: of.axial,
        moment: of.moment,
        borne: of.capacity.moments(of.axial),
    }))
}
