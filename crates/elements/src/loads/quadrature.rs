//! Gauss points of facets, and of the part of a facet below a level.

use powerhouse_model::{Mat3, Vec3};

/// Shape functions and outward vector area of a Gauss point.
type Point = (Vec<f64>, Vec3);

/// The triangles of which a triangle with midpoints consists, whose corners and midpoints are in turn.
const PARTS: [[usize; 3]; 4] = [[0, 1, 5], [1, 2, 3], [5, 3, 4], [1, 3, 5]];
/// Signs of the natural coordinates of the corners of a quadrilateral.
const SIGNS: [(f64, f64); 4] = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
/// Natural coordinates and weights of eight Gauss points, of which four mirror the others.
const EIGHT: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_5),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
];

/// Shape functions and outward vector areas of the Gauss points of a triangle (three, exact to the
/// second degree; in each of its four parts if it has midpoints) or a quadrilateral (2 x 2, exact to the third in each direction).
pub(super) fn face_points(corners: &[Vec3]) -> Vec<Point> {
    match triangles(corners.len()) {
        Some(triangles) => {
            let of_triangle = |part: &[usize; 3]| {
                let whole = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
                triangle_points(corners, part, whole)
            };
            triangles.iter().flat_map(of_triangle).collect()
        }
        None => {
            let g = 1.0 / 3.0_f64.sqrt();
            let points = SIGNS.iter();
            points
                .map(|(r, s)| natural_point(corners, r * g, s * g))
                .collect()
        }
    }
}

/// As [`face_points`], of the part of a facet below a level (z): all of it if no corner is above the level, none if no corner
/// is below. On the part the products of shape functions and depths are integrated exactly for triangles and parallelograms,
/// and to rounding for other quadrilaterals.
pub(super) fn points_below(corners: &[Vec3], level: f64) -> Vec<Point> {
    let depths: Vec<f64> = corners.iter().map(|corner| level - corner.z).collect();
    if depths.iter().all(|depth| *depth >= 0.0) {
        return face_points(corners);
    }
    if depths.iter().all(|depth| *depth <= 0.0) {
        return Vec::new();
    }
    match triangles(corners.len()) {
        Some(triangles) => {
            let mut points = Vec::new();
            for part in triangles {
                let polygon = below_in_triangle(part.map(|corner| depths[corner]));
                for pair in polygon.get(1..).unwrap_or_default().windows(2) {
                    let piece = [polygon[0], pair[0], pair[1]];
                    points.extend(triangle_points(corners, part, piece));
                }
            }
            points
        }
        None => below_in_quadrilateral(corners, [0, 1, 2, 3].map(|corner| depths[corner])),
    }
}

/// The triangles of which a facet with a number of nodes consists, on each of which shape functions are linear; none for a
/// quadrilateral.
fn triangles(nodes: usize) -> Option<&'static [[usize; 3]]> {
    match nodes {
        3 => Some(&[[0, 1, 2]]),
        6 => Some(&PARTS),
        _ => None,
    }
}

/// Three points of a piece of a triangle, whose corners have area coordinates in the triangle.
fn triangle_points(corners: &[Vec3], part: &[usize; 3], piece: [[f64; 3]; 3]) -> Vec<Point> {
    // Midpoints are in the middle of the edges.
    let (a, b, c, share) = match *corners {
        [a, _, b, _, c, _] => (a, b, c, 0.125),
        _ => (corners[0], corners[1], corners[2], 0.5),
    };
    let of_part = Mat3::from_rows(&piece.map(|at| Vec3::from(at).transpose())).determinant();
    let area = (b - a).cross(&(c - a)) * share * of_part / 3.0;
    let point = |near: usize| {
        let mut shape = vec![0.0; corners.len()];
        for (i, at) in piece.iter().enumerate() {
            let weight = if i == near { 2.0 / 3.0 } else { 1.0 / 6.0 };
            for (&corner, share) in part.iter().zip(at) {
                shape[corner] += weight * share;
            }
        }
        (shape, area)
    };
    (0..3).map(point).collect()
}

