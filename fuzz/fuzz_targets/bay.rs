//! Files of bays (TOML), for which meshes are generated.
#![no_main]

use libfuzzer_sys::fuzz_target;
use powerhouse_fuzz::limited;
use powerhouse_wang_2019::bay::Bay;

fuzz_target!(|bytes: &[u8]| {
    let Ok(text) = str::from_utf8(bytes) else {
        return;
    };
    match limited(bytes.len(), || Bay::from_toml(text, "bay.toml")) {
        Ok(bay) => assert!(bay.check().is_ok()),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
