//! The engine with its own kernels: stable step, bits, energy, waves.

use crate::support::{dense, dense_limit, noise, random_vectors};
use nalgebra::DVector;
use powerhouse_elements::SolidKernel;
use powerhouse_explicit_core::{BuildModel, Leapfrog, Model, run};
use powerhouse_model::{
    BlockFactory, BlockOptions, BlockPart, BoundaryParts, ConstitutiveLaw, ElasticMedium,
    EnergyCheck, HistoryVariable, Lane, LaneWidth, LawInput, Mat3, Mesh, NodalImpedance, Precision,
    Rayleigh, RunError, RunOptions, State, StepChoice, Stress, Support, Vec3,
};

#[derive(Clone)]
struct Linear(ElasticMedium);

impl ConstitutiveLaw for Linear {
    const LINEAR: bool = true;

    fn name(&self) -> &str {
        "linear"
    }
    fn medium(&self) -> ElasticMedium {
        self.0
    }
    fn history(&self) -> &'static [HistoryVariable] {
        &[]
    }
    fn stress_change<L: Lane>(&self, input: &LawInput<L>, _new_history: &mut [L]) -> Stress<L> {
        let one = input.strain.0[0].constant(1.0);
        let (lambda, shear) = (one.constant(self.0.lambda()), one.constant(self.0.shear()));
        Stress::elastic(lambda, shear, &input.strain)
    }
}

fn rock() -> Linear {
    Linear(ElasticMedium::new(9.0e9, 0.27, 2750.0).unwrap())
}

/// A box of 1 m cells whose inner nodes are shifted by up to `jitter` metres.
fn jittered(
    make: fn(Vec3, Vec3, [usize; 3], &str) -> Result<Mesh, powerhouse_model::MeshError>,
    cells: [usize; 3],
    jitter: f64,
) -> Mesh {
    let high = Vec3::new(cells[0] as f64, cells[1] as f64, cells[2] as f64);
    let mesh = make(Vec3::zeros(), high, cells, "rock").unwrap();
    let inside = |p: &Vec3| (0..3).all(|c| p[c] > 1e-9 && p[c] < high[c] - 1e-9);
    let seed = |p: &Vec3| (p.x + 50.0 * p.y + 2500.0 * p.z).round() as u64;
    let shift = |p: Vec3| {
        if inside(&p) {
            p + Vec3::from_fn(|c, _| jitter * noise(3 * seed(&p) + c as u64))
        } else {
            p
        }
    };
    mesh.map_positions(shift).unwrap()
}

