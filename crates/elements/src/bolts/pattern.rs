//! Regular bolt patterns on walls and arches.

use std::collections::HashSet;

use powerhouse_model::{EngineError, Facet, Mesh, ParameterError, Vec3};

use super::BoltLine;

/// A regular pattern of bolts normal to a surface, in rows along an opening.
///
/// Rows lie in planes across the direction `along` at a spacing of `spacing[1]`; in each row bolts have a
/// spacing of `spacing[0]` along the surface; both are centred on the surface. Around a closed
/// ring the spacing is the nearest one that divides its length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoltPattern {
    /// Direction of the axis of the opening, of any length but zero.
    pub along: Vec3,
    /// Spacing of bolts around the opening and along it (m), above zero.
    pub spacing: [f64; 2],
    /// Length of the bolts (m), above zero.
    pub length: f64,
}

/// Intersection of a row's plane with a facet: its two end points, and the direction of a bolt there.
#[derive(Clone, Copy, Debug)]
struct FacetCut {
    ends: [Vec3; 2],
    inwards: Vec3,
}

impl BoltPattern {
    /// Axes of the bolts on a surface made of facets, directed into the elements `hosts` (mesh indices) on either
    /// side of it.
    ///
    /// # Errors
    /// A parameter outside its permitted range.
    ///
    /// # Panics
    /// If a facet does not belong to the mesh.
    pub fn lines(
        &self,
        mesh: &Mesh,
        facets: &[Facet],
        hosts: &[u32],
    ) -> Result<Vec<BoltLine>, EngineError> {
        let positive = f64::MIN_POSITIVE;
        for spacing in self.spacing {
            ParameterError::check("spacing", spacing, positive, f64::MAX)?;
        }
        ParameterError::check("length", self.length, positive, f64::MAX)?;
        let along = EngineError::check_direction("a pattern of bolts", self.along)?;
        let hosts: HashSet<u32> = hosts.iter().copied().collect();
        let nodes = mesh.nodes_of_facets(facets);
        let heights = nodes
            .iter()
            .map(|&n| along.dot(&mesh.positions()[n as usize]));
        let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), h| {
            (low.min(h), high.max(h))
        });
        if facets.is_empty() {
            return Ok(Vec::new());
        }
        let mut lines = Vec::new();
        for height in centred(low, high, self.spacing[1]) {
            let cuts: Vec<FacetCut> = (facets.iter())
                .filter_map(|&facet| cut(mesh, facet, &along, height, &hosts))
                .collect();
            for row in rows(cuts) {
                self.add_row(&row, &mut lines);
            }
        }
        Ok(lines)
    }

    /// Adds the bolts of one row of connected cuts.
    fn add_row(&self, row: &[FacetCut], lines: &mut Vec<BoltLine>) {
        let lengths: Vec<f64> = row.iter().map(|c| (c.ends[1] - c.ends[0]).norm()).collect();
        let whole: f64 = lengths.iter().sum();
        let (first, last) = (row[0].ends[0], row[row.len() - 1].ends[1]);
        let closed = row.len() > 2 && (first - last).norm() < SAME * whole;
        let distances = if closed {
            let count = (whole / self.spacing[0]).round().max(1.0);
            (0..count as usize)
                .map(|i| whole * (i as f64 + 0.5) / count)
                .collect()
        } else {
            centred(0.0, whole, self.spacing[0])
        };
        for distance in distances {
            let mut rest = distance;
            let found = row.iter().zip(&lengths).find(|&(_, &length)| {
                let inside = rest <= length;
                if !inside {
                    rest -= length;
                }
                inside
            });
            let Some((cut, length)) = found else {
                continue;
            };
            let head = cut.ends[0] + (cut.ends[1] - cut.ends[0]) * (rest / length);
            lines.push(BoltLine {
                head,
                toe: head + cut.inwards * self.length,
            });
        }
    }
}

