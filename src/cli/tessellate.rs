//! `caustica tessellate`: converts a Bezier profile to a mesh of revolution.

use std::path::{Path, PathBuf};

use caustica::low_level::accel::tessellate::{Fineness, tessellate};
use caustica::low_level::film::FileError;
use caustica::low_level::film::file::{check_place, write_whole};
use caustica::low_level::scene;
use miette::miette;

use super::allowed::Allowed;
use super::output::{message, report, result};
use super::{Done, Failure};

/// Convert a Bezier profile to a mesh of revolution
#[derive(clap::Args)]
#[command(after_help = HELP)]
pub struct Arguments {
    /// Profile file
    profile: PathBuf,
    /// Wavefront OBJ file to write [default: the profile name with .obj, in the current folder]
    #[arg(short, long, value_name = "FILE.obj")]
    output: Option<PathBuf>,
    /// Sectors around the axis, 3 to 4096
    #[arg(long, value_name = "N", default_value_t = Fineness::default().sectors,
          value_parser = clap::value_parser!(u32).range(3..=4096))]
    sectors: u32,
    /// Maximum distance of the mesh from the profile curve relative to the profile's size, 1e-6 to
    /// 0.1 [default: matches the sectors: 2e-4 for 96, a quarter of that for twice as many]
    #[arg(long, value_name = "F", value_parser = flatness, allow_negative_numbers = true)]
    flatness: Option<f64>,
    #[command(flatten)]
    allowed: Allowed,
}

const HELP: &str = "\
A profile file contains `profile = [[radius, height], ...]`, the control points of a Bezier curve \
of degree up to 15, or `segments = [[[radius, height], ...], ...]`, several connected curves, and \
optionally `transform`, as in a scene file.

Example:
  caustica tessellate scenes/profiles/vase.toml -o vase.obj --sectors 64";

/// Reads, tessellates and writes.
pub fn run(arguments: Arguments) -> Result<Done, Failure> {
    let output = arguments.output.unwrap_or_else(|| default_output(&arguments.profile));
    check_output(&output)?;
    let loaded = scene::load_profile_within(&arguments.profile, &arguments.allowed.allowance()?)?;
    for warning in loaded.warnings {
        report(&warning);
    }
    let own = Fineness::of_sectors(arguments.sectors);
    let fineness = Fineness { flatness: arguments.flatness.unwrap_or(own.flatness), ..own };
    let mesh = tessellate(&loaded.segments, &fineness)
        .map_err(|error| Failure::failed(miette!("{}: {error}", arguments.profile.display())))?
        .transformed(&loaded.transform);
    let (vertices, triangles) = (mesh.positions.len(), mesh.triangles.len());
    let name = arguments.profile.file_name().unwrap_or_default().to_string_lossy();
    let header =
        format!("{name} rotated about its axis: {vertices} vertices, {triangles} triangles");
    write_whole(&output, mesh.to_obj(&header).as_bytes())?;
    message(format_args!("{vertices} vertices, {triangles} triangles"));
    result(output.display())?;
    Ok(Done::Fully)
}

fn default_output(profile: &Path) -> PathBuf {
    Path::new(profile.file_stem().unwrap_or(profile.as_os_str())).with_extension("obj")
}

/// Checks before the tessellation that the mesh can be written.
fn check_output(output: &Path) -> Result<(), FileError> {
    if !output.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("obj")) {
        return Err(FileError::UnknownFormat {
            file: output.to_owned(),
            what: "meshes are written as Wavefront OBJ files".to_owned(),
            known: ".obj",
        });
    }
    check_place(output)
}

fn flatness(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number| (1e-6..=0.1).contains(number));
    number.ok_or("expected a number from 1e-6 to 0.1".to_owned())
}
