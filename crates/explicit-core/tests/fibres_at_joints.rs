//! Fibres at joints: impacts, spalls, cohesive cycles, and joints with several nodes in one fibre.

use nalgebra::{DMatrix, DVector};
use powerhouse_contact::{
    Cohesive, CohesiveParameters, Frictionless, Joint, StrengthReduction, Tied,
};
use powerhouse_explicit_core::{BuildModel, Leapfrog, Model};
use powerhouse_model::{
    Constraint, ContactLaw, ElementKind, JointPair, Mesh, Prescribed, StepChoice, Vec3,
};

use crate::support::{Links, balanced_steps, energy_of, fibre_of};

const YOUNG: f64 = 9.0e9;
const AREA: f64 = 0.5;
const DENSITY: f64 = 2700.0;

/// Pieces of a bar between places along a line, with nodes tagged from 1, but for gaps after some nodes (indices).
fn pieces(places: &[f64], along: Vec3, gaps: &[usize]) -> Mesh {
    let mut builder = Mesh::builder();
    for (tag, place) in (1..).zip(places) {
        builder.node(tag, along * *place);
    }
    for node in (0..places.len() - 1).filter(|node| !gaps.contains(node)) {
        let tag = node as u64 + 1;
        builder.element(tag, ElementKind::Bar2, &[tag, tag + 1], &["bar"]);
    }
    builder.build().unwrap()
}

fn bar(mesh: &Mesh, joint: Box<dyn Constraint>) -> powerhouse_model::ModelSpec<'_> {
    let links = Links::new("bar", ElementKind::Bar2, YOUNG, AREA, DENSITY).boxed();
    Model::builder(mesh)
        .elements("bar", links)
        .constraint(joint)
}

fn joint<L: ContactLaw + 'static>(pairs: &[[u32; 2]], along: Vec3, law: L) -> Box<dyn Constraint> {
    let pairs = pairs
        .iter()
        .map(|&nodes| JointPair::new(nodes, along, AREA));
    Box::new(Joint::new("seam", pairs.collect(), law).unwrap())
}

/// A thin bar between two long ones that are tied to it at both ends, whose nodes are a fibre: with both in one joint it
/// moves as bars that have common nodes do, in the mode that strains it with the added inertia of its own mass and in that
/// which does not without, to rounding.
#[test]
fn both_ends_of_a_fibre_may_be_tied() {
    for (along, added, thin) in [
        (Vec3::x(), 3.0, 0.05),
        (Vec3::new(0.3, -0.5, 0.8).normalize(), 8.0, 0.2),
    ] {
        let mesh = pieces(
            &[0.0, 1.0, 1.0, 1.0 + thin, 1.0 + thin, 2.0 + thin],
            along,
            &[1, 3],
        );
        let mut model = bar(&mesh, joint(&[[1, 2], [3, 4]], along, Tied))
            .build()
            .unwrap();
        model.set_fibres(&[fibre_of(&[2, 3], added)]).unwrap();
        let (outer, own) = (0.5 * DENSITY * AREA, 0.5 * DENSITY * AREA * thin);
        let (k, middle) = (YOUNG * AREA, YOUNG * AREA / thin);
        let (slow, inner) = (outer + own * (1.0 + added), outer + own);
        let half = 0.5 * (k / outer + (k + 2.0 * middle) / slow);
        let rest = (half * half - 2.0 * k * middle / (outer * slow)).sqrt();
        let strained = [half + rest, half - rest].map(|square| {
            let ratio = 1.0 - square * outer / k;
            (square.sqrt(), [1.0, ratio, -ratio, -1.0])
        });
        let whole = (k * (1.0 / outer + 1.0 / inner)).sqrt();
        let unstrained = [(whole, [1.0, -outer / inner, -outer / inner, 1.0])];
        let step = 1.6 / strained[0].0;
        for (frequency, shape) in strained.into_iter().chain(unstrained) {
            let angle = 2.0 * (0.5 * frequency * step).asin();
            let shape = [0, 1, 1, 2, 2, 3].map(|place| along * (1e-3 * shape[place]));
            let before = (1.0 - angle.cos()) / step;
            let velocity = shape.map(|value| value * before);
            model.set_initial(&shape, &velocity).unwrap();
            let start = model.state();
            let report = balanced_steps(&mut model, 333, StepChoice::Unchecked(step));
            assert!(report.energy_residual < 1e-12, "{}", report.energy_residual);
            for (node, shape) in (0..).zip(&shape) {
                let exact = shape * (333.0 * angle).cos();
                let error = (model.displacement(node) - exact).norm();
                assert!(error < 1e-12, "{added}, {frequency}: {error:e}");
            }
            model.set_state(&start).unwrap();
        }
    }
}

