//! Models on several ranks: how runs end, what is refused, and what is sent.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, LazyLock, Mutex};
use std::time::{Duration, Instant};

use crate::support::hex_box;
use powerhouse_elements::{NodalForce, SolidKernel};
use powerhouse_explicit_core::{BuildModel, ExplicitOnRanks, Leapfrog, RankModel, Traffic, run};
use powerhouse_model::{
    BlockOptions, Cadence, ConstitutiveLaw, Constraint, ConstraintParts, ConstraintWork,
    DividedConstraint, ElasticMedium, Ended, EnergyCheck, Engine, Fields, Flow, HistoryVariable,
    Lane, LawInput, Linearisation, Mesh, ModelError, ModelSpec, Observer, PredictedMotion,
    RankError, Reach, RunError, RunOptions, SingleRank, StaticError, StaticMethod, StaticOptions,
    StepView, Stress, Support, ThreadRanks, Vec3,
};

/// Time within which a failure must be known to all ranks.
const SOON: Duration = Duration::from_secs(30);

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
        let (lambda, shear) = (self.0.lambda(), self.0.shear());
        Stress::elastic(one.constant(lambda), one.constant(shear), &input.strain)
    }
}

/// Linear elasticity whose stress is not a number in some elements (user's numbers), from a step on.
#[derive(Clone)]
struct Fragile(Linear, Vec<u64>, f64);

impl ConstitutiveLaw for Fragile {
    fn name(&self) -> &str {
        "fragile"
    }
    fn medium(&self) -> ElasticMedium {
        self.0.medium()
    }
    fn history(&self) -> &[HistoryVariable] {
        &[const { HistoryVariable::amount("steps", "1") }]
    }
    fn uses_location(&self) -> bool {
        true
    }
    fn stress_change<L: Lane>(&self, input: &LawInput<L>, new_history: &mut [L]) -> Stress<L> {
        let steps = input.history[0] + input.history[0].constant(1.0);
        new_history[0] = steps;
        let fails = |lane: usize| {
            let element = input.elements()[lane];
            self.1.contains(&element) && steps.extract(lane) > self.2
        };
        let failed = |lane| if fails(lane) { f64::NAN } else { 0.0 };
        let failed = L::build(steps.token(), failed);
        Stress(self.0.stress_change(input, &mut []).0.map(|s| s + failed))
    }
}

/// Constraint on some nodes that changes nothing, and fails at a step.
struct Failing {
    name: String,
    nodes: Vec<u32>,
    at: u64,
    parts: Option<ConstraintParts>,
}

impl Constraint for Failing {
    fn name(&self) -> &str {
        &self.name
    }
    fn nodes(&self) -> &[u32] {
        &self.nodes
    }
    fn divided(&self) -> Option<&dyn DividedConstraint> {
        self.parts.as_ref().map(|_| self as &dyn DividedConstraint)
    }
    fn correct(&mut self, motion: PredictedMotion) -> Result<ConstraintWork, RunError> {
        if motion.number < self.at {
            return Ok(ConstraintWork::default());
        }
        Err(RunError::Constraint {
            name: self.name.clone(),
            step: motion.number,
            reason: "it was to fail".into(),
        })
    }
}

impl DividedConstraint for Failing {
    fn parts(&self) -> ConstraintParts {
        self.parts.clone().unwrap_or_default()
    }
}

/// A box of 120 bricks.
fn mesh() -> &'static Mesh {
    static BOX: LazyLock<Mesh> = LazyLock::new(|| hex_box([10, 4, 3], 1.0, 0.2));
    &BOX
}

/// A box on its base, pushed at its far end, in 15 blocks or more.
fn spec(mesh: &Mesh) -> ModelSpec<'_> {
    let law = Linear(ElasticMedium::new(9.0e9, 0.27, 2750.0).unwrap());
    let rock = SolidKernel::ONE_POINT.factory("rock", law, BlockOptions::default());
    let end = mesh.node_set("x1").unwrap().to_vec();
    let push = NodalForce::new(end, 1e5 * Vec3::z(), Box::new(|t: f64| (900.0 * t).sin()));
    ModelSpec::new(mesh)
        .elements("rock", rock)
        .support(Support::fixed(mesh.node_set("z0").unwrap().to_vec()))
        .load(Box::new(push))
        .block_size(8)
}