/// The reported step lies between 0.95 and 1.000 of the true limit for every kernel on distorted
/// meshes, and the least bound of a single element does not lie above it. From random velocities a
/// run at the reported step stays bounded; one at 1.01 of the true limit, the dense eigenvalue of
/// the same model, is stopped, naming the step, a node, and of the elements at it the one with the highest bound.
#[test]
fn the_reported_step_is_just_below_the_true_limit_for_every_kernel() {
    let options = BlockOptions::default();
    let hexes = jittered(Mesh::box_of_hexes, [4, 4, 3], 0.3);
    let wedges = jittered(Mesh::box_of_wedges, [3, 3, 3], 0.2);
    let tets = jittered(Mesh::box_of_tets, [3, 3, 3], 0.15);
    let pyramids = jittered(Mesh::box_of_pyramids, [3, 3, 2], 0.15);
    let tens = jittered(Mesh::box_of_tets, [3, 2, 2], 0.15)
        .with_midpoints()
        .unwrap();
    let cases: [(&Mesh, Box<dyn BlockFactory>); 7] = [
        (
            &hexes,
            SolidKernel::ONE_POINT.factory("rock", rock(), options),
        ),
        (
            &hexes,
            SolidKernel::Hex8Full.factory("rock", rock(), options),
        ),
        (
            &hexes,
            SolidKernel::Hex8BBar.factory("rock", rock(), options),
        ),
        (
            &wedges,
            SolidKernel::Wedge6.factory("rock", rock(), options),
        ),
        (&tets, SolidKernel::Tet4.factory("rock", rock(), options)),
        (
            &pyramids,
            SolidKernel::Pyramid5.factory("rock", rock(), options),
        ),
        (&tens, SolidKernel::Tet10.factory("rock", rock(), options)),
    ];
    for (i, (mesh, factory)) in cases.into_iter().enumerate() {
        mesh.check().unwrap();
        let all: Vec<u32> = (0..mesh.element_count() as u32).collect();
        let truth = dense_limit(mesh, factory.as_ref(), &all, &[]);
        let count = mesh.node_count();
        let nodes: Vec<u32> = (0..count as u32).collect();
        let block = factory.build(&BlockPart::new(mesh, &all, &nodes)).unwrap();
        let bounds = block.frequency_bounds();
        let mut model = Model::builder(mesh)
            .elements("rock", factory)
            .build()
            .unwrap();
        let report = model.stable_step(&Leapfrog).unwrap();
        let share = report.step / truth;
        assert!((0.95..=1.0).contains(&share), "case {i}: {share}");
        assert!(report.element_bound <= truth * (1.0 + 1e-9), "case {i}");

        let shaken = || random_vectors(count, 1.0, 5);
        let rest = vec![Vec3::zeros(); count];
        model.set_initial(&rest, &shaken()).unwrap();
        let options = RunOptions::steps(20_000);
        run(&mut model, &Leapfrog, &options, &mut [], &mut |_| {}).unwrap();
        let nodes = 0..count as u32;
        let fastest = nodes.map(|node| model.velocity(node).norm());
        assert!(fastest.fold(0.0, f64::max) < 20.0, "case {i}");
        model.set_initial(&rest, &shaken()).unwrap();
        let options = options.with_step(StepChoice::Unchecked(1.01 * truth));
        let error = run(&mut model, &Leapfrog, &options, &mut [], &mut |_| {}).unwrap_err();
        let RunError::Diverged {
            element, set, node, ..
        } = error
        else {
            panic!("case {i}: {error}");
        };
        assert_eq!(set, "rock", "case {i}");
        let has_node = |&n: &u32| mesh.node_tags()[n as usize] == node;
        let at_node = bounds
            .iter()
            .filter(|bound| mesh.nodes_of(bound.element).iter().any(has_node));
        let highest = at_node.clone().map(|bound| bound.frequency);
        let highest = highest.fold(0.0, f64::max);
        // Several elements may have the same bound.
        let mut worst = at_node.filter(|bound| bound.frequency >= highest * (1.0 - 1e-12));
        let is_named = worst.any(|bound| mesh.element_tags()[bound.element as usize] == element);
        assert!(is_named, "case {i}: {element}");
    }
}

/// A damped box with impedances and a support.
fn damped_box(mesh: &Mesh, precision: Precision, lanes: LaneWidth, threads: usize) -> Model {
    let mut options = BlockOptions::default();
    options.precision = precision;
    options.lanes = lanes;
    options.damping = Rayleigh {
        mass: 3.0,
        stiffness: 2e-5,
    };
    let nodes = |set: &str| mesh.nodes_of_facets(mesh.facet_set(set).unwrap());
    let impedance = nodes("bottom")
        .into_iter()
        .map(|node| NodalImpedance::new(node, Mat3::identity() * 1e8, Mat3::identity() * 1e6));
    let mut model = Model::builder(mesh)
        .elements(
            "rock",
            SolidKernel::ONE_POINT.factory("rock", rock(), options),
        )
        .support(Support::roller(nodes("left"), Vec3::x()))
        .gravity(
            Vec3::new(0.0, 1.0, -9.81),
            Box::new(|t: f64| (300.0 * t).sin()),
        )
        .boundary(BoundaryParts::default().with_impedance(impedance))
        .threads(threads)
        .block_size(40)
        .build()
        .unwrap();
    let count = mesh.node_count();
    let velocity = random_vectors(count, 1e-3, 1);
    model
        .set_initial(&vec![Vec3::zeros(); count], &velocity)
        .unwrap();
    model
}

