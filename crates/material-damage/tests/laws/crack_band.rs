//! Fracture energy against the shape of the element and the direction of the crack.

use powerhouse_material_damage::{
    Control, LeeFenves, LeeFenvesParameters, Mazars, MazarsParameters, MazarsTension, MohrCoulomb,
    MohrCoulombParameters, PlasticDamage, PlasticDamageParameters, PointDriver, Softening,
    SofteningPlasticity, SofteningPlasticityParameters, StrengthFall, presets,
};
use powerhouse_model::{ConstitutiveLaw, Extents, Mat3, Vec3};

use super::random::Random;

/// Residual stiffness: the work of its stress in a wide open crack is not part of the fracture
/// energy.
const RESIDUAL: f64 = 1.0e-6;

/// A rotated brick with these edges (m).
fn brick(edges: [f64; 3], turn: &Mat3) -> Extents<f64> {
    let square = Mat3::from_diagonal(&Vec3::from(edges).map(|edge| edge * edge));
    let h = turn * square * turn.transpose();
    Extents([
        h[(0, 0)],
        h[(1, 1)],
        h[(2, 2)],
        h[(0, 1)],
        h[(1, 2)],
        h[(2, 0)],
    ])
}

/// Bricks of aspect 1 to 10 that are long, or short, along each axis, unrotated and rotated at random.
fn bricks() -> Vec<Extents<f64>> {
    let mut random = Random(5);
    let mut bricks = Vec::new();
    for aspect in [1.0, 4.0, 10.0] {
        for axis in 0..3 {
            for [along, across] in [[1.0, aspect], [aspect, 1.0]] {
                let mut edges = [0.1 * across; 3];
                edges[axis] = 0.1 * along;
                bricks.push(brick(edges, &Mat3::identity()));
                bricks.push(brick(edges, &random.rotation()));
            }
        }
    }
    bricks
}

/// The work (N/m) per area of a band that is pulled or pressed along z to a width of opening (m), and how
/// wide the element is along z (m).
fn work(law: &(impl ConstitutiveLaw + Copy), extents: Extents<f64>, opening: f64) -> [f64; 2] {
    let width = extents.along(&[0.0, 0.0, 1.0]);
    let mut point = PointDriver::new(*law).with_extents(extents).unwrap();
    let end = point
        .advance(Control::uniaxial(opening / width), 1000)
        .unwrap();
    [end.last().unwrap().work * width, width]
}

/// Cracks of every law with a fracture energy dissipate it in bricks of aspect 1 to 10 along each axis and
/// rotated at random, to 2 %; the width along the crack's normal is a history variable.
#[test]
fn cracks_dissipate_their_energy_whatever_the_shape_of_the_brick() {
    let energy = 133.0;
    let by_energy = Softening::FractureEnergy {
        energy,
        threshold: 0.0,
    };
    let surface = MohrCoulomb::new(presets::PAPER_CONCRETE).unwrap();
    let plastic = PlasticDamage::new(PlasticDamageParameters {
        surface,
        tension: by_energy,
        compression: Softening::None,
        stiffness_recovery: 1.0,
        residual_stiffness: RESIDUAL,
    })
    .unwrap();
    let lee_fenves = LeeFenves::new(LeeFenvesParameters {
        residual_stiffness: RESIDUAL,
        ..presets::PAPER_CONCRETE_LEE_FENVES
    })
    .unwrap();
    let mazars = Mazars::new(MazarsParameters {
        tension: MazarsTension::FallingStress { energy },
        residual_stiffness: RESIDUAL,
        ..presets::PAPER_CONCRETE_MAZARS
    })
    .unwrap();
    for extents in bricks() {
        let check = |[found, width]: [f64; 2], name: &str| {
            let ratio = found / energy;
            assert!((0.98..1.02).contains(&ratio), "{name} {width} m: {ratio}");
        };
        check(work(&plastic, extents, 1.2e-3), "plastic-damage");
        check(work(&lee_fenves, extents, 1.2e-3), "lee-fenves");
        check(work(&mazars, extents, 1.2e-3), "mazars");
        let mut point = PointDriver::new(plastic).with_extents(extents).unwrap();
        let end = point.advance(Control::uniaxial(1.0e-3), 100).unwrap();
        let kept = end[99].history[13];
        assert!((kept / extents.along(&[0.0, 0.0, 1.0]) - 1.0).abs() < 1e-6);
    }
}

/// A band that crushes along its axis dissipates its energy in bricks of any shape, to 2 %.
#[test]
fn crushing_dissipates_its_energy_whatever_the_shape_of_the_brick() {
    let law = SofteningPlasticity::new(SofteningPlasticityParameters {
        surface: MohrCoulomb::new(MohrCoulombParameters {
            dilation: 0.0,
            tension_strength: None,
            ..presets::PAPER_ROCK
        })
        .unwrap(),
        fall: StrengthFall::FractureEnergy { energy: 1.0e4 },
        residual_strength: 1.0e-3,
    })
    .unwrap();
    for extents in bricks() {
        let [found, width] = work(&law, extents, -1.2e-2);
        // The work of the residual strength is not part of the energy.
        let residual = 1.0e-3 * 4.7167e6 * 1.2e-2;
        let ratio = (found - residual) / 1.0e4;
        assert!((0.98..1.02).contains(&ratio), "{width} m: {ratio}");
    }
}

/// A crack keeps the width of its first damage when the principal axes turn afterwards.
#[test]
fn a_crack_keeps_its_width() {
    let law = presets::paper_concrete().unwrap();
    let extents = brick([0.1, 0.5, 1.0], &Mat3::identity());
    let mut point = PointDriver::new(law).with_extents(extents).unwrap();
    let held = Control::Strain(0.0);
    let across = [Control::Strain(3.0e-4), held, held, held, held, held];
    point.advance(across, 10).unwrap();
    let first = point.state().history.clone();
    assert!(
        first[8] > 0.0 && (first[13] - 0.1).abs() < 1e-12,
        "{first:?}"
    );
    let turned = [held, held, Control::Strain(2.0e-3), held, held, held];
    point.advance(turned, 10).unwrap();
    let last = &point.state().history;
    assert!(last[8] > first[8] && last[13] == first[13]);
}
