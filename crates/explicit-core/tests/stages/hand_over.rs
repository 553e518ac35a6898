//! From rest to motion: other supports, the same forces.

use powerhouse_elements::{NodalForce, SolidKernel};
use powerhouse_explicit_core::{BuildModel, Leapfrog, Model, run};
use powerhouse_model::{
    Cadence, ConstitutiveLaw, ElasticMedium, EnergyCheck, Fields, Flow, HistoryVariable, Lane,
    LawInput, Mesh, ModelError, ModelSpec, Observer, Precision, RunOptions, State, StaticError,
    StaticOptions, StepView, Stress, Vec3,
};

use super::{
    GRAVITY, absorbing, bent_box, elastic_body, face_nodes, largest, on_rollers, rock, weak,
};

const DISTANCE: f64 = 20.0;

fn block() -> Mesh {
    bent_box(Vec3::new(40.0, 30.0, 30.0), [6, 5, 4], 1.0)
}

/// The block in static equilibrium on rollers under its weight, to a coarse tolerance.
fn at_rest(mesh: &Mesh, builder: ModelSpec, tolerance: f64) -> State {
    let builder = on_rollers(mesh, builder).gravity(GRAVITY, Box::new(|_: f64| 1.0));
    let mut model = builder.build().unwrap();
    let options = StaticOptions::default().with_tolerance(tolerance);
    model.equilibrate(&options, &mut |_| {}).unwrap();
    model.state().next_stage(mesh.node_count())
}

/// The fastest and the farthest node of a run (m/s, m), as observers see them.
#[derive(Clone, Copy, Default)]
struct Stillness {
    speed: f64,
    distance: f64,
}

struct Watch(std::sync::mpsc::Sender<Stillness>);

impl Observer for Watch {
    fn name(&self) -> &str {
        "stillness"
    }
    fn fields(&self) -> Fields {
        Fields::default()
    }
    fn cadence(&self) -> Cadence {
        Cadence::Steps(500)
    }
    fn observe(&mut self, view: &dyn StepView) -> Result<Flow, ModelError> {
        let mut seen = Stillness::default();
        for node in 0..view.node_count() as u32 {
            seen.speed = seen.speed.max(view.velocity(node).norm());
            seen.distance = seen.distance.max(view.displacement(node).norm());
        }
        self.0.send(seen).expect("the test listens");
        Ok(Flow::Continue)
    }
}

fn stillness(model: &mut Model, steps: u64) -> Stillness {
    let (sender, seen) = std::sync::mpsc::channel();
    let options = RunOptions::steps(steps).with_energy(EnergyCheck::every(1000));
    let mut watch: [Box<dyn Observer>; 1] = [Box::new(Watch(sender))];
    run(model, &Leapfrog, &options, &mut watch, &mut |_| {}).unwrap();
    let looks: Vec<Stillness> = seen.try_iter().collect();
    assert!(looks.len() as u64 > steps / 500);
    looks
        .iter()
        .fold(Stillness::default(), |most, s| Stillness {
            speed: most.speed.max(s.speed),
            distance: most.distance.max(s.distance),
        })
}

/// Rock that yields under its weight, in static equilibrium to a coarse tolerance on rollers, stays at rest on springs
/// and dashpots without input: below 1e-10 m/s and 1e-10 m for 10,000 steps in double precision. In
/// the others, whose elements have seven digits, points on the yield surface flow by rounding: below
/// 1e-6 m/s and 1e-6 m.
#[test]
fn a_body_that_is_handed_over_does_not_move() {
    let mesh = block();
    let yielding = |precision| Model::builder(&mesh).elements("ground", weak("ground", precision));
    let state = at_rest(&mesh, yielding(Precision::F64), 1.0e-5);
    let plastic = state.history.iter();
    let plastic = plastic.filter(|field| field.name == "equivalent_plastic_strain");
    let yielded = plastic
        .flat_map(|field| &field.values)
        .filter(|&&e| e > 0.0);
    assert!(yielded.count() > 50);
    assert!(largest(state.displacement.iter().copied()) > 5.0e-4);
    for (precision, tolerance) in [
        (Precision::F64, 1.0e-9),
        (Precision::Mixed, 1.0e-4),
        (Precision::F32, 1.0e-3),
    ] {
        let mut model = absorbing(&mesh, yielding(precision), DISTANCE)
            .gravity(GRAVITY, Box::new(|_: f64| 1.0))
            .start(state.clone())
            .build()
            .unwrap();
        let report = model.hand_over(tolerance).unwrap();
        let still = stillness(&mut model, 10_000);
        println!(
            "{precision:?}: {:.2e} m/s, {:.2e} m, {report:?}",
            still.speed, still.distance
        );
        let limit = if precision == Precision::F64 {
            1.0e-10
        } else {
            1.0e-6
        };
        assert!(still.speed <= limit && still.distance <= limit);
    }
}

