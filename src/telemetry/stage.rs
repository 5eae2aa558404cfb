//! Logging of processing stages and their times with the `log` crate; the program prints them with
//! `-v`.

use std::time::Instant;

/// A stage in progress; logged with its seconds when dropped.
#[must_use]
pub struct Stage {
    name: &'static str,
    begun: Instant,
}

/// Starts a stage. Nested stages are logged in the order in which they end.
pub fn stage(name: &'static str) -> Stage {
    Stage { name, begun: Instant::now() }
}

impl Drop for Stage {
    fn drop(&mut self) {
        log::info!(target: "caustica::stage", "{}: {:.3} s", self.name, self.begun.elapsed().as_secs_f64());
    }
}
