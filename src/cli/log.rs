//! Logs on standard error: `-v` logs the device and the stages with their times, `-vv` also each
//! pass.

use std::sync::OnceLock;
use std::time::Instant;

use log::{Level, LevelFilter, Log, Metadata, Record};

use super::output::paragraph;

/// Prefix of the targets of the program's records.
const OWN: &str = "caustica";

/// Writes selected records as lines: seconds since the start, level, target, text.
struct Writer {
    begun: OnceLock<Instant>,
}

static WRITER: Writer = Writer { begun: OnceLock::new() };

/// Starts logging at the level of `verbosity` times `-v`.
pub fn begin(verbosity: u8) {
    if verbosity == 0 {
        return;
    }
    WRITER.begun.get_or_init(Instant::now);
    if log::set_logger(&WRITER).is_ok() {
        log::set_max_level(if verbosity == 1 { LevelFilter::Info } else { LevelFilter::Debug });
    }
}

/// Returns true if logging is enabled.
pub fn is_on() -> bool {
    log::max_level() > LevelFilter::Off
}

/// Selects records. Libraries log one level less than the program: warnings with `-v`, information
/// with `-vv`.
fn wanted(level: Level, target: &str, most: LevelFilter) -> bool {
    let own = target.split("::").next() == Some(OWN);
    let most = match (own, most) {
        (true, most) => most,
        (false, LevelFilter::Debug | LevelFilter::Trace) => LevelFilter::Info,
        (false, _) => LevelFilter::Warn,
    };
    level <= most
}

impl Log for Writer {
    fn enabled(&self, metadata: &Metadata) -> bool {
        wanted(metadata.level(), metadata.target(), log::max_level())
    }

    fn log(&self, record: &Record) {
        if self.enabled(record.metadata()) {
            let seconds = self.begun.get().map_or(0.0, |begun| begun.elapsed().as_secs_f64());
            let level = record.level().as_str().to_ascii_lowercase();
            paragraph(format_args!(
                "{seconds:9.3} s {level:<5} {}: {}",
                record.target().replace("::low_level::", "::"),
                record.args()
            ));
        }
    }

    fn flush(&self) {}
}

/// Theory: a library's records are treated as the program's records one level lower.
#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn libraries_are_quieter() {
        let (v, vv) = (LevelFilter::Info, LevelFilter::Debug);
        assert!(
            wanted(Level::Info, "caustica::stage", v)
                && !wanted(Level::Debug, "caustica::device", v)
        );
        assert!(wanted(Level::Debug, "caustica::device", vv));
        assert!(wanted(Level::Warn, "wgpu_hal::vulkan", v) && !wanted(Level::Info, "wgpu_core", v));
        assert!(wanted(Level::Info, "wgpu_core", vv) && !wanted(Level::Debug, "wgpu_core", vv));
        assert!(!wanted(Level::Info, "caustically", v), "a longer name is a different crate");
    }
}
