//! The reported stable step compared with the true one, which is determined from the scheme's own steps.
//!
//! A step of a linear body is a linear map of displacement and velocity. The map is computed column by
//! column from single steps of the body, whatever is attached to it; the body is stable at a step if
//! powers of the map stay bounded.

use nalgebra::DMatrix;
use powerhouse::engine::{BuildModel, Leapfrog, Model, OneSided, run};
use powerhouse_boundary::{InputMode, ViscousSpring};
use powerhouse_contact::{Joint, JointSurface, SurfaceOptions, Tied};
use powerhouse_elements::{BoltLine, BoltParameters, BoltSet, SolidKernel};
use powerhouse_material_damage::media;
use powerhouse_model::{
    BlockOptions, ElasticMedium, ElementKind, Mesh, Rayleigh, RunOptions, StepChoice,
    TimeIntegrator, Vec3,
};
use powerhouse_tests::{Ground, elastic};

/// Greatest examined power of the map, as an exponent of 2: a step beyond the limit by 1e-7 of it is detected.
const DOUBLINGS: usize = 14;
/// Greatest permitted growth of the map over that of one step: free bodies drift by a distance for each step.
const BOUNDED: f64 = 1e7;
/// Relative accuracy of the true step.
const TOLERANCE: f64 = 1e-3;

/// Whether steps of a length (s) keep a body's motion bounded.
fn is_stable(model: &mut Model, integrator: &dyn TimeIntegrator, step: f64) -> bool {
    let nodes = model.mesh().node_count();
    let options = RunOptions::steps(1)
        .with_step(StepChoice::Unchecked(step))
        .with_speed_limit(f64::MAX);
    let mut map = DMatrix::zeros(6 * nodes, 6 * nodes);
    for column in 0..6 * nodes {
        let mut start = [vec![Vec3::zeros(); nodes], vec![Vec3::zeros(); nodes]];
        // Velocities are scaled by the step.
        let (which, entry) = (column / (3 * nodes), column % (3 * nodes));
        start[which][entry / 3][entry % 3] = [1.0, 1.0 / step][which];
        model.set_initial(&start[0], &start[1]).unwrap();
        run(model, integrator, &options, &mut [], &mut |_| {}).unwrap();
        for node in 0..nodes {
            let (u, v) = (model.displacement(node as u32), model.velocity(node as u32));
            for axis in 0..3 {
                map[(3 * node + axis, column)] = u[axis];
                map[(3 * (nodes + node) + axis, column)] = v[axis] * step;
            }
        }
    }
    let most = BOUNDED * map.norm();
    for _ in 0..DOUBLINGS {
        map = &map * &map;
        let size = map.norm();
        if size.is_nan() || size > most {
            return false;
        }
    }
    true
}

/// The reported step over the true one.
///
/// # Panics
/// If the reported step is unstable.
fn ratio(name: &str, mut model: Model, integrator: &dyn TimeIntegrator) -> f64 {
    let reported = model.stable_step(integrator).unwrap().step;
    assert!(
        is_stable(&mut model, integrator, reported),
        "{name}: {reported:e} s grows"
    );
    let (mut below, mut above) = (1.0, 1.1);
    while is_stable(&mut model, integrator, above * reported) {
        (below, above) = (above, 1.2 * above);
        assert!(above < 100.0, "{name}: stable at every step");
    }
    while above - below > TOLERANCE * below {
        let middle = 0.5 * (below + above);
        if is_stable(&mut model, integrator, middle * reported) {
            below = middle;
        } else {
            above = middle;
        }
    }
    1.0 / below
}

const CELLS: [usize; 3] = [2, 2, 1];

fn boxed(kernel: SolidKernel) -> Ground {
    let mut ground = Ground::boxed(Vec3::new(4.0, 4.0, 2.0), CELLS, media::ROCK, kernel);
    ground.threads = Some(1);
    ground
}

/// Elements of different shapes.
fn distorted(kernel: SolidKernel) -> Ground {
    let bend = |a: f64, b: f64| 0.35 * (1.3 * a + 0.7 * b).sin();
    boxed(kernel).mapped(|p| {
        let x = p.x + bend(p.y, p.z);
        Vec3::new(x, p.y + bend(p.z, p.x), p.z * (1.0 + 0.1 * p.x))
    })
}

/// Elements ten times as long on one side as on the other.
fn graded(kernel: SolidKernel) -> Ground {
    let grade = |x: f64| {
        if x > 2.0 {
            0.4 + 2.0 * (x - 2.0)
        } else {
            0.2 * x
        }
    };
    boxed(kernel).mapped(|p| Vec3::new(grade(p.x), grade(p.y), p.z))
}

