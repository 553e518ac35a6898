//! The motion of models: closed forms, symmetry, and bits.

use crate::support::{Links, chain, hex_box, random_vectors, same_bits_over_threads};
use powerhouse_elements::NodalForce;
use powerhouse_explicit_core::{BuildModel, Leapfrog, Model, run};
use powerhouse_model::{
    Cadence, ElementKind, Fields, Flow, Mat3, Mesh, ModelError, NodalImpedance, Observer,
    PeriodicPairs, Precision, Prescribed, RunOptions, State, StepChoice, StepView, Support, Vec3,
};

fn rock() -> Links {
    Links::new("rock", ElementKind::Hex8, 9.0e9, 0.3, 2700.0)
}

fn steps(model: &mut Model, count: u64, step: f64) {
    let options = RunOptions::steps(count)
        .with_step(StepChoice::Unchecked(step))
        .with_speed_limit(1e9);
    run(model, &Leapfrog, &options, &mut [], &mut |_| {}).unwrap();
}

/// Records displacement, velocity and acceleration of a node at every step.
struct Probe {
    node: u32,
    send: std::sync::mpsc::Sender<[f64; 10]>,
}
impl Observer for Probe {
    fn name(&self) -> &str {
        "probe"
    }
    fn fields(&self) -> Fields {
        Fields::default()
    }
    fn cadence(&self) -> Cadence {
        Cadence::Steps(1)
    }
    fn observe(&mut self, view: &dyn StepView) -> Result<Flow, ModelError> {
        let (u, v) = (view.displacement(self.node), view.velocity(self.node));
        let a = view.acceleration(self.node);
        let row = [view.time(), u.x, u.y, u.z, v.x, v.y, v.z, a.x, a.y, a.z];
        self.send.send(row).unwrap();
        Ok(Flow::Continue)
    }
}

fn probe(node: u32) -> (Box<dyn Observer>, std::sync::mpsc::Receiver<[f64; 10]>) {
    let (send, receive) = std::sync::mpsc::channel();
    (Box::new(Probe { node, send }), receive)
}

/// A free body under gravity falls with g at every node and step: `u = g t^2 / 2`, `v = g t`,
/// `a = g`, to rounding.
#[test]
fn a_free_body_falls_with_g() {
    let mesh = hex_box([3, 2, 2], 1.0, 0.2);
    let g = Vec3::new(0.0, 0.0, -9.81);
    // Soft, so that rounding of the fall is not amplified by the stiffness.
    let soft = Links::new("rock", ElementKind::Hex8, 9.0e6, 0.3, 2700.0);
    let mut model = Model::builder(&mesh)
        .elements("rock", soft.boxed())
        .gravity(g, Box::new(|_: f64| 1.0))
        .build()
        .unwrap();
    let step = 1e-4;
    // At rest at t = 0 with the velocity half a step before.
    let start = vec![-0.5 * step * g; mesh.node_count()];
    let zero = vec![Vec3::zeros(); mesh.node_count()];
    model.set_initial(&zero, &start).unwrap();
    let (observer, rows) = probe(7);
    let options = RunOptions::steps(1001).with_step(StepChoice::Fixed(step));
    run(
        &mut model,
        &Leapfrog,
        &options,
        &mut [observer],
        &mut |_| {},
    )
    .unwrap();
    let rows: Vec<_> = rows.iter().collect();
    assert_eq!(rows.len(), 1001);
    for [t, _, _, uz, _, _, vz, _, _, az] in rows {
        assert!((uz - 0.5 * g.z * t * t).abs() < 1e-13);
        assert!((vz - g.z * t).abs() < 1e-11);
        assert!((az - g.z).abs() < 1e-9);
    }
}

