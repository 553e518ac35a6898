//! Properties of every kernel, on distorted elements.

mod natural;
mod tet10;

use nalgebra::{DMatrix, Rotation3, SymmetricEigen};
use powerhouse_model::{
    ElasticMedium, ElementKernel, Geometry, Hourglass, KernelArithmetic, Mat3, Strain, Stress, Vec3,
};

use super::straight_brick::StraightBrick;
use super::straight_natural::StraightNatural;
use super::*;

/// One element in an isotropic medium, in double precision.
struct Element<K, const N: usize> {
    kernel: K,
    corners: [Vec3; N],
    numbers: Vec<f64>,
    medium: ElasticMedium,
}

impl<K, const N: usize> Element<K, N> {
    fn new<const P: usize>(kernel: K, corners: [Vec3; N]) -> Self
    where
        K: ElementKernel<N, P>,
    {
        let mut numbers = vec![0.0; kernel.geometry_len()];
        kernel.geometry(&corners, &mut numbers);
        let medium = rock();
        Self {
            kernel,
            corners,
            numbers,
            medium,
        }
    }
    fn geometry(&self) -> Geometry<'_, f64> {
        Geometry::new((), &self.numbers)
    }
    fn nodal(&self, field: impl Fn(&Vec3) -> Vec3) -> [[f64; 3]; N] {
        self.corners.map(|corner| field(&corner).into())
    }
    fn strains<const P: usize>(&self, nodal: &[[f64; 3]; N]) -> [Strain; P]
    where
        K: ElementKernel<N, P>,
    {
        self.kernel
            .strains(self.geometry(), &self.kernel.modes(nodal))
    }
    fn stresses<const P: usize>(&self, nodal: &[[f64; 3]; N]) -> [Stress; P]
    where
        K: ElementKernel<N, P>,
    {
        let (lambda, shear) = (self.medium.lambda(), self.medium.shear());
        self.strains::<P>(nodal)
            .map(|strain| Stress::elastic(lambda, shear, &strain))
    }
    fn forces<const P: usize>(&self, nodal: &[[f64; 3]; N]) -> [[f64; 3]; N]
    where
        K: ElementKernel<N, P>,
    {
        let modes = self.kernel.modes(nodal);
        let stresses = self.stresses::<P>(nodal);
        let modal = self
            .kernel
            .forces(self.geometry(), &stresses, &self.hourglass::<P>(), &modes);
        self.kernel.nodal_forces(&modal)
    }
    fn hourglass_energy<const P: usize>(&self, nodal: &[[f64; 3]; N]) -> f64
    where
        K: ElementKernel<N, P>,
    {
        let modes = self.kernel.modes(nodal);
        self.kernel
            .hourglass_energy(self.geometry(), &self.hourglass::<P>(), &modes)
            .unwrap_or(0.0)
    }
    fn hourglass<const P: usize>(&self) -> Hourglass<'static, f64>
    where
        K: ElementKernel<N, P>,
    {
        let moduli = self.kernel.hourglass_moduli(&self.medium);
        Hourglass::new(moduli.unwrap_or_default())
    }
    fn volume<const P: usize>(&self) -> f64
    where
        K: ElementKernel<N, P>,
    {
        self.kernel.volumes(self.geometry()).iter().sum()
    }
    fn stiffness<const P: usize>(&self) -> DMatrix<f64>
    where
        K: ElementKernel<N, P>,
    {
        let mut stiffness = DMatrix::zeros(3 * N, 3 * N);
        for column in 0..3 * N {
            let mut nodal = [[0.0; 3]; N];
            nodal[column / 3][column % 3] = 1.0;
            let forces = self.forces::<P>(&nodal);
            for row in 0..3 * N {
                stiffness[(row, column)] = forces[row / 3][row % 3];
            }
        }
        stiffness
    }
}

const GRADIENT: Mat3 = Mat3::new(1.1, -0.4, 0.3, 0.8, -0.6, 0.9, -0.2, 0.5, 0.7);

/// Moves corners by up to a fifth of the edges of 2 m, without symmetry, far from the origin.
fn distorted<const N: usize>(corners: [[f64; 3]; N]) -> [Vec3; N] {
    let mut state = 0.37_f64;
    corners.map(|corner| {
        let mut moved = Vec3::from(corner);
        for i in 0..3 {
            state = (state * 97.13 + 0.211).fract();
            moved[i] += 0.4 * (state - 0.5);
        }
        moved + Vec3::new(3.0, -7.0, 5.0)
    })
}

