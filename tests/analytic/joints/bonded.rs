//! Interfaces that hold.

use powerhouse::engine::{BuildModel, Leapfrog, run};
use powerhouse_contact::{BondedCoulomb, BondedCoulombParameters, Joint};
use powerhouse_material_damage::media;
use powerhouse_model::{RunOptions, StepChoice, Vec3};

use super::{Column, even_step, watched};

/// A bond that nothing breaks.
fn strong() -> BondedCoulomb {
    BondedCoulomb::new(BondedCoulombParameters {
        cohesion: f64::INFINITY,
        tensile_strength: f64::INFINITY,
        static_friction: 0.6,
        dynamic_friction: 0.5,
        cohesion_loss: true,
    })
    .unwrap()
}

/// A smooth bump from 0 to 1.
fn bump(x: f64) -> f64 {
    if (0.0..1.0).contains(&x) {
        (core::f64::consts::PI * x).sin().powi(4)
    } else {
        0.0
    }
}

/// At a bonded interface of rock and concrete a normal P wave is transmitted with 0.8084646 and
/// reflected with -0.1915354 of its amplitude, an S wave with 0.7531191 and -0.2468809, to 0.2 %; the
/// two sides do not move against each other at all.
#[test]
fn a_bonded_interface_splits_waves_by_impedance() {
    let speeds =
        |p: bool| [media::ROCK, media::CONCRETE].map(|m| if p { m.p_speed() } else { m.s_speed() });
    for (is_p, expected) in [
        (true, [0.8084646, -0.1915354]),
        (false, [0.7531191, -0.2468809]),
    ] {
        let axis = if is_p { 2 } else { 0 };
        let [rock, concrete] = speeds(is_p);
        let impedance = [
            media::ROCK.density * rock,
            media::CONCRETE.density * concrete,
        ];
        let closed = 2.0 * impedance[0] / (impedance[0] + impedance[1]);
        assert!((closed - expected[0]).abs() < 1e-6);
        let (bricks, brick) = (400, 1.0);
        let parts = [(bricks, media::ROCK), (bricks / 2, media::CONCRETE)];
        let column = Column::new(&parts, brick);
        let duration = 120.0 / rock;
        let wave = move |t: f64| bump(t / duration);
        let builder = column.open(column.along(axis), axis, impedance, wave);
        let pairs = column.surfaces[0].pairs.clone();
        let joint = Joint::new("joint", pairs.clone(), strong()).unwrap();
        let mut model = builder.constraint(Box::new(joint)).build().unwrap();
        let step = even_step(&mut model, duration);
        let below = column.level(200.0)[0];
        let above = column.level(450.0)[0];
        let nodes = [below, above, pairs[0].nodes[0], pairs[0].nodes[1]];
        let (seen, _) = watched(&mut model, &nodes, (700.0 / rock, step));
        let peak = |node: usize, from: f64| {
            let values = seen.times.iter().zip(&seen.velocity[node]);
            let late = values.filter(|(t, _)| **t >= from).map(|(_, v)| v[axis]);
            late.fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a })
        };
        let incident = peak(0, 0.0);
        let found = [peak(1, 0.0) / incident, peak(0, 450.0 / rock) / incident];
        for (found, expected) in found.iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 2e-3, "{found} {expected}");
        }
        let sides = seen.velocity[2].iter().zip(&seen.velocity[3]);
        let apart = sides.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
        assert!(apart < 1e-14 * incident.abs(), "{apart:e}");
    }
}

/// A joint that only sticks is no joint: against the same body in one piece, motion differs by less
/// than 1e-10 of its size after 1e4 steps.
#[test]
fn a_joint_that_sticks_is_no_joint() {
    let of = |cut: bool| {
        let parts = if cut {
            vec![(6, media::ROCK), (6, media::ROCK)]
        } else {
            vec![(12, media::ROCK)]
        };
        let column = Column::new(&parts, 0.8);
        let mut builder = powerhouse::engine::Model::builder(&column.mesh).threads(1);
        for (name, medium) in &column.parts {
            let kernel = powerhouse_elements::SolidKernel::Hex8OnePoint(Default::default());
            let factory = powerhouse_tests::elastic(name, kernel, *medium, Default::default());
            builder = builder.elements(name.as_str(), factory);
        }
        if cut {
            let joint = Joint::new("joint", column.surfaces[0].pairs.clone(), strong()).unwrap();
            builder = builder.constraint(Box::new(joint));
        }
        let mut model = builder.build().unwrap();
        // A motion by place alone, so that copies move with their originals.
        let noise = |p: &Vec3, k: f64| (12.9898 * p.x + 78.233 * p.y + 37.719 * p.z + k).sin();
        let motion = |p: &Vec3| Vec3::new(noise(p, 0.1), noise(p, 0.7), noise(p, 1.9)) * 1e-2;
        let velocity: Vec<Vec3> = column.mesh.positions().iter().map(motion).collect();
        model
            .set_initial(&vec![Vec3::zeros(); velocity.len()], &velocity)
            .unwrap();
        let (step, stable) = (3.0e-4, model.stable_step(&Leapfrog).unwrap().step);
        assert!(step < stable);
        let options = RunOptions::steps(10_000).with_step(StepChoice::Fixed(step));
        run(&mut model, &Leapfrog, &options, &mut [], &mut |_| {}).unwrap();
        (0..52)
            .map(|node| model.displacement(node))
            .collect::<Vec<_>>()
    };
    let (whole, joined) = (of(false), of(true));
    let size = whole.iter().map(|u| u.norm()).fold(0.0, f64::max);
    let differences = whole.iter().zip(&joined).map(|(a, b)| (a - b).norm());
    let worst = differences.fold(0.0, f64::max) / size;
    assert!(worst < 1e-10, "{worst:e}");
}