/// A wave in a bar at the limit step travels one element per step without any error, and its
/// front arrives at `L / c`.
#[test]
fn a_wave_in_a_bar_arrives_at_its_speed() {
    let (count, h) = (100, 0.5);
    let (young, density) = (9.0e9_f64, 2750.0);
    let mesh = chain(count, h);
    let c = (young / density).sqrt();
    let mut model = Model::builder(&mesh)
        .elements(
            "bar",
            Links::new("bar", ElementKind::Bar2, young, 1.0, density).boxed(),
        )
        .prescribed(Prescribed {
            nodes: vec![0],
            direction: Vec3::x(),
            displacement: Box::new(|t: f64| 1e-3 * (1.0 - (-t * 1e3).exp())),
        })
        .build()
        .unwrap();
    let step = h / c;
    let (observer, rows) = probe(60);
    let options = RunOptions::steps(90).with_step(StepChoice::Unchecked(step));
    run(
        &mut model,
        &Leapfrog,
        &options,
        &mut [observer],
        &mut |_| {},
    )
    .unwrap();
    for [t, ux, ..] in rows.iter() {
        let delay = 60.0 * h / c;
        // At the limit step d'Alembert's solution is exact; the free end is not reached yet.
        let exact = 1e-3 * (1.0 - (-(t - delay).max(0.0) * 1e3).exp());
        assert!(
            (ux - exact).abs() < 1e-3 * 1e-9,
            "t = {t}: {ux} instead of {exact}"
        );
    }
}

/// A dashpot with the impedance of the bar absorbs the wave: nothing comes back, to rounding, at
/// the limit step, and the bar stays displaced by the impulse over the impedance.
#[test]
fn a_matched_dashpot_absorbs_a_wave_in_a_bar() {
    let (count, h) = (60, 0.5);
    let (young, density) = (9.0e9_f64, 2750.0_f64);
    let c = (young / density).sqrt();
    let mesh = chain(count, h);
    let dashpot = Mat3::identity() * (density * c);
    let impedance = vec![NodalImpedance::new(count as u32, Mat3::zeros(), dashpot)];
    let pulse = |t: f64| {
        if t < 0.01 {
            1e3 * (std::f64::consts::PI * t / 0.01).sin().powi(2)
        } else {
            0.0
        }
    };
    let mut model = Model::builder(&mesh)
        .elements(
            "bar",
            Links::new("bar", ElementKind::Bar2, young, 1.0, density).boxed(),
        )
        .load(Box::new(NodalForce::new(
            vec![0],
            Vec3::x(),
            Box::new(pulse),
        )))
        .boundary(powerhouse_model::BoundaryParts::default().with_impedance(impedance))
        .build()
        .unwrap();
    // Just below the limit: the lumped end of the bar is not the exact radiation condition of the
    // discrete bar below the limit, so the reflection is of second order in frequency.
    steps(&mut model, 600, 0.999 * h / c);
    let impulse = 1e3 * 0.01 / 2.0;
    let residual = impulse / (density * c);
    for node in 0..=count as u32 {
        assert!((model.displacement(node).x / residual - 1.0).abs() < 1e-3);
        assert!(model.velocity(node).x.abs() < 1e-3 * 1e3 / (density * c));
    }
}

/// Momentum of a free body stays what it was, whatever goes on inside, and grows by the impulse of
/// a load.
#[test]
fn momentum_is_conserved() {
    let mesh = hex_box([4, 3, 3], 1.0, 0.25);
    let count = mesh.node_count();
    let force = Vec3::new(3.0e4, -1.0e4, 2.0e4);
    let mut model = Model::builder(&mesh)
        .elements("rock", rock().damped(0.0, 1e-5).boxed())
        .load(Box::new(NodalForce::new(
            vec![5, 17],
            force,
            Box::new(|_: f64| 0.5),
        )))
        .build()
        .unwrap();
    let velocity = random_vectors(count, 1.0, 3);
    model
        .set_initial(&vec![Vec3::zeros(); count], &velocity)
        .unwrap();
    let momentum = |model: &Model| -> Vec3 {
        (0..count as u32)
            .map(|n| model.velocity(n) * model.mass(n))
            .sum()
    };
    let before = momentum(&model);
    steps(&mut model, 500, 1e-5);
    let gained = momentum(&model) - before;
    assert!((gained - force * (500.0 * 1e-5)).norm() < 1e-11 * before.norm());
}

