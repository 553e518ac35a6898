//! Beams, hinges and the stable step of composite tetrahedra.

use super::hinge;
use super::natural::displaced;
use super::*;

/// A beam along x of a length and a square section of height one, cells long and across, of a kind of elements.
fn beam(kind: ElementKind, length: f64, [along, across]: [usize; 2], skew: f64) -> Mesh {
    let high = Vec3::new(length, 1.0, 1.0);
    let mesh = generator(kind)(Vec3::zeros(), high, [along, across, across], "beam").unwrap();
    let moved = mesh.map_positions(|x| {
        // Sections stay plane but for the ends, which stay where they are.
        let bump = (core::f64::consts::PI * x.x / length).sin();
        x + Vec3::new(skew * bump * (x.z - 0.5), 0.0, 0.0)
    });
    of_kind(kind, moved.unwrap())
}

/// Deflection of a clamped beam under a shear force at its end, over that of a beam with shear (coefficient 5/6), along y and
/// along z.
fn deflection(mesh: &Mesh, kernel: SolidKernel, poisson: f64) -> [f64; 2] {
    let medium = ElasticMedium::new(30.0e9, poisson, 2500.0).unwrap();
    let fixture = Fixture::of(
        mesh.clone(),
        kernel,
        Linear(medium),
        BlockOptions::default(),
    );
    let length = mesh.bounding_box().1.x;
    let end = mesh.tributary_areas(mesh.facet_set("right").unwrap());
    let bending = length.powi(3) / (3.0 * medium.young / 12.0);
    let exact = bending + length / (5.0 / 6.0 * medium.shear());
    [1, 2].map(|axis| {
        let force = |x: &Vec3| {
            let here = |node: u32| (mesh.positions()[node as usize] - x).norm() < 1e-9;
            let area = end.iter().find(|tributary| here(tributary.node));
            Vec3::ith(axis, area.map_or(0.0, |tributary| tributary.area))
        };
        let found = displaced(&fixture, |x| [x.x < 1e-9; 3], force);
        let terms = end.iter().map(|t| found[t.node as usize][axis] * t.area);
        terms.sum::<f64>() / exact
    })
}

/// One cell of six tetrahedra, which has three nodes across, bends as the beam within 5 %, two cells within 2 %, nearly
/// incompressible ones within 7 and 3 %, alike in both directions; skewed sections and cells twice as long cost little. With
/// four nodes two cells have half of the deflection, and in nearly incompressible material a hundredth.
#[test]
fn one_cell_bends_as_a_beam() {
    for (poisson, cells, skew, expected, bound) in [
        (0.3, [10, 1], 0.0, 1.04, 0.01),
        (0.3, [20, 2], 0.0, 1.00, 0.02),
        (0.4999, [10, 1], 0.0, 1.06, 0.01),
        (0.4999, [20, 2], 0.0, 0.98, 0.02),
        (0.2, [10, 1], 0.0, 1.02, 0.02),
        (0.3, [10, 1], 0.5, 1.0, 0.05),
        (0.3, [10, 2], 0.0, 0.95, 0.05),
    ] {
        let mesh = beam(ElementKind::Tet10, 10.0, cells, skew);
        let found = deflection(&mesh, SolidKernel::Tet10, poisson);
        for found in found {
            assert!(
                (found - expected).abs() < bound,
                "{poisson} {cells:?} {skew}: {found}"
            );
        }
    }
    for (poisson, most) in [(0.3, 0.6), (0.4999, 0.05)] {
        let mesh = beam(ElementKind::Tet4, 10.0, [20, 2], 0.0);
        let found = deflection(&mesh, SolidKernel::Tet4, poisson);
        assert!(found.iter().all(|found| *found < most), "{found:?}");
    }
}

/// A beam of one cell forms a hinge near the exact load, as bricks with eight points do: the points are in layers off the
/// middle. Tetrahedra of four nodes hold several times of it.
#[test]
fn one_cell_forms_a_hinge() {
    let found = hinge::load(SolidKernel::Tet10);
    assert!((1.1..1.35).contains(&found), "{found}");
    assert!(hinge::load(SolidKernel::Tet4) > 4.0);
}

/// The stable step is at least three quarters of that of bricks with the same nodes, for cubes and for flat cells.
#[test]
fn steps_are_three_quarters_of_those_of_bricks() {
    for poisson in [0.2, 0.3] {
        for size in [Vec3::repeat(3.0), Vec3::new(6.0, 3.0, 2.0)] {
            let [of_bricks, of_bounds] = steps(size, poisson);
            assert!(of_bricks > 0.75, "{poisson} {size} {of_bricks}");
            assert!(
                (0.75..1.0).contains(&of_bounds),
                "{poisson} {size} {of_bounds}"
            );
        }
    }
}

/// Highest frequency of a body by power iteration, a bound from below.
fn highest(fixture: &Fixture) -> f64 {
    let masses = fixture.masses();
    let mut x = fixture.noise(5, 1.0);
    let mut square = 0.0;
    for _ in 0..2000 {
        let forces = fixture.apply(Operator::Elastic, &x);
        let next: Vec<Vec3> = forces.iter().zip(&masses).map(|(f, m)| f / *m).collect();
        let norm = |values: &[Vec3]| -> f64 {
            let terms = values.iter().zip(&masses);
            terms.map(|(v, m)| v.norm_squared() * m).sum::<f64>().sqrt()
        };
        let size = norm(&next);
        square = size / norm(&x.iter().map(|q| q.to_vector()).collect::<Vec<_>>());
        x = next
            .iter()
            .map(|v| Quad::from_vector(&(v / size)))
            .collect();
    }
    square.sqrt()
}

/// Stable step of a box of three cells along each axis, of composite tetrahedra over that of bricks with the same nodes, and the
/// step by the bounds of single elements over it.
fn steps(size: Vec3, poisson: f64) -> [f64; 2] {
    let medium = ElasticMedium::new(30.0e9, poisson, 2500.0).unwrap();
    let of = |kind: ElementKind, kernel: SolidKernel, cells| {
        let mesh = generator(kind)(Vec3::zeros(), size, cells, "rock").unwrap();
        let mesh = of_kind(kind, mesh);
        Fixture::of(mesh, kernel, Linear(medium), BlockOptions::default())
    };
    let tets = of(ElementKind::Tet10, SolidKernel::Tet10, [3; 3]);
    let bricks = of(ElementKind::Hex8, SolidKernel::Hex8Natural, [6; 3]);
    assert_eq!(tets.block.nodes().len(), bricks.block.nodes().len());
    let own = highest(&tets);
    let bounds = tets.block.frequency_bounds().into_iter();
    let bound = bounds.map(|bound| bound.frequency).fold(0.0, f64::max);
    [highest(&bricks) / own, own / bound]
}
