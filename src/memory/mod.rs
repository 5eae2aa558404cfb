//! Bytes that a render takes, counted before they are taken, and how many there may be.

mod system;

pub use system::{address_space, limited};

/// How much memory a render may take.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Memory {
    /// At most so many bytes, on the device and in main memory together. None: on the processor
    /// what the system and the limits of the process leave, else what the device gives.
    pub budget: Option<u64>,
    /// Whether the film is copied on the way, for checkpoints; that of a device that may be lost is
    /// anyway.
    pub saves: bool,
    /// Photons are not traced in smaller batches than the settings say, since their sums would be
    /// rounded otherwise. Without a budget or a limit of the process they never are.
    pub same_batches: bool,
}

impl Memory {
    /// The limit, and in which words it is told, for buffers that are in main memory or not.
    pub fn limit(&self, in_main_memory: bool) -> Option<(u64, &'static str)> {
        match self.budget {
            Some(budget) => Some((budget, "the memory budget")),
            None if in_main_memory => available(),
            None => None,
        }
    }

    /// Whether photons may be traced in smaller batches: where a budget is given, or the process
    /// has a limit.
    pub fn cuts_batches(&self) -> bool {
        !self.same_batches && (self.budget.is_some() || limited().is_some())
    }
}

/// What part of the memory is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// Its purpose.
    pub what: &'static str,
    /// Bytes.
    pub bytes: u64,
    /// What makes it smaller.
    pub mend: &'static str,
}

/// The bytes of all parts.
pub fn total(parts: &[Part]) -> u64 {
    parts.iter().map(|part| part.bytes).fold(0, u64::saturating_add)
}

/// A render that does not fit, however it is cut.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "the render takes at least {}, and {of} is {}; {} of it are for {}: {}",
    words(*.needed), words(*.limit), words(.largest.bytes), .largest.what, .largest.mend
)]
pub struct OverBudget {
    /// Bytes of the least that it takes.
    pub needed: u64,
    /// What sets the limit.
    pub of: &'static str,
    /// Bytes that there may be.
    pub limit: u64,
    /// The part that takes most.
    pub largest: Part,
}

impl OverBudget {
    /// For these parts, as small as they get.
    pub fn new(parts: &[Part], (limit, of): (u64, &'static str)) -> Self {
        let largest = parts.iter().max_by_key(|part| part.bytes);
        let largest = largest.copied().unwrap_or(Part { what: "nothing", bytes: 0, mend: "" });
        Self { needed: total(parts), of, limit, largest }
    }
}

/// A number of bytes for people: 512 MB, 1.46 GB.
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

/// A number of bytes as people write it: 512MB, 1.5 GB, 2GiB, or bytes alone.
///
/// # Errors
/// What is expected.
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

/// Whether so many bytes can be had at once; they are given back.
pub fn can_be_had(bytes: u64) -> bool {
    usize::try_from(bytes).is_ok_and(|bytes| Vec::<u8>::new().try_reserve_exact(bytes).is_ok())
}

/// Most bytes of a file that is read as a whole, where the system does not say what it has left.
const READ_MAX: u64 = 4 << 30;

/// Most bytes of a file that is read as a whole.
pub fn readable() -> u64 {
    available().map_or(READ_MAX, |limit| limit.0)
}

/// Checks that a picture of so many pixels, which take so many bytes each while it is read, can be
/// held.
///
/// # Errors
/// What it takes, and what there is.
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

/// Bytes of main memory that can still be had, by what is free and by the limits of the process and
/// of its control group; and in whose words.
pub fn available() -> Option<(u64, &'static str)> {
    system::free().into_iter().chain(limited()).min_by_key(|limit| limit.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_for_people() {
        for (bytes, told) in [
            (7, "7 bytes"),
            (1500, "1.50 kB"),
            (512_000_000, "512 MB"),
            (99_960_000, "100 MB"),
            (1_460_000_000, "1.46 GB"),
        ] {
            assert_eq!(words(bytes), told);
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
