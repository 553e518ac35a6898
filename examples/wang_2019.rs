//! One case of the study of Wang, Chen & Xiao (2019), section 4, from Rust: excavation, bolts and lining of a
//! machine bay, then El Centro at oblique incidence, and the main results for design.
//!
//! Builds on `cavern` and `staged_tunnel`. All cases, pictures and the report are
//! `powerhouse sweep data/scenes/wang_2019.toml` and `powerhouse report results/wang_2019`.
//!
//! Run from the top of the project: `cargo run --release --example wang_2019`, a quarter of an hour at most on two
//! cores; a case and a shorter duration (s) may follow: `-- p-30 2.5`. A finished case is not run again.

use std::process::ExitCode;
use std::time::Duration;

use powerhouse::ProgressHook;
use powerhouse_study::sweep::{CaseOutcome, Peak, Sweep, SweepWatch};

type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

const SCENE: &str = "data/scenes/wang_2019.toml";

/// Progress output of a case.
struct Printed;

impl SweepWatch for Printed {
    fn equilibrated(&mut self, _case: &str, took: Duration) {
        println!("excavated, bolted and lined in {:.0} s", took.as_secs_f64());
    }
    fn reused(&mut self, case: &str) {
        println!("{case} was finished before");
    }
    fn progress(&mut self, _case: &str) -> Option<ProgressHook<'static>> {
        let mut tenths = 0;
        Some(Box::new(move |progress| {
            let now = 10 * progress.done / progress.planned.max(1);
            if now > tenths {
                tenths = now;
                println!("{:3} %, t = {:.2} s", 10 * now, progress.time);
            }
        }))
    }
}

/// The sweep of a single case, with a duration (s) or that of the scene.
fn case(scene: &str, name: &str, duration: Option<f64>) -> Outcome<Sweep> {
    let sweep = Sweep::of_file_with(scene, None, &powerhouse_wang_2019::registry())?
        .only(&[name.to_owned()])?;
    Ok(match duration {
        Some(duration) => sweep.with_duration(duration)?,
        None => sweep,
    })
}

/// Prints the main results of a case.
fn print(outcome: &CaseOutcome) {
    let line = |peaks: &[Peak], scale: f64| {
        let texts = peaks
            .iter()
            .map(|peak| format!("{} {:.3}", peak.name, scale * peak.value));
        texts.collect::<Vec<_>>().join(", ")
    };
    println!(
        "principal stress (MPa): {}",
        line(&outcome.stresses, 1.0e-6)
    );
    println!(
        "relative displacement (mm): {}",
        line(&outcome.relative, 1.0e3)
    );
    println!("bolts (kN): {}", line(&outcome.bolts, 1.0e-3));
    for part in &outcome.parts {
        println!("mean damage of {}: {:.3}", part.name, part.mean);
    }
    if let Some(joint) = &outcome.joint_and_lining {
        println!(
            "the joint failed on {:.1} % of its area",
            100.0 * joint.failed
        );
    }
}

fn shake() -> Outcome<()> {
    let mut words = std::env::args().skip(1);
    let name = words.next().unwrap_or_else(|| "sv-30".into());
    let duration = words.next().map(|word| word.parse()).transpose()?;
    let sweep = case(SCENE, &name, duration)?;
    for outcome in sweep.run(None, &mut Printed)? {
        print(&outcome);
    }
    println!("results in {}", sweep.folder().join(&name).display());
    Ok(())
}

fn main() -> ExitCode {
    match shake() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

/// The cases of the usage are cases of the scene, each alone; another name is an error.
#[test]
fn the_case_is_one_of_the_scene() {
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/../data/scenes/wang_2019.toml");
    for name in ["sv-30", "p-30", "sv-30-paper"] {
        assert_eq!(case(scene, name, Some(2.5)).unwrap().cases(), [name]);
    }
    let refused = case(scene, "sv-31", None).err().unwrap().to_string();
    assert!(
        refused.contains("sv-31") && refused.contains("sv-30"),
        "{refused}"
    );
}
