//! Printed reports.

use std::path::PathBuf;
use std::time::Duration;

use crate::terminal::{say, say_warning};
use powerhouse::engine::observe::SectionGeometry;
use powerhouse::engine::{Ended, StableStep};
use powerhouse::model::{LimitingTerm, Mesh, StepProfile, Vec3};
use powerhouse::{
    CompletedStage, Error, Remark, Results, RunNotes, Simulation, StageOverview, Topic,
    merge_messages,
};
use powerhouse_study::{CheckReport, FreeFieldReport, PointError, StaticCost, Warning};

/// Prints size, remarks, warnings and stable step of a simulation before its run.
pub(crate) fn before_run(simulation: &mut Simulation, warnings: &[Warning]) -> Result<(), Error> {
    let mesh = simulation.mesh().clone();
    say!("{}", simulation.title());
    say!(
        "{} nodes, {} elements",
        mesh.node_count(),
        mesh.element_count()
    );
    // Some remarks are made only when the step is known.
    simulation.step()?;
    remarks(simulation.remarks());
    for warning in merge_messages(warnings.iter().map(Warning::message)) {
        say_warning!("{}", warning.text);
    }
    let stable = simulation.stable_step()?;
    step(&stable, simulation.step()?);
    Ok(())
}

/// Prints remarks, then those with the rank of warnings.
fn remarks<'r>(remarks: impl IntoIterator<Item = &'r Remark>) {
    let (warnings, facts): (Vec<&Remark>, Vec<&Remark>) =
        remarks.into_iter().partition(|remark| remark.is_warning());
    for fact in merge_messages(facts.into_iter().map(Remark::message)) {
        say!("{}", fact.text);
    }
    for warning in merge_messages(warnings.into_iter().map(Remark::message)) {
        say_warning!("{}", warning.text);
    }
}

/// Prints the time step and the limit of the stable step.
fn step(stable: &StableStep, step: f64) {
    say!(
        "step {step:.4e} s; stable up to {:.4e} s, limited by the {} of element {} in '{}' ({} elements with a similar limit)",
        stable.step,
        match stable.term {
            LimitingTerm::Stiffness => "size and stiffness",
            term => term.name(),
        },
        stable.element,
        stable.set,
        stable.similar_elements,
    );
    if let Some(next) = stable.next_set_bound {
        say!(
            "without the limiting elements in '{}' the step could be {:.2} times as long",
            stable.set,
            next / stable.element_bound
        );
    }
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

/// Prints the report of a check.
pub(crate) fn check(report: &CheckReport) {
    let quality = &report.quality;
    say!("{}", report.title);
    say!("\nmesh");
    say!("  {} nodes, {} elements", report.nodes, report.elements);
    let (low, high) = &report.extent;
    say!("  {} to {} m", point(low), point(high));
    say!(
        "  edges {:.3} to {:.3} m, aspect ratio of an element at most {:.2}",
        quality.shortest_edge,
        quality.longest_edge,
        quality.largest_aspect
    );
    say!(
        "  least scaled Jacobian {:.3}, element {}",
        quality.least_scaled_jacobian,
        quality.worst_element
    );
    say!("\nsets");
    for set in &report.sets {
        say!(
            "  {:<16} {} {}, {} to {} m",
            set.set,
            set.count,
            set.of,
            point(&set.low),
            point(&set.high)
        );
    }
    say!("\nresolved frequencies, with ten elements per shear wavelength");
    for part in &report.resolution {
        say!(
            "  {:<16} {:>7.2} Hz  (shear wave speed {:.0} m/s, edges up to {:.2} m)",
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
            "  {:<16} {}, {} node pairs on {:.2} m2, paired nodes at most {:.2e} m apart ({first} and {second})",
            joint.name,
            joint.law,
            joint.pairs,
            joint.area,
            joint.worst_gap
        );
        say!(
            "  {:<16} shortest edge {:.3} m: slip and opening are small up to about {:.3} m",
            "",
            joint.shortest_edge,
            Results::SMALL_SLIP * joint.shortest_edge
        );
    }
    sections(&report.sections);
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
        "{} steps, about {} wall time",
        cost.steps,
        duration(cost.wall_time)
    );
    if let Some(profile) = &cost.profile {
        say!(
            "shares of a step, from {} steps at the start of the run, before anything yields or slips:",
            profile.steps
        );
        shares(profile, LEAST_SHARE);
    }
    if let Some(stages) = &cost.stages {
        static_cost(stages);
    }
    if let Some(time) = cost.self_check {
        say!(
            "about {} wall time for the free-field check before the run",
            duration(time)
        );
    }
    say!(
        "about {} memory, at most {} of result files",
        bytes(cost.memory),
        bytes(cost.output)
    );
    if let Some(format) = &report.format {
        say!("{format}");
    }
    if !report.savings.is_empty() {
        say!("\nchanges that save most");
    }
    for saving in &report.savings {
        say!("  {saving}");
    }
    for change in &report.refused {
        say!("  {change}");
    }
    let warnings = merge_messages(report.warnings.iter().map(Warning::message));
    match warnings.len() {
        0 => say!("\nno warnings"),
        count => say!("\n{count} warning(s)"),
    }
    for warning in warnings {
        say!("  {}", warning.text);
    }
}