fn rock() -> ElasticMedium {
    ElasticMedium::new(9.0e9, 0.27, 2750.0).unwrap()
}
fn brick() -> [Vec3; 8] {
    distorted(hexahedron::CORNERS)
}
fn parallelepiped() -> [Vec3; 8] {
    let skew = Mat3::new(1.0, 0.3, -0.2, 0.1, 0.8, 0.4, -0.3, 0.2, 1.3);
    hexahedron::CORNERS.map(|x| skew * Vec3::from(x) + Vec3::new(3.0, 5.0, -2.0))
}
fn skewed(mean_dilatation: bool) -> StraightBrick {
    StraightBrick {
        along_axes: false,
        mean_dilatation,
    }
}
fn straight(along_axes: bool) -> StraightNatural {
    StraightNatural { along_axes }
}
fn wedge() -> [Vec3; 6] {
    distorted([
        [0.0, 0.0, 0.0],
        [2.0, 0.0, 0.0],
        [0.0, 2.0, 0.0],
        [0.0, 0.0, 2.0],
        [2.0, 0.0, 2.0],
        [0.0, 2.0, 2.0],
    ])
}
fn pyramid() -> [Vec3; 5] {
    distorted([
        [-1.0, -1.0, -1.0],
        [1.0, -1.0, -1.0],
        [1.0, 1.0, -1.0],
        [-1.0, 1.0, -1.0],
        [0.0, 0.0, 1.0],
    ])
}
fn tetrahedron() -> [Vec3; 4] {
    distorted([
        [0.0, 0.0, 0.0],
        [2.0, 0.0, 0.0],
        [0.0, 2.0, 0.0],
        [0.0, 0.0, 2.0],
    ])
}

fn largest<const N: usize>(forces: &[[f64; 3]; N]) -> f64 {
    forces
        .as_flattened()
        .iter()
        .fold(0.0, |m, f| m.max(f.abs()))
}

/// The exact mean gradient matrix by high-order quadrature of `grad N` over the brick.
fn mean_gradients(corners: &[Vec3; 8]) -> (f64, [Vec3; 8], [f64; 8]) {
    let g = (0.6_f64).sqrt();
    let rule = [(-g, 5.0 / 9.0), (0.0, 8.0 / 9.0), (g, 5.0 / 9.0)];
    let (mut volume, mut gradients, mut shares) = (0.0, [Vec3::zeros(); 8], [0.0; 8]);
    for (r, wr) in rule {
        for (s, ws) in rule {
            for (t, wt) in rule {
                let natural = [r, s, t];
                let shape = hexahedron::CORNERS.map(|signs| {
                    let f = |i: usize| 0.5 * (1.0 + signs[i] * natural[i]);
                    let d = |i: usize| 0.5 * signs[i];
                    let derivative =
                        Vec3::new(d(0) * f(1) * f(2), f(0) * d(1) * f(2), f(0) * f(1) * d(2));
                    (f(0) * f(1) * f(2), derivative)
                });
                let jacobian: Mat3 = (0..8).map(|a| corners[a] * shape[a].1.transpose()).sum();
                let weight = wr * ws * wt * jacobian.determinant();
                let inverse = jacobian.try_inverse().unwrap();
                volume += weight;
                for a in 0..8 {
                    gradients[a] += inverse.transpose() * shape[a].1 * weight;
                    shares[a] += shape[a].0 * weight;
                }
            }
        }
    }
    (
        volume,
        gradients.map(|gradient| gradient / volume),
        shares.map(|share| share / volume),
    )
}

/// Corners of a regular element with `N` nodes, away from the origin; edges along the axes.
fn affine<const N: usize>() -> [Vec3; N] {
    let kind = match N {
        8 => ElementKind::Hex8,
        6 => ElementKind::Wedge6,
        5 => ElementKind::Pyramid5,
        _ => ElementKind::Tet4,
    };
    let corners = kind.natural_corners();
    core::array::from_fn(|a| {
        let natural = Vec3::from(corners[a]);
        natural.component_mul(&Vec3::new(1.5, 0.8, 2.0)) + Vec3::new(3.0, -2.0, 5.0)
    })
}

