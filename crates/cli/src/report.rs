//! Printed reports.

use std::collections::BTreeMap;
use std::path::PathBuf;

use crate::terminal::{say, say_warning};
use powerhouse::engine::Ended;
use powerhouse::engine::observe::{PeakRow, PeakTable};
use powerhouse::model::{Mesh, StepProfile, Vec3};
use powerhouse::summary::FibreSummary;
use powerhouse::{
    CompletedStage, Error, Message, Results, RunNotes, Simulation, Topic, merge_messages,
};
use powerhouse_study::{FreeFieldReport, PointError, text};

/// Prints lines of text, those that begin with `warning: ` as warnings.
pub(crate) fn lines(text: &str) {
    for line in text.lines() {
        match line.strip_prefix("warning: ") {
            Some(warning) => say_warning!("{warning}"),
            None => say!("{line}"),
        }
    }
}

/// Prints size, remarks, warnings and stable step of a simulation before its run.
pub(crate) fn before_run(simulation: &mut Simulation, warnings: &[Message]) -> Result<(), Error> {
    let mesh = simulation.mesh().clone();
    say!("{}", simulation.title());
    say!(
        "{} nodes, {} elements",
        mesh.node_count(),
        mesh.element_count()
    );
    // Some remarks are made only when the step is known.
    simulation.step()?;
    lines(&text::of_remarks(simulation.remarks()));
    for warning in merge_messages(warnings.iter().cloned()) {
        say_warning!("{}", warning.text);
    }
    let stable = simulation.stable_step()?;
    lines(&text::of_step(&stable, simulation.step()?));
    Ok(())
}

/// Prints the report of a free-field check.
pub(crate) fn free_field(report: &FreeFieldReport) {
    let [x, y, z] = report.cells;
    say!(
        "free field without the structure: {x} x {y} x {z} hexahedra, step {:.3e} s, {:.2} s computed",
        report.step,
        report.window
    );
    errors(&report.points);
    if let Some(points) = &report.damped {
        say!("with the damping of the ground, which the free field does not have:");
        errors(points);
    }
}

/// Prints the errors at the points of a free-field check.
fn errors(points: &[PointError]) {
    for point in points {
        let p = point.position;
        say!(
            "  {:<10} ({:.2}, {:.2}, {:.2}): relative error {:.5} of displacement, {:.5} of velocity",
            point.name,
            p.x,
            p.y,
            p.z,
            point.displacement,
            point.velocity
        );
    }
}

/// A point as text.
pub(crate) fn point(position: &Vec3) -> String {
    format!("({:.3}, {:.3}, {:.3})", position.x, position.y, position.z)
}

/// Prints the result of a stage.
pub(crate) fn stage(stage: &CompletedStage) {
    let (report, solution) = (stage.report, &stage.report.solution);
    say!(
        "stage {} of {}, '{}': {} increments, {} corrections, residual {:.1e} of the load, largest displacement {:.3e} m in this stage, at node {}",
        stage.index + 1,
        stage.count,
        report.name,
        solution.increments,
        solution.corrections,
        solution.residual,
        report.largest_displacement.0,
        report.largest_displacement.1,
    );
}

/// Prints how a run ended, with its wall time.
pub(crate) fn end_of_run(mesh: &Mesh, results: &Results) {
    let run = &results.run;
    let how = match &run.ended {
        Ended::Completed => "completed".into(),
        Ended::Stopped => "interrupted".into(),
        Ended::Observer(name) => format!("ended by {name}"),
        Ended::Failed(_) => "failed".into(),
    };
    let with = if results.stages.is_empty() {
        ""
    } else {
        " with the construction stages"
    };
    let elements = match &results.present {
        Some(present) => present.iter().filter(|present| **present).count(),
        None => mesh.element_count(),
    };
    say!(
        "{how}: {} steps to t = {:.3} s in {:.1} s{with}, {:.3} ms a step, {:.0} ns per element and step",
        run.steps,
        run.time,
        results.wall_time.as_secs_f64(),
        1e3 * results.step_time.as_secs_f64(),
        1e9 * results.step_time.as_secs_f64() / elements.max(1) as f64,
    );
    if let Some(device) = &run.device {
        say!(
            "{} took {} of the steps, those that no output shows",
            device.name,
            device.steps
        );
    }
}

/// Prints the peak memory (bytes) of each process of a run, of which there are none where it is not known.
pub(crate) fn peak_memory(processes: &[u64]) {
    match processes {
        [] => {}
        [one] => say!("peak memory: {}", text::bytes(*one)),
        [first, others @ ..] => say!(
            "peak memory of a rank: {}, at most {} of those after the first, {} together, with what each has in memory of a packed mesh that they share",
            text::bytes(*first),
            text::bytes(others.iter().copied().max().unwrap_or_default()),
            text::bytes(processes.iter().sum())
        ),
    }
}

/// Prints the wall time of the parts of time steps.
pub(crate) fn profile(profile: &StepProfile) {
    say!(
        "\nwall time of {} steps: {:.3} ms each, of which {:.1} % are in the parts below",
        profile.steps,
        1e3 * profile.seconds / profile.steps as f64,
        100.0 * profile.covered()
    );
    lines(&text::of_profile(profile, 0.0));
}

