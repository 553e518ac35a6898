//! Springs and dashpots at nodes against closed forms.

use nalgebra::{Rotation3, Unit};
use powerhouse_boundary::{AxisParameters, Spreading, Viscous, ViscousSpring};
use powerhouse_model::{
    AbsorbingBoundary, BoundarySite, ElasticMedium, Mat3, NodalImpedance, SiteFace, SiteNode, Vec3,
};

fn rock() -> ElasticMedium {
    ElasticMedium::new(9.0e9, 0.27, 2750.0).unwrap()
}

fn lining() -> ElasticMedium {
    ElasticMedium::new(25.0e9, 0.17, 2500.0).unwrap()
}

fn share(face: usize, medium: ElasticMedium, normal: Vec3, area: f64) -> SiteFace {
    SiteFace {
        face,
        medium,
        normal,
        area,
    }
}

/// A corner node of a box of 60 x 40 x 30 m around the scatterer, one node on an edge and one
/// inside each face.
fn corner_site() -> BoundarySite<'static> {
    let (x, y, z) = (Vec3::x(), Vec3::y(), -Vec3::z());
    let node = |node, position, faces| SiteNode {
        node,
        position,
        faces,
    };
    let scatterer = Vec3::new(100.0, -50.0, -200.0);
    let at = |a: f64, b: f64, c: f64| scatterer + Vec3::new(a, b, c);
    BoundarySite::new(
        ["east", "north", "base"].map(String::from).to_vec(),
        vec![
            node(
                0,
                at(30.0, 20.0, -15.0),
                vec![
                    share(0, rock(), x, 1.0),
                    share(1, rock(), y, 2.0),
                    share(2, rock(), z, 3.0),
                ],
            ),
            node(
                7,
                at(30.0, 20.0, 3.0),
                vec![share(0, rock(), x, 1.5), share(1, rock(), y, 2.5)],
            ),
            node(11, at(30.0, -4.0, 3.0), vec![share(0, rock(), x, 4.0)]),
            node(12, at(-7.0, 20.0, 3.0), vec![share(1, rock(), y, 4.0)]),
            node(13, at(-7.0, -4.0, -15.0), vec![share(2, rock(), z, 4.0)]),
        ],
        scatterer,
        None,
    )
}

fn close(a: &Mat3, b: &Mat3) -> bool {
    (a - b).norm() <= 1.0e-14 * b.norm()
}

fn build(boundary: &impl AbsorbingBoundary, site: &BoundarySite) -> Vec<NodalImpedance> {
    boundary.build(site).unwrap().impedance
}

/// Inside a face the impedance follows Eqs. 1 and 2 of the paper times the area, with the distance
/// of the face's plane from the scatterer.
#[test]
fn faces_have_the_springs_and_dashpots_of_the_paper() {
    let impedance = build(&ViscousSpring::paper(), &corner_site());
    let (m, area) = (rock(), 4.0);
    let dashpot_normal = 1.1 * m.density * m.p_speed() * area;
    let dashpot_tangent = 1.1 * m.density * m.s_speed() * area;
    for (node, axis, distance) in [(2, 0, 30.0), (3, 1, 20.0), (4, 2, 15.0)] {
        let mut spring = Mat3::identity() * (m.shear() / (1.8 * distance) * area);
        spring[(axis, axis)] = m.constrained() / (1.8 * distance) * area;
        let mut dashpot = Mat3::identity() * dashpot_tangent;
        dashpot[(axis, axis)] = dashpot_normal;
        assert!(close(&impedance[node].spring, &spring));
        assert!(close(&impedance[node].dashpot, &dashpot));
    }
    assert_eq!(impedance[2].node, 11);
}

