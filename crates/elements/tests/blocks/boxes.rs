//! Blocks of boxes: shorter arithmetic, the same results.

use super::*;

/// A graded box whose cells are boxes, and the same turned and skewed.
fn meshes() -> [Mesh; 3] {
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::new(6.0, 8.0, 10.0), [3, 4, 5], "rock");
    let graded = mesh.unwrap().map_positions(|x| x + x.map(|c| 0.05 * c * c));
    let graded = graded.unwrap();
    let turn = nalgebra::Rotation3::from_euler_angles(0.4, -1.1, 2.3);
    let turned = graded.clone().map_positions(|x| turn * x).unwrap();
    let skewed = graded
        .clone()
        .map_positions(|x| x + Vec3::new(0.2 * x.y, 0.1 * x.z, 0.3 * x.x));
    [graded, turned, skewed.unwrap()]
}

/// A mesh's block as scenes have it, and one of the general arithmetic.
fn pair<M: ConstitutiveLaw>(
    mesh: &Mesh,
    kernel: SolidKernel,
    law: M,
    options: BlockOptions,
) -> [Fixture; 2] {
    let special = Fixture::of(mesh.clone(), kernel, law.clone(), options);
    let mut general = Fixture::of(mesh.clone(), kernel, law.clone(), options);
    let (nodes, elements) = (special.block.nodes(), special.block.elements());
    let part = BlockPart::new(mesh, elements, nodes);
    let factory = kernel.factory_of_any_shape("rock", law, options);
    general.block = factory.build(&part).unwrap();
    [special, general]
}

fn assert_near(own: &[Vec3], exact: &[Vec3], bound: f64) {
    for (own, exact_one) in own.iter().zip(exact) {
        let error = (own - exact_one).norm() / largest(exact);
        assert!(error < bound, "{error}");
    }
}

/// Forces, with and without stiffness damping and with a law that has a history; stresses, energies, masses and
/// frequency bounds of boxes, turned boxes and parallelepipeds are those of the general form of the brick. The shorter
/// form is in use: some digit differs.
#[test]
fn blocks_of_boxes_are_blocks_of_bricks() {
    for (mesh, kernel) in meshes()
        .iter()
        .flat_map(|mesh| [SolidKernel::Hex8Full, SolidKernel::Hex8BBar].map(|k| (mesh, k)))
    {
        for (precision, bound) in [(Precision::F64, 1e-12), (Precision::Mixed, 1e-5)] {
            for stiffness in [0.0, 1e-3] {
                let chosen = options(precision, LaneWidth::Native, stiffness);
                let mut differs = false;
                let [mut own, mut exact] = pair(mesh, kernel, Linear(rock()), chosen);
                let (u, v) = (own.noise(5, 1e-3), own.noise(6, 1e-1));
                let forces = [own.forces(&u, &v), exact.forces(&u, &v)];
                differs |= forces[0] != forces[1];
                assert_near(&forces[0], &forces[1], bound);
                for (a, b) in own.stress(&u).iter().zip(exact.stress(&u)) {
                    assert!((*a - b).0.iter().all(|s| s.abs() < bound * 9e9 * 1e-2));
                }
                let (a, b) = (own.masses(), exact.masses());
                assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12 * b));
                let bounds = [&own, &exact].map(|fixture| fixture.block.frequency_bounds());
                for (a, b) in bounds[0].iter().zip(&bounds[1]) {
                    let error = (a.frequency - b.frequency).abs() / b.frequency;
                    assert!(error < 1e-12, "{error}");
                }
                assert!(differs, "{kernel:?}");

                let law = Softening(rock());
                let [mut own, mut exact] = pair(mesh, kernel, law, chosen);
                for scale in [1.0, 0.5] {
                    let u: Vec<Quad<f64>> = (u.iter())
                        .map(|u| Quad::from_vector(&(u.to_vector() * scale)))
                        .collect();
                    let forces = [own.forces(&u, &v), exact.forces(&u, &v)];
                    assert_near(&forces[0], &forces[1], bound);
                    own.block.commit();
                    exact.block.commit();
                }
            }
        }
    }
}

/// The patch test in blocks of boxes: a linear displacement has its exact stress everywhere and no force at inner nodes.
#[test]
fn patch_test_on_boxes() {
    for mesh in meshes() {
        for kernel in [SolidKernel::Hex8Full, SolidKernel::Hex8BBar] {
            let mut fixture = Fixture::of(
                mesh.clone(),
                kernel,
                Linear(rock()),
                BlockOptions::default(),
            );
            let u = fixture.field(|x| GRADIENT * x * 1e-3);
            let forces = fixture.forces(&u, &zeros(u.len()));
            let inner = |x: [usize; 3]| (1..3).contains(&x[0]) && (1..4).contains(&x[1]);
            for (force, &node) in forces.iter().zip(fixture.block.nodes()) {
                let node = node as usize;
                let place = [node % 4, node / 4 % 5, node / 20];
                if inner(place) && (1..5).contains(&place[2]) {
                    assert!(force.norm() < 1e-12 * largest(&forces), "{force}");
                }
            }
            let gradient = Strain::from_gradient(&(GRADIENT * 1e-3));
            let exact = Stress::elastic(rock().lambda(), rock().shear(), &gradient);
            for stress in fixture.stress(&u) {
                assert!((stress - exact).0.iter().all(|s| s.abs() < 1e-12 * 9e9));
            }
        }
    }
}

/// Blocks of boxes have the same bits with one lane as with many.
#[test]
fn lanes_change_no_bit_of_boxes() {
    for mesh in meshes() {
        let forces = [LaneWidth::Native, LaneWidth::One].map(|lanes| {
            let chosen = options(Precision::F64, lanes, 1e-3);
            let mut fixture =
                Fixture::of(mesh.clone(), SolidKernel::Hex8Full, Linear(rock()), chosen);
            let (u, v) = (fixture.noise(5, 1e-3), fixture.noise(6, 1e-1));
            fixture.forces(&u, &v)
        });
        assert_eq!(forces[0], forces[1]);
    }
}

/// A displacement that is not a number is a fault of its element in blocks of boxes too.
#[test]
fn boxes_find_faults() {
    let [mesh, ..] = meshes();
    let mut fixture = Fixture::of(
        mesh,
        SolidKernel::Hex8Full,
        Linear(rock()),
        BlockOptions::default(),
    );
    let mut u = fixture.noise(5, 1e-3);
    u[0].values[2] = f64::NAN;
    let rest = zeros(u.len());
    let context = BlockContext::new(when(0, 0.0), NodalView::F64(&u), NodalView::F64(&rest));
    let fault = fixture.forces_at(&context).unwrap_err();
    // The last node of the mesh, which is a corner of its last element.
    assert_eq!(fault.element as usize, fixture.mesh.element_count() - 1);
}
