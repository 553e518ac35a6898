//! Cost of constitutive laws: a whole step with none, 5 % (one cluster) and all of the elements yielding, over the elastic
//! step of the same run; and the additional cost of the energy balance, which scenes always compute.
//!
//! `cargo bench --bench law`; a word picks laws and a number the elements along an edge, 48 without:
//! `cargo bench --bench law -- mohr 16` stays in the caches, so that it measures computation without memory traffic.
//! One thread; the least of many short runs, in processor time where the system reports it.

use std::time::Instant;

use powerhouse::engine::{
    BlockOptions, BuildModel, EnergyCheck, Hex8OnePoint, Leapfrog, Model, Precision, RunOptions,
    SolidKernel, StepChoice, run,
};
use powerhouse::material::{
    ConeFit, DampingBand, DruckerPrager, DruckerPragerParameters, ElastoPlastic, LeeFenves,
    LinearElastic, Mazars, MohrCoulomb, ReferenceFrequency, RelaxationSpectrum, presets,
};
use powerhouse::model::{Mesh, State, TimeIntegrator, Vec3};
use powerhouse::{Kernel, Material};

/// Default number of elements along an edge.
const CELLS: usize = 48;
/// Edge of the cluster, of that of the body: 18^3 of 48^3 elements are 5.3 %.
const CLUSTER: f64 = 0.375;
/// Steps before the timing, and timed steps.
const STEPS: [usize; 2] = [2, 6];
const REPETITIONS: usize = 15;

/// Processor time of all threads of this process (s), or wall time.
fn clock(start: Instant) -> f64 {
    let of_thread = |entry: std::io::Result<std::fs::DirEntry>| {
        let text = std::fs::read_to_string(entry.ok()?.path().join("schedstat")).ok()?;
        text.split(' ').next()?.parse::<f64>().ok()
    };
    let tasks = std::fs::read_dir("/proc/self/task").ok();
    let time: Option<f64> = tasks.and_then(|tasks| tasks.map(of_thread).sum());
    time.map_or_else(
        || start.elapsed().as_secs_f64(),
        |nanoseconds| 1e-9 * nanoseconds,
    )
}

/// Extent of yielding.
#[derive(Clone, Copy)]
enum Yielding {
    None,
    Cluster,
    All,
}

/// A state with constant rates of shear and extension in the elements that are to yield.
fn state(mesh: &Mesh, yielding: Yielding, step: f64) -> State {
    let mut state = State::at_rest(mesh.node_count());
    let edge = mesh
        .positions()
        .iter()
        .fold(0.0, |edge: f64, x| edge.max(x.x));
    for (node, x) in mesh.positions().iter().enumerate() {
        let inside = match yielding {
            Yielding::None => false,
            Yielding::Cluster => x.iter().all(|x| *x <= CLUSTER * edge),
            Yielding::All => true,
        };
        let noise = |k: f64| (12.9898 * x.x + 78.233 * x.y + 37.719 * x.z + k).sin();
        let rest = Vec3::new(noise(0.1), noise(0.7), noise(1.9)) * 1e-8;
        let strained = Vec3::new(0.3 * x.x + x.y, 0.4 * x.z, -0.1 * x.z);
        let (strain, rate) = if inside {
            (1e-3, 1e-5 / step)
        } else {
            (0.0, 0.0)
        };
        state.displacement[node] = rest + strained * strain;
        state.velocity[node] = rest / step + strained * rate;
    }
    state
}

/// A body with a law on one thread, a state of it, and a time step (s).
fn body(
    law: &Material,
    mesh: &Mesh,
    yielding: Yielding,
    precision: Precision,
) -> (Model, State, f64) {
    let mut options = BlockOptions::default();
    options.precision = precision;
    let kernel = Kernel::from(SolidKernel::Hex8OnePoint(Hex8OnePoint::default()));
    let step = 0.3 / law.medium().p_speed();
    let builder = Model::builder(mesh).elements("rock", kernel.factory("rock", law, options));
    let mut model = builder.threads(1).build().expect("a valid model");
    let mut start = state(mesh, yielding, step);
    start.history = model.state().history;
    (model, start, step)
}

/// The least time of a step per element (ns) in a run without a balance of energy, and with one: that
/// of a long run less that of a short one, all of them in turn.
fn costs_of_runs(law: &Material, mesh: &Mesh, yielding: Yielding) -> [f64; 2] {
    let (mut model, start, step) = body(law, mesh, yielding, Precision::F64);
    let check = EnergyCheck::every(u64::MAX).with_by_set(false);
    let [short, long] = [2, 12];
    let mut least = [[f64::INFINITY; 2]; 2];
    for _ in 0..REPETITIONS {
        for (energy, least) in [None, Some(check)].into_iter().zip(&mut least) {
            for (steps, least) in [short, long].into_iter().zip(least) {
                model.set_state(&start).expect("a state of the mesh");
                let mut options = RunOptions::steps(steps).with_step(StepChoice::Unchecked(step));
                options.energy = energy;
                let begun = Instant::now();
                let before = clock(begun);
                run(&mut model, &Leapfrog, &options, &mut [], &mut |_| {}).expect("a stable run");
                *least = f64::min(*least, clock(begun) - before);
            }
        }
    }
    let elements = (long - short) as f64 * mesh.element_count() as f64;
    least.map(|[short, long]| 1e9 * (long - short) / elements)
}

