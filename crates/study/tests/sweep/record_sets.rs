//! Sweeps over sets of records: cases as those by hand, statistics, fragility curves, interruption.

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::sync::atomic::Ordering;

use powerhouse::ProgressHook;
use powerhouse_study::fragility::{LognormalFragility, Stripe};
use powerhouse_study::sweep::{
    FragilityResult, SetSpectra, SetStatistics, SpectrumOfRecord, TargetSpectrum,
};

use super::*;
use crate::block::Folder as Block;

pub(super) const SCENE: &str = r#"
title = "block"
[mesh]
file = "mesh.msh"
[[material]]
name = "rock"
law = "elastic"
young = 9e9
poisson = 0.27
density = 2750
[[part]]
set = "rock"
material = "rock"
[[wave]]
kind = "sv"
incidence = 20
record = "motions"
[boundary]
kind = "viscous-spring"
faces = ["left", "right", "front", "back", "bottom"]
scatterer = [60, 60, 120]
[time]
duration = 0.7
[output]
every = 0.02
[[output.history]]
name = "inside"
at = [60, 60, 60]
quantities = ["displacement"]
[[output.section]]
name = "cut"
set = "rock"
at = [60, 60, 60]
normal = [1, 0, 0]
along = [0, 1, 0]
"#;

/// A set of the files of [`block`] at three scales.
const SET: &str = r#"
[[record_set]]
name = "motions"
folder = "motions"
units = "m/s2"
convention = "incident"
scales = [1, 0.5, 2]
[[record_set.fragility]]
name = "by-peak"
figure = "displacement inside [m]"
limit = 0.02
[[record_set.fragility]]
name = "by-spectrum"
figure = "displacement inside [m]"
limit = 0.02
period = 0.2
[[record_set.fragility]]
name = "compressed"
figure = "least axial force cut [N/m]"
limit = -1e12
[[record_set.fragility]]
name = "misnamed"
figure = "displacement crown [m]"
limit = 1
"#;

/// Names of the records, with their peaks (m/s2) and the durations (s) of their displacements, a single pulse.
const RECORDS: [(&str, f64, f64); 5] = [
    ("a", 3.0, 0.4),
    ("b", 8.0, 0.24),
    ("c", 5.0, 0.4),
    ("d", 17.0, 0.24),
    ("e", 1.0, 0.4),
];
const SCALES: [f64; 3] = [0.5, 1.0, 2.0];

/// Acceleration of a displacement of the form sin^4, with a peak.
fn pulse(peak: f64, duration: f64) -> Vec<(f64, f64)> {
    let samples = (duration / 0.01).round() as i32;
    let at = |sample: i32| {
        let phase = 2.0 * PI * f64::from(sample) / f64::from(samples);
        (
            0.01 * f64::from(sample),
            0.5 * peak * ((2.0 * phase).cos() - phase.cos()),
        )
    };
    (0..=samples).map(at).collect()
}

/// A block with these records and a set of them.
fn block(name: &str, set: &str) -> Block {
    let block = Block::new(name, &format!("{SCENE}{set}"), 3);
    std::fs::create_dir_all(block.0.join("motions")).unwrap();
    for (name, peak, duration) in RECORDS {
        let rows = pulse(peak, duration).into_iter();
        let rows: Vec<String> = rows.map(|(time, a)| format!("{time} {a:e}")).collect();
        std::fs::write(block.0.join(format!("motions/{name}.txt")), rows.join("\n")).unwrap();
    }
    block
}

fn sweep(block: &Block) -> Sweep {
    Sweep::of_file(block.scene(), Some(block.out())).unwrap()
}

fn written(block: &Block) -> SetStatistics {
    SetStatistics::read(&block.out().join("statistics.json")).unwrap()
}

fn timeless(outcome: &CaseOutcome) -> CaseOutcome {
    CaseOutcome {
        wall_time: 0.0,
        ..outcome.clone()
    }
}

/// Displacement of a case.
fn moved(outcomes: &[CaseOutcome], case: &str) -> f64 {
    let found = outcomes
        .iter()
        .find(|outcome| outcome.name == case)
        .unwrap();
    found.displacements[0].value
}