/// Corners (area coordinates) of the part of a triangle where a depth, given at its corners, is not negative.
fn below_in_triangle(depths: [f64; 3]) -> Vec<[f64; 3]> {
    let mut polygon = Vec::new();
    for from in 0..3 {
        let to = (from + 1) % 3;
        let mut at = [0.0; 3];
        if depths[from] >= 0.0 {
            at[from] = 1.0;
            polygon.push(at);
        }
        if (depths[from] > 0.0 && depths[to] < 0.0) || (depths[from] < 0.0 && depths[to] > 0.0) {
            let share = depths[from] / (depths[from] - depths[to]);
            at = [0.0; 3];
            at[from] = 1.0 - share;
            at[to] = share;
            polygon.push(at);
        }
    }
    polygon
}

/// Point of a quadrilateral at natural coordinates, with the vector area of a unit of them.
fn natural_point(corners: &[Vec3], r: f64, s: f64) -> Point {
    let shape = SIGNS
        .iter()
        .map(|(ra, sa)| 0.25 * (1.0 + ra * r) * (1.0 + sa * s))
        .collect();
    let (mut along_r, mut along_s) = (Vec3::zeros(), Vec3::zeros());
    for (corner, (ra, sa)) in corners.iter().zip(SIGNS) {
        along_r += corner * (0.25 * ra * (1.0 + sa * s));
        along_s += corner * (0.25 * sa * (1.0 + ra * r));
    }
    (shape, along_r.cross(&along_s))
}

/// Points of the part of a quadrilateral where a depth, bilinear from its corners, is positive: for each `s` the depth is
/// linear in `r`, so that the part is an interval; lines of `s` begin anew where the level passes a corner of that interval.
fn below_in_quadrilateral(corners: &[Vec3], depths: [f64; 4]) -> Vec<Point> {
    let middle = |ends: [f64; 2], at: f64| 0.5 * ((1.0 - at) * ends[0] + (1.0 + at) * ends[1]);
    let edges = [[depths[0], depths[3]], [depths[1], depths[2]]];
    let mut breaks = vec![-1.0, 1.0];
    for [from, to] in edges {
        let zero = (from + to) / (from - to);
        breaks.extend((zero.abs() < 1.0).then_some(zero));
    }
    breaks.sort_by(f64::total_cmp);
    let mut points = Vec::new();
    for ends in breaks.windows(2).filter(|ends| ends[0] < ends[1]) {
        let half = 0.5 * (ends[1] - ends[0]);
        let lines = EIGHT
            .iter()
            .flat_map(|&(at, weight)| [(-at, weight), (at, weight)]);
        for (at, weight) in lines {
            let s = middle([ends[0], ends[1]], at);
            let [left, right] = edges.map(|edge| middle(edge, s));
            let zero = (left + right) / (left - right);
            let [low, high] = match (left > 0.0, right > 0.0) {
                (true, true) => [-1.0, 1.0],
                (true, false) => [-1.0, zero],
                (false, true) => [zero, 1.0],
                (false, false) => continue,
            };
            for sign in [-1.0, 1.0] {
                let r = middle([low, high], sign / 3.0_f64.sqrt());
                let (shape, area) = natural_point(corners, r, s);
                points.push((shape, area * (0.5 * (high - low) * half * weight)));
            }
        }
    }
    points
}

/// Gauss point of the part of a facet between two depths.
pub(super) struct DepthPoint {
    /// Shape functions of the nodes of the facet.
    pub(super) shape: Vec<f64>,
    /// Outward vector area.
    pub(super) area: Vec3,
    /// Depth, which is linear between the corners.
    pub(super) depth: f64,
}

