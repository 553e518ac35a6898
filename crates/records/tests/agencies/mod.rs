//! Records of agencies: each format is recognised, read to the last digit, and refused where it is damaged.

mod files;

use files::{Motion, afad, at2, cosmos, csmip_v1, csmip_v2, csmnc, cwb, esm, geonet, knet, smc};
use powerhouse_records::{
    CountRule, Record, RecordError, RecordFault, RecordOptions, parse_record,
};

/// A file with the motions that it has, and what its header says of them.
struct Case {
    name: &'static str,
    /// Start of the name of the format.
    format: &'static str,
    text: String,
    motions: Vec<Motion>,
    unit: &'static str,
    /// Half of the last digit of a sample, in the unit.
    digit: f64,
    station: &'static str,
}

/// Channels of the same length and step, of different peaks.
fn channels(
    names: [&'static str; 3],
    count: usize,
    step: f64,
    peak: f64,
    decimals: i32,
) -> Vec<Motion> {
    let factors = [1.0, 0.6, -0.3];
    let channel = |(name, factor)| Motion::new(name, count, step, peak * factor, decimals);
    names.into_iter().zip(factors).map(channel).collect()
}

fn cases() -> Vec<Case> {
    let mut all = Vec::new();
    let mut add = |name, format, text: String, motions: Vec<Motion>, unit, digit, station| {
        all.push(Case {
            name,
            format,
            text,
            motions,
            unit,
            digit,
            station,
        });
    };
    for (name, year, component, offset) in [
        ("K-NET 1996", 1996, "N-S", 0.0),
        ("K-NET 2014", 2014, "E-W", -7.4),
        ("KiK-net", 2011, "EW2 (surface)", 12.0),
        ("KiK-net, borehole", 2003, "UD1 (borehole)", -3.0),
    ] {
        let motion = Motion::new(component, 500, 0.01, 231.7, 6);
        let text = knet(&motion, year, offset);
        // Counts are rounded, and the mean of the file is not quite the offset.
        add(name, "K-NET", text, vec![motion], "cm/s2", 2e-3, "CHB002");
    }
    let motions = channels(["90 deg", "Up", "360 deg"], 401, 0.005, 812.34, 5);
    add(
        "COSMOS, touching",
        "COSMOS",
        cosmos(&motions, "8F10.5", true),
        motions,
        "cm/s2",
        5e-6,
        "AK-BMR",
    );
    let motions = channels(["Other", "b", "c"], 301, 0.01, 6.85, 6)[..1].to_vec();
    add(
        "COSMOS, one",
        "COSMOS",
        cosmos(&motions, "1E15.6", false),
        motions,
        "cm/s2",
        5e-6,
        "AK-BMR",
    );
    for (name, capitals) in [("CSMIP 2014", false), ("CSMIP 1990", true)] {
        let motions = channels(["90", "Up", "360"], 403, 0.02, 1301.0, 4);
        let text = csmip_v2(&motions, capitals);
        add(
            name,
            "CSMIP",
            text,
            motions,
            "cm/s2",
            1e-4,
            "Hacienda Heights",
        );
    }
    let motions = channels(["360", "Up", "270"], 397, 0.005, 0.42, 6);
    add(
        "CSMIP volume 1",
        "CSMIP",
        csmip_v1(&motions),
        motions,
        "g",
        5e-7,
        "Willow Creek",
    );
    for (name, volume) in [("GeoNet V1A", 1), ("GeoNet V2A", 2)] {
        let motions = channels(["N28W", "S62W", "Up"], 257, 0.02, 11026.2, 1);
        add(
            name,
            "GeoNet",
            geonet(&motions, volume),
            motions,
            "mm/s2",
            0.05,
            "WPWS",
        );
    }
    for (name, network, station) in [("ESM", "HI", "HI ARS1"), ("AFAD 2020", "TK", "TK ARS1")] {
        let motion = Motion::new("HNE", 333, 0.005, 98.7, 6);
        add(
            name,
            "ESM",
            esm(&motion, network),
            vec![motion],
            "cm/s2",
            5e-7,
            station,
        );
    }
    for (name, comments) in [("SMC", 8), ("SMC without comments", 0)] {
        let motion = Motion::new("360", 601, 0.005, 9.9, 4);
        let text = smc(&motion, comments);
        add(
            name,
            "USGS SMC",
            text,
            vec![motion],
            "cm/s2",
            5e-5,
            "San Francisco, 1295 Shafter, F",
        );
    }
    for (name, step, count) in [("CWB 50 Hz", 0.02, 400), ("CWB 200 Hz", 0.005, 600)] {
        let motions = channels(["U", "N", "E"], count, step, 213.7, 3);
        add(name, "CWB", cwb(&motions), motions, "cm/s2", 5e-4, "EAS");
    }
    for (name, year, step) in [("CSMNC 2008", 2008, 0.005), ("CSMNC 2013", 2013, 0.01)] {
        let motion = Motion::new("EW", 444, step, 1005.35, 3);
        add(
            name,
            "CSMNC",
            csmnc(&motion, year),
            vec![motion],
            "cm/s2",
            5e-4,
            "51BXD",
        );
    }
    for (name, step) in [("AFAD 1999", 0.005), ("AFAD 2017", 0.01)] {
        let motions = channels(["N-S", "E-W", "U-D"], 300, step, 313.2, 6);
        add(name, "AFAD", afad(&motions), motions, "cm/s2", 5e-7, "0921");
    }
    for (name, year) in [("AT2 1997", 1997), ("AT2 2014", 2014)] {
        let motion = Motion::new("", 222, 0.005, 0.31, 7);
        add(
            name,
            "PEER AT2",
            at2(&motion, year),
            vec![motion],
            "g",
            5e-8,
            "",
        );
    }
    all
}

fn read(text: &str, channel: Option<&str>) -> Result<Record, RecordError> {
    let options = RecordOptions {
        channel: channel.map(str::to_string),
        ..RecordOptions::default()
    };
    parse_record(text.as_bytes(), &options)
}

/// Line and fault of a file that must be refused.
fn refused(name: &str, text: &str, channel: Option<&str>) -> (usize, RecordFault) {
    match read(text, channel) {
        Err(RecordError::Content { line, fault, .. }) => (line, fault),
        other => panic!("{name}: {:?}", other.map(|record| record.samples.len())),
    }
}

/// Channel to ask for in a file of several.
fn choice(case: &Case) -> Option<&'static str> {
    (case.motions.len() > 1).then_some("2")
}

