//! `caustica man`: manual pages, generated from the text of `--help`.

use std::path::{Path, PathBuf};

use caustica::low_level::film::FileError;
use caustica::low_level::film::file::write_whole;
use clap_mangen::Man;

use super::output::{bytes, result};
use super::{Done, Failure, command};

/// Print the manual page, or write the pages of all commands to a folder
#[derive(clap::Args)]
#[command(after_help = HELP)]
pub struct Arguments {
    /// Existing folder to write to: caustica.1, caustica-render.1 and so on
    #[arg(value_name = "DIR")]
    folder: Option<PathBuf>,
}

const HELP: &str = "\
Examples:
  caustica man | man -l -
  mkdir -p ~/.local/share/man/man1 && caustica man ~/.local/share/man/man1";

/// Prints or writes the pages.
pub fn run(arguments: Arguments) -> Result<Done, Failure> {
    let mut root = command().disable_help_subcommand(true);
    root.build();
    let Some(folder) = &arguments.folder else {
        bytes(&text(&page(root), Path::new("standard output"))?)?;
        return Ok(Done::Fully);
    };
    let commands: Vec<_> = root.get_subcommands().cloned().collect();
    for page in std::iter::once(root).chain(commands).map(page) {
        let file = folder.join(page.get_filename());
        write_whole(&file, &text(&page, &file)?)?;
        result(file.display())?;
    }
    Ok(Done::Fully)
}

fn page(command: clap::Command) -> Man {
    Man::new(command).source(concat!("caustica ", env!("CARGO_PKG_VERSION")))
}

fn text(page: &Man, file: &Path) -> Result<Vec<u8>, FileError> {
    let mut text = Vec::new();
    match page.render(&mut text) {
        Ok(()) => Ok(text),
        Err(cause) => Err(FileError::Io { file: file.to_owned(), verb: "written", cause }),
    }
}
