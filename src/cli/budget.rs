//! The memory budget option.

use caustica::low_level::memory::{self, Memory};
use clap::Args;

use super::checkpoint::Files;

/// Memory budget of commands that can reduce their memory use.
#[derive(Args, Debug, Default)]
pub struct Budget {
    /// Maximum buffer memory on the device and the host together, e.g. 512MB or 2GiB; larger
    /// renders use tiles and smaller photon batches [default: the available memory]
    #[arg(long, value_name = "BYTES", value_parser = memory::parse)]
    memory_budget: Option<u64>,
}

impl Budget {
    /// Converts the option for a render with the checkpoints `files`. A resumed render keeps its
    /// photon batches.
    pub fn memory(&self, files: &Files) -> Memory {
        Memory {
            budget: self.memory_budget,
            saves: files.keeps(),
            same_batches: files.resumed().is_some(),
        }
    }

    /// Converts the option for a render without checkpoints.
    pub fn alone(&self) -> Memory {
        Memory { budget: self.memory_budget, ..Memory::default() }
    }
}
