//! Named sets of the mesh of a bay: parts, stages, faces, joints, monitoring points.

use std::collections::BTreeMap;

use powerhouse::model::{Facet, Mesh, MeshError, Vec3};

use super::dimensions::{BayDimensions, Levels};
use super::parts::BayPart;
use super::plan::{Column, Plan};

/// Depths below the crowns down to which the upper stages of excavation reach (m): the first of the
/// main powerhouse, the first and second of the transformer cavern.
const FIRST_MAIN: f64 = 9.0;
const UPPER_TRANSFORMER: [f64; 2] = [8.0, 17.0];

/// Sides of a hexahedron of the grid and the index step to the neighbour at each.
const SIDES: [(u8, [isize; 3]); 6] = [
    (0, [0, 0, -1]),
    (1, [0, 0, 1]),
    (2, [0, -1, 0]),
    (3, [1, 0, 0]),
    (4, [0, 1, 0]),
    (5, [-1, 0, 0]),
];

/// Monitoring point of the paper, as a node of the mesh of a bay.
#[derive(Clone, Debug, PartialEq)]
pub struct MonitoringPoint {
    /// Name in the paper: `A` to `F`, `O1`, `O2`; the node set is `point_` followed by it.
    pub name: &'static str,
    /// Mesh index of the node.
    pub node: u32,
    /// Distance (m) of the node from the intended position: along the wall to the nearest grid row.
    pub offset: f64,
}

/// Grid cells with their element indices.
struct Cells<'a> {
    plan: &'a Plan,
    counts: [usize; 3],
}

impl Cells<'_> {
    fn index(&self, [i, j, k]: [usize; 3]) -> u32 {
        ((k * self.counts[1] + j) * self.counts[0] + i) as u32
    }

    fn each(&self) -> impl Iterator<Item = [usize; 3]> + use<> {
        let [nx, ny, nz] = self.counts;
        (0..nz).flat_map(move |k| (0..ny).flat_map(move |j| (0..nx).map(move |i| [i, j, k])))
    }

    fn beside(&self, cell: [usize; 3], step: [isize; 3]) -> Option<[usize; 3]> {
        let mut other = cell;
        for axis in 0..3 {
            other[axis] = cell[axis].checked_add_signed(step[axis])?;
            if other[axis] >= self.counts[axis] {
                return None;
            }
        }
        Some(other)
    }
}

/// Adds the element and facet sets to the mesh of a plan; returns the number of elements of each part.
pub(super) fn name_sets(
    mesh: &mut Mesh,
    plan: &Plan,
    dimensions: &BayDimensions,
    ends_absorb: bool,
) -> Result<BTreeMap<BayPart, usize>, MeshError> {
    let levels = dimensions.levels();
    let cells = Cells {
        plan,
        counts: plan.cells(),
    };
    let mut parts: BTreeMap<BayPart, Vec<u32>> = BTreeMap::new();
    let mut sets: BTreeMap<String, Vec<u32>> = BTreeMap::new();
    let mut facets: BTreeMap<String, Vec<Facet>> = BTreeMap::new();
    for cell in cells.each() {
        let (element, part) = (cells.index(cell), BayPart::of(plan, cell));
        parts.entry(part).or_default().push(element);
        let mut put = |set: &str| sets.entry(set.into()).or_default().push(element);
        if part == BayPart::Rock {
            if touches_side(&cells, cell, ends_absorb) {
                put("rim");
            }
            rock_facets(&cells, cell, &mut facets);
            end_facets(&cells, cell, "rock", &mut facets);
            continue;
        }
        if part.is_concrete() {
            end_facets(&cells, cell, "structure", &mut facets);
            put("structure");
            put(if part.is_lining() {
                "lining"
            } else {
                "interior"
            });
        } else {
            put("void");
        }
        let height = mesh.centroid(element).z;
        put(stage(&levels, part, height));
    }
    let counts = parts.iter().map(|(part, elements)| (*part, elements.len()));
    let counts = counts.collect();
    for (part, elements) in parts {
        sets.insert(part.name().into(), elements);
    }
    for (name, elements) in sets {
        mesh.set_element_set(&name, elements)?;
    }
    for (name, facets) in facets {
        mesh.set_facet_set(&name, facets)?;
    }
    Ok(counts)
}

/// The excavation stage of a cell whose centroid is at a height (m).
fn stage(levels: &Levels, part: BayPart, height: f64) -> &'static str {
    let below = |depth: f64| height < levels.crown - depth;
    if part.is_in_transformer() {
        let [first, second] = UPPER_TRANSFORMER.map(below);
        return match (first, second) {
            (false, _) => "transformer_1",
            (true, false) => "transformer_2",
            (true, true) => "transformer_3",
        };
    }
    match height {
        _ if !below(FIRST_MAIN) => "main_1",
        z if z > levels.generator[0] => "main_2",
        z if z > levels.busbar[0] => "main_3",
        z if z > levels.turbine[0] => "main_4",
        _ => "main_5",
    }
}

