//! `caustica preview` in a build without the preview window.

use super::{Done, Failure};

/// Preview a scene in a window (not included in this build)
#[derive(clap::Args)]
#[command(disable_help_flag = true)]
pub struct Arguments {
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, hide = true)]
    rest: Vec<std::ffi::OsString>,
}

/// Explains how to build with the window.
pub fn run(arguments: Arguments) -> Result<Done, Failure> {
    let rest = arguments.rest.iter().map(|word| word.to_string_lossy());
    let line = ["cargo run --release --features preview -- preview".into()].into_iter().chain(rest);
    Err(Failure::wrong_use(
        "this build does not include the preview window",
        &format!("build it with `{}`", line.collect::<Vec<_>>().join(" ")),
    ))
}
