//! Loads, springs and additional blocks.

use crate::support::{Links, chain};
use powerhouse_elements::{FacePressure, FaceTraction, NodalForce, Profile};
use powerhouse_explicit_core::{BuildModel, Leapfrog, Model, run};
use powerhouse_model::{
    BlockContext, BlockStiffness, BoundaryParts, ElementBlock, ElementFault, ElementKind,
    ExtraBlock, FrequencyBound, Mat3, Mesh, NodalImpedance, NodalLoad, NodalView, NodalViewMut,
    Operator, Quad, Rayleigh, RunOptions, StepChoice, Vec3,
};

/// Resultant (N) and moment about the origin (N m) of a load at a time.
fn resultant(mesh: &Mesh, load: &mut dyn NodalLoad, time: f64) -> (Vec3, Vec3) {
    let nodes = load.nodes().to_vec();
    let mut forces = vec![Vec3::zeros(); nodes.len()];
    load.add_forces(time, &mut forces);
    let position = |&n: &u32| mesh.positions()[n as usize];
    let moment = nodes
        .iter()
        .zip(&forces)
        .map(|(n, f)| position(n).cross(f))
        .sum();
    (forces.iter().sum(), moment)
}

/// A box whose `right` wall (x = 4) is bent inside its plane, of each kind.
fn walls() -> [Mesh; 5] {
    let high = Vec3::new(4.0, 3.0, 6.0);
    let shear = |p: Vec3| Vec3::new(p.x, p.y + 0.1 * p.z, p.z);
    let tets = Mesh::box_of_tets(Vec3::zeros(), high, [2, 3, 6], "rock").unwrap();
    [
        Mesh::box_of_hexes(Vec3::zeros(), high, [2, 3, 6], "rock").unwrap(),
        Mesh::box_of_wedges(Vec3::zeros(), high, [2, 3, 6], "rock").unwrap(),
        Mesh::box_of_pyramids(Vec3::zeros(), high, [2, 3, 6], "rock").unwrap(),
        tets.with_midpoints().unwrap(),
        tets,
    ]
    .map(|mesh| mesh.map_positions(shear).unwrap())
}

/// A uniform pressure pushes with `p A` against the outward normal through the centre of the face.
#[test]
fn a_uniform_pressure_has_its_resultant() {
    for mesh in walls() {
        let facets = mesh.facet_set("right").unwrap();
        let mut load =
            FacePressure::new(&mesh, facets, Profile::Uniform, Box::new(|t: f64| 5.0 * t)).unwrap();
        let (force, moment) = resultant(&mesh, &mut load, 2.0);
        let exact = Vec3::new(-10.0 * 18.0, 0.0, 0.0);
        let centre = Vec3::new(4.0, 1.5 + 0.1 * 3.0, 3.0);
        assert!((force - exact).norm() < 1e-11);
        assert!((moment - centre.cross(&exact)).norm() < 1e-11);
    }
}

/// On triangles with midpoints a uniform pressure has a twelfth of its force at corners and a quarter at midpoints.
#[test]
fn a_uniform_pressure_is_that_of_the_facets() {
    let mesh = &walls()[3];
    let facets = mesh.facet_set("right").unwrap();
    let load = FacePressure::new(mesh, facets, Profile::Uniform, Box::new(|_: f64| 1.0));
    let mut load = load.unwrap();
    let mut forces = vec![Vec3::zeros(); load.nodes().len()];
    load.add_forces(0.0, &mut forces);
    let areas = mesh.tributary_areas(facets);
    assert_eq!(areas.len(), forces.len());
    for (area, force) in areas.iter().zip(forces) {
        assert!((force + area.normal * area.area).norm() < 1e-14);
    }
}

/// Water up to a level that is a level of nodes pushes with `rho g H^2 / 2` per metre, a third of
/// its depth above the bottom, on quadrilaterals and triangles.
#[test]
fn water_pushes_at_a_third_of_its_depth() {
    for mesh in walls() {
        let facets = mesh.facet_set("right").unwrap();
        let profile = Profile::water(5.0);
        let mut load = FacePressure::new(&mesh, facets, profile, Box::new(|_: f64| 1.0)).unwrap();
        let (force, moment) = resultant(&mesh, &mut load, 0.0);
        let total = 9810.0 * 25.0 / 2.0 * 3.0;
        assert!((force - Vec3::new(-total, 0.0, 0.0)).norm() < 1e-9 * total);
        // M_y = z F_x.
        assert!((moment.y + total * 5.0 / 3.0).abs() < 1e-9 * total);
    }
}

