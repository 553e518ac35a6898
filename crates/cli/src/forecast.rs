//! Printed forecast of a run on several ranks.

use std::time::Duration;

use powerhouse::model::RankForecast;
use powerhouse_study::CheckReport;
use powerhouse_study::text::{bytes, duration};

use crate::terminal::say;

/// Assumed time of a message (s) and rates (bytes/s) of the network, and of the processor in packing and unpacking.
const LATENCY: f64 = 2e-6;
const NETWORK: f64 = 10e9;
const PACKING: f64 = 4e9;
/// Memory (bytes) of the mesh in one process with its place in the blocks: position and number of a node; nodes, number and
/// place in the blocks of an element.
const OF_MESH: Whole = Whole([64, 80, 0]);
/// What every rank but the first has of the whole body during a run beside the mesh, and while it reads a mesh file as text:
/// fitted to the memory of 16 ranks with 729,000 bricks and 750,000 tetrahedra.
const HELD: Whole = Whole([25, 62, 0]);
const READING: Whole = Whole([125, 130, 25]);
/// Memory (bytes) of the MPI library and the program in every rank.
const LIBRARY: u64 = 12 << 20;

/// Memory (bytes) for a node, an element and a node of an element.
struct Whole([u64; 3]);

impl Whole {
    fn of(&self, check: &CheckReport) -> u64 {
        let counts = [check.nodes, check.elements, check.element_nodes];
        let bytes = self.0.iter().zip(counts);
        bytes.map(|(bytes, count)| bytes * count as u64).sum()
    }
}

/// Prints elements, shared nodes and messages of the ranks, and what a step costs by the timed steps of a check; of a scene
/// whose mesh is packed or not.
pub(crate) fn print(ranks: &[RankForecast], check: &CheckReport, is_packed: bool) {
    let count = ranks.len();
    say!("\non {count} rank{}", if count == 1 { "" } else { "s" });
    let range = |of: fn(&RankForecast) -> usize| {
        let (least, most) = ranks
            .iter()
            .map(of)
            .fold((usize::MAX, 0), |(low, high), n| (low.min(n), high.max(n)));
        (least, most)
    };
    let elements = range(|rank| rank.elements);
    let shared = range(|rank| rank.shared_nodes);
    let messages = range(|rank| rank.messages);
    let sent = range(|rank| rank.bytes);
    say!("  {} to {} elements", elements.0, elements.1);
    say!(
        "  {} to {} nodes shared with other ranks",
        shared.0,
        shared.1
    );
    say!(
        "  {} to {} messages a step with {} to {} bytes together",
        messages.0,
        messages.1,
        sent.0,
        sent.1
    );
    // As if a rank had the threads of the timed steps.
    let whole = check.cost.wall_time.as_secs_f64() / check.cost.steps.max(1) as f64;
    let exchange = |rank: &RankForecast| {
        let (messages, sent) = (rank.messages as f64, rank.bytes as f64);
        let under_way = LATENCY * messages + sent / NETWORK;
        2.0 * sent / PACKING + (under_way - whole * rank.inner_work).max(0.0)
    };
    let step = |rank: &&RankForecast| whole * rank.work + exchange(rank);
    let slowest = ranks.iter().max_by(|a, b| step(a).total_cmp(&step(b)));
    let slowest = slowest.copied().unwrap_or_default();
    let (step, share) = (step(&&slowest), slowest.work);
    say!(
        "  the slowest: {:.1} % of the work, {:.1} % of it in blocks that share no node, computed while messages travel",
        100.0 * share,
        100.0 * slowest.inner_work / share.max(f64::MIN_POSITIVE)
    );
    say!(
        "  about {:.3} ms a step, {:.3} ms of them exchange, {} for the run: efficiency {:.0} %, if every rank has as many threads \
         as this check and a message takes {:.0} us and {:.0} GB/s",
        1e3 * step,
        1e3 * exchange(&slowest),
        duration(Duration::from_secs_f64(step * check.cost.steps as f64)),
        100.0 * whole / (step * count as f64),
        1e6 * LATENCY,
        NETWORK / 1e9
    );
    let all: usize = ranks.iter().map(|rank| rank.elements).sum();
    let most = elements.1 as f64 / all.max(1) as f64;
    let own = check.cost.memory.saturating_sub(OF_MESH.of(check)) as f64 * most;
    let (held, mesh) = (HELD.of(check) + LIBRARY, check.cost.memory_of_mesh);
    let running = held + own as u64;
    if is_packed {
        say!(
            "  about {} memory a rank, {} of them for the whole body, beside {} of the packed mesh for all ranks of a machine; the first rank has more while it divides the mesh",
            bytes(running),
            bytes(held),
            bytes(mesh)
        );
        return;
    }
    let reading = READING.of(check) + LIBRARY;
    say!(
        "  about {} memory a rank: {} while it reads the mesh file, which every rank reads as a whole, and {} during the run, {} of them for the whole body; with a packed mesh about {}",
        bytes((running + mesh).max(reading)),
        bytes(reading),
        bytes(running + mesh),
        bytes(held + mesh),
        bytes(running)
    );
}
