//! Prints the table of docs/stability.md: every extreme with its figure on the CPU and on lavapipe, and its bound.
//!
//!     cargo run --release --example stability [WORD] > table.md
//!
//! With a word, only the rows whose names hold it. Exits with 1 when a bound does not hold.

#[path = "../tests/stability/bench.rs"]
mod bench;
#[path = "../tests/stability/counts.rs"]
mod counts;
#[path = "../tests/stability/rays.rs"]
mod rays;
#[path = "../tests/stability/scale.rs"]
mod scale;
#[path = "../tests/stability/surfaces.rs"]
mod surfaces;
#[path = "../tests/stability/table.rs"]
mod table;
#[path = "../tests/stability/view.rs"]
mod view;

use std::process::ExitCode;

fn main() -> ExitCode {
    let only = std::env::args().nth(1).unwrap_or_default();
    let (text, holds) = table::markdown(true, &only, |row| eprintln!("{row}"));
    print!("{text}");
    ExitCode::from(u8::from(!holds))
}
