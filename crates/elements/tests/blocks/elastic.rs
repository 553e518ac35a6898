//! Forces, masses, bounds and refusals of linear blocks.

use super::*;

/// The patch test: under a linear displacement a distorted mesh has the exact stress everywhere
/// and no force at its inner nodes.
#[test]
fn patch_test_on_distorted_meshes() {
    for kernel in SolidKernel::ALL {
        let mut fixture = Fixture::new(kernel, Linear(rock()), BlockOptions::default());
        let u = fixture.field(|x| GRADIENT * x * 1e-3);
        let forces = fixture.forces(&u, &zeros(u.len()));
        let scale = largest(&forces);
        for (force, &mesh_node) in forces.iter().zip(fixture.block.nodes()) {
            let x = fixture.mesh.positions()[mesh_node as usize];
            if (0..3).all(|i| x[i] > 0.1 && x[i] < 5.9) {
                assert!(force.norm() < 1e-13 * scale, "{} {force}", kernel.name());
            }
        }
        let exact = Stress::elastic(
            rock().lambda(),
            rock().shear(),
            &Strain::from_gradient(&(GRADIENT * 1e-3)),
        );
        for stress in fixture.stress(&u) {
            assert!((stress - exact).0.iter().all(|s| s.abs() < 1e-12 * 9e9));
        }
    }
}

/// The masses of a mesh sum to density times volume, and their centre is that of the volume, to round-off.
#[test]
fn masses_sum_to_density_times_volume() {
    for kernel in SolidKernel::ALL {
        let fixture = Fixture::new(kernel, Linear(rock()), BlockOptions::default());
        let masses = fixture.masses();
        let mass: f64 = masses.iter().sum();
        let exact = 2750.0 * 216.0;
        assert!((mass - exact).abs() < 1e-14 * exact, "{mass}");
        let places = fixture.field::<f64>(|x| *x);
        let moment: Vec3 = (places.iter().zip(&masses))
            .map(|(place, mass)| place.to_vector() * *mass)
            .sum();
        let off = (moment / mass - Vec3::repeat(3.0)).norm();
        assert!(off < 1e-13, "{}: {off:e}", kernel.name());
    }
}

/// One element under gravity, `integral of N rho g dV` at its nodes, accelerates by g at every
/// node to round-off.
#[test]
fn one_element_falls_with_g() {
    const G: f64 = 9.81;
    for kernel in SolidKernel::ALL {
        let box_mesh = distorted_box(kernel.kind());
        let mut builder = Mesh::builder();
        let nodes: Vec<u64> = (1..).take(kernel.kind().node_count()).collect();
        for (&tag, &node) in nodes.iter().zip(box_mesh.nodes_of(0)) {
            builder.node(tag, box_mesh.positions()[node as usize]);
        }
        builder.element(1, kernel.kind(), &nodes, &["rock"]);
        let mesh = builder.build().unwrap();
        let mut fixture = Fixture::of(mesh, kernel, Linear(rock()), BlockOptions::default());
        let rest = zeros(nodes.len());
        let internal = fixture.forces(&rest, &rest);
        let masses = fixture.masses();
        for (force, mass) in internal.iter().zip(&masses) {
            let acceleration = (Vec3::new(0.0, 0.0, -G * mass) - force) / *mass;
            assert!((acceleration - Vec3::new(0.0, 0.0, -G)).norm() < 1e-15 * G);
        }
    }
}

/// The bound of an element is its highest frequency, from above, to 1e-6.
#[test]
fn frequency_bounds_are_eigenvalues() {
    for kernel in SolidKernel::ALL {
        let whole = distorted_box(kernel.kind());
        for element in [0, 5, 13] {
            let mut builder = Mesh::builder();
            let nodes: Vec<u64> = (1..).take(kernel.kind().node_count()).collect();
            for (&tag, &node) in nodes.iter().zip(whole.nodes_of(element)) {
                builder.node(tag, whole.positions()[node as usize]);
            }
            builder.element(1, kernel.kind(), &nodes, &["rock"]);
            let mesh = builder.build().unwrap();
            let fixture = Fixture::of(mesh, kernel, Linear(rock()), BlockOptions::default());
            let masses = fixture.masses();
            let size = 3 * nodes.len();
            let mut matrix = DMatrix::zeros(size, size);
            for column in 0..size {
                let mut unit = zeros(nodes.len());
                unit[column / 3].values[column % 3] = 1.0;
                for (a, force) in fixture.apply(Operator::Elastic, &unit).iter().enumerate() {
                    let scale = 1.0 / (masses[a] * masses[column / 3]).sqrt();
                    for i in 0..3 {
                        matrix[(3 * a + i, column)] = force[i] * scale;
                    }
                }
            }
            let exact = SymmetricEigen::new(matrix).eigenvalues.max().sqrt();
            let bound = fixture.block.frequency_bounds()[0].frequency;
            assert!(bound >= exact * (1.0 - 1e-12), "{bound} {exact}");
            assert!(bound <= exact * (1.0 + 1e-6), "{bound} {exact}");
        }
    }
}

/// A cube's bound is that of the closed form for nu: `w = sqrt((3 lambda + 2 G) / rho) 2 / h`.
#[test]
fn the_bound_of_a_cube_is_known() {
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(0.5), [1, 1, 1], "rock").unwrap();
    let kernel = SolidKernel::ONE_POINT;
    let fixture = Fixture::of(mesh, kernel, Linear(rock()), BlockOptions::default());
    let stiffness = 3.0 * rock().lambda() + 2.0 * rock().shear();
    let exact = 2.0 / 0.5 * (stiffness / 2750.0).sqrt();
    let bound = fixture.block.frequency_bounds()[0].frequency;
    assert!((bound - exact).abs() < 1e-8 * exact, "{bound} {exact}");
}

