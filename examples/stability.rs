//! Prints the table of docs/stability.md: each extreme case with its measured value on the CPU and
//! on lavapipe, and its bound.
//!
//!     cargo run --release --example stability [WORD] > table.md
//!
//! WORD selects the rows whose names contain it. Exits with code 1 if a bound is exceeded.

#[path = "../tests/physics/stability/bench.rs"]
mod bench;
#[path = "../tests/support/brute_force.rs"]
#[allow(dead_code)] // tests use the rest
mod brute_force;
#[path = "../tests/physics/stability/counts.rs"]
mod counts;
#[path = "../tests/physics/everything.rs"]
mod everything;
#[path = "../tests/physics/stability/grazing.rs"]
mod grazing;
#[path = "../tests/physics/stability/rays.rs"]
mod rays;
#[path = "../tests/support/revolution/mod.rs"]
mod revolution;
#[path = "../tests/physics/stability/scale.rs"]
mod scale;
#[path = "../tests/physics/stability/surfaces.rs"]
mod surfaces;
#[path = "../tests/physics/stability/table.rs"]
mod table;
#[path = "../tests/physics/stability/view.rs"]
mod view;

use std::process::ExitCode;

use bench::{Bench, On};
use table::sections;

fn main() -> ExitCode {
    let only = std::env::args().nth(1).unwrap_or_default();
    let holds = print_table(&only);
    ExitCode::from(u8::from(!holds))
}

/// Measures all rows on both devices and prints them as Markdown tables. Returns true if all bounds
/// hold.
fn print_table(only: &str) -> bool {
    let benches = [On::Cpu, On::Software].map(|on| Bench::new(on, true));
    let mut holds = true;
    for (section, rows) in sections() {
        if rows.iter().all(|row| !row.name.contains(only)) {
            continue;
        }
        let mut text = format!(
            "## {section}\n\n| extreme | figure | CPU | lavapipe | bound |\n|---|---|---|---|---|\n"
        );
        let mut notes = String::new();
        for row in rows.iter().filter(|row| row.name.contains(only)) {
            eprintln!("{}", row.name);
            let figures = benches.each_ref().map(|bench| (row.measure)(bench));
            holds &= figures.iter().all(|figure| row.admits(figure));
            let [cpu, software] = figures.each_ref().map(|figure| {
                let mark = if row.admits(figure) { "" } else { " **fails**" };
                format!("{}{mark}", number(figure.value))
            });
            text += &format!(
                "| {} | {} | {cpu} | {software} | {} |\n",
                row.name,
                row.unit,
                number(row.bound)
            );
            notes += &format!("- *{}*: {}", row.name, row.how);
            let [cpu, software] = figures.map(|figure| figure.note);
            if !cpu.is_empty() {
                notes += &format!(" {cpu}");
            }
            if software != cpu && !software.is_empty() {
                notes += &format!(" lavapipe: {software}");
            }
            notes += "\n";
        }
        println!("{text}\n{notes}");
    }
    holds
}

fn number(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        1e-2..1e4 if value.fract() == 0.0 => format!("{value}"),
        0.1..1e4 => format!("{value:.2}"),
        _ => format!("{value:.1e}"),
    }
}
