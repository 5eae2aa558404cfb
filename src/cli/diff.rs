//! `caustica diff`: difference of an image from a reference.

use std::path::PathBuf;

use caustica::low_level::film::difference::flip_colors;
use caustica::low_level::film::flip::Exposures;
use caustica::low_level::film::metrics::MetricsError;
use caustica::low_level::film::plane::Plane;
use caustica::low_level::film::{Coding, Difference, FileError, Picture, Region, file, read_any};
use caustica::low_level::storage;
use miette::miette;
use serde_json::{Value, json};

use super::bounds::{Bounds, Measured, Passed};
use super::figures::{measures_json, table};
use super::output::{message, result};
use super::{Done, Failure};

/// Measure the difference of an image from a reference, overall and per region
#[derive(clap::Args)]
#[command(after_help = HELP)]
pub struct Arguments {
    /// Image to test (.exr, .pfm, .hdr; .png, .jpg)
    a: PathBuf,
    /// Reference image with the same coding and size
    b: PathBuf,
    /// Also measure a region: columns x0 to x1 and rows y0 to y1 from the top left, x1 and y1
    /// excluded; repeatable
    #[arg(long, value_name = "NAME=x0,y0,x1,y1", value_parser = region)]
    region: Vec<(String, Region)>,
    /// LDR-FLIP map to write (.png), from black (0) via violet and orange to light yellow (1)
    #[arg(short, long, visible_alias = "map", value_name = "FILE")]
    output: Option<PathBuf>,
    /// HDR-FLIP map to write (.png)
    #[arg(long, value_name = "FILE")]
    hdr_map: Option<PathBuf>,
    /// Print the metrics as a JSON object; infinite or undefined values are null
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    bounds: Bounds,
}

const HELP: &str = "\
MSE, RMSE, PSNR, relMSE and the mean ratios use linear light; relMSE is the mean of \
(La - Lb)^2 / (Lb^2 + 0.01) without the largest 0.1 %. SSIM and LDR-FLIP use the image clipped to \
[0, 1]. HDR-FLIP is the maximum of FLIP over a series of exposures, one per stop, from the \
exposure that maps the reference's brightest pixel to a display value of 0.85 (ACES curve) to the \
exposure that maps its median there. The exposures are printed. FLIP assumes 67 pixels per \
degree. See docs/measures.md.

Examples:
  caustica diff picture.exr truth.exr --max-FLIP 0.1 -o flip.png
  caustica diff a.exr b.exr --region lamp=96,32,160,64 --max-relMSE lamp=0.02 --json";

/// Parses a named region such as `caustic=290,425,425,485`.
pub fn region(text: &str) -> Result<(String, Region), String> {
    let parsed = text.split_once('=').and_then(|(name, numbers)| {
        let numbers: Vec<u32> =
            numbers.split(',').map(|n| n.trim().parse().ok()).collect::<Option<_>>()?;
        let [x0, y0, x1, y1] = numbers[..] else { return None };
        Some((name.to_owned(), Region { x0, y0, x1, y1 }))
    });
    match parsed {
        Some((name, region)) if !name.is_empty() && !region.is_empty() => Ok((name, region)),
        _ => Err("expected a name and four whole numbers with x0 < x1 and y0 < y1, e.g. \
                  caustic=290,425,425,485"
            .to_owned()),
    }
}

/// Reads both images, computes the metrics and checks the thresholds.
pub fn run(arguments: Arguments) -> Result<Done, Failure> {
    check(&arguments)?;
    let (a, b, coding) = read_both(&arguments)?;
    let difference =
        Difference::new(&a, &b, coding).map_err(|error| incomparable(error, &arguments))?;
    let places = [(None, None)].into_iter();
    let places =
        places.chain(arguments.region.iter().map(|(name, at)| (Some(name.as_str()), Some(*at))));
    let measured = places
        .map(|(region, at)| Ok(Measured { region, measures: difference.measures(at)? }))
        .collect::<Result<Vec<_>, MetricsError>>()
        .map_err(|error| incomparable(error, &arguments))?;
    let passed = arguments.bounds.passed(&measured)?;
    let exposures = difference.hdr_flip.as_ref().map(|flip| flip.exposures);
    if arguments.json {
        result(as_json(&arguments, &b, coding, exposures, &measured, &passed))?;
    } else {
        result(as_text(&arguments, &b, coding, exposures, &measured))?;
    }
    write_map(&arguments.output, Some(&difference.ldr_flip))?;
    write_map(&arguments.hdr_map, difference.hdr_flip.as_ref().map(|flip| &flip.map))?;
    for output in
        [&arguments.output, &arguments.hdr_map].into_iter().flatten().filter(|_| !arguments.json)
    {
        result(output.display())?;
    }
    for passed in &passed {
        message(format_args!("over the threshold: {}", passed.as_text()));
    }
    Ok(if passed.is_empty() { Done::Fully } else { Done::OverThreshold })
}

