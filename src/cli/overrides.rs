//! Options that override settings of the scene file.

use std::time::Duration;

use caustica::low_level::render::quality::Quality;
use caustica::low_level::scene::Scene;
use caustica::low_level::scene::numbers::{LARGEST, SMALLEST};
use caustica::low_level::scene::settings::{Direct, Method, Radius, RadiusRule, RenderSettings};
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use serde::de::DeserializeOwned;

use super::allowed::Allowed;

/// Options of commands that render; each overrides a value of the scene file.
#[derive(Args, Debug, Default)]
#[command(next_help_heading = "Scene file overrides")]
pub struct Overrides {
    /// Preset of method, passes, photons, radius, rule, alpha and direct; other options override it
    #[arg(long, value_name = "draft|preview|final|reference", value_parser = quality(), hide_possible_values = true)]
    pub quality: Option<Quality>,
    /// Light transport: stochastic progressive photon mapping, progressive photon mapping, or path
    /// tracing (CPU only)
    #[arg(long, value_name = "sppm|ppm|path", value_parser = word::<Method>)]
    method: Option<Method>,
    /// Number of passes; `render` also accepts a range (counted from 0, B excluded) to merge later
    #[arg(long, value_name = "N|A..B", value_parser = passes)]
    passes: Option<Passes>,
    /// Photons emitted per pass
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub photons: Option<u32>,
    /// Maximum photons traced and gathered at once [default: as many as fit in 4 million records]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    batch: Option<u32>,
    /// Start radius in pixels at the visible point (2px), in scene units (0.01), or auto
    #[arg(long, value_name = "R", value_parser = radius, allow_negative_numbers = true)]
    radius: Option<Radius>,
    /// Start radius of diffusely scattered photons relative to that of the others, 1 to 16
    #[arg(long, value_name = "X", value_parser = times, allow_negative_numbers = true)]
    indirect_radius: Option<f64>,
    /// Rule that shrinks the radius
    #[arg(long, value_name = "global|local|fixed", value_parser = word::<RadiusRule>)]
    radius_rule: Option<RadiusRule>,
    /// Fraction of photons kept when the radius shrinks, above 0 and up to 1
    #[arg(long, value_name = "A", value_parser = alpha, allow_negative_numbers = true)]
    alpha: Option<f64>,
    /// Source of direct light: light sampling, or the photon map
    #[arg(long, value_name = "sampled|photons", value_parser = word::<Direct>)]
    direct: Option<Direct>,
    /// Maximum scattering events on a photon path and on an eye path; 0 for direct light only
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(..=65535))]
    max_bounces: Option<u32>,
    /// Fixed visible points per pixel (ppm only)
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=65536))]
    eye_samples: Option<u32>,
    /// Random seed
    #[arg(long, value_name = "S")]
    seed: Option<u64>,
    /// Image size in pixels; keeps the vertical field of view
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Option<(u32, u32)>,
    #[command(flatten)]
    pub allowed: Allowed,
}

/// A range of passes, counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Passes {
    /// First pass.
    pub first: u32,
    /// Pass after the last, greater than `first`.
    pub end: u32,
}

impl Overrides {
    /// Requested passes, if any.
    pub fn passes(&self) -> Option<Passes> {
        self.passes
    }

    /// Number of passes, for commands that start at pass 0.
    pub fn pass_count(&self) -> Option<u32> {
        self.passes.map(|passes| passes.end)
    }

    /// Returns true if a range that does not start at pass 0 is requested.
    pub fn begins_later(&self) -> bool {
        self.passes.is_some_and(|passes| passes.first > 0)
    }

    /// Applies the options. For a range, the number of passes becomes the end of the range.
    pub fn apply(&self, scene: &mut Scene, settings: &mut RenderSettings) {
        fn set<T: Copy>(target: &mut T, value: Option<T>) {
            *target = value.unwrap_or(*target);
        }
        if let Some((width, height)) = self.size {
            (scene.film.width, scene.film.height) = (width, height);
        }
        if let Some(quality) = self.quality {
            quality.apply(u64::from(scene.film.width) * u64::from(scene.film.height), settings);
        }
        set(&mut settings.method, self.method);
        set(&mut settings.passes, self.pass_count());
        set(&mut settings.photons, self.photons);
        settings.batch = self.batch.or(settings.batch);
        set(&mut settings.radius, self.radius);
        settings.indirect_radius = self.indirect_radius.or(settings.indirect_radius);
        set(&mut settings.radius_rule, self.radius_rule);
        set(&mut settings.alpha, self.alpha);
        set(&mut settings.direct, self.direct);
        set(&mut settings.max_bounces, self.max_bounces);
        set(&mut settings.eye_samples, self.eye_samples);
        set(&mut settings.seed, self.seed);
    }
}

/// Parser of preset names; clap suggests the closest one.
fn quality() -> impl TypedValueParser<Value = Quality> {
    PossibleValuesParser::new(Quality::ALL.map(Quality::word)).try_map(|text| word(&text))
}

/// Parses an enumerated setting in the spelling of scene files.
pub fn word<T: DeserializeOwned>(text: &str) -> Result<T, String> {
    serde_json::from_value(text.into()).map_err(|error| error.to_string())
}

