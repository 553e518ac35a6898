//! Tables of a scene file from which waves come.

use super::draft::Draft;
use core::ops::Range;
use std::collections::BTreeMap;

use super::ground::component;
use super::record::PreparedRecord;
use crate::spans::NOT_AT_REST;
use crate::spec::{At, Wave};
use powerhouse_scene::{Error, Fault};

/// Table from which a wave comes: a `[[wave]]`, or a `[[motion]]` of which it is a part.
#[derive(Clone)]
pub(super) struct Origin<'r> {
    /// Byte range of its incidence.
    pub(super) incidence: Range<usize>,
    /// Byte ranges of its arrival and of its reference point, as far as they are given.
    pub(super) times: [Option<Range<usize>>; 2],
    /// Whether the time of its arrival was given, or is that of a wave by default.
    pub(super) is_timed: bool,
    /// Lead of its record (s).
    pub(super) lead: f64,
    /// Name of its record, and the record or its largest component.
    pub(super) record: Option<(String, &'r PreparedRecord)>,
}

impl<'r> Origin<'r> {
    pub(super) fn of_wave(
        table: &Wave,
        records: &'r BTreeMap<String, PreparedRecord>,
    ) -> Result<Self, Fault> {
        let record = match &table.record {
            Some(name) => {
                let record = component(name, table.component.as_ref(), records)?;
                Some((name.to_string(), record))
            }
            None => None,
        };
        Ok(Self {
            incidence: table.incidence.span(),
            times: [
                table.arrival.as_ref().map(At::span),
                table.reference.as_ref().map(At::span),
            ],
            is_timed: true,
            lead: record.as_ref().map_or(0.0, |(_, record)| record.lead),
            record,
        })
    }

    /// Fault of a wave that arrives before the start of the run.
    pub(super) fn early(&self, wave: &str, level: f64, scene: &Draft) -> Fault {
        let span = self.times.iter().flatten().next().cloned();
        let error = Error::NotAtRest {
            field: wave.into(),
            level,
            time: scene.start,
        };
        Fault::refused(span.unwrap_or(scene.places.start.clone()), error).with_help(NOT_AT_REST)
    }
}