/// By default springs are those of the paper, and dashpots have the impedance of plane waves.
#[test]
fn dashpots_have_the_impedance_of_plane_waves_by_default() {
    let (default, paper) = (ViscousSpring::default(), ViscousSpring::paper());
    let (default, paper) = (
        build(&default, &corner_site()),
        build(&paper, &corner_site()),
    );
    let viscous = build(&Viscous::default(), &corner_site());
    for (own, (paper, viscous)) in default.iter().zip(paper.iter().zip(&viscous)) {
        assert_eq!(own.spring, paper.spring);
        assert!(close(&own.dashpot, &viscous.dashpot));
        assert!(close(&paper.dashpot, &(1.1 * viscous.dashpot)));
    }
}

/// Dashpots alone have the impedance of each wave and no springs.
#[test]
fn viscous_faces_have_the_impedance_of_the_medium() {
    let impedance = build(&Viscous::default(), &corner_site());
    let m = rock();
    let tangent = 4.0 * m.density * m.s_speed();
    let normal = 4.0 * m.density * m.p_speed();
    let expected = Mat3::from_diagonal(&Vec3::new(normal, tangent, tangent));
    assert!(close(&impedance[2].dashpot, &expected));
    assert!(impedance.iter().all(|i| i.spring == Mat3::zeros()));
}

/// Edges and corners have the sum of their faces, each with its own area, normal and distance.
#[test]
fn edges_and_corners_sum_their_faces() {
    let impedance = build(&ViscousSpring::default(), &corner_site());
    let face = |node: usize, area: f64| {
        let of_face: &NodalImpedance = &impedance[node];
        (
            of_face.spring * (area / 4.0),
            of_face.dashpot * (area / 4.0),
        )
    };
    let (x, y, z) = (face(2, 1.0), face(3, 2.0), face(4, 3.0));
    assert!(close(&impedance[0].spring, &(x.0 + y.0 + z.0)));
    assert!(close(&impedance[0].dashpot, &(x.1 + y.1 + z.1)));
    let (x, y) = (face(2, 1.5), face(3, 2.5));
    assert!(close(&impedance[1].spring, &(x.0 + y.0)));
    assert!(close(&impedance[1].dashpot, &(x.1 + y.1)));
}

/// Where two media touch at a face each has its own share with its own impedance.
#[test]
fn media_that_meet_at_a_face_keep_their_own_impedance() {
    let mut site = corner_site();
    site.nodes = vec![SiteNode {
        node: 3,
        position: site.scatterer + Vec3::new(30.0, 0.0, 0.0),
        faces: vec![
            share(0, rock(), Vec3::x(), 0.5),
            share(0, lining(), Vec3::x(), 1.5),
        ],
    }];
    let normal = build(&Viscous::default(), &site)[0].dashpot[(0, 0)];
    let impedance = |m: ElasticMedium| m.density * m.p_speed();
    let expected = 0.5 * impedance(rock()) + 1.5 * impedance(lining());
    assert!((normal - expected).abs() < 1e-14 * expected);
}

/// A slice has half the springs and the same dashpots.
#[test]
fn slices_halve_springs_and_keep_dashpots() {
    let sphere = build(&ViscousSpring::default(), &corner_site());
    let slice = ViscousSpring {
        spreading: Spreading::Cylindrical,
        ..ViscousSpring::default()
    };
    for (slice, sphere) in build(&slice, &corner_site()).iter().zip(&sphere) {
        assert!(close(&slice.spring, &(0.5 * sphere.spring)));
        assert_eq!(slice.dashpot, sphere.dashpot);
    }
}

