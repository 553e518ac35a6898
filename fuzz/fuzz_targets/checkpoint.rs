//! Checkpoint files, and the encoded state of a body in them.
#![no_main]

use libfuzzer_sys::fuzz_target;
use powerhouse::io::parse_sections;
use powerhouse::model::{State, decode};
use powerhouse_fuzz::limited;

fuzz_target!(|bytes: &[u8]| {
    let file = limited(bytes.len(), || {
        parse_sections(bytes, ("checkpoint of a run", 3))
    });
    if let Err(fault) = file {
        assert!(!fault.to_string().is_empty());
    }
    // What follows in a section is read without a checksum here.
    let state = limited(bytes.len(), || decode::<State>(bytes));
    if let Err(error) = state {
        assert!(!error.to_string().is_empty());
    }
});