/// Impulses at both ends of a chain of three nodes that are a fibre, between two bars that close or part, are those of the
/// complementarity problem with the dense inertia, and the node between follows; momentum is conserved.
#[test]
fn impulses_at_both_ends_of_a_fibre_are_solved_together() {
    let along = Vec3::new(2.0, -1.0, 0.5).normalize();
    for added in [0.5, 8.0, 60.0] {
        let mesh = pieces(&[0.0, 0.7, 0.7, 0.8, 1.0, 1.0, 1.5], along, &[1, 4]);
        let mut model = bar(&mesh, joint(&[[1, 2], [4, 5]], along, Frictionless))
            .build()
            .unwrap();
        model.set_fibres(&[fibre_of(&[2, 3, 4], added)]).unwrap();
        let masses: Vec<f64> = (0..7).map(|node| model.mass(node)).collect();
        let mut inertia = DMatrix::from_diagonal(&DVector::from_column_slice(&masses));
        let sum: f64 = masses[2..5].iter().sum();
        for i in 2..5 {
            inertia[(i, i)] += added * masses[i];
            for j in 2..5 {
                inertia[(i, j)] -= added * masses[i] * masses[j] / sum;
            }
        }
        let inverse = inertia.clone().try_inverse().unwrap();
        // An impulse of a pair presses its nodes apart.
        let presses = DMatrix::from_fn(7, 2, |node, pair| match (node, pair) {
            (1, 0) | (4, 1) => -1.0,
            (2, 0) | (5, 1) => 1.0,
            _ => 0.0,
        });
        for speeds in [
            [1.0, 1.0, 0.2, -0.3, 0.1, -1.0, -1.0],
            [1.0, 1.0, 0.0, 0.0, 0.0, 0.02, 0.02],
            [0.1, 0.1, 0.0, 0.0, 0.0, -2.0, -2.0],
            [1.0, 1.0, 0.0, 0.4, 0.0, 0.3, 0.3],
        ] {
            let before = DVector::from_column_slice(&speeds);
            let closing = -(presses.transpose() * &before);
            let mobility = presses.transpose() * &inverse * &presses;
            // The one of the four sets of pressed pairs whose impulses press and whose other pair does not close.
            let mut solutions = [[true, true], [true, false], [false, true], [false, false]]
                .into_iter()
                .filter_map(|pressed| {
                    let mut system = mobility.clone();
                    let mut wanted = closing.clone();
                    for pair in (0..2).filter(|&pair| !pressed[pair]) {
                        system.row_mut(pair).fill(0.0);
                        (system[(pair, pair)], wanted[pair]) = (1.0, 0.0);
                    }
                    let impulses = system.try_inverse()? * wanted;
                    let left = &closing - &mobility * &impulses;
                    let holds = (0..2).all(|pair| impulses[pair] >= 0.0 && left[pair] < 1e-12);
                    holds.then_some(impulses)
                });
            let impulses = solutions.next().unwrap();
            let after = &before + &inverse * (&presses * impulses);
            let aside = along.cross(&Vec3::x());
            let velocity: Vec<Vec3> = (speeds.iter().enumerate())
                .map(|(node, speed)| along * *speed + aside * (0.1 * node as f64))
                .collect();
            let still = vec![Vec3::zeros(); 7];
            model.set_initial(&still, &velocity).unwrap();
            let start = model.state();
            let report = balanced_steps(&mut model, 1, StepChoice::Unchecked(1e-6));
            assert!(report.energy_residual < 1e-12, "{}", report.energy_residual);
            for node in 0..7 {
                let exact = along * (after[node] - speeds[node]) + velocity[node];
                let error = (model.velocity(node as u32) - exact).norm();
                assert!(error < 1e-10, "{added}, {speeds:?}, node {node}: {error:e}");
            }
            let momentum = |velocity: &[Vec3]| -> Vec3 {
                velocity.iter().zip(&masses).map(|(v, m)| v * *m).sum()
            };
            let found: Vec<Vec3> = (0..7).map(|node| model.velocity(node)).collect();
            let error = (momentum(&found) - momentum(&velocity)).norm();
            assert!(error < 1e-12 * masses.iter().sum::<f64>(), "{error:e}");
            model.set_state(&start).unwrap();
        }
    }
}

