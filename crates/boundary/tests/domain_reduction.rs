//! The effective forces of a domain reduction.

use powerhouse_boundary::{BoundaryError, DomainReduction, InputMode, ReductionLayer, Viscous};
use powerhouse_model::{
    AbsorbingBoundary, BlockContext, BlockStiffness, BoundarySite, ElasticMedium, ElementBlock,
    ElementFault, FieldMotion, FieldSampler, FrequencyBound, IncidentField, Mesh, ModelError,
    NodalView, NodalViewMut, Operator, Quad, Vec3,
};

/// Springs between every two nodes of each element, `k n n^T` along the line between them, times a
/// number of the pair; the block's order of nodes runs against the mesh's.
struct Truss {
    elements: Vec<u32>,
    nodes: Vec<u32>,
    /// Indices of the nodes in the block and matrix of each element.
    matrices: Vec<(Vec<u32>, Vec<f64>)>,
}

impl Truss {
    fn new(mesh: &Mesh, elements: &[u32]) -> Self {
        let mut of_block = mesh.nodes_of_elements(elements);
        of_block.reverse();
        let index = |node: &u32| of_block.iter().position(|other| other == node).unwrap() as u32;
        let mut matrices = Vec::new();
        for &element in elements {
            let nodes = mesh.nodes_of(element);
            let size = 3 * nodes.len();
            let mut matrix = vec![0.0; size * size];
            for a in 0..nodes.len() {
                for b in 0..a {
                    let at = |n: usize| mesh.positions()[nodes[n] as usize];
                    let line = (at(a) - at(b)).normalize();
                    let spring = line * line.transpose() * (1.0 + (a * b) as f64);
                    for (row, column, sign) in
                        [(a, a, 1.0), (b, b, 1.0), (a, b, -1.0), (b, a, -1.0)]
                    {
                        for i in 0..3 {
                            for j in 0..3 {
                                matrix[(3 * row + i) * size + 3 * column + j] +=
                                    sign * spring[(i, j)];
                            }
                        }
                    }
                }
            }
            matrices.push((nodes.iter().map(index).collect::<Vec<u32>>(), matrix));
        }
        Self {
            elements: elements.to_vec(),
            nodes: of_block,
            matrices,
        }
    }

    /// Its forces on the nodes of the mesh under a motion of them.
    fn forces(&self, count: usize, motion: impl Fn(u32) -> Vec3) -> Vec<Vec3> {
        let mut forces = vec![Vec3::zeros(); count];
        for (numbers, matrix) in &self.matrices {
            let nodes: Vec<u32> = numbers.iter().map(|&n| self.nodes[n as usize]).collect();
            for (row, value) in matrix.chunks(3 * nodes.len()).enumerate() {
                let force: f64 = value
                    .iter()
                    .enumerate()
                    .map(|(c, k)| k * motion(nodes[c / 3])[c % 3])
                    .sum();
                forces[nodes[row / 3] as usize][row % 3] += force;
            }
        }
        forces
    }
}

impl ElementBlock for Truss {
    fn label(&self) -> &str {
        "truss"
    }
    fn elements(&self) -> &[u32] {
        &self.elements
    }
    fn nodes(&self) -> &[u32] {
        &self.nodes
    }
    fn forces(&mut self, context: &BlockContext, out: NodalViewMut) -> Result<(), ElementFault> {
        self.apply(Operator::Elastic, context.displacement, out);
        Ok(())
    }
    fn add_mass(&self, _out: &mut [f64]) {}
    fn frequency_bounds(&self) -> Vec<FrequencyBound> {
        Vec::new()
    }
    fn stiffness(&self) -> Option<&dyn BlockStiffness> {
        Some(self)
    }
}

