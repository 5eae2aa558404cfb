//! Writes docs/speed-accuracy.md from the studies of `scenes/studies/run`:
//!
//!     cargo run --release --example speed_accuracy -- FOLDER PAGE
//!
//! FOLDER contains the studies `scene-NAME` (each setting varied alone) and `preset-NAME` (a longer
//! run with the presets' settings) for each of the shipped scenes.

use std::fmt::Write;
use std::path::Path;
use std::{env, fs};

use caustica::low_level::render::quality::Quality;
use caustica::low_level::study::words::short;
use serde_json::Value;

const SCENES: [&str; 6] =
    ["caustics", "cornell", "depth-of-field", "soft-shadows", "still-life", "water-drop"];
/// Changes to the presets' settings and their labels.
const CHOICES: [(&str, &str); 13] = [
    ("method=path", "path tracing"),
    ("radius=1px", "one disc of 1 px"),
    ("radius=2px", "one disc of 2 px"),
    ("radius=4px", "one disc of 4 px"),
    ("radius=8px", "one disc of 8 px"),
    ("radius=16px", "one disc of 16 px"),
    ("photons/4", "a quarter of the photons"),
    ("photons*4", "four times the photons"),
    ("radius_rule=local", "local rule"),
    ("radius_rule=fixed", "fixed radius"),
    ("direct=photons", "direct light by photons"),
    ("alpha=0.5", "alpha 0.5"),
    ("alpha=0.8", "alpha 0.8"),
];

/// The two studies of a scene.
struct Studied {
    name: &'static str,
    star: Value,
    preset: Value,
}

fn read(folder: &Path, name: &str) -> Result<Value, String> {
    let file = folder.join(name).join("study.json");
    let text = fs::read_to_string(&file).map_err(|error| format!("{}: {error}", file.display()))?;
    serde_json::from_str(&text).map_err(|error| format!("{}: {error}", file.display()))
}

fn curves(study: &Value) -> &[Value] {
    study["parts"][0]["curves"].as_array().map_or(&[], Vec::as_slice)
}

fn points(curve: &Value) -> &[Value] {
    curve["points"].as_array().map_or(&[], Vec::as_slice)
}

