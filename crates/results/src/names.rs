//! Names of the files that a run will write.

use powerhouse_model::HistoryKind;

use crate::folder::{CLOSE_UP, ENVELOPE, SCENE, SNAPSHOTS, STAGES, STATE, SUMMARY, TABLES};
use crate::vtu;
use powerhouse_scene::{Simulation, file_name};

/// Paths of the files that a run may write, relative to its folder; that of snapshots stands for all of them.
pub fn result_files(simulation: &Simulation) -> Vec<String> {
    let plan = simulation.output();
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
        .chain(TABLES)
        .map(str::to_owned)
        .collect();
    let mut add = |folder: &str, name: &str, end: &str| {
        files.push(format!("{folder}/{}{end}", file_name(name)));
    };
    let histories = plan.histories.iter().map(|request| &request.name);
    let stresses = plan.stresses.iter().chain(&plan.state.places);
    let cuts = plan.cuts.iter().map(|request| &request.cut.name);
    let names = histories
        .chain(stresses.map(|request| &request.name))
        .chain(plan.relative.iter().map(|request| &request.name))
        .chain(plan.sampled.iter().map(|request| &request.name))
        .chain(cuts);
    for name in names {
        add("plots", name, ".svg");
    }
    for ring in &plan.rings {
        add("rings", &ring.name, ".csv");
        add("plots", &format!("ring-{}", ring.name), ".svg");
    }
    for request in plan.cuts.iter().filter(|cut| cut.reinforcement.is_some()) {
        add("capacity", &request.cut.name, ".csv");
        add("plots", &format!("capacity-{}", request.cut.name), ".svg");
    }
    add("plots", "energies", ".svg");
    let requested = plan.joints.iter().map(|request| request.name.as_str());
    for name in joints.iter().copied().chain(requested) {
        add("plots", &format!("joint-{name}"), ".svg");
    }
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
    for bolts in &bolts {
        add("plots", &format!("bolts-{bolts}"), ".svg");
        add("bolts", bolts, ".csv");
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
    if plan.snapshots.is_some() {
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
