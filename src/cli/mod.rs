//! Command line: arguments, dispatch and exit codes; one file per command.
//!
//! Results go to standard output, everything else to standard error.

mod allowed;
mod bench;
mod bench_table;
mod bounds;
mod budget;
mod check;
mod checkpoint;
mod colors;
mod compare;
mod compiling;
mod completions;
mod denoise;
mod device_fallback;
mod devices;
mod diff;
mod extent;
mod failure;
mod faults;
mod figures;
mod hidden;
mod info;
mod interrupt;
mod loader;
mod log;
mod man;
mod measure;
mod merge;
#[cfg(not(feature = "preview"))]
mod no_preview;
mod output;
mod overrides;
#[cfg(feature = "preview")]
mod preview;
mod progress;
mod render;
mod rendered;
mod reproduce;
mod shown;
mod signals;
mod study;
mod tessellate;
mod tev;
mod threads;

use std::process::ExitCode;

use clap::{ArgAction, CommandFactory, Parser, Subcommand};

use failure::Failure;
use output::{paragraph, printable};

/// Renders scenes by photon mapping: caustics, soft shadows, depth of field.
#[derive(Parser)]
#[command(version, after_help = HELP)]
struct Arguments {
    /// Log device choice and stage times to standard error; -vv also logs each pass
    #[arg(short, long, global = true, action = ArgAction::Count)]
    verbose: u8,
    #[command(subcommand)]
    command: Command,
}

const HELP: &str = "\
Examples:
  caustica render scenes/caustics.toml -o picture.png -o picture.exr
  caustica check scenes/cornell.toml scenes/caustics.toml

Exit codes: 0 success, 1 failure, 2 usage error, 3 threshold exceeded, 4 no such device, 5 device \
failed (partial image saved), 130 interrupted (partial image saved)";

#[derive(Subcommand)]
enum Command {
    Render(Box<render::Arguments>),
    #[cfg(feature = "preview")]
    Preview(Box<preview::Arguments>),
    #[cfg(not(feature = "preview"))]
    Preview(no_preview::Arguments),
    Merge(merge::Arguments),
    Compare(compare::Arguments),
    Diff(Box<diff::Arguments>),
    Study(Box<study::Arguments>),
    Info(info::Arguments),
    Bench(Box<bench::Arguments>),
    Check(check::Arguments),
    Devices(devices::Arguments),
    Tessellate(tessellate::Arguments),
    Completions(completions::Arguments),
    Man(man::Arguments),
}

impl Command {
    /// Returns true if the command may open or enumerate devices with a driver.
    fn needs_driver(&self) -> bool {
        let any = |devices: &[String]| devices.iter().any(|device| loader::is_driver(device));
        match self {
            Self::Render(arguments) => arguments.device().is_none_or(loader::is_driver),
            Self::Preview(_) => cfg!(feature = "preview"),
            Self::Compare(arguments) => any(arguments.devices()),
            Self::Info(arguments) => arguments.measured().is_some_and(any),
            Self::Bench(_) | Self::Devices(_) | Self::Study(_) => true,
            Self::Merge(_) | Self::Diff(_) | Self::Check(_) | Self::Tessellate(_) => false,
            Self::Completions(_) | Self::Man(_) => false,
        }
    }
}

/// Exit code of a command that did not fail.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Done {
    /// Success.
    Fully = 0,
    /// A metric exceeds its threshold.
    OverThreshold = 3,
    /// The device failed; the partial image is saved.
    DeviceLost = 5,
    /// The user interrupted the command; the partial image is saved.
    Interrupted = 130,
}

/// The parser, for completions and manual pages.
fn command() -> clap::Command {
    Arguments::command()
}

/// Prints a usage error, or the requested help.
fn parsed_otherwise(error: &clap::Error) -> ExitCode {
    // clap quotes arguments without escaping control characters
    let plain = |argument: std::ffi::OsString| {
        let text = argument.to_string_lossy();
        printable(&text) == text
    };
    if error.use_stderr() && !std::env::args_os().all(plain) {
        paragraph(error.render().to_string().trim_end());
    } else {
        // clap prints in color if enabled
        let _ = error.print();
    }
    ExitCode::from(error.exit_code() as u8)
}

/// Runs the command line.
pub fn run() -> ExitCode {
    if interrupt::is_end() {
        return ExitCode::from(Done::Interrupted as u8);
    }
    faults::begin();
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => return parsed_otherwise(&error),
    };
    log::begin(arguments.verbose);
    if arguments.command.needs_driver() {
        loader::quiet();
    }
    interrupt::begin(matches!(arguments.command, Command::Render(_) | Command::Study(_)));
    let done = threads::begin().and_then(|()| carry_out(arguments.command));
    interrupt::wait_if_ending();
    match done {
        Ok(done) => ExitCode::from(done as u8),
        Err(failure) => failure.tell(),
    }
}

fn carry_out(command: Command) -> Result<Done, Failure> {
    match command {
        Command::Render(arguments) => render::run(*arguments),
        #[cfg(feature = "preview")]
        Command::Preview(arguments) => preview::run(*arguments),
        #[cfg(not(feature = "preview"))]
        Command::Preview(arguments) => no_preview::run(arguments),
        Command::Merge(arguments) => merge::run(arguments),
        Command::Compare(arguments) => compare::run(arguments),
        Command::Diff(arguments) => diff::run(*arguments),
        Command::Study(arguments) => study::run(*arguments),
        Command::Info(arguments) => info::run(arguments),
        Command::Bench(arguments) => bench::run(*arguments),
        Command::Check(arguments) => check::run(arguments),
        Command::Devices(arguments) => devices::run(arguments),
        Command::Tessellate(arguments) => tessellate::run(arguments),
        Command::Completions(arguments) => completions::run(arguments),
        Command::Man(arguments) => man::run(arguments),
    }
}