/// Elements with angles of 20 degrees.
fn leaning(kernel: SolidKernel) -> Ground {
    let lean = 1.0 / 20.0_f64.to_radians().tan();
    boxed(kernel).mapped(|p| Vec3::new(p.x + lean * p.z, p.y, p.z))
}

fn with_damping(mut ground: Ground, damping: Rayleigh) -> Ground {
    ground.options.damping = damping;
    ground
}

/// Stiffness damping that halves the step of a body approximately.
fn half_a_step(ground: &Ground) -> f64 {
    let mut model = ground.free().build().unwrap();
    0.4 * model.stable_step(&Leapfrog).unwrap().assembled_limit
}

/// Springs and dashpots on five sides.
fn absorbing(ground: &Ground) -> Model {
    let boundary = ViscousSpring {
        input: InputMode::Nothing,
        ..ViscousSpring::default()
    };
    let faces = ["left", "right", "front", "back", "bottom"];
    ground
        .with_boundary(&boundary, &faces, None)
        .build()
        .unwrap()
}

/// Three thick bolts through the body.
fn bolted(ground: &Ground) -> Model {
    let (low, high) = ground.mesh.bounding_box();
    let at = |x: f64, y: f64, z: f64| low + (high - low).component_mul(&Vec3::new(x, y, z));
    let lines = [
        [at(0.3, 0.4, 0.2), at(0.7, 0.6, 0.7)],
        [at(0.5, 0.5, 0.3), at(0.6, 0.5, 0.7)],
        [at(0.3, 0.6, 0.3), at(0.5, 0.4, 0.6)],
    ]
    .map(|[head, toe]| BoltLine { head, toe });
    let steel = BoltParameters::steel(0.1).unwrap();
    let all: Vec<u32> = (0..ground.mesh.element_count() as u32).collect();
    let bolts = BoltSet::new("bolts", &ground.mesh, &all, &lines, steel).unwrap();
    ground
        .free()
        .embed(Box::new(bolts.clone()))
        .build()
        .unwrap()
}

/// Two halves, the second of another medium and damping, with an optional bonded joint between them.
fn halves(ground: &Ground, (second, damping): (ElasticMedium, f64), jointed: bool) -> Model {
    let all = 0..ground.mesh.element_count() as u32;
    let middle = ground.mesh.bounding_box();
    let middle = 0.5 * (middle.0 + middle.1);
    let (left, right): (Vec<u32>, Vec<u32>) =
        all.partition(|&e| ground.mesh.centroid(e).x < middle.x);
    let mut mesh = ground.mesh.clone();
    let mut joint = None;
    if jointed {
        let split = mesh.split_between(&left, &right).unwrap();
        let options = SurfaceOptions::within(1e-6).unwrap();
        let sides = (&split.first, &split.second);
        let surface = JointSurface::between(&split.mesh, sides.0, sides.1, &options).unwrap();
        joint = Some(Joint::new("joint", surface.pairs, Tied).unwrap());
        mesh = split.mesh;
    }
    let mut options = BlockOptions::default();
    let first = elastic("left", ground.kernel, ground.medium, options);
    options.damping.stiffness = damping;
    let second = elastic("right", ground.kernel, second, options);
    let builder = Model::builder(&mesh)
        .elements(left, first)
        .elements(right, second);
    let builder = builder.threads(1);
    match joint {
        Some(joint) => builder.constraint(Box::new(joint)),
        None => builder,
    }
    .build()
    .unwrap()
}

