//! Accelerograms in plain text of many shapes, and what their titles declare.

use powerhouse_records::{
    AccelerationUnit, Record, RecordColumns, RecordError, RecordFault, RecordOptions, parse_record,
};

fn value(index: usize) -> f64 {
    (0.37 * index as f64).sin() * 0.3 * (index as f64 * 0.05).min(1.0)
}

fn rows(count: usize, row: impl Fn(usize, f64) -> String) -> String {
    (0..count)
        .map(|index| row(index, value(index)) + "\n")
        .collect()
}

fn in_g() -> RecordOptions {
    RecordOptions {
        unit: Some(AccelerationUnit::Gravity),
        ..RecordOptions::default()
    }
}

fn parse(text: &str, options: &RecordOptions) -> Result<Record, RecordError> {
    parse_record(text.as_bytes(), options)
}

fn fault(text: &str, options: &RecordOptions) -> (usize, RecordFault) {
    match parse(text, options) {
        Err(RecordError::Content { line, fault, .. }) => (line, fault),
        other => panic!("{text:.80}: {other:?}"),
    }
}

/// Checks count, step, unit and every sample to six decimals.
fn check(
    name: &str,
    text: &str,
    options: &RecordOptions,
    (count, step): (usize, f64),
    factor: f64,
) {
    let record = parse(text, options).unwrap_or_else(|error| panic!("{name}: {error}"));
    assert_eq!((record.samples.len(), record.step), (count, step), "{name}");
    for (index, sample) in record.samples.iter().enumerate() {
        let expected = value(index) * factor;
        assert!(
            (sample - expected).abs() <= 0.51e-6 * factor,
            "{name}: {index}: {sample} {expected}"
        );
    }
}

/// A header that names another unit than the caller, or another quantity, is refused at its line, however it spells
/// it; the same unit is accepted, and alone it is taken.
#[test]
fn headers_that_contradict_the_caller_are_refused() {
    let g = AccelerationUnit::Gravity.factor();
    let body = rows(60, |i, v| format!("{:.2},{v:.6}", 0.01 * i as f64));
    for (unit, factor) in [
        ("(m/s²)", 1.0),
        ("(m.s-2)", 1.0),
        ("[m s-2]", 1.0),
        ("(m s^-2)", 1.0),
        ("(m/s/s)", 1.0),
        ("[cm/sec^2]", 0.01),
        ("(Gal)", 0.01),
        ("(mm/s2)", 0.001),
        ("(%g)", 0.01 * g),
        ("(mg)", 0.001 * g),
        ("[g]", g),
    ] {
        let text = format!("Time (s),Acceleration {unit}\n{body}");
        check(unit, &text, &RecordOptions::default(), (60, 0.01), factor);
        match (factor == g, parse(&text, &in_g())) {
            (true, Ok(_)) => {}
            (false, Err(RecordError::Content { line: 1, fault, .. })) => {
                assert!(
                    matches!(fault, RecordFault::UnitConflict { .. }),
                    "{unit}: {fault}"
                );
            }
            (_, other) => panic!("{unit}: {other:?}"),
        }
    }
    for (name, factor) in [
        ("accel_m_s2", 1.0),
        ("acc_cm_s2", 0.01),
        ("acc_g", g),
        ("a_gal", 0.01),
    ] {
        check(
            name,
            &format!("t,{name}\n{body}"),
            &RecordOptions::default(),
            (60, 0.01),
            factor,
        );
    }
    for other in [
        "Time [sec],Velocity [cm/sec]",
        "Time,Displacement [m]",
        "t;vel",
        "t (s),u (cm)",
        "t (s),v (m.s-1)",
        "t (s),v (m s-1)",
    ] {
        let (line, fault) = fault(&format!("{other}\n{body}"), &in_g());
        assert!(
            line == 1 && matches!(fault, RecordFault::Quantity { .. }),
            "{other}: {fault}"
        );
    }
    let (line, unknown) = fault(&format!("Time,Acceleration (furlong/s2)\n{body}"), &in_g());
    assert!(
        line == 1 && matches!(unknown, RecordFault::UnknownUnit { .. }),
        "{unknown}"
    );
    // Brackets of other words declare nothing.
    check(
        "component",
        &format!("Time,Acc (N-S)\n{body}"),
        &in_g(),
        (60, 0.01),
        g,
    );
    check(
        "title",
        &format!("# Baseline (velocity, 2nd order)\n{body}"),
        &in_g(),
        (60, 0.01),
        g,
    );
}

