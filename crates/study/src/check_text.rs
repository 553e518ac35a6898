//! The report of a check as text.

use core::fmt::{self, Write};

use powerhouse::engine::Drainage;
use powerhouse::engine::observe::SectionGeometry;
use powerhouse::model::Vec3;
use powerhouse::{FibreChoice, OF_FIBRES_ALONE, Remark, Results, StageOverview, merge_messages};

use crate::Cost;
use crate::check::{CheckReport, Warning};
use crate::static_cost::StaticCost;
use crate::text::{self, bytes, duration, line};

/// Share of a step (%) below which a check does not list a part of its own.
const LEAST_SHARE: f64 = 2.0;

/// The report as text in lines, of which the last one is ended too.
impl fmt::Display for CheckReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut out = String::new();
        whole(&mut out, self);
        f.write_str(&out)
    }
}

/// Writes the report of a check.
fn whole(out: &mut String, report: &CheckReport) {
    let quality = &report.quality;
    line!(out, "{}", report.title);
    line!(out, "\nmesh");
    line!(
        out,
        "  {} nodes, {} elements",
        report.nodes,
        report.elements
    );
    let (low, high) = &report.extent;
    line!(out, "  {} to {} m", point(low), point(high));
    line!(
        out,
        "  edges {:.3} to {:.3} m, aspect ratio of an element at most {:.2}",
        quality.shortest_edge,
        quality.longest_edge,
        quality.largest_aspect
    );
    line!(
        out,
        "  least scaled Jacobian {:.3}, element {}",
        quality.least_scaled_jacobian,
        quality.worst_element
    );
    line!(out, "\nsets");
    for set in &report.sets {
        line!(
            out,
            "  {:<16} {} {}, {} to {} m",
            set.set,
            set.count,
            set.of,
            point(&set.low),
            point(&set.high)
        );
    }
    line!(
        out,
        "\nresolved frequencies, with ten elements per shear wavelength"
    );
    for part in &report.resolution {
        line!(
            out,
            "  {:<16} {:>7.2} Hz  (shear wave speed {:.0} m/s, edges up to {:.2} m)",
            part.set,
            part.frequency,
            part.s_speed,
            part.longest_edge
        );
    }
    if !report.joints.is_empty() {
        line!(out, "\njoints");
    }
    for joint in &report.joints {
        let [first, second] = joint.worst_nodes;
        line!(
            out,
            "  {:<16} {}, {} node pairs on {:.2} m2, paired nodes at most {:.2e} m apart ({first} and {second})",
            joint.name,
            joint.law,
            joint.pairs,
            joint.area,
            joint.worst_gap
        );
        line!(
            out,
            "  {:<16} shortest edge {:.3} m: slip and opening are small up to about {:.3} m",
            "",
            joint.shortest_edge,
            Results::SMALL_SLIP * joint.shortest_edge
        );
    }
    sections(out, &report.sections);
    stages(out, &report.stages);
    let of_part = |remark: &&Remark| matches!(remark, Remark::FlatDamping(_) | Remark::Rim(_));
    if report.remarks.iter().any(|remark| of_part(&remark)) {
        line!(out, "\nparts");
        out.push_str(&text::of_remarks(report.remarks.iter().filter(of_part)));
    }
    let others = text::of_remarks(report.remarks.iter().filter(|remark| !of_part(remark)));
    if !others.is_empty() {
        line!(out, "\nground motion");
        out.push_str(&others);
    }
    line!(out, "\nrun");
    let cost = &report.cost;
    out.push_str(&text::of_step(&report.stable, cost.step));
    line!(
        out,
        "{} steps, about {} wall time",
        cost.steps,
        duration(cost.wall_time)
    );
    if cost.iterates {
        line!(
            out,
            "up to {} times as long where much yields, cracks or slips: a step of a bay then takes several iterations, and those that were timed have one",
            Cost::LONGER
        );
    }
    if let Some(profile) = &cost.profile {
        line!(
            out,
            "shares of a step, from {} steps at the start of the run, before anything yields or slips:",
            profile.steps
        );
        out.push_str(&text::of_profile(profile, LEAST_SHARE));
    }
    if let Some(stages) = &cost.stages {
        static_cost(out, stages);
    }
    if let Some(time) = cost.self_check {
        line!(
            out,
            "about {} wall time for the free-field check before the run",
            duration(time)
        );
    }
    line!(
        out,
        "about {} memory, at most {} of result files",
        bytes(cost.memory),
        bytes(cost.output)
    );
    if let Some(second) = cost.memory_of_format {
        line!(
            out,
            "about {} memory before the run, while the error of the number format is measured against double precision; without so much the run goes on, and a warning says that it is not measured",
            bytes(second)
        );
    }
    if let Some(format) = &report.format {
        line!(out, "{format}");
    }
    fibres(out, &report.fibres);
    if !report.savings.is_empty() {
        line!(out, "\nchanges that save most");
    }
    for saving in &report.savings {
        line!(out, "  {saving}");
    }
    for change in &report.refused {
        line!(out, "  {change}");
    }
    let warnings = merge_messages(report.warnings.iter().map(Warning::message));
    match warnings.len() {
        0 => line!(out, "\nno warnings"),
        count => line!(out, "\n{count} warning(s)"),
    }
    for warning in warnings {
        line!(out, "  {}", warning.text);
    }
}

