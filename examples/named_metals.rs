//! Derives the indices of the named metals from measured spectra.
//!
//! `cargo run --release --example named_metals` prints the lines of `src/scene/named/metals.rs` and
//! the tables of `docs/metals.md`.

#![allow(dead_code)] // the derivation has functions for tests alone

#[path = "named_metals/mod.rs"]
mod named_metals;

use named_metals::fit::fit;
use named_metals::spectra::SPECTRA;

fn main() -> Result<(), String> {
    let fits: Vec<_> = SPECTRA.iter().map(|spectrum| (spectrum, fit(spectrum))).collect();
    println!("Lines of src/scene/named/metals.rs:\n");
    for (spectrum, fit) in &fits {
        println!("{}:", spectrum.name);
        println!("        eta: {},\n        k: {},", digits(fit.eta), digits(fit.k));
    }
    println!("\nTables of docs/metals.md:\n");
    println!("| name | aliases | reflectance R, G, B | eta | k | source | database entry |");
    println!("|---|---|---|---|---|---|---|");
    for (spectrum, fit) in &fits {
        let name = spectrum.name;
        let metal = caustica::low_level::scene::named::metals::metal(name)
            .ok_or(format!("no metal is named {name}"))?;
        let (aliases, source) = (metal.aliases.join(", "), metal.source);
        let [r, eta, k] = [fit.reflectance, fit.eta, fit.k].map(|values| row(values, 3));
        println!("| {name} | {aliases} | {r} | {eta} | {k} | {source} | {} |", spectrum.page);
    }
    println!("\n| name | color before the limit | rms over angles | greatest |");
    println!("|---|---|---|---|");
    for (spectrum, fit) in &fits {
        let (color, rms, max) = (row(fit.color, 3), row(fit.rms, 4), row(fit.max, 4));
        println!("| {} | {color} | {rms} | {max} |", spectrum.name);
    }
    Ok(())
}

/// An array in Rust with the four decimals of the table.
fn digits(values: [f64; 3]) -> String {
    format!("[{}]", row(values, 4))
}

/// Three numbers with this many decimals.
fn row(values: [f64; 3], decimals: usize) -> String {
    values.map(|value| format!("{value:.decimals$}")).join(", ")
}