/// The same bits for 1, 2 and 4 threads, with impedances, loads, ties, damping and supports.
#[test]
fn threads_do_not_change_a_bit() {
    same_bits_over_threads(everything);
}

fn everything(threads: usize, precision: Precision) -> State {
    let mesh = hex_box([9, 8, 7], 1.0, 0.2);
    let mut model = with_everything(&mesh, precision)
        .threads(threads)
        .block_size(32)
        .build()
        .unwrap();
    let count = mesh.node_count();
    let mut velocity = random_vectors(count, 1e-3, 9);
    for (a, b) in pairs(&mesh).pairs {
        velocity[b as usize] = velocity[a as usize];
    }
    model
        .set_initial(&random_vectors(count, 1e-6, 8), &velocity)
        .unwrap();
    model.begin_stage();
    steps(&mut model, 200, 1e-5);
    model.state()
}

fn pairs(mesh: &Mesh) -> PeriodicPairs {
    let set = |name| mesh.node_set(name).unwrap();
    PeriodicPairs::by_translation(mesh, set("y0"), set("y1"), 1e-9).unwrap()
}

fn with_everything(mesh: &Mesh, precision: Precision) -> powerhouse_model::ModelSpec<'_> {
    let set = |name| mesh.node_set(name).unwrap().to_vec();
    let impedance = set("x0").into_iter().map(|node| {
        NodalImpedance::new(
            node,
            Mat3::new(3e8, 1e7, 0.0, 1e7, 2e8, 0.0, 0.0, 0.0, 1e8),
            Mat3::from_diagonal(&Vec3::new(5e6, 3e6, 3e6)),
        )
    });
    Model::builder(mesh)
        .elements(
            "rock",
            rock().damped(2.0, 1e-6).precision(precision).boxed(),
        )
        .periodic(pairs(mesh))
        .support(Support::roller(set("z0"), Vec3::new(0.0, 0.1, 1.0)))
        .gravity(
            Vec3::new(0.1, 0.0, -1.0),
            Box::new(|t: f64| (50.0 * t).sin()),
        )
        .boundary(powerhouse_model::BoundaryParts::default().with_impedance(impedance))
}

/// A run that is interrupted, exported and continued in another model has the bits of one that was
/// not.
#[test]
fn a_continued_run_has_the_same_bits() {
    let mesh = hex_box([6, 4, 4], 1.0, 0.2);
    let build = || {
        with_everything(&mesh, Precision::F64)
            .block_size(16)
            .build()
            .unwrap()
    };
    // Springs are measured from the random displacement at the start: the state must carry it.
    let start = |model: &mut Model| {
        let still = vec![Vec3::zeros(); mesh.node_count()];
        let displacement = random_vectors(mesh.node_count(), 1e-5, 3);
        model.set_initial(&displacement, &still).unwrap();
        model.begin_stage();
    };
    let mut whole = build();
    start(&mut whole);
    steps(&mut whole, 300, 1e-5);
    let mut first = build();
    start(&mut first);
    steps(&mut first, 100, 1e-5);
    let mut second = build();
    second.set_state(&first.state()).unwrap();
    steps(&mut second, 200, 1e-5);
    assert_eq!(whole.state(), second.state());
}

