//! Damaged files.

use powerhouse_io::parse_gmsh;

use super::sample::{FORMATS, Random, Sample};

/// A file truncated at any byte is refused, or gives the same mesh as the complete one.
#[test]
fn a_cut_file_is_never_another_mesh() {
    let sample = Sample::tower();
    let mesh = sample.mesh();
    for format in FORMATS {
        let file = sample.file(format);
        for length in 0..file.len() {
            if let Ok(read) = parse_gmsh(&file[..length]) {
                assert_eq!(read.mesh, mesh, "{format:?} cut at {length}");
                assert!(length + 1 >= file.len(), "{format:?} cut at {length}");
            }
        }
    }
}

/// A file with changed bytes is refused or gives a valid mesh; nothing panics.
#[test]
fn changed_bytes_never_panic() {
    let mut random = Random(1);
    let mut read = 0;
    for format in FORMATS {
        let file = Sample::tower().file(format);
        for round in 0..4_000 {
            let mut changed = file.clone();
            for _ in 0..1 + round % 3 {
                let at = random.below(changed.len());
                let any = random.bits() as u8;
                changed[at] = match random.below(3) {
                    0 => any,
                    1 => changed[at] ^ (1 << (any % 8)),
                    _ => b"0123456789 \n$-.e\xff"[any as usize % 17],
                };
            }
            if let Ok(mesh) = parse_gmsh(&changed) {
                read += 1;
                assert!(mesh.mesh.check().is_ok());
            }
        }
    }
    // Coordinates may change without a trace, so some are read.
    assert!(read > 0);
}

/// A file with passages lost, doubled or moved is refused or gives a valid mesh; nothing panics.
#[test]
fn moved_passages_never_panic() {
    let mut random = Random(2);
    for format in FORMATS {
        let file = Sample::tower().file(format);
        for _ in 0..1_000 {
            let mut ends = [random.below(file.len()), random.below(file.len())];
            ends.sort_unstable();
            let [start, end] = ends;
            let target = random.below(file.len());
            let mut changed = file.clone();
            match random.below(3) {
                0 => drop(changed.drain(start..end)),
                1 => drop(changed.splice(target..target, file[start..end].iter().copied())),
                _ => {
                    let passage: Vec<u8> = changed.drain(start..end).collect();
                    let target = target.min(changed.len());
                    changed.splice(target..target, passage);
                }
            }
            if let Ok(mesh) = parse_gmsh(&changed) {
                assert!(mesh.mesh.check().is_ok());
            }
        }
    }
}
