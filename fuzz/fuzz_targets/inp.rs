//! Meshes of Abaqus input files.
#![no_main]

use libfuzzer_sys::fuzz_target;
use powerhouse::io::parse_inp;
use powerhouse_fuzz::limited;

fuzz_target!(|bytes: &[u8]| {
    let read = limited(bytes.len(), || parse_inp(bytes));
    match read {
        Ok(read) => {
            let mesh = &read.mesh;
            assert!(mesh.element_count() > 0, "a mesh has elements");
            let nodes = mesh.node_count() as u32;
            for element in 0..mesh.element_count() as u32 {
                let named = mesh.nodes_of(element);
                assert!(named.iter().all(|&node| node < nodes));
            }
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
