//! `caustica check`: errors and warnings of scene files, without rendering.

use std::path::{Path, PathBuf};

use caustica::low_level::prepare::limits;
use caustica::low_level::scene;
use caustica::low_level::scene::{Finding, SceneErrors};
use miette::miette;
use serde_json::{Value, json};

use super::allowed::Allowed;
use super::output::{report, result};
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
    /// Print one JSON object per file, with its errors and warnings
    #[arg(long)]
    json: bool,
}

const HELP: &str = "\
Reads each file with all meshes and images that it refers to, and renders nothing.

Example:
  caustica check scenes/cornell.toml scenes/caustics.toml";

/// Checks all files. Fails at the end if one has errors.
pub fn run(arguments: Arguments) -> Result<Done, Failure> {
    let allowance = arguments.allowed.allowance()?;
    let mut bad = 0;
    for file in &arguments.scenes {
        let (errors, warnings) = match scene::load_within(file, &allowance) {
            Ok(loaded) => {
                let limits = limits::warnings(&loaded.scene, &loaded.settings, &loaded.places);
                (None, loaded.warnings.into_iter().chain(limits).collect())
            }
            Err(errors) => (Some(errors), Vec::new()),
        };
        bad += usize::from(errors.is_some());
        match arguments.json {
            true => result(as_json(file, errors.as_ref(), &warnings))?,
            false => tell(file, errors, warnings)?,
        }
    }
    match bad {
        0 => Ok(Done::Fully),
        _ => Err(Failure::failed(miette!(
            "{bad} of {} scenes cannot be rendered",
            arguments.scenes.len()
        ))),
    }
}

fn tell(file: &Path, errors: Option<SceneErrors>, warnings: Vec<Finding>) -> Result<(), Failure> {
    if let Some(errors) = errors {
        result(format_args!("{}: bad", file.display()))?;
        report(&errors);
        return Ok(());
    }
    let count = match warnings.len() {
        0 => String::new(),
        1 => ", 1 warning".to_owned(),
        many => format!(", {many} warnings"),
    };
    for warning in warnings {
        report(&warning);
    }
    result(format_args!("{}: good{count}", file.display()))
}

/// Formats the result as JSON. Lines and columns count from 1, columns in characters; both are null
/// for findings about a whole file.
fn as_json(file: &Path, errors: Option<&SceneErrors>, warnings: &[Finding]) -> Value {
    let finding = |finding: &Finding| {
        let place = finding.line_column();
        json!({
            "message": finding.message(),
            "label": finding.label(),
            "help": finding.help(),
            "file": finding.file(),
            "line": place.map(|(line, _)| line),
            "column": place.map(|(_, column)| column),
        })
    };
    let warnings = errors.map_or(warnings, |errors| &errors.warnings);
    json!({
        "event": "checked",
        "scene": file,
        "good": errors.is_none(),
        "more_errors": errors.map_or(0, |errors| errors.more),
        "errors": errors.map_or(&[][..], |errors| &errors.errors).iter().map(finding).collect::<Vec<_>>(),
        "warnings": warnings.iter().map(finding).collect::<Vec<_>>(),
    })
}
