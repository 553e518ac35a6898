//! Bonds that fail gradually: energies, paths, groups and symmetry.

use powerhouse_contact::{Cohesive, CohesiveParameters, Joint, StrengthReduction};
use powerhouse_model::{
    Bond, Constraint, ConstraintWork, ContactLaw, ContactState, ElasticMedium, JointConstraint,
    JointInput, JointPair, JointRecord, Mat3, PredictedMotion, StepTime, Vec3,
};
use proptest::prelude::*;

/// Strengths 1 and 2 MPa, energies 100 and 1000 J/m2.
const CONCRETE: CohesiveParameters = CohesiveParameters {
    tensile_strength: 1e6,
    cohesion: 2e6,
    opening_energy: 100.0,
    shear_energy: 1000.0,
    mode_exponent: 2.0,
    static_friction: 0.7,
    dynamic_friction: 0.7,
    reduction: StrengthReduction::ByMedia,
};

fn joint(parameters: CohesiveParameters, pair: JointPair) -> Joint<Cohesive> {
    Joint::new("joint", vec![pair], Cohesive::new(parameters).unwrap()).unwrap()
}

/// Two nodes with a joint between them, in steps of central differences.
struct Nodes {
    joint: Joint<Cohesive>,
    inverse_mass: [Mat3; 2],
    step: f64,
    number: u64,
    displacement: [Vec3; 2],
    velocity: [Vec3; 2],
    work: ConstraintWork,
}

impl Nodes {
    fn new(joint: Joint<Cohesive>, inverse_mass: [Mat3; 2], step: f64) -> Self {
        Self {
            joint,
            inverse_mass,
            step,
            number: 0,
            displacement: [Vec3::zeros(); 2],
            velocity: [Vec3::zeros(); 2],
            work: ConstraintWork::default(),
        }
    }
    /// One step under forces on the nodes (N).
    fn advance(&mut self, forces: [Vec3; 2]) {
        let before = self.velocity;
        for (i, force) in forces.iter().enumerate() {
            self.velocity[i] += self.inverse_mass[i] * force * self.step;
        }
        let when = StepTime {
            number: self.number,
            time: self.number as f64 * self.step,
            step: self.step,
        };
        let motion = PredictedMotion::new(
            when,
            &self.displacement,
            &before,
            &mut self.velocity,
            &self.inverse_mass,
        );
        self.work += self.joint.correct(motion).unwrap();
        for i in 0..2 {
            self.displacement[i] += self.velocity[i] * self.step;
        }
        self.number += 1;
    }
    fn record(&self) -> &JointRecord {
        &self.joint.records()[0]
    }
    fn history(&self, name: &str) -> f64 {
        let views = self.joint.joints();
        let at = views[0]
            .variables
            .iter()
            .position(|v| v.name == name)
            .unwrap();
        self.joint.history_of(0)[at]
    }
    fn dissipated(&self) -> f64 {
        self.history("bond_dissipated")
    }
}

/// Bar along z of elastic elements with masses at their ends, free at both, with a joint between two nodes.
struct Bar {
    size: f64,
    step: f64,
    displacement: Vec<Vec3>,
    velocity: Vec<Vec3>,
    /// First node behind the joint.
    joint_at: usize,
    joint: Joint<Cohesive>,
}

const YOUNG: f64 = 20e9;
const DENSITY: f64 = 2500.0;