/// An elastic body moves against the start of its stage as if it had never borne a weight, to 1e-9:
/// with its weight as a load, and its supports turned into springs and dashpots.
#[test]
fn a_static_stress_does_not_change_an_elastic_motion() {
    let mesh = block();
    let push = || {
        // Nothing acts before the start, or it would count as a carried force.
        let pulse = |t: f64| (core::f64::consts::PI * (t / 0.02).min(1.0)).sin().powi(2);
        let nodes = face_nodes(&mesh, "top");
        Box::new(NodalForce::new(
            nodes,
            Vec3::new(2.0e6, 0.5e6, -1.0e6),
            Box::new(pulse),
        ))
    };
    let options = RunOptions::steps(400);
    let mut plain = absorbing(&mesh, elastic_body(&mesh), DISTANCE)
        .load(push())
        .build()
        .unwrap();
    run(&mut plain, &Leapfrog, &options, &mut [], &mut |_| {}).unwrap();

    let state = at_rest(&mesh, elastic_body(&mesh), 1.0e-10);
    let mut pressed = absorbing(&mesh, elastic_body(&mesh), DISTANCE)
        .load(push())
        .gravity(GRAVITY, Box::new(|_: f64| 1.0))
        .start(state.clone())
        .build()
        .unwrap();
    pressed.hand_over(1.0e-9).unwrap();
    let options = options.with_energy(EnergyCheck::every(50));
    let report = run(&mut pressed, &Leapfrog, &options, &mut [], &mut |_| {}).unwrap();
    assert!(
        report.energy_residual < 1.0e-10,
        "{}",
        report.energy_residual
    );

    let nodes = 0..mesh.node_count() as u32;
    let size = largest(nodes.clone().map(|node| plain.displacement(node)));
    assert!(size > 1.0e-7, "{size}");
    for node in nodes {
        let moved = pressed.displacement(node) - state.displacement[node as usize];
        let error = (moved - plain.displacement(node)).norm();
        assert!(error < 1.0e-9 * size, "{error} {size}");
    }
}

/// A dynamic stage without the weight of the static one is refused with the node where most is
/// missing, and so is one whose body lost elements on the way.
#[test]
fn what_no_longer_holds_is_refused() {
    let mesh = block();
    let state = at_rest(&mesh, elastic_body(&mesh), 1.0e-8);
    let mut weightless = absorbing(&mesh, elastic_body(&mesh), DISTANCE)
        .start(state.clone())
        .build()
        .unwrap();
    assert!(matches!(
        weightless.hand_over(1.0e-3),
        Err(StaticError::CarriedForcesChanged { difference, .. }) if difference > 0.1
    ));
    let mut smaller = state;
    smaller.remove(&[0, 1, 2]);
    let mut holed = absorbing(&mesh, elastic_body(&mesh), DISTANCE)
        .gravity(GRAVITY, Box::new(|_: f64| 1.0))
        .start(smaller)
        .build()
        .unwrap();
    assert!(matches!(
        holed.hand_over(1.0e-3),
        Err(StaticError::CarriedForcesChanged { .. })
    ));
}

/// Elastic, but softer in dynamic steps than in static solutions.
#[derive(Clone)]
struct Relaxing {
    medium: ElasticMedium,
    share: f64,
}

impl ConstitutiveLaw for Relaxing {
    fn name(&self) -> &str {
        "relaxing"
    }
    fn medium(&self) -> ElasticMedium {
        self.medium
    }
    fn history(&self) -> &[HistoryVariable] {
        &[]
    }
    fn stress_change<L: Lane>(&self, input: &LawInput<L>, _new_history: &mut [L]) -> Stress<L> {
        let number = |value: f64| input.strain.0[0].constant(self.share * value);
        let (lambda, shear) = (self.medium.lambda(), self.medium.shear());
        Stress::elastic(number(lambda), number(shear), &input.strain)
    }
    fn for_step(&self, length: f64) -> Self {
        let share = if length > 0.0 { 0.9 } else { 1.0 };
        Self {
            share,
            ..self.clone()
        }
    }
}

/// A law whose stress in dynamic steps differs from the static one is refused with its set: the static
/// stress would not stay.
#[test]
fn a_law_that_would_forget_the_static_stress_is_refused() {
    let mesh = block();
    let body = || {
        let law = Relaxing {
            medium: rock(),
            share: 1.0,
        };
        // Without hourglass forces, which do not relax.
        let factory = SolidKernel::Hex8Full.factory("ground", law, Default::default());
        Model::builder(&mesh).elements("ground", factory)
    };
    let state = at_rest(&mesh, body(), 1.0e-8);
    let mut model = absorbing(&mesh, body(), DISTANCE)
        .gravity(GRAVITY, Box::new(|_: f64| 1.0))
        .start(state)
        .build()
        .unwrap();
    assert!(matches!(
        model.hand_over(1.0e-3),
        Err(StaticError::StressChanges { set, difference })
            if set == "ground" && (difference - 0.1).abs() < 1.0e-9
    ));
}

/// A run of the dynamic stage that is interrupted and goes on from its state, in a model that was
/// built anew, has the same bits: what holds the body, and where the stage began, go along.
#[test]
fn a_stage_goes_on_from_its_state() {
    let mesh = block();
    let state = at_rest(&mesh, elastic_body(&mesh), 1.0e-6);
    let built = |state: &State| {
        let force = NodalForce::new(
            face_nodes(&mesh, "top"),
            Vec3::x() * 1.0e5,
            Box::new(|t: f64| (100.0 * t).sin()),
        );
        let builder = absorbing(&mesh, elastic_body(&mesh), DISTANCE).load(Box::new(force));
        let builder = builder.gravity(GRAVITY, Box::new(|_: f64| 1.0));
        builder.start(state.clone()).build().unwrap()
    };
    let step = |model: &mut Model, steps| {
        run(
            model,
            &Leapfrog,
            &RunOptions::steps(steps),
            &mut [],
            &mut |_| {},
        )
        .unwrap();
    };
    let mut whole = built(&state);
    whole.hand_over(1.0e-5).unwrap();
    step(&mut whole, 30);
    let middle = whole.state();
    step(&mut whole, 30);
    let mut second = built(&middle);
    step(&mut second, 30);
    assert!(whole.state() == second.state());
    assert_eq!(middle.stage_start, state.displacement);
}
