//! `caustica preview` in a program that was built without the window.

use super::{Done, Failure};

/// Open a window on a scene (this program was built without it)
#[derive(clap::Args)]
#[command(disable_help_flag = true)]
pub struct Arguments {
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, hide = true)]
    rest: Vec<std::ffi::OsString>,
}

/// Says how to build the window.
pub fn run(arguments: Arguments) -> Result<Done, Failure> {
    let rest = arguments.rest.iter().map(|word| word.to_string_lossy());
    let line = ["cargo run --release --features preview -- preview".into()].into_iter().chain(rest);
    Err(Failure::wrong_use(
        "this program was built without the preview window",
        &format!("build it once with `{}`", line.collect::<Vec<_>>().join(" ")),
    ))
}