macro_rules! kernel_tests {
    ($module:ident, $kernel:expr, $corners:expr, $nodes:literal, $points:literal) => {
        mod $module {
            use super::*;

            fn element() -> Element<impl ElementKernel<$nodes, $points>, $nodes> {
                Element::new::<$points>($kernel, $corners)
            }

            /// A linear field has its exact strain at every point and no hourglass energy.
            #[test]
            fn linear_fields_are_exact() {
                let element = element();
                let nodal = element.nodal(|x| GRADIENT * x + Vec3::new(9.0, 8.0, -7.0));
                let exact = Strain::from_gradient(&GRADIENT);
                for strain in element.strains::<$points>(&nodal) {
                    for i in 0..6 {
                        assert!((strain.0[i] - exact.0[i]).abs() < 1e-13, "{strain:?}");
                    }
                }
                let held = element.hourglass_energy::<$points>(&nodal);
                let scale = element.medium.constrained() * element.volume::<$points>();
                assert!(held < 1e-27 * scale, "{held}");
            }

            /// A constant stress has the nodal forces `sigma` times the integral of `grad N`,
            /// which is the derivative of the volume by the corner.
            #[test]
            fn constant_stress_works_on_the_change_of_volume() {
                let element = element();
                let nodal = element.nodal(|x| GRADIENT * x);
                let stress = element.stresses::<$points>(&nodal)[0].matrix();
                let forces = element.forces::<$points>(&nodal);
                for a in 0..$nodes {
                    let gradient = Vec3::from_fn(|i, _| {
                        let at = |offset: f64| {
                            let mut corners = element.corners;
                            corners[a][i] += offset;
                            Element::new::<$points>($kernel, corners).volume::<$points>()
                        };
                        // The volume is cubic in all and linear in one coordinate.
                        (at(0.5) - at(-0.5)) / 1.0
                    });
                    let exact = stress * gradient;
                    let error = (Vec3::from(forces[a]) - exact).norm();
                    assert!(error < 1e-11 * stress.norm(), "{error}");
                }
            }

            /// The positions of the integration points, weighted by their volumes, have the mean of the corners
            /// of a parallelepiped or tetrahedron, its centroid, or that of a pyramid; and where an element has several points, a
            /// shear strain that grows linearly has at each point the value of its position.
            #[test]
            fn points_are_where_strains_are_taken() {
                let regular = Element::new::<$points>($kernel, affine::<$nodes>());
                let positions = regular.kernel.point_positions(&regular.corners);
                let volumes = regular.kernel.volumes(regular.geometry());
                let volume: f64 = volumes.iter().sum();
                let mut centroid = Vec3::zeros();
                for (position, share) in positions.iter().zip(volumes) {
                    centroid += position * (share / volume);
                }
                let natural = regular.kernel.kind().natural_centre();
                let [mean] = super::super::positions(
                    regular.kernel.kind(),
                    &regular.corners,
                    [natural.into()],
                );
                assert!((centroid - mean).norm() < 1e-13, "{centroid} {mean}");
                if $points > 1 {
                    let nodal = regular.nodal(|x| Vec3::new(0.0, x.x * x.z, 0.0));
                    for (strain, position) in
                        regular.strains::<$points>(&nodal).iter().zip(positions)
                    {
                        assert!(
                            (strain.0[3] - position.z).abs() < 1e-13,
                            "{strain:?} {position}"
                        );
                    }
                }
            }

            /// Translation gives no strain and no force; infinitesimal rotation none to round-off.
            #[test]
            fn rigid_motion_is_free() {
                let element = element();
                let scale = element.medium.constrained();
                let shift = element.nodal(|_| Vec3::new(0.3, -1.7, 2.1));
                assert!(largest(&element.forces::<$points>(&shift)) <= 1e-15 * scale);
                let rotation = element.nodal(|x| Vec3::new(0.5, -0.3, 0.8).cross(x));
                for strain in element.strains::<$points>(&rotation) {
                    assert!(strain.0.iter().all(|e| e.abs() < 1e-14), "{strain:?}");
                }
                assert!(largest(&element.forces::<$points>(&rotation)) < 1e-13 * scale);
            }

            /// The stiffness is symmetric, has exactly six zero modes and no negative one.
            #[test]
            fn stiffness_has_six_zero_modes() {
                let stiffness = element().stiffness::<$points>();
                let norm = stiffness.norm();
                assert!((&stiffness - stiffness.transpose()).norm() < 1e-14 * norm);
                let mut values: Vec<f64> = SymmetricEigen::new(stiffness)
                    .eigenvalues
                    .iter()
                    .map(|value| value / norm)
                    .collect();
                values.sort_by(f64::total_cmp);
                assert!(values[..6].iter().all(|v| v.abs() < 1e-14), "{values:?}");
                assert!(values[6] > 1e-3, "{values:?}");
            }

            /// The forces are the derivative of the elastic and hourglass energy.
            #[test]
            fn forces_hold_the_energy() {
                let element = element();
                let nodal = element.nodal(|x| {
                    GRADIENT * x + Vec3::new(x.y * x.z, x.z * x.x, x.x * x.y * x.z) * 0.1
                });
                let mut work = 0.0;
                let forces = element.forces::<$points>(&nodal);
                for (force, value) in forces.as_flattened().iter().zip(nodal.as_flattened()) {
                    work += 0.5 * force * value;
                }
                let volumes = element.kernel.volumes(element.geometry());
                let strains = element.strains::<$points>(&nodal);
                let stresses = element.stresses::<$points>(&nodal);
                let mut held = element.hourglass_energy::<$points>(&nodal);
                for p in 0..$points {
                    held += 0.5 * stresses[p].work(&strains[p]) * volumes[p];
                }
                assert!((work - held).abs() < 1e-12 * held, "{work} {held}");
            }

            /// A rotated element has the rotated forces.
            #[test]
            fn rotation_of_the_frame_leaves_no_trace() {
                let rotation = Rotation3::from_euler_angles(0.4, -1.1, 2.3);
                let element = element();
                let turned =
                    Element::new::<$points>($kernel, element.corners.map(|x| rotation * x));
                let field = |x: &Vec3| Vec3::new(x.y * x.z, x.z * x.x, x.x * x.y * x.z);
                let nodal = element.nodal(field);
                let forces = element.forces::<$points>(&nodal);
                let turned_nodal = nodal.map(|u| (rotation * Vec3::from(u)).into());
                let turned_forces = turned.forces::<$points>(&turned_nodal);
                for a in 0..$nodes {
                    let error = rotation * Vec3::from(forces[a]) - Vec3::from(turned_forces[a]);
                    assert!(error.norm() < 1e-12 * largest(&forces));
                }
            }

            /// The lumped shares are positive and sum to one to round-off.
            #[test]
            fn masses_sum_to_the_whole() {
                let element = element();
                let shares = element.kernel.node_shares(&element.corners);
                assert!(shares.iter().all(|&share| share > 0.0));
                assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-15);
            }
        }
    };
}

