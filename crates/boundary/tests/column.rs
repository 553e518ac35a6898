//! A column of rock under a vertical wave, by a hand-made explicit loop: effect of a boundary's springs,
//! dashpots and input forces on a wave.
//!
//! ```text
//!   z = H  o  free surface, or boundary "top"
//!          |
//!          |  n springs of height h, lumped masses
//!          |
//!   z = 0  o  boundary "base"
//! ```

use powerhouse_boundary::{InputMode, Viscous, ViscousSpring};
use powerhouse_model::{
    AbsorbingBoundary, BoundaryParts, BoundarySite, ElasticMedium, FieldMotion, FieldSampler,
    IncidentField, Mat3, ModelError, NodalLoad, SiteFace, SiteNode, Vec3,
};

const HEIGHT: f64 = 100.0;
const AREA: f64 = 2.0;

fn rock() -> ElasticMedium {
    ElasticMedium::new(9.0e9, 0.27, 2750.0).unwrap()
}

/// A pulse of 30 ms that is zero, to rounding, before 0 s and after 60 ms; and its derivative.
fn pulse(t: f64) -> (f64, f64) {
    let x = (t - 0.03) / 0.005;
    let bell = (-x * x).exp();
    (1.0e-3 * bell, 1.0e-3 * bell * -2.0 * x / 0.005)
}

/// A P wave (along z) and an S wave (along x) that rise together, and what a surface returns.
#[derive(Clone, Copy)]
struct Vertical {
    surface: Option<f64>,
}

impl Vertical {
    fn motion(&self, z: f64, time: f64) -> FieldMotion {
        let m = rock();
        let mut sum = FieldMotion::default();
        for (component, shear, speed) in [(2, false, m.p_speed()), (0, true, m.s_speed())] {
            let mut add = |delay: f64, sign: f64| {
                let (u, v) = pulse(time - delay);
                sum.displacement[component] += u;
                sum.velocity[component] += v;
                let impedance = sign * m.density * speed;
                if shear {
                    sum.stress.0[5] -= impedance * v;
                } else {
                    let side = m.lambda() / m.constrained();
                    for (i, share) in [side, side, 1.0].into_iter().enumerate() {
                        sum.stress.0[i] -= share * impedance * v;
                    }
                }
            };
            add(z / speed, 1.0);
            if let Some(surface) = self.surface {
                add((2.0 * surface - z) / speed, -1.0);
            }
        }
        sum
    }
}

struct Points(Vertical, Vec<f64>);

impl FieldSampler for Points {
    fn len(&self) -> usize {
        self.1.len()
    }
    fn add_motion(&self, time: f64, motion: &mut [FieldMotion]) {
        for (z, motion) in self.1.iter().zip(motion) {
            *motion += self.0.motion(*z, time);
        }
    }
}

impl IncidentField for Vertical {
    fn name(&self) -> &str {
        "vertical"
    }
    fn medium(&self) -> ElasticMedium {
        rock()
    }
    fn incident_part(&self) -> Option<Box<dyn IncidentField>> {
        Some(Box::new(Self { surface: None }))
    }
    fn prepare(&self, points: &[Vec3]) -> Result<Box<dyn FieldSampler>, ModelError> {
        let depths = points.iter().map(|point| point.z).collect();
        Ok(Box::new(Points(*self, depths)))
    }
}

/// Faces at the base and, if wanted, on top.
fn site(top: bool, field: Option<&dyn IncidentField>, elements: usize) -> BoundarySite<'_> {
    let face = |face, node: usize, height: f64, up: f64| SiteNode {
        node: node as u32,
        position: Vec3::new(0.0, 0.0, height),
        faces: vec![SiteFace {
            face,
            medium: rock(),
            normal: Vec3::new(0.0, 0.0, up),
            area: AREA,
        }],
    };
    let mut nodes = vec![face(0, 0, 0.0, -1.0)];
    if top {
        nodes.push(face(1, elements, HEIGHT, 1.0));
    }
    let faces = vec!["base".into(), "top".into()];
    BoundarySite::new(faces, nodes, Vec3::new(0.0, 0.0, 0.5 * HEIGHT), field)
}

/// Masses and springs of a column with the parts of a boundary.
struct Column {
    stiffness: Vec3,
    masses: Vec<f64>,
    /// Spring and dashpot of each node.
    impedance: Vec<(Mat3, Mat3)>,
    loads: Vec<Box<dyn NodalLoad>>,
    displacement: Vec<Vec3>,
    velocity: Vec<Vec3>,
    /// Acceleration along z that acts on every mass (m/s2).
    gravity: f64,
}

