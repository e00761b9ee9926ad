//! How much memory is free: what the system tells, and what a container or farm lets the process have.
//!
//! Known on Linux alone. What is told is true at that moment; others may take it in the next.

use std::fs::read_to_string;
use std::path::Path;

/// Bytes that may still be taken; none where nobody tells.
pub(crate) fn free() -> Option<u64> {
    let of_system = read_to_string("/proc/meminfo").ok().and_then(|text| available(&text));
    let groups = read_to_string("/proc/self/cgroup").unwrap_or_default();
    let of_groups = groups.lines().filter_map(|line| {
        let mut parts = line.splitn(3, ':').skip(1);
        let (of, group) = (parts.next()?, parts.next()?.trim_start_matches('/'));
        let [root, most, used] = match of {
            "" => ["/sys/fs/cgroup", "memory.max", "memory.current"],
            of if of.split(',').any(|of| of == "memory") => {
                ["/sys/fs/cgroup/memory", "memory.limit_in_bytes", "memory.usage_in_bytes"]
            }
            _ => return None,
        };
        // Within a container its own group is the root, whatever it is called outside. Groups above may allow less.
        let own = Path::new(root).join(group);
        own.ancestors()
            .take_while(|folder| folder.starts_with(root))
            .filter_map(|folder| {
                let read = |name: &str| read_to_string(folder.join(name)).ok();
                left(&read(most)?, &read(used)?, &read("memory.stat").unwrap_or_default())
            })
            .min()
    });
    of_system.into_iter().chain(of_groups).min()
}

/// What `/proc/meminfo` says is available.
fn available(meminfo: &str) -> Option<u64> {
    let line = meminfo.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kib: u64 = line.split_whitespace().next()?.parse().ok()?;
    Some(kib << 10)
}

/// What a control group has left; none where it has no limit. Files that are only kept to be read again make room.
fn left(most: &str, used: &str, stat: &str) -> Option<u64> {
    let number = |text: &str| text.trim().parse::<u64>().ok();
    let most = number(most)?;
    let kept = stat.lines().find_map(|line| number(line.strip_prefix("inactive_file ")?));
    Some(most.saturating_sub(number(used)?.saturating_sub(kept.unwrap_or(0))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_is_read_as_the_system_writes_it() {
        let meminfo = "MemTotal:       16000000 kB\nMemFree: 1 kB\nMemAvailable:    2048 kB\n";
        assert_eq!(available(meminfo), Some(2 << 20));
        assert_eq!(available("MemTotal: 3 kB"), None);
        // 100 of 300 are files that can go: 1000 - (300 - 100).
        assert_eq!(left("1000\n", "300\n", "anon 9\ninactive_file 100\n"), Some(800));
        assert_eq!(left("1000", "2000", ""), Some(0));
        assert_eq!(left("max\n", "300\n", ""), None);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn some_memory_is_free() {
        assert!(free().is_some_and(|bytes| bytes > 1 << 20));
    }
}