kernel_tests!(hex8_one_point, Hex8OnePoint::DEFAULT, brick(), 8, 1);
kernel_tests!(hex8_natural, Hex8Natural, brick(), 8, 1);
kernel_tests!(straight_natural, straight(false), parallelepiped(), 8, 1);
kernel_tests!(hex8_eas, Hex8Eas::new(&rock()), brick(), 8, 8);
kernel_tests!(hex8_full, Hex8Full, brick(), 8, 8);
kernel_tests!(hex8_b_bar, Hex8BBar, brick(), 8, 8);
kernel_tests!(straight_full, skewed(false), parallelepiped(), 8, 8);
kernel_tests!(straight_b_bar, skewed(true), parallelepiped(), 8, 8);
kernel_tests!(tet4, Tet4, tetrahedron(), 4, 1);
kernel_tests!(wedge6, Wedge6, wedge(), 6, 6);
kernel_tests!(pyramid5, Pyramid5, pyramid(), 5, 1);

/// The one-point brick's gradient is the mean of the trilinear one over the volume, and its masses
/// are the row sums of the consistent mass matrix.
#[test]
fn the_uniform_gradient_is_the_exact_mean() {
    let element = Element::new::<1>(Hex8OnePoint::DEFAULT, brick());
    let (volume, gradients, shares) = mean_gradients(&element.corners);
    assert!((element.volume::<1>() - volume).abs() < 1e-14 * volume);
    let own = element.kernel.node_shares(&element.corners);
    for a in 0..8 {
        assert!((own[a] - shares[a]).abs() < 1e-15);
        for j in 0..3 {
            let mut nodal = [[0.0; 3]; 8];
            nodal[a][j] = 1.0;
            let strain = element.strains::<1>(&nodal)[0];
            assert!((strain.0[j] - gradients[a][j]).abs() < 1e-14);
        }
    }
}

