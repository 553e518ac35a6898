//! Rare layouts and faults of accelerograms.

use powerhouse_records::{
    AccelerationUnit, CountRule, Record, RecordError, RecordFault, RecordOptions, parse_record,
};

fn si() -> RecordOptions {
    RecordOptions {
        unit: Some(AccelerationUnit::MetrePerSecondSquared),
        ..RecordOptions::default()
    }
}

fn at2(unit_line: &str, rows: &str) -> String {
    format!("A COLLECTION\nA QUAKE, A STATION\n{unit_line}\nNPTS= 4, DT= .01 SEC\n{rows}")
}

fn place(result: Result<Record, RecordError>) -> (usize, usize, RecordFault) {
    match result {
        Err(RecordError::Content {
            line,
            column,
            fault,
            ..
        }) => (line, column, fault),
        other => panic!("{other:?}"),
    }
}

/// A unit is read in front of a full stop, and in the spellings that headers use.
#[test]
fn units_are_read_as_headers_spell_them() {
    let g = AccelerationUnit::Gravity.factor();
    for (words, factor) in [
        ("IN UNITS OF G. FILTER POINTS: HP=0.1 Hz LP=40.0 Hz", g),
        ("in units of g", g),
        ("IN UNITS OF CM/SEC/SEC", 0.01),
        ("IN UNITS OF CM/S**2", 0.01),
        ("IN UNITS OF M/SEC^2.", 1.0),
    ] {
        let text = at2(&format!("ACCELERATION {words}"), "1 2 3 4\n");
        let record = parse_record(text.as_bytes(), &RecordOptions::default());
        let record = record.unwrap_or_else(|error| panic!("{words}: {error}"));
        assert_eq!(record.samples[3], 4.0 * factor, "{words}");
    }
}

/// Velocities are never read as accelerations, whatever the caller declares.
#[test]
fn a_file_of_velocities_is_refused() {
    let text = at2("VELOCITY TIME SERIES IN UNITS OF CM/S", "1 2 3 4\n");
    for options in [RecordOptions::default(), si()] {
        let (line, _, fault) = place(parse_record(text.as_bytes(), &options));
        assert_eq!(line, 3, "{fault}");
        assert!(fault.to_string().contains("CM/S"), "{fault}");
    }
}

/// An exponent of three digits, which Fortran writes without a letter, is not a separate number.
#[test]
fn an_exponent_without_letter_is_read() {
    let text = at2("UNITS OF G", ".1-101 .2 -.3-102-.4\n");
    let record = parse_record(text.as_bytes(), &RecordOptions::default()).unwrap();
    let g = AccelerationUnit::Gravity.factor();
    let expected = [0.1e-101, 0.2, -0.3e-102, -0.4].map(|value| value * g);
    assert_eq!(record.samples, expected);
}

/// Numbers that touch without a sign between them are refused, never guessed.
#[test]
fn numbers_without_a_separator_are_refused() {
    for rows in ["0.12E-020.34E-03 .5 .6", "0.123.456 .5 .6"] {
        let text = at2("UNITS OF G", rows);
        let (line, column, _) = place(parse_record(text.as_bytes(), &RecordOptions::default()));
        assert_eq!((line, column), (5, 1), "{rows}");
    }
}

/// A trailer does not prevent a record with too few samples from being read as found.
#[test]
fn a_short_record_with_a_trailer_is_read_as_found() {
    let text = at2("UNITS OF G", ".1 .2 .3\nEND OF RECORD\n");
    let found = RecordOptions {
        count: CountRule::AsFound,
        ..RecordOptions::default()
    };
    let record = parse_record(text.as_bytes(), &found).unwrap();
    assert_eq!(record.samples.len(), 3);
    assert!(record.warnings.iter().any(|warning| warning.contains('4')));
    // Words between samples are damage, not a trailer.
    let text = at2("UNITS OF G", ".1 .2\nEND OF RECORD\n.3\n");
    assert_eq!(place(parse_record(text.as_bytes(), &found)).0, 6);
}

/// A UTF-8 byte order mark, old line ends and the end-of-file mark of old systems change nothing.
#[test]
fn encodings_of_text_change_nothing() {
    let plain = at2("UNITS OF G", ".1 .2 .3 .4\n");
    let expected = parse_record(plain.as_bytes(), &RecordOptions::default()).unwrap();
    for text in [
        format!("\u{feff}{plain}"),
        format!("{plain}\u{1a}"),
        plain.replace('\n', "\r"),
    ] {
        let record = parse_record(text.as_bytes(), &RecordOptions::default());
        assert_eq!(record.unwrap().samples, expected.samples, "{text:?}");
    }
    let columns = "0.0,1.0\n0.1,2.0\n0.2,3.0\n";
    for text in [
        format!("\u{feff}{columns}"),
        format!("{columns}\u{1a}\n"),
        columns.replace('\n', "\r"),
    ] {
        let record = parse_record(text.as_bytes(), &si());
        assert_eq!(record.unwrap().samples, [1.0, 2.0, 3.0], "{text:?}");
    }
}

/// A gap in a time column is named where it is, not where the mean step first fails.
#[test]
fn a_gap_is_named_where_it_is() {
    for (missing, line) in [(700, 701), (1, 2), (1498, 1499)] {
        let rows = (0..1500).filter(|&row| row != missing);
        let text: String = rows
            .map(|row| format!("{:.2} 1.0\n", 0.02 * f64::from(row)))
            .collect();
        let (at, column, fault) = place(parse_record(text.as_bytes(), &si()));
        assert_eq!((at, column), (line, 1), "{fault}");
        assert!(matches!(fault, RecordFault::NotUniform { .. }), "{fault}");
    }
}

/// A step that is declared for a time column must reproduce its last instant, too.
#[test]
fn a_declared_step_fits_the_whole_time_column() {
    let text: String = (0..1500)
        .map(|row| format!("{:.2} 1.0\n", 0.02 * f64::from(row)))
        .collect();
    for (step, fits) in [(0.02, true), (0.019_9, false), (0.020_001, false)] {
        let options = RecordOptions {
            step: Some(step),
            ..si()
        };
        match parse_record(text.as_bytes(), &options) {
            Ok(record) => assert!(fits && record.step == step),
            Err(error) => assert!(!fits, "{error}"),
        }
    }
}

/// A single column of decimal commas is not read as two columns.
#[test]
fn decimal_commas_are_not_separators() {
    let text = "0,10\n0,20\n0,30\n";
    assert!(parse_record(text.as_bytes(), &si()).is_err());
    let options = RecordOptions {
        step: Some(0.5),
        ..si()
    };
    let record = parse_record(text.as_bytes(), &options).unwrap();
    assert_eq!(record.samples, [0.1, 0.2, 0.3]);
    // Whole seconds and whole accelerations are two columns.
    let record = parse_record(b"0,10\n1,20\n2,30\n", &si()).unwrap();
    assert_eq!((record.samples, record.step), (vec![10.0, 20.0, 30.0], 1.0));
}

/// An empty cell is a missing sample, not a doubled separator.
#[test]
fn an_empty_cell_is_refused() {
    for text in ["0.0,1.0\n0.1,\n0.2,3.0\n", "0.0;1.0\n;2.0\n0.2;3.0\n"] {
        assert_eq!(place(parse_record(text.as_bytes(), &si())).0, 2, "{text:?}");
    }
}