/// Checks the arguments before the images are read.
fn check(arguments: &Arguments) -> Result<(), Failure> {
    let names = region_names(&arguments.region)?;
    arguments.bounds.check_regions(&names)?;
    let outputs: Vec<&PathBuf> =
        [&arguments.output, &arguments.hdr_map].into_iter().flatten().collect();
    for output in &outputs {
        file::check_png(output)?;
        if storage::same(&arguments.a, output) || storage::same(&arguments.b, output) {
            return Err(Failure::wrong_use(
                &format!(
                    "{}: the difference image would overwrite an input image",
                    output.display()
                ),
                "use another name",
            ));
        }
    }
    match outputs[..] {
        [first, second] if storage::same(first, second) => {
            Err(FileError::Repeated { file: first.clone() }.into())
        }
        _ => Ok(()),
    }
}

/// Names of the regions; fails if two are equal.
pub fn region_names(regions: &[(String, Region)]) -> Result<Vec<&str>, Failure> {
    let names: Vec<&str> = regions.iter().map(|(name, _)| name.as_str()).collect();
    if let Some((i, name)) = names.iter().enumerate().find(|(i, name)| names[..*i].contains(name)) {
        let first = &regions[names.iter().position(|other| other == name).unwrap_or(i)].1;
        return Err(Failure::wrong_use(
            &format!("two regions are called `{name}`"),
            &format!("rename one of them; the first has {first}"),
        ));
    }
    Ok(names)
}

fn read_both(arguments: &Arguments) -> Result<(Picture, Picture, Coding), Failure> {
    let (a, coding) = read_any(&arguments.a)?;
    let (b, other) = read_any(&arguments.b)?;
    if coding != other {
        let kind = |coding| match coding {
            Coding::Radiance => "radiance",
            Coding::Display => "display values",
        };
        let (a, b) = (arguments.a.display(), arguments.b.display());
        return Err(Failure::wrong_use(
            &format!(
                "{a} contains {} and {b} {}: they cannot be compared",
                kind(coding),
                kind(other)
            ),
            "compare images of one coding; `caustica render` writes both, e.g. -o picture.png \
             -o picture.exr",
        ));
    }
    if coding == Coding::Display && arguments.hdr_map.is_some() {
        return Err(Failure::wrong_use(
            "HDR-FLIP is not defined for display values",
            "drop --hdr-map, or compare .exr, .pfm or .hdr files",
        ));
    }
    Ok((a, b, coding))
}

/// Converts the error: a region outside the image is a usage error, everything else a failure.
fn incomparable(error: MetricsError, arguments: &Arguments) -> Failure {
    let (a, b) = (arguments.a.display(), arguments.b.display());
    match &error {
        MetricsError::Region { region: wrong, width, height } => {
            let named = arguments.region.iter().find(|(_, region)| region == wrong);
            let name = named.map_or("", |(name, _)| name);
            Failure::wrong_use(
                &format!("the region {name} ({wrong}) extends beyond the image"),
                &format!("the image has {width} columns and {height} rows, counted from 0"),
            )
        }
        _ => {
            Failure::failed(miette!(help = format!("the first is {a}, the second {b}"), "{error}"))
        }
    }
}

fn write_map(file: &Option<PathBuf>, map: Option<&Plane>) -> Result<(), FileError> {
    match (file, map) {
        (Some(file), Some(map)) => {
            let height = map.values.len() / map.width;
            file::write_rgb8(file, map.width as u32, height as u32, flip_colors(map).as_flattened())
        }
        _ => Ok(()),
    }
}

fn as_text(
    arguments: &Arguments,
    truth: &Picture,
    coding: Coding,
    exposures: Option<Exposures>,
    measured: &[Measured],
) -> String {
    let kind = match coding {
        Coding::Radiance => "radiance",
        Coding::Display => "sRGB, decoded to linear light",
    };
    let mut lines = vec![
        format!("a      {}", arguments.a.display()),
        format!("truth  {}", arguments.b.display()),
        format!("size   {} x {}, {kind}", truth.width, truth.height),
    ];
    lines.extend(arguments.region.iter().map(|(name, region)| format!("{name}: {region}")));
    lines.extend(exposures.map(|Exposures { start, stop, count }| {
        format!("HDR-FLIP over {count} exposures from {start:+.2} to {stop:+.2} stops")
    }));
    lines.push(String::new());
    lines.push(table(measured));
    lines.join("\n")
}

fn as_json(
    arguments: &Arguments,
    truth: &Picture,
    coding: Coding,
    exposures: Option<Exposures>,
    measured: &[Measured],
    passed: &[Passed],
) -> Value {
    let regions = measured.iter().filter_map(|place| {
        let (name, region) =
            arguments.region.iter().find(|(name, _)| place.region == Some(name))?;
        let mut figures = measures_json(&place.measures);
        figures["rectangle"] = json!([region.x0, region.y0, region.x1, region.y1]);
        Some((name.clone(), figures))
    });
    let whole = measured.iter().find(|place| place.region.is_none());
    json!({
        "event": "difference",
        "a": arguments.a,
        "truth": arguments.b,
        "width": truth.width,
        "height": truth.height,
        "coding": match coding { Coding::Radiance => "radiance", Coding::Display => "display" },
        "hdr_flip_exposures": exposures.map(|e| json!({ "start": e.start, "stop": e.stop, "count": e.count })),
        "picture": whole.map(|place| measures_json(&place.measures)),
        "regions": regions.collect::<serde_json::Map<_, _>>(),
        "passed": passed.iter().map(Passed::as_json).collect::<Vec<_>>(),
    })
}
