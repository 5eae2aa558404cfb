//! How much memory may be taken.

use caustica::memory::{self, Memory};
use clap::Args;

/// The option of commands that can do with less.
#[derive(Args, Debug, Default)]
pub struct Budget {
    /// Most memory for buffers, on the device and beside it together, as in 512MB or 2GiB; what does not fit is rendered in tiles, and
    /// photons in smaller batches [default: what the system has left, or the device gives]
    #[arg(long, value_name = "BYTES", value_parser = memory::parse)]
    memory_budget: Option<u64>,
}

impl Budget {
    /// As the library takes it, for a render that is saved on the way or not.
    pub fn memory(&self, saves: bool) -> Memory {
        Memory { budget: self.memory_budget, saves, same_batches: false }
    }
}
