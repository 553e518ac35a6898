//! Bricks that bend as their material does: any shape, frame and numbering, and closed forms of right bricks.

use powerhouse_model::OwnStep;
use proptest::prelude::*;

use super::*;

/// A brick of edges from 0.2 to 4 m in any place and position, with corners moved by up to a share of its edges.
fn any_brick(share: f64) -> impl Strategy<Value = [Vec3; 8]> {
    let edges = prop::array::uniform3(0.1..2.0_f64);
    let place = prop::array::uniform3(-20.0..20.0_f64);
    let angles = prop::array::uniform3(-3.0..3.0_f64);
    let moves = prop::array::uniform8(prop::array::uniform3(-1.0..1.0_f64));
    (edges, place, angles, moves).prop_map(move |(edges, place, [a, b, c], moves)| {
        let turn = Rotation3::from_euler_angles(a, b, c);
        core::array::from_fn(|n| {
            let natural = Vec3::from(hexahedron::CORNERS[n]) + Vec3::from(moves[n]) * share;
            turn * natural.component_mul(&Vec3::from(edges)) + Vec3::from(place)
        })
    })
}

/// A cube of edges of two metres with corners moved by up to a share of half of them.
fn jittered_cube(share: f64) -> impl Strategy<Value = [Vec3; 8]> {
    let moves = prop::array::uniform8(prop::array::uniform3(-share..share));
    moves.prop_map(|moves| {
        core::array::from_fn(|n| Vec3::from(hexahedron::CORNERS[n]) + Vec3::from(moves[n]))
    })
}

/// A nodal field that no brick has as a linear one.
fn bent(corners: &[Vec3; 8]) -> [[f64; 3]; 8] {
    let centre = corners.iter().sum::<Vec3>() / 8.0;
    corners.map(|corner| {
        let x = corner - centre;
        (GRADIENT * x + Vec3::new(x.y * x.z, x.z * x.x, x.x * x.y * x.z + x.x * x.y)).into()
    })
}

/// The places of the corners under a rotation of the natural coordinates: right-handed, by an index below 24.
fn renumbering(index: usize) -> [usize; 8] {
    let orders = [
        [0, 1, 2],
        [1, 2, 0],
        [2, 0, 1],
        [1, 0, 2],
        [0, 2, 1],
        [2, 1, 0],
    ];
    let order = orders[index / 4];
    let odd = index / 4 >= 3;
    let signs = [
        [1.0, 1.0, 1.0],
        [1.0, -1.0, -1.0],
        [-1.0, 1.0, -1.0],
        [-1.0, -1.0, 1.0],
    ];
    let signs = signs[index % 4].map(|sign| if odd { -sign } else { sign });
    hexahedron::CORNERS.map(|corner| {
        let turned: [f64; 3] = core::array::from_fn(|i| signs[i] * corner[order[i]]);
        let mut corners = hexahedron::CORNERS.iter();
        corners.position(|other| *other == turned).unwrap()
    })
}

fn close(a: &[[f64; 3]; 8], b: &[[f64; 3]; 8], bound: f64) -> bool {
    let size = largest(a).max(largest(b));
    let mut pairs = a.as_flattened().iter().zip(b.as_flattened());
    pairs.all(|(a, b)| (a - b).abs() <= bound * size)
}