/// Every format is recognised by its content, and gives count, step, unit, station, component and every sample of
/// every channel to the digits of the file.
#[test]
fn every_format_is_read_to_the_digits_of_the_file() {
    for case in cases() {
        let name = case.name;
        for (index, motion) in case.motions.iter().enumerate() {
            let number = (index + 1).to_string();
            let component = motion.component.trim_end_matches(" deg");
            let wanted = (case.motions.len() > 1).then_some(number.as_str());
            let record = read(&case.text, wanted).unwrap_or_else(|error| panic!("{name}: {error}"));
            assert!(
                record.format.starts_with(case.format),
                "{name}: {}",
                record.format
            );
            assert_eq!(
                (record.samples.len(), record.step),
                (motion.samples.len(), motion.step),
                "{name}"
            );
            assert_eq!(
                (record.unit.name(), &record.station[..]),
                (case.unit, case.station),
                "{name}"
            );
            assert_eq!(record.component, component, "{name}");
            assert!(record.warnings.is_empty(), "{name}: {:?}", record.warnings);
            let mean = match case.format {
                "K-NET" => motion.samples.iter().sum::<f64>() / motion.samples.len() as f64,
                _ => 0.0,
            };
            let factor = record.unit.factor();
            for (at, (found, expected)) in record.samples.iter().zip(&motion.samples).enumerate() {
                let difference = found / factor - (expected - mean);
                assert!(
                    difference.abs() <= 1.01 * case.digit,
                    "{name} {number}: {at}: {found} {expected}"
                );
            }
            if wanted.is_some() {
                assert_eq!(
                    read(&case.text, Some(component)).unwrap(),
                    record,
                    "{name}: by name"
                );
            }
        }
        assert!(
            !case.text.contains("UTC")
                || !read(&case.text, choice(&case)).unwrap().start.is_empty()
        );
    }
}