/// The same bits for lanes of one element and of many, and for one, two and four threads, in every
/// precision.
#[test]
fn lanes_and_threads_do_not_change_a_bit() {
    let mesh = jittered(Mesh::box_of_hexes, [7, 6, 5], 0.25);
    for precision in [Precision::F64, Precision::Mixed, Precision::F32] {
        let go = |lanes, threads| -> State {
            let mut model = damped_box(&mesh, precision, lanes, threads);
            let options = RunOptions::steps(100).with_step(StepChoice::Unchecked(5e-5));
            run(&mut model, &Leapfrog, &options, &mut [], &mut |_| {}).unwrap();
            model.state()
        };
        let reference = go(LaneWidth::One, 1);
        assert!(reference.displacement.iter().any(|u| u.norm() > 1e-7));
        for (lanes, threads) in [
            (LaneWidth::Native, 1),
            (LaneWidth::One, 2),
            (LaneWidth::Native, 4),
        ] {
            assert_eq!(
                reference,
                go(lanes, threads),
                "{precision:?} {lanes:?} {threads}"
            );
        }
    }
}

/// The ledger of a damped box closes in every precision to what that precision allows.
#[test]
fn the_ledger_closes_in_every_precision() {
    let mesh = jittered(Mesh::box_of_hexes, [3, 3, 3], 0.25);
    for (precision, limit) in [
        (Precision::F64, 1e-12),
        (Precision::Mixed, 1e-5),
        (Precision::F32, 1e-4),
    ] {
        let mut model = damped_box(&mesh, precision, LaneWidth::Native, 1);
        let options = RunOptions::steps(5_000).with_energy(EnergyCheck::every(100));
        let report = run(&mut model, &Leapfrog, &options, &mut [], &mut |_| {}).unwrap();
        let column = |name| report.energies.iter().find(|(c, _)| *c == name).unwrap().1;
        assert!(column("stiffness damping") > 0.0 && column("hourglass") > 0.0);
        assert!(
            report.energy_residual < limit,
            "{precision:?}: {}",
            report.energy_residual
        );
    }
}

/// The internal energy of which the work of hourglass resistance is a share is all that a set stores, bending included:
/// `u K u / 2` of its dense stiffness.
#[test]
fn hourglass_resistance_has_a_share_of_all_that_is_stored() {
    let hexes = jittered(Mesh::box_of_hexes, [3, 2, 2], 0.2);
    let pyramids = jittered(Mesh::box_of_pyramids, [2, 2, 2], 0.15);
    for (mesh, kernel) in [
        (&hexes, SolidKernel::Hex8Natural),
        (&hexes, SolidKernel::ONE_POINT),
        (&hexes, SolidKernel::Hex8Full),
        (&pyramids, SolidKernel::Pyramid5),
    ] {
        let factory = kernel.factory("rock", rock(), BlockOptions::default());
        let all: Vec<u32> = (0..mesh.element_count() as u32).collect();
        let (stiffness, _) = dense(mesh, factory.as_ref(), &all);
        let mut model = Model::builder(mesh)
            .elements("rock", factory)
            .build()
            .unwrap();
        let count = mesh.node_count();
        let moved = random_vectors(count, 1e-3, 9);
        let rest = vec![Vec3::zeros(); count];
        model.set_initial(&moved, &rest).unwrap();
        let shares = model.hourglass_shares();
        let moved = moved.iter().flat_map(|u| u.iter().copied());
        let moved = DVector::from_iterator(3 * count, moved);
        let stored = 0.5 * moved.dot(&(&stiffness * &moved));
        let off = (shares[0].internal / stored - 1.0).abs();
        assert!(off < 1e-10, "{}: {off:e}", kernel.name());
    }
}

