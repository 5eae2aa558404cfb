//! Memory of a render, counted before allocation, and the limits on it.

mod system;

pub use system::{KEPT, address_space, check_reserve, limited};

/// Memory limit of a render, and the permitted ways to meet it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Memory {
    /// Greatest number of bytes, on the device and in main memory together. `None`: on the
    /// processor, what the system and the limits of the process leave; on a GPU, what the device
    /// provides.
    pub budget: Option<u64>,
    /// True if the film is copied during the render for checkpoints. It is always copied for a
    /// device that may be lost.
    pub saves: bool,
    /// True if photons must not be traced in smaller batches than the settings request, since this
    /// changes the rounding of their sums. Without a budget or a limit of the process they never
    /// are.
    pub same_batches: bool,
}

impl Memory {
    /// Limit in bytes and its description, for buffers inside or outside main memory.
    pub fn limit(&self, in_main_memory: bool) -> Option<(u64, &'static str)> {
        match self.budget {
            Some(budget) => Some((budget, "the memory budget")),
            None if in_main_memory => available(),
            None => None,
        }
    }

    /// Returns true if photons may be traced in smaller batches: if there is a budget, or a limit
    /// of the process.
    pub fn cuts_batches(&self) -> bool {
        !self.same_batches && (self.budget.is_some() || limited().is_some())
    }
}

/// Memory for one purpose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// Purpose.
    pub what: &'static str,
    /// Size in bytes.
    pub bytes: u64,
    /// Setting that makes it smaller.
    pub mend: &'static str,
}

/// Total bytes of all parts.
pub fn total(parts: &[Part]) -> u64 {
    parts.iter().map(|part| part.bytes).fold(0, u64::saturating_add)
}

/// A render does not fit the memory limit, however it is divided.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "the render takes at least {}, and {of} is {}; {} of it are for {}: {}",
    words(*.needed), words(*.limit), words(.largest.bytes), .largest.what, .largest.mend
)]
pub struct OverBudget {
    /// Least number of bytes that it takes.
    pub needed: u64,
    /// Description of the limit.
    pub of: &'static str,
    /// Limit in bytes.
    pub limit: u64,
    /// Largest part.
    pub largest: Part,
}

impl OverBudget {
    /// Creates the error from the parts at their smallest.
    pub fn new(parts: &[Part], (limit, of): (u64, &'static str)) -> Self {
        let largest = parts.iter().max_by_key(|part| part.bytes);
        let largest = largest.copied().unwrap_or(Part { what: "nothing", bytes: 0, mend: "" });
        Self { needed: total(parts), of, limit, largest }
    }
}

/// Formats a number of bytes for display: 512 MB, 1.46 GB.
pub fn words(bytes: u64) -> String {
    let bytes = bytes as f64;
    let units = [(1e12, "TB"), (1e9, "GB"), (1e6, "MB"), (1e3, "kB")];
    match units.iter().find(|(unit, _)| bytes >= *unit) {
        Some((unit, name)) => {
            let scaled = bytes / unit;
            let decimals = if scaled < 9.995 { 2 } else { usize::from(scaled < 99.95) };
            format!("{scaled:.decimals$} {name}")
        }
        None => format!("{bytes} bytes"),
    }
}

/// Parses a number of bytes with an optional unit: 512MB, 1.5 GB, 2GiB.
///
/// # Errors
/// Description of the expected format.
pub fn parse(text: &str) -> Result<u64, String> {
    let units = [
        ("kib", 10, 0),
        ("mib", 20, 0),
        ("gib", 30, 0),
        ("tib", 40, 0),
        ("kb", 0, 3),
        ("mb", 0, 6),
        ("gb", 0, 9),
        ("tb", 0, 12),
        ("b", 0, 0),
        ("", 0, 0),
    ];
    let lower = text.trim().to_ascii_lowercase();
    let bytes = units.iter().find_map(|(unit, binary, decimal)| {
        let number = lower.strip_suffix(unit)?.trim_end().parse::<f64>().ok()?;
        Some(number * f64::from(2.0_f32.powi(*binary)) * 10_f64.powi(*decimal))
    });
    bytes
        .filter(|bytes| (1.0..9e18).contains(bytes))
        .map(|bytes| bytes as u64)
        .ok_or("expected a number of bytes with its unit, as in 512MB, 1.5GB or 2GiB".to_owned())
}

/// Returns true if this many bytes can be allocated at once; they are freed again.
pub fn can_be_had(bytes: u64) -> bool {
    usize::try_from(bytes).is_ok_and(|bytes| Vec::<u8>::new().try_reserve_exact(bytes).is_ok())
}

/// Limit on the size of a file that is read as a whole, if the system reports no free memory,
/// bytes.
const READ_MAX: u64 = 4 << 30;

/// Limit on the size of a file that is read as a whole, bytes.
pub fn readable() -> u64 {
    available().map_or(READ_MAX, |limit| limit.0)
}

/// Checks that an image can be read if each pixel takes `bytes_each` bytes in the process.
///
/// # Errors
/// The required and the available number of bytes.
pub fn check_pixels(width: u64, height: u64, bytes_each: u64) -> Result<(), String> {
    let needed = width.saturating_mul(height).saturating_mul(bytes_each);
    match available() {
        Some((limit, of)) if needed > limit => {
            let (needed, limit) = (words(needed), words(limit));
            Err(format!("{width} x {height} pixels take {needed} to read, and {of} is {limit}"))
        }
        _ => Ok(()),
    }
}

/// Bytes of main memory that are still available, by the system's free memory and by the limits of
/// the process and its control group; with a description of the tightest limit.
pub fn available() -> Option<(u64, &'static str)> {
    system::free().into_iter().chain(limited()).min_by_key(|limit| limit.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_for_people() {
        for (bytes, expected) in [
            (7, "7 bytes"),
            (1500, "1.50 kB"),
            (512_000_000, "512 MB"),
            (99_960_000, "100 MB"),
            (1_460_000_000, "1.46 GB"),
        ] {
            assert_eq!(words(bytes), expected);
        }
    }

    #[test]
    fn bytes_of_people() {
        for (text, bytes) in [
            ("512MB", 512_000_000),
            ("512 mb", 512_000_000),
            ("1.5GB", 1_500_000_000),
            ("2GiB", 2 << 30),
            ("64kib", 64 << 10),
            ("1000", 1000),
            ("1000B", 1000),
            ("1e9", 1_000_000_000),
        ] {
            assert_eq!(parse(text), Ok(bytes), "{text}");
        }
        for bad in ["", "MB", "-1MB", "0", "nan", "inf", "1e30", "5 MBytes", "1.2.3GB"] {
            assert!(parse(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn the_largest_part_is_named() {
        let part = |what, bytes| Part { what, bytes, mend: "make it smaller" };
        let over = OverBudget::new(
            &[part("a", 10), part("b", 2_000_000), part("c", 30)],
            (1_000_000, "the memory budget"),
        );
        assert_eq!(
            over.to_string(),
            "the render takes at least 2.00 MB, and the memory budget is 1.00 MB; 2.00 MB of it are for b: make it smaller"
        );
    }
}