/// A case of a set has the fingerprint, the outcome and the files of the same case written by hand.
#[test]
fn a_case_of_a_set_is_that_by_hand() {
    let of_set = block("record-set", SET);
    let only = ["c-x2".to_owned()];
    let found = sweep(&of_set)
        .only(&only)
        .unwrap()
        .run(None, &mut NoProgress)
        .unwrap();
    let by_hand = block(
        "record-by-hand",
        "[[record]]\nname = \"motions\"\nfile = \"motions/e.txt\"\nunits = \"m/s2\"\nconvention = \"incident\"\n\
         [[case]]\nname = \"c-x2\"\nrecord = [{ name = \"motions\", file = \"motions/c.txt\", factor = 2 }]\n",
    );
    let expected = sweep(&by_hand).run(None, &mut NoProgress).unwrap();
    assert_eq!(timeless(&found[0]), timeless(&expected[0]));
    let read =
        |block: &Block, file: &str| std::fs::read(block.out().join("c-x2").join(file)).unwrap();
    for file in ["histories.csv", "sections.csv", "energies.csv"] {
        assert!(read(&of_set, file) == read(&by_hand, file), "{file}");
    }
    let mark = |block: &Block| -> BTreeMap<String, String> {
        let text = String::from_utf8(read(block, "finished.json")).unwrap();
        let lines = text
            .lines()
            .filter_map(|line| line.trim().trim_end_matches(',').split_once(": "));
        let own = lines.filter(|(key, _)| ["\"inputs\"", "\"software\""].contains(key));
        own.map(|(key, value)| (key.to_owned(), value.to_owned()))
            .collect()
    };
    assert_eq!(mark(&of_set).len(), 2);
    assert_eq!(mark(&of_set), mark(&by_hand));
    // Twice the motion of the file, in a body without history.
    let once = sweep(&of_set).only(&["c-x1".to_owned()]).unwrap();
    let once = once.run(None, &mut NoProgress).unwrap();
    let ratio = found[0].displacements[0].value / once[0].displacements[0].value;
    assert!((ratio - 2.0).abs() < 1e-9, "{ratio}");
}