/// A file of several channels is refused with their names until one is chosen; so is a choice that the file does not
/// have.
#[test]
fn a_channel_is_chosen() {
    for case in cases() {
        let (name, count) = (case.name, case.motions.len());
        if count > 1 {
            let message = refused(name, &case.text, None).1.to_string();
            let all = case
                .motions
                .iter()
                .all(|m| message.contains(m.component.trim_end_matches(" deg")));
            assert!(all && message.contains("`channel`"), "{name}: {message}");
        }
        let (_, fault) = refused(name, &case.text, Some("x"));
        assert!(
            matches!(fault, RecordFault::NoSuchChannel { .. }),
            "{name}: {fault}"
        );
    }
}

/// A unit or step of the caller that is not that of the file is refused, the same is accepted.
#[test]
fn declarations_are_compared_with_the_header() {
    for case in cases() {
        let name = case.name;
        for (unit, step) in [("cm/s2", 1.0), ("g", 1.0), ("mm/s2", 1.0), (case.unit, 1.1)] {
            let options = RecordOptions {
                unit: powerhouse_records::AccelerationUnit::from_name(unit),
                step: Some(case.motions[0].step * step),
                channel: choice(&case).map(Into::into),
                ..RecordOptions::default()
            };
            let result = parse_record(case.text.as_bytes(), &options);
            assert_eq!(
                result.is_ok(),
                unit == case.unit && step == 1.0,
                "{name}: {unit} {step}"
            );
        }
    }
}

/// A file that ends too early, has another count, a number that stands for a missing sample, or a second record is
/// refused, with a line.
#[test]
fn damaged_files_are_refused_by_line() {
    for case in cases() {
        let (name, text, chosen) = (case.name, &case.text, choice(&case));
        let lines: Vec<&str> = text.lines().collect();
        let is_row = |line: &&str| {
            line.trim_start()
                .starts_with(|c: char| c.is_ascii_digit() || "-.".contains(c))
        };
        // Rows of the last block of samples; the last channel is asked for.
        let last_channel = (case.motions.len() > 1).then_some("3");
        let end = lines.iter().rposition(is_row).unwrap();
        for cut in [1, 3, 30] {
            let kept = [&lines[..end + 1 - cut], &lines[end + 1..]]
                .concat()
                .join("\n");
            let (line, fault) = refused(name, &kept, last_channel);
            let is_count = matches!(
                fault,
                RecordFault::Count { .. } | RecordFault::Header { .. }
            );
            assert!(
                line > 0 && is_count,
                "{name}, {cut} rows less: {line}: {fault}"
            );
        }
        let half = &text[..text.len() - lines[end].len() / 2 - 30 * lines[end].len()];
        assert!(refused(name, half, chosen).0 > 0, "{name}: torn");
        let more = [&lines[..end + 1], &[lines[end - 1]], &lines[end + 1..]]
            .concat()
            .join("\n");
        let (line, fault) = refused(name, &more, last_channel);
        let is_more = matches!(
            fault,
            RecordFault::Count { .. } | RecordFault::NotUniform { .. }
        );
        assert!(line > 0 && is_more, "{name}, a row more: {fault}");
        let count = case.motions[0].samples.len();
        if case.format != "K-NET" && case.format != "CWB" {
            let wrong = text.replace(&count.to_string(), &(count + 1).to_string());
            let (line, fault) = refused(name, &wrong, chosen);
            assert!(
                line > 0 && matches!(fault, RecordFault::Count { .. }),
                "{name}: {fault}"
            );
        }
        let wide = lines[end - 1];
        let word = wide.split([' ', '-']).rfind(|word| word.len() > 2).unwrap();
        let filler = if case.format == "K-NET" {
            "8388607"
        } else {
            "99999.9"
        };
        let padded = match word.len() {
            width @ 0..7 => (format!("{word:>width$}"), filler.to_string()),
            width => (word.to_string(), format!("{filler:>width$}")),
        };
        if wide.contains(&format!(" {word}")) && padded.0.len() == padded.1.len() {
            let filled = wide.replacen(&padded.0, &padded.1, 1);
            let broken = [&lines[..end - 1], &[filled.as_str()], &lines[end..]]
                .concat()
                .join("\n");
            let (line, fault) = refused(name, &broken, last_channel);
            let is_filler = matches!(fault, RecordFault::Filler { .. } | RecordFault::Peak { .. });
            assert!(line > 0 && is_filler, "{name}: {fault}");
        }
        let twice = format!("{text}\n{text}");
        match case.motions.len() {
            1 if case.format != "COSMOS" => {
                let (line, fault) = refused(name, &twice, None);
                let second = matches!(fault, RecordFault::SecondRecord { .. });
                assert!(line > lines.len() - 20 && second, "{name}: {line}: {fault}");
            }
            1 => {
                let (_, fault) = refused(name, &twice, None);
                assert!(
                    matches!(fault, RecordFault::Channels { .. }),
                    "{name}: {fault}"
                );
            }
            _ => assert!(
                read(&twice, Some(case.motions[1].component)).is_err(),
                "{name}"
            ),
        }
    }
}

