//! Records that are scaled or matched to the spectra of codes.

use std::fs;
use std::path::Path;

use powerhouse::wavefield::TimeHistory;
use powerhouse::{RecordSpectrumReport, Remark, Scene, remark};

use super::support::*;

const PULSE: &str = "pulse = { kind = \"smooth\", displacement = 0.01, duration = 0.4 }";

/// El Centro as component x, and its reverse with twice the size as component y; z is x again.
fn station(name: &str) -> Variants {
    let variants = Variants::new(name);
    let file =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/records/el_centro_1940_ns.csv");
    let text = fs::read_to_string(file).unwrap();
    let rows: Vec<(String, f64)> = text
        .lines()
        .filter_map(|line| line.split_once(','))
        .filter_map(|(time, value)| Some((time.to_string(), value.trim().parse().ok()?)))
        .collect();
    assert!(rows.len() > 1000);
    let write = |name: &str, factor: f64| {
        let row = |((time, _), value): (&(String, f64), f64)| format!("{time} {}", factor * value);
        let values: Vec<f64> = rows.iter().map(|(_, value)| *value).collect();
        let text: Vec<String> = if factor > 0.0 {
            rows.iter().zip(values).map(row).collect()
        } else {
            rows.iter().zip(values.into_iter().rev()).map(row).collect()
        };
        fs::write(variants.0.join(name), text.join("\n")).unwrap();
    };
    write("x.txt", 1.0);
    write("y.txt", -2.0);
    // The first 5 s, with a baseline that is off by 0.2 m/s2 at first and by -0.6 m/s2 at last.
    let drift = rows.iter().filter_map(|(time, value)| {
        let seconds: f64 = time.parse().ok()?;
        (seconds <= 5.0).then(|| format!("{time} {}", value + 0.2 - 0.16 * seconds))
    });
    let drift: Vec<String> = drift.collect();
    fs::write(variants.0.join("drift.txt"), drift.join("\n")).unwrap();
    variants
}

fn record(target: &str, rest: &str) -> String {
    format!(
        "record = \"r\"\ncomponent = \"x\"\n[[record]]\nname = \"r\"\nconvention = \"incident\"\nunits = \"m/s2\"\ncomponents = {{ x = \"x.txt\", y = \"y.txt\", z = \"x.txt\" }}\nbaseline = {{ kind = \"velocity-polynomial\", order = 5 }}\nspectrum = {{ target = {target}, periods = [0.1, 2]{rest} }}\n"
    )
}

fn report<'s>(scene: &'s Scene, part: &str) -> &'s RecordSpectrumReport {
    let found = scene.remarks().iter().find_map(|remark| match remark {
        Remark::RecordSpectrum(remark::RecordSpectrum { name, report }) if name == part => {
            Some(&**report)
        }
        _ => None,
    });
    found.unwrap()
}

/// Mean logarithm, least and greatest value of the ratio of the spectrum of a record to a plateau of 2.5 m/s2 that falls from 0.4 s on.
fn ratio(history: &TimeHistory) -> (f64, f64, f64) {
    let periods: Vec<f64> = (0..150)
        .map(|i| 0.1 * 20f64.powf(f64::from(i) / 149.0))
        .collect();
    let responses = history.response_spectrum(0.05, &periods).unwrap();
    let ratios = responses.iter().map(|response| {
        let target = 2.5 * (0.4 / response.period).min(1.0)
            - 2.5 * (1.0 - 1.0 / 2.5) * ((0.15 - response.period) / 0.15).max(0.0);
        response.pseudo_acceleration() / target
    });
    ratios.fold(
        (0.0, f64::INFINITY, 0.0),
        |(sum, least, most), ratio: f64| {
            (sum + ratio.ln() / 150.0, least.min(ratio), most.max(ratio))
        },
    )
}

