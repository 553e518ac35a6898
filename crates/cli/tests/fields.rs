//! Pictures and lines from the snapshots of a finished run.

use std::path::Path;

use crate::block::{Block, text};
use powerhouse::io::read_table;

/// What the command prints; it must succeed.
fn said(block: &Block, arguments: &[&str]) -> String {
    let output = block.powerhouse(arguments);
    assert!(
        output.status.success(),
        "{arguments:?}: {}",
        text(&output.stderr)
    );
    text(&output.stdout)
}

/// Number of pictures of a PNG file.
fn pictures(file: &Path) -> u32 {
    let bytes = std::fs::read(file).unwrap();
    assert_eq!(bytes[..8], [137, 80, 78, 71, 13, 10, 26, 10]);
    let control = bytes.windows(4).position(|name| name == b"acTL");
    control.map_or(1, |at| {
        u32::from_be_bytes(bytes[at + 4..at + 8].try_into().unwrap())
    })
}

/// After a run its snapshots are listed, drawn, drawn deformed, and moving; displacements along a line pass through the
/// history of a point on it. Quantities, lines and folders that are not there are refused by name.
#[test]
fn snapshots_are_drawn_after_the_run() {
    // The last step ends at the last row of the history.
    let block = Block::new("fields", |scene| {
        scene.replace("duration = 0.3\n", "duration = 0.3\nstep = 0.0025\n")
    });
    let (scene, out) = (block.scene(), block.out_text());
    said(&block, &["run", &scene, "--out", &out, "--quiet"]);
    let listed = said(&block, &["picture", &out]);
    for passage in [
        "4 snapshots from 0 to 0.30",
        "displacement, .x, .y, .z",
        "element sets: rock",
    ] {
        assert!(listed.contains(passage), "{passage}: {listed}");
    }
    let drawn = said(
        &block,
        &[
            "picture",
            &out,
            "displacement.x",
            "--time",
            "0.19",
            "--deformed",
        ],
    );
    assert!(
        drawn.contains("pictures/displacement-x-deformed-0.2"),
        "{drawn}"
    );
    assert_eq!(pictures(Path::new(drawn.trim())), 1);
    let file = block.folder.join("moving.png").display().to_string();
    let moving = [
        "--animate",
        "--from",
        "0.05",
        "--deformed=200",
        "--size",
        "300x200",
    ];
    said(
        &block,
        &[
            &["picture", &out, "displacement", "--out", &file],
            &moving[..],
        ]
        .concat(),
    );
    assert_eq!(pictures(Path::new(&file)), 3);

    let line = ["--along", "60,60,0:60,60,120:60,60,200", "--points", "11"];
    let output =
        block.powerhouse(&[&["plot", &out, "displacement.z", "displacement"], &line[..]].concat());
    assert!(
        text(&output.stdout).contains("warning: 4 of 11 points"),
        "{}",
        text(&output.stdout)
    );
    let shown = text(&output.stdout);
    let table = block.out().join("plots");
    let table = table.join(shown.rsplit('/').next().unwrap().trim());
    let drawing = std::fs::read_to_string(table.with_extension("svg")).unwrap();
    // Quantities are drawn, positions are not.
    assert!(drawing.contains(">displacement.z<") && !drawing.contains(">z<"));
    let table = read_table(&table).unwrap();
    let names: Vec<&str> = table.iter().map(|column| &*column.name).collect();
    assert_eq!(
        names,
        ["distance", "x", "y", "z", "displacement.z", "displacement"]
    );
    assert_eq!(table[0].values, [0.0, 20.0, 40.0, 60.0, 80.0, 100.0, 120.0]);
    let history = read_table(&block.out().join("histories.csv")).unwrap();
    let last = |name: &str| {
        let column = history.iter().find(|column| column.name == name).unwrap();
        *column.values.last().unwrap()
    };
    let recorded = ["inside.ux", "inside.uy", "inside.uz"].map(last);
    let size = recorded.iter().map(|u| u * u).sum::<f64>().sqrt();
    assert!((table[4].values[3] - recorded[2]).abs() < 1e-6 * size);
    assert!((table[5].values[3] - size).abs() < 1e-6 * size);

    let snapshot = block
        .out()
        .join("snapshots/snapshots_00003.vtu")
        .display()
        .to_string();
    for (arguments, expected) in [
        (
            vec!["picture", &out, "stress.xx"],
            "no field 'stress.xx'; expected one of displacement, displacement.x",
        ),
        (
            vec!["picture", &out, "displacement.xx"],
            "no field 'displacement.xx'",
        ),
        (
            vec!["picture", &snapshot, "acceleration"],
            "snapshots_00003.vtu: no field 'acceleration'",
        ),
        (
            vec!["picture", &out, "displacement", "--set", "rok"],
            "'rok'",
        ),
        (
            vec!["plot", &out, "displacement", "--along", "0,0,900:0,0,950"],
            "no point of the line",
        ),
        (
            vec!["plot", &out, "displacement", "--along", "0,0:0,0,950"],
            "two or more points of three coordinates",
        ),
        (
            vec!["picture", &scene, "displacement"],
            "scene.toml: there is no appended data",
        ),
        (vec!["picture", "/none", "displacement"], "/none: "),
        (
            vec!["picture", &out, "displacement", "--deformed=1e300"],
            "`auto` or a factor of at most 1e12",
        ),
        (
            vec!["plot", &snapshot, "displacement"],
            "snapshots_00003.vtu is a file",
        ),
        (
            vec!["plot", &out, "top.ux", "--damping", "5%"],
            "give `--of response`",
        ),
    ] {
        let output = block.powerhouse(&arguments);
        let errors = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {errors}");
        assert!(errors.contains(expected), "{arguments:?}: {errors}");
    }
    // A summary that was cut off is a damaged file, and not a folder without results.
    let summary = block.out().join("summary.json");
    let whole = std::fs::read(&summary).unwrap();
    std::fs::write(&summary, &whole[..whole.len() / 2]).unwrap();
    let output = block.powerhouse(&["report", &out]);
    let errors = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{errors}");
    assert!(errors.contains("summary.json"), "{errors}");
}