fn rel_mse(point: &Value) -> f64 {
    point["rel_mse"]["mean"].as_f64().unwrap_or(f64::NAN)
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

impl Studied {
    /// Choice of a curve's configuration, as a key of [`CHOICES`]; empty for the base.
    fn choice(&self, curve: &Value) -> String {
        let configs = &self.star["results"]["about"]["configs"];
        let config = &configs[curve["config"].as_u64().unwrap_or(0) as usize];
        let Some([name, value]) = config["choices"][0].as_array().map(Vec::as_slice) else {
            return String::new();
        };
        let (name, value) = (name.as_str().unwrap_or(""), value.as_str().unwrap_or(""));
        if name != "photons" {
            return format!("{name}={value}");
        }
        let fewer =
            value.parse::<f64>().is_ok_and(|v| v < number(&configs[0]["settings"]["photons"]));
        if fewer { "photons/4".to_owned() } else { "photons*4".to_owned() }
    }

    /// Final relMSE at equal time; `None` if the choice was not rendered.
    fn end(&self, choice: &str) -> Option<f64> {
        let curve = curves(&self.star).iter().find(|curve| self.choice(curve) == choice)?;
        points(curve).last().map(rel_mse)
    }

    /// Mean of a numeric field over all runs.
    fn of_runs(study: &Value, key: &str) -> f64 {
        let runs = study["results"]["runs"].as_array().map_or(&[][..], Vec::as_slice);
        let values: Vec<f64> = runs.iter().filter_map(|run| run[key].as_f64()).collect();
        values.iter().sum::<f64>() / values.len() as f64
    }

    /// Automatic radius of the presets' settings, in pixels.
    fn automatic(&self) -> f64 {
        Self::of_runs(&self.preset, "automatic_radius")
    }

    /// relMSE of the presets' settings after `passes` passes, and whether it is extrapolated.
    fn after(&self, passes: u32) -> Option<(f64, bool)> {
        let curve = curves(&self.preset).first()?;
        let at = |point: &Value| number(&point["passes"]);
        if let Some(point) = points(curve).iter().find(|point| at(point) == f64::from(passes)) {
            return Some((rel_mse(point), false));
        }
        let [.., before, last] = points(curve) else { return None };
        // use images at least a factor of three apart: the last two may be close together
        let early = points(curve).iter().rev().find(|p| at(p) <= at(last) / 3.0).unwrap_or(before);
        let slope = (rel_mse(last) / rel_mse(early)).ln() / (at(last) / at(early)).ln();
        Some((rel_mse(last) * (f64::from(passes) / at(last)).powf(slope), true))
    }

    /// Exponent of relMSE from one pass, estimated from two, to `passes` passes.
    fn decay(&self, passes: u32) -> Option<f64> {
        let (end, _) = self.after(passes)?;
        Some((Self::of_runs(&self.preset, "one_pass") / end).ln() / f64::from(passes).ln())
    }

    /// Seconds per pass of a million pixels.
    fn seconds(&self) -> f64 {
        let size = &self.preset["results"]["about"]["size"];
        let pixels = number(&size[0]) * number(&size[1]);
        curves(&self.preset).first().map_or(f64::NAN, |c| number(&c["seconds_per_pass"])) * 1e6
            / pixels
    }
}

/// Median, minimum and maximum.
fn range(mut values: Vec<f64>) -> Option<[f64; 3]> {
    values.sort_by(f64::total_cmp);
    let middle =
        0.5 * (values.get(values.len().saturating_sub(1) / 2)? + values.get(values.len() / 2)?);
    Some([middle, *values.first()?, *values.last()?])
}

fn page(studies: &[Studied]) -> String {
    let mut out = HEAD.to_owned();
    let columns = studies.iter().map(|s| format!(" {} |", s.name)).collect::<String>();
    let ruler = "---:|".repeat(studies.len());
    let _ = write!(out, "\n## Effect of each setting\n\n{BUYS}\n| |{columns}\n|---|{ruler}\n");
    for (choice, words) in CHOICES {
        let _ = write!(out, "| {words} |");
        for study in studies {
            let ratio = study.end(choice).zip(study.end("")).map(|(other, own)| other / own);
            let _ =
                write!(out, " {} |", ratio.map_or("–".to_owned(), |ratio| format!("{ratio:.2}")));
        }
        out.push('\n');
    }
    let _ = write!(
        out,
        "\n## The automatic radius\n\n{RADIUS}\n| |{columns}\n|---|{ruler}\n| automatic, px |"
    );
    studies.iter().for_each(|s| write!(out, " {} |", s.automatic()).unwrap_or(()));
    out.push_str("\n| best single disc of those tried, px |");
    let widths = ["1px", "2px", "4px", "8px", "16px"];
    let best = |study: &Studied| {
        let tried = widths.iter().filter_map(|px| Some((study.end(&format!("radius={px}"))?, *px)));
        tried.min_by(|a, b| a.0.total_cmp(&b.0))
    };
    for study in studies {
        let _ = write!(out, " {} |", best(study).map_or("–", |(_, px)| px.trim_end_matches("px")));
    }
    out.push_str("\n| error with the automatic radii over that of the best single disc |");
    for study in studies {
        let ratio = best(study).zip(study.end("")).map(|((best, _), own)| own / best);
        let _ = write!(out, " {} |", ratio.map_or("–".to_owned(), |ratio| format!("{ratio:.2}")));
    }
    let _ = write!(out, "\n\n## The presets\n\n{PRESETS}\n");
    out.push_str(
        "| | passes | error, median | from | to | exponent, median | from | to |\n\
         |---|---:|---:|---:|---:|---:|---:|---:|\n",
    );
    for quality in Quality::ALL {
        let passes = quality.passes();
        let errors =
            range(studies.iter().filter_map(|s| s.after(passes)).map(|(e, _)| e).collect());
        let decays = range(studies.iter().filter_map(|s| s.decay(passes)).collect());
        let (Some(errors), Some(decays)) = (errors, decays) else { continue };
        let drawn = studies.iter().filter_map(|s| s.after(passes)).any(|(_, drawn)| drawn);
        let mark = if drawn { " (extrapolated)" } else { "" };
        let [error, low, high] = errors.map(|e| format!("{:.1} %", 100.0 * e.sqrt()));
        let [decay, slow, fast] = decays.map(|d| format!("{d:.2}"));
        let _ = writeln!(
            out,
            "| {}{mark} | {passes} | {error} | {low} | {high} | {decay} | {slow} | {fast} |",
            quality.word()
        );
    }
    let _ = write!(out, "\n| |{columns}\n|---|{ruler}\n| seconds per pass of a million pixels |");
    studies.iter().for_each(|s| write!(out, " {} |", short(s.seconds())).unwrap_or(()));
    out.push('\n');
    for study in studies {
        let _ = write!(out, "\n## {}\n\n", study.name);
        let about = &study.star["results"]["about"];
        let _ = writeln!(
            out,
            "{} x {} pixels, {} photons per pass, {} s per render, {} seeds.\n",
            about["size"][0],
            about["size"][1],
            about["configs"][0]["settings"]["photons"],
            short(number(&about["run_seconds"])),
            about["seeds"]
        );
        for sentence in study.star["recommendations"][0].as_array().into_iter().flatten() {
            let sentence = sentence.as_str().unwrap_or("");
            let _ =
                writeln!(out, "- {}", sentence.replace("preset final", "the presets' settings"));
        }
        let _ = write!(
            out,
            "\n![{0}: relMSE over time, all settings](images/speed-{0}.svg)\n\
             ![{0}: relMSE over time by start radius](images/speed-{0}-radius.svg)\n",
            study.name
        );
    }
    out
}

const HEAD: &str = "\
# Speed and accuracy of the shipped scenes

`scenes/studies/run target/studies scenes` writes this page. It runs `caustica study` on every
shipped scene with the CPU engine. Do not edit the page by hand. [study.md](study.md) explains how a
study measures.

Both axes of the charts are logarithmic, so a power law is a straight line. The dotted guides show
the slopes -1 (averaging of noise) and -2/3 (progressive photon mapping in theory). Lower is better.
Take the curve that is lowest at the time you have. If two curves cross, the better one depends on
that time. A curve that flattens has reached its bias: more passes do not help, but a smaller radius
does. *relMSE* is a squared error over the squared brightness. Its root is the error of a typical
pixel, so 0.0025 means 5 %, and a quarter of the relMSE means half the error. *preset final* stands
for the presets' settings: SPPM, one photon per pass for each pixel, automatic radius, global rule,
alpha 2/3, sampled direct light.
";

const BUYS: &str = "\
relMSE at equal time with one setting changed, divided by the relMSE of the presets' settings.
Values below 1 are better. The studies use two seeds and small images, so differences of a tenth are
noise.
";

const RADIUS: &str = "\
The renderer chooses the radius before the first pass from the number of photons on a pixel and from
the share of caustics (`src/prepare/radius.rs`). The choice consists of a start radius and a wider
radius for photons that a diffuse surface has scattered. The table compares it with the best single
disc of those tried.
";

const PRESETS: &str = "\
`--quality` uses these settings and this number of passes. The errors are roots of relMSE over the
scenes. The exponent describes how relMSE falls from its value after one pass to its value at the
end. The first two passes estimate the former without a ground truth. `caustica render --quality`
uses this exponent for its predictions (`src/render/quality.rs`). Errors for more passes than the
studies had time for are extrapolated from the last octaves.
";

fn main() -> Result<(), String> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [folder, page_file] = arguments.as_slice() else {
        return Err("expected arguments: FOLDER PAGE".to_owned());
    };
    let folder = Path::new(folder);
    let studied = |name: &'static str| {
        let (star, preset) =
            (read(folder, &format!("scene-{name}"))?, read(folder, &format!("preset-{name}"))?);
        Ok(Studied { name, star, preset })
    };
    let studies = SCENES.into_iter().map(studied).collect::<Result<Vec<_>, String>>()?;
    fs::write(page_file, page(&studies)).map_err(|error| format!("{page_file}: {error}"))
}
