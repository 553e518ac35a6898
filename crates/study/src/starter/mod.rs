//! A scene to begin with: a lined tunnel under a pulse, and its mesh.

use powerhouse::model::{Axis, ElementKind, Mesh, MeshBuilder, MeshError, Vec3};

/// Text of the scene, whose mesh is [`tunnel`] in the file `tunnel.msh` beside it.
pub const SCENE: &str = include_str!("scene.toml");

/// Half width, depth and thickness along the tunnel of the box of ground (m).
const HALF_WIDTH: f64 = 60.0;
const DEPTH: f64 = 90.0;
const LENGTH: f64 = 1.0;
/// Height of the axis, inner and outer radius of the lining (m).
const AXIS: f64 = -30.0;
const RADII: [f64; 2] = [4.0, 4.5];
/// Half side of the square around the tunnel in which elements follow its circumference (m), and elements along a side.
const HALF_SQUARE: f64 = 9.0;
const ALONG_SIDE: usize = 12;
/// Elements across the lining, and across the rock between it and the square.
const ACROSS_LINING: usize = 2;
const ACROSS_ROCK: usize = 4;
/// Size (m) of elements beside the square.
const BESIDE: f64 = 1.5;
/// Elements beside, above and below the square.
const BESIDE_COUNT: usize = 16;
const ABOVE_COUNT: usize = 10;

/// Mesh of a slab across a circular tunnel: element sets `rock` and `lining`, facet sets `left`, `right`, `bottom`, `front`
/// and `back`.
///
/// # Errors
/// None for the dimensions that it has.
pub fn tunnel() -> Result<Mesh, MeshError> {
    let x = lines([-HALF_WIDTH, HALF_WIDTH], 0.0, [BESIDE_COUNT, BESIDE_COUNT]);
    let z = lines([-DEPTH, 0.0], AXIS, [BESIDE_COUNT, ABOVE_COUNT]);
    let mut section = Section::new(x, z);
    section.around();
    section.beside();
    let mut mesh = section.extruded()?;
    for (set, axis, value) in [
        ("left", Axis::X, -HALF_WIDTH),
        ("right", Axis::X, HALF_WIDTH),
        ("bottom", Axis::Z, -DEPTH),
        ("front", Axis::Y, 0.0),
        ("back", Axis::Y, LENGTH),
    ] {
        let facets = mesh.facets_on_plane(axis, value, 1e-6);
        mesh.set_facet_set(set, facets)?;
    }
    Ok(mesh)
}

/// Grid lines between two ends: equal ones through the square about a centre, and lines on both sides whose distance grows.
fn lines([low, high]: [f64; 2], centre: f64, [below, above]: [usize; 2]) -> Vec<f64> {
    let from = |square: f64, end: f64, count: usize| {
        let length = (end - square).abs();
        let n = count as f64;
        let growth = (length - n * BESIDE) / (n * (n - 1.0) / 2.0);
        let distance = move |k: usize| {
            let k = k as f64;
            k * BESIDE + growth * k * (k - 1.0) / 2.0
        };
        (1..=count).map(move |k| square + (end - square).signum() * distance(k))
    };
    let [first, last] = [centre - HALF_SQUARE, centre + HALF_SQUARE];
    let mut lines: Vec<f64> = from(first, low, below).collect();
    lines.reverse();
    let side = 2.0 * HALF_SQUARE / ALONG_SIDE as f64;
    lines.extend((0..=ALONG_SIDE).map(|k| first + k as f64 * side));
    lines.extend(from(last, high, above));
    lines
}

