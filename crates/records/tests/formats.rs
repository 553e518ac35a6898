//! Accelerograms in many layouts, valid and damaged.

use std::path::Path;

use powerhouse_records::{
    AccelerationUnit, CountRule, LengthRule, Record, RecordError, RecordFault, RecordOptions,
    common_length, parse_record, read_record,
};

const AT2: &str = "PEER NGA STRONG MOTION DATABASE RECORD\n\
    Imperial Valley-02, 5/19/1940, El Centro Array #9, 180\n\
    ACCELERATION TIME SERIES IN UNITS OF G\n\
    NPTS=   7, DT=   .0100 SEC,\n\
    \x20 .1000000E-01 -.2000000E-01  .3000000E-01  .4000000E-01 -.5000000E-01\n\
    \x20 .6000000E-01 -.7000000E-01\n";

const G: f64 = 9.80665;

fn parse(text: &str) -> Result<Record, RecordError> {
    parse_record(text.as_bytes(), &RecordOptions::default())
}

fn in_unit(text: &str, unit: AccelerationUnit) -> Result<Record, RecordError> {
    let options = RecordOptions {
        unit: Some(unit),
        ..RecordOptions::default()
    };
    parse_record(text.as_bytes(), &options)
}

fn fault(result: Result<Record, RecordError>) -> (usize, RecordFault) {
    match result {
        Err(RecordError::Content { line, fault, .. }) => (line, fault),
        other => panic!("{other:?}"),
    }
}

/// Every known layout of the header gives the same record.
#[test]
fn at2_layouts() {
    let expected = parse(AT2).unwrap();
    assert_eq!(expected.step, 0.01);
    assert_eq!(expected.samples.len(), 7);
    assert!((expected.samples[1] + 0.02 * G).abs() < 1e-15);
    assert!(expected.title.contains("El Centro Array #9"));
    let line = "NPTS=   7, DT=   .0100 SEC,";
    for variant in [
        "NPTS=7, DT=.0100 SEC",
        "NPTS=7, DT=.0100SEC",
        "NPTS= 7, dt= .01",
        "npts=7,dt=0.01 sec",
        "   7    0.0100    NPTS, DT",
        "NPTS=  7, DT= 1.0D-02 SEC",
    ] {
        let record = parse(&AT2.replace(line, variant));
        assert_eq!(
            record.unwrap_or_else(|e| panic!("{variant}: {e}")),
            expected,
            "{variant}"
        );
    }
    // The count may be on line 7, lines may end in CR LF, numbers may touch, words may follow.
    let later = AT2.replace("ACCELERATION TIME", "a\nb\nc\nACCELERATION TIME");
    assert_eq!(parse(&later).unwrap().samples, expected.samples);
    assert_eq!(parse(&AT2.replace('\n', "\r\n")).unwrap(), expected);
    assert_eq!(parse(&AT2.replace("E-01 -.", "E-01-.")).unwrap(), expected);
    assert_eq!(parse(&format!("{AT2}END OF FILE\n")).unwrap(), expected);
    // The title may hold bytes that are not UTF-8.
    let bytes = AT2.replace("Valley", "Vall\u{e9}e").into_bytes();
    let latin: Vec<u8> = bytes.into_iter().filter(|byte| *byte != 0xc3).collect();
    assert_eq!(
        parse_record(&latin, &RecordOptions::default())
            .unwrap()
            .samples,
        expected.samples
    );
}

/// A count that disagrees is an error, or by choice a warning; a huge one costs no memory.
#[test]
fn wrong_counts() {
    for (count, declared) in [("8", 8), ("6", 6), ("18446744073709551615", u64::MAX)] {
        let text = AT2.replace("NPTS=   7", &format!("NPTS= {count}"));
        assert_eq!(
            fault(parse(&text)),
            (4, RecordFault::Count { declared, found: 7 })
        );
        let options = RecordOptions {
            count: CountRule::AsFound,
            ..RecordOptions::default()
        };
        let record = parse_record(text.as_bytes(), &options).unwrap();
        assert_eq!((record.samples.len(), record.warnings.len()), (7, 1));
    }
    for count in ["-3", "1e3x", "99999999999999999999999"] {
        let text = AT2.replace("NPTS=   7", &format!("NPTS= {count}"));
        assert!(matches!(fault(parse(&text)).0, 4), "{count}");
    }
}