/// The least time of a step per element (ns), and the share of elements that yield in it.
fn cost(law: &Material, mesh: &Mesh, yielding: Yielding, precision: Precision) -> (f64, f64) {
    let (mut model, start, step) = body(law, mesh, yielding, precision);
    let (mut least, mut share) = (f64::INFINITY, 0.0);
    for _ in 0..REPETITIONS {
        model.set_state(&start).expect("a state of the mesh");
        let advance = |model: &mut Model, steps: usize| {
            for _ in 0..steps {
                Leapfrog.step(model, step).expect("a stable step");
            }
        };
        advance(&mut model, STEPS[0]);
        let begun = Instant::now();
        let before = clock(begun);
        advance(&mut model, STEPS[1]);
        least = f64::min(least, clock(begun) - before);
        let fields = model.state().history;
        let yields = fields.iter().find(|field| field.name == "yield_state");
        let yields = yields.or(fields.iter().find(|field| field.name == "damage"));
        share = yields.map_or(0.0, |field| {
            let count = field.values.iter().filter(|value| **value > 0.0).count();
            count as f64 / field.values.len() as f64
        });
    }
    (
        1e9 * least / (STEPS[1] * mesh.element_count()) as f64,
        share,
    )
}

/// The arguments of the command line.
fn words() -> impl Iterator<Item = String> {
    std::env::args()
        .skip(1)
        .filter(|word| !word.starts_with('-'))
}

fn compare(name: &str, law: impl Into<Material>, mesh: &Mesh) {
    let law = law.into();
    if words().any(|word| word.parse::<usize>().is_err() && !name.contains(&word)) {
        return;
    }
    for (precision, digits) in [(Precision::F64, "double"), (Precision::Mixed, "mixed")] {
        let elastic = || {
            let elastic = Material::from(LinearElastic::new(law.medium()));
            cost(&elastic, mesh, Yielding::None, precision).0
        };
        let before = elastic();
        let of = |yielding| cost(&law, mesh, yielding, precision);
        let costs = [Yielding::None, Yielding::Cluster, Yielding::All].map(of);
        let base = before.min(elastic());
        let told = costs.map(|(cost, share)| {
            format!(
                "{cost:6.1} ns = {:4.2} ({:3.0} %)",
                cost / base,
                100.0 * share
            )
        });
        println!(
            "{name:19} {digits:6} elastic {base:5.1} ns; {}",
            told.join(", ")
        );
    }
    let added = [Yielding::None, Yielding::Cluster].map(|yielding| {
        let [free, balanced] = costs_of_runs(&law, mesh, yielding);
        format!("{free:.1} to {balanced:.1} ns = {:.2}", balanced / free)
    });
    println!("{name:19} energy balance: {}", added.join(", "));
}

fn main() {
    let cells = words().find_map(|word| word.parse().ok()).unwrap_or(CELLS);
    let size = Vec3::repeat(cells as f64);
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), size, [cells; 3], "rock");
    let mesh = mesh.expect("the mesh of the benchmark is valid");
    println!(
        "time over that of the elastic step: no element yields, a cluster yields, all yield (yielding share)"
    );
    let rock = presets::PAPER_ROCK;
    let cone = DruckerPrager::new(DruckerPragerParameters {
        medium: rock.medium,
        friction: rock.friction,
        dilation: rock.dilation,
        cohesion: rock.cohesion,
        fit: ConeFit::Inscribed,
    });
    compare(
        "drucker-prager",
        ElastoPlastic::new(cone.expect("valid")),
        &mesh,
    );
    let surface = MohrCoulomb::new(rock).expect("valid");
    compare("mohr-coulomb", ElastoPlastic::new(surface), &mesh);
    compare(
        "paper-concrete",
        presets::paper_concrete().expect("valid"),
        &mesh,
    );
    let concrete = Mazars::new(presets::PAPER_CONCRETE_MAZARS).expect("valid");
    compare("mazars", concrete, &mesh);
    let concrete = LeeFenves::new(presets::PAPER_CONCRETE_LEE_FENVES).expect("valid");
    compare("lee-fenves", concrete, &mesh);
    let band = DampingBand {
        ratio: 0.05,
        lowest: 0.5,
        highest: 20.0,
        mechanisms: 3,
    };
    let spectrum = RelaxationSpectrum::fit(band).expect("valid");
    let damped = |law: Material| {
        let damped = law.damped(&spectrum, ReferenceFrequency::Centre);
        damped.expect("valid").expect("in series")
    };
    let elastic = Material::from(LinearElastic::new(rock.medium));
    compare("damped elastic", damped(elastic), &mesh);
    let rock = Material::from(ElastoPlastic::new(surface));
    compare("damped mohr-coulomb", damped(rock), &mesh);
}