impl BlockStiffness for Truss {
    fn apply(&self, _operator: Operator, x: NodalView, out: NodalViewMut) {
        let mut sums = vec![Vec3::zeros(); self.nodes.len()];
        for (numbers, matrix) in &self.matrices {
            for (row, values) in matrix.chunks(3 * numbers.len()).enumerate() {
                for (column, k) in values.iter().enumerate() {
                    let u = x.vector(numbers[column / 3] as usize)[column % 3];
                    sums[numbers[row / 3] as usize][row % 3] += k * u;
                }
            }
        }
        match out {
            NodalViewMut::F64(out) => {
                for (out, sum) in out.iter_mut().zip(sums) {
                    *out = Quad::from_vector(&sum);
                }
            }
            NodalViewMut::F32(out) => {
                for (out, sum) in out.iter_mut().zip(sums) {
                    *out = Quad::from_vector(&sum);
                }
            }
        }
    }
    fn each_matrix(&self, _operator: Operator, show: &mut dyn FnMut(&[u32], &[f64])) {
        for (numbers, matrix) in &self.matrices {
            show(numbers, matrix);
        }
    }
}

/// A motion without any symmetry, which may not be given at a point.
#[derive(Clone)]
struct Skew {
    unknown: Option<Vec3>,
}

fn skew(p: &Vec3, time: f64) -> Vec3 {
    Vec3::new(
        (p.x + 2.0 * p.y + time).sin(),
        (p.y - 3.0 * p.z).cos() * time,
        p.x * p.z + 0.1 * p.y,
    )
}

struct SkewAt(Vec<Vec3>);

impl IncidentField for Skew {
    fn name(&self) -> &str {
        "skew"
    }
    fn medium(&self) -> ElasticMedium {
        rock()
    }
    fn incident_part(&self) -> Option<Box<dyn IncidentField>> {
        None
    }
    fn check_layer(&self, nodes: &[Vec3], _inner: &[bool]) -> Result<(), ModelError> {
        match self.unknown.filter(|point| nodes.contains(point)) {
            Some(_) => Err(ModelError::refused("skew", "unknown at a point")),
            None => Ok(()),
        }
    }
    fn prepare(&self, points: &[Vec3]) -> Result<Box<dyn FieldSampler>, ModelError> {
        Ok(Box::new(SkewAt(points.to_vec())))
    }
}

impl FieldSampler for SkewAt {
    fn len(&self) -> usize {
        self.0.len()
    }
    fn add_motion(&self, time: f64, motion: &mut [FieldMotion]) {
        for (motion, point) in motion.iter_mut().zip(&self.0) {
            motion.displacement += skew(point, time);
        }
    }
}

fn rock() -> ElasticMedium {
    ElasticMedium::new(9.0e9, 0.27, 2750.0).unwrap()
}

/// A block of 7 x 6 x 5 bricks, and a region that reaches its top.
fn ground() -> (Mesh, Vec<u32>) {
    let size = Vec3::new(7.0, 6.0, 5.0);
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), size, [7, 6, 5], "rock").unwrap();
    let inside = mesh.elements_in_box(&Vec3::new(2.0, 2.0, 3.0), &Vec3::new(5.0, 4.0, 5.0));
    (mesh, inside)
}