/// On a parallelepiped the shorter form of the one-point brick is the general one.
#[test]
fn straight_bricks_are_bricks() {
    let corners = parallelepiped();
    assert!(parallelepiped::is_parallelepiped(&corners));
    assert!(!parallelepiped::is_parallelepiped(&brick()));
    let general = Element::new::<1>(Hex8OnePoint::DEFAULT, corners);
    let short = Element::new::<1>(
        parallelepiped::Parallelepiped(Hex8OnePoint::DEFAULT),
        corners,
    );
    let difference = general.stiffness::<1>() - short.stiffness::<1>();
    assert!(difference.norm() < 1e-14 * general.stiffness::<1>().norm());
    let field = |x: &Vec3| Vec3::new(x.y * x.z, x.z * x.x, x.x * x.y * x.z);
    let (a, b) = (general.nodal(field), short.nodal(field));
    let (a, b) = (
        general.hourglass_energy::<1>(&a),
        short.hourglass_energy::<1>(&b),
    );
    assert!((a - b).abs() < 1e-13 * a);
    assert!((general.volume::<1>() - short.volume::<1>()).abs() < 1e-14 * short.volume::<1>());
    let shares = general.kernel.node_shares(&corners);
    assert!(shares.iter().all(|share| (share - 0.125).abs() < 1e-15));
}

/// The stiffness of the elastic forces of a kernel that has them.
fn short_stiffness(element: &Element<StraightBrick, 8>) -> DMatrix<f64> {
    let moduli = [element.medium.lambda(), element.medium.shear()];
    let mut stiffness = DMatrix::zeros(24, 24);
    for column in 0..24 {
        let mut nodal = [[0.0; 3]; 8];
        nodal[column / 3][column % 3] = 1.0;
        let modes = element.kernel.modes(&nodal);
        let modal = element
            .kernel
            .elastic_forces(element.geometry(), moduli, &modes);
        let forces = element.kernel.nodal_forces(&modal.unwrap());
        for row in 0..24 {
            stiffness[(row, column)] = forces[row / 3][row % 3];
        }
    }
    stiffness
}

fn assert_is_general<K: ElementKernel<8, 8>>(general: K, special: StraightBrick, at: [Vec3; 8]) {
    let general = Element::new::<8>(general, at);
    let special = Element::new::<8>(special, at);
    let exact = general.stiffness::<8>();
    for stiffness in [special.stiffness::<8>(), short_stiffness(&special)] {
        let error = (stiffness - &exact).norm() / exact.norm();
        // Edges of 0.4 m and more, up to 20 m from the origin, are rounded to some 1e-14 of their length.
        assert!(error < 1e-12, "{error} {:?}", special.kernel);
    }
    let field = |x: &Vec3| Vec3::new(x.y * x.z, x.z * x.x, x.x * x.y * x.z);
    let nodal = general.nodal(field);
    let (strains, own) = (general.strains::<8>(&nodal), special.strains::<8>(&nodal));
    let most = strains.iter().flat_map(|strain| strain.0);
    let most = most.fold(0.0_f64, |most, e| most.max(e.abs()));
    for p in 0..8 {
        for i in 0..6 {
            let error = (strains[p].0[i] - own[p].0[i]).abs();
            assert!(error < 1e-12 * most, "{error} {:?}", special.kernel);
        }
    }
    let volumes = general.kernel.volumes(general.geometry());
    for (volume, own) in volumes
        .iter()
        .zip(special.kernel.volumes(special.geometry()))
    {
        assert!((volume - own).abs() < 1e-12 * volume);
    }
}