impl Bar {
    /// Bar of elements of a size (m) with a triangular pulse of pressure (Pa) that travels towards its end.
    fn new(size: f64, pressure: f64, law: CohesiveParameters) -> Self {
        let speed = (YOUNG / DENSITY).sqrt();
        let elements = (24.0 / size).round() as usize;
        let joint_at = elements - (2.0 / size).round() as usize;
        let step = 0.98 * size / speed;
        // Sliding would need another direction: one of area 1 m2 along the axis.
        let pair = JointPair::new([0, 1], Vec3::z(), 1.0);
        // A triangle of 8 m, of the displacement of a wave in +z.
        let strain = |z: f64| -pressure / YOUNG * (1.0 - ((z - 12.0) / 4.0).abs()).max(0.0);
        let displaced = |z: f64| {
            let steps = 4000;
            let fraction = z / f64::from(steps);
            (0..steps)
                .map(|i| strain((f64::from(i) + 0.5) * fraction) * fraction)
                .sum::<f64>()
        };
        let position = |node: usize| (node - usize::from(node >= joint_at)) as f64 * size;
        let nodes = elements + 2;
        let at = |node: usize, past: f64| Vec3::z() * displaced(position(node) + past);
        let half = 0.5 * step * speed;
        Self {
            displacement: (0..nodes).map(|node| at(node, 0.0)).collect(),
            velocity: (0..nodes)
                .map(|node| (at(node, 0.0) - at(node, 2.0 * half)) / step)
                .collect(),
            size,
            step,
            joint_at,
            joint: joint(law, pair),
        }
    }
    fn mass(&self, node: usize) -> f64 {
        let ends = [0, self.joint_at - 1, self.joint_at, self.velocity.len() - 1];
        DENSITY * self.size * if ends.contains(&node) { 0.5 } else { 1.0 }
    }
    fn stretched(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        let last = self.velocity.len() - 1;
        let elements = (0..last).filter(|&node| node + 1 != self.joint_at);
        elements.map(|node| {
            (
                node,
                self.displacement[node + 1].z - self.displacement[node].z,
            )
        })
    }
    fn advance(&mut self, number: u64) {
        let mut forces = vec![0.0; self.velocity.len()];
        for (node, stretch) in self.stretched() {
            let force = YOUNG * stretch / self.size;
            forces[node] += force;
            forces[node + 1] -= force;
        }
        let before = [self.joint_at - 1, self.joint_at].map(|node| self.velocity[node]);
        let here = [self.joint_at - 1, self.joint_at].map(|node| self.displacement[node]);
        for node in 0..self.velocity.len() {
            let mass = self.mass(node);
            self.velocity[node].z += forces[node] / mass * self.step;
        }
        let inverse = [self.joint_at - 1, self.joint_at].map(|n| Mat3::identity() / self.mass(n));
        let mut velocity = [self.joint_at - 1, self.joint_at].map(|node| self.velocity[node]);
        let when = StepTime {
            number,
            time: number as f64 * self.step,
            step: self.step,
        };
        let motion = PredictedMotion::new(when, &here, &before, &mut velocity, &inverse);
        self.joint.correct(motion).unwrap();
        self.velocity[self.joint_at - 1] = velocity[0];
        self.velocity[self.joint_at] = velocity[1];
        for node in 0..self.velocity.len() {
            let velocity = self.velocity[node];
            self.displacement[node] += velocity * self.step;
        }
    }
    /// Energy of the scheme between two steps (J): kinetic, and elastic of the displacements at both ends.
    fn energy(&self) -> f64 {
        let kinetic: f64 = (0..self.velocity.len())
            .map(|node| 0.5 * self.mass(node) * self.velocity[node].z.powi(2))
            .sum();
        let elastic: f64 = self
            .stretched()
            .map(|(node, now)| {
                let then = now - (self.velocity[node + 1].z - self.velocity[node].z) * self.step;
                0.5 * YOUNG / self.size * now * then
            })
            .sum();
        kinetic + elastic
    }
}