/// Faults are named with line and column.
#[test]
fn damaged_at2() {
    let nan = fault(parse(&AT2.replace(".3000000E-01", "NaN")));
    assert!(matches!(nan, (5, RecordFault::NotFinite { .. })), "{nan:?}");
    let word = fault(parse(&AT2.replace(" .6000000E-01", "oops")));
    assert!(
        matches!(word, (6, RecordFault::NotANumber { .. })),
        "{word:?}"
    );
    for step in ["0", "-.01", "1e999"] {
        let text = AT2.replace(".0100", step);
        assert_eq!(fault(parse(&text)).0, 4, "{step}");
    }
    assert_eq!(
        fault(parse(&AT2.replace(", DT=   .0100 SEC", ""))).1,
        RecordFault::Header { what: "DT" }
    );
    let no_unit = AT2.replace("IN UNITS OF G", "");
    assert_eq!(fault(parse(&no_unit)).1, RecordFault::NoUnit);
    assert!(in_unit(&no_unit, AccelerationUnit::Gal).is_ok());
    let conflict = fault(in_unit(AT2, AccelerationUnit::Gal)).1;
    assert_eq!(
        conflict,
        RecordFault::UnitConflict {
            found: "g",
            declared: "cm/s2"
        }
    );
}

/// One and two columns with any separator, header and comments give the same samples.
#[test]
fn columns_of_text() {
    let expected = vec![1.0, -2.0, 0.5];
    let unit = AccelerationUnit::MetrePerSecondSquared;
    for text in [
        "0 1\n0.5 -2\n1.0 0.5\n",
        "# a comment\ntime,acceleration\n0,1\n0.5,-2\n\n1.0,0.5",
        "t;a\r\n0;1\r\n0.5;-2\r\n1.0;0.5\r\n",
        "0\t1\t% note\n.5\t-2D0\n1\t5E-1\n",
    ] {
        let record = in_unit(text, unit).unwrap_or_else(|e| panic!("{text:?}: {e}"));
        assert_eq!(
            (record.samples, record.step),
            (expected.clone(), 0.5),
            "{text:?}"
        );
    }
    let options = RecordOptions {
        unit: Some(unit),
        step: Some(0.5),
        ..RecordOptions::default()
    };
    assert_eq!(
        parse_record(b"1\n-2\n0.5\n", &options).unwrap().samples,
        expected
    );
}

/// Faults in columns are named with their line.
#[test]
fn damaged_columns() {
    let si = AccelerationUnit::MetrePerSecondSquared;
    let line_of = |text: &str| fault(in_unit(text, si));
    assert!(matches!(
        line_of("0 1\n0.5 2\n1.2 3\n"),
        (2, RecordFault::NotUniform { .. })
    ));
    assert!(matches!(
        line_of("0 1\n0.5\n"),
        (
            2,
            RecordFault::RowLength {
                found: 1,
                expected: 2
            }
        )
    ));
    assert!(matches!(
        line_of("0 1 2\n"),
        (1, RecordFault::Layout { width: 3, .. })
    ));
    assert!(matches!(
        line_of("0 1\n0.5 1.0-2.0\n"),
        (2, RecordFault::NotANumber { .. })
    ));
    assert!(matches!(
        line_of("0 1\n0.5 inf\n"),
        (2, RecordFault::NotFinite { .. })
    ));
    assert!(matches!(
        line_of("1 1\n0.5 2\n"),
        (2, RecordFault::Step { .. })
    ));
    assert_eq!(line_of("1\n2\n").1, RecordFault::NoStep);
    assert_eq!(line_of("").1, RecordFault::Empty);
    assert_eq!(
        line_of("# nothing\n\n").1,
        RecordFault::TooShort { found: 0 }
    );
    assert_eq!(line_of("0 1\n").1, RecordFault::TooShort { found: 1 });
    assert_eq!(fault(parse("0 1\n1 2\n")).1, RecordFault::NoUnit);
}

/// The record of the project is read completely.
#[test]
fn el_centro() {
    let file =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/records/el_centro_1940_ns.csv");
    let unit = Some(AccelerationUnit::MetrePerSecondSquared);
    let record = read_record(
        &file,
        &RecordOptions {
            unit,
            ..RecordOptions::default()
        },
    )
    .unwrap();
    assert_eq!((record.samples.len(), record.step), (1560, 0.02));
    let peak = record
        .samples
        .iter()
        .fold(0.0_f64, |peak, a| peak.max(a.abs()));
    assert!((peak - 3.1266).abs() < 1e-4);
    assert!(record.title.contains("Imperial Valley"));
}