/// The error of a run on each of some ranks.
fn errors<'m>(
    ranks: usize,
    spec: &(impl Fn() -> ModelSpec<'m> + Sync),
    options: &(impl Fn(usize) -> RunOptions + Sync),
) -> Vec<String> {
    let found = ThreadRanks::run(ranks, |ranks| {
        let mut model = RankModel::build(spec(), Box::new(ranks)).unwrap();
        let options = options(model.rank());
        let failed = model.run(&Leapfrog, &options, &mut [], &mut |_| {});
        Ok(failed.unwrap_err().error.to_string())
    });
    found.into_iter().map(|error| error.unwrap()).collect()
}

/// On one rank a model is the model without ranks: the same bits, nothing sent, and nothing refused.
#[test]
fn one_rank_is_a_model_without_ranks() {
    struct Count(Arc<AtomicBool>);
    impl Observer for Count {
        fn name(&self) -> &str {
            "count"
        }
        fn fields(&self) -> Fields {
            Fields::default()
        }
        fn cadence(&self) -> Cadence {
            Cadence::Steps(1)
        }
        fn observe(&mut self, _view: &dyn StepView) -> Result<Flow, ModelError> {
            self.0.store(true, Ordering::Relaxed);
            Ok(Flow::Continue)
        }
    }
    let mesh = mesh();
    let options = RunOptions::steps(40).with_profile(true);
    let mut alone = spec(mesh).build().unwrap();
    let expected = run(&mut alone, &Leapfrog, &options, &mut [], &mut |_| {}).unwrap();
    let seen = Arc::new(AtomicBool::new(false));
    let mut observers: Vec<Box<dyn Observer>> = vec![Box::new(Count(seen.clone()))];
    let mut model = RankModel::build(spec(mesh), Box::new(SingleRank)).unwrap();
    let found = model.run(&Leapfrog, &options, &mut observers, &mut |_| {});
    assert_eq!(found.unwrap().step, expected.step);
    assert!(seen.load(Ordering::Relaxed));
    assert_eq!(model.traffic(), Traffic::default());
    assert_eq!((model.rank(), model.rank_count()), (0, 1));
    for node in 0..mesh.node_count() as u32 {
        assert_eq!(model.displacement(node), Some(alone.displacement(node)));
        assert_eq!(model.velocity(node), Some(alone.velocity(node)));
    }
    assert!(alone.displacement(mesh.node_count() as u32 - 1).norm() > 1e-9);
}

/// More ranks than blocks, blocks whose constraint cannot be divided, and ranks with other meshes are refused on all ranks.
#[test]
fn models_that_ranks_cannot_share_are_refused_on_all() {
    let mesh = mesh();
    let other: &'static Mesh = Box::leak(Box::new(hex_box([10, 4, 4], 1.0, 0.2)));
    let refusals = |count: usize, spec: &(dyn Fn(usize) -> ModelSpec<'static> + Sync)| {
        let found = ThreadRanks::run(count, |ranks| {
            let spec = spec(powerhouse_model::Ranks::rank(&ranks));
            Ok(RankModel::build(spec, Box::new(ranks))
                .unwrap_err()
                .to_string())
        });
        found
            .into_iter()
            .map(|error| error.unwrap())
            .collect::<Vec<_>>()
    };
    let found = refusals(5, &|_| spec(mesh).block_size(60));
    let remedy = "5 ranks need as many blocks of elements, and there are 2: take 2 ranks at most (in Rust, a block size of 29 elements or less gives enough blocks)";
    for error in found {
        assert!(error.contains(remedy), "{error}");
    }
    let ends = |mesh: &Mesh| {
        let ends = ["x0", "x1"].map(|set| mesh.node_set(set).unwrap()[5]);
        Box::new(Failing {
            name: "far apart".into(),
            nodes: ends.to_vec(),
            at: u64::MAX,
            parts: Some(ConstraintParts::merged([&ends[..1], &ends[1..]])),
        })
    };
    let found = refusals(3, &|_| spec(mesh).constraint(ends(mesh)));
    for error in &found {
        let named = error.contains("constraint 'far apart'") && error.contains("3 ranks");
        assert!(named, "{error}");
    }
    let found = refusals(3, &|rank| spec(if rank == 1 { other } else { mesh }));
    for error in found {
        assert!(error.contains("differs between the ranks"), "{error}");
    }
}

