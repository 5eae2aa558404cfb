//! `caustica check`: everything that is wrong with scene files, and nothing rendered.

use std::path::PathBuf;

use caustica::{limits, scene};
use miette::{Report, miette};

use super::allowed::Allowed;
use super::output::{message, result};
use super::{Done, Failure};

/// Report all errors and warnings of scene files
#[derive(clap::Args)]
#[command(after_help = HELP)]
pub struct Arguments {
    /// Scene files
    #[arg(required = true, value_name = "SCENE")]
    scenes: Vec<PathBuf>,
    #[command(flatten)]
    allowed: Allowed,
}

const HELP: &str = "\
Every file is read with all the meshes and pictures that it names; nothing is rendered.

Example:
  caustica check scenes/cornell.toml scenes/caustics.toml";

/// Checks each file; fails at the end if one has errors.
pub fn run(arguments: Arguments) -> Result<Done, Failure> {
    let allowance = arguments.allowed.allowance()?;
    let mut bad = 0;
    for file in &arguments.scenes {
        match scene::load_within(file, &allowance) {
            Ok(loaded) => {
                let limits = limits::warnings(&loaded.scene, &loaded.settings, &loaded.places);
                let warnings = match loaded.warnings.len() + limits.len() {
                    0 => String::new(),
                    1 => ", 1 warning".to_owned(),
                    many => format!(", {many} warnings"),
                };
                for warning in loaded.warnings.into_iter().chain(limits) {
                    message(format_args!("{:?}", Report::new(warning)));
                }
                result(format_args!("{}: good{warnings}", file.display()))?;
            }
            Err(errors) => {
                bad += 1;
                result(format_args!("{}: bad", file.display()))?;
                message(format_args!("{:?}", Report::new(errors)));
            }
        }
    }
    match bad {
        0 => Ok(Done::Fully),
        _ => Err(Failure::failed(miette!("{bad} of {} scenes cannot be rendered", arguments.scenes.len()))),
    }
}