/// The layer is one element thick, corners included, and the effective forces are
/// `P_b = -K_be u_e`, `P_e = K_eb u_b` with the layer's stiffness split between its two sides; the
/// boundary outside gets no input.
#[test]
fn effective_forces_come_from_the_split_layer() {
    let (mesh, inside) = ground();
    let elements = ReductionLayer::elements(&mesh, &inside);
    // The region has 3 x 2 x 2 bricks, with its layer 5 x 4 x 3, open at the top.
    assert_eq!(elements.len(), 60 - 12);
    let truss = Truss::new(&mesh, &elements);
    let layer = ReductionLayer::new(&mesh, &inside, &truss).unwrap();
    assert_eq!(layer.nodes(), mesh.nodes_of_elements(&elements));

    let bottom = [("bottom", mesh.facet_set("bottom").unwrap())];
    let outside = Viscous::default();
    let site = |field| BoundarySite::from_mesh(&mesh, &bottom, |_| rock(), Vec3::zeros(), field);
    let quiet = Viscous {
        input: InputMode::Nothing,
    };
    let expected_impedance = quiet.build(&site(None)).unwrap().impedance;
    let reduction = DomainReduction::new(layer, outside);
    let parts = reduction.build(&site(Some(&Skew { unknown: None })));
    let parts = parts.unwrap();
    assert_eq!(parts.impedance, expected_impedance);

    let time = 0.7;
    let mut found = vec![Vec3::zeros(); mesh.node_count()];
    for mut load in parts.loads {
        let nodes = load.nodes().to_vec();
        let mut forces = vec![Vec3::zeros(); nodes.len()];
        load.add_forces(time, &mut forces);
        for (node, force) in nodes.into_iter().zip(forces) {
            found[node as usize] += force;
        }
    }
    let on_region = mesh.nodes_of_elements(&inside);
    let is_inner = |node: u32| on_region.binary_search(&node).is_ok();
    let of_side = |inner: bool| {
        truss.forces(mesh.node_count(), |node| {
            if is_inner(node) == inner {
                skew(&mesh.positions()[node as usize], time)
            } else {
                Vec3::zeros()
            }
        })
    };
    let (of_inner, of_outer) = (of_side(true), of_side(false));
    let largest = of_outer.iter().map(Vec3::norm).fold(0.0, f64::max);
    for node in 0..mesh.node_count() {
        let expected = if is_inner(node as u32) {
            -of_outer[node]
        } else {
            of_inner[node]
        };
        let difference = (found[node] - expected).norm();
        assert!(difference < 1e-13 * largest, "{node}: {difference}");
    }
}

/// A field that is not given at a node of the layer is refused; elsewhere it need not be given.
#[test]
fn the_field_checks_the_layer() {
    let (mesh, inside) = ground();
    let elements = ReductionLayer::elements(&mesh, &inside);
    let truss = Truss::new(&mesh, &elements);
    for (unknown, is_refused) in [
        (Vec3::new(1.0, 1.0, 2.0), true),
        (Vec3::new(5.0, 4.0, 5.0), true),
        (Vec3::new(3.0, 3.0, 5.0), false),
        (Vec3::new(7.0, 6.0, 0.0), false),
    ] {
        let layer = ReductionLayer::new(&mesh, &inside, &truss).unwrap();
        let field = Skew {
            unknown: Some(unknown),
        };
        let site = BoundarySite::from_mesh(&mesh, &[], |_| rock(), Vec3::zeros(), Some(&field));
        let parts = DomainReduction::new(layer, Viscous::default()).build(&site);
        assert_eq!(parts.is_err(), is_refused, "{unknown}");
    }
}

/// Without a field nothing is loaded.
#[test]
fn no_field_means_no_forces() {
    let (mesh, inside) = ground();
    let elements = ReductionLayer::elements(&mesh, &inside);
    let truss = Truss::new(&mesh, &elements);
    let layer = ReductionLayer::new(&mesh, &inside, &truss).unwrap();
    let site = BoundarySite::from_mesh(&mesh, &[], |_| rock(), Vec3::zeros(), None);
    let parts = DomainReduction::new(layer, Viscous::default()).build(&site);
    assert!(parts.unwrap().loads.is_empty());
}

/// A block of other elements, and a region without anything around it, are refused.
#[test]
fn a_block_that_is_not_the_layer_is_refused() {
    let (mesh, inside) = ground();
    let mut elements = ReductionLayer::elements(&mesh, &inside);
    elements.pop();
    let truss = Truss::new(&mesh, &elements);
    let refused = ReductionLayer::new(&mesh, &inside, &truss).unwrap_err();
    let expected = BoundaryError::Layer {
        expected: 48,
        found: 47,
    };
    assert_eq!(refused, expected);
    let all: Vec<u32> = (0..mesh.element_count() as u32).collect();
    let nothing = Truss::new(&mesh, &[]);
    assert!(ReductionLayer::new(&mesh, &all, &nothing).is_err());
}
