//! The set of records of a sweep: its motions, and what is made of its cases.

use std::collections::BTreeMap;
use std::fs;

use powerhouse::io::write_summary;
use powerhouse::model::ModelError;
use powerhouse::spec::{FragilityCurve, RecordCase};
use powerhouse::wavefield::{DesignSpectrum, TimeHistory};
use powerhouse::{Registry, SceneFile};

use super::processes::SharedFolder;
use super::{SetSpectra, SetStatistics, Sweep};
use crate::StudyError;

/// Name of the statistics of a set of records in the folder of the sweep.
pub const STATISTICS: &str = "statistics.json";
/// Names of their tables: fractiles, envelopes of section forces.
const TABLES: [&str; 2] = ["statistics.csv", "envelopes.csv"];
/// Damping ratio of the oscillators by which the intensity of a record is measured.
const DAMPING: f64 = 0.05;

/// Components of a record by the ends of their names: none of a record of one component, `.x` and so on of others.
type Components = BTreeMap<String, TimeHistory>;

/// Record of the set at its greatest scale.
struct SetRecord {
    scale: f64,
    components: Components,
    /// Intensity by the measure of each curve (m/s2).
    intensities: Vec<f64>,
}

/// The set of records of a sweep.
pub(super) struct SweepSet {
    name: String,
    curves: Vec<FragilityCurve>,
    /// Its cases, record by record, from the least scale to the greatest.
    cases: Vec<RecordCase>,
    /// Records by their names.
    records: BTreeMap<String, SetRecord>,
    /// Spectrum to which they are brought, with the band of periods (s).
    target: Option<(DesignSpectrum, [f64; 2])>,
}

impl SweepSet {
    /// The set of a scene file, each record of which is read and processed once; `None` without a set.
    ///
    /// # Errors
    /// A record that cannot be read or processed, or does not end at rest, so that its cases would fail; a period of a curve that is
    /// too short for a record.
    pub(super) fn of(file: &SceneFile, registry: &Registry) -> Result<Option<Self>, StudyError> {
        let cases = file.record_cases();
        let scene = file.spec(None)?;
        let Some(set) = scene.record_sets.first() else {
            return Ok(None);
        };
        let (name, curves) = (set.name.to_string(), set.fragility.clone());
        let mut records = BTreeMap::new();
        let mut target = None;
        for (index, case) in cases.iter().enumerate() {
            let next = cases.get(index + 1);
            if next.is_some_and(|next| next.record == case.record) {
                continue;
            }
            let scene = file.spec(Some(&case.case))?;
            if target.is_none() {
                target = scene.target_spectrum(&name)?;
            }
            let all = scene.processed_records(registry)?;
            let own = all.into_iter().filter_map(|(record, history)| {
                Some((part_of(&name, &record)?.to_owned(), history))
            });
            let components: Components = own.collect();
            let intensities = curves.iter().map(|curve| intensity(&components, curve));
            let record = SetRecord {
                scale: case.scale,
                intensities: intensities.collect::<Result<_, _>>()?,
                components,
            };
            records.insert(case.record.clone(), record);
        }
        Ok(Some(Self {
            name,
            curves,
            cases: cases.to_vec(),
            records,
            target,
        }))
    }

    /// Whether a record, or a component of one, is that of the set.
    pub(super) fn has(&self, record: &str) -> bool {
        part_of(&self.name, record).is_some()
    }
    /// All records with their components at their greatest scale, by names.
    pub(super) fn histories(&self) -> impl Iterator<Item = (String, TimeHistory)> {
        self.records.iter().flat_map(|(name, record)| {
            let of = record.components.iter();
            of.map(move |(part, history)| (format!("{name}{part}"), history.clone()))
        })
    }
    /// Response spectra of its records.
    fn spectra(&self) -> Result<SetSpectra, StudyError> {
        let records = self
            .records
            .iter()
            .map(|(name, record)| (name.as_str(), record.scale, horizontal(&record.components)));
        SetSpectra::of(records, self.target.as_ref())
    }
    /// Intensity of the scaled record of a case by the measure of a curve (m/s2).
    fn intensity(&self, case: &RecordCase, curve: usize) -> Option<f64> {
        let record = self.records.get(&case.record)?;
        Some(case.scale / record.scale * record.intensities[curve])
    }
}

/// End of the name of a record, or of a component of one, behind the name of its set; `None` for another record.
fn part_of<'n>(set: &str, record: &'n str) -> Option<&'n str> {
    let part = record.strip_prefix(set)?;
    (part.is_empty() || part.starts_with('.')).then_some(part)
}

/// Horizontal components of a record; of one component that one.
fn horizontal(components: &Components) -> Vec<&TimeHistory> {
    let is_horizontal = |part: &str| components.len() == 1 || part != ".z";
    let all = components.iter();
    let horizontal = all.filter(|(part, _)| is_horizontal(part));
    horizontal.map(|(_, history)| history).collect()
}

/// Intensity of a record by the measure of a curve (m/s2): of two horizontal components the geometric mean.
fn intensity(components: &Components, curve: &FragilityCurve) -> Result<f64, StudyError> {
    let measured = horizontal(components).into_iter();
    let measured = measured.map(|history| match curve.period {
        None => Ok(history.report().peak_acceleration),
        Some(period) => {
            let spectrum = history.response_spectrum(DAMPING, &[period.get()]);
            let refused = |error| powerhouse::Error::from(ModelError::from(error));
            Ok(spectrum.map_err(refused)?[0].pseudo_acceleration())
        }
    });
    let measured: Vec<f64> = measured.collect::<Result<_, StudyError>>()?;
    let product: f64 = measured.iter().product();
    Ok(product.powf(1.0 / measured.len() as f64))
}

impl Sweep {
    /// Statistics of the finished cases of the set of records in the folder of the sweep; `None` of a scene without one.
    ///
    /// # Errors
    /// An outcome that cannot be read.
    pub fn statistics(&self) -> Result<Option<SetStatistics>, StudyError> {
        let Some(set) = &self.set else {
            return Ok(None);
        };
        let outcomes = self.finished_outcomes()?;
        let intensity = |case: &RecordCase, curve: usize| set.intensity(case, curve);
        let of = (set.name.as_str(), &set.curves[..]);
        let spectra = set.spectra()?;
        let found = SetStatistics::of(of, Some(spectra), &set.cases, &outcomes, intensity);
        Ok(Some(found))
    }

    /// Writes the statistics of the set of records, or removes those of a set that the scene had before.
    pub(super) fn write_statistics(&self, shared: &SharedFolder) -> Result<(), StudyError> {
        let files = [STATISTICS, TABLES[0], TABLES[1]].map(|name| self.folder.join(name));
        if self.set.is_none() {
            // There are none of most sweeps.
            files.iter().for_each(|file| drop(fs::remove_file(file)));
            return Ok(());
        }
        if !shared.is_there() {
            return Ok(());
        }
        let _lock = shared.files()?;
        let Some(found) = self.statistics()? else {
            return Ok(());
        };
        let [json, figures, envelopes] = files;
        write_summary(&json, &found).map_err(powerhouse::Error::from)?;
        found.write_figures(&figures)?;
        found.write_envelopes(&envelopes)
    }
}
