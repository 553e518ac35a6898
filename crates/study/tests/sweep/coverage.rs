//! Shares of records that cases cover.

use powerhouse::wavefield::TimeHistory;
use powerhouse::{FileScene, Remark, remark};

use super::*;

/// The share of a record that a case covers is the one of which the scene warns: a filter extends the record, which begins
/// earlier by that; the body starts at rest, which delays the waves; a wave may arrive late, on its reference point.
#[test]
fn the_share_of_a_filtered_record_is_the_one_that_its_scene_warns_of() {
    // The acceleration of a displacement that is a bell, from 0.1 to 0.3 s: at rest at both ends.
    let sample = |i: i32| match (0.005 * f64::from(i) - 0.2) / 0.02 {
        t if t.abs() < 5.5 => 4.0 * (t * t - 1.0) * (-0.5 * t * t).exp(),
        _ => 0.0,
    };
    let history = TimeHistory::new(0.005, (0..=80).map(sample).collect()).unwrap();
    let mut registry = registry();
    registry.add_record("burst", history);
    let folder = Folder::new("coverage");
    let pulse = "pulse = { kind = \"smooth\", displacement = 0.01, duration = 0.1 }\n[boundary]";
    let scene = ground("[[case]]\nname = \"shaken\"\n");
    let filter = "baseline = { kind = \"high-pass\", corner = 5, order = 2 }\n";
    let mut shares = Vec::new();
    let plain = "end_displacement = 0\n";
    for (end, arrival) in [(plain, 0.0), (filter, 0.0), (filter, 0.15), (plain, 0.15)] {
        for duration in [0.15, 0.35, 0.55, 0.75, 1.0, 2.0] {
            let record = format!(
                "[[record]]\nname = \"quake\"\nfile = \"burst\"\nconvention = \"incident\"\n{end}"
            );
            let moved = format!("record = \"quake\"\narrival = {arrival}\n{record}[boundary]");
            let text = scene
                .replace(pulse, &moved)
                .replace("duration = 0.05\n", &format!("duration = {duration}\n"));
            std::fs::write(folder.scene(), &text).unwrap();
            let read = FileScene::from_toml(text, folder.scene(), &registry).unwrap();
            let warned = read.remarks().iter().find_map(|remark| match remark {
                Remark::TruncatedRecord(remark::TruncatedRecord { share, .. }) => Some(*share),
                _ => None,
            });
            let out = folder.0.join(format!("out-{}", shares.len()));
            let sweep = Sweep::of_file_with(folder.scene(), Some(out), &registry).unwrap();
            let cases = sweep.run(None, &mut NoProgress).unwrap();
            let coverage = cases[0].coverage.clone().unwrap();
            let case = format!("{end} {arrival} {duration}: {coverage:?}");
            assert_eq!(coverage.is_enough(), warned.is_none(), "{case}");
            if let Some(share) = warned {
                // A tenth of a period of samples.
                assert!((coverage.intensity - share).abs() < 0.02, "{case}, {share}");
            }
            shares.push(coverage.intensity);
        }
    }
    // None, some and all of the record.
    for shares in shares.chunks(6) {
        assert!(shares.is_sorted() && shares[5] > 0.99, "{shares:?}");
        assert!(shares[0] < 0.4, "{shares:?}");
    }
}
