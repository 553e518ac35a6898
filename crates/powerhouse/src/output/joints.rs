//! Joint facets with their fields, for ParaView and as pictures.

use std::collections::HashMap;
use std::path::Path;

use powerhouse_contact::{JointFacet, JointSurface};
use powerhouse_explicit_core::observe::JointTable;
use powerhouse_io::{FacetField, FieldPrecision, IoError, VtuField, VtuNumbers, VtuWriter};
use powerhouse_model::{Bond, ContactState, JointPair, JointRecord, Mesh, Vec3};

/// The files of a joint's facets.
///
/// Facets share no points, so that each shows the pair of its own side of an edge. Fields: `state`
/// (0 sticks, 1 slides, 2 open), `over the run` (0 held, 1 slid, 2 opened, 3 both) and `bond` (0 never,
/// 1 intact, 2 broken), normal and shear traction,
/// opening and peak opening, accumulated slip, times of first slip and first crack (-1: never),
/// energies of friction, bond and impact per area; where a stage closed the joint anew, `opening counted
/// from` too, the distance of the sides then. Tips, where both sides are one, have zeros. Facets of
/// which a side is not there, beside an excavated room or a lining that is not cast yet, are left out.
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
    /// Facets of a mesh of which these elements are there (none said: all); `file` is named if they cannot
    /// be written. None if no facet is left.
    pub(super) fn new(
        file: &Path,
        mesh: &Mesh,
        surface: &JointSurface,
        present: Option<&[bool]>,
    ) -> Result<Option<Self>, IoError> {
        let (mut positions, mut facets, mut pairs) = (Vec::<Vec3>::new(), Vec::new(), Vec::new());
        let sides = present.map(|present| Sides::new(mesh, surface, present));
        let stands = |facet: &&JointFacet| sides.as_ref().is_none_or(|sides| sides.has(facet));
        for facet in surface.facets.iter().filter(stands) {
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
            positions,
            facets,
            pairs,
        }))
    }

    /// Contact states and peak values of its pairs.
    pub(super) fn fields(&self, pairs: &[JointPair], records: &[JointRecord]) -> JointFields {
        let anew = records.iter().any(|record| record.closed_at.is_some());
        let of_field = |(name, value): &(&'static str, Value)| {
            let values = self.spread(|pair| value(&pairs[pair], &records[pair]));
            (*name, values)
        };
        let fields = FIELDS.iter().chain(anew.then_some(&CLOSED_AT));
        fields.map(of_field).collect()
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

/// Which sides of a joint's facets are there.
struct Sides<'s> {
    mesh: &'s Mesh,
    surface: &'s JointSurface,
    present: &'s [bool],
    /// Elements that are there, at the nodes of the second side.
    beside: HashMap<u32, Vec<u32>>,
}

impl<'s> Sides<'s> {
    fn new(mesh: &'s Mesh, surface: &'s JointSurface, present: &'s [bool]) -> Self {
        let nodes = surface.pairs.iter().map(|pair| (pair.nodes[1], Vec::new()));
        let mut beside: HashMap<u32, Vec<u32>> = nodes.collect();
        for element in 0..mesh.element_count() as u32 {
            if present[element as usize] {
                for node in mesh.nodes_of(element) {
                    if let Some(elements) = beside.get_mut(node) {
                        elements.push(element);
                    }
                }
            }
        }
        Self {
            mesh,
            surface,
            present,
            beside,
        }
    }

    /// Whether both sides of a facet are there: the element that it is a side of, and another one that has
    /// all nodes that face its own.
    fn has(&self, facet: &JointFacet) -> bool {
        let first = facet.first.element;
        let pairs = facet.pairs.iter().flatten();
        let facing: Vec<u32> = pairs
            .map(|&pair| self.surface.pairs[pair as usize].nodes[1])
            .collect();
        let Some((node, others)) = facing.split_first() else {
            return self.present[first as usize];
        };
        let has_all = |&&element: &&u32| {
            let nodes = self.mesh.nodes_of(element);
            element != first && others.iter().all(|other| nodes.contains(other))
        };
        self.present[first as usize] && self.beside[node].iter().any(|e| has_all(&e))
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
        unit: unit_of(name),
        values,
    });
    scalars.collect()
}

/// The unit of a field.
fn unit_of(name: &str) -> &'static str {
    match name {
        _ if name.starts_with("time") => "s",
        _ if name.ends_with("traction") => "Pa",
        _ if name.ends_with("energy") => "J/m2",
        "opening" | "peak opening" | "opening counted from" | "slip" => "m",
        _ => "",
    }
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
pub(super) const PICTURES: [(&str, &str, &[&str]); 5] = [
    ("state", "", &["sticks", "slides", "open"]),
    ("over the run", "", &["held", "slid", "opened", "both"]),
    ("bond", "", &["none", "intact", "broken"]),
    ("slip", "m", &[]),
    ("peak opening", "m", &[]),
];

/// Where a stage closed a joint anew: the distance of the sides then, from which opening counts.
const CLOSED_AT: (&str, Value) = ("opening counted from", |_, record| record.origin().x);

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

#[cfg(test)]
mod tests {
    use powerhouse_contact::SurfaceOptions;

    use super::*;

    /// Facets of a joint are shown where both sides are there: not beside a room that is excavated, on
    /// either side, nor where nothing is left.
    #[test]
    fn facets_beside_rooms_are_left_out() {
        // Two slabs of 4 by 3 bricks, one on the other.
        let size = Vec3::new(4.0, 3.0, 2.0);
        let whole = Mesh::box_of_hexes(Vec3::zeros(), size, [4, 3, 2], "rock").unwrap();
        let slab = |upper: bool| -> Vec<u32> {
            let all = 0..whole.element_count() as u32;
            all.filter(|&e| (whole.centroid(e).z > 1.0) == upper)
                .collect()
        };
        let split = whole.split_between(&slab(false), &slab(true)).unwrap();
        let options = SurfaceOptions::within(1e-6).unwrap();
        let mesh = split.mesh;
        let surface = JointSurface::between(&mesh, &split.first, &split.second, &options).unwrap();
        let count = |is_there: &dyn Fn(Vec3) -> bool| {
            let elements = 0..mesh.element_count() as u32;
            let present: Vec<bool> = elements.map(|e| is_there(mesh.centroid(e))).collect();
            let facets = JointFacets::new(Path::new("x"), &mesh, &surface, Some(&present));
            facets.unwrap().map_or(0, |facets| facets.facets.len())
        };
        assert_eq!(count(&|_| true), 12);
        // A row of three on one side, a brick inside on the other, one side as a whole.
        assert_eq!(count(&|at| at.z > 1.0 || at.x > 1.0), 9);
        assert_eq!(
            count(&|at| at.z < 1.0 || (at - Vec3::new(1.5, 1.5, 1.5)).norm() > 0.1),
            11
        );
        assert_eq!(count(&|at| at.z < 1.0), 0);
    }
}
