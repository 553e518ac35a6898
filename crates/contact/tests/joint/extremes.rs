//! Mass ratios, frictions and strengths at the ends of their ranges.

use powerhouse_contact::{BondedCoulomb, BondedCoulombParameters, Joint};
use powerhouse_model::{JointPair, Vec3};

use super::{Bodies, Noise, oblique};

/// For mass ratios from 1e-6 to 1e6, friction 0 and 10, strength 0 and infinite, with a free or a
/// fixed partner and with dashpots at an angle on both, a pair under noise stays finite, its
/// energies close, and after the noise it stops instead of chattering.
#[test]
fn pairs_stay_bounded_at_the_ends_of_all_ranges() {
    for ratio in [1e-6, 1.0, 1e6] {
        for friction in [0.0, 10.0] {
            for strength in [0.0, f64::INFINITY] {
                for (fixed, dashpot) in [(false, 0.0), (true, 0.0), (false, 1e3)] {
                    let law = BondedCoulomb::new(BondedCoulombParameters {
                        cohesion: strength,
                        tensile_strength: strength,
                        static_friction: friction,
                        dynamic_friction: friction,
                        cohesion_loss: true,
                    })
                    .unwrap();
                    let pair = JointPair::new([0, 1], Vec3::new(0.3, -0.2, 1.0), 1.0);
                    let mut joint = Joint::new("joint", vec![pair], law).unwrap();
                    let mut bodies = Bodies::at_rest(&[1.0, ratio], 1e-2);
                    bodies.fixed[0] = fixed;
                    bodies.dashpot = vec![oblique(dashpot), oblique(dashpot * ratio)];
                    let mut noise = Noise(31);
                    let light = ratio.min(1.0);
                    let press = |body: usize| pair.normal * (0.5 - body as f64) * light;
                    for step in 0..2_000 {
                        let shake = if step < 1_000 {
                            noise.vector()
                        } else {
                            Vec3::zeros()
                        };
                        let force = |body: usize| match body {
                            0 if fixed => Vec3::zeros(),
                            0 => press(0) - shake * light,
                            _ => press(1) + shake * light,
                        };
                        bodies.step(&mut joint, force).unwrap();
                    }
                    let name = format!("{ratio} {friction} {strength} {fixed} {dashpot}");
                    let spent = bodies.work.friction + bodies.work.impact + bodies.kinetic();
                    assert!(spent.is_finite(), "{name}");
                    let residual = bodies.residual(0.0).abs();
                    assert!(
                        residual <= 1e-10 * (spent.abs() + bodies.input.abs() + 1e-15),
                        "{name}: {residual}"
                    );
                    let gap = bodies.displacement[1] - bodies.displacement[0];
                    assert!(gap.dot(&pair.normal) > -1e-12, "{name}");
                    let across = (bodies.velocity[1] - bodies.velocity[0]).dot(&pair.normal);
                    assert!(across.abs() < 1e-12, "{name}: {across}");
                }
            }
        }
    }
}
