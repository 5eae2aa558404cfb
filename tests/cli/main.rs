//! The command line: commands, options, messages and exit codes, and how the program works with
//! files, signals, terminals, drivers and limits of the system.

#[path = "../support/mod.rs"]
mod support;

mod bench;
mod diff;
mod manners;
mod pictures;
#[cfg(unix)]
mod process;
#[cfg(unix)]
mod process_limits;
mod render;
mod study;
mod tessellate;
mod usage;