/// A pyramid, a brick, two wedges and six tetrahedra in a row.
fn of_all_kinds() -> Model {
    let mut mesh = Mesh::builder();
    let tag = |x: u64, y: u64, z: u64| 1 + x + 4 * y + 8 * z;
    for (x, y, z) in (0..16).map(|i| (i % 4, i / 4 % 2, i / 8)) {
        let position = Vec3::new(x as f64 + 0.1 * z as f64, y as f64, 0.8 * z as f64);
        mesh.node(tag(x, y, z), position);
    }
    let n = |x: u64| move |dx: u64, y: u64, z: u64| tag(x + dx, y, z);
    let (b, w, t) = (n(0), n(1), n(2));
    let brick = [
        b(0, 0, 0),
        b(1, 0, 0),
        b(1, 1, 0),
        b(0, 1, 0),
        b(0, 0, 1),
        b(1, 0, 1),
        b(1, 1, 1),
        b(0, 1, 1),
    ];
    mesh.element(1, ElementKind::Hex8, &brick, &["bricks"]);
    mesh.node(17, Vec3::new(-1.2, 0.4, 0.3));
    let pyramid = [b(0, 1, 0), b(0, 0, 0), b(0, 0, 1), b(0, 1, 1), 17];
    mesh.element(10, ElementKind::Pyramid5, &pyramid, &["pyramids"]);
    let wedges = [
        [
            w(0, 0, 0),
            w(1, 0, 0),
            w(1, 1, 0),
            w(0, 0, 1),
            w(1, 0, 1),
            w(1, 1, 1),
        ],
        [
            w(0, 0, 0),
            w(1, 1, 0),
            w(0, 1, 0),
            w(0, 0, 1),
            w(1, 1, 1),
            w(0, 1, 1),
        ],
    ];
    for (number, nodes) in wedges.iter().enumerate() {
        mesh.element(2 + number as u64, ElementKind::Wedge6, nodes, &["wedges"]);
    }
    let (low, high) = (t(0, 0, 0), t(1, 1, 1));
    let ring = [
        t(1, 0, 0),
        t(1, 1, 0),
        t(0, 1, 0),
        t(0, 1, 1),
        t(0, 0, 1),
        t(1, 0, 1),
    ];
    for i in 0..6 {
        let nodes = [low, ring[i], ring[(i + 1) % 6], high];
        mesh.element(4 + i as u64, ElementKind::Tet4, &nodes, &["tetrahedra"]);
    }
    let mesh = mesh.build().unwrap();
    let make = |set, kernel| elastic(set, kernel, media::ROCK, BlockOptions::default());
    Model::builder(&mesh)
        .elements("bricks", make("bricks", SolidKernel::Hex8BBar))
        .elements("pyramids", make("pyramids", SolidKernel::Pyramid5))
        .elements("wedges", make("wedges", SolidKernel::Wedge6))
        .elements("tetrahedra", make("tetrahedra", SolidKernel::Tet4))
        .threads(1)
        .build()
        .unwrap()
}

type Body = (String, Model, &'static dyn TimeIntegrator);

/// Bodies of every kind.
fn bodies() -> Vec<Body> {
    let mut bodies: Vec<Body> = Vec::new();
    for kernel in SolidKernel::ALL {
        let mut add = |what: &str, model: Model, integrator| {
            bodies.push((format!("{}, {what}", kernel.name()), model, integrator));
        };
        let body = distorted(kernel);
        let lag = half_a_step(&body);
        let damped = |mass: f64, stiffness: f64| {
            with_damping(body.clone(), Rayleigh { mass, stiffness })
                .free()
                .build()
                .unwrap()
        };
        let soft = ElasticMedium::new(1e9, 0.45, 2000.0).unwrap();
        add("distorted", body.free().build().unwrap(), &Leapfrog);
        add("graded", graded(kernel).free().build().unwrap(), &Leapfrog);
        add(
            "leaning",
            leaning(kernel).free().build().unwrap(),
            &Leapfrog,
        );
        add("absorbing", absorbing(&body), &Leapfrog);
        add("damped", damped(10.0, lag), &Leapfrog);
        add("one-sided", damped(0.0, lag), &OneSided);
        add("of two media", halves(&body, (soft, 0.0), false), &Leapfrog);
        add(
            "one half damped",
            halves(&body, (media::ROCK, lag), false),
            &Leapfrog,
        );
        if kernel.kind() == ElementKind::Hex8 {
            add("bolted", bolted(&body), &Leapfrog);
            add("bonded", halves(&body, (media::ROCK, 0.0), true), &Leapfrog);
        }
    }
    bodies.push(("all kinds".into(), of_all_kinds(), &Leapfrog));
    bodies
}

/// Over distorted, graded and mixed meshes with joints, bolts, springs and damping the reported step is
/// never above the true one, and in the median above 0.95 of it.
#[test]
fn the_reported_step_is_nearly_the_true_one() {
    let bodies = bodies();
    let mut ratios: Vec<(f64, String)> = Vec::new();
    for (name, model, integrator) in bodies {
        ratios.push((ratio(&name, model, integrator), name));
    }
    ratios.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (ratio, name) in &ratios {
        println!("{ratio:.4} {name}");
        assert!(*ratio <= 1.0, "{name}: {ratio}");
    }
    let (median, _) = ratios[ratios.len() / 2];
    println!("stable_step.median_ratio = {median:.4} of {}", ratios.len());
    assert!(median > 0.95, "{median}");
}
