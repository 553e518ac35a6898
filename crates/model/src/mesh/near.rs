//! Nodes within a distance of facets.

use std::collections::HashMap;

use super::Mesh;
use crate::{Facet, Vec3};

/// Share of the width by which a node must be closer.
const TOLERANCE: f64 = 1e-6;

impl Mesh {
    /// Flags of the nodes (by mesh index) that belong to facets or are closer to one than a width (m).
    ///
    /// A node must be closer by at least a millionth of the width, so that elements with
    /// edges as long as the width form one layer.
    pub fn nodes_near(&self, facets: &[Facet], width: f64) -> Vec<bool> {
        let mut near = vec![false; self.node_count()];
        let mut triangles: Vec<[Vec3; 3]> = Vec::new();
        let mut longest = 0.0_f64;
        for &facet in facets {
            let nodes = self.facet_nodes(facet);
            for &node in &nodes {
                near[node as usize] = true;
            }
            let nodes = self.facet_corners(facet);
            let corner = |i: usize| self.positions()[nodes[i] as usize];
            for i in 2..nodes.len() {
                let triangle = [corner(0), corner(i - 1), corner(i)];
                let [a, b, c] = triangle;
                longest = longest.max((b - a).norm()).max((c - a).norm());
                triangles.push(triangle);
            }
        }
        let reach = width * (1.0 - TOLERANCE);
        if reach <= 0.0 || longest <= 0.0 {
            return near;
        }
        // Cells as wide as a triangle and the reach: each triangle is in a few, each node in one.
        let cell = longest.max(reach);
        let index = |x: f64| (x / cell).floor() as i64;
        let mut cells: HashMap<[i64; 3], Vec<usize>> = HashMap::new();
        for (triangle, [a, b, c]) in triangles.iter().enumerate() {
            let margin = Vec3::repeat(reach);
            let low = (a.inf(b).inf(c) - margin).map(index);
            let high = (a.sup(b).sup(c) + margin).map(index);
            for x in low.x..=high.x {
                for y in low.y..=high.y {
                    for z in low.z..=high.z {
                        cells.entry([x, y, z]).or_default().push(triangle);
                    }
                }
            }
        }
        for (position, near) in self.positions().iter().zip(&mut near) {
            let at = position.map(index);
            let around = cells.get(&[at.x, at.y, at.z]).into_iter().flatten();
            let mut distances =
                around.map(|&i| (closest(&triangles[i], position) - position).norm());
            *near = *near || distances.any(|distance| distance < reach);
        }
        near
    }
}

/// The point of a triangle closest to a given point: within it, or on one of its sides.
fn closest(&[a, b, c]: &[Vec3; 3], point: &Vec3) -> Vec3 {
    let normal = (b - a).cross(&(c - a));
    let is_within = |from: &Vec3, to: &Vec3| normal.dot(&(to - from).cross(&(point - from))) >= 0.0;
    let area = normal.norm_squared();
    if area > 0.0 && is_within(&a, &b) && is_within(&b, &c) && is_within(&c, &a) {
        return point - normal * (normal.dot(&(point - a)) / area);
    }
    let on_side = |from: &Vec3, to: &Vec3| {
        let side = to - from;
        let length = side.norm_squared();
        let share = if length > 0.0 {
            side.dot(&(point - from)) / length
        } else {
            0.0
        };
        from + side * share.clamp(0.0, 1.0)
    };
    let sides = [on_side(&a, &b), on_side(&b, &c), on_side(&c, &a)];
    let distance = |at: &Vec3| (at - point).norm_squared();
    let [first, second, third] = sides;
    let nearer = |x: Vec3, y: Vec3| if distance(&y) < distance(&x) { y } else { x };
    nearer(nearer(first, second), third)
}

#[cfg(test)]
mod tests {
    use super::closest;
    use crate::{Mesh, Vec3};

    /// The closest point of a triangle lies within it, on a side or at a corner, as seen from there.
    #[test]
    fn closest_points_of_a_triangle() {
        let triangle = [
            Vec3::zeros(),
            Vec3::new(4.0, 0.0, 0.0),
            Vec3::new(0.0, 3.0, 0.0),
        ];
        for (point, expected) in [
            ([1.0, 1.0, -2.0], [1.0, 1.0, 0.0]),
            ([2.0, -1.0, 1.0], [2.0, 0.0, 0.0]),
            ([-3.0, 1.0, 0.0], [0.0, 1.0, 0.0]),
            ([6.0, -1.0, 0.0], [4.0, 0.0, 0.0]),
            // Across the slanted side, whose normal is (3, 4) / 5.
            ([2.0 + 0.6, 1.5 + 0.8, 0.0], [2.0, 1.5, 0.0]),
        ] {
            let found = closest(&triangle, &Vec3::from(point));
            assert!((found - Vec3::from(expected)).norm() < 1e-14, "{found:?}");
        }
    }

    /// Nodes closer than the width of the elements touch one layer of them, those of a wider reach
    /// more, of none those of the facets.
    #[test]
    fn layers_of_elements() {
        let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(60.0), [6; 3], "rock");
        let mesh = mesh.unwrap();
        let bottom = mesh.facet_set("bottom").unwrap().to_vec();
        for (width, layers) in [
            (0.0, 1),
            (5.0, 1),
            (10.0, 1),
            (10.1, 2),
            (20.0, 2),
            (1e3, 6),
        ] {
            let near = mesh.nodes_near(&bottom, width);
            let touched = (0..mesh.element_count() as u32).filter(|&element| {
                let nodes = mesh.nodes_of(element);
                nodes.iter().any(|&node| near[node as usize])
            });
            assert_eq!(touched.count(), 36 * layers, "{width}");
        }
    }
}