/// A P wave runs up a column of cubes between rollers at the speed of the medium: the top of the
/// front arrives after `L / c_p` to within the spread that the mesh gives a smooth ramp.
#[test]
fn a_wave_in_a_column_arrives_at_its_speed() {
    let (count, h) = (100, 1.0);
    let mesh = Mesh::box_of_hexes(
        Vec3::zeros(),
        Vec3::new(1.0, 1.0, count as f64 * h),
        [1, 1, count],
        "rock",
    )
    .unwrap();
    let nodes = |set: &str| mesh.nodes_of_facets(mesh.facet_set(set).unwrap());
    let speed = rock().0.p_speed();
    // 20 elements long, so that dispersion stays small.
    let rise = 20.0 * h / speed;
    let ramp = move |t: f64| {
        let x = (t / rise).clamp(0.0, 1.0);
        1e-3 * x * x * x * (10.0 - 15.0 * x + 6.0 * x * x)
    };
    let options = BlockOptions::default();
    let mut model = Model::builder(&mesh)
        .elements(
            "rock",
            SolidKernel::ONE_POINT.factory("rock", rock(), options),
        )
        .support(Support::roller(nodes("left"), Vec3::x()))
        .support(Support::roller(nodes("right"), Vec3::x()))
        .support(Support::roller(nodes("front"), Vec3::y()))
        .support(Support::roller(nodes("back"), Vec3::y()))
        .prescribed(powerhouse_model::Prescribed {
            nodes: nodes("bottom"),
            direction: Vec3::z(),
            displacement: Box::new(ramp),
        })
        .build()
        .unwrap();
    let options = RunOptions::seconds(90.0 * h / speed);
    run(&mut model, &Leapfrog, &options, &mut [], &mut |_| {}).unwrap();
    let time = model.time();
    for node in 0..mesh.node_count() as u32 {
        let height = mesh.positions()[node as usize].z;
        let exact = ramp(time - height / speed);
        // Second order: the error of a wave of 20 elements after 90 elements is a few per mille.
        assert!((model.displacement(node).z - exact).abs() < 5e-3 * 1e-3);
    }
}

/// A law that counts how often its history was committed.
#[derive(Clone)]
struct Counter(ElasticMedium);

impl ConstitutiveLaw for Counter {
    fn name(&self) -> &str {
        "counter"
    }
    fn medium(&self) -> ElasticMedium {
        self.0
    }
    fn history(&self) -> &'static [HistoryVariable] {
        const { &[HistoryVariable::amount("commits", "1")] }
    }
    fn stress_change<L: Lane>(&self, input: &LawInput<L>, new_history: &mut [L]) -> Stress<L> {
        new_history[0] = input.history[0] + input.history[0].constant(1.0);
        Linear(self.0).stress_change(input, &mut [])
    }
}

/// The history of a law is committed once per step, exported with the state by element of the
/// mesh, and taken over by another model.
#[test]
fn history_is_committed_once_per_step() {
    let mesh = jittered(Mesh::box_of_hexes, [5, 3, 2], 0.2);
    let build = |part| {
        let law = Counter(rock().0);
        let factory = SolidKernel::ONE_POINT.factory("rock", law, BlockOptions::default());
        let builder = Model::builder(&mesh).elements("rock", factory);
        builder.block_size(part).build().unwrap()
    };
    let options = RunOptions::steps(7).with_step(StepChoice::Unchecked(5e-5));
    let go = |model: &mut Model| run(model, &Leapfrog, &options, &mut [], &mut |_| {}).unwrap();
    let mut first = build(8);
    go(&mut first);
    let mut second = build(11);
    second.set_state(&first.state()).unwrap();
    go(&mut second);
    for (mut model, commits) in [(first, 7.0), (second, 14.0)] {
        let state = model.state();
        assert_eq!(state.history.len(), 1);
        let field = &state.history[0];
        let mut elements = field.elements.clone();
        elements.sort_unstable();
        assert_eq!(
            elements,
            (0..mesh.element_count() as u32).collect::<Vec<_>>()
        );
        assert_eq!((field.name.as_str(), field.points), ("commits", 1));
        assert!(field.values.iter().all(|&value| value == commits));
    }
}
