//! Whether a program was started as one of several processes.

/// Variables of the environment in which launchers give each process the number of processes: Open MPI, MPICH and its
/// relatives (also by Slurm's PMI), MVAPICH.
const COUNTS: [&str; 3] = ["OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "MV2_COMM_WORLD_SIZE"];
/// The variable that Slurm sets in processes that PMIx connects, and that of their number.
const PMIX: [&str; 2] = ["PMIX_RANK", "SLURM_STEP_NUM_TASKS"];

/// Number of processes as which an MPI launcher has started this program; none if none has started it.
pub fn processes() -> Option<usize> {
    processes_of(|name| std::env::var(name).ok())
}

fn processes_of(variable: impl Fn(&str) -> Option<String>) -> Option<usize> {
    let number = |name: &str| variable(name)?.trim().parse().ok();
    let [rank, count] = PMIX;
    let by_pmix = || variable(rank).and_then(|_| number(count));
    COUNTS.into_iter().find_map(number).or_else(by_pmix)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The number of processes is found under every launcher, and none without a launcher.
    #[test]
    fn launchers_are_recognised() {
        let found = |set: &[(&str, &str)]| {
            let set = set.to_vec();
            processes_of(move |name| {
                let found = set.iter().find(|(own, _)| *own == name);
                found.map(|(_, value)| (*value).to_owned())
            })
        };
        assert_eq!(found(&[]), None);
        assert_eq!(found(&[("OMPI_COMM_WORLD_SIZE", "4")]), Some(4));
        assert_eq!(found(&[("PMI_SIZE", " 3\n")]), Some(3));
        // Slurm has a number of tasks in batch scripts too, which are one process.
        assert_eq!(found(&[("SLURM_STEP_NUM_TASKS", "8")]), None);
        let pmix = [("PMIX_RANK", "0"), ("SLURM_STEP_NUM_TASKS", "8")];
        assert_eq!(found(&pmix), Some(8));
    }
}