impl Column {
    fn new(elements: usize, parts: BoundaryParts) -> Self {
        let m = rock();
        let height = HEIGHT / elements as f64;
        let mut masses = vec![m.density * AREA * height; elements + 1];
        masses[0] *= 0.5;
        masses[elements] *= 0.5;
        let mut impedance = vec![(Mat3::zeros(), Mat3::zeros()); elements + 1];
        for part in &parts.impedance {
            impedance[part.node as usize] = (part.spring, part.dashpot);
        }
        Self {
            impedance,
            loads: parts.loads,
            stiffness: Vec3::new(m.shear(), m.shear(), m.constrained()) * AREA / height,
            masses,
            displacement: vec![Vec3::zeros(); elements + 1],
            velocity: vec![Vec3::zeros(); elements + 1],
            gravity: 0.0,
        }
    }

    /// One leapfrog step with dashpots and springs implicit in the velocity:
    /// `(M + dt/2 C + dt^2/4 K) v+ = (M - dt/2 C + dt^2/4 K) v- + dt (f - K u)`.
    fn advance(&mut self, time: f64, step: f64) {
        let count = self.masses.len();
        let weight = |mass: &f64| Vec3::new(0.0, 0.0, mass * self.gravity);
        let mut force: Vec<Vec3> = self.masses.iter().map(weight).collect();
        for i in 0..count - 1 {
            let stretch = self.displacement[i + 1] - self.displacement[i];
            let tension = self.stiffness.component_mul(&stretch);
            force[i] += tension;
            force[i + 1] -= tension;
        }
        for load in &mut self.loads {
            let nodes = load.nodes().to_vec();
            let mut values = vec![Vec3::zeros(); nodes.len()];
            load.add_forces(time, &mut values);
            for (node, value) in nodes.iter().zip(values) {
                force[*node as usize] += value;
            }
        }
        for i in 0..count {
            let (spring, dashpot) = self.impedance[i];
            let mass = Mat3::identity() * self.masses[i];
            let lagged = mass + spring * (0.25 * step * step);
            let right = (lagged - dashpot * (0.5 * step)) * self.velocity[i]
                + step * (force[i] - spring * self.displacement[i]);
            let matrix = lagged + dashpot * (0.5 * step);
            self.velocity[i] = matrix.try_inverse().unwrap() * right;
        }
        for (u, v) in self.displacement.iter_mut().zip(&self.velocity) {
            *u += step * v;
        }
    }

    fn energy(&self) -> f64 {
        let kinetic = self.masses.iter().zip(&self.velocity);
        let kinetic = kinetic.map(|(m, v)| 0.5 * m * v.norm_squared());
        let stretch = self.displacement.windows(2).map(|u| u[1] - u[0]);
        let strain = stretch.map(|s| 0.5 * s.dot(&self.stiffness.component_mul(&s)));
        kinetic.sum::<f64>() + strain.sum::<f64>()
    }
}

/// At the step in which a P wave crosses one element a dashpot of its impedance absorbs it
/// exactly: the node moves as its neighbour did a step before.
#[test]
fn a_dashpot_absorbs_a_wave_along_the_normal() {
    let elements = 200;
    let step = HEIGHT / elements as f64 / rock().p_speed();
    let parts = Viscous::default()
        .build(&site(true, None, elements))
        .unwrap();
    let mut column = Column::new(elements, parts);
    for (i, velocity) in column.velocity.iter_mut().enumerate() {
        let x = (i as f64 - 100.0) / 12.0;
        velocity.z = (-x * x).exp();
    }
    let start = column.energy();
    for number in 0..2 * elements {
        column.advance(number as f64 * step, step);
    }
    assert!(
        column.energy() < 1e-25 * start,
        "{}",
        column.energy() / start
    );
}

/// Dashpots of 1.1 times the impedance return (1.1 - 1)/(1.1 + 1) of the amplitude along the
/// normal.
#[test]
fn stiffer_dashpots_return_one_part_in_twenty_one() {
    let elements = 400;
    let step = HEIGHT / elements as f64 / rock().p_speed();
    let mut parts = Viscous::default()
        .build(&site(true, None, elements))
        .unwrap();
    for impedance in &mut parts.impedance {
        impedance.dashpot *= 1.1;
    }
    let mut column = Column::new(elements, parts);
    let start = |i: usize| (-((i as f64 - 200.0) / 20.0).powi(2)).exp();
    for i in 0..=elements {
        column.velocity[i].z = start(i);
    }
    // Both halves of the pulse have been returned and meet in the middle again.
    for number in 0..elements {
        column.advance(number as f64 * step, step);
    }
    let peak = column.velocity[200].z;
    // Half a step between velocity and time moves the peak of a bell of 20 elements by 3e-4.
    assert!((peak + 0.1 / 2.1).abs() < 1e-3 * 0.1 / 2.1, "{peak}");
}

