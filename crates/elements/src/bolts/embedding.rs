//! Embedding of bolts in the elements that they cross.

use powerhouse_model::{EngineError, Mesh, Vec3};

use super::BoltLine;

/// A point of a bolt in its host element.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct HostPoint {
    /// Mesh indices of the element's nodes.
    pub(super) nodes: Vec<u32>,
    /// Values of their shape functions at the point.
    pub(super) weights: Vec<f64>,
}

/// A segment of a bolt within one element.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Segment {
    pub(super) element: u32,
    pub(super) start: f64,
    pub(super) length: f64,
    pub(super) ends: [HostPoint; 2],
}

/// Number of equal intervals of a bolt in the search for its elements.
const INTERVALS: usize = 64;
/// Share of a bolt's length below which a segment is neglected.
const NEGLIGIBLE: f64 = 1.0e-9;
/// Share of a bolt's length by which it may leave the elements.
const OUTSIDE: f64 = 1.0e-3;

/// A position along a bolt, as a share of its length, and the element there.
type Sample = (f64, u32);

/// Segments of each bolt, one per element that it crosses, divided where longer than `longest` (m), by the length of the bolt
/// (m).
///
/// The element is located at 65 samples along the bolt; between two samples in different elements
/// the border is found by bisection. A segment shorter than a 64th of the bolt between two samples of one
/// element is assigned to that element, whose shape functions are extrapolated.
pub(super) fn embed(
    mesh: &Mesh,
    hosts: &[u32],
    lines: &[BoltLine],
    longest: impl Fn(f64) -> f64,
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
    let locate = |samples: &[(usize, f64)]| -> Result<Vec<u32>, EngineError> {
        let mut elements = vec![0; samples.len()];
        // The tolerance depends on the length of the bolt.
        let mut start = 0;
        while start < samples.len() {
            let bolt = samples[start].0;
            let end = start + samples[start..].partition_point(|&(other, _)| other == bolt);
            let line = &lines[bolt];
            let tolerance = OUTSIDE * (line.toe - line.head).norm();
            let points: Vec<Vec3> = (samples[start..end].iter())
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
        let shares: Vec<(usize, f64)> = (0..=INTERVALS)
            .map(|i| (bolt, i as f64 / INTERVALS as f64))
            .collect();
        let elements = locate(&shares)?;
        let samples: Vec<Sample> = shares.iter().map(|p| p.1).zip(elements).collect();
        let mut borders = vec![(0.0, samples[0].1)];
        for pair in samples.windows(2) {
            find_borders(pair[0], pair[1], &mut borders, &mut |share| {
                Ok(locate(&[(bolt, share)])?[0])
            })?;
        }
        all.push(segments(mesh, &lines[bolt], &borders, &longest)?);
    }
    Ok(all)
}

fn at(line: &BoltLine, share: f64) -> Vec3 {
    line.head + (line.toe - line.head) * share
}

/// For each bolt the elements whose bounding boxes overlap its own.
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

/// Adds the positions between two samples where the element changes, each with the next element.
fn find_borders(
    from: Sample,
    to: Sample,
    borders: &mut Vec<Sample>,
    locate: &mut impl FnMut(f64) -> Result<u32, EngineError>,
) -> Result<(), EngineError> {
    if from.1 == to.1 {
        return Ok(());
    }
    let middle = 0.5 * (from.0 + to.0);
    if to.0 - from.0 < 1.0e-13 || middle <= from.0 || middle >= to.0 {
        borders.push((middle, to.1));
        return Ok(());
    }
    let between = (middle, locate(middle)?);
    find_borders(from, between, borders, locate)?;
    find_borders(between, to, borders, locate)
}

/// Segments between borders, no longer than `longest` (m) of the length of the bolt.
fn segments(
    mesh: &Mesh,
    line: &BoltLine,
    borders: &[Sample],
    longest: impl Fn(f64) -> f64,
) -> Result<Vec<Segment>, EngineError> {
    let length = (line.toe - line.head).norm();
    let longest = longest(length);
    let mut segments = Vec::new();
    let mut start = 0.0;
    for (index, &(_, element)) in borders.iter().enumerate() {
        let end = borders.get(index + 1).map_or(1.0, |border| border.0);
        if end - start < NEGLIGIBLE && index + 1 < borders.len() {
            continue;
        }
        let parts = (end - start) * length / longest;
        let count = (parts * (1.0 - NEGLIGIBLE)).ceil().max(1.0) as usize;
        let share = |i: usize| start + (end - start) * i as f64 / count as f64;
        for i in 0..count {
            let ends = [share(i), share(i + 1)];
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