/// Options of a run that several ranks do not support are refused by name, and ranks with other options too.
#[test]
fn runs_that_ranks_do_not_support_are_refused_by_name() {
    let mesh = mesh();
    let glued = || {
        spec(mesh).constraint(Box::new(Failing {
            name: "glue".into(),
            nodes: vec![0, 1],
            at: u64::MAX,
            parts: Some(ConstraintParts::merged([&[0][..], &[1]])),
        }))
    };
    let steps = || RunOptions::steps(3);
    for (what, options) in [
        ("a profile", steps().with_profile(true)),
        (
            "an energy balance with a constraint that does not divide its work",
            steps().with_energy(EnergyCheck::every(1)),
        ),
    ] {
        let found = ThreadRanks::run(2, |ranks| {
            let mut model = RankModel::build(glued(), Box::new(ranks)).unwrap();
            let failed = model.run(&Leapfrog, &options, &mut [], &mut |_| {});
            let error = failed.unwrap_err().error;
            let named =
                matches!(error, RunError::OneRankOnly { what: found, ranks: 2 } if found == what);
            Ok(named)
        });
        assert_eq!(found, [Ok(true), Ok(true)], "{what}");
    }
    let unequal = |rank: usize| RunOptions::steps(3 + rank as u64);
    let found = errors(3, &|| spec(mesh), &unequal);
    for error in found {
        assert!(error.starts_with("the number of steps differs"), "{error}");
    }
}

