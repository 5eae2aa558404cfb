//! Description of the machine that a benchmark runs on.

use std::fs;

use serde::Serialize;

/// A machine, without its graphics adapters.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Machine {
    /// Operating system, with its release if known.
    pub os: String,
    /// Instruction set.
    pub architecture: &'static str,
    /// Processor name, if known.
    pub processor: Option<String>,
    /// Number of threads of the CPU engine.
    pub threads: usize,
}

impl Machine {
    /// Describes the current machine.
    pub fn this() -> Self {
        let release =
            field("/etc/os-release", "PRETTY_NAME=").map(|name| name.trim_matches('"').to_owned());
        let os = std::env::consts::OS;
        Self {
            os: release.map_or(os.to_owned(), |release| format!("{os}, {release}")),
            architecture: std::env::consts::ARCH,
            processor: field("/proc/cpuinfo", "model name")
                .or(std::env::var("PROCESSOR_IDENTIFIER").ok()),
            threads: rayon::current_num_threads(),
        }
    }
}

/// Peak resident memory of this process since [`forget_peak`], in bytes; Linux only.
pub fn peak_resident_bytes() -> Option<u64> {
    let kib = field("/proc/self/status", "VmHWM")?;
    kib.strip_suffix("kB")?.trim().parse::<u64>().ok().map(|kib| kib << 10)
}

/// Resets the peak resident memory to the current value; Linux only.
pub fn forget_peak() {
    // if this fails, the peak is only overestimated
    let _ = fs::write("/proc/self/clear_refs", "5");
}

/// Text after `key` and a separator in the first line of a file that starts with `key`.
fn field(file: &str, key: &str) -> Option<String> {
    let text = fs::read_to_string(file).ok()?;
    let value = text.lines().find_map(|line| line.strip_prefix(key))?;
    Some(value.trim_start_matches([' ', '\t', ':']).trim().to_owned())
        .filter(|value| !value.is_empty())
}
