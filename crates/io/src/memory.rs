//! Memory that the system can give to a program, and that a program has taken.

use std::fs;
use std::path::Path;

/// Memory that the system can give to this program (bytes): what is available without swapping, at most the limit of its
/// control group. None where the system does not report it; so far only Linux does.
pub fn available_memory() -> Option<u64> {
    let available = of_meminfo(&fs::read_to_string("/proc/meminfo").ok()?)?;
    let group = fs::read_to_string("/proc/self/cgroup").unwrap_or_default();
    let limits = limit_files(&group).into_iter();
    let limits = limits.filter_map(|file| fs::read_to_string(file).ok()?.trim().parse().ok());
    Some(limits.fold(available, u64::min))
}

/// Peak memory of this program since its start (bytes), mapped files included as far as they were in memory. None where the
/// system does not report it; so far only Linux does.
pub fn peak_memory() -> Option<u64> {
    of_line(&fs::read_to_string("/proc/self/status").ok()?, "VmHWM:")
}

/// The available memory (bytes) in the text of `/proc/meminfo`.
fn of_meminfo(text: &str) -> Option<u64> {
    of_line(text, "MemAvailable:")
}

/// The memory (bytes) of the line of a text that begins with a name.
fn of_line(text: &str, name: &str) -> Option<u64> {
    let mut lines = text.lines();
    let value = lines.find_map(|line| line.strip_prefix(name))?;
    let kilobytes: u64 = value.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(1024 * kilobytes)
}

/// Files that may have the memory limit of a program, from the text of its `/proc/self/cgroup`: those of its own control
/// group and of the groups around it, in both versions of control groups.
fn limit_files(group: &str) -> Vec<String> {
    let mut files = Vec::new();
    for line in group.lines() {
        let mut fields = line.splitn(3, ':').skip(1);
        let (Some(controllers), Some(path)) = (fields.next(), fields.next()) else {
            continue;
        };
        let (root, name) = match controllers {
            "" => ("/sys/fs/cgroup", "memory.max"),
            "memory" => ("/sys/fs/cgroup/memory", "memory.limit_in_bytes"),
            _ => continue,
        };
        let groups = Path::new(path).ancestors();
        files.extend(groups.map(|group| {
            let group = group.to_string_lossy();
            format!("{root}{}/{name}", group.trim_end_matches('/'))
        }));
    }
    files
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Available memory is read in kilobytes; a text without it says nothing.
    #[test]
    fn available_memory_is_read() {
        let text = "MemTotal:       24684096 kB\nMemAvailable:   22297704 kB\nBuffers: 1 kB\n";
        assert_eq!(of_meminfo(text), Some(22_297_704 * 1024));
        assert_eq!(of_meminfo("MemTotal: 3 kB\n"), None);
        assert_eq!(available_memory().is_some(), cfg!(target_os = "linux"));
    }

    /// The peak is at least what a program holds.
    #[test]
    fn the_peak_covers_what_is_held() {
        assert_eq!(
            of_line("Name:\tx\nVmHWM:\t  12 kB\n", "VmHWM:"),
            Some(12 * 1024)
        );
        let held = std::hint::black_box(vec![1u8; 64 << 20]);
        let peak = peak_memory();
        assert_eq!(peak.is_some(), cfg!(target_os = "linux"));
        assert!(peak.is_none_or(|peak| peak >= std::hint::black_box(&held).len() as u64));
    }

    /// The limit of a program is that of its control group or of any group around it.
    #[test]
    fn limits_of_control_groups_are_found() {
        let files = limit_files("4:memory:/a/b\n2:cpu,cpuacct:/\n0::/job\n");
        let expected = [
            "/sys/fs/cgroup/memory/a/b/memory.limit_in_bytes",
            "/sys/fs/cgroup/memory/a/memory.limit_in_bytes",
            "/sys/fs/cgroup/memory/memory.limit_in_bytes",
            "/sys/fs/cgroup/job/memory.max",
            "/sys/fs/cgroup/memory.max",
        ];
        assert_eq!(files, expected);
    }
}
