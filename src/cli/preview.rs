//! `caustica preview`: a window that shows the image as it converges.

use std::path::PathBuf;

use caustica::low_level::device;
use caustica::low_level::film::check_outputs;
use caustica::low_level::preview::session::Start;
use caustica::low_level::preview::window::{Against, WindowError, open};
use caustica::low_level::scene::{self, Loaded};
use clap::builder::NonEmptyStringValueParser;
use miette::miette;

use super::overrides::Overrides;
use super::render::default_output;
use super::{Done, Failure, hidden, threads};

/// Show and edit a scene in a window while it converges
#[derive(clap::Args)]
#[command(after_help = HELP)]
pub struct Arguments {
    /// Scene file
    scene: PathBuf,
    /// Image that key S writes: .png (tone-mapped), .exr, .pfm, .hdr; repeatable [default: the
    /// scene name with .png, in the current folder]
    #[arg(short, long, value_name = "FILE")]
    output: Vec<PathBuf>,
    /// Device to render on: auto, gpu, software, cpu, cpu-f64, or part of a device name
    #[arg(long, value_name = "DEVICE", value_parser = NonEmptyStringValueParser::new(), default_value = "auto")]
    device: String,
    /// Compare with this image: .exr, .pfm, .hdr, .png or .jpg
    #[arg(long, value_name = "FILE", conflicts_with = "against_device")]
    against: Option<PathBuf>,
    /// Compare with a render on another device
    #[arg(long, value_name = "DEVICE", value_parser = NonEmptyStringValueParser::new())]
    against_device: Option<String>,
    #[command(flatten)]
    overrides: Overrides,
}

const HELP: &str = "\
Examples:
  caustica preview scenes/caustics.toml
  caustica preview scenes/cornell.toml --device cpu --against-device software
  caustica preview scenes/cornell.toml -o cornell.exr --against cornell-before.exr

F1 in the window lists the keys and mouse actions. See docs/preview.md.";

/// Opens the window, and returns when it is closed.
pub fn run(arguments: Arguments) -> Result<Done, Failure> {
    let Arguments { scene: file, output, device, against, against_device, overrides } = arguments;
    let outputs = if output.is_empty() { vec![default_output(&file)] } else { output };
    check_outputs(&outputs)?;
    if !threads::are_spare() {
        return Err(Failure::failed(miette!(
            help = "raise the limit of processes (ulimit -u)",
            "this process cannot create threads, and a window needs some"
        )));
    }
    let allowance = overrides.allowed.allowance()?;
    let mut loaded = scene::load_within(&file, &allowance)?;
    overrides.apply(&mut loaded.scene, &mut loaded.settings);
    let device = device::parse(&device);
    // report a missing device before the window opens
    let needs_list = |wanted: &device::Wanted| {
        !matches!(wanted, device::Wanted::Cpu | device::Wanted::CpuDouble)
    };
    let others = against_device.as_deref().map(device::parse);
    for wanted in
        [Some(&device), others.as_ref()].into_iter().flatten().filter(|wanted| needs_list(wanted))
    {
        device::pick(wanted, &device::list())?;
        hidden::warn(wanted);
    }
    let against = against.map(Against::File).or(against_device.map(Against::Device));
    let adjust = Box::new(move |loaded: &mut Loaded| {
        overrides.apply(&mut loaded.scene, &mut loaded.settings);
    });
    open(Start { file, loaded, allowance, adjust, outputs, device }, against)?;
    Ok(Done::Fully)
}

impl From<WindowError> for Failure {
    fn from(error: WindowError) -> Self {
        match error {
            WindowError::File(error) => error.into(),
            WindowError::NoDisplay(_) => Self::failed(miette!(
                help = "a window needs a desktop (DISPLAY or WAYLAND_DISPLAY); without one, use \
                        `caustica render`",
                "{error}"
            )),
            WindowError::NoDevice(_) => Self::no_device(miette!(
                help = "a window needs a graphics driver, such as Mesa's (Debian: mesa-vulkan-drivers)",
                "{error}"
            )),
        }
    }
}
