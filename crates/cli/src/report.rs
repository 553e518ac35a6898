//! What is printed.

use std::path::PathBuf;
use std::time::Duration;

use crate::terminal::say;
use powerhouse::engine::{Ended, StableStep};
use powerhouse::model::{LimitingTerm, Mesh};
use powerhouse::{
    CompletedStage, Error, Remark, Results, RunNotes, Simulation, StageOverview, Topic, together,
};
use powerhouse_study::{CheckReport, FreeFieldReport, PointError, StaticCost, Warning};

pub(crate) fn before_run(simulation: &mut Simulation, warnings: &[Warning]) -> Result<(), Error> {
    let mesh = simulation.mesh().clone();
    say!("{}", simulation.title());
    say!(
        "{} nodes, {} elements",
        mesh.node_count(),
        mesh.element_count()
    );
    // Some remarks need the step.
    simulation.step()?;
    remarks(simulation.remarks());
    for warning in together(warnings.iter().map(Warning::doubt)) {
        say!("warning: {}", warning.text);
    }
    let stable = simulation.stable_step()?;
    step(&stable, simulation.step()?);
    Ok(())
}

fn remarks<'r>(remarks: impl IntoIterator<Item = &'r Remark>) {
    let (doubts, facts): (Vec<&Remark>, Vec<&Remark>) =
        remarks.into_iter().partition(|remark| remark.is_warning());
    for fact in together(facts.into_iter().map(Remark::doubt)) {
        say!("{}", fact.text);
    }
    for doubt in together(doubts.into_iter().map(Remark::doubt)) {
        say!("warning: {}", doubt.text);
    }
}

fn step(stable: &StableStep, step: f64) {
    say!(
        "step {step:.4e} s; stable up to {:.4e} s, limited by the {} of element {} in '{}' ({} alike)",
        stable.step,
        match stable.term {
            LimitingTerm::Stiffness => "size and stiffness",
            LimitingTerm::StiffnessDamping => "stiffness damping",
            LimitingTerm::MassDamping => "mass damping",
        },
        stable.element,
        stable.set,
        stable.similar_elements,
    );
    if let Some(next) = stable.next_set_bound {
        say!(
            "without its worst elements in '{}' the step could grow {:.2} times",
            stable.set,
            next / stable.element_bound
        );
    }
}

pub(crate) fn free_field(report: &FreeFieldReport) {
    let [x, y, z] = report.cells;
    say!(
        "free field without the structure: {x} x {y} x {z} bricks, step {:.3e} s, {:.2} s computed",
        report.step,
        report.window
    );
    errors(&report.points);
    if let Some(points) = &report.damped {
        say!("the same with the damping of the ground, which the free field does not have:");
        errors(points);
    }
}

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

pub(crate) fn check(report: &CheckReport) {
    let quality = &report.quality;
    say!("{}", report.title);
    say!("\nmesh");
    say!("  {} nodes, {} elements", report.nodes, report.elements);
    say!(
        "  edges {:.3} to {:.3} m, longest to shortest in one element at most {:.2}",
        quality.shortest_edge,
        quality.longest_edge,
        quality.largest_aspect
    );
    say!(
        "  least scaled Jacobian {:.3}, element {}",
        quality.least_scaled_jacobian,
        quality.worst_element
    );
    say!("\nfrequencies carried with ten elements per wavelength of shear waves");
    for part in &report.resolution {
        say!(
            "  {:<16} {:>7.2} Hz  ({:.0} m/s, edges up to {:.2} m)",
            part.set,
            part.frequency,
            part.s_speed,
            part.longest_edge
        );
    }
    if !report.joints.is_empty() {
        say!("\njoints");
    }
    for joint in &report.joints {
        let [first, second] = joint.worst_nodes;
        say!(
            "  {:<16} {}, {} pairs on {:.2} m2, nodes at most {:.2e} m apart ({first} and {second})",
            joint.name,
            joint.law,
            joint.pairs,
            joint.area,
            joint.worst_gap
        );
        say!(
            "  {:<16} edges from {:.3} m on: slip and opening are small up to about {:.3} m",
            "",
            joint.shortest_edge,
            Results::SMALL_SLIP * joint.shortest_edge
        );
    }
    stages(&report.stages);
    let of_part =
        |remark: &&Remark| matches!(remark, Remark::FlatDamping { .. } | Remark::Rim { .. });
    if report.remarks.iter().any(|remark| of_part(&remark)) {
        say!("\nparts");
        remarks(report.remarks.iter().filter(of_part));
    }
    say!("\nground motion");
    remarks(report.remarks.iter().filter(|remark| !of_part(remark)));
    say!("\nrun");
    let cost = &report.cost;
    step(&report.stable, cost.step);
    say!(
        "{} steps, about {} of wall time",
        cost.steps,
        duration(cost.wall_time)
    );
    if let Some(stages) = &cost.stages {
        static_cost(stages);
    }
    if let Some(time) = cost.self_check {
        say!("about {} before it to check the free field", duration(time));
    }
    say!(
        "about {} of memory, at most {} of files",
        bytes(cost.memory),
        bytes(cost.output)
    );
    if let Some(format) = &report.format {
        say!("{format}");
    }
    if !report.savings.is_empty() {
        say!("\nwhat would save most");
    }
    for saving in &report.savings {
        say!("  {saving}");
    }
    for change in &report.refused {
        say!("  {change}");
    }
    let warnings = together(report.warnings.iter().map(Warning::doubt));
    match warnings.len() {
        0 => say!("\nno warnings"),
        count => say!("\n{count} warning(s)"),
    }
    for warning in warnings {
        say!("  {}", warning.text);
    }
}