/// A traction keeps its direction on an inclined face, and its resultant is traction times area.
#[test]
fn a_traction_keeps_its_direction() {
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(2.0), [2, 2, 2], "rock").unwrap();
    let mesh = mesh
        .map_positions(|p| Vec3::new(p.x + 0.75 * p.z, p.y, p.z))
        .unwrap();
    let facets = mesh.facet_set("right").unwrap();
    let traction = Vec3::new(1.0, -2.0, 3.0);
    let history = Box::new(|_: f64| 1.0);
    let mut load = FaceTraction::new(&mesh, facets, traction, Profile::Uniform, history).unwrap();
    let (force, _) = resultant(&mesh, &mut load, 0.0);
    assert!((force - traction * (2.0 * 2.5)).norm() < 1e-12);
    assert!(
        FaceTraction::new(
            &mesh,
            facets,
            traction,
            Profile::water(f64::NAN),
            Box::new(|_: f64| 1.0)
        )
        .is_err()
    );
}

/// A force on a spring boundary settles at `F / k`, and at the new stage's start the spring is
/// measured from there: without the force it stays where it is.
#[test]
fn springs_are_measured_from_the_start_of_the_stage() {
    let mesh = chain(4, 1.0);
    let stiffness = 1.0e6;
    let build = |force: f64| {
        Model::builder(&mesh)
            .elements(
                "bar",
                Links::new("bar", ElementKind::Bar2, 1.0e7, 1.0, 2000.0)
                    .damped(20.0, 0.0)
                    .boxed(),
            )
            .load(Box::new(NodalForce::new(
                vec![4],
                Vec3::new(force, 0.0, 0.0),
                Box::new(|_: f64| 1.0),
            )))
            .boundary(
                BoundaryParts::default().with_impedance(vec![NodalImpedance::new(
                    0,
                    Mat3::identity() * stiffness,
                    Mat3::zeros(),
                )]),
            )
            .build()
            .unwrap()
    };
    let options = RunOptions::steps(20_000).with_step(StepChoice::Fixed(2e-4));
    let mut first = build(500.0);
    run(&mut first, &Leapfrog, &options, &mut [], &mut |_| {}).unwrap();
    assert!((first.displacement(0).x - 500.0 / stiffness).abs() < 1e-12);
    let mut second = build(0.0);
    second.set_state(&first.state()).unwrap();
    second.begin_stage();
    run(&mut second, &Leapfrog, &options, &mut [], &mut |_| {}).unwrap();
    // The bar contracts to its own length about the spring, which is at rest where it was.
    assert!((second.displacement(0).x - 500.0 / stiffness).abs() < 1e-12);
    assert!((second.displacement(4).x - 500.0 / stiffness).abs() < 1e-12);
}

/// A bar along x from an existing node to an additional one.
struct Tail {
    nodes: Vec<u32>,
    stiffness: f64,
    mass: f64,
}

impl Tail {
    fn write(&self, x: NodalView, out: NodalViewMut) {
        let stretch = x.vector(1).x - x.vector(0).x;
        let force = Vec3::x() * (self.stiffness * stretch);
        if let NodalViewMut::F64(out) = out {
            out[0] = Quad::from_vector(&-force);
            out[1] = Quad::from_vector(&force);
        }
    }
}

impl ElementBlock for Tail {
    fn label(&self) -> &str {
        "tail"
    }
    fn elements(&self) -> &[u32] {
        &[]
    }
    fn nodes(&self) -> &[u32] {
        &self.nodes
    }
    fn forces(&mut self, context: &BlockContext, out: NodalViewMut) -> Result<(), ElementFault> {
        self.write(context.displacement, out);
        Ok(())
    }
    fn add_mass(&self, out: &mut [f64]) {
        out[0] += 0.5 * self.mass;
        out[1] += 0.5 * self.mass;
    }
    fn frequency_bounds(&self) -> Vec<FrequencyBound> {
        Vec::new()
    }
    fn stiffness(&self) -> Option<&dyn BlockStiffness> {
        Some(self)
    }
}