/// A number of samples or a step in front of the samples is recognised where it is certain, and else refused with the
/// key that answers; it never becomes a sample.
#[test]
fn a_count_or_step_in_front_is_no_sample() {
    let g = AccelerationUnit::Gravity.factor();
    let step = |step| RecordOptions {
        step: Some(step),
        ..in_g()
    };
    let one = rows(400, |_, v| format!("{v:.6}"));
    let exponents = rows(400, |_, v| format!("{:.6e}", 1e-6 * v));
    let two = rows(400, |i, v| format!("{:.2} {v:.6}", 0.01 * i as f64));
    let wrapped: String = (0..50)
        .map(|row| {
            (0..8)
                .map(|i| format!(" {:9.6}", value(8 * row + i)))
                .collect::<String>()
                + "\n"
        })
        .collect();
    check("count", &format!("400\n{one}"), &step(0.01), (400, 0.01), g);
    check("step", &format!("0.01\n{one}"), &step(0.01), (400, 0.01), g);
    check(
        "both before one",
        &format!("m1\n400 0.0100\n{one}"),
        &in_g(),
        (400, 0.01),
        g,
    );
    check(
        "both before two",
        &format!("400 0.01\n{two}"),
        &in_g(),
        (400, 0.01),
        g,
    );
    check(
        "both before eight",
        &format!("400 0.01\n{wrapped}"),
        &in_g(),
        (400, 0.01),
        g,
    );
    for (text, options) in [
        (format!("0.02\n{one}"), step(0.01)),
        (format!("2.000000e-02\n{exponents}"), in_g()),
        (format!("399\n{one}"), step(0.01)),
        (format!("401 0.01\n{one}"), in_g()),
        (format!("401 0.01\n{wrapped}"), in_g()),
    ] {
        let (line, fault) = fault(&text, &options);
        let message = fault.to_string();
        assert!(
            line == 1 && matches!(fault, RecordFault::Leader { .. }),
            "{text:.20}: {message}"
        );
        assert!(
            message.contains("`skip`") && message.contains(text.lines().nth(1).unwrap()),
            "{message}"
        );
    }
    // The answers: leave the line out, or take it as a sample.
    let skipped = |skip| RecordOptions {
        skip: Some(skip),
        ..step(0.01)
    };
    check(
        "skip 1",
        &format!("0.02\n{one}"),
        &skipped(1),
        (400, 0.01),
        g,
    );
    let all = parse(&format!("0.02\n{one}"), &skipped(0)).unwrap();
    assert_eq!((all.samples.len(), all.samples[0]), (401, 0.02 * g));
    // A record that starts with motion, or with an integer, is a record.
    let moving = rows(400, |i, _| format!("{:.4}", 0.03 + 0.01 * (i as f64).sin()));
    assert_eq!(parse(&moving, &step(0.01)).unwrap().samples.len(), 400);
}

/// A step in a comment or a title is taken, and must agree with that of the caller and of the times.
#[test]
fn a_step_in_a_title_is_compared() {
    let g = AccelerationUnit::Gravity.factor();
    let one = rows(100, |_, v| format!("{v:.6}"));
    let two = rows(100, |i, v| format!("{:.3} {v:.6}", 0.005 * i as f64));
    for title in [
        "# dt = 0.005 s, acceleration in g",
        "Time Step: 0.005",
        "#DELTA: 0.005",
        "% sampling interval (s): 5.0e-3",
        "Some record, DT=.005SEC",
        "dt=5 ms",
        "# Sampling rate: 200 Hz",
        "sampling frequency (Hz) = 200",
    ] {
        let text = format!("{title}\n{one}");
        check(title, &text, &in_g(), (100, 0.005), g);
        for (wrong, line) in [(0.01, 1), (0.0051, 1)] {
            let options = RecordOptions {
                step: Some(wrong),
                ..in_g()
            };
            let (at, fault) = fault(&text, &options);
            let expected = RecordFault::StepConflict {
                found: 0.005,
                declared: wrong,
            };
            assert_eq!((at, fault), (line, expected), "{title}");
        }
        check(title, &format!("{title}\n{two}"), &in_g(), (100, 0.005), g);
    }
    let (line, conflict) = fault(&format!("dt = 0.01\n{two}"), &in_g());
    assert!(
        line == 1 && matches!(conflict, RecordFault::StepConflict { .. }),
        "{conflict}"
    );
    // A step of few digits agrees with the one that it rounds.
    let rounded = format!("#DELTA: 0.0133\n{one}");
    let options = RecordOptions {
        step: Some(1.0 / 75.0),
        ..in_g()
    };
    assert_eq!(parse(&rounded, &options).unwrap().step, 1.0 / 75.0);
    // Words that only contain such a key declare nothing.
    let width = format!("# width 3 in 12, deltas 5\n{one}");
    assert_eq!(fault(&width, &in_g()).1, RecordFault::NoStep);
}

