//! Tables on disk while a run goes on.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use powerhouse_io::{GrowingColumn, GrowingTable};
use powerhouse_observe::HistoryTable;

use powerhouse_scene::{TableForm, TableSink};

/// Tables of a run on disk while it goes on: from time to time the rows since the last time are appended, so that a run
/// that is killed leaves what it computed until then. At the end of a run its files are written anew, completely.
///
/// A row that cannot be written, on a full disk, ends no run: it is written with those after it, or at the end.
#[derive(Debug)]
pub struct RunningTables {
    folder: PathBuf,
    tables: BTreeMap<String, GrowingTable>,
    every: Duration,
    last: Instant,
}

impl RunningTables {
    /// Wall time between two looks at what is new.
    pub const EVERY: Duration = Duration::from_secs(20);

    /// Tables of a results folder.
    pub(crate) fn new(folder: &Path) -> Self {
        Self {
            folder: folder.into(),
            tables: BTreeMap::new(),
            every: Self::EVERY,
            last: Instant::now(),
        }
    }

    /// Sets the wall time between two looks at what is new; zero looks after every step.
    #[must_use]
    pub fn with_interval(mut self, every: Duration) -> Self {
        self.every = every;
        self
    }
}

impl TableSink for RunningTables {
    fn is_due(&mut self) -> bool {
        let is_due = self.last.elapsed() >= self.every;
        if is_due {
            self.last = Instant::now();
        }
        is_due
    }
    fn take(&mut self, form: &TableForm, rows: &HistoryTable) {
        let file = form.file();
        let path = self.folder.join(&file);
        let table = self.tables.entry(file);
        let table = table.or_insert_with(|| GrowingTable::new(path));
        // Tried again the next time; the files of the end name what is wrong.
        let _ = table.append(&columns(rows));
    }
}

/// Columns of a table of histories, times first.
fn columns(table: &HistoryTable) -> Vec<GrowingColumn<'_>> {
    let times = GrowingColumn {
        name: "time",
        unit: "s",
        values: &table.times,
    };
    let columns = table.columns.iter().map(|column| GrowingColumn {
        name: &column.name,
        unit: column.unit,
        values: &column.values,
    });
    core::iter::once(times).chain(columns).collect()
}
