//! H5DRM files: two writers' forms, damage, endless sizes, limits of memory.

use std::path::{Path, PathBuf};

use powerhouse_io::{StationFileFault, StationForm, StationMotions, read_station_motions};

const PLENTY: u64 = 1 << 30;

fn sample(name: &str) -> PathBuf {
    let data = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/motions");
    Path::new(data).join(name)
}

fn read(name: &str) -> StationMotions {
    read_station_motions(&sample(name), PLENTY).unwrap()
}

/// Reads changed bytes, as a file.
fn read_bytes(name: &str, bytes: &[u8]) -> Result<StationMotions, StationFileFault> {
    let path = format!("powerhouse-h5drm-{}-{name}.h5drm", std::process::id());
    let path = std::env::temp_dir().join(path);
    std::fs::write(&path, bytes).unwrap();
    let read = read_station_motions(&path, PLENTY);
    std::fs::remove_file(&path).unwrap();
    read.map_err(|error| {
        assert_eq!(error.file, path);
        error.fault
    })
}

/// The sample with one number in the place of another, wherever that is.
fn changed(old: &[u8], new: &[u8]) -> Vec<u8> {
    let mut bytes = std::fs::read(sample("two_layer_sv15.h5drm")).unwrap();
    let places = bytes.windows(old.len()).enumerate();
    let places: Vec<usize> = (places.filter(|(_, window)| *window == old))
        .map(|(place, _)| place)
        .collect();
    assert!(!places.is_empty(), "{old:?} is nowhere");
    for place in places {
        bytes[place..place + new.len()].copy_from_slice(new);
    }
    bytes
}

/// A compressed file has its stations, sides and motions, as another program (h5py) reads them.
#[test]
fn a_compressed_file_is_read() {
    let found = read("two_layer_sv15.h5drm");
    assert_eq!(found.form, StationForm::H5drm);
    assert_eq!((found.positions.len(), found.samples), (156, 300));
    assert_eq!((found.step, found.start), (0.01, 0.0));
    assert_eq!(found.positions[1], [-0.0075, -0.01, 0.005]);
    assert!(found.has_velocity && found.warnings.is_empty());
    assert_eq!(found.motion.len(), 156 * 300 * 6);
    // The peaks of the three rows of displacement.
    let peak = |first: usize| {
        let numbers = found.motion.iter().skip(first).step_by(6);
        numbers.fold(0.0_f64, |most, x| most.max(x.abs()))
    };
    assert_eq!(
        [0, 1, 2].map(peak),
        [4.325057476118744, 0.0, 0.6120946660127037]
    );
    // 5 x 4 x 3 nodes of a region of 4 x 3 x 2 elements, without the 3 x 2 x 2 within it.
    assert_eq!(found.inner.iter().filter(|inner| **inner).count(), 48);
    assert_eq!(found.other_order, None);
}

/// The rows of another writer (single precision, not compressed, flags as numbers, stations in another order, rows of vertical,
/// east, north) are those of the same motions, and their order is found by the control point.
#[test]
fn another_writers_file_is_read() {
    let (found, sample) = (
        read("two_layer_sv15_other_writer.h5drm"),
        read("two_layer_sv15.h5drm"),
    );
    assert_eq!(found.positions, sample.positions);
    assert_eq!(found.inner, sample.inner);
    assert_eq!(found.other_order, Some([1, 2, 0]));
    assert!(!found.has_velocity);
    let pairs = found.motion.chunks(3).zip(sample.motion.chunks(6));
    for (vertical_east_north, east_north_vertical) in pairs {
        for (row, other) in [2, 0, 1].into_iter().enumerate() {
            assert!((vertical_east_north[row] - east_north_vertical[other]).abs() < 1e-6);
        }
    }
}

/// An HDF5 file of another program is named as one.
#[test]
fn a_file_of_another_program_is_named() {
    let other = changed(b"DRM_Data", b"SW4_Data");
    let error = read_bytes("other", &other).unwrap_err().to_string();
    assert!(error.contains("no H5DRM file"), "{error}");
}

/// Numbers out of their ranges are errors with their object.
#[test]
fn numbers_out_of_range_are_named() {
    let dt = 0.01_f64.to_le_bytes();
    for (name, step) in [("zero", 0.0), ("negative", -0.01), ("nan", f64::NAN)] {
        let text = read_bytes(name, &changed(&dt, &step.to_le_bytes()))
            .unwrap_err()
            .to_string();
        assert!(text.contains("/DRM_Metadata/dt = "), "{text}");
    }
    let rows: Vec<u8> = [0_i32, 3, 6, 9]
        .into_iter()
        .flat_map(i32::to_le_bytes)
        .collect();
    let past: Vec<u8> = [0_i32, 466, 6, 9]
        .into_iter()
        .flat_map(i32::to_le_bytes)
        .collect();
    let text = read_bytes("rows", &changed(&rows, &past))
        .unwrap_err()
        .to_string();
    assert!(text.contains("data_location = 466 at index 1"), "{text}");
    let tend = changed(&2.99_f64.to_le_bytes(), &4.0_f64.to_le_bytes());
    let warnings = read_bytes("end", &tend).unwrap().warnings;
    assert!(warnings[0].contains("tend = 4 s"), "{warnings:?}");
}

/// A file that claims more than it can hold, or more than the memory that it may take, is refused before that is taken.
#[test]
fn endless_sizes_are_refused() {
    let lengths = |a: u64, b: u64| [a.to_le_bytes(), b.to_le_bytes()].concat();
    let fault = read_bytes(
        "endless",
        &changed(&lengths(468, 300), &lengths(1 << 58, 300)),
    );
    let text = fault.unwrap_err().to_string();
    assert!(text.contains("/DRM_Data/displacement"), "{text}");
    let fault = read_bytes("stations", &changed(&lengths(156, 3), &lengths(1 << 40, 3)));
    let text = fault.unwrap_err().to_string();
    assert!(text.contains("/DRM_Data/xyz"), "{text}");
    let path = sample("two_layer_sv15.h5drm");
    let needed = 156 * 300 * 6 * 8;
    let error = read_station_motions(&path, needed - 1).unwrap_err();
    assert!(matches!(error.fault, StationFileFault::Memory { needed: n, .. } if n == needed));
    assert!(read_station_motions(&path, needed).is_ok());
}

/// A truncated file is an error, a file with wrong bytes an error or motions of finite numbers; neither ends the program.
#[test]
fn damaged_files_are_errors() {
    let bytes = std::fs::read(sample("two_layer_sv15.h5drm")).unwrap();
    for length in [
        0,
        1,
        8,
        96,
        1000,
        4096,
        100_000,
        bytes.len() / 2,
        bytes.len() - 100,
    ] {
        let fault = read_bytes("short", &bytes[..length]);
        assert!(fault.is_err(), "{length}");
    }
    let mut state = 88_172_645_463_325_252_u64;
    let mut random = move |below: usize| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state as usize % below
    };
    let mut refused = 0;
    for _ in 0..500 {
        let mut damaged = bytes.clone();
        for _ in 0..4 {
            let place = random(20_000);
            damaged[place] = [0, 0xff, random(256) as u8][random(3)];
        }
        match read_bytes("damaged", &damaged) {
            Err(_) => refused += 1,
            Ok(found) => assert!(found.motion.iter().all(|number| number.is_finite())),
        }
    }
    assert!(refused > 100, "{refused} of 500");
    let text = read_bytes("text", b"x [m],y [m]\n")
        .unwrap_err()
        .to_string();
    assert!(text.starts_with("the file: "), "{text}");
}
