//! Extremes of section forces, by which cases are compared.

use powerhouse::Results;
use powerhouse::engine::observe::HistoryTable;
use serde::{Deserialize, Serialize};

use super::Peak;

/// Least and greatest forces per metre of a section over the dynamic run, those of the stages included; of a ring over all
/// its sections. The peaks have the names of their sections.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SectionExtremes {
    /// Name of the section or ring.
    pub name: String,
    /// Least and greatest normal force (N/m, tension positive).
    pub axial: [Peak; 2],
    /// Least and greatest shear force (N/m).
    pub shear: [Peak; 2],
    /// Least and greatest bending moment (N m/m).
    pub moment: [Peak; 2],
    /// Greatest utilisation by its reinforcement (1); `None` without one.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub utilisation: Option<Utilisation>,
    /// The same of each section of a ring; empty for a section.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub around: Vec<SectionExtremes>,
}

/// Utilisation of a reinforced section, of which a number may be unknown.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Utilisation {
    /// Moment over the moment that is borne with the normal force (1).
    Of(f64),
    /// No moment is borne with the normal force.
    Beyond,
}

impl Utilisation {
    /// Its number (1); infinite if no moment is borne.
    pub fn value(self) -> f64 {
        match self {
            Self::Of(value) => value,
            Self::Beyond => f64::INFINITY,
        }
    }
}

/// Extremes of the sections of a run: of each ring, and of each section that is of none. Sections without forces per metre are
/// left out.
pub(super) fn of(results: &Results) -> Vec<SectionExtremes> {
    let table = results.sections();
    let rings = results.section_rings.iter().map(|ring| {
        let sections = ring.sections.iter().map(|(_, name)| name.as_str());
        (ring.name.as_str(), sections.collect::<Vec<_>>())
    });
    let of_ring = |name: &str| {
        let mut all = results.section_rings.iter().flat_map(|ring| &ring.sections);
        all.any(|(_, section)| section == name)
    };
    let others = (results.section_geometry.iter())
        .map(|section| section.name.as_str())
        .filter(|name| !of_ring(name))
        .map(|name| (name, vec![name]));
    let uses = results.section_uses();
    let utilisation = |sections: &[&str]| {
        let own = uses.iter().filter(|of| sections.contains(&&*of.section));
        let greatest = own.map(|of| of.utilisation).reduce(f64::max)?;
        Some(if greatest.is_finite() {
            Utilisation::Of(greatest)
        } else {
            Utilisation::Beyond
        })
    };
    let of = |name: &str, sections: &[&str]| {
        Some(SectionExtremes {
            name: name.into(),
            axial: extremes(table, sections, "axial_per_metre")?,
            shear: extremes(table, sections, "shear_per_metre")?,
            moment: extremes(table, sections, "moment_per_metre")?,
            utilisation: utilisation(sections),
            around: Vec::new(),
        })
    };
    let rings = rings.filter_map(|(name, sections)| {
        let single = sections
            .iter()
            .filter_map(|section| of(section, &[section]));
        let around = single.collect();
        Some(SectionExtremes {
            around,
            ..of(name, &sections)?
        })
    });
    let others = others.filter_map(|(name, sections)| of(name, &sections));
    rings.chain(others).collect()
}

/// Least and greatest value of a force among some sections; `None` without one.
fn extremes(table: &HistoryTable, sections: &[&str], force: &str) -> Option<[Peak; 2]> {
    let samples = sections.iter().flat_map(|section| {
        let column = table.column(&format!("{section}.{force}"));
        let values = column.map_or(&[][..], |column| &column.values);
        let values = values.iter().zip(&table.times);
        values.map(|(&value, &time)| Peak {
            name: (*section).into(),
            value,
            time,
        })
    });
    let by_value = |a: &Peak, b: &Peak| a.value.total_cmp(&b.value);
    let least = samples.clone().min_by(by_value)?;
    Some([least, samples.max_by(by_value)?])
}