/// Points of the part of a facet whose depth, given at its nodes, is between two: 8 x 8 for each part in which the depths
/// of its sides do not pass one of the two. Natural coordinates are those in which the root of the depth is linear, so that
/// functions of that root, as of a mass that begins at the level, are integrated as polynomials are.
pub(super) fn points_between(corners: &[Vec3], depths: &[f64], band: [f64; 2]) -> Vec<DepthPoint> {
    let mut points = Vec::new();
    match triangles(corners.len()) {
        None => strips(corners, depths, &[0, 1, 2, 3], band, &mut points),
        Some(triangles) => {
            for [a, b, c] in triangles {
                // A triangle is a quadrilateral with two corners at one place.
                strips(corners, depths, &[*a, *b, *c, *c], band, &mut points);
            }
        }
    }
    points
}

/// Adds the points of a quadrilateral, whose corners are some nodes of a facet.
fn strips(
    nodes: &[Vec3],
    depths: &[f64],
    of_nodes: &[usize; 4],
    [top, bottom]: [f64; 2],
    points: &mut Vec<DepthPoint>,
) {
    let corners = of_nodes.map(|node| nodes[node]);
    let depths = of_nodes.map(|node| depths[node]);
    let edges = [[depths[0], depths[3]], [depths[1], depths[2]]];
    let on = |ends: [f64; 2], at: f64| 0.5 * ((1.0 - at) * ends[0] + (1.0 + at) * ends[1]);
    let mut breaks = vec![-1.0, 1.0];
    for [from, to] in edges {
        for limit in [top, bottom].into_iter().filter(|limit| limit.is_finite()) {
            let at = (2.0 * limit - from - to) / (to - from);
            breaks.extend((at.abs() < 1.0).then_some(at));
        }
    }
    breaks.sort_by(f64::total_cmp);
    let deepest = |s: f64| on(edges[0], s).max(on(edges[1], s)).min(bottom);
    for ends in breaks.windows(2).filter(|ends| ends[0] < ends[1]) {
        let ends = [ends[0], ends[1]];
        for (s, of_line) in by_root(ends, ends.map(deepest)) {
            let [left, right] = edges.map(|edge| on(edge, s));
            let within = |limit: f64| (2.0 * limit - left - right) / (right - left);
            // Where the line is level, all of it is within or none.
            let (mut low, mut high) = (-1.0_f64, 1.0_f64);
            for limit in [top, bottom] {
                let is_within = |depth: f64| {
                    if limit == top {
                        depth >= top
                    } else {
                        depth <= bottom
                    }
                };
                match (is_within(left), is_within(right)) {
                    (true, true) => {}
                    (true, false) => high = high.min(within(limit)),
                    (false, true) => low = low.max(within(limit)),
                    (false, false) => (low, high) = (1.0, -1.0),
                }
            }
            if low >= high {
                continue;
            }
            let line = [low, high];
            let of_ends = line.map(|r| on([left, right], r));
            for (r, of_point) in by_root(line, of_ends) {
                let (own, area) = natural_point(&corners, r, s);
                let mut shape = vec![0.0; nodes.len()];
                for (&node, share) in of_nodes.iter().zip(own) {
                    shape[node] += share;
                }
                points.push(DepthPoint {
                    shape,
                    area: area * (of_line * of_point),
                    depth: on([left, right], r).clamp(top.max(0.0), bottom),
                });
            }
        }
    }
}

/// Eight points with weights of an interval between the ends of which the root of a depth, linear between these, is taken
/// as the coordinate.
fn by_root(ends: [f64; 2], depths: [f64; 2]) -> impl Iterator<Item = (f64, f64)> {
    let [first, last] = depths.map(|depth| depth.max(0.0).sqrt());
    let sum = first + last;
    let of_eight = EIGHT
        .iter()
        .flat_map(|&(at, weight)| [(-at, weight), (at, weight)]);
    of_eight
        .filter(move |_| sum > 0.0)
        .map(move |(at, weight)| {
            let t = 0.5 * (1.0 + at);
            let root = first + t * (last - first);
            let length = ends[1] - ends[0];
            let place = ends[0] + length * t * (first + root) / sum;
            (place, 0.5 * weight * length * 2.0 * root / sum)
        })
}