/// The elastic operator is symmetric, and its nodal diagonal is that of the operator, in blocks of many
/// elements as in those of a few.
#[test]
fn the_diagonal_is_that_of_the_operator() {
    let sizes = [[3, 3, 3], [2, 2, 1]];
    for (kernel, cells) in SolidKernel::ALL
        .into_iter()
        .flat_map(|kernel| sizes.map(|cells| (kernel, cells)))
    {
        let mesh = distorted(kernel.kind(), cells);
        let fixture = Fixture::of(mesh, kernel, Linear(rock()), BlockOptions::default());
        let count = fixture.block.nodes().len();
        let mut diagonal = vec![Mat3::zeros(); count];
        fixture.block.diagonal(Operator::Elastic, &mut diagonal);
        for node in 0..count {
            for j in 0..3 {
                let mut unit = zeros(count);
                unit[node].values[j] = 1.0;
                let column = fixture.apply(Operator::Elastic, &unit)[node];
                let error = (column - diagonal[node].column(j)).norm();
                assert!(error < 1e-13 * diagonal[node].norm());
            }
        }
        let (x, y) = (fixture.noise(3, 1.0), fixture.noise(4, 1.0));
        let dot = |a: &[Quad<f64>], b: &[Vec3]| -> f64 {
            a.iter().zip(b).map(|(a, b)| a.to_vector().dot(b)).sum()
        };
        let (xy, yx) = (
            dot(&x, &fixture.apply(Operator::Elastic, &y)),
            dot(&y, &fixture.apply(Operator::Elastic, &x)),
        );
        assert!((xy - yx).abs() < 1e-12 * dot(&x, &fixture.apply(Operator::Elastic, &x)));
    }
}

/// Stiffness damping is the elastic operator on the velocity, shifted as asked.
#[test]
fn stiffness_damping_works_on_the_velocity() {
    for kernel in SolidKernel::ALL {
        let damped = options(Precision::F64, LaneWidth::Native, 3e-3);
        let mut linear = Fixture::new(kernel, Linear(rock()), damped);
        let mut softening = Fixture::new(kernel, Softening(rock()), damped);
        let v = linear.noise(5, 1.0);
        let rest = zeros(v.len());
        let context = BlockContext::new(when(0, 1e-4), NodalView::F64(&rest), NodalView::F64(&v))
            .with_damping_shift(-1e-3);
        let expected = linear.apply(Operator::Elastic, &v);
        for fixture in [&mut linear, &mut softening] {
            let forces = fixture.forces_at(&context).unwrap();
            for (force, product) in forces.iter().zip(&expected) {
                assert!((force - product * 2e-3).norm() < 1e-15 * largest(&expected));
            }
        }
    }
}

/// Meshes that do not suit the kernel are refused with the user's numbers.
#[test]
fn unsuitable_parts_are_refused() {
    let build = |mesh: &Mesh, nodes: &[u32]| {
        let elements: Vec<u32> = (0..mesh.element_count() as u32).collect();
        let part = BlockPart::new(mesh, &elements, nodes);
        let factory =
            SolidKernel::ONE_POINT.factory("rock", Linear(rock()), BlockOptions::default());
        factory.build(&part).err().map(|error| error.to_string())
    };
    let hexes = distorted_box(ElementKind::Hex8);
    let all: Vec<u32> = (0..hexes.node_count() as u32).collect();
    assert_eq!(build(&hexes, &all), None);
    let message = build(&hexes, &all[1..]).unwrap();
    assert!(message.contains("uses node 1"), "{message}");
    let tets = distorted_box(ElementKind::Tet4);
    let message = build(&tets, &all).unwrap();
    assert!(
        message.contains("element 1 of set 'rock' is a tet4"),
        "{message}"
    );
    let flat = hexes.map_positions(|x| Vec3::new(x.x, x.y, 0.0));
    if let Ok(flat) = flat {
        let message = build(&flat, &all).unwrap();
        assert!(message.contains("volume"), "{message}");
    }
}

/// A number that is none is reported with the element that met it, at its step.
#[test]
fn a_fault_names_its_element() {
    for precision in [Precision::F64, Precision::Mixed] {
        let options = options(precision, LaneWidth::Native, 1e-4);
        let kernel = SolidKernel::Tet4;
        let mut fixture = Fixture::new(kernel, Linear(rock()), options);
        let rest = zeros(fixture.block.nodes().len());
        let element = 77;
        let node = fixture.mesh.nodes_of(element)[2];
        let touches =
            |fault: &ElementFault, mesh: &Mesh| mesh.nodes_of(fault.element).contains(&node);
        for bad in [f64::NAN, f64::INFINITY] {
            let mut broken = rest.clone();
            broken[fixture.place(node)].values[1] = bad;
            for (u, v) in [(&broken, &rest), (&rest, &broken)] {
                let context =
                    BlockContext::new(when(0, 1e-4), NodalView::F64(u), NodalView::F64(v));
                let fault = fixture.forces_at(&context).unwrap_err();
                assert!(touches(&fault, &fixture.mesh), "{fault:?}");
            }
        }
    }
}
