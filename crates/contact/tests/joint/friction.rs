//! Sliding and sticking.

use core::f64::consts::PI;

use powerhouse_contact::{BondedCoulomb, BondedCoulombParameters, Frictionless, Joint};
use powerhouse_model::{
    Bond, Constraint, ContactLaw, ContactState, JointPair, Mat3, PredictedMotion, StepTime, Vec3,
};

use super::{Bodies, Noise, oblique};

const GRAVITY: f64 = 9.81;

/// A block of 1 kg on a base that is shaken by an acceleration `amplitude sin(w t)` along `x` and
/// held down by gravity; slip per cycle over the last cycle (m).
struct Newmark {
    friction: f64,
    amplitude: f64,
    frequency: f64,
    /// Inclination of the base (rad).
    slope: f64,
}

impl Newmark {
    /// Steps per cycle and cycles; the displacement of the block along the base, and the changes of
    /// state.
    fn run(&self, steps: u32, cycles: u32) -> (Vec<f64>, u32) {
        let omega = 2.0 * PI * self.frequency;
        let step = 1.0 / (self.frequency * f64::from(steps));
        let pair = JointPair::new([0, 1], Vec3::z(), 1.0);
        let law = BondedCoulomb::unbonded(self.friction, self.friction).unwrap();
        let mut joint = Joint::new("base", vec![pair], law).unwrap();
        let mut bodies = Bodies::at_rest(&[1.0, 1.0], step);
        bodies.fixed[0] = true;
        bodies.velocity[1].x = -self.amplitude / omega;
        let (mut slips, mut changes, mut last) = (vec![0.0], 0, ContactState::Stick);
        for _ in 0..cycles {
            for _ in 0..steps {
                let end = bodies.time() + 0.5 * step;
                let base = -self.amplitude / omega * (omega * end).cos();
                let weight = Vec3::new(self.slope.sin(), 0.0, -self.slope.cos()) * GRAVITY;
                let force = |body: usize| if body == 0 { Vec3::x() * base } else { weight };
                bodies.step(&mut joint, force).unwrap();
                let state = joint.records()[0].state.contact;
                changes += u32::from(state != last);
                last = state;
            }
            slips.push((bodies.displacement[1] - bodies.displacement[0]).x);
        }
        (slips, changes)
    }

    /// Slip in the last cycle (m).
    fn slip_per_cycle(&self) -> f64 {
        let (slips, _) = self.run(20_000, 4);
        slips[4] - slips[3]
    }
}

/// A block on a steep base that is shaken slides one way only: slip per cycle follows Newmark's
/// equation, `w^2 / A` times 4.757448, 1.265762 for yield ratios 0.1 and 0.5, and 0.027637 for 0.9
/// (from the closed form of the sliding velocity), to 0.2 %.
#[test]
fn a_block_slides_one_way_as_newmark_has_it() {
    for (ratio, expected) in [(0.1, 4.757448), (0.5, 1.265762), (0.9, newmark_slip(0.9))] {
        let amplitude = 3.0;
        // Friction large enough that the block never slides uphill: tan(slope) close to it.
        let (friction, frequency) = (2.0_f64, 2.0);
        let slope = downhill_slope(friction, ratio * amplitude);
        let block = Newmark {
            friction,
            amplitude,
            frequency,
            slope,
        };
        let omega = 2.0 * PI * frequency;
        let slip = block.slip_per_cycle() * omega * omega / amplitude;
        assert!(
            (slip / expected - 1.0).abs() < 2e-3,
            "{ratio}: {slip} {expected}"
        );
    }
}

/// The slope on which friction resists sliding downhill up to a base acceleration (m/s2).
fn downhill_slope(friction: f64, resistance: f64) -> f64 {
    // g (mu cos - sin) = resistance.
    let angle = friction.atan();
    angle - (resistance * angle.cos() / GRAVITY).asin()
}