/// A pulse of pressure that is reflected at a free end breaks a bond in tension: the body loses the fracture energy, within
/// 0.5 % of it at `theta = c ft/lf` of 0.08 and 1.5 % at 0.4, where the bond opens in a dozen steps or more; where it does in
/// a few, within 6 %. With the traction of the opening at the end of a step it would lose less by 6 and 46 %.
#[test]
fn a_spall_takes_the_fracture_energy() {
    let cases = [
        (0.08, 1.6e6, 0.005),
        (0.08, 2.5e6, 0.005),
        (0.08, 4.0e6, 0.005),
        (0.4, 1.6e6, 0.015),
        (0.4, 2.0e6, 0.015),
        (0.4, 4.0e6, 0.06),
    ];
    for (size, pressure, tolerance) in cases {
        let mut bar = Bar::new(size, pressure, CONCRETE);
        let before = bar.energy();
        let steps = (18.0 / (0.98 * size)) as u64;
        for number in 0..steps {
            bar.advance(number);
        }
        let record = &bar.joint.records()[0];
        assert_eq!(record.state.bond, Bond::Broken);
        let lost = before - bar.energy();
        let share = lost / CONCRETE.opening_energy;
        assert!(
            (share - 1.0).abs() < tolerance,
            "{size} m, {pressure} Pa: {share}"
        );
        assert!((record.bond_energy / CONCRETE.opening_energy - 1.0).abs() < 1e-12);
        let balance = lost - record.bond_energy - record.impact;
        assert!(balance.abs() < 1e-9 * before, "{balance}");
    }
}

/// A bar with a bond too strong to fail keeps its energy and moves as one without a joint; so the bond adds no mass, no
/// stiffness and no loss of step.
#[test]
fn an_intact_bond_is_a_tie() {
    let mut bar = Bar::new(0.4, 0.4e6, CONCRETE);
    let before = bar.energy();
    for number in 0..300 {
        bar.advance(number);
        let [below, above] = [bar.joint_at - 1, bar.joint_at].map(|node| bar.displacement[node]);
        assert!((above - below).norm() < 1e-17);
    }
    assert!((bar.energy() / before - 1.0).abs() < 1e-10);
    assert_eq!(bar.joint.records()[0].state.bond, Bond::Intact);
}

/// Shear under pressure takes the energy in shear and friction beside it, which remains when the bond has failed.
#[test]
fn shear_under_pressure_takes_its_energy_beside_friction() {
    let pair = JointPair::new([0, 1], Vec3::z(), 2.0);
    let inverse = [Mat3::zeros(), Mat3::identity() / 1e4];
    let mut nodes = Nodes::new(joint(CONCRETE, pair), inverse, 2e-5);
    let along = Vec3::new(0.6, 0.8, 0.0);
    let press = Vec3::z() * -1e6;
    // A block that is pulled by a spring whose end moves steadily.
    let mut peak = 0.0_f64;
    for number in 0..40_000 {
        let end = 2e-3 * f64::from(number) / 40_000.0;
        let pull = 2e10 * (end - nodes.displacement[1].dot(&along));
        let damping = -nodes.velocity[1] * 4e6;
        nodes.advance([Vec3::zeros(), along * pull + press + damping]);
        peak = peak.max(nodes.record().traction.yz().norm());
    }
    let record = nodes.record();
    assert_eq!(
        (record.state.bond, record.state.contact),
        (Bond::Broken, ContactState::Slide)
    );
    // 2 MPa and 0.7 times a pressure of 0.5 MPa.
    assert!((peak / 2.35e6 - 1.0).abs() < 1e-3, "{peak}");
    assert!((record.bond_energy / 2000.0 - 1.0).abs() < 1e-9);
    let slip = nodes.displacement[1].dot(&along);
    let expected = 0.35e6 * 2.0 * slip;
    assert!(
        (record.friction / expected - 1.0).abs() < 0.01,
        "{} {expected}",
        record.friction
    );
    assert!(
        record.impact.abs() < 0.01 * record.bond_energy,
        "{}",
        record.impact
    );
    assert!((nodes.work.bond - record.bond_energy).abs() < 1e-9);
    assert!(nodes.work.stored.abs() < 1e-9);
}