/// Peaks of a run, of the sections around a lining the largest of each force alone: the table of the ring has the others.
fn brief_peaks(mesh: &Mesh, results: &Results) -> PeakTable {
    let mut peaks = results.peaks(mesh);
    for ring in &results.section_rings {
        let of_ring = |row: &PeakRow| {
            let (section, force) = row.name.rsplit_once('.')?;
            let mut sections = ring.sections.iter();
            let is_own = sections.any(|(_, name)| name == section);
            is_own.then(|| force.to_owned())
        };
        let mut largest: BTreeMap<String, f64> = BTreeMap::new();
        for row in &peaks.rows {
            if let Some(force) = of_ring(row) {
                let known = largest.entry(force).or_default();
                *known = known.max(row.value.abs());
            }
        }
        peaks.rows.retain(|row| {
            of_ring(row).is_none_or(|force| {
                // Of equal ones the first.
                let is_largest = largest.get(&force) == Some(&row.value.abs());
                is_largest && largest.remove(&force).is_some()
            })
        });
    }
    peaks
}

/// Prints the results of a run and its files.
pub(crate) fn results(mesh: &Mesh, results: &Results, (notes, files): (&RunNotes, &[PathBuf])) {
    say!("\npeaks\n{}", brief_peaks(mesh, results));
    let warnings = notes.remarks.iter().filter(|remark| remark.is_warning());
    // Repeated next to the results that they concern.
    let of_sections = warnings.filter(|warning| warning.topic() == Topic::Sections);
    lines(&text::of_remarks(of_sections));
    if let Some(fibres) = FibreSummary::of(results) {
        say!("fibres: {}", fibres.text());
    }
    energies(results);
    joints(mesh, results);
    bolts(results);
    lines(&text::of_remarks(&results.warnings(mesh)));
    say!("\nfiles");
    for file in files {
        say!("  {}", file.display());
    }
}

/// Prints the bolt forces at the end.
fn bolts(results: &Results) {
    if !results.bolts.is_empty() {
        say!("\nbolts");
    }
    for forces in &results.bolts {
        if let Some((bolt, force)) = forces.greatest() {
            let name = &forces.name;
            say!(
                "  {name:<20} greatest axial force {force:.3e} N at the end, in bolt {}",
                bolt + 1
            );
        }
    }
}

/// Prints final contact state and peak values of the joints.
fn joints(mesh: &Mesh, results: &Results) {
    let outcomes = &results.joint_outcomes;
    let firsts = outcomes
        .iter()
        .flat_map(|of| [of.first_slip, of.first_crack]);
    let after = text::after_first_slip(firsts.flatten().map(|(time, _)| time));
    if !outcomes.is_empty() {
        say!("\njoints");
    }
    for outcome in outcomes {
        let joint = results
            .joints
            .iter()
            .find(|joint| joint.name == outcome.joint);
        let at = |pair: usize| {
            let position = joint.map(|joint| mesh.positions()[joint.pairs[pair].nodes[0] as usize]);
            position.map_or_else(String::new, |p| {
                format!("at ({:.2}, {:.2}, {:.2})", p.x, p.y, p.z)
            })
        };
        let began = |what: &str, share: f64, first: Option<(f64, usize)>| match first {
            Some((time, pair)) => {
                format!(
                    "{:.1} % {what} from {time:.4} s on, first {}",
                    100.0 * share,
                    at(pair)
                )
            }
            None => format!("none {what}"),
        };
        let most = |what: &str, (value, pair): (f64, usize)| {
            let location = if value > 0.0 { at(pair) } else { String::new() };
            format!("{what} {value:.3e} m {location}")
                .trim_end()
                .to_owned()
        };
        say!(
            "  {:<20} {}; {}",
            outcome.name,
            began("slipped", outcome.slipped, outcome.first_slip),
            most("slip", outcome.slip),
        );
        say!(
            "  {:<20} {}; {}",
            "",
            began("opened", outcome.opened, outcome.first_crack),
            most("opening", outcome.peak_opening),
        );
        say!(
            "  {:<20} bond broken on {:.1} %, never bonded on {:.1} %; friction {:.3e} J, bond {:.3e} J, impact {:.3e} J",
            "",
            100.0 * outcome.broken,
            100.0 * outcome.never_bonded,
            outcome.friction,
            outcome.bond,
            outcome.impact,
        );
    }
    for joint in results.joints.iter().filter(|joint| joint.most_sweeps > 0) {
        say!(
            "  pairs of '{}' with shared nodes took at most {} sweeps, with a relative change of motion of at most {:.1e} in the last",
            joint.name,
            joint.most_sweeps,
            joint.worst_residual
        );
    }
    if let Some(after) = after {
        say!("  {after}");
    }
}

/// Prints all energies that were not always zero, and the residual of the balance.
fn energies(results: &Results) {
    let Some(residual) = results.energy_residual() else {
        return;
    };
    say!("energies at the end (J)");
    for (name, value) in results.energy_terms() {
        say!("  {name:<24} {value:>12.4e}");
    }
    let share = residual.share_of_input;
    let share = share.map_or(String::new(), |share| {
        format!("   {share:.1e} of the input work")
    });
    say!("  {:<24} {:>12.4e}{share}", "residual", residual.energy);
    say!(
        "  the residual was at most {:.1e} of the largest energy",
        residual.largest
    );
}