impl BlockStiffness for Tail {
    fn apply(&self, _operator: Operator, x: NodalView, out: NodalViewMut) {
        self.write(x, out);
    }
}

/// Blocks that boundaries bring along, with nodes and a load of their own, extend the body: a bar
/// continued by three such blocks of two boundaries moves like one that is meshed throughout, and
/// is continued from its state with the same bits.
#[test]
fn additional_blocks_extend_the_body() {
    let (young, density) = (1.0e7, 2000.0);
    let links = || Links::new("bar", ElementKind::Bar2, young, 1.0, density).boxed();
    let force = |node| {
        NodalForce::new(
            vec![node],
            Vec3::x(),
            Box::new(|t: f64| 1e3 * (80.0 * t).sin()),
        )
    };
    let whole_mesh = chain(9, 1.0);
    let mut whole = Model::builder(&whole_mesh)
        .elements("bar", links())
        .load(Box::new(force(9)))
        .load(Box::new(force(0)))
        .build()
        .unwrap();
    let short_mesh = chain(6, 1.0);
    let tail = |from: u32, at: f64| {
        let to = if from < 7 { 7 } else { from + 1 };
        ExtraBlock {
            nodes: vec![Vec3::new(at, 0.0, 0.0)],
            block: Box::new(Tail {
                nodes: vec![from, to],
                stiffness: young,
                mass: density,
            }),
        }
    };
    let build = || {
        // At the right end two blocks in a row, whose second end is loaded; at the left end one.
        let right = BoundaryParts::default()
            .with_blocks(vec![tail(6, 7.0), tail(7, 8.0)])
            .with_loads(vec![Box::new(force(8))]);
        let left = BoundaryParts::default()
            .with_blocks(vec![ExtraBlock {
                nodes: vec![Vec3::new(-1.0, 0.0, 0.0)],
                block: Box::new(Tail {
                    nodes: vec![7, 0],
                    stiffness: young,
                    mass: density,
                }),
            }])
            .with_loads(vec![Box::new(force(7))]);
        Model::builder(&short_mesh)
            .elements("bar", links())
            .boundary(right)
            .boundary(left)
            .build()
            .unwrap()
    };
    let step = StepChoice::Fixed(5e-3);
    let mut short = build();
    let limits = [
        whole.stable_step(&Leapfrog).unwrap().step,
        short.stable_step(&Leapfrog).unwrap().step,
    ];
    assert!((limits[0] / limits[1] - 1.0).abs() < 1e-6);
    for model in [&mut whole, &mut short] {
        run(
            model,
            &Leapfrog,
            &RunOptions::steps(400).with_step(step),
            &mut [],
            &mut |_| {},
        )
        .unwrap();
    }
    let scale = whole.displacement(9).norm();
    for node in 0..=6 {
        let difference = short.displacement(node) - whole.displacement(node + 1);
        assert!(difference.norm() < 1e-11 * scale);
    }
    let mut resumed = build();
    resumed.set_state(&short.state()).unwrap();
    for model in [&mut short, &mut resumed] {
        run(
            model,
            &Leapfrog,
            &RunOptions::steps(100).with_step(step),
            &mut [],
            &mut |_| {},
        )
        .unwrap();
    }
    assert_eq!(short.state(), resumed.state());
}

/// Rayleigh coefficients are refused out of range, naming the field.
#[test]
fn damping_ratios_are_checked() {
    assert_eq!(
        Rayleigh::from_ratio(1.5, 1.0, 2.0).unwrap_err().name,
        "ratio"
    );
    assert_eq!(
        Rayleigh::from_ratio(0.05, 0.0, 2.0).unwrap_err().name,
        "first frequency"
    );
    let damping = Rayleigh::from_ratio(0.05, 1.0, 10.0).unwrap();
    for frequency in [1.0, 10.0] {
        let w = std::f64::consts::TAU * frequency;
        assert!((0.5 * (damping.mass / w + damping.stiffness * w) - 0.05).abs() < 1e-15);
    }
}
