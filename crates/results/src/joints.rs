//! Joint facets with their fields, for ParaView and as pictures.

use std::borrow::Cow;
use std::path::Path;

use powerhouse_contact::JointSurface;
#[cfg(feature = "pictures")]
use powerhouse_io::FacetField;
use powerhouse_io::{FieldPrecision, IoError, VtuField, VtuNumbers, VtuWriter};
use powerhouse_model::{
    Bond, ContactState, HistoryVariable, JointHistory, JointPair, JointRecord, Mesh, Vec3,
};
use powerhouse_observe::JointTable;

use crate::vtu;

/// Facets of a joint with their fields, as VTU files and pictures.
///
/// Facets share no points, so that each shows the pair of its own side of an edge. Fields: `state`
/// (0 sticks, 1 slides, 2 open), `over the run` (0 held, 1 slid, 2 opened, 3 both) and `bond` (0 never,
/// 1 intact, 2 broken, 3 softening), normal and shear traction and the components of both along the axes, opening and peak opening, accumulated slip, times of first slip and first crack (-1: never),
/// energies of friction, bond and impact per area, history variables of the law by their names; where a
/// stage closed the joint anew, `opening counted from` too, the distance of the sides then; where it has water, `water pressure`,
/// and the tractions are effective ones. Tips, where
/// both sides share the node, have zeros. Facets of which a side is absent, beside an excavated room or a
/// lining that is not cast yet, are left out.
pub(crate) struct JointFacets {
    pub(crate) writer: VtuWriter,
    /// Corner positions (m) and the corners of each facet.
    #[cfg(feature = "pictures")]
    positions: Vec<Vec3>,
    #[cfg(feature = "pictures")]
    facets: Vec<Vec<u32>>,
    /// Index of the pair at each point; none at tips.
    pairs: Vec<Option<usize>>,
}

/// Fields at the points of the facets.
pub(crate) type JointFields = Vec<JointField>;

/// Field at the points of the facets, by name.
pub(crate) struct JointField {
    name: Cow<'static, str>,
    unit: &'static str,
    numbers: VtuNumbers,
    values: Vec<f64>,
}

impl JointField {
    /// One of the quantities that every joint has.
    fn new(name: &'static str, values: Vec<f64>) -> Self {
        let mut pictures = PICTURES.iter();
        let is_kind = pictures.any(|(known, _, kinds)| *known == name && !kinds.is_empty());
        Self {
            name: name.into(),
            unit: unit_of(name),
            numbers: if is_kind {
                VtuNumbers::Whole
            } else {
                VtuNumbers::Real
            },
            values,
        }
    }
}

/// History variables of the pairs of a joint, those of a pair side by side.
pub(crate) type PairHistory<'a> = (&'a [HistoryVariable], &'a [f64]);

impl JointFacets {
    /// Facets of a mesh with its present elements (none: all are); errors name `file`. None if no facet is
    /// left.
    pub(crate) fn new(
        file: &Path,
        mesh: &Mesh,
        surface: &JointSurface,
        present: Option<&[bool]>,
    ) -> Result<Option<Self>, IoError> {
        let (mut positions, mut facets, mut pairs) = (Vec::<Vec3>::new(), Vec::new(), Vec::new());
        let shown = match present {
            Some(present) => surface.present_facets(mesh, present),
            None => surface.facets.iter().collect(),
        };
        for facet in shown {
            let first = positions.len() as u32;
            facets.push((first..first + facet.nodes.len() as u32).collect::<Vec<u32>>());
            for (&node, pair) in facet.nodes.iter().zip(&facet.pairs) {
                positions.push(mesh.positions()[node as usize]);
                pairs.push(pair.map(|pair| pair as usize));
            }
        }
        if facets.is_empty() {
            return Ok(None);
        }
        let writer = VtuWriter::of_facets(&positions, &facets, FieldPrecision::Single);
        let writer = writer.map_err(|source| IoError::File {
            file: file.into(),
            source,
        })?;
        Ok(Some(Self {
            writer,
            #[cfg(feature = "pictures")]
            positions,
            #[cfg(feature = "pictures")]
            facets,
            pairs,
        }))
    }

    /// Contact states, peak values, energies and history variables of its pairs.
    pub(crate) fn fields(
        &self,
        (pairs, records): (&[JointPair], &[JointRecord]),
        (variables, history): PairHistory,
    ) -> JointFields {
        let anew = records.iter().any(|record| record.closed_at.is_some());
        let of_field = |(name, value): &(&'static str, Value)| {
            let values = self.spread(|pair| value(&pairs[pair], &records[pair]));
            JointField::new(name, values)
        };
        let wet = pairs.iter().any(|pair| pair.water_pressure != 0.0);
        let fields = FIELDS.iter().chain(anew.then_some(&CLOSED_AT));
        let fields = fields.chain(wet.then_some(&WATER));
        let of_variable = |(v, variable): (usize, &HistoryVariable)| JointField {
            name: variable.name.into(),
            unit: vtu::unit(variable.unit),
            numbers: vtu::numbers(variable),
            values: self.spread(|pair| history[pair * variables.len() + v]),
        };
        let variables = variables.iter().enumerate().map(of_variable);
        fields.map(of_field).chain(variables).collect()
    }

