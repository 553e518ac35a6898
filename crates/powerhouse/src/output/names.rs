//! Names of the files that a run will write.

use powerhouse_model::{HistoryKind, HistoryVariable};

use super::file_name;
use super::folder::{CLOSE_UP, ENVELOPE, SCENE, SNAPSHOTS, STAGES, STATE, SUMMARY, TABLES};
use super::{OutputPlan, joints, vtu};

/// Output plan and named objects of a run, after which files are named.
pub(crate) struct Named<'n> {
    pub(crate) plan: &'n OutputPlan,
    pub(crate) joints: Vec<&'n str>,
    pub(crate) stages: Vec<&'n str>,
    pub(crate) bolts: Vec<&'n str>,
    /// History variables of the laws.
    pub(crate) variables: &'n [HistoryVariable],
}

impl Named<'_> {
    /// Paths of the files that the run may write, relative to its folder.
    pub(crate) fn files(&self) -> Vec<String> {
        let plan = self.plan;
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
        for name in self.joints.iter().copied().chain(requested) {
            add("plots", &format!("joint-{name}"), ".svg");
        }
        let peaks = self.variables.iter();
        let peaks = peaks.filter(|variable| variable.kind == HistoryKind::Amount);
        for name in vtu::ENVELOPES.into_iter().chain(peaks.map(|v| v.name)) {
            add("pictures", name, ".png");
            add("pictures", &format!("{name}-{CLOSE_UP}"), ".png");
        }
        for joint in &self.joints {
            add("joints", joint, ".vtu");
            for (what, ..) in joints::PICTURES {
                add("pictures", &format!("joint-{joint}-{what}"), ".png");
            }
        }
        for bolts in &self.bolts {
            add("plots", &format!("bolts-{bolts}"), ".svg");
            add("bolts", bolts, ".csv");
        }
        for (number, stage) in self.stages.iter().enumerate() {
            let stage = format!("{}-{stage}", number + 1);
            add(STAGES, &stage, ".vtu");
            for joint in &self.joints {
                add(STAGES, &format!("{stage}-{joint}"), ".vtu");
            }
            for bolts in &self.bolts {
                add(STAGES, &format!("{stage}-{bolts}"), ".csv");
            }
        }
        if plan.snapshots.is_some() {
            add("snapshots", "snapshots_00000", ".vtu");
            for joint in &self.joints {
                add("snapshots", &format!("snapshots_00000_{joint}"), ".vtu");
            }
        }
        if !cfg!(feature = "pictures") {
            let is_drawn = |file: &str| file.starts_with("plots/") || file.starts_with("pictures/");
            files.retain(|file| !is_drawn(file));
        }
        files
    }
}