proptest! {
    /// Linear fields are exact and free of hourglass energy, rigid motions free of force; a rotated and a renumbered
    /// brick has the rotated and renumbered forces.
    #[test]
    fn frame_and_numbering_leave_no_trace(
        corners in any_brick(0.2),
        angles in prop::array::uniform3(-3.0..3.0_f64),
        index in 0_usize..24,
    ) {
        let element = Element::new::<1>(Hex8Natural, corners);
        let linear = element.nodal(|x| GRADIENT * x);
        let exact = Strain::from_gradient(&GRADIENT);
        for i in 0..6 {
            prop_assert!((element.strains::<1>(&linear)[0].0[i] - exact.0[i]).abs() < 1e-11);
        }
        let whole = element.medium.constrained() * element.volume::<1>();
        prop_assert!(element.hourglass_energy::<1>(&linear).abs() < 1e-22 * whole);
        let stiffness = element.stiffness::<1>().amax();
        let rigid = element.nodal(|x| Vec3::new(0.5, -0.3, 0.8).cross(x) + Vec3::repeat(3.0));
        prop_assert!(largest(&element.forces::<1>(&rigid)) < 1e-12 * stiffness * largest(&rigid));

        let nodal = bent(&corners);
        let forces = element.forces::<1>(&nodal);
        let turn = Rotation3::from_euler_angles(angles[0], angles[1], angles[2]);
        let turned = Element::new::<1>(Hex8Natural, corners.map(|x| turn * x));
        let of_turned = turned.forces::<1>(&nodal.map(|u| (turn * Vec3::from(u)).into()));
        let back = of_turned.map(|f| (turn.inverse() * Vec3::from(f)).into());
        prop_assert!(close(&forces, &back, 1e-10));

        let places = renumbering(index);
        let other = Element::new::<1>(Hex8Natural, places.map(|place| corners[place]));
        let of_other = other.forces::<1>(&places.map(|place| nodal[place]));
        prop_assert!(close(&places.map(|place| forces[place]), &of_other, 1e-10));
    }

    /// The shorter forms for boxes along the axes and for parallelepipeds are the general one: forces, energy, surface
    /// stress and what flows.
    #[test]
    fn straight_bricks_are_natural_bricks(
        edges in prop::array::uniform3(0.1..2.0_f64),
        skew in prop::array::uniform9(-0.3..0.3_f64),
        share in 0.0..1.0_f64,
    ) {
        let skew = Mat3::identity() + Mat3::from_row_slice(&skew);
        let corner = |x: [f64; 3]| Vec3::from(x).component_mul(&Vec3::from(edges));
        for along_axes in [true, false] {
            let shape = if along_axes { Mat3::identity() } else { skew };
            let corners = hexahedron::CORNERS.map(|x| shape * corner(x) + Vec3::new(3.0, 5.0, -2.0));
            let general = Element::new::<1>(Hex8Natural, corners);
            let short = Element::new::<1>(straight(along_axes), corners);
            let nodal = bent(&corners);
            let (a, b) = (general.forces::<1>(&nodal), short.forces::<1>(&nodal));
            prop_assert!(close(&a, &b, 1e-11));
            let [a, b] = [general.hourglass_energy::<1>(&nodal), short.hourglass_energy::<1>(&nodal)];
            prop_assert!((a - b).abs() < 1e-11 * a);
            let a = surface_stresses(&general, &nodal);
            let b = surface_stresses(&short, &nodal);
            for (a, b) in a.iter().zip(b) {
                let size = a.0.iter().fold(0.0, |most: f64, s| most.max(s.abs()));
                prop_assert!((*a - b).0.iter().all(|s| s.abs() < 1e-9 * size));
            }
            let [a, b] = [flowed(&general, &nodal, share), flowed(&short, &nodal, share)];
            let size = a.iter().fold(0.0, |most: f64, s| most.max(s.abs()));
            prop_assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-9 * size));
        }
    }

    /// Eight points with the bending strains of the material are equal to one with its stress, on any brick.
    #[test]
    fn eight_elastic_points_are_one_that_bends(
        corners in any_brick(0.2),
        poisson in 0.0..0.499_f64,
    ) {
        let medium = ElasticMedium::new(9.0e9, poisson, 2750.0).unwrap();
        let mut one = Element::new::<1>(Hex8Natural, corners);
        let mut eight = Element::new::<8>(Hex8Eas::new(&medium), corners);
        (one.medium, eight.medium) = (medium, medium);
        let (one, eight) = (one.stiffness::<1>(), eight.stiffness::<8>());
        prop_assert!((&one - &eight).amax() < 1e-12 * one.amax());
    }

    /// A brick of natural bending oscillates no faster than one of the mean gradient alone: not at all if it is right, and
    /// by a few thousandths if its corners are moved by a tenth; it has no motion without energy but the rigid ones.
    #[test]
    fn bending_costs_no_step(
        right in any_brick(0.0),
        edges in prop::array::uniform3(0.5..1.0_f64),
        bent in jittered_cube(0.1),
        poisson in 0.0..0.499_f64,
    ) {
        let medium = ElasticMedium::new(9.0e9, poisson, 2750.0).unwrap();
        let bent = bent.map(|x| x.component_mul(&Vec3::from(edges)));
        for (corners, most) in [(right, 1.0 + 1e-9), (bent, 1.003)] {
            let mut natural = Element::new::<1>(Hex8Natural, corners);
            let mut mean = Element::new::<1>(Hex8OnePoint::new(1e-3).unwrap(), corners);
            (natural.medium, mean.medium) = (medium, medium);
            let shares = natural.kernel.node_shares(&corners);
            let squares = |stiffness: DMatrix<f64>| {
                let scaled = DMatrix::from_fn(24, 24, |i, j| {
                    stiffness[(i, j)] / (shares[i / 3] * shares[j / 3]).sqrt()
                });
                SymmetricEigen::new(scaled).eigenvalues
            };
            let (values, of_mean) = (squares(natural.stiffness::<1>()), squares(mean.stiffness::<1>()));
            let ratio = (values.max() / of_mean.max()).sqrt();
            prop_assert!(ratio <= most, "{ratio} {most}");
            let mut sorted: Vec<f64> = values.iter().map(|value| value / values.max()).collect();
            sorted.sort_by(f64::total_cmp);
            prop_assert!(sorted[5].abs() < 1e-11 && sorted[6] > 1e-8, "{sorted:?}");
        }
    }
}

fn surface_stresses<K: ElementKernel<8, 1>>(
    element: &Element<K, 8>,
    nodal: &[[f64; 3]; 8],
) -> [Stress; 3] {
    let modes = element.kernel.modes(nodal);
    let hourglass = element.hourglass::<1>();
    let found = (element.kernel).surface_stresses(element.geometry(), &hourglass, &modes);
    found.unwrap()
}