fn passes(text: &str) -> Result<Passes, String> {
    let number = |text: &str| text.parse::<u32>().ok();
    let (first, end) = match text.split_once("..") {
        Some((first, end)) => (number(first), number(end)),
        None => (Some(0), number(text)),
    };
    let passes = first.zip(end).map(|(first, end)| Passes { first, end });
    passes.filter(|passes| passes.first < passes.end).ok_or(format!(
        "expected a number from 1 to {}, or a range such as 0..500 or 500..1000",
        u32::MAX
    ))
}

fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() && number > 0.0 => Ok(number),
        _ => Err("expected a number above zero".to_owned()),
    }
}

fn alpha(text: &str) -> Result<f64, String> {
    positive(text)
        .ok()
        .filter(|alpha| *alpha <= 1.0)
        .ok_or("expected a number above 0 and up to 1".to_owned())
}

fn times(text: &str) -> Result<f64, String> {
    positive(text)
        .ok()
        .filter(|times| (1.0..=16.0).contains(times))
        .ok_or("expected a number from 1 to 16".to_owned())
}

fn radius(text: &str) -> Result<Radius, String> {
    if text == "auto" {
        return Ok(Radius::Auto);
    }
    let (number, in_unit): (_, fn(f64) -> Radius) = match text.strip_suffix("px") {
        Some(pixels) => (pixels, Radius::Pixels),
        None => (text, Radius::Units),
    };
    let number = number.parse().ok().filter(|number| (SMALLEST..=LARGEST).contains(number));
    let expected = || {
        format!(
            "expected auto, or a number from {SMALLEST:e} to {LARGEST:e}: pixels (2px) or scene \
             units (0.01)"
        )
    };
    number.map(in_unit).ok_or_else(expected)
}

fn size(text: &str) -> Result<(u32, u32), String> {
    let side = |text: &str| text.parse::<u32>().ok().filter(|side| (1..=65536).contains(side));
    let (width, height) = text.split_once('x').unwrap_or((text, ""));
    side(width)
        .zip(side(height))
        .ok_or("expected width x height in pixels, 1 to 65536 each, e.g. 640x480".to_owned())
}

/// Parses a duration such as 500ms, 30s, 5m or 1.5h.
pub fn duration(text: &str) -> Result<Duration, String> {
    let units = [("ms", 0.001), ("s", 1.0), ("m", 60.0), ("h", 3600.0)];
    let seconds = units.iter().find_map(|(unit, seconds)| {
        let number = positive(text.strip_suffix(unit)?).ok()?;
        Some(number * seconds)
    });
    seconds
        .and_then(|seconds| Duration::try_from_secs_f64(seconds).ok())
        .ok_or("expected a time with its unit, e.g. 500ms, 30s, 5m or 1.5h".to_owned())
}

/// Parses a relative error such as 2% or 0.02.
pub fn target_error(text: &str) -> Result<f64, String> {
    let number = match text.strip_suffix('%') {
        Some(percent) => positive(percent).map(|number| number / 100.0),
        None => positive(text),
    };
    match number {
        Ok(error) if error <= 1.0 => Ok(error),
        _ => Err("expected a relative error above 0 and up to 100 %, e.g. 2% or 0.02".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radius_in_pixels_or_units() {
        assert_eq!(radius("2px"), Ok(Radius::Pixels(2.0)));
        assert_eq!(radius("0.01"), Ok(Radius::Units(0.01)));
        assert_eq!(radius("auto"), Ok(Radius::Auto));
        for bad in ["", "px", "0px", "-1", "nan", "inf", "2 cm", "1e-16", "1e16px"] {
            assert!(radius(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn passes_by_number_or_range() {
        assert_eq!(passes("7"), Ok(Passes { first: 0, end: 7 }));
        assert_eq!(passes("0..500"), Ok(Passes { first: 0, end: 500 }));
        assert_eq!(passes("500..4294967295"), Ok(Passes { first: 500, end: u32::MAX }));
        for bad in [
            "",
            "0",
            "-1",
            "1.5",
            "..",
            "5..",
            "..5",
            "5..5",
            "6..5",
            "0..4294967296",
            "0...5",
            "0..=5",
            "0 .. 5",
        ] {
            assert!(passes(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn sizes_and_times() {
        assert_eq!(size("640x480"), Ok((640, 480)));
        for bad in ["640", "640x", "x480", "0x480", "65537x1", "640x-1", "640 x 480", "1e3x5"] {
            assert!(size(bad).is_err(), "{bad}");
        }
        assert_eq!(duration("500ms"), Ok(Duration::from_millis(500)));
        assert_eq!(duration("30s"), Ok(Duration::from_secs(30)));
        assert_eq!(duration("1.5h"), Ok(Duration::from_secs(5400)));
        for bad in ["30", "s", "-1s", "infs", "30 days", "1e30h"] {
            assert!(duration(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn errors_are_shares_or_percentages() {
        for good in ["2%", "0.02", "2e-2"] {
            assert_eq!(target_error(good), Ok(0.02), "{good}");
        }
        for bad in ["", "%", "0", "0%", "-1%", "-0.02", "nan", "inf%", "2", "200%", "2 %%", "two"] {
            assert!(target_error(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn words_are_those_of_scene_files() {
        assert_eq!(word::<Method>("ppm"), Ok(Method::Ppm));
        let error = word::<Method>("pmp").unwrap_err();
        for known in ["sppm", "ppm", "path"] {
            assert!(error.contains(known), "{error}");
        }
        assert!(alpha("1").is_ok() && alpha("1.1").is_err() && alpha("0").is_err());
    }
}