/// Whether a cell lies at an absorbing face.
fn touches_side(cells: &Cells, [i, j, k]: [usize; 3], ends_absorb: bool) -> bool {
    let [nx, ny, _] = cells.counts;
    i == 0 || i + 1 == nx || k == 0 || (ends_absorb && (j == 0 || j + 1 == ny))
}

/// Adds the facets of a rock cell towards the structure: those of the joint, by part, and those of the bolt heads,
/// by surface.
fn rock_facets(cells: &Cells, cell: [usize; 3], facets: &mut BTreeMap<String, Vec<Facet>>) {
    let element = cells.index(cell);
    for (side, step) in SIDES {
        let Some(other) = cells.beside(cell, step) else {
            continue;
        };
        let part = BayPart::of(cells.plan, other);
        if !part.is_concrete() {
            continue;
        }
        let mut put = |set: String| facets.entry(set).or_default().push(Facet { element, side });
        // Beyond the ends of the bay its structure meets rock across the halls.
        if step[1] != 0 {
            put("joint_ends".into());
            continue;
        }
        put(format!("joint_{}", part.name()));
        let cavern = if part.is_in_transformer() {
            "transformer"
        } else {
            "main"
        };
        if step[0] != 0 {
            put(format!("walls_{cavern}"));
        } else if step[2] < 0 {
            put(format!("roof_{cavern}"));
        }
    }
}

/// Adds the facets of a rock or concrete cell on the faces normal to the halls; separate sets, since those of the
/// rock may absorb while those of the structure are supported.
fn end_facets(
    cells: &Cells,
    cell: [usize; 3],
    body: &str,
    facets: &mut BTreeMap<String, Vec<Facet>>,
) {
    let element = cells.index(cell);
    for (side, step) in SIDES {
        if step[1] != 0 && cells.beside(cell, step).is_none() {
            let end = if step[1] < 0 { "front" } else { "back" };
            let set = facets.entry(format!("{end}_{body}")).or_default();
            set.push(Facet { element, side });
        }
    }
}

/// Finds the monitoring points at mid-bay and adds their node sets to the mesh.
pub(super) fn name_points(
    mesh: &mut Mesh,
    plan: &Plan,
    dimensions: &BayDimensions,
) -> Result<Vec<MonitoringPoint>, MeshError> {
    let levels = dimensions.levels();
    let [nx, ny, _] = plan.cells();
    let middle = plan.layers.len() / 2;
    let node = |i: usize, k: usize| ((k * (ny + 1) + middle) * (nx + 1) + i) as u32;
    let lines = |column: fn(&Column) -> bool| -> Vec<usize> {
        let of = plan.columns.iter().enumerate();
        of.filter(|(_, c)| column(c)).map(|(i, _)| i).collect()
    };
    let hall = lines(|c| matches!(c, Column::MainHall(_)));
    let transformer = lines(|c| matches!(c, Column::TransformerHall));
    let (clear_main, clear_transformer) = (ends(&hall), ends(&transformer));
    let springing = |width: f64| levels.crown - dimensions.rise * width;
    let wall_main = 0.5 * (springing(dimensions.main_width) + levels.generator[0]);
    let wall_transformer = 0.5 * (springing(dimensions.transformer_width) + levels.busbar[0]);
    let crown = levels.crown - dimensions.arch_lining;
    let axis = |[left, right]: [usize; 2]| (left + right) / 2;
    let [b, c] = clear_main;
    let [e, f] = clear_transformer;
    let wanted = [
        ("A", axis(clear_main), crown),
        ("B", b, wall_main),
        ("C", c, wall_main),
        ("D", axis(clear_transformer), crown),
        ("E", e, wall_transformer),
        ("F", f, wall_transformer),
        ("O1", axis(clear_main), levels.base[0]),
        ("O2", axis(clear_transformer), levels.busbar[0]),
    ];
    let mut points = Vec::new();
    for (name, i, height) in wanted {
        let away = |k: usize| (mesh.positions()[node(i, k) as usize].z - height).abs();
        let nearest = (0..=plan.rows.len()).min_by(|&a, &b| away(a).total_cmp(&away(b)));
        let k = nearest.unwrap_or(0);
        points.push(MonitoringPoint {
            name,
            node: node(i, k),
            offset: away(k),
        });
    }
    for point in &points {
        mesh.set_node_set(&format!("point_{}", point.name), vec![point.node])?;
    }
    Ok(points)
}

/// The first line of columns and the one after the last.
fn ends(columns: &[usize]) -> [usize; 2] {
    match columns {
        [first, .., last] => [*first, last + 1],
        _ => [0, 0],
    }
}

/// The position of a monitoring point (m).
pub(super) fn position(mesh: &Mesh, point: &MonitoringPoint) -> Vec3 {
    mesh.positions()[point.node as usize]
}