/// Slip per cycle over `A / w^2` for a yield ratio: sliding begins at `sin x = r` and ends where
/// the relative velocity `cos x0 - cos x - r (x - x0)` comes back to zero.
fn newmark_slip(ratio: f64) -> f64 {
    let start = ratio.asin();
    let speed = |x: f64| start.cos() - x.cos() - ratio * (x - start);
    let (mut low, mut high) = (PI - start, 2.0 * PI + start);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if speed(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    let d = low - start;
    start.cos() * d - (low.sin() - start.sin()) - 0.5 * ratio * d * d
}

/// The closed form of a cycle's slip agrees with the two values of the reference.
#[test]
fn newmarks_closed_form_agrees_with_the_reference() {
    assert!((newmark_slip(0.1) - 4.757448).abs() < 1e-6);
    assert!((newmark_slip(0.5) - 1.265762).abs() < 1e-6);
}

/// On a level base the block slides both ways; its motion agrees with an integration of
/// `dv/dt = -mu g sgn(v) - a(t)` at a step a thousand times smaller, at yield ratios 0.4 and 0.7, and
/// changes its state at most four times per cycle.
#[test]
fn a_block_slides_both_ways() {
    for ratio in [0.4, 0.7] {
        let (amplitude, frequency) = (3.0, 2.0);
        let friction = ratio * amplitude / GRAVITY;
        let block = Newmark {
            friction,
            amplitude,
            frequency,
            slope: 0.0,
        };
        let cycles = 6;
        let (slips, changes) = block.run(20_000, cycles);
        let exact = two_way(ratio * amplitude, amplitude, frequency, cycles);
        let scale = amplitude / (2.0 * PI * frequency).powi(2);
        for (slip, exact) in slips.iter().zip(&exact) {
            assert!(
                (slip - exact).abs() < 2e-3 * scale,
                "{ratio}: {slip} {exact}"
            );
        }
        assert!(changes <= 4 * cycles + 1, "{changes}");
    }
}

/// Slip after each cycle by small steps of the relative motion, sticking where the base's
/// acceleration is below the yield acceleration.
fn two_way(resistance: f64, amplitude: f64, frequency: f64, cycles: u32) -> Vec<f64> {
    let (omega, parts) = (2.0 * PI * frequency, 200_000);
    let step = 1.0 / (frequency * f64::from(parts));
    let (mut velocity, mut slip) = (0.0_f64, 0.0);
    let mut slips = vec![0.0];
    for cycle in 0..cycles {
        for part in 0..parts {
            let time = (f64::from(cycle) + (f64::from(part) + 0.5) / f64::from(parts)) / frequency;
            let trial = velocity - amplitude * (omega * time).sin() * step;
            velocity = trial - trial.clamp(-resistance * step, resistance * step);
            slip += velocity * step;
        }
        slips.push(slip);
    }
    slips
}

/// A pair that slides and sticks again stays at the place where it stuck, to rounding.
#[test]
fn a_pair_sticks_where_it_stopped() {
    let pair = JointPair::new([0, 1], Vec3::z(), 1.0);
    let law = BondedCoulomb::unbonded(0.5, 0.5).unwrap();
    let mut joint = Joint::new("base", vec![pair], law).unwrap();
    let mut bodies = Bodies::at_rest(&[4.0, 1.0], 1e-3);
    bodies.velocity[1] = Vec3::new(0.4, 0.3, 0.0);
    let press = |body: usize| Vec3::z() * if body == 0 { 10.0 } else { -10.0 };
    let offset = |b: &Bodies| b.displacement[1] - b.displacement[0];
    while joint.records()[0].state.contact != ContactState::Stick || bodies.number < 10 {
        bodies.step(&mut joint, press).unwrap();
    }
    let stopped = offset(&bodies);
    assert!(stopped.xy().norm() > 1e-2);
    assert!((stopped.x * 0.3 - stopped.y * 0.4).abs() < 1e-15);
    let mut noise = Noise(5);
    for _ in 0..10_000 {
        let shake = noise.vector();
        bodies.step(&mut joint, |body| press(body) + shake).unwrap();
    }
    assert!((offset(&bodies) - stopped).norm() < 1e-15 * (1.0 + bodies.displacement[0].norm()));
}

/// Where a dashpot at an angle makes the masses differ between directions the solution obeys
/// Coulomb's law for the slip that it leaves: no overlap, shear `mu N` straight against the slip.
#[test]
fn friction_opposes_slip_where_masses_differ_between_directions() {
    let mut noise = Noise(17);
    let mut slid = 0;
    for _ in 0..2_000 {
        let pair = JointPair::new([0, 1], noise.vector(), 1.0 + 0.5 * noise.next());
        let law = BondedCoulomb::unbonded(0.6, 0.6).unwrap();
        let mut joint = Joint::new("joint", vec![pair], law).unwrap();
        let mut bodies = Bodies::at_rest(&[1.0, 2.0], 1e-2);
        let turned = Mat3::from_columns(&[noise.vector(), noise.vector(), noise.vector()]);
        bodies.dashpot[0] = turned * turned.transpose() * 1e3;
        bodies.dashpot[1] = oblique(500.0);
        bodies.velocity = vec![noise.vector(), noise.vector()];
        let initial = bodies.kinetic();
        let predicted = bodies.predicted(|_| Vec3::zeros());
        bodies.step(&mut joint, |_| Vec3::zeros()).unwrap();
        assert_eq!(joint.isolated_count(), 0);
        let record = &joint.records()[0];
        let after = pair.to_local(&(bodies.velocity[1] - bodies.velocity[0]));
        let traction = record.traction;
        let (shear, slip) = (traction.yz(), after.yz());
        assert!(after.x > -1e-10 && traction.x <= 0.0, "{after} {traction}");
        assert!(traction.x == 0.0 || after.x.abs() < 1e-10);
        assert!(shear.norm() <= 0.6 * -traction.x * (1.0 + 1e-10));
        if record.state.contact == ContactState::Slide {
            slid += 1;
            let along = shear.dot(&slip) / (shear.norm() * slip.norm());
            assert!(along > 1.0 - 1e-8, "{along}");
        }
        // Less energy than predicted, measured by the effective masses.
        let energy = |velocity: &[Vec3]| -> f64 {
            let of = |(body, v): (usize, &Vec3)| v.dot(&(bodies.effective(body) * v));
            velocity.iter().enumerate().map(of).sum()
        };
        assert!(energy(&bodies.velocity) <= energy(&predicted) * (1.0 + 1e-12));
        assert!(bodies.residual(initial).abs() < 1e-12 * initial);
    }
    assert!(slid > 200, "{slid}");
}

/// Where supports let both sides of a dipping joint move in some directions only, the joint carries the
/// force along those and no more: a bond of little strength holds what is far below it, with one free
/// direction as with two.
#[test]
fn supports_take_their_share_of_what_a_dipping_joint_carries() {
    let law = BondedCoulomb::new(BondedCoulombParameters {
        cohesion: 0.3,
        tensile_strength: 0.1,
        static_friction: 0.8,
        dynamic_friction: 0.6,
        cohesion_loss: true,
    })
    .unwrap();
    // A dip of one in ten along x, rollers across x, and in the second case across y, too.
    let pair = JointPair::new([0, 1], Vec3::new(-0.1, 0.0, 1.0), 2.0);
    let step = 1e-3;
    for free in [Vec3::new(0.0, 1.0, 1.0), Vec3::z()] {
        let mut joint = Joint::new("seam", vec![pair], law).unwrap();
        let free = Mat3::from_diagonal(&free);
        let (masses, force) = ([free / 2.0, free / 3.0], Vec3::new(0.0, 0.0, -4.0));
        let rest = [Vec3::zeros(); 2];
        let mut velocity = [masses[0] * -force * step, masses[1] * force * step];
        let when = StepTime {
            number: 0,
            time: 0.0,
            step,
        };
        let motion = PredictedMotion::new(when, &rest, &rest, &mut velocity, &masses);
        joint.correct(motion).unwrap();
        let record = &joint.records()[0];
        let carried = pair.to_global(&record.traction) * pair.area;
        assert!((carried - force).norm() < 1e-12, "{carried}");
        let state = record.state;
        assert_eq!(
            (state.contact, state.bond),
            (ContactState::Stick, Bond::Intact)
        );
        assert!(velocity.iter().all(|v| v.norm() < 1e-18), "{velocity:?}");
    }
}

/// The slip of a record is that at the time of its displacement, in every step, without friction and with it; the state includes the
/// step that begins there.
#[test]
fn slip_is_that_of_the_displacement() {
    let laws: [Box<dyn ContactLaw>; 2] = [
        Box::new(Frictionless),
        Box::new(BondedCoulomb::unbonded(0.3, 0.3).unwrap()),
    ];
    for law in laws {
        for normal in [Vec3::z(), Vec3::new(0.48, 0.6, 0.64)] {
            let pair = JointPair::new([0, 1], normal, 2.0);
            let along = pair.tangent * 0.6 + normal.cross(&pair.tangent) * 0.8;
            let mut joint = Joint::new("base", vec![pair], &law).unwrap();
            let mut bodies = Bodies::at_rest(&[1.0, 4.0], 1e-2);
            bodies.fixed[0] = true;
            bodies.velocity[1] = along;
            for _ in 0..30 {
                let displacement = bodies.displacement[1];
                let pressed = |body: usize| normal * if body == 0 { 0.0 } else { -1.0 };
                bodies.step(&mut joint, pressed).unwrap();
                let record = joint.records()[0];
                let (now, next) = (displacement.dot(&along), bodies.displacement[1].dot(&along));
                assert!((record.slip() - now).abs() < 1e-12, "{record:?} {now}");
                assert!(
                    (record.state.slip - next).abs() < 1e-12,
                    "{record:?} {next}"
                );
                assert!(next > now);
            }
        }
    }
}