/// What stages will cost.
fn static_cost(stages: &StaticCost) {
    let (time, taken) = (duration(stages.wall_time), stages.timed);
    if stages.uncertainty > 1.0 {
        say!(
            "about {time} before it for the stages, within a factor of {} ({} corrections expected, of which {taken} were timed)",
            stages.uncertainty,
            stages.corrections
        );
    } else {
        say!("{time} before it for the stages, which took {taken} corrections");
    }
    for stage in &stages.unknown {
        say!("  without '{stage}', whose relaxation takes an unknown number of steps");
    }
    say!("about {} of memory meanwhile", bytes(stages.memory));
}

/// The stages before a run.
fn stages(stages: &[StageOverview]) {
    if !stages.is_empty() {
        say!("\nstages");
    }
    for stage in stages {
        let mut does = Vec::new();
        let mut count = |number: usize, what: &str| {
            if number > 0 {
                does.push(format!("{number} {what}"));
            }
        };
        count(stage.excavated, "elements excavated");
        count(stage.cast, "elements cast");
        count(stage.supports, "supports");
        count(stage.loads, "loads");
        count(stage.removed_loads, "loads taken off");
        for (name, number) in &stage.bolts {
            count(*number, &format!("bolts of '{name}'"));
        }
        for (set, law) in &stage.materials {
            does.push(format!("'{set}' of another material ({law})"));
        }
        does.extend(stage.tied.iter().map(|joint| format!("'{joint}' tied")));
        does.extend(
            stage
                .bonded
                .iter()
                .map(|joint| format!("'{joint}' bonded anew")),
        );
        if stage.options.release < 1.0 {
            does.push(format!("{} % released", 100.0 * stage.options.release));
        }
        if stage.options.increments > 1 {
            does.push(format!("{} increments", stage.options.increments));
        }
        if does.is_empty() {
            does.push("comes to rest".into());
        }
        say!("  {:<16} {}", stage.name, does.join(", "));
    }
}

/// What a stage came to.
pub(crate) fn stage(stage: &CompletedStage) {
    let (report, solution) = (stage.report, &stage.report.solution);
    say!(
        "stage {} of {}, '{}': {} increments, {} corrections, {:.1e} of the load out of balance, moved by {:.3e} m at node {}",
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

/// How a run ended.
pub(crate) fn end_of_run(mesh: &Mesh, results: &Results) {
    let run = &results.run;
    let how = match &run.ended {
        Ended::Completed => "completed".into(),
        Ended::Stopped => "interrupted".into(),
        Ended::Observer(name) => format!("ended by {name}"),
        Ended::Failed(_) => "failed".into(),
    };
    let wall = results.wall_time.as_secs_f64();
    say!(
        "{how}: {} steps to t = {:.3} s in {wall:.1} s, {:.0} ns per element and step",
        run.steps,
        run.time,
        1e9 * wall / (run.steps as f64 * mesh.element_count() as f64),
    );
}

/// What a run found and wrote.
pub(crate) fn results(mesh: &Mesh, results: &Results, (notes, files): (&RunNotes, &[PathBuf])) {
    say!("\npeaks\n{}", results.peaks(mesh));
    let doubts = notes.remarks.iter().filter(|remark| remark.is_warning());
    // Beside the figures that they are about, once more.
    remarks(doubts.filter(|doubt| doubt.topic() == Topic::Sections));
    energies(results);
    joints(mesh, results);
    bolts(results);
    remarks(&results.doubts(mesh));
    say!("\nfiles");
    for file in files {
        say!("  {}", file.display());
    }
}

/// What bolts bear.
fn bolts(results: &Results) {
    if !results.bolts.is_empty() {
        say!("\nbolts");
    }
    for forces in &results.bolts {
        if let Some((bolt, force)) = forces.greatest() {
            let name = &forces.name;
            say!(
                "  {name:<20} at most {force:.3e} N at the end, in bolt {}",
                bolt + 1
            );
        }
    }
}

/// Final contact state and peak values of joints.
fn joints(mesh: &Mesh, results: &Results) {
    let outcomes = &results.joint_outcomes;
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
            let place = if value > 0.0 { at(pair) } else { String::new() };
            format!("{what} {value:.3e} m {place}")
                .trim_end()
                .to_owned()
        };
        say!(
            "  {:<20} {}; {}",
            outcome.name,
            began("slid", outcome.slipped, outcome.first_slip),
            most("slip", outcome.slip),
        );
        say!(
            "  {:<20} {}; {}",
            "",
            began("opened", outcome.opened, outcome.first_crack),
            most("opening", outcome.peak_opening),
        );
        say!(
            "  {:<20} bond broken on {:.1} %, none ever on {:.1} %; friction {:.3e} J, bond {:.3e} J, impact {:.3e} J",
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
            "  pairs of '{}' that share nodes took {} sweeps at most, the last one changed motion by {:.1e} at most",
            joint.name,
            joint.most_sweeps,
            joint.worst_residual
        );
    }
}

/// The energies that were ever other than zero, and what the balance leaves.
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

/// A time in seconds, minutes or hours.
fn duration(time: Duration) -> String {
    match time.as_secs_f64() {
        s if s < 120.0 => format!("{s:.1} s"),
        s if s < 7200.0 => format!("{:.1} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}

/// A number of bytes.
fn bytes(count: u64) -> String {
    match count as f64 {
        b if b < 1e6 => format!("{:.0} kB", b / 1e3),
        b if b < 1e9 => format!("{:.0} MB", b / 1e6),
        b => format!("{:.1} GB", b / 1e9),
    }
}
