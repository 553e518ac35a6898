//! Bolts at regular distances on a wall or an arch.

use std::collections::HashSet;

use powerhouse_model::{Facet, Mesh, ParameterError, Vec3};

use super::BoltLine;
use crate::EngineError;

/// Bolts normal to a surface, in rows along an opening.
///
/// Rows stand in planes across the direction `along`, `spacing[1]` apart; in each row bolts stand
/// `spacing[0]` apart along the surface, both about the middle of the surface. Around a closed
/// ring the distance is the nearest that divides it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoltPattern {
    /// The direction of the opening, of any length but zero.
    pub along: Vec3,
    /// Distance of bolts around the opening and along it (m).
    pub spacing: [f64; 2],
    /// Length of the bolts (m).
    pub length: f64,
}

/// Where a row's plane cuts a facet: two places, and the direction of a bolt there.
#[derive(Clone, Copy, Debug)]
struct Cut {
    ends: [Vec3; 2],
    inwards: Vec3,
}

impl BoltPattern {
    /// The bolts of a surface made of facets, into the elements `hosts` (mesh indices) on either
    /// side of it.
    ///
    /// # Errors
    /// A parameter out of its range.
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
        let along = crate::support::unit("a pattern of bolts", self.along)?;
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
        for height in about_the_middle(low, high, self.spacing[1]) {
            let cuts: Vec<Cut> = (facets.iter())
                .filter_map(|&facet| cut(mesh, facet, &along, height, &hosts))
                .collect();
            for row in rows(cuts) {
                self.place(&row, &mut lines);
            }
        }
        Ok(lines)
    }

    /// Adds the bolts of one row of connected cuts.
    fn place(&self, row: &[Cut], lines: &mut Vec<BoltLine>) {
        let lengths: Vec<f64> = row.iter().map(|c| (c.ends[1] - c.ends[0]).norm()).collect();
        let whole: f64 = lengths.iter().sum();
        let (first, last) = (row[0].ends[0], row[row.len() - 1].ends[1]);
        let closed = row.len() > 2 && (first - last).norm() < SAME * whole;
        let places = if closed {
            let count = (whole / self.spacing[0]).round().max(1.0);
            (0..count as usize)
                .map(|i| whole * (i as f64 + 0.5) / count)
                .collect()
        } else {
            about_the_middle(0.0, whole, self.spacing[0])
        };
        for place in places {
            let mut rest = place;
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

/// Ends of cuts closer than this share of the row are one place.
const SAME: f64 = 1.0e-6;

/// Places at a distance from each other, one for each whole distance but at least one, about the
/// middle.
fn about_the_middle(low: f64, high: f64, spacing: f64) -> Vec<f64> {
    // A whole number counts although rounding makes it a little less.
    let count = ((high - low) / spacing * (1.0 + 1.0e-9)).floor().max(1.0);
    let first = 0.5 * (low + high - (count - 1.0) * spacing);
    (0..count as usize)
        .map(|i| first + i as f64 * spacing)
        .collect()
}

/// Where the plane of a row cuts a facet. Corners in the plane count as above it, so that of two
/// facets that touch it there one is cut.
fn cut(mesh: &Mesh, facet: Facet, along: &Vec3, height: f64, hosts: &HashSet<u32>) -> Option<Cut> {
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
        [a, b] if (b - a).norm() > 0.0 => Some(Cut {
            ends: [a, b],
            inwards,
        }),
        _ => None,
    }
}

/// Connected cuts in a row, one behind the other; open rows from their lower end.
fn rows(mut cuts: Vec<Cut>) -> Vec<Vec<Cut>> {
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
        let mut row = vec![turned(cuts.swap_remove(index), end)];
        loop {
            let last = row[row.len() - 1].ends[1];
            let next = cuts.iter().enumerate().find_map(|(i, cut)| {
                let end = (0..2).find(|&end| same(&cut.ends[end], &last))?;
                Some((i, end))
            });
            match next {
                Some((index, end)) => row.push(turned(cuts.swap_remove(index), end)),
                None => break,
            }
        }
        rows.push(row);
    }
    rows
}

/// A cut that begins at one of its ends.
fn turned(cut: Cut, end: usize) -> Cut {
    let Cut { ends, inwards } = cut;
    Cut {
        ends: [ends[end], ends[1 - end]],
        inwards,
    }
}
