//! Tables of results (CSV).
#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use powerhouse::io::parse_table;
use powerhouse_fuzz::limited;

fuzz_target!(|bytes: &[u8]| {
    match limited(bytes.len(), || parse_table(bytes, Path::new("table.csv"))) {
        Ok(columns) => {
            let rows = columns[0].values.len();
            assert!(columns.iter().all(|column| column.values.len() == rows));
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