/// Two bars that meet at a joint with a fibre at the end of one of them, whose chain of short bars it slows: the
/// joint's impulse is that of the fibre's inertia. The pair has one velocity right after the impact, which takes the energy
/// of two masses with the inverse inertia `1/s + (1/m - 1/s) / (1 + alpha)` of the node of the fibre; momentum is
/// conserved to rounding, the balance of energy closes, and the long bars part with the velocities of elastic bars.
#[test]
fn a_joint_with_a_fibre_on_one_side_takes_an_impact() {
    for (along, added, thin) in [
        (Vec3::x(), 3.0, 0.02),
        (Vec3::new(0.6, 0.0, -0.8), 8.0, 0.01),
    ] {
        // Two bars of 1 m in 40 pieces, the second of which ends in three thin pieces at the joint.
        let mut builder = Mesh::builder();
        let mut places: Vec<f64> = (0..=40).map(|i| 0.025 * f64::from(i)).collect();
        places.extend((0..4).map(|i| 1.0 + thin * f64::from(i)));
        places.extend((1..=40).map(|i| 1.0 + 3.0 * thin + 0.025 * f64::from(i)));
        for (tag, place) in (1..).zip(&places) {
            builder.node(tag, along * *place);
        }
        for tag in (1..places.len() as u64).filter(|tag| *tag != 41) {
            builder.element(tag, ElementKind::Bar2, &[tag, tag + 1], &["bar"]);
        }
        let mesh = builder.build().unwrap();
        let bar = || Links::new("bar", ElementKind::Bar2, 9.0e9, 0.5, 2700.0).boxed();
        let pair = JointPair::new([40, 41], along, 0.5);
        let build = |with_fibre: bool| {
            let joint = Joint::new("seam", vec![pair], Frictionless).unwrap();
            let mut model = Model::builder(&mesh)
                .elements("bar", bar())
                .constraint(Box::new(joint))
                .build()
                .unwrap();
            let fibres = [fibre_of(&[41, 42, 43, 44], added)];
            model
                .set_fibres(if with_fibre { &fibres } else { &[] })
                .unwrap();
            let speed = |node: usize| along * if node <= 40 { 1.0 } else { 0.0 };
            let count = mesh.node_count();
            let velocity: Vec<Vec3> = (0..count).map(speed).collect();
            model
                .set_initial(&vec![Vec3::zeros(); count], &velocity)
                .unwrap();
            model
        };
        let mass: f64 = (0..mesh.node_count() as u32)
            .map(|n| build(true).mass(n))
            .sum();
        let mut found = Vec::new();
        for with_fibre in [true, false] {
            let mut model = build(with_fibre);
            let step = 0.9 * model.stable_step(&Leapfrog).unwrap().step;
            let of_impact = balanced_steps(&mut model, 2, StepChoice::Unchecked(step));
            // Effective inverse masses of the two nodes.
            let inverse = |node: u32| 1.0 / model.mass(node);
            let mut mobility = inverse(40) + inverse(41);
            if with_fibre {
                let whole = 1.0 / (41..45).map(|node| model.mass(node)).sum::<f64>();
                mobility = inverse(40) + whole + (inverse(41) - whole) / (1.0 + added);
            }
            let lost = energy_of(&of_impact, "impact") * 2.0 * mobility;
            assert!((lost - 1.0).abs() < 1e-9, "{added}: {lost}");
            let [first, second] = [40, 41].map(|node| model.velocity(node));
            assert!((first - second).norm() < 1e-13, "{first} {second}");
            // Longer than a wave takes to the ends and back: the bars have parted.
            let duration = 2.6 / (9.0e9_f64 / 2700.0).sqrt();
            let report = balanced_steps(
                &mut model,
                (duration / step) as u64,
                StepChoice::Unchecked(step),
            );
            assert!(report.energy_residual < 1e-12, "{}", report.energy_residual);
            let momentum: Vec3 = (0..mesh.node_count() as u32)
                .map(|node| model.velocity(node) * model.mass(node))
                .sum();
            let before: f64 = (0..=40).map(|node| model.mass(node)).sum();
            assert!(
                (momentum - along * before).norm() < 1e-12 * mass,
                "{momentum}"
            );
            let of_first: Vec3 = (0..=40).map(|n| model.velocity(n) * model.mass(n)).sum();
            found.push(of_first.dot(&along) / before);
        }
        // Of equal bars the first is left at rest; of these, the second is a little longer.
        assert!((found[0] - found[1]).abs() < 0.01, "{added}: {found:?}");
        assert!(found[1].abs() < 0.06, "{found:?}");
    }
}

