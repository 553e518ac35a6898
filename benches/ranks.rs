//! Cost of a step on several ranks that each have the same number of elements.
//!
//! `cargo bench --bench ranks` prints processor time per element and step for 1, 2, 4, 8 and 16 ranks of one thread with 97,336
//! elastic bricks each, in one process, over that of one rank with two threads and the same body, and what they exchange;
//! `-- 30` takes ranks of 30^3 bricks. Processor time is that of all threads, which does not depend on how many of them have
//! a core of their own; it needs Linux. The body as a whole grows with the number of ranks, so that the time of one rank
//! has what the caches and the memory of this machine make of it.

use powerhouse::engine::{BlockOptions, Leapfrog, RankModel, SolidKernel, Traffic};
use powerhouse::material::LinearElastic;
use powerhouse::model::{
    Constant, ElasticMedium, Mesh, ModelSpec, RunOptions, StepChoice, Support, ThreadRanks, Vec3,
};

/// Bricks along each edge of the cube of a rank, by default.
const SIDE: usize = 46;
/// Steps before the first one that is timed, and the last one.
const STEPS: [u64; 2] = [5, 45];
/// Turns of all numbers of ranks, of which the least time of each counts.
const TURNS: usize = 3;

/// Numbers of cubes along x, y and z.
const SHAPES: [[usize; 3]; 5] = [[1, 1, 1], [2, 1, 1], [2, 2, 1], [2, 2, 2], [4, 2, 2]];

/// Processor time (ns) of all threads of this process so far.
fn processor_time() -> f64 {
    let tasks = std::fs::read_dir("/proc/self/task").expect("Linux");
    let of_task = |task: std::io::Result<std::fs::DirEntry>| -> Option<f64> {
        let text = std::fs::read_to_string(task.ok()?.path().join("schedstat")).ok()?;
        text.split_whitespace().next()?.parse().ok()
    };
    tasks.filter_map(of_task).sum()
}

/// Processor time (ns) of a step of all of some ranks together, and what rank 0 of them exchanges.
fn step(side: usize, shape: [usize; 3], (ranks, threads): (usize, usize)) -> (f64, Traffic) {
    let cells = shape.map(|cubes| cubes * side);
    let size = Vec3::new(cells[0] as f64, cells[1] as f64, cells[2] as f64);
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), size, cells, "rock").expect("a box");
    let foot = mesh.nodes_of_facets(mesh.facet_set("bottom").expect("a foot"));
    let law = LinearElastic::new(ElasticMedium::new(9.0e9, 0.27, 2750.0).expect("rock"));
    let spec = || {
        let rock = SolidKernel::ONE_POINT.factory("rock", law, BlockOptions::default());
        ModelSpec::new(&mesh)
            .elements("rock", rock)
            .support(Support::fixed(foot.clone()))
            .gravity(Vec3::new(0.0, 0.0, -9.81), Box::new(Constant(1.0)))
            // Blocks of one size, whatever the number of elements.
            .block_size(4096)
            .threads(threads)
    };
    let options = RunOptions::steps(STEPS[1]).with_step(StepChoice::Unchecked(1e-5));
    let found = ThreadRanks::run(ranks, |ranks| {
        let mut model = RankModel::build(spec(), Box::new(ranks)).expect("a model");
        let is_first = model.rank() == 0;
        let mut times = [0.0; 2];
        let run = model.run(&Leapfrog, &options, &mut [], &mut |progress| {
            for (time, at) in times.iter_mut().zip(STEPS) {
                if is_first && progress.done == at {
                    *time = processor_time();
                }
            }
        });
        run.expect("a run");
        Ok((times[1] - times[0], model.traffic()))
    });
    let first = found.into_iter().next().and_then(Result::ok);
    let (time, traffic) = first.expect("a rank");
    (time / (STEPS[1] - STEPS[0]) as f64, traffic)
}

fn main() {
    let side = std::env::args()
        .filter_map(|word| word.parse().ok())
        .next_back();
    let side = side.unwrap_or(SIDE);
    let elements = side * side * side;
    let unknown = (f64::INFINITY, Traffic::default());
    let mut least = SHAPES.map(|_| [unknown; 2]);
    for _ in 0..TURNS {
        for (least, shape) in least.iter_mut().zip(SHAPES) {
            let ranks = shape.iter().product();
            for (least, split) in least.iter_mut().zip([(1, 2), (ranks, 1)]) {
                let found = step(side, shape, split);
                if found.0 < least.0 {
                    *least = found;
                }
            }
        }
    }
    println!("{elements} bricks a rank: ns of processor time per element and step");
    for (shape, [one, many]) in SHAPES.into_iter().zip(&least) {
        let ranks: usize = shape.iter().product();
        let [one, (time, traffic)] = [one, many].map(|(time, traffic)| {
            let of_element = time / (ranks * elements) as f64;
            (of_element, *traffic)
        });
        let shared = traffic.shared_nodes;
        let sent = traffic.exchanges.max(1) * shared.max(1) as u64;
        println!(
            "{ranks:>3} ranks: {time:.1}, {:.3} times one rank of two threads; rank 0 shares {shared} nodes with {} ranks, {:.1} bytes each",
            time / one.0,
            traffic.neighbours,
            traffic.bytes as f64 / sent as f64,
        );
    }
}
