//! Runs on several ranks: the processes of `mpirun -n 4 powerhouse run scene.toml`.
//!
//! Every process reads the scene and takes the same steps. Rank 0 writes the results and what is to be read; the others
//! follow in silence.

use std::num::NonZeroUsize;
use std::sync::Arc;

use powerhouse::engine::ExplicitOnRanks;
use powerhouse::io::peak_memory;

use crate::Outcome;

/// Place of this process among those of a run.
#[derive(Clone, Default)]
pub(crate) struct Place {
    /// The engine of its rank; none for the only process.
    engine: Option<Arc<ExplicitOnRanks>>,
}

impl Place {
    /// Whether this process writes the results.
    pub(crate) fn leads(&self) -> bool {
        self.engine.as_ref().is_none_or(|engine| engine.rank() == 0)
    }

    /// The engine of this process among several.
    pub(crate) fn engine(&self) -> Option<&Arc<ExplicitOnRanks>> {
        self.engine.as_ref()
    }

    /// The result of this process if all have succeeded; a failure of one is one of all.
    pub(crate) fn agree<T>(
        &self,
        result: Result<T, Box<dyn std::error::Error>>,
    ) -> Result<T, Box<dyn std::error::Error>> {
        let Some(engine) = &self.engine else {
            return result;
        };
        let failure = result
            .as_ref()
            .err()
            .map(|error| crate::explain(error.as_ref()));
        let agreed = engine.agree(failure.as_deref());
        let value = result?;
        agreed?;
        Ok(value)
    }

    /// Peak memory (bytes) of each process so far, in the order of ranks; none where the system does not report it.
    pub(crate) fn peak_memory(&self) -> Option<Vec<u64>> {
        let own = peak_memory();
        let Some(engine) = &self.engine else {
            return own.map(|bytes| vec![bytes]);
        };
        let all = engine.of_all(own.unwrap_or_default()).ok()?;
        all.iter().all(|bytes| *bytes > 0).then_some(all)
    }
}

/// Refuses to run a command other than `run` and `sweep` on several processes, of which each would do the same.
pub(crate) fn refuse_processes() -> Result<(), Box<dyn std::error::Error>> {
    match powerhouse::mpi::processes() {
        Some(count) if count > 1 => Err(format!(
            "{count} processes were started: of all commands `run` and `sweep` alone are computed by several"
        )
        .into()),
        _ => Ok(()),
    }
}

/// Calls a function on every process of a run; an error of one ends all.
pub(crate) fn on_all(work: impl FnOnce(&Place) -> Outcome + Send) -> Outcome {
    match powerhouse::mpi::processes() {
        Some(count) if count > 1 => on_processes(count, None, work),
        _ => work(&Place::default()),
    }
}

/// Calls a function on every process of a sweep, with its place among those that compute a case together: itself alone,
/// unless a number of them is given.
pub(crate) fn in_groups(
    size: Option<NonZeroUsize>,
    work: impl FnOnce(&Place) -> Outcome + Send,
) -> Outcome {
    let Some(size) = size.filter(|size| size.get() > 1) else {
        return work(&Place::default());
    };
    match powerhouse::mpi::processes() {
        Some(count) if count > 1 => on_processes(count, Some(size), work),
        _ => Err(format!(
            "--ranks-per-case {size} needs so many processes or a multiple of it, such as those of `mpirun -n {size} powerhouse sweep SCENE --ranks-per-case {size}`"
        )
        .into()),
    }
}

/// Refuses processes that know nothing of each other: each would write the same files.
#[cfg(not(feature = "mpi"))]
fn on_processes(
    count: usize,
    _group: Option<NonZeroUsize>,
    _work: impl FnOnce(&Place) -> Outcome + Send,
) -> Outcome {
    Err(format!(
        "{count} processes were started, but this powerhouse was built without MPI: build it with \
         `cargo build --release --features mpi`, or start it as one process"
    )
    .into())
}

#[cfg(feature = "mpi")]
fn on_processes(
    _count: usize,
    group: Option<NonZeroUsize>,
    work: impl FnOnce(&Place) -> Outcome + Send,
) -> Outcome {
    use std::process::ExitCode;

    use powerhouse::mpi::with_groups;

    use crate::{FAILED, terminal};

    let on_rank = |ranks: powerhouse::mpi::MpiRanks| {
        let engine = Arc::new(ExplicitOnRanks::new(Box::new(ranks)));
        let rank = engine.rank();
        if rank > 0 {
            terminal::mute();
        }
        let place = Place {
            engine: Some(engine),
        };
        let outcome = work(&place);
        outcome.map_err(|error| {
            let text = crate::explain(error.as_ref());
            // Printed before any process ends: `mpirun` kills the others when one ends with a failure.
            if rank == 0 {
                terminal::aside(format_args!("{text}"));
            }
            (rank, text)
        })
    };
    // A failure of one process alone, which ends the others.
    let report = |(rank, text): &(usize, String)| {
        if *rank > 0 {
            terminal::aside(format_args!("rank {rank}: {text}"));
        }
    };
    let ended = with_groups(group, on_rank, report)?;
    Ok(ended.unwrap_or_else(|_| ExitCode::from(FAILED)))
}