/// A file that is missing is named.
#[test]
fn a_missing_file_is_named() {
    let error =
        read_record(Path::new("no/such/record.at2"), &RecordOptions::default()).unwrap_err();
    assert!(error.to_string().contains("record.at2"));
}

/// Components are brought to a common length, and must have the same step.
#[test]
fn components_of_unequal_length() {
    let record = |count: usize, step: f64| Record {
        step,
        samples: vec![1.0; count],
        ..Record::default()
    };
    let mut cut = [record(5, 0.01), record(3, 0.01), record(4, 0.01)];
    common_length(&mut cut, LengthRule::Cut).unwrap();
    assert!(cut.iter().all(|r| r.samples.len() == 3));
    let mut padded = [record(5, 0.01), record(3, 0.01)];
    common_length(&mut padded, LengthRule::Pad).unwrap();
    assert_eq!(padded[1].samples, [1.0, 1.0, 1.0, 0.0, 0.0]);
    assert_eq!((padded[0].warnings.len(), padded[1].warnings.len()), (0, 1));
    assert!(common_length(&mut [record(5, 0.01), record(5, 0.02)], LengthRule::Cut).is_err());
}

/// No truncation and no change of a byte makes the reader panic.
#[test]
fn damaged_bytes_never_panic() {
    let columns = "time,acc\n0.00,0.1\n0.02,-0.2\n0.04,0.3\n";
    let mut seed = 0x2545_f491_4f6c_dd1d_u64;
    let mut random = || {
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        seed
    };
    for text in [AT2, columns] {
        let unit = (text == columns).then_some(AccelerationUnit::Gal);
        let options = RecordOptions {
            unit,
            ..RecordOptions::default()
        };
        for end in 0..text.len() {
            if let Ok(record) = parse_record(&text.as_bytes()[..end], &options) {
                assert!(record.samples.len() >= 2);
            }
        }
        for _ in 0..20_000 {
            let mut bytes = text.as_bytes().to_vec();
            for _ in 0..1 + random() % 3 {
                let place = random() as usize % bytes.len();
                bytes[place] = random() as u8;
            }
            if let Ok(record) = parse_record(&bytes, &options) {
                assert!(record.step > 0.0 && record.samples.iter().all(|a| a.is_finite()));
            }
        }
    }
}

/// A unit that names or comments above columns declare is compared with that of the caller: another is
/// refused, the same or none is accepted.
#[test]
fn units_above_columns_are_compared_with_the_declared_one() {
    use AccelerationUnit::{Gal, Gravity, MetrePerSecondSquared};
    let rows = "0,1\n0.01,2\n0.02,1\n";
    for (above, unit, line) in [
        ("time [s],acceleration [g]", Gravity, 1),
        ("t (s), a (m/s^2)", MetrePerSecondSquared, 1),
        ("# a title\n# units: s, cm/s2 (from g)", Gal, 2),
        ("# Acceleration in (g)\ntime,a", Gravity, 1),
    ] {
        let text = format!("{above}\n{rows}");
        for declared in [Gal, Gravity, MetrePerSecondSquared] {
            match in_unit(&text, declared) {
                Ok(record) => {
                    assert_eq!(declared, unit, "{above}");
                    assert_eq!(record.samples[1], 2.0 * unit.factor(), "{above}");
                }
                Err(error) => {
                    assert_ne!(declared, unit, "{above}: {error}");
                    let (found, declared) = (unit.name(), declared.name());
                    let expected = RecordFault::UnitConflict { found, declared };
                    assert!(
                        matches!(&error, RecordError::Content { line: at, fault, .. } if *at == line && *fault == expected),
                        "{above}: {error}"
                    );
                }
            }
        }
        let alone = parse(&text).unwrap();
        assert_eq!(alone.samples[1], 2.0 * unit.factor(), "{above}");
    }
    // Words that only resemble a declaration declare nothing.
    let text = format!("# United States, station G (component A)\n{rows}");
    assert!(parse(&text).is_err());
}