/// Between opening and shear the energy is that of Benzeggagh and Kenane, within what the drive yields of the separation.
#[test]
fn mixed_modes_take_the_energy_between() {
    for angle in [0.0_f64, 0.3, 0.8, 1.3, 1.5] {
        let pair = JointPair::new([0, 1], Vec3::z(), 1.0);
        let inverse = [Mat3::zeros(), Mat3::identity() / 2e3];
        let mut nodes = Nodes::new(joint(CONCRETE, pair), inverse, 1e-5);
        // Separations in a fixed ratio of the scaled space, by a stiff drive.
        let [normal, along] = [angle.cos(), angle.sin() / 2.0];
        let way = Vec3::new(along, 0.0, normal);
        for number in 0..30_000 {
            let end = way * (2.5e-3 * f64::from(number) / 30_000.0);
            let pull = (end - nodes.displacement[1]) * 1e12;
            nodes.advance([Vec3::zeros(), pull - nodes.velocity[1] * 4e7]);
        }
        let mixed = angle.sin().powi(2);
        let expected = 100.0 + 900.0 * mixed * mixed;
        let found = nodes.record().bond_energy;
        assert_eq!(nodes.record().state.bond, Bond::Broken);
        assert!(
            (found / expected - 1.0).abs() < 0.01,
            "{angle}: {found} {expected}"
        );
    }
}

/// Strengths are reduced where pairs are far apart, and energies kept.
#[test]
fn strength_is_reduced_on_coarse_meshes() {
    let law = Cohesive::new(CohesiveParameters {
        reduction: StrengthReduction::Modulus(20e9),
        ..CONCRETE
    })
    .unwrap();
    let close = |found: [f64; 2], expected: [f64; 2]| {
        found
            .iter()
            .zip(expected)
            .all(|(f, e)| (f - e).abs() < 5e-3)
    };
    // For energies of 100 and 1000 J/m2: 0.96, 0.61 and 0.49 MPa, and 2, 1.92 and 1.57 MPa.
    assert!(
        close(law.reduction(0.4), [0.94, 1.0]),
        "{:?}",
        law.reduction(0.4)
    );
    assert!(
        close(law.reduction(1.0), [0.594, 0.939]),
        "{:?}",
        law.reduction(1.0)
    );
    assert_eq!(law.reduction(0.05), [1.0, 1.0]);
    assert_eq!(law.reduction(0.0), [1.0, 1.0]);
    let mut bar = Bar::new(
        0.4,
        2.5e6,
        CohesiveParameters {
            reduction: StrengthReduction::Modulus(5e9),
            ..CONCRETE
        },
    );
    for number in 0..46 {
        bar.advance(number);
    }
    let energy = bar.joint.records()[0].bond_energy;
    assert!((energy / 100.0 - 1.0).abs() < 1e-12, "{energy}");
}

/// A pair whose masses hardly differ between directions is solved by sweeps, and moves as one that is solved in one pass.
#[test]
fn sweeps_find_what_one_pass_finds() {
    let run = |anisotropy: f64| {
        let pair = JointPair::new([0, 1], Vec3::new(0.3, -0.5, 0.9), 1.5);
        let mass = Mat3::from_diagonal(&Vec3::new(1.0, 1.0 + anisotropy, 1.0)) / 3e3;
        let mut nodes = Nodes::new(joint(CONCRETE, pair), [mass, 2.0 * mass], 2e-5);
        let mut seen = Vec::new();
        for number in 0..3000 {
            let time = f64::from(number) * 2e-5;
            let push = Vec3::new(
                (200.0 * time).sin(),
                (331.0 * time).cos(),
                (130.0 * time).sin(),
            );
            nodes.advance([push * -4e6, push * 4e6]);
            if number % 100 == 0 {
                seen.push(nodes.displacement[1] - nodes.displacement[0]);
            }
        }
        (
            seen,
            nodes.record().bond_energy,
            nodes.joint.isolated_count(),
        )
    };
    let ((one, energy, isolated), (swept, other, grouped)) = (run(0.0), run(1e-9));
    assert_eq!((isolated, grouped), (1, 0));
    assert!(energy > 0.0);
    assert!((energy / other - 1.0).abs() < 1e-5, "{energy} {other}");
    let size = one.iter().map(|v| v.norm()).fold(0.0, f64::max);
    for (a, b) in one.iter().zip(&swept) {
        assert!((a - b).norm() < 1e-4 * size, "{a} {b}");
    }
}

