//! What a run records.

use powerhouse_explicit_core::observe::{Cut, Motion, Place, SnapshotFields, Spot};
use powerhouse_model::{Mesh, Vec3};

use super::{Names, vector};
use crate::fault::{Fault, Problem};
use crate::format::{At, Finite, History, Output, Positive, Quantity, Section};
use crate::output::{CutWish, EnvelopeWish, HistoryWish, OutputPlan, RelativeWish, SnapshotWish};

/// Looks at the energies during a run, unless the scene says otherwise.
const ENERGY_LOOKS: f64 = 100.0;

pub(super) fn plan(names: &Names, output: &Output, duration: f64) -> Result<OutputPlan, Fault> {
    let mut plan = OutputPlan::default();
    if let Some(every) = output.every {
        plan.every = every.get();
    }
    let mut used: Vec<&str> = Vec::new();
    let all_names = (output.histories.iter().map(|history| &history.name))
        .chain(output.relative.iter().map(|relative| &relative.name))
        .chain(output.sections.iter().map(|section| &section.name));
    for name in all_names {
        if used.contains(&name.as_str()) {
            let (what, name_of) = ("result", name.to_string());
            let problem = Problem::Duplicate {
                what,
                name: name_of,
            };
            return Err(Fault::new(name.span(), problem));
        }
        used.push(name);
    }
    for history in &output.histories {
        plan.histories.push(HistoryWish {
            name: history.name.to_string(),
            place: place(names, history)?,
            motion: motion(&history.quantities),
            stress: history.quantities.contains(&Quantity::Stress),
        });
    }
    for relative in &output.relative {
        plan.relative.push(RelativeWish {
            name: relative.name.to_string(),
            at: spot(names.mesh, &relative.at)?.into(),
            from: spot(names.mesh, &relative.from)?.into(),
        });
    }
    for section in &output.sections {
        plan.cuts.push(cut(names, section)?);
    }
    plan.energies = Some(
        output
            .energies
            .map_or(duration / ENERGY_LOOKS, Positive::get),
    );
    if let Some(envelope) = &output.envelope {
        let mut sets = Vec::new();
        for set in envelope.sets.iter().flatten() {
            names.elements(set)?;
            sets.push(set.to_string());
        }
        plan.envelope = Some(EnvelopeWish {
            motion: motion(&envelope.quantities),
            stress: envelope.quantities.contains(&Quantity::Stress),
            sets,
            every: envelope.every.map_or(plan.every, Positive::get),
        });
    }
    plan.snapshots = output.snapshots.as_ref().map(|snapshots| SnapshotWish {
        fields: SnapshotFields {
            motion: motion(&snapshots.quantities),
            stress: snapshots.quantities.contains(&Quantity::Stress),
        },
        every: snapshots.every.get(),
    });
    Ok(plan)
}

fn motion(quantities: &[Quantity]) -> Motion {
    Motion {
        displacement: quantities.contains(&Quantity::Displacement),
        velocity: quantities.contains(&Quantity::Velocity),
        acceleration: quantities.contains(&Quantity::Acceleration),
    }
}

fn place(names: &Names, history: &History) -> Result<Place, Fault> {
    match (&history.at, &history.node, &history.set) {
        (Some(at), None, None) => Ok(spot(names.mesh, at)?.into()),
        (None, Some(node), None) if names.mesh.node_tags().contains(node) => {
            Ok(Place::Node(**node))
        }
        (None, Some(node), None) => Err(Fault::new(
            node.span(),
            Problem::NoSuchName {
                what: "node",
                name: node.to_string(),
                available: Vec::new(),
            },
        )),
        (None, None, Some(set)) => {
            names.nodes(set)?;
            Ok(Place::NodeSet(set.to_string()))
        }
        (at, node, set) => Err(Fault::new(
            history.name.span(),
            Problem::OneOf {
                keys: &["at", "node", "set"],
                found: [at.is_some(), node.is_some(), set.is_some()]
                    .iter()
                    .filter(|given| **given)
                    .count(),
            },
        )),
    }
}

/// A point, if it lies in the mesh.
fn spot(mesh: &Mesh, at: &At<[Finite; 3]>) -> Result<Vec3, Fault> {
    let point = vector(at);
    let all: Vec<u32> = (0..mesh.element_count() as u32).collect();
    mesh.locate_among(&all, &[point], Spot::at(point).tolerance)
        .map_err(|error| Fault::refused(at.span(), error))?;
    Ok(point)
}

fn cut(names: &Names, section: &Section) -> Result<CutWish, Fault> {
    names.elements(&section.set)?;
    let point = vector(&section.at);
    Ok(CutWish {
        cut: Cut {
            name: section.name.to_string(),
            point,
            normal: vector(&section.normal),
            along: vector(&section.along),
            within: section.reach.map(|reach| {
                let half = Vec3::repeat(reach.get());
                (point - half, point + half)
            }),
        },
        set: section.set.to_string(),
    })
}
