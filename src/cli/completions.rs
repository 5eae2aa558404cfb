//! `caustica completions`: completion scripts for shells.

use clap_complete::{Shell, generate};

use super::output::bytes;
use super::{Done, Failure, command};

/// Print a completion script for a shell
#[derive(clap::Args)]
#[command(after_help = HELP)]
pub struct Arguments {
    /// Shell
    shell: Shell,
}

const HELP: &str = "\
Examples:
  caustica completions bash > ~/.local/share/bash-completion/completions/caustica
  caustica completions fish > ~/.config/fish/completions/caustica.fish
  caustica completions zsh > \"${fpath[1]}/_caustica\"";

/// Prints the script.
pub fn run(arguments: Arguments) -> Result<Done, Failure> {
    let mut script = Vec::new();
    generate(arguments.shell, &mut command(), "caustica", &mut script);
    bytes(&script)?;
    Ok(Done::Fully)
}