/// Half a model behind a mirror (rollers on the plane of symmetry) moves like the whole one, and
/// so does a period of a periodic row.
#[test]
fn mirror_and_period_stand_for_the_rest() {
    let h = 1.0;
    let load = |mesh: &Mesh, x: f64| {
        let nodes: Vec<u32> = (0..mesh.node_count() as u32)
            .filter(|&n| {
                let p = mesh.positions()[n as usize];
                (p.x - x).abs() < 1e-9 && p.z > 2.9
            })
            .collect();
        nodes
    };
    let pull = |nodes: Vec<u32>, force: f64| {
        Box::new(NodalForce::new(
            nodes,
            Vec3::new(0.0, 0.0, force),
            Box::new(|t: f64| (300.0 * t).sin()),
        ))
    };
    let whole_mesh = hex_box([8, 2, 3], h, 0.0);
    let set = |mesh: &Mesh, name: &str| mesh.node_set(name).unwrap().to_vec();
    let mut whole = Model::builder(&whole_mesh)
        .elements("rock", rock().boxed())
        .support(Support::roller(set(&whole_mesh, "z0"), Vec3::z()))
        .support(Support::roller(set(&whole_mesh, "x0"), Vec3::x()))
        .support(Support::roller(set(&whole_mesh, "x1"), Vec3::x()))
        .load(pull(load(&whole_mesh, 4.0), 2.0e5))
        .build()
        .unwrap();
    let half_mesh = hex_box([4, 2, 3], h, 0.0);
    let mut half = Model::builder(&half_mesh)
        .elements("rock", rock().boxed())
        .support(Support::roller(set(&half_mesh, "z0"), Vec3::z()))
        .support(Support::roller(set(&half_mesh, "x0"), Vec3::x()))
        .support(Support::roller(set(&half_mesh, "x1"), Vec3::x()))
        .load(pull(load(&half_mesh, 4.0), 1.0e5))
        .build()
        .unwrap();
    // Two mirrored halves make a period; the loads at x = 0 and x = 8 are one and the same node.
    let mut period = Model::builder(&whole_mesh)
        .elements("rock", rock().boxed())
        .support(Support::roller(set(&whole_mesh, "z0"), Vec3::z()))
        .periodic(
            PeriodicPairs::by_translation(
                &whole_mesh,
                &set(&whole_mesh, "x0"),
                &set(&whole_mesh, "x1"),
                1e-9,
            )
            .unwrap(),
        )
        .load(pull(load(&whole_mesh, 4.0), 2.0e5))
        .build()
        .unwrap();
    for model in [&mut whole, &mut half, &mut period] {
        steps(model, 400, 2e-5);
    }
    let scale = whole.displacement(load(&whole_mesh, 4.0)[0]).norm();
    assert!(scale > 1e-7);
    for (n, p) in half_mesh.positions().iter().enumerate() {
        let same = whole_mesh
            .positions()
            .iter()
            .position(|q| (q - p).norm() < 1e-9);
        let node = same.unwrap() as u32;
        let u = half.displacement(n as u32);
        assert!((u - whole.displacement(node)).norm() < 1e-11 * scale);
        assert!((u - period.displacement(node)).norm() < 1e-11 * scale);
    }
}

