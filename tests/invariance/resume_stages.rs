//! A static solution that is stopped between increments, or between steps of a dynamic relaxation, and resumed in a newly
//! built model goes on with the same bits.

use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};

use powerhouse::engine::Progress;
use powerhouse::{
    EquilibratedBody, FileScene, Registry, RunHooks, Scene, StageCheckpointSink, StageSolution,
};
use powerhouse_model::{ModelError, encode};
use powerhouse_test_support::EVERYTHING;

/// Receiver that takes the state at one of the calls, and ends the run then.
#[derive(Debug)]
struct StopAt {
    call: u64,
    seen: AtomicU64,
    taken: Mutex<Option<StageSolution>>,
}

impl StopAt {
    fn new(call: u64) -> Arc<Self> {
        Arc::new(Self {
            call,
            seen: AtomicU64::new(0),
            taken: Mutex::new(None),
        })
    }
}

impl StageCheckpointSink for StopAt {
    fn is_due(&self, _progress: &Progress) -> bool {
        self.seen.fetch_add(1, Ordering::Relaxed) == self.call
    }
    fn take(&self, solution: StageSolution) -> Result<(), ModelError> {
        *self.taken.lock().unwrap() = Some(solution);
        Err(ModelError::refused("test", "stopped"))
    }
}

/// The scene with everything, with other text in some places.
fn scene(changes: &[(&str, &str)], threads: usize) -> Scene {
    let mut text = EVERYTHING
        .replace("duration = 1\n", "duration = 1e-4\n")
        .replace("tolerance = 1e-6", "tolerance = 1e-4");
    for (from, to) in changes {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/scenes/everything.toml");
    let scene = FileScene::from_toml(&text, file, &Registry::default())
        .unwrap()
        .into_scene();
    scene.with_threads(threads)
}

/// The last body that the stages reached, from a body and a solution, and whether the run came to its end.
fn run(
    (changes, threads): (&[(&str, &str)], usize),
    sink: Arc<StopAt>,
    from: (Option<EquilibratedBody>, Option<StageSolution>),
) -> (Option<EquilibratedBody>, bool) {
    let mut last = from.0.clone();
    let mut hooks = RunHooks::default()
        .with_stage_checkpoints(sink)
        .with_stage_hook(|body| last = Some(body.clone()));
    (hooks.completed_stages, hooks.stage_solution) = from;
    let completed = scene(changes, threads)
        .prepare()
        .unwrap()
        .run(hooks)
        .is_ok();
    (last, completed)
}

fn bits(body: &EquilibratedBody) -> (Vec<u8>, Vec<u8>) {
    let stages: Vec<_> = body
        .stages()
        .iter()
        .map(|stage| encode(stage).unwrap())
        .collect();
    (encode(body.state()).unwrap(), stages.concat())
}

/// The opening by dynamic relaxation in two increments, the lining by conjugate gradients in two.
#[test]
fn a_stopped_static_solution_goes_on_with_the_same_bits() {
    let changes = [
        (
            "increments = 2\n",
            "increments = 2\nmethod = \"dynamic-relaxation\"\n",
        ),
        ("grouted = [", "increments = 2\ngrouted = ["),
    ];
    let body = stop_and_resume(&changes, 0);
    assert!(
        body.state().joints[0]
            .records
            .iter()
            .all(|record| record.friction == 0.0)
    );
}

/// The lining by dynamic relaxation, in rock that closes on it along a joint that slides.
#[test]
fn a_joint_that_slides_goes_on_with_the_same_bits() {
    let changes = [
        ("release = 0.95\n", "release = 0.5\n"),
        ("increments = 2\n", "method = \"dynamic-relaxation\"\n"),
        (
            "cohesion = 5e5\ntensile_strength = 5e5\n",
            "cohesion = 0\ntensile_strength = 0\n",
        ),
        (
            "static_friction = 0.839\ndynamic_friction = 0.755\n",
            "static_friction = 0.1\ndynamic_friction = 0.1\n",
        ),
        (
            "grouted = [",
            "method = \"dynamic-relaxation\"\ngrouted = [",
        ),
    ];
    let body = stop_and_resume(&changes, 1);
    let slipped = body.state().joints[0].records.iter();
    let slipped = slipped.filter(|record| record.friction > 0.0).count();
    assert!(slipped > 10, "{slipped}");
}

/// Stops the static solutions of a scene at several calls, in turn, and resumes them; returns the body of the solutions
/// without a stop, one of whose stages is `relaxed` in many steps.
fn stop_and_resume(changes: &[(&str, &str)], relaxed: usize) -> EquilibratedBody {
    let never = StopAt::new(u64::MAX);
    let (whole, completed) = run((changes, 2), never.clone(), (None, None));
    let whole = whole.unwrap();
    assert!(completed && whole.stages().len() == 2);
    let calls = never.seen.load(Ordering::Relaxed);
    let relaxed = whole.stages()[relaxed].solution.steps;
    assert!(
        relaxed > 100 && calls > relaxed,
        "{relaxed} steps, {calls} calls"
    );
    // The first increment before its first step and within, the second within, and those of the second stage.
    let chosen = [0, 1, 37, calls / 2, calls - 2, calls - 1];
    for (index, call) in chosen.into_iter().enumerate() {
        let sink = StopAt::new(call);
        let (body, completed) = run((changes, 1), sink.clone(), (None, None));
        let solution = sink.taken.lock().unwrap().clone();
        assert!(!completed && solution.is_some(), "call {call}");
        let stages = body.as_ref().map_or(0, |body| body.stages().len());
        assert_eq!(solution.as_ref().unwrap().stage, stages, "call {call}");
        let later = StopAt::new(u64::MAX);
        let (resumed, completed) = run((changes, 1 + index % 3), later.clone(), (body, solution));
        assert!(completed, "call {call}");
        assert!(bits(&resumed.unwrap()) == bits(&whole), "call {call}");
        // What was done before is not done again.
        assert!(
            later.seen.load(Ordering::Relaxed) <= calls - call,
            "call {call}"
        );
    }
    whole
}