/// Titles, named columns, decimal commas, quotes, wrapped rows and words at the end give the same samples.
#[test]
fn shapes_of_text_give_the_same_samples() {
    let g = AccelerationUnit::Gravity.factor();
    let time = |i: usize| 0.01 * i as f64;
    let comma = |text: String| text.replace('.', ",");
    let step = RecordOptions {
        step: Some(0.01),
        ..in_g()
    };
    let eight = RecordOptions {
        values_in_a_row: Some(8),
        ..step.clone()
    };
    let five = RecordOptions {
        values_in_a_row: Some(5),
        ..in_g()
    };
    let wrapped: String = (0..203)
        .map(|i| {
            format!(
                " {:9.6}{}",
                value(i),
                if i % 8 == 7 || i == 202 { "\n" } else { "" }
            )
        })
        .collect();
    let pairs: String = (0..203)
        .map(|i| {
            format!(
                " {:7.3} {:9.6}{}",
                time(i),
                value(i),
                if i % 5 == 4 || i == 202 { "\n" } else { "" }
            )
        })
        .collect();
    let chosen = RecordOptions {
        columns: Some(RecordColumns {
            time: Some(1),
            acceleration: 3,
        }),
        ..in_g()
    };
    let alone = RecordOptions {
        columns: Some(RecordColumns {
            time: None,
            acceleration: 3,
        }),
        ..step.clone()
    };
    let three = rows(203, |i, v| format!("{:.2} 7 {v:.6}", time(i)));
    let two = rows(203, |i, v| format!("{:.2} {v:.6}", time(i)));
    for (name, text, options) in [
        (
            "titles",
            format!("El Centro 1940\nNS component\nTime Acc\n{two}"),
            in_g(),
        ),
        (
            "skipped title",
            format!("1940 El Centro\n{two}"),
            RecordOptions {
                skip: Some(1),
                ..in_g()
            },
        ),
        (
            "decimal commas, semicolons",
            comma(rows(203, |i, v| format!("{:.2};{v:.6}", time(i)))),
            in_g(),
        ),
        (
            "decimal commas, tabs",
            comma(rows(203, |i, v| format!("{:.2}\t{v:.6}", time(i)))),
            in_g(),
        ),
        ("decimal commas, blanks", comma(two.clone()), in_g()),
        (
            "decimal commas, one column",
            comma(rows(203, |_, v| format!("{v:.6}"))),
            step.clone(),
        ),
        (
            "decimal commas, names",
            format!(
                "Zeit;a\n{}",
                comma(rows(203, |i, v| format!("{:.2};{v:.6}", time(i))))
            ),
            in_g(),
        ),
        (
            "quotes",
            format!(
                "\"Time\",\"Acc\"\n{}",
                rows(203, |i, v| format!("\"{:.2}\",\"{v:.6}\"", time(i)))
            ),
            in_g(),
        ),
        (
            "named columns",
            format!(
                "Time [sec]\tAcceleration [g]\tVelocity [cm/sec]\tDisplacement [cm]\n{}",
                rows(203, |i, v| format!("{:.2}\t{v:.6}\t5\t6", time(i)))
            ),
            RecordOptions::default(),
        ),
        (
            "named columns, blanks",
            format!(
                "Displ (m)  Time (s)  Acc (g)\n{}",
                rows(203, |i, v| format!("5 {:.2} {v:.6}", time(i)))
            ),
            RecordOptions::default(),
        ),
        ("wrapped", wrapped.clone(), eight.clone()),
        (
            "wrapped, words at the end",
            format!("{wrapped}*** End Data ***\n"),
            eight,
        ),
        ("wrapped pairs", pairs.clone(), five),
        ("wrapped pairs, recognised", pairs, in_g()),
        ("chosen columns", three.clone(), chosen),
        ("chosen column", three.clone(), alone),
        (
            "acceleration before time",
            rows(203, |i, v| format!("{v:.6} {:.2}", time(i))),
            in_g(),
        ),
    ] {
        check(name, &text, &options, (203, 0.01), g);
        let crlf = text.replace('\n', "\r\n");
        check(name, &format!("\u{feff}{crlf}"), &options, (203, 0.01), g);
    }
}