/// Relative L2 error of the motion at 21 stations of the column over the whole pulse.
fn error(boundary: &impl AbsorbingBoundary, surface: bool, elements: usize) -> f64 {
    let field = Vertical {
        surface: surface.then_some(HEIGHT),
    };
    let site = site(!surface, Some(&field), elements);
    let mut column = Column::new(elements, boundary.build(&site).unwrap());
    let step = 0.5 * HEIGHT / elements as f64 / rock().p_speed();
    let (mut difference, mut size) = (0.0, 0.0);
    for number in 0..(0.3 / step) as usize {
        column.advance(number as f64 * step, step);
        let time = (number + 1) as f64 * step;
        for (i, u) in column
            .displacement
            .iter()
            .enumerate()
            .step_by(elements / 20)
        {
            let height = HEIGHT * i as f64 / elements as f64;
            let exact = field.motion(height, time).displacement;
            difference += (u - exact).norm_squared();
            size += exact.norm_squared();
        }
    }
    (difference / size).sqrt()
}

/// With the full free field the column converges to it with the square of the element size,
/// whatever the coefficients of springs and dashpots, under a free surface and without one.
#[test]
fn the_full_field_converges_at_second_order() {
    for surface in [true, false] {
        for boundary in [
            &Viscous::default() as &dyn AbsorbingBoundary,
            &ViscousSpring::default(),
        ] {
            let errors = [160, 320, 640].map(|elements| error(&Dyn(boundary), surface, elements));
            for pair in errors.windows(2) {
                let slope = (pair[0] / pair[1]).log2();
                assert!(
                    (slope - 2.0).abs() < 0.1,
                    "{} {surface}: {errors:?}",
                    boundary.name()
                );
            }
            assert!(errors[2] < 0.01, "{errors:?}");
        }
    }
}

/// A reference to a boundary as a boundary.
struct Dyn<'a>(&'a dyn AbsorbingBoundary);

impl AbsorbingBoundary for Dyn<'_> {
    fn name(&self) -> &str {
        self.0.name()
    }
    fn build(&self, site: &BoundarySite) -> Result<BoundaryParts, ModelError> {
        self.0.build(site)
    }
}

/// With the incident wave alone at the base, dashpots (which take the returning wave for a
/// scattered one and absorb it) converge as well; springs and stiffer dashpots leave an error that
/// no mesh removes.
#[test]
fn incident_only_input_is_as_good_as_the_absorber() {
    let input = || InputMode::IncidentOnly {
        faces: vec!["base".into()],
    };
    let dashpots = Viscous { input: input() };
    let springs = ViscousSpring {
        input: input(),
        ..ViscousSpring::default()
    };
    assert!(error(&dashpots, true, 640) < 0.01);
    let coarse = error(&springs, true, 320);
    let fine = error(&springs, true, 640);
    assert!(fine > 0.05 && fine > 0.9 * coarse, "{coarse} {fine}");
}

/// A static force on the column is held by the springs, at the displacement of their stiffness;
/// dashpots alone let it drift.
#[test]
fn springs_hold_a_permanent_force() {
    let elements = 20;
    let step = 0.5 * HEIGHT / elements as f64 / rock().p_speed();
    let settle = |parts: BoundaryParts| {
        let spring: f64 = parts.impedance.iter().map(|i| i.spring[(2, 2)]).sum();
        let mut column = Column::new(elements, parts);
        column.gravity = 1.0;
        for number in 0..40_000 {
            column.advance(number as f64 * step, step);
        }
        (column, spring)
    };
    let held = ViscousSpring::default()
        .build(&site(true, None, elements))
        .unwrap();
    let (column, spring) = settle(held);
    let weight: f64 = column.masses.iter().sum();
    // Both ends carry half the weight.
    let expected = weight / spring;
    let found = column.displacement[0].z;
    assert!(
        (found - expected).abs() < 1e-9 * expected,
        "{found} {expected}"
    );
    let free = Viscous::default()
        .build(&site(true, None, elements))
        .unwrap();
    let (column, _) = settle(free);
    assert!(column.displacement[0].z > 10.0 * expected);
}
