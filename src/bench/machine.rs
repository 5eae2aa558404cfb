//! What a bench runs on, as far as the system tells.

use std::fs;

use serde::Serialize;

/// The machine beside its graphics adapters.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Machine {
    /// Operating system, with its release where that is told.
    pub os: String,
    /// Instruction set.
    pub architecture: &'static str,
    /// The processor's name.
    pub processor: Option<String>,
    /// Threads of the CPU engine.
    pub threads: usize,
}

impl Machine {
    /// This one.
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

/// The most main memory that this program has held since [`forget_peak`], where the system tells
/// (Linux).
pub fn peak_resident_bytes() -> Option<u64> {
    let kib = field("/proc/self/status", "VmHWM")?;
    kib.strip_suffix("kB")?.trim().parse::<u64>().ok().map(|kib| kib << 10)
}

/// Lets the peak begin anew from what is held now, where the system can (Linux).
pub fn forget_peak() {
    // one that stays is only too high
    let _ = fs::write("/proc/self/clear_refs", "5");
}

/// What follows `key` and a separator in the first line of a file that begins so.
fn field(file: &str, key: &str) -> Option<String> {
    let text = fs::read_to_string(file).ok()?;
    let value = text.lines().find_map(|line| line.strip_prefix(key))?;
    Some(value.trim_start_matches([' ', '\t', ':']).trim().to_owned())
        .filter(|value| !value.is_empty())
}
