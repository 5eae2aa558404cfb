//! How much memory may be taken.

use caustica::low_level::memory::{self, Memory};
use clap::Args;

use super::checkpoint::Files;

/// The option of commands that can do with less.
#[derive(Args, Debug, Default)]
pub struct Budget {
    /// Most memory for buffers, on the device and in main memory together, as in 512MB or 2GiB;
    /// what does not fit is rendered in tiles, and photons in smaller batches [default: what the
    /// system has left, or the device gives]
    #[arg(long, value_name = "BYTES", value_parser = memory::parse)]
    memory_budget: Option<u64>,
}

impl Budget {
    /// As the library takes it, for a render that is saved and gone on from or not. One that goes
    /// on has the batches that it was begun with.
    pub fn memory(&self, files: &Files) -> Memory {
        Memory {
            budget: self.memory_budget,
            saves: files.keeps(),
            same_batches: files.resumed().is_some(),
        }
    }

    /// The same for one that is neither.
    pub fn alone(&self) -> Memory {
        Memory { budget: self.memory_budget, ..Memory::default() }
    }
}
