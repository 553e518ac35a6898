//! Section forces around linings.

use powerhouse_io::TableColumn;
use powerhouse_model::{Mesh, ModelError};
use powerhouse_observe::{HistoryTable, SectionGeometry, SectionReinforcement, SectionRing};

use super::table::plot_file;
use super::{OutputPlan, PlottedCurve, Recorder, Results, SectionRequest, TablePlot, file_name};
use crate::{Remark, remark};

/// Request for the sections around a lining, whose forces are written and drawn against their angles as well.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct RingRequest {
    /// Name of the ring, of its table and of its plot.
    pub name: String,
    /// Angles of the sections (degrees) and their names among the requests for sections, in the order of the angles; the
    /// largest gap of a ring that is not closed lies before the first, whose angle may be negative.
    pub sections: Vec<(f64, String)>,
    /// Number of rays.
    pub rays: usize,
}

/// Forces per metre whose values around a ring are written: column, unit, quantity in plots.
const FORCES: [(&str, &str, &str); 3] = [
    ("axial_per_metre", "N/m", "N"),
    ("shear_per_metre", "N/m", "Q"),
    ("moment_per_metre", "N m/m", "M"),
];
/// Values of each force: at the start of the run, and the extremes over it.
const VALUES: [&str; 3] = ["start", "least", "greatest"];

impl RingRequest {
    /// Adds the list of its forces.
    pub(super) fn list(&self, into: &mut Recorder) {
        let name = format!("rings/{}", file_name(&self.name));
        let (file, ring) = (plot_file("ring-", &self.name), self.clone());
        into.list(name, Some(file), move |results| {
            let columns = ring.columns(results)?;
            let plot = plot(&ring.name, &columns);
            Some((columns, plot))
        });
    }
    /// Angle, centroid and thickness of each section, and of each force per metre the value at the start of the run, the least and
    /// the greatest; utilisation where all sections have a reinforcement. None without samples.
    fn columns(&self, results: &Results) -> Option<Vec<TableColumn>> {
        let geometry = |name: &str| {
            let mut all = results.section_geometry.iter();
            all.find(|section| section.name == name)
        };
        let sections: Vec<(f64, &SectionGeometry)> = (self.sections.iter())
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
                .map(|(_, section)| start_and_extremes(results.sections(), &section.name, force))
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
    /// Warning about rays that meet no element.
    pub(super) fn partial(&self) -> Option<Remark> {
        let missed = self.rays - self.sections.len();
        let step = 360.0 / self.rays as f64;
        let ray_of = |angle: &f64| ((angle / step).round() as isize).rem_euclid(self.rays as isize);
        let met: Vec<isize> = self.sections.iter().map(|(of, _)| ray_of(of)).collect();
        let mut none = (0..self.rays).filter(|ray| !met.contains(&(*ray as isize)));
        let first = none.next()?;
        let last = none.next_back().unwrap_or(first);
        Some(Remark::from(remark::PartialRing {
            ring: self.name.clone(),
            missed: [missed, self.rays],
            angles: [first, last].map(|ray| step * ray as f64),
        }))
    }
}

/// Plot of the forces of a ring against the angle; a closed ring ends where it began.
fn plot(name: &str, columns: &[TableColumn]) -> Option<TablePlot> {
    let (angles, columns) = columns.split_first()?;
    let is_closed = angles.values.windows(2).all(|pair| {
        let step = 360.0 / angles.values.len() as f64;
        (pair[1] - pair[0] - step).abs() < 1e-6
    });
    let around = |values: &[f64], factor: f64, turn: f64| -> Vec<f64> {
        let end = values.first().filter(|_| is_closed).map(|v| v + turn);
        let all = values.iter().copied().chain(end);
        all.map(|v| factor * v).collect()
    };
    let x = around(&angles.values, 1.0, 360.0);
    let panels = FORCES.map(|(force, unit, quantity)| {
        let curves = VALUES.map(|value| {
            let name = format!("{force}.{value}");
            let column = columns.iter().find(|column| column.name == name);
            PlottedCurve {
                name: value,
                x: x.clone(),
                y: around(column.map_or(&[], |column| &column.values), 1e-3, 0.0),
            }
        });
        ([quantity.into(), format!("k{unit}")], curves.into())
    });
    Some(TablePlot {
        title: name.into(),
        axis: ["angle", "degrees"],
        panels: panels.into(),
    })
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

/// Sections in the order of their angles from behind the largest gap between two of them.
fn from_gap(mut sections: Vec<(f64, String)>) -> Vec<(f64, String)> {
    let count = sections.len();
    let gap = |index: usize| {
        let before = sections[(index + count - 1) % count].0;
        (sections[index].0 - before).rem_euclid(360.0)
    };
    // Of equal gaps, as of a closed ring, the one before upward.
    let mut first = 0;
    for index in 1..count {
        if gap(index) > gap(first) + 1e-6 {
            first = index;
        }
    }
    sections.rotate_left(first);
    if first > 0 {
        for (angle, _) in &mut sections[..count - first] {
            *angle -= 360.0;
        }
    }
    sections
}

impl OutputPlan {
    /// Adds the forces of sections around the lining of an element set, with a reinforcement if one is given.
    ///
    /// # Errors
    /// A set that is not in the mesh; those of [`SectionRing::sections`].
    pub fn ring(
        mut self,
        mesh: &Mesh,
        set: &str,
        ring: &SectionRing,
        reinforcement: Option<SectionReinforcement>,
    ) -> Result<Self, ModelError> {
        let mut sections = Vec::new();
        for of_ring in ring.sections(mesh, mesh.element_set(set)?)? {
            sections.push((of_ring.angle, of_ring.section.name.clone()));
            let mut request = SectionRequest::new(set, of_ring.section);
            request.elements = Some(of_ring.elements);
            request.reinforcement = reinforcement;
            self.cuts.push(request);
        }
        self.rings.push(RingRequest {
            name: ring.name.clone(),
            sections: from_gap(sections),
            rays: ring.rays,
        });
        Ok(self)
    }
}