proptest! {
    /// Whatever the path, the energy that a bond has dissipated and its damage do not fall, faces do not overlap, energies
    /// are finite, and the body loses what the record says.
    #[test]
    fn any_path_dissipates(
        pushes in prop::collection::vec(([-1.0..1.0_f64, -1.0..1.0, -1.0..1.0], 5..60_u32), 20),
        theta in 0.05..2.5_f64,
        friction in 0.0..1.0_f64,
        force in 0.5..6.0_f64,
    ) {
        let law = CohesiveParameters {
            static_friction: friction,
            dynamic_friction: 0.8 * friction,
            // As brittle in shear as in opening.
            shear_energy: 400.0,
            ..CONCRETE
        };
        let pair = JointPair::new([0, 1], Vec3::new(1.0, 2.0, -1.0), 1.0);
        let mass = 2e3;
        let inverse = [Mat3::identity() / mass, Mat3::identity() / (3.0 * mass)];
        // theta = step^2 W ft^2/(2 GI)
        let step = (theta * 2.0 * law.opening_energy * 0.75 * mass).sqrt() / law.tensile_strength;
        let mut nodes = Nodes::new(joint(law, pair), inverse, step);
        let kinetic = |nodes: &Nodes| 0.5 * mass * (nodes.velocity[0].norm_squared() + 3.0 * nodes.velocity[1].norm_squared());
        let (mut input, mut last, mut damage) = (0.0, 0.0, 0.0);
        for (push, steps) in pushes {
            let push = Vec3::from(push) * (force * 1e6);
            for _ in 0..steps {
                let before = nodes.velocity;
                nodes.advance([-push, push]);
                for (i, sign) in [(0, -1.0), (1, 1.0)] {
                    input += 0.5 * step * sign * push.dot(&(before[i] + nodes.velocity[i]));
                }
                let now = nodes.dissipated();
                prop_assert!(now >= last && now.is_finite());
                let found = nodes.history("bond_damage");
                prop_assert!(found >= damage && found <= 1.0);
                (last, damage) = (now, found);
                let overlap = pair.to_local(&(nodes.displacement[1] - nodes.displacement[0])).x;
                let far = nodes.displacement[1].norm().max(1e-3);
                prop_assert!(overlap > -1e-12 * far, "{overlap}");
                prop_assert!(nodes.history("bond_stored") >= 0.0);
            }
        }
        let work = nodes.work;
        let spent = kinetic(&nodes) + work.bond + work.stored + work.friction + work.impact;
        prop_assert!((input - spent).abs() <= 1e-10 * (input.abs() + spent.abs() + 1.0), "{input} {spent}");
    }
}

/// A bond whose traction in a step would not be unique is refused in the first step, by name; strength that is reduced by
/// the media of the sides makes it so.
#[test]
fn a_step_that_does_not_resolve_the_failure_is_refused() {
    let pair = JointPair::new([0, 1], Vec3::z(), 1.0);
    let inverse = [Mat3::identity() / 2e3; 2];
    let refused = |step: f64| {
        let mut joint = joint(CONCRETE, pair);
        let when = StepTime {
            number: 0,
            time: 0.0,
            step,
        };
        let (rest, mut velocity) = ([Vec3::zeros(); 2], [Vec3::zeros(); 2]);
        let motion = PredictedMotion::new(when, &rest, &rest, &mut velocity, &inverse);
        joint.correct(motion).err().map(|error| error.to_string())
    };
    // theta = 3: step^2 W ft^2/(2 GI) with W = 1e-3/kg.
    let limit = (3.0 * 2.0 * 100.0 / (1e-3 * 1e12_f64)).sqrt();
    assert_eq!(refused(0.99 * limit), None);
    let text = refused(1.01 * limit).unwrap();
    assert!(text.contains("joint") && text.contains("reduce"), "{text}");

    let rock = ElasticMedium::new(20e9, 0.25, 2600.0).unwrap();
    let law = Cohesive::new(CONCRETE).unwrap();
    let between = law.between([&rock, &rock]).unwrap();
    assert!(between.strength_factor(1.0) < 0.65 && law.strength_factor(1.0) == 1.0);
    let kept = CohesiveParameters {
        reduction: StrengthReduction::None,
        ..CONCRETE
    };
    assert!(
        Cohesive::new(kept)
            .unwrap()
            .between([&rock, &rock])
            .is_none()
    );
}