/// Writes what fibres would do.
fn fibres(out: &mut String, choices: &[FibreChoice]) {
    if !choices.is_empty() {
        line!(
            out,
            "\nfibres across thin parts (`fibres` in [time]): step, fibres by their number of nodes, estimated decrease of frequencies, and errors {OF_FIBRES_ALONE}"
        );
    }
    for choice in choices {
        let shift = choice.shift.map_or_else(String::new, |shift| {
            let natural = format!(
                "; first frequency of the structure, {:.1} Hz held at the ground: -{:.2} %",
                shift.natural,
                100.0 * shift.of_natural
            );
            match shift.of_input {
                Some(input) => format!(
                    "{natural}; motion at {:.1} Hz, the highest of the input: about -{:.2} %; errors of accelerations and shear forces about {:.1e}, of axial forces and moments {:.1e}",
                    input.frequency, 100.0 * input.shift, input.of_accelerations, input.of_forces
                ),
                None => natural,
            }
        });
        line!(
            out,
            "  {:<4} step {:.2} times as long, {:.0} % fewer steps; {} in {}{shift}",
            choice.factor,
            choice.gain(),
            100.0 * (1.0 - 1.0 / choice.gain()),
            choice.sizes_text(),
            choice.sets.join(", ")
        );
    }
}

/// Writes the geometry of the sections.
fn sections(out: &mut String, sections: &[SectionGeometry]) {
    if !sections.is_empty() {
        line!(out, "\nsections");
    }
    for section in sections {
        let pieces = match section.pieces.len() {
            ..=1 => String::new(),
            count => format!(", in {count} pieces that do not touch"),
        };
        line!(
            out,
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
fn point(position: &Vec3) -> String {
    format!("({:.3}, {:.3}, {:.3})", position.x, position.y, position.z)
}

/// Writes the predicted cost of the stages.
fn static_cost(out: &mut String, stages: &StaticCost) {
    let (time, taken) = (duration(stages.wall_time), stages.timed);
    if stages.uncertainty > 1.0 {
        line!(
            out,
            "about {time} wall time for the stages before the run, within a factor of {} ({} corrections predicted, {taken} of them timed)",
            stages.uncertainty,
            stages.corrections
        );
    } else {
        line!(
            out,
            "{time} wall time for the stages before the run, which took {taken} corrections"
        );
    }
    for stage in &stages.unknown {
        line!(
            out,
            "  without '{stage}', whose dynamic relaxation takes an unknown number of steps"
        );
    }
    line!(
        out,
        "about {} memory during the stages",
        bytes(stages.memory)
    );
}

/// Writes the stages before a run.
fn stages(out: &mut String, stages: &[StageOverview]) {
    if !stages.is_empty() {
        line!(out, "\nstages");
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
        actions.extend(stage.water.iter().map(|water| {
            let of = (water.set.as_ref()).map_or(String::new(), |set| format!(" of '{set}'"));
            match water.pressure.level() {
                Some(level) => format!("water level{of} at z = {level} m"),
                None => format!("water pressures{of} of a table"),
            }
        }));
        if stage.drainage == Drainage::Undrained {
            actions.push("undrained".into());
        }
        if stage.options.release < 1.0 {
            actions.push(format!("{} % released", 100.0 * stage.options.release));
        }
        if stage.options.increments > 1 {
            actions.push(format!("{} increments", stage.options.increments));
        }
        if actions.is_empty() {
            actions.push("static equilibrium".into());
        }
        line!(out, "  {:<16} {}", stage.name, actions.join(", "));
    }
}