/// A long bar with a bond near its free end, and four thin pieces beyond the bond, whose nodes are a fibre.
fn spalling(fibre: bool, law: CohesiveParameters) -> (Mesh, Model) {
    let mut places: Vec<f64> = (0..=110).map(|i| 0.2 * f64::from(i)).collect();
    places.extend((0..=4).map(|i| 22.0 + 0.01 * f64::from(i)));
    places.extend((1..=10).map(|i| 22.04 + 0.2 * f64::from(i)));
    let mesh = pieces(&places, Vec3::z(), &[110]);
    let law = Cohesive::new(law).unwrap();
    let mut model = bar(&mesh, joint(&[[110, 111]], Vec3::z(), law))
        .build()
        .unwrap();
    if fibre {
        model
            .set_fibres(&[fibre_of(&[111, 112, 113, 114, 115], 8.0)])
            .unwrap();
    }
    (mesh, model)
}

const BOND: CohesiveParameters = CohesiveParameters {
    tensile_strength: 1e6,
    cohesion: 2e6,
    opening_energy: 100.0,
    shear_energy: 1000.0,
    mode_exponent: 2.0,
    static_friction: 0.7,
    dynamic_friction: 0.7,
    reduction: StrengthReduction::None,
};

/// A pulse of pressure that is reflected at the free end of a bar breaks a bond, behind which there is a fibre: what flies off has
/// the velocity, and the bond has taken the energy and begins to fail at the time, that they have without, to 1 %; the
/// balance closes and momentum is conserved to rounding.
#[test]
fn a_spall_is_that_without_fibres() {
    for pressure in [1.6e6, 4.0e6] {
        let found = [false, true].map(|fibre| {
            let (mesh, mut model) = spalling(fibre, BOND);
            let speed = (YOUNG / DENSITY).sqrt();
            let step = 0.9 * 0.01 / speed;
            // A triangle of 8 m that travels towards the free end.
            let strain = |z: f64| -pressure / YOUNG * (1.0 - ((z - 12.0) / 4.0).abs()).max(0.0);
            let displaced = |z: f64| {
                let fraction = z / 4000.0;
                let at = |i: i32| strain((f64::from(i) + 0.5) * fraction) * fraction;
                Vec3::z() * (0..4000).map(at).sum::<f64>()
            };
            let height = |x: &Vec3| x.z;
            let moved: Vec<Vec3> = mesh
                .positions()
                .iter()
                .map(|x| displaced(height(x)))
                .collect();
            let velocity: Vec<Vec3> = (mesh.positions().iter().zip(&moved))
                .map(|(x, now)| (now - displaced(height(x) + speed * step)) / step)
                .collect();
            model.set_initial(&moved, &velocity).unwrap();
            let momentum = |model: &Model, nodes: core::ops::Range<u32>| -> f64 {
                nodes
                    .map(|node| model.velocity(node).z * model.mass(node))
                    .sum()
            };
            let count = mesh.node_count() as u32;
            let before = momentum(&model, 0..count);
            let report = balanced_steps(
                &mut model,
                (18.0 / (speed * step)) as u64,
                StepChoice::Unchecked(step),
            );
            assert!(report.energy_residual < 1e-12, "{}", report.energy_residual);
            let error = (momentum(&model, 0..count) - before).abs() / before;
            assert!(error < 1e-11, "{error:e}");
            [
                momentum(&model, 111..count),
                energy_of(&report, "bond"),
                model.joints().next().unwrap().records[0]
                    .first_crack
                    .unwrap(),
            ]
        });
        for (with, without) in found[1].iter().zip(&found[0]) {
            assert!((with / without - 1.0).abs() < 0.01, "{pressure}: {found:?}");
        }
        assert!((found[0][1] / (BOND.opening_energy * AREA) - 1.0).abs() < 0.01);
    }
}