/// The response does not depend on the tangents of a pair.
#[test]
fn no_direction_in_the_plane_is_preferred() {
    let run = |tangent: Vec3| {
        let mut pair = JointPair::new([0, 1], Vec3::z(), 1.0);
        pair.tangent = tangent;
        let inverse = [Mat3::identity() / 2e3; 2];
        let mut nodes = Nodes::new(joint(CONCRETE, pair), inverse, 2e-5);
        for number in 0..400 {
            let time = f64::from(number) * 2e-5;
            let push = Vec3::new(1.0, 2.0 * (900.0 * time).sin(), (600.0 * time).cos());
            nodes.advance([push * -2e6, push * 2e6]);
        }
        (nodes.displacement[1], nodes.record().bond_energy)
    };
    let ((a, one), (b, other)) = (run(Vec3::x()), run(Vec3::new(0.6, -0.8, 0.0)));
    assert!(one > 10.0);
    assert!((a - b).norm() < 1e-9 * a.norm(), "{a} {b}");
    assert!((one / other - 1.0).abs() < 1e-9);
}

/// While a bond softens its slip is the tangential part of the separation, at every angle between opening and shear, and begins
/// when the bond does; drawn straight off it has none.
#[test]
fn slip_of_a_softening_bond_is_the_tangential_separation() {
    for degrees in [0.0_f64, 20.0, 45.0, 70.0, 90.0] {
        let pair = JointPair::new([0, 1], Vec3::new(0.4, -0.3, 1.0), 2.0);
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let direction = pair.to_global(&Vec3::new(cosine, sine * 0.8, sine * 0.6));
        // Heavy sides: the bond does not slow them.
        let heavy = Mat3::identity() / 1e13;
        let mut nodes = Nodes::new(joint(CONCRETE, pair), [heavy; 2], 1e-6);
        nodes.velocity[1] = direction;
        let (mut least, mut seen) = (f64::INFINITY, 0);
        for _ in 0..900 {
            nodes.advance([Vec3::zeros(); 2]);
            let record = nodes.record();
            let separation = pair.to_local(&(nodes.displacement[1] - nodes.displacement[0]));
            let tangential = separation.y.hypot(separation.z);
            if record.state.bond == Bond::Softening {
                seen += 1;
                let error = (record.state.slip - tangential).abs();
                // The first step, in which the bond still held, is the difference.
                assert!(
                    error < 2.1e-6 * sine + 1e-15,
                    "{degrees}: {record:?} {tangential}"
                );
                least = least.min(record.first_slip.unwrap_or(f64::INFINITY));
            }
        }
        assert!(seen > 100, "{degrees}: {seen}");
        assert_eq!(least.is_finite(), degrees > 0.0, "{degrees}: {least}");
        assert!(degrees == 0.0 || least < 5e-6, "{degrees}: {least}");
    }
}

