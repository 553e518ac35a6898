//! Tables of section forces around linings.

use powerhouse_io::TableColumn;
use powerhouse_observe::{HistoryTable, SectionGeometry};
use powerhouse_scene::{Results, RingRequest};

/// Forces per metre whose values around a ring are written: column, unit, quantity in plots.
pub(crate) const FORCES: [(&str, &str, &str); 3] = [
    ("axial_per_metre", "N/m", "N"),
    ("shear_per_metre", "N/m", "Q"),
    ("moment_per_metre", "N m/m", "M"),
];
/// Values of each force: at the start of the run, and the extremes over it.
pub(crate) const VALUES: [&str; 3] = ["start", "least", "greatest"];

/// Table of a ring: angle, centroid and thickness of each section, and of each force per metre the value at the start of the
/// run, the least and the greatest; utilisation where all sections have a reinforcement. None without samples.
pub(crate) fn table(ring: &RingRequest, results: &Results) -> Option<Vec<TableColumn>> {
    let geometry = |name: &str| {
        let mut all = results.section_geometry.iter();
        all.find(|section| section.name == name)
    };
    let sections: Vec<(f64, &SectionGeometry)> = (ring.sections.iter())
        .filter_map(|(angle, name)| Some((*angle, geometry(name)?)))
        .collect();
    let of = |value: fn(&SectionGeometry) -> f64| -> Vec<f64> {
        sections.iter().map(|(_, section)| value(section)).collect()
    };
    let angles = sections.iter().map(|(angle, _)| *angle).collect();
    let mut columns = vec![
        TableColumn::new("angle", "degrees", angles),
        TableColumn::new("x", "m", of(|section| section.centroid.x)),
        TableColumn::new("y", "m", of(|section| section.centroid.y)),
        TableColumn::new("z", "m", of(|section| section.centroid.z)),
        TableColumn::new("thickness", "m", of(|section| section.depth)),
    ];
    for (force, unit, _) in FORCES {
        let extremes: Option<Vec<[f64; 3]>> = (sections.iter())
            .map(|(_, section)| start_and_extremes(&results.sections, &section.name, force))
            .collect();
        let extremes = extremes?;
        for (index, value) in VALUES.iter().enumerate() {
            let values = extremes.iter().map(|of| of[index]).collect();
            columns.push(TableColumn::new(format!("{force}.{value}"), unit, values));
        }
    }
    let uses = results.section_uses();
    let utilisation: Option<Vec<f64>> = (sections.iter())
        .map(|(_, section)| {
            let mut uses = uses.iter();
            let found = uses.find(|of| of.section == section.name)?;
            Some(found.utilisation)
        })
        .collect();
    if let Some(utilisation) = utilisation {
        columns.push(TableColumn::new("utilisation", "1", utilisation));
    }
    Some(columns)
}

/// First, least and greatest value of a force of a section; none without samples.
fn start_and_extremes(table: &HistoryTable, section: &str, force: &str) -> Option<[f64; 3]> {
    let column = table.column(&format!("{section}.{force}"))?;
    let start = *column.values.first()?;
    let extremes = (column.values.iter()).fold([start; 2], |[least, most], &value| {
        [least.min(value), most.max(value)]
    });
    Some([start, extremes[0], extremes[1]])
}
