//! Cost of a step on several ranks that each have the same number of elements.
//!
//! `cargo bench --bench ranks` prints processor time per element and step for 1, 2, 4, 8 and 16 ranks of one thread with 97,336
//! elastic bricks each, in one process, and what they exchange; `-- 30` takes ranks of 30^3 bricks. Processor time is that of
//! all threads, which does not depend on how many of them have a core of their own; it needs Linux.

use powerhouse::engine::{BlockOptions, Leapfrog, RankModel, SolidKernel, Traffic};
use powerhouse::material::LinearElastic;
use powerhouse::model::{
    ElasticMedium, Mesh, ModelSpec, RunOptions, StepChoice, Support, ThreadRanks, Vec3,
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

/// Processor time (ns) of a step of all ranks together, and what rank 0 of them exchanges.
fn step(side: usize, shape: [usize; 3]) -> (f64, Traffic) {
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
            .gravity(Vec3::new(0.0, 0.0, -9.81), Box::new(|_: f64| 1.0))
            // Blocks of one size, whatever the number of elements.
            .block_size(4096)
    };
    let options = RunOptions::steps(STEPS[1]).with_step(StepChoice::Unchecked(1e-5));
    let found = ThreadRanks::run(shape.iter().product(), |ranks| {
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
    let elements = (side * side * side) as f64;
    let mut least = SHAPES.map(|_| (f64::INFINITY, Traffic::default()));
    for _ in 0..TURNS {
        for (least, shape) in least.iter_mut().zip(SHAPES) {
            let (time, traffic) = step(side, shape);
            if time < least.0 {
                *least = (time, traffic);
            }
        }
    }
    let of_element =
        |shape: [usize; 3], time: f64| time / (shape.iter().product::<usize>() as f64 * elements);
    let one = of_element(SHAPES[0], least[0].0);
    println!(
        "{elements} bricks a rank: ns of processor time per element and step, over that of one rank"
    );
    for (shape, (time, traffic)) in SHAPES.into_iter().zip(&least) {
        let ns = of_element(shape, *time);
        println!(
            "{:>3} ranks: {ns:.1}, {:.3}; rank 0 shares {} nodes with {} ranks, {:.1} bytes each",
            shape.iter().product::<usize>(),
            ns / one,
            traffic.shared_nodes,
            traffic.neighbours,
            traffic.bytes as f64
                / (traffic.exchanges.max(1) * traffic.shared_nodes.max(1) as u64) as f64,
        );
    }
}
