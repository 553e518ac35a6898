//! Joint facets with their fields, for ParaView and as pictures.

use std::path::Path;

use powerhouse_contact::JointSurface;
use powerhouse_explicit_core::observe::JointTable;
use powerhouse_io::{FacetField, FieldPrecision, IoError, VtuField, VtuNumbers, VtuWriter};
use powerhouse_model::{Bond, ContactState, JointPair, JointRecord, Mesh, Vec3};

/// The files of a joint's facets.
///
/// Facets share no points, so that each shows the pair of its own side of an edge. Fields: `state`
/// (0 sticks, 1 slides, 2 open), `over the run` (0 held, 1 slid, 2 opened, 3 both) and `bond` (0 never,
/// 1 intact, 2 broken), normal and shear traction,
/// opening and peak opening, accumulated slip, times of first slip and first crack (-1: never),
/// energies of friction, bond and impact per area. Tips, where both sides are one, have zeros.
pub(super) struct JointFacets {
    pub(super) writer: VtuWriter,
    /// Corner positions (m) and the corners of each facet.
    positions: Vec<Vec3>,
    facets: Vec<Vec<u32>>,
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
        Ok(Self {
            writer,
            positions,
            facets,
            pairs,
        })
    }

    /// What has become of its pairs.
    pub(super) fn fields(&self, pairs: &[JointPair], records: &[JointRecord]) -> JointFields {
        let of_field = |(name, value): &(&'static str, Value)| {
            let values = self.spread(|pair| value(&pairs[pair], &records[pair]));
            (*name, values)
        };
        FIELDS.iter().map(of_field).collect()
    }

    /// Pictures of its pairs: what each shows, its unit, its numbers and the names of these if they
    /// are kinds. What never was above zero has none, but for the state.
    pub(super) fn pictures(&self, table: &JointTable) -> Vec<JointPicture> {
        let field = |name: &str| {
            let (_, value) = FIELDS.iter().find(|(known, _)| *known == name)?;
            let values = self.spread(|pair| value(&table.pairs[pair], &table.records[pair]));
            Some(FacetField {
                positions: self.positions.clone(),
                facets: self.facets.clone(),
                values,
            })
        };
        let pictures = PICTURES.iter().filter_map(|&(name, unit, kinds)| {
            let field = field(name)?;
            let shows = !kinds.is_empty() || field.values.iter().any(|&value| value > 0.0);
            shows.then_some(JointPicture {
                name,
                unit,
                kinds,
                field,
            })
        });
        pictures.collect()
    }

    /// Writes them at a time (s): what has become of the pairs, and their greatest and least tractions
    /// over the run with their times.
    pub(super) fn write(&self, file: &Path, table: &JointTable, time: f64) -> Result<(), IoError> {
        let mut fields = self.fields(&table.pairs, &table.records);
        let tractions = &table.tractions;
        for (name, time, peak) in [
            (
                "greatest normal traction",
                "time of greatest normal traction",
                &tractions.greatest_normal,
            ),
            (
                "least normal traction",
                "time of least normal traction",
                &tractions.least_normal,
            ),
            (
                "greatest shear traction",
                "time of greatest shear traction",
                &tractions.greatest_shear,
            ),
        ] {
            fields.push((name, self.spread(|pair| peak.values[pair])));
            fields.push((time, self.spread(|pair| peak.times[pair])));
        }
        self.writer.write(file, time, &scalars(&fields), &[])
    }

    /// The values of the pairs at the points.
    fn spread(&self, value: impl Fn(usize) -> f64) -> Vec<f64> {
        let of = |pair: &Option<usize>| pair.map_or(0.0, &value);
        self.pairs.iter().map(of).collect()
    }
}

/// The fields as a file takes them; kinds are whole numbers.
pub(super) fn scalars(fields: &JointFields) -> Vec<VtuField<'_>> {
    let of_kinds = |name: &str| {
        let mut pictures = PICTURES.iter();
        pictures.any(|(known, _, kinds)| *known == name && !kinds.is_empty())
    };
    let scalars = fields.iter().map(|(name, values)| VtuField {
        name,
        components: 1,
        numbers: match of_kinds(name) {
            true => VtuNumbers::Whole,
            false => VtuNumbers::Real,
        },
        values,
    });
    scalars.collect()
}

/// A picture of the facets of a joint.
pub(super) struct JointPicture {
    /// What it shows.
    pub(super) name: &'static str,
    /// Its unit.
    pub(super) unit: &'static str,
    /// Names of its numbers from 0, if they are kinds.
    pub(super) kinds: &'static [&'static str],
    pub(super) field: FacetField,
}

/// The fields that are drawn, with their units or the names of their kinds.
const PICTURES: [(&str, &str, &[&str]); 5] = [
    ("state", "", &["sticks", "slides", "open"]),
    ("over the run", "", &["held", "slid", "opened", "both"]),
    ("bond", "", &["none", "intact", "broken"]),
    ("slip", "m", &[]),
    ("peak opening", "m", &[]),
];

type Value = fn(&JointPair, &JointRecord) -> f64;

const FIELDS: [(&str, Value); 13] = [
    ("state", |_, record| match record.state.contact {
        ContactState::Stick => 0.0,
        ContactState::Slide => 1.0,
        ContactState::Open => 2.0,
    }),
    ("over the run", |_, record| {
        let slid = f64::from(u8::from(record.first_slip.is_some()));
        slid + 2.0 * f64::from(u8::from(record.first_crack.is_some()))
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