/// By a factor the horizontal components, taken together, have the mean of the spectrum and keep their proportion, and the vertical one
/// has the same factor; by wavelets each horizontal component has the spectrum to 1 % in the mean and to 15 % at every period after its baseline is
/// corrected, ends at rest, and the report says so.
#[test]
fn records_are_brought_to_the_spectrum_of_a_code() {
    let variants = station("code-spectra");
    let target = "{ kind = \"eurocode-8\", type = 1, ground = \"A\", peak = 1 }";
    let scene = variants.read(PULSE, &record(target, "")).unwrap();
    let [x, y, z] = ["r.x", "r.y", "r.z"].map(|name| &scene.records()[name]);
    let mean = 0.5 * (ratio(x).0 + ratio(y).0);
    assert!(mean.abs() < 0.01, "{mean}");
    let factor = report(&scene, "r.x").factor;
    assert!(report(&scene, "r.z").factor == factor && report(&scene, "r.y").factor == factor);
    assert_eq!(x.acceleration(), z.acceleration());
    let proportion = ratio(y).0 - ratio(x).0;
    assert!(proportion > 0.5 * 2f64.ln(), "{proportion}");

    let scene = variants
        .read(PULSE, &record(target, ", by = \"wavelets\""))
        .unwrap();
    for name in ["r.x", "r.y"] {
        let (mean, least, most) = ratio(&scene.records()[name]);
        assert!(
            mean.abs() < 0.01 && least > 0.85 && most < 1.15,
            "{name}: {mean} {least} {most}"
        );
        let report = report(&scene, name);
        assert!((report.misfit.least / least - 1.0).abs() < 0.02);
        assert!((report.misfit.greatest / most - 1.0).abs() < 0.02);
        let wavelets = report.wavelets.as_ref().unwrap();
        assert!(wavelets.before.worst() > 2.0 * report.misfit.worst());
        let end = scene.records()[name].report();
        assert!(end.end_displacement.abs() < 1e-3 * end.peak_displacement);
    }
    let (vertical, first) = (&scene.records()["r.z"], factor);
    let peak = vertical.report().peak_acceleration / z.report().peak_acceleration;
    assert!((peak - 1.0).abs() < 0.02, "{peak} {first}");
}

/// A short record whose baseline drifts is matched as well: it is corrected before the wavelets come, and after them.
#[test]
fn a_record_that_drifts_is_matched() {
    let variants = station("drifting-spectrum");
    let target = "{ kind = \"eurocode-8\", type = 1, ground = \"A\", peak = 1 }";
    let table = record(target, ", by = \"wavelets\"");
    let components = "components = { x = \"x.txt\", y = \"y.txt\", z = \"x.txt\" }";
    let table = table.replace(components, "file = \"drift.txt\"");
    let table = table.replace("component = \"x\"\n", "");
    let scene = variants.read(PULSE, &table).unwrap();
    let (mean, least, most) = ratio(&scene.records()["r"]);
    assert!(
        mean.abs() < 0.02 && least > 0.85 && most < 1.15,
        "{mean} {least} {most}"
    );
    let baseline = scene.remarks().iter().find_map(|remark| match remark {
        Remark::Record(remark::Record { baseline, .. }) => *baseline,
        _ => None,
    });
    // The drift of the record is shown, and what its correction changed.
    let baseline = baseline.unwrap();
    assert!(baseline.largest_change > 0.5 && baseline.before.end_velocity < -0.5);
    assert!(baseline.after.end_displacement.abs() < 1e-3);
}

/// What is no spectrum, or none of the record, is refused at its key with what is permitted.
#[test]
fn spectra_that_cannot_be_are_refused() {
    let variants = station("no-code-spectrum");
    let ec8 = "{ kind = \"eurocode-8\", type = 1, ground = \"A\", peak = 1 }";
    for (target, rest, expected) in [
        (
            "{ kind = \"eurocode-8\", type = 3, ground = \"A\", peak = 1 }",
            "",
            "1 or 2",
        ),
        (
            "{ kind = \"eurocode-8\", type = 1, ground = \"F\", peak = 1 }",
            "",
            "F",
        ),
        (
            "{ kind = \"nb-35047\", peak = 1, amplification = 2.25 }",
            "",
            "characteristic_period",
        ),
        (
            "{ kind = \"nb-35047\", peak = 1, amplification = 2.25, zone = 0.35 }",
            "",
            "site",
        ),
        (
            "{ kind = \"nb-35047\", peak = 1, amplification = 2.25, zone = 0.5, site = \"II\" }",
            "",
            "0.35, 0.4 or 0.45",
        ),
        (
            "{ kind = \"table\", points = [[0.1, 1.0]] }",
            "",
            "at least 2",
        ),
        (
            "{ kind = \"table\", points = [[0.2, 1.0], [1.0, 1.0]] }",
            "",
            "shortest",
        ),
        (
            "{ kind = \"asce-7\", short = 5, one_second = 3, long_period = 0.1 }",
            "",
            "long_period",
        ),
        (ec8, ", by = \"magic\"", "magic"),
        (
            ec8,
            "}\npeak = 2\nlength = \"pad\" #",
            "exactly one of peak, spectrum",
        ),
    ] {
        let scene = variants.read(PULSE, &record(target, rest));
        let error = scene.err().unwrap().to_string();
        assert!(error.contains(expected), "{target}{rest}: {error}");
    }
}