/// Own history after a step from rest to nodal displacements with an elastic share of the strain.
fn flowed<K: ElementKernel<8, 1>>(
    element: &Element<K, 8>,
    nodal: &[[f64; 3]; 8],
    share: f64,
) -> Vec<f64> {
    let modes = element.kernel.modes(nodal);
    let stresses = element.stresses::<1>(nodal);
    let before = vec![0.0; element.kernel.own_history()];
    let moduli = element.hourglass::<1>().moduli;
    let step = OwnStep::new(&before, &modes, &stresses).with_flow(&modes, moduli, [share, 0.7]);
    let mut after = before.clone();
    (element.kernel).own_history_after(element.geometry(), &step, &mut after);
    after
}

/// A right brick under the displacement `u_x = k x z` has the energy of a plate in bending, held along y, and its stress at
/// the surface.
#[test]
fn a_right_brick_bends_as_a_plate() {
    let (half, curvature) = (Vec3::new(0.7, 1.1, 0.3), 1e-3);
    let corners = hexahedron::CORNERS.map(|x| Vec3::from(x).component_mul(&half));
    for kernel in [straight(true), straight(false)] {
        let element = Element::new::<1>(kernel, corners);
        let medium = element.medium;
        let nodal = element.nodal(|x| Vec3::x() * (curvature * x.x * x.z));
        let stiffness = medium.young / (1.0 - medium.poisson.powi(2));
        let moment = 8.0 * half.x * half.y * half.z.powi(3) / 3.0;
        let exact = 0.5 * stiffness * moment * curvature * curvature;
        let found = element.hourglass_energy::<1>(&nodal);
        assert!((found / exact - 1.0).abs() < 1e-12, "{found} {exact}");
        let [.., across] = surface_stresses(&element, &nodal);
        let bending = stiffness * curvature * half.z;
        for (found, exact) in across.0.into_iter().zip([1.0, medium.poisson]) {
            assert!((found / bending - exact).abs() < 1e-12, "{across:?}");
        }
        // Twisted, it has the torsional stiffness of a plate.
        let nodal = element.nodal(|x| Vec3::new(x.y * x.z, x.x * x.z, -x.x * x.y) * curvature);
        let exact = 2.0 * medium.shear() * moment * curvature * curvature;
        let found = element.hourglass_energy::<1>(&nodal);
        assert!((found / exact - 1.0).abs() < 1e-12, "{found} {exact}");
    }
}

/// Hourglass forces that grow in proportion keep the elastic share of their increment; those that fall are elastic. What
/// becomes plastic costs energy.
#[test]
fn bending_flows_with_its_point() {
    let element = Element::new::<1>(Hex8Natural, brick());
    let nodal = bent(&element.corners);
    let modes = element.kernel.modes(&nodal);
    let stresses = element.stresses::<1>(&nodal);
    let moduli = element.hourglass::<1>().moduli;
    let times = |factor: f64| modes.map(|mode| mode.map(|value| value * factor));
    let energy = |modes: &[[f64; 3]; 8], own: &[f64]| {
        let hourglass = Hourglass::new(moduli).with_history(own);
        let found = (element.kernel).hourglass_energy(element.geometry(), &hourglass, modes);
        found.unwrap()
    };
    let flow = |own: &[f64], at: f64, moved: f64, [share, kept]: [f64; 2]| {
        let (at, moved) = (times(at), times(moved));
        let step = OwnStep::new(own, &at, &stresses).with_flow(&moved, moduli, [share, kept]);
        let mut after = [0.0; 12];
        (element.kernel).own_history_after(element.geometry(), &step, &mut after);
        after
    };
    let virgin = [0.0; 12];
    let whole = energy(&modes, &[]);
    let step = |own: &[f64], at, moved, share| flow(own, at, moved, [share, 1.0]);
    // Elastic to 1, then a fifth of the increment to 1.5.
    assert_eq!(step(&virgin, 1.0, 1.0, 1.0), virgin);
    let own = step(&virgin, 1.5, 0.5, 0.2);
    let kept = energy(&times(1.5), &own).sqrt() / whole.sqrt();
    assert!((kept - 1.1).abs() < 1e-12, "{kept}");
    // Back by 0.3 while the point flows the other way: elastic.
    assert_eq!(step(&own, 1.2, -0.3, 0.2), own);
    // All of it plastic: a fiftieth of the increment is left.
    let own = step(&virgin, 2.0, 2.0, 0.0);
    let kept = energy(&times(2.0), &own).sqrt() / whole.sqrt();
    assert!((kept - 0.04).abs() < 1e-12, "{kept}");
    // At rest while the point flows: forces relax with its stress.
    let own = flow(&virgin, 1.0, 0.0, [0.2, 0.7]);
    let kept = energy(&times(1.0), &own).sqrt() / whole.sqrt();
    assert!((kept - 0.7).abs() < 1e-12, "{kept}");
}