/// Samples above the peak of the header are damage; below it there is a warning.
#[test]
fn samples_are_compared_with_the_peak_of_the_header() {
    let mut motion = Motion::new("HNE", 200, 0.005, 98.7, 6);
    let text = esm(&motion, "HI");
    let peak = motion.peak();
    motion.samples[77] = 4.0 * peak;
    let spike = esm(&motion, "HI").replace(
        &format!("{:.6}\nTIME", motion.peak()),
        &format!("{peak:.6}\nTIME"),
    );
    assert!(matches!(
        refused("spike", &spike, None).1,
        RecordFault::Peak { .. }
    ));
    let high = text.replace(
        &format!("{peak:.6}\nTIME"),
        &format!("{:.6}\nTIME", 2.0 * peak),
    );
    assert_eq!(read(&high, None).unwrap().warnings.len(), 1);
}

/// Files of velocities, spectra, counts and other programs are named, with the way out.
#[test]
fn other_files_are_named() {
    let motion = Motion::new("HNE", 100, 0.005, 98.7, 6);
    let velocity = esm(&motion, "HI").replace("DATA_TYPE: ACCELERATION", "DATA_TYPE: VELOCITY");
    assert!(matches!(
        refused("velocity", &velocity, None).1,
        RecordFault::Quantity { .. }
    ));
    let counts = cosmos(std::slice::from_ref(&motion), "8F10.5", false)
        .replace("cm/sec2(04)", "counts (50)");
    assert!(matches!(
        refused("counts", &counts, None).1,
        RecordFault::UnknownUnit { .. }
    ));
    let only =
        cosmos(std::slice::from_ref(&motion), "8F10.5", false).replace("acceleration", "velocity");
    assert!(matches!(
        refused("only", &only, None).1,
        RecordFault::Quantity { .. }
    ));
    let smc_velocity = smc(&motion, 2).replace("2 CORRECTED ACCELEROGRAM", "3 VELOCITY");
    assert!(matches!(
        refused("smc", &smc_velocity, None).1,
        RecordFault::Quantity { .. }
    ));
    let mut sac = vec![0_u8; 632];
    sac[304] = 6;
    let mut mseed = b"000001D CHB   HNE".to_vec();
    mseed.resize(512, 0);
    let spectra = b"Response and Fourier amplitude spectra (78 periods)\n1 2 3\n".to_vec();
    let pairs = b"TIMESERIES XX_T__HNE_R, 2 samples, 100 sps, 2020-01-01T00:00:00.000000, TSPAIR, FLOAT, M/S**2\n\
        2020-01-01T00:00:00.000000  0.125\n2020-01-01T00:00:00.010000  0.5\n";
    let gse = b"WID2 2020/01/01 00:00:00.000 T     HNE      CM6        2  100.000000\nDAT2\n0+U\nCHK2 1\n";
    for (bytes, name, way) in [
        (sac, "SAC", "obspy"),
        (pairs.to_vec(), "TSPAIR", "obspy"),
        (gse.to_vec(), "GSE", "obspy"),
        (mseed, "miniSEED", "obspy"),
        (spectra, "spectra", ".V2"),
        (b"\x89HDF\r\n\x1a\n00000000".to_vec(), "HDF5", "export"),
        (b"PK\x03\x04abcdefgh".to_vec(), "ZIP", "export"),
        (
            b"Uncorrected Accelerogram\n1 2 3\n".to_vec(),
            "layout",
            "export",
        ),
    ] {
        let message = parse_record(&bytes, &RecordOptions::default())
            .unwrap_err()
            .to_string();
        assert!(
            message.contains(name) && message.contains(way),
            "{name}: {message}"
        );
    }
}

