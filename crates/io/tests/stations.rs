//! Motions of stations in tables (CSV).

use std::path::PathBuf;

use powerhouse_io::{StationForm, StationMotions, TableColumn, read_station_motions, write_table};

const PLENTY: u64 = 1 << 30;

fn path(name: &str) -> PathBuf {
    std::env::temp_dir().join(format!("powerhouse-stations-{}-{name}", std::process::id()))
}

/// Two stations of three samples.
fn columns() -> Vec<TableColumn> {
    let column =
        |name: &str, unit: &str, values: [f64; 6]| TableColumn::new(name, unit, values.to_vec());
    let mut columns = vec![
        column("x", "km", [0.0, 0.0, 0.0, 0.005, 0.005, 0.005]),
        column("y", "m", [1.0; 6]),
        column("z", "m", [-2.0; 6]),
        column("inner", "1", [1.0, 1.0, 1.0, 0.0, 0.0, 0.0]),
        column("time", "s", [0.5, 0.75, 1.0, 0.5, 0.75, 1.0]),
    ];
    for (axis, name) in ["ux", "uy", "uz"].into_iter().enumerate() {
        let number = |row: usize| (10 * row + axis) as f64;
        columns.push(column(name, "cm", [0, 1, 2, 3, 4, 5].map(number)));
    }
    columns
}

fn read(name: &str, columns: &[TableColumn], most: u64) -> Result<StationMotions, String> {
    let path = path(name);
    write_table(&path, columns).unwrap();
    let read = read_station_motions(&path, most).map_err(|error| error.to_string());
    std::fs::remove_file(path).unwrap();
    read
}

/// A table has its stations and motions, in metres whatever its units.
#[test]
fn a_table_is_read_in_its_units() {
    let found = read("units.csv", &columns(), PLENTY).unwrap();
    assert_eq!(found.form, StationForm::Table);
    assert_eq!(found.positions, [[0.0, 1.0, -2.0], [5.0, 1.0, -2.0]]);
    assert_eq!(found.inner, [true, false]);
    assert_eq!((found.start, found.step, found.samples), (0.5, 0.25, 3));
    assert!(!found.has_velocity);
    let expected = (0..6).flat_map(|row| [0, 1, 2].map(|axis| f64::from(10 * row + axis)));
    for (found, expected) in found.motion.iter().zip(expected) {
        assert!((found - 0.01 * expected).abs() < 1e-12);
    }
    let mut with_velocity = columns();
    for name in ["vx", "vy", "vz"] {
        with_velocity.push(TableColumn::new(name, "m/s", vec![7.0; 6]));
    }
    let found = read("velocity.csv", &with_velocity, PLENTY).unwrap();
    assert!(found.has_velocity && found.motion.len() == 36);
    assert_eq!(&found.motion[3..6], [7.0; 3]);
}

/// What is no table of motions is an error with the row and the reason.
#[test]
fn tables_that_do_not_fit_are_refused() {
    type Change = fn(&mut Vec<TableColumn>);
    let changes: [(Change, &str); 11] = [
        (
            |c| c[1].unit = "ft".into(),
            "no column 'y' in [m] or [km]; the columns are x [km], y [ft]",
        ),
        (|c| c[5].unit = "m/s2".into(), "no column 'ux'"),
        (|c| drop(c.remove(3)), "no column 'inner'"),
        (|c| c[3].values[4] = 1.0, "row 5 below the header: sample 1"),
        (|c| c[3].values[..3].fill(2.0), "inner = 2"),
        (
            |c| c[4].values[4] = 0.8,
            "row 5 below the header: time 0.8 s is not the expected 0.75 s",
        ),
        (|c| c[4].values.fill(1.0), "do not rise"),
        (|c| c[0].values[1] = 0.005, "needs two samples"),
        (
            |c| c.iter_mut().for_each(|c| c.values.truncate(5)),
            "the last station has 2 rows, the first one 3",
        ),
        (
            |c| c.iter_mut().for_each(|c| c.values.truncate(1)),
            "two samples of a station",
        ),
        (
            |c| c.push(TableColumn::new("vx", "m/s", vec![0.0; 6])),
            "no column 'vy'",
        ),
    ];
    for (change, wanted) in changes {
        let mut changed = columns();
        change(&mut changed);
        let text = read("bad.csv", &changed, PLENTY).unwrap_err();
        assert!(text.contains(wanted), "{wanted}: {text}");
    }
}

/// A table that would need more memory than it may take is refused by its size.
#[test]
fn a_large_table_is_refused_before_it_is_read() {
    let text = read("large.csv", &columns(), 1000).unwrap_err();
    assert!(text.contains("more than the permitted 100"), "{text}");
}

/// A program without the reader of H5DRM files says how to compile it in.
#[cfg(not(feature = "h5drm"))]
#[test]
fn a_program_without_the_reader_says_how_to_get_it() {
    for name in ["a.h5drm", "a.H5DRM", "a.hdf5"] {
        let text = read_station_motions(&path(name), PLENTY)
            .unwrap_err()
            .to_string();
        assert!(text.contains("--features h5drm"), "{text}");
    }
}
