//! Stages of the work and their seconds, for logs (the `log` crate; the program writes them with
//! `-v`).

use std::time::Instant;

/// A stage that is going on; logged with its seconds when dropped.
#[must_use]
pub struct Stage {
    name: &'static str,
    begun: Instant,
}

/// Begins a stage. Stages within one another are logged in the order in which they end.
pub fn stage(name: &'static str) -> Stage {
    Stage { name, begun: Instant::now() }
}

impl Drop for Stage {
    fn drop(&mut self) {
        log::info!(target: "caustica::stage", "{}: {:.3} s", self.name, self.begun.elapsed().as_secs_f64());
    }
}
