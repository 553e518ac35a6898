//! Joint facets with their fields, for ParaView.

use std::path::Path;

use powerhouse_contact::JointSurface;
use powerhouse_explicit_core::observe::JointTable;
use powerhouse_io::{FieldPrecision, IoError, VtuField, VtuWriter};
use powerhouse_model::{Bond, ContactState, JointPair, JointRecord, Mesh, Vec3};

/// Writes a joint as a surface at a time (s).
///
/// Facets share no points, so that each shows the pair of its own side of an edge. Fields: `state`
/// (0 sticks, 1 slides, 2 open) and `bond` (0 never, 1 intact, 2 broken), normal and shear traction,
/// opening and peak opening, accumulated slip, times of first slip and first crack (-1: never),
/// energies of friction, bond and impact per area. Tips, where both sides are one, have zeros.
pub(super) fn write(
    file: &Path,
    mesh: &Mesh,
    (surface, table): (&JointSurface, &JointTable),
    time: f64,
) -> Result<(), IoError> {
    let (mut positions, mut facets, mut pairs) = (Vec::<Vec3>::new(), Vec::new(), Vec::new());
    for facet in &surface.facets {
        let first = positions.len() as u32;
        facets.push((first..first + facet.nodes.len() as u32).collect::<Vec<u32>>());
        for (&node, pair) in facet.nodes.iter().zip(&facet.pairs) {
            positions.push(mesh.positions()[node as usize]);
            pairs.push(pair.map(|pair| pair as usize));
        }
    }
    let writer = VtuWriter::of_facets(&positions, &facets, FieldPrecision::Single);
    let writer = writer.map_err(|source| IoError::File {
        file: file.into(),
        source,
    })?;
    let fields: Vec<(&str, Vec<f64>)> = FIELDS
        .iter()
        .map(|(name, value)| {
            let of = |pair: &Option<usize>| {
                pair.map_or(0.0, |pair| value(&table.pairs[pair], &table.records[pair]))
            };
            (*name, pairs.iter().map(of).collect())
        })
        .collect();
    let fields: Vec<VtuField> = fields
        .iter()
        .map(|(name, values)| VtuField {
            name,
            components: 1,
            values,
        })
        .collect();
    writer.write(file, time, &fields, &[])
}

type Value = fn(&JointPair, &JointRecord) -> f64;

const FIELDS: [(&str, Value); 12] = [
    ("state", |_, record| match record.state.contact {
        ContactState::Stick => 0.0,
        ContactState::Slide => 1.0,
        ContactState::Open => 2.0,
    }),
    ("bond", |_, record| match record.state.bond {
        Bond::Never => 0.0,
        Bond::Intact => 1.0,
        Bond::Broken => 2.0,
    }),
    ("normal traction", |_, record| record.traction.x),
    ("shear traction", |_, record| {
        record.traction.y.hypot(record.traction.z)
    }),
    ("opening", |_, record| record.opening),
    ("peak opening", |_, record| record.peak_opening),
    ("slip", |_, record| record.state.slip),
    ("time of first slip", |_, record| {
        record.first_slip.unwrap_or(-1.0)
    }),
    ("time of first crack", |_, record| {
        record.first_crack.unwrap_or(-1.0)
    }),
    ("friction energy", |pair, record| {
        record.friction / pair.area
    }),
    ("bond energy", |pair, record| record.bond_energy / pair.area),
    ("impact energy", |pair, record| record.impact / pair.area),
];