/// Fractiles, envelopes and counts are those of the outcomes by hand at each scale, in the statistics, their tables and the report.
#[test]
fn statistics_are_those_of_the_outcomes() {
    let block = block("record-statistics", SET);
    let sweep = sweep(&block);
    let names: Vec<String> = RECORDS
        .iter()
        .flat_map(|(name, ..)| SCALES.map(|scale| format!("{name}-x{scale}")))
        .collect();
    assert_eq!(sweep.cases(), names);
    let outcomes = sweep.run(None, &mut NoProgress).unwrap();
    let statistics = sweep.statistics().unwrap().unwrap();
    assert_eq!(written(&block).to_string(), statistics.to_string());
    let table = std::fs::read_to_string(block.out().join("statistics.csv")).unwrap();
    let envelopes = std::fs::read_to_string(block.out().join("envelopes.csv")).unwrap();
    let page = std::fs::read_to_string(write_report(block.out()).unwrap()).unwrap();
    assert_eq!(statistics.scales.len(), 3);
    for (found, scale) in statistics.scales.iter().zip(SCALES) {
        assert_eq!(
            (found.scale, found.finished, found.missing.len()),
            (scale, 5, 0)
        );
        let mut values = RECORDS.map(|(name, ..)| moved(&outcomes, &format!("{name}-x{scale}")));
        values.sort_by(f64::total_cmp);
        let [v0, v1, v2, v3, v4] = values;
        assert!(v0 < v1 && v1 < v2 && v2 < v3 && v3 < v4);
        // 16 % of four intervals end 0.64 behind the first value.
        let (low, high) = (v0 + 0.64 * (v1 - v0), v3 + 0.36 * (v4 - v3));
        let figure = found
            .figures
            .iter()
            .find(|of| of.figure == "displacement inside [m]")
            .unwrap();
        assert_eq!((figure.count, figure.median), (5, Some(v2)));
        assert!((figure.low.unwrap() / low - 1.0).abs() < 1e-14);
        assert!((figure.high.unwrap() / high - 1.0).abs() < 1e-14);
        let line = format!(
            "{scale},displacement inside [m],5,{:e},{v2:e},",
            figure.low.unwrap()
        );
        assert!(table.contains(&line), "{line}\n{table}");
        let own = outcomes
            .iter()
            .filter(|outcome| outcome.name.ends_with(&format!("-x{scale}")));
        let cuts: Vec<_> = own.map(|outcome| outcome.sections[0].clone()).collect();
        let least = cuts
            .iter()
            .map(|cut| cut.axial[0].value)
            .fold(f64::INFINITY, f64::min);
        let most = cuts
            .iter()
            .map(|cut| cut.moment[1].value)
            .fold(f64::NEG_INFINITY, f64::max);
        let [envelope] = &found.envelopes[..] else {
            panic!("{:?}", found.envelopes);
        };
        assert_eq!((envelope.axial[0], envelope.moment[1]), (least, most));
        assert!(
            envelopes.contains(&format!("{scale},cut,{least:e},")),
            "{envelopes}"
        );
    }
    for text in [
        "Scale 0.5: 5 of 5 cases",
        "Fragility curve by-peak",
        "greatest Q",
        "no case has the result",
    ] {
        assert!(page.contains(text), "{text}");
    }

    // Peaks of the files times scales, exceedances by the outcomes: the curve is that of these runs.
    let of = |name: &str| -> &FragilityResult {
        statistics
            .fragility
            .iter()
            .find(|fragility| fragility.name == name)
            .unwrap()
    };
    let by = |intensity: &dyn Fn(&str, f64, f64) -> f64| {
        let runs = RECORDS.iter().flat_map(|&(name, peak, duration)| {
            SCALES.map(|scale| Stripe {
                intensity: scale * intensity(name, peak, duration),
                count: 1,
                exceeded: u32::from(moved(&outcomes, &format!("{name}-x{scale}")) > 0.02),
            })
        });
        runs.collect::<Vec<Stripe>>()
    };
    let peaks = by(&|_, peak, _| peak);
    let curve = LognormalFragility::fit(&peaks).unwrap();
    let found = of("by-peak");
    let exceeded: u32 = peaks.iter().map(|stripe| stripe.exceeded).sum();
    assert_eq!(
        (found.runs.len(), found.exceeded()),
        (15, exceeded as usize)
    );
    let own = found.curve.as_ref().unwrap();
    assert!(
        (own.median / curve.median - 1.0).abs() < 1e-9,
        "{own:?} {curve:?}"
    );
    assert!((own.dispersion / curve.dispersion - 1.0).abs() < 1e-9);
    let spectrum = |_: &str, peak: f64, duration: f64| {
        let samples = pulse(peak, duration).into_iter().map(|(_, a)| a).collect();
        let history = powerhouse::wavefield::TimeHistory::new(0.01, samples).unwrap();
        history.response_spectrum(0.05, &[0.2]).unwrap()[0].pseudo_acceleration()
    };
    let curve = LognormalFragility::fit(&by(&spectrum)).unwrap();
    let own = of("by-spectrum").curve.as_ref().unwrap();
    assert!(
        (own.median / curve.median - 1.0).abs() < 1e-9,
        "{own:?} {curve:?}"
    );
    let none = of("compressed");
    assert!(none.curve.is_none());
    assert!(
        none.refused
            .as_ref()
            .unwrap()
            .contains("none of 15 runs exceeds the limit")
    );
    let misnamed = of("misnamed").refused.as_ref().unwrap();
    assert!(
        misnamed.contains(
            "no case has the result 'displacement crown [m]', but: displacement inside [m]"
        )
    );
    let shown = statistics.to_string();
    for text in [
        "records 'motions' at scale 0.5: 5 of 5 cases",
        "fragility 'by-peak'",
        "no curve, since",
    ] {
        assert!(shown.contains(text), "{shown}");
    }

    // Other curves of the same cases run none of them again; without a set its statistics are gone.
    let text = std::fs::read_to_string(block.scene()).unwrap();
    std::fs::write(block.scene(), text.replace("limit = 0.02", "limit = 0.01")).unwrap();
    let mut count = Count::default();
    super::record_sets::sweep(&block)
        .run(None, &mut count)
        .unwrap();
    assert_eq!((count.kept.len(), count.ended.len()), (15, 0));
    assert!(written(&block).fragility[0].exceeded() > exceeded as usize);
    let own = "[[record]]\nname = \"motions\"\nfile = \"motions/e.txt\"\nunits = \"m/s2\"\nconvention = \"incident\"\n[[case]]\nname = \"own\"\n";
    std::fs::write(block.scene(), format!("{SCENE}{own}")).unwrap();
    super::record_sets::sweep(&block)
        .run(None, &mut NoProgress)
        .unwrap();
    assert!(!block.out().join("statistics.json").exists());
}