/// While a bond is drawn apart or sheared at a steady speed no work on it counts as impact, with coarse steps, too: what it stores
/// and has dissipated is the work up to the middle of the step. In mixed modes the error falls with the step.
#[test]
fn a_bond_on_its_way_has_no_impact() {
    for steps in [20, 100] {
        for angle in [0.0_f64, 0.4, 1.2, core::f64::consts::FRAC_PI_2] {
            let pair = JointPair::new([0, 1], Vec3::new(0.6, 0.0, 0.8), 3.0);
            let inverse = [Mat3::zeros(), Mat3::identity() * 1e-12];
            let mut nodes = Nodes::new(joint(CONCRETE, pair), inverse, 1e-3);
            let along = Vec3::new(0.8, 0.0, -0.6) * angle.sin();
            let way = pair.normal * angle.cos() + along;
            // The whole separation in opening is 0.2 mm, in shear 1 mm.
            let last = if angle > 1.5 { 1e-3 } else { 2e-4 };
            nodes.velocity[1] = way * (last / f64::from(steps) / nodes.step);
            // The first step begins with a velocity that the closed sides cannot have had.
            nodes.advance([Vec3::zeros(); 2]);
            let (first, mut most) = (nodes.record().impact, 0.0_f64);
            for _ in 0..2 * steps {
                nodes.advance([Vec3::zeros(); 2]);
                most = most.max((nodes.record().impact - first).abs());
            }
            assert!(nodes.record().bond_energy > 100.0, "{angle}");
            let share = most / nodes.record().bond_energy;
            // Between the modes, which the first step does not know, a quarter of a step's work remains.
            let is_pure = way.dot(&pair.normal).abs() < 1e-12 || angle == 0.0;
            let allowed = if is_pure {
                1e-5
            } else {
                0.25 / f64::from(steps)
            };
            assert!(share < allowed, "{steps} {angle}: {share:e} {allowed:e}");
        }
    }
}

proptest! {
    /// The traction of a bond that softens has no jump, whatever its pair has done: where it turns back, opens on, stops or begins to slide, small
    /// changes of the trial change it by a little. (Sides that meet or part do jump, so that all trials of a line press, or none.)
    #[test]
    fn the_traction_of_a_softening_bond_has_no_jump(
        steepness in 0.1..2.9_f64,
        reached in 0.02..0.9_f64,
        [opened, opened_before] in [0.0..1.3_f64, 0.0..1.3],
        slid in [-1.3..1.3_f64, -1.3..1.3],
        slid_before in [-1.3..1.3_f64, -1.3..1.3],
        pressed in any::<bool>(),
        from in [0.0..3.0_f64, -4.0..4.0, -4.0..4.0],
        to in [0.0..3.0_f64, -4.0..4.0, -4.0..4.0],
    ) {
        let law = Cohesive::new(CohesiveParameters {
            reduction: StrengthReduction::None,
            ..CONCRETE
        })
        .unwrap();
        let (tensile, last, ratio) = (1e6, 2e-4, 2.0);
        let separation = reached * last;
        let mut history = vec![0.0; law.history().len()];
        history[0] = separation / (tensile * (1.0 - reached));
        // A pair that presses is closed.
        let [opened, opened_before] = [opened, opened_before].map(|o| if pressed { 0.0 } else { o * separation });
        let [slid, slid_before] = [slid, slid_before].map(|s| s.map(|s| s * separation / ratio));
        let step = 1e-3;
        let rates = [0, 1].map(|c| (slid[c] - slid_before[c]) / step);
        let state = law.initial().with_bond(Bond::Softening).with_contact(ContactState::Slide);
        let traction = |trial: Vec3| {
            let input = JointInput::new(trial, &state)
                .with_history(&history)
                .with_motion(opened, rates)
                .with_shear_displacement(slid, (opened - opened_before) / step)
                .with_step(0.0, step, steepness * last / tensile / step);
            law.admissible(&input, &mut history.clone()).traction
        };
        let [from, to] = [from, to].map(|[x, y, z]| Vec3::new(if pressed { -x } else { x }, y, z) * tensile);
        let at = |share: f64| from + (to - from) * share;
        for cell in 0..400 {
            let [mut low, mut high] = [cell, cell + 1].map(|c| f64::from(c) / 400.0);
            let jump = |low: f64, high: f64| (traction(at(high)) - traction(at(low))).norm();
            while high - low > 1e-12 && jump(low, high) > 0.001 * tensile {
                let middle = 0.5 * (low + high);
                if jump(low, middle) > jump(middle, high) {
                    high = middle;
                } else {
                    low = middle;
                }
            }
            prop_assert!(jump(low, high) <= 0.001 * tensile, "{} Pa at {low} of the way", jump(low, high));
        }
    }
}