/// Share of the row's length below which ends of cuts count as coincident.
const SAME: f64 = 1.0e-6;

/// Equally spaced positions centred between two bounds: as many as whole spacings fit, but at least one.
fn centred(low: f64, high: f64, spacing: f64) -> Vec<f64> {
    // A whole number counts although rounding makes it a little less.
    let count = ((high - low) / spacing * (1.0 + 1.0e-9)).floor().max(1.0);
    let first = 0.5 * (low + high - (count - 1.0) * spacing);
    (0..count as usize)
        .map(|i| first + i as f64 * spacing)
        .collect()
}

/// Intersection of the plane of a row with a facet. Corners in the plane count as above it, so that of two
/// facets that touch it there only one is cut.
fn cut(
    mesh: &Mesh,
    facet: Facet,
    along: &Vec3,
    height: f64,
    hosts: &HashSet<u32>,
) -> Option<FacetCut> {
    let geometry = mesh.facet_geometry(facet);
    let corners: Vec<Vec3> = (geometry.nodes.iter())
        .map(|&node| mesh.positions()[node as usize])
        .collect();
    let over = |corner: &Vec3| along.dot(corner) - height;
    let mut ends = Vec::with_capacity(2);
    for (i, a) in corners.iter().enumerate() {
        let b = &corners[(i + 1) % corners.len()];
        let (from, to) = (over(a), over(b));
        if (from < 0.0) != (to < 0.0) {
            ends.push(a + (b - a) * (from / (from - to)));
        }
    }
    let inwards = if hosts.contains(&facet.element) {
        -geometry.normal()
    } else {
        geometry.normal()
    };
    match ends[..] {
        [a, b] if (b - a).norm() > 0.0 => Some(FacetCut {
            ends: [a, b],
            inwards,
        }),
        _ => None,
    }
}

/// Connected cuts in order, row by row; open rows from their lower end.
fn rows(mut cuts: Vec<FacetCut>) -> Vec<Vec<FacetCut>> {
    let size: f64 = cuts.iter().map(|c| (c.ends[1] - c.ends[0]).norm()).sum();
    let same = move |a: &Vec3, b: &Vec3| (a - b).norm() < SAME * size;
    let key = |p: &Vec3| (p.z, p.x, p.y);
    let mut rows = Vec::new();
    while !cuts.is_empty() {
        let ends = || {
            cuts.iter()
                .enumerate()
                .flat_map(|(i, c)| [(i, 0, c.ends[0]), (i, 1, c.ends[1])])
        };
        let alone = |&(i, _, p): &(usize, usize, Vec3)| {
            !ends().any(|(other, _, q)| other != i && same(&p, &q))
        };
        let lowest = |a: &(usize, usize, Vec3), b: &(usize, usize, Vec3)| {
            let (a, b) = (key(&a.2), key(&b.2));
            a.0.total_cmp(&b.0)
                .then(a.1.total_cmp(&b.1))
                .then(a.2.total_cmp(&b.2))
        };
        let start = ends()
            .filter(alone)
            .min_by(lowest)
            .or_else(|| ends().min_by(lowest));
        let Some((index, end, _)) = start else {
            break;
        };
        let mut row = vec![oriented(cuts.swap_remove(index), end)];
        loop {
            let last = row[row.len() - 1].ends[1];
            let next = cuts.iter().enumerate().find_map(|(i, cut)| {
                let end = (0..2).find(|&end| same(&cut.ends[end], &last))?;
                Some((i, end))
            });
            match next {
                Some((index, end)) => row.push(oriented(cuts.swap_remove(index), end)),
                None => break,
            }
        }
        rows.push(row);
    }
    rows
}

/// The cut oriented so that it begins at one of its ends.
fn oriented(cut: FacetCut, end: usize) -> FacetCut {
    let FacetCut { ends, inwards } = cut;
    FacetCut {
        ends: [ends[end], ends[1 - end]],
        inwards,
    }
}
