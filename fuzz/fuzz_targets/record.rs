//! Accelerograms of all formats. The first byte selects what the caller declares.
#![no_main]

use libfuzzer_sys::fuzz_target;
use powerhouse::io::{AccelerationUnit, RecordColumns, RecordOptions, parse_record};
use powerhouse_fuzz::limited;

fuzz_target!(|bytes: &[u8]| {
    let Some((&choice, text)) = bytes.split_first() else {
        return;
    };
    let mut options = RecordOptions::default();
    if choice & 1 != 0 {
        options.unit = Some(AccelerationUnit::Gravity);
    }
    if choice & 2 != 0 {
        options.step = Some(0.01);
    }
    options.channel = (choice & 4 != 0).then(|| "1".into());
    options.skip = (choice & 8 != 0).then_some(1);
    options.values_in_a_row = (choice & 16 != 0).then_some(2);
    if choice & 32 != 0 {
        let (time, acceleration) = (Some(1), 2);
        options.columns = Some(RecordColumns { time, acceleration });
    }
    match limited(text.len(), || parse_record(text, &options)) {
        Ok(record) => {
            assert!(record.samples.len() >= 2);
            assert!(record.samples.iter().all(|sample| sample.is_finite()));
            assert!(record.step > 0.0 && record.step.is_finite());
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
