//! Joint facets with their fields, for ParaView.

use std::path::Path;

use powerhouse_contact::JointSurface;
use powerhouse_explicit_core::observe::{JointTable, PeakField};
use powerhouse_io::{FieldPrecision, IoError, VtuField, VtuNumbers, VtuWriter};
use powerhouse_model::{Bond, ContactState, JointPair, JointRecord, Mesh, Vec3};

/// The files of a joint's facets.
///
/// Facets share no points, so that each shows the pair of its own side of an edge. Fields: `state`
/// (0 sticks, 1 slides, 2 open) and `bond` (0 never, 1 intact, 2 broken), normal and shear traction,
/// opening and peak opening, accumulated slip, times of first slip and first crack (-1: never),
/// energies of friction, bond and impact per area. Tips, where both sides are one, have zeros.
pub(super) struct JointFacets {
    pub(super) writer: VtuWriter,
    /// The pair at each point; none at tips.
    pairs: Vec<Option<usize>>,
}

/// Named values at the points of the facets.
pub(super) type JointFields = Vec<(&'static str, Vec<f64>)>;

impl JointFacets {
    /// Facets of a mesh; `file` is named if they cannot be written.
    pub(super) fn new(file: &Path, mesh: &Mesh, surface: &JointSurface) -> Result<Self, IoError> {
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
        Ok(Self { writer, pairs })
    }

    /// What has become of its pairs.
    pub(super) fn fields(&self, pairs: &[JointPair], records: &[JointRecord]) -> JointFields {
        let of_field = |(name, value): &(&'static str, Value)| {
            let values = self.spread(|pair| value(&pairs[pair], &records[pair]));
            (*name, values)
        };
        FIELDS.iter().map(of_field).collect()
    }

    /// The values of the pairs at the points.
    fn spread(&self, value: impl Fn(usize) -> f64) -> Vec<f64> {
        let of = |pair: &Option<usize>| pair.map_or(0.0, &value);
        self.pairs.iter().map(of).collect()
    }
}

/// Writes a joint as a surface at a time (s): what has become of it, and its greatest and least
/// tractions over the run with their times.
pub(super) fn write(
    file: &Path,
    mesh: &Mesh,
    (surface, table): (&JointSurface, &JointTable),
    time: f64,
) -> Result<(), IoError> {
    let facets = JointFacets::new(file, mesh, surface)?;
    let mut fields = facets.fields(&table.pairs, &table.records);
    let mut peak = |[name, time]: [&'static str; 2], field: &PeakField| {
        fields.push((name, facets.spread(|pair| field.values[pair])));
        fields.push((time, facets.spread(|pair| field.times[pair])));
    };
    let tractions = &table.tractions;
    peak(
        [
            "greatest normal traction",
            "time of greatest normal traction",
        ],
        &tractions.greatest_normal,
    );
    peak(
        ["least normal traction", "time of least normal traction"],
        &tractions.least_normal,
    );
    peak(
        ["greatest shear traction", "time of greatest shear traction"],
        &tractions.greatest_shear,
    );
    facets.writer.write(file, time, &scalars(&fields), &[])
}

/// The fields as a file takes them.
pub(super) fn scalars(fields: &JointFields) -> Vec<VtuField<'_>> {
    let fields = fields.iter();
    let scalars = fields.map(|(name, values)| VtuField {
        name,
        components: 1,
        numbers: VtuNumbers::Real,
        values,
    });
    scalars.collect()
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