/// The fit of a set is that of the arithmetic mean of its spectra at the periods of the band at which the target is defined.
#[test]
fn the_fit_of_a_set_is_that_of_its_mean() {
    let record = |record: &str, accelerations: [f64; 5]| SpectrumOfRecord {
        record: record.into(),
        accelerations: accelerations.to_vec(),
        peak: 1.0,
        arias: 1.0,
        duration: 1.0,
    };
    let target = TargetSpectrum {
        name: "a code".into(),
        band: [0.1, 1.0],
        accelerations: vec![Some(1.0), Some(2.0), Some(4.0), None, Some(1.0)],
    };
    let mut spectra = SetSpectra {
        components: 2,
        damping: 0.05,
        periods: vec![0.05, 0.1, 0.5, 0.9, 2.0],
        records: vec![
            record("a", [9.0, 1.0, 5.0, 9.0, 9.0]),
            record("b", [9.0, 2.5, 5.0, 9.0, 9.0]),
        ],
        target: Some(target),
    };
    let [least, greatest] = spectra.fit().unwrap();
    assert_eq!([least.period, least.ratio], [0.1, 0.875]);
    assert_eq!([greatest.period, greatest.ratio], [0.5, 1.25]);
    assert_eq!(
        spectra.to_string(),
        "mean of the spectra of 2 records (of two components the geometric mean) over that of a code, from 0.100 to 1.00 s: 0.875 at \
         0.100 s to 1.25 at 0.500 s"
    );
    spectra.target = None;
    assert!(spectra.fit().is_none() && spectra.to_string().is_empty());
}

/// Stops a sweep after some cases and some steps of the next one.
struct Stopping {
    stop: Arc<AtomicBool>,
    cases: usize,
    begun: usize,
}

impl SweepWatch for Stopping {
    fn begins(&mut self, _case: &str, _number: usize, _of: usize) {
        self.begun += 1;
    }
    fn progress(&mut self, _case: &str) -> Option<ProgressHook<'static>> {
        let (stop, is_last) = (self.stop.clone(), self.begun > self.cases);
        Some(Box::new(move |progress| {
            stop.fetch_or(is_last && progress.done >= 5, Ordering::Relaxed);
        }))
    }
}

/// A sweep that is stopped twice inside a case says each time which cases are missing, goes on, and ends with the bytes of one that was
/// not stopped; so does one whose cases are chosen by name, and one side by side.
#[test]
fn a_stopped_study_ends_with_the_same_bytes() {
    let whole = block("record-whole", SET);
    sweep(&whole).run(None, &mut NoProgress).unwrap();
    let files = ["statistics.json", "statistics.csv", "envelopes.csv"];
    let bytes = |block: &Block| files.map(|file| std::fs::read(block.out().join(file)).unwrap());

    let stopped = block("record-stopped", SET);
    for (cases, finished) in [(4, 4), (9, 9)] {
        let mut watch = Stopping {
            stop: Arc::default(),
            cases,
            begun: 0,
        };
        let stop = watch.stop.clone();
        let done = sweep(&stopped).run(Some(&stop), &mut watch);
        assert!(matches!(done, Err(StudyError::Interrupted)));
        let found = written(&stopped).scales;
        assert_eq!(
            found.iter().map(|scale| scale.finished).sum::<usize>(),
            finished
        );
        assert_eq!(
            found.iter().map(|scale| scale.missing.len()).sum::<usize>(),
            15 - finished
        );
        assert!(found[0].missing.contains(&"e-x0.5".to_owned()));
        assert!(bytes(&stopped) != bytes(&whole));
    }
    let two = NonZeroUsize::new(2).unwrap();
    let last = sweep(&stopped).side_by_side(two);
    last.run(None, &mut NoProgress).unwrap();
    assert!(bytes(&stopped) == bytes(&whole));
}

/// A record that cannot be used is refused when the sweep begins, by its file, before any case runs.
#[test]
fn an_unfit_record_is_refused_before_the_first_case() {
    let block = block("record-unfit", SET);
    std::fs::write(block.0.join("motions/d.txt"), "0 0\n0.01 1\n0.02 2\n").unwrap();
    let refused = Sweep::of_file(block.scene(), Some(block.out()))
        .err()
        .unwrap()
        .to_string();
    assert!(
        refused.contains("case 'd-x2'") && refused.contains("end velocity"),
        "{refused}"
    );
    std::fs::write(block.0.join("motions/d.txt"), "no numbers").unwrap();
    let refused = Sweep::of_file(block.scene(), Some(block.out()))
        .err()
        .unwrap()
        .to_string();
    assert!(refused.contains("d.txt"), "{refused}");
    assert!(!block.out().exists());
}