/// Rollers along axes leave the motion what supports of any other kind make of it, loaded and damped
/// as it may be, and nothing moves along them, whatever a state says.
#[test]
fn rollers_along_axes_move_as_other_supports_do() {
    let mesh = hex_box([6, 4, 4], 1.0, 0.2);
    let set = |name| mesh.node_set(name).unwrap().to_vec();
    let build = |impedance: Vec<NodalImpedance>| {
        let boundary = powerhouse_model::BoundaryParts::default().with_impedance(impedance);
        let weight = Vec3::new(3.0, 1.0, -9.0);
        Model::builder(&mesh)
            .elements("rock", rock().damped(20.0, 0.0).boxed())
            .support(Support::roller(set("x0"), Vec3::new(-2.0, 0.0, 0.0)))
            .support(Support::roller(set("z0"), Vec3::z()))
            .support(Support::fixed(vec![set("y1")[0]]))
            .gravity(weight, Box::new(|t: f64| (300.0 * t).sin()))
            .boundary(boundary)
            .build()
            .unwrap()
    };
    // A dashpot too small to be felt makes them supports among others.
    let dashpot = Mat3::identity() * 1e-280;
    let felt = [set("x0"), set("z0"), vec![set("y1")[0]]].concat();
    let mut felt = felt;
    felt.sort_unstable();
    felt.dedup();
    let impedance = felt
        .into_iter()
        .map(|node| NodalImpedance::new(node, Mat3::zeros(), dashpot));
    let (mut lean, mut other) = (build(Vec::new()), build(impedance.collect()));
    let corner = set("z0")[3];
    let mut state = lean.state();
    state.velocity = random_vectors(mesh.node_count(), 1e-3, 5);
    let mut accelerations = Vec::new();
    for model in [&mut lean, &mut other] {
        model.set_state(&state).unwrap();
        let (observer, rows) = probe(corner);
        let options = RunOptions::steps(300)
            .with_step(StepChoice::Unchecked(1e-5))
            .with_speed_limit(1e9);
        run(model, &Leapfrog, &options, &mut [observer], &mut |_| {}).unwrap();
        accelerations.push(rows.iter().last().unwrap());
    }
    let scale = (0..mesh.node_count() as u32).map(|node| other.displacement(node).amax());
    let scale = scale.fold(0.0, f64::max);
    assert!(scale > 1e-6);
    for node in 0..mesh.node_count() as u32 {
        let (u, v) = (lean.displacement(node), lean.velocity(node));
        assert!((u - other.displacement(node)).amax() < 1e-12 * scale);
        assert!((v - other.velocity(node)).amax() < 1e-12 * scale / 1e-5);
    }
    for node in set("x0") {
        assert_eq!(
            (lean.displacement(node).x, lean.velocity(node).x),
            (0.0, 0.0)
        );
    }
    for node in set("z0") {
        assert_eq!(
            (lean.displacement(node).z, lean.velocity(node).z),
            (0.0, 0.0)
        );
    }
    let [a, b] = [accelerations[0], accelerations[1]].map(|row| Vec3::new(row[7], row[8], row[9]));
    assert!(
        a.norm() > 0.1 && (a - b).norm() < 1e-9 * a.norm(),
        "{a} {b}"
    );
    assert_eq!(a.z, 0.0);
}

/// Nodes on an oblique roller stay in their plane, and a rigid block slides down it with
/// `g sin(angle)`.
#[test]
fn a_block_slides_down_an_oblique_roller() {
    let mesh = hex_box([2, 2, 2], 1.0, 0.1);
    let angle = 0.5_f64;
    let normal = Vec3::new(angle.sin(), 0.0, angle.cos());
    let down = Vec3::new(angle.cos(), 0.0, -angle.sin());
    let all: Vec<u32> = (0..mesh.node_count() as u32).collect();
    let mut model = Model::builder(&mesh)
        .elements("rock", rock().boxed())
        .support(Support::roller(all.clone(), normal * 3.0))
        .gravity(Vec3::new(0.0, 0.0, -10.0), Box::new(|_: f64| 1.0))
        .build()
        .unwrap();
    let (step, count) = (1e-4, 1000);
    steps(&mut model, count, step);
    let distance = 10.0 * angle.sin() * step * step * (count * (count + 1)) as f64 / 2.0;
    for node in all {
        let u = model.displacement(node);
        assert!(u.dot(&normal).abs() < 1e-14);
        assert!((u - down * distance).norm() < 1e-12);
    }
}

