//! `caustica info`: features, kernels and memory that a scene needs.

use std::fmt;
use std::path::PathBuf;

use caustica::low_level::engine::EngineError;
use caustica::low_level::memory::{Memory, Part, total};
use caustica::low_level::pack::PackedScene;
use caustica::low_level::pilots::prepare;
use caustica::low_level::plan::features::Feature;
use caustica::low_level::plan::{Buffer, BufferPlace, Kernel, Plan, scene_bytes, scene_tables};
use caustica::low_level::scene::settings::Method;
use clap::builder::NonEmptyStringValueParser;
use serde_json::{Value, json};

use super::budget::Budget;
use super::measure;
use super::output::result;
use super::overrides::Overrides;
use super::render::load;
use super::{Done, Failure, compiling};

/// Show the features, kernels and buffers that a scene needs, and those it does not
#[derive(clap::Args)]
#[command(after_help = HELP)]
pub struct Arguments {
    /// Scene file
    scene: PathBuf,
    /// Time all kernels with and without each unused feature, on each --device
    #[arg(long)]
    measure: bool,
    /// Device to measure: auto, gpu, software, cpu, or part of a device name; repeatable
    #[arg(long, value_name = "DEVICE", value_parser = NonEmptyStringValueParser::new(), default_value = "auto", requires = "measure")]
    device: Vec<String>,
    /// Print one JSON object per line; sizes in bytes, times in seconds
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    budget: Budget,
    #[command(flatten)]
    overrides: Overrides,
}

impl Arguments {
    /// Devices to measure, if any.
    pub fn measured(&self) -> Option<&[String]> {
        self.measure.then_some(&self.device)
    }
}

const HELP: &str = "\
Examples:
  caustica info scenes/caustics.toml --method ppm --size 1920x1080
  MESA_SHADER_CACHE_DISABLE=true caustica info scenes/cornell.toml --measure --device software --device cpu";

const ON_GPU: BufferPlace = BufferPlace::Device { in_main_memory: false };

/// Memory of a render, and its tiles and batches under the budget.
struct Need {
    parts: Vec<Part>,
    cut: String,
}

impl Need {
    fn of(plan: &Plan, packed: &PackedScene, place: BufferPlace, budget: &Budget) -> Self {
        let scene = scene_bytes(&packed.tables);
        let memory = budget.alone();
        let given = Memory { budget: memory.budget.or(Some(u64::MAX)), ..memory };
        match plan.clone().within(scene, place, &given) {
            Ok(plan) => {
                let (tiles, batches) = (if plan.tiled { plan.chunks() } else { 0 }, plan.batches());
                let tiles =
                    if tiles > 0 { format!("{tiles} tiles") } else { "one piece".to_owned() };
                Self {
                    parts: plan.memory(scene, place),
                    cut: format!("image in {tiles}, photons in {batches} batches"),
                }
            }
            Err(error) => Self { parts: Vec::new(), cut: error.to_string() },
        }
    }

    fn as_json(&self) -> Value {
        json!({
            "parts": Value::from_iter(self.parts.iter().map(|part| (part.what, part.bytes))),
            "bytes": total(&self.parts),
            "cut": self.cut,
        })
    }
}

impl fmt::Display for Need {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for part in &self.parts {
            writeln!(f, "{:<40} {:>16}", part.what, part.bytes)?;
        }
        if !self.parts.is_empty() {
            writeln!(f, "{:<40} {:>16}", "total", total(&self.parts))?;
        }
        f.write_str(&self.cut)
    }
}

/// Components of a render of a scene.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct InfoReport {
    /// Feature names, true if the scene needs the feature.
    pub features: Vec<(String, bool)>,
    /// Kernel names, true if the kernel is compiled.
    pub kernels: Vec<(String, bool)>,
    /// Buffer names and sizes in bytes.
    pub buffers: Vec<(String, u64)>,
}