/// A failure of one rank is the failure of all: that of the earliest step, with the message of a model on one rank.
#[test]
fn all_ranks_end_with_the_failure_of_one() {
    let mesh = mesh();
    let start = Instant::now();
    let kick = |set: &str, size: f64, from: f64| {
        let nodes = mesh.node_set(set).unwrap()[7..8].to_vec();
        let late = move |t: f64| if t > from { 1.0 } else { 0.0 };
        Box::new(NodalForce::new(nodes, size * Vec3::x(), Box::new(late)))
    };
    let glue = |name: &str, nodes: [u32; 2], at: u64| {
        Box::new(Failing {
            name: name.into(),
            nodes: nodes.to_vec(),
            at,
            parts: None,
        })
    };
    let options = |_: usize| RunOptions::steps(60);
    let cases: [(&str, &(dyn Fn() -> ModelSpec<'static> + Sync)); 3] = [
        ("diverged at step", &|| {
            spec(mesh).load(kick("x0", 1e12, 5e-3))
        }),
        ("constraint 'first' at step 13", &|| {
            let nodes = [60, 61];
            let later = spec(mesh).constraint(glue("later", [150, 151], 14));
            later.constraint(glue("first", nodes, 13))
        }),
        ("constraint 'one' at step 13", &|| {
            let both = spec(mesh).constraint(glue("one", [150, 151], 13));
            both.constraint(glue("other", [60, 61], 13))
        }),
    ];
    for (expected, spec) in cases {
        let mut model = spec().build().unwrap();
        let alone = run(&mut model, &Leapfrog, &options(0), &mut [], &mut |_| {}).unwrap_err();
        assert!(alone.to_string().contains(expected), "{alone}");
        for ranks in [2, 3, 7] {
            let found = errors(ranks, &spec, &options);
            assert_eq!(found, vec![alone.to_string(); ranks]);
        }
    }
    assert!(start.elapsed() < SOON);
}

/// Elements that fail in any block, with shared nodes or without, end all ranks with the failure of the first of them.
#[test]
fn all_ranks_end_with_the_first_element_that_fails() {
    let mesh = mesh();
    let options = |_: usize| RunOptions::steps(40);
    for elements in [
        &[1_u64][..],
        &[37],
        &[62],
        &[120],
        &[8, 33, 61, 64, 92, 119],
    ] {
        let spec = || {
            let linear = Linear(ElasticMedium::new(9.0e9, 0.27, 2750.0).unwrap());
            let law = Fragile(linear, elements.to_vec(), 21.0);
            let mut spec = spec(mesh);
            let rock = SolidKernel::ONE_POINT.factory("rock", law, BlockOptions::default());
            spec.sets[0].1 = rock;
            spec
        };
        let mut model = spec().build().unwrap();
        let alone = run(&mut model, &Leapfrog, &options(0), &mut [], &mut |_| {}).unwrap_err();
        let named = |element: &u64| alone.to_string().contains(&format!("element {element}"));
        assert!(elements.iter().any(named), "{alone}");
        for ranks in [2, 3, 7] {
            let found = errors(ranks, &spec, &options);
            assert_eq!(found, vec![alone.to_string(); ranks], "{elements:?}");
        }
    }
}

/// A model goes on after a failed run: what was under way between the ranks is gone.
#[test]
fn ranks_run_again_after_a_failure() {
    let mesh = mesh();
    let found = ThreadRanks::run(4, |ranks| {
        let spec = spec(mesh).constraint(Box::new(Failing {
            name: "glue".into(),
            nodes: vec![60, 61],
            at: 9,
            parts: None,
        }));
        let mut model = RankModel::build(spec, Box::new(ranks)).unwrap();
        for _ in 0..3 {
            let options = RunOptions::steps(20);
            let failed = model.run(&Leapfrog, &options, &mut [], &mut |_| {});
            let error = failed.unwrap_err().error.to_string();
            assert!(error.starts_with("constraint 'glue'"), "{error}");
        }
        Ok(())
    });
    assert_eq!(found, vec![Ok(()); 4]);
}

/// The cancellation flag of one rank ends the runs of all after the same step.
#[test]
fn all_ranks_stop_after_the_same_step() {
    let mesh = mesh();
    let found = ThreadRanks::run(3, |ranks| {
        let mut model = RankModel::build(spec(mesh), Box::new(ranks)).unwrap();
        let flag = Arc::new(AtomicBool::new(false));
        let options = RunOptions::steps(1000).with_stop(flag.clone());
        let is_last = model.rank() == 2;
        let report = model.run(&Leapfrog, &options, &mut [], &mut |progress| {
            flag.store(is_last && progress.done >= 37, Ordering::Relaxed);
        });
        let report = report.unwrap();
        assert_eq!(report.ended, Ended::Stopped);
        Ok((report.steps, model.steps_taken()))
    });
    // The ranks agree on stopping before step 48, which is their last one.
    assert_eq!(found, vec![Ok((49, 49)); 3]);
}

/// A rank that dies is reported by all others, which do not hang.
#[test]
fn a_rank_that_dies_is_reported_by_the_others() {
    let mesh = mesh();
    let start = Instant::now();
    let found = ThreadRanks::run(4, |ranks| {
        let mut model = RankModel::build(spec(mesh), Box::new(ranks)).unwrap();
        let dies = model.rank() == 1;
        let options = RunOptions::steps(100_000);
        let failed = model.run(&Leapfrog, &options, &mut [], &mut |progress| {
            if dies && progress.done == 20 {
                std::panic::resume_unwind(Box::new("killed"));
            }
        });
        match failed.unwrap_err().error {
            RunError::Ranks(error) => Ok(error),
            other => panic!("{other}"),
        }
    });
    for (rank, found) in found.into_iter().enumerate() {
        let lost = RankError::Lost { rank: 1 };
        assert_eq!(found, if rank == 1 { Err(lost) } else { Ok(lost) });
    }
    assert!(start.elapsed() < SOON);
}

/// A weight that changes in time moves every node as on one rank.
#[test]
fn a_weight_that_changes_in_time_is_that_of_one_rank() {
    let mesh = mesh();
    let spec = || spec(mesh).gravity(-9.81 * Vec3::z(), Box::new(|t: f64| (700.0 * t).cos()));
    let options = RunOptions::steps(30);
    let mut alone = spec().build().unwrap();
    run(&mut alone, &Leapfrog, &options, &mut [], &mut |_| {}).unwrap();
    let nodes = 0..mesh.node_count() as u32;
    let expected: Vec<Vec3> = nodes.map(|node| alone.displacement(node)).collect();
    for count in [2, 5] {
        let equal = ThreadRanks::run(count, |ranks| {
            let mut model = RankModel::build(spec(), Box::new(ranks)).unwrap();
            let report = model.run(&Leapfrog, &options, &mut [], &mut |_| {});
            report.unwrap();
            let mut nodes = (0..).zip(&expected);
            Ok(nodes.all(|(node, u)| model.displacement(node).is_none_or(|found| found == *u)))
        });
        assert_eq!(equal, vec![Ok(true); count]);
    }
}

/// In every step a rank sends one message to each neighbour, and for each node that it shares little more than the three
/// numbers of a force: 30 bytes or less in blocks of 2048 elements.
#[test]
fn a_step_sends_few_bytes_for_each_shared_node() {
    let mesh = hex_box([32, 26, 20], 1.0, 0.0);
    let steps = 3;
    let found = ThreadRanks::run(4, |ranks| {
        let spec = spec(&mesh).block_size(2048);
        let mut model = RankModel::build(spec, Box::new(ranks)).unwrap();
        let step = powerhouse_model::StepChoice::Unchecked(1e-6);
        let options = RunOptions::steps(steps)
            .with_step(step)
            .with_speed_limit(1.0);
        let built = model.traffic();
        model
            .run(&Leapfrog, &options, &mut [], &mut |_| {})
            .unwrap();
        Ok((built, model.traffic(), model.node_count()))
    });
    let nodes: usize = found.iter().map(|found| found.as_ref().unwrap().2).sum();
    assert!(nodes > mesh.node_count() && nodes < mesh.node_count() * 13 / 10);
    for (rank, found) in found.into_iter().enumerate() {
        let (built, after, _) = found.unwrap();
        assert_eq!((built.exchanges, after.exchanges), (1, 1 + steps));
        assert_eq!(after.messages, after.exchanges * after.neighbours as u64);
        let bytes = (after.bytes - built.bytes) as f64 / steps as f64;
        let of_node = bytes / after.shared_nodes as f64;
        println!("rank {rank}: {after:?}, {of_node:.1} bytes for each shared node");
        assert!(of_node > 12.0 && of_node <= 30.0, "{of_node}");
    }
}

/// What ranks will send is known from a model on one rank, to the byte.
#[test]
fn a_forecast_is_what_the_ranks_send() {
    let mesh = mesh();
    let alone = spec(mesh).build().unwrap();
    for count in [1, 2, 3, 7] {
        let forecast = alone.rank_forecast(count).unwrap();
        let found = ThreadRanks::run(count, |ranks| {
            let mut model = RankModel::build(spec(mesh), Box::new(ranks)).unwrap();
            let options = RunOptions::steps(9);
            model
                .run(&Leapfrog, &options, &mut [], &mut |_| {})
                .unwrap();
            Ok((model.node_count(), model.traffic()))
        });
        assert_eq!(forecast.len(), count);
        let elements: usize = forecast.iter().map(|rank| rank.elements).sum();
        assert_eq!(elements, mesh.element_count());
        let work: f64 = forecast.iter().map(|rank| rank.work).sum();
        assert!((work - 1.0).abs() < 1e-12, "{work}");
        for rank in &forecast {
            let share = rank.elements as f64 / elements as f64;
            assert!((rank.work - share).abs() < 1e-12 && rank.inner_work < rank.work + 1e-12);
        }
        // With few ranks some blocks have no shared nodes.
        let inner: f64 = forecast.iter().map(|rank| rank.inner_work).sum();
        assert!(count > 2 || inner > 0.1, "{count}: {inner}");
        for (forecast, found) in forecast.iter().zip(found) {
            let (nodes, traffic) = found.unwrap();
            assert_eq!(
                (forecast.nodes, forecast.shared_nodes),
                (nodes, traffic.shared_nodes)
            );
            let exchanges = traffic.exchanges;
            let counted = (traffic.messages, traffic.bytes);
            let (messages, bytes) = (forecast.messages as u64, forecast.bytes as u64);
            assert_eq!(
                counted,
                (exchanges * messages, exchanges * bytes),
                "{count}"
            );
            assert_eq!(messages > 0, count > 1);
        }
    }
    let refused = alone.rank_forecast(121).unwrap_err().to_string();
    assert!(refused.contains("121"), "{refused}");
}

/// A static solution fails on all ranks for the reason for which it fails on one, or by which one of them is stopped.
#[test]
fn all_ranks_end_with_the_failure_of_a_static_solution() {
    let mesh = mesh();
    let law = Linear(ElasticMedium::new(9.0e9, 0.27, 2750.0).unwrap());
    let loose = || {
        let options = BlockOptions::default();
        let rock = SolidKernel::ONE_POINT.factory("rock", law.clone(), options);
        let base = mesh.node_set("z0").unwrap().to_vec();
        ModelSpec::new(mesh)
            .elements("rock", rock)
            .support(Support::roller(base, Vec3::z()))
            .block_size(8)
    };
    let weighted = || {
        let gravity = Box::new(|_: f64| 1.0);
        spec(mesh).gravity(Vec3::new(0.0, 0.0, -9.81), gravity)
    };
    let options = StaticOptions::default();
    let failure = |spec: &(dyn Fn(usize) -> ModelSpec<'static> + Sync), options: &StaticOptions| {
        ThreadRanks::run(3, |ranks| {
            let rank = powerhouse_model::Ranks::rank(&ranks);
            let engine = ExplicitOnRanks::new(Box::new(ranks));
            let mut model = engine.build(spec(rank)).unwrap();
            let failed = model.statics().unwrap().equilibrate(options, &mut |_| {});
            Ok(failed.unwrap_err())
        })
    };
    let mut alone = loose().build().unwrap();
    let expected = alone.equilibrate(&options, &mut |_| {}).unwrap_err();
    assert!(matches!(expected, StaticError::Floating { .. }));
    for found in failure(&|_| loose(), &options) {
        assert_eq!(found.unwrap(), expected);
    }
    let direct =
        StaticOptions::default().with_method(StaticMethod::Cholesky(Linearisation::Elastic));
    for found in failure(&|_| loose(), &direct) {
        let what = "the static method `direct`";
        assert_eq!(found.unwrap(), StaticError::OneRankOnly { what, ranks: 3 });
    }
    let stopped = Arc::new(AtomicBool::new(true));
    let stops = |rank: usize| match rank {
        1 => weighted().stop_on(stopped.clone()),
        _ => weighted(),
    };
    for found in failure(&stops, &options) {
        assert_eq!(found.unwrap(), StaticError::Interrupted);
    }
}

/// Values that an observer reads at a step, as bits.
type Readings = Arc<Mutex<Vec<u64>>>;

/// Reads everything that ranks gather, or something that they do not.
struct Reader {
    readings: Readings,
    fields: Fields,
    reach: Reach,
    read: fn(&dyn StepView) -> Vec<f64>,
    stop_at: u64,
    finished: Arc<AtomicBool>,
}

impl Observer for Reader {
    fn name(&self) -> &str {
        "reader"
    }
    fn fields(&self) -> Fields {
        self.fields
    }
    fn reach(&self) -> Reach {
        self.reach.clone()
    }
    fn cadence(&self) -> Cadence {
        Cadence::Steps(7)
    }
    fn observe(&mut self, view: &dyn StepView) -> Result<Flow, ModelError> {
        let values = (self.read)(view).into_iter().map(f64::to_bits);
        self.readings.lock().unwrap().extend(values);
        let stops = view.number() >= self.stop_at;
        Ok(if stops { Flow::Stop } else { Flow::Continue })
    }
    fn finish(&mut self) -> Result<(), ModelError> {
        self.finished.store(true, Ordering::Relaxed);
        Ok(())
    }
}

fn everything(view: &dyn StepView) -> Vec<f64> {
    let mut all = vec![view.number() as f64, view.time(), view.step()];
    for node in 0..view.node_count() as u32 {
        for v in [
            view.displacement(node),
            view.velocity(node),
            view.acceleration(node),
        ] {
            all.extend([v.x, v.y, v.z]);
        }
    }
    for element in 0..120 {
        all.extend(view.stress(element).0);
        let mut forces = [Vec3::zeros(); 8];
        assert!(view.element_forces(element, &mut forces));
        all.extend(forces.iter().flat_map(|f| [f.x, f.y, f.z]));
        all.extend(view.history(element, "damage"));
    }
    all.push(view.joints().len() as f64);
    all.extend(view.embedded("bolts", "force").unwrap_or_default());
    all.extend(view.energies().iter().map(|(_, energy)| *energy));
    all
}

/// Observers see on rank 0 what they see on one rank, to the bit; one that stops the run stops all ranks, and one that reads
/// what is not gathered ends it with an error that names it.
#[test]
fn observers_see_the_whole_body_on_rank_0() {
    let mesh = mesh();
    let declared = Fields::default()
        .with_acceleration(true)
        .with_stress(true)
        .with_energy(true);
    let observed = |ranks: usize, reader: &(dyn Fn() -> Reader + Sync)| {
        ThreadRanks::run(ranks, |ranks| {
            let rank = powerhouse_model::Ranks::rank(&ranks);
            let reader = reader();
            let (readings, finished) = (reader.readings.clone(), reader.finished.clone());
            let mut model = RankModel::build(spec(mesh), Box::new(ranks)).unwrap();
            let options = RunOptions::steps(60);
            let mut observers: Vec<Box<dyn Observer>> = vec![Box::new(reader)];
            let report = model.run(&Leapfrog, &options, &mut observers, &mut |_| {});
            assert_eq!(finished.load(Ordering::Relaxed), rank == 0);
            let ended = match report {
                Ok(report) => format!("{:?} {}", report.ended, report.steps),
                Err(failure) => failure.error.to_string(),
            };
            let readings = readings.lock().unwrap().clone();
            Ok((ended, readings))
        })
    };
    let whole = Reach::default()
        .with_element_forces()
        .with_variables(["damage"]);
    let reader = |(fields, reach), read: fn(&dyn StepView) -> Vec<f64>, stop_at: u64| Reader {
        readings: Readings::default(),
        fields,
        reach,
        read,
        stop_at,
        finished: Arc::default(),
    };
    for stop_at in [u64::MAX, 30] {
        let all = || reader((declared, whole.clone()), everything, stop_at);
        let expected = observed(1, &all).remove(0).unwrap();
        let cut = stop_at == 30;
        assert!(
            expected
                .0
                .starts_with(if cut { "Observer" } else { "Completed" })
        );
        assert!(expected.1.len() > 5 * 1000);
        for ranks in [2, 3, 5] {
            for (rank, found) in observed(ranks, &all).into_iter().enumerate() {
                let (ended, readings) = found.unwrap();
                assert_eq!(ended, expected.0);
                let seen = if rank == 0 { &expected.1[..] } else { &[] };
                assert!(readings == seen, "{ranks} ranks, rank {rank}");
            }
        }
    }
    type Read = fn(&dyn StepView) -> Vec<f64>;
    let undeclared: [(Read, &str); 6] = [
        (|view| vec![view.velocity(7).x], "nodes beyond"),
        (|view| view.stress(3).0.to_vec(), "stresses"),
        (
            |view| vec![f64::from(view.element_forces(3, &mut [Vec3::zeros(); 8]))],
            "element forces",
        ),
        (
            |view| view.history(3, "damage").into_iter().collect(),
            "history variables",
        ),
        (
            |view| view.embedded("bolts", "force").unwrap_or_default(),
            "embedded elements",
        ),
        (|view| vec![view.joints().len() as f64], "joints"),
    ];
    for (read, name) in undeclared {
        let reads = || reader((Fields::default(), Reach::NONE), read, u64::MAX);
        for (rank, found) in observed(3, &reads).into_iter().enumerate() {
            let (ended, _) = found.unwrap();
            assert!(
                ended.contains(name) && ended.contains("3 ranks"),
                "{rank}: {ended}"
            );
        }
    }
}