/// A bond that is opened and closed in growing cycles beside a fibre dissipates what it does without, takes the same work
/// and opens as far, to 1 %.
#[test]
fn cohesive_cycles_are_those_without_fibres() {
    for (along, added) in [(Vec3::z(), 8.0), (Vec3::new(0.0, 0.6, -0.8), 3.0)] {
        let found = [false, true].map(|fibre| {
            // Short bars, so that nothing oscillates: ten pieces and four thin ones.
            let mut places: Vec<f64> = (0..=10).map(|i| 0.2 * f64::from(i)).collect();
            places.extend((0..=4).map(|i| 2.0 + 0.01 * f64::from(i)));
            let mesh = pieces(&places, along, &[10]);
            let law = Cohesive::new(BOND).unwrap();
            let links = Links::new("bar", ElementKind::Bar2, YOUNG, AREA, DENSITY);
            let mut model = Model::builder(&mesh)
                .elements("bar", links.damped(400.0, 0.0).boxed())
                .constraint(joint(&[[10, 11]], along, law))
                .prescribed(Prescribed {
                    nodes: vec![0],
                    direction: along,
                    displacement: Box::new(|_: f64| 0.0),
                })
                .prescribed(Prescribed {
                    nodes: vec![15],
                    direction: along,
                    displacement: Box::new(|t: f64| {
                        5e-4 * t / 0.2 * (core::f64::consts::TAU * t / 0.05).sin()
                    }),
                })
                .build()
                .unwrap();
            if fibre {
                model
                    .set_fibres(&[fibre_of(&[11, 12, 13, 14], added)])
                    .unwrap();
            }
            let step = 0.9 * 0.01 / (YOUNG / DENSITY).sqrt();
            let report =
                balanced_steps(&mut model, (0.2 / step) as u64, StepChoice::Unchecked(step));
            assert!(report.energy_residual < 1e-12, "{}", report.energy_residual);
            let opening = model.joints().next().unwrap().records[0].peak_opening;
            [
                energy_of(&report, "bond"),
                energy_of(&report, "prescribed motion"),
                opening,
            ]
        });
        assert!(found[0][0] > 0.2 * BOND.opening_energy * AREA, "{found:?}");
        for (with, without) in found[1].iter().zip(&found[0]) {
            assert!((with / without - 1.0).abs() < 0.01, "{found:?}");
        }
    }
}