/// Of 200 damaged copies of each file none makes the reader panic, and none is accepted with another count or unit.
#[test]
fn mutations_change_no_count_and_no_unit() {
    let mut seed = 0x9e37_79b9_7f4a_7c15_u64;
    let mut random = move || {
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        seed as usize
    };
    for case in cases() {
        let chosen = choice(&case).map(str::to_string);
        let options = RecordOptions {
            channel: chosen,
            ..RecordOptions::default()
        };
        let count = case.motions[0].samples.len();
        for round in 0..200 {
            let mut bytes = case.text.as_bytes().to_vec();
            // The header is short against the samples, and every second time it is hit.
            let range = if round % 2 == 0 {
                bytes.len()
            } else {
                bytes.len().min(1500)
            };
            let place = random() % range;
            match random() % 4 {
                0 => bytes[place] = random() as u8,
                1 => bytes[place] = b"0123456789.-+ \n,"[random() % 16],
                2 => {
                    bytes.remove(place);
                }
                _ => {
                    let end = (place + random() % 200).min(bytes.len());
                    bytes.drain(place..end);
                }
            }
            if let Ok(record) = parse_record(&bytes, &options) {
                let found = (record.samples.len(), record.unit.name());
                let name = case.name;
                assert_eq!(
                    found,
                    (count, case.unit),
                    "{name}, {round} at {place}: {}",
                    record.format
                );
            }
        }
    }
}

/// A letter that is lost from `CM/SEC/SEC` or `gal` makes another unit, in which no file of these formats is.
#[test]
fn a_unit_that_the_format_never_has_is_refused() {
    let mut tried = 0;
    for case in cases().iter().filter(|case| case.unit == "cm/s2") {
        for (whole, damaged) in [
            ("CM/SEC/SEC", "M/SEC/SEC"),
            (": gal", ": g"),
            ("gal.", "g."),
        ] {
            let text = case.text.replacen(whole, damaged, 1);
            if !(case.name.starts_with("CSMNC") || case.name.starts_with("CWB"))
                || text == case.text
            {
                continue;
            }
            let message = parse_record(text.as_bytes(), &RecordOptions::default())
                .unwrap_err()
                .to_string();
            assert!(
                message.contains("may be damaged"),
                "{}: {message}",
                case.name
            );
            tried += 1;
        }
    }
    assert!(tried >= 3, "{tried}");
}

/// A count that differs is a warning, if the caller wants the samples as they are.
#[test]
fn counts_as_found_are_warnings() {
    let motion = Motion::new("HNE", 100, 0.005, 98.7, 6);
    let text = esm(&motion, "HI").replace("NDATA: 100", "NDATA: 101");
    let options = RecordOptions {
        count: CountRule::AsFound,
        ..RecordOptions::default()
    };
    let record = parse_record(text.as_bytes(), &options).unwrap();
    assert_eq!((record.samples.len(), record.warnings.len()), (100, 1));
}
