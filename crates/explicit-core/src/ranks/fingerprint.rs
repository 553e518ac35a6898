//! Checksum of the specification of a model, by which ranks find that theirs differ.

use powerhouse_model::{Checksum, ConstraintParts, ModelSpec, NodalLoad, TimeFunction, encode};

/// Times (s) at which functions of time are compared.
const TIMES: [f64; 4] = [0.0, 0.017, 0.43, 3.1];

fn add_nodes(sum: &mut Checksum, nodes: &[u32]) {
    let bytes: Vec<u8> = nodes.iter().flat_map(|node| node.to_le_bytes()).collect();
    sum.add_whole(&bytes);
}

fn add_function(sum: &mut Checksum, function: &dyn TimeFunction) {
    for time in TIMES {
        sum.add_number(function.value(time).to_bits());
    }
}

fn add_loads(sum: &mut Checksum, loads: &[Box<dyn NodalLoad>]) {
    sum.add_number(loads.len() as u64);
    for load in loads {
        sum.add_whole(load.name().as_bytes());
        add_nodes(sum, load.nodes());
    }
}

/// Checksum of all that can be compared: the mesh, the sets with their options, and nodes, directions, names and functions of
/// time of boundary conditions, loads, constraints and embedded elements. Parameters of laws are not among them.
pub(crate) fn fingerprint(spec: &ModelSpec) -> u64 {
    let mut sum = Checksum::default();
    sum.add_mesh(spec.mesh);
    sum.add_whole(format!("{:?}", spec.block_size).as_bytes());
    for (choice, factory) in &spec.sets {
        let set = format!("{choice:?} {} {:?}", factory.label(), factory.options());
        sum.add_whole(set.as_bytes());
    }
    sum.add_whole(format!("{:?} {:?}", spec.supports, spec.periodic).as_bytes());
    for prescribed in &spec.prescribed {
        add_nodes(&mut sum, &prescribed.nodes);
        sum.add_whole(format!("{:?}", prescribed.direction).as_bytes());
        add_function(&mut sum, prescribed.displacement.as_ref());
    }
    add_loads(&mut sum, &spec.loads);
    for (acceleration, function) in &spec.weights {
        sum.add_whole(format!("{acceleration:?}").as_bytes());
        add_function(&mut sum, function.as_ref());
    }
    for parts in &spec.boundaries {
        sum.add_whole(format!("{:?}", parts.impedance).as_bytes());
        add_loads(&mut sum, &parts.loads);
        sum.add_number(parts.blocks.len() as u64);
    }
    sum.add_whole(format!("{:?}", spec.added_masses).as_bytes());
    for constraint in &spec.constraints {
        sum.add_whole(constraint.name().as_bytes());
        add_nodes(&mut sum, constraint.nodes());
        add_nodes(&mut sum, ConstraintParts::of(constraint.as_ref()).nodes());
    }
    for embedded in &spec.embedded {
        let hosts = format!("{} {:?}", embedded.name(), embedded.hosts());
        sum.add_whole(hosts.as_bytes());
    }
    // A state that cannot be encoded is not compared.
    let start = spec.start.as_ref().and_then(|start| encode(start).ok());
    sum.add_whole(&start.unwrap_or_default());
    sum.value()
}