/// On boxes along the axes of any proportions, on boxes that are turned, and on oblique parallelepipeds the shorter
/// forms of the bricks with 2 x 2 x 2 points are the general ones: elastic forces, forces, strains and volumes.
#[test]
fn straight_bricks_with_eight_points_are_bricks() {
    let mut state = 0.61_f64;
    let mut random = || {
        state = (state * 97.13 + 0.211).fract();
        state
    };
    for case in 0..40 {
        let edges = Vec3::from_fn(|_, _| 0.2 + 4.0 * random());
        let place = Vec3::from_fn(|_, _| 20.0 * (random() - 0.5));
        let turn = Rotation3::from_euler_angles(6.0 * random(), 6.0 * random(), 6.0 * random());
        let shear = Mat3::from_fn(|i, j| f64::from(u8::from(i == j)) + 0.3 * (random() - 0.5));
        // Half of the boxes are numbered from another corner: two edges point against their axes.
        let signs = if case % 2 == 0 { 1.0 } else { -1.0 };
        let corner = |x: [f64; 3]| Vec3::from(x).component_mul(&edges);
        let boxed = hexahedron::CORNERS.map(|[x, y, z]| corner([signs * x, signs * y, z]) + place);
        let turned = boxed.map(|x| turn * x);
        let skewed = boxed.map(|x| shear * x);
        assert!(straight_brick::is_along_axes(&boxed));
        for (corners, along_axes) in [
            (boxed, true),
            (boxed, false),
            (turned, false),
            (skewed, false),
        ] {
            assert!(parallelepiped::is_parallelepiped(&corners));
            assert!(along_axes || corners == boxed || !straight_brick::is_along_axes(&corners));
            let special = |mean_dilatation| StraightBrick {
                along_axes,
                mean_dilatation,
            };
            assert_is_general(Hex8Full, special(false), corners);
            assert_is_general(Hex8BBar, special(true), corners);
        }
    }
    assert!(!straight_brick::is_along_axes(&brick()));
}

/// The hourglass stiffness of a cube is the stated one: a bending mode of amplitude a holds
/// `3 hourglass (lambda + 2 G) h a^2`.
#[test]
fn hourglass_stiffness_is_as_stated() {
    let half = 0.75;
    let corners = hexahedron::CORNERS.map(|x| Vec3::from(x) * half);
    let element = Element::new::<1>(Hex8OnePoint::new(0.1).unwrap(), corners);
    let amplitude = 0.01;
    let bending = element.nodal(|x| Vec3::x() * (amplitude * x.x * x.y / (half * half)));
    let exact = 3.0 * 0.1 * element.medium.constrained() * 2.0 * half * amplitude * amplitude;
    let held = element.hourglass_energy::<1>(&bending);
    assert!((held - exact).abs() < 1e-13 * exact, "{held} {exact}");
}

/// The brick with mean dilatation has one dilatation at all of its points.
#[test]
fn mean_dilatation_is_the_same_everywhere() {
    let element = Element::new::<8>(Hex8BBar, brick());
    let nodal = element.nodal(|x| Vec3::new(x.y * x.z, x.z * x.x * x.x, x.x * x.y * x.z));
    let traces = element
        .strains::<8>(&nodal)
        .map(|strain| strain.0[0] + strain.0[1] + strain.0[2]);
    let full = Element::new::<8>(Hex8Full, brick());
    let volumes = full.kernel.volumes(full.geometry());
    let strains = full.strains::<8>(&nodal);
    let mean: f64 = (0..8)
        .map(|p| volumes[p] * (strains[p].0[0] + strains[p].0[1] + strains[p].0[2]))
        .sum::<f64>()
        / volumes.iter().sum::<f64>();
    for trace in traces {
        assert!(
            (trace - mean).abs() < 1e-13 * mean.abs(),
            "{traces:?} {mean}"
        );
    }
}

/// Names find their kernels, and every solid kind has one.
#[test]
fn kernels_go_by_name() {
    for kernel in SolidKernel::ALL {
        assert_eq!(SolidKernel::from_name(kernel.name()), Some(kernel));
        assert!(SolidKernel::default_for(kernel.kind()).is_some());
    }
    assert_eq!(SolidKernel::from_name("hex20"), None);
    assert_eq!(SolidKernel::default_for(ElementKind::Bar2), None);
    assert!(Hex8OnePoint::new(0.0).is_err());
}
