//! The composite tetrahedron against its definition.

use super::*;

/// Corners and midpoints of a distorted tetrahedron.
fn corners() -> [Vec3; 10] {
    let corners = tetrahedron();
    let edges = ElementKind::Tet10.edges_with_midpoint();
    core::array::from_fn(|a| match a {
        0..4 => corners[a],
        _ => {
            let [b, c] = edges[a - 4].map(|end| corners[usize::from(end)]);
            (b + c) * 0.5
        }
    })
}

fn element(poisson: f64) -> Element<Tet10, 10> {
    let medium = ElasticMedium::new(9.0e9, poisson, 2750.0).unwrap();
    let mut element = Element::new::<4>(Tet10::new(&medium), corners());
    element.medium = medium;
    element
}

/// A field without any symmetry.
fn bent(x: &Vec3) -> Vec3 {
    let x = x - Vec3::new(3.0, -7.0, 5.0);
    GRADIENT * x
        + 0.3
            * Vec3::new(
                x.y * x.z - 0.4 * x.x * x.x,
                x.z * x.x + 0.7 * x.y * x.y,
                x.x * x.y - 0.2 * x.z * x.z,
            )
}

/// Corner coordinates of natural coordinates.
fn shares(natural: &Vec3) -> [f64; 4] {
    [1.0 - natural.sum(), natural.x, natural.y, natural.z]
}

/// Displacement gradients at the corners by their definition: the gradient that is linear in position and differs least, in
/// the mean of the square over the volume, from the gradients of the twelve parts.
fn projected(corners: &[Vec3; 10], nodal: &[[f64; 3]; 10]) -> [Mat3; 4] {
    let kind = ElementKind::Tet10;
    let jacobian = Mat3::from_columns(&[1, 2, 3].map(|a| corners[a] - corners[0]));
    let inverse = jacobian.try_inverse().unwrap();
    // Centroids of the parts, each with an eighth of the volume at the corners and a sixteenth inside.
    let nodes = kind.natural_corners();
    let at = |node: usize| Vec3::from(nodes[node]);
    let edges = kind.edges_with_midpoint();
    let middles = |of: usize, touching: bool| -> Vec<usize> {
        let touches = |edge: &[u8; 2]| edge.contains(&(of as u8)) == touching;
        (0..6)
            .filter(|&i| touches(&edges[i]))
            .map(|i| 4 + i)
            .collect()
    };
    let centre = Vec3::repeat(0.25);
    let mut parts = Vec::new();
    for corner in 0..4 {
        let around: Vec3 = middles(corner, true).into_iter().map(at).sum();
        parts.push(((around + at(corner)) / 4.0, 1.0 / 8.0));
        parts.push(((around + centre) / 4.0, 1.0 / 16.0));
        let across: Vec3 = middles(corner, false).into_iter().map(at).sum();
        parts.push(((across + centre) / 4.0, 1.0 / 16.0));
    }
    let mut right = [Mat3::zeros(); 4];
    for (natural, volume) in parts {
        let mut slopes = [Vec3::zeros(); 10];
        kind.shape_gradients(&natural, &mut slopes);
        let terms = nodal.iter().zip(slopes);
        let gradient: Mat3 = terms
            .map(|(u, slope)| Vec3::from(*u) * slope.transpose())
            .sum::<Mat3>()
            * inverse;
        for (sum, share) in right.iter_mut().zip(shares(&natural)) {
            *sum += gradient * (share * volume);
        }
    }
    // The inverse of (1 + d_ab) / 20 is 20 (d_ab - 1/5).
    let all: Mat3 = right.iter().sum();
    right.map(|one| (one - all * 0.2) * 20.0)
}

/// The strains at the points are those of the projected gradient, with the volumetric part blended with its mean.
#[test]
fn strains_are_projected_and_blended() {
    for poisson in [0.0, 0.2, 0.3, 0.4999] {
        let element = element(poisson);
        let nodal = element.nodal(bent);
        let at_corners = projected(&element.corners, &nodal);
        let points = element.kernel.point_positions(&element.corners);
        let jacobian =
            Mat3::from_columns(&[1, 2, 3].map(|a| element.corners[a] - element.corners[0]));
        let inverse = jacobian.try_inverse().unwrap();
        let local: Vec<Strain> = points
            .iter()
            .map(|point| {
                let weights = shares(&(inverse * (point - element.corners[0])));
                let terms = at_corners.iter().zip(weights);
                let gradient: Mat3 = terms.map(|(gradient, weight)| gradient * weight).sum();
                Strain::from_gradient(&gradient)
            })
            .collect();
        let trace = |strain: &Strain| strain.0[0] + strain.0[1] + strain.0[2];
        let mean = local.iter().map(trace).sum::<f64>() / 4.0;
        let blend = ((1.0 - 2.0 * poisson) / (1.0 + poisson)).sqrt();
        for (found, local) in element.strains::<4>(&nodal).iter().zip(&local) {
            let shift = (mean - trace(local)) * (1.0 - blend) / 3.0;
            for i in 0..6 {
                let expected = local.0[i] + if i < 3 { shift } else { 0.0 };
                assert!((found.0[i] - expected).abs() < 1e-13, "{poisson} {i}");
            }
        }
    }
}

/// The formula of the derivative along an edge, at a corner, gives linear fields exactly; the field of a single corner and
/// of a single midpoint has the coefficients of the formula.
#[test]
fn the_derivative_along_an_edge_has_its_coefficients() {
    let element = element(0.0);
    // (node, at corner 0 along edge 01): the coefficients, times 24.
    let coefficients = [-51.0, -9.0, 0.0, 0.0, 70.0, -2.0, -8.0, -8.0, 10.0, -2.0];
    for (node, coefficient) in coefficients.into_iter().enumerate() {
        let mut nodal = [[0.0; 3]; 10];
        nodal[node] = [1.0, 0.0, 0.0];
        let gradient = projected(&element.corners, &nodal)[0];
        let along = (gradient * (element.corners[1] - element.corners[0])).x;
        assert!((along - coefficient / 24.0).abs() < 1e-13, "{node} {along}");
    }
}