/// A prescribed displacement along an oblique direction is met at every step while the node stays
/// free across it.
#[test]
fn a_prescribed_motion_is_met() {
    let mesh = hex_box([3, 3, 3], 1.0, 0.2);
    let nodes = mesh.node_set("z0").unwrap().to_vec();
    let direction = Vec3::new(1.0, 2.0, 2.0) / 3.0;
    let history = |t: f64| 1e-3 * (1.0 - (200.0 * t).cos());
    let mut model = Model::builder(&mesh)
        .elements("rock", rock().boxed())
        .prescribed(Prescribed {
            nodes: nodes.clone(),
            direction: direction * 5.0,
            displacement: Box::new(history),
        })
        .build()
        .unwrap();
    for _ in 0..20 {
        steps(&mut model, 17, 2e-5);
        for &node in &nodes {
            let along = model.displacement(node).dot(&direction);
            assert!((along - history(model.time())).abs() < 1e-16);
        }
    }
    let across = |n: &u32| {
        let u = model.displacement(*n);
        (u - direction * u.dot(&direction)).norm()
    };
    assert!(nodes.iter().map(across).fold(0.0, f64::max) > 1e-6);
}

/// A body that moves as its base does from the start goes on so, without a force: the velocity that it is given at nodes with
/// prescribed motion counts.
#[test]
fn a_body_that_moves_with_its_base_is_not_accelerated() {
    let mesh = hex_box([3, 2, 2], 1.0, 0.2);
    let nodes = mesh.node_set("z0").unwrap().to_vec();
    let speed = 0.3;
    for direction in [Vec3::z(), Vec3::new(1.0, 2.0, 2.0) / 3.0] {
        let mut model = Model::builder(&mesh)
            .elements("rock", rock().boxed())
            .prescribed(Prescribed {
                nodes: nodes.clone(),
                direction,
                displacement: Box::new(move |t: f64| speed * t),
            })
            .build()
            .unwrap();
        let count = mesh.node_count();
        let moving = vec![direction * speed; count];
        model
            .set_initial(&vec![Vec3::zeros(); count], &moving)
            .unwrap();
        let (observer, rows) = probe(nodes[0]);
        let options = RunOptions::steps(40).with_step(StepChoice::Fixed(2e-5));
        let mut observers = [observer];
        run(&mut model, &Leapfrog, &options, &mut observers, &mut |_| {}).unwrap();
        drop(observers);
        let rows: Vec<_> = rows.iter().collect();
        assert_eq!(rows.len(), 40);
        for [t, _, _, _, vx, vy, vz, ax, ay, az] in rows {
            let off = Vec3::new(vx, vy, vz) - direction * speed;
            assert!(off.norm() < 1e-12, "{t}: {off}");
            assert!(Vec3::new(ax, ay, az).norm() < 1e-6, "{t}: {ax} {ay} {az}");
        }
    }
}

/// Where a joint cuts periodic faces, two nodes stand at one place: each is tied to the one on its own
/// side of the joint.
#[test]
fn ties_keep_to_their_side_of_a_joint() {
    let size = Vec3::new(2.0, 3.0, 2.0);
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), size, [2, 3, 2], "rock").unwrap();
    let part = |mesh: &Mesh, below: bool| -> Vec<u32> {
        let elements = 0..mesh.element_count() as u32;
        let inside = |&e: &u32| (mesh.centroid(e).z < 1.0) == below;
        elements.filter(inside).collect()
    };
    let mesh = mesh.split_between(&part(&mesh, true), &part(&mesh, false));
    let mesh = mesh.unwrap().mesh;
    let at = |y: f64| -> Vec<u32> {
        let nodes = 0..mesh.node_count() as u32;
        nodes
            .filter(|&n| mesh.positions()[n as usize].y == y)
            .collect()
    };
    let ties = PeriodicPairs::by_translation(&mesh, &at(0.0), &at(3.0), 1e-9).unwrap();
    let lower = mesh.nodes_of_elements(&part(&mesh, true));
    assert_eq!(ties.pairs.len(), 12);
    for &(from, to) in &ties.pairs {
        let offset = mesh.positions()[to as usize] - mesh.positions()[from as usize];
        assert!((offset - Vec3::new(0.0, 3.0, 0.0)).norm() < 1e-12);
        assert_eq!(lower.contains(&from), lower.contains(&to), "{from} {to}");
    }
}
