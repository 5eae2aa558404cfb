//! Panic messages.

use std::backtrace::{Backtrace, BacktraceStatus};
use std::panic::{self, PanicHookInfo};

use super::output::{message, paragraph};

/// Installs a panic hook that prints the source location relative to its crate. The default message
/// would reveal folders of the build machine.
pub fn begin() {
    panic::set_hook(Box::new(|info| {
        message(format_args!("internal error in caustica: {}", text(info)));
        let trace = Backtrace::capture();
        match trace.status() {
            BacktraceStatus::Captured => paragraph(trace),
            _ => message("please report this, if possible with RUST_BACKTRACE=1 set"),
        }
    }));
}

fn text(info: &PanicHookInfo) -> String {
    let payload = info.payload();
    let owned = || payload.downcast_ref::<String>().map(String::as_str);
    let what = payload
        .downcast_ref::<&str>()
        .copied()
        .or_else(owned)
        .unwrap_or("panic payload is not text");
    match info.location() {
        Some(place) => format!("{what} ({}:{})", short(place.file()), place.line()),
        None => what.to_owned(),
    }
}

/// Source path from its crate on, without the folders of the build machine.
fn short(file: &str) -> &str {
    let file = file
        .strip_prefix("/rustc/")
        .and_then(|rest| rest.split_once('/'))
        .map_or(file, |(_, rest)| rest);
    let libraries =
        file.split_once("/registry/src/").or_else(|| file.split_once("/git/checkouts/"));
    match libraries.and_then(|(_, rest)| rest.split_once('/')) {
        Some((_, rest)) => rest,
        None if !file.starts_with('/') => file,
        // this program, built from another folder
        None => file.rfind("/src/").map_or(file, |at| &file[at + 1..]),
    }
}

/// Theory: independent of the build folder, the crate name and the path below it remain.
#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_of_the_machine_are_left_out() {
        for (file, shown) in [
            ("src/cli/mod.rs", "src/cli/mod.rs"),
            ("/home/me/caustica/src/cli/mod.rs", "src/cli/mod.rs"),
            (
                "/home/me/.cargo/registry/src/index.crates.io-1949/wgpu-30.0.0/src/api.rs",
                "wgpu-30.0.0/src/api.rs",
            ),
            ("/home/me/.cargo/git/checkouts/wgpu-ab12/0c1/src/api.rs", "0c1/src/api.rs"),
            ("/rustc/59807616e/library/core/src/option.rs", "library/core/src/option.rs"),
        ] {
            assert_eq!(short(file), shown);
        }
    }
}
