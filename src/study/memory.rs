//! How much memory this process has used at most, where the operating system tells.

use std::fs::OpenOptions;
use std::io::Write;

/// Lets the peak start anew from what is in use now; whether the system does that, and tells the peak.
///
/// Linux does, where a process may write to its own `clear_refs` (proc(5): `5` resets the peak of the resident set).
pub(super) fn restart_peak() -> bool {
    let restarted = OpenOptions::new()
        .write(true)
        .open("/proc/self/clear_refs")
        .and_then(|mut file| file.write_all(b"5"));
    restarted.is_ok() && peak_bytes().is_some()
}

/// The largest resident set since the start, or since the peak started anew.
pub(super) fn peak_bytes() -> Option<u64> {
    peak_of(&std::fs::read_to_string("/proc/self/status").ok()?)
}

fn peak_of(status: &str) -> Option<u64> {
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kilobytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(1024 * kilobytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_peak_is_read_from_the_status_of_a_process() {
        let status =
            "Name:\tphotosurface\nVmPeak:\t  9000 kB\nVmHWM:\t    1234 kB\nVmRSS:\t     900 kB\n";
        assert_eq!(peak_of(status), Some(1234 * 1024));
        assert_eq!(peak_of("Name:\tphotosurface\n"), None);
        assert_eq!(peak_of("VmHWM:\tmuch\n"), None);
    }

    /// Other tests run beside this one: what they give back may be as much as what this one takes.
    #[test]
    fn what_is_used_meanwhile_counts() {
        if !restart_peak() {
            return;
        }
        const BYTES: usize = 64 << 20;
        // Nothing is resident until it is written to.
        let used = vec![1u8; BYTES];
        let peak = peak_bytes().unwrap();
        assert_eq!(
            used.iter().map(|&byte| usize::from(byte)).sum::<usize>(),
            BYTES
        );
        assert!((BYTES as u64..1 << 40).contains(&peak), "{peak}");
    }
}