/// Prints the report.
pub fn run(arguments: Arguments) -> Result<Done, Failure> {
    let (scene, settings) = load(&arguments.scene, &arguments.overrides)?;
    let film = scene.film;
    let packed = prepare(&scene, film.width, film.height).map_err(EngineError::from)?;
    let plan = Plan::probed(&packed, &settings);
    let memory = [("on a GPU", ON_GPU), ("on the CPU", BufferPlace::Program { saves: false })]
        .map(|(name, place)| (name, Need::of(&plan, &packed, place, &arguments.budget)));
    if arguments.json {
        let mut figures = report(&packed, &plan).as_json();
        figures["scene"] = json!(scene.name);
        figures["width"] = json!(film.width);
        figures["height"] = json!(film.height);
        figures["memory"] =
            Value::from_iter(memory.iter().map(|(name, need)| (*name, need.as_json())));
        figures["settings"] = json!(plan.settings);
        figures["radius_why"] = json!(plan.automatic_radius().map(|radius| radius.to_string()));
        result(figures)?;
    } else {
        result(format_args!(
            "{}: {} x {} pixels, {} passes",
            scene.name, film.width, film.height, settings.passes
        ))?;
        if let Some(radius) = plan.automatic_radius() {
            result(format_args!("start radius: {radius}"))?;
        }
        result(report(&packed, &plan))?;
        for (name, need) in &memory {
            result(format_args!("{:<40} {:>16}\n{need}", format!("memory {name}"), "bytes"))?;
        }
    }
    if arguments.measure {
        compiling::begin(false, arguments.json);
        for device in &arguments.device {
            measure::on_device(device, &packed, &settings, arguments.json)?;
        }
    }
    Ok(Done::Fully)
}

fn report(packed: &PackedScene, plan: &Plan) -> InfoReport {
    let features =
        Feature::all().map(|feature| (feature.name().to_owned(), plan.features.has(feature)));
    let kernels = plan.kernels();
    let used = |kernel| kernels.iter().any(|(other, _)| *other == kernel);
    // path tracing is a single kernel of the CPU engine, and its only buffer is the film
    let path = plan.settings.method == Method::Path;
    let kernels =
        Kernel::ALL.iter().map(|kernel| (kernel.stem().to_owned(), !path && used(*kernel)));
    let kernels = kernels.chain([("path_trace".to_owned(), path)]);
    let tables = scene_tables(&packed.tables).into_iter().filter(|(_, bytes)| *bytes > 0);
    let own_buffers =
        plan.buffers().into_iter().filter(|(buffer, _)| !path || *buffer == Buffer::Film);
    let own_buffers = own_buffers.map(|(buffer, bytes)| (buffer.name(), bytes));
    let buffers = tables.chain(own_buffers).map(|(name, bytes)| (name.to_owned(), bytes));
    InfoReport {
        features: features.collect(),
        kernels: kernels.collect(),
        buffers: buffers.collect(),
    }
}

impl InfoReport {
    fn as_json(&self) -> Value {
        let needed = |entries: &[(String, bool)]| Value::from_iter(entries.iter().cloned());
        json!({
            "event": "info",
            "features": needed(&self.features),
            "kernels": needed(&self.kernels),
            "buffers": Value::from_iter(self.buffers.iter().cloned()),
            "bytes": self.buffers.iter().map(|(_, bytes)| bytes).sum::<u64>(),
        })
    }
}

impl fmt::Display for InfoReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut lines = Vec::new();
        for (title, entries, word, wanted) in [
            ("features", &self.features, "needed", true),
            ("features", &self.features, "left out", false),
            ("kernels", &self.kernels, "needed", true),
            ("kernels", &self.kernels, "left out", false),
        ] {
            let of_this_kind = entries.iter().filter(|(_, is)| *is == wanted);
            let names: Vec<&str> = of_this_kind.map(|(name, _)| name.as_str()).collect();
            if !names.is_empty() {
                lines.push(format!("{title} {word}: {}", names.join(", ")));
            }
        }
        if !self.buffers.is_empty() {
            let total: u64 = self.buffers.iter().map(|(_, bytes)| bytes).sum();
            lines.push(format!("{:<32} {:>16}", "buffer", "bytes"));
            for (name, bytes) in self.buffers.iter().chain([&("total".to_owned(), total)]) {
                lines.push(format!("{name:<32} {bytes:>16}"));
            }
        }
        f.write_str(&lines.join("\n"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn report_shows_both_sides_and_the_sum() {
        let report = InfoReport {
            features: vec![("glass".into(), true), ("lens".into(), false)],
            kernels: vec![("gather".into(), true)],
            buffers: vec![("photons".into(), 4096), ("nodes".into(), 8)],
        };
        let text = report.to_string();
        assert!(
            text.contains(
                "features needed: glass\nfeatures left out: lens\nkernels needed: gather\n"
            ),
            "{text}"
        );
        assert!(text.lines().last().unwrap().ends_with(" 4104"), "{text}");
        assert_eq!(InfoReport::default().to_string(), "");
    }
}