/// Cross section: nodes (x, z), and quadrilaterals by their nodes, anticlockwise about the y axis.
struct Section {
    x: Vec<f64>,
    z: Vec<f64>,
    nodes: Vec<[f64; 2]>,
    quads: Vec<([usize; 4], &'static str)>,
    /// Index of the first line of the square along x and z.
    square: [usize; 2],
}

impl Section {
    /// The nodes of the grid; those within the square stay without elements and are left out of the mesh.
    fn new(x: Vec<f64>, z: Vec<f64>) -> Self {
        let nodes = (z.iter())
            .flat_map(|&z| x.iter().map(move |&x| [x, z]))
            .collect();
        Self {
            square: [BESIDE_COUNT, BESIDE_COUNT],
            quads: Vec::new(),
            nodes,
            x,
            z,
        }
    }
    fn node(&self, i: usize, j: usize) -> usize {
        j * self.x.len() + i
    }
    /// Node of the grid on the square at a place of its circumference, from its lower right corner anticlockwise.
    fn on_square(&self, place: usize) -> usize {
        let [i, j] = self.square;
        let (side, k) = (place / ALONG_SIDE % 4, place % ALONG_SIDE);
        match side {
            0 => self.node(i + ALONG_SIDE, j + k),
            1 => self.node(i + ALONG_SIDE - k, j + ALONG_SIDE),
            2 => self.node(i, j + ALONG_SIDE - k),
            _ => self.node(i + k, j),
        }
    }
    /// Lining and the rock between it and the square, in rings.
    fn around(&mut self) {
        let (round, rings) = (4 * ALONG_SIDE, ACROSS_LINING + ACROSS_ROCK);
        let mut ring: Vec<Vec<usize>> = Vec::new();
        for r in 0..=rings {
            let mut nodes = Vec::with_capacity(round);
            for place in 0..round {
                let square = self.on_square(place);
                if r == rings {
                    nodes.push(square);
                    continue;
                }
                let angle = core::f64::consts::FRAC_PI_2 * (place as f64 / ALONG_SIDE as f64 - 0.5);
                let across = (r as f64 / ACROSS_LINING as f64).min(1.0);
                let radius = RADII[0] + across * (RADII[1] - RADII[0]);
                let circle = [radius * angle.cos(), AXIS + radius * angle.sin()];
                let outwards = r.saturating_sub(ACROSS_LINING) as f64 / ACROSS_ROCK as f64;
                let end = self.nodes[square];
                nodes.push(self.nodes.len());
                self.nodes
                    .push([0, 1].map(|axis| circle[axis] + outwards * (end[axis] - circle[axis])));
            }
            ring.push(nodes);
        }
        for r in 0..rings {
            let set = if r < ACROSS_LINING { "lining" } else { "rock" };
            for place in 0..round {
                let next = (place + 1) % round;
                let (inner, outer) = (&ring[r], &ring[r + 1]);
                let quad = [inner[place], inner[next], outer[next], outer[place]];
                self.quads.push((quad, set));
            }
        }
    }
    /// The rock outside of the square.
    fn beside(&mut self) {
        let [first, second] = self.square;
        let within = |index: usize, first: usize| (first..first + ALONG_SIDE).contains(&index);
        for j in 0..self.z.len() - 1 {
            for i in 0..self.x.len() - 1 {
                if !(within(i, first) && within(j, second)) {
                    let quad = [(i, j), (i, j + 1), (i + 1, j + 1), (i + 1, j)];
                    self.quads
                        .push((quad.map(|(i, j)| self.node(i, j)), "rock"));
                }
            }
        }
    }
    /// The section as one layer of bricks along y.
    fn extruded(&self) -> Result<Mesh, MeshError> {
        let mut used = vec![false; self.nodes.len()];
        for &node in self.quads.iter().flat_map(|(quad, _)| quad) {
            used[node] = true;
        }
        let mut builder: MeshBuilder = Mesh::builder();
        let tag = |node: usize, back: bool| (2 * node + usize::from(back) + 1) as u64;
        for (node, &[x, z]) in self
            .nodes
            .iter()
            .enumerate()
            .filter(|(node, _)| used[*node])
        {
            builder.node(tag(node, false), Vec3::new(x, 0.0, z));
            builder.node(tag(node, true), Vec3::new(x, LENGTH, z));
        }
        for (number, (quad, set)) in self.quads.iter().enumerate() {
            let [a, b, c, d] = quad.map(|node| tag(node, false));
            let [e, f, g, h] = quad.map(|node| tag(node, true));
            let nodes = [a, b, c, d, e, f, g, h];
            builder.element(number as u64 + 1, ElementKind::Hex8, &nodes, &[*set]);
        }
        builder.build()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mesh has the volumes of its parts, to the polygon of its circumference, and well shaped elements.
    #[test]
    fn the_tunnel_fills_its_box() {
        let mesh = tunnel().unwrap();
        let quality = mesh.check().unwrap();
        assert!(quality.least_scaled_jacobian > 0.6 && quality.parts == 1);
        let volume = |set: &str| mesh.volume_of(mesh.element_set(set).unwrap());
        let sides = 4.0 * ALONG_SIDE as f64;
        let polygon = |radius: f64| {
            sides / 2.0 * radius * radius * (core::f64::consts::TAU / sides).sin() * LENGTH
        };
        let lining = polygon(RADII[1]) - polygon(RADII[0]);
        assert!((volume("lining") - lining).abs() < 1e-9 * lining);
        let rock = 2.0 * HALF_WIDTH * DEPTH * LENGTH - polygon(RADII[1]);
        assert!((volume("rock") - rock).abs() < 1e-9 * rock);
        for (set, area) in [
            ("left", DEPTH * LENGTH),
            ("bottom", 2.0 * HALF_WIDTH * LENGTH),
        ] {
            let facets = mesh.facet_set(set).unwrap().iter();
            let found: f64 = facets.map(|facet| mesh.facet_geometry(*facet).area()).sum();
            assert!((found - area).abs() < 1e-9 * area, "{set}");
        }
    }
}
