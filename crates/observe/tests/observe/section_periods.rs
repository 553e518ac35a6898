//! Sections of bodies whose two ends are joined: any place of one period shows what the same place shows in the middle of a row of periods.

use powerhouse_model::{ElasticMedium, Mesh, PeriodicPairs, Vec3};
use powerhouse_observe::{CrossSection, SectionForces};

use super::beam::{Body, Kernel, cut_at};
use powerhouse_model::Cadence;

const PERIOD: f64 = 4.0;
/// Periods of the row on either side of the one in its middle: more than ramps of a single layer reach.
const BESIDE: usize = 5;

fn concrete() -> ElasticMedium {
    ElasticMedium::new(25.0e9, 0.2, 2500.0).unwrap()
}

/// So many periods of a beam along x, the one at x = 0 to 4 m after so many others, each of layers that grow from one end to the other.
fn row(kernel: Kernel, layers: usize, growth: f64, beside: usize) -> Body {
    let periods = 2 * beside + 1;
    let low = Vec3::new(-(beside as f64) * PERIOD, -1.0, -0.5);
    let high = Vec3::new((beside + 1) as f64 * PERIOD, 1.0, 0.5);
    let mesh = kernel.mesh(low, high, [periods * layers, 1, 2]);
    let grown = mesh.map_positions(|p| {
        let whole = (p.x / PERIOD + 1e-9).floor();
        let x = (p.x / PERIOD - whole).clamp(0.0, 1.0);
        Vec3::new(PERIOD * (whole + x * (1.0 - growth * (1.0 - x))), p.y, p.z)
    });
    Body::new(grown.unwrap().with_straight_edges(), kernel, concrete())
}

/// A motion whose strain repeats after a period: extension, bending, shear and torsion.
fn motion(mesh: &Mesh) -> Vec<Vec3> {
    let wave = std::f64::consts::TAU / PERIOD;
    let at = |p: &Vec3| {
        let (first, second) = (wave * p.x, 2.0 * wave * p.x + 0.4);
        1e-4 * Vec3::new(
            p.x + 0.3 * first.sin() + p.z * second.cos() + p.y * first.cos(),
            0.2 * p.x + second.sin() - p.z * first.sin(),
            -0.1 * p.x + first.cos() + p.y * first.sin(),
        )
    };
    mesh.positions().iter().map(at).collect()
}

/// The pairs of the two faces of a beam across an axis.
fn pairs(mesh: &Mesh, names: [&str; 2]) -> Vec<(u32, u32)> {
    let [from, to] = names.map(|face| mesh.nodes_of_facets(mesh.facet_set(face).unwrap()));
    PeriodicPairs::by_translation(mesh, &from, &to, 1e-6)
        .unwrap()
        .pairs
}

fn section(body: &Body, cut: &CrossSection, pairs: Vec<(u32, u32)>) -> Vec<f64> {
    let mut observer = SectionForces::new(Cadence::Steps(1))
        .unwrap()
        .with_joined_ends(pairs);
    (observer.add_section(&body.mesh, cut, body.elements())).unwrap();
    body.observed(observer, &motion(&body.mesh))
}

/// One period shows at its ends, beside them and inside what a row of eleven periods shows there, to rounding: one layer of elements or several, of
/// one length or growing by eight, of all shapes, seen from both sides; the order of the pairs and those of other faces do not matter.
#[test]
fn one_period_shows_the_forces_of_a_row() {
    let cases = [
        (Kernel::Full, 1, 0.0),
        (Kernel::OnePoint, 1, 0.0),
        (Kernel::Wedge, 2, 0.5),
        (Kernel::Full, 3, 0.7),
        (Kernel::Tet, 4, 0.6),
        (Kernel::Ten, 2, 0.0),
        (Kernel::Pyramid, 5, 0.8),
    ];
    for (kernel, layers, growth) in cases {
        let (one, all) = (
            row(kernel, layers, growth, 0),
            row(kernel, layers, growth, BESIDE),
        );
        let ends = pairs(&one.mesh, ["left", "right"]);
        let sides = pairs(&one.mesh, ["front", "back"]);
        for x in [0.0, 0.1, 0.9, 2.0, 3.3, 3.9, 4.0] {
            for side in [1.0, -1.0] {
                let mut cut = cut_at(x);
                cut.normal = side * Vec3::x();
                let expected = section(&all, &cut, Vec::new());
                let scale = expected.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
                assert!(scale > 1e5);
                let turned = ends.iter().map(|&(a, b)| (b, a)).chain(sides.clone());
                for pairs in [ends.clone(), turned.collect()] {
                    let found = section(&one, &cut, pairs);
                    for (column, (found, expected)) in found.iter().zip(&expected).enumerate() {
                        assert!(
                            (found - expected).abs() < 1e-9 * scale,
                            "{kernel:?}, {layers} layers, {growth}, x = {x}, normal {side}, column {column}: {found} for {expected}"
                        );
                    }
                }
            }
        }
    }
}

/// Both ends of a period are one place, and one layer of elements shows the forces of its middle everywhere.
#[test]
fn a_layer_shows_the_forces_of_its_middle_everywhere() {
    let wave = |x: f64| (section_of_layer(x), section_of_layer(0.5 * PERIOD));
    for x in [0.0, 0.3, 1.1, 3.0, PERIOD] {
        let (found, expected) = wave(x);
        let scale = expected.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        for (found, expected) in found.iter().zip(&expected) {
            assert!(
                (found - expected).abs() < 1e-9 * scale,
                "x = {x}: {found} for {expected}"
            );
        }
    }
}

/// The forces at a place of one layer of full integration that bends and is sheared.
fn section_of_layer(x: f64) -> Vec<f64> {
    let body = row(Kernel::Full, 1, 0.0, 0);
    let ends = pairs(&body.mesh, ["left", "right"]);
    let mut observer = SectionForces::new(Cadence::Steps(1))
        .unwrap()
        .with_joined_ends(ends);
    (observer.add_section(&body.mesh, &cut_at(x), body.elements())).unwrap();
    let at = |p: &Vec3| 1e-4 * Vec3::new(p.x * (1.0 + p.z), -p.x * p.z, 0.5 * p.x - p.y * p.x);
    let bent: Vec<Vec3> = body.mesh.positions().iter().map(at).collect();
    body.observed(observer, &bent)
}

/// Pairs along the plane, or a set that reaches beyond the period, leave the section as it is; a box keeps copies out of which the centroids are
/// outside of it.
#[test]
fn other_pairs_and_boxes_leave_a_section_as_it_is() {
    let body = row(Kernel::Full, 4, 0.0, 0);
    let plain = section(&body, &cut_at(0.2), Vec::new());
    let sides = pairs(&body.mesh, ["front", "back"]);
    assert_eq!(section(&body, &cut_at(0.2), sides), plain);
    let ends = pairs(&body.mesh, ["left", "right"]);
    let joined = section(&body, &cut_at(0.2), ends.clone());
    assert!((joined[4] - plain[4]).abs() > 0.1 * joined[4].abs());
    let mut boxed = cut_at(0.2);
    boxed.within = Some((Vec3::new(0.0, -9.0, -9.0), Vec3::repeat(9.0)));
    assert_eq!(section(&body, &boxed, ends), plain);
}