    /// Fields of the state that a stage leaves, with the history variables by their names.
    pub(crate) fn fields_of_stage(&self, pairs: &[JointPair], state: &JointHistory) -> JointFields {
        let count = state.variables.len();
        let mut fields = self.fields((pairs, &state.records), (&[], &[]));
        fields.extend(
            state
                .variables
                .iter()
                .enumerate()
                .map(|(v, name)| JointField {
                    name: name.clone().into(),
                    unit: "",
                    numbers: VtuNumbers::Real,
                    values: self.spread(|pair| state.history[pair * count + v]),
                }),
        );
        fields
    }

    /// Pictures of its pairs. A quantity that never was above zero has none, but for those that are kinds.
    #[cfg(feature = "pictures")]
    pub(crate) fn pictures(&self, table: &JointTable) -> Vec<JointPicture> {
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

    /// Writes the fields at a time (s), with the extreme tractions over the run and their times.
    pub(crate) fn write(&self, file: &Path, table: &JointTable, time: f64) -> Result<(), IoError> {
        let history = (&table.variables[..], &table.history[..]);
        let mut fields = self.fields((&table.pairs, &table.records), history);
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
            let values = self.spread(|pair| peak.values[pair]);
            fields.push(JointField::new(name, values));
            let times = self.spread(|pair| peak.times[pair]);
            fields.push(JointField::new(time, times));
        }
        self.writer.write(file, time, &scalars(&fields), &[])
    }

    /// Values at the points from those of the pairs.
    fn spread(&self, value: impl Fn(usize) -> f64) -> Vec<f64> {
        let of = |pair: &Option<usize>| pair.map_or(0.0, &value);
        self.pairs.iter().map(of).collect()
    }
}

/// Fields as a VTU file has them; kinds and flags are whole numbers.
pub(crate) fn scalars(fields: &JointFields) -> Vec<VtuField<'_>> {
    let scalars = fields.iter().map(|field| VtuField {
        name: &field.name,
        components: 1,
        numbers: field.numbers,
        unit: field.unit,
        values: &field.values,
    });
    scalars.collect()
}

/// Unit of one of the quantities that every joint has.
fn unit_of(name: &str) -> &'static str {
    match name {
        _ if name.starts_with("time") => "s",
        _ if name.ends_with("traction") || name == "water pressure" => "Pa",
        _ if name.ends_with("energy") => "J/m2",
        "opening" | "peak opening" | "opening counted from" | "slip" => "m",
        _ => "",
    }
}

/// Picture of the facets of a joint.
#[cfg(feature = "pictures")]
pub(crate) struct JointPicture {
    /// Quantity that is drawn.
    pub(crate) name: &'static str,
    /// Unit of the quantity.
    pub(crate) unit: &'static str,
    /// Names of the values 0, 1 and so on of a quantity that is a kind; empty otherwise.
    pub(crate) kinds: &'static [&'static str],
    pub(crate) field: FacetField,
}

/// Quantities that are drawn, with their units or the names of their kinds.
pub(crate) const PICTURES: [(&str, &str, &[&str]); 5] = [
    ("state", "", &["sticks", "slides", "open"]),
    ("over the run", "", &["held", "slid", "opened", "both"]),
    ("bond", "", &["none", "intact", "broken", "softening"]),
    ("slip", "m", &[]),
    ("peak opening", "m", &[]),
];

/// Distance of the sides from which opening counts, where a stage closed a joint anew.
const CLOSED_AT: (&str, Value) = ("opening counted from", |_, record| record.origin().x);

/// Pressure of the water in a joint.
const WATER: (&str, Value) = ("water pressure", |pair, _| pair.water_pressure);

type Value = fn(&JointPair, &JointRecord) -> f64;

const FIELDS: [(&str, Value); 16] = [
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
        Bond::Softening => 3.0,
    }),
    ("normal traction", |_, record| record.traction.x),
    ("shear traction", |_, record| {
        record.traction.y.hypot(record.traction.z)
    }),
    ("x traction", |pair, record| {
        pair.to_global(&record.traction).x
    }),
    ("y traction", |pair, record| {
        pair.to_global(&record.traction).y
    }),
    ("z traction", |pair, record| {
        pair.to_global(&record.traction).z
    }),
    ("opening", |_, record| record.opening),
    ("peak opening", |_, record| record.peak_opening),
    ("slip", |_, record| record.slip()),
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