/// Parameters given for one axis apply to the faces across that axis and to no others.
#[test]
fn parameters_can_differ_by_axis() {
    let mut boundary = ViscousSpring::default();
    boundary.axes[1] = AxisParameters::new(1.0, 1.0, Some(500.0)).unwrap();
    let site = corner_site();
    let changed = build(&boundary, &site);
    let default = build(&ViscousSpring::default(), &site);
    assert_eq!(changed[2], default[2]);
    assert_eq!(changed[4], default[4]);
    let m = rock();
    let spring = m.constrained() / (2.0 * 500.0) * 4.0;
    let dashpot = m.density * m.p_speed() * 4.0;
    assert!((changed[3].spring[(1, 1)] - spring).abs() < 1e-14 * spring);
    assert!((changed[3].dashpot[(1, 1)] - dashpot).abs() < 1e-14 * dashpot);
    // Whichever way the faces look.
    for (number, axis) in boundary.axes.iter_mut().enumerate() {
        axis.distance = Some(100.0 + 50.0 * number as f64);
    }
    let mut opposite = corner_site();
    for face in opposite.nodes.iter_mut().flat_map(|node| &mut node.faces) {
        face.normal = -face.normal;
    }
    assert_eq!(build(&boundary, &opposite), build(&boundary, &site));
}

/// The boundary has no preferred direction: a turned site has turned matrices.
#[test]
fn oblique_faces_turn_with_the_site() {
    let axis = Unit::new_normalize(Vec3::new(0.2, -0.7, 0.4));
    let turn = *Rotation3::from_axis_angle(&axis, 0.6).matrix();
    let straight = corner_site();
    let mut turned = corner_site();
    turned.scatterer = turn * straight.scatterer;
    for node in &mut turned.nodes {
        node.position = turn * node.position;
        for face in &mut node.faces {
            face.normal = turn * face.normal;
        }
    }
    let boundary = ViscousSpring::default();
    let pairs = build(&boundary, &turned);
    for (turned, straight) in pairs.iter().zip(build(&boundary, &straight)) {
        let spring = turn * straight.spring * turn.transpose();
        let dashpot = turn * straight.dashpot * turn.transpose();
        assert!((turned.spring - spring).norm() < 1e-13 * spring.norm());
        assert!((turned.dashpot - dashpot).norm() < 1e-13 * dashpot.norm());
        assert_eq!(turned.spring, turned.spring.transpose());
    }
}

/// Rounding in a normal leaves the matrices of a straight face exactly diagonal, which is what
/// engines and input loads are fast with.
#[test]
fn straight_faces_stay_diagonal_under_rounding() {
    let mut site = corner_site();
    for node in &mut site.nodes {
        for face in &mut node.faces {
            face.normal = (face.normal + Vec3::new(3e-16, -2e-14, 5e-15)).normalize();
        }
    }
    for impedance in build(&ViscousSpring::default(), &site) {
        for matrix in [impedance.spring, impedance.dashpot] {
            assert_eq!(matrix, Mat3::from_diagonal(&matrix.diagonal()));
        }
    }
}

/// A scatterer on a face, or outside it, is refused with the face's name and the distance; a
/// distance given for the axis is taken instead.
#[test]
fn a_face_without_distance_is_named() {
    let mut site = corner_site();
    for beyond in [0.0, 3.0] {
        site.scatterer = Vec3::new(100.0, -30.0 + beyond, -200.0);
        let error = ViscousSpring::default().build(&site).err().unwrap();
        let text = error.to_string();
        assert!(
            text.contains("'north'") && text.contains("scatterer"),
            "{text}"
        );
    }
    let mut boundary = ViscousSpring::default();
    boundary.axes[1].distance = Some(40.0);
    assert!(boundary.build(&site).is_ok());
}

/// Parameters outside their range are refused with name, value and range, also when they were
/// set past the constructor.
#[test]
fn impossible_parameters_are_refused() {
    assert!(AxisParameters::new(-0.1, 1.1, None).is_err());
    assert!(AxisParameters::new(0.8, 0.0, None).is_err());
    assert!(AxisParameters::new(0.8, 1.1, Some(f64::NAN)).is_err());
    let mut boundary = ViscousSpring::default();
    boundary.axes[2].speed_ratio = f64::INFINITY;
    let text = boundary.build(&corner_site()).err().unwrap().to_string();
    assert!(text.contains("speed_ratio = inf"), "{text}");
}