/// Prints the geometry of the sections.
fn sections(sections: &[SectionGeometry]) {
    if !sections.is_empty() {
        say!("\nsections");
    }
    for section in sections {
        let pieces = match section.pieces.len() {
            ..=1 => String::new(),
            count => format!(", in {count} pieces that do not touch"),
        };
        say!(
            "  {:<16} {:.4} m2, {:.3} m along and {:.3} m across, {} elements about {} m{pieces}",
            section.name,
            section.area,
            section.width,
            section.depth,
            section.elements,
            point(&section.centroid)
        );
    }
}

/// A point as text.
pub(crate) fn point(position: &Vec3) -> String {
    format!("({:.3}, {:.3}, {:.3})", position.x, position.y, position.z)
}

/// Prints the predicted cost of the stages.
fn static_cost(stages: &StaticCost) {
    let (time, taken) = (duration(stages.wall_time), stages.timed);
    if stages.uncertainty > 1.0 {
        say!(
            "about {time} wall time for the stages before the run, within a factor of {} ({} corrections predicted, {taken} of them timed)",
            stages.uncertainty,
            stages.corrections
        );
    } else {
        say!("{time} wall time for the stages before the run, which took {taken} corrections");
    }
    for stage in &stages.unknown {
        say!("  without '{stage}', whose dynamic relaxation takes an unknown number of steps");
    }
    say!("about {} memory during the stages", bytes(stages.memory));
}

/// Prints the stages before a run.
fn stages(stages: &[StageOverview]) {
    if !stages.is_empty() {
        say!("\nstages");
    }
    for stage in stages {
        let mut actions = Vec::new();
        let mut count = |number: usize, what: &str| {
            if number > 0 {
                actions.push(format!("{number} {what}"));
            }
        };
        count(stage.excavated, "elements excavated");
        count(stage.cast, "elements cast");
        count(stage.supports, "supports");
        count(stage.loads, "loads");
        count(stage.removed_loads, "loads removed");
        for (name, number) in &stage.bolts {
            count(*number, &format!("bolts of '{name}'"));
        }
        for (set, law) in &stage.materials {
            actions.push(format!("new material of '{set}' ({law})"));
        }
        actions.extend(stage.tied.iter().map(|joint| format!("'{joint}' tied")));
        actions.extend(
            stage
                .bonded
                .iter()
                .map(|joint| format!("bond of '{joint}' renewed")),
        );
        if stage.options.release < 1.0 {
            actions.push(format!("{} % released", 100.0 * stage.options.release));
        }
        if stage.options.increments > 1 {
            actions.push(format!("{} increments", stage.options.increments));
        }
        if actions.is_empty() {
            actions.push("static equilibrium".into());
        }
        say!("  {:<16} {}", stage.name, actions.join(", "));
    }
}

/// Prints the result of a stage.
pub(crate) fn stage(stage: &CompletedStage) {
    let (report, solution) = (stage.report, &stage.report.solution);
    say!(
        "stage {} of {}, '{}': {} increments, {} corrections, residual {:.1e} of the load, largest displacement {:.3e} m at node {}",
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
    let with = match results.stages.is_empty() {
        true => "",
        false => " with the construction stages",
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
}

/// Prints the wall time of the parts of time steps.
pub(crate) fn profile(profile: &StepProfile) {
    say!(
        "\nwall time of {} steps: {:.3} ms each, of which {:.1} % are in the parts below",
        profile.steps,
        1e3 * profile.seconds / profile.steps as f64,
        100.0 * profile.covered()
    );
    shares(profile, 0.0);
}

/// Share of a step (%) below which a check does not list a part of its own.
const LEAST_SHARE: f64 = 2.0;

/// Prints the shares of the parts of a step; those below a share (%) together.
fn shares(profile: &StepProfile, least: f64) {
    let mut rest = 0.0;
    for row in &profile.rows {
        let share = 100.0 * row.seconds / profile.seconds;
        if share >= least {
            say!("  {share:5.1} %  {}", row.part);
        } else {
            rest += share;
        }
    }
    if rest > 0.0 {
        say!("  {rest:5.1} %  all other parts");
    }
}

/// Prints the results of a run and its files.
pub(crate) fn results(mesh: &Mesh, results: &Results, (notes, files): (&RunNotes, &[PathBuf])) {
    say!("\npeaks\n{}", results.peaks(mesh));
    let warnings = notes.remarks.iter().filter(|remark| remark.is_warning());
    // Repeated next to the results that they concern.
    remarks(warnings.filter(|warning| warning.topic() == Topic::Sections));
    energies(results);
    joints(mesh, results);
    bolts(results);
    remarks(&results.warnings(mesh));
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

/// A duration as text in seconds, minutes or hours.
pub(crate) fn duration(time: Duration) -> String {
    match time.as_secs_f64() {
        s if s < 120.0 => format!("{s:.1} s"),
        s if s < 7200.0 => format!("{:.1} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}

/// A number of bytes as text.
pub(crate) fn bytes(count: u64) -> String {
    match count as f64 {
        b if b < 1e6 => format!("{:.0} kB", b / 1e3),
        b if b < 1e9 => format!("{:.0} MB", b / 1e6),
        b => format!("{:.1} GB", b / 1e9),
    }
}
