//! Records from files.

use powerhouse_io::{AccelerationUnit, CountRule, RecordOptions, read_record};
use powerhouse_wavefield::TimeHistory;

use crate::fault::{Fault, SceneText};
use crate::format::{Count, Positive, Record, Units};

/// Reads a record's file; what was taken differently from what it declares comes beside it.
pub(super) fn read(text: &SceneText, table: &Record) -> Result<(TimeHistory, Vec<String>), Fault> {
    let path = text.folder().join(&*table.file);
    let options = RecordOptions {
        unit: table.units.map(|units| match units {
            Units::MetrePerSecondSquared => AccelerationUnit::MetrePerSecondSquared,
            Units::CentimetrePerSecondSquared => AccelerationUnit::Gal,
            Units::Gravity => AccelerationUnit::Gravity,
        }),
        step: table.time_step.map(Positive::get),
        count: match table.count {
            Count::AsDeclared => CountRule::AsDeclared,
            Count::AsFound => CountRule::AsFound,
        },
    };
    let place = table.file.span();
    let record =
        read_record(&path, &options).map_err(|error| Fault::refused(place.clone(), error))?;
    let history = TimeHistory::new(record.step, record.samples)
        .map_err(|error| Fault::refused(place, error))?;
    Ok((history, record.warnings))
}
