//! Which elements a bolt crosses, and where.

use powerhouse_model::{Mesh, Vec3};

use super::BoltLine;
use crate::EngineError;

/// A point of a bolt in an element.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct HostPoint {
    /// Mesh indices of the element's nodes.
    pub(super) nodes: Vec<u32>,
    /// Their weights.
    pub(super) weights: Vec<f64>,
}

/// A piece of a bolt within one element.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Segment {
    pub(super) element: u32,
    pub(super) start: f64,
    pub(super) length: f64,
    pub(super) ends: [HostPoint; 2],
}

/// Looks along a bolt before elements are told apart.
const LOOKS: usize = 64;
/// Shares of a bolt's length below which a piece is none, and by which it may leave the elements.
const NOTHING: f64 = 1.0e-9;
const OUTSIDE: f64 = 1.0e-3;

/// A place along a bolt, as a share of its length, and the element there.
type Look = (f64, u32);

/// The segments of each bolt.
///
/// The element is looked up at places along the bolt; between two places in different elements
/// the border is found by halving. A piece of less than a 64th of the bolt between two looks in one
/// element counts to that element, whose shape functions reach as far.
pub(super) fn embed(
    mesh: &Mesh,
    hosts: &[u32],
    lines: &[BoltLine],
    longest: f64,
) -> Result<Vec<Vec<Segment>>, EngineError> {
    for line in lines {
        let along = line.toe - line.head;
        if !(along.norm() > 0.0 && along.norm().is_finite()) {
            return Err(EngineError::NoDirection {
                part: "a bolt".into(),
                x: along.x,
                y: along.y,
                z: along.z,
            });
        }
    }
    let near = near(mesh, hosts, lines);
    let look = |places: &[(usize, f64)]| -> Result<Vec<u32>, EngineError> {
        let mut elements = vec![0; places.len()];
        // Lines of different length permit different distances.
        let mut start = 0;
        while start < places.len() {
            let bolt = places[start].0;
            let end = start + places[start..].partition_point(|&(other, _)| other == bolt);
            let line = &lines[bolt];
            let tolerance = OUTSIDE * (line.toe - line.head).norm();
            let points: Vec<Vec3> = (places[start..end].iter())
                .map(|&(_, share)| at(line, share))
                .collect();
            let found = mesh.locate_among(&near[bolt], &points, tolerance)?;
            for (element, located) in elements[start..end].iter_mut().zip(found) {
                *element = located.element;
            }
            start = end;
        }
        Ok(elements)
    };
    let mut all = Vec::new();
    for bolt in 0..lines.len() {
        let places: Vec<(usize, f64)> = (0..=LOOKS)
            .map(|i| (bolt, i as f64 / LOOKS as f64))
            .collect();
        let elements = look(&places)?;
        let looks: Vec<Look> = places.iter().map(|p| p.1).zip(elements).collect();
        let mut borders = vec![(0.0, looks[0].1)];
        for pair in looks.windows(2) {
            find_borders(pair[0], pair[1], &mut borders, &mut |share| {
                Ok(look(&[(bolt, share)])?[0])
            })?;
        }
        all.push(segments(mesh, &lines[bolt], &borders, longest)?);
    }
    Ok(all)
}

fn at(line: &BoltLine, share: f64) -> Vec3 {
    line.head + (line.toe - line.head) * share
}

/// For each bolt the elements whose boxes come near its own.
fn near(mesh: &Mesh, hosts: &[u32], lines: &[BoltLine]) -> Vec<Vec<u32>> {
    let boxes: Vec<(Vec3, Vec3)> = (lines.iter())
        .map(|line| {
            let margin = Vec3::repeat(OUTSIDE * (line.toe - line.head).norm());
            (
                line.head.inf(&line.toe) - margin,
                line.head.sup(&line.toe) + margin,
            )
        })
        .collect();
    let mut near = vec![Vec::new(); lines.len()];
    for &host in hosts {
        let corners = mesh.nodes_of(host).iter();
        let corners = corners.map(|&node| mesh.positions()[node as usize]);
        let infinite = Vec3::repeat(f64::INFINITY);
        let (low, high) = corners.fold((infinite, -infinite), |(low, high), p| {
            (low.inf(&p), high.sup(&p))
        });
        for (list, (from, to)) in near.iter_mut().zip(&boxes) {
            if (0..3).all(|i| low[i] <= to[i] && high[i] >= from[i]) {
                list.push(host);
            }
        }
    }
    near
}

/// Adds where the element changes between two looks, and to which.
fn find_borders(
    from: Look,
    to: Look,
    borders: &mut Vec<Look>,
    look: &mut impl FnMut(f64) -> Result<u32, EngineError>,
) -> Result<(), EngineError> {
    if from.1 == to.1 {
        return Ok(());
    }
    let middle = 0.5 * (from.0 + to.0);
    if to.0 - from.0 < 1.0e-13 || middle <= from.0 || middle >= to.0 {
        borders.push((middle, to.1));
        return Ok(());
    }
    let between = (middle, look(middle)?);
    find_borders(from, between, borders, look)?;
    find_borders(between, to, borders, look)
}

/// Pieces between borders, no longer than `longest` (m).
fn segments(
    mesh: &Mesh,
    line: &BoltLine,
    borders: &[Look],
    longest: f64,
) -> Result<Vec<Segment>, EngineError> {
    let length = (line.toe - line.head).norm();
    let mut segments = Vec::new();
    let mut start = 0.0;
    for (index, &(_, element)) in borders.iter().enumerate() {
        let end = borders.get(index + 1).map_or(1.0, |border| border.0);
        if end - start < NOTHING && index + 1 < borders.len() {
            continue;
        }
        let pieces = ((end - start) * length / longest).ceil().max(1.0) as usize;
        let share = |piece: usize| start + (end - start) * piece as f64 / pieces as f64;
        for piece in 0..pieces {
            let ends = [share(piece), share(piece + 1)];
            let points = ends.map(|share| at(line, share));
            let found = mesh.locate_among(&[element], &points, 2.0 * OUTSIDE * length)?;
            let host = |i: usize| HostPoint {
                nodes: found[i].nodes.clone(),
                weights: found[i].weights.clone(),
            };
            segments.push(Segment {
                element,
                start: ends[0] * length,
                length: (ends[1] - ends[0]) * length,
                ends: [host(0), host(1)],
            });
        }
        start = end;
    }
    Ok(segments)
}