/// What is not certain is refused with the first lines of the file and the key that answers.
#[test]
fn what_is_not_certain_is_refused_with_the_key() {
    let eight = "0.1 0.2 0.3 0.4 0.5 0.6 0.7 0.8\n".repeat(4);
    let message = fault(&eight, &in_g()).1.to_string();
    for part in ["values_in_a_row = 8", "columns =", "0.1 0.2 0.3 0.4"] {
        assert!(message.contains(part), "{part}: {message}");
    }
    let (line, title) = fault("1940 El Centro\n0 1\n1 2\n", &in_g());
    assert!(line == 1 && title.to_string().contains("`skip`"), "{title}");
    let columns = |time, acceleration| RecordOptions {
        columns: Some(RecordColumns { time, acceleration }),
        ..in_g()
    };
    for (time, acceleration, column) in [(Some(1), 9, 9), (Some(0), 2, 0), (None, 0, 0)] {
        let (_, fault) = fault(&eight, &columns(time, acceleration));
        assert_eq!(fault, RecordFault::NoSuchColumn { column, width: 8 });
    }
    let seven = RecordOptions {
        values_in_a_row: Some(7),
        ..in_g()
    };
    assert_eq!(
        fault(&eight, &seven),
        (
            1,
            RecordFault::RowLength {
                found: 8,
                expected: 7
            }
        )
    );
    let wrapped = RecordOptions {
        values_in_a_row: Some(8),
        step: Some(0.01),
        ..in_g()
    };
    let torn = eight.replacen(" 0.8\n", "\n", 2);
    assert_eq!(
        fault(&torn, &wrapped),
        (
            1,
            RecordFault::RowLength {
                found: 7,
                expected: 8
            }
        )
    );
    assert!(
        fault("0 1\n1 2\n", &RecordOptions::default())
            .1
            .to_string()
            .contains("`units`")
    );
    assert!(
        fault("1\n2\n3\n", &in_g())
            .1
            .to_string()
            .contains("`time_step`")
    );
    let fillers = "0 0.1\n1 99999\n2 0.2\n3 -9999.99\n";
    assert!(matches!(
        fault(fillers, &in_g()),
        (2, RecordFault::Filler { .. })
    ));
    let channel = RecordOptions {
        channel: Some("1".into()),
        ..in_g()
    };
    assert!(
        fault("0 1\n1 2\n", &channel)
            .1
            .to_string()
            .contains("columns")
    );
}

/// Exponents of Fortran are read; words, infinities, hexadecimal numbers and doubled signs are refused at their place.
#[test]
fn numbers_are_decimal_and_finite() {
    let options = RecordOptions {
        unit: Some(AccelerationUnit::MetrePerSecondSquared),
        ..RecordOptions::default()
    };
    let record = parse("0.00 -1.5D-3\n0.02 .5\n0.04 7.0D+01\n", &options).unwrap();
    assert_eq!(record.samples, [-1.5e-3, 0.5, 70.0]);
    for (number, is_finite) in [
        ("nan", false),
        ("1e999", false),
        ("0x10", true),
        ("--1", true),
    ] {
        let (line, found) = fault(&format!("0.00 0.1\n0.02 {number}\n0.04 0.3\n"), &options);
        let expected = if is_finite {
            matches!(found, RecordFault::NotANumber { .. })
        } else {
            matches!(found, RecordFault::NotFinite { .. })
        };
        assert!(line == 2 && expected, "{number}: {line} {found:?}");
    }
}