/// A linear field has its exact strain; translation and rotation have none.
#[test]
fn linear_fields_are_exact() {
    for poisson in [0.0, 0.3, 0.4999] {
        let element = element(poisson);
        let nodal = element.nodal(|x| GRADIENT * x + Vec3::new(9.0, 8.0, -7.0));
        let exact = Strain::from_gradient(&GRADIENT);
        for strain in element.strains::<4>(&nodal) {
            for i in 0..6 {
                assert!((strain.0[i] - exact.0[i]).abs() < 2e-13, "{strain:?}");
            }
        }
        let scale = element.medium.constrained();
        let shift = element.nodal(|_| Vec3::new(0.3, -1.7, 2.1));
        assert!(largest(&element.forces::<4>(&shift)) <= 1e-15 * scale);
        let rotation = element.nodal(|x| Vec3::new(0.5, -0.3, 0.8).cross(x));
        for strain in element.strains::<4>(&rotation) {
            assert!(strain.0.iter().all(|e| e.abs() < 1e-13), "{strain:?}");
        }
    }
}

/// A uniform stress has at each node of a side a twelfth of the traction at corners and a quarter at midpoints.
#[test]
fn uniform_stress_is_uniform_traction() {
    let element = element(0.3);
    let nodal = element.nodal(|x| GRADIENT * x);
    let stress = element.stresses::<4>(&nodal)[0].matrix();
    let forces = element.forces::<4>(&nodal);
    let mut builder = powerhouse_model::Mesh::builder();
    for (tag, position) in (1..).zip(element.corners) {
        builder.node(tag, position);
    }
    let tags: Vec<u64> = (1..=10).collect();
    builder.element(1, ElementKind::Tet10, &tags, &["rock"]);
    let mesh = builder.build().unwrap();
    let mut expected = [Vec3::zeros(); 10];
    for side in 0..4 {
        let geometry = mesh.facet_geometry(powerhouse_model::Facet { element: 0, side });
        for (&node, share) in geometry.nodes.iter().zip(&geometry.shares) {
            expected[node as usize] += stress * share;
        }
    }
    let scale = largest(&forces);
    for (force, expected) in forces.iter().zip(expected) {
        assert!((Vec3::from(*force) - expected).norm() < 1e-13 * scale);
    }
}

/// The stiffness is symmetric and has six zero modes, up to nearly incompressible material; without any local volumetric
/// strain it would have nine.
#[test]
fn stiffness_has_six_zero_modes() {
    let zeros = |element: &Element<Tet10, 10>, least: f64| {
        let stiffness = element.stiffness::<4>();
        assert!((&stiffness - stiffness.transpose()).norm() < 1e-14 * stiffness.norm());
        let values = SymmetricEigen::new(stiffness).eigenvalues;
        let shear = element.medium.shear();
        assert!(values.iter().all(|value| *value > -1e-13 * values.max()));
        values
            .iter()
            .filter(|value| **value < least * shear)
            .count()
    };
    for poisson in [-0.2, 0.0, 0.2, 0.3, 0.45, 0.49] {
        assert_eq!(zeros(&element(poisson), 0.02), 6, "{poisson}");
    }
    let mut averaged = element(0.3);
    averaged.kernel.blend = 0.0;
    assert_eq!(zeros(&averaged, 0.02), 9);
}

/// The forces are the derivative of the elastic energy, and a rotated element has the rotated forces.
#[test]
fn forces_hold_the_energy_in_every_frame() {
    for poisson in [0.0, 0.3, 0.49] {
        let element = element(poisson);
        let nodal = element.nodal(bent);
        let forces = element.forces::<4>(&nodal);
        let pairs = forces.as_flattened().iter().zip(nodal.as_flattened());
        let work: f64 = pairs.map(|(force, value)| 0.5 * force * value).sum();
        let volumes = element.kernel.volumes(element.geometry());
        let points = element.stresses::<4>(&nodal).into_iter();
        let points = points.zip(element.strains::<4>(&nodal)).zip(volumes);
        let held: f64 = points
            .map(|((s, e), volume)| 0.5 * s.work(&e) * volume)
            .sum();
        assert!((work - held).abs() < 1e-12 * held, "{work} {held}");

        let rotation = Rotation3::from_euler_angles(0.4, -1.1, 2.3);
        let mut turned = Element::new::<4>(element.kernel, element.corners.map(|x| rotation * x));
        turned.medium = element.medium;
        let turned_nodal = nodal.map(|u| (rotation * Vec3::from(u)).into());
        for (force, other) in forces.iter().zip(turned.forces::<4>(&turned_nodal)) {
            let error = rotation * Vec3::from(*force) - Vec3::from(other);
            assert!(error.norm() < 1e-12 * largest(&forces));
        }
    }
}

/// Lumped shares are the sums over the twelve parts, positive, and sum to one.
#[test]
fn masses_are_sums_over_the_parts() {
    let element = element(0.3);
    let shares = element.kernel.node_shares(&element.corners);
    assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-15);
    // A quarter of an eighth at a corner; the rest, the centroid's share included, is that of the midpoints.
    assert_eq!(shares[0], 1.0 / 32.0);
    assert!((shares[4] - (1.0 - 4.0 / 32.0) / 6.0).abs() < 1e-15);
}
