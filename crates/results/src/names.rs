//! Names of the files that a run will write.

use powerhouse_model::HistoryKind;

use crate::folder::{CLOSE_UP, ENVELOPE, SCENE, SNAPSHOTS, STAGES, STATE, SUMMARY};
use crate::vtu;
use powerhouse_scene::{Simulation, file_name};

/// Paths of the files that a run may write, relative to its folder; that of snapshots stands for all of them.
pub fn result_files(simulation: &Simulation) -> Vec<String> {
    let joints = simulation
        .joint_surfaces()
        .iter()
        .map(|(name, _)| name.as_str());
    let joints: Vec<&str> = joints.collect();
    let bolts: Vec<&str> = simulation
        .bolts()
        .iter()
        .map(|bolts| bolts.name.as_str())
        .collect();
    let mut files: Vec<String> = [SUMMARY, SCENE, ENVELOPE, STATE, SNAPSHOTS]
        .into_iter()
        .map(str::to_owned)
        .collect();
    files.extend(simulation.table_files());
    let mut add = |folder: &str, name: &str, end: &str| {
        files.push(format!("{folder}/{}{end}", file_name(name)));
    };
    let peaks = simulation.history_variables().iter();
    let peaks = peaks.filter(|variable| variable.kind == HistoryKind::Amount);
    for name in vtu::ENVELOPES.into_iter().chain(peaks.map(|v| v.name)) {
        add("pictures", name, ".png");
        add("pictures", &format!("{name}-{CLOSE_UP}"), ".png");
    }
    for joint in &joints {
        add("joints", joint, ".vtu");
        for (what, ..) in crate::joints::PICTURES {
            add("pictures", &format!("joint-{joint}-{what}"), ".png");
        }
    }
    for (number, stage) in simulation.stages().iter().enumerate() {
        let stage = format!("{}-{}", number + 1, stage.name());
        add(STAGES, &stage, ".vtu");
        for joint in &joints {
            add(STAGES, &format!("{stage}-{joint}"), ".vtu");
        }
        for bolts in &bolts {
            add(STAGES, &format!("{stage}-{bolts}"), ".csv");
        }
    }
    if simulation.output().snapshots.is_some() {
        add("snapshots", "snapshots_00000", ".vtu");
        for joint in &joints {
            add("snapshots", &format!("snapshots_00000_{joint}"), ".vtu");
        }
    }
    if !cfg!(feature = "pictures") {
        let is_drawn = |file: &str| file.starts_with("plots/") || file.starts_with("pictures/");
        files.retain(|file| !is_drawn(file));
    }
    files
}
