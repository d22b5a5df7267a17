//! Memory of the process, where the system tells (Linux).

use std::fs;

/// Lets the peak begin anew.
pub(crate) fn forget_peak() {
    // Where it cannot, the peak is that of the whole run: an upper bound still.
    let _ = fs::write("/proc/self/clear_refs", "5");
}

/// The most bytes that were resident since [`forget_peak`].
pub(crate) fn peak() -> Option<u64> {
    status("VmHWM:")
}

/// The bytes that are resident now.
pub(crate) fn resident() -> Option<u64> {
    status("VmRSS:")
}

/// The bytes of address space that the process has taken.
pub(crate) fn address_space() -> Option<u64> {
    status("VmSize:")
}

/// The bytes of memory that the machine has.
pub(crate) fn of_machine() -> Option<u64> {
    entry(&fs::read_to_string("/proc/meminfo").ok()?, "MemTotal:")
}

fn status(name: &str) -> Option<u64> {
    entry(&fs::read_to_string("/proc/self/status").ok()?, name)
}

/// A line "name 123 kB", in bytes.
fn entry(text: &str, name: &str) -> Option<u64> {
    let value = text.lines().find_map(|line| line.strip_prefix(name))?;
    Some(value.split_whitespace().next()?.parse::<u64>().ok()? * 1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_read_in_bytes() {
        let text = "VmPeak:\t  100 kB\nVmHWM:\t    12 kB\nVmRSS: none\n";
        assert_eq!((entry(text, "VmHWM:"), entry(text, "VmRSS:"), entry(text, "VmData:")), (Some(12_288), None, None));
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn the_peak_follows_what_is_taken_and_begins_anew() {
        const BYTES: usize = 64 << 20;
        let taken = std::hint::black_box(vec![1u8; BYTES]);
        let high = peak().unwrap();
        assert!(high >= BYTES as u64);
        drop(taken);
        forget_peak();
        // Other tests of this process may take some meanwhile, but hardly all of it.
        assert!(peak().unwrap() <= high, "{:?} after {high}", peak());
    }
}
